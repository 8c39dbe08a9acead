//! Why a mesh could not be remeshed.

use crate::error::MeshError;
use crate::simplify::OptionError;
use crate::wavelet::WaveletError;

/// Why a mesh could not be remeshed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RemeshError {
    /// The mesh has no triangles with three different points.
    #[error("the mesh has no triangles")]
    Empty,
    /// An option outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// A collapse could not be mapped. Does not happen with the rules of a remesher.
    #[error("collapse {step} has no map between the triangles before and after it")]
    Unmapped {
        /// The collapse.
        step: usize,
    },
    /// The mesh lacks values to bake.
    #[error("the mesh has no attribute {name:?} of {width} floats")]
    NoAttribute {
        /// The attribute's name.
        name: &'static str,
        /// Floats a vertex.
        width: usize,
    },
    /// The wavelet mesh could not be built.
    #[error(transparent)]
    Wavelet(WaveletError),
    /// The input is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The progress callback cancelled the run.
    #[error("remeshing was cancelled")]
    Cancelled,
}

impl From<WaveletError> for RemeshError {
    fn from(error: WaveletError) -> Self {
        match error {
            WaveletError::Cancelled => Self::Cancelled,
            error => Self::Wavelet(error),
        }
    }
}
