//! Promise: seams, creases, borders between materials and locked vertices come through every collapse whole.

use std::collections::{BTreeMap, BTreeSet};

use crate::meshes::*;
use multires::mesh::{Mesh, names};
use multires::simplify::metric::WithAttributes;
use multires::simplify::oracle::Borders;
use multires::simplify::{CollapseSequence, Origin, Pair, Placement, Simplifier, WorkingSurface};
use proptest::prelude::*;

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

fn simplified(mesh: &Mesh, placement: Placement) -> CollapseSequence {
    Simplifier::new().placement(placement).run(mesh).unwrap()
}

fn uv(mesh: &Mesh) -> Vec<[f32; 2]> {
    rows(mesh.attribute(names::UV).unwrap().as_floats().unwrap())
}

/// Levels spread over the whole sequence, both ends included.
fn some_levels(sequence: &CollapseSequence, count: usize) -> Vec<usize> {
    (0..=count).map(|i| i * sequence.len() / count).collect()
}

/// After every step the border edges' count never grows and every border point was one in the input.
fn assert_no_tears(mesh: &Mesh, sequence: &CollapseSequence) {
    let point = points(mesh, sequence);
    let mut before = None;
    for steps in 0..=sequence.len() {
        let level = level(mesh, sequence, &point, steps);
        let borders = edges(&level.points).values().filter(|&&count| count == 1).count();
        assert!(before.is_none_or(|b| borders <= b), "{borders} border edges after {steps} steps");
        before = Some(borders);
    }
}

#[test]
fn no_seam_tears() {
    let bumpy = |u: f32, v: f32| 0.1 * (7.0 * u).sin() * (5.0 * v).cos();
    for mesh in [seamed_grid(6, 12, bumpy), tube(12, 8), cube(4)] {
        for placement in PLACEMENTS {
            let sequence = simplified(&mesh, placement);
            assert!(sequence.len() > 20, "{} steps with {placement:?}", sequence.len());
            assert_no_tears(&mesh, &sequence);
        }
    }
}

#[test]
fn a_closed_cube_stays_closed_and_keeps_its_creases() {
    let mesh = cube(4);
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        assert_eq!(sequence.report().triangles, 12, "{placement:?}");
        let base = sequence.extract(&mesh, sequence.len());
        assert_eq!(base.positions().len(), 24, "three normals at each corner");
        let normals: Vec<[f32; 3]> = rows(base.attribute(names::NORMAL).unwrap().as_floats().unwrap());
        for t in base.triangles() {
            let n = normal(t.map(|v| base.positions()[v as usize]));
            for v in t {
                let own = normals[*v as usize].map(f64::from);
                assert!(dot(n, own) > 0.999 * dot(n, n).sqrt(), "a corner with another face's normal");
            }
        }
    }
}

#[test]
fn every_triangle_stays_in_its_chart() {
    let mesh = seamed_grid(8, 10, |u, v| 0.2 * (6.0 * u).sin() + 0.1 * (9.0 * v).sin());
    let chart = |u: f32| u > 5.0;
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        for steps in some_levels(&sequence, 20).into_iter().skip(1) {
            let coarse = sequence.extract(&mesh, steps);
            let (_, origin) = sequence.triangles_at(&mesh, steps);
            let coordinates = uv(&coarse);
            for (t, &o) in coarse.triangles().iter().zip(&origin) {
                let expected = chart(uv(&mesh)[mesh.triangles()[o as usize][0] as usize][0]);
                for &v in t {
                    let [u, _] = coordinates[v as usize];
                    assert_eq!(chart(u), expected);
                    // Whole numbers are not blended: u says where the vertex lies, on either chart.
                    let x = if chart(u) { u - 9.5 } else { u };
                    let off = (x - coarse.positions()[v as usize][0]).abs();
                    // A new vertex lies off the surface that its value is of, by no more than the level's error.
                    let moves = placement != Placement::Endpoint;
                    let slack = if moves { sequence.error_after(steps) } else { 0.0 };
                    assert!(
                        off < slack + 1e-4,
                        "u {u} at {:?}, {placement:?}",
                        coarse.positions()[v as usize]
                    );
                }
            }
        }
    }
}

