//! Attributes come through collapses: they count, fit where they are placed, keep their seams and creases, and are never
//! turned over.

#[path = "../support/meshes.rs"]
mod meshes;
#[path = "../support/models.rs"]
mod models;

mod blended_vertices;
mod by_default;
mod costs;
mod hard_edges;
mod placement;
mod seams;
mod uv_orientation;
