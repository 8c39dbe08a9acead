//! What was built for meshes, and what is being built: once for each mesh, in the background.

use std::sync::Arc;

use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::ecs::message::{MessageReader, MessageWriter};
use bevy::ecs::system::ResMut;
use bevy::log::warn;
use bevy::mesh::Mesh;
use bevy::platform::collections::HashMap;
use bevy::prelude::Resource;
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task};

use crate::auto_lod::{LodBuilt, LodLevel, LodLevels};
use crate::build::{self, BuildError, BuiltLevel, Following, Ladder, Progress};

/// The levels of meshes, built and being built. A mesh's levels go when the mesh itself goes.
#[derive(Resource, Default)]
pub struct LodCache {
    entries: HashMap<Key, Entry>,
    /// Meshes of which a mesh is a level.
    sources: HashMap<AssetId<Mesh>, AssetId<Mesh>>,
}

/// A mesh, and whether it is built to follow the view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    mesh: AssetId<Mesh>,
    view_dependent: bool,
}

enum Entry {
    Building { task: Task<Built>, progress: Arc<Progress> },
    Ready(Ready),
    Failed,
}

impl Drop for Entry {
    fn drop(&mut self) {
        if let Self::Building { progress, .. } = self {
            progress.cancel();
        }
    }
}

/// What a task returns.
enum Built {
    Levels(usize, Result<Vec<BuiltLevel>, BuildError>),
    Following(Result<Following, BuildError>),
}

/// What was built.
#[derive(Clone)]
pub(crate) enum Ready {
    Levels(Arc<LodLevels>),
    Following(Arc<Following>),
}

/// What is known of a mesh.
pub(crate) enum Found {
    Ready(Ready),
    Failed,
    /// Being built, or the mesh is not loaded.
    Later,
}

impl LodCache {
    /// Returns the share of the build of a mesh done, 0 to 1; `None` if no build of it runs.
    pub fn progress(&self, mesh: impl Into<AssetId<Mesh>>) -> Option<f32> {
        let mesh = mesh.into();
        let share = |view_dependent| match self.entries.get(&Key { mesh, view_dependent }) {
            Some(Entry::Building { progress, .. }) => Some(progress.share()),
            _ => None,
        };
        share(false).or_else(|| share(true))
    }

    /// Returns the number of builds that run or wait.
    pub fn building(&self) -> usize {
        self.entries.values().filter(|entry| matches!(entry, Entry::Building { .. })).count()
    }

    /// Returns the share of all builds done, 0 to 1: 1 if none runs.
    pub fn total_progress(&self) -> f32 {
        let share = |entry: &Entry| match entry {
            Entry::Building { progress, .. } => progress.share(),
            _ => 1.0,
        };
        match self.entries.len() {
            0 => 1.0,
            all => self.entries.values().map(share).sum::<f32>() / all as f32,
        }
    }

    /// Returns the levels of a mesh; `None` if they are not there.
    pub fn levels(&self, mesh: impl Into<AssetId<Mesh>>) -> Option<&Arc<LodLevels>> {
        match self.entries.get(&Key { mesh: mesh.into(), view_dependent: false }) {
            Some(Entry::Ready(Ready::Levels(levels))) => Some(levels),
            _ => None,
        }
    }

    /// Returns the mesh that a mesh is a level of; itself if it is none.
    pub(crate) fn source_of(&self, mesh: AssetId<Mesh>) -> AssetId<Mesh> {
        self.sources.get(&mesh).copied().unwrap_or(mesh)
    }

    /// Returns what was built for a mesh, or begins to build it.
    pub(crate) fn find(
        &mut self,
        mesh: AssetId<Mesh>,
        view_dependent: bool,
        ladder: &Ladder,
        meshes: &Assets<Mesh>,
    ) -> Found {
        let key = Key { mesh, view_dependent };
        match self.entries.get(&key) {
            Some(Entry::Ready(ready)) => return Found::Ready(ready.clone()),
            Some(Entry::Failed) => return Found::Failed,
            Some(Entry::Building { .. }) => return Found::Later,
            None => {}
        }
        let Some(source) = meshes.get(mesh) else { return Found::Later };
        let progress = Arc::<Progress>::default();
        let (source, ladder, shared) = (source.clone(), *ladder, Arc::clone(&progress));
        let task = AsyncComputeTaskPool::get().spawn(async move {
            match view_dependent {
                false => Built::Levels(triangles(&source), build::levels(&source, &ladder, &shared)),
                true => Built::Following(build::hierarchy(&source, &shared)),
            }
        });
        self.entries.insert(key, Entry::Building { task, progress });
        Found::Later
    }

    /// Forgets what was built for a mesh, and stops building.
    fn forget(&mut self, mesh: AssetId<Mesh>) -> bool {
        let gone =
            [false, true].map(|view_dependent| self.entries.remove(&Key { mesh, view_dependent }).is_some());
        if gone[0] {
            self.sources.retain(|_, source| *source != mesh);
        }
        gone[0] || gone[1]
    }
}

/// Returns the number of triangles of a triangle list.
fn triangles(mesh: &Mesh) -> usize {
    let corners = match mesh.try_indices_option() {
        Ok(Some(indices)) => indices.len(),
        Ok(None) => mesh.count_vertices(),
        Err(_) => 0,
    };
    corners / 3
}

/// Takes what tasks have finished, a mesh for each level into Bevy's assets.
pub(crate) fn collect(
    mut cache: ResMut<LodCache>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut sent: MessageWriter<LodBuilt>,
) {
    let LodCache { entries, sources } = &mut *cache;
    for (&Key { mesh, view_dependent }, entry) in entries {
        let Entry::Building { task, .. } = entry else { continue };
        let Some(built) = check_ready(task) else { continue };
        let ready = match built {
            Built::Levels(full_triangles, levels) => levels.map(|levels| {
                let coarser: Vec<LodLevel> =
                    levels.into_iter().map(|level| added(level, &mut meshes)).collect();
                sources.extend(coarser.iter().map(|level| (level.mesh.id(), mesh)));
                Ready::Levels(Arc::new(LodLevels { full_triangles, coarser }))
            }),
            Built::Following(following) => following.map(|following| Ready::Following(Arc::new(following))),
        };
        let error = ready.as_ref().err().cloned();
        if let Some(error) = &error {
            let name = meshes.get_strong_handle(mesh).and_then(|handle| Some(handle.path()?.to_string()));
            warn!("no levels of detail for the mesh {}: {error}", name.unwrap_or_else(|| mesh.to_string()));
        }
        *entry = ready.map_or(Entry::Failed, Entry::Ready);
        sent.write(LodBuilt { mesh, view_dependent, error });
    }
}

fn added(level: BuiltLevel, meshes: &mut Assets<Mesh>) -> LodLevel {
    let triangles = triangles(&level.mesh);
    LodLevel { mesh: meshes.add(level.mesh), error: level.error, triangles }
}

/// Meshes that an application changed or removed, and of which something was built.
#[derive(Resource, Default)]
pub(crate) struct Outdated(pub Vec<AssetId<Mesh>>);

/// Forgets what was built for meshes that an application changed or removed.
pub(crate) fn forget(
    mut cache: ResMut<LodCache>,
    mut outdated: ResMut<Outdated>,
    mut events: MessageReader<AssetEvent<Mesh>>,
) {
    outdated.0.clear();
    for event in events.read() {
        if let AssetEvent::Modified { id } | AssetEvent::Removed { id } = event
            && cache.forget(*id)
        {
            outdated.0.push(*id);
        }
    }
}
