//! The plain parts of a g-mesh: levels are computed from the finest level's triangles and the targets, so none can disagree.

use crate::mesh::MAX_ELEMENTS;
use crate::sequence::collapse_forest::is_degenerate;

use super::{Gmesh, GmeshError, GmeshLevel};

/// Most triangles of all levels together, per triangle of the finest: a level of 0.9 of the level before it gives 10.
const MOST_SHARE: usize = 12;
/// Limit for small meshes.
const FEW: usize = 4096;
/// Most starts of levels in groups, per triangle of the finest level, and for small meshes.
const MOST_STARTS: usize = 64;
const FEW_STARTS: usize = 1 << 16;

/// The arrays of a [`Gmesh`], for file formats of your own. The triangles of coarser levels follow from the finest level and
/// the targets.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GmeshParts {
    /// Vertices of each level, finest first: a prefix of all vertices. Never rising.
    pub level_vertices: Vec<u32>,
    /// Error bound of each level, object units. Never falling.
    pub level_errors: Vec<f32>,
    /// Enclosed volume of each level, cubic object units; NaN where there is none.
    pub level_volumes: Vec<f64>,
    /// Per vertex the vertex to which it moves in the last level that draws it, which this level draws too; itself for
    /// vertices of the coarsest level.
    pub targets: Vec<u32>,
    /// Corners of the finest level, by ascending material.
    pub triangles: Vec<[u32; 3]>,
    /// End of every material's triangles; one entry without materials.
    pub group_ends: Vec<u32>,
    /// The material ids in use, ascending; empty without materials.
    pub material_ids: Vec<u32>,
}

impl From<Gmesh> for GmeshParts {
    fn from(gmesh: Gmesh) -> Self {
        let mut finest = Vec::with_capacity(gmesh.levels[0].triangles);
        let mut group_ends = Vec::with_capacity(gmesh.groups());
        for group in 0..gmesh.groups() {
            finest.extend_from_slice(gmesh.triangles(0, group));
            group_ends.push(finest.len() as u32);
        }
        Self {
            level_vertices: gmesh.levels.iter().map(|level| level.vertices as u32).collect(),
            level_errors: gmesh.levels.iter().map(|level| level.error).collect(),
            level_volumes: gmesh.levels.iter().map(|level| level.volume.unwrap_or(f64::NAN)).collect(),
            targets: gmesh.targets,
            triangles: finest,
            group_ends,
            material_ids: gmesh.material_ids,
        }
    }
}

impl TryFrom<GmeshParts> for Gmesh {
    type Error = GmeshError;

    /// Checks every promise and makes the triangles of all levels. O(output).
    fn try_from(parts: GmeshParts) -> Result<Self, GmeshError> {
        parts.check_levels()?;
        parts.check_targets()?;
        parts.check_triangles()?;
        let (triangles, starts) = parts.all_levels()?;
        let GmeshParts { level_vertices, level_errors, level_volumes, targets, material_ids, .. } = parts;
        let count = level_vertices.len();
        let drawn = |level: usize| -> usize {
            let of_group =
                |group: usize| (starts[group * count + level + 1] - starts[group * count + level]) as usize;
            (0..material_ids.len().max(1)).map(of_group).sum()
        };
        let levels = level_vertices.iter().zip(&level_errors).zip(&level_volumes).enumerate();
        let levels = levels.map(|(level, ((&vertices, &error), &volume))| GmeshLevel {
            vertices: vertices as usize,
            triangles: drawn(level),
            error,
            volume: volume.is_finite().then_some(volume),
        });
        let levels = levels.collect();
        Ok(Self { levels, targets, triangles, starts, material_ids })
    }
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), GmeshError> {
    if found == expected { Ok(()) } else { Err(GmeshError::Length { what, found, expected }) }
}

fn limit(what: &'static str, found: usize) -> Result<(), GmeshError> {
    if found <= MAX_ELEMENTS {
        Ok(())
    } else {
        Err(GmeshError::Length { what, found, expected: MAX_ELEMENTS })
    }
}

