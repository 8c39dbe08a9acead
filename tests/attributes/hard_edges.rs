//! Promise: normals that a crease angle explains hold no mesh: they are computed anew after simplification and look as they
//! did; normals that nothing explains are carried along as they are.

use crate::meshes::{self, cross, dot, normal, sub};
use multires::mesh::{Attribute, Creases, Mesh, NormalWeights, names, shapes};
use multires::simplify::{
    CollapseSequence, Normals, NormalsDone, Permissive, Simplifier, StopReason, Target,
};

/// Every triangle with three vertices and a normal of its own.
fn flat_shaded(mesh: &Mesh) -> Mesh {
    let corners = mesh.triangles().iter().flatten();
    let positions: Vec<[f32; 3]> = corners.map(|&v| mesh.positions()[v as usize]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let unit = |t: &[u32; 3]| unit(normal(t.map(|v| positions[v as usize]))).map(|x| x as f32);
    let normals: Vec<[f32; 3]> = triangles.iter().flat_map(|t| [unit(t); 3]).collect();
    Mesh::new(positions, triangles)
        .unwrap()
        .with_attribute(Attribute::floats(names::NORMAL, &normals))
        .unwrap()
}

fn unit(n: [f64; 3]) -> [f64; 3] {
    let length = dot(n, n).sqrt();
    n.map(|x| x / length)
}

fn stored(mesh: &Mesh, vertex: u32) -> [f64; 3] {
    let normals = mesh.attribute(names::NORMAL).unwrap().as_floats().unwrap();
    std::array::from_fn(|i| f64::from(normals[3 * vertex as usize + i]))
}

fn facet(mesh: &Mesh, t: &[u32; 3]) -> [f64; 3] {
    unit(normal(t.map(|v| mesh.positions()[v as usize])))
}

fn simplify(mesh: &Mesh, normals: Normals, ratio: f64) -> CollapseSequence {
    Simplifier::new().normals(normals).target(Target::Ratio(ratio)).run(mesh).unwrap()
}

fn level(mesh: &Mesh, normals: Normals, ratio: f64) -> Mesh {
    let sequence = simplify(mesh, normals, ratio);
    sequence.extract(mesh, sequence.len())
}

/// Degrees between two unit vectors, good for small angles too.
fn degrees(a: [f64; 3], b: [f64; 3]) -> f64 {
    let c = cross(a, b);
    dot(c, c).sqrt().atan2(dot(a, b)).to_degrees()
}

/// A box of `n` cells along each side, whose outer two cells are bent to quarter circles.
fn bevelled(n: u32) -> Mesh {
    let mesh = meshes::cube(n);
    let (half, inner) = (0.5 * n as f32, 0.5 * n as f32 - 2.0);
    let round = |p: [f32; 3]| {
        let p = p.map(|x| (x * n as f32).round() - half);
        let core = p.map(|x| x.clamp(-inner, inner));
        let d: [f32; 3] = std::array::from_fn(|i| p[i] - core[i]);
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        std::array::from_fn(|i| core[i] + d[i] / length * 2.0)
    };
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|&p| round(p)).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

fn with_creases(mesh: &Mesh, angle: f32) -> Mesh {
    mesh.with_crease_normals(&Creases { angle, weights: NormalWeights::Area })
}

#[test]
fn flat_shaded_meshes_reach_their_target_and_stay_flat_shaded() {
    let shapes = [
        ("sphere", shapes::icosphere(3)),
        ("rock", shapes::rock(3000, 3)),
        ("terrain", shapes::terrain(40, 7)),
    ];
    for (name, shape) in shapes {
        let mesh = flat_shaded(&shape);
        let sequence = simplify(&mesh, Normals::default(), 0.1);
        assert_eq!(sequence.report().stop, StopReason::Target, "{name}: {:?}", sequence.report());
        assert_eq!(sequence.validate(), Ok(()));
        let level = sequence.extract(&mesh, sequence.len());
        assert!(level.triangles().len() * 10 <= mesh.triangles().len(), "{name}");
        for t in level.triangles() {
            for &v in t {
                let turn = degrees(stored(&level, v), facet(&level, t));
                assert!(turn < 0.1, "{name}: a normal is {turn} degrees off its face");
            }
        }
        let again = simplify(&mesh, Normals::default(), 0.1);
        assert_eq!(again.extract(&mesh, again.len()), level, "{name}");
        // The surface is that of the mesh without normals.
        let bare = self::level(&shape, Normals::default(), 0.1);
        assert_eq!(bare.triangles().len(), level.triangles().len(), "{name}");
        let simplifier = Simplifier::new().normals(Normals::Keep).permissive(Permissive::Off);
        let held = simplifier.target(Target::Ratio(0.1)).run(&mesh).unwrap();
        assert_eq!(held.report().stop, StopReason::NothingLegal, "{name}: kept normals hold it");
    }
}

#[test]
fn the_angle_is_found_that_normals_were_made_with() {
    let box_ = shapes::box_with_face_normals(6);
    let cases = [(flat_shaded(&shapes::icosphere(2)), 0.0..4.0), (box_, 0.0..90.0)];
    for (mesh, range) in cases {
        let (creases, share) = Creases::fitted(&mesh).unwrap();
        assert!(range.contains(&creases.angle), "{creases:?}, not {range:?}");
        assert!(share > 0.999, "{share}");
    }
    let smooth = with_creases(&shapes::rock(2000, 1), 180.0);
    assert_eq!(Creases::fitted(&smooth), Some((Creases { angle: 180.0, weights: NormalWeights::Area }, 1.0)));
    for angle in [20.0, 40.0, 60.0] {
        let mesh = with_creases(&shapes::rock(4000, 6), angle);
        let (creases, share) = Creases::fitted(&mesh).unwrap();
        assert!((creases.angle - angle).abs() < 1.0 && share > 0.99, "{creases:?}, {share}, not {angle}");
        assert_eq!(creases.weights, NormalWeights::Area);
    }
}

#[test]
fn a_bevelled_box_keeps_its_look() {
    let mesh = with_creases(&bevelled(16), 180.0);
    for normals in [Normals::Automatic, Normals::Recompute { crease_angle: None }] {
        let level = level(&mesh, normals, 0.3);
        assert!(level.triangles().len() * 3 < mesh.triangles().len());
        // No normal is far from the input's at the nearest vertex.
        for v in 0..level.positions().len() as u32 {
            let place = level.positions()[v as usize];
            let off = |w: u32| {
                let d = sub(mesh.positions()[w as usize], place);
                dot(d, d)
            };
            let nearest =
                (0..mesh.positions().len() as u32).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap();
            let turn = degrees(stored(&level, v), stored(&mesh, nearest));
            assert!(turn < 20.0, "{normals:?}: a normal is {turn} degrees off");
        }
    }
    // A box with creases at its edges slides along them: nothing is to be recomputed.
    let sharp = shapes::box_with_face_normals(8);
    assert_eq!(Normals::Automatic.resolve(&sharp), Ok(NormalsDone::Kept));
}

#[test]
fn creases_are_where_the_angle_puts_them() {
    let cube = bevelled(4);
    for (angle, mean) in [(180.0, 1.0), (0.0, 2.0)] {
        let mesh = with_creases(&cube, angle);
        assert_eq!(mesh.triangles().len(), cube.triangles().len());
        assert!(mesh.positions().len() as f64 >= mean * cube.positions().len() as f64);
        for (t, before) in mesh.triangles().iter().zip(cube.triangles()) {
            for (&v, &w) in t.iter().zip(before) {
                assert_eq!(mesh.positions()[v as usize], cube.positions()[w as usize]);
                let n = stored(&mesh, v);
                assert!((dot(n, n) - 1.0).abs() < 1e-5);
            }
        }
    }
    // Two squares at a right angle: one normal along the fold, or two.
    let positions = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0f32],
    ];
    let fold = Mesh::new(positions, [[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4]]).unwrap();
    assert_eq!(with_creases(&fold, 91.0).positions().len(), 6);
    let creased = with_creases(&fold, 89.0);
    assert_eq!(creased.positions().len(), 8);
    for t in creased.triangles() {
        assert!(t.iter().all(|&v| degrees(stored(&creased, v), facet(&creased, t)) < 1e-3));
    }
}

