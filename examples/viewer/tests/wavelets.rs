//! Promise: a wavelet mesh wears one texture at every level of detail; vertices say their level and error; settings reach its
//! instances; and a mesh without subdivision connectivity is refused with a reason and a way out.

mod card;

use std::ops::ControlFlow;
use std::sync::Arc;

use card::{model, moving, open, shared};
use multires::adapt::Refinements;
use multires::lod::{Baked, Lod, LodOptions, Triangulation, VertexBuffer};
use multires::mesh::{Mesh, shapes};
use multires::view::View;
use multires::wavelet::{ErrorBound, Normals, WaveletBuilder, WaveletLod, WaveletMesh, WaveletOptions};
use multires_viewer::camera::{Lens, Orbit, Pose, Tolerances};
use multires_viewer::headless::{STEP, Stage};
use multires_viewer::renderer::{Look, Shading};
use multires_viewer::scene::{
    BuildOptions, Builtin, Coordinates, Model, ModelError, Overlays, StructureKind,
};

const LENS: Lens = Lens { field_of_view: 0.8, size: [300, 300] };

fn wavelets() -> BuildOptions {
    BuildOptions::default().with_structure(StructureKind::Wavelet)
}

fn wavelet_mesh(model: &Model) -> &Arc<WaveletMesh> {
    model.baked().as_any().downcast_ref::<Baked<WaveletMesh>>().unwrap().structure()
}

/// An icosahedron whose faces are split but as good as flat.
fn flat_faces(levels: usize) -> Mesh {
    let mut builder = WaveletBuilder::new(&shapes::icosphere(0)).unwrap();
    for _ in 0..levels {
        builder.subdivide(|midpoint| midpoint.middle.map(|x| x * 1.00001)).unwrap();
    }
    builder.build(&WaveletOptions::default()).unwrap().finest(Normals::Kept)
}

fn pose(model: &Model, around: f64) -> Pose {
    let [low, high] = model.bounds();
    let centre = std::array::from_fn(|i| f64::from(low[i] + high[i]) * 0.5);
    let radius = (0..3).map(|i| f64::from(high[i] - low[i]).powi(2)).sum::<f64>().sqrt() * 0.5;
    let mut orbit = Orbit::framing(centre, radius, LENS.field_of_view, false);
    orbit.around = around;
    orbit.pose()
}

fn view(pose: &Pose, tolerance: f32) -> View {
    pose.view(&LENS, &Tolerances::default().with_anywhere(tolerance)).unwrap()
}

#[test]
fn every_level_wears_the_same_texture() {
    let Some(gpu) = open("every_level_wears_the_same_texture") else { return };
    let model = model(&flat_faces(4), &wavelets());
    assert_eq!(model.texture().unwrap().size, [1024; 2]);
    let place = glam::Mat4::IDENTITY.to_cols_array_2d();
    let mut stage = Stage::new(gpu.clone(), Arc::clone(&model), &[place], shared(), LENS.size, 1).unwrap();
    let pose = pose(&model, 0.5);
    let look = Look { shading: Shading::Texture, flat: true, ..pose.look(&LENS, 2.0) };
    let pictures = [3.0, 0.0].map(|tolerance| {
        let views = [view(&pose, tolerance)];
        let report = stage.frame(&views, Some(&look), Overlays::default(), STEP);
        (report.adapted.change.triangles, stage.picture().unwrap())
    });
    let [(few, coarse), (many, fine)] = &pictures;
    assert!(*few == 20 && *many > 1_000, "{few} and {many} triangles");
    let differ = coarse.iter().zip(fine).filter(|(a, b)| (0..3).any(|c| a[c].abs_diff(b[c]) > 24)).count();
    let surface = coarse.iter().filter(|pixel| pixel[3] > 0).count();
    eprintln!("{differ} of {surface} pixels differ");
    assert!(differ * 100 < surface, "{differ} of {surface} pixels differ");
    // It is a texture: no two faces look alike, nor do the squares of one.
    let mut seen: Vec<_> = coarse.iter().filter(|pixel| pixel[3] > 0).map(|p| p.map(|c| c / 16)).collect();
    seen.sort_unstable();
    seen.dedup();
    assert!(seen.len() >= 16, "only {} colours", seen.len());
    assert_eq!(gpu.error(), None);
}

#[test]
fn coordinates_of_its_own_stay_where_asked_for() {
    let rock = shapes::rock(1_280, 2);
    let uv: Vec<[f32; 2]> = rock.positions().iter().map(|p| [p[0], p[2]]).collect();
    let rock =
        rock.with_attribute(multires::mesh::Attribute::floats(multires::mesh::names::UV, &uv)).unwrap();
    let own = model(&rock, &wavelets().with_coordinates(Coordinates::Own));
    assert!(own.texture().is_none() && own.has_uv());
    assert!(own.vertices().iter().all(|v| v.uv == [v.position[0], v.position[2]]));
    let atlas = model(&rock, &wavelets());
    assert!(atlas.texture().is_some());
    assert!(atlas.vertices().iter().any(|v| v.uv != [v.position[0], v.position[2]]));
}

