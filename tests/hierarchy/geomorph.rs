//! Promise: vertices do not jump. Each moves at its speed, whatever happens around it, and at rest it is at its place.

use crate::support;
use crate::support::lod::{
    POLICIES, Random, assert_valid, bake_hierarchy, drawn, places, shape, shown, view, wanted,
};
use multires::adapt::{Blend, Geomorph};
use multires::hierarchy::HierarchyLod;
use multires::lod::{Lod, LodOptions, VertexBuffer};
use multires::simplify::{Placement, Simplifier};
use multires::view::Motion;
use proptest::prelude::*;

type Place = [f32; 3];

fn distance(a: Place, b: Place) -> f32 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt()
}

/// A copy of the vertex buffer, kept by dirty ranges alone.
fn upload(lod: &mut HierarchyLod<Place>, buffer: &mut Vec<Place>, gap: usize) {
    buffer.resize(lod.values().len(), [f32::NAN; 3]);
    for range in lod.dirty_vertices(gap) {
        buffer[range.clone()].copy_from_slice(&lod.values()[range]);
    }
    lod.clean();
}

/// What is in the buffer is where the vertices are.
fn assert_drawn(lod: &HierarchyLod<Place>, buffer: &[Place]) {
    for group in 0..lod.groups() {
        for &index in lod.triangles(group).as_flattened() {
            let vertex = lod.vertices().map_or(index, |vertices| vertices[index as usize]);
            assert_eq!(Some(buffer[index as usize]), lod.value(vertex));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Any mesh, any sequence, anything asked for at any time, frames of any length: no corner of the full mesh is drawn
    /// further from where it was than vertices on the way may go in that time.
    #[test]
    fn nothing_jumps(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        packed in any::<bool>(),
        operations in prop_oneof![Just(None), (1usize..6).prop_map(Some)],
        triangles in prop_oneof![Just(None), (0usize..40).prop_map(Some)],
        // Few kinds, so that the same is asked for again while it is on its way out.
        steps in prop::collection::vec((0u64..4, 60u64..110, prop::collection::vec(0usize..5, 1..6)), 1..12),
    ) {
        let model = bake_hierarchy(&mesh, &sequence, POLICIES[policy]);
        let (places, hierarchy) = (places(&model), model.structure());
        let buffer = if packed { VertexBuffer::Packed } else { VertexBuffer::Whole };
        let options = LodOptions::default().with_operations(operations).with_triangles(triangles);
        let options = options.with_buffer(buffer).with_geomorph(Geomorph::default().with_duration(1.0));
        let mut lod = model.instance(places.clone(), &options).unwrap();
        let size = places.iter().flat_map(|&a| places.iter().map(move |&b| distance(a, b))).fold(0.0, f32::max);
        let leaves = || hierarchy.triangles().as_flattened().iter().copied();
        let at = |lod: &HierarchyLod<Place>| -> Vec<Place> {
            leaves().map(|leaf| lod.value(lod.representative(leaf)).unwrap()).collect()
        };
        let mut before = at(&lod);
        let mut buffer = Vec::new();
        for (seed, share, frames) in steps {
            let asked = Random::new(hierarchy, seed, share);
            for frame in frames {
                let seconds = [0.0, 0.002, 0.05, 0.3, 0.6][frame];
                let change = lod.adapt_by(&asked, Motion::Other, seconds);
                assert_valid(&lod);
                prop_assert!(operations.is_none_or(|most| change.cut.splits + change.cut.collapses <= most));
                prop_assert!(triangles.is_none_or(|most| change.triangles <= most || change.over_budget));
                let now = at(&lod);
                // A vertex follows its substitute on top of its own way; no chain is longer than there are splits.
                let farthest = seconds * size * (1 + hierarchy.split_count()) as f32 + 1e-4 * size;
                for (a, b) in before.iter().zip(&now) {
                    prop_assert!(distance(*a, *b) <= farthest, "{} of {size} in {seconds}", distance(*a, *b));
                }
                before = now;
                upload(&mut lod, &mut buffer, frame);
                assert_drawn(&lod, &buffer);
            }
        }
        // In the end all is at its place.
        let asked = Random::new(hierarchy, 5, 70);
        for _ in 0..5 * (hierarchy.split_count() + 1) {
            lod.adapt_by(&asked, Motion::Other, 0.4);
        }
        prop_assert_eq!(lod.moving(), 0);
        prop_assert_eq!(shown(&lod), wanted(hierarchy, lod.cut()));
        for vertex in leaves().map(|leaf| lod.representative(leaf)) {
            prop_assert_eq!(lod.value(vertex), Some(places[vertex as usize]));
        }
        upload(&mut lod, &mut buffer, 0);
        assert_drawn(&lod, &buffer);
    }

    /// What nobody sees is not morphed.
    #[test]
    fn what_is_not_seen_is_changed_at_once(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        steps in prop::collection::vec((any::<u64>(), 0u64..110), 1..6),
    ) {
        let model = bake_hierarchy(&mesh, &sequence, POLICIES[policy]);
        let hierarchy = model.structure();
        let options = LodOptions::default().with_buffer(VertexBuffer::Packed).with_geomorph(Geomorph::default());
        let mut lod = model.instance(places(&model), &options).unwrap();
        let mut at_once = HierarchyLod::new(hierarchy.clone());
        let mut buffer = Vec::new();
        for (seed, share) in steps {
            let mut asked = Random::new(hierarchy, seed, share);
            asked.seen = false;
            lod.adapt_by(&asked, Motion::Other, 0.001);
            at_once.adapt_by(&asked, Motion::Other, 0.0);
            prop_assert_eq!(lod.moving(), 0);
            prop_assert_eq!(drawn(&lod), drawn(&at_once));
            upload(&mut lod, &mut buffer, 1);
            assert_drawn(&lod, &buffer);
        }
    }
}

/// A sphere of a second's morphs before a still eye, with what a view of it asks for.
fn sphere(placement: Placement) -> (multires::Mesh, HierarchyLod<Place>) {
    let mesh = shape(2);
    let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
    let model = bake_hierarchy(&mesh, &sequence, POLICIES[0]);
    let geomorph = Geomorph::default().with_duration(1.0).with_travel(f32::INFINITY).with_turn(f32::INFINITY);
    let options = LodOptions::default().with_buffer(VertexBuffer::Whole).with_geomorph(geomorph);
    let lod = model.instance(places(&model), &options).unwrap();
    (mesh, lod)
}

#[test]
fn a_morph_takes_its_time_and_turns_round_where_it_is() {
    for placement in [Placement::Endpoint, Placement::Optimal] {
        let (mesh, mut lod) = sphere(placement);
        // From both sides, so that all is seen.
        let seen = |z, tolerance| {
            [view(&mesh, [0.0, 0.0, z], 0.0, tolerance).with_back_faces_culled(false).of_world()]
        };
        let (near, far) = (seen(1.2, 0.1), seen(40.0, 2.0));
        lod.adapt(&far, 0.0);
        lod.settle();
        lod.clean();
        let start = lod.adapt(&near, 0.25);
        assert!(start.moving > 50 && start.pending == 0);
        let all = lod.surface().triangle_count();
        let place = |lod: &HierarchyLod<Place>| -> Vec<Place> { lod.values().to_vec() };
        let at_start = place(&lod);
        assert_eq!(lod.adapt(&near, 0.5).moving, start.moving);
        let half = place(&lod);
        // Back: from there, not from either end, and no triangle goes before its vertices have closed.
        let back = lod.adapt(&far, 0.0);
        assert_eq!((back.triangles, back.cut.collapses), (all, 0));
        assert!(back.pending > 0);
        assert_eq!(place(&lod), half);
        assert!(half != at_start);
        let back = lod.adapt(&far, 0.5);
        assert_eq!(back.triangles, all);
        // And forth again.
        lod.adapt(&near, 0.0);
        assert!(lod.adapt(&near, 0.99).moving > 0);
        assert_eq!(lod.adapt(&near, 0.02).moving, 0);
        let done = lod.adapt(&far, 0.0);
        assert!(done.moving > 0);
        lod.adapt(&far, 0.6);
        let gone = lod.adapt(&far, 0.6);
        assert!(gone.moving == 0 && gone.pending == 0 && gone.triangles < all);
    }
}

/// The same on meshes of some size, with views that jump, all limits at once, and any placement.
#[test]
fn nothing_jumps_where_much_happens_at_once() {
    for (which, policy) in [(0, 0), (6, 1), (1, 2), (0, 2)] {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let mesh = shape(which);
            let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
            let model = bake_hierarchy(&mesh, &sequence, POLICIES[policy]);
            let (places, hierarchy) = (places(&model), model.structure());
            let geomorph =
                Geomorph::default().with_duration(1.0).with_travel(f32::INFINITY).with_turn(f32::INFINITY);
            let limits = LodOptions::default().with_operations(Some(150)).with_triangles(Some(1_000));
            let options = limits.with_buffer(VertexBuffer::Packed).with_geomorph(geomorph);
            let mut lod = model.instance(places.clone(), &options).unwrap();
            let seen = |at: usize| {
                let eye = [[0.0, 0.0, 0.9], [0.6, 0.1, 0.4], [0.0, 0.0, 20.0], [-0.4, 0.3, 0.5]][at % 4];
                [view(&mesh, eye, 0.0, 0.2).with_frustum(false).with_back_faces_culled(false).of_world()]
            };
            let places_of = |lod: &HierarchyLod<Place>| -> Vec<Place> {
                let leaves = hierarchy.triangles().as_flattened();
                leaves.iter().map(|&leaf| lod.value(lod.representative(leaf)).unwrap()).collect()
            };
            let mut before = places_of(&lod);
            let (mut buffer, mut most_moving) = (Vec::new(), 0);
            for frame in 0..160 {
                let seconds = [0.001, 0.0, 0.1, 0.001][frame % 4];
                let change = lod.adapt(&seen(frame / 13), seconds);
                assert!(change.triangles <= 1_000 && change.cut.splits + change.cut.collapses <= 150);
                most_moving = most_moving.max(lod.moving());
                let now = places_of(&lod);
                let farthest = before.iter().zip(&now).map(|(a, b)| distance(*a, *b)).fold(0.0, f32::max);
                let size = mesh.diagonal() as f32;
                assert!(farthest <= size * (30.0 * seconds + 1e-5), "{farthest} of {size} in {seconds}");
                before = now;
                upload(&mut lod, &mut buffer, 3);
                assert_drawn(&lod, &buffer);
                if frame % 8 == 0 {
                    assert_valid(&lod);
                }
            }
            assert!(most_moving > 100);
            let mut change = lod.adapt(&seen(0), 0.3);
            for _ in 0..200 {
                change = lod.adapt(&seen(0), 0.3);
            }
            assert_eq!((change.pending, change.moving, lod.moving()), (0, 0, 0));
            assert_eq!(shown(&lod), wanted(hierarchy, lod.cut()));
            let vertices = lod.vertices().unwrap().iter();
            assert!(vertices.zip(lod.values()).all(|(&vertex, value)| *value == places[vertex as usize]));
        }
    }
}

#[test]
fn outside_the_frustum_nothing_is_morphed() {
    let (mesh, mut lod) = sphere(Placement::Endpoint);
    let eye = [0.0, 0.0, 1.2];
    lod.adapt(&[view(&mesh, eye, 0.0, 0.1).of_world()], 0.0);
    lod.settle();
    let away = view(&mesh, eye, std::f32::consts::PI, 0.1);
    let change = lod.adapt(&[away.of_world()], 0.01);
    assert!(change.cut.collapses > 50);
    assert_eq!((change.moving, change.pending), (0, 0));
    // Where the frustum does not count, neither does it here.
    let mut lod = sphere(Placement::Endpoint).1;
    lod.adapt(&[view(&mesh, eye, 0.0, 0.1).of_world()], 0.0);
    lod.settle();
    let far = view(&mesh, [0.0, 0.0, 60.0], 0.0, 4.0).with_frustum(false).with_back_faces_culled(false);
    let change = lod.adapt(&[far.of_world()], 0.01);
    assert!(change.moving > 0 && change.pending > 0);
}

#[test]
fn the_share_of_the_way_is_as_stated() {
    let geomorph = Geomorph::default().with_duration(2.0).with_travel(0.5).with_turn(4.0);
    let moved = |distance, angle| Motion::Moved { distance, angle };
    let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
    assert!(near(geomorph.progress(0.5, moved(0.0, 0.0), 10.0), 0.25));
    assert!(near(geomorph.progress(0.5, moved(1.0, 1.0), 10.0), 0.25 + 0.2 + 0.25));
    assert!(near(geomorph.progress(0.5, Motion::Other, 10.0), 0.25));
    assert!(near(geomorph.progress(0.0, moved(100.0, 0.0), 10.0), 1.0));
    assert!(near(geomorph.with_frames(30.0).progress(0.25, Motion::Other, 1.0), 0.5));
    assert!(near(geomorph.with_duration(0.0).progress(0.0, Motion::Other, 1.0), 1.0));
    for odd in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
        let odd = Geomorph::default().with_duration(odd).with_travel(odd).with_turn(odd);
        for seconds in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
            let progress = odd.progress(seconds, moved(f64::INFINITY, f64::NAN), f64::NAN);
            assert!((0.0..=1.0).contains(&progress));
        }
    }
}

