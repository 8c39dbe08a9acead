//! Every command does what it says, answers with one object, exits 0, 1 or 2, and leaves no half-written file behind.

#[cfg(feature = "cli")]
#[path = "../support/command.rs"]
mod command;
#[path = "../support/content.rs"]
mod content;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/wavelet.rs"]
mod wavelet_support;

mod advice;
mod commands;
mod every_model;
mod gmesh;
mod hierarchy;
mod large_coordinates;
mod measure;
mod remesh;
mod wavelet;
