//! Views answer what their definitions say: cameras however they are given, conservative and nested tests, honest slacks.

use multires::view::{Answer, Bounds, Criterion, ErrorKind, Focus, Motion, ObjectView, View, ViewError};
use proptest::prelude::*;

use crate::support::camera::*;

const UNMOVED: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn projection(near: f32, far: Option<f32>, zero_to_one: bool, reversed: bool) -> Matrix {
    let high = 1.0 / (FOV * 0.5).tan();
    let wide = high * VIEWPORT[1] as f32 / VIEWPORT[0] as f32;
    let (mut a, mut b) = match (far, zero_to_one) {
        (Some(far), true) => (far / (near - far), near * far / (near - far)),
        (Some(far), false) => ((far + near) / (near - far), 2.0 * near * far / (near - far)),
        (None, true) => (-1.0, -near),
        (None, false) => (-1.0, -2.0 * near),
    };
    if reversed {
        // 1 - depth.
        (a, b) = (-1.0 - a, -b);
    }
    [[wide, 0.0, 0.0, 0.0], [0.0, high, 0.0, 0.0], [0.0, 0.0, a, -1.0], [0.0, 0.0, b, 0.0]]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Ranges of depth change nothing.
    #[test]
    fn a_projection_is_the_camera_that_it_projects(
        camera in camera(),
        near in 0.01f32..1.0,
        far in prop::option::of(10.0f32..1000.0),
        zero_to_one in any::<bool>(),
        reversed in any::<bool>(),
        balls in prop::collection::vec(ball(), 20),
    ) {
        let view = camera.view();
        let other = View::from_projection(camera.matrix(), projection(near, far, zero_to_one, reversed), VIEWPORT).unwrap();
        let [a, b] = [&view, &other].map(|view| view.eye().unwrap());
        prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5));
        prop_assert!(a.iter().zip(camera.eye).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-4));
        prop_assert!(view.forward().iter().zip(camera.axes[2]).all(|(a, b)| (f64::from(*a) + b).abs() < 1e-5));
        // Pixels of a unit at distance 1: half the viewport over the tangent.
        let pixels = 240.0 / (FOV * 0.5).tan();
        prop_assert!((view.pixels_per_unit(2.0) * 2.0 - pixels).abs() < 1e-3);
        prop_assert!((other.pixels_per_unit(2.0) * 2.0 - pixels).abs() < 1e-3);
        let [view, other] = [view.of_world(), other.of_world()];
        for ball in balls {
            let [a, b] = [&view, &other].map(|view| view.test(&ball.bounds()));
            prop_assert!(a.refine == b.refine || a.moved.min(b.moved) < 1e-4, "{:?} {:?}", a, b);
        }
    }

    /// An object that is turned, moved and scaled sees the view as its image in the world does.
    #[test]
    fn objects_see_what_the_world_sees(
        camera in camera(),
        settings in settings(),
        (axis, angle, at, scale) in (vector(1.0), -3.0..3.0, vector(2.0), -2.0..2.0),
        balls in prop::collection::vec(ball(), 20),
    ) {
        let (axis, scale) = (unit(axis), 10f64.powf(scale));
        let turn = |v: V| turned(v, axis, angle);
        let column = |v: V| { let v = turn(v); [0, 1, 2].map(|i| (v[i] * scale) as f32) };
        let [x, y, z] = [column([1.0, 0.0, 0.0]), column([0.0, 1.0, 0.0]), column([0.0, 0.0, 1.0])];
        let [tx, ty, tz] = at.map(|x| x as f32);
        let matrix = [[x[0], x[1], x[2], 0.0], [y[0], y[1], y[2], 0.0], [z[0], z[1], z[2], 0.0], [tx, ty, tz, 1.0]];
        let view = set(camera.view(), settings);
        let (world, object) = (view.of_world(), view.of_object(matrix).unwrap());
        for inner in balls {
            // Cones lose by packing: none here, but where the axes of both are packed alike.
            let ball = Ball { centre: inner.centre.map(|x| x / scale), radius: inner.radius / scale, error: inner.error / scale, ..inner };
            let image = Ball { centre: add(turn(inner.centre), at, 1.0), ..inner };
            let plain = |ball: &Ball| Bounds { cone: [0, 0, 0, -1], ..ball.bounds() };
            let (a, b) = (object.test(&plain(&ball)), world.test(&plain(&image)));
            prop_assert!(a.refine == b.refine || a.moved.min(b.moved / scale) < 1e-3 * (1.0 + 1.0 / scale), "{:?} {:?}", a, b);
            // With cones: what is clear in one is clear in the other.
            let image = Ball { axis: turn(inner.axis), ..image };
            let (a, b) = (object.test(&ball.bounds()), world.test(&image.bounds()));
            let clear = 0.05 * length(add(image.centre, camera.eye, -1.0)).max(0.1);
            prop_assert!(a.refine == b.refine || (a.moved * scale).min(b.moved) < clear, "{:?} {:?}", a, b);
        }
    }

    /// Whatever an object is stretched and sheared by: a point of it that is in the picture and off by more than the tolerance
    /// in the world is asked for.
    #[test]
    fn stretched_objects_are_never_coarser_than_asked_for(
        camera in camera(),
        columns in prop::array::uniform3(vector(2.0)),
        at in vector(2.0),
        ball in ball(),
        off in vector(1.0),
        samples in prop::collection::vec((vector(1.0), 0.0..1.0, 0.0..6.3, 0.0..1.0), 30),
    ) {
        let [x, y, z] = columns;
        prop_assume!(dot(cross(x, y), z).abs() > 0.05);
        let row = |v: V, last: f32| [v[0] as f32, v[1] as f32, v[2] as f32, last];
        let object = camera.view().of_object([row(x, 0.0), row(y, 0.0), row(z, 0.0), row(at, 1.0)]).unwrap();
        let image = |v: V| add(add(add([0.0; 3], x, v[0]), y, v[1]), z, v[2]);
        let pixels = 240.0 / (f64::from(FOV) * 0.5).tan();
        // By an error of the ball's, in any direction.
        let world_off = image(unit(off).map(|c| c * ball.error));
        for (way, depth, around, aside) in samples {
            let (inner, normal) = ball.sample(way, depth, around, aside);
            let point = add(image(inner), at, 1.0);
            let to = add(point, camera.eye, -1.0);
            let across = add(world_off, to, -dot(world_off, to) / dot(to, to));
            let visible = length(across) * pixels / length(to);
            // Normals go by the inverse transpose: the cofactors.
            let outward = add(
                add(cross(y, z).map(|c| c * normal[0]), cross(z, x), normal[1]),
                cross(x, y),
                normal[2],
            );
            let faces = dot(cross(x, y), z).signum() * dot(outward, to) < -1e-4 * length(outward) * length(to);
            if camera.sees(point, 1e-3) && faces && visible > 1.001 {
                prop_assert!(object.test(&ball.bounds()).refine, "{} pixels", visible);
            }
        }
    }

    /// What has a point in the picture that faces the eye, with an error that is too large there, is needed.
    #[test]
    fn nothing_seen_is_left_out(
        camera in camera(),
        ball in ball(),
        samples in prop::collection::vec((vector(1.0), 0.0..1.0, 0.0..6.3, 0.0..1.0), 30),
    ) {
        let view = camera.view().of_world();
        let blind = camera.view().with_frustum(false).of_world();
        let both_sides = camera.view().with_back_faces_culled(false).of_world();
        let pixels = 240.0 / (f64::from(FOV) * 0.5).tan();
        let bounds = ball.bounds();
        // The error test is its definition: pixels at the nearest point of the sphere.
        let gap = length(add(ball.centre, camera.eye, -1.0)) - ball.radius;
        let large = ball.error * pixels > gap;
        let open = camera.view().with_frustum(false).with_back_faces_culled(false).of_world().test(&bounds);
        prop_assert!(open.refine == large || (gap - ball.error * pixels).abs() < 1e-4 * (1.0 + gap.abs()));
        for (way, depth, around, aside) in samples {
            let (point, normal) = ball.sample(way, depth, around, aside);
            let seen = camera.sees(point, 1e-4);
            let faces = dot(normal, add(camera.eye, point, -1.0)) > 1e-4;
            let huge = Bounds { error: 1e9, ..bounds };
            if seen && faces {
                prop_assert!(view.test(&huge).refine);
                prop_assert!(!large || gap + 1e-4 > ball.error * pixels || view.test(&bounds).refine);
            }
            prop_assert!(!seen || both_sides.test(&huge).refine);
            prop_assert!(!faces || blind.test(&huge).refine);
        }
        // From within the sphere all of it is near, in the picture, and may face the eye.
        if gap < -1e-4 {
            prop_assert!(view.test(&bounds).refine);
        }
    }

    /// What is needed is needed with larger bounds.
    #[test]
    fn tests_are_nested(
        camera in camera(),
        settings in settings(),
        inner in ball(),
        (way, out, more, wider, worse) in (vector(1.0), 0.0..1.0, 0.0..1.0, 0.0..1.0, 1.0..4.0),
    ) {
        let view = set(camera.view(), settings).of_world();
        let small = inner.bounds();
        let apart = out * inner.radius;
        let outer = Ball {
            centre: add(inner.centre, unit(way), apart).map(|x| f64::from(x as f32)),
            radius: (inner.radius + apart) * 1.0001 + more * more + 1e-6,
            axis: turned(inner.axis, beside(inner.axis)[0], 0.4 * wider),
            angle: inner.angle + 0.4 * wider + 0.1,
            error: inner.error * worse,
        };
        let large = outer.bounds();
        prop_assume!(large.contains(&small));
        prop_assert!(view.test(&large).refine || !view.test(&small).refine, "{:?} {:?}", view.test(&large), view.test(&small));
    }

    /// While a move and a turn together stay within the slack, so does the answer, in the directions that matter most: to and from
    /// the sphere, the ball of focus to and from it, across the sides of the picture, along the cone, and about every axis. And what the
    /// view says of its motion is what it did.
    #[test]
    fn slacks_are_honest(
        camera in camera(),
        settings in settings(),
        ball in ball(),
        share in 0.0f64..1.0,
        (any_way, any_axis) in (vector(1.0), vector(1.0)),
    ) {
        let before = set(camera.view(), settings).of_world();
        let bounds = ball.bounds();
        let answer = before.test(&bounds);
        prop_assert!(answer.moved >= 0.0 && answer.turned >= 0.0);
        // Nearer than that the rounding of matrices decides.
        prop_assume!(answer.moved > 1e-4);
        let to = unit(add(ball.centre, camera.eye, -1.0));
        let aside = unit(add(ball.axis, to, -dot(ball.axis, to)));
        let to_focus = settings.5.map_or(to, |focus| unit(add(ball.centre, focus.0, -1.0)));
        let [right, left, up, down, _] = camera.normals();
        let ways = [[0.0; 3], to, aside, to_focus, right, left, up, down, camera.axes[2], unit(any_way)];
        let axes = [camera.axes[0], camera.axes[1], camera.axes[2], unit(any_axis)];
        for share in [0.0, share, 1.0] {
            // Most of each share, so that rounding of matrices does not count. Where only moving wakes, turning is free.
            let rest = if answer.turned.is_finite() { share } else { 1.0 };
            let far = if answer.moved.is_finite() { answer.moved * rest * 0.98 - 1e-5 } else { 10.0 };
            let angle = if answer.turned.is_finite() { answer.turned * (1.0 - share) * 0.98 - 1e-5 } else { 3.0 };
            let (far, angle) = (far.max(0.0), angle.max(0.0));
            let rounding = 1e-4 * (1.0 + far);
            for (way, axis) in ways.iter().flat_map(|way| axes.map(|axis| (way, axis))) {
                for (far, angle) in [(far, angle), (-far, angle), (far, -angle), (-far, -angle)] {
                    let now = Camera {
                        eye: add(camera.eye, *way, far),
                        axes: camera.axes.map(|a| turned(a, axis, angle)),
                    };
                    // The ball of focus goes with the eye.
                    let mut with = settings;
                    with.5 = with.5.map(|(centre, radius)| (add(centre, *way, far), radius));
                    let view = set(now.view(), with).of_world();
                    let later = view.test(&bounds);
                    prop_assert!(
                        later.refine == answer.refine,
                        "{:?} then {:?} after {} along {:?} and {} about {:?}", answer, later, far, way, angle, axis
                    );
                    let Motion::Moved { distance, angle: reported } = view.motion(&before) else {
                        return Err(TestCaseError::fail("another view"));
                    };
                    prop_assert!(distance < length(*way) * far.abs() + rounding && reported < angle.abs() + 1e-4);
                    prop_assert!(distance > length(*way) * far.abs() - rounding);
                    for (a, b) in camera.normals().into_iter().zip(now.normals()) {
                        let turn = length(cross(a, b)).atan2(dot(a, b));
                        prop_assert!(reported > turn - 1e-4);
                    }
                }
            }
        }
    }

    /// Orthographic views: an error is as large everywhere, and what is beside the box is left out.
    #[test]
    fn orthographic_views_see_a_box(camera in camera(), ball in ball(), half in 0.5f32..4.0, tolerance in 0.1f32..10.0) {
        let wide = half * VIEWPORT[0] as f32 / VIEWPORT[1] as f32;
        let flat = [[1.0 / wide, 0.0, 0.0, 0.0], [0.0, 1.0 / half, 0.0, 0.0], [0.0, 0.0, -0.01, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let view = View::from_projection(camera.matrix(), flat, VIEWPORT).unwrap().with_tolerance_px(tolerance);
        prop_assert_eq!(view.eye(), None);
        let pixels = 240.0 / half;
        prop_assert!((view.pixels_per_unit(7.0) - pixels).abs() < 1e-2);
        prop_assert!(view.forward().iter().zip(camera.axes[2]).all(|(a, b)| (f64::from(*a) + b).abs() < 1e-5));
        let bounds = Bounds { cone: [0, 0, 0, -1], ..ball.bounds() };
        let large = ball.error * f64::from(pixels / tolerance);
        let to = add(ball.centre, camera.eye, -1.0);
        let [x, y, _] = camera.axes.map(|axis| dot(axis, to).abs() - ball.radius);
        let (over, beside) = (large - 1.0, (x - f64::from(wide)).max(y - f64::from(half)));
        prop_assume!(over.abs() > 1e-3 && beside.abs() > 1e-3);
        prop_assert_eq!(view.of_world().test(&bounds).refine, over > 0.0 && beside < 0.0);
        // What turns away does so along the direction of view.
        let away = Bounds::new([0.0; 3], 0.1, 1e9, 1e9).with_cone(camera.axes[2].map(|x| -x), 1.2);
        let aside = Bounds::new([0.0; 3], 0.1, 1e9, 1e9).with_cone(camera.axes[0], 0.1);
        let open = view.with_frustum(false).of_world();
        prop_assert!(!open.test(&away).refine && open.test(&aside).refine);
    }

    /// Several views need what any of them needs, for as long as all hold.
    #[test]
    fn several_views_are_any_of_them(cameras in prop::collection::vec((camera(), settings()), 0..4), ball in ball()) {
        let views: Vec<ObjectView> = cameras.iter().map(|(camera, with)| set(camera.view(), *with).of_world()).collect();
        let bounds = ball.bounds();
        let answers: Vec<Answer> = views.iter().map(|view| view.test(&bounds)).collect();
        let all = views[..].test(&bounds);
        prop_assert_eq!(all.refine, answers.iter().any(|answer| answer.refine));
        let same = answers.iter().filter(|answer| answer.refine == all.refine);
        let longest = same.clone().map(|answer| answer.moved).fold(0.0, f64::max);
        let shortest = same.map(|answer| answer.moved).fold(f64::INFINITY, f64::min);
        prop_assert!(all.moved <= longest || views.is_empty());
        prop_assert!(all.refine || all.moved <= shortest);
    }

    /// In the ball of focus everything in the picture is refined, whatever its error, and nothing else more than without.
    #[test]
    fn focus_refines_fully(camera in camera(), ball in ball(), focus in (vector(3.0), 0.1..2.0)) {
        let with = set(camera.view(), (1.0, None, true, false, false, Some(focus))).of_world();
        let without = set(camera.view(), (1.0, None, true, false, false, None)).of_world();
        let large = set(camera.view(), (1e-30, None, true, false, false, None)).of_world();
        let bounds = ball.bounds();
        let gap = length(add(ball.centre, focus.0, -1.0)) - ball.radius - focus.1;
        prop_assume!(gap.abs() > 1e-4);
        let expected = if gap < 0.0 { large.test(&bounds).refine } else { without.test(&bounds).refine };
        prop_assert_eq!(with.test(&bounds).refine, expected);
    }
}

#[test]
fn what_is_no_camera_is_refused() {
    for fov in [0.0, -1.0, 3.2, f32::NAN, f32::INFINITY] {
        assert!(
            matches!(View::perspective(UNMOVED, fov, VIEWPORT), Err(ViewError::FieldOfView { .. })),
            "{fov}"
        );
    }
    for viewport in [[0, 480], [640, 0], [0, 0]] {
        let [width, height] = viewport;
        assert_eq!(View::perspective(UNMOVED, 1.0, viewport), Err(ViewError::Viewport { width, height }));
    }
    let with = |column: usize, row: usize, value: f32| {
        let mut matrix = UNMOVED;
        matrix[column][row] = value;
        matrix
    };
    for bad in [f32::NAN, f32::INFINITY] {
        let matrix = with(3, 1, bad);
        assert_eq!(View::perspective(matrix, 1.0, VIEWPORT), Err(ViewError::NotFinite { which: "view" }));
        let view = View::from_projection(UNMOVED, matrix, VIEWPORT);
        assert_eq!(view, Err(ViewError::NotFinite { which: "projection" }));
        let view = View::perspective(UNMOVED, 1.0, VIEWPORT).unwrap();
        assert_eq!(view.of_object(matrix), Err(ViewError::NotFinite { which: "object" }));
    }
    // Stretched, sheared, flat, and no affine map.
    for matrix in [with(0, 0, 2.0), with(1, 0, 0.5), with(2, 2, 0.0), [[0.0; 4]; 4], with(0, 3, 0.1)] {
        assert_eq!(View::perspective(matrix, 1.0, VIEWPORT), Err(ViewError::NotUniform { which: "view" }));
    }
    let view = View::perspective(UNMOVED, 1.0, VIEWPORT).unwrap();
    for matrix in [[[0.0; 4]; 4], with(0, 3, 0.1), with(3, 3, 2.0)] {
        assert_eq!(view.of_object(matrix), Err(ViewError::NotAffine { which: "object" }));
    }
    for matrix in [with(2, 2, 0.0), with(0, 0, 0.0)] {
        assert_eq!(view.of_object(matrix), Err(ViewError::Singular { which: "object" }));
    }
    // No eye and no direction: nothing across, nothing down, nothing at all.
    for matrix in [with(0, 0, 0.0), with(1, 1, 0.0), [[0.0; 4]; 4], with(3, 3, 0.0)] {
        let view = View::from_projection(UNMOVED, matrix, VIEWPORT);
        assert_eq!(view, Err(ViewError::Singular { which: "projection" }), "{matrix:?}");
    }
}

/// Other settings make another view: no answer given before holds.
#[test]
fn other_settings_are_another_view() {
    let view = View::perspective(UNMOVED, 1.0, VIEWPORT).unwrap();
    let focus = Focus { centre: [0.0; 3], radius: 1.0 };
    let others = [
        view.clone().with_tolerance_px(2.0),
        view.clone().with_silhouette_px(0.5),
        view.clone().with_error(ErrorKind::Parametric),
        view.clone().with_frustum(false),
        view.clone().with_back_faces_culled(false),
        view.clone().with_focus(Some(focus)),
        View::perspective(UNMOVED, 1.1, VIEWPORT).unwrap(),
        View::perspective(UNMOVED, 1.0, [640, 960]).unwrap(),
    ];
    let first = view.of_world();
    assert_eq!(first.motion(&first), Motion::Moved { distance: 0.0, angle: 0.0 });
    for other in others {
        assert_eq!(other.of_world().motion(&first), Motion::Other, "{other:?}");
    }
    assert_eq!(first.coarsened(2.0).motion(&first), Motion::Other);
}
