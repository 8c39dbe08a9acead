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

use super::instance::surface::finest_triangles;
use super::recognise::{Leaves, Quadrisection, Recognition};
use super::subdivision::{Part, SubdivisionBuilder};
use super::{Subdivision, WaveletError, WaveletMesh, WaveletOptions};

/// The input, by the faces of its quadrisection.
struct Source<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    found: &'a Quadrisection,
    /// Leaves of several triangles; `None` where leaves are triangles.
    leaves: Option<&'a Leaves>,
    /// Per face its corners, each as a corner of the input: `3 * triangle + k`.
    corners: Vec<[u32; 3]>,
    /// Per face its first child, or `NONE`.
    first_child: Vec<u32>,
}

/// Makes the wavelet mesh. Returns, for each of its vertices, the input's vertex. [`WaveletError::NoConnectivity`] if leaves of
/// several triangles are not drawn as the input has them.
pub(super) fn from_quadrisection(
    mesh: &Mesh,
    found: &Recognition,
    options: &WaveletOptions,
    progress: Progress<'_>,
) -> Result<(WaveletMesh, Vec<u32>), WaveletError> {
    let source = Source::new(mesh, found);
    let (base, base_vertices) = source.base();
    let builder = source.builder(base, base_vertices.len())?;
    let subdivision = source.split(builder)?;
    let origins = source.origins(base_vertices, &subdivision);
    let materials = source.materials();
    if source.leaves.is_some() && !source.is_drawn(&subdivision, &origins, &materials) {
        let reason = "faces split to different depths do not fit together".to_owned();
        return Err(WaveletError::NoConnectivity { reason });
    }
    let vertices = mesh.gather(&origins, Vec::new(), Vec::new());
    Ok((WaveletMesh::assemble(subdivision, vertices, &materials, options, progress)?, origins))
}

impl<'a> Source<'a> {
    fn new(mesh: &'a Mesh, found: &'a Recognition) -> Self {
        let leaves = found.leaves.as_ref();
        let found = &found.quadrisection;
        let own = || (0..mesh.triangles().len() as u32).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
        let named: Vec<[u32; 3]> = leaves.map_or_else(own, |leaves| leaves.corners.clone());
        let mut first_child = vec![NONE; found.len()];
        found.splits().for_each(|(face, child)| first_child[face] = child as u32);
        let corners = found.corners(&named);
        Self { mesh, topology: Topology::new(mesh), found, leaves, corners, first_child }
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

    /// Returns the midpoints on the sides of an unsplit face, each as a corner of the input, or `NONE`.
    fn midpoints_beside(&self, face: u32) -> [u32; 3] {
        let leaf = self.found.leaves()[face as usize];
        let of_leaf = self.leaves.and_then(|leaves| {
            let at = leaves.midpoints.binary_search_by_key(&(leaf / 3), |leaf| leaf.0);
            Some(leaves.midpoints[at.ok()?].1)
        });
        of_leaf.map_or([NONE; 3], |midpoints| [0, 1, 2].map(|k| midpoints[((k + leaf % 3) % 3) as usize]))
    }

    /// Returns the wedge at the midpoint of a side: of a split face as one of the children has it.
    fn wedge_beside(&self, face: u32, side: usize, part: Part) -> Option<u32> {
        if self.first_child[face as usize] != NONE {
            return Some(self.wedge_at_midpoint(face, side, part));
        }
        let corner = self.midpoints_beside(face)[side];
        (corner != NONE).then(|| self.wedge(corner))
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

    /// Starts a subdivision of the base. Base edges are told apart by their points, and by the points at their midpoints.
    fn builder(&self, base: Vec<[u32; 3]>, vertices: usize) -> Result<SubdivisionBuilder, WaveletError> {
        let faces = 0..self.found.base_faces();
        let points: Vec<[u32; 3]> =
            faces.clone().map(|face| self.corners[face].map(|c| self.point(c))).collect();
        let midpoints = faces.map(|face| match self.first_child[face] {
            NONE => self.midpoints_beside(face as u32).map(|c| if c == NONE { NONE } else { self.point(c) }),
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
            let more = match self.leaves {
                None => builder.split(flags)?,
                Some(_) => builder.split_only(&flags)?,
            };
            if !more {
                break;
            }
        }
        if self.leaves.is_some() {
            return Ok(builder.finish_beside(|_, _, face, side, part| self.wedge_beside(face, side, part)));
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
                if !subdivision.is_split(along.face()) {
                    let [vertex, _] = subdivision.vertices_at(wavelet, along.face(), along.side());
                    let corner = self.midpoints_beside(along.face())[along.side()];
                    if corner != NONE && origins[vertex as usize] == NONE {
                        origins[vertex as usize] = self.wedge(corner);
                    }
                    continue;
                }
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

    /// Whether the full resolution has just the triangles of the input: the same wedges and materials. `origins`: the wedge of
    /// every vertex. O(n log n).
    fn is_drawn(&self, subdivision: &Subdivision, origins: &[u32], materials: &[u32]) -> bool {
        if origins.contains(&NONE) {
            return false;
        }
        let turned = |[a, b, c]: [u32; 3]| match a.min(b).min(c) {
            least if least == a => [a, b, c],
            least if least == b => [b, c, a],
            _ => [c, a, b],
        };
        let mut drawn: Vec<([u32; 3], u32)> = Vec::with_capacity(self.mesh.triangles().len());
        for face in (0..subdivision.face_count() as u32).filter(|&face| !subdivision.is_split(face)) {
            let material = materials.get(subdivision.base_face_of(face) as usize).copied().unwrap_or(NONE);
            finest_triangles(subdivision, face, |corners| {
                drawn.push((turned(corners.map(|vertex| origins[vertex as usize])), material));
            });
        }
        let wedge = |vertex: u32| self.topology.wedge_of()[vertex as usize];
        let own = self.mesh.triangles().iter().enumerate().map(|(triangle, corners)| {
            (turned(corners.map(wedge)), self.mesh.materials().get(triangle).copied().unwrap_or(NONE))
        });
        let mut own: Vec<([u32; 3], u32)> = own.collect();
        drawn.sort_unstable();
        own.sort_unstable();
        drawn == own
    }
}
