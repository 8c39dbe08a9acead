//! An entity that follows the view has a mesh of its own: fine where a camera needs it, coarse elsewhere.

mod support;

use bevy::asset::AssetEvent;
use bevy::mesh::Indices;
use bevy::prelude::*;
use bevy_multires::{AutoLod, DrawnLod, LodCache, LodSettings, LodStats, convert};
use multires::mesh::shapes;
use support::{add, app, built, camera, mesh_of, move_to, triangles, until};

/// Hills from -1 to 1.
fn terrain() -> Mesh {
    convert::to_bevy(&shapes::terrain(96, 3)).expect("a legal mesh").with_computed_area_weighted_normals()
}

/// Returns the number of triangles with all corners at an `x` above 0, and below.
fn sides(mesh: &Mesh) -> [usize; 2] {
    let positions =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|values| values.as_float3()).expect("floats");
    let corners: Vec<usize> = mesh.indices().map(|indices| indices.iter().collect()).unwrap_or_default();
    let count = |right: bool| {
        let on = |corner: &usize| (positions[*corner][0] > 0.0) == right;
        corners.as_chunks::<3>().0.iter().filter(|triangle| triangle.iter().all(on)).count()
    };
    [count(true), count(false)]
}

#[test]
fn it_is_fine_where_the_camera_is() {
    let mut app = app();
    let full = terrain();
    let mesh = add(&mut app, full.clone());
    let model = app.world_mut().spawn((Mesh3d(mesh), AutoLod::view_dependent().with_tolerance_px(2.0))).id();
    // Looks along -z, over all of the terrain.
    let eye = app.world_mut().spawn(camera(Vec3::new(0.8, 0.3, 1.5))).id();
    built(&mut app, &[model]);
    let [right, left] = sides(mesh_of(&app, model));
    assert!(right > left, "{right} triangles near the camera, {left} elsewhere");
    assert!(triangles(&app, model) < full.indices().map_or(0, Indices::len) / 3);

    move_to(&mut app, eye, Vec3::new(-0.8, 0.3, 1.5));
    app.update();
    let [right, left] = sides(mesh_of(&app, model));
    assert!(left > right, "{left} triangles near the camera, {right} elsewhere");
    assert!(mesh_of(&app, model).contains_attribute(Mesh::ATTRIBUTE_NORMAL));
}

#[test]
fn its_mesh_changes_when_the_cut_does_and_only_then() {
    let mut app = app();
    let mesh = add(&mut app, terrain());
    let models =
        [0; 2].map(|_| app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::view_dependent())).id());
    let eye = app.world_mut().spawn(camera(Vec3::new(0.0, 0.3, 1.5))).id();
    built(&mut app, &models);
    let handle = |app: &App, model| app.world().get::<Mesh3d>(model).expect("it has a mesh").0.clone();
    let first = handle(&app, models[0]);
    assert!(first != mesh && first != handle(&app, models[1])); // each its own
    app.update();
    assert_eq!(app.world().resource::<LodStats>().changed_meshes, 0);

    let mut reader = app.world().resource::<Messages<AssetEvent<Mesh>>>().get_cursor_current();
    move_to(&mut app, eye, Vec3::new(0.3, 0.3, 1.2));
    app.update();
    let stats = *app.world().resource::<LodStats>();
    assert_eq!((stats.entities, stats.changed_meshes), (2, 2));
    // The same asset, changed: Bevy uploads all of its vertices and indices.
    assert_eq!(handle(&app, models[0]), first);
    let events = app.world().resource::<Messages<AssetEvent<Mesh>>>();
    assert!(reader.read(events).any(|event| *event == AssetEvent::Modified { id: first.id() }));
    let bytes = |mesh: &Mesh| {
        let vertices: usize = mesh.attributes().map(|(_, values)| values.get_bytes().len()).sum();
        vertices + mesh.get_index_buffer_bytes().map_or(0, <[u8]>::len)
    };
    let both = bytes(mesh_of(&app, models[0])) + bytes(mesh_of(&app, models[1]));
    assert_eq!(stats.changed_bytes, both);
    assert_eq!(stats.triangles, triangles(&app, models[0]) + triangles(&app, models[1]));
}

#[test]
fn at_no_tolerance_it_is_the_mesh_itself() {
    let mut app = app();
    let full = convert::to_bevy(&shapes::rock(2_000, 1)).expect("a legal mesh");
    let mesh = add(&mut app, full.clone());
    // Back faces stay coarse, so the camera is inside, and two look both ways.
    let model =
        app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::view_dependent().with_tolerance_px(0.0))).id();
    for turn in 0..8 {
        let (around, up) = (turn % 4, turn / 4);
        let away =
            Quat::from_rotation_y(around as f32 * 1.6) * Vec3::new(3.0, 3.0 * (1.0 - 2.0 * up as f32), 3.0);
        let eye = app.world_mut().spawn(camera(away)).id();
        let looking = Transform::from_translation(away).looking_at(Vec3::ZERO, Vec3::Y);
        app.world_mut().entity_mut(eye).insert(looking);
    }
    built(&mut app, &[model]);
    assert_eq!(triangles(&app, model), 2_000);
    app.world_mut().resource_mut::<LodSettings>().enabled = false;
    app.update();
    assert_eq!(app.world().get::<Mesh3d>(model).map(|drawn| drawn.0.clone()), Some(mesh));
}

#[test]
fn the_kind_may_change_while_it_is_drawn() {
    let mut app = app();
    let mesh = add(&mut app, terrain());
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    app.world_mut().spawn(camera(Vec3::new(0.0, 0.3, 1.5)));
    built(&mut app, &[model]);
    assert!(app.world().get::<DrawnLod>(model).is_some_and(|lod| lod.level().is_some()));
    app.world_mut().entity_mut(model).insert(AutoLod::view_dependent());
    until(&mut app, "it follows the view", |app| {
        app.world().get::<DrawnLod>(model).is_some_and(|lod| lod.level().is_none())
    });
    app.world_mut().entity_mut(model).insert(AutoLod::default());
    until(&mut app, "it draws levels", |app| {
        app.world().get::<DrawnLod>(model).is_some_and(|lod| lod.level().is_some())
    });
    assert_eq!(app.world().get::<DrawnLod>(model).map(|lod| lod.source().id()), Some(mesh.id()));
}

#[test]
fn meshes_go_with_their_entity() {
    let mut app = app();
    let mesh = add(&mut app, terrain());
    app.world_mut().spawn(camera(Vec3::new(0.0, 0.3, 1.5)));
    let model = app.world_mut().spawn((Mesh3d(mesh), AutoLod::view_dependent())).id();
    built(&mut app, &[model]);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 2);
    app.world_mut().despawn(model);
    until(&mut app, "no mesh is left", |app| app.world().resource::<Assets<Mesh>>().is_empty());
    assert_eq!(app.world().resource::<LodCache>().building(), 0);
}
