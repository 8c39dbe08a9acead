//! The statistics of a comparison: layouts of variance, Scheffe's test of pairs, Wilks's lambda, correlations.
//!
//! Everything is a function of plain slices; nothing knows of meshes. What cannot be said (too few values, no variance)
//! is `None`, never a NaN. Sources: Scheffe, "The Analysis of Variance", 1959 (sections 3.5 and 4.2); Rao, "Linear
//! Statistical Inference", 1973 (8c.5) for the approximation of lambda by F.

use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal};

/// How a sample divides: what lies between groups against what is left over.
#[derive(Debug, Clone, PartialEq)]
pub struct Variance {
    /// Mean of each group.
    pub means: Vec<f64>,
    /// Values in each group.
    pub counts: Vec<usize>,
    /// Mean square of what the layout does not explain.
    pub residual: f64,
    /// Degrees of freedom between groups, and of the residual.
    pub freedom: [f64; 2],
    /// Between groups over residual.
    pub f: f64,
    /// Chance of an F at least as large where all groups have the same mean.
    pub p: f64,
}

impl Variance {
    /// One-way layout: every value is its group's mean plus chance. `None` with fewer than two groups, an empty one,
    /// or where no value differs from its group's mean.
    pub fn one_way(groups: &[Vec<f64>]) -> Option<Self> {
        let counts: Vec<usize> = groups.iter().map(Vec::len).collect();
        let means: Vec<f64> = groups.iter().map(|group| mean(group)).collect::<Option<_>>()?;
        let total: usize = counts.iter().sum();
        let grand = groups.iter().flatten().sum::<f64>() / total.max(1) as f64;
        let between: f64 = means.iter().zip(&counts).map(|(m, &n)| n as f64 * (m - grand).powi(2)).sum();
        let within: f64 =
            groups.iter().zip(&means).flat_map(|(group, m)| group.iter().map(move |x| (x - m).powi(2))).sum();
        let freedom = [groups.len() as f64 - 1.0, total as f64 - groups.len() as f64];
        Self::of(means, counts, [between, within], freedom)
    }

    /// Two-way layout without interaction: every block has one value of each group, and every value is the sum of what
    /// its group and its block bring along, plus chance. `blocks` is row after row, `groups` values each. `None` as
    /// for one way, or with fewer than two blocks.
    pub fn blocked(blocks: &[f64], groups: usize) -> Option<Self> {
        let rows = blocks.len().checked_div(groups)?;
        if rows < 2 || rows * groups != blocks.len() {
            return None;
        }
        let grand = mean(blocks)?;
        let column = |g: usize| blocks.iter().skip(g).step_by(groups).sum::<f64>() / rows as f64;
        let means: Vec<f64> = (0..groups).map(column).collect();
        let (mut between, mut left) = (0.0, 0.0);
        for m in &means {
            between += rows as f64 * (m - grand).powi(2);
        }
        for block in blocks.chunks_exact(groups) {
            let own = block.iter().sum::<f64>() / groups as f64;
            // What is left of each value, directly: differences of sums would lose the digits.
            left += block.iter().zip(&means).map(|(x, m)| (x - m - own + grand).powi(2)).sum::<f64>();
        }
        let freedom = [groups as f64 - 1.0, (groups as f64 - 1.0) * (rows as f64 - 1.0)];
        Self::of(means, vec![rows; groups], [between, left], freedom)
    }

    fn of(means: Vec<f64>, counts: Vec<usize>, squares: [f64; 2], freedom: [f64; 2]) -> Option<Self> {
        let residual = squares[1] / freedom[1];
        let f = squares[0] / freedom[0] / residual;
        let p = f_tail(f, freedom)?;
        Some(Self { means, counts, residual, freedom, f, p })
    }

    /// Scheffe's test of one pair of groups: the chance of any contrast as large where all means are the same.
    pub fn scheffe(&self, a: usize, b: usize) -> Option<f64> {
        let difference = self.means.get(a)? - self.means.get(b)?;
        let spread = self.residual * (1.0 / self.counts[a] as f64 + 1.0 / self.counts[b] as f64);
        f_tail(difference * difference / spread / self.freedom[0], self.freedom)
    }
}

