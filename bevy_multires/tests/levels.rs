//! Entities draw the coarsest level within their tolerance, and share levels; what cannot have levels keeps its mesh.

mod support;

use bevy::camera::visibility::RenderLayers;
use bevy::mesh::Indices;
use bevy::prelude::*;
use bevy_multires::{AutoLod, DrawnLod, Ladder, LodBuilt, LodCache, LodSettings, LodStats, NoAutoLod};
use support::{add, app, built, camera, level, list, mesh_of, move_to, rock, triangles, until};

const DISTANCES: [f32; 7] = [1.5, 10.0, 40.0, 100.0, 200.0, 500.0, 10_000.0];

#[test]
fn farther_is_coarser_and_within_the_tolerance() {
    let mut app = app();
    let mesh = add(&mut app, rock(4_000));
    let model = app
        .world_mut()
        .spawn((Mesh3d(mesh.clone()), AutoLod::default().with_tolerance_px(1.0).with_hysteresis(0.0)))
        .id();
    let eye = app.world_mut().spawn(camera(Vec3::Z * 2.0)).id();
    built(&mut app, &[model]);

    let levels = app.world().resource::<LodCache>().levels(&mesh).expect("they are built").clone();
    assert!(levels.coarser().len() >= 5);
    assert_eq!(levels.triangles(0), triangles(&app, model));
    let mut last = 0;
    for distance in DISTANCES {
        move_to(&mut app, eye, Vec3::Z * distance);
        app.update();
        let at = level(&app, model);
        assert!(at >= last);
        assert_eq!(triangles(&app, model), levels.triangles(at));
        last = at;

        // 90 degrees over 1000 pixels: 500 pixels a unit at distance 1. The box of a rock reaches at most 1.5 towards the eye.
        let pixels = |error: f32, near: f32| error * 500.0 / (distance - near).max(1e-6);
        if let Some(drawn) = at.checked_sub(1) {
            assert!(pixels(levels.coarser()[drawn].error, 0.0) <= 1.0);
        }
        if let Some(coarser) = levels.coarser().get(at) {
            assert!(pixels(coarser.error, 1.5) > 1.0);
        }
    }
    assert_eq!(last, levels.coarser().len());
    move_to(&mut app, eye, Vec3::ZERO);
    app.update();
    assert_eq!(level(&app, model), 0); // within the box: the mesh itself
    assert_eq!(app.world().get::<Mesh3d>(model).map(|mesh| mesh.0.id()), Some(mesh.id()));
}

#[test]
fn every_level_is_a_legal_mesh_of_half_the_triangles() {
    let mut app = app();
    let mesh = add(
        &mut app,
        Mesh::from(Torus::new(0.5, 1.0)).with_generated_tangents().expect("it has coordinates"),
    );
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    let levels = app.world().resource::<LodCache>().levels(&mesh).expect("they are built").clone();
    let meshes = app.world().resource::<Assets<Mesh>>();
    let full = meshes.get(&mesh).expect("it is there");
    let ids = |mesh: &Mesh| mesh.attributes().map(|(attribute, _)| attribute.id).collect::<Vec<_>>();
    let mut last = (levels.triangles(0), 0.0, full.count_vertices() + 1);
    assert!(levels.coarser().len() >= 3);
    for level in levels.coarser() {
        let mesh = meshes.get(&level.mesh).expect("it is there");
        assert!(level.triangles * 2 <= last.0 && level.error >= last.1 && mesh.count_vertices() < last.2);
        last = (level.triangles, level.error, mesh.count_vertices());
        assert_eq!(ids(mesh), ids(full));
        assert!(mesh.attributes().all(|(_, values)| values.len() == mesh.count_vertices()));
        assert!(mesh.indices().is_some_and(|all| all.iter().all(|index| index < mesh.count_vertices())));
        assert_eq!(mesh.indices().map(|all| matches!(all, Indices::U32(_))), Some(true)); // the width of the source
        let find = |position: &[f32; 3]| vertices(full).iter().any(|other| other == position);
        assert!(vertices(mesh).iter().all(find)); // levels place no vertex anew
    }
}

fn vertices(mesh: &Mesh) -> Vec<[f32; 3]> {
    let positions = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|values| values.as_float3());
    positions.expect("positions are floats").to_vec()
}