impl GmeshParts {
    fn check_levels(&self) -> Result<(), GmeshError> {
        limit("vertices", self.targets.len())?;
        limit("triangles", self.triangles.len())?;
        let count = self.level_vertices.len();
        expect("levels", count, count.max(1))?;
        expect("errors of levels", self.level_errors.len(), count)?;
        expect("volumes of levels", self.level_volumes.len(), count)?;
        expect("vertices of the finest level", self.level_vertices[0] as usize, self.targets.len())?;
        let is_error = |error: f32| (0.0..f32::INFINITY).contains(&error);
        for level in 0..count {
            let falls = level > 0 && self.level_errors[level] < self.level_errors[level - 1];
            let grows = level > 0 && self.level_vertices[level] > self.level_vertices[level - 1];
            if falls || grows || !is_error(self.level_errors[level]) {
                return Err(GmeshError::Level { level });
            }
        }
        Ok(())
    }

    fn check_targets(&self) -> Result<(), GmeshError> {
        let coarsest = self.level_vertices.last().map_or(0, |&n| n as usize);
        for (vertex, &target) in self.targets[..coarsest].iter().enumerate() {
            if target as usize != vertex {
                return Err(GmeshError::Target { vertex, target });
            }
        }
        for ends in self.level_vertices.windows(2) {
            for vertex in ends[1] as usize..ends[0] as usize {
                let target = self.targets[vertex];
                if target >= ends[0] {
                    return Err(GmeshError::Target { vertex, target });
                }
            }
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<(), GmeshError> {
        let vertices = self.targets.len();
        let is_legal = |t: &[u32; 3]| !is_degenerate(*t) && t.iter().all(|&v| (v as usize) < vertices);
        if let Some(triangle) = self.triangles.iter().position(|t| !is_legal(t)) {
            return Err(GmeshError::Triangle { triangle });
        }
        if let Some(group) = self.material_ids.windows(2).position(|ids| ids[0] >= ids[1]) {
            return Err(GmeshError::Group { group: group + 1 });
        }
        expect("groups", self.group_ends.len(), self.material_ids.len().max(1))?;
        if let Some(group) = self.group_ends.windows(2).position(|ends| ends[0] > ends[1]) {
            return Err(GmeshError::Group { group: group + 1 });
        }
        let starts = self.group_ends.len().saturating_mul(self.level_vertices.len());
        let most = MOST_STARTS.saturating_mul(self.triangles.len()).max(FEW_STARTS);
        if starts > most {
            return Err(GmeshError::Length { what: "levels of groups", found: starts, expected: most });
        }
        expect(
            "triangles in groups",
            self.group_ends.last().map_or(0, |&end| end as usize),
            self.triangles.len(),
        )
    }

    /// Makes the triangles of all levels, group by group, and their starts: the triangles of a level are the images of the
    /// triangles of the level before it, without those with two equal corners.
    fn all_levels(&self) -> Result<(Vec<[u32; 3]>, Vec<u32>), GmeshError> {
        let most = (MOST_SHARE * self.triangles.len() + FEW).min(MAX_ELEMENTS);
        let mut triangles = Vec::with_capacity(self.triangles.len() * 2);
        let mut starts = Vec::with_capacity(self.group_ends.len() * self.level_vertices.len() + 1);
        let mut first = 0;
        for &end in &self.group_ends {
            starts.push(triangles.len() as u32);
            triangles.extend_from_slice(&self.triangles[first..end as usize]);
            first = end as usize;
            let mut start = starts[starts.len() - 1] as usize;
            for (level, vertices) in self.level_vertices.iter().enumerate().skip(1) {
                let before = start..triangles.len();
                start = triangles.len();
                starts.push(start as u32);
                for at in before {
                    let image =
                        triangles[at].map(|v: u32| if v >= *vertices { self.targets[v as usize] } else { v });
                    if !is_degenerate(image) {
                        triangles.push(image);
                    }
                }
                if triangles.len() > most {
                    return Err(GmeshError::TooLittle { level, triangles: triangles.len() });
                }
                if let Some(at) = triangles[start..].iter().position(|t| t.iter().any(|v| v >= vertices)) {
                    // A target that only vanishing triangles may use.
                    let corner =
                        triangles[start + at].into_iter().find(|v| v >= vertices).unwrap_or_default();
                    return Err(GmeshError::Target { vertex: corner as usize, target: corner });
                }
            }
        }
        starts.push(triangles.len() as u32);
        Ok((triangles, starts))
    }
}
