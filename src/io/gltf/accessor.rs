//! Values out of buffers: accessors with strides, normalised whole numbers and sparse parts (glTF 2.0, 3.6.2).
//!
//! Every range is compared with its view, and every view with its buffer, before a byte is read.

use std::borrow::Cow;

use super::document::{Accessor, Document};
use crate::io::error::ReadError;

/// How a component is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn coded(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The first value in `bytes`, which holds [`size`](Self::size) bytes at least.
    fn value(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 4];
        word[..self.size()].copy_from_slice(&bytes[..self.size()]);
        let word = u32::from_le_bytes(word);
        match self {
            Self::I8 => f64::from(word as i8),
            Self::U8 | Self::U16 | Self::U32 => f64::from(word),
            Self::I16 => f64::from(word as i16),
            Self::F32 => f64::from(f32::from_bits(word)),
        }
    }

    /// What a normalised value of 1 is stored as (glTF 2.0, 3.11).
    fn one(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::U32 | Self::F32 => 1.0,
        }
    }
}

/// The type of an accessor's elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub component: Component,
    pub normalized: bool,
    /// Components of an element.
    pub width: usize,
}

impl Shape {
    /// Whether values may be blended: floats, or whole numbers that stand for shares.
    pub fn is_float(self) -> bool {
        self.normalized || self.component == Component::F32
    }

    pub fn is_signed(self) -> bool {
        matches!(self.component, Component::I8 | Component::I16)
    }
}

/// All that accessors refer to.
pub(super) struct Store<'a> {
    pub document: &'a Document,
    buffers: &'a [Cow<'a, [u8]>],
    bytes: usize,
}

impl<'a> Store<'a> {
    pub fn new(document: &'a Document, buffers: &'a [Cow<'a, [u8]>]) -> Self {
        Self { document, buffers, bytes: buffers.iter().map(|b| b.len()).sum() }
    }

    /// Bytes of all buffers.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, ReadError> {
        let count = self.document.accessors.len();
        let missing = || ReadError::invalid(format!("accessor {index} is named, but there are {count}"));
        self.document.accessors.get(index).ok_or_else(missing)
    }

    /// Number of elements; no more than the buffers could hold, so that a count cannot make a reader reserve without limit.
    pub fn count(&self, index: usize) -> Result<usize, ReadError> {
        let count = self.accessor(index)?.count;
        let bytes = self.bytes;
        if count > bytes {
            return Err(ReadError::too_large(format!(
                "accessor {index} has {count} elements, the buffers {bytes} bytes"
            )));
        }
        Ok(count)
    }

    pub fn shape(&self, index: usize) -> Result<Shape, ReadError> {
        let accessor = self.accessor(index)?;
        let component = Component::coded(accessor.component_type).ok_or_else(|| {
            ReadError::invalid(format!("accessor {index} has component type {}", accessor.component_type))
        })?;
        let width = match accessor.shape.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => return Err(ReadError::invalid(format!("accessor {index} has type {:?}", accessor.shape))),
        };
        // Columns of small matrices are padded, which nothing that we read uses.
        if accessor.shape.starts_with("MAT") && component.size() < 4 {
            return Err(ReadError::unsupported(format!("accessor {index} is a matrix of small components")));
        }
        Ok(Shape { component, normalized: accessor.normalized, width })
    }

    /// Calls `put(element, component, value)` for every value; normalised ones are shares already.
    pub fn values(&self, index: usize, mut put: impl FnMut(usize, usize, f64)) -> Result<(), ReadError> {
        let (accessor, shape, count) = (self.accessor(index)?, self.shape(index)?, self.count(index)?);
        let size = shape.component.size();
        let mut element = |element: usize, bytes: &[u8]| {
            for (c, bytes) in bytes.chunks_exact(size).enumerate() {
                let value = shape.component.value(bytes);
                let share = if shape.normalized { (value / shape.component.one()).max(-1.0) } else { value };
                put(element, c, share);
            }
        };
        if let Some(view) = accessor.buffer_view {
            let (bytes, stride) =
                self.range(index, view, accessor.byte_offset, count, shape.width * size, true)?;
            for i in 0..count {
                element(i, &bytes[i * stride..i * stride + shape.width * size]);
            }
        }
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let kind = Component::coded(sparse.indices.component_type)
            .filter(|k| matches!(k, Component::U8 | Component::U16 | Component::U32));
        let kind = kind.ok_or_else(|| {
            ReadError::invalid(format!("accessor {index} has sparse indices of no index type"))
        })?;
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset);
        let (places, _) = self.range(index, view, offset, sparse.count, kind.size(), false)?;
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset);
        let (values, _) = self.range(index, view, offset, sparse.count, shape.width * size, false)?;
        for (place, value) in places.chunks_exact(kind.size()).zip(values.chunks_exact(shape.width * size)) {
            let place = kind.value(place) as usize;
            if place >= count {
                return Err(ReadError::invalid(format!(
                    "accessor {index} has a sparse index {place} beyond its {count}"
                )));
            }
            element(place, value);
        }
        Ok(())
    }

    /// The bytes of `count` elements of `size` bytes, and the step from one to the next.
    fn range(
        &self,
        accessor: usize,
        view: usize,
        offset: usize,
        count: usize,
        size: usize,
        strided: bool,
    ) -> Result<(&'a [u8], usize), ReadError> {
        let found = self.document.buffer_views.get(view);
        let found = found.ok_or_else(|| {
            ReadError::invalid(format!("accessor {accessor} names buffer view {view}, which is not there"))
        })?;
        let buffer = self.buffers.get(found.buffer);
        let buffer = buffer.ok_or_else(|| {
            ReadError::invalid(format!(
                "buffer view {view} names buffer {}, which is not there",
                found.buffer
            ))
        })?;
        let bytes = buffer.get(found.byte_offset..).and_then(|rest| rest.get(..found.byte_length));
        let bytes = bytes.ok_or_else(|| {
            ReadError::invalid(format!("buffer view {view} reaches beyond buffer {}", found.buffer))
        })?;
        let stride = found.byte_stride.filter(|_| strided).unwrap_or(size);
        if stride < size {
            return Err(ReadError::invalid(format!(
                "buffer view {view} has a stride of {stride} for elements of {size} bytes"
            )));
        }
        let length = if count == 0 {
            Some(0)
        } else {
            (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size))
        };
        let range = length.and_then(|length| bytes.get(offset..)?.get(..length));
        let beyond = || ReadError::invalid(format!("accessor {accessor} reaches beyond buffer view {view}"));
        Ok((range.ok_or_else(beyond)?, stride))
    }
}
