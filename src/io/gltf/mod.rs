//! glTF 2.0 and GLB: all meshes of a scene as a single mesh, in world space.
//!
//! | file | idea |
//! |---|---|
//! | `document.rs`, `container.rs` | the geometric part of the document (`gltf-json`); GLB chunks and buffers |
//! | `extensions.rs` | extensions: known, refused, kept |
//! | `accessor.rs` | values out of buffers |
//! | `decoded.rs`, `meshopt/`, `draco.rs` | compressed views and primitives, decoded on opening |
//! | `semantics.rs` | attributes' names |
//! | `scene.rs` | nodes and their world transforms |
//! | `plan.rs`, `primitives.rs`, `normals.rs` | what meshes consist of; primitives to vertices and triangles; normals that are missing |
//! | `read.rs` | a scene to a mesh |
//! | `write.rs` | a mesh to a file |
//! | `whole/` | [`GltfDocument`]: a file of which only the meshes change |
//!
//! Read: triangles, strips and fans of every mesh shown by a node of the scene, once for each such node and each of its
//! instances. Positions and normals are transformed to world space; triangles are flipped if the transform mirrors. Skins
//! and morph targets are not applied: a skinned mesh is in bind pose, in its own space. Material ids and names are the
//! document's. If only some primitives have a material, the other primitives get the number of materials as id. Primitives
//! with equal accessors share vertices.
//!
//! Views compressed by `EXT_meshopt_compression` or `KHR_meshopt_compression` are decoded if they have no uncompressed form,
//! and with the feature `draco` so are primitives compressed by `KHR_draco_mesh_compression`. Without the feature, a file that
//! requires Draco is refused, by name.
//!
//! `NORMAL`, `TANGENT`, `TEXCOORD_n`, `COLOR_n`, `JOINTS_n`, `WEIGHTS_n` become attributes of the customary names, and
//! `_NAME` an attribute called `NAME`. Primitives lacking an attribute that others have get white colours, normals from
//! their triangles, and zeros; if some lack tangents, tangents are left out. Images are never opened; a written file refers
//! to pictures where asked to ([`GltfTextures`]).

mod accessor;
mod container;
mod decoded;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod extensions;
mod meshopt;
mod normals;
mod plan;
mod primitives;
mod read;
mod scene;
mod semantics;
mod whole;
mod write;

pub(super) use read::read;
pub use whole::{GltfDocument, GltfLevels, GltfPose};
pub use write::GltfTextures;
pub(super) use write::write;
