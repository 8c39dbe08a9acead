//! From a level of detail to a resolution.

use crate::lod::Level;

use super::TotallyOrderedMesh;

/// A resolution of a totally ordered mesh: whole groups of vertices, and the triangles spanned by them.
///
/// Belongs to the mesh that returned it. Another mesh takes it without panicking, but may then draw incomplete steps or
/// half of a seam.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Resolution {
    pub(super) vertices: u32,
    pub(super) triangles: u32,
    pub(super) error: f32,
}

impl Resolution {
    /// Returns the number of active vertices: the first `vertices()` vertices are all that is drawn.
    pub fn vertices(&self) -> usize {
        self.vertices as usize
    }

    /// Returns the number of drawn triangles.
    pub fn triangles(&self) -> usize {
        self.triangles as usize
    }

    /// Returns a bound for the error, object units, as defined by the simplifier. 0 at full resolution.
    pub fn error(&self) -> f32 {
        self.error
    }
}

impl TotallyOrderedMesh {
    /// Returns the full resolution.
    pub fn finest(&self) -> Resolution {
        self.resolution(self.substitute.len() as u32)
    }

    /// Returns the resolution of the base mesh.
    pub fn coarsest(&self) -> Resolution {
        self.resolution(self.base_vertices)
    }

    /// Returns the finest resolution within a count or ratio, or the coarsest resolution known to be within an error; at
    /// least the base.
    ///
    /// Several triangles vanish together, so not every count exists: read the count off the result. O(log triangles)
    /// walks along substitution chains.
    pub fn at(&self, level: Level) -> Resolution {
        match level {
            Level::Triangles(count) => self.at_triangles(count),
            Level::Vertices(count) => {
                let most = count.min(self.substitute.len());
                self.resolution(self.boundary_at_most(most as u32))
            }
            Level::Error(error) => self.resolution(self.vertices_within(error)),
            Level::Ratio(ratio) => {
                // The cast takes NaN and negative ratios to 0; beyond 1 all is drawn.
                self.at_triangles((f64::from(ratio) * self.triangles.len() as f64) as usize)
            }
        }
    }

    /// Returns the vertices of the coarsest resolution known to be within an error. O(log marks).
    pub(super) fn vertices_within(&self, error: f32) -> u32 {
        // Bounds fall from mark to mark.
        let above = self.error_marks.partition_point(|mark| mark.error > error);
        self.error_marks
            .get(above)
            .filter(|mark| mark.error <= error)
            .map_or(self.substitute.len() as u32, |mark| mark.vertices)
    }

    /// Returns the next coarser resolution: a group of vertices less. `None` at the base.
    pub fn coarser(&self, resolution: Resolution) -> Option<Resolution> {
        let active = self.clamp(resolution).vertices;
        (active > self.base_vertices).then(|| self.resolution(self.boundary_at_most(active - 1)))
    }

    /// Returns the next finer resolution: a group of vertices more. `None` at full resolution.
    pub fn finer(&self, resolution: Resolution) -> Option<Resolution> {
        let mut active = self.clamp(resolution).vertices;
        if active as usize == self.substitute.len() {
            return None;
        }
        active += 1;
        while !self.is_boundary(active) {
            active += 1;
        }
        Some(self.resolution(active))
    }

    fn at_triangles(&self, count: usize) -> Resolution {
        if count >= self.triangles.len() {
            return self.finest();
        }
        // The first undrawn triangle vanishes with this vertex's group; another group would draw it.
        match self.last_vertex(count) {
            crate::mesh::NONE => self.coarsest(),
            last => self.resolution(self.boundary_at_most(last)),
        }
    }

    /// Returns the resolution of a group boundary.
    pub(super) fn resolution(&self, vertices: u32) -> Resolution {
        let error = if vertices as usize == self.substitute.len() {
            0.0
        } else {
            let above = self.error_marks.partition_point(|mark| mark.vertices <= vertices);
            above.checked_sub(1).map_or(f32::INFINITY, |at| self.error_marks[at].error)
        };
        Resolution { vertices, triangles: self.triangles_at(vertices), error }
    }

    /// Clamps any resolution to this mesh's range, so all its indices are valid.
    pub(super) fn clamp(&self, resolution: Resolution) -> Resolution {
        Resolution {
            vertices: resolution.vertices.clamp(self.base_vertices, self.substitute.len() as u32),
            triangles: resolution.triangles.min(self.triangles.len() as u32),
            ..resolution
        }
    }
}
