//! Apps without a renderer, and cameras whose values are set by hand.
#![allow(dead_code, reason = "each test uses some of it")]

use std::time::{Duration, Instant};

use bevy::asset::{AssetPlugin, RenderAssetUsages};
use bevy::camera::visibility::VisibilityPlugin;
use bevy::camera::{ComputedCameraValues, RenderTargetInfo};
use bevy::mesh::{Indices, MeshPlugin, PrimitiveTopology};
use bevy::prelude::*;
use bevy_multires::{DrawnLod, LodCache, MultiresPlugin};

/// Returns an app with meshes, transforms and levels of detail, and no renderer.
pub fn app() -> App {
    let mut app = App::new();
    let assets = AssetPlugin { file_path: env!("CARGO_TARGET_TMPDIR").to_owned(), ..default() };
    app.add_plugins((MinimalPlugins, assets, TransformPlugin, MeshPlugin, VisibilityPlugin, MultiresPlugin));
    app
}

/// Returns a camera of 90 degrees and 1000 x 1000 pixels at a place, looking along -z.
pub fn camera(at: Vec3) -> impl Bundle {
    let clip_from_view = Mat4::perspective_infinite_reverse_rh(std::f32::consts::FRAC_PI_2, 1.0, 0.1);
    let target_info = Some(RenderTargetInfo { physical_size: UVec2::splat(1000), scale_factor: 1.0 });
    let computed = ComputedCameraValues { clip_from_view, target_info, ..default() };
    (Camera3d::default(), Camera { computed, ..default() }, Transform::from_translation(at))
}

/// Returns a triangle list of positions and indices.
pub fn list(positions: Vec<[f32; 3]>, indices: Indices) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(indices)
}

/// Returns a rock of about so many triangles.
pub fn rock(triangles: u32) -> Mesh {
    bevy_multires::convert::to_bevy(&multires::mesh::shapes::rock(triangles, 1)).expect("a rock is a mesh")
}

/// Adds a mesh to an app.
pub fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// Updates until a condition holds. Panics after two minutes.
pub fn until(app: &mut App, what: &str, mut holds: impl FnMut(&mut App) -> bool) {
    let begin = Instant::now();
    loop {
        app.update();
        if holds(app) {
            return;
        }
        assert!(begin.elapsed() < Duration::from_secs(120), "waited in vain: {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Updates until no build runs and all entities given have what they draw, and once more.
pub fn built(app: &mut App, entities: &[Entity]) {
    until(app, "levels are built", |app| {
        app.world().resource::<LodCache>().building() == 0
            && entities.iter().all(|&entity| app.world().get::<DrawnLod>(entity).is_some())
    });
    app.update();
}

/// Returns the level that an entity draws.
pub fn level(app: &App, entity: Entity) -> usize {
    app.world().get::<DrawnLod>(entity).and_then(DrawnLod::level).expect("the entity has levels")
}

/// Returns the mesh that an entity draws.
pub fn mesh_of(app: &App, entity: Entity) -> &Mesh {
    let handle = &app.world().get::<Mesh3d>(entity).expect("the entity has a mesh").0;
    app.world().resource::<Assets<Mesh>>().get(handle).expect("the mesh is there")
}

/// Returns the number of triangles that an entity draws.
pub fn triangles(app: &App, entity: Entity) -> usize {
    mesh_of(app, entity).indices().map_or(0, |indices| indices.len() / 3)
}

/// Moves an entity.
pub fn move_to(app: &mut App, entity: Entity, to: Vec3) {
    app.world_mut().get_mut::<Transform>(entity).expect("the entity has a place").translation = to;
}
