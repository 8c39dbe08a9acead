//! Fetches what splits and collapses are going to read.
//!
//! A split follows a chain of reads, and most of them miss the cache: vertex, star, triangles, their places. A processor waits for one
//! after the other. Here the same link of many chains is read at a time, so it waits once for all.

use std::hint::black_box;

use super::VertexHierarchy;
use super::surface::{CutSurface, SplitSource};

/// Reads of a kind at a time. Of more, the first ones are left out.
const MOST: usize = 128;

/// What is to be read next.
struct Reads {
    at: [u32; MOST],
    count: usize,
}

impl Reads {
    fn new() -> Self {
        Self { at: [0; MOST], count: 0 }
    }

    fn push(&mut self, at: u32) {
        self.at[self.count % MOST] = at;
        self.count += 1;
    }

    fn iter(&self) -> impl Iterator<Item = u32> {
        self.at[..self.count.min(MOST)].iter().copied()
    }
}

impl CutSurface {
    /// Fetches what some splits (`true`) and collapses are going to read.
    pub(super) fn look_ahead(&self, hierarchy: &VertexHierarchy, changes: &[(u32, bool)]) {
        let Self { stars, output, .. } = self;
        let (mut moving, mut others, mut places) = (Reads::new(), Reads::new(), Reads::new());
        let mut sum = 0;
        for &(split, comes) in changes {
            hierarchy
                .brought(split)
                .for_each(|[vertex, to, _]| moving.push(output.name(if comes { to } else { vertex })));
            for triangle in hierarchy.owned(split) {
                let at = output.place.at(triangle);
                if comes {
                    let vertices = hierarchy.leaves(triangle);
                    sum ^= vertices.iter().fold(0, |sum, &leaf| sum ^ hierarchy.split_of[leaf as usize]);
                } else if let Some(names) =
                    output.groups[hierarchy.group_of(triangle)].indices.get(at as usize)
                {
                    names.iter().for_each(|&name| others.push(name));
                }
            }
        }
        for name in moving.iter() {
            stars.of(name).iter().for_each(|[corner, _]| places.push(output.place.at(corner / 3)));
        }
        for name in others.iter() {
            sum ^= stars.of(name).first().map_or(0, |[corner, _]| *corner);
        }
        if let [group] = &output.groups[..] {
            for at in places.iter() {
                sum ^= group.indices.get(at as usize).map_or(0, |corners| corners[0]);
            }
        }
        black_box(sum);
    }
}
