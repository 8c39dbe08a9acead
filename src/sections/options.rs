//! How files are written and opened.

/// How a baked file is written. Equal models and equal options give equal bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct BakeOptions {
    /// How large sections are compressed; default [`Compression::None`].
    pub compression: Compression,
    /// Whether arrays that follow from others are written too, so that they need not be derived while opening: of a
    /// hierarchy 28 bytes a vertex, of a g-mesh all levels but the finest. Default true; compressed files are written
    /// without.
    pub derived: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self { compression: Compression::None, derived: true }
    }
}

impl BakeOptions {
    /// Sets the compression. Compressed arrays are copied while opening; all others are used in place.
    #[must_use]
    pub fn with_compression(mut self, compression: Compression) -> Self {
        self.compression = compression;
        self
    }

    /// Sets whether arrays that follow from others are written.
    #[must_use]
    pub fn with_derived(mut self, derived: bool) -> Self {
        self.derived = derived;
        self
    }

    /// Whether arrays that follow from others are written.
    pub(crate) fn writes_derived(self) -> bool {
        self.derived && self.compression == Compression::None
    }
}

/// Compression of the large sections of a baked file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Compression {
    /// None: sections are used in place.
    #[default]
    None,
    /// Differences in planes of bits, by LZ4, chunk by chunk: less than half the size. Opening copies the arrays.
    Lz4,
}

/// How a baked file is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct OpenOptions {
    /// Whether the content is checked; default [`Trust::Checked`].
    pub trust: Trust,
}

impl OpenOptions {
    /// Sets the trust.
    #[must_use]
    pub fn with_trust(mut self, trust: Trust) -> Self {
        self.trust = trust;
        self
    }
}

/// Whether the content of a baked file is checked while it is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Trust {
    /// Every checksum and every invariant of the structure. A file that opens is a structure that never panics and never
    /// loops without end. O(n): reads all of the file.
    #[default]
    Checked,
    /// For files that you wrote yourself, unchanged. Checked are header and table with their checksum, and the lengths of
    /// the arrays against each other. *Not* checked are checksums of sections, ranges of indices and all other invariants.
    /// O(sections) for arrays used in place; pages of the file are read as they are needed.
    ///
    /// A damaged file may then open, draw a wrong mesh, panic, or never return from a call, at any time. It causes no
    /// undefined behaviour: this crate has no unsafe code.
    Own,
}
