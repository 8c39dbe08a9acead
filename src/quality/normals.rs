//! Shading normals: per corner of every triangle, smooth across gentle edges and split at creases.

use glam::Vec3;

use crate::geometry::lists::Lists;
use crate::mesh::{Mesh, Topology, names};

/// Cosine of the angle between two triangles' normals below which an edge is a crease: 45 degrees.
const CREASE: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// Most corners around a point for which creases are sought: the cost grows with the square of their number. A corner
/// at a more crowded point gets its triangle's normal.
const CROWDED: usize = 64;

/// Returns unit normals, three to a triangle; zero if there is none. Uses the mesh's own normals if it has them.
/// Otherwise takes the mean by area of the triangles around each point, without triangles across a crease. O(n).
pub(super) fn corner_normals(mesh: &Mesh) -> Vec<Vec3> {
    if let Some(own) = mesh.attribute(names::NORMAL).filter(|a| a.width() == 3).and_then(|a| a.as_floats()) {
        let normal = |v: u32| Vec3::from_slice(&own[3 * v as usize..3 * v as usize + 3]).normalize_or_zero();
        return mesh.indices().iter().map(|&v| normal(v)).collect();
    }
    smooth_normals(mesh, CREASE)
}

/// Returns unit normals, three to a triangle, from the surface alone, ignoring the mesh's own normals. A corner's
/// normal is the mean by area of the triangles around its point. Triangles with `cosine < crease` to the corner's own
/// triangle are left out. Vertices at equal positions are a single point. O(n).
pub(super) fn smooth_normals(mesh: &Mesh, crease: f32) -> Vec<Vec3> {
    let faces = face_normals(mesh);
    let topology = Topology::new(mesh);
    let point_of = |corner: usize| topology.point_of()[mesh.indices()[corner] as usize];

    let by_point = (0..mesh.indices().len()).map(|corner| (point_of(corner), corner as u32));
    let corners = Lists::from_pairs(topology.point_count(), by_point);

    (0..mesh.indices().len())
        .map(|corner| {
            let around = corners.get(point_of(corner));
            let (own, area) = faces[corner / 3];
            if around.len() > CROWDED {
                return own;
            }
            let smooth = |&other: &u32| {
                let (normal, area) = faces[other as usize / 3];
                if normal.dot(own) >= crease { normal * area } else { Vec3::ZERO }
            };
            (around.iter().map(smooth).sum::<Vec3>() / area.max(f32::MIN_POSITIVE)).normalize_or(own)
        })
        .collect()
}

/// Returns the unit normal and the area of every triangle, in squares of the mesh's size; a zero normal without an
/// area.
fn face_normals(mesh: &Mesh) -> Vec<(Vec3, f32)> {
    let unit = mesh.diagonal().max(f64::MIN_POSITIVE);
    let position = |v: u32| glam::DVec3::from_array(mesh.positions()[v as usize].map(f64::from)) / unit;
    mesh.triangles()
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(position);
            let normal = (b - a).cross(c - a);
            (normal.normalize_or_zero().as_vec3(), (normal.length() * 0.5) as f32)
        })
        .collect()
}
