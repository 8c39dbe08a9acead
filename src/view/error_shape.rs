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
//! Both are convex and symmetric about the origin, so one holds another where its support function is nowhere smaller. All is
//! done in the plane of the axis: a vector is its part along the axis (`h`) and its part across (`t`), both as lengths.

use glam::DVec3;

/// Shape of the bound around error vectors. Both are round about the cone's axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorShape {
    /// An ellipsoid of revolution with these semi-axes, longer or shorter along the axis than across.
    #[default]
    Spheroid,
    /// The convex hull of a ball and of two points on the axis, the tips of cones that touch it. The ball alone where the tips
    /// are within.
    SphereAndCones,
}

impl ErrorShape {
    /// Half-lengths along the axis and across it of a small shape that holds all vectors: a sphere with cones has the ratio
    /// `max |e.n| : max |e x n|`, a spheroid that or a lesser power of it, whichever looks smallest on the mean over all directions. `vectors` are pairs `|e.n|`, `|e x n|` for axis `n`. 0 where there are none; what is not a
    /// number counts as the largest one. Rounded up.
    ///
    /// Both are a ball where that ratio is 1 or less: an oblate spheroid looks as large as the ball about it from everywhere.
    ///
    /// Source: Azuma et al. 2003 (View-dependent refinement of multiresolution meshes with subdivision connectivity), Eq. 3, for
    /// the ratio.
    pub fn fit(self, vectors: impl Iterator<Item = (f64, f64)> + Clone) -> [f32; 2] {
        let mut fit = Fit::new(self, vectors.clone().fold([0.0, 0.0], Fit::span));
        vectors.for_each(|vector| fit.add(vector));
        fit.sizes()
    }
}

/// The two passes of [`ErrorShape::fit`], for vectors that are searched rather than listed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fit {
    shape: ErrorShape,
    /// The largest part along the axis of any vector, and across it.
    high: f64,
    wide: f64,
    /// Ratios of length to width that are tried, and what shapes of them must measure across so far, or its square.
    ratios: [f64; RATIO_POWERS.len()],
    across: [f64; RATIO_POWERS.len()],
    tried: usize,
}

impl Fit {
    /// First pass: the largest parts of vectors along the axis and across it, with one more vector.
    #[inline]
    pub fn span([high, wide]: [f64; 2], (h, t): (f64, f64)) -> [f64; 2] {
        [number(h).max(high), number(t).max(wide)]
    }

    /// Second pass: with what the first found.
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

    /// What a shape of a ratio must measure across to hold a vector, or its square. Grows with both parts.
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
            // The flanks' normal, which leads to where they touch.
            ErrorShape::SphereAndCones => flank_radius((h, t), flank(self.high, self.wide)),
        }
    }

    /// With one more vector of those of the first pass.
    #[inline]
    pub fn add(&mut self, vector: (f64, f64)) {
        for at in 0..self.tried {
            self.across[at] = self.across[at].max(self.needs(at, vector));
        }
    }

    /// Whether a vector would change anything.
    #[inline]
    pub fn grows_by(&self, vector: (f64, f64)) -> bool {
        (0..self.tried).any(|at| self.needs(at, vector) > self.across[at])
    }

    /// Half-lengths along the axis and across it.
    pub fn sizes(&self) -> [f32; 2] {
        let Self { shape, high, wide, ratios, across, .. } = self;
        if *wide <= 0.0 {
            return [round_up(*high), 0.0];
        }
        let [along, across] = match shape {
            ErrorShape::Spheroid if *high <= 0.0 => [0.0, *wide],
            _ if high <= wide => [across[0], across[0]],
            ErrorShape::Spheroid => {
                // Mean squares of their sizes: from all directions alike, the mean squared sine is 2/3.
                let looks = |at: usize| across[at] * (1.0 + (ratios[at] * ratios[at] - 1.0) * (2.0 / 3.0));
                let best = (0..ratios.len()).min_by(|&a, &b| looks(a).total_cmp(&looks(b))).unwrap_or(0);
                let across = across[best].sqrt() * (1.0 + 1e-15);
                [across * ratios[best], across]
            }
            ErrorShape::SphereAndCones => [across[0] * ratios[0], across[0]],
        };
        [round_up(along), round_up(across)]
    }
}

/// Powers of the ratio of Eq. 3 that a spheroid may have. Of a single vector far along the axis, the spheroid that looks smallest
/// has about its root; Eq. 3's is 1.4 times as long as the vector.
const RATIO_POWERS: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];

/// A length as it counts.
fn number(length: f64) -> f64 {
    length.abs().min(f64::from(f32::MAX))
}

/// To single precision, no smaller.
fn round_up(x: f64) -> f32 {
    let rounded = x as f32;
    let rounded = if f64::from(rounded) < x { rounded.next_up() } else { rounded };
    rounded.min(f32::MAX)
}

/// Cosine and sine of the angle from the axis to where flanks from a tip touch the ball.
fn flank(tip: f64, radius: f64) -> (f64, f64) {
    let cosine = (radius / tip).min(1.0);
    (cosine, ((1.0 - cosine) * (1.0 + cosine)).sqrt())
}

