//! The plugin, and its systems in the order of a frame.
//!
//! ```text
//!     PreUpdate     forget -> reset -> collect            meshes changed; finished builds become assets
//!     PostUpdate    adopt -> attach -> choose -> follow -> show -> count
//! ```
//!
//! Levels become assets in one schedule and are drawn from the next on, so that Bevy has uploaded them by then.

use std::sync::Arc;

use bevy::app::{App, Plugin, PostUpdate, PreUpdate};
use bevy::asset::{AssetApp, AssetEventSystems, Assets};
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{RenderLayers, VisibilitySystems};
use bevy::camera::{Camera, Camera3d, CameraUpdateSystems};
use bevy::ecs::prelude::*;
use bevy::log::warn;
use bevy::math::{Vec3, Vec3A};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::time::Time;
use bevy::transform::TransformSystems;
use bevy::transform::components::GlobalTransform;
use multires::view::View;

use crate::auto_lod::{AutoLod, Drawn, DrawnLod, LodBuilt, LodSettings, LodStats, NoAutoLod};
use crate::build::BuildError;
use crate::cache::{self, Found, LodCache, Outdated, Ready};
use crate::follow::Follow;
use crate::model::{LodModel, LodModel3d, LodModelLoader};

/// Levels of detail for every entity with [`AutoLod`]. Add it after Bevy's `DefaultPlugins`.
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_multires::MultiresPlugin;
///
/// App::new().add_plugins((DefaultPlugins, MultiresPlugin)).run();
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct MultiresPlugin;

/// The systems that choose levels, in `PostUpdate`. Move cameras and entities before it.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LodSystems;

impl Plugin for MultiresPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<LodSettings>()
            .init_resource::<LodStats>()
            .init_resource::<LodCache>()
            .init_resource::<Outdated>()
            .add_message::<LodBuilt>()
            .register_type::<AutoLod>()
            .register_type::<NoAutoLod>()
            .init_asset::<LodModel>()
            .init_asset_loader::<LodModelLoader>()
            .add_observer(restore)
            .configure_sets(
                PostUpdate,
                LodSystems
                    .after(TransformSystems::Propagate)
                    .after(CameraUpdateSystems)
                    .before(VisibilitySystems::CalculateBounds)
                    .before(AssetEventSystems),
            )
            .add_systems(PreUpdate, (cache::forget, reset, cache::collect).chain().run_if(has_meshes))
            .add_systems(
                PostUpdate,
                (adopt, attach, choose, follow, show, count).chain().in_set(LodSystems).run_if(has_meshes),
            );
    }
}

/// Holds if Bevy's own plugin for meshes is there.
fn has_meshes(meshes: Option<Res<Assets<Mesh>>>) -> bool {
    meshes.is_some()
}

/// Draws the mesh itself again where [`AutoLod`] was removed.
fn restore(removed: On<Remove, AutoLod>, mut drawn: Query<(&DrawnLod, &mut Mesh3d)>, mut commands: Commands) {
    if let Ok((lod, mut mesh)) = drawn.get_mut(removed.entity) {
        if lod.owns(mesh.0.id()) && mesh.0 != lod.source {
            mesh.0 = lod.source.clone();
        }
        commands.entity(removed.entity).try_remove::<DrawnLod>();
    }
}

/// What [`reset`] looks at.
type Attached =
    (Entity, Ref<'static, AutoLod>, &'static mut Mesh3d, &'static DrawnLod, Option<Ref<'static, LodModel3d>>);

/// Forgets what entities draw if their mesh, their model or the kind of levels has changed.
fn reset(mut entities: Query<Attached>, outdated: Res<Outdated>, mut commands: Commands) {
    for (entity, lod, mut mesh, drawn, model) in &mut entities {
        let other_mesh = mesh.is_changed() && !drawn.owns(mesh.0.id());
        let other_kind = lod.is_changed() && lod.view_dependent != drawn.is_view_dependent();
        let other_model = model.is_some_and(|model| model.is_changed() && !model.is_added());
        if other_mesh || other_kind || other_model || outdated.0.contains(&drawn.source.id()) {
            if !other_mesh && mesh.0 != drawn.source {
                mesh.0 = drawn.source.clone();
            }
            commands.entity(entity).try_remove::<DrawnLod>();
        }
    }
}

/// Entities that [`LodSettings::all`] is for.
type Plain = (With<Mesh3d>, Without<AutoLod>, Without<NoAutoLod>);

/// Gives all entities with meshes [`AutoLod`], if the settings say so.
fn adopt(entities: Query<Entity, Plain>, settings: Res<LodSettings>, mut commands: Commands) {
    if let Some(all) = settings.all {
        for entity in &entities {
            commands.entity(entity).try_insert(all);
        }
    }
}

