//! Analysis and synthesis.

use std::ops::Range;

use crate::wavelet::{Subdivision, WaveletError, WaveletMesh};

use super::Coefficients;
use super::disk::Lifting;
use super::domain::Domain;

/// Most rings of a disk.
const MOST_RINGS: u8 = 2;

/// Functions weighted by the coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Wavelet {
    /// Hats at midpoints: coarser levels are samples of the finest level.
    Lazy,
    /// Hats at midpoints minus a combination of coarser hats. The combination makes the wavelet orthogonal to all
    /// coarser hats in a disk of 0 to 2 rings of neighbours around the edge. Coarser levels are nearly the best
    /// approximations in the mean square.
    Disk(u8),
}

/// Takes functions on a subdivision apart into values on the base and wavelet coefficients, and puts them together again.
///
/// A function is linear on the faces of the finest level. On a coarser level, it is the function with all finer
/// coefficients set to 0. The coefficient w of a midpoint is its value minus the middle of its ends. For
/// [`Wavelet::Disk`], s_k w is added to the next coarser level's value at every hat k of the disk, before that level is
/// taken apart in turn (Lounsbery et al. 1997, Multiresolution analysis for surfaces of arbitrary topological type; the
/// lifting form of Southern, appendix A, equation A.10). Synthesis inverts these steps in reverse order.
///
/// Values belong to nodes, numbered level by level, the base first. With [`of_points`](Self::of_points) nodes are
/// points: all vertices at a seam share a value, so no truncation opens a crack. Use it for positions. With
/// [`of_vertices`](Self::of_vertices) nodes are vertices, and the surface is cut along its seams. Use it for texture
/// coordinates.
///
/// Lazy transforms work for all subdivisions. Disks need whole levels: the faces of a component, joined by nodes, must
/// be split equally deep. Making, analysis and synthesis are O(n), as long as few vertices have very many neighbours.
/// Disks with more than 256 hats lose rings until they fit.
///
/// ```
/// use multires::mesh::shapes;
/// use multires::wavelet::{Wavelet, WaveletBuilder, WaveletOptions, WaveletTransform, l2_error};
///
/// let mut builder = WaveletBuilder::new(&shapes::icosphere(0))?;
/// for level in 1..=4 {
///     // Rough on all scales.
///     builder.subdivide(|m| m.middle.map(|x| x + (40.0 * x).sin() / (1 << level) as f32 / 10.0))?;
/// }
/// let mesh = builder.build(&WaveletOptions::default())?;
/// let positions = mesh.vertices().positions().as_flattened();
/// let error = |kind| -> Result<f64, multires::wavelet::WaveletError> {
///     let transform = WaveletTransform::of_points(&mesh, kind)?;
///     let tenth = transform.analyse(positions, 3)?.to_count(256);
///     l2_error(mesh.subdivision(), 3, positions, &tenth.synthesise())
/// };
/// assert!(error(Wavelet::Disk(1))? < error(Wavelet::Lazy)?);
/// # Ok::<(), multires::wavelet::WaveletError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WaveletTransform {
    kind: Wavelet,
    pub(super) domain: Domain,
    /// `None`: lazy.
    lifting: Option<Lifting>,
    /// Per node above the base, the norm of its wavelet.
    norms: Vec<f64>,
}

impl WaveletTransform {
    /// Makes a transform for functions with the same value at all vertices of a point.
    ///
    /// # Errors
    /// [`WaveletError::Invalid`]: a disk of more than two rings; for disks, faces of a component split to different
    /// depths.
    pub fn of_points(mesh: &WaveletMesh, kind: Wavelet) -> Result<Self, WaveletError> {
        Self::new(mesh.subdivision(), Domain::of_points(mesh), kind)
    }

    /// Makes a transform for functions with a value for every vertex. Values on the two sides of a seam are independent.
    ///
    /// # Errors
    /// [`WaveletError::Invalid`]: a disk of more than two rings; for disks, faces of a component split to different
    /// depths.
    pub fn of_vertices(subdivision: &Subdivision, kind: Wavelet) -> Result<Self, WaveletError> {
        Self::new(subdivision, Domain::of_vertices(subdivision), kind)
    }

