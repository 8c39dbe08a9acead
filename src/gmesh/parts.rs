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
        let (triangles, group_ends) = gmesh.finest();
        Self {
            level_vertices: gmesh.levels.iter().map(|level| level.vertices as u32).collect(),
            level_errors: gmesh.levels.iter().map(|level| level.error).collect(),
            level_volumes: gmesh.levels.iter().map(|level| level.volume.unwrap_or(f64::NAN)).collect(),
            targets: gmesh.targets.into_vec(),
            triangles,
            group_ends,
            material_ids: gmesh.material_ids.into_vec(),
        }
    }
}

impl TryFrom<GmeshParts> for Gmesh {
    type Error = GmeshError;

    /// Checks every promise and makes the triangles of all levels. O(output).
    fn try_from(parts: GmeshParts) -> Result<Self, GmeshError> {
        let seeds = Seeds {
            level_vertices: &parts.level_vertices,
            level_errors: &parts.level_errors,
            level_volumes: &parts.level_volumes,
            targets: &parts.targets,
            material_ids: &parts.material_ids,
        };
        seeds.check_levels()?;
        seeds.check_targets()?;
        seeds.check_finest(&parts.triangles)?;
        seeds.check_groups(&parts.group_ends, parts.triangles.len())?;
        let (triangles, starts) = seeds.all_levels(&parts.triangles, &parts.group_ends)?;
        let levels = seeds.levels(&starts);
        Ok(Self {
            levels,
            targets: parts.targets.into(),
            triangles: triangles.into(),
            starts: starts.into(),
            material_ids: parts.material_ids.into(),
        })
    }
}

impl Gmesh {
    /// Returns the triangles of the finest level, by ascending material, and the end of every material's.
    pub(super) fn finest(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut finest = Vec::with_capacity(self.levels[0].triangles);
        let mut ends = Vec::with_capacity(self.groups());
        for group in 0..self.groups() {
            finest.extend_from_slice(self.triangles(0, group));
            ends.push(finest.len() as u32);
        }
        (finest, ends)
    }
}

/// What a g-mesh is made of besides the triangles of its finest level.
#[derive(Clone, Copy)]
pub(super) struct Seeds<'a> {
    pub level_vertices: &'a [u32],
    pub level_errors: &'a [f32],
    pub level_volumes: &'a [f64],
    pub targets: &'a [u32],
    pub material_ids: &'a [u32],
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

