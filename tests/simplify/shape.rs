//! Promise: every level has the input's topology, no flipped and no new degenerate triangles, and lies within the error
//! that the sequence states.

use crate::meshes::*;
use multires::mesh::Mesh;
use multires::simplify::metric::WithAttributes;
use multires::simplify::{CollapseSequence, Order, Placement, Simplifier};
use proptest::prelude::*;

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

/// A shape by number: closed, open and non-manifold ones.
fn shape(which: usize) -> Mesh {
    match which {
        0 => grid(7, 9, |_, _| 0.0),
        1 => torus(10, 7),
        2 => cube(3),
        3 => tube(9, 6),
        4 => three_sheets(5),
        5 => two_fans(5),
        6 => seamed_grid(4, 8, |_, _| 0.0),
        7 => inconsistent(),
        _ => twice(),
    }
}
const SHAPES: usize = 9;

/// A grid with every third triangle turned around.
fn inconsistent() -> Mesh {
    let mesh = grid(6, 6, |_, _| 0.0);
    let turned = |(i, &[a, b, c]): (usize, &[u32; 3])| if i % 3 == 0 { [a, c, b] } else { [a, b, c] };
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().enumerate().map(turned).collect();
    Mesh::new(mesh.positions(), triangles).unwrap()
}

/// A torus with some triangles given twice and some given with two equal corners.
fn twice() -> Mesh {
    let mesh = torus(8, 6);
    let mut triangles = mesh.triangles().to_vec();
    triangles.extend_from_slice(&mesh.triangles()[10..14]);
    triangles.extend([[0, 0, 1], [5, 6, 5]]);
    Mesh::new(mesh.positions(), triangles).unwrap()
}

fn run(mesh: &Mesh, placement: Placement, order: Order, attributes: bool) -> CollapseSequence {
    let simplifier = Simplifier::new().placement(placement).order(order);
    if attributes {
        simplifier.metric(WithAttributes::new(mesh)).run(mesh).unwrap()
    } else {
        { simplifier }.run(mesh).unwrap()
    }
}

/// Triangles over the same three points, once each: that is the surface, however often it is given.
fn sheets(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let sorted = |t: &[u32; 3]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    let mut seen = std::collections::BTreeSet::new();
    triangles.iter().copied().filter(|t| seen.insert(sorted(t))).collect()
}