    fn new(of: &Subdivision, domain: Domain, kind: Wavelet) -> Result<Self, WaveletError> {
        let lifting = match kind {
            Wavelet::Lazy => None,
            Wavelet::Disk(rings) if rings <= MOST_RINGS => Some(Lifting::new(of, &domain, rings)?),
            Wavelet::Disk(rings) => {
                let what = "a disk has no more than two rings";
                return Err(WaveletError::Invalid { what, at: rings.into() });
            }
        };
        let products = domain.midpoint_products(of);
        let whole = of.base_face_count().max(1) as f64;
        let mut norms = Vec::with_capacity(products.len());
        for level in 1..=domain.depth() {
            let unit = 0.25_f64.powi(level as i32 - 1) / (48.0 * whole);
            for node in domain.nodes_of(level) {
                let at = node - domain.base();
                let gain = lifting.as_ref().map_or(0.0, |lifting| lifting.gain[at]);
                norms.push((unit * (f64::from(products[at]) - gain)).max(0.0).sqrt());
            }
        }
        Ok(Self { kind, domain, lifting, norms })
    }

    /// The kind of wavelets.
    pub fn kind(&self) -> Wavelet {
        self.kind
    }

    /// The deepest level; 0 where nothing is split.
    pub fn depth(&self) -> usize {
        self.domain.depth()
    }

    /// Number of vertices with values.
    pub fn vertex_count(&self) -> usize {
        self.domain.node_of.len()
    }

    /// Number of nodes: values on the base and coefficients.
    pub fn node_count(&self) -> usize {
        self.domain.len()
    }

    /// Nodes of the coefficients of a level, by number; base nodes for level 0, empty out of range.
    pub fn nodes_of(&self, level: usize) -> Range<usize> {
        self.domain.nodes_of(level)
    }

    /// The node of a vertex; `None` out of range.
    pub fn node_of(&self, vertex: u32) -> Option<usize> {
        self.domain.node_of.get(vertex as usize).map(|&node| node as usize)
    }

    /// The first vertex of a node; `None` out of range.
    pub fn vertex_of(&self, node: usize) -> Option<u32> {
        self.domain.vertex_of.get(node).copied()
    }

    /// Root of the mean square of a node's wavelet over the surface, every base face weighted equally: the
    /// [`l2_error`](super::l2_error) caused by a coefficient of 1 alone. `None` for the base and out of range.
    pub fn norm(&self, node: usize) -> Option<f64> {
        self.norms.get(node.checked_sub(self.domain.base())?).copied()
    }

    /// Coarser hats subtracted from a node's wavelet: nodes and weights. `None` for the base, out of range and for lazy
    /// wavelets.
    pub fn lifting(&self, node: usize) -> Option<(&[u32], &[f64])> {
        let at = node.checked_sub(self.domain.base()).filter(|&at| at < self.norms.len())?;
        self.lifting.as_ref().map(|lifting| lifting.disk(at))
    }

    /// Number of different systems of equations solved for disks; 0 for lazy wavelets.
    pub fn patterns(&self) -> usize {
        self.lifting.as_ref().map_or(0, |lifting| lifting.patterns)
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        let lifting = self.lifting.as_ref().map_or(0, Lifting::memory);
        self.domain.memory() + lifting + size_of_val(&self.norms[..])
    }

