//! With levels the picture is the same, of far fewer triangles; switching levels uploads nothing, following the view uploads meshes whole.
//! Drawn by the first adapter there is, also by one in software; without any, tests say by name that they skip.

#[path = "../examples/models/headless.rs"]
mod headless;
#[path = "../examples/models/scene.rs"]
mod scene;

use std::sync::{Arc, Mutex};

use bevy::asset::{AssetId, RenderAssetUsages};
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::render::mesh::RenderMesh;
use bevy::render::render_asset::ExtractedAssets;
use bevy::render::{Render, RenderApp, RenderSystems};
use bevy_multires::{AutoLod, LodSettings, LodStats, convert};
use headless::{Headless, difference};
use multires::mesh::shapes;
use scene::Field;

/// Returns the app, or says by name that a test skips.
fn drawing(test: &str, size: UVec2, eye: Transform, plugins: impl FnOnce(&mut App)) -> Option<Headless> {
    let headless = Headless::new(size, eye, scene::SKY, plugins);
    if headless.is_none() {
        eprintln!("{test} skips: there is no adapter to draw with");
    }
    headless
}

/// Holds that a picture shows something: not one colour.
fn assert_shows(pixels: &[u8]) {
    assert!(!pixels.is_empty() && difference(pixels, &pixels[..4].repeat(pixels.len() / 4)) > 2.0);
}

/// A mesh that went to the render world, and its bytes.
type Upload = (AssetId<Mesh>, usize);

/// Meshes that went to the render world.
#[derive(Resource, Clone, Default)]
struct Uploads(Arc<Mutex<Vec<Upload>>>);

impl Uploads {
    fn watch(&self, app: &mut App) {
        let render = app.get_sub_app_mut(RenderApp).expect("there is a renderer");
        render.insert_resource(self.clone()).add_systems(Render, record.before(RenderSystems::PrepareAssets));
    }

    fn take(&self) -> Vec<Upload> {
        std::mem::take(&mut self.0.lock().expect("no test panicked within"))
    }
}

fn record(extracted: Res<ExtractedAssets<RenderMesh>>, uploads: Res<Uploads>) {
    let bytes =
        |mesh: &Mesh| mesh.get_vertex_buffer_size() + mesh.get_index_buffer_bytes().map_or(0, <[u8]>::len);
    let new = extracted.extracted.iter().map(|(id, mesh)| (*id, bytes(mesh)));
    uploads.0.lock().expect("no test panicked within").extend(new);
}

#[test]
fn the_same_picture_of_a_quarter_of_the_triangles() {
    let field = Field { models: 500, triangles: 8_000 };
    let Some(mut headless) = drawing(
        "the_same_picture_of_a_quarter_of_the_triangles",
        UVec2::new(800, 450),
        scene::eye(&field),
        |app| {
            app.insert_resource(field).add_systems(Startup, scene::spawn);
            app.insert_resource(LodSettings::default().with_all(AutoLod::default()));
        },
    ) else {
        return;
    };
    headless.settle();
    let with = headless.picture();
    let stats = *headless.app.world().resource::<LodStats>();
    headless.app.world_mut().resource_mut::<LodSettings>().enabled = false;
    let without = headless.picture();
    let full = *headless.app.world().resource::<LodStats>();
    assert_shows(&with);
    println!(
        "{} of {} triangles, difference {}",
        stats.triangles,
        full.triangles,
        difference(&with, &without)
    );
    assert!(difference(&with, &without) <= 2.0, "{}", difference(&with, &without));
    assert!(with != without, "levels are drawn");
    assert!(stats.entities >= 500 && full.triangles == full.full_triangles);
    assert!(4 * stats.triangles <= full.triangles, "{} of {}", stats.triangles, full.triangles);
}

