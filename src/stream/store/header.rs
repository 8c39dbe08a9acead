//! The header of a store: its coarsest mesh, and of every page its place and bounds.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::geometry::array::{Array, SharedBytes};
use crate::lod::{LodOptions, Vertex};
use crate::sections::{OpenOptions, Reader, Writer};
use crate::view::Bounds;

use super::super::client::StreamVertex;
use super::super::header::Header;
use super::page::{Frame, Name, PAGE, Page, share};
use super::{StoreError, StoreLod};

/// Kind of a header, as a baked file.
pub(super) const KIND: &str = "store";
/// Bytes of a baked file that tell its length.
const START: usize = 64;

/// Section `store`.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Head {
    /// A name of the content, for its pages.
    pub id: u64,
    /// Diagonal of the model's box, object units.
    pub diagonal: f64,
    /// Whether a split has dependencies besides its parents.
    pub has_dependencies: bool,
}

/// What a store tells before any page.
#[derive(Debug)]
pub(super) struct Shared {
    pub head: Head,
    pub header: Header,
    /// Per vertex of the coarsest mesh, its first leaf.
    pub first_leaf: Array<u32>,
    /// Bits of their scalars, scalar by scalar.
    pub scalars: Array<u32>,
    /// Leaves of the triangles of the coarsest mesh, and their groups.
    pub triangles: Array<[u32; 3]>,
    pub group_of: Array<u16>,
    /// Splits without parents.
    pub roots: Array<u32>,
    /// Bounds of all splits of a page.
    pub page_bounds: Array<Bounds>,
    /// Where every page starts in the file behind the header, and the end of the last.
    pub page_at: Array<u64>,
    /// Per page, its vertices, its triangles, and its bytes in memory.
    pub page_sizes: Array<[u32; 3]>,
    /// Bytes of the header in the file.
    pub length: u64,
}

impl Shared {
    /// Writes the header's bytes. `length` is not written.
    pub fn write(&self) -> Result<Vec<u8>, StoreError> {
        let mut to = Writer::new(Default::default());
        to.meta("store", &self.head)?;
        let mut header = Vec::new();
        self.header.write(&mut header);
        to.array("stream", &header);
        to.array("base.first_leaf", &self.first_leaf);
        to.array("base.scalars", &self.scalars);
        to.array("base.triangles", &self.triangles);
        to.array_if_any("base.group_of", &self.group_of);
        to.array("roots", &self.roots);
        to.array("page.bounds", &self.page_bounds);
        to.array("page.at", &self.page_at);
        to.array("page.sizes", &self.page_sizes);
        Ok(to.finish(KIND)?)
    }

    /// Reads and checks the header of a store of so many bytes.
    fn read(bytes: &SharedBytes, store: u64) -> Result<Self, StoreError> {
        let from = Reader::shared(bytes, OpenOptions::default())?;
        let length = (**bytes).as_ref().len() as u64;
        let header = Header::read(&from.array::<u8>("stream")?)?;
        let shared = Self {
            head: from.meta("store")?,
            header,
            first_leaf: from.array("base.first_leaf")?,
            scalars: from.array("base.scalars")?,
            triangles: from.array("base.triangles")?,
            group_of: from.array_if_any("base.group_of")?,
            roots: from.array("roots")?,
            page_bounds: from.array("page.bounds")?,
            page_at: from.array("page.at")?,
            page_sizes: from.array("page.sizes")?,
            length,
        };
        match shared.find_fault(store) {
            Some(what) => Err(StoreError::Damaged { what }),
            None => Ok(shared),
        }
    }

    /// Returns what is wrong with the arrays, for a store of so many bytes.
    fn find_fault(&self, store: u64) -> Option<&'static str> {
        let Header { leaves, splits, base_vertices, base_triangles, .. } = self.header;
        let pages = splits.div_ceil(PAGE) as usize;
        let groups = self.frame().groups;
        let ends = || self.page_at.windows(2);
        let starts_at_0 = self.first_leaf.first().is_none_or(|&first| first == 0);
        match () {
            () if !(0.0..1e30).contains(&self.head.diagonal) => Some("the diagonal is not a length"),
            () if self.first_leaf.len() != base_vertices as usize
                || !starts_at_0
                || self.first_leaf.windows(2).any(|pair| pair[0] >= pair[1])
                || self.first_leaf.last().is_some_and(|&last| last >= leaves) =>
            {
                Some("vertices of the coarsest mesh are not in order")
            }
            () if self.scalars.len() != self.frame().channels * self.first_leaf.len() => {
                Some("vertices have another number of scalars")
            }
            () if self.triangles.len() != base_triangles as usize
                || self.triangles.as_flattened().iter().any(|&leaf| leaf >= leaves) =>
            {
                Some("a triangle is of no leaf")
            }
            () if self.group_of.len() != if groups > 1 { self.triangles.len() } else { 0 }
                || self.group_of.iter().any(|&group| u32::from(group) >= groups) =>
            {
                Some("a triangle is of no group")
            }
            () if self.roots.iter().any(|&root| root >= splits) => Some("a root is no split"),
            () if self.page_bounds.len() != pages
                || self.page_sizes.len() != pages
                || self.page_at.len() != pages + 1
                || self.page_at[0] != 0
                || self.page_at[pages] != store.saturating_sub(self.length)
                || ends().any(|ends| ends[0] > ends[1]) =>
            {
                Some("the table of pages does not fit the store")
            }
            // The sections of a page alone take more: what is declared is there.
            () if ends().any(|ends| ends[1] - ends[0] < u64::from(PAGE / 2)) => Some("a page is too short"),
            () => None,
        }
    }

    /// Returns what a page must keep to.
    pub fn frame(&self) -> Frame {
        Frame {
            splits: self.header.splits,
            leaves: self.header.leaves,
            has_dependencies: self.head.has_dependencies,
            groups: self.header.materials.len().max(1) as u32,
            channels: self.header.layout.len(),
        }
    }

    /// Reads a page.
    pub fn page(&self, page: u32, bytes: Vec<u8>) -> Result<Page, StoreError> {
        let pages = self.page_sizes.len() as u32;
        let Some(sizes) = self.page_sizes.get(page as usize) else {
            return Err(StoreError::NoPage { page, pages });
        };
        let read = Page::read(&share(bytes), &Name { store: self.head.id, page }, self.frame())?;
        if read.sizes() != *sizes {
            return Err(StoreError::Damaged { what: "a page has other sizes than the header tells" });
        }
        Ok(read)
    }

    /// Appends the bits of the scalars of a vertex of the coarsest mesh.
    pub fn words(&self, vertex: u32, words: &mut Vec<u32>) {
        words.extend(self.scalars.iter().skip(vertex as usize).step_by(self.first_leaf.len()));
    }
}

