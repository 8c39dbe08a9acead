//! Shapes around error vectors, round about an axis: spheroids, and spheres with cones.
//!
//! ```text
//!               ___                          .            tip: along
//!             /     \                       / \
//!    along   |   +   |               along / _ \          flanks touch the sphere
//!             \ ___ /                     ( (+) )         across: its radius
//!            across                        \ ~ /
//!                                           \ /
//! ```
//!
//! Both shapes are convex and symmetric about the origin, so shape A contains shape B if A's support function is nowhere
//! smaller than B's. Vectors are given in the plane of the axis, by their lengths along the axis (`h`) and across it
//! (`t`).

use crate::geometry::rounding;

use glam::DVec3;

/// Kind of a bound around error vectors, round about the cone's axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorShape {
    /// An ellipsoid of revolution, with semi-axes `along` and `across`. May be longer or shorter along the axis than
    /// across.
    #[default]
    Spheroid,
    /// The convex hull of a ball and two points on the axis: the tips of cones touching the ball. If the tips lie within
    /// the ball, the ball alone.
    SphereAndCones,
}

impl ErrorShape {
    /// Returns the half-lengths, along the axis and across it, of a small shape containing all vectors.
    ///
    /// `vectors` are pairs `|e.n|`, `|e x n|` for axis `n`. A sphere with cones has the ratio
    /// `r = max |e.n| : max |e x n|`. A spheroid has the ratio `r` or a lower power of `r`, whichever has the smallest
    /// mean size over all directions. If `r <= 1`, both shapes are balls: an oblate spheroid looks as large as its
    /// circumscribed ball from everywhere.
    ///
    /// Returns 0 if there are no vectors. NaN and infinity count as `f32::MAX`. Results are rounded up.
    ///
    /// Source of the ratio: Azuma et al. 2003 (View-dependent refinement of multiresolution meshes with subdivision
    /// connectivity), Eq. 3.
    pub fn fit(self, vectors: impl Iterator<Item = (f64, f64)> + Clone) -> [f32; 2] {
        let mut fit = Fit::new(self, vectors.clone().fold([0.0, 0.0], Fit::span));
        vectors.for_each(|vector| fit.add(vector));
        fit.sizes()
    }
}

/// The two passes of [`ErrorShape::fit`], for vectors found by a search rather than a list.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fit {
    shape: ErrorShape,
    /// Largest `h` (`high`) and largest `t` (`wide`) of any vector.
    high: f64,
    wide: f64,
    /// Ratios of length to width to try, and the half-length across the axis needed so far for each ratio, or its square.
    ratios: [f64; RATIO_POWERS.len()],
    across: [f64; RATIO_POWERS.len()],
    tried: usize,
}

impl Fit {
    /// First pass: adds a vector to the largest `h` and `t`.
    #[inline]
    pub fn span([high, wide]: [f64; 2], (h, t): (f64, f64)) -> [f64; 2] {
        [number(h).max(high), number(t).max(wide)]
    }

    /// Starts the second pass, with the results of the first pass.
    pub fn new(shape: ErrorShape, [high, wide]: [f64; 2]) -> Self {
        let mut fit = Self {
            shape,
            high,
            wide,
            ratios: [1.0; RATIO_POWERS.len()],
            across: [0.0; RATIO_POWERS.len()],
            tried: 1,
        };
        if high > wide && wide > 0.0 {
            if shape == ErrorShape::Spheroid {
                fit.ratios = RATIO_POWERS.map(|power| (high / wide).powf(power));
                fit.tried = fit.ratios.len();
            } else {
                fit.ratios[0] = high / wide;
            }
        }
        fit
    }

    /// Returns the half-length across the axis needed by a ratio to contain a vector, or its square. Grows with `h` and
    /// `t`.
    #[inline]
    fn needs(&self, at: usize, (h, t): (f64, f64)) -> f64 {
        let (h, t) = (number(h), number(t));
        if self.high <= self.wide || self.wide <= 0.0 {
            return h.hypot(t);
        }
        match self.shape {
            ErrorShape::Spheroid => {
                let h = h / self.ratios[at];
                h * h + t * t
            }
            // The flanks' normal points to where the flanks touch the ball.
            ErrorShape::SphereAndCones => flank_radius((h, t), flank(self.high, self.wide)),
        }
    }

