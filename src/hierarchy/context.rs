//! Error of a split left out of an otherwise fine mesh.
//!
//! A sequence measures each collapse among its neighbours at the time, which were coarse. A cut may leave a split out
//! while everything around it is at full resolution. Then the surface differs:
//!
//! ```text
//!      o---o---o              the leaves that x stands for (o) are drawn at x, all others where they are; how
//!     / \ / \ / \             far are the leaves, and the middles of the triangles at the rim, from the triangles
//!    w---o---x---w            between x and the rim?
//! ```
//!
//! The cut uses the larger of both errors. From close by, without this error one sample in forty missed a tolerance of
//! one pixel, with it one in a hundred. Remaining errors come from neighbouring splits left out together, and are covered
//! by the margin in `bounds.rs`.

use glam::DVec3;

use crate::geometry::{lists::Lists, parallel, triangle::distance_squared};
use crate::mesh::{Adjacency, NONE};

use super::VertexHierarchy;

/// Maximum number of leaves of a cluster. Larger clusters use only the error measured by the sequence.
const MOST_LEAVES: usize = 24;
/// Maximum number of triangles around a cluster. Where a hub has more, its triangles count only if it moves; where it
/// moves, the cluster uses only the error measured by the sequence.
const MOST_TRIANGLES: usize = 512;

/// Returns, per split, the distance from the input to the mesh without this split alone. `end`: per vertex, the end of
/// its run of leaves.
pub(super) fn lonely_errors(
    hierarchy: &VertexHierarchy,
    brings: &Lists,
    end: &[u32],
    positions: &[[f32; 3]],
) -> Vec<f32> {
    let count = brings.start.len() - 1;
    let adjacency = Adjacency::new(&hierarchy.triangles, hierarchy.leaves as usize);
    let one = |scratch: &mut Scratch, split: usize| {
        scratch.error(hierarchy, &adjacency, brings.get(split as u32), end, positions)
    };
    parallel::map_with(count, 256, one)
}

#[derive(Default)]
struct Scratch {
    /// Runs of leaves, and the vertex at which each run is drawn.
    runs: Vec<(std::ops::Range<u32>, u32)>,
    triangles: Vec<u32>,
    images: Vec<[DVec3; 3]>,
    points: Vec<DVec3>,
}

impl Scratch {
    fn error(
        &mut self,
        hierarchy: &VertexHierarchy,
        adjacency: &Adjacency,
        brings: &[u32],
        end: &[u32],
        positions: &[[f32; 3]],
    ) -> f32 {
        let position = |v: u32| DVec3::from_array(positions[v as usize].map(f64::from));
        let Self { runs, triangles, images, points } = self;
        runs.clear();
        for &vertex in brings {
            let to = hierarchy.substitute[vertex as usize];
            let first = hierarchy.first_leaf(to);
            let end = end[vertex as usize];
            match runs.iter_mut().find(|run| run.1 == to) {
                Some(run) => run.0 = first.min(run.0.start)..end.max(run.0.end),
                None => runs.push((first..end, to)),
            }
        }
        let leaves: usize = runs.iter().map(|run| run.0.len()).sum();
        if leaves > MOST_LEAVES {
            return 0.0;
        }
        let drawn = |leaf: u32| runs.iter().find(|run| run.0.contains(&leaf)).map_or(NONE, |run| run.1);
        let around = |counts: &dyn Fn(u32) -> bool| -> usize {
            let leaves = runs.iter().flat_map(|run| run.0.clone()).filter(|&leaf| counts(leaf));
            leaves.map(|leaf| adjacency.corners(leaf).len()).sum()
        };
        let moves = |leaf: u32| drawn(leaf) != leaf;
        let only_moved = around(&|_| true) > MOST_TRIANGLES;
        if only_moved && around(&moves) > MOST_TRIANGLES {
            return 0.0;
        }
        triangles.clear();
        points.clear();
        // Points moving farthest come first, so the others are soon found to be nearer.
        points.extend(brings.iter().map(|&vertex| position(hierarchy.first_leaf(vertex))));
        for (run, _) in runs.iter() {
            for leaf in run.clone() {
                points.push(position(leaf));
                if only_moved && !moves(leaf) {
                    continue;
                }
                triangles.extend(adjacency.corners(leaf).iter().map(|&corner| corner / 3));
            }
        }
        triangles.sort_unstable();
        triangles.dedup();
        images.clear();
        for &triangle in triangles.iter() {
            let corners = hierarchy.triangles[triangle as usize];
            let image = corners.map(|leaf| if drawn(leaf) == NONE { leaf } else { drawn(leaf) });
            if image[0] == image[1] || image[1] == image[2] || image[2] == image[0] {
                continue;
            }
            images.push(image.map(position));
            let [a, b, c] = corners.map(position);
            points.push((a + b + c) / 3.0);
        }
        if images.is_empty() {
            return 0.0;
        }
        let mut worst = 0.0_f64;
        // Points are in spatial order, so the triangle nearest to the last point is a good guess.
        let mut guess = 0;
        for &point in points.iter() {
            let mut nearest = distance_squared(&images[guess], point);
            if nearest <= worst {
                continue;
            }
            for (i, image) in images.iter().enumerate() {
                let distance = distance_squared(image, point);
                if distance < nearest {
                    (nearest, guess) = (distance, i);
                    if nearest <= worst {
                        break;
                    }
                }
            }
            worst = worst.max(nearest);
        }
        worst.sqrt() as f32
    }
}
