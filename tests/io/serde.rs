//! Promise: every structure comes back equal from serde, in text and in binary; and what comes out of a forged file is
//! refused by name, or is a structure on which no call panics.
#![cfg(feature = "io")]

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::support;
use crate::support::lod::bake_tom;
use multires::lod::{Baked, Level, Lod, LodOptions, Values};
use multires::mesh::{Attribute, AttributeValues, Mesh, Report, shapes};
use multires::simplify::{
    CollapseSequence, ErrorMeasure, NewVertex, Order, Placement, ProgressiveMesh, SequenceError, Simplifier,
};
use multires::tom::{TomCursor, TomOptions, TomParts, TomSteps, TotallyOrderedMesh};
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

fn config() -> impl bincode::config::Config {
    bincode::config::standard().with_fixed_int_encoding().with_limit::<{ 1 << 24 }>()
}

fn bytes(value: &impl Serialize) -> Vec<u8> {
    bincode::serde::encode_to_vec(value, config()).unwrap()
}

fn unbytes<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    bincode::serde::decode_from_slice(bytes, config()).map(|(value, _)| value).map_err(|e| e.to_string())
}

fn assert_comes_back<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: &T) {
    assert_eq!(&unbytes::<T>(&bytes(value)).unwrap(), value);
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value);
}

/// Values of every kind on a mesh of any number of vertices.
fn dressed(mesh: &Mesh) -> Mesh {
    let count = mesh.positions().len();
    let normals: Vec<[f32; 3]> = (0..count).map(|v| [v as f32, 1.0, -3e38]).collect();
    let ids = (0..count as u32).collect();
    mesh.clone()
        .with_attribute(Attribute::floats("normal", &normals))
        .and_then(|m| m.with_attribute(Attribute::new("id", 1, AttributeValues::Uint(ids))))
        .and_then(|m| m.with_attribute(Attribute::new("label", 2, AttributeValues::Int(vec![-1; 2 * count]))))
        .and_then(|m| m.with_locks(vec![false; count]))
        .unwrap()
        .with_material_names(["stone".to_owned()])
}

#[test]
fn simplified_models_come_back() {
    for mesh in [Mesh::default(), shapes::torus(1.0, 0.4, 12, 8), shapes::demo()] {
        assert_comes_back(&mesh);
        assert_comes_back(&Report::new(&mesh));
        for placement in [Placement::Endpoint, Placement::Optimal] {
            for order in [Order::Linear, Order::Batched] {
                let mut simplifier = Simplifier::new().placement(placement).order(order);
                let sequence = simplifier.run(&mesh).unwrap();
                assert_eq!(sequence.validate(), Ok(()));
                assert_comes_back(&sequence);
                let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
                for steps in [sequence.len(), sequence.len() / 2, 0] {
                    progressive.seek(steps);
                    assert_eq!(progressive.validate(), Ok(()));
                    assert_comes_back(&progressive);
                }
            }
        }
        let sequence = Simplifier::new().run(&mesh).unwrap();
        let tom = bake_tom(&mesh, &sequence);
        assert_comes_back(&tom);
        assert_comes_back(&**tom.structure());
        assert_comes_back(&TomParts::from((**tom.structure()).clone()));
    }
    for option in [Placement::Subset, Placement::Midpoint] {
        assert_comes_back(&option);
    }
    assert_comes_back(&Order::Batched);
    assert_comes_back(&ErrorMeasure::Verified);
}

#[test]
fn a_sequence_that_was_cut_short_comes_back() {
    let mesh = shapes::rock(20_000, 1);
    let sequence = Simplifier::new().run_with(&mesh, |_| ControlFlow::Break(())).unwrap();
    assert!(!sequence.is_empty() && sequence.triangles_after(sequence.len()) > 100);
    assert_comes_back(&sequence);
}

proptest! {
    #[test]
    fn any_sequence_comes_back((mesh, sequence) in support::any_placement(), level in 0usize..50) {
        assert_comes_back(&dressed(&mesh));
        assert_comes_back(&sequence);
        let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
        progressive.seek(level);
        assert_comes_back(&progressive);
        if let Ok(tom) = Baked::<TotallyOrderedMesh>::of_sequence(&dressed(&mesh), &sequence, &TomOptions::default()) {
            assert_comes_back(&tom);
        }
    }
}

