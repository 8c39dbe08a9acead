//! Vertices at points of another mesh: each as up to two mixtures of two vertices, with the attributes there.
//!
//! ```text
//!     c                     m = mix(a, b, wb / (wa + wb))
//!     |\                    v = mix(m, c, wc)
//!     | v \
//!     a--m--b
//! ```

use crate::lod::Mixture;
use crate::mesh::{Attribute, Blender, Mesh, MeshPoint};

/// Weights below this are rounding: a vertex on an edge of the source takes no values from the third corner.
pub(super) const LEAST_WEIGHT: f64 = 1e-9;

/// Collects vertices with their sources and attributes.
pub(super) struct Sources<'a> {
    source: &'a Mesh,
    blender: Blender,
    order: Vec<u32>,
    mixtures: Vec<Mixture>,
}

impl<'a> Sources<'a> {
    pub fn new(source: &'a Mesh) -> Self {
        let blender = Blender::new(source.attributes(), 0);
        Self { source, blender, order: Vec::new(), mixtures: Vec::new() }
    }

    /// Adds the vertex at a point. Returns false, and adds vertex 0, if the source has no such triangle.
    pub fn push(&mut self, point: &MeshPoint) -> bool {
        let Some(corners) = self.source.triangles().get(point.triangle as usize) else {
            self.order.push(0);
            return false;
        };
        let mut parts = [0, 1, 2].map(|k| (corners[k], point.barycentric[k]));
        // The largest weight first: it is there.
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (mut vertex, mut weight) = parts[0];
        for (other, more) in parts.into_iter().skip(1).filter(|part| part.1 > LEAST_WEIGHT) {
            weight += more;
            vertex = self.mix([vertex, other], (more / weight) as f32);
        }
        self.order.push(vertex);
        true
    }

    fn mix(&mut self, from: [u32; 2], weight: f32) -> u32 {
        self.blender.push(from, weight);
        self.mixtures.push(Mixture { from, weight });
        (self.source.positions().len() + self.mixtures.len() - 1) as u32
    }

    /// Returns the attributes of all vertices, the source of each, and the mixtures.
    pub fn finish(self) -> (Vec<Attribute>, Vec<u32>, Vec<Mixture>) {
        let Self { blender, order, mixtures, .. } = self;
        let all = blender.finish();
        (all.iter().map(|attribute| attribute.gather(&order)).collect(), order, mixtures)
    }
}
