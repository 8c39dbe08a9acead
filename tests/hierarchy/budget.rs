//! Promise: never more triangles than the budget, and those spent on what is most urgent.

use std::sync::Arc;

use crate::support::lod::{Limited, POLICIES, assert_valid, shape, view, wanted};
use multires::adapt::Refinements;
use multires::hierarchy::{HierarchyLod, VertexHierarchy};
use multires::lod::{Lod, LodOptions};
use multires::mesh::Mesh;
use multires::simplify::{Placement, Simplifier};
use multires::view::{Bounds, Criterion, Focus, ObjectView};
use proptest::prelude::*;

fn hierarchy(mesh: &Mesh, optimal: bool, policy: usize) -> Arc<VertexHierarchy> {
    let placement = if optimal { Placement::Optimal } else { Placement::Endpoint };
    let sequence = Simplifier::new().placement(placement).run(mesh).unwrap();
    Arc::new(VertexHierarchy::build(mesh, &sequence, POLICIES[policy]).unwrap().hierarchy)
}

fn within(hierarchy: &Arc<VertexHierarchy>, most: usize) -> HierarchyLod {
    HierarchyLod::new(hierarchy.clone()).limited(LodOptions::default().with_triangles(Some(most)))
}

/// A view, perhaps of another kind.
fn seen(mesh: &Mesh, eye: [f32; 3], turn: f32, tolerance: f32, kind: usize) -> ObjectView {
    let view = view(mesh, eye, turn, tolerance);
    match kind {
        0 => view,
        1 => view.with_frustum(false).with_back_faces_culled(false),
        2 => {
            let [low, _] = mesh.bounds().unwrap();
            let radius = mesh.diagonal() as f32 * 0.4;
            view.with_focus(Some(Focus { centre: low, radius }))
        }
        _ => view.with_tolerance_px(0.0),
    }
    .of_world()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// After any moves, at once and jumping: never above; valid; nested in the budget; the same again in a still scene.
    #[test]
    fn never_above(
        which in 0usize..8,
        policy in 0usize..4,
        optimal in any::<bool>(),
        kind in 0usize..4,
        budgets in prop::array::uniform2(0usize..1500),
        moves in prop::collection::vec((prop::array::uniform3(-1.0f32..1.0), -1.0f32..1.0, 0i32..5), 1..16),
        tolerance in 0.01f32..4.0,
    ) {
        let mesh = shape(which);
        let hierarchy = hierarchy(&mesh, optimal, policy);
        let base = hierarchy.base_triangle_count();
        let mut lods = budgets.map(|most| within(&hierarchy, most));
        let (mut eye, mut turn) = ([0.0, 0.0, 1.2], 0.0);
        for (step, angle, size) in moves {
            let size = 4f32.powi(-size);
            eye = std::array::from_fn(|i| eye[i] + step[i] * size);
            turn += angle * size;
            let view = seen(&mesh, eye, turn, tolerance, kind);
            for (lod, most) in lods.iter_mut().zip(budgets) {
                let change = lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
                assert_valid(lod);
                prop_assert!(change.triangles <= most.max(base));
                prop_assert_eq!(change.triangles, lod.surface().triangle_count());
                prop_assert_eq!(change.over_budget, change.triangles > most);
                let again = lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
                prop_assert_eq!((again.cut.splits, again.cut.collapses), (0, 0));
                prop_assert!(again.cut.tests == 0 || again.over_budget);
            }
            // Instances that come here from nowhere: nested in their budgets, and no more than the view asks for.
            let fresh = |most: usize| {
                let mut lod = within(&hierarchy, most);
                lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
                lod
            };
            let few = fresh(budgets[0].min(budgets[1]));
            let many = fresh(budgets[0].max(budgets[1]));
            let mut all = HierarchyLod::new(hierarchy.clone());
            all.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
            for split in 0..hierarchy.split_count() as u32 {
                prop_assert!(!few.shows(split) || many.shows(split));
                prop_assert!(!many.shows(split) || all.shows(split));
            }
            let enough = fresh(all.surface().triangle_count());
            prop_assert_eq!(wanted(&hierarchy, enough.cut()), wanted(&hierarchy, all.cut()));
            // Worst first: nothing that waits at the fringe is more urgent than what is there.
            let urgency = |split: u32| view.urgency(&hierarchy.bounds(split));
            let splits = || 0..hierarchy.split_count() as u32;
            let least = splits().filter(|&s| few.cut().asks_for(s)).map(urgency).fold(f64::INFINITY, f64::min);
            let waits = |&s: &u32| !few.cut().asks_for(s) && hierarchy.parents(s).all(|p| few.cut().asks_for(p));
            let most = splits().filter(waits).map(urgency).fold(0.0, f64::max);
            prop_assert!(most <= 1.0 || most <= least, "{most} waits, {least} is there");
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2048))]

    /// A refinement is needed exactly up to its urgency, and what contains it is no less urgent.
    #[test]
    fn urgency_is_the_factor(
        kind in 0usize..4,
        eye in prop::array::uniform3(-1.5f32..1.5),
        turn in -3.2f32..3.2,
        centre in prop::array::uniform3(-1.0f32..1.0),
        (radius, error) in (0f32..3.0, 1e-6f32..0.3),
        grow in 1f32..3.0,
    ) {
        let mesh = shape(2);
        let view = seen(&mesh, eye, turn, 2.0, kind);
        let bounds = Bounds::new(centre, radius, error, error * 2.0).with_cone([0.2, 0.9, 0.1], 0.4);
        let urgency = view.urgency(&bounds);
        prop_assert_eq!(view.test(&bounds).refine, urgency > 1.0);
        for factor in [1.0, 1.5, urgency * 0.999, urgency * 1.001] {
            if factor >= 1.0 && factor.is_finite() {
                prop_assert_eq!(view.test_at(&bounds, factor).refine, urgency > factor);
            }
        }
        let larger = Bounds::new(centre, radius * grow + 0.01, error * grow, error * 2.0 * grow)
            .with_cone([0.2, 0.9, 0.1], 0.6);
        prop_assert!(view.urgency(&larger) >= urgency);
    }
}

