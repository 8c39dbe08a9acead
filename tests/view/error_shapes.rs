//! Shapes around error vectors hold what they are made for, say rightly which holds which, and grow by no more than they must.

use multires::view::{DeviationBounds, ErrorShape};
use proptest::prelude::*;

use crate::support::camera::{V, add, beside, cross, dot, length, turned, unit, vector};

const SHAPES: [ErrorShape; 2] = [ErrorShape::Spheroid, ErrorShape::SphereAndCones];

fn with(shape: ErrorShape, axis: V, along: f32, across: f32) -> DeviationBounds {
    DeviationBounds { along, across, ..DeviationBounds::new([0.0; 3], 1.0, shape).with_cone(axis, 2.0) }
}

/// How far a shape reaches in a direction, from the definition.
fn support(bounds: &DeviationBounds, way: V) -> f64 {
    let (a, b) = (f64::from(bounds.along), f64::from(bounds.across));
    let Some(axis) = bounds.axis() else { return a.max(b) };
    let cosine = dot(axis, way).abs().min(1.0);
    match bounds.shape {
        ErrorShape::Spheroid => (a * a * cosine * cosine + b * b * (1.0 - cosine * cosine)).sqrt(),
        _ => b.max(a * cosine),
    }
}

/// Lengths of all sizes, and none.
fn size() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0.01f32..10.0, 2 => (-6.0f32..2.0).prop_map(|x| 10f32.powf(x)), 1 => Just(0.0f32)]
}

fn axis() -> impl Strategy<Value = V> {
    prop_oneof![vector(1.0), Just([0.0, 0.0, 1.0]), Just([0.0, 1.0, 0.0]), Just([0.6, 0.0, 0.8])]
        .prop_map(unit)
}

/// A second axis: near the first, the same, or any.
fn axes() -> impl Strategy<Value = [V; 2]> {
    (axis(), axis(), prop_oneof![Just(0.0), 0.0..0.2, Just(9.0)])
        .prop_map(|(a, b, near)| [a, if near < 1.0 { turned(a, beside(a)[0], near) } else { b }])
}

