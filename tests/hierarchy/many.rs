//! Promise: an instance takes memory for what it draws, one at rest costs nothing, and many are adapted together as each alone.

use multires::adapt::Geomorph;
use multires::hierarchy::{Dependencies, HierarchyBuilder, HierarchyLod};
use multires::lod::adapt_all;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::view::ObjectView;

use crate::support::lod::{places, view};

const SECONDS: f32 = 1.0 / 60.0;

/// The view from some distance.
fn from(mesh: &Mesh, distance: f32) -> [ObjectView; 1] {
    [view(mesh, [0.1, 0.2, distance], 0.0, 1.0).of_world()]
}

#[test]
fn memory_follows_what_is_drawn() {
    let mesh = shapes::rock(100_000, 4);
    let model = HierarchyBuilder::new().dependencies(Dependencies::Manifold).bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let splits = model.structure().split_count();
    for buffer in [VertexBuffer::Packed, VertexBuffer::Shared] {
        for geomorph in [None, Some(Geomorph::default())] {
            if geomorph.is_some() && buffer == VertexBuffer::Shared {
                continue; // then all vertices are the instance's own
            }
            let mut options = LodOptions::default().with_buffer(buffer);
            options.geomorph = geomorph;
            let mut lod = model.instance(values.clone(), &options).unwrap();
            let new = lod.memory();
            assert!(new < splits / 4 + 40_000, "{new} bytes for {splits} splits");
            lod.refine_fully();
            lod.clean();
            let whole = lod.memory();
            assert!(whole > 40 * splits, "{whole} bytes for {splits} splits");
            // It may come back: for a while, buffers stay.
            let far = from(&mesh, 1e4);
            lod.adapt(&far, SECONDS);
            lod.settle();
            lod.clean();
            assert!(lod.memory() > whole / 2);
            for _ in 0..1_100 {
                lod.adapt(&far, SECONDS);
            }
            let left = lod.memory();
            assert!(left < new + 60_000, "{left} bytes, {new} at first");
            // And it is as good as new.
            lod.refine_fully();
            assert_eq!(lod.triangles(0).len(), model.structure().triangle_count());
        }
    }
}

#[test]
fn at_rest_nothing_is_looked_at_and_everything_else_wakes_it() {
    let mesh = shapes::rock(5_000, 4);
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap();
    let mut lod = model.instance(values.clone(), &LodOptions::default()).unwrap();
    let near = from(&mesh, 3.0);
    let first = lod.adapt(&near, SECONDS);
    let again = lod.adapt(&near, SECONDS);
    assert!(first.cut.tests > 0 && first.cut.splits > 0 && again.triangles == first.triangles);
    assert_eq!((again.cut.tests, again.cut.splits, again.cut.collapses), (0, 0, 0));
    assert!(again.cut.blocks > 0 && again.cut.asleep == again.cut.blocks);
    // The factor of tolerances, options, other criteria and other views are seen.
    lod.set_tolerance_factor(20.0);
    assert!(lod.adapt(&near, SECONDS).triangles < first.triangles);
    lod.set_tolerance_factor(1.0);
    assert_eq!(lod.adapt(&near, SECONDS).triangles, first.triangles);
    lod.set_options(&LodOptions::default().with_triangles(Some(200))).unwrap();
    assert!(lod.adapt(&near, SECONDS).triangles <= 200);
    lod.set_options(&LodOptions::default()).unwrap();
    assert_eq!(lod.adapt(&near, SECONDS).triangles, first.triangles);
    lod.refine_fully();
    assert_eq!(lod.adapt(&near, SECONDS).triangles, first.triangles);
    assert!(lod.adapt(&[], SECONDS).triangles < 20 && lod.adapt(&[], SECONDS).triangles < 20);
    assert_eq!(lod.adapt(&near, SECONDS).triangles, first.triangles);
    // Operations a frame: it is not at rest before all is done.
    let mut slow = model.instance(values, &LodOptions::default().with_operations(Some(50))).unwrap();
    let mut frames = 0;
    while slow.adapt(&near, SECONDS).pending > 0 {
        frames += 1;
    }
    assert!(frames > 5);
    assert_eq!(slow.adapt(&near, SECONDS).triangles, first.triangles);
}

#[test]
fn together_as_alone() {
    let mesh = shapes::rock(3_000, 4);
    let hierarchy = VertexHierarchy::bake(&mesh).unwrap();
    let tom = TotallyOrderedMesh::bake(&mesh).unwrap();
    let options = LodOptions::default();
    let make = |at: usize| -> Box<dyn Lod> {
        if at.is_multiple_of(3) {
            Box::new(tom.instance(tom.arrange(mesh.positions()).unwrap(), &options).unwrap())
        } else {
            Box::new(hierarchy.instance(hierarchy.arrange(mesh.positions()).unwrap(), &options).unwrap())
        }
    };
    let (mut together, mut alone): (Vec<_>, Vec<_>) = (0..70).map(|at| (make(at), make(at))).unzip();
    for frame in 0..4 {
        let views: Vec<_> = (0..70).map(|at| from(&mesh, (1 + at + frame) as f32)).collect();
        let pairs = together.iter_mut().zip(&views).map(|(lod, views)| (&mut **lod, &views[..]));
        let changes = adapt_all(pairs, SECONDS);
        for ((alone, views), change) in alone.iter_mut().zip(&views).zip(changes) {
            assert_eq!(alone.adapt(views, SECONDS), change);
        }
        assert!(together.iter().zip(&alone).all(|(a, b)| a.triangles(0) == b.triangles(0)));
    }
    let none: [(&mut HierarchyLod, &[ObjectView]); 0] = [];
    assert!(adapt_all(none, SECONDS).is_empty());
}

/// A call at rest reports what is drawn, of wavelets too, whose triangles are written after the cut has moved.
#[test]
fn at_rest_the_report_is_of_what_is_drawn() {
    let mesh = shapes::icosphere(5);
    let hierarchy = VertexHierarchy::bake(&mesh).unwrap();
    let wavelets = WaveletMesh::bake(&mesh).unwrap();
    for options in [LodOptions::default(), LodOptions::default().with_operations(Some(100_000))] {
        let mut lods: [Box<dyn Lod>; 2] = [
            Box::new(hierarchy.instance(hierarchy.arrange(mesh.positions()).unwrap(), &options).unwrap()),
            Box::new(wavelets.instance(places(&wavelets), &options).unwrap()),
        ];
        for lod in &mut lods {
            for distance in [2.0, 9.0, 3.0, 40.0] {
                let views = from(&mesh, distance);
                let moved = lod.adapt(&views, SECONDS).triangles;
                assert_eq!(moved, lod.triangles(0).len());
                for change in [lod.adapt(&views, SECONDS), lod.adapt_at_rest(&views).unwrap()] {
                    assert_eq!((change.triangles, change.cut.tests, change.pending), (moved, 0, 0));
                }
            }
        }
    }
}
