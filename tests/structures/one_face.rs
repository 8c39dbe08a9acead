//! Promise: every structure is drawn by the same calls. What uploads put on a card is, byte for byte, what an instance holds, whatever
//! changes while it lives; at rest that is the mesh that it says it is.

use std::collections::BTreeMap;

use crate::asset::{self, Asset, Vertex};
use crate::gpu::Gpu;
use crate::support::lod::view;
use multires::adapt::Geomorph;
use multires::gmesh::Gmesh;
use multires::hierarchy::HierarchyBuilder;
use multires::lod::{Baked, Lod, LodError, LodOptions, Structure, Triangulation, Values, VertexBuffer};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::simplify::Placement;
use multires::view::{Focus, ObjectView};
use multires::wavelet::WaveletMesh;
use multires::{TotallyOrderedMesh, VertexHierarchy};
use proptest::prelude::*;

fn mesh(asset: &Asset) -> Mesh {
    Mesh::from_vertices(&asset.vertices, &asset.indices, |v| v.position)
        .unwrap()
        .with_attribute(Attribute::of(names::UV, &asset.vertices, |v| v.uv))
        .unwrap()
        .with_material_ranges(&asset.ranges)
        .unwrap()
}

/// A model of each structure, with the engine's own vertices.
fn instances(asset: &Asset, options: &LodOptions) -> Vec<(&'static str, Box<dyn Lod>)> {
    fn one<S: Structure>(mesh: &Mesh, asset: &Asset, options: &LodOptions) -> (&'static str, Box<dyn Lod>) {
        let model = S::bake(mesh).unwrap();
        let values = model.arrange(&asset.vertices).unwrap().with_blending();
        (S::KIND, Box::new(model.instance(values, options).unwrap()))
    }
    let mesh = mesh(asset);
    vec![
        one::<VertexHierarchy>(&mesh, asset, options),
        one::<TotallyOrderedMesh>(&mesh, asset, options),
        one::<WaveletMesh>(&mesh, asset, options),
        one::<Gmesh>(&mesh, asset, options),
    ]
}

/// Triangles by material and corners, in whatever order they lie and from whichever corner they start.
fn counted(triangles: impl Iterator<Item = (u32, [[u32; 5]; 3])>) -> BTreeMap<(u32, [[u32; 5]; 3]), usize> {
    let mut count = BTreeMap::new();
    for (material, mut corners) in triangles {
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
        corners.rotate_left(least);
        *count.entry((material, corners)).or_default() += 1;
    }
    count
}

fn bits([x, y, z]: [f32; 3], [u, v]: [f32; 2]) -> [u32; 5] {
    [x, y, z, u, v].map(f32::to_bits)
}

/// What the card draws is what the instance says that it draws, every vertex at its place.
fn assert_drawn(what: &str, lod: &dyn Lod, gpu: &Gpu, shared: &[Vertex]) {
    let mesh = lod.to_mesh();
    let uv: &[[f32; 2]] = bytemuck::cast_slice(mesh.attribute(names::UV).unwrap().as_floats().unwrap());
    let said = mesh.triangles().iter().zip(mesh.materials()).map(|(triangle, &material)| {
        (material, triangle.map(|v| bits(mesh.positions()[v as usize], uv[v as usize])))
    });
    let drawn = gpu.draw(lod, shared);
    let drawn = drawn.iter().map(|(material, corners)| (*material, corners.map(|v| bits(v.position, v.uv))));
    assert!(counted(drawn) == counted(said), "{what}");
}

/// The buffers of a card, less what lies behind what is in use.
fn assert_held(what: &str, lod: &dyn Lod, gpu: &Gpu) {
    if !lod.shares_vertices() {
        assert!(gpu.held(0, lod.vertex_bytes().len()) == lod.vertex_bytes(), "{what}: vertices");
    }
    for group in 0..lod.groups() {
        let indices: &[u8] = bytemuck::cast_slice(lod.buffered_triangles(group));
        assert!(gpu.held(1 + group, indices.len()) == indices, "{what}: group {group}");
    }
}

