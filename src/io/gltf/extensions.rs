//! Extensions: the known ones, and what becomes of the others (glTF 2.0, 3.12).
//!
//! A file that *requires* an extension must not be read by a program that does not know it: it is refused, by name. An
//! extension that is only *used* may be ignored by readers; [`GltfDocument`](super::GltfDocument) keeps it, unless it refers to
//! vertices of a surface that is replaced.

use crate::io::error::ReadError;

/// Extensions with the vertices of meshes or instances in a form of their own, that this crate reads.
const GEOMETRY: [&str; 4] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
];

/// Extensions that say nothing about the positions of vertices: materials, textures, lights, animations, variants,
/// metadata. Beside these, all whose names start with [`HARMLESS_PREFIXES`].
const HARMLESS: [&str; 20] = [
    "ADOBE_materials_thin_transparency",
    "AGI_articulations",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "FB_geometry_metadata",
    "GRIFFEL_bim_data",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_node_visibility",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
];

const HARMLESS_PREFIXES: [&str; 4] = ["KHR_materials_", "EXT_materials_", "KHR_texture_", "MSFT_texture_"];

/// Extensions of a primitive that stay true when its vertices change: they speak of materials, or of attributes by name.
const OF_PRIMITIVES: [&str; 3] = ["KHR_materials_variants", "EXT_mesh_features", "EXT_structural_metadata"];

/// Extensions that store what uncompressed accessors hold as well.
pub(super) const COMPRESSED: [&str; 3] =
    ["EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_meshopt_compression"];

/// What to do about a file that is compressed by Draco.
const DRACO: &str = " (decompress it first, for example: gltf-transform copy IN.glb OUT.glb)";

fn is_known(name: &str) -> bool {
    GEOMETRY.contains(&name)
        || (cfg!(feature = "draco") && name == "KHR_draco_mesh_compression")
        || HARMLESS.contains(&name)
        || HARMLESS_PREFIXES.iter().any(|prefix| name.starts_with(prefix))
}

/// Refuses the first required extension that is not known.
pub(super) fn check_required(required: &[String]) -> Result<(), ReadError> {
    let Some(name) = required.iter().find(|name| !is_known(name)) else { return Ok(()) };
    let way = match name.as_str() {
        "KHR_draco_mesh_compression" => DRACO,
        _ => "",
    };
    Err(ReadError::unsupported(format!("the file requires the glTF extension {name}{way}")))
}

/// Whether an extension of a primitive may stay when the primitive's vertices are replaced.
pub(super) fn survives(name: &str) -> bool {
    OF_PRIMITIVES.contains(&name)
}