/// Directions that matter: about both axes and in their plane, densely near where flanks and axes are.
fn ways(a: &DeviationBounds, b: &DeviationBounds) -> Vec<V> {
    let Some(first) = a.axis().or(b.axis()) else { return vec![[0.0, 0.0, 1.0]] };
    let second = b.axis().unwrap_or(first);
    let across = add(second, first, -dot(first, second));
    let across = if length(across) > 1e-9 { unit(across) } else { beside(first)[0] };
    let tilt = dot(second, across).atan2(dot(second, first));
    let [x, y] = beside(first);
    let mut ways = vec![x, y, unit(add(x, y, 1.0)), cross(first, across)];
    let fine =
        (0..400).flat_map(|i| [-1.0, 1.0].map(|sign| sign * 10f64.powf(-7.0 + 7.0 * f64::from(i) / 400.0)));
    let quarter = std::f64::consts::FRAC_PI_2;
    for angle in fine {
        for base in [0.0, quarter, tilt, tilt + quarter] {
            let (sine, cosine) = (base + angle).sin_cos();
            ways.push(std::array::from_fn(|i| first[i] * cosine + across[i] * sine));
        }
    }
    ways
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// All vectors are in, the ratio is that of the largest parts, and nothing smaller would do.
    #[test]
    fn the_smallest_of_its_ratio(
        spheroid in any::<bool>(),
        axis in axis(),
        flat in 0usize..3,
        vectors in prop::collection::vec(vector(1.0), 0..12),
        stretch in -3.0f64..3.0,
    ) {
        let shape = SHAPES[usize::from(!spheroid)];
        let bounds = DeviationBounds::new([0.0; 3], 1.0, shape).with_cone(axis, 0.3);
        let axis = bounds.axis().unwrap();
        // Within the surface, along the normal, or both.
        let vectors: Vec<V> = vectors.into_iter().map(|v| {
            let along = dot(v, axis);
            let across = add(v, axis, -along);
            let along = along * 10f64.powf(stretch);
            let axial = axis.map(|x| x * along);
            match flat { 0 => across, 1 => axial, _ => add(across, axial, 1.0) }
        }).collect();
        let made = bounds.with_errors(vectors.iter().copied());
        let parts = |v: &V| { let h = dot(*v, axis).abs(); (h, length(add(*v, axis, -dot(*v, axis)))) };
        let high = vectors.iter().map(|v| parts(v).0).fold(0.0, f64::max);
        let wide = vectors.iter().map(|v| parts(v).1).fold(0.0, f64::max);
        let (a, b) = (f64::from(made.along), f64::from(made.across));
        prop_assert!(a >= high * (1.0 - 1e-6) && b >= 0.0 && (b + 1e-12 >= wide * (1.0 - 1e-6) || !spheroid || flat == 1));
        if flat == 2 && vectors.len() > 1 && high > wide {
            let ratio = high / wide;
            if spheroid {
                // Between a ball and the ratio of the largest parts; and it looks no larger than either.
                prop_assert!(a >= b * (1.0 - 1e-6) && a <= b * ratio * (1.0 + 1e-6), "{a} {b} {ratio}");
                let looks = |a: f64, b: f64| b * b / 3.0 + a * a * 2.0 / 3.0;
                let across = vectors.iter().map(|v| (parts(v).0 / ratio).hypot(parts(v).1)).fold(0.0, f64::max);
                let radius = vectors.iter().map(|v| length(*v)).fold(0.0, f64::max);
                prop_assert!(looks(a, b) <= looks(across * ratio, across).min(looks(radius, radius)) * (1.0 + 1e-5));
            } else {
                prop_assert!((a * wide - b * high).abs() <= 1e-5 * a * wide, "{a} {b} {high} {wide}");
            }
        }
        if flat == 2 && high <= wide && high > 0.0 {
            prop_assert!(a == b, "oblate: {a} {b}");
        }
        // Out of a convex shape where a direction separates it; of all directions in the vector's plane, those of flanks too.
        let outside = |bounds: &DeviationBounds, v: &V, room: f64| {
            let (h, t) = parts(v);
            let (a, b) = (f64::from(bounds.along), f64::from(bounds.across));
            if spheroid && a > 1e-9 * b && b > 1e-9 * a {
                return (h / a).hypot(t / b) > 1.0 + room;
            }
            let across = if t > 1e-8 { unit(add(*v, axis, -dot(*v, axis))) } else { beside(axis)[0] };
            let flank = (b / a.max(1e-30)).min(1.0).acos();
            (0..2000).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_2 / 1999.0).chain([flank]).any(|angle| {
                let (sine, cosine) = angle.sin_cos();
                let way = std::array::from_fn(|i| axis[i] * cosine + across[i] * sine);
                h * cosine + t * sine > support(bounds, way) * (1.0 + room) + 1e-9 * (high + wide) + 1e-30
            })
        };
        prop_assert!(vectors.iter().all(|v| !outside(&made, v, 1e-6)), "{made:?}");
        let smaller = DeviationBounds { along: made.along * 0.99, across: made.across * 0.99, ..made };
        if made.largest_error() > 1e-6 && flat == 2 {
            prop_assert!(vectors.iter().any(|v| outside(&smaller, v, 0.0)), "{made:?}");
        }
    }

    /// One holds another exactly where its support function is nowhere smaller.
    #[test]
    fn holding_is_support(
        shapes in (0usize..2, 0usize..2),
        axes in axes(),
        sizes in (size(), size(), size(), size()),
    ) {
        let outer = with(SHAPES[shapes.0], axes[0], sizes.0, sizes.1);
        let inner = with(SHAPES[shapes.1], axes[1], sizes.2, sizes.3);
        prop_assert!(outer.contains(&outer) && inner.contains(&inner));
        let scale = f64::from(outer.largest_error().max(inner.largest_error()));
        let beyond = ways(&outer, &inner).into_iter().map(|way| support(&inner, way) - support(&outer, way));
        let beyond = beyond.fold(f64::NEG_INFINITY, f64::max);
        if outer.contains(&inner) {
            prop_assert!(beyond <= 1e-7 * scale, "{beyond} {outer:?} {inner:?}");
        } else if shapes != (1, 0) {
            // Sampled directions may just miss where it sticks out.
            prop_assert!(beyond >= -1e-4 * scale, "{beyond} {outer:?} {inner:?}");
        }
    }

    /// Grown, it holds the other; it never shrinks; and no other choice would have grown it much less.
    #[test]
    fn growth_is_enough_and_little(
        shapes in (0usize..2, 0usize..2),
        axes in axes(),
        sizes in (size(), size(), size(), size()),
        trials in prop::collection::vec((0.0f32..1.0, 0.0f32..1.0), 40),
    ) {
        let before = with(SHAPES[shapes.0], axes[0], sizes.0, sizes.1);
        let other = with(SHAPES[shapes.1], axes[1], sizes.2, sizes.3);
        let mut grown = before;
        grown.hold_errors_of(&other);
        prop_assert!(grown.contains(&other) && grown.contains(&before), "{before:?} {other:?} {grown:?}");
        prop_assert!(grown.along >= before.along && grown.across >= before.across);
        prop_assert!(!before.contains(&other) || grown == before, "{before:?} {other:?} {grown:?}");
        // A ball would do, about.
        let ball = other.largest_error() * 1.000_001;
        prop_assert!(grown.along <= before.along.max(ball) * 1.5 && grown.across <= before.across.max(ball) * 1.5);
        let cost = |bounds: &DeviationBounds| f64::from(bounds.along).powi(2) + 2.0 * f64::from(bounds.across).powi(2);
        // Between what it was and what holds both anyhow.
        let most = before.along.max(ball);
        let room = if shapes == (0, 0) { 1.0 - 1e-4 } else { 0.9 };
        for (a, b) in trials {
            let along = before.along + (2.0 * most - before.along) * a;
            let across = before.across + (ball - before.across).max(0.0) * b;
            let candidate = DeviationBounds { along, across, ..before };
            if shapes.0 == shapes.1 && candidate.contains(&other) {
                prop_assert!(cost(&candidate) >= cost(&grown) * room, "{candidate:?} {grown:?}");
            }
        }
    }

    /// Without an axis it is a ball.
    #[test]
    fn without_an_axis_a_ball(which in 0usize..2, vectors in prop::collection::vec(vector(3.0), 1..8), axis in axis()) {
        let longest = vectors.iter().map(|v| length(*v)).fold(0.0, f64::max);
        let bounds = DeviationBounds::new([0.0; 3], 1.0, SHAPES[which]).with_errors(vectors.iter().copied());
        prop_assert!(bounds.axis().is_none() && bounds.cone().is_none());
        prop_assert!(bounds.along == bounds.across);
        prop_assert!((f64::from(bounds.along) - longest).abs() <= 1e-6 * longest && f64::from(bounds.along) >= longest);
        let small = with(SHAPES[which], axis, bounds.along, 0.5 * bounds.across);
        let mut grown = DeviationBounds::new([0.0; 3], 1.0, SHAPES[which]);
        prop_assert!(bounds.contains(&small) && !grown.contains(&small));
        grown.hold_errors_of(&small);
        prop_assert!(grown.contains(&small) && grown.along == grown.across && grown.along == small.along);
        prop_assert!(!with(SHAPES[which], axis, bounds.along, 0.0).contains(&bounds));
    }
}

