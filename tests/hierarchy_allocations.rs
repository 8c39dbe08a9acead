//! Promise: nothing allocates once warm.

mod support;

use multires::adapt::Geomorph;
use multires::hierarchy::HierarchyLod;
use multires::lod::{Lod, LodOptions, ShortIndices, VertexBuffer};
use multires::mesh::{Mesh, shapes};
use multires::simplify::Simplifier;
use peak_alloc::PeakAlloc;
use support::lod::{Limited, POLICIES, bake_hierarchy, places, view};

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// A flight to and around the mesh, with a jump, from the coarsest and back to it. Whether no more memory was in use at any
/// time than before.
fn fly(mesh: &Mesh, lod: &mut impl Lod, short: &mut ShortIndices) -> bool {
    let views: Vec<_> = (0..80)
        .map(|frame| {
            let angle = frame as f32 * 0.05;
            let far = if frame > 50 { 3.0 } else { 2.0 - 0.03 * frame as f32 };
            [view(mesh, [far * angle.sin(), 0.1, far * angle.cos()], angle, 0.3).of_world()]
        })
        .collect();
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let mut written = 0;
    let rest: &[_] = &[];
    for views in views.iter().map(|views| &views[..]).chain([rest; 80]) {
        lod.adapt(views, 1.0 / 60.0);
        short.update(lod, 0);
        written += lod.dirty_triangles(0, 4).map(|range| range.len()).sum::<usize>();
        written += lod.dirty_vertices(4).map(|range| range.len()).sum::<usize>();
        lod.clean();
    }
    assert!(written > 5_000);
    ALLOCATOR.peak_usage() == before && ALLOCATOR.current_usage() == before
}

/// One test, so that nothing else allocates meanwhile.
#[test]
fn the_second_flight_allocates_nothing() {
    let mesh = shapes::rock(6_000, 2);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    for policy in [0, 2] {
        let model = bake_hierarchy(&mesh, &sequence, POLICIES[policy]);
        let (places, hierarchy) = (places(&model), model.structure());
        let check = |name: &str, lod: &mut dyn FnMut(&mut ShortIndices) -> bool| {
            let mut short = ShortIndices::default();
            assert!(!lod(&mut short), "{name}, policy {policy}: the first flight must grow buffers");
            assert!(lod(&mut short), "{name}, policy {policy}");
        };
        let limits = [
            LodOptions::default(),
            LodOptions::default().with_operations(Some(60)),
            LodOptions::default().with_triangles(Some(1_500)),
            LodOptions::default().with_operations(Some(60)).with_triangles(Some(1_500)),
        ];
        for (i, options) in limits.into_iter().enumerate() {
            let mut lod = HierarchyLod::new(hierarchy.clone()).limited(options);
            check(&format!("static {i}"), &mut |short| fly(&mesh, &mut lod, short));
            let mut lod = HierarchyLod::packed(hierarchy.clone()).limited(options);
            check(&format!("packed {i}"), &mut |short| fly(&mesh, &mut lod, short));
            let geomorph = Geomorph::default().with_frames(10.0);
            let moving = options.with_geomorph(geomorph);
            let mut lod = model.instance(places.clone(), &moving.with_buffer(VertexBuffer::Whole)).unwrap();
            check(&format!("morphed {i}"), &mut |short| fly(&mesh, &mut lod, short));
            let mut lod = model.instance(places.clone(), &moving.with_buffer(VertexBuffer::Packed)).unwrap();
            check(&format!("morphed and packed {i}"), &mut |short| fly(&mesh, &mut lod, short));
        }
    }
}
