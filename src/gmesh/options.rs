//! Options of building a g-mesh.

/// Options for building a g-mesh from a simplification.
///
/// ```
/// use multires::gmesh::{Gmesh, GmeshBuilder, GmeshOptions};
/// use multires::mesh::shapes;
///
/// let model = GmeshBuilder::new().options(GmeshOptions::default().with_share(0.4)).bake(&shapes::rock(2_000, 1))?;
/// let levels = model.structure().levels();
/// assert!(levels[1].triangles * 10 <= levels[0].triangles * 4);
/// # Ok::<(), multires::gmesh::GmeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct GmeshOptions {
    /// Largest share of the triangles kept from a level to the next, above 0 to 0.9. Batches are joined into a level until
    /// the share is reached; a sequence in linear order is cut where the share is first reached. What is left at the end joins
    /// the last level. Default 0.65: each batch of [`Matching`](crate::simplify::Independence::Matching) is a level.
    pub share: f32,
}

impl Default for GmeshOptions {
    fn default() -> Self {
        Self { share: 0.65 }
    }
}

impl GmeshOptions {
    /// Sets the largest share of the triangles kept from a level to the next.
    #[must_use]
    pub fn with_share(mut self, share: f32) -> Self {
        self.share = share;
        self
    }
}
