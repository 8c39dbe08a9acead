//! Columns to accessors, views and one buffer.
//!
//! ```text
//!   accessors of replaced primitives alone     free: their indices are used again by columns
//!   views with free accessors                  free: only ranges that other accessors read are kept
//!   all other views                            kept whole
//!   ranges kept, joined where they overlap --> buffer 0, columns appended
//! ```
//!
//! No index changes: animations, skins, images and extensions that this crate does not know stay right. A free accessor or
//! view for which there is no use becomes an empty one at its place, or goes if it is the last.

use std::collections::BTreeSet;

use gltf_json::accessor::ComponentType;
use serde_json::{Value, json};

use crate::io::error::WriteError;
use crate::io::gltf::accessor::Store;
use crate::io::gltf::document::size;
use crate::io::gltf::extensions::COMPRESSED;

use super::encode::Column;
use super::ranges::{Moved, Range, ranges};
use super::sections::{Elements, raw, value};

const VERTICES: u32 = 34_962;
const INDICES: u32 = 34_963;

/// Accessors, views and the buffer of a document to be written.
pub(super) struct Packed {
    pub accessors: Elements,
    pub views: Elements,
    pub buffer: Vec<u8>,
    /// Index of each column's accessor.
    pub index: Vec<usize>,
}

/// What is known about the uses of accessors and views.
#[derive(Default)]
pub(super) struct Uses {
    /// Accessors of primitives that are replaced.
    pub replaced: BTreeSet<usize>,
    /// Accessors of all else.
    pub kept: BTreeSet<usize>,
    /// Those among them that are attributes of vertices.
    pub kept_vertices: BTreeSet<usize>,
    /// Views used by no accessor: images, extensions.
    pub kept_views: BTreeSet<usize>,
    /// Views of the compressed form of primitives that are replaced.
    pub replaced_views: BTreeSet<usize>,
}

/// Packs columns into a document's accessors and views. O(n log n).
///
/// # Errors
/// A view that reaches beyond its buffer; a buffer of more than 4 GiB.
pub(super) fn pack(
    store: &Store,
    accessors: Elements,
    views: Elements,
    uses: &Uses,
    columns: &[&Column],
) -> Result<Packed, WriteError> {
    let free = uses.replaced.difference(&uses.kept).copied();
    let free: BTreeSet<usize> = free.filter(|accessor| *accessor < accessors.len()).collect();
    let mut packing = Packing { store, accessors, views, free_views: BTreeSet::new() };
    packing.free_views.extend(uses.replaced_views.difference(&uses.kept_views));
    for &accessor in &free {
        packing.free_views.extend(ranges(store, accessor).map(|(view, _)| view));
    }
    packing.free_views.retain(|view| !uses.kept_views.contains(view) && *view < packing.views.len());
    let mut buffer = packing.keep(&free, &uses.kept_vertices)?;
    let index = packing.append(columns, free, &mut buffer);
    let Packing { accessors, views, .. } = packing;
    if u32::try_from(buffer.len()).is_err() {
        let what = format!("a buffer of {} bytes", buffer.len());
        return Err(WriteError::Unsupported { format: "glTF", what });
    }
    Ok(Packed { accessors, views, buffer, index })
}

struct Packing<'a> {
    store: &'a Store<'a>,
    accessors: Elements,
    views: Elements,
    /// Views of which only ranges are kept.
    free_views: BTreeSet<usize>,
}

