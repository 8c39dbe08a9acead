//! A view in the space of an object. All tests are done there: the eye is transformed, not the object.

use glam::{DMat4, DVec3, DVec4};

use super::bounds::Bounds;
use super::camera::{ErrorKind, Eye, View, ViewError};
use super::criteria::{Answer, Criterion, Factors, Motion, one_by_one, within_band};
use super::deviation::DeviationBounds;
use super::lanes::{LaneBounds, LaneView};
use super::matrix::{columns, scales};
use super::region::angle_between;
use super::seen::{Extent, Facing, Place, SeenBounds};

/// Distance assumed by a budget for refinements containing the eye or in focus: they come before all others, ordered by
/// error. Object units. Any length far below all measured lengths does.
const NEAREST: f64 = 1e-30;
/// Smallest tolerance, pixels: far below any error except 0.
const LEAST_TOLERANCE: f64 = 1e-30;
/// Urgency of refinements needed without an error.
const BARELY: f64 = 1.0 + 1e-6;

/// A [`View`] as seen from an object: everything in object units.
///
/// ```
/// use multires::view::{View, look_at};
///
/// let view = View::perspective(look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]), 1.0, [1920, 1080])?;
/// let twice = [[2.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// let object = view.of_object(twice)?;
/// assert_eq!(object.eye(), Some([0.0, 0.0, 2.5])); // in the object's own units
/// assert!(object.error_at(1.0) < object.error_at(2.0)); // farther away, more error is allowed
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectView {
    pub(super) eye: Eye,
    pub(super) planes: [DVec4; 5],
    pub(super) plane_count: usize,
    /// `error * reach` is the distance up to which an error is too large. For an orthographic view, `error * reach` is
    /// the error in multiples of the tolerance. `reach` holds in the interior, `silhouette_reach` on silhouettes.
    pub(super) reach: f64,
    pub(super) silhouette_reach: f64,
    pub(super) error: ErrorKind,
    pub(super) frustum: bool,
    pub(super) back_faces: bool,
    /// Centre and radius of the ball.
    pub(super) focus: Option<(DVec3, f64)>,
}

impl View {
    /// Returns this view as seen from an object with the identity as matrix from object to world.
    pub fn of_world(&self) -> ObjectView {
        self.seen_from(&DMat4::IDENTITY, [1.0; 2])
    }

    /// Returns this view as seen from an object with the given affine matrix from object to world. If the matrix shears
    /// or scales directions differently, errors use the greatest scale and distances the least scale. Then nothing is
    /// coarser than asked for, and more triangles than needed are drawn, by the ratio of both scales.
    ///
    /// # Errors
    /// The matrix is not finite, is no affine map, or flattens the object.
    pub fn of_object(&self, object_to_world: [[f32; 4]; 4]) -> Result<ObjectView, ViewError> {
        let matrix = columns(object_to_world).ok_or(ViewError::NotFinite { which: "object" })?;
        let scales = scales(&matrix).ok_or(ViewError::NotAffine { which: "object" })?;
        if scales[0] <= 0.0 {
            return Err(ViewError::Singular { which: "object" });
        }
        Ok(self.seen_from(&matrix, scales))
    }

    fn seen_from(&self, to_world: &DMat4, [least, greatest]: [f64; 2]) -> ObjectView {
        let to_object = to_world.inverse();
        let (eye, pixels) = match self.eye {
            Eye::At { eye, forward, pixels } => {
                let eye = to_object.transform_point3(eye);
                let pixels = pixels * (greatest / least);
                (Eye::At { eye, forward: to_object.transform_vector3(forward).normalize(), pixels }, pixels)
            }
            Eye::Along { forward, pixels } => {
                let pixels = pixels * greatest;
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
                (to_object.transform_point3(centre), f64::from(ball.radius) / least)
            }),
        }
    }
}

/// Largest ratio of reaches between which an error that looks different from elsewhere is compared.
const WIDEST: f64 = 7.0;
/// Shrinks a difference by more than its rounding error.
const SURE: f64 = 4.0 * f64::EPSILON;

/// Returns a lower bound for `|ln(a / b)|`, and for `1 - a / b` where a is less than b. At most 1.
#[inline]
fn apart(a: f64, b: f64) -> f64 {
    let (less, more) = if a < b { (a, b) } else { (b, a) };
    (1.0 - less / more - SURE).max(0.0)
}

