//! Promise: feature curves of the mesh are edges of the base, and base faces keep to a side of them.

use std::collections::BTreeSet;

use crate::support::{along, awkward, distance, is_face, map, models, sides, weights};
use multires::mesh::{Mesh, MeshPoint, Topology, names, shapes};
use multires::remesh::{Creasing, Features, Parameterisation, Remesher};
use multires::wavelet::DomainPoint;

/// Weight below which a point lies on a side of its base face.
const ON_SIDE: f64 = 1e-9;

fn normal(mesh: &Mesh, triangle: u32) -> [f64; 3] {
    let [a, b, c] = mesh.triangles()[triangle as usize].map(|v| mesh.positions()[v as usize].map(f64::from));
    let (e, f): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let length = distance(n, [0.0; 3]).max(f64::MIN_POSITIVE);
    n.map(|x| x / length)
}

/// Feature edges, each by its sides: borders, non-manifold and flipped edges, edges between materials and where values
/// of texture coordinates or colours differ, and bends of more than `degrees`.
fn feature_edges(mesh: &Mesh, degrees: f64) -> Vec<Vec<(u32, usize, bool)>> {
    let value = |v: u32, name: &str| {
        let values = mesh.attribute(name).map(|a| (a.width(), a.as_floats().unwrap_or_default()));
        values.map(|(width, all)| all[v as usize * width..(v as usize + 1) * width].to_vec())
    };
    let corner =
        |(t, side, _): (u32, usize, bool), end: usize| mesh.triangles()[t as usize][(side + end) % 3];
    let is_feature = |sides: &Vec<(u32, usize, bool)>| {
        let &[a, b] = sides.as_slice() else { return true };
        let differs = |name: &str| {
            let (end, other) = if a.2 == b.2 { ([0, 1], [0, 1]) } else { ([0, 1], [1, 0]) };
            (0..2).any(|k| value(corner(a, end[k]), name) != value(corner(b, other[k]), name))
        };
        let [m, n] = [a, b].map(|side| mesh.materials().get(side.0 as usize));
        let [p, q] = [a, b].map(|side| normal(mesh, side.0));
        let cosine: f64 = (0..3).map(|i| p[i] * q[i]).sum();
        a.2 == b.2
            || m != n
            || differs(names::UV)
            || differs(names::COLOR)
            || cosine < degrees.to_radians().cos()
    };
    let faces = sides(mesh).into_values().map(|mut sides| {
        sides.retain(|side| is_face(mesh, side.0 as usize));
        sides
    });
    faces.filter(|sides| !sides.is_empty() && is_feature(sides)).collect()
}

/// Points on feature edges, as a point of a triangle beside the edge.
fn feature_points(mesh: &Mesh, degrees: f64) -> Vec<MeshPoint> {
    let edges = feature_edges(mesh, degrees);
    let point = |&(t, side, backward): &(u32, usize, bool), share: f64| {
        MeshPoint::new(t, along(side, backward, share))
    };
    edges
        .iter()
        .flat_map(|sides| sides.iter().flat_map(|side| [0.0, 0.3, 0.5, 1.0].map(|share| point(side, share))))
        .collect()
}

fn assert_on_sides(name: &str, map: &Parameterisation, points: &[MeshPoint]) {
    for point in points {
        let place = map.to_base(point).unwrap();
        let least = place.barycentric.iter().copied().fold(1.0, f64::min);
        assert!(least < ON_SIDE, "{name}: {point:?} lies at {place:?}");
    }
}

#[test]
fn points_of_features_lie_on_edges_of_the_base() {
    for (name, mesh, faces) in models().into_iter().chain(awkward().into_iter().map(|(n, m)| (n, m, 4))) {
        // Borders, seams and material borders count without being asked for.
        assert_on_sides(name, &map(&mesh, faces), &feature_points(&mesh, 181.0));
        // And bends, where the angle is given.
        let features = Features::new().creasing(Creasing::Angle(50.0));
        let map = Remesher::new().base_faces(faces).features(features).run(&mesh).unwrap();
        assert_on_sides(name, &map, &feature_points(&mesh, 50.01));
    }
}