#[test]
fn switching_levels_uploads_nothing_and_following_uploads_whole_meshes() {
    let name = "switching_levels_uploads_nothing_and_following_uploads_whole_meshes";
    let eye = Transform::from_xyz(0.0, 1.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y);
    let Some(mut headless) = drawing(name, UVec2::splat(64), eye, |_| {}) else { return };
    let app = &mut headless.app;
    let uploads = Uploads::default();
    uploads.watch(app);
    let rock = convert::to_bevy(&shapes::rock(4_000, 1))
        .expect("a legal mesh")
        .with_computed_area_weighted_normals();
    let rock = app.world_mut().resource_mut::<Assets<Mesh>>().add(rock);
    let paint = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial::default());
    let models: Vec<Entity> = (0..20)
        .map(|at| {
            let place = Transform::from_xyz(at as f32 - 10.0, 0.0, -4.0);
            app.world_mut()
                .spawn((Mesh3d(rock.clone()), MeshMaterial3d(paint.clone()), place, AutoLod::default()))
                .id()
        })
        .collect();
    headless.settle();
    let built = uploads.take();
    assert!((4..12).contains(&built.len()), "a mesh and its levels, once for 20 entities: {}", built.len());
    // All coarser levels together hold less than the mesh itself.
    let full = built.iter().find(|(id, _)| *id == rock.id()).map_or(0, |(_, bytes)| *bytes);
    assert!(built.iter().map(|(_, bytes)| bytes).sum::<usize>() < 2 * full + full / 5);

    let mut switches = 0;
    for step in 0..10 {
        let mut cameras = headless.app.world_mut().query_filtered::<&mut Transform, With<Camera3d>>();
        for mut place in cameras.iter_mut(headless.app.world_mut()) {
            place.translation.z = 4.0 + 12.0 * step as f32;
        }
        headless.frame();
        switches += headless.app.world().resource::<LodStats>().switches;
    }
    assert!(switches >= 20);
    assert_eq!(uploads.take(), []);

    headless.app.world_mut().entity_mut(models[0]).insert(AutoLod::view_dependent());
    headless.settle();
    assert_eq!(uploads.take().len(), 1);
    let mut cameras = headless.app.world_mut().query_filtered::<&mut Transform, With<Camera3d>>();
    for mut place in cameras.iter_mut(headless.app.world_mut()) {
        place.translation = Vec3::new(-10.0, 0.5, -1.5);
    }
    headless.frame();
    let stats = *headless.app.world().resource::<LodStats>();
    let uploaded = uploads.take();
    assert_eq!((uploaded.len(), stats.changed_meshes), (1, 1));
    assert_eq!(uploaded[0].1, stats.changed_bytes);
}

/// A tube of five joints, half of them turned, with a morph target that widens it.
fn bent(app: &mut App, lod: Option<AutoLod>, levels: bool) {
    let mut mesh = convert::to_bevy(&shapes::skinned_tube(96, 160)).expect("a legal mesh");
    mesh.asset_usage = RenderAssetUsages::default();
    let positions =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|values| values.as_float3()).expect("floats");
    let wider = |p: &[f32; 3]| MorphAttributes::new(Vec3::new(p[0], 0.0, p[2]), Vec3::ZERO, Vec3::ZERO);
    let targets = positions.iter().map(wider).collect();
    mesh.set_morph_targets(targets);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let paint = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(Color::srgb(0.8, 0.5, 0.3));
    let joints: Vec<Entity> = (0..5)
        .map(|joint| {
            app.world_mut().spawn(Transform::from_rotation(Quat::from_rotation_z(0.12 * joint as f32))).id()
        })
        .collect();
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 5]);
    let inverse_bindposes = app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let weights = MeshMorphWeights::Value { weights: vec![0.6] };
    let skin = SkinnedMesh { inverse_bindposes, joints };
    let tube = app.world_mut().spawn((Mesh3d(mesh), MeshMaterial3d(paint), skin, weights)).id();
    if let Some(lod) = lod {
        app.world_mut().entity_mut(tube).insert(lod);
    }
    app.world_mut().resource_mut::<LodSettings>().enabled = levels;
    let sun = Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    app.world_mut().spawn((DirectionalLight { illuminance: 6_000.0, ..default() }, sun));
}

#[test]
fn a_skinned_and_morphed_mesh_keeps_its_shape() {
    let eye = Transform::from_xyz(0.0, 1.2, 9.0).looking_at(Vec3::Y, Vec3::Y);
    let picture = |lod: Option<AutoLod>, levels: bool| {
        let name = "a_skinned_and_morphed_mesh_keeps_its_shape";
        let mut headless = drawing(name, UVec2::splat(256), eye, |_| {})?;
        bent(&mut headless.app, lod, levels);
        headless.settle();
        let picture = headless.picture();
        let stats = *headless.app.world().resource::<LodStats>();
        Some((picture, stats.triangles, stats.full_triangles))
    };
    let Some((plain, ..)) = picture(None, true) else { return };
    assert_shows(&plain);
    for lod in [AutoLod::default(), AutoLod::view_dependent()] {
        let Some((leveled, triangles, full)) = picture(Some(lod), true) else { return };
        assert!(2 * triangles < full, "{triangles} of {full}");
        assert!(difference(&plain, &leveled) <= 2.0, "{}", difference(&plain, &leveled));
    }
}
