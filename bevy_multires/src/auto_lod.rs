//! What an application says and reads: components, settings and counts.

use std::sync::Arc;

use bevy::ecs::prelude::*;
use bevy::prelude::{AssetId, Handle, Mesh, Reflect, ReflectComponent, ReflectResource};

use crate::build::{BuildError, Ladder};
use crate::follow::Follow;

/// Gives an entity with `Mesh3d` levels of detail. They are built once for each mesh, in the background; until they are there, and where
/// they cannot be built, the mesh itself is drawn.
///
/// The drawn level is the coarsest whose error, seen from the nearest point of the entity's box, is at most `tolerance_px` pixels in
/// every active `Camera3d` that shares a render layer with the entity.
///
/// ```
/// use bevy_multires::AutoLod;
///
/// let distant = AutoLod::default().with_tolerance_px(2.0);
/// let terrain = AutoLod::view_dependent();
/// assert!(terrain.view_dependent && !distant.view_dependent);
/// ```
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Component)]
#[non_exhaustive]
pub struct AutoLod {
    /// Largest error on the screen, physical pixels; default 0.5: the picture looks the same. At 1 half as many triangles are drawn, and
    /// light shows some levels.
    pub tolerance_px: f32,
    /// Share of the tolerance by which the error of a coarser level must stay below it before the level is taken, 0 to 1; default
    /// 0.2. Finer levels come at once. Keeps a camera that moves to and fro from switching to and fro.
    pub hysteresis: f32,
    /// Whether the entity has a mesh of its own that is fine where a camera needs it and coarse elsewhere; default false: one of a few
    /// levels, shared by all entities with the mesh.
    pub view_dependent: bool,
}

impl Default for AutoLod {
    fn default() -> Self {
        Self { tolerance_px: 0.5, hysteresis: 0.2, view_dependent: false }
    }
}

impl AutoLod {
    /// Follows the view within the mesh: for large models of which the camera is near a part, such as terrain.
    pub fn view_dependent() -> Self {
        Self { view_dependent: true, ..Self::default() }
    }

    /// Sets the largest error on the screen, physical pixels.
    #[must_use]
    pub fn with_tolerance_px(mut self, pixels: f32) -> Self {
        self.tolerance_px = pixels;
        self
    }

    /// Sets the hysteresis, 0 to 1.
    #[must_use]
    pub fn with_hysteresis(mut self, share: f32) -> Self {
        self.hysteresis = share;
        self
    }
}

/// Keeps an entity from getting [`AutoLod`] by [`LodSettings::all`].
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component)]
pub struct NoAutoLod;

/// Settings of all levels of detail.
///
/// ```
/// use bevy_multires::{AutoLod, LodSettings};
///
/// let everything = LodSettings::default().with_all(AutoLod::default());
/// assert!(everything.enabled);
/// ```
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
#[non_exhaustive]
pub struct LodSettings {
    /// Whether levels are drawn; default true. If not, all entities draw their own meshes. Levels stay in memory.
    pub enabled: bool,
    /// The component that every entity with `Mesh3d` gets, also those of scenes loaded later; default none.
    pub all: Option<AutoLod>,
    /// Factor on all tolerances, above 0; default 1. Larger is coarser.
    pub tolerance_factor: f32,
    /// Which levels meshes get. A change holds for meshes whose build has not begun.
    #[reflect(ignore)]
    pub ladder: Ladder,
}

impl Default for LodSettings {
    fn default() -> Self {
        Self { enabled: true, all: None, tolerance_factor: 1.0, ladder: Ladder::default() }
    }
}

impl LodSettings {
    /// Sets whether levels are drawn.
    #[must_use]
    pub fn with_enabled(mut self, enabled: bool) -> Self {
        self.enabled = enabled;
        self
    }

    /// Sets the component that every entity with `Mesh3d` gets, or (`None`) none.
    #[must_use]
    pub fn with_all(mut self, all: impl Into<Option<AutoLod>>) -> Self {
        self.all = all.into();
        self
    }

    /// Sets the factor on all tolerances.
    #[must_use]
    pub fn with_tolerance_factor(mut self, factor: f32) -> Self {
        self.tolerance_factor = factor;
        self
    }

    /// Sets which levels meshes get.
    #[must_use]
    pub fn with_ladder(mut self, ladder: Ladder) -> Self {
        self.ladder = ladder;
        self
    }
}

/// Counts of the last frame.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default, Reflect)]
#[reflect(Resource)]
#[non_exhaustive]
pub struct LodStats {
    /// Entities with levels, or with a mesh of their own that follows the view.
    pub entities: usize,
    /// Triangles of their meshes as drawn, inside the view or not.
    pub triangles: usize,
    /// Triangles of their meshes at full resolution.
    pub full_triangles: usize,
    /// Entities whose `Mesh3d` was switched to another level.
    pub switches: usize,
    /// Meshes that follow the view and changed. Bevy uploads each whole.
    pub changed_meshes: usize,
    /// Bytes of these meshes: vertices, indices and morph targets.
    pub changed_bytes: usize,
    /// Meshes whose levels are being built.
    pub building: usize,
}

