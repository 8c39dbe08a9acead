//! Sheets: triangles over the same three points, simplified as a single triangle and given back separately.
//!
//! ```text
//!        front  a b c   material 0, wedges 0 1 2     leader: the one triangle that stars know
//!        back   a c b   material 1, wedges 3 5 4     layer:  wedges and material of each different triangle of a sheet,
//!        front  a b c   material 0, wedges 0 1 2             at the leader's corners
//!                                                    follower: every triangle but the leader; it dies with the leader
//! ```
//!
//! Foliage, cloth and many exported buildings hold each triangle twice, once per side. With four triangles at each
//! edge, such a mesh is manifold nowhere. As sheets it is an ordinary surface: oracles, metrics and errors see each
//! leader once. Edges are compared layer by layer, front with front and back with back.

use crate::geometry::lists::prefix_sum;
use crate::mesh::{Edges, NONE};

use super::classify::kind;

/// Most different triangles of a sheet. Triangles over the same points are left apart where more of them differ.
const MOST_LAYERS: usize = 8;

/// A triangle of a sheet, seen at the leader's corners.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Layer {
    /// Lowest triangle with these vertices, material and winding.
    pub triangle: u32,
    /// The vertices at the leader's corners, in the leader's order.
    pub vertices: [u32; 3],
    pub material: u32,
    /// True if wound opposite to the leader.
    pub opposite: bool,
}

impl Layer {
    fn carries_the_same(&self, other: &Self) -> bool {
        (self.vertices, self.material, self.opposite) == (other.vertices, other.material, other.opposite)
    }
}

/// Leaders and their followers. Empty where no two triangles coincide.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sheets {
    /// Start of each triangle's followers; length triangles + 1.
    start: Vec<u32>,
    followers: Vec<u32>,
    /// Layer of each follower. Per leader, layers different from all before them come first.
    layers: Vec<Layer>,
    /// Per triangle, number of followers different from it and from each other.
    different: Vec<u8>,
}

impl Sheets {
    /// Finds the sheets. Followers' corners in `triangles` become `NONE`. O(n + k log k), k: triangles sharing a bit of
    /// their hash with another; about 10 % of n where none coincide.
    pub fn new(
        triangles: &mut [[u32; 3]],
        vertices: impl Fn(u32) -> [u32; 3],
        material: impl Fn(u32) -> u32,
        points: usize,
    ) -> Self {
        let groups = Groups::new(triangles);
        if groups.members.is_empty() {
            return Self::default();
        }
        let layer = |leader: u32, of: u32| layer(triangles, leader, of, &vertices, &material);
        // Members of each group: first a member of each kind, then repetitions. Groups of too many kinds are left out.
        let mut ordered: Vec<u32> = Vec::with_capacity(groups.members.len());
        let mut spans: Vec<[usize; 3]> = Vec::new();
        let mut kinds: Vec<Layer> = Vec::new();
        let mut again: Vec<u32> = Vec::new();
        for group in groups.iter() {
            kinds.clear();
            again.clear();
            let first = ordered.len();
            for &member in group {
                let layer = layer(group[0], member);
                if kinds.iter().any(|known| known.carries_the_same(&layer)) {
                    again.push(member);
                } else if kinds.len() <= MOST_LAYERS {
                    kinds.push(layer);
                    ordered.push(member);
                }
            }
            if kinds.len() > MOST_LAYERS {
                ordered.truncate(first);
            } else {
                ordered.extend_from_slice(&again);
                spans.push([first, first + kinds.len(), ordered.len()]);
            }
        }

        // Choose leaders wound like their neighbours.
        let is_opposite = |[first, _, _]: [usize; 3], i: usize| layer(ordered[first], ordered[i]).opposite;
        let other_way = |&span: &[usize; 3]| (span[0]..span[1]).find(|&i| is_opposite(span, i));
        let others: Vec<Option<usize>> = spans.iter().map(other_way).collect();
        let mut leaders = triangles.to_vec();
        let mut free = vec![false; triangles.len()];
        for (&[first, _, last], other) in spans.iter().zip(&others) {
            ordered[first + 1..last].iter().for_each(|&t| leaders[t as usize] = [NONE; 3]);
            free[ordered[first] as usize] = other.is_some();
        }
        let turned = turned(&leaders, &free, points);
        for (&[first, _, _], other) in spans.iter().zip(&others) {
            if let (Some(other), true) = (*other, turned[ordered[first] as usize]) {
                ordered.swap(first, other);
            }
        }

        let mut sheets = Self {
            start: vec![0; triangles.len() + 1],
            different: vec![0; triangles.len()],
            ..Self::default()
        };
        for &[first, _, last] in &spans {
            sheets.start[ordered[first] as usize + 1] = (last - first - 1) as u32;
        }
        prefix_sum(&mut sheets.start);
        let count = sheets.start[triangles.len()] as usize;
        sheets.followers.resize(count, NONE);
        sheets.layers.resize(count, Layer::default());
        for &[first, different, last] in &spans {
            let leader = ordered[first];
            sheets.different[leader as usize] = (different - first - 1) as u8;
            let start = sheets.start[leader as usize] as usize;
            for (at, &follower) in ordered[first + 1..last].iter().enumerate() {
                sheets.followers[start + at] = follower;
                sheets.layers[start + at] = self::layer(triangles, leader, follower, &vertices, &material);
            }
        }
        sheets.followers.iter().for_each(|&t| triangles[t as usize] = [NONE; 3]);
        sheets
    }

