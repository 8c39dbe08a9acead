//! What a vertex must be able to do to move: be mixed with another.

/// A value between two of its kind.
///
/// At `t = 0` the result must be `self` and at `t = 1` `other`, exactly: a vertex at rest is where it belongs.
pub trait Blend: Sized {
    /// `(1 - t) * self + t * other`; `t` is from 0 to 1.
    #[must_use]
    fn blend(&self, other: &Self, t: f32) -> Self;

    /// `self + t * (to - from)`: carried along by a share of another's way; `t` is from 0 to 1. At `t = 0` `self`, and at
    /// `t = 1` `to` where `self` equals `from`, exactly. Unless implemented, `(1 - t) * self + t * to`, which is the same
    /// where `self` equals `from`.
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
            // Of equal values no share may round away from them.
            *self
        } else {
            (1.0 - t) * self + t * other
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
