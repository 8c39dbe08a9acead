//! Tests of many bounds at once: four by four, in single precision.
//!
//! ```text
//!     no <----------|-- margin --0-- margin --|----------> yes      every comparison as a signed distance from its limit:
//!        surely no  |      asked again        |  surely yes         how far the eye may move until it turns over
//! ```
//!
//! A comparison is a pair: how surely yes, and how surely no, each less the margin for all rounding errors. *And* takes the lesser yes
//! and the greater no, *or* the other way round. What is neither surely yes nor surely no is tested again in double precision, so
//! answers are those of double precision.

use glam::{BVec4A, Vec4};

use super::bounds::Bounds;
use super::camera::{ErrorKind, Eye};
use super::criteria::Answer;
use super::deviation::DeviationBounds;
use super::error_shape::ErrorShape;
use super::object::ObjectView;
use super::region;

/// Bounds tested at a time.
const LANES: usize = 4;
/// Margin, per unit of the lengths compared: several times the sum of the rounding errors of all steps.
const MARGIN: f32 = 16.0 * f32::EPSILON;
/// Least cosine of half the angle of a sphere beside which normals are compared.
const LEAST_COSINE: f32 = 1.0 / 16.0;
/// Apparent errors below this one, and above 0, are compared in double precision.
const TINY: f32 = 1e-20;

/// A view in single precision, relative to its eye.
pub(super) struct LaneView {
    /// The eye, and what rounding it leaves.
    eye: [[f32; 3]; 2],
    /// Normals and offsets from the eye, of as many planes as there are.
    planes: [Vec4; 5],
    plane_count: usize,
    reach: f32,
    silhouette_reach: f32,
    back_faces: bool,
    kind: ErrorKind,
}

impl LaneView {
    /// Returns a perspective view, with tolerances multiplied by a factor; `None` for other views.
    pub fn new(view: &ObjectView, factor: f64) -> Option<Self> {
        let Eye::At { eye, .. } = view.eye else { return None };
        let rounded = eye.as_vec3();
        let planes = view.planes.map(|plane| plane.truncate().extend(plane.dot(eye.extend(1.0))).as_vec4());
        Some(Self {
            eye: [rounded.to_array(), (eye - rounded.as_dvec3()).as_vec3().to_array()],
            planes,
            plane_count: if view.frustum { view.plane_count } else { 0 },
            reach: (view.reach / factor) as f32,
            silhouette_reach: (view.silhouette_reach / factor) as f32,
            back_faces: view.back_faces,
            kind: view.error,
        })
    }

    /// Answers for bounds. `exact` answers in double precision. `TURNS`: as
    /// [`Criterion::test_turning`](super::Criterion::test_turning).
    pub fn test<B: LaneBounds, const TURNS: bool>(
        &self,
        bounds: &[B],
        answers: &mut [Answer],
        exact: impl Fn(&B) -> Answer,
    ) {
        let silhouettes = self.silhouette_reach > self.reach;
        let angles = region::lane_angles();
        for (bounds, answers) in bounds.chunks(LANES).zip(answers.chunks_mut(LANES)) {
            let columns = Columns::new(bounds, self.kind, angles);
            let results = match silhouettes {
                true => columns.compare::<B, TURNS, true>(self),
                false => columns.compare::<B, TURNS, false>(self),
            };
            for (i, (bounds, answer)) in bounds.iter().zip(answers).enumerate() {
                let [moved, turned] = [results.moved[i], results.turned[i]];
                *answer = if moved > 0.0 && turned > 0.0 {
                    Answer {
                        refine: results.refine.test(i),
                        moved: f64::from(moved),
                        turned: f64::from(turned),
                    }
                } else {
                    exact(bounds)
                };
            }
        }
    }
}

/// Bounds as read by lanes.
pub(super) trait LaneBounds {
    /// Whether errors look different from elsewhere.
    const SLOPES: bool;

    /// The sphere's centre and radius, and the cone.
    fn region(&self) -> ([f32; 3], f32, [i8; 4]);

