//! Volume, boundary and shape objectives, without memory (Lindstrom and Turk 1998).
//!
//! ```text
//! the position solves, in this order, whatever is compatible with what came before (1 degree):
//!   volume preservation     sum of the signed volumes swept = 0
//!   boundary preservation   the signed areas swept by the border sum to the shortest vector
//!   optimisation            1/2 f_V + 1/2 L^2 f_B least; f_V the squared volumes, f_B the squared areas that rims sweep
//!                           (borders, borders between materials, creases, seams), L the length
//!   triangle shape          the squared lengths of the new edges least: only where all above leave a choice (planes)
//! cost = 1/2 f_V + 1/2 L^2 f_B
//! ```
//!
//! All volumes come from the sums of `stars.rs`. Borders and feature edges are rare and are visited one by one.

use glam::{DVec3, Vec3};

use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::curves::Rim;

use super::region::{at, finite, for_border_edges, for_region, for_rims};
use super::solve::{Constraints, Symmetric, minimise_on_plane};
use super::stars::{StarSums, Sum, Weight};
use super::{AttributeQuadric, ErrorMetric, Loss, MetricEvent, MetricProperties, Optimum, Pair};

/// Weight of the areas swept by creases and seams. The volumes on either side hold creases already: by trial on a
/// machined part the mean distance grows by a third with 1, and the largest distance by a third with 0. Without a weight
/// a seam slides over flat faces between colours constant on both sides.
const INNER: f64 = 0.1;
/// 1/2 of the squared volume (a sixth of the triple product, squared).
const VOLUME: f64 = 0.5 / 36.0;
/// 1/2 of the squared area (half of the vector product, squared).
const BOUNDARY: f64 = 0.5 / 4.0;
/// Scale of the costs, which are squared volumes: 2^60 keeps them clear of single-precision underflow on any mesh.
const SCALE: f64 = (1u64 << 60) as f64 * VOLUME;

/// The metric of Lindstrom and Turk. Made for [`Placement::Optimal`](crate::simplify::Placement::Optimal), which
/// preserves the volume of closed meshes.
///
/// ```
/// use multires::simplify::metric::LindstromTurk;
/// use multires::{Placement, Simplifier, Target, mesh::shapes};
///
/// let mesh = shapes::icosphere(3);
/// let simplifier = Simplifier::new().metric(LindstromTurk::new()).placement(Placement::Optimal);
/// let sequence = { simplifier }.target(Target::Ratio(0.1)).run(&mesh)?;
/// let level = sequence.extract(&mesh, sequence.len());
/// let ratio = level.volume().zip(mesh.volume()).map(|(after, before)| after / before);
/// assert!(ratio.is_some_and(|ratio| (ratio - 1.0).abs() < 0.01)); // keeps the volume
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LindstromTurk {
    stars: StarSums,
}

impl Default for LindstromTurk {
    fn default() -> Self {
        Self { stars: StarSums::new(Weight::Volume, 0.0) }
    }
}

impl LindstromTurk {
    /// Creates the metric, with the paper's weights (1/2 and 1/2).
    pub fn new() -> Self {
        Self::default()
    }

    /// Root mean square of twice the area of the triangles around the two points.
    fn double_area(&self, surface: &WorkingSurface, pair: Pair) -> f64 {
        let count = surface.valence(pair.lost) + surface.valence(pair.kept);
        let squares = self.stars.squares(pair.lost) + self.stars.squares(pair.kept);
        (squares / count.max(1) as f64).sqrt()
    }

    /// Sums the volumes and rims of a candidate with a point on a curve, relative to the lost point.
    #[cold]
    fn at_rim(&self, surface: &WorkingSurface, pair: Pair) -> (Sum, Border) {
        let mut sum = self.stars.region(surface, pair);
        let border = Border::new(surface, pair);
        let length2 = (at(surface, pair.kept) - at(surface, pair.lost)).length_squared();
        let weight = BOUNDARY / VOLUME * length2;
        sum.h.add(&border.h.scaled(weight));
        sum.c += weight * border.c;
        sum.constant += weight * border.constant;
        (sum, border)
    }
}

#[inline]
fn is_at_rim(surface: &WorkingSurface, pair: Pair) -> bool {
    surface.is_on_curve(pair.lost) | surface.is_on_curve(pair.kept)
}

/// The areas swept by borders and rims, relative to the lost point: the edge from p to q sweeps `(s - x * e) / 2` with
/// `e = q - p` and `s = p * q`, where * is the vector product.
#[derive(Debug, Clone, Copy, Default)]
struct Border {
    e: DVec3,
    s: DVec3,
    h: Symmetric,
    c: DVec3,
    constant: f64,
}