fn waved() -> impl Strategy<Value = (usize, f32, [f32; 3])> {
    (0..SHAPES, 0.0f32..0.2, prop::array::uniform3(0.0f32..6.3))
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(config(60))]

    #[test]
    fn topology_is_constant(
        (which, height, phase) in waved(), placement in 0usize..4, batched in any::<bool>(), attributes in any::<bool>(),
    ) {
        let mesh = mapped(&shape(which), |p| wave(p, height, phase));
        let order = if batched { Order::Batched } else { Order::Linear };
        let sequence = run(&mesh, PLACEMENTS[placement], order, attributes);
        prop_assert!(sequence.len() > 5);
        let point = points(&mesh, &sequence);
        let first = level(&mesh, &sequence, &point, 0);
        let (expected, parts) = (euler(&sheets(&first.points)), components(&first.points));
        let mut last = usize::MAX;
        for steps in 0..=sequence.len() {
            let level = level(&mesh, &sequence, &point, steps);
            prop_assert_eq!(level.points.len(), sequence.triangles_after(steps));
            prop_assert_eq!(euler(&sheets(&level.points)), expected, "after {} steps", steps);
            prop_assert_eq!(components(&level.points), parts);
            let borders = edges(&level.points).values().filter(|&&count| count == 1).count();
            prop_assert!(borders <= last, "a border edge is new after {} steps", steps);
            last = borders;
        }
        prop_assert_eq!(sequence.report().triangles, sequence.triangles_after(sequence.len()));
    }

    /// The triangle ends say the same as the replay.
    #[test]
    fn replay_agrees_with_itself((which, height, phase) in waved(), placement in 0usize..4) {
        let mesh = mapped(&shape(which), |p| wave(p, height, phase));
        let sequence = run(&mesh, PLACEMENTS[placement], Order::Linear, false);
        let point = points(&mesh, &sequence);
        let mut corners: Vec<[u32; 3]> = mesh.triangles().to_vec();
        for steps in 1..=sequence.len() {
            if steps == 1 {
                for &[from, to] in sequence.aliases() {
                    corners.as_flattened_mut().iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
                }
            }
            let step = sequence.substitutions(steps - 1);
            for v in corners.as_flattened_mut() {
                *v = step.iter().find(|s| s[0] == *v).map_or(*v, |s| s[1]);
            }
            let (triangles, origin) = sequence.triangles_at(&mesh, steps);
            let mut at = 0;
            for (t, c) in corners.iter().enumerate() {
                let p = c.map(|v| point[v as usize]);
                if p[0] != p[1] && p[1] != p[2] && p[2] != p[0] {
                    prop_assert_eq!(origin[at], t as u32);
                    prop_assert_eq!(&triangles[at], c);
                    at += 1;
                } else {
                    prop_assert!(sequence.triangle_ends()[t] as usize <= steps);
                }
            }
            prop_assert_eq!(at, triangles.len());
        }
    }

    /// No collapse turns a triangle over or makes one without area.
    #[test]
    fn nothing_flips((which, height, phase) in waved(), placement in 0usize..4, attributes in any::<bool>()) {
        let mesh = mapped(&shape(which), |p| wave(p, height, phase));
        let sequence = run(&mesh, PLACEMENTS[placement], Order::Linear, attributes);
        let mut before: Vec<Option<[f64; 3]>> = vec![None; mesh.triangles().len()];
        for steps in 0..=sequence.len() {
            let (triangles, origin) = sequence.triangles_at(&mesh, steps);
            for (t, &o) in triangles.iter().zip(&origin) {
                let now = normal(t.map(|v| position(&mesh, &sequence, v)));
                if let Some(old) = before[o as usize] {
                    prop_assert!(dot(old, old) == 0.0 || dot(now, now) > 0.0, "no area after {} steps", steps);
                    // 78 degrees in one step, and rounding.
                    let cos = dot(old, now) / (dot(old, old) * dot(now, now)).sqrt().max(f64::MIN_POSITIVE);
                    prop_assert!(dot(old, old) == 0.0 || cos > 0.2, "turned to {} in step {}", cos, steps);
                }
                before[o as usize] = Some(now);
            }
        }
    }

    /// No input vertex is farther from a level than the level's error.
    #[test]
    fn the_error_holds((which, height, phase) in waved(), placement in 0usize..4, attributes in any::<bool>()) {
        let mesh = mapped(&shape(which), |p| wave(p, height, phase));
        let sequence = run(&mesh, PLACEMENTS[placement], Order::Linear, attributes);
        let slack = 1e-6 * mesh.diagonal();
        for steps in (1..=16).map(|i| i * sequence.len() / 16) {
            let (triangles, _) = sequence.triangles_at(&mesh, steps);
            let corners: Vec<[[f32; 3]; 3]> =
                triangles.iter().map(|t| t.map(|v| position(&mesh, &sequence, v))).collect();
            let bound = f64::from(sequence.error_after(steps));
            for &v in mesh.indices() {
                let p = mesh.positions()[v as usize];
                let nearest = corners.iter().map(|&t| distance(p, t)).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= bound + slack, "vertex {v}: {nearest} beyond {bound} after {steps}");
            }
        }
    }
}

#[test]
fn errors_never_decrease() {
    for which in 0..SHAPES {
        let mesh = mapped(&shape(which), |p| wave(p, 0.1, [1.0, 2.0, 3.0]));
        for placement in PLACEMENTS {
            let sequence = run(&mesh, placement, Order::Linear, false);
            assert_eq!(sequence.error_after(0), 0.0);
            for steps in 1..=sequence.len() {
                let (before, after) = (sequence.error_after(steps - 1), sequence.error_after(steps));
                assert!(after >= before && after >= sequence.step_error(steps - 1));
            }
            assert_eq!(sequence.report().error, sequence.error_after(sequence.len()));
        }
    }
}