    /// Half-lengths of the error along the axis and across it, and whether it is a spheroid.
    fn error(&self, kind: ErrorKind) -> ([f32; 2], bool);
}

impl LaneBounds for Bounds {
    const SLOPES: bool = false;

    #[inline(always)]
    fn region(&self) -> ([f32; 3], f32, [i8; 4]) {
        (self.centre, self.radius, self.cone)
    }

    #[inline(always)]
    fn error(&self, kind: ErrorKind) -> ([f32; 2], bool) {
        let error = match kind {
            ErrorKind::Geometric => self.error,
            ErrorKind::Parametric => self.parametric,
        };
        ([error; 2], true)
    }
}

impl LaneBounds for DeviationBounds {
    const SLOPES: bool = true;

    #[inline(always)]
    fn region(&self) -> ([f32; 3], f32, [i8; 4]) {
        (self.centre, self.radius, self.cone)
    }

    #[inline(always)]
    fn error(&self, _: ErrorKind) -> ([f32; 2], bool) {
        let [x, y, z, _] = self.cone;
        // No number, and less than nothing, is nothing.
        let [along, across] = [self.along, self.across].map(|x| if x > 0.0 { x } else { 0.0 });
        let lengths = if (x | y | z) == 0 { [along.max(across); 2] } else { [along, across] };
        (lengths, self.shape == ErrorShape::Spheroid)
    }
}

/// Four bounds.
struct Columns {
    centre: [Vec4; 3],
    radius: Vec4,
    /// Half-lengths of the error, along the axis and across it, and 1 for a spheroid.
    along: Vec4,
    across: Vec4,
    spheroid: Vec4,
    axis: [Vec4; 3],
    /// Sine and cosine of the cone's half-angle; 2 and 0 for all directions.
    angle: [Vec4; 2],
}

/// Answers, and how far the eye may move and turn; 0 or less, or no number, for what is not sure.
struct Results {
    refine: BVec4A,
    moved: Vec4,
    turned: Vec4,
}

/// How surely yes, and how surely no. At most one of both is above 0.
#[derive(Clone, Copy)]
struct Sure {
    yes: Vec4,
    no: Vec4,
}

const ALL: Vec4 = Vec4::INFINITY;
const UNSURE: Vec4 = Vec4::NEG_ONE;

impl Sure {
    const ALWAYS: Self = Self { yes: ALL, no: UNSURE };

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self { yes: self.yes.min(other.yes), no: self.no.max(other.no) }
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self { yes: self.yes.max(other.yes), no: self.no.min(other.no) }
    }

    #[inline(always)]
    fn select(mask: BVec4A, a: Self, b: Self) -> Self {
        Self { yes: Vec4::select(mask, a.yes, b.yes), no: Vec4::select(mask, a.no, b.no) }
    }
}

