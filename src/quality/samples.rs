//! Points spread evenly over a surface or along its edges: a point per equal share of area or length, ordered so that
//! consecutive points are neighbours.
//!
//! ```text
//!     shares    |-----|-----|-----|-----|-----|        one jittered position in each share of the total
//!     elements  |--------|---|------------|---|        the element under it, and how far along it is
//! ```
//!
//! On an edge, the distance along the element gives the point. In a triangle, it is a position on Sierpinski's curve.
//! The curve halves the triangle from the apex to the middle of the opposite edge, again and again: equal stretches of
//! the curve cover equal areas. So each sample has its own piece of surface of equal area, across triangles of any
//! size. Neighbours in order are neighbours in space, which speeds up the search for the nearest point.

use crate::geometry::hash;

/// Halvings of a triangle: its samples lie on a grid of 2^12 by 2^12 steps.
const HALVINGS: u32 = 24;

/// Elements (triangles, edges) laid end to end by their measure (area, length).
pub(crate) struct Shares {
    /// End of each element: running sum of the measures.
    ends: Vec<f64>,
    samples: usize,
    seed: u64,
}

impl Shares {
    /// Lays `samples` positions over elements of the given measures.
    pub(crate) fn new(measures: impl Iterator<Item = f64>, samples: usize, seed: u64) -> Self {
        let mut total = 0.0;
        let ends = measures
            .map(|m| {
                total += m;
                total
            })
            .collect();
        Self { ends, samples, seed }
    }

    /// Returns the number of samples.
    pub(crate) fn len(&self) -> usize {
        if self.ends.is_empty() { 0 } else { self.samples }
    }

    /// Returns the element and the position along it (0..1) of each sample of a range.
    pub(crate) fn positions(&self, range: std::ops::Range<usize>) -> impl Iterator<Item = (usize, f64)> + '_ {
        let total = self.ends.last().copied().unwrap_or(0.0);
        let share = total / self.samples.max(1) as f64;
        let mut element = self.ends.partition_point(|&end| end <= range.start as f64 * share);
        range.map(move |sample| {
            let position = (sample as f64 + hash::unit(self.seed, sample as u64)) * share;
            while element + 1 < self.ends.len() && self.ends[element] <= position {
                element += 1;
            }
            let start = if element == 0 { 0.0 } else { self.ends[element - 1] };
            let measure = self.ends[element] - start;
            let along = if measure > 0.0 { (position - start) / measure } else { 0.5 };
            (element, along.clamp(0.0, 1.0))
        })
    }
}

/// Returns the weights of a triangle's corners at a position (0..1) on its Sierpinski curve from the first corner to
/// the second. Preserves measure: evenly spread positions give evenly spread points of the area.
pub(crate) fn sierpinski(along: f64) -> [f64; 3] {
    // The piece's two ends on the curve and its apex, as weights of the second and third corner.
    let (mut from, mut to, mut apex) = ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]);
    let mut left = along;
    for _ in 0..HALVINGS {
        let middle = [(from[0] + to[0]) * 0.5, (from[1] + to[1]) * 0.5];
        left *= 2.0;
        if left < 1.0 {
            to = apex;
        } else {
            left -= 1.0;
            from = apex;
        }
        apex = middle;
    }
    let centre = |i: usize| (from[i] + to[i] + apex[i]) / 3.0;
    [1.0 - centre(0) - centre(1), centre(0), centre(1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sierpinski_covers_equal_areas_and_stays_inside() {
        let count = 1 << 14;
        let mut quarter = [0usize; 4];
        for i in 0..count {
            let w = sierpinski((f64::from(i) + 0.5) / f64::from(count));
            assert!(w.iter().all(|&x| x >= 0.0) && (w.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            // The middle triangle, or a triangle at a corner: a quarter of the area each.
            quarter[w.iter().position(|&x| x > 0.5).map_or(3, |corner| corner)] += 1;
        }
        assert!(quarter.iter().all(|&q| q.abs_diff(count as usize / 4) < 200), "{quarter:?}");
    }

    #[test]
    fn neighbours_in_order_are_neighbours_in_space() {
        let count = 4096;
        let at = |i: i32| sierpinski((f64::from(i) + 0.5) / f64::from(count));
        for i in 1..count {
            let (a, b) = (at(i - 1), at(i));
            assert!((0..3).all(|k| (a[k] - b[k]).abs() <= 2.0 / 64.0), "{i}");
        }
    }

    #[test]
    fn every_element_gets_its_share() {
        let measures = [1.0, 0.0, 5.0, 0.25, 3.75];
        let shares = Shares::new(measures.into_iter(), 1000, 7);
        let mut counts = [0i32; 5];
        shares.positions(0..500).chain(shares.positions(500..1000)).for_each(|(e, _)| counts[e] += 1);
        for (count, measure) in counts.iter().zip(measures) {
            assert!((f64::from(*count) - 100.0 * measure).abs() <= 1.0, "{counts:?}");
        }
    }
}
