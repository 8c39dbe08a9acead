//! What every structure promises alike; and totally ordered meshes, progressive meshes and g-meshes, which need no folder
//! of their own.

#[path = "../../examples/support/asset.rs"]
mod asset;
#[path = "../../examples/support/gpu.rs"]
mod gpu;
#[path = "../support/mod.rs"]
mod support;

mod baked_models;
mod built_is_valid;
mod gmesh;
mod one_face;
mod out_of_range;
mod progressive;
mod steps_memory;
mod tom;
mod tom_mesh;
mod zero_edges;
