//! Promise: bounds that are tested many at once get the answers that they get one by one, however near to a limit; and these hold
//! while the eye moves and turns within their slacks.

use multires::view::{Answer, Bounds, Criterion, DeviationBounds, ErrorShape, Factors, ObjectView};
use proptest::prelude::*;

use crate::support::camera::*;

fn each<B>(view: &ObjectView, bounds: &[B], factors: Factors) -> Vec<Answer>
where
    ObjectView: Criterion<B>,
{
    let mut answers = vec![Answer::NEVER; bounds.len()];
    view.test_each(bounds, factors, &mut answers);
    answers
}

/// A value between two, of which one is answered otherwise than the other: the last that is answered as `low` is.
fn limit(low: f32, high: f32, test: impl Fn(f32) -> bool) -> Option<f32> {
    let (mut low, mut high) = (low, high);
    let first = test(low);
    if test(high) == first {
        return None;
    }
    while low.next_up() < high {
        let middle = low + 0.5 * (high - low);
        let middle = if middle > low && middle < high { middle } else { low.next_up() };
        if test(middle) == first { low = middle } else { high = middle }
    }
    Some(low)
}

/// Some values below and above.
fn around(x: f32) -> impl Iterator<Item = f32> {
    let mut values = vec![x];
    let (mut down, mut up) = (x, x);
    for step in 0..12 {
        for _ in 0..1 << step.min(8) {
            (down, up) = (down.next_down(), up.next_up());
        }
        values.extend([down, up]);
    }
    values.into_iter()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    /// Any balls, and those at the limits of every test: moved, grown, and with other errors, until the answer turns over.
    #[test]
    fn many_are_answered_as_one_by_one(
        camera in camera(),
        settings in settings(),
        focus in 0..8,
        balls in prop::collection::vec((ball(), 0..5usize), 1..9),
        (scale, factor) in (0.2f64..20.0, prop_oneof![Just(1.0), 1.0f64..8.0]),
        turning in any::<bool>(),
        away in prop_oneof![Just(0.0f32), 1e2f32..1e6],
    ) {
        let mut settings = settings;
        settings.5 = settings.5.filter(|_| focus == 0);
        // The same far from the origin: less is left of single precision there.
        let camera = Camera { eye: camera.eye.map(|x| x + f64::from(away)), ..camera };
        let view = set(camera.view(), settings).of_world();
        let factors = Factors { turning: turning.then_some(scale), budget: factor };
        let scale = factors.turning.unwrap_or(1.0);
        let one = |bounds: &Bounds| view.test_scaled(bounds, scale, factor).refine;
        let mut all: Vec<Bounds> = Vec::new();
        for (ball, which) in balls {
            let plain: Bounds = ball.bounds();
            let plain = Bounds { centre: plain.centre.map(|x| x + away), ..plain };
            let with = |x: f32| match which {
                0..=2 => {
                    let mut centre = plain.centre;
                    centre[which] = x;
                    Bounds { centre, ..plain }
                }
                3 => Bounds { radius: x, ..plain },
                _ => Bounds { error: x, parametric: x, ..plain },
            };
            let (low, high) = match which {
                0..=2 => (away - 4.0, away + 4.0),
                3 => (0.0, 4.0),
                _ => (0.0, 1.0),
            };
            all.push(plain);
            if let Some(limit) = limit(low, high, |x| one(&with(x))) {
                all.extend(around(limit).map(with));
            }
        }
        let answers = each(&view, &all, factors);
        for (bounds, answer) in all.iter().zip(answers) {
            prop_assert_eq!(answer.refine, one(bounds), "{:?} {:?}", bounds, answer);
            prop_assert!(answer.moved >= 0.0 && answer.turned >= 0.0, "{:?}", answer);
        }
    }

    /// The same with errors that look different from elsewhere.
    #[test]
    fn many_deviations_are_answered_as_one_by_one(
        camera in camera(),
        settings in settings(),
        balls in prop::collection::vec((ball(), 0..6usize, 1e-4f32..0.5, 1e-4f32..0.5, any::<bool>()), 1..9),
        (scale, factor) in (0.2f64..20.0, prop_oneof![Just(1.0), 1.0f64..8.0]),
        turning in any::<bool>(),
    ) {
        let mut settings = settings;
        settings.5 = None;
        let view = set(camera.view(), settings).of_world();
        let factors = Factors { turning: turning.then_some(scale), budget: factor };
        let scale = factors.turning.unwrap_or(1.0);
        let one = |bounds: &DeviationBounds| view.test_scaled(bounds, scale, factor).refine;
        let mut all = Vec::new();
        for (ball, which, along, across, spheroid) in balls {
            let shape = if spheroid { ErrorShape::Spheroid } else { ErrorShape::SphereAndCones };
            let plain = DeviationBounds::new(ball.centre.map(|x| x as f32), ball.radius as f32, shape);
            let plain = DeviationBounds { along, across, ..plain.with_cone(ball.axis, ball.angle) };
            let with = |x: f32| match which {
                0..=2 => {
                    let mut centre = plain.centre;
                    centre[which] = x;
                    DeviationBounds { centre, ..plain }
                }
                3 => DeviationBounds { radius: x, ..plain },
                4 => DeviationBounds { along: x, ..plain },
                _ => DeviationBounds { across: x, ..plain },
            };
            let (low, high) = match which {
                0..=2 => (-4.0, 4.0),
                3 => (0.0, 4.0),
                _ => (0.0, 1.0),
            };
            all.push(plain);
            if let Some(limit) = limit(low, high, |x| one(&with(x))) {
                all.extend(around(limit).map(with));
            }
        }
        let answers = each(&view, &all, factors);
        for (bounds, answer) in all.iter().zip(answers) {
            prop_assert_eq!(answer.refine, one(bounds), "{:?} {:?}", bounds, answer);
            prop_assert!(answer.moved >= 0.0 && answer.turned >= 0.0, "{:?}", answer);
        }
    }

    /// Answers from lanes are no vaguer than they must be: nearly the slacks of double precision, where one test decides.
    #[test]
    fn slacks_are_nearly_those_of_one_by_one(camera in camera(), balls in prop::collection::vec(ball(), 8)) {
        let view = camera.view().with_frustum(false).with_back_faces_culled(false).of_world();
        let bounds: Vec<Bounds> = balls.iter().map(Ball::bounds).collect();
        for (bounds, many) in bounds.iter().zip(each(&view, &bounds, Factors::NONE)) {
            let one = view.test(bounds);
            prop_assert!(many.moved <= one.moved * (1.0 + 1e-5) + 1e-7, "{:?} {:?}", many, one);
            prop_assert!(many.moved >= one.moved * (1.0 - 1e-4) - 1e-4, "{:?} {:?}", many, one);
        }
    }
}