impl Border {
    #[cold]
    fn new(surface: &WorkingSurface, pair: Pair) -> Self {
        let mut border = Self::default();
        let origin = at(surface, pair.lost);
        for_border_edges(surface, pair, |p, q| {
            let (p, q) = (p - origin, q - origin);
            let (e, s) = (q - p, p.cross(q));
            border.e += e;
            border.s += s;
        });
        for_rims(surface, pair, |p, q, rim| {
            let weight = if rim == Rim::Edge { 1.0 } else { INNER };
            let (p, q) = (p - origin, q - origin);
            let (e, s) = (q - p, p.cross(q));
            // |s - x * e|^2 = x'(|e|^2 - ee')x - 2 (e * s).x + |s|^2
            border.h.add(&Symmetric::identity(weight * e.length_squared()));
            border.h.subtract_outer(weight.sqrt() * e);
            border.c += weight * e.cross(s);
            border.constant += weight * s.length_squared();
        });
        border
    }

    /// Adds two constraints: the point lies on the line along `e` on which the summed area vector is shortest.
    fn preserve(&self, constraints: &mut Constraints) {
        let toward = self.e.cross(self.s);
        constraints.add(toward, toward.length_squared() / self.e.length_squared().max(f64::MIN_POSITIVE));
        constraints.add(self.e.cross(toward), 0.0);
    }
}

impl ErrorMetric for LindstromTurk {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let x = Vec3::from(position).as_dvec3() - at(surface, pair.lost);
        let sum = if is_at_rim(surface, pair) {
            self.at_rim(surface, pair).0
        } else {
            self.stars.region(surface, pair)
        };
        finite(sum.at(x) * SCALE)
    }

    #[inline]
    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        let counts = attributes.area > 0.0;
        let rate = if counts { self.double_area(surface, pair) } else { 0.0 };
        if is_at_rim(surface, pair) {
            let (mut sum, border) = self.at_rim(surface, pair);
            attributes.add_to(&mut sum, rate);
            return place(surface, pair, &sum, Some(&border));
        }
        let mut sum = self.stars.region(surface, pair);
        if counts {
            attributes.add_to(&mut sum, rate);
        }
        match minimise_on_plane(&sum.h, sum.c, sum.normals, sum.offset) {
            Some(x) => Some(placed(surface, pair, &sum, x)),
            None => place(surface, pair, &sum, None),
        }
    }

    /// Attributes: a squared volume is a squared distance times the square of twice the area, whereas `off.sum` has twice
    /// the area. The exchange rate is twice the area of a triangle around the pair.
    ///
    /// A part: every triangle counts at each of its three corners, with its squared distance times the square of twice its
    /// area. The mean triangle area of the surface stands for the part's own: otherwise small parts of small triangles
    /// would cost next to nothing.
    fn cost_of(&self, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
        let (sum, double_area) = match loss {
            Loss::Attributes(off) => (f64::from(off.sum), self.double_area(surface, pair)),
            Loss::Part(loss) => (6.0 * f64::from(loss.integral), 2.0 * f64::from(loss.mean_area)),
            Loss::Deviation => return None,
        };
        Some(finite(sum * double_area * SCALE))
    }

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.stars.follow(surface, event);
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("lindstrom-turk")
    }
}

/// Solves for the position, adding the constraints in order.
#[cold]
fn place(surface: &WorkingSurface, pair: Pair, sum: &Sum, border: Option<&Border>) -> Option<Optimum> {
    let mut constraints = Constraints::default();
    constraints.add(sum.normals, sum.offset);
    if let Some(border) = border {
        border.preserve(&mut constraints);
    }
    constraints.minimise(&sum.h, sum.c);
    if !constraints.is_full() {
        let origin = at(surface, pair.lost);
        let (mut around, mut count) = (DVec3::ZERO, 0.0);
        for_region(surface, pair, |facet| {
            if facet.survives {
                around += facet.q + facet.r - 2.0 * origin;
                count += 2.0;
            }
        });
        constraints.minimise(&Symmetric::identity(count), around);
    }
    constraints.point().map(|x| placed(surface, pair, sum, x))
}

#[inline]
fn placed(surface: &WorkingSurface, pair: Pair, sum: &Sum, x: DVec3) -> Optimum {
    Optimum::of_both((at(surface, pair.lost) + x).as_vec3().into(), finite(sum.at(x) * SCALE))
}
