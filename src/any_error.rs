//! One error for whoever need not tell the rooms apart: every error of the crate becomes it by `?`.

use crate::error::MeshError;
use crate::hierarchy::HierarchyError;
use crate::lod::LodError;
use crate::simplify::{OptionError, ProgressiveError, SequenceError};
use crate::tom::TomError;
use crate::view::ViewError;
use crate::wavelet::WaveletError;

/// Whatever went wrong anywhere in this crate. Its message is that of the error inside.
///
/// ```
/// use multires::prelude::*;
/// use multires::{Mesh, mesh::shapes};
///
/// fn instance(mesh: &Mesh) -> Result<impl Lod, multires::Error> {
///     let model = VertexHierarchy::bake(mesh)?; // a mesh that is too large
///     let values = model.arrange(mesh.positions())?; // values of another mesh
///     Ok(model.instance(values, &LodOptions::default())?) // options that make no sense
/// }
/// assert!(instance(&shapes::demo())?.triangles(0).len() > 3);
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
    /// An instance.
    Lod(#[from] LodError),
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

impl Error {
    /// Whether a build ended because whoever was told of its progress said so.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Tom(TomError::Cancelled)
                | Self::Hierarchy(HierarchyError::Cancelled)
                | Self::Wavelet(WaveletError::Cancelled)
        )
    }
}
