//! Vertices at the midpoint of two others, and smooth normals from triangles.

use glam::DVec3;

use super::blend::Blender;
use super::{Attribute, Mesh, Topology, names};

impl Mesh {
    /// Moves vertices to the midpoint of two others and blends their values, in order. Labels are copied from the first
    /// end.
    pub(crate) fn with_midpoints(mut self, ends: impl Iterator<Item = (u32, [u32; 2])> + Clone) -> Self {
        self.positions.edit(|positions| {
            for (vertex, [a, b]) in ends.clone() {
                let [a, b] = [a, b].map(|end| positions[end as usize]);
                positions[vertex as usize] = std::array::from_fn(|i| 0.5 * a[i] + 0.5 * b[i]);
            }
        });
        let mut blender = Blender::new(&self.attributes, 0);
        ends.for_each(|(vertex, from)| blender.put(vertex, from, 0.5));
        self.attributes = blender.finish();
        self
    }

    /// Replaces the positions by as many finite positions.
    pub(crate) fn with_positions(mut self, positions: Vec<[f32; 3]>) -> Self {
        debug_assert_eq!(positions.len(), self.positions.len());
        self.positions = positions.into();
        self
    }

    /// Changes positions. New positions must be finite.
    pub(crate) fn edit_positions<R>(&mut self, edit: impl FnOnce(&mut [[f32; 3]]) -> R) -> R {
        self.positions.edit(|positions| edit(positions))
    }

    /// Replaces the normals by area-weighted means of the triangles around each position. Vertices at equal positions
    /// get equal normals.
    pub(crate) fn with_smooth_normals(mut self) -> Self {
        let topology = Topology::new(&self);
        let point_of = topology.point_of();
        let mut sums = vec![DVec3::ZERO; topology.point_count()];
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|v| DVec3::from_array(self.positions[v as usize].map(f64::from)));
            let normal = (b - a).cross(c - a);
            corners.iter().for_each(|&v| sums[point_of[v as usize] as usize] += normal);
        }
        let unit = |&point: &u32| sums[point as usize].normalize_or(DVec3::Z).as_vec3().to_array();
        let normals: Vec<[f32; 3]> = point_of.iter().map(unit).collect();
        self.attributes.retain(|attribute| attribute.name() != names::NORMAL);
        self.attributes.insert(0, Attribute::floats(names::NORMAL, &normals));
        self
    }
}
