//! glTF 2.0 and GLB: all meshes of a scene as a single mesh, in world space.
//!
//! | file | idea |
//! |---|---|
//! | `document.rs` | the document (`gltf-json`), the GLB container and the buffers |
//! | `accessor.rs` | values out of buffers |
//! | `scene.rs` | nodes and their world transforms |
//! | `read.rs` | primitives to a mesh |
//! | `semantics.rs` | attributes' names |
//! | `write.rs` | a mesh to a file |
//!
//! Read: triangles, strips and fans of every mesh shown by a node of the scene, once for each such node. Positions and
//! normals are transformed to world space; triangles are flipped if the transform mirrors. Skins and morph targets are
//! not applied: a skinned mesh is in bind pose at its node. Material ids and names are the document's. If only some
//! primitives have a material, the other primitives get the number of materials as id. Primitives with equal accessors
//! share vertices.
//!
//! `NORMAL`, `TANGENT`, `TEXCOORD_n`, `COLOR_n`, `JOINTS_n`, `WEIGHTS_n` become attributes of the customary names, and
//! `_NAME` an attribute called `NAME`. Primitives lacking an attribute get zeros. Images are never opened; a written
//! file refers to pictures where asked to ([`GltfTextures`]).

mod accessor;
mod document;
mod read;
mod scene;
mod semantics;
mod write;

pub(super) use read::read;
pub use write::GltfTextures;
pub(super) use write::write;