    /// Returns true if no two triangles coincide.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// Number of followers.
    pub fn count(&self) -> usize {
        self.followers.len()
    }

    /// Returns the followers of `leader`, which die with it; empty for a follower.
    #[inline]
    pub fn followers(&self, leader: u32) -> &[u32] {
        &self.followers[self.span(leader)]
    }

    /// Returns the followers' layers different from the leader's and from each other.
    #[inline]
    pub fn layers(&self, leader: u32) -> &[Layer] {
        match self.different.get(leader as usize) {
            Some(&count) => &self.layers[self.start[leader as usize] as usize..][..count as usize],
            None => &[],
        }
    }

    /// Maps the followers' vertices at a corner of their leader.
    pub fn replace(&mut self, leader: u32, slot: usize, mut map: impl FnMut(u32) -> u32) {
        let Some(&count) = self.different.get(leader as usize) else { return };
        for layer in &mut self.layers[self.start[leader as usize] as usize..][..count as usize] {
            layer.vertices[slot] = map(layer.vertices[slot]);
        }
    }

    #[inline]
    fn span(&self, leader: u32) -> std::ops::Range<usize> {
        match self.start.get(leader as usize..leader as usize + 2) {
            Some(&[start, end]) => start as usize..end as usize,
            _ => 0..0,
        }
    }
}

/// Returns the layer of triangle `of` at the leader's corners.
fn layer(
    triangles: &[[u32; 3]],
    leader: u32,
    of: u32,
    vertices: impl Fn(u32) -> [u32; 3],
    material: impl Fn(u32) -> u32,
) -> Layer {
    let [corners, own] = [leader, of].map(|t| triangles[t as usize]);
    let slots = corners.map(|point| own.iter().position(|&p| p == point).unwrap_or(0));
    let carried = vertices(of);
    Layer {
        triangle: of,
        vertices: slots.map(|slot| carried[slot]),
        material: material(of),
        opposite: (slots[1] + 3 - slots[0]) % 3 == 2,
    }
}

/// Triangles over the same three points, each group in ascending order.
struct Groups {
    members: Vec<u32>,
    end: Vec<usize>,
}

impl Groups {
    /// Sorts only triangles sharing a bit of their hash with another: about 10 % where no triangles coincide.
    fn new(triangles: &[[u32; 3]]) -> Self {
        // Lowest, highest and middle point.
        let key = |&[a, b, c]: &[u32; 3]| {
            let (lowest, highest) = (a.min(b).min(c), a.max(b).max(c));
            [lowest, highest, a ^ b ^ c ^ lowest ^ highest]
        };
        let bits = (8 * triangles.len()).next_power_of_two().max(64).ilog2();
        let place = |triangle: &[u32; 3]| {
            let [a, b, c] = key(triangle).map(u64::from);
            let hash =
                (a | b << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ c.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
            let place = (hash ^ hash >> 29).wrapping_mul(0xff51_afd7_ed55_8ccd) >> (64 - bits);
            ((place >> 6) as usize, 1u64 << (place & 63))
        };
        let is_live = |triangle: &&[u32; 3]| triangle[0] != NONE;
        let [mut once, mut twice] = [(); 2].map(|()| vec![0u64; 1 << (bits - 6)]);
        for triangle in triangles.iter().filter(is_live) {
            let (word, bit) = place(triangle);
            twice[word] |= once[word] & bit;
            once[word] |= bit;
        }
        let shares = |triangle: &[u32; 3]| {
            let (word, bit) = place(triangle);
            twice[word] & bit != 0
        };
        let numbered = (0u32..).zip(triangles).filter(|(_, triangle)| is_live(triangle) && shares(triangle));
        let mut alike: Vec<([u32; 3], u32)> = numbered.map(|(t, triangle)| (key(triangle), t)).collect();
        alike.sort_unstable();
        let mut groups = Self { members: Vec::new(), end: Vec::new() };
        for run in alike.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
            groups.members.extend(run.iter().map(|&(_, triangle)| triangle));
            groups.end.push(groups.members.len());
        }
        groups
    }

    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let start = std::iter::once(0).chain(self.end.iter().copied());
        start.zip(&self.end).map(|(start, &end)| &self.members[start..end])
    }
}

