//! Any mesh is simplified to what is asked for, by every metric and under every rule: parts, needles, hubs, curves, topology
//! that gives; and what comes out is a sequence of valid levels.

#[path = "../support/meshes.rs"]
mod meshes;
#[path = "../support/models.rs"]
mod models;
#[path = "../support/strips.rs"]
mod strips;

mod batches;
mod doubled_sheets;
mod extremes;
mod hubs;
mod joining;
mod large_meshes;
mod metric_rims;
mod metrics;
mod metrics_any_input;
mod needles;
mod no_rules;
mod non_manifold_curves;
mod options;
mod parts;
mod permissive;
mod permissive_models;
mod ruin;
mod self_intersection;
mod shape;
mod topology_gives;