impl Packing<'_> {
    /// Returns a view's range of its buffer.
    fn range(&self, view: usize) -> Result<Range, WriteError> {
        let what = || format!("buffer view {view}, which reaches beyond its buffer");
        let beyond = || WriteError::Unsupported { format: "glTF", what: what() };
        let found = self.store.document.buffer_views.get(view).ok_or_else(beyond)?;
        let (buffer, start) = (found.buffer.value(), found.byte_offset.map_or(0, size));
        let end = start.checked_add(size(found.byte_length)).ok_or_else(beyond)?;
        let there = self.store.buffers().get(buffer).map_or(0, |bytes| bytes.len());
        if end > there { Err(beyond()) } else { Ok(Range { buffer, start, end }) }
    }

    /// Gathers all bytes that stay into a buffer, and moves their views. `free`: accessors whose bytes go; `vertices`: others
    /// that are attributes of vertices.
    fn keep(&mut self, free: &BTreeSet<usize>, vertices: &BTreeSet<usize>) -> Result<Vec<u8>, WriteError> {
        let mut kept = Vec::with_capacity(self.views.len());
        // Of free views: the first and last byte that others read.
        let mut rest: Vec<Option<Range>> = vec![None; self.views.len()];
        for view in (0..self.views.len()).filter(|view| !self.free_views.contains(view)) {
            kept.push(self.range(view)?);
        }
        let accessors = (0..self.accessors.len()).filter(|a| !free.contains(a));
        let others: Vec<usize> =
            accessors.filter(|&a| ranges(self.store, a).any(|(v, _)| self.free_views.contains(&v))).collect();
        for &accessor in &others {
            for (view, bytes) in ranges(self.store, accessor).filter(|(v, _)| self.free_views.contains(v)) {
                let whole = self.range(view)?;
                let start = whole.start.saturating_add(bytes.start).min(whole.end);
                let end = whole.start.saturating_add(bytes.end).min(whole.end);
                let range = Range { buffer: whole.buffer, start: start & !3, end: end.max(start) };
                kept.push(range);
                let joined = rest[view].get_or_insert(range);
                (joined.start, joined.end) = (joined.start.min(range.start), joined.end.max(range.end));
            }
        }
        let moved = Moved::new(kept);
        let of_vertices: BTreeSet<usize> =
            vertices.iter().flat_map(|&a| ranges(self.store, a)).map(|(view, _)| view).collect();
        let strided = self.read_in_strides(free);
        for (view, &left) in rest.iter().enumerate() {
            let range = match (self.free_views.contains(&view), left) {
                (false, _) => self.range(view)?,
                (true, Some(range)) => range,
                (true, None) => continue,
            };
            let start = moved.place(range.buffer, range.start);
            let mut json = value(&self.views[view]);
            json["buffer"] = json!(0);
            json["byteOffset"] = json!(start);
            if self.free_views.contains(&view) {
                json["byteLength"] = json!(moved.place(range.buffer, range.end) - start);
            }
            // A stride is for vertices alone (glTF 2.0, 5.11.4); what animations read is often in views with one.
            if !of_vertices.contains(&view)
                && !strided.contains(&view)
                && self.store.document.buffer_views[view].byte_stride.is_some()
            {
                forget(&mut json, &["byteStride", "target"]);
            }
            uncompress(&mut json);
            self.views[view] = raw(&json);
        }
        for accessor in others {
            self.move_within(accessor, &rest, &moved)?;
        }
        self.free_views.retain(|&view| rest[view].is_none());
        Ok(moved.gather(self.store))
    }

    /// Returns the views with gaps between the elements of accessors other than `free`.
    fn read_in_strides(&self, free: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut found = BTreeSet::new();
        for accessor in (0..self.accessors.len()).filter(|a| !free.contains(a)) {
            let view = self.store.document.accessors.get(accessor).and_then(|a| a.buffer_view);
            let Some(view) = view.map(|view| view.value()) else { continue };
            let stride = self.store.document.buffer_views.get(view).and_then(|v| v.byte_stride);
            let width = self.store.shape(accessor).map(|shape| shape.width * shape.component.size());
            if stride.is_some_and(|stride| width.map_or(true, |width| width != stride.0)) {
                found.insert(view);
            }
        }
        found
    }

    /// Moves an accessor's offsets within views that were cut.
    fn move_within(
        &mut self,
        accessor: usize,
        rest: &[Option<Range>],
        moved: &Moved,
    ) -> Result<(), WriteError> {
        let mut json = value(&self.accessors[accessor]);
        let mut list = ranges(self.store, accessor).collect::<Vec<_>>().into_iter();
        let mut offset = |holder: &mut Value| -> Result<(), WriteError> {
            let Some((view, bytes)) = list.next() else { return Ok(()) };
            if let Some(Some(cut)) = rest.get(view).filter(|_| self.free_views.contains(&view)) {
                let old = self.range(view)?;
                let start = old.start.saturating_add(bytes.start).min(old.end);
                let offset = moved.place(cut.buffer, start) - moved.place(cut.buffer, cut.start);
                holder["byteOffset"] = json!(offset);
            }
            Ok(())
        };
        if json.get("bufferView").is_some() {
            offset(&mut json)?;
        }
        if json.get("sparse").is_some() {
            offset(&mut json["sparse"]["indices"])?;
            offset(&mut json["sparse"]["values"])?;
        }
        self.accessors[accessor] = raw(&json);
        Ok(())
    }

    /// Appends columns to the buffer, and gives them accessors and views.
    fn append(&mut self, columns: &[&Column], mut free: BTreeSet<usize>, buffer: &mut Vec<u8>) -> Vec<usize> {
        let mut index = Vec::with_capacity(columns.len());
        for column in columns {
            let old = column.old.and_then(|old| self.accessors.get(old));
            let mut json = accessor(old.map_or(json!({}), |old| value(old)), column);
            match &column.sparse {
                None => json["bufferView"] = json!(self.view(column, buffer)),
                Some(places) => {
                    let bytes: Vec<u8> = places.iter().flat_map(|place| place.to_le_bytes()).collect();
                    let [places_view, values] =
                        [&bytes, &column.bytes].map(|bytes| self.plain_view(bytes, buffer));
                    json["sparse"] = json!({
                        "count": places.len(),
                        "indices": { "bufferView": places_view, "componentType": 5125 },
                        "values": { "bufferView": values },
                    });
                }
            }
            let place = column.old.filter(|old| free.remove(old));
            index.push(put(&mut self.accessors, place, json));
        }
        // What nothing uses.
        drop_last(&mut self.accessors, &mut free);
        for accessor in free {
            let nothing = json!({ "componentType": 5126, "count": 1, "type": "SCALAR" });
            self.accessors[accessor] = raw(&nothing);
        }
        drop_last(&mut self.views, &mut self.free_views);
        for &view in &self.free_views {
            if buffer.is_empty() {
                buffer.resize(4, 0);
            }
            self.views[view] = raw(&json!({ "buffer": 0, "byteLength": 1 }));
        }
        index
    }
}

