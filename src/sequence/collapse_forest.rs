//! The substitutions of a sequence as a forest, checked once: which vertex replaces which, when, and when triangles
//! vanish.
//!
//! ```text
//!     number   0 ... roots  | last removed ... first removed | duplicates | unused
//!              stay to the end   reverse order of removal      aliases      roots that nothing names
//! ```
//!
//! A vertex is only ever substituted by a vertex removed later, so in this numbering every parent is lower than its
//! children. Two vertices merge at the lower of two children: the children of their lowest common ancestor through which
//! their paths reach it. Skew-binary jump pointers (Myers 1983) find it in O(log n) however long the chains are.
//!
//! A triangle is degenerate, and in no level, where two of its corners have the same position in the input: as a single
//! vertex or as two wedges. The simplifier, working on points, does the same.

use std::borrow::Cow;

use crate::mesh::{Mesh, NONE};

use super::validate::expect;
use super::{CollapseSequence, SequenceError};

/// Vertices of a sequence by reverse order of removal, and the forest of their substitutions.
pub(crate) struct CollapseForest<'a> {
    positions: Cow<'a, [[f32; 3]]>,
    /// Per number, the vertex of the sequence.
    pub order: Vec<u32>,
    /// Per vertex of the sequence, its number.
    pub number: Vec<u32>,
    /// Per number, the steps after which it is gone: 0 for a duplicate, `NONE` where it stays.
    pub removed: Vec<u32>,
    /// Numbers below this stay to the end and are used.
    pub roots: u32,
    /// Numbers from `roots` to here are removed by a step; then follow duplicates, then unused vertices.
    pub real: u32,
    forest: Forest,
}

impl<'a> CollapseForest<'a> {
    /// Reads a sequence against the mesh it was made from. O(vertices + substitutions + triangles).
    ///
    /// Nothing in the sequence is trusted: every structure built from it relies on this check alone.
    pub fn new(mesh: &'a Mesh, sequence: &CollapseSequence) -> Result<Self, SequenceError> {
        let inputs = mesh.positions().len();
        expect("input vertices", sequence.input_vertices(), inputs)?;
        expect("input triangles", sequence.input_triangles(), mesh.triangles().len())?;
        sequence.check_tables()?;
        let count = sequence.vertex_count();
        let mut parent = vec![NONE; count];
        let mut removed = vec![NONE; count];
        let mut named = vec![false; count];

        for &[duplicate, kept] in &sequence.aliases {
            for vertex in [duplicate, kept] {
                if vertex as usize >= inputs {
                    return Err(SequenceError::VertexOutOfRange { step: 0, vertex, vertices: inputs });
                }
            }
            if duplicate == kept || parent[duplicate as usize] != NONE || parent[kept as usize] != NONE {
                return Err(SequenceError::NotLive { step: 0, vertex: duplicate });
            }
            parent[duplicate as usize] = kept;
            removed[duplicate as usize] = 0;
        }

        let mut removal = Vec::with_capacity(sequence.substitutions.len());
        for step in 0..sequence.len() {
            for &[from, to] in sequence.substitutions(step) {
                for vertex in [from, to] {
                    if vertex as usize >= count {
                        return Err(SequenceError::VertexOutOfRange { step, vertex, vertices: count });
                    }
                }
                let (f, t) = (from as usize, to as usize);
                if from == to {
                    return Err(SequenceError::SelfSubstitution { step, vertex: from });
                }
                // A new vertex is born when first named as a target.
                if parent[f] != NONE || (f >= inputs && !named[f]) {
                    return Err(SequenceError::NotLive { step, vertex: from });
                }
                if parent[t] != NONE {
                    return Err(SequenceError::NotLive { step, vertex: to });
                }
                parent[f] = to;
                removed[f] = step as u32 + 1;
                (named[f], named[t]) = (true, true);
                removal.push(from);
            }
        }

        let positions = sequence.placed(mesh);
        let fold = |v: u32| if removed[v as usize] == 0 { parent[v as usize] } else { v };
        for corners in mesh.triangles() {
            let corners = corners.map(fold);
            if !meets_itself(&positions, corners) {
                corners.iter().for_each(|&v| named[v as usize] = true);
            }
        }

        let mut order = Vec::with_capacity(count);
        let all = || 0..count as u32;
        order.extend(all().filter(|&v| removed[v as usize] == NONE && named[v as usize]));
        let roots = order.len() as u32;
        order.extend(removal.iter().rev());
        let real = order.len() as u32;
        order.extend(all().filter(|&v| removed[v as usize] == 0));
        order.extend(all().filter(|&v| removed[v as usize] == NONE && !named[v as usize]));

        let mut number = vec![NONE; count];
        for (i, &v) in order.iter().enumerate() {
            number[v as usize] = i as u32;
        }
        let parents = order.iter().enumerate().map(|(i, &v)| match parent[v as usize] {
            NONE => i as u32,
            to => number[to as usize],
        });
        let forest = Forest::new(parents.collect());
        let removed = order.iter().map(|&v| removed[v as usize]).collect();
        Ok(Self { positions, order, number, removed, roots, real, forest })
    }

