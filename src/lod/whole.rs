//! Structures drawn at a single resolution for all of the model: the error allowed by views, at the model's nearest point, and
//! the common parts of their instances.

use crate::adapt::{Dirty, DirtyRanges};
use crate::view::{Bounds, Criterion, Motion, ObjectView};

use super::{LodError, LodOptions, Mix, Values, Vertex, VertexBuffer};

/// The error allowed in a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Allowed {
    /// No error: the model is in focus.
    Nothing,
    /// Errors up to this, object units.
    Error(f32),
    /// Any error: no view sees the model.
    Anything,
}

/// The bounding sphere of a model, as tested by views.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whole {
    /// The sphere, with the diagonal as its error.
    bounds: Bounds,
    diagonal: f32,
}

impl Whole {
    /// Makes the sphere around the box of a model.
    pub fn new(extent: Option<[[f32; 3]; 2]>) -> Self {
        let [low, high] = extent.unwrap_or_default().map(glam::Vec3::from_array);
        // Halves first, so no box overflows.
        let (centre, radius) = (low * 0.5 + high * 0.5, (high * 0.5 - low * 0.5).length());
        let diagonal = (2.0 * radius).min(f32::MAX);
        Self { bounds: Bounds::new(centre.to_array(), radius, diagonal, diagonal), diagonal }
    }

    /// Returns the diagonal of the box, object units.
    pub fn diagonal(&self) -> f32 {
        self.diagonal
    }

    /// Returns the error allowed by all views together, with tolerances multiplied by a factor.
    #[inline]
    pub fn allowed(&self, views: &[ObjectView], factor: f32) -> Allowed {
        // A model in focus is drawn at full resolution. Without a focus, no view needs an error of 0.
        if views.iter().any(ObjectView::has_focus) {
            let exact = Bounds { error: 0.0, parametric: 0.0, ..self.bounds };
            if views.test(&exact).refine {
                return Allowed::Nothing;
            }
        }
        // The urgency is the factor by which tolerances must grow to allow an error of a whole diagonal. Hence the largest
        // allowed error is `diagonal * factor / urgency`.
        let urgency = views.urgency(&self.bounds);
        if urgency > 0.0 {
            Allowed::Error((f64::from(self.diagonal) * f64::from(factor) / urgency) as f32)
        } else {
            Allowed::Anything
        }
    }

    /// Whether some view may see the model.
    pub fn is_seen(&self, views: &[ObjectView]) -> bool {
        views.iter().any(|view| view.sees(&self.bounds))
    }

    /// Returns the motion of views since others; [`Motion::Other`] if there were none.
    pub fn motion(views: &[ObjectView], before: &[ObjectView]) -> Motion {
        match before.is_empty() {
            true => Motion::Other,
            false => Criterion::<Bounds>::motion(views, before),
        }
    }
}

/// Options, views and vertex values of an instance drawn at a single resolution.
#[derive(Debug, Clone)]
pub(crate) struct WholeInstance<V> {
    options: LodOptions,
    factor: f32,
    /// Views of the last call.
    pub views: Vec<ObjectView>,
    values: Values<V>,
    /// Only where vertices move.
    moving: Option<Moving<V>>,
    /// Written vertices, in use or not.
    dirty: Dirty,
}

/// Vertices moved by the processor.
#[derive(Debug, Clone)]
struct Moving<V> {
    mix: Mix<V>,
    /// Drawn value of each vertex.
    drawn: Vec<V>,
}

/// Options accepted by an instance, not yet in force.
pub(crate) struct Accepted<V> {
    options: LodOptions,
    mix: Option<Mix<V>>,
    /// Set if vertices begin or cease to move.
    pub moves: bool,
    /// Set if all must be uploaded anew.
    pub rebuilds: bool,
    /// Set if the resolution asked for must be drawn before the options are in force.
    pub settles: bool,
}