/// Two rows of three vertices, 6 a duplicate of 1, 7 made of 1 and 4; batches as written.
fn small() -> (Mesh, CollapseSequence) {
    let places = [[0., 1.], [1., 1.], [2., 1.], [0., 0.], [1., 0.], [2., 0.], [1., 1.]];
    let positions: Vec<[f32; 3]> = places.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let triangles = [[0, 3, 6], [3, 4, 1], [1, 4, 5], [6, 5, 2], [5, 5, 2]];
    let mesh = Mesh::new(positions, triangles).unwrap();
    let half = NewVertex { from: [1, 4], weight: 0.5, position: [1.0, 0.5, 0.0] };
    let steps: [(&[[u32; 2]], f32); 3] =
        [(&[[1, 7], [4, 7]], 0.5), (&[[0, 3]], 0.25), (&[[7, 3], [2, 5]], 1.0)];
    let sequence = CollapseSequence::from_collapses(&mesh, &[half], steps).unwrap();
    assert_eq!(sequence.triangle_ends(), [2, 1, 1, 3, 0]);
    (mesh, sequence)
}

/// Changes one entry of a structure's text and says why it is then refused.
fn refusal<T: Serialize + DeserializeOwned + std::fmt::Debug>(
    value: &T,
    changes: &[(&str, Value)],
) -> String {
    let mut text = serde_json::to_value(value).unwrap();
    for (place, entry) in changes {
        *text.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = entry.clone();
    }
    serde_json::from_value::<T>(text).expect_err(changes[0].0).to_string()
}

#[test]
fn every_promise_of_a_sequence_is_checked() {
    let (_, sequence) = small();
    let none: Vec<u32> = Vec::new();
    for (place, entry, why) in [
        // Lengths and order of the tables.
        ("/input_vertices", json!(u32::MAX), "input vertices"),
        ("/step_start", json!(none), "0 step starts"),
        ("/step_start", json!([0, 2, 3]), "3 step starts"),
        ("/step_start/0", json!(1), "first step start"),
        ("/step_start/3", json!(4), "last step start"),
        ("/step_start/1", json!(4), "step 1 ends before it starts"),
        ("/max_error", json!([0.5]), "1 accumulated errors"),
        ("/batch_end", json!([2, 1, 3]), "batch 1 ends before"),
        ("/batch_end", json!([1, 4]), "batch 1 ends before it starts, or after"),
        ("/batch_end", json!([1, 2]), "2 batched steps"),
        ("/batch_end", json!(none), "0 batched steps"),
        // Errors.
        ("/step_error/1", json!(-1.0), "step 1 has the error bound -1"),
        ("/step_error/2", json!(1e39), "step 2 has the error bound inf"),
        ("/step_error/1", json!(0.75), "step 1 has the error bound 0.5"),
        ("/max_error/1", json!(0.25), "step 1 has the error bound 0.25"),
        ("/max_error/2", json!(1.5), "step 2 has the error bound 1.5"),
        // New vertices.
        ("/new_vertices/0/from/1", json!(7), "new vertex 0"),
        ("/new_vertices/0/weight", json!(1.5), "new vertex 0"),
        ("/new_vertices/0/position/2", json!(1e39), "new vertex 0"),
        // Vertices named.
        ("/aliases/0", json!([7, 1]), "step 0 names vertex 7, but there are 7"),
        ("/aliases/0", json!([6, 6]), "vertex 6 by itself"),
        ("/aliases/0", json!([1, 6]), "step 0 names vertex 1, which is not in the mesh"),
        ("/aliases", json!([[6, 5], [5, 3]]), "step 0 names vertex 5, which is not"),
        ("/aliases", json!([[6, 5], [6, 3]]), "step 0 names vertex 6, which is not"),
        ("/aliases", json!(vec![[6, 1]; 9]), "vertices taken away"),
        ("/substitutions/2", json!([0, 8]), "step 1 names vertex 8, but there are 8"),
        ("/substitutions/2", json!([u32::MAX, 0]), "step 1 names vertex 4294967295"),
        ("/substitutions/4", json!([2, 2]), "step 2 substitutes vertex 2 by itself"),
        ("/substitutions/4", json!([0, 5]), "step 2 names vertex 0, which is not"),
        ("/substitutions/4", json!([2, 0]), "step 2 names vertex 0, which is not"),
        ("/substitutions/4", json!([2, 6]), "step 2 names vertex 6, which is not"),
        ("/substitutions/4", json!([6, 2]), "step 2 names vertex 6, which is not"),
        ("/substitutions/4", json!([3, 7]), "step 2 names vertex 7, which is not"),
        ("/substitutions/0", json!([7, 1]), "step 0 names vertex 7, which is not"),
        (
            "/substitutions",
            json!([[7, 1], [4, 0], [0, 3], [1, 3], [2, 5]]),
            "step 0 names vertex 7, which is not",
        ),
        // Triangles.
        ("/triangles_after", json!([4, 2, 1]), "3 triangle counts"),
        ("/triangles_after/0", json!(5), "after 0 steps 5 triangles"),
        ("/triangles_after/2", json!(0), "after 2 steps 0 triangles"),
        ("/triangle_end/0", json!(4), "triangle 0 vanishes with step 4"),
        ("/triangle_end/0", json!(u32::MAX), "after 2 steps 1 triangles"),
        ("/triangle_end/0", json!(0), "after 0 steps 4 triangles"),
        // The report.
        ("/report/steps", json!(2), "2 reported steps"),
        ("/report/triangles", json!(7), "7 reported triangles"),
        ("/report/vertices", json!(99), "99 reported vertices"),
        ("/report/error", json!(2.0), "step 3 has the error bound 2"),
    ] {
        let said = refusal(&sequence, &[(place, entry)]);
        assert!(said.contains(why), "{place}: {said}");
    }
    // A cycle across steps.
    let said =
        refusal(&sequence, &[("/substitutions/2", json!([3, 0])), ("/substitutions/3", json!([0, 3]))]);
    assert!(said.contains("which is not in the mesh"), "{said}");
}

