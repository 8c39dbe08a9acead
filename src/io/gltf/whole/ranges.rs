//! Ranges of buffers: which an accessor reads, and where they come to lie.

use gltf_json::validation::Checked;

use crate::io::gltf::accessor::Store;
use crate::io::gltf::document::size;

/// A range of a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Range {
    pub buffer: usize,
    pub start: usize,
    pub end: usize,
}

/// Returns the views of an accessor, each with the bytes within it: values, sparse indices, sparse values.
pub(super) fn ranges(
    store: &Store,
    accessor: usize,
) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> {
    let found = store.document.accessors.get(accessor);
    let kind = found.and_then(|a| match (a.component_type, a.type_) {
        (Checked::Valid(component), Checked::Valid(kind)) => Some((component.0, kind)),
        _ => None,
    });
    let view_stride = |view: usize, width: usize| {
        let stride = store.document.buffer_views.get(view).and_then(|v| v.byte_stride);
        stride.map_or(width, |stride| stride.0.max(width))
    };
    let list = found.zip(kind).map(|(a, (component, kind))| {
        // Columns of matrices start at multiples of 4 bytes: 24 bytes at most (a matrix of 3 columns of 3 small numbers).
        let width = (kind.multiplicity() * component.size()).max(match kind.multiplicity() {
            9 => 3 * (3 * component.size()).next_multiple_of(4),
            _ => 0,
        });
        let mut list = Vec::new();
        if let Some(view) = a.buffer_view {
            let (view, start, count) = (view.value(), a.byte_offset.map_or(0, size), size(a.count));
            let length = count.saturating_sub(1).saturating_mul(view_stride(view, width));
            list.push((view, start..start.saturating_add(length).saturating_add(width)));
        }
        if let Some(sparse) = &a.sparse {
            let count = size(sparse.count);
            let index = match sparse.indices.component_type {
                Checked::Valid(kind) => kind.0.size(),
                Checked::Invalid => 4,
            };
            let parts = [
                (sparse.indices.buffer_view, size(sparse.indices.byte_offset), index),
                (sparse.values.buffer_view, size(sparse.values.byte_offset), width),
            ];
            list.extend(parts.map(|(view, start, width)| {
                (view.value(), start..start.saturating_add(count.saturating_mul(width)))
            }));
        }
        list
    });
    list.unwrap_or_default().into_iter()
}

/// Ranges of old buffers, and their places in the new one.
pub(super) struct Moved {
    /// Disjoint, in order, with the start in the new buffer.
    ranges: Vec<(Range, usize)>,
}

impl Moved {
    /// Joins ranges that overlap. Offsets keep their remainder by 4.
    pub fn new(mut kept: Vec<Range>) -> Self {
        kept.iter_mut().for_each(|range| range.start &= !3);
        kept.sort_unstable();
        let mut ranges: Vec<(Range, usize)> = Vec::new();
        for range in kept {
            match ranges.last_mut() {
                Some((last, _)) if last.buffer == range.buffer && range.start <= last.end => {
                    last.end = last.end.max(range.end);
                }
                _ => ranges.push((range, 0)),
            }
        }
        let mut end: usize = 0;
        for (range, start) in &mut ranges {
            *start = end.next_multiple_of(4);
            end = *start + (range.end - range.start);
        }
        Self { ranges }
    }

    /// Returns the new place of an offset within a kept range.
    pub fn place(&self, buffer: usize, offset: usize) -> usize {
        let after = self.ranges.partition_point(|(range, _)| (range.buffer, range.start) <= (buffer, offset));
        let found = after.checked_sub(1).and_then(|i| self.ranges.get(i));
        found.map_or(0, |(range, start)| start + (offset - range.start))
    }

    /// Returns the bytes of all ranges.
    pub fn gather(&self, store: &Store) -> Vec<u8> {
        let mut buffer = Vec::new();
        for (range, start) in &self.ranges {
            buffer.resize(*start, 0);
            let bytes = store.buffers().get(range.buffer).map_or(&[][..], |bytes| &bytes[..]);
            buffer.extend_from_slice(bytes.get(range.start..range.end).unwrap_or_default());
        }
        buffer
    }
}
