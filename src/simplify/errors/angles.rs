//! Triangles around a point sorted by angle: the triangle below another point is found by asking a few of very many.
//!
//! ```text
//!        \  |  /            Directions are taken in the plane across the triangles' mean normal. Four triangles at a
//!      --- x ---            time make a group; a point is looked for in the group that its direction falls into and
//!        /  |  \            in those next to it.
//! ```
//!
//! Where a fan is not a function over the plane, the triangle found need not be the nearest; its distance is an upper
//! bound.

use glam::Vec3;

use crate::simplify::surface::patch::Facet;

/// Triangles sorted by angle, and the plane in which directions are measured.
#[derive(Debug, Clone, Default)]
pub(crate) struct Angles {
    right: Vec3,
    up: Vec3,
    order: Vec<(f32, u32)>,
}

impl Angles {
    /// Sorts facets by the angle of their midpoints. O(n log n).
    pub fn sort(&mut self, facets: &mut Vec<Facet>, scratch: &mut Vec<Facet>) {
        let axis = facets.iter().map(|facet| facet.after).sum::<Vec3>().try_normalize().unwrap_or(Vec3::Z);
        (self.right, self.up) = axis.any_orthonormal_pair();
        let mut order = std::mem::take(&mut self.order);
        order.clear();
        order.extend(facets.iter().zip(0..).map(|(facet, i)| (self.angle(facet.a + facet.b), i)));
        order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        scratch.clear();
        scratch.extend(order.iter().map(|&(_, i)| facets[i as usize]));
        std::mem::swap(facets, scratch);
        self.order = order;
    }

    /// Returns the index among the sorted facets at which a direction belongs. O(log n).
    pub fn place(&self, direction: Vec3) -> usize {
        let angle = self.angle(direction);
        self.order.partition_point(|&(other, _)| other < angle)
    }

    /// Returns a number from 0 to 4, growing with the angle around the axis.
    fn angle(&self, direction: Vec3) -> f32 {
        let (x, y) = (direction.dot(self.right), direction.dot(self.up));
        let share = y / (x.abs() + y.abs()).max(f32::MIN_POSITIVE);
        match (x < 0.0, y < 0.0) {
            (true, _) => 2.0 - share,
            (false, false) => share,
            (false, true) => 4.0 + share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_grow_once_around() {
        let mut angles = Angles::default();
        (angles.right, angles.up) = Vec3::Z.any_orthonormal_pair();
        let (right, up) = (angles.right, angles.up);
        let around = [
            right,
            right + 0.5 * up,
            right + up,
            up,
            up - 2.0 * right,
            -right,
            -right - up,
            -up,
            right - 3.0 * up,
            right - 0.1 * up,
        ];
        let angles: Vec<f32> = around.iter().map(|&d| angles.angle(d)).collect();
        assert!(angles.windows(2).all(|pair| pair[0] < pair[1]), "{angles:?}");
        assert!(angles[0] == 0.0 && angles[9] < 4.0);
    }
}