impl Seeds<'_> {
    fn groups(&self) -> usize {
        self.material_ids.len().max(1)
    }

    /// Returns the levels of triangles with these starts.
    pub fn levels(&self, starts: &[u32]) -> Vec<GmeshLevel> {
        let count = self.level_vertices.len();
        let of_group = |at: usize| (starts[at + 1] - starts[at]) as usize;
        let level = |level: usize| GmeshLevel {
            vertices: self.level_vertices[level] as usize,
            triangles: (0..self.groups()).map(|group| of_group(group * count + level)).sum(),
            error: self.level_errors[level],
            volume: self.level_volumes[level].is_finite().then_some(self.level_volumes[level]),
        };
        (0..count).map(level).collect()
    }

    /// Checks levels and the order of materials.
    pub fn check_levels(&self) -> Result<(), GmeshError> {
        limit("vertices", self.targets.len())?;
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

    /// Checks that every vertex moves to one that its last level draws.
    pub fn check_targets(&self) -> Result<(), GmeshError> {
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

    /// Checks triangles of the finest level.
    fn check_finest(&self, triangles: &[[u32; 3]]) -> Result<(), GmeshError> {
        limit("triangles", triangles.len())?;
        let vertices = self.targets.len();
        let is_legal = |t: &[u32; 3]| !is_degenerate(*t) && t.iter().all(|&v| (v as usize) < vertices);
        match triangles.iter().position(|t| !is_legal(t)) {
            Some(triangle) => Err(GmeshError::Triangle { triangle }),
            None => Ok(()),
        }
    }

    /// Checks the ends of the materials' triangles in the finest level.
    fn check_groups(&self, group_ends: &[u32], triangles: usize) -> Result<(), GmeshError> {
        if let Some(group) = self.material_ids.windows(2).position(|ids| ids[0] >= ids[1]) {
            return Err(GmeshError::Group { group: group + 1 });
        }
        expect("groups", group_ends.len(), self.groups())?;
        if let Some(group) = group_ends.windows(2).position(|ends| ends[0] > ends[1]) {
            return Err(GmeshError::Group { group: group + 1 });
        }
        self.check_number_of_starts(triangles)?;
        expect("triangles in groups", group_ends.last().map_or(0, |&end| end as usize), triangles)
    }

    /// Checks that levels of groups are not out of all proportion to the triangles of the finest level.
    fn check_number_of_starts(&self, triangles: usize) -> Result<(), GmeshError> {
        let starts = self.groups().saturating_mul(self.level_vertices.len());
        let most = MOST_STARTS.saturating_mul(triangles).max(FEW_STARTS);
        if starts > most {
            return Err(GmeshError::Length { what: "levels of groups", found: starts, expected: most });
        }
        Ok(())
    }

    /// Checks starts of levels in groups: as many as needed, and ascending to the number of triangles.
    #[cfg(feature = "io")]
    pub fn check_starts(&self, starts: &[u32], triangles: usize) -> Result<(), GmeshError> {
        let expected = self.groups().saturating_mul(self.level_vertices.len()).saturating_add(1);
        expect("starts of levels", starts.len(), expected)?;
        if let Some(at) = starts.windows(2).position(|pair| pair[0] > pair[1]) {
            return Err(GmeshError::Level { level: at % self.level_vertices.len() });
        }
        expect("triangles before the first level", starts[0] as usize, 0)?;
        expect("triangles of levels", starts[expected - 1] as usize, triangles)
    }

    /// Checks the triangles of all levels against the finest. O(triangles), without a copy.
    #[cfg(feature = "io")]
    pub fn check_all(&self, triangles: &[[u32; 3]], starts: &[u32]) -> Result<(), GmeshError> {
        if let Some(group) = self.material_ids.windows(2).position(|ids| ids[0] >= ids[1]) {
            return Err(GmeshError::Group { group: group + 1 });
        }
        let count = self.level_vertices.len();
        let level_of = |group: usize, level: usize| {
            let [start, end] = [0, 1].map(|next| starts[group * count + level + next] as usize);
            &triangles[start..end]
        };
        let finest: usize = (0..self.groups()).map(|group| level_of(group, 0).len()).sum();
        self.check_number_of_starts(finest)?;
        let most = (MOST_SHARE * finest + FEW).min(MAX_ELEMENTS);
        if triangles.len() > most {
            return Err(GmeshError::TooLittle { level: count - 1, triangles: triangles.len() });
        }
        for group in 0..self.groups() {
            self.check_finest(level_of(group, 0))?;
            for level in 1..count {
                let images = level_of(group, level - 1).iter().filter_map(|&t| self.image(t, level));
                let own = level_of(group, level).iter();
                if !own.clone().copied().eq(images) {
                    return Err(GmeshError::Level { level });
                }
                if let Some(&vertex) = own.flatten().find(|&&v| v >= self.level_vertices[level]) {
                    return Err(GmeshError::Target { vertex: vertex as usize, target: vertex });
                }
            }
        }
        Ok(())
    }

    /// Returns the image of a triangle in a level, of the level before it; `None` if two corners are equal.
    fn image(&self, triangle: [u32; 3], level: usize) -> Option<[u32; 3]> {
        let end = self.level_vertices[level];
        let image = triangle.map(|v| if v >= end { self.targets[v as usize] } else { v });
        (!is_degenerate(image)).then_some(image)
    }

    /// Makes the triangles of all levels, group by group, and their starts: the triangles of a level are the images of the
    /// triangles of the level before it, without those with two equal corners.
    fn all_levels(
        &self,
        finest: &[[u32; 3]],
        group_ends: &[u32],
    ) -> Result<(Vec<[u32; 3]>, Vec<u32>), GmeshError> {
        let most = (MOST_SHARE * finest.len() + FEW).min(MAX_ELEMENTS);
        let mut triangles = Vec::with_capacity(finest.len() * 2);
        let mut starts = Vec::with_capacity(group_ends.len() * self.level_vertices.len() + 1);
        let mut first = 0;
        for &end in group_ends {
            starts.push(triangles.len() as u32);
            triangles.extend_from_slice(&finest[first..end as usize]);
            first = end as usize;
            let mut start = starts[starts.len() - 1] as usize;
            for (level, vertices) in self.level_vertices.iter().enumerate().skip(1) {
                let before = start..triangles.len();
                start = triangles.len();
                starts.push(start as u32);
                for at in before {
                    triangles.extend(self.image(triangles[at], level));
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
