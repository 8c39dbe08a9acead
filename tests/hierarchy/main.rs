//! A vertex hierarchy shows a surface like its mesh at every cut, and keeps the error, the budget and the changes a frame
//! that are asked for.

#[path = "../support/flown.rs"]
mod flown;
#[path = "../support/meshes.rs"]
mod meshes;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/mod.rs"]
mod support;

mod budget;
mod closed_moves;
mod cuts;
mod every_model;
mod geomorph;
mod manifold;
mod many;
mod mesh;
mod operations;
mod parts;
mod screen_error;
mod short_indices;
