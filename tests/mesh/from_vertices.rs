//! Promise: a mesh from an engine's vertex and index buffers has a seam where vertices at one position differ in a byte, and
//! nowhere else; and vertices follow into the order of a structure, or are refused where a seam would be lost.
#![allow(clippy::single_range_in_vec_init)] // One material is a list of one range.

use multires::MeshError;
use multires::hierarchy::{Dependencies, HierarchyOptions, VertexHierarchy};
use multires::lod::Baked;
use multires::mesh::{Attribute, AttributeValues, Mesh, Topology, names, shapes};
use multires::simplify::{CollapseSequence, Placement, Simplifier};
use multires::tom::{Level, TomOptions, TotallyOrderedMesh};
use proptest::prelude::*;

/// What skinned characters have: 52 bytes.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    color: [u8; 4],
    joints: [u8; 4],
    weights: [f32; 3],
}

/// Vertices of a mesh, what it does not have being zero.
fn vertices(mesh: &Mesh) -> Vec<Vertex> {
    fn row<const N: usize>(mesh: &Mesh, name: &str, v: usize) -> [f32; N] {
        let attribute = mesh.attribute(name);
        let floats =
            attribute.and_then(|a| a.as_floats()).filter(|_| attribute.is_some_and(|a| a.width() >= N));
        floats.map_or([0.0; N], |f| std::array::from_fn(|i| f[v * attribute.unwrap().width() + i]))
    }
    let vertex = |v: usize| Vertex {
        position: mesh.positions()[v],
        normal: row(mesh, names::NORMAL, v),
        uv: row(mesh, names::UV, v),
        color: row::<3>(mesh, names::COLOR, v)
            .map(|x| (255.0 * x) as u8)
            .into_iter()
            .chain([255])
            .collect::<Vec<_>>()
            .try_into()
            .unwrap(),
        joints: [0; 4],
        weights: row(mesh, names::WEIGHTS, v),
    };
    (0..mesh.positions().len()).map(vertex).collect()
}

fn mesh_of(vertices: &[Vertex], mesh: &Mesh) -> Mesh {
    Mesh::from_vertices(vertices, mesh.indices(), |v| v.position).unwrap()
}

#[test]
fn seams_are_where_bytes_differ() {
    for shape in
        [shapes::box_with_face_normals(3), shapes::prop(12), shapes::robot(6), shapes::uv_sphere(16, 8)]
    {
        let all = vertices(&shape);
        let [seen, known] =
            [mesh_of(&all, &shape), shape].map(|mesh| Topology::new(&mesh).wedge_of().to_vec());
        assert_eq!(seen, known);
    }
}

#[test]
fn vertices_that_are_equal_are_one_and_need_no_stream() {
    // Every triangle has corners of its own.
    let sphere = shapes::icosphere(2);
    let loose: Vec<Vertex> = {
        let all = vertices(&sphere);
        sphere.indices().iter().map(|&v| all[v as usize]).collect()
    };
    let indices: Vec<u32> = (0..loose.len() as u32).collect();
    let mesh = Mesh::from_vertices(&loose, &indices, |v| v.position).unwrap();
    assert_eq!(mesh.attributes(), []);
    assert_eq!(Topology::new(&mesh).wedge_count(), sphere.positions().len());
    // The sign of a zero is no place of its own, but a byte.
    let at = |x: f32| Vertex { position: [x, 0.0, 0.0], ..loose[0] };
    let zeros = Mesh::from_vertices(&[at(0.0), at(-0.0)], &[0u16; 0], |v| v.position).unwrap();
    assert_eq!(Topology::new(&zeros).wedge_of(), [0, 1]);
}

#[test]
fn both_widths_of_indices_are_taken() {
    let cube = shapes::box_with_face_normals(2);
    let all = vertices(&cube);
    let short: Vec<u16> = cube.indices().iter().map(|&i| i as u16).collect();
    assert_eq!(Mesh::from_vertices(&all, &short, |v| v.position).unwrap(), mesh_of(&all, &cube));
    let odd = Mesh::from_vertices(&all, &short[..7], |v| v.position);
    assert_eq!(odd, Err(MeshError::OddIndices { indices: 7 }));
    let beyond = Mesh::from_vertices(&all[..2], &[0u16, 1, 2], |v| v.position);
    assert_eq!(beyond, Err(MeshError::IndexOutOfRange { triangle: 0, index: 2, vertices: 2 }));
    let nowhere = Mesh::from_vertices(&all, &short, |_| [f32::NAN, 0.0, 0.0]);
    assert!(matches!(nowhere, Err(MeshError::NonFinitePosition { vertex: 0, .. })));
}

