//! Instances of wavelet meshes: the triangles of a cut, and the values of its vertices, which change with it.
//!
//! A vertex that is in use only because a wavelet beside it splits its edge lies in the middle of the edge, so every instance draws
//! values of its own: dirty ranges are of them, static or compact.

use std::sync::Arc;

use multires::adapt::{Change, DirtyRanges, Geomorph, LevelOfDetail};
use multires::error::MeshError;
use multires::view::{Motion, ObjectView};
use multires::wavelet::{Drawing, Triangulation, WaveletLod, WaveletMesh};

use super::instance::{Everything, Instance, LodSettings, Storage};
use crate::renderer::{Drawn, Values, Vertex};

/// Seconds from call to call where nobody says.
const STEP: f32 = 1.0 / 60.0;
/// Seconds of the shortest transition.
const SHORTEST: f32 = 1e-3;

/// An instance of a wavelet mesh.
pub struct WaveletInstance {
    lod: WaveletLod<Vertex>,
    /// Seconds of a transition, where vertices move.
    duration: Option<f32>,
}

impl WaveletInstance {
    /// With the vertices of the mesh, in its order.
    ///
    /// # Errors
    /// They are not as many as the mesh's.
    pub fn new(
        mesh: &Arc<WaveletMesh>,
        vertices: &Arc<[Vertex]>,
        settings: &LodSettings,
    ) -> Result<Self, MeshError> {
        // How it is drawn is set when an instance is made. A transition takes a second of time that goes by faster or slower, so
        // that other durations do not ask for a new instance.
        let second = Geomorph::default().with_duration(1.0);
        let drawing = Drawing::default()
            .with_triangulation(settings.triangulation)
            .with_packed(settings.storage == Storage::Compact)
            .with_geomorph(settings.geomorph.map(|_| second));
        let lod = WaveletLod::new(Arc::clone(mesh), Arc::clone(vertices), &drawing)?;
        Ok(Self { lod: lod.with_options(settings.limits), duration: settings.geomorph })
    }

    /// What is drawn.
    pub fn drawn(&self) -> &WaveletLod<Vertex> {
        &self.lod
    }

    fn kind(&self) -> (Triangulation, bool) {
        (self.lod.drawing().triangulation, self.lod.drawing().packed)
    }
}

impl LevelOfDetail for WaveletInstance {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        self.adapt_in(views, STEP)
    }

    fn adapt_in(&mut self, views: &[ObjectView], seconds: f32) -> Change {
        self.lod.adapt_in(views, seconds / self.duration.unwrap_or(1.0).max(SHORTEST))
    }

    fn groups(&self) -> usize {
        self.lod.groups()
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.lod.triangles(group)
    }

    fn vertices(&self) -> Option<&[u32]> {
        self.lod.vertices()
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.lod.dirty_triangles(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.lod.dirty_vertices(gap)
    }

    fn clean(&mut self) {
        self.lod.clean();
    }
}

impl Drawn for WaveletInstance {
    fn lod(&self) -> &dyn LevelOfDetail {
        self
    }

    fn lod_mut(&mut self) -> &mut dyn LevelOfDetail {
        self
    }

    fn values(&self) -> Values<'_> {
        Values::Own(self.lod.values())
    }
}

impl Instance for WaveletInstance {
    fn set(&mut self, settings: &LodSettings) -> bool {
        let kind = (settings.triangulation, settings.storage == Storage::Compact);
        if kind != self.kind() || settings.geomorph.is_some() != self.duration.is_some() {
            return false;
        }
        self.duration = settings.geomorph;
        self.lod.set_options(settings.limits);
        true
    }

    fn settle(&mut self) {
        self.lod.settle();
    }

    fn refine_fully(&mut self) {
        self.lod.adapt_by(&Everything, Motion::Other, f32::INFINITY);
    }

    fn memory(&self) -> usize {
        self.lod.memory()
    }
}
