//! Coarsens a component by one level: merges faces in fours all over it, or says why this is impossible.
//!
//! ```text
//!     for each of the four states of the first face
//!         label all faces                                              (label.rs)
//!         group every centre with its three corner faces
//!             their corners are three points, each midpoint is one wedge, the material is one
//!             both halves of a side belong together in all faces along it
//!         the groups are the faces of the coarser complex, the pairs of halves its edges
//! ```
//!
//! The last condition cannot be checked on labels alone. It ensures six faces around every midpoint: three at a border, and
//! three for every face of an edge where many faces meet. Points need not be old or new everywhere: where several fans of faces
//! meet at a point, the point may be a midpoint in one fan and an old vertex in another.

use crate::mesh::NONE;

use super::complex::{Complex, FaceComplex};
use super::label::{CENTRE, Labels, Refusal, STATES};
use super::stop::Stop;

/// A coarser complex, with a quarter of the faces.
pub(super) struct Coarsening {
    pub coarse: Complex,
    /// Per coarse face, `3 * face + turn` for each child: corner `turn` of finer face `face` is the child's corner 0.
    pub children: Vec<[u32; 4]>,
    /// The state assumed for the first finer face.
    pub assumption: u8,
}

/// Coarsens a connected complex by the first consistent assumption, from `from` on. O(n).
pub(super) fn coarsen(
    complex: &Complex,
    surface: &FaceComplex,
    labels: &mut Labels,
    from: u8,
) -> Result<Coarsening, Stop> {
    let faces = complex.face_count() as u32;
    if faces <= 1 {
        return Err(Stop::SingleFace);
    }
    if !faces.is_multiple_of(4) {
        return Err(Stop::NotFourfold { faces });
    }
    let mut longest = Refusal { reached: 0, stop: Stop::Irregular { triangle: complex.lowest[0] } };
    for assumption in from..STATES {
        let labelled = labels.spread(complex, surface, assumption);
        match labelled.and_then(|()| group(complex, surface, labels, assumption)) {
            Ok(coarsening) => return Ok(coarsening),
            Err(refusal) if refusal.reached > longest.reached => longest = refusal,
            Err(_) => {}
        }
    }
    Err(longest.stop)
}

/// Builds the coarse complex from labelled faces.
fn group(
    complex: &Complex,
    surface: &FaceComplex,
    labels: &Labels,
    assumption: u8,
) -> Result<Coarsening, Refusal> {
    let faces = complex.face_count();
    let mut grouped = vec![false; faces];
    let mut sides = Sides::new(complex.edge_count);
    let mut lowest = Vec::with_capacity(faces / 4);
    let mut corners = Vec::with_capacity(faces / 4);
    let mut edges = Vec::with_capacity(faces / 4);
    let mut children = Vec::with_capacity(faces / 4);
    let mut turns = Vec::new();

    // In order of the lowest face of every group, so that coarse faces keep the order of the input's triangles.
    for face in 0..faces {
        if grouped[face] {
            continue;
        }
        let group = Group::around(complex, labels, face as u32);
        let checked = group.check(complex, surface).and_then(|()| group.edges(complex, &mut sides));
        match checked {
            Ok(own_edges) => edges.push(own_edges),
            Err(stop) => return Err(Refusal { reached: faces + face, stop }),
        }
        group.children.iter().for_each(|&child| grouped[(child / 3) as usize] = true);
        lowest.push(complex.lowest[face]);
        corners.push([0, 1, 2].map(|k| group.corner(complex, k, 0)));
        children.push(group.children);
        if !complex.turns.is_empty() {
            turns.push(complex.turns[(group.children[3] / 3) as usize]);
        }
    }
    let mut coarse = Complex::new(lowest, corners, edges, sides.count as usize);
    coarse.turns = turns;
    Ok(Coarsening { coarse, children, assumption })
}

/// Four faces to be merged: corner faces 0, 1, 2 and the centre, each as `3 * face + turn`.
struct Group {
    children: [u32; 4],
}

