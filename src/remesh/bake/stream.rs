//! A float attribute, read at vertices and at points of the surface.

use glam::DVec3;

use crate::mesh::{Mesh, MeshPoint};
use crate::remesh::RemeshError;

/// A float attribute of `WIDTH` values a vertex.
pub(super) struct Stream<'a, const WIDTH: usize> {
    values: &'a [f32],
}

impl<'a, const WIDTH: usize> Stream<'a, WIDTH> {
    pub fn of(mesh: &'a Mesh, name: &'static str) -> Result<Self, RemeshError> {
        let found = mesh.attribute(name).filter(|attribute| attribute.width() == WIDTH);
        let values = found.and_then(|attribute| attribute.as_floats());
        values.map(|values| Self { values }).ok_or(RemeshError::NoAttribute { name, width: WIDTH })
    }

    pub fn value(&self, vertex: usize) -> [f64; WIDTH] {
        std::array::from_fn(|i| f64::from(self.values[vertex * WIDTH + i]))
    }

    /// Returns the value at a point of the mesh, linear in its triangle; `None` if the mesh has no such triangle.
    pub fn at(&self, mesh: &Mesh, point: &MeshPoint) -> Option<[f64; WIDTH]> {
        let corners = mesh.triangles().get(point.triangle as usize)?.map(|v| self.value(v as usize));
        Some(std::array::from_fn(|i| (0..3).map(|k| point.barycentric[k] * corners[k][i]).sum()))
    }
}

impl Stream<'_, 3> {
    pub fn vector(&self, vertex: usize) -> DVec3 {
        DVec3::from_array(self.value(vertex))
    }
}