#[test]
fn borders_of_the_base_are_borders_of_the_mesh() {
    for (name, mesh, faces) in models() {
        let map = map(&mesh, faces);
        let (of_mesh, of_base) = (sides(&mesh), sides(map.base()));
        for (sides, image) in [(&of_mesh, "base"), (&of_base, "mesh")] {
            for side in sides.values().filter(|sides| sides.len() == 1).flatten() {
                let weights = along(side.1, side.2, 0.37);
                let (weights, on, triangle) = match image {
                    "base" => {
                        let place = map.to_base(&MeshPoint::new(side.0, weights)).unwrap();
                        (place.barycentric, &of_base, place.base_face)
                    }
                    _ => {
                        let point = map.to_mesh(&DomainPoint::new(side.0, weights)).unwrap();
                        (point.barycentric, &of_mesh, point.triangle)
                    }
                };
                // The image lies on a side which is a border too.
                let number = (0..3).filter(|&k| weights[(k + 2) % 3] < ON_SIDE);
                let mut borders = number.filter(|&k| {
                    on.values().any(|sides| sides.len() == 1 && (sides[0].0, sides[0].1) == (triangle, k))
                });
                assert!(
                    borders.next().is_some(),
                    "{name}: {side:?} in the {image} at {triangle}, {weights:?}"
                );
            }
        }
    }
}

#[test]
fn base_faces_do_not_mix_materials() {
    let mut several = 0;
    for (name, mesh, faces) in models().into_iter().filter(|(_, mesh, _)| !mesh.materials().is_empty()) {
        let map = map(&mesh, faces);
        assert_eq!(map.base().material_names(), mesh.material_names(), "{name}");
        let materials = |mesh: &Mesh| mesh.materials().iter().copied().collect::<BTreeSet<u32>>();
        assert_eq!(materials(map.base()), materials(&mesh), "{name}");
        several += usize::from(materials(&mesh).len() > 1);
        for (face, &material) in (0..).zip(map.base().materials()) {
            for sample in (0..40).filter(|sample| ![2, 5, 7].contains(&(sample % 8))) {
                let point = map.to_mesh(&DomainPoint::new(face, weights(u64::from(face), sample))).unwrap();
                assert_eq!(mesh.materials()[point.triangle as usize], material, "{name}: face {face}");
            }
        }
    }
    assert!(several >= 4);
}

#[test]
fn locked_vertices_are_vertices_of_the_base() {
    for (name, mesh, faces) in models() {
        let count = mesh.positions().len();
        let topology = Topology::new(&mesh);
        let used: BTreeSet<u32> = mesh.triangles().as_flattened().iter().copied().collect();
        let locks: Vec<bool> =
            (0..count).map(|v| v % (count / 7 + 1) == 3 && used.contains(&(v as u32))).collect();
        let locked: BTreeSet<u32> =
            (0..count).filter(|&v| locks[v]).map(|v| topology.point_of()[v]).collect();
        let mesh = mesh.with_locks(locks).unwrap();
        let map = map(&mesh, faces);
        let of_base: BTreeSet<[u32; 3]> =
            map.base().positions().iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
        for point in locked {
            let p = mesh.positions()[topology.vertex_of_point()[point as usize] as usize];
            assert!(of_base.contains(&p.map(|x| (x + 0.0).to_bits())), "{name}: {p:?}");
        }
    }
}

#[test]
fn corners_are_vertices_of_the_base() {
    let mesh = shapes::box_with_face_normals(6);
    let base = map(&mesh, 12).base().clone();
    for corner in 0..8 {
        let at = [0, 1, 2].map(|i| if corner >> i & 1 == 1 { 1.0 } else { -1.0 });
        assert!(base.positions().contains(&at), "{at:?}");
    }
    assert_eq!(base.triangles().len(), 12);
    // Where a border turns sharply.
    let base = map(&shapes::plane(16), 2).base().clone();
    for at in [[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0]] {
        assert!(base.positions().contains(&at), "{at:?}");
    }
}