#[test]
fn hand_made_normals_are_kept() {
    // Every face has its own normals, but turned by up to 20 degrees: no angle explains them.
    let mesh = flat_shaded(&shapes::icosphere(3));
    let normals: Vec<[f32; 3]> = (0..mesh.positions().len() as u32)
        .map(|v| {
            let n = stored(&mesh, v);
            let off = [0.35 * f64::from(v % 3) - 0.35, 0.35 * f64::from(v % 5) - 0.7, 0.2];
            unit(std::array::from_fn(|i| n[i] + off[i])).map(|x| x as f32)
        })
        .collect();
    let made = Mesh::new(mesh.positions(), mesh.triangles()).unwrap();
    let made = made.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    assert_eq!(Normals::Automatic.resolve(&made), Ok(NormalsDone::Kept));
    let level = level(&made, Normals::Automatic, 0.5);
    let is_stored = |n: [f64; 3]| normals.contains(&n.map(|x| x as f32));
    assert!((0..level.positions().len() as u32).all(|v| is_stored(stored(&level, v))));
}

#[test]
fn both_sides_of_a_sheet_have_normals_of_their_own() {
    let single = flat_shaded(&meshes::grid(16, 16, |u, v| 0.3 * u * (1.0 - v) * u));
    let count = single.positions().len() as u32;
    let behind = single.triangles().iter().map(|&[a, b, c]| [a + count, c + count, b + count]);
    let triangles: Vec<[u32; 3]> = single.triangles().iter().copied().chain(behind).collect();
    let positions = [single.positions(), single.positions()].concat();
    let normals: Vec<[f32; 3]> = (0..2 * count)
        .map(|v| stored(&single, v % count).map(|x| if v < count { x as f32 } else { -x as f32 }))
        .collect();
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mesh = mesh.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    let sequence = simplify(&mesh, Normals::Automatic, 0.1);
    assert_eq!(sequence.report().stop, StopReason::Target, "{:?}", sequence.report());
    let level = sequence.extract(&mesh, sequence.len());
    for t in level.triangles() {
        assert!(t.iter().all(|&v| degrees(stored(&level, v), facet(&level, t)) < 0.1));
    }
}

#[test]
fn dropped_normals_are_gone() {
    let mesh = flat_shaded(&shapes::icosphere(3));
    let sequence = simplify(&mesh, Normals::Drop, 0.1);
    assert_eq!(sequence.report().stop, StopReason::Target);
    assert_eq!(sequence.report().normals, NormalsDone::Dropped);
    for steps in [0, sequence.len()] {
        assert!(sequence.extract(&mesh, steps).attribute(names::NORMAL).is_none());
    }
}

#[test]
fn angles_out_of_range_are_refused() {
    let mesh = flat_shaded(&shapes::icosphere(1));
    for angle in [f32::NAN, -1.0, 181.0] {
        let normals = Normals::Recompute { crease_angle: Some(angle) };
        assert!(Simplifier::new().normals(normals).run(&mesh).is_err(), "{angle}");
    }
}
