//! The order of splits in pages.
//!
//! ```text
//!     band       splits of like error, within a factor of about 1.4, so that a page's largest error says much of all of them
//!     place      within a band, by the centre of the split's bounds along a Morton curve
//! ```
//!
//! The splits of a page are asked for by like views. Numbers do not ascend from coarse to fine within a band, and so cannot order
//! splits of equal urgency and equal error; errors are told apart instead.

use crate::adapt::Refinements;
use crate::hierarchy::VertexHierarchy;

/// Cells of the Morton curve along an axis.
const CELLS: u32 = 1 << 16;

/// Returns the place of a cell along a Morton curve.
fn morton(cell: [u32; 3]) -> u64 {
    let spread =
        |number: u32| (0..16).fold(0, |spread, bit| spread | u64::from(number >> bit & 1) << (3 * bit));
    let [x, y, z] = cell.map(|number| spread(number.min(CELLS - 1)));
    x | y << 1 | z << 2
}

/// Splits in the order of their pages, the place of each, and what orders them.
pub(super) struct Order {
    pub splits: Vec<u32>,
    pub place: Vec<u32>,
    /// Per split, how many floats above its error is one that is larger than that of every child.
    pub above: Vec<u32>,
}

impl Order {
    /// Sorts the splits of a hierarchy in a box. O(n log n).
    pub fn new(of: &VertexHierarchy, [low, high]: [[f32; 3]; 2]) -> Self {
        let count = of.split_count() as u32;
        let mut splits: Vec<u32> = (0..count).collect();
        // The exponent and a bit.
        let band = |split: u32| u32::MAX - (of.error(split).to_bits() >> 22);
        let across = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f32::max);
        let place = |split: u32| {
            let centre = of.bounds(split).centre;
            // Casts map what is not finite, or beyond the box, to the ends.
            morton(std::array::from_fn(|axis| ((centre[axis] - low[axis]) / across * CELLS as f32) as u32))
        };
        splits.sort_by_cached_key(|&split| (band(split), place(split), split));
        let mut place = vec![0; count as usize];
        splits.iter().zip(0..).for_each(|(&split, at)| place[split as usize] = at);
        // A split has a larger number than its parents. Errors are not negative, so that their bits are in order.
        let mut above = vec![0; count as usize];
        for split in (0..count).rev() {
            let bits = of.error(split).to_bits() + above[split as usize];
            for parent in of.parents(split) {
                let own = of.error(parent).to_bits();
                let least = (bits + 1).saturating_sub(own);
                above[parent as usize] = least.max(above[parent as usize]);
            }
        }
        Self { splits, place, above }
    }
}
