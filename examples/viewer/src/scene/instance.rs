//! Instances of structures: levels of detail with the values of their vertices.
//!
//! Whatever implements [`LevelOfDetail`] can be drawn: give it an [`Instance`].

use std::sync::Arc;

use multires::adapt::{Geomorph, LevelOfDetail, LodOptions};
use multires::hierarchy::{HierarchyLod, MorphedLod, VertexHierarchy};
use multires::view::{Answer, Criterion, Motion};
use multires::wavelet::Triangulation;

use crate::renderer::{Drawn, Values, Vertex};

/// Where vertices are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Storage {
    /// All of them on the card, once for all instances.
    #[default]
    Static,
    /// Those in use, for each instance.
    Compact,
}

/// How an instance follows the view.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LodSettings {
    /// Where vertices are kept; default static.
    pub storage: Storage,
    /// Limits of triangles and operations; default none.
    pub limits: LodOptions,
    /// Seconds in which vertices move to their places; default none: they jump.
    pub geomorph: Option<f32>,
    /// Which triangles of a wavelet mesh; default the sum of its wavelets, exactly.
    pub triangulation: Triangulation,
}

impl LodSettings {
    /// With vertices kept there.
    #[must_use]
    pub fn with_storage(mut self, storage: Storage) -> Self {
        self.storage = storage;
        self
    }

    /// With these limits.
    #[must_use]
    pub fn with_limits(mut self, limits: LodOptions) -> Self {
        self.limits = limits;
        self
    }

    /// With vertices that move in so many seconds, or jump.
    #[must_use]
    pub fn with_geomorph(mut self, seconds: Option<f32>) -> Self {
        self.geomorph = seconds;
        self
    }

    /// With these triangles of a wavelet mesh.
    #[must_use]
    pub fn with_triangulation(mut self, triangulation: Triangulation) -> Self {
        self.triangulation = triangulation;
        self
    }
}

/// A level of detail that can be drawn, and told how to follow the view.
pub trait Instance: Drawn {
    /// Takes new settings; `false` where that takes a new instance.
    fn set(&mut self, settings: &LodSettings) -> bool;

    /// Draws all that was asked for at once: after a jump of the camera.
    fn settle(&mut self);

    /// Goes to the full resolution.
    fn refine_fully(&mut self);

    /// Bytes of the instance in memory.
    fn memory(&self) -> usize;
}

/// Needs everything, from everywhere.
pub(super) struct Everything;

impl<B> Criterion<B> for Everything {
    fn needs(&self, _: &B) -> Answer {
        Answer::ALWAYS
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Moved { distance: 0.0, angle: 0.0 }
    }
}

enum Lod {
    Jumps(HierarchyLod),
    Moves(MorphedLod<Vertex>),
}

/// An instance of a vertex hierarchy.
pub struct HierarchyInstance {
    lod: Lod,
    vertices: Arc<[Vertex]>,
    storage: Storage,
    /// Seconds of a transition, where vertices move.
    duration: f32,
}

impl HierarchyInstance {
    /// With vertices in the hierarchy's order. Where they are not as many as the hierarchy's, they do not move.
    pub fn new(hierarchy: &Arc<VertexHierarchy>, vertices: &Arc<[Vertex]>, settings: &LodSettings) -> Self {
        let make = match settings.storage {
            Storage::Static => MorphedLod::new,
            Storage::Compact => MorphedLod::packed,
        };
        let moving = match settings.geomorph {
            Some(_) => make(Arc::clone(hierarchy), Arc::clone(vertices)).ok(),
            None => None,
        };
        let lod = match (moving, settings.storage) {
            (Some(lod), _) => Lod::Moves(lod),
            (None, Storage::Static) => Lod::Jumps(HierarchyLod::new(Arc::clone(hierarchy))),
            (None, Storage::Compact) => Lod::Jumps(HierarchyLod::packed(Arc::clone(hierarchy))),
        };
        let mut instance =
            Self { lod, vertices: Arc::clone(vertices), storage: settings.storage, duration: f32::NAN };
        instance.set(settings);
        instance
    }
}

impl Drawn for HierarchyInstance {
    fn lod(&self) -> &dyn LevelOfDetail {
        match &self.lod {
            Lod::Jumps(lod) => lod,
            Lod::Moves(lod) => lod,
        }
    }

    fn lod_mut(&mut self) -> &mut dyn LevelOfDetail {
        match &mut self.lod {
            Lod::Jumps(lod) => lod,
            Lod::Moves(lod) => lod,
        }
    }

    fn values(&self) -> Values<'_> {
        match (&self.lod, self.storage) {
            (Lod::Moves(lod), _) => Values::Own(lod.values()),
            (Lod::Jumps(_), Storage::Static) => Values::Shared,
            (Lod::Jumps(_), Storage::Compact) => Values::Slots(&self.vertices),
        }
    }
}

impl Instance for HierarchyInstance {
    fn set(&mut self, settings: &LodSettings) -> bool {
        if settings.storage != self.storage {
            return false;
        }
        match (&mut self.lod, settings.geomorph) {
            (Lod::Jumps(lod), None) => lod.set_options(settings.limits),
            (Lod::Moves(lod), Some(seconds)) => {
                if seconds != self.duration {
                    // The duration is set when an instance is made, so it is made anew from what it is.
                    let geomorph = Geomorph::default().with_duration(seconds);
                    *lod = lod.clone().with_geomorph(geomorph);
                    self.duration = seconds;
                }
                lod.set_options(settings.limits);
            }
            _ => return false,
        }
        true
    }

    fn settle(&mut self) {
        match &mut self.lod {
            Lod::Jumps(lod) => lod.settle(),
            Lod::Moves(lod) => lod.settle(),
        }
    }

    fn refine_fully(&mut self) {
        match &mut self.lod {
            Lod::Jumps(lod) => drop(lod.adapt_by(&Everything, Motion::Other)),
            Lod::Moves(lod) => drop(lod.adapt_by(&Everything, Motion::Other, f32::INFINITY)),
        }
    }

    fn memory(&self) -> usize {
        match &self.lod {
            Lod::Jumps(lod) => lod.memory(),
            Lod::Moves(lod) => lod.memory(),
        }
    }
}
