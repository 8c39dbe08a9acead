//! A mesh prepared once for measuring: its hierarchy of boxes, and its samples.
//!
//! ```text
//!     Surface::new(original)  --distance-->  Surface::new(level 1)      the original's hierarchy is built once,
//!                             --distance-->  Surface::new(level 2)      not once a level
//! ```
//!
//! Data needed only by some measures (corners and edges to sample, orientation) is built on first use.

use std::sync::OnceLock;

use glam::DVec3;

use crate::geometry::{
    bvh::Bvh,
    hash,
    parallel::map_chunks,
    triangle::{Corners, normal},
};
use crate::mesh::Mesh;

use super::{
    DistanceOptions, QualityError,
    samples::{Shares, sierpinski},
    signed::Solid,
};

/// Samples of a unit of work. The result depends on this number (order of sums), so the machine must not change it.
pub(super) const CHUNK: usize = 4096;
/// Most samples: keeps the precision of sums, and stops a mistyped number from running for days.
const MAX_SAMPLES: usize = u32::MAX as usize;

/// A mesh prepared once for measuring, to measure many meshes against it.
///
/// The surface consists of the triangles with an area. Coincident triangles count once. Vertices used only by other
/// triangles do not count. Some 130 bytes a triangle, and about as much again once edges are sampled.
///
/// ```
/// use multires::{Simplifier, mesh::shapes, quality::{DistanceOptions, Surface}};
/// let mesh = shapes::rock(2_000, 1);
/// let sequence = Simplifier::new().run(&mesh)?;
/// let original = Surface::new(&mesh)?;
/// let mut coarser = 0.0;
/// for triangles in [1_000, 500, 250] {
///     let level = sequence.extract(&mesh, sequence.steps_for_triangles(triangles));
///     let apart = original.distance(&Surface::new(&level)?, &DistanceOptions::default().with_samples(5_000))?;
///     assert!(apart.mean() > coarser);
///     coarser = apart.mean();
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Surface<'mesh> {
    mesh: &'mesh Mesh,
    bvh: Bvh,
    diagonal: f64,
    outline: OnceLock<Outline>,
    solid: OnceLock<Result<Solid, QualityError>>,
}

/// Each vertex and each edge of the surface once, in the order of its slots.
#[derive(Debug)]
struct Outline {
    corners: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

impl<'mesh> Surface<'mesh> {
    /// Prepares a mesh. O(n log n).
    ///
    /// # Errors
    /// The mesh has no triangle with an area.
    pub fn new(mesh: &'mesh Mesh) -> Result<Self, QualityError> {
        Self::named(mesh, "given")
    }

    /// Prepares a mesh, called `which` in errors. O(n log n).
    pub(super) fn named(mesh: &'mesh Mesh, which: &'static str) -> Result<Self, QualityError> {
        let triangles = mesh.triangles().len();
        let bvh = Bvh::new(mesh.positions(), mesh.triangles())
            .ok_or(QualityError::NoSurface { which, triangles })?;
        let (outline, solid) = (OnceLock::new(), OnceLock::new());
        Ok(Self { mesh, bvh, diagonal: mesh.diagonal(), outline, solid })
    }

    /// Returns the mesh of the surface.
    pub fn mesh(&self) -> &'mesh Mesh {
        self.mesh
    }

    /// Returns the diagonal of the mesh's box ([`Mesh::diagonal`]), object units.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns the distance of every point from the surface, object units, never negative. Colours for a level's
    /// vertices by distance: [`palette::colours`](super::palette::colours). Points that are not finite get an infinite
    /// distance; all positions of a [`Mesh`] are finite. O(log n) expected for each point.
    pub fn point_distances(&self, points: &[[f32; 3]]) -> Vec<f64> {
        let chunks = map_chunks(points.len(), CHUNK, |range| {
            let mut walker = self.bvh.walker();
            let distance = |p: &[f32; 3]| match finite(p) {
                Some(point) => walker.closest(point).distance_squared.sqrt(),
                None => f64::INFINITY,
            };
            points[range].iter().map(distance).collect::<Vec<_>>()
        });
        chunks.concat()
    }

    /// Returns the hierarchy of boxes.
    pub(super) fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Returns the orientation data to tell inside from outside, built on first use. The mesh is called `which` in
    /// errors.
    pub(super) fn solid(&self, which: &'static str) -> Result<&Solid, QualityError> {
        let solid = self.solid.get_or_init(|| Solid::new(self.mesh, &self.bvh));
        solid.as_ref().map_err(|error| error.clone().of(which))
    }

