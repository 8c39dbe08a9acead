//! Sections out of bytes, in place where the bytes are shared.

use serde::de::DeserializeOwned;

use crate::geometry::array::{Array, SharedBytes};
use crate::geometry::parallel;

use super::table::{self, Entry, LZ4, PLAIN, checksum};
use super::{BakeError, Element, OpenOptions, Trust, codec, layout};

/// A baked file whose header and table are checked.
pub struct Reader<'a> {
    bytes: &'a [u8],
    /// The holder of the bytes, for arrays used in place; without one, arrays are copied.
    shared: Option<&'a SharedBytes>,
    entries: Vec<Entry>,
    /// Indices of the entries by name.
    by_name: Vec<usize>,
    trust: Trust,
}

impl<'a> Reader<'a> {
    /// Reads header and table of a file, and checks the checksums of all sections unless trusted.
    ///
    /// # Errors
    /// The bytes are no baked file of this version, or damaged.
    pub fn new(bytes: &'a [u8], options: OpenOptions) -> Result<Self, BakeError> {
        let entries = table::decode(bytes)?;
        let mut by_name: Vec<usize> = (0..entries.len()).collect();
        by_name.sort_unstable_by(|&a, &b| entries[a].name.cmp(&entries[b].name));
        let reader = Self { bytes, shared: None, entries, by_name, trust: options.trust };
        if !reader.is_trusted() {
            reader.check_sums()?;
        }
        Ok(reader)
    }

    /// As [`Reader::new`], for arrays within the shared bytes.
    ///
    /// # Errors
    /// As [`Reader::new`].
    pub(crate) fn shared(bytes: &'a SharedBytes, options: OpenOptions) -> Result<Self, BakeError> {
        Ok(Self { shared: Some(bytes), ..Self::new((**bytes).as_ref(), options)? })
    }

    /// Whether the content is not to be checked.
    pub fn is_trusted(&self) -> bool {
        self.trust == Trust::Own
    }

    /// Checks the checksums of all sections, and the zeros between them.
    fn check_sums(&self) -> Result<(), BakeError> {
        let is_whole = |entry: &Entry| checksum(&self.bytes[entry.range()]) == entry.checksum;
        let whole = parallel::map_items(&self.entries, is_whole);
        if let Some(at) = whole.iter().position(|whole| !whole) {
            let name = &self.entries[at].name;
            return Err(BakeError::damaged(format!("section {name:?}: its checksum does not fit")));
        }
        let ends = self.entries.iter().map(|entry| entry.range().end);
        let mut gaps = ends.zip(self.entries.iter().skip(1).map(|entry| entry.offset));
        match gaps.any(|(end, start)| self.bytes[end..start].iter().any(|&byte| byte != 0)) {
            true => Err(BakeError::damaged("there are bytes between sections")),
            false => Ok(()),
        }
    }

    fn find(&self, name: &str) -> Option<&Entry> {
        let at = self.by_name.binary_search_by(|&at| self.entries[at].name.as_str().cmp(name)).ok()?;
        self.entries.get(self.by_name[at])
    }

    /// Whether there is a section of this name.
    pub fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    fn needed(&self, name: &str) -> Result<&Entry, BakeError> {
        self.find(name).ok_or_else(|| BakeError::Missing { section: name.to_owned() })
    }

    /// Returns a small value.
    ///
    /// # Errors
    /// There is no such section, or it does not hold such a value.
    pub fn meta<T: DeserializeOwned>(&self, name: &str) -> Result<T, BakeError> {
        let entry = self.needed(name)?;
        if entry.codec != PLAIN || entry.element != 1 {
            return Err(BakeError::damaged(format!("section {name:?} is an array")));
        }
        super::decode(&self.bytes[entry.range()])
    }

    /// Returns an array, empty if there is no such section.
    ///
    /// # Errors
    /// The section holds elements of another size, or is damaged.
    pub(crate) fn array_if_any<T: Element>(&self, name: &str) -> Result<Array<T>, BakeError> {
        if self.has(name) { self.array(name) } else { Ok(Array::default()) }
    }

    /// Returns an array: within the shared bytes if it is aligned there and not compressed, else a copy.
    ///
    /// # Errors
    /// There is no such section, it holds elements of another size, or it is damaged.
    pub(crate) fn array<T: Element>(&self, name: &str) -> Result<Array<T>, BakeError> {
        let entry = self.needed(name)?;
        let damaged = |what: &str| BakeError::damaged(format!("section {name:?}: {what}"));
        if entry.element != size_of::<T>() {
            return Err(damaged(&format!("elements have {} bytes, not {}", entry.element, size_of::<T>())));
        }
        let stored = &self.bytes[entry.range()];
        match (entry.codec, self.shared) {
            (PLAIN, Some(shared)) if cfg!(target_endian = "little") => {
                if let Some(array) = Array::within(shared, entry.range()) {
                    return Ok(array);
                }
            }
            (PLAIN | LZ4, _) => {}
            _ => return Err(damaged("its codec is of a later version")),
        }
        let mut elements = vec![T::zeroed(); entry.plain / size_of::<T>()];
        if entry.codec == LZ4 {
            codec::decompress(stored, &mut elements)?;
        } else {
            let bytes = bytemuck::cast_slice_mut(&mut elements);
            bytes.copy_from_slice(stored);
            layout::to_native(bytes, T::SCALARS);
        }
        Ok(elements.into())
    }
}
