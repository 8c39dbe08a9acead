//! A drawn instance of a store.

use std::io::{Read, Seek};
use std::ops::Range;
use std::sync::Arc;

use crate::adapt::{Change, Cut, DirtyRanges};
use crate::hierarchy::CutSurface;
use crate::lod::{Draws, Driver, Everything, Lod, LodError, LodOptions, Uploads, Vertex, VertexBuffer};
use crate::mesh::{Mesh, NONE};
use crate::view::{Criterion, Motion, ObjectView};

use super::super::client::StreamVertex;
use super::super::values::{Arrived, DrawnValues, drawn_mesh};
use super::StoreError;
use super::cache::Pages;
use super::header::{Shared, read_range};
use super::page::PAGE;
use super::shown::{Drawn, Sink};

/// A page that an instance wants, and where it is.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct PageRange {
    /// Number of the page.
    pub page: u32,
    /// Its bytes in the store.
    pub range: Range<u64>,
}

/// A drawn instance of a [`Store`](super::Store): a [`Lod`] whose cut stops where pages have not arrived.
///
/// Every frame: [`adapt`](Lod::adapt); read the ranges of [`wanted`](StoreLod::wanted), in as many threads as there are, and hand the bytes
/// to [`supply`](StoreLod::supply) when they come. [`fetch`](StoreLod::fetch) does both at once, for files.
///
/// Once nothing is wanted, triangles and vertices are those that an instance of the model itself draws for the views. Pages with a
/// split in the mesh stay in memory. If the cache is too small for all that the views ask for, nothing more is wanted once it is
/// full: what is missing stays coarse.
///
/// Takes 4 bytes a split of the pages drawn in part or in whole (8 with dependencies) and 48 for each that may come or go, besides the cache and what is drawn.
#[derive(Clone)]
pub struct StoreLod<V, F> {
    pages: Pages,
    cache: usize,
    driver: Driver,
    surface: CutSurface,
    drawn: Drawn,
    values: DrawnValues<V, F>,
    /// What is asked for: views, or everything.
    views: Vec<ObjectView>,
    everything: bool,
}

