//! A view in the space of one object, where all tests are done: an object is not transformed, the eye is.

use glam::{DMat4, DVec3, DVec4};

use super::bounds::{Bounds, angle_between};
use super::camera::{ErrorKind, Eye, View, ViewError};
use super::criteria::{Answer, Criterion, Motion};
use super::matrix::{columns, uniform_scale};

/// Distance at which a budget takes those that the eye is in, or that are in focus, to be: before all others, by their error.
/// Object units; any length far below all that is measured does.
const NEAREST: f64 = 1e-30;
/// Least tolerance that tolerances are multiples of, pixels: far below any error that is not 0.
const LEAST_TOLERANCE: f64 = 1e-30;
/// Urgency of what is needed for no error.
const BARELY: f64 = 1.0 + 1e-6;

/// A [`View`] as seen from an object: everything in object units.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectView {
    eye: Eye,
    planes: [DVec4; 5],
    plane_count: usize,
    /// By how much an error must be multiplied for the distance up to which it is too large (for an orthographic view:
    /// for its multiple of the tolerance), in the interior and on silhouettes.
    reach: f64,
    silhouette_reach: f64,
    error: ErrorKind,
    frustum: bool,
    back_faces: bool,
    /// Centre and radius.
    focus: Option<(DVec3, f64)>,
}

impl View {
    /// This view as seen from an object that lies in the world as it is.
    pub fn of_world(&self) -> ObjectView {
        self.seen_from(&DMat4::IDENTITY, 1.0)
    }

    /// This view as seen from an object with the given matrix from object to world: a rotation or reflection, a
    /// translation, and a scale that is the same in all directions.
    ///
    /// # Errors
    /// The matrix is not finite, or not of that kind.
    pub fn of_object(&self, object_to_world: [[f32; 4]; 4]) -> Result<ObjectView, ViewError> {
        let matrix = columns(object_to_world).ok_or(ViewError::NotFinite { which: "object" })?;
        let scale = uniform_scale(&matrix).ok_or(ViewError::NotUniform { which: "object" })?;
        Ok(self.seen_from(&matrix, scale))
    }

    fn seen_from(&self, to_world: &DMat4, scale: f64) -> ObjectView {
        let to_object = to_world.inverse();
        let (eye, pixels) = match self.eye {
            Eye::At { eye, forward, pixels } => {
                let eye = to_object.transform_point3(eye);
                (Eye::At { eye, forward: to_object.transform_vector3(forward).normalize(), pixels }, pixels)
            }
            Eye::Along { forward, pixels } => {
                let pixels = pixels * scale;
                (Eye::Along { forward: to_object.transform_vector3(forward).normalize(), pixels }, pixels)
            }
        };
        let across = to_world.transpose();
        let mut planes = self.planes.map(|plane| across * plane);
        for plane in &mut planes[..self.plane_count] {
            *plane /= plane.truncate().length();
        }
        let finest = self.tolerance.min(self.silhouette);
        ObjectView {
            eye,
            planes,
            plane_count: self.plane_count,
            reach: pixels / self.tolerance.max(LEAST_TOLERANCE),
            silhouette_reach: pixels / finest.max(LEAST_TOLERANCE),
            error: self.error,
            frustum: self.frustum,
            back_faces: self.back_faces,
            focus: self.focus.map(|ball| {
                let centre = DVec3::from_array(ball.centre.map(f64::from));
                (to_object.transform_point3(centre), f64::from(ball.radius) / scale)
            }),
        }
    }
}

/// Where a sphere is, as all tests see it.
struct Place {
    /// From the eye to its centre, unit length; ahead where the eye is at the centre.
    towards: DVec3,
    distance: f64,
    /// To the nearest point of the sphere; negative inside it.
    gap: f64,
    /// Sine and cosine of half the angle under which the sphere is seen.
    half: [f64; 2],
}

impl ObjectView {
    /// The same with tolerances multiplied by a factor: how a budget coarsens what a view asks for.
    #[must_use]
    pub fn coarsened(&self, factor: f64) -> Self {
        Self { reach: self.reach / factor, silhouette_reach: self.silhouette_reach / factor, ..self.clone() }
    }

    /// The eye in object units; `None` for an orthographic view.
    pub fn eye(&self) -> Option<[f64; 3]> {
        match self.eye {
            Eye::At { eye, .. } => Some(eye.to_array()),
            Eye::Along { .. } => None,
        }
    }

