//! Which faces to split.

use crate::mesh::Mesh;
use crate::wavelet::{DomainPoint, WaveletBuilder};

use super::{Parameterisation, RemeshError};

/// How deep a base is subdivided.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Depth {
    /// Every base face is split this many times.
    Levels(usize),
}

impl Depth {
    pub(super) fn subdivide(
        self,
        _map: &Parameterisation,
        _mesh: &Mesh,
        builder: &mut WaveletBuilder,
        place: impl Fn(&DomainPoint) -> [f32; 3],
    ) -> Result<(), RemeshError> {
        match self {
            Self::Levels(levels) => {
                for _ in 0..levels {
                    builder.subdivide(|midpoint| place(&midpoint.domain))?;
                }
            }
        }
        Ok(())
    }
}