#[test]
fn wedges_go_to_wedges_of_the_same_chart() {
    let mesh = seamed_grid(6, 9, |u, v| (4.0 * u).sin() * v);
    let values = uv(&mesh);
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        let mut chart: Vec<bool> = values.iter().map(|c| c[0] > 5.0).collect();
        for new in sequence.new_vertices() {
            let [a, b] = new.from.map(|v| chart[v as usize]);
            assert_eq!(a, b, "a blend across the seam");
            chart.push(a);
        }
        for &[from, to] in (0..sequence.len()).flat_map(|s| sequence.substitutions(s)) {
            assert_eq!(chart[from as usize], chart[to as usize]);
        }
    }
}

/// On a tube the coordinate runs from 0 to 1 around; a triangle across the seam would span nearly all of it.
#[test]
fn texture_does_not_smear_around_a_tube() {
    let mesh = tube(24, 10);
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        let half = sequence.steps_for_triangles(mesh.triangles().len() / 8);
        let coarse = sequence.extract(&mesh, half);
        let coordinates = uv(&coarse);
        for t in coarse.triangles() {
            let [a, b, c] = t.map(|v| coordinates[v as usize][0]);
            let span = a.max(b).max(c) - a.min(b).min(c);
            assert!(span < 0.5, "a triangle spans {span} of the texture with {placement:?}");
        }
    }
}

/// A blended vertex on a seam has one vertex for each side, at one position.
#[test]
fn both_sides_of_a_seam_move_together() {
    let mesh = seamed_grid(6, 16, |_, v| 0.2 * (5.0 * v).sin());
    for placement in [Placement::Midpoint, Placement::Subset] {
        let sequence = simplified(&mesh, placement);
        let mut twins = 0;
        for step in 0..sequence.len() {
            let substitutions = sequence.substitutions(step);
            let made: BTreeSet<u32> = substitutions
                .iter()
                .map(|s| s[1])
                .filter(|&v| matches!(sequence.origin(v), Origin::Blend(_)))
                .collect();
            let places: BTreeSet<[u32; 3]> =
                made.iter().map(|&v| position(&mesh, &sequence, v).map(f32::to_bits)).collect();
            assert!(places.len() <= 1, "one step makes one place");
            twins += usize::from(made.len() == 2);
            let gone: BTreeSet<u32> = substitutions.iter().map(|s| s[0]).collect();
            assert_eq!(gone.len(), substitutions.len(), "a vertex is substituted once");
            assert!(substitutions.iter().all(|s| !gone.contains(&s[1])), "nothing becomes what goes");
        }
        assert!(twins > 0, "no collapse along the seam with {placement:?}");
    }
}

/// Shortest edge first: only the rules keep anything in place.
fn shortest(surface: &WorkingSurface, pair: Pair, _: [f32; 3]) -> f32 {
    let edge = sub(surface.position(pair.lost), surface.position(pair.kept));
    dot(edge, edge) as f32
}

