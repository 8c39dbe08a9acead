//! A progressive mesh replays a simplification exactly, both ways, and ends with the input bit for bit.

use crate::support::{any_placement, naive};
use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, NewVertex, ProgressiveMesh, SequenceError};
use proptest::prelude::*;

/// Triangles as positions, bit for bit, by input triangle.
type Picture = Vec<(u32, [[u32; 3]; 3])>;

fn bits(p: [f32; 3]) -> [u32; 3] {
    p.map(f32::to_bits)
}

/// What the sequence says the mesh is after so many steps.
fn expected(mesh: &Mesh, sequence: &CollapseSequence, steps: usize) -> Picture {
    let (triangles, origin) = sequence.triangles_at(mesh, steps);
    let position = |v: u32| match sequence.origin(v) {
        multires::simplify::Origin::Blend(new) => bits(new.position),
        _ => bits(mesh.positions()[v as usize]),
    };
    origin.into_iter().zip(triangles.into_iter().map(|t| t.map(position))).collect()
}

fn shown(pm: &ProgressiveMesh) -> Picture {
    let at = |v: u32| bits(pm.positions()[v as usize]);
    let triangles = pm.triangles().iter().map(|t| t.map(at));
    let mut all: Picture = pm.triangle_order().iter().copied().zip(triangles).collect();
    all.sort_unstable();
    all
}

fn assert_is_input(pm: &ProgressiveMesh, mesh: &Mesh) {
    let mut positions = vec![[0; 3]; mesh.positions().len()];
    for (p, &v) in pm.positions().iter().zip(pm.vertex_order()) {
        positions[v as usize] = bits(*p);
    }
    assert_eq!(pm.positions().len(), mesh.positions().len());
    assert_eq!(positions, mesh.positions().iter().map(|&p| bits(p)).collect::<Vec<_>>());
    let mut triangles = vec![[u32::MAX; 3]; mesh.triangles().len()];
    for (t, &i) in pm.triangles().iter().zip(pm.triangle_order()) {
        triangles[i as usize] = t.map(|v| pm.vertex_order()[v as usize]);
    }
    assert_eq!(triangles, mesh.triangles());
}

proptest! {
    #[test]
    fn every_level_is_the_sequences((mesh, sequence) in any_placement()) {
        let mut pm = ProgressiveMesh::new(&mesh, &sequence).unwrap();
        let base = pm.clone();
        prop_assert_eq!(pm.len(), sequence.len());
        prop_assert_eq!(pm.steps(), sequence.len());
        let mut pictures = vec![shown(&pm)];
        prop_assert_eq!(&pictures[0], &expected(&mesh, &sequence, sequence.len()));
        while pm.refine() {
            let picture = shown(&pm);
            prop_assert_eq!(&picture, &expected(&mesh, &sequence, pm.steps()));
            pictures.push(picture);
        }
        assert_is_input(&pm, &mesh);
        while pm.coarsen() {
            prop_assert_eq!(&shown(&pm), &pictures[sequence.len() - pm.steps()]);
        }
        prop_assert_eq!(pm, base);
    }

    #[test]
    fn walks_come_back((mesh, sequence) in any_placement(), walk in prop::collection::vec(0usize..50, 1..12)) {
        let mut pm = ProgressiveMesh::new(&mesh, &sequence).unwrap();
        for steps in walk {
            pm.seek(steps);
            prop_assert_eq!(pm.steps(), steps.min(sequence.len()));
            prop_assert_eq!(shown(&pm), expected(&mesh, &sequence, pm.steps()));
        }
        pm.seek(0);
        assert_is_input(&pm, &mesh);
    }

    /// The records alone are enough: triangles that come are the range named, corners that move held k and then hold l.
    #[test]
    fn records_say_what_happens((mesh, sequence) in any_placement()) {
        let mut pm = ProgressiveMesh::new(&mesh, &sequence).unwrap();
        while pm.steps() > 0 {
            let before = pm.clone();
            pm.refine();
            let split = before.split(pm.steps()).unwrap();
            prop_assert_eq!(split.first_triangle as usize, before.triangles().len());
            prop_assert_eq!((split.first_triangle + split.triangles) as usize, pm.triangles().len());
            prop_assert_eq!(split.parted.len(), pm.positions().len() - before.positions().len());
            let mut triangles = before.triangles().to_vec();
            for (pair, &[k, l]) in split.parted.iter().enumerate() {
                prop_assert_eq!(l as usize, before.positions().len() + pair);
                for &corner in before.moved_corners(pm.steps(), pair) {
                    let corner = &mut triangles.as_flattened_mut()[corner as usize];
                    prop_assert_eq!(*corner, k);
                    *corner = l;
                }
            }
            prop_assert_eq!(&triangles[..], &pm.triangles()[..triangles.len()]);
            let mut positions = before.positions().to_vec();
            for (slot, fine, coarse) in before.moved_slots(pm.steps()) {
                prop_assert_eq!(bits(positions[slot as usize]), bits(coarse));
                positions[slot as usize] = fine;
            }
            prop_assert_eq!(&positions[..], &pm.positions()[..positions.len()]);
        }
    }
}

