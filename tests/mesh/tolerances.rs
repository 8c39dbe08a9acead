//! Promise: vertices at one point whose values agree within tolerances are one wedge, however they are numbered and
//! chained, so that noise makes no seams; and every structure folds the same ones.

use multires::hierarchy::{HierarchyOptions, VertexHierarchy};
use multires::lod::Baked;
use multires::mesh::{Attribute, AttributeValues, Mesh, Report, Tolerances, Topology, names, shapes};
use multires::simplify::{OptionError, Permissive, ProgressiveMesh, Simplifier, Target};
use multires::tom::{TomOptions, TotallyOrderedMesh};

/// Every triangle with three vertices of its own, each number of each float stream off by up to `ulps` steps.
fn noisy_soup(mesh: &Mesh, ulps: i32) -> Mesh {
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as i32 % (2 * ulps + 1) - ulps
    };
    let corners = || mesh.indices().iter().map(|&v| v as usize);
    let positions: Vec<[f32; 3]> = corners().map(|v| mesh.positions()[v]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mut soup = Mesh::new(positions, triangles).unwrap();
    for stream in mesh.attributes() {
        let (values, width) = (stream.as_floats().unwrap(), stream.width());
        let noisy = corners().flat_map(|v| &values[v * width..(v + 1) * width]).map(|&x| {
            let bits = x.to_bits() as i32;
            if x.abs() < 1e-3 { x } else { f32::from_bits((bits + noise()) as u32) }
        });
        let noisy = AttributeValues::Float(noisy.collect());
        soup = soup.with_attribute(Attribute::new(stream.name(), width, noisy)).unwrap();
    }
    soup
}

/// A sphere with smooth normals, colours and texture coordinates without a seam.
fn sphere() -> Mesh {
    let mesh = shapes::icosphere(4);
    let normals = mesh.positions().to_vec();
    let colors: Vec<[f32; 3]> = normals.iter().map(|n| n.map(|x| 0.5 * x + 0.5)).collect();
    let uv: Vec<[f32; 2]> = normals.iter().map(|n| [n[0], n[1]]).collect();
    mesh.with_attribute(Attribute::floats(names::NORMAL, &normals))
        .and_then(|mesh| mesh.with_attribute(Attribute::floats(names::COLOR, &colors)))
        .and_then(|mesh| mesh.with_attribute(Attribute::floats(names::UV, &uv)))
        .unwrap()
}

#[test]
fn noise_makes_no_seams() {
    let (clean, noisy) = (sphere(), noisy_soup(&sphere(), 2));
    let exact = Topology::new(&noisy);
    assert!(exact.wedge_count() > 5 * exact.point_count(), "the noise is there");
    let topology = Topology::with(&noisy, &Tolerances::default());
    assert_eq!([topology.point_count(), topology.wedge_count()], [clean.positions().len(); 2]);

    let target = || Simplifier::new().target(Target::Triangles(100));
    let held = target().tolerances(Tolerances::exact()).permissive(Permissive::Off);
    let exactly = { held }.run(&noisy).unwrap();
    assert!(exactly.report().triangles > 4_000, "the sphere is all seams: {}", exactly.report().triangles);
    let sequence = target().run(&noisy).unwrap();
    // In the same order of vertices, since equal costs are served in that.
    let expected = target().run(&noisy_soup(&clean, 0)).unwrap();
    assert_eq!(sequence.report().triangles, expected.report().triangles);
    assert_eq!(sequence.report().vertices, expected.report().vertices);
    assert!(sequence.report().error <= 1.3 * expected.report().error);
    assert_eq!(sequence.aliases().len(), noisy.positions().len() - clean.positions().len());
}

/// The full resolution of a structure is the input with each vertex in the place of those folded into it.
#[test]
fn structures_fold_what_the_sequence_folds() {
    let noisy = noisy_soup(&sphere(), 2);
    let sequence = Simplifier::new().run(&noisy).unwrap();
    let mut kept: Vec<u32> = (0..noisy.positions().len() as u32).collect();
    sequence.aliases().iter().for_each(|&[duplicate, to]| kept[duplicate as usize] = to);
    assert_eq!(kept, Topology::with(&noisy, &Tolerances::default()).wedge_of());

    let tom = Baked::<TotallyOrderedMesh>::of_sequence(&noisy, &sequence, &TomOptions::default()).unwrap();
    let finest = tom.mesh_at(tom.structure().finest());
    let hierarchy =
        Baked::<VertexHierarchy>::of_sequence(&noisy, &sequence, &HierarchyOptions::default()).unwrap();
    let points = Report::welded(&noisy).vertices;
    for (mesh, triangles) in
        [(&finest, finest.triangles().len()), (hierarchy.vertices(), hierarchy.structure().triangle_count())]
    {
        assert_eq!(mesh.positions().len(), points, "one vertex a point");
        assert_eq!(triangles, noisy.triangles().len());
    }
    // A vertex is drawn with values that differ from its own by the noise at most.
    let values = |mesh: &Mesh, v: u32| {
        mesh.attributes()
            .iter()
            .flat_map(|a| a.as_floats().unwrap()[v as usize * a.width()..][..a.width()].to_vec())
            .collect::<Vec<f32>>()
    };
    let [mut drawn, mut input] = [&finest, &noisy].map(|mesh| {
        let all =
            mesh.indices().iter().map(|&v| (mesh.positions()[v as usize].map(f32::to_bits), values(mesh, v)));
        all.collect::<Vec<_>>()
    });
    drawn.sort_by_key(|corner| corner.0);
    input.sort_by_key(|corner| corner.0);
    for ((place, shown), (there, own)) in drawn.iter().zip(&input) {
        assert_eq!(place, there);
        assert!(shown.iter().zip(own).all(|(a, b)| (a - b).abs() <= 1e-6), "{shown:?} {own:?}");
    }
    // The progressive mesh goes back to the input itself.
    let mut progressive = ProgressiveMesh::new(&noisy, &sequence).unwrap();
    progressive.seek(0);
    assert_eq!(progressive.positions().len(), noisy.positions().len());
    let level = sequence.extract(&noisy, 0);
    assert_eq!(level, noisy);
}

