//! Attributes' names: customary ones and those of the format.

use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;

use crate::mesh::{AttributeValues, names};

use super::accessor::Shape;

/// Returns the customary name of a set: `uv`, `uv1`, `uv2`.
fn numbered(base: &str, set: u32) -> String {
    if set == 0 { base.to_owned() } else { format!("{base}{set}") }
}

/// Returns the semantic of a customary attribute; `None` for other names or widths.
pub(super) fn semantic(name: &str, width: usize) -> Option<Semantic> {
    match name {
        names::NORMAL => return (width == 3).then_some(Semantic::Normals),
        names::TANGENT => return (width == 4).then_some(Semantic::Tangents),
        _ => {}
    }
    let sets = [
        (names::UV, Semantic::TexCoords as fn(u32) -> Semantic, 2..=2),
        (names::COLOR, Semantic::Colors, 3..=4),
        (names::JOINTS, Semantic::Joints, 4..=4),
        (names::WEIGHTS, Semantic::Weights, 4..=4),
    ];
    sets.into_iter().find_map(|(base, semantic, widths)| {
        let set = name.strip_prefix(base)?;
        let set: u32 = if set.is_empty() { 0 } else { set.parse().ok()? };
        (numbered(base, set) == name && widths.contains(&width)).then(|| semantic(set))
    })
}

/// Returns the name and layout of the attribute for a semantic; `None` for positions.
pub(super) fn attribute(semantic: &Semantic, shape: Shape) -> Option<(String, usize, AttributeValues)> {
    let (float, uint) = (AttributeValues::Float(Vec::new()), AttributeValues::Uint(Vec::new()));
    Some(match semantic {
        Semantic::Positions => return None,
        Semantic::Normals => (names::NORMAL.to_owned(), 3, float),
        Semantic::Tangents => (names::TANGENT.to_owned(), 4, float),
        Semantic::TexCoords(set) => (numbered(names::UV, *set), 2, float),
        Semantic::Colors(set) => (numbered(names::COLOR, *set), shape.width.clamp(3, 4), float),
        Semantic::Joints(set) => (numbered(names::JOINTS, *set), 4, uint),
        Semantic::Weights(set) => (numbered(names::WEIGHTS, *set), 4, float),
        Semantic::Extras(own) => {
            // An application's own name must not be mistaken for a customary name.
            let taken = own.is_empty() || (1..=4).any(|width| self::semantic(own, width).is_some());
            let name = if taken { semantic.to_string() } else { own.clone() };
            let values = match (shape.is_float(), shape.is_signed()) {
                // Numbers of features (EXT_mesh_features) are no quantities, though some files have them as floats.
                _ if own.starts_with("FEATURE_ID_") => uint,
                (true, _) => float,
                (_, true) => AttributeValues::Int(Vec::new()),
                _ => uint,
            };
            (name, shape.width, values)
        }
    })
}

/// Returns the name of the attribute for a semantic of a morph target: `displacement` and its number for positions; for
/// others this name, a dot and the semantic.
pub(super) fn displacement(target: usize, semantic: &str) -> String {
    let name = numbered(names::DISPLACEMENT, target as u32);
    if semantic == "POSITION" { name } else { format!("{name}.{semantic}") }
}

/// Returns a primitive's attributes with a valid semantic, with their accessors.
pub(super) fn attributes(primitive: &Primitive) -> impl Iterator<Item = (&Semantic, usize)> {
    primitive.attributes.iter().filter_map(|(semantic, accessor)| match semantic {
        Checked::Valid(semantic) => Some((semantic, accessor.value())),
        Checked::Invalid => None,
    })
}
