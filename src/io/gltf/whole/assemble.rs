//! The document to be written: meshes replaced, all references right.

use gltf_json::mesh::Primitive;
use serde_json::{Map, Value, json};

use crate::io::error::WriteError;
use crate::io::gltf::extensions::{self, COMPRESSED};
use crate::io::gltf::plan::is_surface;

use super::encode::{Column, Encoded, EncodedPrimitive};
use super::gltf_document::GltfDocument;
use super::pack::{Packed, Uses, pack};
use super::sections::{Elements, Sections, elements, index, indices, raw, value};

/// A document and its only buffer.
pub(super) struct Assembled {
    pub sections: Sections,
    pub views: Elements,
    pub buffer: Vec<u8>,
}

impl GltfDocument {
    /// Puts the replaced meshes, and added levels, in their places. The section `bufferViews` is not yet set.
    pub(super) fn assemble(&self) -> Result<Assembled, WriteError> {
        let store = self.store();
        let mut sections = self.sections.clone();
        let mut meshes: Vec<Value> = self.meshes.iter().map(|text| value(text)).collect();
        let uses = self.uses(&meshes);
        let encoded: Vec<&Encoded> =
            self.replaced.values().chain(self.added.iter().map(|added| &added.encoded)).collect();
        let columns: Vec<&Column> = encoded.iter().flat_map(|e| &e.columns).collect();
        let Packed { accessors, views, buffer, index } =
            pack(&store, sections.array("accessors"), sections.array("bufferViews"), &uses, &columns)?;
        let mut first = 0;
        let mut place = |encoded: &Encoded| {
            first += encoded.columns.len();
            index[first - encoded.columns.len()..first].to_vec()
        };
        let old = meshes.clone();
        for (&m, encoded) in &self.replaced {
            meshes[m] = self.with_primitives(&old[m], m, encoded, &place(encoded));
        }
        for added in &self.added {
            let mut mesh =
                self.with_primitives(&old[added.of], added.of, &added.encoded, &place(&added.encoded));
            let name = self.mesh_name(added.of);
            let name = if name.is_empty() { format!("mesh {}", added.of) } else { name.to_owned() };
            mesh["name"] = json!(format!("{name}_LOD{}", added.level));
            meshes.push(mesh);
        }
        sections.set_array("accessors", &accessors);
        if !encoded.is_empty() {
            let text = meshes.iter().enumerate().map(|(m, mesh)| match self.meshes.get(m) {
                Some(text) if !self.replaced.contains_key(&m) => text.clone(),
                _ => raw(mesh),
            });
            sections.set_array("meshes", &text.collect());
        }
        self.strip_unused(&mut sections, &views);
        Ok(Assembled { sections, views, buffer })
    }

    /// Returns a mesh with the primitives of a level.
    fn with_primitives(&self, old: &Value, mesh: usize, encoded: &Encoded, index: &[usize]) -> Value {
        let mut result = old.clone();
        let mut primitives = Vec::new();
        let typed = &self.document.meshes[mesh].primitives;
        for (p, primitive) in elements(old.get("primitives")).iter().enumerate() {
            let found = encoded.primitives.iter().find(|e| e.primitive == p);
            match found {
                Some(found) => primitives.push(changed(primitive, found, index)),
                None if typed.get(p).is_some_and(is_surface) => {}
                None => primitives.push(primitive.clone()),
            }
        }
        result["primitives"] = Value::from(primitives);
        result
    }

