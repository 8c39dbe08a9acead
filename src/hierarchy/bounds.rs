//! Bounds of splits: spheres, cones of normals and errors. Bounds of a split contain the bounds of all splits building on
//! it.
//!
//! A split moves corners of the triangles around its vertices. The bounds of a split contain the input's triangles around
//! all leaves represented by these vertices, and the bounds of its children. Southern (section 5.1.1) bounds the
//! operations' regions of the coarse mesh. Here the bounds use the input's surface, with places and normals independent
//! of the cut.

use glam::DVec3;

use crate::adapt::Refinements;
use crate::geometry::rounding;
use crate::view::{Bounds, angle_between};

use super::VertexHierarchy;

/// Relative enlargement of spheres, so containment survives rounding.
const ROOM: f64 = 4e-7;

/// Ratio of the error at a cut to the error measured for single collapses, if several neighbouring splits are left out.
/// With it 999 of 1000 points are within the tolerance (measured on scans, `tests/hierarchy/screen_error.rs`).
const CUT_MARGIN: f32 = 4.0 / 3.0;

#[derive(Clone, Copy)]
struct Region {
    low: DVec3,
    high: DVec3,
    /// Sum of normals, weighted by area.
    normal: DVec3,
}

impl Region {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, normal: DVec3::ZERO };

    fn join(&mut self, other: &Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.normal += other.normal;
    }
}

/// Computes the bounds of every split. `error` is each split's own error. O(triangles + hops of all leaves to their
/// roots).
pub(super) fn bounds(hierarchy: &VertexHierarchy, positions: &[[f32; 3]], error: &[f32]) -> Vec<Bounds> {
    let count = error.len();
    let (around, normals) = around_leaves(hierarchy, positions);
    let own = own_regions(hierarchy, &around, count);
    let region = nested_regions(hierarchy, &own);
    let parametric = parametric_errors(hierarchy, positions, count);
    let axis: Vec<DVec3> = region.iter().map(|r| r.normal.normalize_or_zero()).collect();
    let angle = cone_angles(hierarchy, &normals, &axis);

    let mut all = vec![Bounds::new([0.0; 3], 0.0, 0.0, 0.0); count];
    for split in (0..count as u32).rev() {
        let s = split as usize;
        let mut normal_error = error[s] * CUT_MARGIN;
        let mut far = parametric[s];
        let mut wide = if axis[s] == DVec3::ZERO { f64::INFINITY } else { angle[s] };
        for child in hierarchy.children(split) {
            let bounds = &all[child as usize];
            normal_error = normal_error.max(bounds.error);
            far = far.max(f64::from(bounds.parametric));
            wide = match bounds.cone() {
                Some((child_axis, child_angle)) => {
                    wide.max(angle_between(axis[s], DVec3::from_array(child_axis)) + child_angle)
                }
                None => f64::INFINITY,
            };
        }
        let far = rounding::up_short(far * (1.0 + 1e-9));
        let (centre, radius) = sphere(hierarchy, split, &region[s], &own[s], &all);
        // The distance of a point to the drawn surface is at most its distance to the place where it is drawn.
        all[s] = Bounds::new(centre, radius, normal_error.min(far), far)
            .with_cone(axis[s].to_array(), wide + 1e-6);
    }
    all
}

fn at(positions: &[[f32; 3]], vertex: u32) -> DVec3 {
    DVec3::from_array(positions[vertex as usize].map(f64::from))
}

/// Returns the region of the input's triangles around every leaf, and the unit normal of every triangle.
fn around_leaves(hierarchy: &VertexHierarchy, positions: &[[f32; 3]]) -> (Vec<Region>, Vec<DVec3>) {
    let mut around = vec![Region::EMPTY; hierarchy.leaves as usize];
    let normals = hierarchy
        .triangles
        .iter()
        .map(|corners| {
            let [a, b, c] = corners.map(|leaf| at(positions, leaf));
            let normal = (b - a).cross(c - a);
            let region = Region { low: a.min(b).min(c), high: a.max(b).max(c), normal };
            corners.iter().for_each(|&leaf| around[leaf as usize].join(&region));
            normal.normalize_or_zero()
        })
        .collect();
    (around, normals)
}

/// Returns, per split, the region of its own leaves. Leaves into which nothing was merged lie in no child's bounds.
fn own_regions(hierarchy: &VertexHierarchy, around: &[Region], count: usize) -> Vec<Region> {
    let mut own = vec![Region::EMPTY; count];
    for leaf in 0..hierarchy.leaves {
        let split = hierarchy.split_of[leaf as usize];
        if split != u32::MAX {
            own[split as usize].join(&around[leaf as usize]);
        }
    }
    own
}