    /// Calls `add` for every sample on the faces with its slot, the weights of the corners there, and the point.
    /// `start` makes an accumulator for every chunk. Returns the accumulators in order. Each sample stands for an equal
    /// area.
    pub(super) fn on_faces<T: Send>(
        &self,
        options: &DistanceOptions,
        start: impl Fn() -> T + Sync,
        add: impl Fn(&mut T, u32, [f64; 3], DVec3) + Sync,
    ) -> Vec<T> {
        let areas = (0..self.bvh.len() as u32).map(|slot| normal(&self.bvh.corners(slot)).length());
        let shares = Shares::new(areas, options.samples, options.seed);
        map_chunks(shares.len(), CHUNK, |range| {
            let mut sum = start();
            for (slot, along) in shares.positions(range) {
                let weights = sierpinski(along);
                add(&mut sum, slot as u32, weights, blend(&self.bvh.corners(slot as u32), weights));
            }
            sum
        })
    }

    /// Calls `add` for every corner of the surface with its vertex and position. Returns the chunks' accumulators in
    /// order.
    pub(super) fn on_corners<T: Send>(
        &self,
        start: impl Fn() -> T + Sync,
        add: impl Fn(&mut T, u32, DVec3) + Sync,
    ) -> Vec<T> {
        let corners = &self.outline().corners;
        map_chunks(corners.len(), CHUNK, |range| {
            let mut sum = start();
            corners[range].iter().for_each(|&v| add(&mut sum, v, self.position(v)));
            sum
        })
    }

    /// Calls `add` for every sample along the edges, a quarter as many as on faces. Returns the chunks' accumulators in
    /// order.
    pub(super) fn on_edges<T: Send>(
        &self,
        options: &DistanceOptions,
        start: impl Fn() -> T + Sync,
        add: impl Fn(&mut T, DVec3) + Sync,
    ) -> Vec<T> {
        let edges = &self.outline().edges;
        let lengths = edges.iter().map(|&[a, b]| (self.position(b) - self.position(a)).length());
        let shares = Shares::new(lengths, options.edge_samples(), hash::mix(options.seed));
        map_chunks(shares.len(), CHUNK, |range| {
            let mut sum = start();
            for (edge, along) in shares.positions(range) {
                let [a, b] = edges[edge].map(|v| self.position(v));
                add(&mut sum, a + (b - a) * along);
            }
            sum
        })
    }

    /// Returns how many points [`on_corners`](Self::on_corners) and [`on_edges`](Self::on_edges) pass to `add`.
    pub(super) fn outline_samples(&self, options: &DistanceOptions) -> usize {
        self.outline().corners.len() + options.edge_samples()
    }

    fn outline(&self) -> &Outline {
        self.outline.get_or_init(|| Outline::new(self.mesh, &self.bvh))
    }

    fn position(&self, vertex: u32) -> DVec3 {
        DVec3::from_array(self.mesh.positions()[vertex as usize].map(f64::from))
    }
}

impl DistanceOptions {
    /// Checks the number of samples.
    pub(super) fn check(&self) -> Result<(), QualityError> {
        if (1..=MAX_SAMPLES).contains(&self.samples) {
            Ok(())
        } else {
            Err(QualityError::Samples { samples: self.samples, limit: MAX_SAMPLES })
        }
    }

    fn edge_samples(&self) -> usize {
        self.samples.div_ceil(4)
    }
}

impl Outline {
    fn new(mesh: &Mesh, bvh: &Bvh) -> Self {
        let mut seen = vec![false; mesh.positions().len()];
        let mut corners = Vec::new();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * bvh.len());
        for &triangle in bvh.triangle_of() {
            let [a, b, c] = mesh.triangles()[triangle as usize];
            for v in [a, b, c] {
                if !std::mem::replace(&mut seen[v as usize], true) {
                    corners.push(v);
                }
            }
            for (p, q) in [(a, b), (b, c), (c, a)] {
                sides.push(([p.min(q), p.max(q)], sides.len() as u32));
            }
        }
        sides.sort_unstable();
        sides.dedup_by_key(|side| side.0);
        sides.sort_unstable_by_key(|side| side.1);
        Self { corners, edges: sides.into_iter().map(|side| side.0).collect() }
    }
}

pub(super) fn finite(point: &[f32; 3]) -> Option<DVec3> {
    let point = DVec3::from_array(point.map(f64::from));
    point.is_finite().then_some(point)
}

fn blend(&[a, b, c]: &Corners, weights: [f64; 3]) -> DVec3 {
    a + (b - a) * weights[1] + (c - a) * weights[2]
}
