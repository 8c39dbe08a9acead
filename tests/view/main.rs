//! Views answer what their definitions say: what is seen, how large an error looks, and for how long that holds.

#[path = "../support/mod.rs"]
mod support;

mod answers;
mod deviation;
mod error_shapes;
mod many;
mod turning;
