//! Blending of vertices, needed wherever vertices move.

use bytemuck::Pod;

/// Bytes of an `f32`.
const NUMBER: usize = size_of::<f32>();

/// Interpolates between two values of a type.
///
/// If all fields of a vertex are `f32`, `impl Blend for Vertex {}` suffices: each field is interpolated by itself. A
/// vertex with other fields, such as colours in bytes or joints, implements `blend`.
///
/// `blend` must return exactly `self` at `t = 0` and exactly `other` at `t = 1`, so vertices at rest have their own
/// values.
///
/// ```
/// use bytemuck::{Pod, Zeroable};
/// use multires::adapt::Blend;
///
/// #[repr(C)]
/// #[derive(Clone, Copy, Pod, Zeroable)]
/// struct Plain {
///     position: [f32; 3],
///     uv: [f32; 2],
/// }
/// impl Blend for Plain {}
///
/// #[repr(C)]
/// #[derive(Clone, Copy, Pod, Zeroable)]
/// struct Painted {
///     position: [f32; 3],
///     colour: [u8; 4],
/// }
/// impl Blend for Painted {
///     fn blend(&self, other: &Self, t: f32) -> Self {
///         let channel = |i: usize| {
///             f32::from(self.colour[i]).blend(&f32::from(other.colour[i]), t).round() as u8
///         };
///         Self { position: self.position.blend(&other.position, t), colour: std::array::from_fn(channel) }
///     }
/// }
///
/// let [black, white] = [0, 255].map(|c: u8| Painted { position: [f32::from(c); 3], colour: [c; 4] });
/// assert_eq!(black.blend(&white, 0.2).colour, [51; 4]);
/// # let [a, b] = [0.0, 1.0].map(|x| Plain { position: [x; 3], uv: [x; 2] });
/// # assert_eq!(a.blend(&b, 0.25).uv, [0.25; 2]);
/// ```
pub trait Blend: Pod {
    /// Returns `(1 - t) * self + t * other`, for `t` from 0 to 1. The default reads every four bytes as an `f32`.
    /// Remaining bytes are copied from `self`, and from `other` at `t = 1`.
    #[must_use]
    fn blend(&self, other: &Self, t: f32) -> Self {
        if t >= 1.0 {
            return *other;
        }
        let mut mixed = *self;
        let bytes = bytemuck::bytes_of_mut(&mut mixed).chunks_exact_mut(NUMBER);
        for (bytes, other) in bytes.zip(bytemuck::bytes_of(other).chunks_exact(NUMBER)) {
            let [a, b]: [f32; 2] = [bytemuck::pod_read_unaligned(bytes), bytemuck::pod_read_unaligned(other)];
            bytes.copy_from_slice(&a.blend(&b, t).to_ne_bytes());
        }
        mixed
    }

    /// Returns `self + t * (to - from)`, for `t` from 0 to 1: moves `self` along with a value on its way from `from` to
    /// `to`. At `t = 0` the result is exactly `self`. If `self == from`, the result at `t = 1` is exactly `to`. The
    /// default returns `(1 - t) * self + t * to`, equal to the formula above if `self == from`.
    #[must_use]
    fn moved(&self, from: &Self, to: &Self, t: f32) -> Self {
        let _ = from;
        self.blend(to, t)
    }
}

impl Blend for f32 {
    #[inline]
    fn blend(&self, other: &Self, t: f32) -> Self {
        if t >= 1.0 {
            *other
        } else if t <= 0.0 || self == other {
            // Blending equal values must not round.
            *self
        } else {
            // Rounding does not lead beyond either.
            ((1.0 - t) * self + t * other).max(self.min(*other)).min(self.max(*other))
        }
    }

    #[inline]
    fn moved(&self, from: &Self, to: &Self, t: f32) -> Self {
        if self == from || t <= 0.0 { self.blend(to, t) } else { self + t.min(1.0) * (to - from) }
    }
}

impl<T: Blend, const N: usize> Blend for [T; N] {
    #[inline]
    fn blend(&self, other: &Self, t: f32) -> Self {
        std::array::from_fn(|i| self[i].blend(&other[i], t))
    }

    #[inline]
    fn moved(&self, from: &Self, to: &Self, t: f32) -> Self {
        std::array::from_fn(|i| self[i].moved(&from[i], &to[i], t))
    }
}
