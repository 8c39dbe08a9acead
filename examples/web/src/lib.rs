//! The viewer in a browser: its scene and renderer, told what to do by a page.
//!
//! ```text
//!     page/main.js       what is seen and touched; never waits
//!     page/picture.js    a worker with the canvas and a Stage: adapts, uploads, draws
//!     page/build.js      a worker with build(): files and shapes become baked bytes
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `build.rs` | `build`: a shape or a file, baked; in a browser |
//! | `names.rs` | scenes by name |
//! | `stage.rs` | `Stage`: a scene, a camera, a canvas; in a browser |
//! | [`bindings`] | a package as a browser loads it; elsewhere |
//! | `bin/serve.rs` | the program that makes the page and serves it |
//! | `bin/pack.rs` | the program that makes the npm package of `multires-web` |

#[cfg(not(target_arch = "wasm32"))]
pub mod bindings;
#[cfg(all(target_arch = "wasm32", feature = "build"))]
mod build;
#[cfg(target_arch = "wasm32")]
mod names;
#[cfg(all(target_arch = "wasm32", feature = "picture"))]
mod stage;

#[cfg(all(target_arch = "wasm32", feature = "build"))]
pub use build::{Built, build};
#[cfg(all(target_arch = "wasm32", feature = "picture"))]
pub use stage::{Frame, Stage};