#[test]
fn borders_between_materials_stay_in_place() {
    let mesh = grid(12, 12, |u, v| 0.05 * (9.0 * u + 4.0 * v).sin());
    let side = |t: &[u32; 3]| {
        let x: f32 = t.iter().map(|&v| mesh.positions()[v as usize][0]).sum::<f32>() / 3.0;
        u32::from(x > 0.5)
    };
    let ids: Vec<u32> = mesh.triangles().iter().map(side).collect();
    let mesh = mesh.clone().with_materials(ids).unwrap();
    for placement in PLACEMENTS {
        // With the outline in place, all the way down to the base.
        let simplifier = Simplifier::new().metric(shortest).oracle(Borders::Locked).placement(placement);
        let sequence = { simplifier }.run(&mesh).unwrap();
        assert!(sequence.report().triangles < mesh.triangles().len() / 3);
        for steps in some_levels(&sequence, 12) {
            let coarse = sequence.extract(&mesh, steps);
            let mut between = BTreeMap::<[u32; 2], BTreeSet<u32>>::new();
            for (t, &material) in coarse.triangles().iter().zip(coarse.materials()) {
                for i in 0..3 {
                    let (a, b) = (t[i], t[(i + 1) % 3]);
                    between.entry([a.min(b), a.max(b)]).or_default().insert(material);
                    // The border is straight in x, so no triangle reaches beyond it.
                    let x = coarse.positions()[a as usize][0];
                    assert!(if material == 0 { x <= 0.50001 } else { x >= 0.49999 }, "{placement:?}");
                }
            }
            let mut length = 0.0;
            for edge in between.iter().filter(|(_, ids)| ids.len() == 2).map(|(edge, _)| edge) {
                let [p, q] = edge.map(|v| coarse.positions()[v as usize]);
                assert!((p[0] - 0.5).abs() < 1e-5 && (q[0] - 0.5).abs() < 1e-5);
                length += (p[1] - q[1]).abs();
            }
            assert!((length - 1.0).abs() < 1e-4, "the border runs from end to end: {length}");
        }
        let on_border = |mesh: &Mesh| mesh.positions().iter().filter(|p| (p[0] - 0.5).abs() < 1e-5).count();
        assert!(on_border(&sequence.extract(&mesh, sequence.len())) < on_border(&mesh), "{placement:?}");
    }
}

/// A seam that is closed in one point: that point's one wedge has two to go to, so it must stay.
#[test]
fn wedges_of_one_point_never_become_one() {
    let open = seamed_grid(6, 12, |_, _| 0.0);
    let values = uv(&open);
    let middle = |v: usize| open.positions()[v] == [0.5, 0.5, 0.0];
    let one = (0..values.len()).find(|&v| middle(v)).unwrap() as u32;
    let pinch = |v: u32| if middle(v as usize) { one } else { v };
    let triangles: Vec<[u32; 3]> = open.triangles().iter().map(|t| t.map(pinch)).collect();
    let mesh = Mesh::new(open.positions(), triangles)
        .unwrap()
        .with_attribute(open.attribute(names::UV).unwrap().clone())
        .unwrap();
    for placement in PLACEMENTS {
        let simplifier = Simplifier::new().metric(shortest).placement(placement);
        let sequence = { simplifier }.run(&mesh).unwrap();
        for steps in 1..=sequence.len() {
            let new = |v: u32| v as usize >= values.len();
            for &[from, to] in sequence.substitutions(steps - 1) {
                let same_place = !new(from)
                    && !new(to)
                    && mesh.positions()[from as usize] == mesh.positions()[to as usize];
                assert!(!same_place, "{from} became {to} in step {steps} with {placement:?}");
            }
        }
        assert!(sequence.len() > 50);

        // With all else locked there is nowhere to go; with a wedge for each side there is.
        for (mesh, expected) in [(&mesh, 0), (&open, 1)] {
            let locks: Vec<bool> = (0..values.len()).map(|v| !middle(v)).collect();
            let mesh = mesh.clone().with_locks(locks).unwrap();
            assert_eq!(simplified(&mesh, placement).len(), expected, "{placement:?}");
        }
    }
}

#[test]
fn locked_vertices_stay() {
    let plain = tube(16, 10);
    let locks: Vec<bool> = (0..plain.positions().len()).map(|v| v % 7 == 3).collect();
    let mesh = plain.with_locks(locks.clone()).unwrap();
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        assert!(sequence.len() > 20);
        let base = sequence.extract(&mesh, sequence.len());
        let there: BTreeSet<[u32; 3]> = base.positions().iter().map(|p| p.map(f32::to_bits)).collect();
        for v in (0..locks.len()).filter(|&v| locks[v]) {
            assert!(there.contains(&mesh.positions()[v].map(f32::to_bits)), "vertex {v} with {placement:?}");
        }
    }
}