/// Returns, per split, its own region joined with its children's.
fn nested_regions(hierarchy: &VertexHierarchy, own: &[Region]) -> Vec<Region> {
    let mut region = own.to_vec();
    for split in (0..own.len() as u32).rev() {
        for child in hierarchy.children(split) {
            let child = region[child as usize];
            region[split as usize].join(&child);
        }
    }
    region
}

/// Returns, per split, the largest distance of a leaf from the vertex that takes its place without the split.
fn parametric_errors(hierarchy: &VertexHierarchy, positions: &[[f32; 3]], count: usize) -> Vec<f64> {
    let mut parametric = vec![0.0_f64; count];
    for leaf in 0..hierarchy.leaves {
        let from = at(positions, leaf);
        let mut vertex = leaf;
        while !hierarchy.is_root(vertex) {
            let far = &mut parametric[hierarchy.split_of[vertex as usize] as usize];
            vertex = hierarchy.substitute[vertex as usize];
            *far = far.max(from.distance(at(positions, vertex)));
        }
    }
    parametric
}

/// Returns, per split, the largest angle of its axis to the normals around its own leaves, radians.
fn cone_angles(hierarchy: &VertexHierarchy, normals: &[DVec3], axis: &[DVec3]) -> Vec<f64> {
    let mut angle = vec![0.0_f64; axis.len()];
    for (corners, &normal) in hierarchy.triangles.iter().zip(normals) {
        if normal == DVec3::ZERO {
            continue;
        }
        for &leaf in corners {
            let split = hierarchy.split_of[leaf as usize];
            if split != u32::MAX {
                let to = &mut angle[split as usize];
                *to = to.max(angle_between(axis[split as usize], normal));
            }
        }
    }
    angle
}

/// Returns a sphere around a split's own region and its children's spheres. Tries two centres: the middle of the box, and
/// the centre of the joined spheres. Returns the smaller sphere.
fn sphere(
    hierarchy: &VertexHierarchy,
    split: u32,
    region: &Region,
    own: &Region,
    all: &[Bounds],
) -> ([f32; 3], f32) {
    let ball = |b: &Bounds| (DVec3::from_array(b.centre.map(f64::from)), f64::from(b.radius));
    if region.low.x > region.high.x {
        return ([0.0; 3], 0.0);
    }
    let to_own = |centre: DVec3| {
        if own.low.x > own.high.x {
            return 0.0;
        }
        (own.low - centre).abs().max((own.high - centre).abs()).length()
    };
    let needed = |centre: DVec3| {
        let balls = hierarchy.children(split).map(|child| {
            let (middle, radius) = ball(&all[child as usize]);
            centre.distance(middle) + radius
        });
        balls.fold(to_own(centre), f64::max)
    };
    let middle = (region.low + region.high) * 0.5;
    let mut best = (round(middle), 0.0);
    best.1 = needed(best.0);

    // Joins the own box's sphere and the children's spheres, one after another, each pair into its smallest enclosing
    // sphere.
    let mut joined: Option<(DVec3, f64)> =
        (own.low.x <= own.high.x).then(|| ((own.low + own.high) * 0.5, (own.high - own.low).length() * 0.5));
    for child in hierarchy.children(split) {
        let (b, s) = ball(&all[child as usize]);
        joined = Some(match joined {
            None => (b, s),
            Some((a, r)) => {
                let apart = a.distance(b);
                if apart + s <= r {
                    (a, r)
                } else if apart + r <= s {
                    (b, s)
                } else {
                    let radius = (apart + r + s) * 0.5;
                    (a + (b - a) * ((radius - r) / apart), radius)
                }
            }
        });
    }
    if let Some((centre, _)) = joined {
        let centre = round(centre);
        let radius = needed(centre);
        if radius < best.1 {
            best = (centre, radius);
        }
    }
    let (centre, radius) = best;
    // Enlargement in proportion to the coordinates too, because a centre is rounded to single precision.
    let scale = hierarchy.diagonal * 1e-9 + centre.abs().max_element() * 1e-12;
    (centre.as_vec3().to_array(), rounding::up_short(radius * (1.0 + ROOM) + scale))
}

/// Rounds a vector to single precision.
fn round(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}
