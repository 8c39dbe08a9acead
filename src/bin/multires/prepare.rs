//! How to prepare a mesh: arguments common to `simplify`, `build` and `remesh`.

use clap::Args;
use multires::mesh::Mesh;

use crate::output::Failure;
use crate::rules::not_negative;

/// Stands for the material ids where attributes are named.
const MATERIAL: &str = "material";

#[derive(Args, Clone)]
pub struct Preparation {
    /// Leave these attributes out, and their seams with them; "material" stands for the material ids.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub drop: Vec<String>,
    /// Snap positions within this distance (object units) of each other together, before anything else.
    #[arg(long, value_name = "D", default_value_t = 0.0, value_parser = not_negative)]
    pub weld: f64,
}

impl Preparation {
    /// Returns the mesh without dropped attributes, near positions snapped.
    pub fn prepared(&self, mesh: Mesh) -> Result<Mesh, Failure> {
        let mesh = self.dropped(mesh)?;
        Ok(if self.weld > 0.0 { mesh.welded(self.weld) } else { mesh })
    }

    /// Returns the mesh without dropped attributes.
    pub fn dropped(&self, mesh: Mesh) -> Result<Mesh, Failure> {
        if self.drop.is_empty() {
            return Ok(mesh);
        }
        let is_dropped = |name: &str| self.drop.iter().any(|d| d == name);
        let there = |name: &String| name == MATERIAL || mesh.attribute(name).is_some();
        if let Some(name) = self.drop.iter().find(|name| !there(name)) {
            return Err(Failure::Input(format!("--drop: the mesh has no attribute named {name:?}")));
        }
        let kept = if is_dropped(MATERIAL) { &[][..] } else { mesh.materials() };
        let mut result = Mesh::new(mesh.positions(), mesh.triangles()).map_err(Failure::input)?;
        result = result.with_origin(mesh.origin()).map_err(Failure::input)?;
        result = result.with_materials(kept).map_err(Failure::input)?;
        result = result.with_locks(mesh.locks()).map_err(Failure::input)?;
        if !kept.is_empty() {
            result = result.with_material_names(mesh.material_names());
        }
        for attribute in mesh.attributes().iter().filter(|a| !is_dropped(a.name())) {
            result = result.with_attribute(attribute.clone()).map_err(Failure::input)?;
        }
        Ok(result)
    }
}