#[test]
fn one_camera_shakes_and_nothing_switches() {
    let mut app = app();
    let mesh = add(&mut app, rock(4_000));
    let shaking = |hysteresis: f32, app: &mut App| {
        let model = app
            .world_mut()
            .spawn((Mesh3d(mesh.clone()), AutoLod::default().with_hysteresis(hysteresis)))
            .id();
        let eye = app.world_mut().spawn(camera(Vec3::Z * 10.0)).id();
        built(app, &[model]);
        // Where the level changes without hysteresis.
        let mut far = 10.0;
        let first = level(app, model);
        while level(app, model) == first {
            far *= 1.01;
            move_to(app, eye, Vec3::Z * far);
            app.update();
        }
        let mut switches = 0;
        for shake in 0..20 {
            move_to(app, eye, Vec3::Z * far * if shake % 2 == 0 { 0.97 } else { 1.01 });
            app.update();
            switches += app.world().resource::<LodStats>().switches;
        }
        app.world_mut().despawn(model);
        app.world_mut().despawn(eye);
        switches
    };
    assert_eq!(shaking(0.2, &mut app), 0);
    assert_eq!(shaking(0.0, &mut app), 20);
}

#[test]
fn entities_with_one_mesh_share_one_build_and_its_levels() {
    let mut app = app();
    let mesh = add(&mut app, rock(2_000));
    app.world_mut().spawn(camera(Vec3::Z * 200.0));
    let models: Vec<Entity> =
        (0..50).map(|_| app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id()).collect();
    built(&mut app, &models);
    let after = app.world().resource::<Assets<Mesh>>().len();
    let levels = app.world().resource::<LodCache>().levels(&mesh).map(|levels| levels.coarser().len());
    assert_eq!(Some(after - 1), levels); // one mesh a level, however many entities
    let handles: Vec<_> =
        models.iter().map(|&model| app.world().get::<Mesh3d>(model).map(|mesh| mesh.0.id())).collect();
    assert!(handles.iter().all(|handle| *handle == handles[0]) && handles[0] != Some(mesh.id()));

    // One more, a copy of what another draws: still the same levels.
    let copy = app.world().get::<Mesh3d>(models[0]).expect("it has a mesh").clone();
    let copy = app.world_mut().spawn((copy, AutoLod::default())).id();
    built(&mut app, &[copy]);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), after);
    assert_eq!(app.world().get::<DrawnLod>(copy).map(|lod| lod.source().id()), Some(mesh.id()));
}

#[test]
fn switching_changes_no_mesh() {
    let mut app = app();
    let mesh = add(&mut app, rock(20_000));
    let eye = app.world_mut().spawn(camera(Vec3::Z * 2.0)).id();
    let model = app.world_mut().spawn((Mesh3d(mesh), AutoLod::default())).id();
    built(&mut app, &[model]);
    app.update();
    let mut reader = app.world().resource::<Messages<AssetEvent<Mesh>>>().get_cursor_current();
    let mut switches = 0;
    for distance in DISTANCES.into_iter().chain(DISTANCES.into_iter().rev()) {
        move_to(&mut app, eye, Vec3::Z * distance);
        app.update();
        switches += app.world().resource::<LodStats>().switches;
        assert_eq!(reader.read(app.world().resource::<Messages<AssetEvent<Mesh>>>()).count(), 0); // nothing to upload
    }
    assert!(switches >= 6);
}

#[test]
fn of_several_cameras_the_one_that_wants_most_decides() {
    let mut app = app();
    let mesh = add(&mut app, rock(4_000));
    let model = app.world_mut().spawn((Mesh3d(mesh), AutoLod::default())).id();
    app.world_mut().spawn(camera(Vec3::Z * 300.0));
    built(&mut app, &[model]);
    let far = level(&app, model);
    let near = app.world_mut().spawn((camera(Vec3::Z * 3.0), RenderLayers::layer(1))).id();
    app.update();
    assert_eq!(level(&app, model), far); // it does not see the model
    app.world_mut().entity_mut(near).insert(RenderLayers::default());
    app.update();
    assert!(level(&app, model) < far);
    app.world_mut().get_mut::<Camera>(near).expect("it is a camera").is_active = false;
    app.update();
    assert_eq!(level(&app, model), far);
}

