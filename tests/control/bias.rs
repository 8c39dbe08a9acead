//! Promise: a bias of all parameters holds the triangles of a crowd near a number, moving as little as it must and no faster than
//! it may.

use crate::crowd::{Crowd, FRAMES, Pose, circle, stairs, through};
use multires::control::{
    Bias, BiasOptions, BiasStop, Controllable, Crossing, Sight, StairObject, Stairs, Toward,
};
use proptest::prelude::*;

/// An object with one change of level.
struct Single {
    at: f64,
    fine: usize,
    coarse: usize,
}

impl Controllable for Single {
    fn triangles(&self, bias: f64) -> usize {
        if bias < self.at { self.fine } else { self.coarse }
    }

    fn next(&self, bias: f64, toward: Toward) -> Option<Crossing> {
        let triangles = self.fine - self.coarse;
        match toward {
            Toward::Coarse => (bias < self.at).then_some(Crossing { bias: self.at, triangles }),
            Toward::Fine => (bias >= self.at).then_some(Crossing { bias: self.at.next_down(), triangles }),
        }
    }
}

/// Objects A to F of Fig. 6.4: the order of the next coarser levels is D, A, E, B, C, F; D saves 25 triangles, A 50.
fn figure() -> [Single; 6] {
    let saves = [(0.2, 50), (0.4, 30), (0.5, 40), (0.1, 25), (0.3, 60), (0.6, 35)];
    saves.map(|(at, saved)| Single { at, fine: 100 + saved, coarse: 100 })
}

#[test]
fn the_object_at_which_the_sum_is_reached_sets_the_bias() {
    // 840 triangles, 790 wanted.
    let options = BiasOptions::default().with_triangles(790).with_tolerance(25).with_change(None);
    let mut bias = Bias::new(options).unwrap();
    let report = bias.update(&figure(), false);
    assert_eq!(bias.bias(), 0.2, "the bias of A");
    assert_eq!((report.before, report.triangles, report.change), (840, 765, 0.2));
    assert_eq!(report.stop, BiasStop::Inside);
    // 25 too few is within the tolerance: nothing is taken back.
    assert_eq!(bias.update(&figure(), false).change, 0.0);
}

#[test]
fn too_few_triangles_move_the_bias_to_the_nearest_finer_levels() {
    let options = BiasOptions::default().with_triangles(690).with_tolerance(30).with_change(None);
    let mut bias = Bias::new(options).unwrap();
    bias.set_bias(1.0);
    // 600 triangles. F adds 35, C adds 40, B adds 30: the third reaches 90.
    let report = bias.update(&figure(), false);
    assert_eq!((report.before, report.triangles), (600, 705));
    assert_eq!(bias.bias(), 0.4_f64.next_down());
}

#[test]
fn a_change_that_passes_the_tolerance_is_left_out_toward_fine_and_taken_toward_coarse() {
    let objects = [Single { at: 0.5, fine: 1_000, coarse: 100 }];
    let options = BiasOptions::default().with_triangles(500).with_tolerance(50).with_change(None);
    let mut bias = Bias::new(options).unwrap();
    let report = bias.update(&objects, false);
    assert_eq!((report.triangles, report.stop), (100, BiasStop::Coarse));
    let report = bias.update(&objects, false);
    assert_eq!((report.triangles, report.change, report.stop), (100, 0.0, BiasStop::Coarse));
}

/// Toward fine, the changes before the one that passes the tolerance are taken.
#[test]
fn changes_before_one_that_passes_the_tolerance_are_taken() {
    let objects = [Single { at: 0.6, fine: 200, coarse: 100 }, Single { at: 0.4, fine: 1_100, coarse: 100 }];
    let options = BiasOptions::default().with_triangles(500).with_tolerance(50).with_change(None);
    let mut bias = Bias::new(options).unwrap();
    bias.set_bias(1.0);
    let report = bias.update(&objects, false);
    assert_eq!((report.triangles, report.stop), (300, BiasStop::Coarse));
    assert_eq!(bias.bias(), 0.6_f64.next_down());
}

#[test]
fn the_limit_of_a_frame_is_kept_and_lifted_in_motion() {
    let objects = figure();
    let options = BiasOptions::default().with_triangles(600).with_tolerance(10);
    let mut bias = Bias::new(options).unwrap();
    let report = bias.update(&objects, true);
    assert_eq!((report.change, report.stop), (0.01, BiasStop::Limited));
    bias.set_options(options.with_free_in_motion(true)).unwrap();
    assert_eq!(bias.update(&objects, false).stop, BiasStop::Limited);
    assert_eq!(bias.update(&objects, true).triangles, 600);
    assert_eq!(bias.bias(), 0.6);
}

#[test]
fn hidden_objects_lose_all_detail_before_seen_objects_lose_any() {
    let stairs = stairs();
    let seen = StairObject::new(&stairs, 0.0);
    let objects = [seen, seen.with_sight(Sight::Hidden), seen.with_sight(Sight::Culled)];
    let mut bias = Bias::new(BiasOptions::default().with_triangles(10_200).with_tolerance(0)).unwrap();
    let report = bias.update(&objects, false);
    assert_eq!((report.triangles, report.change), (10_200, 0.0));
    assert_eq!(objects[1].level_at(0.0), 6);
    assert_eq!(objects[1].parameter_at(0.0), f32::INFINITY);
}