/// One-way layout of several values at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wilks {
    /// Share of the generalised variance that groups do not explain: 0 to 1.
    pub lambda: f64,
    /// Rao's F and its degrees of freedom.
    pub f: f64,
    /// Of groups, and of the rest.
    pub freedom: [f64; 2],
    /// Chance of a lambda at most as large where all groups have the same means.
    pub p: f64,
}

impl Wilks {
    /// Each group is row after row of `width` values. `None` with fewer than two groups, an empty one, or where the
    /// values depend on each other.
    pub fn new(groups: &[Vec<f64>], width: usize) -> Option<Self> {
        let all: Vec<f64> = groups.concat();
        let (n, k, w) = ((all.len().checked_div(width)?) as f64, groups.len() as f64, width as f64);
        // In units of each value's own deviation: lambda does not change, and the logarithms stay tame.
        let grand = column_means(&all, width)?;
        let mut scale = vec![0.0; width];
        for row in all.chunks_exact(width) {
            for i in 0..width {
                scale[i] += (row[i] - grand[i]).powi(2) / n;
            }
        }
        let scale: Vec<f64> = scale.into_iter().map(f64::sqrt).collect();
        let mut within = vec![0.0; width * width];
        for group in groups {
            let means = column_means(group, width)?;
            scatter(group, &means, &scale, &mut within);
        }
        let mut total = vec![0.0; width * width];
        scatter(&all, &grand, &scale, &mut total);
        let lambda = (log_determinant(within, width)? - log_determinant(total, width)?).exp();

        let q = k - 1.0;
        let squares = w * w + q * q - 5.0;
        let root = if squares > 0.0 { ((w * w * q * q - 4.0) / squares).sqrt() } else { 1.0 };
        let freedom = [w * q, (n - 1.0 - (w + k) / 2.0) * root - (w * q - 2.0) / 2.0];
        let remains = lambda.powf(1.0 / root);
        let f = (1.0 - remains) / remains * freedom[1] / freedom[0];
        Some(Self { lambda, f, freedom, p: f_tail(f, freedom)? })
    }
}

/// Pearson's correlation of two samples, pair by pair; `None` where one of them does not vary.
pub fn pearson(x: &[f64], y: &[f64]) -> Option<f64> {
    if x.len() != y.len() {
        return None;
    }
    let (mx, my) = (mean(x)?, mean(y)?);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (a, b) in x.iter().zip(y) {
        xx += (a - mx).powi(2);
        yy += (b - my).powi(2);
        xy += (a - mx) * (b - my);
    }
    let r = xy / (xx * yy).sqrt();
    r.is_finite().then(|| r.clamp(-1.0, 1.0))
}

/// Spearman's correlation: Pearson's of the ranks.
pub fn spearman(x: &[f64], y: &[f64]) -> Option<f64> {
    pearson(&ranks(x), &ranks(y))
}

/// Chance of a correlation at least as far from 0 among `n` pairs that are not correlated.
pub fn correlation_p(r: f64, n: usize) -> Option<f64> {
    let freedom = n.checked_sub(2).filter(|&f| f > 0)? as f64;
    let unexplained = 1.0 - r * r;
    if unexplained <= 0.0 { Some(0.0) } else { f_tail(r * r * freedom / unexplained, [1.0, freedom]) }
}

/// Fisher's comparison of two correlations, each of `n` pairs of its own: the standard normal deviate of their
/// difference and its two-sided chance. Samples that share values are not independent, and then it is a guide only.
pub fn fisher(r1: f64, r2: f64, n: usize) -> Option<(f64, f64)> {
    let pairs = n.checked_sub(3).filter(|&f| f > 0)? as f64;
    let z = (r1.atanh() - r2.atanh()) * (pairs / 2.0).sqrt();
    let tail = Normal::new(0.0, 1.0).ok()?.sf(z.abs());
    z.is_finite().then_some((z, 2.0 * tail))
}

