//! Promise: a budget of triangles is never exceeded, its split is within 5 % of the best, and a still scene does not flicker.

use crate::crowd::Random;
use multires::control::{Budget, BudgetOptions, ControlError, Estimate, Ladder, LadderObject, Split};
use proptest::prelude::*;

/// The least total error within a number of triangles, of all combinations of levels; `None` if there is none.
fn best(objects: &[(&[(usize, f32)], f32)], triangles: usize) -> Option<f64> {
    let Some(((levels, weight), others)) = objects.split_first() else { return Some(0.0) };
    let weight = f64::from(*weight);
    let with = |&(count, error): &(usize, f32)| {
        Some(weight * f64::from(error) + best(others, triangles.checked_sub(count)?)?)
    };
    levels.iter().filter_map(with).min_by(f64::total_cmp)
}

fn split(budget: &mut Budget, levels: &[(&[(usize, f32)], f32)]) -> Split {
    let ladders: Vec<_> = levels.iter().map(|(levels, _)| Ladder::new(levels).unwrap()).collect();
    let objects: Vec<_> =
        ladders.iter().zip(levels).map(|(ladder, (_, pixels))| LadderObject::new(ladder, *pixels)).collect();
    let split = budget.split(&objects);
    let chosen = levels.iter().zip(budget.levels()).map(|((levels, pixels), &level)| {
        let (triangles, error) = levels[level as usize];
        (triangles, f64::from(*pixels) * f64::from(error))
    });
    let (triangles, error) = chosen.fold((0, 0.0), |sum, level| (sum.0 + level.0, sum.1 + level.1));
    assert_eq!(split.triangles, triangles);
    assert!((split.error - error).abs() <= 1e-6 * error, "{} {error}", split.error);
    split
}

