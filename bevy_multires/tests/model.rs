//! Baked files are assets: their levels are drawn without a build, and a damaged file is an error of the asset server.

mod support;

use std::path::Path;

use bevy::asset::{AssetServer, LoadState};
use bevy::prelude::*;
use bevy_multires::{AutoLod, DrawnLod, LodCache, LodModel, LodModel3d, LodStats};
use multires::lod::Structure;
use multires::mesh::{Mesh as Input, shapes};
use multires::{Gmesh, TotallyOrderedMesh, VertexHierarchy};
use support::{app, camera, level, move_to, triangles, until};

/// Writes a baked file where assets are.
fn write<S: Structure>(name: &str, mesh: &Input)
where
    multires::Baked<S>: stored::Write,
{
    let model = S::bake(mesh).unwrap_or_else(|error| panic!("{error}"));
    stored::Write::write_to(&model, &Path::new(env!("CARGO_TARGET_TMPDIR")).join(name));
}

/// Names the structures that files hold.
mod stored {
    use std::path::Path;

    pub trait Write {
        fn write_to(&self, path: &Path);
    }

    macro_rules! write {
        ($($structure:ty),*) => { $(
            impl Write for multires::Baked<$structure> {
                fn write_to(&self, path: &Path) {
                    self.write(path).expect("the folder can be written to");
                }
            }
        )* };
    }
    write!(multires::TotallyOrderedMesh, multires::VertexHierarchy, multires::Gmesh);
}

/// Spawns a model of a file, and updates until it is drawn.
fn drawn(app: &mut App, file: &str, lod: AutoLod, part: usize) -> Entity {
    let model = app.world().resource::<AssetServer>().load(file.to_owned());
    let entity = app.world_mut().spawn((LodModel3d::new(model).with_part(part), lod)).id();
    until(app, "the file is loaded", |app| app.world().get::<DrawnLod>(entity).is_some());
    app.update();
    entity
}

#[test]
fn levels_of_every_structure_without_a_build() {
    let rock = shapes::rock(4_000, 1);
    write::<TotallyOrderedMesh>("tom.mres", &rock);
    write::<VertexHierarchy>("hierarchy.mres", &rock);
    write::<Gmesh>("gmesh.mres", &rock);
    for file in ["tom.mres", "hierarchy.mres", "gmesh.mres"] {
        let mut app = app();
        let eye = app.world_mut().spawn(camera(Vec3::ZERO)).id();
        let model = drawn(&mut app, file, AutoLod::default(), 0);
        assert_eq!((level(&app, model), triangles(&app, model)), (0, rock.triangles().len()));
        move_to(&mut app, eye, Vec3::Z * 200.0);
        app.update();
        assert!(level(&app, model) > 0 && triangles(&app, model) < 1_000, "{file}");
        assert_eq!(app.world().resource::<LodCache>().building(), 0);
        assert_eq!(app.world().resource::<LodStats>().full_triangles, rock.triangles().len());
    }
}

#[test]
fn a_hierarchy_follows_the_view() {
    write::<VertexHierarchy>("follow.mres", &shapes::terrain(64, 3));
    let mut app = app();
    let eye = app.world_mut().spawn(camera(Vec3::new(0.0, 0.3, 1.5))).id();
    let model = drawn(&mut app, "follow.mres", AutoLod::view_dependent(), 0);
    let near = triangles(&app, model);
    assert_eq!(level_of(&app, model), None);
    move_to(&mut app, eye, Vec3::new(0.0, 3.0, 60.0));
    app.update();
    assert!(triangles(&app, model) < near);
    assert_eq!(app.world().resource::<LodStats>().changed_meshes, 1);
}

fn level_of(app: &App, entity: Entity) -> Option<usize> {
    app.world().get::<DrawnLod>(entity).and_then(DrawnLod::level)
}

#[test]
fn a_part_for_each_material() {
    let plate = shapes::two_material_plate(64, 0.3);
    write::<TotallyOrderedMesh>("parts.mres", &plate);
    let mut app = app();
    app.world_mut().spawn(camera(Vec3::Y * 0.5));
    let models =
        [0, 1].map(|part| drawn(&mut app, "parts.mres", AutoLod::default().with_tolerance_px(0.0), part));
    let counts = models.map(|model| triangles(&app, model));
    let of = |id| plate.materials().iter().filter(|&&material| material == id).count();
    assert_eq!(counts, [of(0), of(1)]);
    let model = app.world().get::<LodModel3d>(models[0]).expect("it is still there").model.clone();
    let names = app
        .world()
        .resource::<Assets<LodModel>>()
        .get(&model)
        .map(|model| model.parts().iter().map(|part| part.name.clone()).collect::<Vec<_>>());
    assert_eq!(names, Some(vec!["plate".to_owned(), "island".to_owned()]));

    // A part that is none is told, and draws nothing.
    let none = app.world_mut().spawn(LodModel3d::new(model).with_part(2)).id();
    until(&mut app, "the part is refused", |app| app.world().get::<LodModel3d>(none).is_none());
    assert!(app.world().get::<Mesh3d>(none).is_none());
}

#[test]
fn a_damaged_file_is_an_error() {
    write::<TotallyOrderedMesh>("whole.mres", &shapes::rock(500, 1));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let mut bytes = std::fs::read(folder.join("whole.mres")).expect("it was written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x55;
    std::fs::write(folder.join("damaged.mres"), &bytes).expect("the folder can be written to");
    std::fs::write(folder.join("short.mres"), &bytes[..100]).expect("the folder can be written to");
    std::fs::write(folder.join("none.mres"), b"").expect("the folder can be written to");
    for file in ["damaged.mres", "short.mres", "none.mres"] {
        let mut app = app();
        let server = app.world().resource::<AssetServer>().clone();
        let model: Handle<LodModel> = server.load(file);
        let entity = app.world_mut().spawn(LodModel3d::new(model.clone())).id();
        until(&mut app, "the file is refused", |_| matches!(server.load_state(&model), LoadState::Failed(_)));
        app.update();
        assert!(app.world().get::<Mesh3d>(entity).is_none());
    }
}