/// If a no because of the error holds for this share of the distance, no other no with a longer slack is searched for.
const LONG: f64 = 0.125;

impl ObjectView {
    /// Returns this view with tolerances multiplied by `factor`, as a budget coarsens a view.
    #[must_use]
    pub fn coarsened(&self, factor: f64) -> Self {
        Self { reach: self.reach / factor, silhouette_reach: self.silhouette_reach / factor, ..self.clone() }
    }

    /// Returns the largest tolerable error at a distance from the eye, object units: the value for a level of detail
    /// chosen by hand ([`Level::Error`](crate::lod::Level::Error)). An orthographic view has equal errors at all
    /// distances.
    ///
    /// ```
    /// use multires::view::{View, look_at};
    ///
    /// // 90 degrees over 1000 pixels: at 5 units 10 units are seen, so one pixel is a hundredth.
    /// let matrix = look_at([0.0, 0.0, 5.0], [0.0; 3], [0.0, 1.0, 0.0]);
    /// let view = View::perspective(matrix, 90_f32.to_radians(), [1000, 1000])?.with_tolerance_px(1.0);
    /// assert!((view.of_world().error_at(5.0) - 0.01).abs() < 1e-6);
    /// # Ok::<(), multires::view::ViewError>(())
    /// ```
    pub fn error_at(&self, distance: f64) -> f64 {
        match self.eye {
            Eye::At { .. } => distance.max(0.0) / self.reach,
            Eye::Along { .. } => 1.0 / self.reach,
        }
    }

    /// Whether the view has a focus.
    pub(crate) fn has_focus(&self) -> bool {
        self.focus.is_some()
    }

    /// Returns the eye in object units; `None` for an orthographic view.
    pub fn eye(&self) -> Option<[f64; 3]> {
        match self.eye {
            Eye::At { eye, .. } => Some(eye.to_array()),
            Eye::Along { .. } => None,
        }
    }

    #[inline]
    fn place(&self, bounds: &impl SeenBounds) -> Place {
        match self.eye {
            Eye::At { eye, .. } => {
                let to = bounds.centre() - eye;
                let square = to.length_squared();
                let distance = square.sqrt();
                Place { to, distance, square, gap: distance - bounds.reach() }
            }
            Eye::Along { forward, .. } => {
                Place { to: forward, distance: f64::INFINITY, square: 1.0, gap: f64::INFINITY }
            }
        }
    }

    /// Whether the sphere intersects the frustum.
    #[inline]
    fn in_frustum(&self, bounds: &impl SeenBounds, place: &Place) -> Answer {
        if !self.frustum {
            return Answer::ALWAYS;
        }
        let centre = bounds.centre().extend(1.0);
        let mut inside = f64::INFINITY;
        for plane in &self.planes[..self.plane_count] {
            let distance = plane.dot(centre);
            inside = if distance < inside { distance } else { inside };
        }
        inside += bounds.reach();
        // The distance from a plane changes by at most the distance moved by the eye. The planes turn about the eye,
        // which is at most as far as it may have moved away. An orthographic view which turns is another view.
        let slack = inside.abs();
        let turned = match self.eye {
            Eye::At { .. } => slack / (place.distance + slack),
            Eye::Along { .. } => f64::INFINITY,
        };
        Answer { refine: inside >= 0.0, moved: slack, turned }
    }

    /// Compares a cone of normals with the directions to its sphere; `None` if the cone contains all directions.
    #[inline]
    fn facing(&self, bounds: &impl SeenBounds, place: &Place) -> Option<Facing> {
        let (axis, [sine, cosine]) = bounds.facing()?;
        if place.gap <= 0.0 {
            return Some(Facing { wide: [1.0, -1.0], away: [0.0, 1.0], gap: place.gap });
        }
        let [half_sine, half_cosine] = place.half(bounds.reach());
        let wide = [sine * half_cosine + cosine * half_sine, cosine * half_cosine - sine * half_sine];
        let away = axis.dot(place.to) / (axis.length_squared() * place.square).sqrt();
        let away = away.clamp(-1.0, 1.0);
        Some(Facing { wide, away: [away, ((1.0 - away) * (1.0 + away)).sqrt()], gap: place.gap })
    }

