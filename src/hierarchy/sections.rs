//! Vertex hierarchies in the sections of a baked file.

use serde::{Deserialize, Serialize};

use crate::geometry::array::Array;
use crate::geometry::lists::Lists;
use crate::sections::{BakeError, Element, Reader, Sections, Writer};
use crate::view::Bounds;

use super::{Dependencies, VertexHierarchy};

impl Element for Bounds {
    const SCALARS: &'static [u8] = &[4, 4, 4, 4, 4, 4, 1, 1, 1, 1];
}

/// Section `hierarchy`.
#[derive(Serialize, Deserialize)]
struct Head {
    dependency_kind: Dependencies,
    diagonal: f64,
}

impl Sections for VertexHierarchy {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        to.meta("hierarchy", &Head { dependency_kind: self.dependency_kind, diagonal: self.diagonal })?;
        to.array("substitute", &self.substitute);
        to.array_if_any("first_leaf", &self.first_leaf);
        to.array("brings.at", &self.brings.start);
        to.array("brings", &self.brings.items);
        to.array_if_any("dependencies.at", &self.dependencies.start);
        to.array_if_any("dependencies", &self.dependencies.items);
        to.array("bounds", &self.bounds);
        to.array("triangles", &self.triangles);
        to.array("first_triangle", &self.first_triangle);
        to.array_if_any("group_of", &self.group_of);
        to.array_if_any("materials", &self.materials);
        if to.writes_derived() {
            to.array("split_of", &self.split_of);
            to.array("parents.at", &self.parents.start);
            to.array("parents", &self.parents.items);
            to.array("children.at", &self.children.start);
            to.array("children", &self.children.items);
            to.array("roots", &self.roots);
            to.array_if_any("jump", &self.jump);
        }
        Ok(())
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let Head { dependency_kind, diagonal } = from.meta("hierarchy")?;
        let (substitute, first_leaf) = (from.array("substitute")?, from.array_if_any("first_leaf")?);
        let leaves =
            substitute.len().checked_sub(first_leaf.len()).and_then(|count| u32::try_from(count).ok());
        let mut hierarchy = Self {
            leaves: leaves.ok_or_else(|| BakeError::damaged("the number of leaves is none"))?,
            substitute,
            split_of: Array::default(),
            first_leaf,
            brings: Lists { start: from.array("brings.at")?, items: from.array("brings")? },
            parents: Lists::default(),
            children: Lists::default(),
            dependencies: Lists {
                start: from.array_if_any("dependencies.at")?,
                items: from.array_if_any("dependencies")?,
            },
            dependency_kind,
            bounds: from.array("bounds")?,
            roots: Array::default(),
            triangles: from.array("triangles")?,
            first_triangle: from.array("first_triangle")?,
            group_of: from.array_if_any("group_of")?,
            materials: from.array_if_any("materials")?,
            diagonal,
            jump: Array::default(),
        };
        if !from.has("split_of") {
            // Deriving needs valid arrays, so trust saves nothing.
            hierarchy.complete().map_err(BakeError::damaged)?;
            return Ok(hierarchy);
        }
        hierarchy.split_of = from.array("split_of")?;
        hierarchy.parents = Lists { start: from.array("parents.at")?, items: from.array("parents")? };
        hierarchy.children = Lists { start: from.array("children.at")?, items: from.array("children")? };
        hierarchy.roots = from.array("roots")?;
        hierarchy.jump = from.array_if_any("jump")?;
        let checked = if from.is_trusted() { hierarchy.check_lengths() } else { hierarchy.validate() };
        checked.map_err(BakeError::damaged)?;
        Ok(hierarchy)
    }
}