    /// Takes a function apart: `width` scalars a vertex, vertex by vertex. O(n).
    ///
    /// [`Coefficients::synthesise`] restores the values. For lazy wavelets they are equal bit for bit (but -0 becomes
    /// 0), if at every vertex its value and its ends' values, zeros apart, differ by a factor of 2^26 at most: then all
    /// sums are exact. Otherwise, and for disks, the error is about 1e-15 of the largest value nearby, before rounding
    /// to single precision.
    ///
    /// # Errors
    /// Not `width` values a vertex, a width of 0, a non-finite value, or different values at vertices of the same node.
    pub fn analyse(&self, values: &[f32], width: usize) -> Result<Coefficients<'_>, WaveletError> {
        check_length(values.len(), self.vertex_count(), width)?;
        let mut nodes: Vec<f64> = Vec::with_capacity(self.node_count() * width);
        for &vertex in &self.domain.vertex_of {
            nodes.extend(values[vertex as usize * width..][..width].iter().map(|&x| f64::from(x)));
        }
        for ((vertex, own), &node) in values.chunks_exact(width).enumerate().zip(&self.domain.node_of) {
            if !own.iter().all(|x| x.is_finite()) {
                let what = "a value is not finite: of the vertex";
                return Err(WaveletError::Invalid { what, at: vertex });
            }
            let of_node = &nodes[node as usize * width..][..width];
            if own.iter().zip(of_node).any(|(&a, &b)| f64::from(a) != b) {
                let what = "vertices at one point have different values: the vertex";
                return Err(WaveletError::Invalid { what, at: vertex });
            }
        }
        for level in (1..=self.depth()).rev() {
            self.predict(&mut nodes, width, level, -1.0);
            self.update(&mut nodes, width, level, 1.0);
        }
        Ok(Coefficients::of(self, width, nodes))
    }

    /// Takes coefficients from elsewhere, `width` scalars a node, node by node: values for base nodes, coefficients for
    /// all others.
    ///
    /// # Errors
    /// Not `width` scalars a node, a width of 0, or a non-finite scalar.
    pub fn coefficients(&self, nodes: Vec<f64>, width: usize) -> Result<Coefficients<'_>, WaveletError> {
        check_length(nodes.len(), self.node_count(), width)?;
        if let Some(at) = nodes.iter().position(|x| !x.is_finite()) {
            let what = "a coefficient is not finite: of the node";
            return Err(WaveletError::Invalid { what, at: at / width });
        }
        Ok(Coefficients::of(self, width, nodes))
    }

    /// Turns coefficients into values of all nodes, in place.
    pub(super) fn restore(&self, nodes: &mut [f64], width: usize) {
        for level in 1..=self.depth() {
            self.update(nodes, width, level, -1.0);
            self.predict(nodes, width, level, 1.0);
        }
    }

    /// Adds `sign` times the middle of its ends to every node of a level.
    fn predict(&self, nodes: &mut [f64], width: usize, level: usize, sign: f64) {
        let of_level = self.domain.nodes_of(level);
        let (coarse, fine) = nodes.split_at_mut(of_level.start * width);
        for (node, values) in of_level.zip(fine.chunks_exact_mut(width)) {
            let [a, b] = self.domain.ends(node).map(|end| end * width);
            for (i, value) in values.iter_mut().enumerate() {
                *value += sign * (0.5 * (coarse[a + i] + coarse[b + i]));
            }
        }
    }

    /// Adds `sign` times the lifting terms of a level's wavelets to coarser nodes.
    fn update(&self, nodes: &mut [f64], width: usize, level: usize, sign: f64) {
        let Some(lifting) = &self.lifting else { return };
        let of_level = self.domain.nodes_of(level);
        let (coarse, fine) = nodes.split_at_mut(of_level.start * width);
        for (node, values) in of_level.zip(fine.chunks_exact(width)) {
            let (disk, weights) = lifting.disk(node - self.domain.base());
            for (&to, weight) in disk.iter().zip(weights) {
                let to = &mut coarse[to as usize * width..][..width];
                to.iter_mut().zip(values).for_each(|(to, value)| *to += sign * weight * value);
            }
        }
    }
}

/// Checks for `width` numbers for each of `count` elements, and a width above 0.
pub(super) fn check_length(found: usize, count: usize, width: usize) -> Result<(), WaveletError> {
    match count.checked_mul(width) {
        _ if width == 0 => Err(WaveletError::Invalid { what: "a function has no scalars", at: 0 }),
        Some(expected) if expected == found => Ok(()),
        expected => {
            Err(WaveletError::Length { what: "values", found, expected: expected.unwrap_or(usize::MAX) })
        }
    }
}
