//! Errors of the caller's arrays and values: each variant names the element at fault.
//!
//! Stopping early is a result, not an error (see [`StopReason`](crate::simplify::StopReason)).

/// Why a [`Mesh`](crate::mesh::Mesh) could not be made from the given arrays, or values not be arranged.
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
        /// The index held by the triangle.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// The number of indices is not a multiple of 3.
    #[error("{indices} indices are not three a triangle")]
    OddIndices {
        /// Number of indices.
        indices: usize,
    },
    /// A range of a material is out of bounds, cuts triangles in two, or overlaps another range.
    #[error("range {range} of indices ({start}..{end}) is not one of whole triangles of its own")]
    MaterialRange {
        /// Number of the range, from 0.
        range: usize,
        /// Its first index.
        start: usize,
        /// The index behind its last.
        end: usize,
    },
    /// A triangle is in no range of a material.
    #[error("triangle {triangle} is in no range of a material")]
    NoMaterial {
        /// Index of the triangle.
        triangle: usize,
    },
    /// Two vertices have different values, but are a single vertex in the mesh.
    #[error(
        "vertices {} and {} are one in the mesh, but their values differ: tell them apart by Mesh::from_vertices or an \
         attribute",
        vertices[0],
        vertices[1]
    )]
    Folded {
        /// The first two such vertices.
        vertices: [u32; 2],
    },
    /// Vertices made by collapses have no values: only a blend of other values can give them.
    #[error("{count} vertices were made by collapses: their values need a blend")]
    NewVertices {
        /// Number of vertices made by collapses.
        count: usize,
    },
    /// A vertex of a baked model has no origin: neither an input vertex nor an earlier mixture.
    #[error("origin {vertex} names {found}, which there is not before it")]
    Origin {
        /// Index of the origin.
        vertex: usize,
        /// The vertex named by the origin.
        found: u32,
    },
    /// More vertices or triangles than the structures can number.
    #[error("{count} {what} are more than the {limit} supported")]
    TooMany {
        /// "vertices" or "triangles".
        what: &'static str,
        /// Number found.
        count: usize,
        /// Most supported.
        limit: usize,
    },
    /// A stream's length does not match the mesh.
    #[error("{what} has {found} entries where {expected} are needed")]
    LengthMismatch {
        /// The name of the stream.
        what: String,
        /// Number of entries in the stream.
        found: usize,
        /// Number of entries needed by the mesh.
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
