//! Values of a structure's vertices, of any type, in the structure's order.

use std::ops::Deref;
use std::sync::Arc;

use bytemuck::NoUninit;

use crate::adapt::Blend;

use super::{LodError, LodOptions};

/// A type of vertex: plain data without padding, as graphics interfaces take it. Implemented for every such type; derive
/// [`bytemuck::NoUninit`] or [`bytemuck::Pod`] for yours.
pub trait Vertex: NoUninit + Send + Sync {}

impl<V: NoUninit + Send + Sync> Vertex for V {}

/// Functions to mix two values, as pointers: values of any type can be held, and moved if they can be mixed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mix<V> {
    /// `(1 - t) * a + t * b`.
    pub blend: fn(&V, &V, f32) -> V,
    /// `a + t * (to - from)`.
    pub moved: fn(&V, &V, &V, f32) -> V,
}

/// The values of all vertices of a structure, in the structure's order, shared by instances. Made by
/// [`Baked::arrange`](super::Baked::arrange) and its kin, or from a vector in this order.
///
/// If vertices are to move, or to lie between others (wavelet meshes), the instance must be able to mix two values:
/// [`Values::with_blending`].
///
/// ```
/// use multires::{LodOptions, Structure, adapt::Geomorph, hierarchy::VertexHierarchy, mesh::shapes};
///
/// let mesh = shapes::icosphere(2);
/// let model = VertexHierarchy::bake(&mesh)?;
/// let values = model.arrange(mesh.positions())?;
/// let moving = LodOptions::default().with_geomorph(Geomorph::default());
/// assert!(model.instance(values.clone(), &moving).is_err()); // values that move must blend
/// assert!(model.instance(values.with_blending(), &moving).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Values<V> {
    values: Arc<[V]>,
    mix: Option<Mix<V>>,
}

impl<V: Copy + Blend> Values<V> {
    /// Lets instances mix the values.
    #[must_use]
    pub fn with_blending(mut self) -> Self {
        self.mix = Some(Mix { blend: V::blend, moved: V::moved });
        self
    }
}

impl<V> Values<V> {
    /// Returns the values as shared.
    pub fn shared(&self) -> &Arc<[V]> {
        &self.values
    }

    /// Holds if instances may mix the values.
    pub fn can_blend(&self) -> bool {
        self.mix.is_some()
    }

    pub(crate) fn mix(&self) -> Option<Mix<V>>
    where
        V: Copy,
    {
        self.mix
    }

    /// Checks the number of values: one for each vertex of the structure.
    pub(crate) fn check(&self, expected: usize) -> Result<(), LodError> {
        let found = self.values.len();
        if found == expected { Ok(()) } else { Err(LodError::Length { found, expected }) }
    }

    /// Returns the interpolation of values, if options ask for geomorphs.
    pub(crate) fn mix_for(&self, options: &LodOptions) -> Result<Option<Mix<V>>, LodError>
    where
        V: Copy,
    {
        if options.geomorph.is_none() {
            return Ok(None);
        }
        self.mix.map(Some).ok_or(LodError::NeedsBlending { what: "a geomorph" })
    }

    /// Returns the values, to be changed, or replaced by as many.
    pub(crate) fn shared_mut(&mut self) -> &mut Arc<[V]> {
        &mut self.values
    }
}

impl Values<()> {
    /// Makes no values, for an instance needed for its triangles alone.
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