#[test]
fn important_objects_are_finer_on_both_sides() {
    let stairs = stairs();
    let plain = StairObject::new(&stairs, 0.5);
    let important = plain.with_importance(3.0);
    for bias in [-0.3, 0.3] {
        assert!(important.parameter_at(bias) < plain.parameter_at(bias));
    }
    for nonsense in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(plain.with_importance(nonsense).parameter_at(0.3), plain.parameter_at(0.3));
    }
}

/// Triangles of each frame.
struct Run {
    drawn: Vec<usize>,
    stops: Vec<BiasStop>,
}

fn fly(path: fn(usize) -> Pose, options: BiasOptions) -> Run {
    let (crowd, stairs) = (Crowd::new(10), stairs());
    let mut bias = Bias::new(options).unwrap();
    let (mut objects, mut run) = (Vec::new(), Run { drawn: Vec::new(), stops: Vec::new() });
    for frame in 0..FRAMES {
        crowd.objects(&stairs, path(frame), &mut objects);
        let before = bias.bias();
        let report = bias.update(&objects, true);
        let moved = (bias.bias() - before).abs();
        let free = options.free_in_motion;
        assert!(free || options.change.is_none_or(|most| moved <= most * (1.0 + 1e-12)), "{moved}");
        let counted: usize = objects
            .iter()
            .filter(|object| object.sight != Sight::Culled)
            .map(|object| stairs.triangles(object.level_at(bias.bias())))
            .sum();
        assert_eq!(report.triangles, counted);
        run.drawn.push(report.triangles);
        run.stops.push(report.stop);
    }
    run
}

#[test]
fn a_circle_is_inside_the_tolerance_from_the_tenth_frame_on() {
    let tolerance = stairs().largest_step();
    for change in [0.01, 0.1] {
        let options =
            BiasOptions::default().with_triangles(1_000_000).with_tolerance(tolerance).with_change(change);
        let run = fly(circle, options);
        let outside =
            run.drawn.iter().enumerate().skip(10).find(|(_, drawn)| drawn.abs_diff(1_000_000) > tolerance);
        assert_eq!(outside, None, "at {change}");
    }
}

#[test]
fn a_path_through_the_middle_is_back_inside_within_ten_frames() {
    let tolerance = stairs().largest_step();
    let options = BiasOptions::default().with_triangles(1_000_000).with_tolerance(tolerance).with_change(0.1);
    let run = fly(through, options);
    let mut above = 0;
    let (mut longest, mut exhausted) = (0, 0);
    for (drawn, stop) in run.drawn.iter().zip(&run.stops) {
        above = if *drawn > 1_000_000 + tolerance { above + 1 } else { 0 };
        longest = longest.max(above);
        exhausted += usize::from(*stop == BiasStop::Exhausted);
    }
    assert!((1..=10).contains(&longest), "{longest} frames above");
    assert!(exhausted > 5, "{exhausted} frames see fewer triangles than are wanted");
    // The slow limit takes longer: popping against frame time.
    let slow = fly(through, options.with_change(0.01));
    let above = |run: &Run| run.drawn.iter().filter(|&&drawn| drawn > 1_000_000 + tolerance).count();
    assert!(above(&slow) > above(&run));
    // Free in motion: never above.
    assert_eq!(above(&fly(through, options.with_free_in_motion(true))), 0);
}

#[test]
fn a_still_scene_comes_to_rest() {
    let (crowd, stairs) = (Crowd::new(10), stairs());
    let mut objects = Vec::new();
    crowd.objects(&stairs, circle(0), &mut objects);
    for wanted in [0, 150_000, 1_000_000, 3_000_000, 20_000_000] {
        let options = BiasOptions::default().with_triangles(wanted).with_change(None);
        let mut bias = Bias::new(options).unwrap();
        bias.update(&objects, false);
        assert_eq!(bias.update(&objects, false).change, 0.0);
    }
}

proptest! {
    /// At the bias that an object names, it has changed its level, in spite of rounding.
    #[test]
    fn an_object_has_changed_at_the_bias_it_names(
        parameter in -3.0_f32..3.0, importance in 1e-3_f32..1e3, bias in -2.0_f64..2.0,
    ) {
        let stairs = stairs();
        let object = StairObject::new(&stairs, parameter).with_importance(importance);
        for toward in [Toward::Coarse, Toward::Fine] {
            let Some(crossing) = object.next(bias, toward) else { continue };
            let [before, after] = [bias, crossing.bias].map(|bias| object.triangles(bias));
            prop_assert_eq!(before.abs_diff(after), crossing.triangles);
            prop_assert!(crossing.triangles > 0);
        }
    }
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -1.0_f32..2.0,
        1 => prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1e30, -1e30, 1e-40])
    ]
}

