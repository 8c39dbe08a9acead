//! Promise: vertices that collapses make get attributes that fit where they lie: linear ones exactly, normals of unit
//! length, texture coordinates inside their chart, and no seam where there was none.

use std::collections::BTreeMap;

use crate::meshes::*;
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::simplify::metric::{NAMES, by_name};
use multires::simplify::{AttributeWeights, CollapseSequence, Placement, Simplifier};

const MOVING: [Placement; 3] = [Placement::Midpoint, Placement::Subset, Placement::Optimal];

fn floats<const N: usize>(mesh: &Mesh, name: &str) -> Vec<[f32; N]> {
    rows(mesh.attribute(name).unwrap().as_floats().unwrap())
}

fn levels(sequence: &CollapseSequence) -> impl Iterator<Item = usize> + '_ {
    (1..=6).map(|i| i * sequence.len() / 6)
}

/// Texture coordinates and colours that are linear in the place, on a flat sheet with an uneven border.
fn linear() -> Mesh {
    let sheet = grid(16, 16, |_, _| 0.0);
    let uneven = mapped(&sheet, |[x, y, z]| [x + 0.2 * y * (1.0 - y), y + 0.1 * x * x, z]);
    let uv: Vec<[f32; 2]> = uneven.positions().iter().map(|p| texture(*p)).collect();
    let colours: Vec<[f32; 3]> = uneven.positions().iter().map(|p| colour(*p)).collect();
    let mesh = uneven.with_attribute(Attribute::floats(names::UV, &uv)).unwrap();
    mesh.with_attribute(Attribute::floats(names::COLOR, &colours)).unwrap()
}

fn texture([x, y, _]: [f32; 3]) -> [f32; 2] {
    [0.1 + 0.5 * x + 0.2 * y, 0.3 - 0.1 * x + 0.6 * y]
}

fn colour([x, y, _]: [f32; 3]) -> [f32; 3] {
    [0.2 + 0.3 * x, 0.2 + 0.3 * y, 0.4 + 0.1 * x - 0.2 * y]
}

