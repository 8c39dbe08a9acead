//! Promise: positions that nearly coincide can be made one, without chains, and are where only rounding parts them; what
//! was meant to be closed is closed at every level, and small real edges stay.

use multires::hierarchy::{HierarchyOptions, VertexHierarchy};
use multires::lod::{Baked, Lod, LodOptions, Values};
use multires::mesh::{Attribute, Mesh, Report, Tolerances, Topology, names, shapes};
use multires::simplify::{ProgressiveMesh, Simplifier, Target};
use multires::tom::{TomOptions, TotallyOrderedMesh};

/// How a grid of cells closes: in columns, in rows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Torus,
    Sphere,
    Cylinder,
}

/// A grid with a closing column (and row) of its own, as an engine computes it in single precision: sine of a full turn is
/// not 0. Texture coordinates make the closing ones wedges of their own.
fn engine_made(shape: Shape, uv: bool) -> Mesh {
    let (columns, rows) = (40u32, 28u32);
    let mut positions = Vec::new();
    let mut coordinates = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let [u, v] = [column as f32 / columns as f32, row as f32 / rows as f32];
            // Sine and cosine of the angle off by their rounding at a full turn: -1.75e-7 for 0.
            let [sin, cos] = turn(u);
            positions.push(match shape {
                Shape::Torus => {
                    let [up, out] = turn(v);
                    [(2.0 + 0.7 * out) * cos, 0.7 * up, (2.0 + 0.7 * out) * sin]
                }
                Shape::Sphere => {
                    let [radius, height] = half_turn(v, row, rows);
                    [radius * cos, height, radius * sin]
                }
                Shape::Cylinder => [cos, 3.0 * v, sin],
            });
            coordinates.push([u, v]);
        }
    }
    let at = |column: u32, row: u32| row * (columns + 1) + column;
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b, c, d] =
                [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    if uv { mesh.with_attribute(Attribute::floats(names::UV, &coordinates)).unwrap() } else { mesh }
}

/// Sine and cosine of a share of a turn. At the full turn the sine is that of the nearest single-precision number.
fn turn(share: f32) -> [f32; 2] {
    let angle = f64::from(share) * std::f64::consts::TAU;
    let error = if share == 1.0 { 1.748_455_6e-7 } else { 0.0 };
    [(angle.sin() + error) as f32, angle.cos() as f32]
}

fn half_turn(share: f32, row: u32, rows: u32) -> [f32; 2] {
    let angle = f64::from(share) * std::f64::consts::PI;
    let radius = if row == 0 || row == rows { 0.0 } else { angle.sin() };
    [radius as f32, angle.cos() as f32]
}

/// Border edges and Euler characteristic by place, triangles of no area by place left out.
fn shape_of(mesh: &Mesh) -> [i64; 2] {
    let report = Report::welded(mesh);
    [report.border_edges as i64, report.euler_characteristic]
}

#[test]
fn what_rounding_has_parted_is_closed_at_every_level() {
    for uv in [false, true] {
        for (shape, expected) in [(Shape::Torus, [0, 0]), (Shape::Sphere, [0, 2]), (Shape::Cylinder, [80, 0])]
        {
            let mesh = engine_made(shape, uv);
            let report = Report::welded(&mesh);
            let open = if shape == Shape::Cylinder { 2 * 28 + 80 } else { 2 * 26 };
            assert!(report.border_edges >= open, "{shape:?}: open as it is, {}", report.border_edges);
            assert!(report.near_twins >= 26 && report.twin_distance < 1e-6, "{shape:?}: {report:?}");
            assert_eq!(shape_of(&mesh.welded(1.01 * report.twin_distance)), expected, "{shape:?}");
            assert_eq!(Report::welded(&mesh.welded(1.01 * report.twin_distance)).near_twins, 0);

            let sequence = Simplifier::new().target(Target::Triangles(200)).run(&mesh).unwrap();
            assert!(!uv || !sequence.snaps().is_empty());
            assert!(sequence.report().triangles <= 200, "{shape:?} {}", sequence.report().triangles);
            let tom =
                Baked::<TotallyOrderedMesh>::of_sequence(&mesh, &sequence, &TomOptions::default()).unwrap();
            let hierarchy =
                Baked::<VertexHierarchy>::of_sequence(&mesh, &sequence, &HierarchyOptions::default())
                    .unwrap();
            let none = Values::none(hierarchy.structure().vertex_count());
            let lod = hierarchy.instance(none, &LodOptions::default()).unwrap();
            let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
            let plain = Mesh::new(progressive.positions(), progressive.triangles()).unwrap();
            for (level, what) in [
                (sequence.extract(&mesh, 1), "after one step"),
                (sequence.extract(&mesh, sequence.len()), "sequence"),
                (tom.mesh_at(tom.structure().finest()), "ordered, finest"),
                (tom.mesh_at(tom.structure().coarsest()), "ordered, coarsest"),
                (lod.to_mesh(), "hierarchy"),
                (plain, "progressive"),
            ] {
                match shape {
                    Shape::Cylinder => assert_eq!(Report::welded(&level).euler_characteristic, 0, "{what}"),
                    _ => assert_eq!(shape_of(&level), expected, "{shape:?}, uv {uv}: {what}"),
                }
            }
            // The progressive mesh holds the input, cracks and all.
            assert_eq!(progressive.validate(), Ok(()));
            progressive.seek(0);
            for (slot, &vertex) in progressive.vertex_order().iter().enumerate() {
                assert_eq!(progressive.positions()[slot], mesh.positions()[vertex as usize]);
            }

            let exact = Simplifier::new()
                .tolerances(Tolerances::exact())
                .target(Target::Triangles(200))
                .run(&mesh)
                .unwrap();
            assert!(exact.snaps().is_empty());
            let closed = Report::welded(&exact.extract(&mesh, exact.len())).is_closed();
            assert!(!closed, "{shape:?}: open where only equal positions are one");
        }
    }
}