#[test]
fn every_promise_of_a_progressive_mesh_is_checked() {
    // A fan around 0; the middle goes to 1, then 2 and 3 become 7.
    let rim = [[0., 0.], [2., 0.], [1., 2.], [-1., 2.], [-2., 0.], [-1., -2.], [1., -2.]];
    let positions: Vec<[f32; 3]> = rim.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (1..7).map(|i| [0, i, i % 6 + 1]).collect();
    let mesh = Mesh::new(positions, triangles).unwrap();
    let half = NewVertex { from: [2, 3], weight: 0.5, position: [0.0, 2.0, 0.0] };
    let steps: [(&[[u32; 2]], f32); 2] = [(&[[0, 1]], 0.5), (&[[2, 7], [3, 7]], 0.25)];
    let sequence = CollapseSequence::from_collapses(&mesh, &[half], steps).unwrap();
    let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
    progressive.seek(1);
    let none: Vec<u32> = Vec::new();
    for (place, entry, why) in [
        ("/vertices_after", json!(none), "0 levels"),
        ("/steps", json!(3), "3 steps"),
        ("/vertices_after", json!([7, 6]), "triangle counts"),
        ("/vertices_after/0", json!(8), "vertex counts"),
        ("/vertices_after/1", json!(8), "vertex counts are out of order at entry 1"),
        ("/triangles_after/0", json!(7), "triangle counts"),
        ("/triangles_after/2", json!(5), "triangle counts are out of order at entry 2"),
        ("/places_after/0", json!(2), "place counts"),
        ("/places_after", json!([1, 1, 1]), "places at the base"),
        ("/parted", json!([[4, 5]]), "1 pairs"),
        ("/parted/0/1", json!(6), "pair 0 parts slot 4 into 6"),
        ("/parted/1/0", json!(9), "pair 1 parts slot 9 into 6"),
        ("/parted/1/0", json!(2), "corner 0 of pair 1"),
        ("/corner_start", json!([0]), "1 corner starts"),
        ("/corner_start/0", json!(1), "first corner start"),
        ("/corner_start/2", json!(4), "last corner start"),
        ("/corner_start/1", json!(6), "corner starts are out of order at entry 2"),
        ("/corners/0", json!(18), "corner 18 of pair 0"),
        ("/corners/4", json!(12), "corner 12 of pair 1"),
        ("/corners/0", json!(2), "triangle 0 names slot 5"),
        ("/vertex_order/3", json!(7), "order of vertices names 7 at place 3"),
        ("/vertex_order/3", json!(1), "order of vertices names 1 at place 3"),
        ("/triangle_order/1", json!(2), "order of triangles names 2 at place 1"),
        ("/triangle_order", json!([0]), "1 triangles"),
        ("/batches", json!([2, 1, 2]), "batches are out of order at entry 1"),
        ("/batches", json!([1]), "1 batched steps"),
        ("/positions/4/0", json!(1e39), "slot 4 has a non-finite position"),
        // Forgotten on the way to the base, so it shows only when the level comes by again.
        ("/positions/4/0", json!(0.25), "not that after 1 steps"),
        ("/places/0/slot", json!(99), "slot 99"),
        ("/places/0/fine/1", json!(1e39), "non-finite position"),
        ("/places/0/coarse", json!([1.0, 2.0, 0.0]), "move 0"),
        ("/places/0/slot", json!(6), "move 0 does not start where slot 6 lies"),
        ("/triangles/0/0", json!(6), "triangle 0 names slot 6"),
        ("/triangles/5/0", json!(7), "triangle 5 names slot 7"),
        ("/triangles/3/0", json!(5), "corner 9 of pair 1"),
        ("/triangles/0/1", json!(3), "not that after 1 steps"),
    ] {
        let said = refusal(&progressive, &[(place, entry.clone())]);
        assert!(said.contains(why), "{place} {entry}: {said}");
    }
    // The same corner for two pairs of a step, and the same slot moved twice.
    let twice = [
        ("/vertices_after", json!([7, 5, 5])),
        ("/corners", json!([0, 0, 3, 6, 9])),
        ("/parted", json!([[0, 5], [0, 6]])),
        ("/triangles", json!([[0, 4, 1], [0, 1, 2], [0, 2, 3], [0, 4, 3], [0, 1, 4], [6, 3, 0]])),
        ("/places", json!([])),
        ("/places_after", json!([0, 0, 0])),
    ];
    let said = refusal(&progressive, &twice);
    assert!(said.contains("corner 0 of pair 0"), "{said}");
    let place = |fine: f32, coarse: f32| json!({"slot": 0, "fine": [fine, 0, 0], "coarse": [coarse, 0, 0]});
    let twice = [("/places", json!([place(3.0, 2.0), place(2.0, 3.0)])), ("/places_after", json!([2, 0, 0]))];
    let said = refusal(&progressive, &twice);
    assert!(said.contains("move 1"), "{said}");
}

