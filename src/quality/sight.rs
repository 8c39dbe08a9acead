//! Ray casting against a mesh: first intersection with the surface, its side, and the normal to shade with.
//!
//! Uses sums, products, quotients and square roots only: equal bits on every machine.

use glam::{DVec3, Vec3};

use crate::geometry::bvh::{Bvh, RayHit, Walker};

/// A surface and its shading normals.
pub(super) struct Sight<'a> {
    pub bvh: &'a Bvh,
    /// Three normals to a triangle; empty for flat shading.
    pub normals: Vec<Vec3>,
}

/// The surface seen by a ray.
pub(super) struct SeenSurface {
    pub hit: RayHit,
    /// Triangle of the mesh.
    pub triangle: usize,
    /// Barycentric weights of the triangle's corners.
    pub weights: [f32; 3],
    /// True if the triangle's front is seen.
    pub front: bool,
    /// Unit normal of the triangle on the viewer's side.
    pub facing: DVec3,
    /// Unit normal to shade with; on the viewer's side.
    pub normal: Vec3,
}

impl Sight<'_> {
    /// Casts a ray along a unit direction; `None` if it misses the surface.
    pub(super) fn look(
        &self,
        walker: &mut Walker<'_>,
        origin: DVec3,
        direction: DVec3,
    ) -> Option<SeenSurface> {
        let hit = walker.first_hit(origin, direction, f64::INFINITY)?;
        let triangle = self.bvh.triangle_of()[hit.slot as usize] as usize;
        let [a, b, c] = self.bvh.corners(hit.slot);
        let face = (b - a).cross(c - a).normalize_or_zero();
        let front = face.dot(direction) <= 0.0;
        let facing = if front { face } else { -face };
        let weights = hit.weights.map(|w| w as f32);
        let normal = self.normal(triangle, weights, face.as_vec3(), front, direction.as_vec3());
        Some(SeenSurface { hit, triangle, weights, front, facing, normal })
    }

    fn normal(&self, triangle: usize, weights: [f32; 3], face: Vec3, front: bool, direction: Vec3) -> Vec3 {
        let flat = if front { face } else { -face };
        let Some(corners) = self.normals.get(3 * triangle..3 * triangle + 3) else { return flat };
        let blend =
            (corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2]).normalize_or(face);
        let normal = if front { blend } else { -blend };
        // If the triangle is visible but its smooth normal points away: take the nearest normal that does not.
        let away = normal.dot(direction);
        if away > 0.0 { (normal - direction * away).normalize_or(flat) } else { normal }
    }
}