#[test]
fn scale_counts_as_distance_does() {
    let mut app = app();
    let mesh = add(&mut app, rock(4_000));
    let small = app
        .world_mut()
        .spawn((Mesh3d(mesh.clone()), AutoLod::default(), Transform::from_xyz(0.0, 0.0, -40.0)))
        .id();
    let large = Transform::from_xyz(0.0, 0.0, -400.0).with_scale(Vec3::splat(10.0));
    let large = app.world_mut().spawn((Mesh3d(mesh), AutoLod::default(), large)).id();
    app.world_mut().spawn(camera(Vec3::ZERO));
    built(&mut app, &[small, large]);
    assert!(level(&app, small) > 0);
    assert_eq!(level(&app, small), level(&app, large));
}

#[test]
fn a_setting_gives_levels_to_all_that_come() {
    let mut app = app();
    let mesh = add(&mut app, rock(1_000));
    app.world_mut().spawn(camera(Vec3::Z * 300.0));
    let before = app.world_mut().spawn(Mesh3d(mesh.clone())).id();
    app.update();
    assert!(app.world().get::<AutoLod>(before).is_none());

    let all = LodSettings::default().with_all(AutoLod::default().with_tolerance_px(2.0));
    app.insert_resource(all);
    let kept = app.world_mut().spawn((Mesh3d(mesh.clone()), NoAutoLod)).id();
    built(&mut app, &[before]);
    // As a scene does that was loaded in the meantime.
    let later = app.world_mut().spawn(Mesh3d(mesh.clone())).id();
    built(&mut app, &[later]);
    assert_eq!(app.world().get::<AutoLod>(later).map(|lod| lod.tolerance_px), Some(2.0));
    assert!(level(&app, before) > 0 && level(&app, later) > 0);
    assert!(app.world().get::<AutoLod>(kept).is_none());
}

#[test]
fn a_mesh_that_cannot_have_levels_is_drawn_as_it_is() {
    let mut app = app();
    app.world_mut().spawn(camera(Vec3::Z * 300.0));
    let degenerate =
        list(vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], Indices::U32([0, 1, 1].repeat(100)));
    let none = list(Vec::new(), Indices::U32(Vec::new()));
    let broken = list(vec![[f32::NAN; 3]; 3], Indices::U32([0, 1, 2].repeat(100)));
    let strip = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleStrip, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 200]);
    for view_dependent in [false, true] {
        for mesh in [&degenerate, &none, &broken, &strip] {
            let mesh = add(&mut app, mesh.clone());
            let mut lod = AutoLod::default();
            lod.view_dependent = view_dependent;
            let models = [0; 3].map(|_| app.world_mut().spawn((Mesh3d(mesh.clone()), lod)).id());
            let mut reader = app.world().resource::<Messages<LodBuilt>>().get_cursor_current();
            let mut errors = 0;
            until(&mut app, "the build fails", |app| {
                let messages = app.world().resource::<Messages<LodBuilt>>();
                errors += reader.read(messages).filter(|built| built.error.is_some()).count();
                errors > 0
            });
            built(&mut app, &models);
            assert_eq!(errors, 1); // once for all entities
            for model in models {
                assert_eq!(app.world().get::<Mesh3d>(model).map(|drawn| drawn.0.id()), Some(mesh.id()));
            }
        }
    }
}