proptest! {
    /// On any objects: the bias moves in one direction within the limit, never past the number wanted and the tolerance toward fine,
    /// toward coarse as little as it can; the same calls give the same results.
    #[test]
    fn the_bias_moves_no_farther_than_it_must(
        numbers in prop::collection::vec((any_number(), any_number(), 0_u8..6), 0..40),
        wanted in 0_usize..200_000,
        tolerance in 0_usize..10_000,
        change in prop::option::of(1e-3_f64..2.0),
        frames in 1_usize..6,
    ) {
        let stairs = stairs();
        let objects: Vec<_> = numbers
            .iter()
            .map(|&(parameter, importance, sight)| {
                let sight = match sight { 0 => Sight::Hidden, 1 => Sight::Culled, _ => Sight::Seen };
                StairObject::new(&stairs, parameter).with_importance(importance).with_sight(sight)
            })
            .collect();
        let options = BiasOptions::default()
            .with_triangles(wanted)
            .with_tolerance(tolerance)
            .with_change(change);
        let mut bias = Bias::new(options).unwrap();
        let mut again = bias.clone();
        for _ in 0..frames {
            let start = bias.bias();
            let report = bias.update(&objects, false);
            prop_assert_eq!(report, again.update(&objects, false));
            prop_assert!(bias.bias().is_finite());
            let counted: usize = objects.iter().map(|object| object.triangles(bias.bias())).sum();
            prop_assert_eq!(report.triangles, counted);
            if let Some(most) = change {
                prop_assert!(report.change.abs() <= most * (1.0 + 1e-9));
            }
            if report.before.abs_diff(wanted) <= tolerance {
                prop_assert_eq!(report.change, 0.0);
            } else if report.before > wanted {
                prop_assert!(report.change >= 0.0 && report.triangles <= report.before);
                // A little less far is not enough.
                if report.triangles < wanted && report.change > 0.0 && bias.bias().abs() < 1e6 {
                    let at = bias.bias() - 1e-9 * (1.0 + bias.bias().abs());
                    let less: usize = objects.iter().map(|o| o.triangles(at)).sum();
                    prop_assert!(less > wanted || at < start);
                }
            } else {
                prop_assert!(report.change <= 0.0 && report.triangles >= report.before);
                prop_assert!(report.triangles <= wanted + tolerance);
            }
        }
    }

    /// Objects that do not keep the contract: defined results, no panic.
    #[test]
    fn lies_are_survived(
        lies in prop::collection::vec((any::<f64>(), any::<usize>(), any::<usize>()), 0..10),
        wanted in any::<usize>(),
    ) {
        struct Liar(f64, usize, usize);
        impl Controllable for Liar {
            fn triangles(&self, bias: f64) -> usize {
                if bias > self.0 { self.1 } else { self.2 }
            }
            fn next(&self, bias: f64, _: Toward) -> Option<Crossing> {
                Some(Crossing { bias: bias + self.0, triangles: self.1 })
            }
        }
        let objects: Vec<_> = lies.iter().map(|&(a, b, c)| Liar(a, b, c)).collect();
        let mut bias = Bias::new(BiasOptions::default().with_triangles(wanted).with_change(None)).unwrap();
        for _ in 0..3 {
            bias.update(&objects, false);
            prop_assert!(bias.bias().is_finite());
        }
    }
}

#[test]
fn objects_may_be_of_any_kind() {
    let stairs = stairs();
    let objects: [&dyn Controllable; 2] =
        [&StairObject::new(&stairs, 0.2), &Single { at: 0.1, fine: 50, coarse: 3 }];
    let mut bias = Bias::new(BiasOptions::default().with_triangles(5_300).with_tolerance(100)).unwrap();
    assert_eq!(bias.update(&objects, false).triangles, 5_250);
}

#[test]
fn bad_stairs_and_options_are_refused() {
    for (levels, message) in [
        (vec![], "there are no levels: at least 1 is needed"),
        (
            vec![(0.0, 5), (f32::NAN, 4)],
            "level 1 begins at NaN, which is not finite or not above the level before",
        ),
        (
            vec![(0.5, 5), (0.5, 4)],
            "level 1 begins at 0.5, which is not finite or not above the level before",
        ),
        (vec![(0.0, 5), (0.5, 5)], "level 1 has 5 triangles, no fewer than the level before"),
    ] {
        assert_eq!(Stairs::new(&levels).unwrap_err().to_string(), message);
    }
    let two = Stairs::new(&[(0.0, 9), (0.5, 7)]).unwrap();
    assert_eq!([f64::NEG_INFINITY, 0.4, 0.5, f64::NAN].map(|t| two.level(t)), [0, 0, 1, 1]);
    let single = Stairs::new(&[(0.0, 7)]).unwrap();
    let mut bias = Bias::new(BiasOptions::default().with_triangles(0).with_tolerance(0)).unwrap();
    assert_eq!(bias.update(&[StairObject::new(&single, 0.5)], false).stop, BiasStop::Exhausted);
    assert_eq!(bias.update::<StairObject>(&[], false).triangles, 0);
    for change in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Bias::new(BiasOptions::default().with_change(change)).is_err());
    }
    bias.set_bias(f64::NAN);
    assert_eq!(bias.bias(), 0.0);
}
