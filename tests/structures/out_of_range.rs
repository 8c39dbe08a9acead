//! Numbers beyond the last get an answer, not a panic: none, zero, or the end.

use multires::adapt::Refinements;
use multires::gmesh::Gmesh;
use multires::mesh::shapes;
use multires::prelude::*;
use multires::simplify::Origin;
use multires::wavelet::{Normals, WaveletMesh};
use multires::{TotallyOrderedMesh, VertexHierarchy};

/// What is just beyond, and what is as far as can be.
fn beyond(count: usize) -> [u32; 3] {
    [count as u32, count as u32 + 1, u32::MAX]
}

fn refinements<R: Refinements>(of: &R) {
    for number in beyond(of.len()) {
        let _ = (of.bounds(number), of.error(number));
        assert_eq!(of.parents(number).count(), 0);
        assert_eq!(of.children(number).count(), 0);
        assert_eq!(of.dependencies(number).count(), 0);
    }
}

#[test]
fn refinements_that_are_not_there_need_nothing() {
    refinements(&**VertexHierarchy::bake(&shapes::prop(1)).unwrap().structure());
    refinements(&**WaveletMesh::bake(&shapes::icosphere(3)).unwrap().structure());
}

#[test]
fn levels_faces_and_wavelets_that_are_not_there_are_none() {
    let model = WaveletMesh::bake(&shapes::icosphere(3)).unwrap();
    let of = model.structure().subdivision();
    for level in [of.depth() + 1, usize::MAX - 1, usize::MAX] {
        assert!(of.wavelets_of(level).is_empty());
        assert!(of.faces_of(level + usize::from(level < usize::MAX)).is_empty());
        let whole = model.structure().at_level(level, Normals::default());
        assert_eq!(whole.triangles().len(), of.triangle_count());
    }
    for face in beyond(of.face_count()) {
        assert_eq!(of.base_face_of(face), u32::MAX);
        assert_eq!(of.base_face(face), None);
        assert!(!of.is_split(face));
        let _ = of.level_of_face(face);
    }
    for wavelet in beyond(of.wavelet_count()) {
        assert_eq!(of.vertex_of(wavelet), u32::MAX);
        assert!(of.seam_vertices_of(wavelet).is_empty());
        let _ = of.level_of(wavelet);
    }
    for vertex in beyond(of.vertex_count()) {
        assert_eq!((of.wavelet_of(vertex), of.ends(vertex)), (None, None));
    }
}

#[test]
fn steps_and_vertices_of_a_sequence_that_are_not_there() {
    let mesh = shapes::prop(1);
    let sequence = Simplifier::new().target(Target::Ratio(0.2)).run(&mesh).unwrap();
    for steps in [sequence.len() + 1, usize::MAX] {
        assert_eq!(sequence.step_error(steps), 0.0);
        assert_eq!(sequence.error_after(steps), sequence.error_after(sequence.len()));
        assert_eq!(sequence.triangles_after(steps), sequence.triangles_after(sequence.len()));
        assert!(sequence.substitutions(steps).is_empty());
        assert_eq!(sequence.representatives(steps), sequence.representatives(sequence.len()));
        assert_eq!(sequence.extract(&mesh, steps), sequence.extract(&mesh, sequence.len()));
        let _ = (sequence.surface_error_after(steps), sequence.curve_error_after(steps));
    }
    assert!(matches!(sequence.origin(u32::MAX), Origin::Input(u32::MAX)));
    assert_eq!(sequence.steps_for_triangles(usize::MAX), 0);
    // Bytes of vertices that no machine has.
    for per_vertex in [usize::MAX, usize::MAX / 2] {
        let target = Target::Bytes { bytes: 1_000, per_vertex };
        let report = Simplifier::new().target(target).run(&mesh).unwrap().report().clone();
        assert!(report.triangles < mesh.triangles().len() / 4, "no number wraps round to a small one");
    }
}

#[test]
fn groups_of_instances_that_are_not_there_are_empty() {
    let sphere = shapes::icosphere(3);
    let options = LodOptions::default();
    let view = View::perspective(
        multires::view::look_at([0.0, 0.0, 4.0], [0.0; 3], [0.0, 1.0, 0.0]),
        1.0,
        [800, 600],
    );
    let view = view.unwrap().of_world();
    let blended = multires::lod::Values::from(sphere.positions().to_vec()).with_blending();
    let models: Vec<Box<dyn Lod>> = vec![
        Box::new(
            VertexHierarchy::bake(&sphere).unwrap().instance(sphere.positions().to_vec(), &options).unwrap(),
        ),
        Box::new(WaveletMesh::bake(&sphere).unwrap().instance(blended, &options).unwrap()),
        Box::new(
            TotallyOrderedMesh::bake(&sphere)
                .unwrap()
                .instance(sphere.positions().to_vec(), &options)
                .unwrap(),
        ),
    ];
    for mut lod in models {
        lod.adapt(std::slice::from_ref(&view), 0.0);
        for group in [lod.groups(), usize::MAX] {
            assert!(lod.triangles(group).is_empty());
        }
    }
    let tom = TotallyOrderedMesh::bake(&sphere).unwrap();
    assert_eq!(tom.structure().memory(usize::MAX), usize::MAX);
    let crowd = Gmesh::bake(&sphere).unwrap();
    for (level, group) in [(0, usize::MAX), (usize::MAX, 0)] {
        assert!(crowd.structure().triangles(level, group).is_empty());
    }
}