#[test]
fn parts_of_a_totally_ordered_mesh_are_checked() {
    let mesh = shapes::torus(1.0, 0.4, 12, 8);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let tom = bake_tom(&mesh, &sequence);
    for (place, entry, why) in [
        ("/substitute/95", json!(95), "vertex 95 is substituted by 95"),
        ("/substitute/0", json!(1), "base vertex 0"),
        ("/base_vertices", json!(97), "97 base vertices"),
        ("/triangles/5/0", json!(96), "triangle 5 names vertex 96"),
        ("/error_marks/1/error", json!(1e39), "error mark 1"),
    ] {
        let said = refusal(&**tom.structure(), &[(place, entry.clone())]);
        assert!(said.contains(why), "{place}: {said}");
        let said = refusal(&tom, &[(&format!("/structure{place}"), entry)]);
        assert!(said.contains(why), "{place}: {said}");
    }
}

#[test]
fn a_mesh_is_checked() {
    let mesh = dressed(&small().0).with_materials(vec![0; 5]).unwrap();
    for (place, entry, why) in [
        ("/positions/2/1", json!(1e39), "vertex 2 has a non-finite position"),
        ("/triangles/1/2", json!(7), "triangle 1 names vertex 7"),
        ("/materials", json!([0]), "materials has 1 entries"),
        ("/locks", json!([true]), "locks has 1 entries"),
        ("/attributes/1/name", json!("label"), "already an attribute named \"label\""),
        ("/attributes/1/width", json!(usize::MAX), "width 18446744073709551615"),
        ("/attributes/1/width", json!(2), "id has 7 entries where 14"),
    ] {
        let said = refusal(&mesh, &[(place, entry)]);
        assert!(said.contains(why), "{place}: {said}");
    }
}

