//! Options of a simplification: order, attributes, targets, progress.

use crate::mesh::Mesh;

use super::metric::Attributes;

/// Order of the collapses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Order {
    /// The cheapest collapse next, to within a cost class of 6.25 % (Southern 3.3). Above 65,536 points, collapses are
    /// found to within a band of one or two octaves and then sorted (see `docs/architecture.md`).
    #[default]
    Linear,
    /// Batches of independent collapses, cheapest first inside each (Southern 3.4). [`Independence`] says what is
    /// independent. The metric, its coefficients and the placement may change between batches.
    Batched,
}

/// Collapses that may share a batch of [`Order::Batched`]. Whatever the choice, no point takes part in two collapses of a
/// batch; a part that vanishes as a whole does so in one step.
///
/// Share of the triangles kept by a batch on scans, endpoint placement: 0.84 (`Ring`), 0.70 (`Domain`), 0.59 (`Matching`).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Independence {
    /// A collapse takes its merged point and all neighbours of the point out of the batch (Berkey and Song). Collapses of a
    /// batch may be undone in any order, each alone with its triangles as they were.
    #[default]
    Ring,
    /// A collapse takes every edge of the triangles it changes out of the batch: its edge collapse domain (Southern 3.4).
    Domain,
    /// A collapse takes its two points out of the batch. A batch nearly halves the mesh: for few levels of detail
    /// ([`Gmesh`](crate::gmesh::Gmesh)). It ends at 0.59 of the triangles, before the collapses that linear order would do
    /// last, or where costs leap by a factor of 1000.
    Matching,
}

/// Error measure of a step, and whether it is checked before the step.
///
/// ```
/// use multires::simplify::ErrorMeasure;
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// let mesh = shapes::rock(1_000, 1);
/// let [proven, measured] = [ErrorMeasure::Parametric, ErrorMeasure::Measured].map(|measure| {
///     Simplifier::new().error_measure(measure).target(Target::Ratio(0.2)).run(&mesh)
/// });
/// assert!(measured?.report().error <= proven?.report().error);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorMeasure {
    /// Distance travelled by input points to the point they were merged into. A proven bound for the distance of the
    /// surfaces in both directions and for the sliding of textures, but loose where the surface is flat. Fastest: for a
    /// sequence used only for its order. Without any rule ([`Simplifier::oracles`](super::Simplifier::oracles)) a point may
    /// be left without triangles, and what was merged into it is no longer on the surface: then this is no bound.
    Parametric,
    /// Largest of the distances of input points from the level's surface and of the curves of input and level from each
    /// other; next to curves and on coarse levels also of the level's triangles from the input. Measured as they change.
    /// Tight.
    #[default]
    Measured,
    /// As `Measured`. In addition, if the metric's costs are squared distances (the quadrics), a collapse moving the
    /// input further from the surface than foreseen by its cost waits until its true cost is the cheapest. Levels of
    /// equal size lie up to a third closer to the input, for about twice the time.
    Verified,
}

/// Whether collapses ruining the shape are refused.
///
/// When the rules refuse everything better, the remaining collapses may be terrible: a wall folds into a corner while its
/// ornaments stand. While on, a collapse is refused if its error would exceed the limit explained by the remaining
/// triangles,
///
/// ```text
///     diagonal * max(1 / 100, 5 / (2 sqrt(triangles)))
/// ```
///
/// where `diagonal` is the diagonal of the box around the input's triangles, and `triangles` counts the triangles after
/// the collapse. The second term is about 2.5 times the edge length of as many even triangles. Of 60 models, scans down
/// to 1 % of their triangles stay below `0.9 diagonal / sqrt(triangles)`, and nearly all levels asked for and reached
/// below 2.4. Ruined levels lie between 3 and 12.
///
/// Other collapses go on. Refused collapses are tried again as triangles go and the limit grows; if none is left, the
/// simplification stops with [`StopReason::Guard`](super::StopReason::Guard). The limit also holds without a target, as
/// for base meshes: below 7 triangles it allows anything.
///
/// The guard judges measured distances: it has no effect with [`ErrorMeasure::Parametric`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Guard {
    /// Refuses collapses ruining the shape.
    #[default]
    On,
    /// Allows every collapse allowed by the rules.
    Off,
}

impl Guard {
    /// Returns the largest allowed error of a level of `triangles` triangles, in the unit of `diagonal`.
    pub(super) fn limit(diagonal: f32, triangles: usize) -> f32 {
        diagonal * (2.5 / (triangles.max(1) as f32).sqrt()).max(0.01)
    }
}

/// Treatment of separate parts (points joined by triangles) at their coarsest: leaves, pebbles, struts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Parts {
    /// A part vanishes as a whole, in a single step, when its area and size make this the cheapest next step. The last
    /// part stays. Parts with a locked vertex stay, and so do parts held by another rule
    /// ([`Oracle::allows_vanishing`](super::Oracle::allows_vanishing)).
    #[default]
    Vanish,
    /// Every part stays, as far as other rules allow: an open part as a triangle, a closed part as a tetrahedron.
    Keep,
}

