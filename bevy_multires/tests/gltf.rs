//! Meshes of a scene loaded from a glTF file get levels when the scene is there. With feature `gltf`: `cargo test -p bevy_multires --features gltf`

mod support;

use std::path::Path;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityClass;
use bevy::gltf::{GltfAssetLabel, GltfExtras, GltfMaterialName, GltfMeshName, GltfPlugin, GltfSceneName};
use bevy::image::ImagePlugin;
use bevy::prelude::*;
use bevy::transform::components::TransformTreeChanged;
use bevy::world_serialization::{WorldAssetRoot, WorldSerializationPlugin};
use bevy_multires::{AutoLod, DrawnLod, LodSettings};
use multires::mesh::shapes;
use support::{app, camera, until};

/// Registers the components of a scene, which an app with all of Bevy's plugins has registered.
fn register(app: &mut App) {
    app.register_type::<Transform>()
        .register_type::<GlobalTransform>()
        .register_type::<TransformTreeChanged>()
        .register_type::<Visibility>()
        .register_type::<InheritedVisibility>()
        .register_type::<ViewVisibility>()
        .register_type::<VisibilityClass>()
        .register_type::<Aabb>()
        .register_type::<Mesh3d>()
        .register_type::<Name>()
        .register_type::<ChildOf>()
        .register_type::<Children>()
        .register_type::<GltfMeshName>()
        .register_type::<GltfMaterialName>()
        .register_type::<GltfSceneName>()
        .register_type::<GltfExtras>();
}

#[test]
fn a_scene_loaded_later() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("robot.glb");
    multires::io::write(&file, &shapes::robot(6)).expect("the folder can be written to");
    let mut app = app();
    app.add_plugins((ImagePlugin::default(), WorldSerializationPlugin, GltfPlugin::default()));
    register(&mut app);
    app.finish();
    app.cleanup();
    app.insert_resource(LodSettings::default().with_all(AutoLod::default()));
    app.world_mut().spawn(camera(Vec3::Z * 100.0));
    app.update();

    let scene = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset("robot.glb"));
    app.world_mut().spawn(WorldAssetRoot(scene));
    let mut levels = app.world_mut().query::<(&DrawnLod, &Mesh3d)>();
    until(&mut app, "the scene draws levels", |app| {
        let drawn: Vec<_> = levels.iter(app.world()).collect();
        // Three materials are three meshes.
        drawn.len() == 3 && drawn.iter().all(|(lod, mesh)| lod.level() > Some(0) && mesh.0 != *lod.source())
    });
}