#[inline(always)]
fn dot(a: [Vec4; 3], b: [Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [Vec4; 3], b: [Vec4; 3]) -> [Vec4; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The place of four spheres, relative to the eye.
struct Places {
    to: [Vec4; 3],
    radius: Vec4,
    distance: Vec4,
    gap: Vec4,
    /// Margin of lengths.
    margin: Vec4,
    /// Sine and cosine of half the angle of the sphere.
    half: [Vec4; 2],
    /// Sine of the angle by which the axis points away beyond a right angle, and its cosine.
    away: [Vec4; 2],
}

/// Apparent sizes of four errors: from here, from where they look smallest and largest, the largest change a radian, and the error of
/// the first.
struct Sizes {
    size: Vec4,
    least: Vec4,
    largest: Vec4,
    slope: Vec4,
    margin: Vec4,
}

/// Margin of sines and cosines of sums with half the angle of a sphere.
const ANGLE_MARGIN: f32 = MARGIN * (1.0 + 1.0 / LEAST_COSINE);
/// Largest ratio of reaches between which an error that looks different from elsewhere is compared.
const WIDEST: f32 = 7.0;

impl Columns {
    /// Puts down four bounds, or fewer, the last of them several times.
    #[inline(always)]
    fn new<B: LaneBounds>(bounds: &[B], kind: ErrorKind, angles: &[[f32; 2]; 256]) -> Self {
        let last = bounds.len() - 1;
        let four = [&bounds[0], &bounds[1.min(last)], &bounds[2.min(last)], &bounds[last]];
        let [a, b, c, d] = four.map(|bounds| bounds.region());
        let centre = |k: usize| Vec4::new(a.0[k], b.0[k], c.0[k], d.0[k]);
        let axis = |k: usize| {
            let of = |cone: [i8; 4]| f32::from(cone[k]);
            Vec4::new(of(a.2), of(b.2), of(c.2), of(d.2))
        };
        let [e, f, g, h] = [a.2, b.2, c.2, d.2].map(|cone| region::lane_angle(cone, angles));
        let radius = Vec4::new(a.1, b.1, c.1, d.1);
        let [p, q, r, s] = four.map(|bounds| bounds.error(kind));
        Self {
            centre: [centre(0), centre(1), centre(2)],
            // All of space is no number.
            radius: Vec4::select(radius.cmplt(Vec4::MAX), radius, Vec4::NAN),
            along: Vec4::new(p.0[0], q.0[0], r.0[0], s.0[0]),
            across: Vec4::new(p.0[1], q.0[1], r.0[1], s.0[1]),
            spheroid: Vec4::new(p.1.into(), q.1.into(), r.1.into(), s.1.into()),
            axis: [axis(0), axis(1), axis(2)],
            angle: [Vec4::new(e[0], f[0], g[0], h[0]), Vec4::new(e[1], f[1], g[1], h[1])],
        }
    }

    #[inline(always)]
    fn places(&self, view: &LaneView) -> Places {
        let [eye, rest] = view.eye;
        let to = |k: usize| self.centre[k] - Vec4::splat(eye[k]) - Vec4::splat(rest[k]);
        let to = [to(0), to(1), to(2)];
        let (distance, radius) = (dot(to, to).sqrt(), self.radius);
        let gap = distance - radius;
        let length = dot(self.axis, self.axis).sqrt();
        let per_length = (distance * length).recip();
        let per_distance =
            if length.cmpgt(Vec4::ZERO).all() { length * per_length } else { distance.recip() };
        let half_cosine = (gap * (distance + radius)).max(Vec4::ZERO).sqrt() * per_distance;
        let across = cross(self.axis, to);
        Places {
            to,
            radius,
            distance,
            gap,
            margin: (distance + radius) * MARGIN,
            half: [radius * per_distance, half_cosine],
            away: [dot(self.axis, to) * per_length, dot(across, across).sqrt() * per_length],
        }
    }

    #[inline(always)]
    fn sizes<B: LaneBounds>(&self, at: &Places) -> Sizes {
        let (along, across) = (self.along, self.across);
        if !B::SLOPES {
            return Sizes {
                size: along,
                least: along,
                largest: along,
                slope: Vec4::ZERO,
                margin: Vec4::ZERO,
            };
        }
        let spheroid = self.spheroid.cmpgt(Vec4::ZERO);
        let longer = (along - across).max(Vec4::ZERO);
        let slope = Vec4::select(spheroid, longer, (longer * (along + across)).sqrt());
        // The largest sine of the angle between the axis and a line of sight to the sphere.
        let ([half_sine, half_cosine], [cosine, sine]) = (at.half, [at.away[0].abs(), at.away[1]]);
        let beside = (cosine * half_cosine).cmple(sine * half_sine);
        let steepest = (sine * half_cosine + cosine * half_sine).min(Vec4::ONE);
        let steepest = Vec4::select(beside | at.gap.cmple(Vec4::ZERO), Vec4::ONE, steepest);
        let steepest = Vec4::select(slope.cmpgt(Vec4::ZERO), steepest, Vec4::ZERO);
        let beyond = (along * along - across * across).max(Vec4::ZERO);
        let round = (across * across + beyond * steepest * steepest).sqrt();
        let near = half_cosine.cmplt(Vec4::splat(LEAST_COSINE)) & at.gap.cmpgt(-at.margin);
        Sizes {
            size: Vec4::select(spheroid, round, across.max(along * steepest)),
            least: across,
            largest: along.max(across),
            slope,
            margin: Vec4::select(near, along + across, slope * ANGLE_MARGIN),
        }
    }

    /// Whether an error is too large up to a distance of `reach` times its size; and the angle that may be turned.
    #[inline(always)]
    fn too_large<B: LaneBounds, const TURNS: bool>(
        &self,
        at: &Places,
        sizes: &Sizes,
        reach: f32,
    ) -> (Sure, Vec4) {
        let none = !sizes.largest.cmpgt(Vec4::ZERO);
        let far = sizes.size * reach;
        let beyond = far - at.gap;
        let off = at.margin + far * MARGIN + sizes.margin * reach;
        let (yes, no) = (beyond - off, -beyond - off);
        let small = far.cmplt(Vec4::splat(TINY));
        if !B::SLOPES {
            let sure = Sure { yes: Vec4::select(small, UNSURE, yes), no: Vec4::select(none, ALL, no) };
            if !TURNS {
                return (sure, ALL);
            }
            let turned = ((beyond.abs() - off) / at.gap.max(far)).min(Vec4::ONE) - Vec4::splat(MARGIN);
            return (sure, Vec4::select(none, ALL, turned));
        }
        let (yes, no) = (yes.cmpgt(Vec4::ZERO) & !small, no.cmpgt(Vec4::ZERO));
        let own = Vec4::splat(reach);
        // With a factor that turns, half-way to the factor at which the answer changes: what holds there holds on all of the way.
        let (reach, turned) = if TURNS {
            let least = Vec4::splat(f32::MIN_POSITIVE);
            let limit = (at.gap.max(least) / sizes.size.max(least)).min(own * WIDEST);
            let between = (own + limit) * 0.5;
            let turned = Vec4::ONE - between.min(own) / between.max(own) - Vec4::splat(MARGIN);
            (between, Vec4::select(none, ALL, turned))
        } else {
            (own, ALL)
        };
        let far = sizes.size * reach;
        let apart = (far - at.gap).abs() - (at.margin + far * MARGIN + sizes.margin * reach);
        // As the eye moves, lines of sight turn by no more than asin(moved / gap).
        let turning =
            Vec4::ONE + sizes.slope * reach * (std::f32::consts::FRAC_PI_2 * (1.0 + MARGIN)) / at.gap;
        let turning = (apart / turning * (1.0 - MARGIN)).min(at.gap - at.margin);
        let turning = Vec4::select(at.gap.cmpgt(Vec4::ZERO), turning, -at.gap - at.margin);
        let turning = Vec4::select(sizes.slope.cmpgt(Vec4::ZERO), turning, apart);
        // Bounds for any turn of the lines of sight.
        let (least, largest) = (sizes.least * reach, sizes.largest * reach);
        let sure_yes = least - at.gap - at.margin - least * MARGIN;
        let sure_no = at.gap - largest - at.margin - largest * MARGIN;
        let sure = Sure {
            yes: Vec4::select(yes, turning.max(sure_yes), UNSURE),
            no: Vec4::select(none, ALL, Vec4::select(no, turning.max(sure_no), UNSURE)),
        };
        (sure, turned)
    }

    /// Whether any normal may face the eye, and whether any may face away from it.
    #[inline(always)]
    fn facing<const BACK: bool>(&self, at: &Places) -> [Sure; 2] {
        // Sine and cosine of the cone's half-angle, and of that with half the angle of the sphere.
        let ([sine, cosine], [half_sine, half_cosine]) = (self.angle, at.half);
        let wide = [sine * half_cosine + cosine * half_sine, cosine * half_cosine - sine * half_sine];
        let [along, across] = at.away;
        // The nearer the eye is to the sphere, the less precise is the half-angle's cosine: beside it nothing is sure.
        let margin = Vec4::splat(ANGLE_MARGIN);
        let beyond = Vec4::select(half_cosine.cmpgt(Vec4::splat(LEAST_COSINE)), at.gap - at.margin, UNSURE);
        let outside = at.gap.cmpgt(Vec4::ZERO);
        let inside = Sure { yes: -at.gap - at.margin, no: UNSURE };
        let any = sine.cmpgt(Vec4::splat(1.5));
        let faces = |away: Vec4| {
            let turned = wide[0] * across - wide[1] * away;
            let beside = wide[1] * across + wide[0] * away;
            let free = Vec4::select(beside.cmplt(-margin), Vec4::ONE, turned.abs() - margin);
            // Not above 0 where the distance is not sure.
            let moved = beyond * free.max(Vec4::ZERO).min(Vec4::ONE);
            let yes = turned.cmpgt(margin) | wide[1].cmplt(-margin);
            let no = turned.cmplt(-margin) & wide[1].cmpgt(margin);
            let seen = Sure { yes: Vec4::select(yes, moved, UNSURE), no: Vec4::select(no, moved, UNSURE) };
            Sure::select(any, Sure::ALWAYS, Sure::select(outside, seen, inside))
        };
        [faces(along), if BACK { faces(-along) } else { Sure::ALWAYS }]
    }

    #[inline]
    fn compare<B: LaneBounds, const TURNS: bool, const SILHOUETTES: bool>(&self, view: &LaneView) -> Results {
        let at = self.places(view);
        let sizes = self.sizes::<B>(&at);
        let (mut size, mut size_turned) = self.too_large::<B, TURNS>(&at, &sizes, view.reach);
        let [mut front, back] = self.facing::<SILHOUETTES>(&at);
        if SILHOUETTES {
            let (finer, finer_turned) = self.too_large::<B, TURNS>(&at, &sizes, view.silhouette_reach);
            let edge = front.and(back);
            let silhouette = finer.and(edge);
            if TURNS {
                let yes_turned = Vec4::select(size.yes.cmpgt(silhouette.yes), size_turned, finer_turned);
                // A no holds while the error is small enough for the interior, and for silhouettes or where there are none.
                let no_turned =
                    Vec4::select(edge.no.cmpgt(finer.no), size_turned, size_turned.min(finer_turned));
                let yes = size.yes.max(silhouette.yes).cmpgt(Vec4::ZERO);
                size_turned = Vec4::select(yes, yes_turned, no_turned);
            }
            size = size.or(silhouette);
        }
        if !view.back_faces {
            front = Sure::ALWAYS;
        }
        let shown = size.and(front);

        let mut inside = ALL;
        for plane in &view.planes[..view.plane_count] {
            let [x, y, z, w] = plane.to_array();
            inside = inside.min(at.to[0] * x + at.to[1] * y + at.to[2] * z + Vec4::splat(w));
        }
        inside += at.radius;
        let framed = Sure { yes: inside - at.margin, no: -inside - at.margin };
        let slack = framed.yes.max(framed.no);
        let turned = slack / (at.distance + slack) * (1.0 - MARGIN);
        let framed_turned = Vec4::select(slack.cmplt(ALL), turned, ALL);

        let refine = shown.yes.min(framed.yes).cmpgt(Vec4::ZERO);
        let hidden = shown.no.cmpgt(Vec4::ZERO);
        let hidden_turned = Vec4::select(front.no.cmpge(size.no), ALL, size_turned);
        let no = Vec4::select(hidden, shown.no, framed.no);
        let no_turned = Vec4::select(hidden, hidden_turned, framed_turned);
        let moved = Vec4::select(refine, shown.yes.min(framed.yes), no);
        // Numbers too large for single precision, and what is no number, are not sure.
        let sound = (at.margin + (self.along + self.across) * (WIDEST * view.silhouette_reach)).cmplt(ALL);
        Results {
            refine,
            moved: Vec4::select(sound, moved, UNSURE),
            turned: Vec4::select(refine, size_turned.min(framed_turned), no_turned),
        }
    }
}