/// Attributes counted by the costs of collapses, beside the shape.
///
/// Weights are defined in [`metric::Attributes`](super::metric::Attributes). They work with every metric, at its own
/// exchange rate. On a mesh without the counted attributes, costs count the shape alone.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AttributeWeights {
    /// No attribute counts. Attributes are carried along and seams are kept, but values do not steer.
    Off,
    /// Normals, texture coordinates and colours, with the
    /// [customary weights](super::metric::Attributes::customary).
    #[default]
    Customary,
    /// The float attributes with these names, which the mesh must have, each with a weight: the distance costing as much
    /// as a deviation of 1 unit, as a share of the diagonal of the mesh's box, 0 to 1,000,000.
    Chosen(Vec<(String, f32)>),
}

impl AttributeWeights {
    /// Returns the counted attributes of a mesh; `None` if none count.
    pub(super) fn of<'a>(&self, mesh: &'a Mesh) -> Result<Option<Attributes<'a>>, OptionError> {
        let attributes = match self {
            Self::Off => return Ok(None),
            Self::Customary => Attributes::customary(mesh),
            Self::Chosen(list) => {
                list.iter().fold(Attributes::new(mesh), |all, (name, weight)| all.custom(name, *weight))
            }
        };
        attributes.checked().map(|attributes| (!attributes.is_empty()).then_some(attributes))
    }
}

/// When to stop. With several targets the first target reached stops.
///
/// ```
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// // At most 500 triangles, or as few as an error of 0.01 allows, whichever comes first.
/// let mut simplifier = Simplifier::new().target(Target::Triangles(500)).target(Target::Error(0.01));
/// let report = simplifier.run(&shapes::icosphere(4))?.report().clone();
/// assert!(report.triangles <= 500 || report.error <= 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// At most this many triangles.
    Triangles(usize),
    /// At most this many vertices (wedges used by triangles).
    Vertices(usize),
    /// At most this share of the input's triangles, 0 to 1.
    Ratio(f64),
    /// As few triangles as possible with an error bound of at most this value, object units.
    Error(f32),
    /// At most this many bytes, as an indexed mesh with 32-bit indices.
    Bytes {
        /// The bytes of vertices and indices together.
        bytes: usize,
        /// Bytes of one vertex.
        per_vertex: usize,
    },
}

/// An invalid option.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// A number outside its range.
    #[error("{option} is {value}, which is not {expected}")]
    OutOfRange {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
        /// The allowed values.
        expected: &'static str,
    },
    /// The mesh has no float attribute with this name.
    #[error("the mesh has no float attribute named {name:?}")]
    NoAttribute {
        /// Name of the attribute.
        name: String,
    },
}

/// Progress of a simplification.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Collapses done.
    pub steps: usize,
    /// Triangles left.
    pub triangles: usize,
    /// Triangles of the input.
    pub input_triangles: usize,
    /// The triangles asked for by the targets, if known; otherwise 0.
    pub target_triangles: usize,
}

impl Progress {
    /// The completed share of the work, 0 to 1.
    pub fn fraction(&self) -> f32 {
        let way = self.input_triangles.saturating_sub(self.target_triangles).max(1);
        (self.input_triangles.saturating_sub(self.triangles) as f32 / way as f32).min(1.0)
    }
}

/// All targets combined, checked after every step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub triangles: usize,
    pub vertices: usize,
    pub bytes: Option<(usize, usize)>,
    pub error: f32,
}

impl Limits {
    pub fn new(targets: &[Target], input_triangles: usize) -> Result<Self, OptionError> {
        let mut limits = Self { triangles: 0, vertices: 0, bytes: None, error: f32::INFINITY };
        let bad = |option, value, expected| Err(OptionError::OutOfRange { option, value, expected });
        for &target in targets {
            match target {
                Target::Triangles(n) => limits.triangles = limits.triangles.max(n),
                Target::Vertices(n) => limits.vertices = limits.vertices.max(n),
                Target::Ratio(r) if !(0.0..=1.0).contains(&r) => return bad("ratio", r, "0 to 1"),
                Target::Ratio(r) => {
                    limits.triangles = limits.triangles.max((input_triangles as f64 * r).floor() as usize);
                }
                Target::Error(e) if e.is_nan() || e < 0.0 => return bad("error", f64::from(e), "0 or more"),
                Target::Error(e) => limits.error = limits.error.min(e),
                Target::Bytes { bytes, per_vertex } => limits.bytes = Some((bytes, per_vertex)),
            }
        }
        Ok(limits)
    }

    /// Whether any target is a size, rather than only an error.
    pub fn is_sized(&self) -> bool {
        self.triangles > 0 || self.vertices > 0 || self.bytes.is_some()
    }

    /// Whether a mesh of this size meets a target of size.
    #[inline]
    pub fn reached(&self, triangles: usize, vertices: usize) -> bool {
        triangles <= self.triangles
            || vertices <= self.vertices
            || self.bytes.is_some_and(|(bytes, per_vertex)| {
                vertices.saturating_mul(per_vertex).saturating_add(12 * triangles) <= bytes
            })
    }
}
