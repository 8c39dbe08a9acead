//! Reading values from buffers: accessors with strides, normalised integers and sparse parts (glTF 2.0, 3.6.2).
//!
//! Checks each range against its view, and each view against its buffer, before reading a byte.

use std::borrow::Cow;

use gltf_json::Accessor;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

use super::document::{Document, size};
use crate::io::error::ReadError;

/// Returns the first value in `bytes`; `bytes` holds at least one component.
fn value(kind: ComponentType, bytes: &[u8]) -> f64 {
    let mut word = [0; 4];
    word[..kind.size()].copy_from_slice(&bytes[..kind.size()]);
    let word = u32::from_le_bytes(word);
    match kind {
        ComponentType::I8 => f64::from(word as i8),
        ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => f64::from(word),
        ComponentType::I16 => f64::from(word as i16),
        ComponentType::F32 => f64::from(f32::from_bits(word)),
    }
}

/// Returns the stored integer of a normalised value of 1 (glTF 2.0, 3.11).
pub(super) fn one(kind: ComponentType) -> f64 {
    match kind {
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32_767.0,
        ComponentType::U16 => 65_535.0,
        ComponentType::U32 | ComponentType::F32 => 1.0,
    }
}

/// Most elements of an accessor that are not stored.
const NOT_STORED: usize = 1 << 20;

/// The type of an accessor's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub component: ComponentType,
    pub normalized: bool,
    /// Components per element.
    pub width: usize,
}

impl Shape {
    /// Tests if values may be interpolated: floats, or normalised integers.
    pub fn is_float(self) -> bool {
        self.normalized || self.component == ComponentType::F32
    }

    pub fn is_signed(self) -> bool {
        matches!(self.component, ComponentType::I8 | ComponentType::I16)
    }
}

/// The document and the buffers accessors refer to.
pub(super) struct Store<'a> {
    pub document: &'a Document,
    buffers: &'a [Cow<'a, [u8]>],
    bytes: usize,
}

impl<'a> Store<'a> {
    pub fn new(document: &'a Document, buffers: &'a [Cow<'a, [u8]>]) -> Self {
        Self { document, buffers, bytes: buffers.iter().map(|b| b.len()).sum() }
    }

    /// Returns the total size of all buffers, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the buffers.
    pub fn buffers(&self) -> &'a [Cow<'a, [u8]>] {
        self.buffers
    }