impl<V: Vertex, F: FnMut(StreamVertex<'_>) -> V> StoreLod<V, F> {
    pub(super) fn new(store: Arc<Shared>, cache: usize, options: &LodOptions, make: F) -> Self {
        let header = &store.header;
        let cut = Cut::new(header.splits as usize, store.head.diagonal, store.head.has_dependencies);
        let mut surface = CutSurface::empty(header.materials.len().max(1));
        let pages = Pages::new(store);
        let drawn = Drawn::new(&pages, &mut surface);
        let mut lod = Self {
            pages,
            cache,
            driver: Driver::new(cut),
            surface,
            drawn,
            values: DrawnValues::new(make),
            views: Vec::new(),
            everything: false,
        };
        lod.apply(options);
        lod.write_values();
        lod
    }

    fn apply(&mut self, options: &LodOptions) {
        let mut options = options.with_buffer(VertexBuffer::Packed);
        options.geomorph = None;
        let Self { pages, driver, surface, drawn, .. } = self;
        let pages = &*pages;
        driver.set_options(pages, &options, &mut Sink { pages, drawn, surface }, |cut| {
            pages.store().triangles.len()
                + cut.refinements().map(|split| pages.owned(split).len()).sum::<usize>()
        });
    }

    /// Gives back memory if most of it is not in use.
    fn trim(&mut self) {
        self.driver.trim();
        self.surface.trim();
    }

    fn write_values(&mut self) {
        let Self { pages, surface, values, drawn, .. } = self;
        drawn
            .left
            .drain(..)
            .filter(|&page| drawn.used[page as usize] == 0)
            .for_each(|page| pages.leave(page));
        values.write(surface, &pages.store().header, |vertex, words| pages.scalars(vertex, words));
    }

    /// Adapts to a custom criterion. `motion` is the criterion's motion since the last call; see [`Criterion::motion`].
    fn adapt_by<C: Criterion + ?Sized>(&mut self, criterion: &C, motion: Motion, seconds: f32) -> Change {
        let Self { pages, driver, surface, drawn, .. } = self;
        let pages = &*pages;
        let mut sink = Sink { pages, drawn, surface };
        let diagonal = pages.store().head.diagonal;
        let cost = |split: u32, _| pages.owned(split).len();
        let change = driver.adapt_by(pages, (criterion, motion, seconds, diagonal), &mut sink, cost);
        self.write_values();
        change
    }

    /// Returns the pages that the last views ask for and that are not in memory, most urgent first, as many as the cache has
    /// room for. A page is wanted until it is supplied, or no view asks for it.
    pub fn wanted(&self) -> Vec<PageRange> {
        let store = self.pages.store();
        let factor = f64::from(self.driver.tolerance_factor()) * self.driver.limit_factor();
        let urgency = |(page, needed): (u32, bool)| match needed || self.everything {
            true => (f64::INFINITY, page),
            false => (self.views.urgency_scaled(&store.page_bounds[page as usize], factor), page),
        };
        let mut missed: Vec<(f64, u32)> =
            self.pages.missed().map(urgency).filter(|(urgency, _)| *urgency > 1.0).collect();
        missed.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let size = |page: u32| store.page_sizes[page as usize][2] as usize;
        let mut room = self.cache.saturating_sub(self.pages.bytes());
        room += self.unused().map(|(_, page)| size(page)).sum::<usize>();
        let mut wanted = Vec::new();
        for (_, page) in missed {
            let Some(left) = room.checked_sub(size(page)) else { break };
            room = left;
            let at = |page: u32| store.length + store.page_at[page as usize];
            wanted.push(PageRange { page, range: at(page)..at(page + 1) });
        }
        wanted
    }

    /// Returns the pages in memory without a split in the mesh, and when their last split left it.
    fn unused(&self) -> impl Iterator<Item = (u64, u32)> {
        let (driver, drawn) = (&self.driver, &self.drawn);
        let all_drawn = driver.options().is_immediate();
        self.pages.ages().filter(move |(_, page)| {
            drawn.used[*page as usize] == 0
                && (all_drawn || (page * PAGE..(page + 1) * PAGE).all(|split| !driver.cut().holds(split)))
        })
    }

    /// Takes in a page. Returns whether there was room for it; the next [`adapt`](Lod::adapt) draws it. Takes pages out of memory that
    /// have no split in the mesh, the longest unused first.
    ///
    /// # Errors
    /// There is no such page; the bytes are of another page, or damaged. Nothing has changed.
    pub fn supply(&mut self, page: u32, bytes: Vec<u8>) -> Result<bool, StoreError> {
        if self.pages.has(page) {
            return Ok(true);
        }
        let content = self.pages.store().page(page, bytes)?;
        let size = content.sizes()[2] as usize;
        if self.pages.bytes() + size > self.cache {
            let mut unused: Vec<(u64, u32)> = self.unused().collect();
            unused.sort_unstable();
            let mut unused = unused.into_iter();
            while self.pages.bytes() + size > self.cache {
                match unused.next() {
                    Some((_, page)) => self.pages.remove(page),
                    None => return Ok(false),
                }
            }
        }
        self.pages.insert(page, content);
        let ends = self.pages.ends();
        self.drawn.reach(ends);
        self.surface.reach(ends[0], ends[1]);
        self.driver.arrived();
        Ok(true)
    }

    /// Reads the most urgent of the wanted pages, up to so many bytes and at least one, and takes them in. Returns the bytes read.
    ///
    /// # Errors
    /// Reading fails, or a page is damaged.
    pub fn fetch(&mut self, from: &mut (impl Read + Seek), most: usize) -> Result<usize, StoreError> {
        let mut read = 0;
        for PageRange { page, range } in self.wanted() {
            let length = (range.end - range.start) as usize;
            if read > 0 && read + length > most {
                break;
            }
            let bytes = read_range(from, range)?;
            self.supply(page, bytes)?;
            read += length;
        }
        Ok(read)
    }

    /// Returns the number of pages in memory.
    pub fn pages(&self) -> usize {
        self.pages.count()
    }

    /// Returns the bytes of the pages in memory.
    pub fn cached_bytes(&self) -> usize {
        self.pages.bytes()
    }

    /// Returns the number of splits without effect: they are in the cut, but made no sense in the mesh, since their store is not
    /// of one model. 0 for every store that was written by [`write_store`](super::write_store).
    pub fn faults(&self) -> usize {
        self.drawn.void()
    }

    /// Returns the drawn vertices, by slot.
    pub fn values(&self) -> &[V] {
        self.values.all()
    }
}

