//! Promise: needles in, needles out. Thin triangles stop no simplification and cost no accuracy; what makes new ones waits
//! while there is a choice; and nothing folds.
#![cfg(feature = "quality")]

use crate::strips::*;
use multires::mesh::{Mesh, shapes};
use multires::quality::volume;
use multires::simplify::oracle::TriangleQuality;
use multires::simplify::{CollapseSequence, Simplifier, StopReason, Target};

fn to(mesh: &Mesh, ratio: f64) -> CollapseSequence {
    Simplifier::new().target(Target::Ratio(ratio)).run(mesh).unwrap()
}

fn level(mesh: &Mesh, sequence: &CollapseSequence) -> Mesh {
    sequence.extract(mesh, sequence.len())
}

fn put_off(sequence: &CollapseSequence) -> u64 {
    let of = |r: &&multires::simplify::Refusal| r.oracle == "triangle quality";
    sequence.report().refusals.iter().find(of).map_or(0, |r| r.count)
}

fn quality(mesh: &Mesh, triangle: [u32; 3]) -> f32 {
    let [p, q, r] = triangle.map(|v| mesh.positions()[v as usize]);
    let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (a, b, c) = (minus(q, p), minus(r, p), minus(r, q));
    let double_area = (dot(a, a) * dot(b, b) - dot(a, b) * dot(a, b)).max(0.0).sqrt();
    2.0 * 3f32.sqrt() * double_area / (dot(a, a) + dot(b, b) + dot(c, c))
}

#[test]
fn a_beam_of_thin_strips_is_exact_down_to_its_box() {
    for sections in [60, 300] {
        let mesh = beam(sections, 1000.0);
        for ratio in [0.5, 0.25, 0.1] {
            let sequence = to(&mesh, ratio);
            let report = sequence.report();
            assert_eq!(report.stop, StopReason::Target, "{sections} sections, {ratio}");
            assert!(report.error < 1e-3, "{sections} sections, {ratio}: error {}", report.error);
            let inside = volume(&level(&mesh, &sequence)).unwrap();
            assert!((inside - 1000.0).abs() < 1.0, "{sections} sections, {ratio}: volume {inside}");
        }
    }
}

#[test]
fn a_cylinder_of_long_quads_reaches_its_target_as_near_as_a_prism_can() {
    for sides in [500, 2000, 4000] {
        let mesh = cylinder(sides);
        let sequence = to(&mesh, 0.1);
        let report = sequence.report();
        assert_eq!(report.stop, StopReason::Target, "{sides} sides: {:?}", report.refusals);
        // A tenth of the triangles is a tenth of the sides: the sagitta of an even one, radius 10.
        let half_angle = std::f64::consts::PI / (f64::from(sides) / 10.0);
        let sagitta = 10.0 * (1.0 - half_angle.cos());
        let error = f64::from(report.error);
        assert!(error < 6.0 * sagitta, "{sides} sides: {error} of {sagitta}");
    }
}

#[test]
fn a_disc_of_slivers_stays_flat_and_whole() {
    let mesh = sliver_disc(1000);
    let sequence = to(&mesh, 0.1);
    assert_eq!(sequence.report().stop, StopReason::Target);
    let small = level(&mesh, &sequence);
    let share = multires::quality::area(&small) / multires::quality::area(&mesh);
    assert!((0.99..1.001).contains(&share), "area {share}");
    for &t in small.triangles() {
        let [p, q, r] = t.map(|v| small.positions()[v as usize]);
        let turn = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        assert!(turn > 0.0, "{p:?} {q:?} {r:?} is folded");
    }
}

#[test]
fn strict_quality_is_a_rule_like_others() {
    let mesh = beam(60, 1000.0);
    let strict = TriangleQuality::default().strict();
    let sequence = Simplifier::new().oracle(strict).target(Target::Ratio(0.1)).run(&mesh).unwrap();
    let soft = to(&mesh, 0.1);
    assert!(put_off(&sequence) > 0 && put_off(&soft) > 0);
    let small = level(&mesh, &sequence);
    assert!(small.triangles().iter().all(|&t| quality(&small, t) > 0.009));
    assert!(
        sequence.report().stop != StopReason::Target || sequence.report().error > 100.0 * soft.report().error,
        "the beam cannot be exact without needles"
    );
    // What gives way stands nowhere in the way.
    let base = Simplifier::new().run(&mesh).unwrap();
    assert!(base.report().refusals.iter().all(|r| r.oracle != "triangle quality" || r.standing == 0));
}

/// Where there is a choice, few needles are made: on surfaces without any.
#[test]
fn even_surfaces_get_few_needles() {
    for mesh in [shapes::terrain(64, 3), shapes::rock(8000, 2), shapes::plane(60)] {
        let all = mesh.triangles().len();
        for ratio in [0.3, 0.1] {
            let small = level(&mesh, &to(&mesh, ratio));
            let needles = small.triangles().iter().filter(|&&t| quality(&small, t) < 0.01).count();
            let most = small.triangles().len() / 100;
            assert!(needles <= most, "{needles} of {} of {all}", small.triangles().len());
        }
    }
}
