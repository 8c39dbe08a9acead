//! Four triangles sharing their first corner, side by side: which of them a point lies over, and its distance from
//! each.

use glam::Vec4;

use super::lanes::Lanes;

/// Four triangles relative to their shared first corner. `a` and `b`: the two other corners of each.
///
/// A point `p` lies between the sides along `a` and `b` where `p . side_a >= 0` and `p . side_b >= 0`. It lies over the
/// triangle where also `p . side_ab + reach >= 0`. Its squared distance is then `(p . normal)^2 * inverse_area`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sectors {
    a: Lanes,
    b: Lanes,
    normal: Lanes,
    side_a: Lanes,
    side_b: Lanes,
    side_ab: Lanes,
    reach: Vec4,
    inverse_area: Vec4,
}

impl Sectors {
    /// `normal`: the cross product of `a` and `b`.
    #[inline]
    pub fn new(a: Lanes, b: Lanes, normal: Lanes) -> Self {
        let side_ab = normal.cross(&b.minus(&a));
        let area = normal.dot(&normal);
        // Without an area there is no inside.
        let has_area = area.cmpgt(Vec4::splat(f32::MIN_POSITIVE));
        Self {
            side_a: normal.cross(&a),
            side_b: b.cross(&normal),
            reach: Vec4::select(has_area, -a.dot(&side_ab), Vec4::NEG_ONE),
            inverse_area: Vec4::ONE / area.max(Vec4::splat(f32::MIN_POSITIVE)),
            side_ab,
            a,
            b,
            normal,
        }
    }

    /// Returns the squared distances of a point to the triangles it lies over; infinite for other triangles.
    #[inline]
    pub fn heights(&self, p: &Lanes) -> Vec4 {
        let between = p.dot(&self.side_a).min(p.dot(&self.side_b));
        let inside = between.min(p.dot(&self.side_ab) + self.reach).cmpge(Vec4::ZERO);
        let height = p.dot(&self.normal);
        Vec4::select(inside, height * height * self.inverse_area, Vec4::INFINITY)
    }

    /// Returns the squared distances of a point to the triangles' sides.
    #[inline]
    pub fn sides(&self, p: &Lanes) -> Vec4 {
        let origin = Lanes([Vec4::ZERO; 3]);
        let spokes = origin.distance_squared(&self.a, p).min(origin.distance_squared(&self.b, p));
        spokes.min(self.a.distance_squared(&self.b.minus(&self.a), p))
    }
}

/// Returns the least of four distances, and its lane.
#[inline]
pub(crate) fn least(distances: Vec4) -> (f32, usize) {
    let least = distances.min_element();
    let lane = distances.cmpeq(Vec4::splat(least)).bitmask().trailing_zeros();
    (least, lane as usize & 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn distances_from_triangles() {
        let [a, b] = [Vec3::X, Vec3::Y].map(Lanes::splat);
        let sectors = Sectors::new(a, b, a.cross(&b));
        for (from, distance) in [
            (Vec3::new(0.2, 0.2, 0.5), 0.25),
            (Vec3::new(0.5, -2.0, 0.0), 4.0),
            (Vec3::new(1.0, 1.0, 0.0), 0.5),
            (Vec3::new(-1.0, -1.0, 1.0), 3.0),
        ] {
            let p = Lanes::splat(from);
            let (found, _) = least(sectors.heights(&p).min(sectors.sides(&p)));
            assert!((found - distance).abs() < 1e-6, "{from}: {found}");
        }
    }

    #[test]
    fn without_an_area_there_is_no_inside() {
        let a = Lanes::splat(Vec3::X);
        let sectors = Sectors::new(a, a, a.cross(&a));
        let p = Lanes::splat(Vec3::new(0.5, 0.0, 2.0));
        assert_eq!(least(sectors.heights(&p)).0, f32::INFINITY);
        assert_eq!(least(sectors.sides(&p)).0, 4.0);
    }
}