#[test]
fn a_small_mesh_has_no_levels_and_no_error() {
    let mut app = app();
    app.world_mut().spawn(camera(Vec3::Z * 300.0));
    let cube = add(&mut app, Mesh::from(Cuboid::default()));
    let model = app.world_mut().spawn((Mesh3d(cube.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    assert_eq!(level(&app, model), 0);
    assert!(
        app.world().resource::<LodCache>().levels(&cube).is_some_and(|levels| levels.coarser().is_empty())
    );
}

#[test]
fn levels_go_off_and_on() {
    let mut app = app();
    let mesh = add(&mut app, rock(2_000));
    app.world_mut().spawn(camera(Vec3::Z * 100.0));
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    let coarse = triangles(&app, model);
    assert!(coarse < 1_000);
    app.world_mut().resource_mut::<LodSettings>().enabled = false;
    app.update();
    assert_eq!(triangles(&app, model), 2_000);
    assert_eq!(app.world().resource::<LodStats>().triangles, 2_000);
    app.world_mut().resource_mut::<LodSettings>().enabled = true;
    app.update();
    assert_eq!(triangles(&app, model), coarse);
    assert_eq!(app.world().resource::<LodStats>().triangles, coarse);
    app.world_mut().resource_mut::<LodSettings>().tolerance_factor = 0.01;
    app.update();
    assert!(triangles(&app, model) > coarse);
}

#[test]
fn without_the_component_the_mesh_itself_comes_back() {
    let mut app = app();
    let mesh = add(&mut app, rock(2_000));
    app.world_mut().spawn(camera(Vec3::Z * 100.0));
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    app.world_mut().entity_mut(model).remove::<AutoLod>();
    app.update();
    assert_eq!(app.world().get::<Mesh3d>(model).map(|drawn| drawn.0.id()), Some(mesh.id()));
    assert!(app.world().get::<DrawnLod>(model).is_none());
}

#[test]
fn a_mesh_that_changes_gets_new_levels() {
    let mut app = app();
    let mesh = add(&mut app, rock(2_000));
    app.world_mut().spawn(camera(Vec3::Z * 100.0));
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);

    // The asset changes.
    let count = |mesh: &Mesh| mesh.indices().map(|indices| indices.len() / 3);
    let (large, small) = (rock(8_000), rock(1_000));
    let counts = [&large, &small].map(count);
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(mesh.id(), large).expect("it is there");
    app.update();
    let full = |app: &App| app.world().get::<DrawnLod>(model).and_then(DrawnLod::full_triangles);
    until(&mut app, "levels of the new mesh", |app| full(app) == counts[0]);
    until(&mut app, "a level", |app| level(app, model) > 0);

    // The entity gets another mesh.
    let other = add(&mut app, small);
    app.world_mut().get_mut::<Mesh3d>(model).expect("it has a mesh").0 = other.clone();
    until(&mut app, "levels of the other mesh", |app| full(app) == counts[1]);
    assert_eq!(app.world().get::<DrawnLod>(model).map(|lod| lod.source().id()), Some(other.id()));
}

#[test]
fn levels_go_with_their_mesh() {
    let mut app = app();
    let mesh = add(&mut app, rock(2_000));
    app.world_mut().spawn(camera(Vec3::Z * 100.0));
    let model = app.world_mut().spawn((Mesh3d(mesh), AutoLod::default())).id();
    built(&mut app, &[model]);
    assert!(app.world().resource::<Assets<Mesh>>().len() > 3);
    app.world_mut().despawn(model);
    until(&mut app, "no mesh is left", |app| app.world().resource::<Assets<Mesh>>().is_empty());
}

#[test]
fn the_ladder_says_which_levels_there_are() {
    let mut app = app();
    let ladder = Ladder::default().with_ratio(0.25).with_least_triangles(200).with_most_levels(3);
    app.insert_resource(LodSettings::default().with_ladder(ladder));
    let mesh = add(&mut app, rock(20_000));
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    let levels = app.world().resource::<LodCache>().levels(&mesh).expect("they are built");
    let counts: Vec<usize> = levels.coarser().iter().map(|level| level.triangles).collect();
    assert_eq!(counts.len(), 2);
    // A step takes a few triangles away, so a level may have a few less.
    let quarters = [levels.triangles(0) / 4, levels.triangles(0) / 16];
    assert!(counts.iter().zip(quarters).all(|(&count, most)| (most - most / 50..=most).contains(&count)));
    assert!(mesh_of(&app, model).count_vertices() > 0);
}

#[test]
fn a_build_tells_how_far_it_is() {
    let mut app = app();
    let rock = rock(60_000);
    let full = rock.indices().map_or(0, Indices::len) / 3;
    let mesh = add(&mut app, rock);
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    let mut shares = Vec::new();
    until(&mut app, "levels are built", |app| {
        let cache = app.world().resource::<LodCache>();
        shares.extend(cache.progress(&mesh));
        assert_eq!(triangles(app, model), full); // drawn as it is until then; no camera chooses a level
        cache.levels(&mesh).is_some()
    });
    assert!(shares.is_sorted() && shares.iter().any(|share| (0.1..1.0).contains(share)), "{shares:?}");
    assert_eq!(app.world().resource::<LodCache>().total_progress(), 1.0);
}