/// What may change from frame to frame.
#[derive(Debug, Clone)]
enum Step {
    Look {
        place: [f32; 3],
        turn: f32,
        tolerance: f32,
        seconds: f32,
    },
    LookAway,
    Options {
        buffer: usize,
        seconds: Option<f32>,
        triangles: Option<usize>,
        operations: Option<usize>,
        minimal: bool,
    },
    Tolerance(f32),
    Settle,
    Refine,
    Lose,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let look =
        ([-1.5_f32..1.5, 0.0_f32..1.0, 0.2_f32..4.0], 0.0_f32..6.3, 0.5_f32..20.0, 0.0_f32..0.1).prop_map(
            |(place, turn, tolerance, seconds)| Step::Look { place, turn: turn * 0.1, tolerance, seconds },
        );
    let options = (
        0_usize..3,
        proptest::option::of(0.05_f32..0.4),
        proptest::option::of(50_usize..3_000),
        proptest::option::of(1_usize..400),
        any::<bool>(),
    )
        .prop_map(|(buffer, seconds, triangles, operations, minimal)| Step::Options {
            buffer,
            seconds,
            triangles,
            operations,
            minimal,
        });
    let step = prop_oneof![
        10 => look,
        3 => options,
        3 => (0.3_f32..3.0).prop_map(Step::Tolerance),
        1 => Just(Step::LookAway),
        1 => Just(Step::Settle),
        1 => Just(Step::Refine),
        1 => Just(Step::Lose),
    ];
    proptest::collection::vec(step, 1..40)
}

fn options(buffer: usize, seconds: Option<f32>) -> LodOptions {
    let buffer = [VertexBuffer::Packed, VertexBuffer::Whole, VertexBuffer::Shared][buffer];
    let geomorph = seconds.map(|seconds| Geomorph::default().with_duration(seconds));
    LodOptions::default().with_buffer(buffer).with_geomorph(geomorph)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn cards_hold_what_instances_hold(steps in steps()) {
        let asset = asset::patch(8);
        let model = mesh(&asset);
        for (kind, mut lod) in instances(&asset, &LodOptions::default()) {
            let (mut gpu, mut shared, mut moves) = (Gpu::default(), Vec::new(), false);
            for (i, step) in steps.iter().enumerate() {
                match step {
                    Step::Look { place, turn, tolerance, seconds } => {
                        let view = view(&model, *place, *turn, *tolerance);
                        let change = lod.adapt(&[view.of_world()], *seconds);
                        moves = change.moving > 0;
                    }
                    Step::LookAway => moves = lod.adapt(&[], 0.01).moving > 0,
                    Step::Options { buffer, seconds, triangles, operations, minimal } => {
                        let minimal = if *minimal { Triangulation::Minimal } else { Triangulation::Exact };
                        let options = options(*buffer, *seconds)
                            .with_triangles(*triangles)
                            .with_operations(*operations)
                            .with_triangulation(minimal);
                        let was_shared = lod.shares_vertices();
                        let before = *lod.options();
                        lod.set_options(&options).unwrap();
                        if options.buffer != before.buffer
                            || options.triangulation != before.triangulation && kind == WaveletMesh::KIND
                            || options.geomorph.is_some() != before.geomorph.is_some()
                        {
                            // All of it counts as written: new buffers are filled.
                            gpu = Gpu::default();
                        }
                        prop_assert_eq!(lod.options(), &options);
                        if lod.shares_vertices() && !was_shared {
                            // Whoever shares has uploaded the values.
                            shared = bytemuck::cast_slice(lod.vertex_bytes()).to_vec();
                        }
                    }
                    Step::Tolerance(factor) => {
                        lod.set_tolerance_factor(*factor);
                        prop_assert_eq!(lod.tolerance_factor(), *factor);
                    }
                    Step::Settle => {
                        lod.settle();
                        moves = false;
                    }
                    Step::Refine => moves = lod.refine_fully().moving > 0,
                    Step::Lose => {
                        gpu = Gpu::default();
                        lod.invalidate();
                    }
                }
                // Frames may go by without an upload.
                if i % 3 != 1 {
                    gpu.upload(&*lod);
                    lod.clean();
                    let what = format!("{kind}, step {i}, {step:?}");
                    assert_held(&what, &*lod, &gpu);
                    prop_assert!(lod.uploads().next().is_none(), "{}", what);
                    if !moves && lod.options().geomorph.is_none() {
                        assert_drawn(&what, &*lod, &gpu, &shared);
                    }
                }
            }
            lod.settle();
            gpu.upload(&*lod);
            lod.clean();
            assert_drawn(kind, &*lod, &gpu, &shared);
        }
    }

    /// Whatever was before, tolerances of a view multiplied by a factor give what a view with those tolerances gives.
    #[test]
    fn a_tolerance_factor_is_a_factor_of_tolerances(
        looks in proptest::collection::vec((-0.2_f32..0.2, 0.8_f32..1.25, any::<bool>()), 1..60),
        triangles in proptest::option::of(100_usize..1_000),
        focus in 0..5,
        turns in -0.1_f32..0.1,
    ) {
        let asset = asset::patch(8);
        let model = mesh(&asset);
        let options = LodOptions::default().with_triangles(triangles);
        for ((kind, mut turned), (_, mut plain)) in
            instances(&asset, &options).into_iter().zip(instances(&asset, &options))
        {
            let (mut factor, mut aside) = (1.0_f32, 0.0_f32);
            for (frame, (move_by, turn_by, still)) in looks.iter().enumerate() {
                factor *= turn_by;
                if !still {
                    aside += 0.1 * move_by;
                }
                let angle = if *still { 0.0 } else { turns * frame as f32 };
                let mut view = view(&model, [aside, 0.4, 1.5], angle, 4.0);
                match focus {
                    1 => view = view.with_focus(Some(Focus { centre: [0.2, 0.0, 0.1], radius: 0.3 })),
                    2 => view = view.with_radius_test(1.7),
                    3 => view = view.with_silhouette_px(4.0),
                    4 => view = view.with_back_faces_culled(true).with_silhouette_px(0.5),
                    _ => {}
                }
                let view: ObjectView = view.of_world();
                turned.set_tolerance_factor(factor);
                turned.adapt(std::slice::from_ref(&view), 0.1);
                plain.adapt(&[view.coarsened(f64::from(factor))], 0.1);
                prop_assert_eq!(turned.refinements(), plain.refinements(), "{}, frame {}", kind, frame);
                prop_assert_eq!(turned.to_mesh(), plain.to_mesh(), "{}, frame {}", kind, frame);
            }
        }
    }
}