#[test]
fn marked_edges_lie_on_edges_of_the_base() {
    let mesh = shapes::icosphere(4);
    // A curve around the sphere: edges between triangles on both sides of a plane.
    let above = |t: u32| {
        mesh.triangles()[t as usize].map(|v| mesh.positions()[v as usize][1]).iter().sum::<f32>() > 0.6
    };
    let sides = sides(&mesh);
    let marked: Vec<_> = sides.values().filter(|s| above(s[0].0) != above(s[1].0)).map(|s| s[0]).collect();
    assert!(marked.len() > 30);
    let ends =
        |&(t, side, _): &(u32, usize, bool)| [0, 1].map(|end| mesh.triangles()[t as usize][(side + end) % 3]);
    let inside = |map: &Parameterisation| {
        let place = |side: &(u32, usize, bool)| {
            map.to_base(&MeshPoint::new(side.0, along(side.1, side.2, 0.4))).unwrap()
        };
        let least = |side| place(side).barycentric.into_iter().fold(1.0, f64::min);
        marked.iter().filter(|side| least(side) > ON_SIDE).count()
    };
    let edges: Vec<[u32; 2]> = marked.iter().map(ends).collect();
    let with = |features| Remesher::new().base_faces(60).features(features).run(&mesh).unwrap();
    assert_eq!(inside(&with(Features::new().mark(edges.iter().copied()))), 0);
    // A single edge.
    let one = with(Features::new().mark([edges[7]]));
    let ends = edges[7].map(|v| mesh.positions()[v as usize]);
    let of_base = |t: &[u32; 3]| {
        let at = t.map(|v| one.base().positions()[v as usize]);
        ends.iter().all(|end| at.contains(end))
    };
    assert_eq!(one.base().triangles().iter().filter(|t| of_base(t)).count(), 2);
    assert!(inside(&with(Features::new())) > 10);
    // Pairs which are no edge are ignored.
    let none = with(Features::new().mark([[0, 0], [0, u32::MAX], [0, 2000]]));
    assert_eq!(none.base(), with(Features::new()).base());
}

#[test]
fn bends_do_not_count_unless_they_outline_a_part() {
    // Relief of a scan bends, and makes no features.
    let rock = shapes::rock(3_000, 1);
    assert!(feature_points(&rock, 50.0).len() > 100);
    assert_eq!(map(&rock, 60).base().triangles().len(), 60);
    // Edges of a part do.
    let gear = shapes::cut_in_four(&shapes::gear(8, 0.3));
    assert_on_sides("gear", &map(&gear, 100), &feature_points(&gear, 60.0));
}

#[cfg(feature = "io")]
#[test]
fn creases_of_fandisk_are_found_by_themselves() {
    let Some(mesh) = crate::models::read("remesh/features", "real/fandisk.obj") else { return };
    let map = Remesher::new().run(&mesh).unwrap();
    // The ends of creases that fade out, too.
    let points = feature_points(&mesh, 42.0);
    let least = |p: &MeshPoint| map.to_base(p).unwrap().barycentric.into_iter().fold(1.0, f64::min);
    let off = points.iter().filter(|point| least(point) > ON_SIDE).count();
    println!("{off} of {} points lie off the edges of the base", points.len());
    assert_eq!(off, 0);
}

#[cfg(feature = "io")]
#[test]
fn creases_of_fandisk_lie_on_edges_of_the_remesh() {
    let Some(mesh) = crate::models::read("remesh/features", "real/fandisk.obj") else { return };
    let features = Features::new().creasing(Creasing::Angle(40.0));
    let map = Remesher::new().features(features).run(&mesh).unwrap();
    let points = feature_points(&mesh, 40.01);
    assert!(points.len() > 1_000);
    assert_on_sides("fandisk", &map, &points);
    // Distance from the edges of level 5: pieces of sides of base faces.
    let pieces = 32.0;
    let mut worst = 0.0f64;
    for point in &points {
        let place = map.to_base(point).unwrap();
        let side = (0..3).find(|&k| place.barycentric[(k + 2) % 3] < ON_SIDE).unwrap();
        let t = place.barycentric[(side + 1) % 3];
        let low = (t * pieces).floor().min(pieces - 1.0);
        let [a, b] = [low, low + 1.0].map(|end| {
            let place = DomainPoint::new(place.base_face, along(side, false, end / pieces));
            crate::support::at(&mesh, &map.to_mesh(&place).unwrap())
        });
        let (p, d) = (crate::support::at(&mesh, point), [0, 1, 2].map(|i| b[i] - a[i]));
        let square: f64 = d.iter().map(|x| x * x).sum();
        let dot: f64 = (0..3).map(|i| (p[i] - a[i]) * d[i]).sum();
        let share = (dot / square.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        worst = worst.max(distance(p, std::array::from_fn(|i| a[i] + share * d[i])));
    }
    println!("{:.4} % of the diagonal", 100.0 * worst / mesh.diagonal());
    assert!(worst < 0.0002 * mesh.diagonal(), "{}", worst / mesh.diagonal());
}
