//! Promise: an answer for a factor of tolerances holds while the eye moves and turns and the factor turns within its slack, shared
//! out among the three in any way; be it asked for alone or among many.

use multires::view::{Answer, Bounds, Criterion, DeviationBounds, ErrorShape, Factors, ObjectView, View};
use proptest::prelude::*;

use crate::support::camera::*;

/// Sizes of errors, as `tests/view/deviation.rs` has them.
fn size() -> impl Strategy<Value = f64> {
    prop_oneof![6 => (-6.0f64..0.0).prop_map(|x| 10f64.powf(x)), 1 => Just(0.0)]
}

/// How far the eye moves and turns, and the factor turns: shares of the slack which make 1.
type Shares = [f64; 3];

fn assert_holds<B>(
    camera: &Camera,
    settings: Settings,
    bounds: &B,
    to: V,
    (scale, factor): (f64, f64),
    (shares, any, axis): (Shares, V, V),
) -> Result<(), TestCaseError>
where
    B: Copy,
    ObjectView: Criterion<B>,
{
    let before = set(camera.view(), settings).of_world();
    let alone = before.test_turning(bounds, scale, factor);
    let mut among = [Answer::NEVER; 3];
    let factors = Factors { turning: Some(scale), budget: factor };
    before.test_each(&[*bounds, *bounds, *bounds], factors, &mut among);
    prop_assert!(among.iter().all(|answer| answer.refine == alone.refine));
    let answer = if any[0] > 0.0 { alone } else { among[2] };
    prop_assert_eq!(answer.refine, before.test_scaled(bounds, scale, factor).refine);
    prop_assert!(answer.moved >= 0.0 && answer.turned >= 0.0);
    // Nearer than that the rounding of matrices decides.
    prop_assume!(answer.moved > 1e-4 && answer.turned > 1e-4);
    let whole: f64 = shares.iter().sum();
    let shares = shares.map(|share| share / whole);
    for [moves, turns, scales] in
        [shares, [shares[0], 0.0, 1.0 - shares[0]], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    {
        // A share of 0 of a slack without an end is 0.
        let of = |slack: f64, share: f64, most: f64| (slack.min(1e6) * share * 0.98 - 1e-5).clamp(0.0, most);
        let (far, angle, turn) =
            (of(answer.moved, moves, 10.0), of(answer.turned, turns, 3.0), of(answer.turned, scales, 3.0));
        for way in [to, to.map(|x| -x), any] {
            for turn in [turn, -turn] {
                let now = Camera {
                    eye: add(camera.eye, way, far),
                    axes: camera.axes.map(|a| turned(a, axis, angle)),
                };
                let mut with = settings;
                with.5 = with.5.map(|(centre, radius)| (add(centre, way, far), radius));
                let later = set(now.view(), with).of_world();
                let later = later.test_scaled(bounds, scale * turn.exp(), factor);
                prop_assert!(
                    later.refine == answer.refine,
                    "{answer:?} then {later:?} after {far} along {way:?}, {angle}, and a factor of {}",
                    turn.exp()
                );
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn slacks_of_factors_are_honest(
        camera in camera(),
        settings in settings(),
        (ball, along, across, spheroid) in (ball(), size(), size(), any::<bool>()),
        scale in 0.2f64..20.0,
        factor in prop_oneof![Just(1.0), 1.0f64..8.0],
        shares in [0.01f64..1.0, 0.0f64..1.0, 0.0f64..1.0],
        (any, axis) in (vector(1.0), vector(1.0)),
    ) {
        let to = unit(add(ball.centre, camera.eye, -1.0));
        let how = (shares, unit(any), unit(axis));
        let plain: Bounds = ball.bounds();
        assert_holds(&camera, settings, &plain, to, (scale, factor), how)?;
        let shape = if spheroid { ErrorShape::Spheroid } else { ErrorShape::SphereAndCones };
        let empty = DeviationBounds::new(ball.centre.map(|x| x as f32), ball.radius as f32, shape);
        let deviation = empty.with_cone(ball.axis, ball.angle);
        let deviation = DeviationBounds { along: along as f32, across: across as f32, ..deviation };
        assert_holds(&camera, settings, &deviation, to, (scale, factor), how)?;
    }

    /// Without an eye, only the factor counts.
    #[test]
    fn orthographic_answers_hold_too(
        camera in camera(), ball in ball(), half in 0.5f32..4.0, scale in 0.2f64..20.0, sign in any::<bool>(),
    ) {
        let wide = half * VIEWPORT[0] as f32 / VIEWPORT[1] as f32;
        let flat = [[1.0 / wide, 0.0, 0.0, 0.0], [0.0, 1.0 / half, 0.0, 0.0], [0.0, 0.0, -0.01, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let view = View::from_projection(camera.matrix(), flat, VIEWPORT).unwrap();
        let view = view.with_tolerance_px(0.5).with_frustum(false).with_back_faces_culled(false).of_world();
        let bounds: Bounds = ball.bounds();
        let answer = view.test_turning(&bounds, scale, 1.0);
        prop_assert_eq!(answer.refine, view.test_scaled(&bounds, scale, 1.0).refine);
        // A slack without an end belongs to an error of 0.
        prop_assert_eq!(answer.turned == f64::INFINITY, bounds.error == 0.0);
        let turn = answer.turned.min(3.0) * if sign { 1.0 } else { -1.0 };
        prop_assert_eq!(answer.refine, view.test_scaled(&bounds, scale * turn.exp(), 1.0).refine);
    }
}