/// With a radius, all of a model is drawn that the eye is within it of, whatever its structure.
#[test]
fn a_radius_is_a_radius_for_all() {
    let asset = asset::patch(8);
    let model = mesh(&asset);
    for (kind, mut lod) in instances(&asset, &LodOptions::default()) {
        let near = view(&model, [0.0, 0.2, 1.0], 0.0, 1.0).with_radius_test(100.0).of_world();
        let far = view(&model, [0.0, 0.2, 30.0], 0.0, 1.0).with_radius_test(0.1).of_world();
        for factor in [1.0, 1.3] {
            lod.set_tolerance_factor(factor);
            let all = lod.adapt(std::slice::from_ref(&near), 0.1).triangles;
            let none = lod.adapt(std::slice::from_ref(&far), 0.1).triangles;
            assert!(all > 4 * none.max(20), "{kind}, {factor}: {all} and {none}");
        }
    }
}

/// Another triangulation counts other triangles: limits hold for those.
#[test]
fn limits_hold_when_the_triangulation_changes() {
    let mesh = shapes::rock(5_120, 1);
    let model = WaveletMesh::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let minimal = LodOptions::default().with_triangulation(Triangulation::Minimal).with_triangles(1_000);
    let mut lod = model.instance(values, &minimal).unwrap();
    let look = view(&mesh, [0.0, 0.0, 0.8], 0.0, 0.5).of_world();
    for _ in 0..3 {
        lod.adapt(std::slice::from_ref(&look), 0.1);
        lod.set_options(&minimal.with_triangulation(Triangulation::Exact)).unwrap();
        let change = lod.adapt(std::slice::from_ref(&look), 0.1);
        assert!(change.triangles <= 1_000 && change.triangles > 500, "{change:?}");
        assert_eq!(change.triangles, lod.triangles(0).len());
        lod.adapt(&[], 0.1);
        lod.set_options(&minimal).unwrap();
    }
    // A limit that stays while vertices begin to move finds what fits by itself.
    lod.adapt(std::slice::from_ref(&look), 0.1);
    lod.set_options(&minimal.with_geomorph(Geomorph::default())).unwrap();
    let away = view(&mesh, [0.0, 0.0, 1.6], 0.0, 0.5).of_world();
    lod.adapt(std::slice::from_ref(&away), 0.1);
    lod.settle();
    let mut fresh = model.instance(lod.own_values().clone(), &minimal).unwrap();
    fresh.adapt(&[away], 0.1);
    assert_eq!(lod.to_mesh(), fresh.to_mesh());
}