impl Group {
    /// Returns the group containing a face.
    fn around(complex: &Complex, labels: &Labels, face: u32) -> Self {
        let state = labels.state(face);
        let centre = if state == CENTRE {
            face
        } else {
            let inner_side = u32::from(state + 1) % 3;
            complex.next(3 * face + inner_side) / 3
        };
        // Corner face k lies across the centre's side from midpoint k - 1 to midpoint k.
        let corner_faces = [2, 0, 1].map(|side| {
            let corner_face = complex.next(3 * centre + side) / 3;
            3 * corner_face + u32::from(labels.state(corner_face))
        });
        let [a, b, c] = corner_faces;
        Self { children: [a, b, c, 3 * centre] }
    }

    /// Returns the wedge at corner `k` of a child.
    fn corner(&self, complex: &Complex, child: usize, k: u32) -> u32 {
        complex.corners.as_flattened()[turned(self.children[child], k)]
    }

    fn check(&self, complex: &Complex, surface: &FaceComplex) -> Result<(), Stop> {
        let triangle_of = |child: usize| complex.lowest[(self.children[child] / 3) as usize];
        let triangle = triangle_of(3);
        let [a, b, c] = [0, 1, 2].map(|child| surface.point(self.corner(complex, child, 0)));
        if a == b || b == c || c == a {
            return Err(Stop::RepeatedCorner { triangle });
        }
        for child in 0..3 {
            if surface.material(triangle_of(child)) != surface.material(triangle) {
                return Err(Stop::Material { triangle: triangle_of(child) });
            }
        }
        // Corner k of the centre is midpoint k: the centre turns as its parent does.
        if !self.children[..3].iter().all(|&child| complex.may_start(child)) {
            return Err(Stop::Irregular { triangle });
        }
        for k in 0..if surface.across_seams { 0 } else { 3 } {
            let midpoint = self.corner(complex, 3, k as u32);
            let before = self.corner(complex, k, 1);
            let after = self.corner(complex, (k + 1) % 3, 2);
            if before != midpoint || after != midpoint {
                return Err(Stop::Seam { triangle });
            }
        }
        Ok(())
    }

    /// Returns the coarse edges along the three sides.
    fn edges(&self, complex: &Complex, sides: &mut Sides) -> Result<[u32; 3], Stop> {
        let edge = |child: usize, side: u32| complex.edges.as_flattened()[turned(self.children[child], side)];
        let mut own = [NONE; 3];
        for (k, own) in own.iter_mut().enumerate() {
            let halves = [edge(k, 0), edge((k + 1) % 3, 2)];
            let triangle = complex.lowest[(self.children[k] / 3) as usize];
            *own = sides.join(halves).ok_or(Stop::Irregular { triangle })?;
        }
        Ok(own)
    }
}

/// Returns the index of corner or side `k` of a face given as `3 * face + turn`.
fn turned(face: u32, k: u32) -> usize {
    (face - face % 3 + (face % 3 + k) % 3) as usize
}

/// Pairs of edges: the halves of coarse edges.
struct Sides {
    /// The other half of every edge.
    mate: Vec<u32>,
    coarse: Vec<u32>,
    count: u32,
}

impl Sides {
    fn new(edges: usize) -> Self {
        Self { mate: vec![NONE; edges], coarse: vec![NONE; edges], count: 0 }
    }

    /// Returns the coarse edge of two halves; `None` if either half already has another mate. The mate relation is symmetric.
    fn join(&mut self, [a, b]: [u32; 2]) -> Option<u32> {
        let [i, j] = [a as usize, b as usize];
        if self.mate[i] == NONE && self.mate[j] == NONE {
            (self.mate[i], self.mate[j]) = (b, a);
            (self.coarse[i], self.coarse[j]) = (self.count, self.count);
            self.count += 1;
        }
        (self.mate[i] == b).then_some(self.coarse[i])
    }
}
