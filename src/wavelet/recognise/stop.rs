//! Reasons why a component cannot be coarsened further, in words.

/// Why four-to-one coarsening of a component ended.
///
/// Triangles are input triangles. Where a face made of several triangles is at fault, its lowest triangle is named. For a
/// contradiction, the reason belongs to the assumption consistent for the most faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stop {
    /// A single face is left.
    SingleFace,
    /// The number of faces left is not a multiple of four.
    NotFourfold {
        /// Number of faces left.
        faces: u32,
    },
    /// The triangle names a point twice.
    Degenerate {
        /// The triangle.
        triangle: u32,
    },
    /// Edges do not continue straight through vertices as they do across the midpoint of an edge: some valence does not occur
    /// in a subdivided mesh, or the pattern of coarse faces does not close up.
    Irregular {
        /// A triangle at the irregular place.
        triangle: u32,
    },
    /// A border runs through the middle of a would-be coarse face.
    Border {
        /// A triangle at the border.
        triangle: u32,
    },
    /// Three or more triangles meet at an edge in the middle of a would-be coarse face.
    NonManifold {
        /// A triangle at the non-manifold edge.
        triangle: u32,
    },
    /// The triangles of a would-be coarse face turn different ways.
    Orientation {
        /// A triangle with the other orientation.
        triangle: u32,
    },
    /// A would-be coarse face has the same point at two of its corners.
    RepeatedCorner {
        /// A triangle of the coarse face.
        triangle: u32,
    },
    /// A seam, where a point has several attribute values, runs through the middle of a would-be coarse face.
    Seam {
        /// A triangle of the coarse face.
        triangle: u32,
    },
    /// The triangles of a would-be coarse face differ in material.
    Material {
        /// A triangle of the coarse face.
        triangle: u32,
    },
}

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::SingleFace => write!(f, "a single face is left"),
            Self::NotFourfold { faces } => write!(f, "{faces} faces do not divide by four"),
            Self::Degenerate { triangle } => write!(f, "triangle {triangle} names a point twice"),
            Self::Irregular { triangle } => {
                write!(f, "vertices around triangle {triangle} do not fit a four-to-one subdivision")
            }
            Self::Border { triangle } => {
                write!(f, "a border at triangle {triangle} cuts through what would be a coarse face")
            }
            Self::NonManifold { triangle } => {
                write!(f, "triangle {triangle} has a non-manifold edge inside what would be a coarse face")
            }
            Self::Orientation { triangle } => {
                write!(f, "triangle {triangle} is turned the other way than the rest of its coarse face")
            }
            Self::RepeatedCorner { triangle } => {
                write!(f, "the coarse face around triangle {triangle} would have two corners in one point")
            }
            Self::Seam { triangle } => {
                write!(f, "an attribute seam cuts through the coarse face around triangle {triangle}")
            }
            Self::Material { triangle } => {
                write!(f, "materials change inside the coarse face around triangle {triangle}")
            }
        }
    }
}