/// The full resolution is there at once, however few operations a frame may take.
#[test]
fn all_is_there_at_once_where_that_is_asked_for() {
    let asset = asset::patch(8);
    let options = LodOptions::default().with_operations(3).with_geomorph(Geomorph::default());
    for (kind, mut lod) in instances(&asset, &options) {
        let change = lod.refine_fully();
        assert_eq!(
            (change.triangles, change.pending, change.moving),
            (asset.indices.len() / 3, 0, 0),
            "{kind}"
        );
    }
}

/// Where vertices never leave their places, a whole buffer is written once.
#[test]
fn vertices_that_stay_are_written_once() {
    let mesh = shapes::rock(5_120, 1);
    let model = WaveletMesh::bake(&mesh).unwrap();
    let options =
        LodOptions::default().with_triangulation(Triangulation::Minimal).with_buffer(VertexBuffer::Whole);
    let mut lod = model.instance(model.arrange(mesh.positions()).unwrap(), &options).unwrap();
    lod.clean();
    for distance in [3.0, 1.0, 2.0, 0.7] {
        lod.adapt(&[view(&mesh, [0.0, 0.0, distance], 0.0, 2.0).of_world()], 0.1);
        assert!(lod.uploads().all(|upload| upload.buffer > 0));
        assert!(lod.uploads().next().is_some());
        lod.clean();
    }
}

/// A controller turns the factor by a little: few are asked about again.
#[test]
fn a_little_turn_of_the_factor_asks_little() {
    let mesh = shapes::rock(20_000, 1);
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap();
    let mut lod = model.instance(values, &LodOptions::default()).unwrap();
    let view = view(&mesh, [0.0, 0.0, 1.0], 0.0, 2.0).of_world();
    lod.set_tolerance_factor(1.0);
    let all = lod.adapt(std::slice::from_ref(&view), 0.0).cut.tests;
    let mut most = 0;
    for step in 0..40 {
        lod.set_tolerance_factor(1.0 + 0.03 * (0.3 * step as f32).sin());
        most = most.max(lod.adapt(std::slice::from_ref(&view), 0.0).cut.tests);
    }
    assert!(most > 0 && 8 * most < all, "{most} tests, {all} for all");
    // However far it has come in the end. All are asked for a factor once, when it is first set.
    let mut factor = lod.tolerance_factor();
    for step in 0..40 {
        factor *= if step < 20 { 1.06 } else { 1.0 / 1.06 };
        lod.set_tolerance_factor(factor);
        let tests = lod.adapt(std::slice::from_ref(&view), 0.0).cut.tests;
        assert!(tests > 0 && 3 * tests < all, "{tests} tests in step {step}, {all} for all");
    }
    // A still eye and a still factor ask nothing of those that can sleep.
    lod.set_tolerance_factor(f32::NAN);
    lod.set_tolerance_factor(-1.0);
    assert!(lod.tolerance_factor() > 0.9);
    assert_eq!(lod.adapt(std::slice::from_ref(&view), 0.0).cut.tests, 0);
}

