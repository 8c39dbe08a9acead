//! Rules for the shape of triangles: which way they face, and how thin they are.

use crate::simplify::surface::patch::quality;
use crate::simplify::surface::{Facet, WorkingSurface};

use super::{Collapse, Oracle, Reads};

/// Refuses collapses that turn a triangle's normal by more than an angle.
///
/// ```
/// use multires::simplify::oracle::NormalFlip;
/// use multires::{Simplifier, mesh::shapes};
///
/// // No triangle turns by more than 20 degrees.
/// let sequence = Simplifier::new().oracle(NormalFlip::degrees(20.0)).run(&shapes::icosphere(3))?;
/// assert!(!sequence.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NormalFlip {
    cos: f32,
}

impl Default for NormalFlip {
    /// 78 degrees.
    fn default() -> Self {
        Self::degrees(78.0)
    }
}

impl NormalFlip {
    /// Allows normals to turn by at most `angle` degrees in a collapse, 0 to 180 (clamped; NaN: 78).
    pub fn degrees(angle: f32) -> Self {
        let angle = if angle.is_nan() { 78.0 } else { angle.clamp(0.0, 180.0) };
        Self { cos: (f64::from(angle).to_radians().cos()) as f32 }
    }
}

impl Oracle for NormalFlip {
    fn name(&self) -> &str {
        "normal flip"
    }

    fn allows(&self, _: &WorkingSurface, collapse: &Collapse) -> bool {
        let cos_squared = self.cos * self.cos.abs();
        collapse.patch.facets().iter().all(|facet| {
            let (before, after) = (facet.before.length_squared(), facet.after.length_squared());
            let dot = facet.before.dot(facet.after);
            // dot > cos * |before| |after|, squared with its sign. A triangle without area has no side to flip to.
            dot * dot.abs() > cos_squared * before * after || before <= f32::MIN_POSITIVE
        })
    }

    fn reads(&self) -> Reads {
        Reads::Facets
    }
}

/// Delays collapses making needles: the thinnest new triangle should reach `least`, or the quality of the thinnest of the
/// triangles replaced or removed (needles in, needles out).
///
/// The measure is `4 sqrt(3) area / (sum of squared sides)`: 1 for an equilateral triangle, 0 for one without area.
///
/// A thin triangle is no error: on a long box only thin triangles are exact. So this rule does not end a simplification.
/// A refused collapse counts as 64 times dearer (about 8 times the distance), and is done once collapses of this cost are
/// due. The report counts how often it was put off. [`strict`](TriangleQuality::strict) makes the rule absolute.
#[derive(Debug, Clone, Copy)]
pub struct TriangleQuality {
    least: f32,
    strict: bool,
}

/// Cost factor of a collapse making a needle.
const NEEDLE_SURCHARGE: f32 = 64.0;

impl Default for TriangleQuality {
    /// 0.01.
    fn default() -> Self {
        Self::at_least(0.01)
    }
}

impl TriangleQuality {
    /// Asks for new triangles of at least this quality, 0 (anything) to 1 (equilateral only).
    pub fn at_least(least: f32) -> Self {
        Self { least, strict: false }
    }

    /// Makes the rule absolute: a refused collapse is never done. For meshes that must not get thinner triangles than
    /// they have; simplifications may miss their target.
    #[must_use]
    pub fn strict(self) -> Self {
        Self { strict: true, ..self }
    }
}

impl Oracle for TriangleQuality {
    fn name(&self) -> &str {
        "triangle quality"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let patch = collapse.patch;
        let thinnest = |of: fn(&Facet) -> f32| patch.facets().iter().map(of).fold(f32::INFINITY, f32::min);
        let after = thinnest(Facet::quality_after);
        if after >= self.least {
            return true;
        }
        let dying = patch.opposite().iter().map(|&third| {
            let [p, q, r] = [collapse.pair.lost, collapse.pair.kept, third].map(|point| surface.at(point));
            quality((q - p).cross(r - p), q - p, r - p)
        });
        after >= dying.fold(thinnest(Facet::quality_before), f32::min)
    }

    fn surcharge(&self) -> Option<f32> {
        (!self.strict).then_some(NEEDLE_SURCHARGE)
    }
}
