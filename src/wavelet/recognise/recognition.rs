//! Finds the coarsest mesh from which each component of a mesh is subdivided.

use std::borrow::Cow;
use std::fmt;

use crate::mesh::{Edges, Mesh, NONE, Topology};
use crate::wavelet::Quadrisection;

use super::Stop;
use super::complex::{Complex, FaceComplex};
use super::label::Labels;
use super::peel::{Peeled, peel};
use super::pieces::Pieces;
use super::tower::{Leaves, Nodes, Tower};

/// Result of [`recognise`] for a component: a set of triangles joined by edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Component {
    /// Number of input triangles.
    pub triangles: u32,
    /// Number of times each base face is split, or the most often split one where `uneven`; 0: the component has no subdivision
    /// connectivity.
    pub levels: u32,
    /// Number of base faces: `triangles / 4^levels`, unless `uneven`.
    pub base_faces: u32,
    /// Whether faces are split to different depths, so that some leaves are several triangles.
    pub uneven: bool,
    /// First base face of the component in the forest; its other base faces follow.
    pub first_base_face: u32,
    /// The lowest input triangle of the component.
    pub first_triangle: u32,
    /// Why there are no more levels.
    pub stop: Stop,
}

/// Writes a single line.
impl fmt::Display for Component {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = |n: u32| if n == 1 { "" } else { "s" };
        let Self { triangles, levels, base_faces, uneven, stop, .. } = *self;
        let most = if uneven { "up to " } else { "" };
        write!(f, "{triangles} triangle{}, {most}{levels} level{}", plural(triangles), plural(levels))?;
        if levels > 0 {
            write!(f, " above {base_faces} base face{}", plural(base_faces))?;
        }
        write!(f, ": {stop}")
    }
}

/// Result of [`recognise`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Recognition {
    /// The whole mesh as a forest of faces. Every input triangle is exactly 1 leaf, except in [uneven](Component::uneven)
    /// components, where a leaf may be several triangles: see [`Recognition::leaves`].
    pub quadrisection: Quadrisection,
    /// The components, in order of their lowest triangle.
    pub components: Vec<Component>,
    /// `None`: the leaves are the input triangles.
    pub(in crate::wavelet) leaves: Option<Leaves>,
}

impl Recognition {
    /// Returns the leaves as triangles of the mesh recognised, in the order of their lowest triangle: the triangles to which
    /// [`Quadrisection::leaves`] and [`Quadrisection::corners`] refer. Where a leaf is several triangles, they are taken for one,
    /// and the midpoints on its sides are left out: its neighbours meet it in T-vertices.
    ///
    /// `mesh`: the mesh recognised.
    pub fn leaves<'a>(&self, mesh: &'a Mesh) -> Cow<'a, [[u32; 3]]> {
        let vertex = |corner: u32| mesh.indices().get(corner as usize).copied().unwrap_or(NONE);
        match &self.leaves {
            None => Cow::Borrowed(mesh.triangles()),
            Some(leaves) => leaves.corners.iter().map(|corners| corners.map(vertex)).collect(),
        }
    }
}

/// Fewest triangles of an uneven component: two base faces, of which one is split.
const LEAST_UNEVEN: usize = 6;

/// Takes a mesh apart into the coarsest base complex of each component and its four-to-one subdivisions.
///
/// A component is a set of triangles joined by edges between welded points ([`Topology`]). All base faces of a
/// component are split equally often; components may differ. Borders, edges with three or more triangles, clashing
/// orientation, attribute seams and changes of material may run anywhere along the edges of coarse faces, but not
/// inside coarse faces. Locks do not matter. Points where several fans of triangles meet are no obstacle: a point may
/// be a midpoint in one fan and an old vertex in another. Duplicate triangles leave their component without levels. A
/// triangle naming a point twice is a component of its own, without levels.
///
/// Base faces are ordered by component, then by their lowest input triangle. Corner 0 of a base face is its lowest
/// wedge, but a base face that is itself an input triangle keeps the corner order of the input.
///
/// Several ways to coarsen exist only on meshes without irregular vertices. The ways are tried in a fixed order, and
/// the first to allow a further coarsening is taken. O(n) beyond the making of [`Topology`] and [`Edges`]; about 110
/// bytes a triangle while it runs.
///
/// ```
/// use multires::{mesh::shapes, wavelet::recognise};
///
/// let recognition = recognise(&shapes::icosphere(3));
/// assert_eq!(recognition.quadrisection.levels(), 3);
/// assert_eq!(recognition.quadrisection.base_faces(), 20);
/// ```
pub fn recognise(mesh: &Mesh) -> Recognition {
    find(mesh, false, false)
}

/// Takes a mesh apart like [`recognise`], but coarsens components across attribute seams if the seams would stop
/// coarsening. Then several wedges may share a midpoint inside a coarse face.
pub fn recognise_across_seams(mesh: &Mesh) -> Recognition {
    find(mesh, true, false)
}

