//! G-meshes in the sections of a baked file: all levels, or the finest and the targets.

use serde::{Deserialize, Serialize};

use crate::sections::{BakeError, Reader, Sections, Writer};

use super::parts::Seeds;
use super::{Gmesh, GmeshParts};

/// Section `gmesh`.
#[derive(Serialize, Deserialize)]
struct Head {
    level_vertices: Vec<u32>,
    level_errors: Vec<f32>,
    level_volumes: Vec<f64>,
}

impl Sections for Gmesh {
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError> {
        let levels = self.levels.iter();
        let head = Head {
            level_vertices: levels.clone().map(|level| level.vertices as u32).collect(),
            level_errors: levels.clone().map(|level| level.error).collect(),
            level_volumes: levels.map(|level| level.volume.unwrap_or(f64::NAN)).collect(),
        };
        to.meta("gmesh", &head)?;
        to.array("targets", &self.targets);
        to.array_if_any("materials", &self.material_ids);
        if to.writes_derived() {
            to.array("triangles", &self.triangles);
            to.array("starts", &self.starts);
        } else {
            let (finest, ends) = self.finest();
            to.array("finest", &finest);
            to.array("group_ends", &ends);
        }
        Ok(())
    }

    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError> {
        let Head { level_vertices, level_errors, level_volumes } = from.meta("gmesh")?;
        let (targets, material_ids) = (from.array("targets")?, from.array_if_any("materials")?);
        if !from.has("starts") {
            let parts = GmeshParts {
                level_vertices,
                level_errors,
                level_volumes,
                targets: targets.into_vec(),
                triangles: from.array("finest")?.into_vec(),
                group_ends: from.array("group_ends")?.into_vec(),
                material_ids: material_ids.into_vec(),
            };
            return Self::try_from(parts).map_err(BakeError::damaged);
        }
        let seeds = Seeds {
            level_vertices: &level_vertices,
            level_errors: &level_errors,
            level_volumes: &level_volumes,
            targets: &targets,
            material_ids: &material_ids,
        };
        let (triangles, starts) = (from.array("triangles")?, from.array("starts")?);
        seeds.check_levels().map_err(BakeError::damaged)?;
        seeds.check_starts(&starts, triangles.len()).map_err(BakeError::damaged)?;
        if !from.is_trusted() {
            seeds.check_targets().map_err(BakeError::damaged)?;
            seeds.check_all(&triangles, &starts).map_err(BakeError::damaged)?;
        }
        let levels = seeds.levels(&starts);
        Ok(Self { levels, targets, triangles, starts, material_ids })
    }
}