#[test]
fn what_is_linear_on_a_plane_stays_exact() {
    let mesh = linear();
    let all = |p: &[f32; 3]| texture(*p).into_iter().chain(colour(*p)).collect::<Vec<_>>();
    let mut ranges = [[f32::INFINITY, f32::NEG_INFINITY]; 5];
    for p in mesh.positions() {
        ranges.iter_mut().zip(all(p)).for_each(|(r, x)| *r = [r[0].min(x), r[1].max(x)]);
    }
    for name in NAMES {
        for placement in MOVING {
            let simplifier = Simplifier::new().metric(by_name(name).unwrap()).placement(placement);
            let sequence = { simplifier }.run(&mesh).unwrap();
            // A subset may be ends alone.
            assert!(placement == Placement::Subset || !sequence.new_vertices().is_empty(), "{name}");
            for steps in levels(&sequence) {
                let level = sequence.extract(&mesh, steps);
                let (uv, colours) = (floats::<2>(&level, names::UV), floats::<3>(&level, names::COLOR));
                for ((p, uv), own) in level.positions().iter().zip(uv).zip(colours) {
                    let there = texture(*p).into_iter().zip(uv).chain(colour(*p).into_iter().zip(own));
                    for ((a, b), [low, high]) in there.zip(&ranges) {
                        // Values keep to their range: beyond the corners of the sheet, and where springs have pulled a
                        // vertex away from all that it stands for.
                        let right = a.clamp(*low, *high);
                        let slack = if name == "progressive-mesh" { 0.01 } else { 1e-4 };
                        assert!(
                            (right - b).abs() < slack,
                            "{b} where {right} is right, {name}, {placement:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn linear_values_cost_an_optimum_nothing() {
    let mesh = linear();
    let run = |weights| {
        let simplifier = Simplifier::new().placement(Placement::Optimal).attributes(weights);
        { simplifier }.run(&mesh).unwrap()
    };
    let (on, off) = (run(AttributeWeights::Customary), run(AttributeWeights::Off));
    let level = |s: &CollapseSequence| s.error_after(s.steps_for_triangles(100));
    assert!(level(&on) < 2.0 * level(&off) + 1e-3, "{} with, {} without", level(&on), level(&off));
}

/// A bumpy ball with normals, tangents at right angles to them, and texture coordinates.
fn dressed() -> Mesh {
    let ball = shapes::icosphere(3);
    let ball = mapped(&ball, |[x, y, z]| {
        let r = 1.0 + 0.2 * x * y + 0.1 * z * z * x;
        [x * r, y * r, z * r]
    });
    let unit = |v: [f64; 3]| v.map(|x| (x / dot(v, v).sqrt()) as f32);
    let normals: Vec<[f32; 3]> = ball.positions().iter().map(|p| unit(p.map(f64::from))).collect();
    let tangents: Vec<[f32; 4]> = normals
        .iter()
        .map(|n| {
            let n = n.map(f64::from);
            let [x, y, z] = unit(cross(if n[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] }, n));
            [x, y, z, 1.0]
        })
        .collect();
    let mesh = ball.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    mesh.with_attribute(Attribute::floats(names::TANGENT, &tangents)).unwrap()
}

#[test]
fn normals_have_unit_length_and_tangents_right_angles() {
    let mesh = dressed();
    for placement in MOVING {
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        for steps in levels(&sequence) {
            for level in [sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps)] {
                let (normals, tangents) =
                    (floats::<3>(&level, names::NORMAL), floats::<4>(&level, names::TANGENT));
                for (n, [x, y, z, w]) in normals.into_iter().zip(tangents) {
                    let (n, t) = (n.map(f64::from), [x, y, z].map(f64::from));
                    assert!((dot(n, n) - 1.0).abs() < 1e-4, "a normal of {n:?}");
                    assert!((dot(t, t) - 1.0).abs() < 1e-3 && dot(n, t).abs() < 1e-3, "{t:?} on {n:?}");
                    assert_eq!(w, 1.0);
                }
            }
        }
    }
}

/// Two charts whose coordinates are far apart, on a bumpy sheet.
#[test]
fn texture_coordinates_stay_inside_their_chart() {
    let mesh = seamed_grid(8, 12, |u, v| 0.2 * (7.0 * u).sin() * (5.0 * v).cos());
    let range = |uv: &[[f32; 2]], second: bool| {
        let chart = uv.iter().filter(|c| (c[0] > 5.0) == second);
        chart.fold([f32::INFINITY, f32::NEG_INFINITY], |r, c| [r[0].min(c[0]), r[1].max(c[0])])
    };
    let own = floats::<2>(&mesh, names::UV);
    for name in ["quadric", "memoryless-quadric", "lindstrom-turk"] {
        for placement in MOVING {
            let simplifier = Simplifier::new().metric(by_name(name).unwrap()).placement(placement);
            let sequence = { simplifier }.run(&mesh).unwrap();
            for steps in levels(&sequence) {
                for level in [sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps)] {
                    let uv = floats::<2>(&level, names::UV);
                    for second in [false, true] {
                        let (was, is) = (range(&own, second), range(&uv, second));
                        assert!(
                            was[0] <= is[0] && is[1] <= was[1],
                            "{is:?} in {was:?}, {name}, {placement:?}"
                        );
                    }
                    for t in level.triangles() {
                        let sides = t.map(|v| uv[v as usize][0] > 5.0);
                        assert!(sides == [sides[0]; 3], "a triangle in two charts");
                    }
                }
            }
        }
    }
}

/// A seam of the texture alone: normals are the same on both sides, and stay so to the bit.
#[test]
fn no_seam_of_another_attribute_opens() {
    let mesh = seamed_grid(8, 12, |u, v| 0.2 * (7.0 * u).sin() * (5.0 * v).cos());
    let normals: Vec<[f32; 3]> = mesh
        .positions()
        .iter()
        .map(|[x, y, _]| {
            let v = [0.3 * x - 0.1, 0.5 * y - 0.2, 1.0].map(f64::from);
            v.map(|x| (x / dot(v, v).sqrt()) as f32)
        })
        .collect();
    let mesh = mesh.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    for placement in MOVING {
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        let mut twins = 0;
        for steps in levels(&sequence) {
            for level in [sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps)] {
                let mut at: BTreeMap<[u32; 3], [f32; 3]> = BTreeMap::new();
                for (p, n) in level.positions().iter().zip(floats::<3>(&level, names::NORMAL)) {
                    if let Some(other) = at.insert(p.map(f32::to_bits), n) {
                        assert_eq!(other, n, "at {p:?}, {placement:?}");
                        twins += 1;
                    }
                }
            }
        }
        assert!(twins > 10, "{twins}");
    }
}

#[test]
fn fitted_values_are_closer_on_average_and_locked_ones_stay() {
    let mesh = shapes::demo();
    let locks: Vec<bool> = (0..mesh.positions().len()).map(|v| v % 50 == 0).collect();
    let mesh = mesh.with_locks(locks).unwrap();
    let sequence = Simplifier::new().run(&mesh).unwrap();
    for triangles in [20_000, 8_000] {
        let steps = sequence.steps_for_triangles(triangles);
        let (kept, fitted) = (sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps));
        assert_eq!(kept.positions(), fitted.positions());
        assert_eq!(kept.triangles(), fitted.triangles());
        let off = |level: &Mesh| sequence.attribute_deviations(&mesh, steps, level);
        let (before, after) = (off(&kept), off(&fitted));
        assert!(!before.is_empty());
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(before.name, after.name);
            assert!(after.mean < before.mean, "{}: {} fitted, {} kept", before.name, after.mean, before.mean);
        }
        for (v, &locked) in kept.locks().iter().enumerate().filter(|(_, locked)| **locked) {
            assert!(locked);
            for (a, b) in kept.attributes().iter().zip(fitted.attributes()) {
                if let (Some(a), Some(b)) = (a.as_floats(), b.as_floats()) {
                    let width = a.len() / kept.positions().len();
                    assert_eq!(a[v * width..][..width], b[v * width..][..width]);
                }
            }
        }
    }
}

