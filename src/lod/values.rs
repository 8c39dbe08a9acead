//! The values of a structure's vertices, of any type, in the structure's order.

use std::ops::Deref;
use std::sync::Arc;

use bytemuck::NoUninit;

use crate::adapt::Blend;

/// What a vertex can be: plain data without padding, as graphics interfaces take it. Implemented for every such type; derive
/// [`bytemuck::NoUninit`] or [`bytemuck::Pod`] for yours.
pub trait Vertex: NoUninit + Send + Sync {}

impl<V: NoUninit + Send + Sync> Vertex for V {}

/// How two values are mixed, as function pointers, so that values of any type can be held and those that can be mixed moved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mix<V> {
    /// `(1 - t) * a + t * b`.
    pub blend: fn(&V, &V, f32) -> V,
    /// `a + t * (to - from)`.
    pub moved: fn(&V, &V, &V, f32) -> V,
}

/// The values of all vertices of a structure, in its order, shared by instances. Made by [`Baked::arrange`](super::Baked::arrange) and its
/// kin, or from a vector in that order.
///
/// Where vertices are to move, or to lie between others (wavelet meshes), the instance must know how two are mixed:
/// [`Values::with_blending`].
#[derive(Debug, Clone)]
pub struct Values<V> {
    values: Arc<[V]>,
    mix: Option<Mix<V>>,
}

impl<V: Copy + Blend> Values<V> {
    /// The same values, which instances may mix.
    #[must_use]
    pub fn with_blending(mut self) -> Self {
        self.mix = Some(Mix { blend: V::blend, moved: V::moved });
        self
    }
}

impl<V> Values<V> {
    /// The values as they are shared.
    pub fn shared(&self) -> &Arc<[V]> {
        &self.values
    }

    /// Whether instances may mix them.
    pub fn can_blend(&self) -> bool {
        self.mix.is_some()
    }

    pub(crate) fn mix(&self) -> Option<Mix<V>>
    where
        V: Copy,
    {
        self.mix
    }

    /// The values, to be changed, or replaced by as many.
    pub(crate) fn shared_mut(&mut self) -> &mut Arc<[V]> {
        &mut self.values
    }
}

impl Values<()> {
    /// No values: for an instance whose triangles alone count.
    pub fn none(count: usize) -> Self {
        Self::from(vec![(); count])
    }
}

impl<V> From<Vec<V>> for Values<V> {
    fn from(values: Vec<V>) -> Self {
        Self { values: values.into(), mix: None }
    }
}

impl<V> From<Arc<[V]>> for Values<V> {
    fn from(values: Arc<[V]>) -> Self {
        Self { values, mix: None }
    }
}

impl<V> Deref for Values<V> {
    type Target = [V];

    fn deref(&self) -> &[V] {
        &self.values
    }
}
