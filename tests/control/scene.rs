//! Promise: a scene of instances of any structure stays within one number of triangles, and a still scene rests.

use crate::support::lod::{places, view};
use multires::adapt::Geomorph;
use multires::control::{ControlError, SceneBudget, SceneObject, SceneOptions, SceneReport};
use multires::lod::{Baked, Lod, LodOptions, Structure};
use multires::mesh::{Mesh, shapes};
use multires::view::{Focus, ObjectView};
use multires::{TotallyOrderedMesh, VertexHierarchy, WaveletMesh};

const FRAME: f32 = 1.0 / 60.0;

/// A hierarchy, a totally ordered mesh and a wavelet mesh, each with its model.
fn scene(options: &LodOptions) -> Vec<(Mesh, Box<dyn Lod>)> {
    fn instance<S: Structure>(model: &Baked<S>, options: &LodOptions) -> Box<dyn Lod> {
        Box::new(model.instance(places(model), options).unwrap())
    }
    let [terrain, rock, dunes] = [shapes::terrain(48, 3), shapes::rock(6_000, 1), shapes::terrain(65, 2)];
    let first = instance(&VertexHierarchy::bake(&terrain).unwrap(), options);
    let second = instance(&TotallyOrderedMesh::bake(&rock).unwrap(), options);
    let third = instance(&WaveletMesh::bake(&dunes).unwrap(), options);
    vec![(terrain, first), (rock, second), (dunes, third)]
}

fn views(mesh: &Mesh, frame: usize) -> [ObjectView; 1] {
    let angle = frame as f32 * 0.03;
    let far = 1.3 + 0.7 * (frame as f32 * 0.07).cos();
    [view(mesh, [far * angle.sin(), 0.15, far * angle.cos()], angle, 0.05).of_world()]
}

fn frame(
    budget: &mut SceneBudget,
    scene: &mut [(Mesh, Box<dyn Lod>)],
    at: usize,
    importance: [f32; 3],
) -> SceneReport {
    let all: Vec<_> = scene.iter().map(|(mesh, _)| views(mesh, at)).collect();
    let mut objects: Vec<_> = scene
        .iter_mut()
        .zip(&all)
        .zip(importance)
        .map(|(((_, lod), views), importance)| {
            SceneObject::new(lod.as_mut(), views).with_importance(importance)
        })
        .collect();
    let report = budget.adapt(&mut objects, FRAME);
    let drawn: usize =
        scene.iter().map(|(_, lod)| (0..lod.groups()).map(|g| lod.triangles(g).len()).sum::<usize>()).sum();
    assert_eq!(report.triangles, drawn);
    report
}

#[test]
fn never_above_and_mostly_used() {
    let moving = LodOptions::default().with_geomorph(Geomorph::default().with_duration(0.2));
    for options in [LodOptions::default(), moving, LodOptions::default().with_operations(200)] {
        let mut scene = scene(&options);
        let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(4_000)).unwrap();
        let (mut used, mut rounds, mut forced) = (0, 0, 0);
        for at in 0..200 {
            let report = frame(&mut budget, &mut scene, at, [1.0; 3]);
            assert!(report.triangles <= 4_000 && !report.over_budget, "{report:?} in frame {at}");
            assert!(report.factor >= 1.0);
            used += usize::from(report.triangles > 3_400);
            rounds += report.rounds;
            forced += usize::from(report.coarsest > 0);
        }
        assert!(used > 90, "{used} frames use 85 %, {options:?}");
        assert!(rounds < 80, "{rounds} rounds in 200 frames, {options:?}");
        assert_eq!(forced, 0);
    }
}

#[test]
fn a_budget_that_is_not_needed_changes_nothing() {
    let [mut with, mut without] = [0; 2].map(|_| scene(&LodOptions::default()));
    let mut budget = SceneBudget::new(SceneOptions::default()).unwrap();
    for at in 0..30 {
        assert_eq!(frame(&mut budget, &mut with, at, [3.0, 1.0, 0.1]).factor, 1.0);
        for ((mesh, lod), (_, other)) in without.iter_mut().zip(&with) {
            lod.adapt(&views(mesh, at), FRAME);
            assert_eq!(lod.triangles(0), other.triangles(0));
        }
    }
}

#[test]
fn a_still_scene_rests() {
    for limit in [900, 2_000, 4_000, 5_000] {
        let mut scene = scene(&LodOptions::default());
        let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(limit)).unwrap();
        for _ in 0..20 {
            frame(&mut budget, &mut scene, 7, [1.0; 3]);
        }
        let rest = frame(&mut budget, &mut scene, 7, [1.0; 3]);
        for _ in 0..20 {
            assert_eq!(frame(&mut budget, &mut scene, 7, [1.0; 3]), rest);
        }
        assert!(rest.triangles > limit * 7 / 10, "{} of {limit}", rest.triangles);
    }
}

#[test]
fn equal_calls_are_equal_and_lower_budgets_hold_at_once() {
    let [mut first, mut second] = [0; 2].map(|_| scene(&LodOptions::default()));
    let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(5_000)).unwrap();
    let mut again = budget.clone();
    for at in 0..60 {
        for budget in [&mut budget, &mut again] {
            budget.set_triangles(if at % 20 < 10 { 5_000 } else { 1_000 });
        }
        let report = frame(&mut budget, &mut first, at, [1.0; 3]);
        assert_eq!(report, frame(&mut again, &mut second, at, [1.0; 3]));
        assert!(report.triangles <= if at % 20 < 10 { 5_000 } else { 1_000 });
    }
}

