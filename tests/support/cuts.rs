//! Cuts of vertex hierarchies, from the definition.

use multires::adapt::{Cut, LevelOfDetail, Refinements};
use multires::hierarchy::{HierarchyLod, VertexHierarchy};
use multires::view::{Answer, Bounds, Criterion, Motion};

/// Needs what a hash says, but for what needs its parents' hash: so any closed set can be asked for.
pub struct Random<'a> {
    hierarchy: &'a VertexHierarchy,
    needed: Vec<bool>,
}

impl<'a> Random<'a> {
    /// About `share` percent.
    pub fn new(hierarchy: &'a VertexHierarchy, seed: u64, share: u64) -> Self {
        let mut needed: Vec<bool> = Vec::new();
        for split in 0..hierarchy.split_count() as u32 {
            let hash =
                (u64::from(split) + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
            let own = hash % 100 < share;
            needed.push(own && hierarchy.parents(split).all(|parent| needed[parent as usize]));
        }
        Self { hierarchy, needed }
    }
}

impl Criterion for Random<'_> {
    fn needs(&self, bounds: &Bounds) -> Answer {
        let first = self.hierarchy.bounds(0);
        let split =
            (std::ptr::from_ref(bounds).addr() - std::ptr::from_ref(first).addr()) / size_of::<Bounds>();
        Answer::once(self.needed[split])
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

/// The triangles that are drawn, by number, as vertices of the hierarchy.
pub fn drawn(lod: &HierarchyLod) -> Vec<(u32, [u32; 3])> {
    let mut all = Vec::new();
    for group in 0..lod.groups() {
        let named = lod.triangles(group).iter().map(|t| match lod.vertices() {
            Some(vertices) => t.map(|slot| vertices[slot as usize]),
            None => *t,
        });
        all.extend(lod.surface().drawn(group).iter().copied().zip(named));
    }
    all.sort_unstable();
    all
}

/// The image of all triangles at a cut, less those with two equal corners.
pub fn image(hierarchy: &VertexHierarchy, cut: &Cut) -> Vec<(u32, [u32; 3])> {
    let triangles = hierarchy.triangles().iter().enumerate();
    let all = triangles.map(|(t, corners)| (t as u32, corners.map(|v| hierarchy.stand_in(v, cut))));
    all.filter(|(_, [a, b, c])| a != b && b != c && c != a).collect()
}

/// Whether a cut holds with each split those it needs.
pub fn is_closed(hierarchy: &VertexHierarchy, cut: &Cut) -> bool {
    let splits = (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split));
    let mut needed = splits.flat_map(|split| hierarchy.parents(split).chain(hierarchy.needs(split)));
    needed.all(|split| cut.holds(split))
}