impl Packing<'_> {
    /// Appends the elements of a column, and adds their view; returns its index.
    fn view(&mut self, column: &Column, buffer: &mut Vec<u8>) -> usize {
        let view = self.plain_view(&column.bytes, buffer);
        let mut json = value(&self.views[view]);
        json["target"] = json!(if column.is_index { INDICES } else { VERTICES });
        if !column.is_index {
            json["byteStride"] = json!(column.stride);
        }
        self.views[view] = raw(&json);
        view
    }

    /// Appends bytes, and adds their view; returns its index.
    fn plain_view(&mut self, bytes: &[u8], buffer: &mut Vec<u8>) -> usize {
        buffer.resize(buffer.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": buffer.len(), "byteLength": bytes.len() });
        buffer.extend_from_slice(bytes);
        put(&mut self.views, self.free_views.pop_first(), view)
    }
}

/// Removes the last elements while they are free.
fn drop_last(elements: &mut Elements, free: &mut BTreeSet<usize>) {
    while elements.len().checked_sub(1).is_some_and(|last| free.remove(&last)) {
        elements.pop();
    }
}

/// Puts an element at a place or behind the last; returns its index.
fn put(elements: &mut Elements, place: Option<usize>, json: Value) -> usize {
    match place {
        Some(place) => elements[place] = raw(&json),
        None => elements.push(raw(&json)),
    }
    place.unwrap_or(elements.len() - 1)
}

/// Changes an accessor to the type and range of a column; its name and extras stay.
fn accessor(mut json: Value, column: &Column) -> Value {
    let component = match column.shape.component {
        ComponentType::I8 => 5120,
        ComponentType::U8 => 5121,
        ComponentType::I16 => 5122,
        ComponentType::U16 => 5123,
        ComponentType::U32 => 5125,
        ComponentType::F32 => 5126,
    };
    let kind = match column.shape.width {
        1 => "SCALAR",
        2 => "VEC2",
        3 => "VEC3",
        _ => "VEC4",
    };
    forget(&mut json, &["bufferView", "sparse", "byteOffset", "min", "max", "normalized"]);
    json["componentType"] = json!(component);
    json["count"] = json!(column.count);
    json["type"] = json!(kind);
    if column.shape.normalized {
        json["normalized"] = json!(true);
    }
    if let Some([low, high]) = &column.range {
        json["min"] = json!(low);
        json["max"] = json!(high);
    }
    json
}

fn forget(json: &mut Value, names: &[&str]) {
    if let Some(members) = json.as_object_mut() {
        names.iter().for_each(|name| {
            members.remove(*name);
        });
    }
}

/// Removes the compressed form of a view, which is not written.
fn uncompress(view: &mut Value) {
    let Some(extensions) = view.get_mut("extensions").and_then(Value::as_object_mut) else { return };
    COMPRESSED.iter().for_each(|name| {
        extensions.remove(*name);
    });
    if extensions.is_empty() {
        forget(view, &["extensions"]);
    }
}
