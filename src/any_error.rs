//! A single error type for the whole crate: every other error converts to it by `?`.

use crate::control::ControlError;
use crate::error::MeshError;
use crate::gmesh::{GmeshError, PartitionError};
use crate::hierarchy::HierarchyError;
use crate::lod::LodError;
use crate::progressive::ProgressiveError;
use crate::remesh::RemeshError;
use crate::sequence::SequenceError;
use crate::simplify::OptionError;
use crate::tom::TomError;
use crate::view::ViewError;
use crate::wavelet::WaveletError;

/// Any error of this crate. Displays the message of the error inside.
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
    /// Arrays do not make a mesh.
    Mesh(#[from] MeshError),
    /// Options of a simplification make no sense.
    Options(#[from] OptionError),
    /// A collapse sequence does not hold together.
    Sequence(#[from] SequenceError),
    /// A progressive mesh does not hold together.
    Progressive(#[from] ProgressiveError),
    /// An error of a totally ordered mesh.
    Tom(#[from] TomError),
    /// An error of a g-mesh.
    Gmesh(#[from] GmeshError),
    /// Lengths do not make a partition.
    Partition(#[from] PartitionError),
    /// An error of a vertex hierarchy.
    Hierarchy(#[from] HierarchyError),
    /// An error of a wavelet mesh.
    Wavelet(#[from] WaveletError),
    /// An error of a remeshing.
    Remesh(#[from] RemeshError),
    /// An error of an instance.
    Lod(#[from] LodError),
    /// An error of a view.
    View(#[from] ViewError),
    /// An error of a controller.
    Control(#[from] ControlError),
    /// An error of a stream.
    #[cfg(feature = "stream")]
    Stream(#[from] crate::stream::StreamError),
    /// An error of a store.
    #[cfg(all(feature = "stream", feature = "io"))]
    Store(#[from] crate::stream::store::StoreError),
    /// An error of a measurement.
    #[cfg(feature = "quality")]
    Quality(#[from] crate::quality::QualityError),
    /// A file cannot be read.
    #[cfg(feature = "io")]
    Read(#[from] crate::io::ReadError),
    /// A file cannot be written.
    #[cfg(feature = "io")]
    Write(#[from] crate::io::WriteError),
    /// An error of a baked file.
    #[cfg(feature = "io")]
    Bake(#[from] crate::io::BakeError),
}

impl Error {
    /// Holds if a build ended because its progress callback asked to stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Tom(TomError::Cancelled)
                | Self::Gmesh(GmeshError::Cancelled)
                | Self::Hierarchy(HierarchyError::Cancelled)
                | Self::Wavelet(WaveletError::Cancelled)
                | Self::Remesh(RemeshError::Cancelled | RemeshError::Wavelet(WaveletError::Cancelled))
        )
    }
}