#[test]
fn vertices_say_their_level_and_error() {
    let model = model(&shapes::rock(1_280, 2), &wavelets());
    let mesh = wavelet_mesh(&model);
    let of = mesh.subdivision();
    assert_eq!(of.depth(), 3);
    assert_eq!(model.vertices().len(), of.vertex_count());
    assert_eq!(model.triangle_count(), 1_280);
    for (i, vertex) in (0_u32..).zip(model.vertices().iter()) {
        let length = vertex.normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4, "vertex {i} has a normal of length {length}");
        match of.wavelet_of(i) {
            None => assert!(vertex.level == 0.0 && f64::from(vertex.error) > 0.9 * mesh.diagonal()),
            Some(wavelet) => {
                let bounds = mesh.bounds(wavelet);
                assert_eq!(vertex.level, of.level_of(wavelet) as f32 / 3.0);
                assert_eq!(vertex.error, bounds.along.max(bounds.across));
            }
        }
    }
}

#[test]
fn settings_reach_instances() {
    let model = model(&shapes::rock(20_480, 2), &wavelets());
    let mesh = wavelet_mesh(&model);
    let views = [view(&pose(&model, 0.0), 2.0).of_world()];
    let mut triangles = Vec::new();
    for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
        for options in [shared(), LodOptions::default()] {
            let options = options.with_triangulation(triangulation);
            let mut instance = model.instance(&options).unwrap();
            assert_eq!(instance.options(), &options);
            assert_eq!(instance.vertices().is_some(), options.buffer == VertexBuffer::Packed);
            instance.adapt(&views, 1.0 / 60.0);
            let mut own = WaveletLod::new(Arc::clone(mesh), model.vertices().clone(), &options).unwrap();
            own.adapt(&views, 1.0 / 60.0);
            assert_eq!(instance.triangles(0), own.triangles(0));
            assert_eq!(instance.vertex_bytes(), own.vertex_bytes());
            triangles.push(instance.triangles(0).len());
            // All of it may change under way.
            instance.set_options(&moving(options, 0.1).with_triangles(600)).unwrap();
            assert!(instance.adapt(&views, 1.0 / 60.0).triangles <= 600);
        }
    }
    assert!(triangles[0] > triangles[2], "{triangles:?}");

    // A transition lasts as long as it says, also where that changes under way.
    for (seconds, then, frames) in [(0.5, 0.5, 30), (1.0, 0.25, 15), (0.1, 0.1, 6)] {
        let mut instance = model.instance(&moving(shared(), seconds)).unwrap();
        // The first look from anywhere shows things as they are; a closer one moves.
        instance.adapt(&views, 1.0 / 60.0);
        instance.settle();
        instance.set_options(&moving(shared(), then)).unwrap();
        let views = [view(&pose(&model, 0.0), 0.5).of_world()];
        let mut took = 0;
        loop {
            let change = instance.adapt(&views, 1.0 / 60.0);
            if change.moving == 0 {
                break;
            }
            took += 1;
            assert!(took < 100, "it never ends");
        }
        assert!(f64::from(took - frames).abs() <= 2.0, "{took} frames where {frames} were expected");
    }
}

#[test]
fn bounds_are_those_asked_for() {
    let rock = shapes::rock(20_480, 2);
    let narrow = wavelets().with_wavelets(WaveletOptions::default().with_bound(ErrorBound::WithoutSiblings));
    let triangles = [wavelets(), narrow].map(|options| {
        let model = model(&rock, &options);
        assert_eq!(wavelet_mesh(&model).options(), &options.wavelets);
        let mut instance = model.instance(&shared()).unwrap();
        instance.adapt(&[view(&pose(&model, 0.0), 2.0).of_world()], 1.0 / 60.0).triangles
    });
    assert!(triangles[0] >= triangles[1], "{triangles:?}");
}

#[test]
fn built_in_scenes_can_be_wavelet_meshes() {
    for (builtin, triangles) in [(Builtin::Terrain, 5_000), (Builtin::Rocks, 700), (Builtin::Crowd, 2_000)] {
        let mesh = builtin.mesh(Some(triangles), StructureKind::Wavelet);
        let found = WaveletMesh::recognise(&mesh, &WaveletOptions::default()).unwrap();
        let base = found.subdivision().base_face_count();
        let count = mesh.triangles().len();
        assert!(base <= 20, "{} has {base} base faces", builtin.name());
        assert!((triangles as usize / 2..=2 * triangles as usize).contains(&count), "{count} triangles");
    }
}

#[test]
fn what_has_no_connectivity_is_refused_with_a_way_out() {
    // 25 triangles on each face of an icosahedron: an odd number of edges cannot be halved.
    let odd = shapes::rock(500, 1);
    let error = Model::build(&odd, &wavelets(), &mut |_| ControlFlow::Continue(())).err().unwrap();
    let text = error.to_string();
    assert!(matches!(error, ModelError::NoConnectivity(_)), "{text}");
    assert!(text.contains("four-to-one") && text.contains("--structure hierarchy"), "{text}");
    assert_eq!(text.lines().count(), 1);
    let rock = shapes::rock(1_280, 1);
    let mut asked = 0;
    let cancelled = Model::build(&rock, &wavelets(), &mut |_| {
        asked += 1;
        ControlFlow::Break(())
    });
    assert!(matches!(cancelled, Err(ModelError::Cancelled)));
    assert_eq!(asked, 1);
}