    /// Adds a vector from the first pass.
    #[inline]
    pub fn add(&mut self, vector: (f64, f64)) {
        for at in 0..self.tried {
            self.across[at] = self.across[at].max(self.needs(at, vector));
        }
    }

    /// Whether adding a vector would change the result.
    #[inline]
    pub fn grows_by(&self, vector: (f64, f64)) -> bool {
        (0..self.tried).any(|at| self.needs(at, vector) > self.across[at])
    }

    /// Returns the half-lengths along the axis and across it.
    pub fn sizes(&self) -> [f32; 2] {
        let Self { shape, high, wide, ratios, across, .. } = self;
        if *wide <= 0.0 {
            return [rounding::up(*high), 0.0];
        }
        let [along, across] = match shape {
            ErrorShape::Spheroid if *high <= 0.0 => [0.0, *wide],
            _ if high <= wide => [across[0], across[0]],
            ErrorShape::Spheroid => {
                // Mean squares of the sizes. Over all directions, the mean squared sine is 2/3.
                let looks = |at: usize| across[at] * (1.0 + (ratios[at] * ratios[at] - 1.0) * (2.0 / 3.0));
                let best = (0..ratios.len()).min_by(|&a, &b| looks(a).total_cmp(&looks(b))).unwrap_or(0);
                let across = across[best].sqrt() * (1.0 + 1e-15);
                [across * ratios[best], across]
            }
            ErrorShape::SphereAndCones => [across[0] * ratios[0], across[0]],
        };
        [rounding::up(along), rounding::up(across)]
    }
}

/// Powers of the ratio of Eq. 3 allowed for a spheroid. For a single vector far along the axis, the spheroid with the
/// smallest mean size has about the root of the ratio. The spheroid of Eq. 3 is 1.4 times as long as the vector.
const RATIO_POWERS: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];

/// Returns the length as a finite number, not negative. NaN becomes `f32::MAX`.
fn number(length: f64) -> f64 {
    length.abs().min(f64::from(f32::MAX))
}

/// Cosine and sine of the angle from the axis to where flanks from a tip touch the ball.
fn flank(tip: f64, radius: f64) -> (f64, f64) {
    let cosine = (radius / tip).min(1.0);
    (cosine, ((1.0 - cosine) * (1.0 + cosine)).sqrt())
}

/// Returns the radius of the ball with flanks of the given normal, if a vector lies on the ball's surface or on its
/// flanks.
fn flank_radius((h, t): (f64, f64), (cosine, sine): (f64, f64)) -> f64 {
    if t * cosine > h * sine { h.hypot(t) } else { h * cosine + t * sine }
}

/// Returns the distance of the tip at which the hull of a ball of the given radius contains a vector; infinite if there
/// is none.
fn tip((h, t): (f64, f64), radius: f64) -> f64 {
    let square = h * h + t * t;
    if square <= radius * radius {
        0.0
    } else if t <= 0.0 {
        h
    } else {
        let cosine = (h * radius - t * (square - radius * radius).sqrt()) / square;
        if cosine > 0.0 { radius / cosine } else { f64::INFINITY }
    }
}

/// Relative tolerances of tests for rounding errors: of squares, and of lengths. Less than a step of single precision.
const SQUARE_ROOM: f64 = 1e-15;
const ROOM: f64 = 1e-12;
/// Radii tried when a ball grows.
const TRIALS: u32 = 32;

/// A shape with its axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    kind: ErrorShape,
    /// In whole numbers, so angles between axes are exact; 0 for a ball.
    axis: DVec3,
    along: f64,
    across: f64,
}

