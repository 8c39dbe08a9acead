//! What the programs that make `docs/results` share.
//!
//! | program | makes |
//! |---|---|
//! | `study` | docs/results/simplification.md: metrics, placements and measures compared |
//! | `flythrough` | docs/results/hierarchy.md: a flight past a vertex hierarchy |
//! | `wavelet` | docs/results/wavelets.md: flights past wavelet meshes |
//! | `wavelet_compression` | docs/results/wavelet-compression.md: how few coefficients do |
//! | `remeshing` | docs/results/remeshing.md: any mesh as one with subdivision connectivity |
//! | `streaming` | docs/results/streaming.md: models sent to clients, and bytes counted |
//! | `fidelity` | docs/performance.md: reported errors beside measured ones |

#![allow(missing_docs)]

#[path = "../../../src/bin/multires/canvas.rs"]
pub mod canvas;
pub mod chart;
#[path = "../../../tests/support/flight.rs"]
pub mod flight;
#[path = "../../../src/bin/multires/lettering.rs"]
pub mod lettering;
pub mod outside;
pub mod painted;
#[path = "../../../examples/support/parameter_lines.rs"]
pub mod parameter_lines;
#[path = "../../../examples/support/picture.rs"]
pub mod picture;
pub mod plates;
pub mod race;
#[path = "../../../examples/support/say.rs"]
pub mod say;
pub mod sheet;
pub mod sphere;
pub mod study;