/// What [`attach`] looks at: entities that want levels and have none.
type Waiting = (Entity, &'static AutoLod, Option<&'static mut Mesh3d>, Option<&'static LodModel3d>);

/// Gives entities what was built for their mesh or loaded from their file, and begins to build.
fn attach(
    mut entities: Query<Waiting, Without<DrawnLod>>,
    mut cache: ResMut<LodCache>,
    settings: Res<LodSettings>,
    mut meshes: ResMut<Assets<Mesh>>,
    models: Res<Assets<LodModel>>,
    mut commands: Commands,
) {
    for (entity, lod, mesh, model) in &mut entities {
        let view_dependent = lod.view_dependent;
        let drawn = if let Some(model) = model {
            let Some(loaded) = models.get(model.id()) else { continue };
            let Some(part) = loaded.parts().get(model.part) else {
                let error = BuildError::Part { part: model.part, parts: loaded.parts().len() };
                warn!("nothing is drawn of a model: {error}");
                commands.entity(entity).try_remove::<LodModel3d>();
                continue;
            };
            match mesh {
                Some(mut mesh) => mesh.0 = part.mesh.clone(),
                None => {
                    commands.entity(entity).try_insert(Mesh3d(part.mesh.clone()));
                }
            }
            let follow = view_dependent.then(|| {
                let group = loaded.following.model.materials().iter().position(|&id| id == part.material);
                Follow::new(Arc::clone(&loaded.following), group.unwrap_or(0), part.levels.full_triangles)
            });
            let drawn = match follow {
                Some(Ok(follow)) => Drawn::Follow(Box::new(follow)),
                Some(Err(_)) => {
                    warn!("{}", BuildError::NotViewDependent { kind: loaded.kind() });
                    Drawn::Level { levels: Arc::clone(&part.levels), at: 0 }
                }
                None => Drawn::Level { levels: Arc::clone(&part.levels), at: 0 },
            };
            DrawnLod { source: part.mesh.clone(), drawn }
        } else {
            let Some(mut mesh) = mesh else { continue };
            let id = cache.source_of(mesh.0.id());
            let drawn = match cache.find(id, view_dependent, &settings.ladder, &meshes) {
                Found::Later => continue,
                Found::Failed => Drawn::Source { view_dependent },
                Found::Ready(Ready::Levels(levels)) => Drawn::Level { levels, at: 0 },
                Found::Ready(Ready::Following(model)) => {
                    let full = model.model.triangle_counts()[0];
                    match Follow::new(model, 0, full) {
                        Ok(follow) => Drawn::Follow(Box::new(follow)),
                        Err(error) => {
                            warn!("a mesh cannot follow the view: {error}");
                            Drawn::Source { view_dependent }
                        }
                    }
                }
            };
            if id != mesh.0.id() {
                // Copied from an entity that drew a level at that time.
                let Some(source) = meshes.get_strong_handle(id) else { continue };
                mesh.0 = source;
            }
            DrawnLod { source: mesh.0.clone(), drawn }
        };
        commands.entity(entity).try_insert(drawn);
    }
}

/// What [`eyes`] looks at.
type Cameras<'w, 's> =
    Query<'w, 's, (&'static Camera, &'static GlobalTransform, Option<&'static RenderLayers>), With<Camera3d>>;

/// Returns the views of the active cameras, with their layers.
fn eyes(cameras: &Cameras) -> Vec<(View, RenderLayers)> {
    let mut eyes = Vec::new();
    for (camera, place, layers) in cameras {
        let Some(size) = camera.physical_viewport_size().filter(|_| camera.is_active) else { continue };
        let world_to_eye = place.to_matrix().inverse().to_cols_array_2d();
        let eye_to_clip = camera.clip_from_view().to_cols_array_2d();
        // A camera without an extent, or with a scale of 0, draws nothing.
        if let Ok(view) = View::from_projection(world_to_eye, eye_to_clip, size.to_array()) {
            eyes.push((view, layers.cloned().unwrap_or_default()));
        }
    }
    eyes
}

/// What [`choose`] looks at.
type Leveled = (
    &'static GlobalTransform,
    &'static AutoLod,
    &'static mut DrawnLod,
    Option<&'static Aabb>,
    Option<&'static RenderLayers>,
);

/// Chooses the levels of all entities.
fn choose(mut entities: Query<Leveled>, cameras: Cameras, settings: Res<LodSettings>) {
    let eyes = eyes(&cameras);
    if eyes.is_empty() || !settings.enabled {
        return;
    }
    let factor = settings.tolerance_factor;
    entities.par_iter_mut().for_each(|(place, lod, mut drawn, aabb, layers)| {
        let Drawn::Level { levels, at } = &mut drawn.bypass_change_detection().drawn else { return };
        let everywhere = RenderLayers::default();
        let layers = layers.unwrap_or(&everywhere);
        let seen = eyes.iter().filter(|(_, layer)| layer.intersects(layers));
        let errors = seen.map(|(view, _)| tolerated(view, place, aabb, lod.tolerance_px * factor));
        let chosen = levels.choose(errors.fold(f32::INFINITY, f32::min), *at, lod.hysteresis);
        if chosen != *at {
            *at = chosen;
            drawn.set_changed();
        }
    });
}

/// Returns the error (object units) that is `pixels` on the screen at the nearest point of the entity's box.
fn tolerated(view: &View, place: &GlobalTransform, aabb: Option<&Aabb>, pixels: f32) -> f32 {
    let affine = place.affine();
    let scale = affine.matrix3.to_cols_array_2d().map(|axis| Vec3::from(axis).length());
    let largest = scale.into_iter().fold(0.0, f32::max);
    let distance = view.eye().map_or(f32::INFINITY, |eye| {
        // Nearest in the object's space, then measured in the world's: exact but for different scales.
        let (centre, half) = aabb.map_or((Vec3A::ZERO, Vec3A::ZERO), |aabb| (aabb.center, aabb.half_extents));
        let eye = Vec3A::from(eye);
        let within = affine.inverse().transform_point3a(eye).clamp(centre - half, centre + half);
        if within.is_finite() { affine.transform_point3a(within).distance(eye) } else { 0.0 }
    });
    pixels / (view.pixels_per_unit(distance) * largest)
}

/// What [`follow`] looks at.
type Followed = (
    &'static GlobalTransform,
    &'static AutoLod,
    &'static mut DrawnLod,
    Option<&'static RenderLayers>,
    Has<SkinnedMesh>,
    Has<MeshMorphWeights>,
);

/// Lets meshes follow the view.
fn follow(
    mut entities: Query<Followed>,
    cameras: Cameras,
    settings: Res<LodSettings>,
    time: Option<Res<Time>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut stats: ResMut<LodStats>,
) {
    let eyes = eyes(&cameras);
    (stats.changed_meshes, stats.changed_bytes) = (0, 0);
    if eyes.is_empty() || !settings.enabled {
        return;
    }
    let (factor, seconds) = (settings.tolerance_factor, time.map_or(0.0, |time| time.delta_secs()));
    entities.par_iter_mut().for_each(|(place, lod, mut drawn, layers, skinned, morphed)| {
        let Drawn::Follow(follow) = &mut drawn.bypass_change_detection().drawn else { return };
        let everywhere = RenderLayers::default();
        let layers = layers.unwrap_or(&everywhere);
        let moving = skinned || morphed;
        let views: Vec<_> = eyes
            .iter()
            .filter(|(_, layer)| layer.intersects(layers))
            .filter_map(|(view, _)| {
                // Where vertices move, the structure does not know which face away, or lie outside the view.
                let view = view.clone().with_tolerance_px(lod.tolerance_px * factor);
                let view = view.with_frustum(!moving).with_back_faces_culled(!moving);
                view.of_object(place.to_matrix().to_cols_array_2d()).ok()
            })
            .collect();
        if let Err(error) = follow.adapt(&views, seconds) {
            warn!("a mesh does not follow the view: {error}");
        }
    });
    for (.., mut drawn, _, _, _) in &mut entities {
        let Drawn::Follow(follow) = &mut drawn.bypass_change_detection().drawn else { continue };
        if let Some(bytes) = follow.hand_over(&mut meshes) {
            stats.changed_meshes += 1;
            stats.changed_bytes += bytes;
            drawn.set_changed();
        }
    }
}

/// Draws what was chosen: switches `Mesh3d` where it is another mesh.
fn show(
    mut entities: Query<(&DrawnLod, &mut Mesh3d)>,
    settings: Res<LodSettings>,
    mut stats: ResMut<LodStats>,
) {
    stats.switches = 0;
    for (drawn, mut mesh) in &mut entities {
        let wanted = drawn.wanted(settings.enabled);
        // What an application has put there is seen next frame.
        if mesh.0.id() != wanted.id() && drawn.owns(mesh.0.id()) {
            mesh.0 = wanted.clone();
            stats.switches += 1;
        }
    }
}

/// Counts what is drawn.
fn count(
    entities: Query<&DrawnLod>,
    cache: Res<LodCache>,
    settings: Res<LodSettings>,
    mut stats: ResMut<LodStats>,
) {
    let counts = entities.iter().filter_map(|drawn| Some([drawn.triangles()?, drawn.full_triangles()?]));
    let mut all = [0; 3];
    for [triangles, full] in counts {
        all = [all[0] + 1, all[1] + if settings.enabled { triangles } else { full }, all[2] + full];
    }
    [stats.entities, stats.triangles, stats.full_triangles] = all;
    stats.building = cache.building();
}
