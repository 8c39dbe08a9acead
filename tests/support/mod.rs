//! What several tests share.

#![allow(dead_code)]

pub mod camera;
pub mod content;
pub mod lod;
pub mod naive;

use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, NewVertex};
use proptest::prelude::*;

/// Any mesh of a few vertices, with duplicates, degenerate triangles and unused vertices, and any legal sequence of it
/// with endpoint placement, seams torn or whole, any vertex in any other's place.
pub fn endpoint() -> impl Strategy<Value = (Mesh, CollapseSequence)> {
    raw().prop_map(|raw| raw.build(false))
}

/// The same for any placement.
pub fn any_placement() -> impl Strategy<Value = (Mesh, CollapseSequence)> {
    (raw(), any::<bool>()).prop_map(|(raw, new)| raw.build(new))
}

#[derive(Debug, Clone)]
struct Raw {
    places: Vec<u8>,
    triangles: Vec<[u8; 3]>,
    materials: Vec<u32>,
    steps: Vec<(Vec<[u8; 2]>, u8)>,
}

fn raw() -> impl Strategy<Value = Raw> {
    (1usize..40).prop_flat_map(|vertices| {
        let places = prop::collection::vec(0u8..60, vertices);
        let triangles = prop::collection::vec(any::<[u8; 3]>(), 0..60);
        let steps =
            prop::collection::vec((prop::collection::vec(any::<[u8; 2]>(), 0..4), any::<u8>()), 0..40);
        (places, triangles, steps).prop_flat_map(|(places, triangles, steps)| {
            let materials = prop::collection::vec(0u32..4, triangles.len());
            (Just(places), Just(triangles), prop_oneof![Just(Vec::new()), materials], Just(steps))
                .prop_map(|(places, triangles, materials, steps)| Raw { places, triangles, materials, steps })
        })
    })
}

impl Raw {
    /// Makes the random numbers legal: every choice is among the vertices that are live at that time.
    fn build(self, with_new: bool) -> (Mesh, CollapseSequence) {
        let count = self.places.len();
        let positions: Vec<[f32; 3]> = self.places.iter().map(|&p| [f32::from(p), 0.0, 1.0]).collect();
        let triangles: Vec<[u32; 3]> =
            self.triangles.iter().map(|t| t.map(|v| u32::from(v) % count as u32)).collect();
        let mesh = Mesh::new(positions, triangles).unwrap().with_materials(self.materials).unwrap();
        let topology = multires::mesh::Topology::new(&mesh);
        let mut live: Vec<u32> =
            (0..count as u32).filter(|&v| topology.wedge_of()[v as usize] == v).collect();
        let mut new: Vec<NewVertex> = Vec::new();
        let mut steps = Vec::new();
        for (choices, error) in self.steps {
            let mut step = Vec::new();
            for [a, b] in choices {
                if live.len() < 2 {
                    break;
                }
                let from = live.remove(usize::from(a) % live.len());
                if with_new && b % 3 > 0 {
                    let number = (count + new.len()) as u32;
                    let place = [f32::from(a) * 0.25, f32::from(b), 2.0];
                    step.push([from, number]);
                    let mut other = from;
                    // One wedge alone, or two.
                    if b % 3 == 2 {
                        other = live.remove(usize::from(b) % live.len());
                        step.push([other, number]);
                    }
                    new.push(NewVertex { from: [from, other], weight: 0.5, position: place });
                    live.push(number);
                } else {
                    step.push([from, live[usize::from(b) % live.len()]]);
                }
            }
            steps.push((step, f32::from(error)));
        }
        let sequence = CollapseSequence::from_collapses(&mesh, &new, steps).unwrap();
        (mesh, sequence)
    }
}
