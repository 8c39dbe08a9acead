//! A wavelet mesh is found in what was subdivided; is transformed, edited and drawn by any set of wavelets without cracks;
//! and keeps the error and the budget that are asked for.

#[path = "../support/models.rs"]
mod models;
#[path = "../support/subdivide/mod.rs"]
mod subdivide;
#[path = "../support/wavelet.rs"]
mod wavelet;

mod atlas;
mod atlas_order;
mod budget;
mod edit;
mod geomorph;
mod heights;
mod left_out;
mod mesh;
mod parts;
mod recognise;
mod recognise_adaptive;
mod screen_error;
mod surface;
mod transform;
