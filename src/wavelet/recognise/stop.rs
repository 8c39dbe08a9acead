//! Why a component cannot be coarsened further, in words.

/// Why four-to-one coarsening of a component ended where it did.
///
/// Triangles are those of the input. Where faces of several triangles are at fault, the lowest triangle of one of them
/// is named. A contradiction is that of the assumption which held for the most faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stop {
    /// One face is left.
    SingleFace,
    /// The number of faces that are left is not a multiple of four.
    NotFourfold {
        /// How many faces are left.
        faces: u32,
    },
    /// The triangle names a point twice.
    Degenerate {
        /// The triangle.
        triangle: u32,
    },
    /// Edges do not continue straight through vertices as they do across the midpoint of an edge: some valence is not
    /// that of a subdivided mesh, or the pattern of coarse faces does not close up.
    Irregular {
        /// A triangle where that shows.
        triangle: u32,
    },
    /// A border runs where the middle of a coarse face would be.
    Border {
        /// A triangle at that border.
        triangle: u32,
    },
    /// Three or more triangles meet where the middle of a coarse face would be.
    NonManifold {
        /// One of them.
        triangle: u32,
    },
    /// Triangles that would make up a coarse face turn different ways.
    Orientation {
        /// One of them.
        triangle: u32,
    },
    /// A coarse face would have one point at two of its corners.
    RepeatedCorner {
        /// A triangle of that face.
        triangle: u32,
    },
    /// A seam, where one point has several attribute values, runs through the middle of a coarse face.
    Seam {
        /// A triangle of that face.
        triangle: u32,
    },
    /// Triangles that would make up a coarse face differ in material.
    Material {
        /// One of them.
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