    fn place(&self, bounds: &Bounds) -> Place {
        let centre = DVec3::from_array(bounds.centre.map(f64::from));
        let radius = bounds.reach();
        match self.eye {
            Eye::At { eye, forward, .. } => {
                let to = centre - eye;
                let distance = to.length();
                let gap = distance - radius;
                let sine = if gap > 0.0 { radius / distance } else { 1.0 };
                Place {
                    towards: if distance > 0.0 { to / distance } else { forward },
                    distance,
                    gap,
                    half: [sine, ((1.0 - sine) * (1.0 + sine)).sqrt()],
                }
            }
            Eye::Along { forward, .. } => {
                Place { towards: forward, distance: f64::INFINITY, gap: f64::INFINITY, half: [0.0, 1.0] }
            }
        }
    }

    /// Whether the sphere reaches into the frustum.
    fn in_frustum(&self, bounds: &Bounds, place: &Place) -> Answer {
        if !self.frustum {
            return Answer::ALWAYS;
        }
        let centre = DVec3::from_array(bounds.centre.map(f64::from)).extend(1.0);
        let inside = self.planes[..self.plane_count].iter().map(|plane| plane.dot(centre));
        let inside = inside.fold(f64::INFINITY, f64::min) + bounds.reach();
        // The distance from a plane changes by no more than the eye moves, and the planes turn about the eye. Half of
        // the slack for each. An orthographic view that turns is another view.
        let half = 0.5 * inside.abs();
        match self.eye {
            Eye::At { .. } => {
                Answer { refine: inside >= 0.0, moved: half, turned: half / (place.distance + half) }
            }
            Eye::Along { .. } => Answer { refine: inside >= 0.0, moved: 2.0 * half, turned: f64::INFINITY },
        }
    }

    /// Where the cone of normals stands to the directions in which the sphere is seen: `facing` is how far (as the sine of
    /// an angle) from turning wholly away, `silhouette` how far from having no normal at a right angle to the eye.
    fn facing(&self, bounds: &Bounds, place: &Place) -> (Answer, Answer) {
        let Some((axis, angle)) = bounds.unpacked() else { return (Answer::ALWAYS, Answer::ALWAYS) };
        if place.gap <= 0.0 {
            let inside = Answer { refine: true, moved: -place.gap, turned: f64::INFINITY };
            return (inside, inside);
        }
        let (sine, cosine) = angle.sin_cos();
        // Angle of the cone plus half the angle of the sphere: from here on `wide`.
        let [half_sine, half_cosine] = place.half;
        let (wide_sine, wide_cosine) =
            (sine * half_cosine + cosine * half_sine, cosine * half_cosine - sine * half_sine);
        // Angle by which the axis points away from the eye beyond a right angle to the line of sight.
        let away = axis.dot(place.towards).clamp(-1.0, 1.0);
        let away_cosine = ((1.0 - away) * (1.0 + away)).sqrt();
        // All directions to points of the sphere turn by at most asin(moved / gap), and so does their angle to any normal.
        let within = |sine: f64, cosine: f64| {
            let allowed = if cosine < 0.0 { 1.0 } else { sine.abs().min(1.0) };
            if place.gap.is_finite() { place.gap * allowed } else { f64::INFINITY }
        };
        let compare = |away: f64| {
            // Sine and cosine of `wide - away`.
            let (sine, cosine) =
                (wide_sine * away_cosine - wide_cosine * away, wide_cosine * away_cosine + wide_sine * away);
            Answer {
                refine: sine >= 0.0 || wide_cosine <= 0.0,
                moved: within(sine, cosine),
                turned: f64::INFINITY,
            }
        };
        let front = compare(away);
        let back = compare(-away);
        let silhouette = Answer {
            refine: front.refine && back.refine,
            moved: if front.refine == back.refine {
                front.moved.min(back.moved)
            } else if front.refine {
                back.moved
            } else {
                front.moved
            },
            turned: f64::INFINITY,
        };
        (front, silhouette)
    }

    /// Whether an error is too large at the nearest point of the sphere.
    fn too_large(&self, error: f64, reach: f64, place: &Place) -> Answer {
        if error <= 0.0 {
            return Answer::NEVER;
        }
        let far = error * reach;
        match self.eye {
            Eye::At { .. } => Answer {
                refine: place.gap.max(NEAREST) < far,
                moved: (place.gap - far).abs(),
                turned: f64::INFINITY,
            },
            Eye::Along { .. } => Answer { refine: far > 1.0, ..Answer::ALWAYS },
        }
    }