/// A model in pages, opened: its coarsest mesh, and where its pages are. Clones share everything.
///
/// ```
/// use std::io::Cursor;
/// use multires::prelude::*;
/// use multires::stream::store::{Store, StoreOptions, write_store};
/// use multires::{mesh::shapes, view::look_at};
///
/// let model = VertexHierarchy::bake(&shapes::rock(20_000, 1))?;
/// let mut file = Vec::new(); // or a File
/// write_store(&model, &StoreOptions::default(), &mut file)?;
///
/// let mut file = Cursor::new(file);
/// let store = Store::open(&mut file)?;
/// let mut lod = store.instance(1 << 20, &LodOptions::default(), |vertex| vertex.position());
/// let camera = look_at([0.0, 0.0, 1.5], [0.0; 3], [0.0, 1.0, 0.0]);
/// let view = View::perspective(camera, 1.0, [1920, 1080])?.of_world();
/// for _ in 0..40 {
///     lod.adapt(&[view.clone()], 1.0 / 60.0);
///     lod.fetch(&mut file, 1 << 18)?; // or: hand `wanted` to threads, and `supply` what they read
///     lod.clean();
/// }
/// assert!(lod.wanted().is_empty() && lod.triangles(0).len() > 1_000);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Store(pub(super) Arc<Shared>);

impl Store {
    /// Opens a store in a file, or in anything else with ranges. Reads its header.
    ///
    /// # Errors
    /// Reading fails; the bytes are no store, or damaged.
    pub fn open(from: &mut (impl Read + Seek)) -> Result<Self, StoreError> {
        let length = from.seek(SeekFrom::End(0))?;
        let start = read_range(from, 0..length.min(START as u64))?;
        let header = Self::header_length(&start)?;
        Self::from_header(read_range(from, 0..header.min(length))?, length)
    }

    /// Returns the bytes of the header, of which the first 64 tell its length.
    ///
    /// # Errors
    /// These are not the first bytes of a store.
    pub fn header_length(start: &[u8]) -> Result<u64, StoreError> {
        if crate::sections::kind_of(start)? != KIND || start.len() < START {
            return Err(StoreError::Damaged { what: "this is no store" });
        }
        Ok(u64::from_le_bytes(std::array::from_fn(|at| start[32 + at])))
    }

    /// Opens a store by its header. `length` is the length of the whole store, bytes.
    ///
    /// # Errors
    /// The bytes are no header of a store of this length, or damaged.
    pub fn from_header(header: Vec<u8>, length: u64) -> Result<Self, StoreError> {
        Ok(Self(Arc::new(Shared::read(&share(header), length)?)))
    }

    /// Creates an instance, at the coarsest mesh. `cache` is what its pages may take in memory, bytes; `make` makes the vertices to be
    /// drawn. Of the options, the geomorph and the buffer do not count: vertices are packed, and do not move.
    pub fn instance<V: Vertex, F: FnMut(StreamVertex<'_>) -> V>(
        &self,
        cache: usize,
        options: &LodOptions,
        make: F,
    ) -> StoreLod<V, F> {
        StoreLod::new(Arc::clone(&self.0), cache, options, make)
    }

    /// Returns the number of pages.
    pub fn page_count(&self) -> usize {
        self.0.page_sizes.len()
    }

    /// Returns where the bytes of a page are in the store; `None` if there is no such page.
    pub fn page_range(&self, page: u32) -> Option<Range<u64>> {
        let start = *self.0.page_at.get(page as usize)?;
        let end = *self.0.page_at.get(page as usize + 1)?;
        Some(self.0.length + start..self.0.length + end)
    }

    /// Returns the number of triangles at full resolution.
    pub fn full_triangles(&self) -> usize {
        self.0.header.triangles as usize
    }

    /// Returns the smallest and largest corner of the box around the model, object units.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        self.0.header.extent
    }

    /// Returns the bytes of what instances share.
    pub fn memory(&self) -> usize {
        let shared = &*self.0;
        size_of_val(&shared.first_leaf[..])
            + size_of_val(&shared.scalars[..])
            + size_of_val(&shared.triangles[..])
            + size_of_val(&shared.group_of[..])
            + size_of_val(&shared.roots[..])
            + size_of_val(&shared.page_bounds[..])
            + size_of_val(&shared.page_at[..])
            + size_of_val(&shared.page_sizes[..])
    }
}

/// Reads a range of bytes.
pub(super) fn read_range(from: &mut (impl Read + Seek), range: Range<u64>) -> Result<Vec<u8>, StoreError> {
    from.seek(SeekFrom::Start(range.start))?;
    let mut bytes = Vec::new();
    from.take(range.end - range.start).read_to_end(&mut bytes)?;
    Ok(bytes)
}
