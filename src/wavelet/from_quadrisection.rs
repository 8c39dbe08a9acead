//! A wavelet mesh from a mesh and its quadrisection.
//!
//! ```text
//!     name corners       every corner of every face by a corner of the input's triangles
//!     number the base    vertices in the order of the base faces; edges by points and midpoints
//!     split              level by level
//!     name vertices      a vertex per different wedge at the midpoint of a side
//!     gather             positions, attributes and locks per vertex, a material per base face
//! ```

use crate::lod::Progress;
use crate::mesh::{Mesh, NONE, Topology};

use super::recognise::quadrisection::Quadrisection;
use super::subdivision::{Part, SubdivisionBuilder};
use super::{Subdivision, WaveletError, WaveletMesh, WaveletOptions};

/// The input, by the faces of its quadrisection.
struct Source<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    found: &'a Quadrisection,
    /// Per face its corners, each as a corner of the input: `3 * triangle + k`.
    corners: Vec<[u32; 3]>,
    /// Per face its first child, or `NONE`.
    first_child: Vec<u32>,
}

/// Makes the wavelet mesh. Returns, for each of its vertices, the input's vertex.
pub(super) fn from_quadrisection(
    mesh: &Mesh,
    found: &Quadrisection,
    options: &WaveletOptions,
    progress: Progress<'_>,
) -> Result<(WaveletMesh, Vec<u32>), WaveletError> {
    let source = Source::new(mesh, found);
    let (base, base_vertices) = source.base();
    let builder = source.builder(base, base_vertices.len())?;
    let subdivision = source.split(builder)?;
    let origins = source.origins(base_vertices, &subdivision);
    let materials = source.materials();
    let vertices = mesh.gather(&origins, Vec::new(), Vec::new());
    Ok((WaveletMesh::assemble(subdivision, vertices, &materials, options, progress)?, origins))
}

impl<'a> Source<'a> {
    fn new(mesh: &'a Mesh, found: &'a Quadrisection) -> Self {
        let named: Vec<[u32; 3]> =
            (0..mesh.triangles().len() as u32).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
        let mut first_child = vec![NONE; found.len()];
        found.splits().for_each(|(face, child)| first_child[face] = child as u32);
        Self { mesh, topology: Topology::new(mesh), found, corners: found.corners(&named), first_child }
    }

    fn wedge(&self, corner: u32) -> u32 {
        self.topology.wedge_of()[self.mesh.triangles().as_flattened()[corner as usize] as usize]
    }

    fn point(&self, corner: u32) -> u32 {
        self.topology.point_of()[self.mesh.triangles().as_flattened()[corner as usize] as usize]
    }

    /// Returns the wedge at the midpoint of a split face's side, as one of the children has it.
    fn wedge_at_midpoint(&self, face: u32, side: usize, part: Part) -> u32 {
        let (child, corner) = part.corner(side);
        self.wedge(self.corners[self.first_child[face as usize] as usize + child][corner])
    }

    /// Numbers the vertices of the base in the order of its faces. Returns the corners of the faces, and the wedge of each
    /// vertex.
    fn base(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut number = vec![NONE; self.mesh.positions().len()];
        let mut wedges: Vec<u32> = Vec::new();
        let mut base = self.corners[..self.found.base_faces()].to_vec();
        for corner in base.as_flattened_mut() {
            let wedge = self.wedge(*corner);
            let vertex = &mut number[wedge as usize];
            if *vertex == NONE {
                *vertex = wedges.len() as u32;
                wedges.push(wedge);
            }
            *corner = *vertex;
        }
        (base, wedges)
    }

    /// Starts a subdivision of the base. Base edges are told apart by their points, and by the points at the midpoints of
    /// split faces' sides.
    fn builder(&self, base: Vec<[u32; 3]>, vertices: usize) -> Result<SubdivisionBuilder, WaveletError> {
        let faces = 0..self.found.base_faces();
        let points: Vec<[u32; 3]> =
            faces.clone().map(|face| self.corners[face].map(|c| self.point(c))).collect();
        let midpoints = faces.map(|face| match self.first_child[face] {
            NONE => [NONE; 3],
            child => [0, 1, 2].map(|k| self.point(self.corners[child as usize + k][1])),
        });
        SubdivisionBuilder::new(base, vertices, &points, &midpoints.collect::<Vec<_>>())
    }

    /// Splits level by level, and gives every different wedge at a midpoint a vertex.
    fn split(&self, mut builder: SubdivisionBuilder) -> Result<Subdivision, WaveletError> {
        let split = self.found.split();
        loop {
            let level = builder.last_level();
            let flags = split[level.start as usize..level.end as usize].to_vec();
            if !builder.split(flags)? {
                break;
            }
        }
        let subdivision = builder.finish(|_, face, side, part| self.wedge_at_midpoint(face, side, part));
        if subdivision.split_count as usize != split.iter().filter(|split| **split).count() {
            return Err(WaveletError::Invalid { what: "seams beside the edges of base face", at: 0 });
        }
        Ok(subdivision)
    }

    /// Returns the wedge of every vertex, starting from those of the base.
    fn origins(&self, base: Vec<u32>, subdivision: &Subdivision) -> Vec<u32> {
        let mut origins = base;
        origins.resize(subdivision.vertex_count(), NONE);
        for wavelet in 0..subdivision.wavelet_count() as u32 {
            for along in subdivision.faces_along(wavelet) {
                for part in Part::ALL {
                    let (child, corner) = part.corner(along.side());
                    let vertex = subdivision.corner(subdivision.child(along.face(), child), corner);
                    origins[vertex as usize] = self.wedge_at_midpoint(along.face(), along.side(), part);
                }
            }
        }
        origins
    }

    /// Returns the material of each base face; empty for a mesh without materials.
    fn materials(&self) -> Vec<u32> {
        let materials = self.mesh.materials();
        let of_base = self.corners.iter().take(self.found.base_faces());
        of_base.filter_map(|corners| materials.get(corners[0] as usize / 3).copied()).collect()
    }
}
