//! Why a sequence is refused.

/// An inconsistency in a sequence of collapses, or between a sequence and a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SequenceError {
    /// The sequence was made from another mesh, or its tables do not fit together.
    #[error("the sequence has {found} {what} where {expected} are needed")]
    Mismatch {
        /// Counted elements.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number needed.
        expected: usize,
    },
    /// A step ends before it starts.
    #[error("step {step} ends before it starts")]
    StepOrder {
        /// Index of the step.
        step: usize,
    },
    /// A batch ends before the previous batch, or beyond the last step.
    #[error("batch {batch} ends before it starts, or after the last step")]
    BatchOrder {
        /// Index of the batch.
        batch: usize,
    },
    /// A step names a vertex out of range.
    #[error("step {step} names vertex {vertex}, but there are {vertices}")]
    VertexOutOfRange {
        /// Index of the step.
        step: usize,
        /// The vertex.
        vertex: u32,
        /// Number of vertices, new vertices included.
        vertices: usize,
    },
    /// A step names a vertex not in the mesh at the time: substituted earlier, folded into its duplicate, or not made
    /// yet.
    #[error("step {step} names vertex {vertex}, which is not in the mesh at that time")]
    NotLive {
        /// Index of the step.
        step: usize,
        /// The vertex.
        vertex: u32,
    },
    /// A step substitutes a vertex by itself.
    #[error("step {step} substitutes vertex {vertex} by itself")]
    SelfSubstitution {
        /// Index of the step.
        step: usize,
        /// The vertex.
        vertex: u32,
    },
    /// An error bound is negative or not finite, or an accumulated or reported error is not the largest so far.
    #[error(
        "step {step} has the error bound {error}, which is negative, not finite or not the largest so far"
    )]
    BadError {
        /// Index of the step.
        step: usize,
        /// The bound as given.
        error: f32,
    },
    /// A new vertex lies at a non-finite position, blends with a weight outside 0 to 1, or blends a vertex not numbered
    /// below itself.
    #[error("new vertex {new} has a position that is not finite, a weight outside 0 to 1, or a later source")]
    BadNewVertex {
        /// Index among the new vertices.
        new: usize,
    },
    /// A vertex is snapped twice, out of order, or to a vertex snapped itself.
    #[error("vertex {vertex} is snapped twice, out of order, or to a vertex that is snapped itself")]
    Snap {
        /// The vertex.
        vertex: u32,
    },
    /// A triangle vanishes with a step beyond the last.
    #[error("triangle {triangle} vanishes with step {end} of fewer")]
    TriangleEnd {
        /// Index of the triangle.
        triangle: usize,
        /// Number of steps given as the triangle's end.
        end: u32,
    },
    /// The number of triangles left differs from the number of triangles not vanished.
    #[error("after {steps} steps {found} triangles are said to be left, but {expected} have not vanished")]
    TriangleCount {
        /// The number of steps.
        steps: usize,
        /// Number of triangles left, as given.
        found: usize,
        /// Number of triangles vanishing later or never.
        expected: usize,
    },
    /// The crease angle for recomputing normals is not within 0 to 180 degrees.
    #[error("the crease angle of recomputed normals is not 0 to 180 degrees")]
    BadCreases,
    /// There are more steps, substitutions or moved corners than supported.
    #[error("there are more than {limit} substitutions")]
    TooMany {
        /// Maximum supported.
        limit: usize,
    },
}
