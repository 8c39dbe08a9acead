//! Promise: 16-bit indices are those of 32 bits, or there are none.

use std::sync::Arc;

use crate::support::lod::{POLICIES, shape, view};
use multires::adapt::{Change, Dirty, DirtyRanges};
use multires::hierarchy::{HierarchyLod, VertexHierarchy};
use multires::lod::{Draws, Lod, LodError, LodOptions, ShortIndices, Structure, Uploads};
use multires::mesh::Mesh;
use multires::simplify::Simplifier;
use multires::tom::TotallyOrderedMesh;
use multires::view::ObjectView;

/// Triangles written by hand.
#[derive(Default)]
struct Written {
    triangles: Vec<[u32; 3]>,
    dirty: Dirty,
}

impl Written {
    fn put(&mut self, at: usize, triangle: [u32; 3]) {
        self.triangles.resize(self.triangles.len().max(at + 1), [0; 3]);
        self.triangles[at] = triangle;
        self.dirty.mark(at as u32);
    }
}

impl Lod for Written {
    fn adapt(&mut self, _: &[ObjectView], _: f32) -> Change {
        Change::default()
    }

    fn refine_fully(&mut self) -> Change {
        Change::default()
    }

    fn settle(&mut self) {}

    fn options(&self) -> &LodOptions {
        unreachable!()
    }

    fn set_options(&mut self, _: &LodOptions) -> Result<(), LodError> {
        unreachable!()
    }

    fn tolerance_factor(&self) -> f32 {
        1.0
    }

    fn set_tolerance_factor(&mut self, _: f32) {}

    fn refinements(&self) -> usize {
        0
    }

    fn groups(&self) -> usize {
        1
    }

    fn material(&self, _: usize) -> u32 {
        u32::MAX
    }

    fn triangles(&self, _: usize) -> &[[u32; 3]] {
        &self.triangles
    }

    fn vertices(&self) -> Option<&[u32]> {
        None
    }

    fn vertex_bytes(&self) -> &[u8] {
        &[]
    }

    fn vertex_size(&self) -> usize {
        0
    }

    fn shares_vertices(&self) -> bool {
        true
    }

    fn dirty_triangles(&self, _: usize, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.triangles.len(), gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(0, gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    fn clean(&mut self) {
        self.dirty.clear();
    }

    fn invalidate(&mut self) {
        self.dirty.mark_all(self.triangles.len());
    }

    fn to_mesh(&self) -> Mesh {
        Mesh::default()
    }

    fn memory(&self) -> usize {
        0
    }
}

fn update(short: &mut ShortIndices, lod: &mut impl Lod, group: usize) -> Option<Vec<[u32; 3]>> {
    short.update(lod, group).map(|t| t.iter().map(|t| t.map(u32::from)).collect())
}

#[test]
fn they_fit_up_to_65_534() {
    let (mut lod, mut short) = (Written::default(), ShortIndices::default());
    let mut card: Vec<[u32; 3]> = Vec::new();
    let mut check = |lod: &mut Written, fits: bool| {
        let found = update(&mut short, lod, 0);
        assert_eq!(found, fits.then(|| lod.triangles.clone()));
        if let Some(found) = found {
            card.resize(card.len().max(found.len()), [0; 3]);
            for range in short.dirty(0) {
                card[range.clone()].copy_from_slice(&found[range]);
            }
            short.clean();
            assert_eq!(card[..found.len()], found);
        }
        lod.clean();
    };
    lod.put(2, [65_534, 1, 2]);
    check(&mut lod, true);
    lod.put(0, [3, 4, 65_535]);
    check(&mut lod, false);
    // What is written meanwhile is there when it fits again.
    lod.put(1, [7, 8, 9]);
    check(&mut lod, false);
    lod.put(0, [3, 4, 5]);
    check(&mut lod, true);
    lod.put(0, [65_536, 4, 5]);
    check(&mut lod, false);
    lod.triangles.truncate(0);
    check(&mut lod, true);
}

/// Triangles that come back are not written again, neither in 32 bits nor in 16; and are there.
#[test]
fn triangles_that_come_back_are_there() {
    let mesh = shape(0);
    let model = TotallyOrderedMesh::bake(&mesh).unwrap();
    let mut lod = model.instance(model.arrange(mesh.positions()).unwrap(), &LodOptions::default()).unwrap();
    let (mut short, mut card) = (ShortIndices::default(), vec![[0_u16; 3]; mesh.triangles().len()]);
    let mut uploaded = Vec::new();
    for distance in [1.0, 30.0, 1.0, 4.0, 1.0] {
        lod.adapt(&[view(&mesh, [0.0, 0.0, distance], 0.0, 2.0).of_world()], 1.0 / 60.0);
        let drawn = short.update(&lod, 0).unwrap().to_vec();
        let ranges: Vec<_> = short.dirty(0).collect();
        uploaded.push(ranges.iter().map(|range| range.len()).sum::<usize>());
        ranges.into_iter().for_each(|range| card[range.clone()].copy_from_slice(&drawn[range]));
        short.clean();
        lod.clean();
        let card: Vec<[u32; 3]> = card[..drawn.len()].iter().map(|t| t.map(u32::from)).collect();
        assert_eq!(card, lod.triangles(0), "at {distance}");
    }
    assert!(uploaded[2] < lod.triangles(0).len(), "{uploaded:?}");
}

#[test]
fn they_follow_the_level_of_detail() {
    let mesh = shape(6);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let hierarchy = Arc::new(VertexHierarchy::build(&mesh, &sequence, POLICIES[0]).unwrap().hierarchy);
    let mut lod = HierarchyLod::packed(hierarchy);
    assert_eq!(lod.groups(), 3);
    let mut short = [(); 3].map(|()| ShortIndices::default());
    for frame in 0..40 {
        let z = 3.0 - (frame as f32 * 0.3).sin() * 2.5;
        lod.adapt(&[view(&mesh, [0.0, 0.0, z], 0.0, 0.5).of_world()], 1.0 / 60.0);
        for (group, short) in short.iter_mut().enumerate() {
            assert_eq!(update(short, &mut lod, group).as_deref(), Some(lod.triangles(group)));
        }
        lod.clean();
    }
}
