//! Multiresolution triangle meshes: build once, pick a level of detail whenever you like, upload the slices.
//!
//! A pure Rust library that knows no graphics interface: it takes plain arrays and hands out plain slices.
//!
//! # The tour
//!
//! ```
//! use bytemuck::{Pod, Zeroable};
//! use multires::mesh::shapes;
//! use multires::prelude::*;
//!
//! #[repr(C)]
//! #[derive(Clone, Copy, Pod, Zeroable)]
//! struct Vertex {
//!     position: [f32; 3],
//! }
//! # let demo = shapes::demo();
//! # let vertices: Vec<Vertex> = demo.positions().iter().map(|&position| Vertex { position }).collect();
//! # let indices = demo.indices().to_vec();
//!
//! // Once, offline or when loading: what an engine has, one structure of it, your vertices in its order.
//! let mesh = Mesh::from_vertices(&vertices, &indices, |v| v.position)?;
//! let model = VertexHierarchy::bake(&mesh)?; // or TotallyOrderedMesh, or WaveletMesh: the rest stays the same
//! let values = model.arrange(&vertices)?;
//! let mut lod = model.instance(values, &LodOptions::default())?; // one for each drawn object
//!
//! // Every frame: follow the view, write what changed into buffers, draw.
//! # let world_to_eye = multires::view::look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]);
//! # let object_to_world = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
//! # let mut buffers = vec![Vec::new(); 2];
//! let view = View::perspective(world_to_eye, 60_f32.to_radians(), [1920, 1080])?.with_tolerance_px(1.0);
//! lod.adapt(&[view.of_object(object_to_world)?], 1.0 / 60.0);
//! for upload in lod.uploads() {
//!     // queue.write_buffer(&buffers[upload.buffer], upload.offset, upload.bytes)
//! #   let buffer: &mut Vec<u8> = &mut buffers[upload.buffer];
//! #   buffer.resize(buffer.len().max(upload.size as usize), 0);
//! #   buffer[upload.offset as usize..][..upload.bytes.len()].copy_from_slice(upload.bytes);
//! }
//! lod.clean();
//! for draw in lod.draws() {
//!     // pass.draw_indexed(draw.indices, draw.base_vertex, 0..1)
//! #   assert!(buffers[draw.buffer].len() >= 4 * draw.indices.end as usize);
//! }
//! # Ok::<(), multires::Error>(())
//! ```
//!
//! # One idea
//!
//! Taking detail away merges vertices, one step at a time. After any number of steps the mesh is *the image of the
//! input's triangles under the merges, less those with two equal corners*. That is all the connectivity there is, so no
//! step can lose or corrupt any, on open, non-manifold or otherwise odd meshes either. What the structures differ in is
//! how they get at that image quickly. Only [`wavelet`] meshes take the other way: a coarse mesh and a sum of corrections, for
//! meshes that were made by subdivision.
//!
//! # Rooms
//!
//! | room | what it holds |
//! |---|---|
//! | [`mesh`] | what comes in: [`Mesh`], attributes, materials, locks; [`Report`](mesh::Report); procedural [`shapes`](mesh::shapes) |
//! | [`simplify`] | how detail is taken away: [`Simplifier`] with metric, placement, order and oracles; [`CollapseSequence`] and [`ProgressiveMesh`] |
//! | [`lod`] | the one face of all structures: [`Baked`] models, [`Lod`] instances, [`LodOptions`] |
//! | [`tom`] | the [`TotallyOrderedMesh`]: every level in one vertex array and one triangle array |
//! | [`hierarchy`] | the [`VertexHierarchy`]: fine where a view needs it, for any mesh |
//! | [`wavelet`] | the [`WaveletMesh`]: the same for meshes with subdivision connectivity, where textures stay in place |
//! | [`view`] | where one looks from, and how large an error may be on the screen: [`View`] |
//! | [`adapt`] | how a level of detail follows the view: the cut, ranges that changed |
//! | `quality` | distances between meshes, signed and proven, volume, normals, textures, pictures without a graphics card (feature `quality`) |
//! | `io` | OBJ, PLY, STL, OFF, glTF and the baked file (feature `io`) |
//! | [`error`] | what can be wrong with arrays that are handed in |
//! | [`prelude`] | what most programs use; [`Error`], which every error of the crate becomes |
//!
//! Chapters to read at leisure are in the module `guide` (in the repository `docs/guide`): input, simplification, when it will not
//! go further, the three structures, what a frame of an engine does, measuring. Why things are as they are is in
//! `docs/architecture.md`, figures in `docs/performance.md`.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `parallel` | yes | all cores where work divides; the bytes that come out are the same without |
//! | `quality` | yes | the room `quality` |
//! | `io` | | the room `io`; brings `serde` |
//! | `serde` | | `Serialize` and `Deserialize` for meshes and structures, validated on the way in |
//! | `cli` | | the program `multires`; brings `io` and `quality` |
//!
//! # Guarantees
//!
//! - **No panic on any input.** Arrays are checked once, by [`Mesh::new`] and its kin; errors name the element at fault.
//!   Whatever passes is legal input everywhere.
//! - **Deterministic.** The same input and options give the same bytes, for any number of threads.
//! - **Errors are distances**, in object units, with a stated meaning ([`Simplifier`], "The error"), never the root of a
//!   cost.
//! - **Stopping early is a result**, not an error, and says why ([`StopReason`](simplify::StopReason)).
//! - **Nothing allocates per frame** once buffers are warm.
//! - **No unsafe code**, and no maths crate's types in public signatures.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod adapt;
mod any_error;
pub mod error;
#[cfg(all(any(doc, doctest), feature = "io", feature = "quality"))]
pub mod guide;
pub mod hierarchy;
#[cfg(feature = "io")]
pub mod io;
pub mod lod;
pub mod mesh;
pub mod prelude;
#[cfg(feature = "quality")]
pub mod quality;
pub mod simplify;
pub mod tom;
pub mod view;
pub mod wavelet;

pub use any_error::Error;
pub use error::MeshError;
pub use hierarchy::VertexHierarchy;
pub use lod::{Baked, Level, Lod, LodOptions, Structure};
pub use mesh::{Attribute, Mesh};
pub use simplify::{CollapseSequence, Placement, ProgressiveMesh, Simplifier, Target};
pub use tom::TotallyOrderedMesh;
pub use view::View;
pub use wavelet::WaveletMesh;

/// The code in the readme and the guide is compiled and run with the tests.
#[cfg(all(doctest, feature = "io", feature = "quality"))]
#[doc = include_str!("../README.md")]
mod readme {}