/// Whatever way the texture of a triangle runs, fitting does not turn it round.
#[test]
fn fitting_mirrors_no_texture() {
    let bumpy = |u: f32, v: f32| 0.3 * (9.0 * u).sin() * (8.0 * v).cos();
    for mesh in [seamed_grid(10, 20, bumpy), tube(24, 12), shapes::demo()] {
        let sequence = Simplifier::new().attributes(AttributeWeights::Off).run(&mesh).unwrap();
        let own = floats::<2>(&mesh, names::UV);
        let area = |uv: &[[f32; 2]], t: [u32; 3]| {
            let [a, b, c] = t.map(|v| uv[v as usize].map(f64::from));
            (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        };
        for steps in levels(&sequence) {
            let (kept, fitted) = (sequence.extract(&mesh, steps), sequence.extract_fitted(&mesh, steps));
            let (_, origin) = sequence.triangles_at(&mesh, steps);
            let (old, new) = (floats::<2>(&kept, names::UV), floats::<2>(&fitted, names::UV));
            for (&t, &o) in fitted.triangles().iter().zip(&origin) {
                let way = area(&own, mesh.triangles()[o as usize]);
                let mirrored = |uv| area(uv, t) * way < 0.0;
                assert!(!mirrored(&new) || mirrored(&old), "triangle {t:?} after {steps} steps");
            }
        }
    }
}

/// The input has nothing to be off by; a level that is turned around by a quarter in its texture is off by that.
#[test]
fn deviations_are_in_their_own_units() {
    let mesh = linear();
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let exact = sequence.attribute_deviations(&mesh, 0, &sequence.extract(&mesh, 0));
    assert_eq!(exact.iter().map(|d| d.name.as_str()).collect::<Vec<_>>(), [names::UV, names::COLOR]);
    assert!(exact.iter().all(|d| d.max < 1e-6), "{exact:?}");

    // A texture that slid by 0.1 in the plane, and colours that are off by 0.25.
    let shifted = |name: &str, by: &dyn Fn([f32; 3]) -> Vec<f32>, width: usize| {
        let values = mesh.positions().iter().flat_map(|&p| by(p)).collect();
        Attribute::new(name, width, multires::mesh::AttributeValues::Float(values))
    };
    let uv = shifted(names::UV, &|[x, y, z]| texture([x + 0.08, y + 0.06, z]).to_vec(), 2);
    let colours = shifted(names::COLOR, &|p| colour(p).map(|c| c + 0.25).to_vec(), 3);
    let level = Mesh::new(mesh.positions(), mesh.triangles()).unwrap();
    let level = level.with_attribute(uv).unwrap().with_attribute(colours).unwrap();
    let off = sequence.attribute_deviations(&mesh, 0, &level);
    // The texture is sheared, so a step in it is not quite as long as on the sheet.
    assert!((0.08..0.13).contains(&off[0].mean) && off[0].max < 0.14, "{off:?}");
    assert!((off[1].mean - 0.25).abs() < 1e-4 && (off[1].max - 0.25).abs() < 1e-4, "{off:?}");
    // Nothing is said of a level of something else.
    assert!(sequence.attribute_deviations(&torus(4, 4), 0, &level).is_empty());
}