    /// Finds out what uses accessors and views.
    fn uses(&self, meshes: &[Value]) -> Uses {
        let mut uses = Uses { replaced_views: self.streams.clone(), ..Uses::default() };
        for (m, mesh) in meshes.iter().enumerate() {
            let is_replaced = self.replaced.contains_key(&m);
            let typed: &[Primitive] = self.document.meshes.get(m).map_or(&[], |mesh| &mesh.primitives);
            for (p, primitive) in elements(mesh.get("primitives")).iter().enumerate() {
                let goes = is_replaced && typed.get(p).is_some_and(is_surface);
                let mut vertices: Vec<usize> = indices(primitive.get("attributes")).map(|(_, i)| i).collect();
                for target in elements(primitive.get("targets")) {
                    vertices.extend(indices(Some(target)).map(|(_, i)| i));
                }
                let accessors = if goes { &mut uses.replaced } else { &mut uses.kept };
                accessors.extend(vertices.iter().copied().chain(index(primitive.get("indices"))));
                if !goes {
                    uses.kept_vertices.extend(vertices);
                }
                let views = if goes { &mut uses.replaced_views } else { &mut uses.kept_views };
                if let Some(extensions) = primitive.get("extensions") {
                    named(extensions, "bufferView", &mut |i| {
                        views.insert(i);
                    });
                }
            }
        }
        for skin in self.sections.array("skins") {
            uses.kept.extend(index(value(&skin).get("inverseBindMatrices")));
        }
        for animation in self.sections.array("animations") {
            for sampler in elements(value(&animation).get("samplers")) {
                uses.kept.extend(index(sampler.get("input")).into_iter().chain(index(sampler.get("output"))));
            }
        }
        let instancing =
            self.document.nodes.iter().filter_map(|n| n.extensions.as_ref()?.instancing.as_ref());
        uses.kept.extend(instancing.flat_map(|i| i.attributes.values()));
        let others =
            self.sections.names().filter(|name| !["accessors", "bufferViews", "meshes"].contains(name));
        for text in others.filter_map(|name| self.sections.get(name)) {
            if text.get().contains("\"bufferView\"") {
                named(&value(text), "bufferView", &mut |i| {
                    uses.kept_views.insert(i);
                });
            }
        }
        uses
    }

    /// Takes names of extensions that are used no more out of the lists.
    fn strip_unused(&self, sections: &mut Sections, views: &Elements) {
        let lists = ["extensionsUsed", "extensionsRequired"];
        // Written anew: views given, and a buffer without extensions.
        let anew = ["bufferViews", "buffers"];
        let is_used = |name: &str, sections: &Sections| {
            let word = format!("\"{name}\"");
            let mut texts =
                sections.names().filter(|section| !lists.contains(section) && !anew.contains(section));
            texts.any(|section| sections.get(section).is_some_and(|text| text.get().contains(&word)))
                || views.iter().any(|view| view.get().contains(&word))
        };
        let dropped = |name: &str| COMPRESSED.contains(&name) || self.dropped.contains(name);
        for list in lists {
            let names = sections.strings(list);
            let kept: Vec<String> =
                names.iter().filter(|name| !dropped(name) || is_used(name, sections)).cloned().collect();
            if kept.len() < names.len() {
                sections.set_strings(list, &kept);
            }
        }
    }
}

/// Calls `found` with every index that a member of this name has, anywhere within a value.
fn named(json: &Value, name: &str, found: &mut impl FnMut(usize)) {
    match json {
        Value::Array(values) => values.iter().for_each(|value| named(value, name, found)),
        Value::Object(members) => {
            for (key, value) in members {
                match index(Some(value)).filter(|_| key == name) {
                    Some(index) => found(index),
                    None => named(value, name, found),
                }
            }
        }
        _ => {}
    }
}

/// Returns a primitive with other accessors. `index`: accessor of each column.
fn changed(old: &Value, encoded: &EncodedPrimitive, index: &[usize]) -> Value {
    let mut primitive = old.clone();
    let members = |list: &[(String, usize)]| {
        let members = list.iter().map(|(semantic, column)| (semantic.clone(), json!(index[*column])));
        Value::from(members.collect::<Map<_, _>>())
    };
    primitive["attributes"] = members(&encoded.attributes);
    primitive["indices"] = json!(index[encoded.indices]);
    if old.get("targets").is_some() {
        primitive["targets"] = encoded.targets.iter().map(|target| members(target)).collect();
    }
    if let Some(members) = primitive.as_object_mut() {
        members.remove("mode");
        if let Some(extensions) = members.get_mut("extensions").and_then(Value::as_object_mut) {
            extensions.retain(|name, _| extensions::survives(name));
            if extensions.is_empty() {
                members.remove("extensions");
            }
        }
    }
    primitive
}
