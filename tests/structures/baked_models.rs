//! Promise: a model of any structure, baked, written and read again, draws the same, takes values of the input's vertices in their own
//! order, and gives levels that do not exceed what is asked for. Builds tell how far they are, and stop where they are told to.
#![cfg(feature = "io")]

use std::ops::ControlFlow;

use crate::support::lod::view;
use multires::hierarchy::{Dependencies, HierarchyBuilder, HierarchyOptions};
use multires::io::{self, BakeError};
use multires::lod::{Baked, Level, Lod, LodOptions, Structure, VertexBuffer};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::simplify::{Placement, Simplifier};
use multires::view::{Answer, Bounds, Criterion, Motion};
use multires::wavelet::{WaveletBuilder, WaveletMesh, WaveletOptions};
use multires::{Error, Gmesh, MeshError, TotallyOrderedMesh, VertexHierarchy};

/// A mesh that all structures take, with a texture seam and two materials.
fn mesh() -> Mesh {
    let rock = shapes::rock(1_280, 2);
    let uv: Vec<[f32; 2]> = rock.positions().iter().map(|p| [p[0] - p[2], p[1]]).collect();
    rock.with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

fn written<S: io::Stored + PartialEq + std::fmt::Debug>(mesh: &Mesh)
where
    Error: From<S::Error>,
    S::Error: std::fmt::Debug,
{
    let model = S::bake(mesh).unwrap();
    let bytes = model.to_bytes().unwrap();
    let back = Baked::<S>::from_bytes(&bytes).unwrap();
    assert_eq!(back, model);
    assert_eq!(back.to_bytes().unwrap(), bytes);

    // Values come in the input's order, whoever has read the model.
    let numbers: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    let arranged = back.arrange(&numbers).unwrap();
    assert_eq!(arranged.len(), model.structure().vertex_count());
    for (&number, place) in arranged.iter().zip(model.vertices().positions()) {
        assert_eq!(mesh.positions()[number as usize], *place, "{}", S::KIND);
    }
    assert!(matches!(back.arrange(&numbers[1..]), Err(MeshError::LengthMismatch { .. })));

    // Read without knowing what it is.
    let any = io::unbake_model::<[f32; 3]>(&bytes).unwrap();
    assert_eq!((any.kind(), any.vertex_count()), (S::KIND, model.structure().vertex_count()));
    assert!(any.as_any().downcast_ref::<Baked<S>>() == Some(&model));
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let options = LodOptions::default().with_buffer(VertexBuffer::Whole);
    let (mut here, mut there) =
        (model.instance(values.clone(), &options).unwrap(), any.instance(&values, &options).unwrap());
    for distance in [3.0, 1.0, 2.0] {
        let view = view(mesh, [0.1, 0.2, distance], 0.0, 3.0).of_world();
        let [a, b] = [here.adapt(std::slice::from_ref(&view), 0.1), there.adapt(&[view], 0.1)];
        assert_eq!((a, here.to_mesh()), (b, there.to_mesh()));
        assert_eq!(here.vertex_bytes(), there.vertex_bytes());
    }
    assert_eq!(there.refine_fully().triangles, model.structure().triangle_count());
    assert_eq!(model.structure().triangle_count(), mesh.triangles().len());
    assert!(model.memory() > model.plain_memory() && model.plain_memory() > 0);
    assert_eq!(any.bounds(), mesh.bounds());

    for damage in [8, 40, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[damage] ^= 4;
        assert!(Baked::<S>::from_bytes(&damaged).is_err() && io::unbake_model::<u8>(&damaged).is_err());
    }
}

#[test]
fn models_are_written_and_read() {
    let mesh = mesh();
    written::<VertexHierarchy>(&mesh);
    written::<TotallyOrderedMesh>(&mesh);
    written::<WaveletMesh>(&mesh);
    written::<Gmesh>(&mesh);
    let tom = TotallyOrderedMesh::bake(&mesh).unwrap().to_bytes().unwrap();
    let other = Baked::<VertexHierarchy>::from_bytes(&tom).unwrap_err();
    assert!(matches!(other, BakeError::OtherKind { .. }), "{other}");
    let foreign = io::bake("cloud", &7_u32).unwrap();
    let foreign = io::unbake_model::<u8>(&foreign).err().unwrap();
    assert!(foreign.to_string().contains("hierarchy or tom or wavelet"), "{foreign}");
    assert_eq!(foreign.to_string().lines().count(), 1);
}

/// Origins that name nothing are no origins.
#[test]
fn forged_origins_are_refused() {
    let mesh = shapes::rock(320, 2);
    let model = HierarchyBuilder::new().placement(Placement::Optimal).bake(&mesh).unwrap();
    let good = serde_json::to_value(&model).unwrap();
    assert!(serde_json::from_value::<Baked<VertexHierarchy>>(good.clone()).is_ok());
    let last = u32::MAX;
    let forgeries = [
        ("/origins/order/3", serde_json::json!(last)),
        ("/origins/mixtures/0/from/0", serde_json::json!(last)),
        ("/origins/mixtures/0/weight", serde_json::json!(1.5)),
        // A mixture of itself.
        ("/origins/mixtures/0/from/1", serde_json::json!(mesh.positions().len())),
        ("/origins/snapped", serde_json::json!([5, 5])),
        ("/origins/snapped", serde_json::json!([last])),
        ("/origins/folded", serde_json::json!([[0, last]])),
        ("/origins/order", serde_json::json!([0])),
    ];
    for (at, value) in forgeries {
        let mut forged = good.clone();
        *forged.pointer_mut(at).unwrap() = value;
        let refused = serde_json::from_value::<Baked<VertexHierarchy>>(forged);
        assert!(refused.is_err(), "{at}");
    }
}

/// What a wavelet mesh was built from is its input: midpoints are mixed, and lie where the builder put them.
#[test]
fn built_wavelets_take_values_of_their_base() {
    let base = shapes::uv_sphere(8, 4);
    let mut builder = WaveletBuilder::new(&base).unwrap();
    let out = |p: [f32; 3]| p.map(|x| 1.1 * x);
    builder.subdivide(|midpoint| out(midpoint.middle)).unwrap();
    builder.subdivide_where(|face| face.corners[0][1] > 0.0, |midpoint| out(midpoint.middle)).unwrap();
    let model = builder.bake_with(&WaveletOptions::default(), |_| ControlFlow::Continue(())).unwrap();
    let back = Baked::<WaveletMesh>::from_bytes(&model.to_bytes().unwrap()).unwrap();
    // Corners of a box that the mesh takes for one, with colours that differ.
    let corners = shapes::box_with_face_normals(1);
    let bare = Mesh::new(corners.positions(), corners.triangles()).unwrap();
    let cube = WaveletBuilder::new(&bare).unwrap();
    let cube = cube.bake_with(&WaveletOptions::default(), |_| ControlFlow::Continue(())).unwrap();
    let numbers: Vec<[f32; 1]> = (0..bare.positions().len()).map(|i| [i as f32]).collect();
    assert!(matches!(cube.arrange_blended(&numbers, |_, _| {}), Err(MeshError::Folded { .. })));
    assert!(matches!(back.arrange(base.positions()), Err(MeshError::NewVertices { .. })));
    let uv: &[[f32; 2]] = bytemuck::cast_slice(base.attribute(names::UV).unwrap().as_floats().unwrap());
    let vertices: Vec<[f32; 5]> =
        base.positions().iter().zip(uv).map(|(p, uv)| [p[0], p[1], p[2], uv[0], uv[1]]).collect();
    let values = back.arrange_blended(&vertices, |v, p| v[..3].copy_from_slice(&p)).unwrap();
    let own: &[[f32; 2]] =
        bytemuck::cast_slice(back.vertices().attribute(names::UV).unwrap().as_floats().unwrap());
    for ((value, place), uv) in values.iter().zip(back.vertices().positions()).zip(own) {
        assert_eq!(value[..3], place[..]);
        assert!((0..2).all(|k| (value[3 + k] - uv[k]).abs() < 1e-6), "{value:?} {uv:?}");
    }
}

/// Needs whatever errs by more.
struct Above(f32);

impl Criterion for Above {
    fn test(&self, bounds: &Bounds) -> Answer {
        Answer::once(bounds.error > self.0)
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

fn levels<S: Structure>(mesh: &Mesh)
where
    S::Error: std::fmt::Debug,
{
    let model = S::bake(mesh).unwrap();
    let all = model.structure().triangle_count();
    let base = model.level(Level::Triangles(0));
    assert_eq!(base.mesh.triangles().len(), model.structure().base_triangle_count(), "{}", S::KIND);
    let mut before = 0;
    for percent in [1, 5, 20, 50, 90, 100] {
        let most = all * percent / 100;
        let by_count = model.level(Level::Triangles(most));
        let count = by_count.mesh.triangles().len();
        assert!(count <= most.max(base.mesh.triangles().len()), "{}: {count} of {most}", S::KIND);
        assert!(count >= before && by_count.error <= base.error);
        before = count;
        let by_ratio = model.level(Level::Ratio(percent as f32 / 100.0)).mesh.triangles().len();
        assert!(by_ratio <= count && by_ratio + 40 > count, "{}: {by_ratio}, {count}", S::KIND);

        let by_error = model.level(Level::Error(by_count.error));
        assert!(by_error.error <= by_count.error);
        let vertices = by_count.mesh.positions().len();
        let by_vertices = model.level(Level::Vertices(vertices)).mesh;
        assert!(by_vertices.positions().len() <= vertices.max(base.mesh.positions().len()));
    }
    assert_eq!(before, all);
    assert_eq!(model.level(Level::Error(f32::NAN)).mesh.triangles().len(), all);
    assert_eq!(model.level(Level::Error(f32::INFINITY)).mesh, base.mesh);
    assert_eq!(model.level(Level::Ratio(f32::NAN)).mesh, base.mesh);
    assert_eq!(model.level(Level::Ratio(2.0)).error, 0.0);
}

#[test]
fn levels_do_not_exceed_what_is_asked_for() {
    let mesh = mesh();
    levels::<VertexHierarchy>(&mesh);
    levels::<TotallyOrderedMesh>(&mesh);
    levels::<WaveletMesh>(&mesh);
    levels::<Gmesh>(&mesh);

    // A level by error is what a criterion of that error asks for, with all that depends on it.
    let knot = shapes::torus_knot(2, 3, 60, 8);
    let sequence = Simplifier::new().run(&knot).unwrap();
    for dependencies in [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours] {
        let options = HierarchyOptions::default().with_dependencies(dependencies);
        let model = Baked::<VertexHierarchy>::of_sequence(&knot, &sequence, &options).unwrap();
        let mut lod =
            model.instance(model.arrange(knot.positions()).unwrap(), &LodOptions::default()).unwrap();
        for step in 0..40 {
            let error = knot.diagonal() as f32 * 0.3 * 0.8_f32.powi(step);
            lod.adapt_by(&Above(error), Motion::Other, 0.0);
            assert_eq!(model.level(Level::Error(error)).mesh, lod.to_mesh(), "{dependencies:?}, {error}");
        }
    }

    // With dependencies a split brings along what it needs.
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let tied = HierarchyOptions::default().with_dependencies(Dependencies::Neighbours);
    let tied = Baked::<VertexHierarchy>::of_sequence(&mesh, &sequence, &tied).unwrap();
    for most in [300, 700, 1_100] {
        let level = tied.level(Level::Triangles(most)).mesh;
        assert!(level.triangles().len() <= most && level.triangles().len() > most / 2);
        assert!(multires::mesh::Report::welded(&level).is_manifold());
    }
}

fn progress<S: Structure>(mesh: &Mesh)
where
    Error: From<S::Error>,
    S::Error: std::fmt::Debug,
{
    let mut told = Vec::new();
    S::bake_with(mesh, &S::Options::default(), |share| {
        told.push(share);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(told.len() > 4 && told.is_sorted(), "{}: {told:?}", S::KIND);
    assert!(told[0] < 0.2 && *told.last().unwrap() == 1.0, "{}: {told:?}", S::KIND);
    for stop in 0..told.len() {
        let mut calls = 0;
        let refused = S::bake_with(mesh, &S::Options::default(), |_| {
            calls += 1;
            if calls > stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert!(Error::from(refused.err().unwrap()).is_cancelled(), "{}: {stop}", S::KIND);
        assert_eq!(calls, stop + 1, "{}: asked on after it was told to stop", S::KIND);
    }
}

#[test]
fn builds_tell_how_far_they_are_and_stop() {
    let mesh = shapes::rock(20_480, 2);
    progress::<VertexHierarchy>(&mesh);
    progress::<TotallyOrderedMesh>(&mesh);
    progress::<WaveletMesh>(&mesh);
    progress::<Gmesh>(&mesh);
}

/// A model without triangles, and one without vertices, are models.
#[test]
fn nothing_is_a_model_too() {
    fn nothing<S: io::Stored>(mesh: &Mesh)
    where
        S::Error: std::fmt::Debug,
    {
        let model = S::bake(mesh).unwrap();
        let model = Baked::<S>::from_bytes(&model.to_bytes().unwrap()).unwrap();
        assert_eq!((model.bounds(), model.structure().triangle_count()), (None, 0));
        let values = model.arrange(mesh.positions()).unwrap().with_blending();
        let mut lod = model.instance(values, &LodOptions::default()).unwrap();
        lod.adapt(&[], 0.1);
        lod.set_tolerance_factor(2.0);
        assert_eq!(lod.refine_fully().triangles, 0);
        lod.settle();
        assert!(lod.draws().next().is_none() && lod.uploads().next().is_none());
        assert_eq!(lod.to_mesh().triangles().len(), 0);
        assert!(model.level(Level::Ratio(0.5)).mesh.triangles().is_empty());
    }
    for mesh in [Mesh::default(), Mesh::new([[0.0; 3], [1.0, 0.0, 0.0]], []).unwrap()] {
        nothing::<VertexHierarchy>(&mesh);
        nothing::<TotallyOrderedMesh>(&mesh);
        nothing::<Gmesh>(&mesh);
    }
}