    pub fn accessor(&self, index: usize) -> Result<&'a Accessor, ReadError> {
        let count = self.document.accessors.len();
        let missing = || ReadError::invalid(format!("accessor {index} is named, but there are {count}"));
        self.document.accessors.get(index).ok_or_else(missing)
    }

    /// Returns the number of elements. Rejects a count above the bytes of all buffers, so a count cannot cause
    /// unlimited memory use; elements that are not stored (0 unless a sparse part replaces them) may be a million.
    pub fn count(&self, index: usize) -> Result<usize, ReadError> {
        let accessor = self.accessor(index)?;
        let (count, bytes) = (size(accessor.count), self.bytes);
        let most = if accessor.buffer_view.is_some() { bytes } else { bytes.max(NOT_STORED) };
        if count > most {
            return Err(ReadError::too_large(format!(
                "accessor {index} has {count} elements, the buffers {bytes} bytes"
            )));
        }
        Ok(count)
    }

    /// Returns the number of elements replaced by a sparse part; work that [`count`](Self::count) does not bound.
    pub fn replaced(&self, index: usize) -> usize {
        let sparse = self.document.accessors.get(index).and_then(|a| a.sparse.as_ref());
        sparse.map_or(0, |sparse| size(sparse.count))
    }

    pub fn shape(&self, index: usize) -> Result<Shape, ReadError> {
        let accessor = self.accessor(index)?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_)
        else {
            return Err(ReadError::invalid(format!("accessor {index} is of a type that glTF does not have")));
        };
        let (component, width) = (component.0, kind.multiplicity());
        // Columns of matrices with small components are padded; this reader needs no such matrix.
        if matches!(kind, Type::Mat2 | Type::Mat3 | Type::Mat4) && component.size() < 4 {
            return Err(ReadError::unsupported(format!("accessor {index} is a matrix of small components")));
        }
        Ok(Shape { component, normalized: accessor.normalized, width })
    }

    /// Calls `put(element, component, value)` for every value; normalised integers are converted to floats.
    pub fn values(&self, index: usize, mut put: impl FnMut(usize, usize, f64)) -> Result<(), ReadError> {
        let (accessor, shape, count) = (self.accessor(index)?, self.shape(index)?, self.count(index)?);
        let component = shape.component.size();
        let mut element = |element: usize, bytes: &[u8]| {
            for (c, bytes) in bytes.chunks_exact(component).enumerate() {
                let value = value(shape.component, bytes);
                let share = if shape.normalized { (value / one(shape.component)).max(-1.0) } else { value };
                put(element, c, share);
            }
        };
        let bytes = shape.width * component;
        if let Some(view) = accessor.buffer_view {
            let offset = accessor.byte_offset.map_or(0, size);
            let (values, stride) = self.range(index, view.value(), offset, count, bytes, true)?;
            for i in 0..count {
                element(i, &values[i * stride..i * stride + bytes]);
            }
        }
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(ReadError::invalid(format!("accessor {index} has sparse indices of no index type")));
        };
        let (kind, replaced) = (kind.0, size(sparse.count));
        let (view, offset) = (sparse.indices.buffer_view.value(), size(sparse.indices.byte_offset));
        let (places, _) = self.range(index, view, offset, replaced, kind.size(), false)?;
        let (view, offset) = (sparse.values.buffer_view.value(), size(sparse.values.byte_offset));
        let (values, _) = self.range(index, view, offset, replaced, bytes, false)?;
        for (place, replacement) in places.chunks_exact(kind.size()).zip(values.chunks_exact(bytes)) {
            let place = value(kind, place) as usize;
            if place >= count {
                return Err(ReadError::invalid(format!(
                    "accessor {index} has a sparse index {place} beyond its {count}"
                )));
            }
            element(place, replacement);
        }
        Ok(())
    }

    /// Returns the bytes of `count` elements of `width` bytes, and the stride between elements.
    fn range(
        &self,
        accessor: usize,
        view: usize,
        offset: usize,
        count: usize,
        width: usize,
        strided: bool,
    ) -> Result<(&'a [u8], usize), ReadError> {
        let found = self.document.buffer_views.get(view);
        let found = found.ok_or_else(|| {
            ReadError::invalid(format!("accessor {accessor} names buffer view {view}, which is not there"))
        })?;
        let buffer = self.buffers.get(found.buffer.value());
        let buffer = buffer.ok_or_else(|| {
            ReadError::invalid(format!(
                "buffer view {view} names buffer {}, which is not there",
                found.buffer.value()
            ))
        })?;
        let start = found.byte_offset.map_or(0, size);
        let bytes = buffer.get(start..).and_then(|rest| rest.get(..size(found.byte_length)));
        let bytes = bytes.ok_or_else(|| {
            ReadError::invalid(format!("buffer view {view} reaches beyond buffer {}", found.buffer.value()))
        })?;
        let stride = found.byte_stride.filter(|_| strided).map_or(width, |stride| stride.0);
        if stride < width {
            return Err(ReadError::invalid(format!(
                "buffer view {view} has a stride of {stride} for elements of {width} bytes"
            )));
        }
        let length = if count == 0 {
            Some(0)
        } else {
            (count - 1).checked_mul(stride).and_then(|n| n.checked_add(width))
        };
        let range = length.and_then(|length| bytes.get(offset..)?.get(..length));
        let beyond = || ReadError::invalid(format!("accessor {accessor} reaches beyond buffer view {view}"));
        Ok((range.ok_or_else(beyond)?, stride))
    }
}
