//! Finds the coarsest mesh from which each component of a mesh is subdivided.

use std::fmt;

use crate::mesh::{Edges, Mesh, NONE, Topology};
use crate::wavelet::Quadrisection;

use super::Stop;
use super::coarsen::{Coarsening, coarsen};
use super::complex::{Complex, FaceComplex};
use super::label::Labels;
use super::pieces::Pieces;

/// Result of [`recognise`] for a component: a set of triangles joined by edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Component {
    /// Number of input triangles.
    pub triangles: u32,
    /// Number of times each base face is split; 0: the component has no subdivision connectivity.
    pub levels: u32,
    /// Number of base faces: `triangles / 4^levels`.
    pub base_faces: u32,
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
        let Self { triangles, levels, base_faces, stop, .. } = *self;
        write!(f, "{triangles} triangle{}, {levels} level{}", plural(triangles), plural(levels))?;
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
    /// The whole mesh as a forest of faces: every input triangle is exactly 1 leaf.
    pub quadrisection: Quadrisection,
    /// The components, in order of their lowest triangle.
    pub components: Vec<Component>,
}

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
    find(mesh, false)
}

/// Takes a mesh apart like [`recognise`], but coarsens components across attribute seams if the seams would stop
/// coarsening. Then several wedges may share a midpoint inside a coarse face.
pub fn recognise_across_seams(mesh: &Mesh) -> Recognition {
    find(mesh, true)
}

fn find(mesh: &Mesh, across_seams: bool) -> Recognition {
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
        let (levels, stop) = match hopeless(piece, &sides) {
            Some(stop) => (0, stop),
            None => {
                let coarse = tower.children.len();
                let found = tower.raise(cutter.cut(piece), &surface, &mut labels, &mut roots);
                if across_seams && matches!(found.1, Stop::Seam { .. }) {
                    tower.children.truncate(coarse);
                    roots.truncate(first_base_face as usize);
                    tower.raise(cutter.cut(piece), &across, &mut labels, &mut roots)
                } else {
                    found
                }
            }
        };
        if levels == 0 {
            roots.extend(piece.iter().map(|&triangle| 3 * triangle));
        }
        components.push(Component {
            triangles: piece.len() as u32,
            levels,
            base_faces: roots.len() as u32 - first_base_face,
            first_base_face,
            first_triangle: piece[0],
            stop,
        });
    }
    Recognition { quadrisection: tower.forest(roots), components }
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

/// All coarse faces so far. A *node* is an input triangle `t`, or `triangles + c` for coarse face `c`; below `4/3 *
/// 2^30`, so three times a node fits 32 bits.
struct Tower {
    triangles: u32,
    /// Per coarse face, its children as `3 * node + turn`.
    children: Vec<[u32; 4]>,
}

impl Tower {
    fn new(triangles: u32) -> Self {
        Self { triangles, children: Vec::new() }
    }

    /// Returns the node of the next coarse face.
    fn next_node(&self) -> u32 {
        self.triangles + self.children.len() as u32
    }

    /// Coarsens a component as often as possible, and adds its base faces to the roots if there is at least 1 level.
    /// Returns the number of levels and why there are no more.
    fn raise(
        &mut self,
        complex: Complex,
        surface: &FaceComplex,
        labels: &mut Labels,
        roots: &mut Vec<u32>,
    ) -> (u32, Stop) {
        let mut top = Level { first_node: NONE, complex };
        // The level below the top, and the assumption taken from it to the top.
        let mut below: Option<(Level, u8)> = None;
        let mut levels = 0;
        loop {
            match coarsen(&top.complex, surface, labels, 0) {
                Ok(Coarsening { coarse, children, assumption }) => {
                    let coarser = self.add(&top, coarse, &children);
                    below = Some((std::mem::replace(&mut top, coarser), assumption));
                    levels += 1;
                }
                Err(stop) => {
                    let Some((below, taken)) = &mut below else { return (0, stop) };
                    let Some(other) = other_way(&below.complex, surface, labels, *taken) else {
                        roots.extend((0..top.complex.face_count()).map(|face| top.root(face)));
                        return (levels, stop);
                    };
                    self.children.truncate((top.first_node - self.triangles) as usize);
                    top = self.add(below, other.coarse, &other.children);
                    *taken = other.assumption;
                }
            }
        }
    }

    fn add(&mut self, finer: &Level, coarse: Complex, children: &[[u32; 4]]) -> Level {
        let first_node = self.next_node();
        let as_node = |child: u32| 3 * finer.node(child / 3) + child % 3;
        self.children.extend(children.iter().map(|four| four.map(as_node)));
        Level { first_node, complex: coarse }
    }

    /// Grows the forest level by level from roots given as `3 * node + turn`.
    fn forest(self, roots: Vec<u32>) -> Quadrisection {
        let base_faces = roots.len() as u32;
        let faces = self.triangles as usize + self.children.len();
        let mut queue = roots;
        queue.reserve_exact(faces - queue.len());
        let mut split = Vec::with_capacity(faces);
        while let Some(&face) = queue.get(split.len()) {
            let (node, turn) = (face / 3, face % 3);
            let is_split = node >= self.triangles;
            if is_split {
                let four = self.children[(node - self.triangles) as usize];
                queue.extend((0..3).map(|i| four[(i + turn as usize) % 3]));
                // The centre turns with its parent: its corner k is the midpoint of side k.
                queue.push(four[3] - four[3] % 3 + (four[3] + turn) % 3);
            }
            split.push(is_split);
        }
        // A triangle is its own node, so `queue` already holds leaves as `3 * triangle + turn`.
        let mut leaves = queue;
        leaves.iter_mut().zip(&split).filter(|(_, split)| **split).for_each(|(leaf, _)| *leaf = NONE);
        Quadrisection::new(base_faces, split, leaves)
    }
}

/// A complex whose faces are nodes.
struct Level {
    /// The node of face 0; [`NONE`] where faces are input triangles.
    first_node: u32,
    complex: Complex,
}

impl Level {
    fn node(&self, face: u32) -> u32 {
        if self.first_node == NONE { self.complex.lowest[face as usize] } else { self.first_node + face }
    }

    /// Returns a base face as `3 * node + turn`, turned so its lowest wedge comes first.
    fn root(&self, face: usize) -> u32 {
        let [a, b, c] = self.complex.corners[face];
        let turn = if a < b && a < c { 0 } else { 1 + u32::from(c < b) };
        3 * self.node(face as u32) + turn
    }
}

/// Returns the first coarsening after the assumption `taken` which can itself be coarsened.
fn other_way(below: &Complex, surface: &FaceComplex, labels: &mut Labels, taken: u8) -> Option<Coarsening> {
    let mut from = taken + 1;
    while let Ok(other) = coarsen(below, surface, labels, from) {
        if coarsen(&other.coarse, surface, labels, 0).is_ok() {
            return Some(other);
        }
        from = other.assumption + 1;
    }
    None
}