#[test]
fn materials_come_by_ranges_of_indices() {
    let plane = shapes::plane(2);
    let with = |ranges: &[std::ops::Range<usize>]| plane.clone().with_material_ranges(ranges);
    assert_eq!(with(&[6..24, 0..6]).unwrap().materials(), [1, 1, 0, 0, 0, 0, 0, 0]);
    assert_eq!(with(&[0..24, 24..24]).unwrap().materials(), [0; 8]);
    let refused = |range, start, end| Err(MeshError::MaterialRange { range, start, end });
    assert_eq!(with(&[0..24, 0..3]), refused(1, 0, 3));
    assert_eq!(with(&[0..4, 4..24]), refused(0, 0, 4));
    assert_eq!(with(&[0..27]), refused(0, 0, 27));
    #[allow(clippy::reversed_empty_ranges)]
    let backwards = with(&[6..3]);
    assert_eq!(backwards, refused(0, 6, 3));
    assert_eq!(with(&[0..6, 9..24]), Err(MeshError::NoMaterial { triangle: 2 }));
    assert_eq!(with(&[]), Err(MeshError::NoMaterial { triangle: 0 }));
}

fn simplified(mesh: &Mesh) -> CollapseSequence {
    Simplifier::new().run(mesh).unwrap()
}

fn ordered(mesh: &Mesh, sequence: &CollapseSequence) -> Baked<TotallyOrderedMesh> {
    Baked::of_sequence(mesh, sequence, &TomOptions::default()).unwrap()
}

fn hierarchy(mesh: &Mesh, sequence: &CollapseSequence) -> Baked<VertexHierarchy> {
    Baked::of_sequence(mesh, sequence, &HierarchyOptions::default()).unwrap()
}

/// Every triangle of a level is the image of one of the input, and wears on each corner the vertex of its own side of a seam:
/// faces of a box keep one normal.
#[test]
fn vertices_of_any_type_follow_with_their_seams() {
    let shape = shapes::box_with_face_normals(6);
    let all = vertices(&shape);
    let mesh = mesh_of(&all, &shape);
    let sequence = simplified(&mesh);
    let model = ordered(&mesh, &sequence);
    let (tom, arranged) = (model.structure(), model.arrange(&all).unwrap());
    let (mut indices, mut levels) = (Vec::new(), 0);
    for triangles in [400, 200, 100, 50, 12] {
        tom.fill_indices(tom.at(Level::Triangles(triangles)), &mut indices);
        for corners in indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| arranged[corners[i] as usize].normal);
            assert!(a == b && b == c, "{a:?} {b:?} {c:?}");
            levels += 1;
        }
    }
    assert!(levels > 500);
    let built = VertexHierarchy::build(&mesh, &sequence, Dependencies::None).unwrap();
    let order: Vec<Vertex> = built.vertex_order.iter().map(|&v| all[v as usize]).collect();
    assert_eq!(hierarchy(&mesh, &sequence).arrange(&all).unwrap()[..], order);
}

#[test]
fn a_seam_that_the_mesh_does_not_know_is_refused() {
    let shape = shapes::box_with_face_normals(4);
    let all = vertices(&shape);
    let blind = Mesh::new(shape.positions(), shape.triangles()).unwrap();
    let sequence = simplified(&blind);
    let (tom, hierarchy) = (ordered(&blind, &sequence), hierarchy(&blind, &sequence));
    let refused = tom.arrange(&all).unwrap_err();
    let MeshError::Folded { vertices: [a, b] } = refused else { panic!("{refused}") };
    assert_eq!(shape.positions()[a as usize], shape.positions()[b as usize]);
    assert_ne!(all[a as usize], all[b as usize]);
    assert_eq!(hierarchy.arrange(&all).unwrap_err(), MeshError::Folded { vertices: [a, b] });
    // Without comparing, on one's own account; and where nothing differs.
    assert_eq!(tom.origins().arrange_any(&all).unwrap().len(), all.len() - sequence.aliases().len());
    assert!(tom.arrange(shape.positions()).is_ok() && hierarchy.arrange(shape.positions()).is_ok());
}

