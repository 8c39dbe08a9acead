//! What comes in is understood: adjacency, counts of what is odd, positions and values that nearly agree, vertices as
//! engines have them, and procedural shapes.

#[path = "../support/models.rs"]
mod models;

mod adjacency;
mod from_vertices;
mod near_positions;
mod report;
mod shapes;
mod tolerances;