    /// Returns the number which replaces `number`; `number` itself where it stays.
    pub fn parent(&self, number: u32) -> u32 {
        self.forest.parent[number as usize]
    }

    /// Returns the number of a vertex of the sequence, duplicates folded.
    pub fn folded(&self, vertex: u32) -> u32 {
        let number = self.number[vertex as usize];
        if self.removed[number as usize] == 0 { self.parent(number) } else { number }
    }

    /// Returns the steps after which an input triangle is gone: 0 where two corners share a position, `NONE` where it
    /// stays. O(log n).
    pub fn end(&self, triangle: [u32; 3]) -> u32 {
        let corners = triangle.map(|v| self.folded(v));
        if meets_itself(&self.positions, corners.map(|number| self.order[number as usize])) {
            return 0;
        }
        self.forest.vanishes(corners).map_or(NONE, |number| self.removed[number as usize])
    }
}

/// Parent pointers with jump pointers over them; every parent is lower than its child, a root is its own parent.
pub(crate) struct Forest {
    parent: Vec<u32>,
    jump: Vec<u32>,
    depth: Vec<u32>,
}

impl Forest {
    /// Builds the jump pointers. O(n); 12 bytes a vertex. The caller ensures `parent[v] <= v`.
    pub fn new(parent: Vec<u32>) -> Self {
        let mut jump: Vec<u32> = Vec::with_capacity(parent.len());
        let mut depth: Vec<u32> = Vec::with_capacity(parent.len());
        for (v, &p) in parent.iter().enumerate() {
            let p = p as usize;
            if p >= v {
                jump.push(v as u32);
                depth.push(0);
                continue;
            }
            let (near, far) = (jump[p] as usize, jump[jump[p] as usize] as usize);
            let even = depth[p] - depth[near] == depth[near] - depth[far];
            jump.push(if even { far as u32 } else { p as u32 });
            depth.push(depth[p] + 1);
        }
        Self { parent, jump, depth }
    }

    /// Returns the vertex whose substitution makes a triangle of three different vertices degenerate; `None` if no
    /// substitution does. This is the earliest merge of the three pairs, so the highest number. O(log n).
    pub fn vanishes(&self, [a, b, c]: [u32; 3]) -> Option<u32> {
        self.merge(a, b).max(self.merge(b, c)).max(self.merge(c, a))
    }

    /// Returns the vertex whose substitution merges two different vertices.
    fn merge(&self, a: u32, b: u32) -> Option<u32> {
        let depth = |v: u32| self.depth[v as usize];
        let parent = |v: u32| self.parent[v as usize];
        let (mut a, mut b) = if depth(a) >= depth(b) { (a, b) } else { (b, a) };
        if depth(a) > depth(b) {
            let below = depth(b) + 1;
            while depth(a) > below {
                let far = self.jump[a as usize];
                a = if depth(far) >= below { far } else { parent(a) };
            }
            if parent(a) == b {
                return Some(a);
            }
            a = parent(a);
        }
        // Equal depths jump equally far.
        while parent(a) != parent(b) {
            if depth(a) == 0 {
                return None;
            }
            let far = [self.jump[a as usize], self.jump[b as usize]];
            [a, b] = if far[0] == far[1] { [parent(a), parent(b)] } else { far };
        }
        Some(a.min(b))
    }
}

/// Whether two corners of a triangle have the same position: equal vertices, or different wedges of a point.
fn meets_itself(positions: &[[f32; 3]], corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|v| positions[v as usize]);
    a == b || b == c || c == a
}

/// Whether a triangle has two equal corners.
pub(crate) fn is_degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the forest with a plain walk: substitute the highest corner until two agree.
    #[test]
    fn vanishing_agrees_with_the_walk() {
        let mut state = 7u32;
        let mut random = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        for shape in 0..20 {
            let parents: Vec<u32> = (0..200u32)
                .map(|v| match (v, shape) {
                    (0..5, _) => v,
                    (_, 0) => v - 1,
                    (_, 1) => v - 5,
                    _ => v - 1 - random(v.min(3 * shape)),
                })
                .collect();
            let forest = Forest::new(parents.clone());
            for _ in 0..500 {
                let mut corners = [random(200), random(200), random(200)];
                if is_degenerate(corners) {
                    continue;
                }
                let found = forest.vanishes(corners);
                let mut last = None;
                while !is_degenerate(corners) {
                    let Some(high) = corners.iter_mut().filter(|v| parents[**v as usize] != **v).max() else {
                        last = None;
                        break;
                    };
                    last = Some(*high);
                    *high = parents[*high as usize];
                }
                assert_eq!(found, last);
            }
        }
    }
}