/// Radius of the ball with flanks of that normal on whose surface, or on whose flanks, a vector is.
fn flank_radius((h, t): (f64, f64), (cosine, sine): (f64, f64)) -> f64 {
    if t * cosine > h * sine { h.hypot(t) } else { h * cosine + t * sine }
}

/// How far a tip must be so that a vector is in the hull with a ball of that radius; endless where none is far enough.
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

/// Shares by which a test forgives rounding: of squares, and of lengths. Less than a step of single precision.
const SQUARE_ROOM: f64 = 1e-15;
const ROOM: f64 = 1e-12;
/// Radii that are tried for a ball that grows.
const TRIALS: u32 = 32;

/// A shape about its axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    kind: ErrorShape,
    /// In whole numbers, so that angles between axes are exact; 0 of a ball.
    axis: DVec3,
    along: f64,
    across: f64,
}

impl Shape {
    /// `axis` in whole numbers. Without one it is the ball that holds the shape about any.
    pub fn new(kind: ErrorShape, axis: DVec3, along: f32, across: f32) -> Self {
        // What is no number is nothing.
        let length = |x: f32| if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 };
        let (mut along, mut across) = (length(along), length(across));
        if axis == DVec3::ZERO {
            along = along.max(across);
            across = along;
        }
        Self { kind, axis, along, across }
    }

    /// The longest of its vectors.
    pub fn largest(&self) -> f64 {
        self.along.max(self.across)
    }

    /// Half of what it spans across a line of sight, at that sine of the angle to its axis.
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

    /// By how much [`Shape::size`] changes, at most, for each radian.
    #[inline]
    pub fn slope(&self) -> f64 {
        let Self { along, across, .. } = *self;
        let longer = (along - across).max(0.0);
        match self.kind {
            ErrorShape::Spheroid => longer,
            ErrorShape::SphereAndCones => (longer * (along + across)).sqrt(),
        }
    }

    /// Cosine and sine, not negative, of the angle between the axes; exact where that is 0. Any for balls.
    fn turned(&self, other: &Self) -> (f64, f64) {
        let lengths = (self.axis.length_squared() * other.axis.length_squared()).sqrt();
        if lengths > 0.0 {
            (self.axis.dot(other.axis).abs() / lengths, self.axis.cross(other.axis).length() / lengths)
        } else {
            (1.0, 0.0)
        }
    }

    /// The tip of another about the own axis.
    fn tip_of(&self, other: &Self) -> (f64, f64) {
        let (cosine, sine) = self.turned(other);
        (other.along * cosine, other.along * sine)
    }

    /// What of a spheroid the difference of the quadratic forms `u^T M u` (the squares of support functions) has, in the plane
    /// of the axes, along the own axis and across it, less the own; and between.
    fn form_of(&self, other: &Self) -> [f64; 3] {
        let (cosine, sine) = self.turned(other);
        let (along, across) = (other.along * other.along, other.across * other.across);
        let beyond = along - across;
        [across + beyond * (cosine * cosine), across + beyond * (sine * sine), beyond * (cosine * sine)]
    }

    /// Whether a spheroid holds another: the larger form less the smaller is positive semidefinite.
    fn holds_spheroid(&self, other: &Self) -> bool {
        let room = SQUARE_ROOM * self.largest().max(other.largest()).powi(2);
        let [along, across, between] = self.form_of(other);
        let a = self.along * self.along - along + room;
        let b = self.across * self.across - across + room;
        self.across >= other.across && a >= 0.0 && b >= 0.0 && a * b >= between * between
    }

    /// Whether a vector is in a sphere with cones.
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

    /// The ball in a sphere with cones, and what is between its tips: together they span it.
    fn ball_and_needle(&self) -> [Self; 2] {
        let spheroid = |along: f64, across: f64| Self { kind: ErrorShape::Spheroid, along, across, ..*self };
        [spheroid(self.across, self.across), spheroid(self.along, 0.0)]
    }

    /// Whether this shape holds another. Exact, but that a sphere with cones holds a spheroid only where its ball does.
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

    /// Half-lengths with which it holds another too: the sum of squares of the three semi-axes grows by as little as can be, for
    /// spheres with cones nearly. Rounded up; nothing changes where it holds it already.
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
        let mut sizes = [round_up(along.max(self.along)), round_up(across.max(self.across))];
        for _ in 0..4 {
            if Self::new(self.kind, self.axis, sizes[0], sizes[1]).holds(other) {
                break;
            }
            sizes = sizes.map(|size| size.next_up().min(f32::MAX));
        }
        sizes
    }

    /// The spheroid about the own axis, no smaller, that holds another.
    fn least_spheroid(&self, other: &Self) -> [f64; 2] {
        let [along, across, between] = self.form_of(other);
        // What the squares exceed those of the other by: at least this, with a product of at least the square between.
        let wide = self.across.max(other.across);
        let (least_a, least_b) = ((self.along.powi(2) - along).max(0.0), (wide * wide - across).max(0.0));
        let product = between * between;
        let (mut a, mut b) = (least_a, least_b);
        if a * b < product {
            // Least a + 2 b on the hyperbola.
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

    /// The sphere with cones about the own axis, no smaller, that holds another.
    fn least_hull(&self, other: &Self) -> [f64; 2] {
        let point = self.tip_of(other);
        let least = self.across.max(other.across);
        // Flanks lead to no point that is farther out than the ball.
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