#[test]
fn the_coarsest_is_drawn_and_told_where_nothing_fits() {
    let mut scene = scene(&LodOptions::default());
    let coarsest: usize = scene.iter().map(|(_, lod)| lod.triangles(0).len()).sum();
    let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(0)).unwrap();
    for at in 0..5 {
        let report = frame(&mut budget, &mut scene, at, [1.0; 3]);
        assert_eq!((report.triangles, report.over_budget), (coarsest, true));
    }
    // And back.
    budget.set_triangles(4_000);
    for at in 0..60 {
        assert!(frame(&mut budget, &mut scene, at, [f32::NAN, 0.0, -1.0]).triangles <= 4_000);
    }
    assert!(frame(&mut budget, &mut scene, 60, [1.0; 3]).triangles > 3_000);
    assert_eq!(budget.adapt(&mut [], FRAME).triangles, 0);
    let options = SceneOptions::default().with_rounds(0);
    assert!(matches!(SceneBudget::new(options), Err(ControlError::OutOfRange { .. })));
}

/// An approach brings up to 10 % more triangles each frame. What the last frame grew by is provided for, so most frames adapt once.
#[test]
fn growth_is_provided_for() {
    let moving = LodOptions::default().with_geomorph(Geomorph::default().with_duration(0.3));
    let slow = LodOptions::default().with_operations(150);
    for (options, most) in [(LodOptions::default(), 50), (moving, 44), (slow, 38)] {
        let mut scene = scene(&options);
        let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(4_000)).unwrap();
        let (mut rounds, mut far) = (0, 30.0);
        for _ in 0..80 {
            far = f32::max(far * 0.97, 0.6);
            let all: Vec<_> =
                scene.iter().map(|(mesh, _)| [view(mesh, [0.0, 0.15, far], 0.0, 0.05).of_world()]).collect();
            let objects = scene.iter_mut().zip(&all);
            let mut objects: Vec<_> =
                objects.map(|((_, lod), views)| SceneObject::new(lod.as_mut(), views)).collect();
            let report = budget.adapt(&mut objects, FRAME);
            assert!(report.triangles <= 4_000);
            rounds += report.rounds;
        }
        assert!(rounds <= most, "{rounds} rounds in 80 frames, {options:?}");
    }
}

/// After a rise of the budget, instances that take several frames are waited for: the factor is judged by what it asks for, and does
/// not fall while much is pending.
#[test]
fn a_factor_does_not_wind_down_while_instances_lag() {
    let slow = LodOptions::default().with_operations(150);
    for limit in [3_000, 5_000] {
        let mut scene = scene(&slow);
        let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(1_000)).unwrap();
        for _ in 0..40 {
            frame(&mut budget, &mut scene, 7, [1.0; 3]);
        }
        budget.set_triangles(limit);
        let reports: Vec<_> = (0..60).map(|_| frame(&mut budget, &mut scene, 7, [1.0; 3])).collect();
        let rest = reports[59];
        let least = reports.iter().map(|report| report.factor).fold(f32::INFINITY, f32::min);
        assert!(least > 0.35 * rest.factor, "{least} before {rest:?}");
        assert!(rest.triangles > limit * 9 / 10, "{rest:?} of {limit}");
    }
}

/// After a rise of the budget, the factor falls by little in a frame: no frame pays for all of the new triangles.
#[test]
fn a_rise_of_the_budget_is_spread_over_frames() {
    let mut scene = scene(&LodOptions::default());
    let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(2_000)).unwrap();
    for _ in 0..40 {
        frame(&mut budget, &mut scene, 7, [1.0; 3]);
    }
    budget.set_triangles(5_000);
    let mut before = frame(&mut budget, &mut scene, 7, [1.0; 3]).triangles;
    for _ in 0..80 {
        let report = frame(&mut budget, &mut scene, 7, [1.0; 3]);
        let most = before + (5_000 - before) / 2 + 250;
        assert!(report.triangles <= most, "{before}, then {report:?}");
        before = report.triangles;
    }
    assert!(before > 4_500, "{before} of 5,000");
}

/// A focus heeds no factor, so the rounds are in vain.
#[test]
fn the_coarsest_is_drawn_where_no_factor_is_enough() {
    let mut scene = scene(&LodOptions::default());
    let focus = Focus { centre: [0.0; 3], radius: 100.0 };
    let views = [view(&scene[1].0, [0.0, 0.15, 2.0], 0.0, 0.05).with_focus(Some(focus)).of_world()];
    let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(4_000)).unwrap();
    for _ in 0..3 {
        let report = budget.adapt(&mut [SceneObject::new(scene[1].1.as_mut(), &views)], FRAME);
        assert_eq!((report.rounds, report.coarsest, report.over_budget), (4, 1, false));
        assert!(report.triangles <= 4_000, "{report:?}");
    }
}

#[test]
fn importance_gives_triangles() {
    let [mut first, mut second] = [0; 2].map(|_| scene(&LodOptions::default()));
    let options = SceneOptions::default().with_triangles(3_000);
    let [mut plain, mut weighted] = [0; 2].map(|_| SceneBudget::new(options).unwrap());
    for _ in 0..30 {
        frame(&mut plain, &mut first, 20, [1.0; 3]);
        frame(&mut weighted, &mut second, 20, [4.0, 1.0, 1.0]);
    }
    let [before, after] = [&first, &second].map(|scene| scene[0].1.triangles(0).len());
    assert!(after > before + before / 10, "{before} to {after}");
}
