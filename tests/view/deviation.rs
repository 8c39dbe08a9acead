//! Views answer for errors with a direction: nothing that looks too large is left out, tests are nested, slacks are honest,
//! urgencies are factors.

use multires::view::{Bounds, Criterion, DeviationBounds, ErrorKind, ErrorShape, View};
use proptest::prelude::*;

use crate::support::camera::*;

/// A ball with a cone, and what error vectors there are: along the axis, across it, and in which shape.
type Deviation = (Ball, f64, f64, bool);

fn deviation() -> impl Strategy<Value = Deviation> {
    let size = || prop_oneof![6 => (-6.0f64..0.0).prop_map(|x| 10f64.powf(x)), 1 => Just(0.0)];
    (ball(), size(), size(), any::<bool>())
}

fn bounds((ball, along, across, spheroid): Deviation) -> DeviationBounds {
    let shape = if spheroid { ErrorShape::Spheroid } else { ErrorShape::SphereAndCones };
    let (along, across) = (along as f32, across as f32);
    let empty = DeviationBounds::new(ball.centre.map(|x| x as f32), ball.radius as f32, shape);
    DeviationBounds { along, across, ..empty.with_cone(ball.axis, ball.angle) }
}

/// Half of what the shape spans across a line of sight, from its support function, by looking at directions beside it.
fn spans(bounds: &DeviationBounds, sight: V) -> f64 {
    let (a, b) = (f64::from(bounds.along), f64::from(bounds.across));
    let axis = bounds.axis().unwrap();
    let aside = add(axis, sight, -dot(axis, sight));
    let widest = if length(aside) > 1e-9 { unit(aside) } else { beside(sight)[0] };
    let [other, _] = beside(sight);
    [widest, cross(sight, widest), other]
        .map(|way| {
            let cosine = dot(axis, way).abs().min(1.0);
            match bounds.shape {
                ErrorShape::Spheroid => (a * a * cosine * cosine + b * b * (1.0 - cosine * cosine)).sqrt(),
                _ => b.max(a * cosine),
            }
        })
        .into_iter()
        .fold(0.0, f64::max)
}

/// Pixels of a unit at distance 1.
fn pixels() -> f64 {
    240.0 / (f64::from(FOV) * 0.5).tan()
}