#[test]
fn blends_are_exact_at_their_ends() {
    for (a, b) in [(1.0_f32, 0.1), (1e30, -3e-20), (f32::INFINITY, 2.0)] {
        assert_eq!([a, b].blend(&[b, a], 0.0), [a, b]);
        assert_eq!([a, b].blend(&[b, a], 1.0), [b, a]);
    }
    assert_eq!(2.0_f32.blend(&4.0, 0.25), 2.5);
}

/// A whole that only knows how to be mixed.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
struct Mixed(f32);

impl Blend for Mixed {
    fn blend(&self, other: &Self, t: f32) -> Self {
        Self(self.0.blend(&other.0, t))
    }
}

#[test]
fn what_is_carried_along_goes_as_far_and_ends_where_the_other_does() {
    assert_eq!([10.0_f32, 1.0].moved(&[2.0, 1.0], &[4.0, 3.0], 0.25), [10.5, 1.5]);
    for (a, b) in [(1.0_f32, 0.1), (1e30, -3e-20), (0.3, 0.7)] {
        assert_eq!(a.moved(&b, &7.0, 0.0), a);
        assert_eq!(a.moved(&a, &b, 1.0), b);
        assert_eq!(a.moved(&a, &b, 0.0), a);
        assert_eq!(Mixed(a).moved(&Mixed(a), &Mixed(b), 1.0), Mixed(b));
        assert_eq!(Mixed(a).moved(&Mixed(a), &Mixed(b), 0.5), Mixed(a.moved(&a, &b, 0.5)));
    }
    assert_eq!(f32::INFINITY.moved(&1.0, &2.0, 0.0), f32::INFINITY);
}
