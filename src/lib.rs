//! Multiresolution triangle meshes: build once, pick a level of detail at any time, upload the slices.
//!
//! A pure Rust library without any graphics interface: it takes plain arrays and returns plain slices.
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
//! # The idea
//!
//! Simplification merges vertices, one step at a time. After any number of steps the mesh is *the image of the input's
//! triangles under the merges, less the triangles with two equal corners*. There is no other connectivity, so no step can lose
//! or corrupt any, on open, non-manifold or otherwise odd meshes either. The structures differ in how they compute the image
//! quickly. Only [`wavelet`] meshes work differently: by a coarse mesh and a sum of corrections, for meshes made by
//! subdivision, which [`remesh`] makes of any mesh.
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | [`mesh`] | input: [`Mesh`], attributes, materials, locks; [`Report`](mesh::Report); procedural [`shapes`](mesh::shapes) |
//! | [`simplify`] | [`Simplifier`] with metric, placement, order and oracles |
//! | [`sequence`] | what comes out: the [`CollapseSequence`] with its report, and any level of it |
//! | [`progressive`] | the [`ProgressiveMesh`]: a base mesh and vertex splits |
//! | [`lod`] | the interface common to all structures: [`Baked`] models, [`Lod`] instances, [`LodOptions`] |
//! | [`tom`] | the [`TotallyOrderedMesh`]: every level in a vertex array and a triangle array |
//! | [`gmesh`] | the [`Gmesh`]: few levels that turn into each other in a vertex shader, for objects drawn many times |
//! | [`hierarchy`] | the [`VertexHierarchy`]: fine where a view needs it, for any mesh |
//! | [`wavelet`] | the [`WaveletMesh`]: fine where a view needs it, for subdivision meshes; textures stay in place |
//! | [`remesh`] | any mesh as a subdivision mesh, with a map that takes points both ways |
//! | [`view`] | cameras, and the error allowed on the screen: [`View`] |
//! | [`adapt`] | following a view: the cut, changed ranges |
//! | [`control`] | a frame time, or a number of triangles, for a whole scene |
//! | `stream` | a model that lies elsewhere: coarse at once, then what is looked at (feature `stream`) |
//! | `quality` | distances between meshes, signed and proven, volume, normals, textures, rendering on the CPU (feature `quality`) |
//! | `io` | OBJ, PLY, STL, OFF, glTF and the baked file (feature `io`) |
//! | [`error`] | errors of input arrays |
//! | [`prelude`] | names used by most programs; [`Error`], to which every error of the crate converts |
//!
//! Chapters to read at leisure are in the module `guide` (in the repository `docs/guide`): input, simplification, when it gets
//! stuck, the three structures, many objects, models over a line, a frame of an engine,
//! measuring. Reasons for the design are in `docs/architecture.md`, figures
//! in `docs/performance.md`.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `parallel` | yes | use of all cores where work divides; the output bytes are equal without it |
//! | `quality` | yes | the module `quality` |
//! | `io` | | the module `io`; brings `serde` |
//! | `draco` | | glTF files compressed by Draco; brings `io` |
//! | `stream` | | the module `stream` |
//! | `serde` | | `Serialize` and `Deserialize` for meshes and structures, validated on the way in |
//! | `cli` | | the program `multires`; brings `io`, `draco` and `quality` |
//!
//! # Guarantees
//!
//! - **No panic on any input.** Arrays are checked once, by [`Mesh::new`] and its kin; errors name the element at fault.
//!   Checked arrays are legal input everywhere.
//! - **Deterministic.** Equal input and options give equal bytes, for any number of threads.
//! - **Errors are distances**, in object units, with a stated meaning ([`Simplifier`], "The error"), never the root of a
//!   cost.
//! - **Stopping early is a result**, not an error, and says why ([`StopReason`](simplify::StopReason)).
//! - **Nothing allocates per frame** once buffers are warm.
//! - **No unsafe code**, and no maths crate's types in public signatures.
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod adapt;
mod any_error;
pub mod control;
pub mod error;
mod geometry;
pub mod gmesh;
#[cfg(all(any(doc, doctest), feature = "io", feature = "quality", feature = "stream"))]
pub mod guide;
pub mod hierarchy;
#[cfg(feature = "io")]
pub mod io;
pub mod lod;
pub mod mesh;
pub mod prelude;
pub mod progressive;
#[cfg(feature = "quality")]
pub mod quality;
pub mod remesh;
#[cfg(feature = "io")]
mod sections;
pub mod sequence;
pub mod simplify;
#[cfg(feature = "stream")]
pub mod stream;
pub mod tom;
pub mod view;
pub mod wavelet;

pub use any_error::Error;
pub use error::MeshError;
pub use gmesh::Gmesh;
pub use hierarchy::VertexHierarchy;
pub use lod::{Baked, Level, Lod, LodOptions, Structure};
pub use mesh::{Attribute, Mesh};
pub use progressive::ProgressiveMesh;
pub use sequence::CollapseSequence;
pub use simplify::{Placement, Simplifier, Target};
pub use tom::TotallyOrderedMesh;
pub use view::View;
pub use wavelet::WaveletMesh;

/// Compiles and runs the code in the readme with the tests.
#[cfg(all(doctest, feature = "io", feature = "quality"))]
#[doc = include_str!("../README.md")]
mod readme {}