/// Calls whatever there is to call, in and out of range, with the input and with others.
fn use_sequence(sequence: &CollapseSequence, mesh: &Mesh) {
    let len = sequence.len();
    let other = shapes::cube();
    for steps in [0, 1, len / 2, len.saturating_sub(1), len, len + 1, usize::MAX] {
        let _ = (sequence.substitutions(steps), sequence.step_error(steps));
        let bounds = (sequence.error_after(steps), sequence.triangles_after(steps));
        assert!(bounds.0 >= 0.0 && bounds.1 <= sequence.input_triangles());
        for mesh in [mesh, &Mesh::default(), &other] {
            let (triangles, origin) = sequence.triangles_at(mesh, steps);
            let level = sequence.extract(mesh, steps);
            assert_eq!((origin.len(), level.triangles().len()), (triangles.len(), triangles.len()));
            if !sequence.fits(mesh) {
                assert_eq!((triangles.len(), &level), (0, &Mesh::default()));
            }
            assert!(level.indices().iter().all(|&v| (v as usize) < level.positions().len()));
        }
        // Four bytes for every vertex it claims to have.
        if sequence.input_vertices() < 1 << 20 {
            let _ = sequence.representatives(steps);
        }
    }
    for number in [0, 1, usize::MAX] {
        assert!(sequence.steps_for_triangles(number) <= len);
    }
    for error in [-1.0, 0.0, 1.0, f32::INFINITY, f32::NAN] {
        assert!(sequence.steps_for_error(error) <= len);
    }
    let inputs = sequence.input_vertices() as u32;
    for vertex in [0, inputs, inputs.wrapping_add(1), u32::MAX] {
        let _ = sequence.origin(vertex);
    }
    let _ = (sequence.batches(), sequence.aliases(), sequence.new_vertices(), sequence.triangle_ends());
    for mesh in [mesh, &other] {
        if let Ok(progressive) = ProgressiveMesh::new(mesh, sequence) {
            assert_eq!(progressive.validate(), Ok(()));
            use_progressive(progressive);
        }
        if let Ok(tom) = Baked::<TotallyOrderedMesh>::of_sequence(mesh, sequence, &TomOptions::default()) {
            use_tom(&tom);
        }
    }
}

fn use_progressive(mut progressive: ProgressiveMesh) {
    let here = (progressive.positions().to_vec(), progressive.triangles().to_vec(), progressive.steps());
    let len = progressive.len();
    for steps in [0, 1, len, len + 1, usize::MAX] {
        let pairs = progressive.split(steps).map_or(0, |split| split.parted.len());
        for pair in [0, pairs, usize::MAX] {
            let _ = progressive.moved_corners(steps, pair);
        }
        let _ = progressive.moved_slots(steps).count();
    }
    let is_whole = |mesh: &ProgressiveMesh| {
        let count = mesh.positions().len();
        assert!(mesh.triangles().as_flattened().iter().all(|&slot| (slot as usize) < count));
    };
    while progressive.coarsen() {
        is_whole(&progressive);
    }
    while progressive.refine() {
        is_whole(&progressive);
    }
    progressive.seek(here.2);
    assert_eq!(
        here,
        (progressive.positions().to_vec(), progressive.triangles().to_vec(), progressive.steps())
    );
    let _ = (progressive.memory(), progressive.vertex_order(), progressive.batches());
}

fn use_tom(bundle: &Baked<TotallyOrderedMesh>) {
    let tom: &TotallyOrderedMesh = bundle.structure();
    let _ = (bundle.memory(), bundle.plain_memory(), tom.substitute(u32::MAX), tom.material_ids());
    let levels = [
        Level::Triangles(0),
        Level::Triangles(tom.triangle_count() / 2),
        Level::Triangles(usize::MAX),
        Level::Vertices(usize::MAX),
        Level::Vertices(3),
        Level::Error(0.5),
        Level::Error(f32::NAN),
        Level::Ratio(0.3),
        Level::Ratio(f32::NAN),
    ];
    let cursors = [TomSteps::new(tom.clone()), TomSteps::by_material(tom.clone())];
    let mut cursors = cursors.map(|steps| TomCursor::new(Arc::new(steps.unwrap())));
    let (mut indices, mut ranges) = (Vec::new(), Vec::new());
    for level in levels {
        let resolution = tom.at(level);
        tom.fill_by_material(resolution, &mut indices, &mut ranges);
        tom.fill_indices(resolution, &mut indices);
        assert!(indices.iter().all(|&v| (v as usize) < resolution.vertices()));
        assert_eq!(bundle.level(level).mesh.triangles().len(), resolution.triangles());
        let _ = (tom.traversal_overhead(resolution), tom.coarser(resolution), tom.finer(resolution));
        for cursor in &mut cursors {
            cursor.seek(resolution);
            let drawn = cursor.ranges().iter().map(|range| range.count as usize).sum::<usize>();
            assert_eq!(drawn, indices.len());
            let _ = cursor.indices();
            let _ = cursor.take_dirty();
        }
    }
    let mut lod = bundle.instance(Values::none(tom.vertex_count()), &LodOptions::default()).unwrap();
    assert_eq!(lod.refine_fully().triangles, tom.triangle_count());
    assert_eq!(lod.adapt(&[], 0.1).triangles, tom.coarsest().triangles());
    assert_eq!(lod.to_mesh().triangles().len(), tom.coarsest().triangles());
    // Four bytes for every vertex they claim to come from.
    let count = bundle.origins().input_vertices();
    if count < 1 << 20 {
        let _ = (bundle.arrange(&vec![0_u32; count]), bundle.origins().arrange_any(&vec![0_u32; count]));
    }
}