fn open(camera: &Camera) -> View {
    camera.view().with_frustum(false).with_back_faces_culled(false)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Refined exactly where the shape may span more than the tolerance at the nearest point, seen along any line of sight to
    /// the sphere.
    #[test]
    fn nothing_that_looks_too_large_is_left_out(
        camera in camera(),
        with in deviation(),
        tolerance in 0.1f64..10.0,
        points in prop::collection::vec(vector(1.0), 60),
    ) {
        let bounds = bounds(with);
        let ball = with.0;
        let answer = open(&camera).with_tolerance_px(tolerance as f32).of_world().test(&bounds);
        let gap = length(add(ball.centre, camera.eye, -1.0)) - ball.radius;
        prop_assume!(gap.abs() > 1e-3);
        if gap < 0.0 {
            prop_assert_eq!(answer.refine, bounds.largest_error() > 0.0);
            return Ok(());
        }
        // Lines of sight to points of the sphere, those on its rim in the plane of the axis among them.
        let to = add(ball.centre, camera.eye, -1.0);
        let half = (ball.radius / length(to)).asin();
        let axis = bounds.axis().unwrap();
        let about = unit(cross(unit(to), axis));
        let rim = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| turned(unit(to), about, share * half));
        let others = points.into_iter().map(|way| unit(add(to, way, ball.radius / length(way).max(1.0))));
        let sights: Vec<V> = rim.into_iter().chain(others).collect();
        let mut most = sights.iter().map(|sight| spans(&bounds, *sight)).fold(0.0, f64::max);
        let reach = pixels() / tolerance;
        let margin = 1e-4 * (1.0 + gap);
        if most * reach > gap + margin {
            prop_assert!(answer.refine, "{most} {gap}");
        }
        // And no more than that: where a right angle to the axis is among the lines of sight, all of it is seen.
        if dot(rim[0], axis) * dot(rim[4], axis) <= 0.0 {
            most = f64::from(bounds.across.max(bounds.along));
        }
        if bounds.along >= bounds.across || bounds.shape == ErrorShape::Spheroid {
            if bounds.along < bounds.across {
                most = f64::from(bounds.across);
            }
            prop_assert!(!answer.refine || most * reach > gap - margin, "{most} {gap}");
        }
    }

    /// Which error a view goes by does not matter; and as large in all directions, it is as for other bounds.
    #[test]
    fn balls_are_errors(camera in camera(), with in deviation(), settings in settings(), spheroid in any::<bool>()) {
        let (ball, error, ..) = with;
        let round = bounds((ball, error, error, spheroid));
        let plain = Bounds { error: error as f32, parametric: error as f32, ..ball.bounds() };
        let view = set(camera.view(), settings);
        let [a, b] = [ErrorKind::Geometric, ErrorKind::Parametric].map(|kind| view.clone().with_error(kind).of_world());
        prop_assert_eq!(a.test(&bounds(with)), b.test(&bounds(with)));
        prop_assert_eq!(a.test(&round), a.test(&plain));
        prop_assert_eq!(a.urgency(&round), a.urgency(&plain));
        prop_assert_eq!(a.sees(&round), a.sees(&plain));
    }

    /// What is needed is needed with larger bounds, and is no less urgent.
    #[test]
    fn tests_are_nested(
        camera in camera(),
        settings in settings(),
        with in deviation(),
        (way, out, more, wider, worse) in (vector(1.0), 0.0..1.0, 0.0..1.0, 0.0..1.0, (0.5f64..2.0, 0.5f64..2.0)),
        turn in -0.5f64..0.5,
    ) {
        let view = set(camera.view(), settings).of_world();
        let (inner, along, across, spheroid) = with;
        let small = bounds(with);
        let apart = out * inner.radius;
        let turn = turn * wider;
        let outer = Ball {
            centre: add(inner.centre, unit(way), apart).map(|x| f64::from(x as f32)),
            radius: (inner.radius + apart) * 1.0001 + more * more + 1e-6,
            axis: turned(inner.axis, beside(inner.axis)[0], turn),
            angle: inner.angle + turn.abs() + 0.1,
            ..inner
        };
        let mut large = bounds((outer, along * worse.0, across * worse.1, spheroid));
        large.hold_errors_of(&small);
        prop_assert!(large.contains(&small));
        prop_assert!(view.test(&large).refine || !view.test(&small).refine, "{:?} {:?}", view.test(&large), view.test(&small));
        prop_assert!(view.urgency(&large) >= view.urgency(&small), "{} {}", view.urgency(&large), view.urgency(&small));
        prop_assert!(view.sees(&large) || !view.sees(&small));
    }

    /// A refinement is needed exactly up to its urgency.
    #[test]
    fn urgency_is_the_factor(camera in camera(), settings in settings(), with in deviation(), factor in 1.0f64..100.0) {
        let view = set(camera.view(), settings).of_world();
        let bounds = bounds(with);
        let urgency = view.urgency(&bounds);
        prop_assert_eq!(view.test(&bounds).refine, urgency > 1.0);
        for factor in [factor, urgency * 0.999, urgency * 1.001] {
            if factor >= 1.0 && (factor - urgency).abs() > 1e-6 * urgency {
                prop_assert_eq!(view.test_at(&bounds, factor).refine, urgency > factor, "{} {}", urgency, factor);
            }
        }
    }

    /// While a move and a turn together stay within the slack, so does the answer: to and from the sphere, around it, along the
    /// axis, and anywhere.
    #[test]
    fn slacks_are_honest(
        camera in camera(),
        settings in settings(),
        with in deviation(),
        share in 0.0f64..1.0,
        anywhere in prop::collection::vec(vector(1.0), 8),
        any_axis in vector(1.0),
    ) {
        let before = set(camera.view(), settings).of_world();
        let (ball, bounds) = (with.0, bounds(with));
        let answer = before.test(&bounds);
        prop_assert!(answer.moved >= 0.0 && answer.turned >= 0.0);
        // Nearer than that the rounding of matrices decides.
        prop_assume!(answer.moved > 1e-4);
        let to = unit(add(ball.centre, camera.eye, -1.0));
        let axis = bounds.axis().unwrap();
        let around = unit(add(axis, to, -dot(axis, to)));
        let halfway = |a: V, b: V, sign: f64| unit(add(a, b, sign));
        let mut ways = vec![[0.0; 3], to, around, axis, halfway(to, around, 1.0), halfway(to, around, -1.0)];
        ways.extend(anywhere.into_iter().map(unit));
        let [right, left, up, down, _] = camera.normals();
        ways.extend([right, left, up, down]);
        let axes = [camera.axes[0], camera.axes[1], unit(any_axis)];
        for share in [0.0, share, 1.0] {
            let rest = if answer.turned.is_finite() { share } else { 1.0 };
            let far = if answer.moved.is_finite() { answer.moved * rest * 0.98 - 1e-5 } else { 10.0 };
            let angle = if answer.turned.is_finite() { answer.turned * (1.0 - share) * 0.98 - 1e-5 } else { 3.0 };
            let (far, angle) = (far.max(0.0), angle.max(0.0));
            for (way, axis) in ways.iter().flat_map(|way| axes.map(|axis| (way, axis))) {
                for (far, angle) in [(far, angle), (-far, angle), (far * 0.5, -angle), (-far * 0.7, -angle)] {
                    let now = Camera {
                        eye: add(camera.eye, *way, far),
                        axes: camera.axes.map(|a| turned(a, axis, angle)),
                    };
                    // The ball of focus goes with the eye.
                    let mut with = settings;
                    with.5 = with.5.map(|(centre, radius)| (add(centre, *way, far), radius));
                    let later = set(now.view(), with).of_world().test(&bounds);
                    prop_assert!(
                        later.refine == answer.refine,
                        "{:?} then {:?} after {} along {:?} and {} about {:?}", answer, later, far, way, angle, axis
                    );
                }
            }
        }
    }

    /// Orthographic views: it is the angle to the direction of view that counts.
    #[test]
    fn orthographic_views_look_along_one_direction(camera in camera(), with in deviation(), half in 0.5f32..4.0) {
        let wide = half * VIEWPORT[0] as f32 / VIEWPORT[1] as f32;
        let flat = [[1.0 / wide, 0.0, 0.0, 0.0], [0.0, 1.0 / half, 0.0, 0.0], [0.0, 0.0, -0.01, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let view = View::from_projection(camera.matrix(), flat, VIEWPORT).unwrap();
        let view = view.with_tolerance_px(0.5).with_frustum(false).with_back_faces_culled(false).of_world();
        let bounds = bounds(with);
        let forward = camera.axes[2].map(|x| -x);
        let least_to_most = spans(&bounds, forward) * 480.0 / f64::from(half);
        prop_assume!((least_to_most - 1.0).abs() > 1e-3);
        prop_assert_eq!(view.test(&bounds).refine, least_to_most > 1.0);
        prop_assert_eq!(view.test(&bounds).moved, f64::INFINITY);
        prop_assert_eq!(view.urgency(&bounds) > 1.0, view.test(&bounds).refine);
    }
}

/// Along the normal one does not see an error along the normal, from the side one does; and for errors within the surface it
/// makes no difference.
#[test]
fn what_one_looks_along_is_short() {
    let up = [0.0, 0.0, 1.0];
    let refines = |eye: [f32; 3], along: f32, across: f32| {
        let matrix = multires::view::look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
        let view = View::perspective(matrix, FOV, VIEWPORT).unwrap().with_back_faces_culled(false).of_world();
        let bounds = DeviationBounds::new([0.0; 3], 0.01, ErrorShape::Spheroid).with_cone(up, 0.2);
        view.test(&DeviationBounds { along, across, ..bounds }).refine
    };
    let visible = 20.0 / pixels() as f32;
    assert!(!refines([0.0, 0.0, 10.0], visible, 0.0) && refines([10.0, 0.0, 0.0], visible, 0.0));
    assert!(refines([0.0, 0.0, 10.0], 0.0, visible) && refines([10.0, 0.0, 0.0], 0.0, visible));
}