#[test]
fn locked_borders_keep_all_border_points() {
    let mesh = grid(10, 10, |u, v| 0.1 * (8.0 * u * v).sin());
    for placement in PLACEMENTS {
        let sequence = Simplifier::new().placement(placement).oracle(Borders::Locked).run(&mesh).unwrap();
        let base = sequence.extract(&mesh, sequence.len());
        assert!(base.triangles().len() < mesh.triangles().len() / 2);
        let there: BTreeSet<[u32; 3]> = base.positions().iter().map(|p| p.map(f32::to_bits)).collect();
        for p in mesh.positions() {
            if [p[0], p[1]].iter().any(|&x| x == 0.0 || x == 1.0) {
                assert!(there.contains(&p.map(f32::to_bits)), "border point {p:?} with {placement:?}");
            }
        }
    }
}

#[test]
fn sliding_borders_stay_straight() {
    let mesh = grid(12, 12, |u, v| 0.1 * (u * (1.0 - u) * v * (1.0 - v) * 40.0).sin());
    for placement in PLACEMENTS {
        let sequence = simplified(&mesh, placement);
        let point = points(&mesh, &sequence);
        let last = sequence.steps_for_error(0.04);
        assert!(sequence.triangles_after(last) < mesh.triangles().len() / 3, "{placement:?}");
        for steps in (0..=10).map(|i| i * last / 10) {
            let level = level(&mesh, &sequence, &point, steps);
            // The optimum weighs the border against the surface: it stays within the level's error.
            let slack = if placement == Placement::Optimal { sequence.error_after(steps) } else { 0.0 };
            let mut length = 0.0;
            for (edge, count) in edges(&level.vertices) {
                if count == 1 {
                    let [p, q] = edge.map(|v| position(&mesh, &sequence, v));
                    let near = |p: f32, x: f32| (p - x).abs() < 1e-5 + slack;
                    let on = |axis: usize, x: f32| near(p[axis], x) && near(q[axis], x);
                    assert!(on(0, 0.0) || on(0, 1.0) || on(1, 0.0) || on(1, 1.0), "{p:?} to {q:?}");
                    length += dot(sub(p, q), sub(p, q)).sqrt();
                }
            }
            assert!(
                (length - 4.0).abs() < 1e-4 + 8.0 * f64::from(slack),
                "border of length {length} after {steps}, {placement:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Random charts: every triangle of a torus is given one of three charts by a random rule, and wedges follow.
    #[test]
    fn random_charts_never_tear(seed in any::<u32>(), placement in 0usize..4, weighted in any::<bool>()) {
        let mesh = charted(&torus(12, 8), seed);
        let placement = PLACEMENTS[placement];
        let sequence = if weighted {
            Simplifier::new().metric(WithAttributes::new(&mesh)).placement(placement).run(&mesh).unwrap()
        } else {
            simplified(&mesh, placement)
        };
        let point = points(&mesh, &sequence);
        for steps in some_levels(&sequence, 15) {
            let level = level(&mesh, &sequence, &point, steps);
            let odd: Vec<_> = edges(&level.points).into_iter().filter(|&(_, count)| count != 2).collect();
            prop_assert!(odd.is_empty(), "{odd:?} after {steps} steps of {placement:?}");
            prop_assert_eq!(euler(&level.points), 0);
            let coarse = sequence.extract(&mesh, steps);
            let chart = uv(&coarse);
            for (t, &o) in coarse.triangles().iter().zip(&level.origin) {
                let own = uv(&mesh)[mesh.triangles()[o as usize][0] as usize][0];
                for &v in t {
                    prop_assert_eq!(chart[v as usize][0], own);
                }
            }
        }
    }
}

/// The mesh cut into charts, told apart by the first texture coordinate.
fn charted(mesh: &Mesh, seed: u32) -> Mesh {
    use multires::mesh::Attribute;
    let chart = |t: usize| {
        let block = (t as u32 / 24).wrapping_mul(2_654_435_761) ^ seed;
        ((block ^ block >> 13).wrapping_mul(0x85eb_ca6b) >> 29) % 3
    };
    let count = mesh.positions().len() as u32;
    let positions: Vec<[f32; 3]> = (0..3).flat_map(|_| mesh.positions().iter().copied()).collect();
    let triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().enumerate().map(|(t, c)| c.map(|v| v + chart(t) * count)).collect();
    let uv: Vec<[f32; 2]> = (0..3 * count).map(|v| [(v / count) as f32, 0.0]).collect();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}