#[test]
fn an_edge_between_two_faces_splits_into_both() {
    //   0 --- 1 --- 2      1 and 4 become a new vertex 6 half way
    //   |   / | \   |
    //   3 --- 4 --- 5
    let places = [[0., 1.], [1., 1.], [2., 1.], [0., 0.], [1., 0.], [2., 0.]];
    let positions: Vec<[f32; 3]> = places.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let triangles = [[0, 3, 1], [3, 4, 1], [1, 4, 5], [1, 5, 2]];
    let mesh = Mesh::new(positions, triangles).unwrap();
    let half = NewVertex { from: [1, 4], weight: 0.5, position: [1.0, 0.5, 0.0] };
    let sequence = CollapseSequence::from_collapses(&mesh, &[half], [([[1, 6], [4, 6]], 0.5)]).unwrap();
    let mut pm = ProgressiveMesh::new(&mesh, &sequence).unwrap();

    assert_eq!((pm.positions().len(), pm.triangles().len()), (5, 2));
    assert_eq!(pm.positions()[4], [1.0, 0.5, 0.0]);
    let split = pm.split(0).unwrap();
    assert_eq!(split.parted, [[4, 5]]);
    assert_eq!((split.first_triangle, split.triangles), (2, 2));
    assert!(pm.moved_corners(0, 0).is_empty(), "only the vanished triangles use vertex 4");
    let moved: Vec<_> = pm.moved_slots(0).collect();
    assert_eq!(moved, [(4, [1.0, 1.0, 0.0], [1.0, 0.5, 0.0])]);
    assert!(pm.refine() && !pm.refine());
    assert_is_input(&pm, &mesh);
    assert!(pm.split(1).is_none() && pm.moved_corners(1, 0).is_empty() && pm.moved_corners(0, 1).is_empty());
}

#[test]
fn a_closed_mesh_brings_two_faces_a_split() {
    let mesh = naive::torus(12, 10, false, false);
    let sequence = naive::sequence(&mesh, 60);
    let pm = ProgressiveMesh::new(&mesh, &sequence).unwrap();
    assert!(sequence.len() > 50);
    assert!((0..pm.len()).all(|step| pm.split(step).unwrap().triangles == 2));
    assert!((0..pm.len()).all(|step| pm.moved_slots(step).next().is_none()), "endpoints stay where they are");
    assert_eq!(pm.batches(), sequence.batches());
    assert!(pm.memory() > 0);
}

#[test]
fn a_foreign_mesh_is_refused() {
    let mesh = naive::torus(6, 5, false, false);
    let sequence = naive::sequence(&mesh, 20);
    let other = naive::torus(6, 6, false, false);
    let error = ProgressiveMesh::new(&other, &sequence).unwrap_err();
    assert!(matches!(error, SequenceError::Mismatch { what: "input vertices", found: 30, expected: 36 }));
}

#[test]
fn bad_substitutions_are_refused_by_name() {
    let mesh = naive::torus(4, 4, false, false);
    let build = |steps: &[(&[[u32; 2]], f32)]| {
        CollapseSequence::from_substitutions(&mesh, steps.iter().copied()).unwrap_err()
    };
    assert_eq!(build(&[(&[[3, 3]], 0.0)]), SequenceError::SelfSubstitution { step: 0, vertex: 3 });
    assert_eq!(
        build(&[(&[[0, 16]], 0.0)]),
        SequenceError::VertexOutOfRange { step: 0, vertex: 16, vertices: 16 }
    );
    assert_eq!(build(&[(&[[0, 1]], 0.0), (&[[0, 2]], 0.0)]), SequenceError::NotLive { step: 1, vertex: 0 });
    assert_eq!(build(&[(&[[0, 1]], 0.0), (&[[2, 0]], 0.0)]), SequenceError::NotLive { step: 1, vertex: 0 });
    assert!(matches!(build(&[(&[], f32::NAN)]), SequenceError::BadError { step: 0, .. }));
    assert!(matches!(build(&[(&[], -1.0)]), SequenceError::BadError { step: 0, .. }));
    assert!(matches!(build(&[(&[], f32::INFINITY)]), SequenceError::BadError { step: 0, .. }));
    let early = NewVertex { from: [0, 17], weight: 0.5, position: [0.0; 3] };
    let none: [([[u32; 2]; 0], f32); 0] = [];
    assert_eq!(
        CollapseSequence::from_collapses(&mesh, &[early], none).unwrap_err(),
        SequenceError::BadNewVertex { new: 0 }
    );
}

#[test]
fn duplicates_are_folded_and_may_be_named() {
    // Vertex 4 is vertex 1 again.
    let positions = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.], [1., 0., 0.], [5., 5., 5.]];
    let mesh = Mesh::new(positions, [[0, 1, 2], [2, 4, 3], [0, 1, 4]]).unwrap();
    let steps = [([[4, 3], [1, 3]], 2.0), ([[3, 0], [3, 0]], 1.0)];
    let sequence = CollapseSequence::from_substitutions(&mesh, steps).unwrap();
    assert_eq!(sequence.aliases(), [[4, 1]]);
    assert_eq!(sequence.substitutions(0), [[1, 3]]);
    assert_eq!(sequence.triangle_ends(), [2, 1, 0]);
    assert_eq!([0, 1, 2].map(|k| sequence.triangles_after(k)), [2, 1, 0]);
    assert_eq!([0, 1, 2].map(|k| sequence.error_after(k)), [0.0, 2.0, 2.0]);
    let report = sequence.report();
    assert_eq!((report.steps, report.triangles, report.vertices, report.error), (2, 0, 0, 2.0));
}