impl<V: Vertex> WholeInstance<V> {
    /// Creates the parts of an instance with all vertices at their own places. Needs as many values as `vertices`.
    pub fn new(values: Values<V>, vertices: usize, options: &LodOptions) -> Result<Self, LodError> {
        values.check(vertices)?;
        let mix = values.mix_for(options)?;
        let moving = mix.map(|mix| Moving { mix, drawn: values.to_vec() });
        let mut new = Self {
            options: *options,
            factor: 1.0,
            views: Vec::new(),
            values,
            moving,
            dirty: Dirty::default(),
        };
        new.invalidate();
        Ok(new)
    }

    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    pub fn factor(&self) -> f32 {
        self.factor
    }

    /// Sets the factor of tolerances. Ignores factors which are not positive and finite.
    pub fn set_factor(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.factor = factor;
        }
    }

    /// Replaces the views of the last call.
    pub fn look(&mut self, views: &[ObjectView]) {
        self.views.clear();
        self.views.extend_from_slice(views);
    }

    /// Checks new options.
    pub fn accept(&self, options: &LodOptions) -> Result<Accepted<V>, LodError> {
        let mix = self.values.mix_for(options)?;
        let moves = mix.is_some() != self.moving.is_some();
        let rebuilds = moves || options.buffer != self.options.buffer;
        Ok(Accepted { options: *options, mix, moves, rebuilds, settles: rebuilds || options.is_immediate() })
    }

    /// Brings options in force. Where vertices begin to move, all are at their own places.
    pub fn set_options(&mut self, accepted: Accepted<V>) {
        self.options = accepted.options;
        if accepted.moves {
            self.moving = accepted.mix.map(|mix| Moving { mix, drawn: self.values.to_vec() });
        }
    }

    /// Whether the processor moves vertices.
    pub fn moves(&self) -> bool {
        self.moving.is_some()
    }

    /// Returns the drawn values of all vertices of the structure.
    pub fn values(&self) -> &[V] {
        self.moving.as_ref().map_or(&self.values, |moving| &moving.drawn)
    }

    /// Draws vertices as blends: each with the two vertices it lies between, at a share of the way from the first to the
    /// second.
    pub fn blend(&mut self, vertices: impl Iterator<Item = (u32, [u32; 2])>, share: f32) {
        let Some(Moving { mix, drawn }) = &mut self.moving else { return };
        for (vertex, ends) in vertices {
            let [from, to] = ends.map(|v| self.values[v as usize]);
            drawn[vertex as usize] = (mix.blend)(&from, &to, share);
            self.dirty.mark(vertex);
        }
    }

    /// Moves vertices back to their own places.
    pub fn rest(&mut self, vertices: impl Iterator<Item = u32>) {
        let Some(Moving { drawn, .. }) = &mut self.moving else { return };
        for vertex in vertices {
            drawn[vertex as usize] = self.values[vertex as usize];
            self.dirty.mark(vertex);
        }
    }

    /// Returns the number of vertices in the buffer, of which `prefix` are in use.
    fn buffered(&self, prefix: usize) -> usize {
        match self.options.buffer {
            VertexBuffer::Packed => prefix,
            _ => self.values.len(),
        }
    }

    pub fn vertex_bytes(&self, prefix: usize) -> &[u8] {
        bytemuck::cast_slice(&self.values()[..self.buffered(prefix)])
    }

    pub fn shares_vertices(&self) -> bool {
        self.options.buffer == VertexBuffer::Shared && self.moving.is_none()
    }

    pub fn dirty_vertices(&self, prefix: usize, gap: usize) -> DirtyRanges<'_> {
        self.dirty.ranges(self.buffered(prefix), gap)
    }

    /// Clears the marks of buffered vertices. Other vertices keep their marks: nobody uploaded them.
    pub fn clean(&mut self, prefix: usize) {
        let buffered = self.buffered(prefix);
        self.dirty.clear_range(0..buffered);
    }

    /// Marks all vertices that the instance uploads.
    pub fn invalidate(&mut self) {
        self.dirty.clear();
        if !self.shares_vertices() {
            self.dirty.mark_all(self.values.len());
        }
    }

    pub fn memory(&self) -> usize {
        let moving = self.moving.as_ref().map_or(0, |moving| size_of_val(&moving.drawn[..]));
        self.dirty.memory() + self.views.capacity() * size_of::<ObjectView>() + moving
    }
}
