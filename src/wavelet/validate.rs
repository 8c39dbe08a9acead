//! What comes out of a file, checked as a whole.

use crate::mesh::Mesh;

use super::bounds::Packed;
use super::{Subdivision, WaveletError, WaveletMesh, WaveletOptions};

/// The fields of a [`WaveletMesh`].
#[derive(serde::Deserialize)]
pub(super) struct Parts {
    subdivision: Subdivision,
    vertices: Mesh,
    materials: Vec<u32>,
    group_of: Vec<u16>,
    bounds: Vec<Packed>,
    options: WaveletOptions,
    diagonal: f64,
}

impl TryFrom<Parts> for WaveletMesh {
    type Error = WaveletError;

    fn try_from(parts: Parts) -> Result<Self, WaveletError> {
        let Parts { subdivision, vertices, materials, group_of, bounds, options, diagonal } = parts;
        let extent = None;
        let mut mesh = Self { subdivision, vertices, materials, group_of, bounds, options, diagonal, extent };
        mesh.measure();
        Ok(mesh)
    }
}