/// Takes a mesh apart like [`recognise_across_seams`], and finds components of uneven depth too.
///
/// In a component without a base of equal depth, faces may be split to different depths, by one level at most at a common edge, and
/// be cut beside deeper faces as [`WaveletMesh::finest`](crate::wavelet::WaveletMesh::finest) cuts them. This is found if vertices of
/// every level come after those of coarser levels and a quarter of the triangles, at least, are in split or cut faces
/// ([`Component::uneven`]). On a regular lattice some splits may be missed: then base faces are more than they could be.
pub fn recognise_uneven(mesh: &Mesh) -> Recognition {
    find(mesh, true, true)
}

fn find(mesh: &Mesh, across_seams: bool, may_be_uneven: bool) -> Recognition {
    let topology = Topology::new(mesh);
    let triangles = mesh.triangles().len();
    let corner_points: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|corners| corners.map(|v| topology.point_of()[v as usize])).collect();
    let edges = Edges::new(&corner_points, topology.point_count());
    drop(corner_points);
    let sides = edges.of_half_edges(triangles);
    let pieces = Pieces::new(&edges, &sides);
    let mut cutter = Cutter { mesh, topology: &topology, sides: &sides, own_number: vec![NONE; edges.len()] };
    drop(edges);

    let surface =
        FaceComplex { point_of: topology.point_of(), materials: mesh.materials(), across_seams: false };
    let across = FaceComplex { across_seams: true, ..surface };
    let mut tower = Tower::new(triangles as u32);
    let mut labels = Labels::default();
    let mut components = Vec::new();
    let mut roots: Vec<u32> = Vec::new();
    for piece in pieces.iter() {
        let first_base_face = roots.len() as u32;
        let start = tower.height();
        let mut found = match hopeless(piece, &sides) {
            Some(stop) => (0, stop),
            None => {
                let found =
                    tower.raise(cutter.cut(piece), Nodes::Triangles, &surface, &mut labels, &mut roots);
                if across_seams && matches!(found.1, Stop::Seam { .. }) {
                    tower.truncate(start);
                    roots.truncate(first_base_face as usize);
                    tower.raise(cutter.cut(piece), Nodes::Triangles, &across, &mut labels, &mut roots)
                } else {
                    found
                }
            }
        };
        let mut uneven = false;
        if may_be_uneven && found.0 == 0 && piece.len() >= LEAST_UNEVEN {
            let mut surfaces = [Some(&surface), across_seams.then_some(&across)].into_iter().flatten();
            let peeled = surfaces.find_map(|surface| {
                tower.truncate(start);
                Some((peel(cutter.cut(piece), surface, &mut tower)?, surface))
            });
            if let Some((Peeled { complex, nodes }, surface)) = peeled {
                roots.truncate(first_base_face as usize);
                let nodes = Nodes::Listed(nodes);
                let (_, stop) = tower.raise(complex, nodes, surface, &mut labels, &mut roots);
                found = (tower.levels_above(start), stop);
                uneven = true;
            } else {
                tower.truncate(start);
            }
        }
        let (levels, stop) = found;
        if levels == 0 {
            roots.truncate(first_base_face as usize);
            roots.extend(piece.iter().map(|&triangle| 3 * triangle));
        }
        components.push(Component {
            triangles: piece.len() as u32,
            levels,
            base_faces: roots.len() as u32 - first_base_face,
            uneven,
            first_base_face,
            first_triangle: piece[0],
            stop,
        });
    }
    let (quadrisection, leaves) = tower.forest(roots);
    Recognition { quadrisection, components, leaves }
}

/// Returns why a component cannot be coarsened, where this shows without labelling.
fn hopeless(piece: &[u32], sides: &[[u32; 3]]) -> Option<Stop> {
    let faces = piece.len() as u32;
    match piece {
        [triangle] if sides[*triangle as usize][0] == NONE => Some(Stop::Degenerate { triangle: *triangle }),
        [_] => Some(Stop::SingleFace),
        _ => (!faces.is_multiple_of(4)).then_some(Stop::NotFourfold { faces }),
    }
}

/// Cuts components out of the mesh as complexes.
struct Cutter<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    sides: &'a [[u32; 3]],
    /// Per edge of the mesh, its number in the component being cut; `NONE` between components.
    own_number: Vec<u32>,
}

impl Cutter<'_> {
    fn cut(&mut self, piece: &[u32]) -> Complex {
        let wedges = |&triangle: &u32| {
            self.mesh.triangles()[triangle as usize].map(|v| self.topology.wedge_of()[v as usize])
        };
        let corners = piece.iter().map(wedges).collect();
        let mut count = 0;
        let edges = piece.iter().map(|&triangle| {
            self.sides[triangle as usize].map(|edge| {
                let number = &mut self.own_number[edge as usize];
                if *number == NONE {
                    *number = count;
                    count += 1;
                }
                *number
            })
        });
        let edges = edges.collect();
        for &triangle in piece {
            self.sides[triangle as usize].iter().for_each(|&edge| self.own_number[edge as usize] = NONE);
        }
        Complex::new(piece.to_vec(), corners, edges, count as usize)
    }
}
