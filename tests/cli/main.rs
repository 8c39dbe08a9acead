//! Every command does what it says, answers with one object, exits 0, 1 or 2, and leaves no half-written file behind.

#[cfg(feature = "cli")]
#[path = "../support/command.rs"]
mod command;
#[path = "../support/content.rs"]
mod content;
/// Vertices around and along the tube of the samples.
#[cfg(feature = "cli")]
const TUBE: [usize; 2] = [24, 40];
#[cfg(feature = "cli")]
#[path = "../support/gltf_samples.rs"]
mod gltf_samples;
#[path = "../support/models.rs"]
mod models;
#[cfg(feature = "cli")]
#[path = "../support/gltf_validator.rs"]
mod validator;
#[path = "../support/wavelet.rs"]
mod wavelet_support;

mod advice;
mod commands;
mod every_model;
mod gltf;
mod gmesh;
mod hierarchy;
mod large_coordinates;
mod manual;
mod measure;
mod remesh;
mod wavelet;
