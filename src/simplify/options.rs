//! What can be asked of a simplification: order, attributes, targets, progress.

use crate::mesh::Mesh;

use super::metric::Attributes;

/// In which order collapses are done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Order {
    /// Always the cheapest next, to within one cost class of 6.25 % (Southern 3.3). Above 65,536 points, to within a
    /// band of one or two octaves while it is found, and then sorted (see `docs/architecture.md`).
    #[default]
    Linear,
    /// Batches of collapses whose neighbourhoods do not touch, cheapest first inside each (Southern 3.4). Each batch
    /// at most halves the mesh or so, the collapses of one batch may be undone in any order, and the metric may change
    /// between batches.
    Batched,
}

/// What the error of a step is, and whether it is asked before the step is done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorMeasure {
    /// How far input points have travelled to the point they were merged into. A proven bound for the distance of
    /// the surfaces in both directions and for how far textures slide, but a loose one where the surface is flat: the
    /// fastest, for a sequence of which only the order matters.
    Parametric,
    /// The largest distance of an input point from the level's surface, of the curves of input and level from each other, and
    /// next to curves and on coarse levels of the level's triangles from the input, measured as they change. Tight.
    #[default]
    Measured,
    /// As `Measured`; and where the metric's costs are squared distances (the quadrics), a collapse that would move
    /// the input further from the surface than its cost foresaw waits until that is the cheapest. Levels of the same
    /// size lie up to a third closer to the input, for about twice the time.
    Verified,
}

/// Whether collapses are refused that would ruin the shape.
///
/// What is left when everything better is refused by a rule may be terrible: a wall that folds into a corner while its
/// ornaments stand. While on, a collapse is refused that would bring the error beyond what the triangles left explain,
///
/// ```text
///     diagonal * max(1 / 100, 5 / (2 sqrt(triangles)))
/// ```
///
/// where the diagonal is that of the box around the input's triangles and the triangles are those that the collapse would
/// leave: some two and a half times the length that the edges of as many even triangles have. Of 60 models, scans down to
/// 1 % of their triangles stay below `0.9 diagonal / sqrt(triangles)` and nearly all levels that were asked for and
/// reached below 2.4; levels that were ruined lie between 3 and 12. Other collapses go on, and what was refused is tried again
/// as triangles go and the limit grows; where none is left, the simplification stops for
/// [`StopReason::Guard`](super::StopReason::Guard). The limit holds also where no target is asked for, as for base
/// meshes: below 7 triangles it allows anything.
///
/// The guard judges measured distances: it has no say with [`ErrorMeasure::Parametric`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Guard {
    /// Collapses that ruin are refused.
    #[default]
    On,
    /// Whatever the rules allow is done.
    Off,
}

impl Guard {
    /// The largest error of a level of so many triangles, in the unit of the diagonal.
    pub(super) fn limit(diagonal: f32, triangles: usize) -> f32 {
        diagonal * (2.5 / (triangles.max(1) as f32).sqrt()).max(0.01)
    }
}

/// What becomes of separate parts (points joined by triangles) that are as coarse as they get: leaves, pebbles, struts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Parts {
    /// A part vanishes as a whole, in one step, when that is the cheapest next step by its area and size. The last part
    /// stays. Parts with a locked vertex stay, and so do those that another rule holds
    /// ([`Oracle::allows_vanishing`](super::Oracle::allows_vanishing)).
    #[default]
    Vanish,
    /// Every part stays, as far as the other rules have it: of an open one a triangle, of a closed one a tetrahedron.
    Keep,
}

/// Which attributes count in what collapses cost, beside the shape.
///
/// They weigh as [`metric::Attributes`](super::metric::Attributes) says: with every metric, at its own exchange rate. A
/// mesh without the attributes that count is simplified as if none did.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AttributeWeights {
    /// None: they are carried along, seams are kept, but values do not steer.
    Off,
    /// Normals, texture coordinates and colours, with the
    /// [customary weights](super::metric::Attributes::customary).
    #[default]
    Customary,
    /// The float attributes of these names, which the mesh must have, each with a weight: the distance that a deviation
    /// of one unit is worth, as a share of the diagonal of the mesh's box, 0 to 1,000,000.
    Chosen(Vec<(String, f32)>),
}

impl AttributeWeights {
    /// What counts of a mesh; `None` where that is nothing.
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

/// When to stop. With several targets the first one reached stops.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// At most this many triangles.
    Triangles(usize),
    /// At most this many vertices (wedges that a triangle uses).
    Vertices(usize),
    /// At most this share of the input's triangles, 0 to 1.
    Ratio(f64),
    /// As few triangles as possible while the error bound stays within this, object units.
    Error(f32),
    /// At most this many bytes as an indexed mesh with 32-bit indices.
    Bytes {
        /// The bytes of vertices and indices together.
        bytes: usize,
        /// Bytes of one vertex.
        per_vertex: usize,
    },
}

/// An option that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// A number outside its range.
    #[error("{option} is {value}, which is not {expected}")]
    OutOfRange {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The mesh has no such attribute of floats.
    #[error("the mesh has no float attribute named {name:?}")]
    NoAttribute {
        /// The attribute asked for.
        name: String,
    },
}

/// How far a simplification is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Collapses done.
    pub steps: usize,
    /// Triangles left.
    pub triangles: usize,
    /// Triangles of the input.
    pub input_triangles: usize,
    /// The triangles that the targets ask for, as far as they say; 0 otherwise.
    pub target_triangles: usize,
}

impl Progress {
    /// The share of the way done, 0 to 1.
    pub fn fraction(&self) -> f32 {
        let way = self.input_triangles.saturating_sub(self.target_triangles).max(1);
        (self.input_triangles.saturating_sub(self.triangles) as f32 / way as f32).min(1.0)
    }
}

/// The targets, in one place to ask after every step.
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

    /// Whether a size is asked for, and not only an error.
    pub fn is_sized(&self) -> bool {
        self.triangles > 0 || self.vertices > 0 || self.bytes.is_some()
    }

    /// Whether a mesh of this size is small enough.
    #[inline]
    pub fn reached(&self, triangles: usize, vertices: usize) -> bool {
        triangles <= self.triangles
            || vertices <= self.vertices
            || self.bytes.is_some_and(|(bytes, per_vertex)| triangles * 12 + vertices * per_vertex <= bytes)
    }
}