/// Values that nobody knows how to mix are drawn where nothing must be mixed, and refused elsewhere; then nothing changes.
#[test]
fn values_without_blending_are_refused_where_they_would_be_mixed() {
    #[repr(C)]
    #[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
    struct Opaque([f32; 3]);
    let mesh = shapes::rock(1_280, 1);
    let opaque: Vec<Opaque> = mesh.positions().iter().map(|&p| Opaque(p)).collect();
    let morph = LodOptions::default().with_geomorph(Geomorph::default());

    let hierarchy = VertexHierarchy::bake(&mesh).unwrap();
    let values = hierarchy.arrange(&opaque).unwrap();
    let refused = hierarchy.instance(values.clone(), &morph).unwrap_err();
    assert!(matches!(refused, LodError::NeedsBlending { .. }), "{refused}");
    let mut lod = hierarchy.instance(values, &LodOptions::default()).unwrap();
    lod.refine_fully();
    assert_eq!(lod.set_options(&morph), Err(LodError::NeedsBlending { what: "a geomorph" }));
    assert_eq!((*lod.options(), lod.triangles(0).len()), (LodOptions::default(), 1_280));

    let tom = TotallyOrderedMesh::bake(&mesh).unwrap();
    assert!(tom.instance(tom.arrange(&opaque).unwrap(), &morph).is_err());
    assert!(tom.instance(tom.arrange(&opaque).unwrap(), &LodOptions::default()).is_ok());

    let wavelet = WaveletMesh::bake(&mesh).unwrap();
    let values = wavelet.arrange(&opaque).unwrap();
    assert!(wavelet.instance(values.clone(), &LodOptions::default()).is_err());
    let minimal = LodOptions::default().with_triangulation(Triangulation::Minimal);
    let mut lod = wavelet.instance(values, &minimal).unwrap();
    assert_eq!(lod.refine_fully().triangles, 1_280);

    let few = Values::from(vec![[0.0_f32; 3]; 5]);
    let length = |error: LodError| assert!(matches!(error, LodError::Length { found: 5, .. }), "{error}");
    length(hierarchy.instance(few.clone(), &LodOptions::default()).err().unwrap());
    length(tom.instance(few.clone(), &LodOptions::default()).err().unwrap());
    length(wavelet.instance(few.clone(), &minimal).err().unwrap());
    length(VertexHierarchy::instance(&hierarchy, few.clone(), &LodOptions::default()).err().unwrap());
    length(TotallyOrderedMesh::instance(&tom, few, &LodOptions::default()).err().unwrap());
}

/// Vertices that collapses made are mixed, and lie where the structure has them.
#[test]
fn new_vertices_are_mixed_and_placed() {
    let asset = asset::patch(8);
    let model = HierarchyBuilder::new().placement(Placement::Optimal).bake(&mesh(&asset)).unwrap();
    assert!(!model.origins().mixtures().is_empty());
    assert!(model.arrange(&asset.vertices).is_err());
    let values = model.arrange_blended(&asset.vertices, |v, position| v.position = position).unwrap();
    for (value, position) in values.iter().zip(model.vertices().positions()) {
        assert_eq!(value.position, *position);
        assert!(value.joints == [0, 1, 0, 0] && value.colour[3] == 255);
    }
    let mut lod = model.instance(values, &LodOptions::default()).unwrap();
    let mut gpu = Gpu::default();
    lod.adapt(&[view(&mesh(&asset), [0.0, 0.3, 1.5], 0.0, 5.0).of_world()], 0.0);
    gpu.upload(&lod);
    assert!(gpu.draw::<Vertex>(&lod, &[]).len() > 50);
}

/// One transition of a totally ordered mesh: vertices go from where they were to where they belong, and turn round.
#[test]
fn a_totally_ordered_mesh_moves_without_a_jump() {
    let mesh = shapes::rock(2_000, 3);
    let model: Baked<TotallyOrderedMesh> = TotallyOrderedMesh::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap().with_blending();
    let still = Geomorph::default().with_duration(1.0).with_travel(f32::INFINITY).with_turn(f32::INFINITY);
    let mut lod = model.instance(values.clone(), &LodOptions::default().with_geomorph(still)).unwrap();
    let look = |far: f32| [view(&mesh, [0.0, 0.0, far], 0.0, 2.0).of_world()];
    let (near, away) = (look(1.0), look(20.0));
    lod.adapt(&away, 0.1);
    lod.settle();
    let coarse = lod.resolution();

    let change = lod.adapt(&near, 0.1);
    let fine = lod.resolution();
    assert!(fine.vertices() > 2 * coarse.vertices() && change.moving == fine.vertices() - coarse.vertices());
    // At the start of the way every new vertex lies on one of the coarse mesh.
    for vertex in coarse.vertices()..fine.vertices() {
        assert!(values[..coarse.vertices()].contains(&lod.values()[vertex]));
    }
    let diagonal = mesh.diagonal() as f32;
    let mut before = lod.values().to_vec();
    for frame in 0..30 {
        let views = if (4..8).contains(&frame) { &away } else { &near };
        lod.adapt(views, 0.1);
        let moved =
            |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt();
        let most = lod.values().iter().zip(&before).map(moved).fold(0.0, f32::max);
        assert!(most <= 0.101 * diagonal, "a vertex jumps by {most}");
        before = lod.values().to_vec();
    }
    assert_eq!((lod.resolution(), lod.values()), (fine, &values[..]));
}
