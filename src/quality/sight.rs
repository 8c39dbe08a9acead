//! What a ray sees of a mesh: where it first meets the surface, from which side, and the normal to shade with.
//!
//! All in sums, products, quotients and square roots, so that it is the same bits on every machine.

use glam::{DVec3, Vec3};

use super::bvh::{Bvh, RayHit, Walker};

/// A surface and the normals to shade it with.
pub(super) struct Sight<'a> {
    pub bvh: &'a Bvh,
    /// Three to a triangle; empty for flat shading.
    pub normals: Vec<Vec3>,
}

/// What a ray sees.
pub(super) struct SeenSurface {
    pub hit: RayHit,
    /// The mesh's triangle.
    pub triangle: usize,
    /// Weights of its corners.
    pub weights: [f32; 3],
    /// Whether its front is seen.
    pub front: bool,
    /// Its unit normal on the viewer's side.
    pub facing: DVec3,
    /// The unit normal to shade with, on the viewer's side.
    pub normal: Vec3,
}

impl Sight<'_> {
    /// Along a unit direction; `None` where the ray misses the surface.
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
        // Where the triangle is seen and its smooth normal points away: the nearest that does not.
        let away = normal.dot(direction);
        if away > 0.0 { (normal - direction * away).normalize_or(flat) } else { normal }
    }
}
