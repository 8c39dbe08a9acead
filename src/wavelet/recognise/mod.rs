//! Recognises subdivision connectivity: takes a plain mesh apart into the coarsest base complex and its four-to-one
//! subdivisions.
//!
//! ```text
//!     weld, find edges, split into components                          (pieces.rs)
//!     for every component
//!         while four faces can be taken for one all over it            (coarsen.rs)
//!             replace it by the coarser complex
//!         if there was none                                            (peel.rs)
//!             while faces split last are found beside unsplit ones
//!                 merge both                                           (region.rs, merge.rs)
//!             go on as above
//!     grow the forest from the faces that are left
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `recognition.rs` | the driver, and what it returns |
//! | `quadrisection.rs` | [`Quadrisection`]: a forest of faces |
//! | `pieces.rs` | components |
//! | `complex.rs` | faces glued along edges |
//! | `label.rs` | the state of a single face determines the states of all |
//! | `coarsen.rs` | merging faces in fours, all over a component |
//! | `tower.rs` | coarse faces of all components, and the forest grown from them |
//! | `peel.rs` | components of uneven depth: the finest splits are taken off first |
//! | `region.rs` | faces split last, joined by common sides, and the unsplit faces beside them |
//! | `merge.rs` | the ways in which faces are taken for one |
//! | `fans.rs` | faces around a point that are joined by edges |
//! | `stop.rs` | why coarsening ended |
//!
//! The problem is posed in Taubin, "Is this a quadrisected mesh?" (ACM Solid Modeling 2001). Taubin finds the coarse mesh of a
//! manifold among the components of a covering mesh. Here labels spread from the first face instead, on complexes of any kind.
//!
//! **Ambiguity.** A midpoint has six faces around it: three at a border, and three for every face of an edge where many faces
//! meet. Any other vertex is old, and a single known old vertex settles the whole component. So several of the four assumptions
//! can hold only where all vertices are regular. On a manifold the component is then the triangular lattice rolled up. On a
//! torus, an annulus and a Moebius strip, shifts of the lattice map the assumptions onto each other. On a Klein bottle, a glide
//! reflection settles one coordinate of the old vertices, and the existence of a next level does not depend on the other. So
//! the first assumption is as good as any, except for features outside the lattice: seams, materials, clashing orientation, and
//! edges where many faces meet. Because of these features, if a level cannot be coarsened, the remaining assumptions of the
//! level below are tried, and the first to allow a further level is taken. Each level is examined twice at most, so the total
//! time is linear. An assumption failing only two levels above is not revised.

mod coarsen;
mod complex;
mod fans;
mod label;
mod merge;
mod peel;
mod pieces;
pub(super) mod quadrisection;
mod recognition;
mod region;
mod stop;
mod tower;

pub use quadrisection::Quadrisection;
pub use recognition::{Component, Recognition, recognise, recognise_across_seams, recognise_uneven};
pub use stop::Stop;
pub(super) use tower::Leaves;