/// One change of some bytes: any byte at all, or a word made a small number, which more often fits.
fn damage() -> impl Strategy<Value = Vec<(prop::sample::Index, bool, u32)>> {
    prop::collection::vec((any::<prop::sample::Index>(), any::<bool>(), any::<u32>()), 1..4)
}

fn damaged(mut bytes: Vec<u8>, damage: &[(prop::sample::Index, bool, u32)]) -> Vec<u8> {
    for &(at, word, value) in damage {
        if word && bytes.len() >= 8 {
            let at = at.index(bytes.len() / 4 - 1) * 4;
            bytes[at..at + 4].copy_from_slice(&(value % 64).to_le_bytes());
        } else if !bytes.is_empty() {
            let at = at.index(bytes.len());
            bytes[at] ^= value as u8;
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn a_forged_sequence_is_refused_or_safe((mesh, sequence) in support::any_placement(), damage in damage()) {
        if let Ok(sequence) = unbytes::<CollapseSequence>(&damaged(bytes(&sequence), &damage)) {
            use_sequence(&sequence, &dressed(&mesh));
        }
    }

    #[test]
    fn a_forged_progressive_mesh_is_refused_or_safe(
        (mesh, sequence) in support::any_placement(),
        level in 0usize..50,
        damage in damage(),
    ) {
        let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
        progressive.seek(level);
        if let Ok(progressive) = unbytes::<ProgressiveMesh>(&damaged(bytes(&progressive), &damage)) {
            use_progressive(progressive);
        }
    }

    #[test]
    fn a_forged_totally_ordered_mesh_is_refused_or_safe(
        (mesh, sequence) in support::endpoint(),
        damage in damage(),
    ) {
        let tom = bake_tom(&dressed(&mesh), &sequence);
        if let Ok(tom) = unbytes::<Baked<TotallyOrderedMesh>>(&damaged(bytes(&tom), &damage)) {
            use_tom(&tom);
        }
    }

    #[test]
    fn a_forged_mesh_is_refused_or_safe((mesh, _) in support::endpoint(), damage in damage()) {
        if let Ok(mesh) = unbytes::<Mesh>(&damaged(bytes(&dressed(&mesh)), &damage)) {
            let sequence = Simplifier::new().run(&mesh).unwrap();
            use_sequence(&sequence, &mesh);
        }
    }
}

#[test]
fn counts_beyond_the_ends_are_taken_for_the_ends() {
    let (mesh, sequence) = small();
    assert_eq!(sequence.substitutions(3), [[0u32; 2]; 0]);
    assert_eq!(sequence.step_error(3), 0.0);
    assert_eq!(sequence.error_after(99), 1.0);
    assert_eq!(sequence.triangles_after(99), 0);
    assert_eq!(sequence.representatives(99), sequence.representatives(3));
    assert_eq!(sequence.extract(&mesh, 99), sequence.extract(&mesh, 3));
    let other = Mesh::new(mesh.positions(), &mesh.triangles()[1..]).unwrap();
    assert!(sequence.fits(&mesh) && !sequence.fits(&other));
    assert_eq!(sequence.extract(&other, 0), Mesh::default());
    assert_eq!(sequence.triangles_at(&other, 1), (Vec::new(), Vec::new()));
    assert!(matches!(ProgressiveMesh::new(&other, &sequence), Err(SequenceError::Mismatch { .. })));
}
