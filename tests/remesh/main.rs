//! A remesh has the topology, features, attributes and textures of its mesh, and the map between the two is one to one.

#[path = "../support/models.rs"]
mod models;
#[path = "../support/remesh.rs"]
mod support;

mod attributes;
mod bake;
mod features;
mod fit;
mod map;
mod topology;