    /// Whether an error is too large at the nearest point of the sphere. `TURNS`: changes of the tolerances' factor count as
    /// turning, as in [`Criterion::test_turning`].
    #[inline]
    fn too_large<const TURNS: bool>(&self, error: &Extent, reach: f64, place: &Place) -> Answer {
        if error.largest <= 0.0 {
            return Answer::NEVER;
        }
        let far = error.size * reach;
        match self.eye {
            Eye::At { .. } => {
                let near = place.gap.max(NEAREST);
                let refine = near < far;
                let (turned, reach) = match TURNS {
                    false => (f64::INFINITY, reach),
                    true if error.slope <= 0.0 => (apart(near, far), reach),
                    true => {
                        // Half-way to the factor at which the answer changes: what holds there holds on all of the way.
                        let between = 0.5 * (reach + (near / error.size).min(WIDEST * reach));
                        (apart(between, reach), between)
                    }
                };
                Answer { refine, moved: error.slack(reach, place.gap, refine), turned }
            }
            Eye::Along { .. } => {
                let turned = if TURNS { apart(far, 1.0) } else { f64::INFINITY };
                Answer { refine: far > 1.0, moved: f64::INFINITY, turned }
            }
        }
    }

    fn in_focus(&self, bounds: &impl SeenBounds) -> Answer {
        let Some((centre, radius)) = self.focus else { return Answer::NEVER };
        let gap = centre.distance(bounds.centre()) - bounds.reach() - radius;
        Answer { refine: gap < 0.0, moved: gap.abs(), turned: f64::INFINITY }
    }
}

impl ObjectView {
    /// Whether a refinement is needed with tolerances multiplied by `scale`, and for a budget by `factor`.
    #[inline]
    fn answer<const TURNS: bool>(&self, bounds: &impl SeenBounds, scale: f64, factor: f64) -> Answer {
        let place = self.place(bounds);
        let error = bounds.extent(self.error, &place);
        let both_factors = scale * factor;
        let mut answer = self.too_large::<TURNS>(&error, self.reach / both_factors, &place);
        let mut facing = None;
        if !answer.refine && self.silhouette_reach > self.reach {
            facing = self.facing(bounds, &place);
            let both = facing.as_ref().map_or(Answer::ALWAYS, |facing| facing.front().and(facing.back()));
            let silhouette = self.too_large::<TURNS>(&error, self.silhouette_reach / both_factors, &place);
            answer = answer.or(silhouette.and(both));
        }
        if self.focus.is_some()
            && (factor <= 1.0 || error.largest * self.silhouette_reach > NEAREST * both_factors)
        {
            answer = answer.or(self.in_focus(bounds));
        }
        if !answer.refine && answer.moved > LONG * place.gap {
            return answer;
        }
        if self.back_faces {
            let facing = facing.or_else(|| self.facing(bounds, &place));
            if let Some(facing) = facing {
                answer = answer.and(facing.front());
            }
        }
        // Turning wakes only refinements decided by the frustum.
        if !answer.refine && answer.moved > 0.0 {
            return answer;
        }
        answer.and(self.in_frustum(bounds, &place))
    }

    /// Returns the urgency: the further factor of tolerances, already multiplied by `scale`, at which the need ends.
    fn urgency_of(&self, bounds: &impl SeenBounds, scale: f64) -> f64 {
        let place = self.place(bounds);
        let facing = self.facing(bounds, &place);
        let front = facing.as_ref().is_none_or(|facing| facing.front().refine);
        if self.back_faces && !front || !self.in_frustum(bounds, &place).refine {
            return 0.0;
        }
        let silhouette = front && facing.as_ref().is_none_or(|facing| facing.back().refine);
        let reach = if silhouette { self.silhouette_reach } else { self.reach } / scale;
        let error = bounds.extent(self.error, &place);
        let size = error.size.max(0.0);
        let urgency = match self.eye {
            Eye::At { .. } => size * reach / place.gap.max(NEAREST),
            Eye::Along { .. } => size * reach,
        };
        if self.in_focus(bounds).refine {
            urgency.max(error.largest.max(0.0) * self.silhouette_reach / scale / NEAREST).max(BARELY)
        } else {
            urgency
        }
    }