impl<V: Vertex, F: FnMut(StreamVertex<'_>) -> V + Send> Lod for StoreLod<V, F> {
    fn adapt_at_rest(&mut self, views: &[ObjectView]) -> Option<Change> {
        let (change, waited) = self.driver.at_rest(views)?;
        if waited {
            self.trim();
        }
        Some(change)
    }

    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        if let Some(change) = self.adapt_at_rest(views) {
            return change;
        }
        self.views.clear();
        self.views.extend_from_slice(views);
        self.everything = false;
        let Self { pages, driver, surface, drawn, .. } = self;
        let pages = &*pages;
        let mut sink = Sink { pages, drawn, surface };
        let diagonal = pages.store().head.diagonal;
        let cost = |split: u32, _| pages.owned(split).len();
        let change = driver.adapt(pages, (views, seconds, diagonal), &mut sink, cost);
        self.write_values();
        self.surface.sweep();
        if self.driver.waited(&change) {
            self.trim();
        }
        change
    }

    /// Draws all that is in memory; from then on every page is wanted.
    fn refine_fully(&mut self) -> Change {
        self.everything = true;
        let change = self.adapt_by(&Everything, Motion::Other, f32::INFINITY);
        self.settle();
        Change { triangles: self.surface.triangle_count(), pending: 0, moving: 0, ..change }
    }

    fn settle(&mut self) {
        let Self { pages, driver, surface, drawn, .. } = self;
        let pages = &*pages;
        driver.settle(pages, &mut Sink { pages, drawn, surface });
        self.write_values();
    }

    fn options(&self) -> &LodOptions {
        self.driver.options()
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        self.apply(options);
        self.write_values();
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.driver.tolerance_factor()
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        self.driver.set_tolerance_factor(factor);
    }

    fn refinements(&self) -> usize {
        self.drawn.splits()
    }

    fn groups(&self) -> usize {
        self.surface.groups()
    }

    fn material(&self, group: usize) -> u32 {
        self.pages.store().header.materials.get(group).copied().unwrap_or(NONE)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.surface.triangles(group)
    }

    /// Returns names of the vertices in the slots: numbers of this instance's own.
    fn vertices(&self) -> Option<&[u32]> {
        self.surface.vertices()
    }

    fn vertex_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.values.all())
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    fn shares_vertices(&self) -> bool {
        false
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.surface.dirty_triangles(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.surface.dirty_vertices(gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    fn clean(&mut self) {
        self.surface.clean();
    }

    fn invalidate(&mut self) {
        self.surface.invalidate();
        self.surface.invalidate_vertices();
    }

    /// Returns the drawn triangles with all attributes, vertices in the order of the model.
    fn to_mesh(&self) -> Mesh {
        drawn_mesh(&self.surface, &self.pages.store().header, &self.pages).unwrap_or_default()
    }

    fn memory(&self) -> usize {
        self.pages.memory()
            + self.driver.memory()
            + self.surface.memory()
            + self.drawn.memory()
            + size_of_val(self.values.all())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::super::page::Name;
    use super::super::{Store, StoreOptions, write_store};
    use super::*;
    use crate::hierarchy::{Dependencies, HierarchyBuilder};
    use crate::mesh::shapes;
    use crate::view::{View, look_at};

    fn check(lod: &impl Lod) {
        let slots = lod.vertices().map_or(0, <[u32]>::len) as u32;
        for &[a, b, c] in lod.triangles(0) {
            assert!(a.max(b).max(c) < slots && a != b && b != c && c != a);
        }
    }

    #[test]
    fn bounds_of_pages_contain_those_of_their_splits() {
        for mesh in [shapes::rock(12_000, 1), shapes::robot(4)] {
            let model = HierarchyBuilder::new().bake(&mesh).expect("a model");
            let mut file = Vec::new();
            write_store(&model, &StoreOptions::default(), &mut file).expect("a store");
            let store = Store::open(&mut Cursor::new(&file)).expect("a store");
            for (number, union) in (0..).zip(&store.0.page_bounds) {
                let range = store.page_range(number).expect("a page");
                let bytes = file[range.start as usize..range.end as usize].to_vec();
                let page = store.0.page(number, bytes).expect("a page");
                for bounds in &page.bounds {
                    assert!(union.contains(bounds), "{union:?} {bounds:?}");
                }
            }
        }
    }

    /// Pages whose checksums fit, of numbers that were changed: an error, or a mesh of the splits that make sense.
    #[test]
    fn forged_pages_do_no_harm() {
        let (mut refused, mut void) = (0, 0);
        for (kind, most) in [
            (Dependencies::None, None),
            (Dependencies::Neighbours, None),
            (Dependencies::Adjacent, Some(900)),
        ] {
            let model =
                HierarchyBuilder::new().dependencies(kind).bake(&shapes::rock(4_000, 1)).expect("a model");
            let mut file = Vec::new();
            write_store(&model, &StoreOptions::default(), &mut file).expect("a store");
            let store = Store::open(&mut Cursor::new(&file)).expect("a store");
            let shared = &store.0;
            for seed in 0..150_u64 {
                let mut state = seed * 2 + 1;
                let mut random = |most: u32| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    ((state >> 33) % u64::from(most)) as u32
                };
                let operations = (seed % 3 == 0).then_some(200);
                let options = LodOptions { triangles: most, operations, ..LodOptions::default() };
                let mut lod = store.instance(1 << 17, &options, |vertex| vertex.position());
                for step in 0..30 {
                    let eye = [3.0 - 0.1 * step as f32, 0.2, random(3) as f32 * 0.3];
                    let camera = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
                    let view =
                        View::perspective(camera, 1.0, [1920, 1080]).expect("a view").with_tolerance_px(0.5);
                    lod.adapt(&[view.of_world()], 0.0);
                    check(&lod);
                    let number = random(store.page_count() as u32);
                    let range = store.page_range(number).expect("a page");
                    let bytes = file[range.start as usize..range.end as usize].to_vec();
                    let mut page = shared.page(number, bytes).expect("a page");
                    if random(3) > 0 {
                        page.forge(&mut random);
                    }
                    let name = Name { store: shared.head.id, page: number };
                    let bytes = page.write(&name, Default::default()).expect("a page");
                    refused += usize::from(lod.supply(number, bytes).is_err());
                }
                lod.refine_fully();
                check(&lod);
                void += lod.faults();
                lod.adapt(&[], 0.0);
                lod.settle();
                check(&lod);
            }
        }
        assert!(refused > 100 && void > 100, "{refused} {void}");
    }
}