/// Numbers that single precision does not hold, and what is no number.
#[test]
fn extreme_numbers_are_answered_as_one_by_one() {
    let camera = Camera { eye: [0.0, 0.0, 2.0], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
    let numbers = [
        0.0,
        -1.0,
        1e-45,
        1e-38,
        1e-30,
        1e-6,
        0.5,
        1.0,
        2.0,
        1e6,
        1e19,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    let mut all = Vec::new();
    for radius in numbers {
        for error in numbers {
            for z in [0.0, 2.0, -1e30, 3.0, f32::NAN] {
                for cone in [[0, 0, 0, -1], [0, 0, 127, 0], [0, 0, -127, 0], [127, 0, 0, 100], [0, 0, 0, 9]] {
                    let bounds = Bounds::new([0.0, 0.0, z], radius, error, error);
                    all.push(Bounds { cone, ..bounds });
                }
            }
        }
    }
    for tolerance in [0.0, 1e-30, 1.0, f32::INFINITY] {
        for silhouette in [None, Some(0.0), Some(0.5)] {
            let view = set(camera.view(), (tolerance, silhouette, true, true, false, None)).of_world();
            for (bounds, answer) in all.iter().zip(each(&view, &all, Factors::NONE)) {
                assert_eq!(answer.refine, view.test(bounds).refine, "{tolerance} {silhouette:?} {bounds:?}");
            }
            let factors = Factors { turning: Some(1.5), budget: 1.0 };
            for (bounds, answer) in all.iter().zip(each(&view, &all, factors)) {
                assert_eq!(answer.refine, view.test_turning(bounds, 1.5, 1.0).refine, "{bounds:?}");
            }
        }
    }
}
