//! Promise: at most so many splits and collapses a frame, the rest carried over, what is drawn closed and valid after every
//! frame, and in the end what was asked for; instances do not know of each other.

use std::sync::Arc;

use crate::support;
use crate::support::lod::{Limited, POLICIES, Random, assert_valid, drawn, shape, shown, view, wanted};
use multires::hierarchy::{HierarchyLod, VertexHierarchy};
use multires::lod::{Lod, LodOptions};
use multires::simplify::Simplifier;
use multires::view::Motion;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn no_frame_does_more_and_all_is_done_in_the_end(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        packed in any::<bool>(),
        most in 1usize..7,
        triangles in prop_oneof![Just(None), (0usize..40).prop_map(Some)],
        steps in prop::collection::vec((any::<u64>(), 0u64..110, 1usize..5), 1..10),
    ) {
        let built = VertexHierarchy::build(&mesh, &sequence, POLICIES[policy]).unwrap();
        let hierarchy = Arc::new(built.hierarchy);
        let lod = if packed { HierarchyLod::packed(hierarchy.clone()) } else { HierarchyLod::new(hierarchy.clone()) };
        let options = LodOptions::default().with_operations(Some(most)).with_triangles(triangles);
        let mut lod = lod.limited(options);
        let ceiling = triangles.map_or(usize::MAX, |most| most.max(hierarchy.base_triangle_count()));
        for (seed, share, frames) in steps {
            let asked = Random::new(&hierarchy, seed, share);
            for _ in 0..frames {
                let change = lod.adapt_by(&asked, Motion::Other, 0.0);
                prop_assert!(change.cut.splits + change.cut.collapses <= most);
                assert_valid(&lod);
                prop_assert_eq!(change.triangles, lod.surface().triangle_count());
                prop_assert!(change.triangles <= ceiling);
                let (now, aim) = (shown(&lod), wanted(&hierarchy, lod.cut()));
                let late = now.iter().filter(|s| !aim.contains(s)).count();
                let early = aim.iter().filter(|s| !now.contains(s)).count();
                prop_assert_eq!(change.pending, late + early);
            }
        }
        let asked = Random::new(&hierarchy, 77, 80);
        for _ in 0..=hierarchy.split_count() {
            lod.adapt_by(&asked, Motion::Other, 0.0);
        }
        prop_assert_eq!(shown(&lod), wanted(&hierarchy, lod.cut()));
        prop_assert_eq!(lod.adapt_by(&asked, Motion::Other, 0.0).pending, 0);
        if triangles.is_none() {
            let mut at_once = HierarchyLod::new(hierarchy.clone());
            at_once.adapt_by(&asked, Motion::Other, 0.0);
            prop_assert_eq!(drawn(&lod), drawn(&at_once));
        }
    }

    /// Limits come and go while more is to be done.
    #[test]
    fn lifting_the_limit_draws_all(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        limits in prop::collection::vec((prop::option::of(0usize..4), prop::option::of(0usize..30), any::<u64>()), 1..8),
    ) {
        let built = VertexHierarchy::build(&mesh, &sequence, POLICIES[policy]).unwrap();
        let hierarchy = Arc::new(built.hierarchy);
        let mut lod = HierarchyLod::packed(hierarchy.clone());
        for (operations, triangles, seed) in limits {
            lod.limit(LodOptions::default().with_operations(operations).with_triangles(triangles));
            let change = lod.adapt_by(&Random::new(&hierarchy, seed, 90), Motion::Other, 0.0);
            assert_valid(&lod);
            let ceiling = triangles.map_or(usize::MAX, |most| most.max(hierarchy.base_triangle_count()));
            prop_assert!(change.triangles <= ceiling);
            prop_assert_eq!(change.over_budget, triangles.is_some_and(|most| change.triangles > most));
            lod.limit(LodOptions::default());
            prop_assert_eq!(shown(&lod), wanted(&hierarchy, lod.cut()));
            assert_valid(&lod);
        }
    }
}

#[test]
fn instances_are_independent_and_may_go_to_other_threads() {
    fn is_send<T: Send + Sync>() {}
    is_send::<HierarchyLod>();
    is_send::<HierarchyLod<[f32; 3]>>();

    let mesh = shape(0);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let built = VertexHierarchy::build(&mesh, &sequence, POLICIES[1]).unwrap();
    let hierarchy = Arc::new(built.hierarchy);
    let options = |i: usize| LodOptions::default().with_operations(Some(40 * i)).with_triangles(Some(900));
    let fly = |lod: &mut HierarchyLod, i: usize, frame: usize| {
        let along = frame as f32 / 20.0;
        let eye = if i == 1 { [0.0, 0.3, 2.0 - along] } else { [along - 0.5, 0.0, 1.0] };
        lod.adapt(&[view(&mesh, eye, 0.0, 0.5).of_world()], 1.0 / 60.0);
    };
    let new = |i: usize| HierarchyLod::new(hierarchy.clone()).limited(options(i));
    let mut alone = [new(1), new(2)];
    for (i, lod) in alone.iter_mut().enumerate() {
        (0..30).for_each(|frame| fly(lod, i + 1, frame));
    }
    let mut together = [new(1), new(2)];
    for frame in 0..30 {
        for (i, lod) in together.iter_mut().enumerate() {
            fly(lod, i + 1, frame);
        }
    }
    for (a, b) in alone.iter().zip(&together) {
        assert_eq!(a.triangles(0), b.triangles(0));
        assert!(a.triangles(0).len() > 100);
    }
    assert_ne!(drawn(&alone[0]), drawn(&alone[1]));
}
