//! Keeps solved texture coordinates from flipping triangles: where a fit mirrors a triangle, its corners return to their
//! values before the fit, which the simplifier has checked.

use crate::geometry::texture::side;
use crate::mesh::{Attribute, names};

/// Number of passes after which the corners of all triangles go back.
const PASSES: usize = 12;

/// Replaces values of `after` by values of `before`, vertex by vertex, until no triangle lies on another side of
/// texture space than before, in any set of coordinates. Vertices with equal positions and equal values before keep
/// equal values. O(triangles) a pass; a few passes.
pub(super) fn keep_sides(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    before: &[Attribute],
    after: &mut [Attribute],
) {
    for (before, after) in before.iter().zip(after) {
        if names::is_set_of(before.name(), names::UV)
            && before.width() == 2
            && let (Some(before), Some(after)) = (before.as_floats(), after.floats_mut())
        {
            keep(positions, triangles, before, after);
        }
    }
}

fn keep(positions: &[[f32; 3]], triangles: &[[u32; 3]], before: &[f32], after: &mut [f32]) {
    let at = |values: &[f32], v: u32| [values[2 * v as usize], values[2 * v as usize + 1]];
    // Filled when the first triangle is flipped: mostly none is.
    let mut order: Vec<u32> = Vec::new();
    let key = |v: u32| (positions[v as usize].map(f32::to_bits), at(before, v).map(f32::to_bits));
    let mut back = vec![false; positions.len()];
    for pass in 0.. {
        let mut any = false;
        for &t in triangles {
            let was = side(t.map(|v| at(before, v)));
            // A triangle flattened to a line counts too: it could come back on the other side.
            if side(t.map(|v| at(after, v))) != was || pass == PASSES {
                any |= t.iter().any(|&v| !back[v as usize]);
                t.iter().for_each(|&v| back[v as usize] = true);
            }
        }
        if !any {
            return;
        }
        if order.is_empty() {
            order.extend(0..positions.len() as u32);
            order.sort_unstable_by_key(|&v| (key(v), v));
        }
        for same in order.chunk_by(|&a, &b| key(a) == key(b)) {
            let goes = same.iter().any(|&v| back[v as usize]);
            for &v in same.iter().filter(|_| goes) {
                back[v as usize] = true;
                after[2 * v as usize..][..2].copy_from_slice(&at(before, v));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests a fan of four triangles whose middle was moved across its rim in texture space, among other triangles.
    #[test]
    fn a_mirrored_corner_goes_back_and_others_stay() {
        let rim = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [9.0, 9.0], [9.0, 8.0]];
        let positions: Vec<[f32; 3]> = (0..7).map(|v| [v as f32, 0.0, 0.0]).collect();
        let triangles = [[0, 1, 6], [1, 2, 6], [2, 3, 6], [3, 0, 6], [2, 1, 5]];
        let uv = |middle: [f32; 2], far: [f32; 2]| {
            let mut values: Vec<[f32; 2]> = rim.to_vec();
            values[5] = far;
            values.push(middle);
            vec![Attribute::floats(names::UV, &values)]
        };
        let before = uv([2.0, 2.0], [9.0, 8.0]);
        for (middle, expected) in [([1.0, 1.5], [1.0, 1.5]), ([5.0, 2.0], [2.0, 2.0])] {
            let mut after = uv(middle, [8.0, 7.0]);
            keep_sides(&positions, &triangles, &before, &mut after);
            assert_eq!(after, uv(expected, [8.0, 7.0]));
        }
    }

    /// A triangle flat in texture space before stays flat, whatever the fit says.
    #[test]
    fn a_line_gets_no_side() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let uv = |middle: [f32; 2]| vec![Attribute::floats(names::UV, &[[0.0, 0.0], middle, [4.0, 0.0]])];
        let mut after = uv([2.0, 1.0]);
        keep_sides(&positions, &[[0, 1, 2]], &uv([2.0, 0.0]), &mut after);
        assert_eq!(after, uv([2.0, 0.0]));
    }
}
