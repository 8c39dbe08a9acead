//! A store out of a model.

use std::io::Write;

use twox_hash::XxHash3_64;

use crate::adapt::Refinements;
use crate::geometry::parallel;
use crate::hierarchy::VertexHierarchy;
use crate::lod::Baked;
use crate::sections::{BakeOptions, Compression};

use super::super::channels::Layout;
use super::super::header::Header;
use super::super::server::StreamOptions;
use super::super::tables::Tables;
use super::StoreError;
use super::header::{Head, Shared};
use super::order::Order;
use super::page::{Name, PAGE, Page};

/// Pages that are gathered before they are written.
const BATCH: u32 = 64;

/// How a store is written. Defaults: exact scalars, pages compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct StoreOptions {
    /// Bits of the scalars of vertices; default [`StreamOptions::exact`]. Fewer bits make smaller pages.
    pub scalars: StreamOptions,
    /// Compression of pages; default [`Compression::Lz4`]. Pages without compression are used where they lie.
    pub compression: Compression,
}

impl Default for StoreOptions {
    fn default() -> Self {
        Self { scalars: StreamOptions::exact(), compression: Compression::Lz4 }
    }
}

impl StoreOptions {
    /// Sets the bits of the scalars of vertices.
    #[must_use]
    pub fn with_scalars(mut self, scalars: StreamOptions) -> Self {
        self.scalars = scalars;
        self
    }

    /// Sets the compression of pages.
    #[must_use]
    pub fn with_compression(mut self, compression: Compression) -> Self {
        self.compression = compression;
        self
    }
}

/// Writes a model in pages. Equal models and equal options give equal bytes. O(n log n); takes the bytes of the store in memory.
///
/// # Errors
/// An option is out of its range, or writing fails.
pub fn write_store(
    model: &Baked<VertexHierarchy>,
    options: &StoreOptions,
    to: &mut impl Write,
) -> Result<(), StoreError> {
    options.scalars.check()?;
    let of = &**model.structure();
    let vertices = model.vertices();
    let layout = Layout::new(vertices, options.scalars.position_bits, options.scalars.attribute_bits);
    let channels = layout.len();
    let mut words = layout.numbers(vertices);
    for scalars in words.chunks_exact_mut(channels) {
        for (word, channel) in scalars.iter_mut().zip(&layout.channels) {
            *word = channel.word(*word);
        }
    }
    // The bounds too: models of equal vertices and triangles may have other splits.
    let id = XxHash3_64::oneshot(bytemuck::cast_slice(&words));
    let id = XxHash3_64::oneshot_with_seed(id, bytemuck::cast_slice(of.triangles()));
    let id = (0..of.split_count() as u32)
        .fold(id, |id, split| XxHash3_64::oneshot_with_seed(id, bytemuck::bytes_of(&of.bounds(split))));

    let order = Order::new(of, model.bounds().unwrap_or_default());
    let bake = BakeOptions::default().with_compression(options.compression);
    let pages = (of.split_count() as u32).div_ceil(PAGE);
    let (mut bodies, mut page_at) = (Vec::new(), vec![0]);
    let (mut page_bounds, mut page_sizes) = (Vec::new(), Vec::new());
    for start in (0..pages).step_by(BATCH as usize) {
        let count = BATCH.min(pages - start) as usize;
        let batch = parallel::map(count, 1, |at| {
            let number = start + at as u32;
            let page = Page::gather(of, &order, number, channels, &words);
            let bytes = page.write(&Name { store: id, page: number }, bake);
            (bytes, page.union(), page.sizes())
        });
        for (bytes, bounds, sizes) in batch {
            let bytes = bytes?;
            page_at.push(page_at[page_at.len() - 1] + bytes.len() as u64);
            bodies.push(bytes);
            page_bounds.push(bounds);
            page_sizes.push(sizes);
        }
    }
    let base = Tables::base(of);
    let scalar = |channel: usize| base.iter().map(move |&vertex| (vertex, channel));
    let base_triangles = of.base_triangle_count();
    let group_of = match of.materials().len() {
        0 | 1 => Vec::new(),
        _ => (0..base_triangles as u32).map(|triangle| of.group_of(triangle) as u16).collect(),
    };
    let header = Header {
        leaves: of.leaf_count() as u32,
        splits: of.split_count() as u32,
        triangles: of.triangle_count() as u32,
        base_vertices: base.len() as u32,
        base_triangles: base_triangles as u32,
        places: 0,
        extent: model.bounds().unwrap_or_default(),
        materials: of.materials().to_vec(),
        layout,
    };
    let roots = of.roots().map(|root| order.place[root as usize]);
    let mut roots: Vec<u32> = roots.collect();
    roots.sort_unstable();
    let shared = Shared {
        head: Head { id, diagonal: of.diagonal(), has_dependencies: of.has_dependencies() },
        header,
        first_leaf: base.iter().map(|&vertex| of.first_leaf(vertex)).collect(),
        scalars: (0..channels)
            .flat_map(scalar)
            .map(|(vertex, channel)| words[vertex as usize * channels + channel])
            .collect(),
        triangles: of.triangles()[..base_triangles].to_vec().into(),
        group_of: group_of.into(),
        roots: roots.into(),
        page_bounds: page_bounds.into(),
        page_at: page_at.into(),
        page_sizes: page_sizes.into(),
        length: 0,
    };
    to.write_all(&shared.write()?)?;
    for body in bodies {
        to.write_all(&body)?;
    }
    Ok(())
}