impl Shape {
    /// `axis` is in whole numbers. Without an axis, creates the ball containing the shape about any axis.
    pub fn new(kind: ErrorShape, axis: DVec3, along: f32, across: f32) -> Self {
        // NaN and negative lengths count as 0.
        let length = |x: f32| if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 };
        let (mut along, mut across) = (length(along), length(across));
        if axis == DVec3::ZERO {
            along = along.max(across);
            across = along;
        }
        Self { kind, axis, along, across }
    }

    /// Returns the length of the longest vector in the shape.
    pub fn largest(&self) -> f64 {
        self.along.max(self.across)
    }

    /// Returns half of the extent across a line of sight, for the sine of the angle between the line and the axis.
    #[inline]
    pub fn size(&self, sine: f64) -> f64 {
        let Self { along, across, .. } = *self;
        match self.kind {
            ErrorShape::Spheroid => {
                (across * across + (along * along - across * across).max(0.0) * (sine * sine)).sqrt()
            }
            ErrorShape::SphereAndCones => across.max(along * sine),
        }
    }

    /// Returns the largest change of [`Shape::size`] per radian.
    #[inline]
    pub fn slope(&self) -> f64 {
        let Self { along, across, .. } = *self;
        let longer = (along - across).max(0.0);
        match self.kind {
            ErrorShape::Spheroid => longer,
            ErrorShape::SphereAndCones => (longer * (along + across)).sqrt(),
        }
    }

    /// Returns cosine and sine (not negative) of the angle between the axes. Exact at angle 0. Without an axis, of angle
    /// 0.
    fn turned(&self, other: &Self) -> (f64, f64) {
        let lengths = (self.axis.length_squared() * other.axis.length_squared()).sqrt();
        if lengths > 0.0 {
            (self.axis.dot(other.axis).abs() / lengths, self.axis.cross(other.axis).length() / lengths)
        } else {
            (1.0, 0.0)
        }
    }

    /// Returns the tip of `other`, along and across the own axis.
    fn tip_of(&self, other: &Self) -> (f64, f64) {
        let (cosine, sine) = self.turned(other);
        (other.along * cosine, other.along * sine)
    }

    /// Returns the quadratic form `u^T M u` (the square of the support function) of a spheroid `other`, in the plane of
    /// the two axes: its entries along the own axis and across it, and the entry between.
    fn form_of(&self, other: &Self) -> [f64; 3] {
        let (cosine, sine) = self.turned(other);
        let (along, across) = (other.along * other.along, other.across * other.across);
        let beyond = along - across;
        [across + beyond * (cosine * cosine), across + beyond * (sine * sine), beyond * (cosine * sine)]
    }

    /// Whether a spheroid contains another spheroid: the difference of the forms is positive semidefinite.
    fn holds_spheroid(&self, other: &Self) -> bool {
        let room = SQUARE_ROOM * self.largest().max(other.largest()).powi(2);
        let [along, across, between] = self.form_of(other);
        let a = self.along * self.along - along + room;
        let b = self.across * self.across - across + room;
        self.across >= other.across && a >= 0.0 && b >= 0.0 && a * b >= between * between
    }

    /// Whether a vector lies in a sphere with cones.
    fn holds_vector(&self, (h, t): (f64, f64)) -> bool {
        let room = ROOM * self.largest();
        if h.hypot(t) <= self.across + room {
            return true;
        }
        if self.along <= self.across || h > self.along + room {
            return false;
        }
        let normal = flank(self.along, self.across);
        let (cosine, sine) = normal;
        t * cosine <= h * sine + room && h * cosine + t * sine <= self.across + room
    }

    /// Returns the ball and the segment between the tips. A sphere with cones is their convex hull.
    fn ball_and_needle(&self) -> [Self; 2] {
        let spheroid = |along: f64, across: f64| Self { kind: ErrorShape::Spheroid, along, across, ..*self };
        [spheroid(self.across, self.across), spheroid(self.along, 0.0)]
    }

    /// Whether this shape contains another shape. Exact, except for spheroids in spheres with cones: true only if the
    /// ball contains the spheroid.
    pub fn holds(&self, other: &Self) -> bool {
        match (self.kind, other.kind) {
            (ErrorShape::Spheroid, ErrorShape::Spheroid) => self.holds_spheroid(other),
            (ErrorShape::Spheroid, ErrorShape::SphereAndCones) => {
                other.ball_and_needle().iter().all(|part| self.holds_spheroid(part))
            }
            (ErrorShape::SphereAndCones, ErrorShape::Spheroid) => self.across >= other.largest(),
            (ErrorShape::SphereAndCones, ErrorShape::SphereAndCones) => {
                self.across >= other.across && self.holds_vector(self.tip_of(other))
            }
        }
    }

    /// Returns half-lengths with which the shape contains `other` too. The sum of squares of the three semi-axes grows as
    /// little as possible, for spheres with cones nearly so. Rounded up. Unchanged if the shape already contains `other`.
    pub fn enlarged(&self, other: &Self) -> [f32; 2] {
        let (mut along, mut across) = (self.along, self.across);
        if !self.holds(other) {
            if self.axis == DVec3::ZERO {
                along = along.max(other.largest());
                across = along;
            } else {
                [along, across] = match (self.kind, other.kind) {
                    (ErrorShape::Spheroid, ErrorShape::Spheroid) => self.least_spheroid(other),
                    (ErrorShape::Spheroid, ErrorShape::SphereAndCones) => {
                        let [ball, needle] = other.ball_and_needle();
                        let [along, across] = self.least_spheroid(&ball);
                        Self { along, across, ..*self }.least_spheroid(&needle)
                    }
                    (ErrorShape::SphereAndCones, ErrorShape::Spheroid) => [along, other.largest()],
                    (ErrorShape::SphereAndCones, ErrorShape::SphereAndCones) => self.least_hull(other),
                };
            }
        }
        let mut sizes = [rounding::up(along.max(self.along)), rounding::up(across.max(self.across))];
        for _ in 0..4 {
            if Self::new(self.kind, self.axis, sizes[0], sizes[1]).holds(other) {
                return sizes;
            }
            sizes = sizes.map(|size| size.next_up().min(f32::MAX));
        }
        // No half-length is large enough: the ball of the largest holds whatever single precision can tell.
        [f32::MAX; 2]
    }

    /// Returns the spheroid about the own axis, no smaller than the own, containing `other`.
    fn least_spheroid(&self, other: &Self) -> [f64; 2] {
        let [along, across, between] = self.form_of(other);
        // `a`, `b`: the excess of the squares over the form of `other`. Each has a least value, and `a b >= between^2`.
        let wide = self.across.max(other.across);
        let (least_a, least_b) = ((self.along.powi(2) - along).max(0.0), (wide * wide - across).max(0.0));
        let product = between * between;
        let (mut a, mut b) = (least_a, least_b);
        if a * b < product {
            // Minimum of `a + 2 b` on the hyperbola.
            a = (2.0 * product).sqrt();
            b = (0.5 * product).sqrt();
            if a < least_a {
                (a, b) = (least_a, product / least_a);
            } else if b < least_b {
                (a, b) = (product / least_b, least_b);
            }
        }
        [(along + a).sqrt(), (across + b).sqrt().max(wide)]
    }

    /// Returns the sphere with cones about the own axis, no smaller than the own, containing `other`.
    fn least_hull(&self, other: &Self) -> [f64; 2] {
        let point = self.tip_of(other);
        let least = self.across.max(other.across);
        // Flanks reach no point farther across than the ball's radius.
        let (low, high) = (least.max(point.1), other.along.max(least));
        let mut best = [self.along, high];
        let square = |[along, across]: [f64; 2]| along * along + 2.0 * across * across;
        for trial in 0..TRIALS {
            let radius = low + (high - low) * (f64::from(trial) / f64::from(TRIALS));
            let tried = [tip(point, radius).max(self.along), radius];
            if square(tried) < square(best) {
                best = tried;
            }
        }
        best
    }
}
