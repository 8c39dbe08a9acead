//! A glTF document goes in and comes out with lighter meshes and nothing else changed.

#![cfg(all(feature = "io", feature = "quality"))]

/// Vertices around and along the tube of the samples.
const TUBE: [usize; 2] = [24, 40];
#[path = "../support/gltf_samples.rs"]
mod gltf_samples;
#[path = "../support/meshopt_encoder.rs"]
mod meshopt_encoder;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/gltf_validator.rs"]
mod validator;

mod compare;
mod compressed;
#[cfg(feature = "draco")]
mod draco;
mod hostile;
mod levels;
mod poses;
mod reading;
mod saving;
mod whole;
