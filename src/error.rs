//! What can be wrong with what a caller hands in: one enum by blame, each variant naming the element.
//!
//! Stopping early is not an error but a result (see [`StopReason`](crate::simplify::StopReason)).

/// Why a [`Mesh`](crate::mesh::Mesh) could not be made from the arrays it was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A position holds NaN or an infinity.
    #[error("vertex {vertex} has a non-finite position {position:?}")]
    NonFinitePosition {
        /// Index of the vertex.
        vertex: usize,
        /// The position as given.
        position: [f32; 3],
    },
    /// The origin holds NaN or an infinity.
    #[error("the origin {origin:?} is not finite")]
    NonFiniteOrigin {
        /// The origin as given.
        origin: [f64; 3],
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Indices that make no whole number of triangles.
    #[error("{indices} indices are not three a triangle")]
    OddIndices {
        /// How many indices there are.
        indices: usize,
    },
    /// A range of a material that is out of bounds, cuts triangles in two, or overlaps another.
    #[error("range {range} of indices ({start}..{end}) is not one of whole triangles of its own")]
    MaterialRange {
        /// The number of the range.
        range: usize,
        /// Its first index.
        start: usize,
        /// One behind its last index.
        end: usize,
    },
    /// A triangle that no range of a material covers.
    #[error("triangle {triangle} is in no range of a material")]
    NoMaterial {
        /// Index of the triangle.
        triangle: usize,
    },
    /// Values of two vertices that differ, where the mesh said that the vertices are one.
    #[error(
        "vertices {} and {} are one in the mesh, but their values differ: tell them apart by Mesh::from_vertices or an \
         attribute",
        vertices[0],
        vertices[1]
    )]
    Folded {
        /// The first two.
        vertices: [u32; 2],
    },
    /// Values of vertices that collapses have made, which only a blend of others can give.
    #[error("{count} vertices were made by collapses: their values need a blend")]
    NewVertices {
        /// How many there are.
        count: usize,
    },
    /// A vertex of a baked model that comes from nowhere: no vertex of the input, nor a mixture before it.
    #[error("origin {vertex} names {found}, which there is not before it")]
    Origin {
        /// Index of the origin.
        vertex: usize,
        /// What it names.
        found: u32,
    },
    /// More vertices or triangles than the structures can number.
    #[error("{count} {what} are more than the {limit} supported")]
    TooMany {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are supported.
        limit: usize,
    },
    /// A stream's length does not match the mesh.
    #[error("{what} has {found} entries where {expected} are needed")]
    LengthMismatch {
        /// The name of the stream.
        what: String,
        /// How many entries it has.
        found: usize,
        /// How many the mesh needs.
        expected: usize,
    },
    /// An attribute's width is not 1 to 16 scalars.
    #[error("attribute {name:?} has width {width}, which is not 1 to 16")]
    AttributeWidth {
        /// The attribute's name.
        name: String,
        /// The width as given.
        width: usize,
    },
    /// Two attributes have the same name.
    #[error("there is already an attribute named {name:?}")]
    DuplicateAttribute {
        /// The attribute's name.
        name: String,
    },
}
