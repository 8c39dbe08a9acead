//! The input mesh: positions, triangles and attribute streams, and their analysis.
//!
//! | file | idea |
//! |---|---|
//! | `triangle_mesh.rs` | [`Mesh`], validated once and infallible afterwards |
//! | `attribute.rs` | [`Attribute`], a named stream of per-vertex values |
//! | `blend.rs` | blends of two vertices' attributes |
//! | `creases.rs` | [`Creases`]: normals from the triangles, smooth up to an angle |
//! | `group.rs` | groups of equal items |
//! | `topology.rs` | [`Topology`]: points (vertices at equal positions) and wedges (equal vertices) |
//! | `tolerances.rs` | [`Tolerances`]: the largest differences within a wedge |
//! | `adjacency.rs` | [`Adjacency`]: the corners around every point, in flat arrays |
//! | `edges.rs` | [`Edges`]: every edge once, with the half-edges along it |
//! | `gather.rs` | submeshes: selected vertices with their attributes |
//! | `midpoints.rs` | vertices at the midpoint of two others, smooth normals |
//! | `near.rs` | nearly coincident positions: [`Mesh::welded`] |
//! | `mesh_point.rs` | [`MeshPoint`]: a point of the surface |
//! | `report.rs` | [`Report`]: counts, borders, non-manifold parts |
//! | `volume.rs` | enclosed volume |
//! | `vertices.rs` | meshes from an engine's vertex and index buffers |
//! | `shapes/` | [`shapes`]: procedural meshes for tests, demos and the quickstart |

mod adjacency;
mod attribute;
mod blend;
mod creases;
mod edges;
mod gather;
mod group;
mod mesh_point;
mod midpoints;
mod near;
mod report;
#[cfg(feature = "io")]
mod sections;
pub mod shapes;
mod tolerances;
mod topology;
mod triangle_mesh;
mod vertices;
mod volume;

pub use adjacency::Adjacency;
pub use attribute::{Attribute, AttributeValues, names};
pub use creases::{Creases, NormalWeights};
pub use edges::Edges;
pub use mesh_point::MeshPoint;
pub(crate) use near::{border_twins, rounding};
pub use report::Report;
pub use tolerances::Tolerances;
pub use topology::Topology;
pub use vertices::Index;
pub(crate) use vertices::{check_folded, folded};

pub(crate) use crate::geometry::lists::NONE;
pub(crate) use blend::Blender;
pub(crate) use gather::Used;
pub use triangle_mesh::{MAX_ELEMENTS, Mesh};
