//! Why a measurement or a picture could not be made: one enum, each variant naming the argument at fault.

/// Why a measurement or a picture could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QualityError {
    /// A mesh has no triangle with an area, so there is no surface to measure.
    #[error("the {which} mesh has no surface: none of its {triangles} triangles has an area")]
    NoSurface {
        /// "first" or "second", in the order of the arguments; "given" where there is but one.
        which: &'static str,
        /// How many triangles it has.
        triangles: usize,
    },
    /// A mesh has a border, so that there is no inside.
    #[error("the {which} mesh is not closed: triangles along the edge of vertices {edge:?}: {triangles}")]
    Open {
        /// As in [`NoSurface`](Self::NoSurface).
        which: &'static str,
        /// The edge's ends. Vertices at the same position count as the first of them.
        edge: [u32; 2],
        /// How many triangles lie along it: an odd number.
        triangles: usize,
    },
    /// A mesh is closed, but its triangles do not agree on which side is outside.
    #[error(
        "the {which} mesh is inconsistently oriented: triangles run the same way along the edge of vertices {edge:?}"
    )]
    Orientation {
        /// As in [`NoSurface`](Self::NoSurface).
        which: &'static str,
        /// The edge's ends. Vertices at the same position count as the first of them.
        edge: [u32; 2],
    },
    /// A measurement was asked for with no samples, or more than can be numbered.
    #[error("{samples} samples were asked for, which is not 1 to {limit}")]
    Samples {
        /// How many were asked for.
        samples: usize,
        /// The most that are supported.
        limit: usize,
    },
    /// A picture without pixels, or with more than are supported on a side.
    #[error("a picture of {width} by {height} pixels is not 1 to {limit} on each side")]
    PictureSize {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Most pixels on a side.
        limit: usize,
    },
    /// A camera's numbers do not make a view.
    #[error("the camera's {what} is not usable: {why}")]
    Camera {
        /// The field at fault.
        what: &'static str,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A list of colours or scalars does not have one entry per vertex or per triangle, as it should.
    #[error("{found} colours were given where the mesh has {expected} {what}")]
    ColourCount {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A comparison by images with no view or no pixel, or with more pixels than are supported.
    #[error("{views} views of {size} by {size} pixels are not 1 to {limit} pixels in all")]
    ImagePixels {
        /// How many views were asked for.
        views: usize,
        /// Pixels on each side.
        size: usize,
        /// Most pixels of all views.
        limit: usize,
    },
    /// A view that there is none of.
    #[error("there is no view {view} of {views}: they count from 0")]
    View {
        /// The view asked for.
        view: usize,
        /// How many there are.
        views: usize,
    },
}

impl QualityError {
    /// The same error of a mesh by another name.
    pub(crate) fn of(mut self, name: &'static str) -> Self {
        match &mut self {
            Self::NoSurface { which, .. } | Self::Open { which, .. } | Self::Orientation { which, .. } => {
                *which = name;
            }
            _ => {}
        }
        self
    }
}