/// Mean; `None` of nothing.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Chance of an F larger than this.
fn f_tail(f: f64, [above, below]: [f64; 2]) -> Option<f64> {
    if !f.is_finite() || f < 0.0 {
        return None;
    }
    Some(FisherSnedecor::new(above, below).ok()?.sf(f))
}

/// Ranks from 1; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let (mut ranks, mut start) = (vec![0.0; values.len()], 0);
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let shared = start as f64 + (equal.len() as f64 + 1.0) / 2.0;
        equal.iter().for_each(|&i| ranks[i] = shared);
        start += equal.len();
    }
    ranks
}

fn column_means(rows: &[f64], width: usize) -> Option<Vec<f64>> {
    (0..width).map(|i| mean(&rows.iter().skip(i).step_by(width).copied().collect::<Vec<_>>())).collect()
}

/// Adds the sums of squares and products about the means, in units of `scale`.
fn scatter(rows: &[f64], means: &[f64], scale: &[f64], sums: &mut [f64]) {
    let width = means.len();
    for row in rows.chunks_exact(width) {
        let off = |i: usize| (row[i] - means[i]) / scale[i];
        for (at, sum) in sums.iter_mut().enumerate() {
            *sum += off(at / width) * off(at % width);
        }
    }
}

/// Logarithm of the determinant of a positive definite matrix, by Cholesky; `None` of any other.
fn log_determinant(mut m: Vec<f64>, n: usize) -> Option<f64> {
    let mut sum = 0.0;
    for k in 0..n {
        let pivot = m[k * n + k];
        // Below this, a column is a combination of others but for rounding. Diagonals are counts of rows at most.
        if pivot.is_nan() || pivot <= 1e-12 {
            return None;
        }
        sum += pivot.ln();
        for i in k + 1..n {
            let factor = m[i * n + k] / pivot;
            for j in k..n {
                m[i * n + j] -= factor * m[k * n + j];
            }
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    /// Three groups of six: sums of squares 84 and 68, F = 42 / (68 / 15). With two degrees of freedom above, the tail
    /// of F has a closed form.
    fn three_groups() -> Variance {
        let groups = [[6, 8, 4, 5, 3, 4], [8, 12, 9, 11, 6, 8], [13, 9, 11, 8, 7, 12]];
        Variance::one_way(&groups.map(|g| g.map(f64::from).to_vec())).expect("values vary")
    }

    fn tail_of_two(f: f64, below: f64) -> f64 {
        (1.0 + 2.0 * f / below).powf(-below / 2.0)
    }

    #[test]
    fn one_way_layout_of_three_groups() {
        let found = three_groups();
        assert_eq!((found.means.as_slice(), found.freedom), (&[5.0, 9.0, 10.0][..], [2.0, 15.0]));
        close(found.residual, 68.0 / 15.0, 1e-12);
        close(found.f, 9.264_705_882, 1e-8);
        close(found.p, tail_of_two(found.f, 15.0), 1e-12);
        close(found.p, 0.0024, 5e-5);
    }

    #[test]
    fn scheffe_tells_the_pairs_apart_that_the_criterion_does() {
        let found = three_groups();
        // (difference)^2 / (residual * (1/6 + 1/6)) / 2 against the F of 2 and 15; 3.68 is the 5 % point.
        for ([a, b], square) in [([0, 1], 16.0), ([0, 2], 25.0), ([1, 2], 1.0)] {
            let f = square / (68.0 / 15.0 / 3.0) / 2.0;
            let p = found.scheffe(a, b).expect("groups exist");
            close(p, tail_of_two(f, 15.0), 1e-12);
            assert_eq!(p < 0.05, f > 3.682);
            assert_eq!(found.scheffe(b, a), Some(p));
        }
        assert_eq!(found.scheffe(0, 3), None);
    }

    /// Hardness of four coupons tested with four tips (Montgomery, "Design and Analysis of Experiments", randomised
    /// complete blocks): F = 14.44, p = 0.0009, residual sum of squares 8 with 9 degrees of freedom.
    #[test]
    fn blocked_layout_of_the_hardness_test() {
        let tips = [[-2, -1, 1, 5], [-1, -2, 3, 4], [-3, -1, 0, 2], [2, 1, 5, 7]];
        let blocks: Vec<f64> = (0..4).flat_map(|coupon| tips.map(|tip| f64::from(tip[coupon]))).collect();
        let found = Variance::blocked(&blocks, 4).expect("values vary");
        assert_eq!(found.freedom, [3.0, 9.0]);
        close(found.residual, 8.0 / 9.0, 1e-12);
        close(found.f, 14.4375, 1e-9);
        close(found.p, 0.0009, 5e-5);
    }

    /// Johnson and Wichern, "Applied Multivariate Statistical Analysis", the example of three populations:
    /// lambda = 239 / 6215, F = 8.19 with 4 and 8 degrees of freedom.
    #[test]
    fn wilks_of_three_populations() {
        let groups = [vec![9, 3, 6, 2, 9, 7], vec![0, 4, 2, 0], vec![3, 8, 1, 9, 2, 7]];
        let groups = groups.map(|g| g.into_iter().map(f64::from).collect::<Vec<_>>());
        let found = Wilks::new(&groups, 2).expect("values vary");
        close(found.lambda, 239.0 / 6215.0, 1e-12);
        assert_eq!(found.freedom, [4.0, 8.0]);
        close(found.f, 8.19, 0.01);
        assert!(found.p < 0.01);
        // The same column twice says nothing more than once, and cannot be divided by.
        let twice = groups.map(|g| g.chunks(2).flat_map(|row| [row[0], row[0]]).collect::<Vec<_>>());
        assert_eq!(Wilks::new(&twice, 2), None);
    }

    /// Anscombe's first set: r = 0.81642, p = 0.00217.
    #[test]
    fn pearson_of_anscombe() {
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68];
        let r = pearson(&x, &y).expect("values vary");
        close(r, 0.81642, 5e-6);
        close(correlation_p(r, x.len()).expect("enough values"), 0.00217, 5e-6);
        assert_eq!(pearson(&x, &[1.0; 11]), None);
    }

    /// Ten pairs with rank differences whose squares sum to 194: rho = -29 / 165.
    #[test]
    fn spearman_of_ten_pairs() {
        let x = [106.0, 100.0, 86.0, 101.0, 99.0, 103.0, 97.0, 113.0, 112.0, 110.0];
        let y = [7.0, 27.0, 2.0, 50.0, 28.0, 29.0, 20.0, 12.0, 6.0, 17.0];
        close(spearman(&x, &y).expect("values vary"), -29.0 / 165.0, 1e-12);
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [3.5, 1.0, 3.5, 2.0]);
    }

    #[test]
    fn fisher_of_two_correlations() {
        // artanh 0.6 - artanh 0 = ln 2, times sqrt(200 / 2).
        let (z, p) = fisher(0.6, 0.0, 203).expect("enough values");
        close(z, 10.0 * 2f64.ln(), 1e-12);
        assert!(p < 1e-10);
        // The 5 % point of the normal distribution.
        let (z, p) = fisher((1.959_964f64 / 10.0).tanh(), 0.0, 203).expect("enough values");
        close(z, 1.959_964, 1e-9);
        close(p, 0.05, 1e-6);
    }

    #[test]
    fn too_little_is_none() {
        assert_eq!(Variance::one_way(&[]), None);
        assert_eq!(Variance::one_way(&[vec![1.0, 2.0]]), None);
        assert_eq!(Variance::one_way(&[vec![1.0, 2.0], vec![]]), None);
        assert_eq!(Variance::one_way(&[vec![1.0, 1.0], vec![1.0, 1.0]]), None);
        assert_eq!(Variance::blocked(&[1.0, 2.0], 2), None);
        assert_eq!(Variance::blocked(&[], 0), None);
        assert_eq!(Wilks::new(&[], 0), None);
        assert_eq!(Wilks::new(&[vec![], vec![]], 2), None);
        assert_eq!((correlation_p(0.5, 2), fisher(0.5, 0.1, 3)), (None, None));
    }
}
