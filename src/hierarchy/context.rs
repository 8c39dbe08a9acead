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

use crate::mesh::{Adjacency, NONE};

use super::{Lists, VertexHierarchy};

/// Maximum number of leaves of a cluster. Larger clusters use only the error measured by the sequence.
const MOST_LEAVES: usize = 24;

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
    let one = |scratch: &mut Scratch, split: u32| {
        scratch.error(hierarchy, &adjacency, brings.get(split), end, positions)
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count as u32).into_par_iter().with_min_len(256).map_init(Scratch::default, one).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut scratch = Scratch::default();
        (0..count as u32).map(|split| one(&mut scratch, split)).collect()
    }
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
        triangles.clear();
        points.clear();
        // Points moving farthest come first, so the others are soon found to be nearer.
        points.extend(brings.iter().map(|&vertex| position(hierarchy.first_leaf(vertex))));
        for (run, _) in runs.iter() {
            for leaf in run.clone() {
                points.push(position(leaf));
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
            let mut nearest = distance_squared(point, &images[guess]);
            if nearest <= worst {
                continue;
            }
            for (i, image) in images.iter().enumerate() {
                let distance = distance_squared(point, image);
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

/// Returns the squared distance from a point to a triangle.
fn distance_squared(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    let inside = area > 0.0
        && ab.cross(ap).dot(normal) >= 0.0
        && ap.cross(ac).dot(normal) >= 0.0
        && (c - b).cross(p - b).dot(normal) >= 0.0;
    if inside {
        return ap.dot(normal).powi(2) / area;
    }
    let side = |a: DVec3, b: DVec3| {
        let (along, to) = (b - a, p - a);
        let length = along.length_squared();
        let t = if length > 0.0 { (to.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
        (to - along * t).length_squared()
    };
    side(a, b).min(side(b, c)).min(side(c, a))
}
