//! Minima of quadratic functions in three unknowns, in double precision.
//!
//! Provides two methods for two kinds of metric. [`nearest_minimum`] solves once and stays near its start in directions
//! of little influence. [`Constraints`] takes linear constraints in order and leaves out constraints incompatible with
//! the earlier ones (Lindstrom and Turk 1998, section 3).

use glam::DVec3;

/// A symmetric 3 x 3 matrix: xx, yy, zz, xy, xz, yz.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Symmetric(pub [f64; 6]);

impl Symmetric {
    pub const ZERO: Self = Self([0.0; 6]);

    /// `diagonal` times the identity.
    pub fn identity(diagonal: f64) -> Self {
        Self([diagonal, diagonal, diagonal, 0.0, 0.0, 0.0])
    }

    /// Adds `n n'`.
    #[inline]
    pub fn add_outer(&mut self, n: DVec3) {
        let terms = [n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z];
        self.0.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }

    /// Subtracts `n n'`.
    #[inline]
    pub fn subtract_outer(&mut self, n: DVec3) {
        let terms = [n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z];
        self.0.iter_mut().zip(terms).for_each(|(sum, term)| *sum -= term);
    }

    /// Adds another matrix.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, term)| *sum += term);
    }

    /// Returns this matrix times `factor`.
    #[inline]
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }

    /// Returns this matrix times `v`.
    #[inline]
    pub fn times(&self, v: DVec3) -> DVec3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        DVec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }

    /// The sum of the eigenvalues.
    #[inline]
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[1] + self.0[2]
    }
}

/// Share of the trace added to every eigenvalue: directions with less than a millionth of the influence of the others
/// keep to the start.
const RAISE: f64 = 1e-6;

/// Returns the step `d` minimising `d'Hd + 2 g'd` for a positive semidefinite `H`. Every eigenvalue is raised slightly so
/// that the step is unique and never far: on a plane the step is along the normal, on a ridge across it. 0 if `H` is 0.
pub(super) fn nearest_minimum(h: &Symmetric, gradient: DVec3) -> DVec3 {
    let raise = h.trace() * RAISE;
    let [xx, yy, zz, xy, xz, yz] = h.0;
    let (xx, yy, zz) = (xx + raise, yy + raise, zz + raise);
    // Cofactors: accurate in double precision, as the raised matrix has a condition of at most a million.
    let c = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy];
    let determinant = xx * c[0] + xy * c[1] + xz * c[2];
    let step = DVec3::new(
        c[0] * gradient.x + c[1] * gradient.y + c[2] * gradient.z,
        c[1] * gradient.x + (xx * zz - xz * xz) * gradient.y + (xy * xz - xx * yz) * gradient.z,
        c[2] * gradient.x + (xy * xz - xx * yz) * gradient.y + (xx * yy - xy * xy) * gradient.z,
    ) / -determinant;
    if step.is_finite() { step } else { DVec3::ZERO }
}

/// cos^2 and sin^2 of 1 degree: constraints whose normals are within this angle of being dependent are left out.
const COS2: f64 = 0.999_695_413_509_547_9;
const SIN2: f64 = 0.000_304_586_490_452_134_8;

/// Ratio of a gradient's row to the matrix below which the row is rounding noise: positions carry 24 bits, so on a plane
/// slopes are noise of about 1e-5, and their squares 1e-10.
const NOISE: f64 = 1e-10;

/// Up to three constraints `a . x = b` with independent normals.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Constraints {
    a: [DVec3; 3],
    b: [f64; 3],
    len: usize,
}

impl Constraints {
    /// Whether the constraints determine a point.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.len == 3
    }

    /// Adds a constraint if it is compatible with the earlier constraints.
    #[inline]
    pub fn add(&mut self, a: DVec3, b: f64) {
        let length2 = a.length_squared();
        let compatible = match self.len {
            0 => true,
            1 => self.a[0].dot(a).powi(2) < COS2 * length2,
            2 => {
                let normal = self.a[0].cross(self.a[1]);
                normal.dot(a).powi(2) > SIN2 * normal.length_squared() * length2
            }
            _ => false,
        };
        if compatible && length2 > f64::MIN_POSITIVE {
            let scale = 1.0 / length2.sqrt();
            self.a[self.len] = a * scale;
            self.b[self.len] = b * scale;
            self.len += 1;
        }
    }

    /// Adds the constraints minimising `x'Hx - 2 c'x` among the points satisfying the earlier constraints.
    #[inline]
    pub fn minimise(&mut self, h: &Symmetric, c: DVec3) {
        let least = (h.trace() * NOISE).powi(2);
        let along = |constraints: &mut Self, q: DVec3| {
            let row = h.times(q);
            if row.length_squared() > least {
                constraints.add(row, q.dot(c));
            }
        };
        match self.len {
            0 => [DVec3::X, DVec3::Y, DVec3::Z].into_iter().for_each(|q| along(self, q)),
            1 => {
                let (q, r) = self.a[0].any_orthonormal_pair();
                along(self, q);
                along(self, r);
            }
            2 => along(self, self.a[0].cross(self.a[1]).normalize_or_zero()),
            _ => {}
        }
    }

    /// Returns the point satisfying all constraints; `None` with fewer than three.
    #[inline]
    pub fn point(&self) -> Option<DVec3> {
        if self.len < 3 {
            return None;
        }
        let [a, b, c] = self.a;
        let ab = a.cross(b);
        let x = (self.b[0] * b.cross(c) + self.b[1] * c.cross(a) + self.b[2] * ab) / ab.dot(c);
        x.is_finite().then_some(x)
    }
}

/// Returns the point minimising `x'Hx - 2 c'x` on the plane `n . x = d` if all constraints are compatible: the point
/// found by [`Constraints`] from `add(n, d)` and `minimise(h, c)`, without normalising. `None` if a constraint is
/// incompatible.
#[inline]
pub(super) fn minimise_on_plane(h: &Symmetric, c: DVec3, n: DVec3, d: f64) -> Option<DVec3> {
    let n2 = n.length_squared();
    // Two directions in the plane, of any length.
    let q = if n.x.abs() < n.z.abs() { DVec3::new(0.0, -n.z, n.y) } else { DVec3::new(-n.y, n.x, 0.0) };
    let r = n.cross(q);
    let (hq, hr) = (h.times(q), h.times(r));
    let (q2, r2) = (q.length_squared(), r.length_squared());
    let (qq, qr, rr) = (q.dot(hq), q.dot(hr), r.dot(hr));
    // Squared length of the first row's part in the plane, and the area spanned by both rows there (both as lengths in
    // units of q and r).
    let first = qq * qq * r2 + qr * qr * q2;
    let determinant = qq * rr - qr * qr;
    let (hq2, hr2) = (hq.length_squared(), hr.length_squared());
    let noise = (h.trace() * NOISE).powi(2);
    let compatible = n2 > f64::MIN_POSITIVE
        && first > SIN2 * hq2 * q2 * r2
        && determinant * determinant > SIN2 * first * hr2
        && hq2 > noise * q2
        && hr2 > noise * r2;
    if !compatible {
        return None;
    }
    let start = n * (d / n2);
    let rest = c - h.times(start);
    let (a, b) = (q.dot(rest), r.dot(rest));
    let x = start + (q * (a * rr - b * qr) + r * (b * qq - a * qr)) / determinant;
    x.is_finite().then_some(x)
}