/// Values that differ by less than the tolerances are one by the caller's own will.
#[test]
fn noise_within_the_tolerances_is_no_lost_seam() {
    let shape = shapes::plane(6);
    let twice = |v: &[[f32; 3]]| v.iter().chain(v).copied().collect::<Vec<_>>();
    let (count, last) = (shape.positions().len() as u32, shape.triangles().len() / 2);
    let triangles: Vec<[u32; 3]> = shape
        .triangles()
        .iter()
        .enumerate()
        .map(|(t, corners)| if t < last { *corners } else { corners.map(|v| v + count) })
        .collect();
    let normals: Vec<[f32; 3]> = (0..2 * count).map(|v| [1e-7 * (v / count) as f32, 1.0, 0.0]).collect();
    let mesh = Mesh::new(twice(shape.positions()), triangles)
        .unwrap()
        .with_attribute(Attribute::floats(names::NORMAL, &normals))
        .unwrap();
    let sequence = simplified(&mesh);
    assert!(!sequence.aliases().is_empty());
    let arranged = ordered(&mesh, &sequence).arrange(&normals).unwrap();
    assert_eq!(arranged.len(), normals.len() - sequence.aliases().len());
}

/// Zeros of both signs are one place, and arranging positions is no lost seam; nor is what no triangle uses.
#[test]
fn zeros_and_unused_vertices_differ_at_will() {
    let right = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let left = [[-0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-0.0, 1.0, 0.0]];
    let positions = [&right[..], &left, &right].concat();
    let mesh = Mesh::new(positions, [[0, 1, 2], [3, 5, 4]]).unwrap();
    let sequence = simplified(&mesh);
    let (tom, hierarchy) = (ordered(&mesh, &sequence), hierarchy(&mesh, &sequence));
    assert!(tom.arrange(mesh.positions()).is_ok() && hierarchy.arrange(mesh.positions()).is_ok());
    let numbers: Vec<u32> = (0..9).map(|v| if v < 6 { 0 } else { v }).collect();
    assert!(tom.arrange(&numbers).is_ok() && hierarchy.arrange(&numbers).is_ok());
    // Too few are that, and no lost seam.
    let short = MeshError::LengthMismatch { what: "values".into(), found: 8, expected: 9 };
    assert_eq!(tom.arrange(&numbers[1..]).unwrap_err(), short);
    assert_eq!(hierarchy.arrange(&numbers[1..]).unwrap_err(), short);
}

#[test]
fn vertices_made_by_collapses_need_a_blend() {
    let mesh = shapes::icosphere(3);
    let sequence = Simplifier::new().placement(Placement::Optimal).run(&mesh).unwrap();
    let hierarchy = hierarchy(&mesh, &sequence);
    let refused = hierarchy.arrange(mesh.positions()).unwrap_err();
    assert_eq!(refused, MeshError::NewVertices { count: sequence.new_vertices().len() });
    let blended = hierarchy.arrange_blended(mesh.positions(), |place, at| *place = at).unwrap();
    assert_eq!(blended[..], *hierarchy.vertices().positions());
}

proptest! {
    /// Whatever the vertices hold: one wedge where place and bytes are equal, and nowhere else.
    #[test]
    fn wedges_are_equal_places_and_bytes(
        raw in prop::collection::vec((0u8..3, 0u8..3), 1..40),
        corners in prop::collection::vec(0usize..1000, 0..60),
    ) {
        let vertices: Vec<[f32; 4]> = raw.iter().map(|&(x, value)| [f32::from(x), 0.0, 0.0, f32::from(value)]).collect();
        let whole = corners.len() / 3 * 3;
        let indices: Vec<u32> = corners[..whole].iter().map(|c| (c % vertices.len()) as u32).collect();
        let mesh = Mesh::from_vertices(&vertices, &indices, |v| [v[0], v[1], v[2]]).unwrap();
        let topology = Topology::new(&mesh);
        for (v, vertex) in vertices.iter().enumerate() {
            let first = vertices.iter().position(|other| other == vertex).unwrap();
            prop_assert_eq!(topology.wedge_of()[v] as usize, first);
        }
        let stream = mesh.attribute(names::VERTEX).map(|a| a.values().clone());
        let seam = topology.wedge_count() > topology.point_count();
        prop_assert_eq!(seam, matches!(stream, Some(AttributeValues::Uint(_))));
    }
}
