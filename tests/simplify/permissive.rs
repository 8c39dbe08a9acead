//! Promise: where a size would be missed seams, creases and material borders give, in this order and counted, and nothing opens or is mirrored.

use crate::meshes::*;
use multires::hierarchy::{Dependencies, HierarchyOptions, VertexHierarchy};
use multires::lod::Baked;
use multires::mesh::{Mesh, names, shapes};
use multires::simplify::metric::WithAttributes;
use multires::simplify::{
    CollapseSequence, ErrorMeasure, GivenUp, Order, Permissive, Placement, ProgressiveMesh, Simplifier,
    StopReason, Target,
};
use multires::tom::TotallyOrderedMesh;
use proptest::prelude::*;

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

fn bumps(u: f32, v: f32) -> f32 {
    0.4 * u * (1.0 - u) * v * (1.0 - v) + 0.02 * (u - v) * (u - v)
}

fn run(mesh: &Mesh, placement: Placement, permissive: Permissive, target: Option<f64>) -> CollapseSequence {
    let simplifier = Simplifier::new().placement(placement).permissive(permissive);
    let mut simplifier = simplifier.metric(WithAttributes::new(mesh));
    if let Some(ratio) = target {
        simplifier = simplifier.target(Target::Ratio(ratio));
    }
    simplifier.run(mesh).unwrap()
}

/// Border edges between points never become more, and the sequence is what its substitutions say.
fn assert_whole(mesh: &Mesh, sequence: &CollapseSequence) {
    sequence.validate().unwrap();
    let point = points(mesh, sequence);
    let mut before = None;
    for steps in (0..=20).map(|i| i * sequence.len() / 20) {
        let level = level(mesh, sequence, &point, steps);
        let borders = edges(&level.points).values().filter(|&&count| count == 1).count();
        assert!(before.is_none_or(|b| borders <= b), "{borders} border edges after {steps} steps");
        before = Some(borders);
    }
    let steps = (0..sequence.len()).map(|s| (sequence.substitutions(s).to_vec(), sequence.step_error(s)));
    let again = CollapseSequence::from_collapses(mesh, sequence.new_vertices(), steps).unwrap();
    assert_eq!(again.triangle_ends(), sequence.triangle_ends(), "triangles vanish when their corners meet");
}

#[test]
fn a_quilt_of_charts_reaches_its_size() {
    let mesh = quilt(12, 2, false, bumps);
    for placement in PLACEMENTS {
        let held = run(&mesh, placement, Permissive::Off, Some(0.05));
        assert_eq!(held.report().stop, StopReason::NothingLegal, "{placement:?}");
        assert!(held.report().given_up.is_none());
        for permissive in [Permissive::Auto, Permissive::On] {
            let sequence = run(&mesh, placement, permissive, Some(0.05));
            let report = sequence.report();
            assert_eq!(report.stop, StopReason::Target, "{placement:?} {permissive:?}");
            let GivenUp { seams, creases, materials, .. } = report.given_up;
            assert!(seams > 0 && creases == 0 && materials == 0, "{:?}", report.given_up);
            assert_whole(&mesh, &sequence);
            for steps in (0..=20).map(|i| i * sequence.len() / 20) {
                assert_eq!(mirrored(&mesh, &sequence, steps), 0, "{placement:?} after {steps}");
            }
        }
    }
}

/// Down to 2.5 times the triangles at which nothing legal would be left, a permissive run is the run in which all holds.
#[test]
fn all_hold_first() {
    let mesh = quilt(8, 2, false, bumps);
    for placement in PLACEMENTS {
        let held = run(&mesh, placement, Permissive::Off, None);
        let gives = run(&mesh, placement, Permissive::Auto, Some(0.05));
        assert!(gives.len() > held.len());
        let early = held.report().triangles * 5 / 2;
        let same = held.steps_for_triangles(early);
        assert!(same > 20 && same < held.len());
        for step in 0..same {
            assert_eq!(held.substitutions(step), gives.substitutions(step), "{placement:?} step {step}");
        }
        // Without a size asked for, or with one that is reached, nothing gives.
        assert_eq!(run(&mesh, placement, Permissive::Auto, None), held);
        let reached = run(&mesh, placement, Permissive::Auto, Some(0.9));
        assert_eq!(reached, run(&mesh, placement, Permissive::Off, Some(0.9)));
        assert!(reached.report().given_up.is_none());
    }
}

#[test]
fn creases_are_counted_apart_and_normals_stay_normals() {
    let mesh = quilt(10, 2, true, bumps);
    for placement in PLACEMENTS {
        let sequence = run(&mesh, placement, Permissive::Auto, Some(0.05));
        let GivenUp { seams, creases, materials, .. } = sequence.report().given_up;
        assert!(creases > 0 && seams == 0 && materials == 0, "{:?}", sequence.report().given_up);
        assert_eq!(sequence.report().stop, StopReason::Target);
        assert_whole(&mesh, &sequence);
        let coarse = sequence.extract(&mesh, sequence.len());
        for n in rows::<f32, 3>(coarse.attribute(names::NORMAL).unwrap().as_floats().unwrap()) {
            let length = dot(n.map(f64::from), n.map(f64::from)).sqrt();
            assert!((length - 1.0).abs() < 1e-5, "a normal of length {length} with {placement:?}");
        }
    }
}