/// Ladders of any shape: errors that fall somehow, as the triangles rise.
fn levels() -> impl Strategy<Value = Vec<(usize, f32)>> {
    prop::collection::vec((1_usize..3_000, 0.0_f32..1.0), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Small scenes, from nothing and from the split of another frame.
    #[test]
    fn small_scenes_are_within_five_percent_of_the_best(
        ladders in prop::collection::vec((levels(), 0.1_f32..10.0, 0.8_f32..1.25), 1..6),
        share in 0.0_f64..1.1,
    ) {
        let objects: Vec<_> = ladders.iter().map(|(levels, pixels, _)| (&levels[..], *pixels)).collect();
        let most: usize = objects.iter().map(|(levels, _)| levels.iter().map(|l| l.0).max().unwrap()).sum();
        let triangles = (most as f64 * share) as usize;
        let mut budget = Budget::new(BudgetOptions::default().with_triangles(triangles)).unwrap();
        let moved: Vec<_> = ladders.iter().map(|(levels, pixels, by)| (&levels[..], pixels * by)).collect();
        for objects in [&objects, &moved] {
            let split = split(&mut budget, objects);
            match best(objects, triangles) {
                None => prop_assert!(split.over_budget),
                Some(best) => {
                    prop_assert!(split.triangles <= triangles && !split.over_budget);
                    prop_assert!(split.error <= best * 1.05 + 1e-9, "{} for {best}", split.error);
                    prop_assert!(split.bound <= best * (1.0 + 1e-6) + 1e-9, "bound {} of {best}", split.bound);
                }
            }
        }
    }

    /// Scenes of any size with any numbers: never above, a still scene rests after the first frame, equal calls are equal, and what is
    /// out of sight is at its coarsest.
    #[test]
    fn any_scene_is_within_the_budget_and_rests(
        ladders in prop::collection::vec(levels(), 1..4),
        objects in prop::collection::vec(
            (any::<u8>(), prop_oneof![4 => 0.0_f32..10.0, 1 => any::<f32>()], any::<f32>()), 0..200),
        triangles in 0_usize..300_000,
        tolerance in prop_oneof![Just(0.0_f32), 0.0_f32..3.0],
        exact in 0_usize..30,
    ) {
        let ladders: Vec<_> = ladders.iter().map(|levels| Ladder::new(levels).unwrap()).collect();
        let objects: Vec<_> = objects
            .iter()
            .map(|&(ladder, pixels, importance)| {
                let object = LadderObject::new(&ladders[ladder as usize % ladders.len()], pixels);
                if ladder > 200 { object.with_importance(importance) } else { object }
            })
            .collect();
        let options = BudgetOptions::default()
            .with_triangles(triangles)
            .with_tolerance_px(tolerance)
            .with_exact(exact);
        let mut budget = Budget::new(options).unwrap();
        let mut again = budget.clone();
        let split = budget.split(&objects);
        prop_assert_eq!(split, again.split(&objects));
        let coarsest: usize = objects.iter().map(|object| object.ladder.coarsest().1).sum();
        prop_assert_eq!(split.over_budget, coarsest > triangles);
        prop_assert!(split.triangles <= triangles.max(coarsest));
        prop_assert!(split.bound <= split.error && split.error.is_finite());
        for (object, &level) in objects.iter().zip(budget.levels()) {
            let weight = object.pixels * object.importance;
            if !(object.pixels > 0.0 && object.importance > 0.0) || weight == 0.0 {
                prop_assert_eq!(level as usize, object.ladder.coarsest().0);
            }
        }
        let levels = budget.levels().to_vec();
        for _ in 0..3 {
            let still = budget.split(&objects);
            // A search that ended early may go on from where it was.
            if objects.len() > exact {
                prop_assert_eq!(still.changed, 0);
                prop_assert_eq!(budget.levels(), &levels[..]);
            } else {
                prop_assert!(still.error <= split.error * (1.0 + 1e-9));
            }
        }
    }
}

#[test]
fn more_triangles_never_give_more_error() {
    let mut random = Random(7);
    let ladders: Vec<Vec<(usize, f32)>> = (0..6)
        .map(|_| {
            (0..4).map(|i| (100 << (2 * i), 0.5_f32.powi(2 * i) * (0.5 + random.unit() as f32))).collect()
        })
        .collect();
    let objects: Vec<_> = ladders.iter().map(|levels| (&levels[..], 1.0 + random.unit() as f32)).collect();
    let mut last = f64::INFINITY;
    for triangles in (1_000..40_000).step_by(500) {
        let mut budget =
            Budget::new(BudgetOptions::default().with_triangles(triangles).with_gap(1e-6)).unwrap();
        let error = split(&mut budget, &objects).error;
        assert!(error <= last * (1.0 + 1e-5), "{error} after {last}");
        last = error;
    }
}

/// A large scene, seen by an eye that trembles: how many levels change in a frame.
fn flicker(hysteresis: f32) -> usize {
    let ladder = Ladder::new(&[(10_000, 0.001), (2_500, 0.004), (600, 0.02), (200, 0.1)]).unwrap();
    let mut random = Random(3);
    let places: Vec<f64> = (0..1_000).map(|_| 1.9 + 0.2 * random.unit()).collect();
    let options = BudgetOptions::default().with_triangles(800_000).with_hysteresis(hysteresis);
    let mut budget = Budget::new(options).unwrap();
    let mut changed = 0;
    for frame in 0..50 {
        let objects: Vec<_> = places
            .iter()
            .map(|place| {
                let trembling = 1.0 + 0.02 * random.unit();
                LadderObject::new(&ladder, (1000.0 / (place * trembling)) as f32)
            })
            .collect();
        let split = budget.split(&objects);
        assert!(split.triangles <= 800_000 && split.triangles > 790_000);
        assert!(split.error <= split.bound * 1.02, "{} of {}", split.error, split.bound);
        changed += if frame > 0 { split.changed } else { 0 };
    }
    changed
}

#[test]
fn hysteresis_ends_flicker() {
    let [without, with] = [flicker(0.0), flicker(0.05)];
    assert!(without > 100, "{without} changes without");
    assert!(with * 20 < without, "{with} changes with, {without} without");
}

/// A lower budget holds at once, and the bound is that of a split without a past.
#[test]
fn a_budget_that_falls_is_kept_and_bounded_as_from_nothing() {
    let ladder = Ladder::new(&[(10_000, 0.001), (2_500, 0.004), (600, 0.02), (200, 0.1)]).unwrap();
    let mut random = Random(5);
    let objects: Vec<_> =
        (0..300).map(|_| LadderObject::new(&ladder, 1.0 + 9.0 * random.unit() as f32)).collect();
    let options = BudgetOptions::default().with_triangles(900_000);
    let mut budget = Budget::new(options).unwrap();
    budget.split(&objects);
    for triangles in [700_000, 500_000, 480_000, 100_000] {
        budget.set_triangles(triangles);
        let split = budget.split(&objects);
        assert!(split.triangles <= triangles, "{} of {triangles}", split.triangles);
        let fresh = Budget::new(options.with_triangles(triangles)).unwrap().split(&objects);
        assert!((split.bound / fresh.bound - 1.0).abs() < 1e-9, "{} for {}", split.bound, fresh.bound);
    }
}

/// Steps of any price, from one to the next.
#[test]
fn a_scene_without_a_past_is_split_near_the_bound() {
    let mut random = Random(9);
    let ladders: Vec<_> = (0..40)
        .map(|_| {
            let scale = 10.0_f64.powf(-4.0 * random.unit());
            let levels = (0..6).map(|i| (100 << i, (scale * 0.45_f64.powi(i)) as f32));
            Ladder::new(&levels.collect::<Vec<_>>()).unwrap()
        })
        .collect();
    let objects: Vec<_> = (0..2_000)
        .map(|i| LadderObject::new(&ladders[i % 40], 10.0_f64.powf(6.0 * random.unit() - 3.0) as f32))
        .collect();
    let most = 2_000 * 3_200;
    for share in [0.04, 0.1, 0.3, 0.6, 0.9, 0.999, 1.0] {
        let triangles = (most as f64 * share) as usize;
        let mut budget = Budget::new(BudgetOptions::default().with_triangles(triangles)).unwrap();
        let split = budget.split(&objects);
        assert!(split.triangles <= triangles && split.triangles + 100 >= triangles, "{split:?}");
        assert!(split.error <= split.bound * 1.001 + 1e-12, "{split:?}");
    }
}

/// What does not fit leaves its triangles to the next steps, also where they are of another class of keys.
#[test]
fn the_rest_goes_to_steps_that_follow() {
    // Steps that save 2, 1 and 0.95 a triangle.
    let ladder = |error: f32, triangles: usize| Ladder::new(&[(10, error), (10 + triangles, 0.0)]).unwrap();
    let ladders = [ladder(2_000.0, 1_000), ladder(1_000.0, 1_000), ladder(95.0, 100)];
    let objects = ladders.each_ref().map(|ladder| LadderObject::new(ladder, 1.0));
    let options = BudgetOptions::default().with_triangles(1_530).with_exact(0);
    let mut budget = Budget::new(options).unwrap();
    for _ in 0..2 {
        assert_eq!(budget.split(&objects).triangles, 1_130);
        assert_eq!(budget.levels(), [1, 0, 1]);
    }
}

#[test]
fn an_exponent_is_learned_within_limits() {
    let learned = |factor: f32, triangles: usize| {
        let mut terrain = Estimate::new(0);
        terrain.observe(1.0, 64_000);
        terrain.observe_again(factor, triangles);
        terrain.exponent()
    };
    // A quarter of the way from 1 to 2, to 2.5 and to 0.25; nothing from factors that hardly differ.
    assert!((learned(2.0, 16_000) - 1.25).abs() < 1e-9);
    assert!((learned(2.0, 1_000) - 1.375).abs() < 1e-9);
    assert!((learned(2.0, 63_000) - 0.8125).abs() < 1e-9);
    assert_eq!(learned(1.01, 32_000), 1.0);
}

#[test]
fn objects_out_of_sight_give_up_their_triangles_first() {
    let levels: &[(usize, f32)] = &[(1_000, 0.0), (100, 1.0)];
    let mut budget = Budget::new(BudgetOptions::default().with_triangles(2_100)).unwrap();
    assert_eq!(split(&mut budget, &[(levels, 1.0), (levels, 1.0), (levels, 0.0)]).triangles, 2_100);
    assert_eq!(budget.levels(), [0, 0, 1]);
    split(&mut budget, &[(levels, 0.0), (levels, 1.0), (levels, 0.1)]);
    assert_eq!(budget.levels(), [1, 0, 0]);
}

#[test]
fn a_tolerance_leaves_triangles_unspent() {
    let levels: &[(usize, f32)] = &[(10_000, 0.0), (1_000, 0.1), (100, 1.0)];
    let options = BudgetOptions::default().with_tolerance_px(0.5);
    let mut budget = Budget::new(options).unwrap();
    split(&mut budget, &[(levels, 1.0), (levels, 0.4), (levels, 10.0)]);
    assert_eq!(budget.levels(), [1, 2, 0]);
}

#[test]
fn continuous_structures_share_a_budget_with_levels() {
    let mut terrain = Estimate::new(500);
    terrain.observe(1.0, 60_500);
    terrain.observe_again(2.0, 30_500);
    assert!((terrain.exponent() - 1.0).abs() < 1e-9);
    let mut ladder = Ladder::default();
    terrain.write(1.0, &mut ladder).unwrap();
    let statue = Ladder::new(&[(10_000, 0.0), (2_000, 0.01), (200, 0.1)]).unwrap();
    let mut budget = Budget::new(BudgetOptions::default().with_triangles(40_000)).unwrap();
    let objects =
        [LadderObject::new(&ladder, 1.0), LadderObject::new(&statue, 100.0), LadderObject::new(&statue, 1.0)];
    let report = budget.split(&objects);
    assert!(report.triangles <= 40_000 && report.triangles > 20_000);
    let factor = Estimate::factor_of(budget.levels()[0]);
    assert!((2.0..3.0).contains(&factor), "{factor}");
}

#[test]
fn bad_ladders_and_options_are_refused() {
    assert_eq!(Ladder::new(&[]).unwrap_err(), ControlError::NoLevels);
    for error in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(Ladder::new(&[(1, 0.0), (2, error)]), Err(ControlError::Error { level: 1, .. })));
    }
    #[cfg(target_pointer_width = "64")]
    assert!(matches!(Ladder::new(&[(1 << 32, 0.0)]), Err(ControlError::TooLarge { level: 0, .. })));
    let dear = Ladder::new(&[(100, 1.0), (200, 2.0), (300, 1.0)]).unwrap();
    assert_eq!(dear.finest(), (0, 100, 1.0), "more triangles for no less error");
    let mut ladder = Ladder::new(&[(7, 0.5)]).unwrap();
    assert!(ladder.set(&[]).is_err());
    assert_eq!((ladder.coarsest(), ladder.finest()), ((0, 7, 0.5), (0, 7, 0.5)));

    let options = BudgetOptions::default();
    for bad in [f32::NAN, -0.1, 2.0, f32::INFINITY] {
        assert!(Budget::new(options.with_hysteresis(bad)).is_err());
        assert!(Budget::new(options.with_gap(bad)).is_err());
    }
    assert!(Budget::new(options.with_tolerance_px(-1.0)).is_err());
    let mut budget = Budget::new(options).unwrap();
    assert_eq!(budget.split(&[]).triangles, 0);
    let empty = Ladder::default();
    let split = budget.split(&[LadderObject::new(&empty, 1.0), LadderObject::new(&ladder, f32::NAN)]);
    assert_eq!((split.triangles, budget.levels()), (7, &[0, 0][..]));
}
