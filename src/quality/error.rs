//! Errors of measurements and pictures: an enum, each variant naming the argument at fault.

/// Error of a measurement or a picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QualityError {
    /// A mesh has no triangle with an area, so there is no surface to measure.
    #[error("the {which} mesh has no surface: none of its {triangles} triangles has an area")]
    NoSurface {
        /// "first" or "second", in the order of the arguments; "given" if there is a single mesh.
        which: &'static str,
        /// Number of triangles of the mesh.
        triangles: usize,
    },
    /// A mesh has a border, so it has no inside.
    #[error("the {which} mesh is not closed: triangles along the edge of vertices {edge:?}: {triangles}")]
    Open {
        /// Name of the mesh, as in [`NoSurface`](Self::NoSurface).
        which: &'static str,
        /// End vertices of the edge. Of vertices at the same position, the first is given.
        edge: [u32; 2],
        /// Number of triangles along the edge: odd.
        triangles: usize,
    },
    /// A mesh is closed, but its triangles do not agree on which side is outside.
    #[error(
        "the {which} mesh is inconsistently oriented: triangles run the same way along the edge of vertices {edge:?}"
    )]
    Orientation {
        /// Name of the mesh, as in [`NoSurface`](Self::NoSurface).
        which: &'static str,
        /// End vertices of the edge. Of vertices at the same position, the first is given.
        edge: [u32; 2],
    },
    /// A mesh has no texture coordinates: no attribute `uv` of two floats.
    #[error("the {which} mesh has no texture coordinates: no attribute \"uv\" of two floats")]
    NoTexture {
        /// Name of the mesh, as in [`NoSurface`](Self::NoSurface).
        which: &'static str,
    },
    /// A texture coordinate is not finite.
    #[error("vertex {vertex} of the {which} mesh has a texture coordinate that is not finite")]
    NonFiniteTexture {
        /// Name of the mesh, as in [`NoSurface`](Self::NoSurface).
        which: &'static str,
        /// Index of the vertex.
        vertex: usize,
    },
    /// A collapse sequence belongs to another mesh.
    #[error(
        "the sequence is of a mesh of {vertices} vertices and {triangles} triangles, which the given mesh is not"
    )]
    Sequence {
        /// Vertices of the sequence's input.
        vertices: usize,
        /// Triangles of the sequence's input.
        triangles: usize,
    },
    /// The number of samples is 0, or more than can be numbered.
    #[error("{samples} samples were asked for, which is not 1 to {limit}")]
    Samples {
        /// Samples requested.
        samples: usize,
        /// Most samples supported.
        limit: usize,
    },
    /// A picture has no pixels, or more than supported on a side.
    #[error("a picture of {width} by {height} pixels is not 1 to {limit} on each side")]
    PictureSize {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// Most pixels on a side.
        limit: usize,
    },
    /// A camera does not define a view.
    #[error("the camera's {what} is not usable: {why}")]
    Camera {
        /// Field of the camera at fault.
        what: &'static str,
        /// Defect of the field.
        why: &'static str,
    },
    /// A list of colours does not have exactly one entry per vertex or per triangle.
    #[error("{found} colours were given where the mesh has {expected} {what}")]
    ColourCount {
        /// "vertices" or "triangles".
        what: &'static str,
        /// Colours given.
        found: usize,
        /// Colours needed.
        expected: usize,
    },
    /// A comparison by images has no view or no pixel, or more pixels than supported.
    #[error("{views} views of {size} by {size} pixels are not 1 to {limit} pixels in all")]
    ImagePixels {
        /// Views requested.
        views: usize,
        /// Pixels on each side.
        size: usize,
        /// Most pixels of all views.
        limit: usize,
    },
    /// A view's index is out of range.
    #[error("there is no view {view} of {views}: they count from 0")]
    View {
        /// Index of the view requested.
        view: usize,
        /// Number of views.
        views: usize,
    },
}

impl QualityError {
    /// Renames the mesh in the error.
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
