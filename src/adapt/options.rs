//! How a level of detail may go about following the view: how much a frame, how much at most.

/// Limits of a level of detail that follows the view; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct LodOptions {
    /// Most splits and collapses a frame; the rest is carried over. `None`: all at once. At 0 nothing changes any more.
    pub operations: Option<usize>,
    /// Most triangles, whatever the view asks for; `None`: as many as it asks for. Where the coarsest mesh has more, that.
    /// Tolerances grow together until the most urgent of what is asked for fits ([`Criterion::urgency`]); while the view
    /// moves, 95 to 100 of a hundred are used.
    ///
    /// [`Criterion::urgency`]: crate::view::Criterion::urgency
    pub triangles: Option<usize>,
}

impl LodOptions {
    /// With at most this many splits and collapses a frame.
    #[must_use]
    pub fn with_operations(mut self, most: Option<usize>) -> Self {
        self.operations = most;
        self
    }

    /// With at most this many triangles.
    #[must_use]
    pub fn with_triangles(mut self, most: Option<usize>) -> Self {
        self.triangles = most;
        self
    }
}
