//! One error for whoever need not tell the rooms apart: every error of the crate becomes it by `?`.

use crate::error::MeshError;
use crate::hierarchy::HierarchyError;
use crate::simplify::{OptionError, ProgressiveError, SequenceError};
use crate::tom::TomError;
use crate::view::ViewError;
use crate::wavelet::WaveletError;

/// Whatever went wrong anywhere in this crate. Its message is that of the error inside.
///
/// ```
/// use multires::{Level, Mesh, Simplifier, TotallyOrderedMesh, mesh::shapes};
///
/// fn coarse(mesh: &Mesh) -> Result<Vec<u32>, multires::Error> {
///     let sequence = Simplifier::new().run(mesh)?; // options that make no sense
///     let built = TotallyOrderedMesh::build(mesh, &sequence)?; // a sequence of another mesh
///     let mut indices = Vec::new();
///     built.tom.fill_indices(built.tom.at(Level::Ratio(0.1)), &mut indices);
///     Ok(indices)
/// }
/// assert!(coarse(&shapes::demo())?.len() > 3);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[error(transparent)]
pub enum Error {
    /// Arrays that make no mesh.
    Mesh(#[from] MeshError),
    /// Options of a simplification.
    Options(#[from] OptionError),
    /// A collapse sequence that does not hold together.
    Sequence(#[from] SequenceError),
    /// A progressive mesh that does not hold together.
    Progressive(#[from] ProgressiveError),
    /// A totally ordered mesh.
    Tom(#[from] TomError),
    /// A vertex hierarchy.
    Hierarchy(#[from] HierarchyError),
    /// A wavelet mesh.
    Wavelet(#[from] WaveletError),
    /// A view.
    View(#[from] ViewError),
    /// A measurement.
    #[cfg(feature = "quality")]
    Quality(#[from] crate::quality::QualityError),
    /// A file that cannot be read.
    #[cfg(feature = "io")]
    Read(#[from] crate::io::ReadError),
    /// A file that cannot be written.
    #[cfg(feature = "io")]
    Write(#[from] crate::io::WriteError),
    /// A baked file.
    #[cfg(feature = "io")]
    Bake(#[from] crate::io::BakeError),
}
