//! Sections of a document that was decoded, as if it had never been compressed.
//!
//! Compression rounds, and bounds of accessors are those of the values before it: right within a compressed file, wrong where
//! the values are written uncompressed.

use std::collections::BTreeSet;

use gltf_json::accessor::ComponentType;
use gltf_json::validation::Checked;
use serde_json::{Value, json};

use crate::io::gltf::accessor::{Store, one};
use crate::io::gltf::decoded::Decoded;
use crate::io::gltf::document::{Document, size};

use super::sections::{Sections, raw, value};

impl Sections {
    /// Sets accessors and views to those decoded, and removes the extension of their primitives.
    pub fn set_decoded(&mut self, document: &Document, decoded: &Decoded) {
        if decoded.accessors.is_empty() {
            return;
        }
        let mut accessors = self.array("accessors");
        for &a in &decoded.accessors {
            let (Some(text), Some(typed)) = (accessors.get_mut(a), document.accessors.get(a)) else {
                continue;
            };
            let mut json = value(text);
            json["bufferView"] = json!(typed.buffer_view.map(|view| view.value()));
            json["count"] = json!(typed.count.0);
            // Indices alone may have changed their type.
            if matches!(typed.component_type, Checked::Valid(kind) if kind.0 == ComponentType::U32) {
                json["componentType"] = json!(5125);
            }
            if let Some(members) = json.as_object_mut() {
                members.remove("byteOffset");
            }
            *text = raw(&json);
        }
        self.set_array("accessors", &accessors);
        let mut views = self.array("bufferViews");
        for view in document.buffer_views.iter().skip(views.len()) {
            let mut json = json!({ "buffer": view.buffer.value(), "byteOffset": view.byte_offset.map_or(0, size),
                "byteLength": size(view.byte_length), "target": 34963 });
            if let Some(stride) = view.byte_stride {
                json["byteStride"] = json!(stride.0);
                json["target"] = json!(34962);
            }
            views.push(raw(&json));
        }
        self.set_array("bufferViews", &views);
        let mut meshes = self.array("meshes");
        let mut of: Vec<usize> = decoded.primitives.iter().map(|primitive| primitive.0).collect();
        of.dedup();
        for m in of {
            let Some(text) = meshes.get_mut(m) else { continue };
            let mut json = value(text);
            let primitives = json.get_mut("primitives").and_then(Value::as_array_mut);
            for (p, primitive) in primitives.into_iter().flatten().enumerate() {
                let Some(members) =
                    primitive.as_object_mut().filter(|_| decoded.primitives.contains(&(m, p)))
                else {
                    continue;
                };
                let Some(extensions) = members.get_mut("extensions").and_then(Value::as_object_mut) else {
                    continue;
                };
                extensions.remove("KHR_draco_mesh_compression");
                if extensions.is_empty() {
                    members.remove("extensions");
                }
            }
            *text = raw(&json);
        }
        self.set_array("meshes", &meshes);
    }

    /// Sets the bounds of accessors of these views to those of their values, where they have bounds and finite values. O(n) in
    /// the bytes of all buffers: accessors that share more values than this stay as they are.
    pub fn mend_bounds(&mut self, store: &Store, filtered: &BTreeSet<usize>) {
        if filtered.is_empty() {
            return;
        }
        let mut accessors = self.array("accessors");
        let mut left = store.bytes();
        for (a, text) in accessors.iter_mut().enumerate() {
            let view = store.document.accessors.get(a).and_then(|accessor| accessor.buffer_view);
            if !view.is_some_and(|view| filtered.contains(&view.value())) {
                continue;
            }
            let mut json = value(text);
            let work = store.count(a).unwrap_or(0).saturating_add(store.replaced(a));
            if work > left || (json.get("min").is_none() && json.get("max").is_none()) {
                continue;
            }
            left -= work;
            let Some(bounds) = bounds(store, a) else { continue };
            for (name, bound) in ["min", "max"].into_iter().zip(bounds) {
                if json.get(name).is_some() {
                    json[name] = json!(bound);
                }
            }
            *text = raw(&json);
        }
        self.set_array("accessors", &accessors);
    }
}

/// Returns the least and largest stored components; `None` if there are none, or not all are numbers.
fn bounds(store: &Store, accessor: usize) -> Option<[Vec<f64>; 2]> {
    let shape = store.shape(accessor).ok()?;
    let scale = if shape.normalized { one(shape.component) } else { 1.0 };
    let mut bounds = [vec![f64::INFINITY; shape.width], vec![f64::NEG_INFINITY; shape.width]];
    let mut is_finite = true;
    let read = store.values(accessor, |_, component, value| {
        let stored = value * scale;
        is_finite &= stored.is_finite();
        bounds[0][component] = bounds[0][component].min(stored);
        bounds[1][component] = bounds[1][component].max(stored);
    });
    let is_known = read.is_ok() && is_finite && bounds[0][0] <= bounds[1][0];
    if shape.normalized {
        bounds.iter_mut().flatten().for_each(|bound| *bound = bound.round());
    }
    is_known.then_some(bounds)
}
