//! A number of triangles shared by meshes so that all have the same error in the scene: the smallest that suffices.
//!
//! ```text
//!     least e with  sum of triangles_i(e / scale_i) <= N      by bisection over single precision numbers
//!     where many steps have that very error: of each mesh the same share of them
//! ```

use multires::CollapseSequence;

/// A mesh to share with.
pub struct Share<'a> {
    pub sequence: &'a CollapseSequence,
    /// Length of a unit of the mesh in the scene.
    pub scale: f64,
}

impl Share<'_> {
    /// Returns the most steps that leave a triangle.
    pub fn last(&self) -> usize {
        let steps = self.sequence.steps_for_triangles(0);
        if self.sequence.triangles_after(steps) == 0 { steps.saturating_sub(1) } else { steps }
    }

    /// Returns the most steps with at most this error in the scene, that leave a triangle.
    pub fn steps(&self, error: f32) -> usize {
        let own = (f64::from(error) / self.scale) as f32;
        self.sequence.steps_for_error(own).min(self.last())
    }
}

/// Returns the steps of each mesh that leave at most `most` triangles together, at the least common error. If there is none,
/// each mesh goes as far as it can.
pub fn steps_for_triangles(shares: &[Share], most: usize) -> Vec<usize> {
    let at = |error: f32| -> Vec<usize> { shares.iter().map(|share| share.steps(error)).collect() };
    let triangles = |steps: &[usize]| -> Vec<usize> {
        shares.iter().zip(steps).map(|(share, &steps)| share.sequence.triangles_after(steps)).collect()
    };
    let total = |steps: &[usize]| triangles(steps).iter().sum::<usize>();
    let start: Vec<usize> = vec![0; shares.len()];
    if total(&start) <= most {
        return start;
    }
    // Bits of positive numbers are in the order of the numbers.
    let (mut low, mut high) = (0, f32::INFINITY.to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        if total(&at(f32::from_bits(middle))) <= most { high = middle } else { low = middle + 1 }
    }
    let enough = at(f32::from_bits(high));
    let before = if high == 0 { start } else { at(f32::from_bits(high - 1)) };
    // Some of the steps at this very error suffice.
    let (coarse, fine) = (triangles(&enough), triangles(&before));
    let [to_go, all] = [
        fine.iter().sum::<usize>().saturating_sub(most),
        fine.iter().sum::<usize>() - coarse.iter().sum::<usize>(),
    ];
    let mut gone = 0;
    let mut seen = 0;
    shares
        .iter()
        .zip(fine.iter().zip(&coarse))
        .map(|(share, (&fine, &coarse))| {
            seen += fine - coarse;
            // As much of all steps so far as is to go, rounded up: the sum is exact.
            let due = (to_go as u128 * seen as u128).div_ceil(all.max(1) as u128) as usize;
            let steps = share.sequence.steps_for_triangles((fine + gone).saturating_sub(due).min(fine));
            let steps = steps.min(share.last());
            gone += fine - share.sequence.triangles_after(steps);
            steps
        })
        .collect()
}
