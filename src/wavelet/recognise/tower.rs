//! The coarse faces of all components, from input triangles up to the base, and the forest grown from them.

use crate::mesh::NONE;
use crate::wavelet::Quadrisection;

use super::Stop;
use super::coarsen::{Coarsening, coarsen};
use super::complex::{Complex, FaceComplex};
use super::label::Labels;

/// An unsplit face beside deeper faces: several triangles of the input. Corners are corners of the input: `3 * triangle + corner`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closing {
    pub lowest: u32,
    pub corners: [u32; 3],
    /// The midpoint on each side, or `NONE`.
    pub midpoints: [u32; 3],
}

/// All coarse faces so far. A *node* is an input triangle `t`, or `triangles + c` for coarse face `c`; below `4/3 *
/// 2^30`, so three times a node fits 32 bits.
pub(super) struct Tower {
    triangles: u32,
    /// Per coarse face, its children as `3 * node + turn`; for a closing face [`NONE`] and its number.
    children: Vec<[u32; 4]>,
    closings: Vec<Closing>,
}

impl Tower {
    pub fn new(triangles: u32) -> Self {
        Self { triangles, children: Vec::new(), closings: Vec::new() }
    }

    /// Number of input triangles, which are the first nodes.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// Adds a coarse face with its children as `3 * node + turn`. Returns its node.
    pub fn add_split(&mut self, children: [u32; 4]) -> u32 {
        let node = self.next_node();
        self.children.push(children);
        node
    }

    /// Adds a closing face. Returns its node.
    pub fn add_closing(&mut self, closing: Closing) -> u32 {
        self.closings.push(closing);
        self.add_split([NONE, self.closings.len() as u32 - 1, NONE, NONE])
    }

    fn closing(&self, node: u32) -> Option<&Closing> {
        match self.children.get(node.checked_sub(self.triangles)? as usize)? {
            [NONE, number, ..] => self.closings.get(*number as usize),
            _ => None,
        }
    }

    /// Number of coarse and of closing faces, to go back to.
    pub fn height(&self) -> [usize; 2] {
        [self.children.len(), self.closings.len()]
    }

    /// Removes faces above a height.
    pub fn truncate(&mut self, [children, closings]: [usize; 2]) {
        self.children.truncate(children);
        self.closings.truncate(closings);
    }

    /// Returns the most levels of splits below the faces above a height.
    pub fn levels_above(&self, height: [usize; 2]) -> u32 {
        let mut levels = vec![0; self.children.len() - height[0]];
        for at in 0..levels.len() {
            let four = &self.children[height[0] + at];
            if four[0] != NONE {
                let first = self.triangles as usize + height[0];
                let of_child =
                    |&child: &u32| (child as usize / 3).checked_sub(first).map_or(0, |at| levels[at]);
                levels[at] = 1 + four.iter().map(of_child).max().unwrap_or(0);
            }
        }
        levels.into_iter().max().unwrap_or(0)
    }

    /// Returns the node of the next coarse face.
    fn next_node(&self) -> u32 {
        self.triangles + self.children.len() as u32
    }

    /// Coarsens a component as often as possible, and adds its base faces to the roots.
    /// Returns the number of levels and why there are no more.
    pub fn raise(
        &mut self,
        complex: Complex,
        nodes: Nodes,
        surface: &FaceComplex,
        labels: &mut Labels,
        roots: &mut Vec<u32>,
    ) -> (u32, Stop) {
        let mut top = Level { nodes, complex };
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
                    let other = below
                        .as_ref()
                        .and_then(|(below, taken)| other_way(&below.complex, surface, labels, *taken));
                    let (Some((below, taken)), Some(other)) = (&mut below, other) else {
                        roots.extend((0..top.complex.face_count()).map(|face| top.root(face)));
                        return (levels, stop);
                    };
                    self.children.truncate((top.node(0) - self.triangles) as usize);
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
        Level { nodes: Nodes::From(first_node), complex: coarse }
    }

    /// Grows the forest level by level from roots given as `3 * node + turn`. Returns the leaves too, if any is made of several
    /// triangles.
    pub fn forest(self, roots: Vec<u32>) -> (Quadrisection, Option<Leaves>) {
        let base_faces = roots.len() as u32;
        let faces = self.triangles as usize + self.children.len();
        let mut queue = roots;
        queue.reserve_exact(faces.saturating_sub(queue.len()));
        let mut split = Vec::with_capacity(faces);
        while let Some(&face) = queue.get(split.len()) {
            let (node, turn) = (face / 3, face % 3);
            let is_split = node >= self.triangles && self.closing(node).is_none();
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
        let several = (!self.closings.is_empty()).then(|| self.number_leaves(&mut leaves));
        (Quadrisection::new(base_faces, split, leaves), several)
    }

    /// Numbers the leaves by their lowest triangle, from nodes to these numbers.
    fn number_leaves(&self, leaves: &mut [u32]) -> Leaves {
        let lowest_of = |node: u32| self.closing(node).map_or(node, |closing| closing.lowest);
        let mut node_at = vec![NONE; self.triangles as usize];
        for &leaf in leaves.iter().filter(|&&leaf| leaf != NONE) {
            node_at[lowest_of(leaf / 3) as usize] = leaf / 3;
        }
        let mut found = Leaves::default();
        let mut number_of = vec![NONE; self.triangles as usize];
        for (triangle, &node) in node_at.iter().enumerate().filter(|(_, node)| **node != NONE) {
            let number = found.lowest.len() as u32;
            number_of[triangle] = number;
            found.lowest.push(triangle as u32);
            let closing = self.closing(node);
            let own = [0, 1, 2].map(|k| 3 * triangle as u32 + k);
            found.corners.push(closing.map_or(own, |closing| closing.corners));
            if let Some(closing) = closing {
                found.midpoints.push((number, closing.midpoints));
            }
        }
        for leaf in leaves.iter_mut().filter(|leaf| **leaf != NONE) {
            *leaf = 3 * number_of[lowest_of(*leaf / 3) as usize] + *leaf % 3;
        }
        found
    }
}

/// Leaves of which some are several triangles. Corners are corners of the input: `3 * triangle + corner`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::wavelet) struct Leaves {
    /// The lowest triangle of each leaf, ascending.
    pub lowest: Vec<u32>,
    pub corners: Vec<[u32; 3]>,
    /// Leaves of several triangles, ascending, with the midpoint on each side or `NONE`.
    pub midpoints: Vec<(u32, [u32; 3])>,
}

/// The nodes of the faces of a complex.
pub(super) enum Nodes {
    /// Faces are input triangles.
    Triangles,
    /// Nodes in a row, from this one.
    From(u32),
    Listed(Vec<u32>),
}

/// A complex whose faces are nodes.
struct Level {
    nodes: Nodes,
    complex: Complex,
}

impl Level {
    fn node(&self, face: u32) -> u32 {
        match &self.nodes {
            Nodes::Triangles => self.complex.lowest[face as usize],
            Nodes::From(first) => first + face,
            Nodes::Listed(nodes) => nodes[face as usize],
        }
    }

    /// Returns a base face as `3 * node + turn`, turned so its lowest wedge comes first, as far as the face may be turned.
    fn root(&self, face: usize) -> u32 {
        let may_start = |&turn: &u32| self.complex.may_start(3 * face as u32 + turn);
        let turn = (0..3).filter(may_start).min_by_key(|&turn| self.complex.corners[face][turn as usize]);
        3 * self.node(face as u32) + turn.unwrap_or(0)
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