fn checker(mesh: &Mesh, blocks: f32) -> Mesh {
    let material = |t: &[u32; 3]| {
        let cell = |axis: usize| {
            let sum: f32 = t.iter().map(|&v| mesh.positions()[v as usize][axis]).sum();
            (sum / 3.0 * blocks) as u32
        };
        (cell(0) + cell(1)) % 2
    };
    mesh.clone().with_materials(mesh.triangles().iter().map(material).collect::<Vec<_>>()).unwrap()
}

#[test]
fn materials_give_last_and_stay_closed() {
    let plain = checker(&grid(24, 24, bumps), 12.0);
    let charted = checker(&quilt(12, 2, false, bumps), 3.0);
    for placement in PLACEMENTS {
        let sequence = run(&plain, placement, Permissive::Auto, Some(0.05));
        assert_eq!(sequence.report().stop, StopReason::Target, "{placement:?}");
        let GivenUp { seams, creases, materials, .. } = sequence.report().given_up;
        assert!(materials > 0 && seams == 0 && creases == 0);
        assert_whole(&plain, &sequence);
        // Every triangle keeps the material that it came with.
        let coarse = sequence.extract(&plain, sequence.len());
        let (_, origin) = sequence.triangles_at(&plain, sequence.len());
        assert!(coarse.materials().iter().zip(&origin).all(|(&m, &o)| m == plain.materials()[o as usize]));

        // Where giving up seams is enough, materials hold.
        let sequence = run(&charted, placement, Permissive::Auto, Some(0.2));
        assert_eq!(sequence.report().stop, StopReason::Target, "{placement:?}");
        let given_up = sequence.report().given_up;
        assert!(given_up.seams > 0 && given_up.materials == 0, "{given_up:?} with {placement:?}");
        assert_whole(&charted, &sequence);
    }
}

/// With all that may give given up, a closed cube with a normal for each face goes below its twelve triangles.
#[test]
fn creases_of_a_cube_give() {
    let mesh = cube(6);
    let simplify = |permissive, triangles| {
        let simplifier = Simplifier::new().oracle(multires::simplify::oracle::NormalFlip::degrees(180.0));
        { simplifier.permissive(permissive).target(Target::Triangles(triangles)) }.run(&mesh).unwrap()
    };
    let held = simplify(Permissive::Off, 6);
    assert_eq!((held.report().stop, held.report().triangles), (StopReason::NothingLegal, 12));
    let gives = simplify(Permissive::Auto, 6);
    assert!(gives.report().triangles < 12, "{} triangles", gives.report().triangles);
    assert!(gives.report().given_up.creases > 0 && gives.report().given_up.seams == 0);
    assert_whole(&mesh, &gives);
}

/// The structures show what the sequence says.
fn assert_structures(mesh: &Mesh, sequence: &CollapseSequence) {
    sequence.validate().unwrap();
    if sequence.new_vertices().is_empty() {
        TotallyOrderedMesh::build(mesh, sequence).unwrap().tom.validate().unwrap();
    }
    let progressive = ProgressiveMesh::new(mesh, sequence).unwrap();
    assert_eq!(progressive.len(), sequence.len());
    let hierarchy = Baked::<VertexHierarchy>::of_sequence(
        mesh,
        sequence,
        &HierarchyOptions::default().with_dependencies(Dependencies::Adjacent),
    )
    .unwrap();
    hierarchy.structure().validate().unwrap();
}

fn some_mesh(which: usize) -> Mesh {
    match which {
        0 => shapes::box_with_face_normals(3),
        1 => shapes::uv_sphere(12, 8),
        2 => quilt(5, 1, false, bumps),
        3 => quilt(5, 1, true, bumps),
        4 => checker(&quilt(6, 1, false, bumps), 3.0),
        5 => shapes::demo(),
        6 => tube(8, 6),
        7 => shapes::soup(60, 7),
        _ => shapes::book(5),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn structures_replay_what_gave(
        which in 0usize..9, placement in 0usize..4, on in any::<bool>(), batched in any::<bool>(),
        rules in any::<bool>(), join in any::<bool>(), verified in any::<bool>(), ratio in 0.0f64..0.3,
    ) {
        let mesh = some_mesh(which);
        let mut simplifier = Simplifier::new()
            .placement(PLACEMENTS[placement])
            .permissive(if on { Permissive::On } else { Permissive::Auto })
            .order(if batched { Order::Batched } else { Order::Linear })
            .error_measure(if verified { ErrorMeasure::Verified } else { ErrorMeasure::Measured })
            .join_distance(if join { 0.3 } else { 0.0 })
            .target(Target::Ratio(ratio));
        if !rules {
            simplifier = simplifier.oracles(Vec::new());
        }
        let sequence = simplifier.run(&mesh).unwrap();
        assert_structures(&mesh, &sequence);
        if rules && mesh.attribute(names::UV).is_some() {
            prop_assert_eq!(mirrored(&mesh, &sequence, sequence.len()), 0);
        }
        // The same again, byte for byte.
        prop_assert_eq!(simplifier.run(&mesh).unwrap(), sequence);
    }
}
