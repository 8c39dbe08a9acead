//! Wavelet meshes in the sections of a baked file: base, splits, seams and values. Connectivity is grown while opening.

use serde::{Deserialize, Serialize};

use crate::mesh::Mesh;
use crate::sections::{BakeError, Element, Reader, Sections, Writer};

use super::parts::{beside, seams, sides, split};
use super::validate::Seeds;
use super::{WaveletBounds, WaveletMesh, WaveletOptions};

impl Element for WaveletBounds {
    const SCALARS: &'static [u8] = &[4, 4, 4, 1, 1, 1, 1];
}

/// Section `wavelet`.
#[derive(Serialize, Deserialize)]
struct Head {
    base_vertices: u32,
    options: WaveletOptions,
}

impl Sections for WaveletMesh {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        let of = &self.subdivision;
        to.meta("wavelet", &Head { base_vertices: of.base_vertices, options: self.options })?;
        to.array("base", &of.base);
        to.array("sides", &sides(of));
        to.array("split", &split(of));
        to.array_if_any("seams", &seams(of));
        to.array_if_any("beside", &beside(of));
        to.array_if_any("materials", &self.materials);
        to.array_if_any("group_of", &self.group_of);
        to.array("bounds", &self.bounds);
        self.vertices.write_vertices(to)
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let Head { base_vertices, options } = from.meta("wavelet")?;
        let vertices = Mesh::read_vertices(from)?;
        let seeds = Seeds {
            base: &from.array("base")?,
            base_vertices,
            sides: &from.array("sides")?,
            split: &from.array("split")?,
            seams: &from.array_if_any("seams")?,
            beside: &from.array_if_any("beside")?,
            vertices: vertices.positions().len(),
        };
        let mut mesh = Self {
            // Growing is how the file is read, so it is checked in any case.
            subdivision: seeds.grow().map_err(BakeError::damaged)?,
            vertices,
            materials: from.array_if_any("materials")?.into_vec(),
            group_of: from.array_if_any("group_of")?,
            bounds: from.array("bounds")?,
            options,
            diagonal: 0.0,
            extent: None,
        };
        mesh.measure();
        let checked = if from.is_trusted() { mesh.check_lengths() } else { mesh.check_values() };
        checked.map_err(BakeError::damaged)?;
        Ok(mesh)
    }
}
