//! Bounds of accessors whose values came through a filter: `min` and `max` are those of the values before it was applied,
//! and wrong where the values are written uncompressed.

use std::collections::BTreeSet;

use serde_json::json;

use crate::io::gltf::accessor::{Store, one};

use super::sections::{Sections, raw, value};

impl Sections {
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