/// It is spent where there is something to spend it on, in stillness for nothing, and while moving it stays near.
#[test]
fn the_budget_is_spent() {
    let mesh = shape(0);
    for policy in 0..3 {
        let hierarchy = hierarchy(&mesh, false, policy);
        let mut lod = within(&hierarchy, 800);
        for frame in 0..200 {
            let angle = frame as f32 * 0.03;
            let view = view(&mesh, [angle.sin(), 0.0, angle.cos()], angle, 0.01).of_world();
            let change = lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
            assert!((700..=800).contains(&change.triangles), "{} in frame {frame}", change.triangles);
            let still = lod.adapt(&[view], 1.0 / 60.0);
            assert_eq!(still.cut.tests, 0);
        }
    }
}

#[test]
fn a_base_above_the_budget_is_drawn_and_said_so() {
    let mesh = shape(6);
    let hierarchy = hierarchy(&mesh, false, 0);
    let base = hierarchy.base_triangle_count();
    assert!(base > 0);
    let mut lod = within(&hierarchy, base - 1);
    let change = lod.adapt(&[view(&mesh, [0.0, 0.0, 1.0], 0.0, 0.1).of_world()], 1.0 / 60.0);
    assert_eq!((change.triangles, change.over_budget), (base, true));
    lod.limit(LodOptions::default().with_triangles(Some(base + 50)));
    let change = lod.adapt(&[view(&mesh, [0.0, 0.0, 1.0], 0.0, 0.1).of_world()], 1.0 / 60.0);
    assert!(!change.over_budget && change.triangles > base);
}

/// A limit that changes counts at once, though nothing moves.
#[test]
fn the_budget_may_change_in_stillness() {
    let mesh = shape(0);
    let hierarchy = hierarchy(&mesh, false, 1);
    let view = view(&mesh, [0.0, 0.0, 0.8], 0.0, 0.3).of_world();
    let mut all = HierarchyLod::new(hierarchy.clone());
    let most = all.adapt(std::slice::from_ref(&view), 1.0 / 60.0).triangles;
    assert!(most > 900);
    let mut lod = within(&hierarchy, 300);
    for limit in [300, 800, 200, 900, most, most / 2] {
        lod.limit(LodOptions::default().with_triangles(Some(limit)));
        let change = lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
        assert!((limit * 8 / 10..=limit).contains(&change.triangles), "{} of {limit}", change.triangles);
        assert_valid(&lod);
    }
    lod.limit(LodOptions::default());
    assert_eq!(lod.adapt(&[view], 1.0 / 60.0).triangles, most);
    assert_eq!(wanted(&hierarchy, lod.cut()), wanted(&hierarchy, all.cut()));
}