#[test]
fn an_axis_is_kept_where_normals_go_everywhere() {
    let bounds = DeviationBounds::new([0.0; 3], 1.0, ErrorShape::Spheroid).with_cone([0.0, 0.0, 2.0], 3.0);
    assert_eq!((bounds.cone(), bounds.axis()), (None, Some([0.0, 0.0, 1.0])));
    let narrow = bounds.with_cone([0.0, 3.0, 0.0], 0.0);
    assert_eq!(narrow.cone(), Some(([0.0, 1.0, 0.0], 0.0)));
    assert_eq!(bounds.with_cone([0.0; 3], 0.1).axis(), None);
    assert!(bounds.contains(&narrow) && !narrow.contains(&bounds));
    let far = DeviationBounds { centre: [0.5, 0.0, 0.0], radius: 0.6, ..bounds };
    assert!(!bounds.contains(&far) && bounds.contains(&DeviationBounds { radius: 0.5, ..far }));
}

#[test]
fn purely_normal_and_purely_tangential_errors() {
    for shape in SHAPES {
        let fit = |vectors: &[(f64, f64)]| shape.fit(vectors.iter().copied());
        assert_eq!(fit(&[]), [0.0, 0.0]);
        assert_eq!(fit(&[(3.0, 0.0), (-5.0, 0.0)]), [5.0, 0.0]);
        assert_eq!(fit(&[(f64::NAN, 0.0)]), [f32::MAX, 0.0]);
        assert!(fit(&[(f64::INFINITY, 1.0), (1.0, f64::NAN)]).iter().all(|x| x.is_finite() && *x >= 1e38));
    }
    assert_eq!(ErrorShape::Spheroid.fit([(0.0, 2.0)].into_iter()), [0.0, 2.0]);
    assert_eq!(ErrorShape::SphereAndCones.fit([(0.0, 2.0), (1.0, 0.0)].into_iter()), [2.0, 2.0]);
    // Half way between: a tip at (2, 0) and a ball of radius 1 hold both, and (1, 1/sqrt(3)) on the flank.
    let [along, across] =
        ErrorShape::SphereAndCones.fit([(2.0, 0.0), (0.0, 1.0), (1.0, 3f64.sqrt().recip())].into_iter());
    assert!((along - 2.0).abs() < 1e-6 && (across - 1.0).abs() < 1e-6);
}
