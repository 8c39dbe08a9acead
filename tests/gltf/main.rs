//! A glTF document goes in and comes out with lighter meshes and nothing else changed.

#![cfg(all(feature = "io", feature = "quality"))]

#[path = "../support/gltf_samples.rs"]
mod gltf_samples;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/gltf_validator.rs"]
mod validator;

mod compare;
mod hostile;
mod levels;
mod poses;
mod reading;
mod saving;
mod whole;
