//! Measures of meshes and pictures of them are right (distances, angles, volumes, images), with a reason where there is
//! none.

#[path = "../support/models.rs"]
mod models;

mod any_input;
mod distance;
mod distance_meshlab;
mod images;
mod normal_deviation;
mod render;
mod signed_distance;
mod surface_points;
mod volume;
