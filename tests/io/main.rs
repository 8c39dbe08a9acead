//! Files are written and read without loss, in every form of their format; and broken or forged ones do no harm.

#[path = "../support/models.rs"]
mod models;
#[path = "../support/mod.rs"]
mod support;

mod atomic_links;
mod baked;
mod cases;
mod formats;
mod gltf_textures;
mod hostile_files;
mod roundtrip;
mod serde;
mod variants;
