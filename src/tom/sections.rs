//! Totally ordered meshes in the sections of a baked file.

use crate::sections::{BakeError, Element, Reader, Sections, Writer};

use super::{ErrorMark, TotallyOrderedMesh};

impl Element for ErrorMark {
    const SCALARS: &'static [u8] = &[4, 4];
}

impl Sections for TotallyOrderedMesh {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        to.meta("tom", &self.base_vertices)?;
        to.array("substitute", &self.substitute);
        to.array_if_any("joined", &self.joined);
        to.array("triangles", &self.triangles);
        to.array("error_marks", &self.error_marks);
        to.array_if_any("material_of", &self.material_of);
        to.array_if_any("materials", &self.material_ids);
        Ok(())
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let tom = Self {
            base_vertices: from.meta("tom")?,
            substitute: from.array("substitute")?,
            joined: from.array_if_any("joined")?,
            triangles: from.array("triangles")?,
            error_marks: from.array("error_marks")?,
            material_of: from.array_if_any("material_of")?,
            material_ids: from.array_if_any("materials")?,
        };
        let checked = if from.is_trusted() { tom.validate_lengths() } else { tom.validate() };
        checked.map_err(BakeError::damaged)?;
        Ok(tom)
    }
}
