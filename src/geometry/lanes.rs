//! Four vectors at once, so the processor's four lanes work on four triangles or neighbours in parallel.

use glam::{Vec3, Vec4};

/// Four vectors, by coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lanes(pub [Vec4; 3]);

impl Lanes {
    #[inline]
    pub fn splat(v: Vec3) -> Self {
        Self([Vec4::splat(v.x), Vec4::splat(v.y), Vec4::splat(v.z)])
    }

    #[inline]
    pub fn gather(mut of: impl FnMut(usize) -> Vec3) -> Self {
        let [p, q, r, s] = [of(0), of(1), of(2), of(3)];
        Self([Vec4::new(p.x, q.x, r.x, s.x), Vec4::new(p.y, q.y, r.y, s.y), Vec4::new(p.z, q.z, r.z, s.z)])
    }

    #[inline]
    pub fn dot(&self, o: &Self) -> Vec4 {
        self.0[0] * o.0[0] + self.0[1] * o.0[1] + self.0[2] * o.0[2]
    }

    #[inline]
    pub fn cross(&self, o: &Self) -> Self {
        let ([x, y, z], [u, v, w]) = (self.0, o.0);
        Self([y * w - z * v, z * u - x * w, x * v - y * u])
    }

    #[inline]
    pub fn minus(&self, o: &Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - o.0[i]))
    }

    /// Returns the squared distances from a point to the segments running from these points along `along`.
    #[inline]
    pub fn distance_squared(&self, along: &Self, p: &Self) -> Vec4 {
        let from = p.minus(self);
        let length = along.dot(along).max(Vec4::splat(f32::MIN_POSITIVE));
        let t = (from.dot(along) / length).clamp(Vec4::ZERO, Vec4::ONE);
        let off = Self(std::array::from_fn(|i| from.0[i] - t * along.0[i]));
        off.dot(&off)
    }
}
