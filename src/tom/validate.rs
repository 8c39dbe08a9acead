//! Checks for every promise of a totally ordered mesh, and conversion from and to its plain parts.

use crate::geometry::parallel;
use crate::mesh::MAX_ELEMENTS;
use crate::sequence::collapse_forest::{Forest, is_degenerate};

use super::{ErrorMark, TomError, TotallyOrderedMesh};

/// The arrays of a [`TotallyOrderedMesh`], for file formats of your own.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TomParts {
    /// Earlier vertex that replaces each vertex. Base vertices come first and name themselves.
    pub substitute: Vec<u32>,
    /// 1 bit a vertex, 64 a word, lowest first: set if a single step removes it together with the vertex before it.
    /// Unset for base vertices and the vertex after them. Empty if no bit is set.
    pub joined: Vec<u64>,
    /// Number of base vertices.
    pub base_vertices: u32,
    /// Corners at full resolution, sorted by the group with which the triangle vanishes, base triangles first.
    pub triangles: Vec<[u32; 3]>,
    /// Error bounds at some resolutions, see [`TotallyOrderedMesh::error_marks`].
    pub error_marks: Vec<ErrorMark>,
    /// Per triangle an index into `material_ids`; empty with fewer than 2 materials.
    pub material_of: Vec<u32>,
    /// The material ids in use, ascending.
    pub material_ids: Vec<u32>,
}

impl From<TotallyOrderedMesh> for TomParts {
    fn from(tom: TotallyOrderedMesh) -> Self {
        let TotallyOrderedMesh {
            substitute,
            joined,
            base_vertices,
            triangles,
            error_marks,
            material_of,
            material_ids,
        } = tom;
        Self {
            substitute: substitute.into_vec(),
            joined: joined.into_vec(),
            base_vertices,
            triangles: triangles.into_vec(),
            error_marks: error_marks.into_vec(),
            material_of: material_of.into_vec(),
            material_ids: material_ids.into_vec(),
        }
    }
}

impl TryFrom<TomParts> for TotallyOrderedMesh {
    type Error = TomError;

    fn try_from(parts: TomParts) -> Result<Self, TomError> {
        let TomParts { substitute, joined, base_vertices, triangles, error_marks, material_of, material_ids } =
            parts;
        let tom = Self {
            substitute: substitute.into(),
            joined: joined.into(),
            base_vertices,
            triangles: triangles.into(),
            error_marks: error_marks.into(),
            material_of: material_of.into(),
            material_ids: material_ids.into(),
        };
        tom.validate()?;
        Ok(tom)
    }
}

impl TotallyOrderedMesh {
    /// Proves the promises behind every other call: substitutes come before the vertices they replace, groups are
    /// marked, triangles exist, have three corners and vanish in order, and error bounds fall. Vanished triangles stay
    /// vanished, because equal corners have equal substitutes. O((vertices + triangles) log vertices).
    ///
    /// Holds for every output of [`TotallyOrderedMesh::build`]. Parts and files are let in only through this check.
    ///
    /// # Errors
    /// Names the first element to break a promise.
    pub fn validate(&self) -> Result<(), TomError> {
        self.validate_lengths()?;
        self.validate_substitutes()?;
        self.validate_triangles()?;
        self.validate_error_marks()?;
        self.validate_materials()
    }

    /// Checks the lengths of all arrays: what a trusted file must have.
    pub(super) fn validate_lengths(&self) -> Result<(), TomError> {
        let limit = |what, found, expected| {
            if found <= expected { Ok(()) } else { Err(TomError::Length { what, found, expected }) }
        };
        limit("vertices", self.substitute.len(), MAX_ELEMENTS)?;
        limit("triangles", self.triangles.len(), MAX_ELEMENTS)?;
        limit("base vertices", self.base_vertices as usize, self.substitute.len())?;
        let expected = if self.joined.is_empty() { 0 } else { self.substitute.len().div_ceil(64) };
        if self.joined.len() != expected {
            return Err(TomError::Length { what: "group words", found: self.joined.len(), expected });
        }
        let expected = if self.material_ids.len() > 1 { self.triangles.len() } else { 0 };
        if self.material_of.len() != expected {
            let (what, found) = ("triangle materials", self.material_of.len());
            return Err(TomError::Length { what, found, expected });
        }
        Ok(())
    }

    fn validate_substitutes(&self) -> Result<(), TomError> {
        let base = self.base_vertices as usize;
        for (vertex, &entry) in self.substitute.iter().enumerate() {
            if vertex < base {
                if entry as usize != vertex {
                    return Err(TomError::BaseSubstitute { vertex });
                }
            } else if entry as usize >= vertex {
                return Err(TomError::LateSubstitute { vertex, substitute: entry });
            }
        }
        let inside = base + 1..self.substitute.len();
        let stray = (0..64 * self.joined.len()).find(|&v| self.is_joined(v as u32) && !inside.contains(&v));
        stray.map_or(Ok(()), |vertex| Err(TomError::Group { vertex }))
    }

    fn validate_triangles(&self) -> Result<(), TomError> {
        let vertices = self.substitute.len();
        let forest = Forest::new(self.substitute.to_vec());
        let mut group = 0;
        let groups = (0..vertices as u32).map(|v| {
            group += u32::from(v >= self.base_vertices && !self.is_joined(v));
            group
        });
        let group_of: Vec<u32> = groups.collect();
        // Groups count from 1; a base triangle vanishes with none. The walks take nearly all of the time.
        let end = |triangle: usize| {
            let corners = self.triangles[triangle];
            let is_legal = corners.iter().all(|&v| (v as usize) < vertices) && !is_degenerate(corners);
            if is_legal { forest.vanishes(corners).map_or(0, |v| group_of[v as usize]) } else { 0 }
        };
        let ends = parallel::map(self.triangles.len(), 1024, end);
        let mut latest = 0;
        for (triangle, &corners) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(TomError::Corner { triangle, vertex, vertices });
            }
            if is_degenerate(corners) {
                return Err(TomError::Degenerate { triangle });
            }
            if ends[triangle] < latest {
                return Err(TomError::TriangleOrder { triangle });
            }
            latest = ends[triangle];
        }
        Ok(())
    }

    fn validate_error_marks(&self) -> Result<(), TomError> {
        let starts = match self.error_marks.first() {
            Some(mark) => mark.vertices == self.base_vertices,
            None => self.substitute.is_empty(),
        };
        if !starts {
            return Err(TomError::ErrorMark { mark: 0 });
        }
        let (mut above, mut error) = (None, f32::INFINITY);
        for (mark, entry) in self.error_marks.iter().enumerate() {
            let ascends = above.is_none_or(|above| entry.vertices > above);
            let falls = entry.error >= 0.0 && entry.error <= error;
            if !(ascends && falls && self.is_boundary(entry.vertices)) {
                return Err(TomError::ErrorMark { mark });
            }
            (above, error) = (Some(entry.vertices), entry.error);
        }
        Ok(())
    }

    fn validate_materials(&self) -> Result<(), TomError> {
        if let Some(entry) = self.material_ids.windows(2).position(|w| w[0] >= w[1]) {
            return Err(TomError::Material { entry: entry + 1 });
        }
        match self.material_of.iter().position(|&m| m as usize >= self.material_ids.len()) {
            Some(entry) => Err(TomError::Material { entry }),
            None => Ok(()),
        }
    }
}