/// Sent when the levels of a mesh are there, or cannot be built.
#[derive(Message, Debug, Clone)]
#[non_exhaustive]
pub struct LodBuilt {
    /// The mesh.
    pub mesh: AssetId<Mesh>,
    /// Whether a hierarchy for [`AutoLod::view_dependent`] was built.
    pub view_dependent: bool,
    /// Why there are no levels; `None` if there are.
    pub error: Option<BuildError>,
}

/// A coarser level of a mesh.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct LodLevel {
    /// The level as an asset of its own.
    pub mesh: Handle<Mesh>,
    /// Error, object units: the bound for the distance of the surfaces, or the mean deviation of the normals (radians) times half the
    /// mean edge where that is more, because light shows it.
    pub error: f32,
    /// Number of triangles.
    pub triangles: usize,
}

/// The levels of a mesh, shared by all entities that draw it. Level 0 is the mesh itself.
#[derive(Debug, Clone, Default)]
pub struct LodLevels {
    pub(crate) full_triangles: usize,
    /// Fine to coarse, errors ascending.
    pub(crate) coarser: Vec<LodLevel>,
}

impl LodLevels {
    /// Returns the coarser levels, fine to coarse: levels 1 and up.
    pub fn coarser(&self) -> &[LodLevel] {
        &self.coarser
    }

    /// Returns the number of triangles of a level.
    pub fn triangles(&self, level: usize) -> usize {
        match level.checked_sub(1) {
            None => self.full_triangles,
            Some(at) => self.coarser.get(at).map_or(0, |level| level.triangles),
        }
    }

    /// Returns the level to draw where an error of `allowed` (object units) is tolerated: at once if it is finer than the drawn level
    /// `at`, and only with `hysteresis` to spare if it is coarser.
    pub(crate) fn choose(&self, allowed: f32, at: usize, hysteresis: f32) -> usize {
        let coarsest = |allowed: f32| self.coarser.partition_point(|level| level.error <= allowed);
        let now = coarsest(allowed);
        if now <= at { now } else { coarsest(allowed * (1.0 - hysteresis.clamp(0.0, 1.0))).max(at) }
    }
}

/// What an entity with [`AutoLod`] draws: which level of which mesh. Added by the plugin when the levels are there; read it to tell.
#[derive(Component)]
pub struct DrawnLod {
    /// The mesh itself.
    pub(crate) source: Handle<Mesh>,
    pub(crate) drawn: Drawn,
}

pub(crate) enum Drawn {
    /// There are no levels, or none of this kind.
    Source { view_dependent: bool },
    /// One of the levels of the mesh.
    Level { levels: Arc<LodLevels>, at: usize },
    /// A mesh of its own that follows the view.
    Follow(Box<Follow>),
}

impl DrawnLod {
    /// Returns the mesh itself, at full resolution.
    pub fn source(&self) -> &Handle<Mesh> {
        &self.source
    }

    /// Returns the number of the drawn level: 0 is the mesh itself. `None` if the entity follows the view by a mesh of its own.
    pub fn level(&self) -> Option<usize> {
        match &self.drawn {
            Drawn::Source { .. } => Some(0),
            Drawn::Level { at, .. } => Some(*at),
            Drawn::Follow(_) => None,
        }
    }

    /// Returns the levels; `None` if the entity follows the view by a mesh of its own, or has no levels.
    pub fn levels(&self) -> Option<&Arc<LodLevels>> {
        match &self.drawn {
            Drawn::Level { levels, .. } => Some(levels),
            _ => None,
        }
    }

    /// Returns the number of triangles chosen for the cameras; `None` if there are no levels. While levels are switched off,
    /// [`full_triangles`](Self::full_triangles) are drawn.
    pub fn triangles(&self) -> Option<usize> {
        match &self.drawn {
            Drawn::Source { .. } => None,
            Drawn::Level { levels, at } => Some(levels.triangles(*at)),
            Drawn::Follow(follow) => Some(follow.triangles()),
        }
    }

    /// Returns the number of triangles at full resolution; `None` if there are no levels.
    pub fn full_triangles(&self) -> Option<usize> {
        match &self.drawn {
            Drawn::Source { .. } => None,
            Drawn::Level { levels, .. } => Some(levels.full_triangles),
            Drawn::Follow(follow) => Some(follow.full_triangles()),
        }
    }

    /// Returns the mesh to draw.
    pub(crate) fn wanted(&self, enabled: bool) -> &Handle<Mesh> {
        match &self.drawn {
            Drawn::Level { levels, at } if enabled => at
                .checked_sub(1)
                .and_then(|at| levels.coarser.get(at))
                .map_or(&self.source, |level| &level.mesh),
            Drawn::Follow(follow) if enabled => follow.mesh().unwrap_or(&self.source),
            _ => &self.source,
        }
    }

    /// Holds if a mesh is one that the plugin draws for this entity.
    pub(crate) fn owns(&self, mesh: AssetId<Mesh>) -> bool {
        self.source.id() == mesh
            || match &self.drawn {
                Drawn::Source { .. } => false,
                Drawn::Level { levels, .. } => levels.coarser.iter().any(|level| level.mesh.id() == mesh),
                Drawn::Follow(follow) => follow.mesh().is_some_and(|own| own.id() == mesh),
            }
    }

    pub(crate) fn is_view_dependent(&self) -> bool {
        match &self.drawn {
            Drawn::Source { view_dependent } => *view_dependent,
            Drawn::Level { .. } => false,
            Drawn::Follow(_) => true,
        }
    }
}
