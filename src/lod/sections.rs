//! Baked models in the sections of a file: the structure's, the vertices', and their origins.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::mesh::Mesh;
use crate::sections::{BakeError, Element, Reader, Sections, Writer};

use super::{Baked, Mixture, Origins, Structure};

impl Element for Mixture {
    const SCALARS: &'static [u8] = &[4, 4, 4];
}

/// A structure whose arrays lie in the sections of a baked file. Implemented by every structure of this crate. A structure
/// of your own goes through serde: [`io::bake`](crate::io::bake).
pub trait Stored: Structure + Sections + Serialize + DeserializeOwned {}

impl<S: Structure + Sections + Serialize + DeserializeOwned> Stored for S {}

impl<S: Stored> Sections for Baked<S> {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        self.structure().write_sections(to)?;
        if self.structure().own_vertices().is_none() {
            self.vertices().write_vertices(to)?;
        }
        self.origins().write_sections(to)
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let structure = S::read_sections(from)?;
        let vertices = match structure.own_vertices() {
            Some(_) => None,
            None => Some(Mesh::read_vertices(from)?),
        };
        let origins = Origins::read_sections(from)?;
        Self::checked(structure, vertices, origins).map_err(BakeError::damaged)
    }
}

impl Sections for Origins {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        to.meta("origins", &self.input_vertices)?;
        to.array("order", &self.order);
        to.array_if_any("mixtures", &self.mixtures);
        to.array_if_any("snapped", &self.snapped);
        to.array_if_any("folded", &self.folded);
        Ok(())
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let origins = Self {
            input_vertices: from.meta("origins")?,
            order: from.array("order")?,
            mixtures: from.array_if_any("mixtures")?,
            snapped: from.array_if_any("snapped")?,
            folded: from.array_if_any("folded")?,
        };
        if !from.is_trusted() {
            origins.validate().map_err(BakeError::damaged)?;
        }
        Ok(origins)
    }
}
