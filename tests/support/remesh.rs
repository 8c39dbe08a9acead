//! What tests of remeshing share.

#![allow(dead_code)]

use std::collections::BTreeMap;

use multires::mesh::{Mesh, MeshPoint, Topology, shapes};
use multires::remesh::{Depth, Parameterisation, Remesher};
use multires::wavelet::{DomainPoint, WaveletMesh, WaveletOptions};

/// Returns a number from 0 to below 1, random in both arguments.
pub fn random(a: u64, b: u64) -> f64 {
    let mut x = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_mul(0xd6e8_feb8_6659_fd93) ^ 0x5851_f42d;
    x ^= x >> 32;
    x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x ^= x >> 29;
    (x.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / (1u64 << 24) as f64
}

/// Procedural meshes of all kinds, with the number of base faces to aim at.
pub fn models() -> Vec<(&'static str, Mesh, usize)> {
    vec![
        ("rock", shapes::rock(3_000, 1), 60),
        ("terrain", shapes::terrain(33, 2), 40),
        ("torus", shapes::torus(1.0, 0.4, 40, 20), 60),
        ("knot with seams", shapes::torus_knot(2, 3, 120, 8), 200),
        ("uv sphere", shapes::uv_sphere(32, 16), 40),
        ("open cylinder", shapes::open_cylinder(24, 10), 30),
        ("gear", shapes::cut_in_four(&shapes::gear(8, 0.3)), 100),
        ("washer", shapes::cut_in_four(&shapes::washer(24, 0.5, 0.2)), 60),
        ("pocketed block", shapes::cut_in_four(&shapes::pocketed_block(2, 3)), 100),
        ("lettering", shapes::cut_in_four(&shapes::lettering(3, 1, 0.2)), 60),
        ("ramps", shapes::ring_with_ramps(32, 6), 40),
        ("two materials", shapes::cut_in_four(&shapes::two_material_plate(24, 0.3)), 30),
        ("seam island", shapes::plate_with_seam_island(24, 0.3), 30),
        ("prop", shapes::prop(10), 150),
        ("robot", shapes::robot(3), 300),
        ("tree", shapes::tree(40), 150),
        ("flat rock", shapes::flat_rock(1_500, 3), 40),
        ("skinned tube", shapes::skinned_tube(16, 30), 40),
        ("painted disc", shapes::painted_disc(24, 8), 40),
        ("forest", shapes::forest(20, 4, 1), 200),
        ("gravel", shapes::gravel(9, 1), 100),
        ("shell", shapes::shell(3, 0.9), 100),
        ("cube", shapes::box_with_face_normals(6), 12),
    ]
}

/// Small meshes of odd topology.
pub fn awkward() -> Vec<(&'static str, Mesh)> {
    let mesh = |positions: &[[f32; 3]], triangles: &[[u32; 3]]| {
        Mesh::new(positions.to_vec(), triangles.to_vec()).unwrap()
    };
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
    vec![
        ("one triangle", mesh(&corners[..3], &[[0, 1, 2]])),
        ("two triangles", mesh(&corners, &[[0, 1, 2], [2, 1, 4]])),
        ("two triangles of clashing orientation", mesh(&corners, &[[0, 1, 2], [1, 2, 4]])),
        ("a triangle and two without three points", mesh(&corners, &[[0, 0, 1], [0, 1, 2], [2, 2, 2]])),
        ("a triangle twice", mesh(&corners, &[[0, 1, 2], [0, 1, 2]])),
        ("a triangle three times", mesh(&corners, &[[0, 1, 2], [1, 2, 0], [2, 1, 0]])),
        ("a triangle without area", mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]])),
        ("tetrahedron", shapes::tetrahedron()),
        ("pillow", shapes::pillow()),
        ("book of three", shapes::book(3)),
        ("book of six", shapes::cut_in_four(&shapes::cut_in_four(&shapes::book(6)))),
        ("bow tie", shapes::cut_in_four(&shapes::bowtie())),
        ("touching spheres", shapes::two_spheres_touching(2)),
        ("Moebius strip", shapes::moebius(12)),
        ("Moebius strip, finer", shapes::cut_in_four(&shapes::moebius(30))),
        ("hub", shapes::hub(200)),
        ("spindle", shapes::spindle(100)),
        ("soup", shapes::soup(20, 1)),
        ("plane", shapes::plane(9)),
        ("plate with a hole", shapes::plate_with_hole(16, 0.0)),
        ("shaft", shapes::stepped_shaft(3, 12, 1)),
    ]
}

pub fn map(mesh: &Mesh, faces: usize) -> Parameterisation {
    Remesher::new().base_faces(faces).run(mesh).unwrap()
}

pub fn remesh(map: &Parameterisation, mesh: &Mesh, levels: usize) -> WaveletMesh {
    let baked = map.bake(mesh, Depth::Levels(levels), &WaveletOptions::default()).unwrap();
    WaveletMesh::clone(baked.structure())
}

/// Random weights: of every eight, two on a side and one at a corner.
pub fn weights(seed: u64, salt: u64) -> [f64; 3] {
    let mut weights: [f64; 3] = std::array::from_fn(|k| random(seed, 3 * salt + k as u64) + 1e-3);
    let zeros = [0, 0, 1, 0, 0, 1, 0, 2][(salt % 8) as usize];
    (0..zeros).for_each(|k| weights[((salt / 8 + k) % 3) as usize] = 0.0);
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

pub fn at(mesh: &Mesh, point: &MeshPoint) -> [f64; 3] {
    point.position(mesh).unwrap()
}

/// Returns the point of the base's own surface at a place.
pub fn on_base(base: &Mesh, place: &DomainPoint) -> [f64; 3] {
    at(base, &MeshPoint::new(place.base_face, place.barycentric))
}

pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Whether a triangle has three different points.
pub fn is_face(mesh: &Mesh, triangle: usize) -> bool {
    let [a, b, c] =
        mesh.triangles()[triangle].map(|v| mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits()));
    a != b && b != c && c != a
}

/// Sides of triangles by the edge between points: triangle, number of the side, and whether it runs from the higher point.
pub fn sides(mesh: &Mesh) -> BTreeMap<[u32; 2], Vec<(u32, usize, bool)>> {
    let topology = Topology::new(mesh);
    let mut sides: BTreeMap<[u32; 2], Vec<_>> = BTreeMap::new();
    for (t, corners) in (0..).zip(mesh.triangles()) {
        for k in 0..3 {
            let [a, b] = [corners[k], corners[(k + 1) % 3]].map(|v| topology.point_of()[v as usize]);
            if a != b {
                sides.entry([a.min(b), a.max(b)]).or_default().push((t, k, a > b));
            }
        }
    }
    sides
}

/// Weights of the point at a share `t` of a side, from its lower point.
pub fn along(side: usize, backward: bool, t: f64) -> [f64; 3] {
    let t = if backward { 1.0 - t } else { t };
    let mut weights = [0.0; 3];
    (weights[side], weights[(side + 1) % 3]) = (1.0 - t, t);
    weights
}
