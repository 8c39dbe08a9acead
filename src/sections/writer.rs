//! Sections into bytes.

use serde::Serialize;

use super::table::{self, Entry, HEADER, LZ4, PLAIN, aligned, checksum};
use super::{BakeError, BakeOptions, Compression, Element, codec, layout};

/// Sections shorter than this are never compressed.
const SMALL: usize = 256;

/// Gathers the sections of a file.
#[derive(Debug)]
pub struct Writer {
    options: BakeOptions,
    entries: Vec<Entry>,
    /// The sections, each at a multiple of 64 bytes.
    body: Vec<u8>,
}

impl Writer {
    /// Starts a file.
    pub fn new(options: BakeOptions) -> Self {
        Self { options, entries: Vec::new(), body: Vec::new() }
    }

    /// Whether arrays that follow from others are to be written.
    pub fn writes_derived(&self) -> bool {
        self.options.writes_derived()
    }

    /// Adds an array.
    pub fn array<T: Element>(&mut self, name: &str, elements: &[T]) {
        let mut swapped = Vec::new();
        let bytes = if cfg!(target_endian = "big") {
            swapped.extend_from_slice(bytemuck::cast_slice(elements));
            layout::to_native(&mut swapped, T::SCALARS);
            &swapped[..]
        } else {
            bytemuck::cast_slice(elements)
        };
        let packed = match self.options.compression {
            Compression::Lz4 if bytes.len() >= SMALL => codec::compress(bytes, T::SCALARS),
            _ => None,
        };
        match packed {
            Some(packed) => self.section(name, &packed, bytes.len(), size_of::<T>(), LZ4),
            None => self.section(name, bytes, bytes.len(), size_of::<T>(), PLAIN),
        }
    }

    /// Adds an array unless it is empty.
    pub fn array_if_any<T: Element>(&mut self, name: &str, elements: &[T]) {
        if !elements.is_empty() {
            self.array(name, elements);
        }
    }

    /// Adds a small value.
    ///
    /// # Errors
    /// The value cannot be serialised.
    pub fn meta<T: Serialize>(&mut self, name: &str, value: &T) -> Result<(), BakeError> {
        let mut bytes = Vec::new();
        super::encode(value, &mut bytes)?;
        self.section(name, &bytes, bytes.len(), 1, PLAIN);
        Ok(())
    }

    fn section(&mut self, name: &str, stored: &[u8], plain: usize, element: usize, codec: u32) {
        debug_assert!(super::is_kind(name));
        self.body.resize(aligned(self.body.len()), 0);
        let offset = self.body.len();
        self.body.extend_from_slice(stored);
        let (name, stored, checksum) = (name.to_owned(), stored.len(), checksum(stored));
        self.entries.push(Entry { name, offset, stored, plain, checksum, element, codec });
    }

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// `kind` is not 1 to 16 printable ASCII characters.
    pub fn finish(mut self, kind: &str) -> Result<Vec<u8>, BakeError> {
        if !super::is_kind(kind) {
            return Err(BakeError::BadKind { kind: kind.to_owned() });
        }
        let start = HEADER * (1 + self.entries.len());
        self.entries.iter_mut().for_each(|entry| entry.offset += start);
        let length = start + self.body.len();
        let mut bytes = table::encode(kind, &self.entries, length);
        bytes.append(&mut self.body);
        Ok(bytes)
    }
}
