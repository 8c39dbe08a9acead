//! The error that a level reports is honest, sampled both ways, on surfaces and along curves: on small meshes, parts of
//! machines and models of games.

#[cfg(feature = "quality")]
#[path = "../support/apart.rs"]
mod apart;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/mod.rs"]
mod support;

mod both_ways;
mod cad;
mod curves;
mod deviation;
mod games;
mod levels_measured;
mod pinches;