/// A flat patch whose edges are as long as the tolerance, far from the origin: nothing may merge.
#[test]
fn ends_of_small_edges_stay_two_points() {
    let plane = shapes::plane(20);
    // 0.0625 is the step of single precision there, 8 x 2^-23 of it half a unit; cells are a quarter wide.
    let far = |p: &[f32; 3]| p.map(|x| x.mul_add(2.5, 600_000.0));
    let positions: Vec<[f32; 3]> = plane.positions().iter().map(far).collect();
    let mesh = Mesh::new(positions, plane.triangles()).unwrap();
    assert_eq!(Topology::new(&mesh).point_count(), mesh.positions().len());
    let sequence = Simplifier::new().target(Target::Triangles(400)).run(&mesh).unwrap();
    assert!(sequence.snaps().is_empty() && sequence.aliases().is_empty());
    assert_eq!(sequence.triangles_after(0), mesh.triangles().len());
    assert_eq!(Report::welded(&mesh).near_twins, 0);
}

#[test]
fn a_locked_crack_stays() {
    let mesh = engine_made(Shape::Torus, false);
    let locks = vec![true; mesh.positions().len()];
    let sequence = Simplifier::new().run(&mesh.clone().with_locks(locks).unwrap()).unwrap();
    assert!(sequence.snaps().is_empty() && sequence.aliases().is_empty());
}

/// A row of points each near the next: every one lies within the distance of where it goes.
#[test]
fn a_row_of_near_points_does_not_become_one() {
    let positions: Vec<[f32; 3]> = (0..1000).map(|i| [i as f32 * 0.6, 0.0, 0.0]).collect();
    let mesh = Mesh::new(positions.clone(), []).unwrap();
    let welded = mesh.welded(1.0);
    let expected: Vec<f32> = (0..1000).map(|i| (i / 2 * 2) as f32 * 0.6).collect();
    let found: Vec<f32> = welded.positions().iter().map(|p| p[0]).collect();
    assert_eq!(found, expected, "each second point goes to the one before it");
    for nothing in [0.0, -1.0, f64::NAN, 1e-300] {
        assert_eq!(mesh.welded(nothing), mesh);
    }
    // Within half of everything: all of it in one place, whatever the order of sizes.
    for distance in [1e4, 1e38, 1e300, f64::INFINITY] {
        assert_eq!(Topology::new(&mesh.welded(distance)).point_count(), 1, "{distance}");
    }
}

/// Against the definition, by comparing all pairs, on random points about as far apart as the distance.
#[test]
fn welding_is_by_the_nearest_that_stays() {
    let mut state = 5u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let positions: Vec<[f32; 3]> =
        (0..1500).map(|_| [random() - 0.5, random() - 0.5, 0.2 * random()]).collect();
    let apart = |a: [f32; 3], b: [f32; 3]| {
        (0..3).map(|i| (f64::from(a[i]) - f64::from(b[i])).powi(2)).sum::<f64>().sqrt()
    };
    for distance in [0.01, 0.05, 0.3] {
        let mut stays: Vec<[f32; 3]> = Vec::new();
        let mut expected = Vec::new();
        for &p in &positions {
            let near = stays.iter().filter(|&&q| apart(p, q) <= distance);
            match near.min_by(|&&a, &&b| apart(p, a).total_cmp(&apart(p, b))) {
                Some(&q) => expected.push(q),
                None => {
                    stays.push(p);
                    expected.push(p);
                }
            }
        }
        let welded = Mesh::new(positions.clone(), []).unwrap().welded(distance);
        assert_eq!(welded.positions(), expected);
        assert!(stays.len() < positions.len());
    }
}

/// Vertices and their values stay; only positions change.
#[test]
fn welding_keeps_wedges() {
    let mesh = engine_made(Shape::Torus, true);
    let welded = mesh.welded(1e-5);
    assert_eq!(welded.triangles(), mesh.triangles());
    assert_eq!(welded.attributes(), mesh.attributes());
    let topology = Topology::new(&welded);
    assert_eq!([topology.point_count(), topology.wedge_count()], [40 * 28, 41 * 29]);
}

#[cfg(feature = "io")]
#[test]
fn a_model_with_jitter_becomes_a_closed_sphere() {
    let Some(mesh) = crate::models::read("mesh/near_positions", "hostile/near_duplicates.obj") else {
        return;
    };
    assert_eq!(Report::welded(&mesh).border_edges, 2_880);
    let welded = Report::welded(&mesh.welded(1e-6));
    assert!(welded.is_closed() && welded.is_manifold());
    assert_eq!((welded.vertices, welded.euler_characteristic), (642, 2));
    let sequence = Simplifier::new().target(Target::Triangles(100)).run(&mesh).unwrap();
    let level = Report::welded(&sequence.extract(&mesh, sequence.len()));
    assert_eq!((level.border_edges, level.euler_characteristic), (0, 2));
}