/// Returns the triangles to turn: free triangles (which may be wound either way) must be wound like their
/// neighbours. Other triangles fix the winding. A component without any follows its lowest triangle.
fn turned(triangles: &[[u32; 3]], free: &[bool], points: usize) -> Vec<bool> {
    let mut turned = vec![false; triangles.len()];
    if !free.contains(&true) {
        return turned;
    }
    let edges = Edges::new(triangles, points);
    let edge_of = edges.of_half_edges(triangles.len());
    // The other triangle at an edge of two, and true if both run along the edge in the same direction.
    let across = |triangle: u32, edge: u32| match edges.half_edges(edge) {
        &[a, b] => {
            let (a, b) = (a / 3, b / 3);
            Some((if a == triangle { b } else { a }, edges.is_flipped(edge)))
        }
        _ => None,
    };
    let mut known: Vec<bool> = free.iter().map(|free| !free).collect();
    let mut waiting: Vec<u32> = Vec::new();
    for seed_anywhere in [false, true] {
        for seed in 0..triangles.len() as u32 {
            if known[seed as usize] {
                continue;
            }
            let neighbours = || edge_of[seed as usize].iter().filter_map(|&edge| across(seed, edge));
            match neighbours().find(|&(other, _)| known[other as usize]) {
                Some((other, clashes)) => turned[seed as usize] = turned[other as usize] ^ clashes,
                None if seed_anywhere => {}
                None => continue,
            }
            known[seed as usize] = true;
            waiting.push(seed);
            while let Some(triangle) = waiting.pop() {
                for &edge in &edge_of[triangle as usize] {
                    if let Some((other, clashes)) = across(triangle, edge)
                        && !known[other as usize]
                    {
                        known[other as usize] = true;
                        turned[other as usize] = turned[triangle as usize] ^ clashes;
                        waiting.push(other);
                    }
                }
            }
        }
    }
    turned
}

/// An edge of a layer: true if it runs from the first end to the second, its vertices at the ends, and its material.
pub(crate) type LayerEdge = (bool, [u32; 2], u32);

/// Classifies an edge between two sheets, as `kind` bits: a seam or material border where a layer on either side does
/// not continue on the other. `before` and `beyond`: edges of the layers on either side, from the same end.
pub(crate) fn edge_between(
    before: impl Iterator<Item = LayerEdge> + Clone,
    beyond: impl Iterator<Item = LayerEdge> + Clone,
) -> u16 {
    // A layer continues in a layer running the other way along the edge. Where each side has a single direction, the
    // directions may clash.
    let ways_differ = !(runs_one_way(before.clone()) && runs_one_way(beyond.clone()));
    let differ = |wedges: bool, materials: bool| {
        let go_on = |a: LayerEdge, b: LayerEdge| {
            (!ways_differ || a.0 != b.0) && (!wedges || a.1 == b.1) && (!materials || a.2 == b.2)
        };
        !before.clone().all(|a| beyond.clone().any(|b| go_on(a, b)))
            || !beyond.clone().all(|b| before.clone().any(|a| go_on(a, b)))
    };
    let is_seam = differ(true, false);
    let is_border = differ(false, true)
        || before.clone().count() != beyond.clone().count()
        || !is_seam && differ(true, true);
    (if is_seam { kind::SEAM } else { 0 }) | (if is_border { kind::MATERIAL } else { 0 })
}

fn runs_one_way(mut edges: impl Iterator<Item = LayerEdge>) -> bool {
    let first = edges.next().is_some_and(|edge| edge.0);
    edges.all(|edge| edge.0 == first)
}
