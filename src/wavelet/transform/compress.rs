//! Coefficients, and dropping the least significant: by level, by size, by count.
//!
//! The significance of a coefficient is its length times the norm of its wavelet: the L2 error of dropping only this
//! coefficient. For orthogonal wavelets, keeping the largest is optimal. It is nearly optimal for k-disk wavelets, but not for
//! lazy wavelets.

use std::ops::Range;

use super::WaveletTransform;

/// A function as values on the base and wavelet coefficients, `width` scalars for every node of a [`WaveletTransform`].
#[derive(Debug, Clone)]
pub struct Coefficients<'t> {
    transform: &'t WaveletTransform,
    width: usize,
    nodes: Vec<f64>,
}

impl<'t> Coefficients<'t> {
    /// Makes coefficients from `width` scalars for every node.
    pub(super) fn of(transform: &'t WaveletTransform, width: usize, nodes: Vec<f64>) -> Self {
        Self { transform, width, nodes }
    }

    /// The transform of these coefficients.
    pub fn transform(&self) -> &'t WaveletTransform {
        self.transform
    }

    /// Number of scalars a node.
    pub fn width(&self) -> usize {
        self.width
    }

    /// All scalars, node by node: values on the base, then coefficients level by level.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Scalars of a level, node by node; values on the base for level 0, empty out of range.
    pub fn of_level(&self, level: usize) -> &[f64] {
        let Range { start, end } = self.transform.nodes_of(level);
        &self.nodes[start * self.width..end * self.width]
    }

    /// Number of coefficients, without the values on the base.
    pub fn count(&self) -> usize {
        self.transform.node_count() - self.transform.nodes_of(0).len()
    }

    /// Number of coefficients other than zero.
    pub fn kept(&self) -> usize {
        let base = self.transform.nodes_of(0).len();
        let rest = self.nodes[base * self.width..].chunks_exact(self.width);
        rest.filter(|w| w.iter().any(|&x| x != 0.0)).count()
    }

    /// Length of a node's coefficient times the norm of its wavelet: the L2 error of dropping only this coefficient, in the
    /// unit of the values ([`l2_error`](super::l2_error)). `None` for the base and out of range.
    pub fn magnitude(&self, node: usize) -> Option<f64> {
        let norm = self.transform.norm(node)?;
        let square: f64 = self.nodes[node * self.width..][..self.width].iter().map(|x| x * x).sum();
        Some(square.sqrt() * norm)
    }

    /// Drops the coefficients of levels above `level`, leaving the function of this level.
    #[must_use]
    pub fn to_level(&self, level: usize) -> Self {
        let end = self.transform.nodes_of(level.min(self.transform.depth())).end;
        self.keep(|node| node < end)
    }

    /// Drops coefficients of [magnitude](Self::magnitude) up to `tolerance`, in the unit of the values.
    #[must_use]
    pub fn to_tolerance(&self, tolerance: f64) -> Self {
        self.keep(|node| self.magnitude(node).is_none_or(|magnitude| magnitude > tolerance))
    }

    /// Keeps the `count` coefficients of largest [magnitude](Self::magnitude); of equal magnitudes, the first nodes. O(n).
    #[must_use]
    pub fn to_count(&self, count: usize) -> Self {
        let base = self.transform.nodes_of(0).len();
        if count >= self.count() {
            return self.clone();
        }
        let magnitudes =
            (base..self.transform.node_count()).map(|node| (self.magnitude(node).unwrap_or(0.0), node));
        let mut order: Vec<(f64, usize)> = magnitudes.collect();
        order.select_nth_unstable_by(count, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut keep = vec![false; self.transform.node_count()];
        order[..count].iter().for_each(|&(_, node)| keep[node] = true);
        self.keep(|node| node < base || keep[node])
    }

    fn keep(&self, keep: impl Fn(usize) -> bool) -> Self {
        let mut kept = self.clone();
        for (node, values) in kept.nodes.chunks_exact_mut(self.width).enumerate() {
            if !keep(node) {
                values.fill(0.0);
            }
        }
        kept
    }

    /// Computes the function: `width` scalars a vertex, vertex by vertex. O(n).
    pub fn synthesise(&self) -> Vec<f32> {
        let mut nodes = self.nodes.clone();
        self.transform.restore(&mut nodes, self.width);
        let mut values = Vec::with_capacity(self.transform.vertex_count() * self.width);
        for &node in &self.transform.domain.node_of {
            values.extend(nodes[node as usize * self.width..][..self.width].iter().map(|&x| x as f32));
        }
        values
    }
}