/// Vertices at one point with the given values of a stream.
fn wedges(name: &str, values: &[[f32; 3]]) -> Mesh {
    let count = values.len() as u32;
    let mut positions = vec![[0.0; 3]; values.len()];
    positions.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let triangles: Vec<[u32; 3]> = (0..count).map(|v| [v, count, count + 1]).collect();
    let values = [values, &[[0.0; 3]; 2]].concat();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(name, &values)).unwrap()
}

/// Each wedge is near the one that names it, not only near the next.
#[test]
fn a_chain_of_near_values_does_not_become_one() {
    let ramp: Vec<[f32; 3]> = (0..100).map(|i| [0.9 * i as f32 / 255.0; 3]).collect();
    let tolerances = Tolerances::exact().with_color(2.0);
    let topology = Topology::with(&wedges(names::COLOR, &ramp), &tolerances);
    let named: Vec<u32> = (0..100).map(|v| v / 3 * 3).collect();
    assert_eq!(topology.wedge_of()[..100], named, "three in each, of the lowest one's name");
}

#[test]
fn a_stream_can_be_left_out() {
    let mesh = shapes::box_with_face_normals(3);
    let points = Topology::new(&mesh).point_count();
    let without = |name| Topology::with(&mesh, &Tolerances::default().without(name)).wedge_count();
    assert_eq!(without(names::UV), 6 * 16, "each face has a normal of its own");
    let neither = Tolerances::default().without(names::NORMAL).without(names::UV);
    assert_eq!(Topology::with(&mesh, &neither).wedge_count(), points);
    let any = Tolerances::exact().with_normal(f32::INFINITY).with_uv(f32::INFINITY);
    assert_eq!(Topology::with(&mesh, &any).wedge_count(), points);
    assert!(without(names::NORMAL) > points);
}

#[test]
fn labels_are_exact() {
    let mesh = Mesh::new([[0.0; 3], [0.0; 3], [1.0; 3]], [[0, 1, 2]]).unwrap();
    let joints = AttributeValues::Uint(vec![0, 1, 2, 3, 0, 1, 2, 4, 0, 0, 0, 0]);
    let mesh = mesh.with_attribute(Attribute::new(names::JOINTS, 4, joints)).unwrap();
    let wide = Tolerances::default().with_relative(1e9).with_normal(180.0);
    assert_eq!(Topology::with(&mesh, &wide).wedge_count(), 3);
}

/// Very many different wedges at one point, and very many nearly equal ones: a square of their number would take hours.
#[test]
fn many_wedges_at_a_point_cost_no_square() {
    let distinct: Vec<[f32; 3]> = (0..300_000).map(|i| [i as f32, 1.0, 0.0]).collect();
    let topology = Topology::with(&wedges("place", &distinct), &Tolerances::default().with_relative(1e-9));
    assert_eq!(topology.wedge_count(), 300_002);
    let near: Vec<[f32; 3]> = (0..300_000).map(|i| [1.0 + i as f32 * 1e-11, 1.0, i as f32 * 1e-11]).collect();
    let topology = Topology::with(&wedges("place", &near), &Tolerances::default());
    assert_eq!(topology.wedge_count(), 3);
}

#[test]
fn what_is_no_tolerance_is_refused() {
    let mesh = shapes::tetrahedron();
    let good = Tolerances::default;
    for bad in [
        good().with_normal(-1.0),
        good().with_uv(f32::NAN),
        good().with_color(-0.5),
        good().with_relative(f32::NAN),
        good().with_position(-1.0),
        good().with_texture_size(0.0),
    ] {
        let said = Simplifier::new().tolerances(bad.clone()).run(&mesh);
        assert!(matches!(said, Err(OptionError::OutOfRange { .. })), "{bad:?}");
    }
    assert!(Simplifier::new().tolerances(good().with_uv(f32::INFINITY)).run(&mesh).is_ok());
}