    fn in_focus(&self, bounds: &Bounds) -> Answer {
        let Some((centre, radius)) = self.focus else { return Answer::NEVER };
        let gap = centre.distance(DVec3::from_array(bounds.centre.map(f64::from))) - bounds.reach() - radius;
        Answer { refine: gap < 0.0, moved: gap.abs(), turned: f64::INFINITY }
    }
}

impl ObjectView {
    fn error_of(&self, bounds: &Bounds) -> f64 {
        f64::from(match self.error {
            ErrorKind::Geometric => bounds.error,
            ErrorKind::Parametric => bounds.parametric,
        })
    }

    /// Whether a refinement is needed with tolerances multiplied by a factor.
    #[inline]
    fn answer(&self, bounds: &Bounds, factor: f64) -> Answer {
        let place = self.place(bounds);
        let error = self.error_of(bounds);
        let mut large = self.too_large(error, self.reach / factor, &place);
        let facing =
            (self.back_faces || self.silhouette_reach > self.reach).then(|| self.facing(bounds, &place));
        if let Some((_, silhouette)) = facing {
            if !large.refine && self.silhouette_reach > self.reach {
                let reach = self.silhouette_reach / factor;
                large = large.or(self.too_large(error, reach, &place).and(silhouette));
            }
        }
        if factor <= 1.0 || error * self.silhouette_reach > NEAREST * factor {
            large = large.or(self.in_focus(bounds));
        }
        if let (Some((front, _)), true) = (facing, self.back_faces) {
            large = large.and(front);
        }
        // Turning wakes only what the frustum decides.
        if !large.refine && large.moved > 0.0 {
            return large;
        }
        large.and(self.in_frustum(bounds, &place))
    }
}

impl Criterion for ObjectView {
    fn needs(&self, bounds: &Bounds) -> Answer {
        self.answer(bounds, 1.0)
    }

    fn needs_at(&self, bounds: &Bounds, factor: f64) -> Answer {
        self.answer(bounds, factor)
    }

    fn urgency(&self, bounds: &Bounds) -> f64 {
        let place = self.place(bounds);
        let (front, silhouette) = self.facing(bounds, &place);
        if self.back_faces && !front.refine || !self.in_frustum(bounds, &place).refine {
            return 0.0;
        }
        let reach = if silhouette.refine { self.silhouette_reach } else { self.reach };
        let error = self.error_of(bounds).max(0.0);
        let urgency = match self.eye {
            Eye::At { .. } => error * reach / place.gap.max(NEAREST),
            Eye::Along { .. } => error * reach,
        };
        if self.in_focus(bounds).refine {
            urgency.max(error * self.silhouette_reach / NEAREST).max(BARELY)
        } else {
            urgency
        }
    }

    fn sees(&self, bounds: &Bounds) -> bool {
        let place = self.place(bounds);
        self.in_frustum(bounds, &place).refine && (!self.back_faces || self.facing(bounds, &place).0.refine)
    }

    fn motion(&self, before: &Self) -> Motion {
        let same = self.reach == before.reach
            && self.silhouette_reach == before.silhouette_reach
            && self.error == before.error
            && self.frustum == before.frustum
            && self.back_faces == before.back_faces
            && self.plane_count == before.plane_count;
        let focus = match (self.focus, before.focus) {
            (None, None) => 0.0,
            (Some((a, r)), Some((b, s))) => a.distance(b) + (r - s).abs(),
            _ => return Motion::Other,
        };
        let planes = || self.planes[..self.plane_count].iter().zip(&before.planes[..before.plane_count]);
        match (self.eye, before.eye) {
            (Eye::At { eye, pixels, .. }, Eye::At { eye: eye_before, pixels: pixels_before, .. })
                if same && pixels == pixels_before =>
            {
                let turned = planes().map(|(a, b)| angle_between(a.truncate(), b.truncate()));
                Motion::Moved {
                    distance: eye.distance(eye_before).max(focus),
                    angle: turned.fold(0.0, f64::max),
                }
            }
            (
                Eye::Along { forward, pixels },
                Eye::Along { forward: forward_before, pixels: pixels_before },
            ) if same
                && pixels == pixels_before
                && forward == forward_before
                && planes().all(|(a, b)| a.truncate() == b.truncate()) =>
            {
                let distance = planes().map(|(a, b)| (a.w - b.w).abs()).fold(focus, f64::max);
                Motion::Moved { distance, angle: 0.0 }
            }
            _ => Motion::Other,
        }
    }
}