    /// Whether a refinement is needed, as [`Criterion::test_turning`] says.
    fn answer_turning(&self, bounds: &impl SeenBounds, scale: f64, factor: f64) -> Answer {
        if self.focus.is_some() && factor > 1.0 {
            // What a focus keeps from a budget depends on both factors.
            return within_band(scale, |scale| self.answer::<false>(bounds, scale, factor));
        }
        self.answer::<true>(bounds, scale, factor)
    }

    /// Answers for many bounds, as [`Criterion::test_each`] says.
    fn answer_each<B: SeenBounds + LaneBounds>(&self, bounds: &[B], factors: Factors, answers: &mut [Answer])
    where
        Self: Criterion<B>,
    {
        let Factors { turning, budget } = factors;
        let lanes = match self.focus {
            None => LaneView::new(self, turning.unwrap_or(1.0) * budget),
            Some(_) => None,
        };
        let Some(lanes) = lanes else { return one_by_one(self, bounds, factors, answers) };
        match turning {
            None => lanes.test::<_, false>(bounds, answers, |b| self.answer::<false>(b, 1.0, budget)),
            Some(scale) => lanes.test::<_, true>(bounds, answers, |b| self.answer::<true>(b, scale, budget)),
        }
    }

    fn may_see(&self, bounds: &impl SeenBounds) -> bool {
        let place = self.place(bounds);
        let front = || self.facing(bounds, &place).is_none_or(|facing| facing.front().refine);
        self.in_frustum(bounds, &place).refine && (!self.back_faces || front())
    }

    /// Returns the motion since `before`: [`Criterion::motion`] for all kinds of bounds.
    pub fn motion(&self, before: &Self) -> Motion {
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

impl Criterion for ObjectView {
    fn test(&self, bounds: &Bounds) -> Answer {
        self.answer::<false>(bounds, 1.0, 1.0)
    }

    fn test_at(&self, bounds: &Bounds, factor: f64) -> Answer {
        self.answer::<false>(bounds, 1.0, factor)
    }

    fn test_scaled(&self, bounds: &Bounds, scale: f64, factor: f64) -> Answer {
        self.answer::<false>(bounds, scale, factor)
    }

    fn test_turning(&self, bounds: &Bounds, scale: f64, factor: f64) -> Answer {
        self.answer_turning(bounds, scale, factor)
    }

    fn test_each(&self, bounds: &[Bounds], factors: Factors, answers: &mut [Answer]) {
        self.answer_each(bounds, factors, answers);
    }

    fn urgency(&self, bounds: &Bounds) -> f64 {
        self.urgency_of(bounds, 1.0)
    }

    fn urgency_scaled(&self, bounds: &Bounds, scale: f64) -> f64 {
        self.urgency_of(bounds, scale)
    }

    fn sees(&self, bounds: &Bounds) -> bool {
        self.may_see(bounds)
    }

    fn motion(&self, before: &Self) -> Motion {
        self.motion(before)
    }
}

/// Uses the apparent size of the errors. The view's [`ErrorKind`] has no effect, because shapes bound displacements in
/// all directions.
impl Criterion<DeviationBounds> for ObjectView {
    fn test(&self, bounds: &DeviationBounds) -> Answer {
        self.answer::<false>(bounds, 1.0, 1.0)
    }

    fn test_at(&self, bounds: &DeviationBounds, factor: f64) -> Answer {
        self.answer::<false>(bounds, 1.0, factor)
    }

    fn test_scaled(&self, bounds: &DeviationBounds, scale: f64, factor: f64) -> Answer {
        self.answer::<false>(bounds, scale, factor)
    }

    fn test_turning(&self, bounds: &DeviationBounds, scale: f64, factor: f64) -> Answer {
        self.answer_turning(bounds, scale, factor)
    }

    fn test_each(&self, bounds: &[DeviationBounds], factors: Factors, answers: &mut [Answer]) {
        self.answer_each(bounds, factors, answers);
    }

    fn urgency(&self, bounds: &DeviationBounds) -> f64 {
        self.urgency_of(bounds, 1.0)
    }

    fn urgency_scaled(&self, bounds: &DeviationBounds, scale: f64) -> f64 {
        self.urgency_of(bounds, scale)
    }

    fn sees(&self, bounds: &DeviationBounds) -> bool {
        self.may_see(bounds)
    }

    fn motion(&self, before: &Self) -> Motion {
        self.motion(before)
    }
}
