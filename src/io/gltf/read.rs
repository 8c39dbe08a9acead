//! A scene to a single mesh in world space.

use std::path::Path;

use crate::io::draft::Draft;
use crate::io::error::ReadError;
use crate::mesh::names;

use super::accessor::Store;
use super::primitives::{Builder, Ids};
use super::{container, decoded, document, scene};

/// Reads a whole file; external buffers are read from `directory`. O(n) in file and result. The result is bounded by a
/// multiple of the bytes read, for any number of instances of a mesh.
pub(in crate::io) fn read(bytes: &[u8], directory: Option<&Path>) -> Result<Draft, ReadError> {
    let (json, chunk) = document::open(bytes)?;
    let mut document = document::parse(json)?;
    let mut buffers = container::buffers(&document, chunk, directory)?;
    decoded::decode(json, &mut document, &mut buffers, bytes.len())?;
    let store = Store::new(&document, &buffers);
    let instances = scene::instances(&store, bytes.len())?;
    let shown = instances.iter().map(|instance| instance.mesh).collect();
    let mut builder = Builder::new(&store, &shown, &|_, _| Vec::new(), Ids::Material, bytes.len())?;
    for instance in &instances {
        builder.add(instance.mesh, instance.world)?;
    }
    let (mut draft, plan) = builder.finish();
    // Tangents cannot be made up, and zeros are none.
    let tangent = plan.streams.iter().position(|s| s.name == names::TANGENT);
    let lacks = |stream: usize| {
        let parts = plan.meshes.values().flat_map(|m| &m.primitives).flatten();
        parts.filter(|part| part.inputs.iter().all(|input| input.1 != stream)).count()
    };
    if let Some((stream, count)) = tangent.map(|t| (t, lacks(t))).filter(|(_, count)| *count > 0) {
        draft.attributes.remove(stream);
        draft
            .notes
            .push(format!("{count} primitives have no tangents, unlike others: tangents are left out"));
    }
    let of = |count: usize, one: &str, many: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {many}")),
    };
    let primitives = document.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let targets = primitives.filter_map(|p| p.targets.as_ref().map(Vec::len)).max().unwrap_or(0);
    let left = [
        of(document.skins.len(), "skin", "skins"),
        of(document.animations.len(), "animation", "animations"),
        of(targets, "morph target", "morph targets"),
    ];
    let left: Vec<String> = left.into_iter().flatten().collect();
    if !left.is_empty() {
        draft.notes.push(format!("{}: no part of a mesh, and left out", left.join(", ")));
    }
    Ok(draft)
}
