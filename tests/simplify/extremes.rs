//! Promise: meshes at the edge of what is legal are simplified like any other, without panic and in reasonable time:
//! coordinates as large and as small as they go, all in one place, hubs, heaps of copies.
//!
//! Sizes are such that anything quadratic in a hub's valence would be felt, and anything cubic would not end.

use multires::lod::{Baked, Level};
use multires::mesh::{Adjacency, Attribute, Edges, Mesh, Report, Topology, shapes};
use multires::simplify::metric::{NAMES, by_name};
use multires::simplify::{
    CollapseSequence, ErrorMeasure, Order, Placement, ProgressiveMesh, Simplifier, Target,
};
use multires::tom::{TomOptions, TotallyOrderedMesh};

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

/// What holds of any simplification, and whatever is made of it.
fn assert_holds(what: &str, mesh: &Mesh, sequence: &CollapseSequence) {
    assert_eq!(sequence.validate(), Ok(()), "{what}");
    assert!(sequence.fits(mesh), "{what}");
    for steps in [0, sequence.len() / 2, sequence.len()] {
        assert!(sequence.error_after(steps).is_finite(), "{what}");
        let level = sequence.extract(mesh, steps);
        assert!(Mesh::new(level.positions(), level.triangles()).is_ok(), "{what}");
        assert!(level.diagonal().is_finite(), "{what}");
    }
    let mut progressive = ProgressiveMesh::new(mesh, sequence).unwrap();
    progressive.seek(0);
    assert_eq!(progressive.triangles().len(), mesh.triangles().len(), "{what}");
    if sequence.new_vertices().is_empty() {
        let tom = Baked::<TotallyOrderedMesh>::of_sequence(mesh, sequence, &TomOptions::default()).unwrap();
        assert!(tom.structure().validate().is_ok(), "{what}");
        // Where seams lie in one place with themselves, triangles between the wedges of one point are drawn.
        let drawn = tom.level(Level::Ratio(1.0)).mesh.triangles().len();
        assert!(drawn == sequence.triangles_after(0) || !mesh.attributes().is_empty(), "{what}");
    }
}

/// Simplifies by quadrics in every way; the least number of triangles that any way came to.
fn simplify(what: &str, mesh: &Mesh) -> usize {
    let mut least = usize::MAX;
    for placement in PLACEMENTS {
        for order in [Order::Linear, Order::Batched] {
            let sequence = Simplifier::new().placement(placement).order(order).run(mesh).unwrap();
            assert_holds(&format!("{what}, {placement:?}, {order:?}"), mesh, &sequence);
            least = least.min(sequence.triangles_after(sequence.len()));
        }
    }
    least
}

/// Simplifies by every metric, and with every option that measures distances.
fn simplify_by_all(what: &str, mesh: &Mesh) {
    for name in NAMES {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let metric = by_name(name).unwrap();
            let sequence = Simplifier::new().metric(metric).placement(placement).run(mesh).unwrap();
            assert_holds(&format!("{what}, {name}, {placement:?}"), mesh, &sequence);
        }
    }
    for measure in [ErrorMeasure::Parametric, ErrorMeasure::Verified] {
        for (join, error) in [(f32::MAX, f32::MAX), (f32::MIN_POSITIVE, 0.0), (1e-45, 1e-45)] {
            let mut simplifier =
                Simplifier::new().error_measure(measure).join_distance(join).target(Target::Error(error));
            let sequence = simplifier.run(mesh).unwrap();
            assert!(sequence.error_after(sequence.len()) <= error, "{what}, {measure:?}, {error}");
            assert_holds(&format!("{what}, {measure:?}, {join}"), mesh, &sequence);
        }
    }
}

fn look_at(mesh: &Mesh) {
    let topology = Topology::new(mesh);
    assert!(topology.point_count() <= topology.wedge_count());
    let (corners, vertices) = (mesh.triangles(), mesh.positions().len());
    assert_eq!(Adjacency::new(corners, vertices).point_count(), vertices);
    assert!(Edges::new(corners, vertices).len() <= mesh.indices().len());
    let _ = (mesh.bounds(), Report::new(mesh), Report::welded(mesh));
}

/// The same connectivity elsewhere.
fn mapped(mesh: &Mesh, map: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|&p| map(p)).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

#[test]
fn size_does_not_matter() {
    let mesh = shapes::torus(1.0, 0.4, 16, 10);
    let plain = simplify("as it is", &mesh);
    // By powers of two, so that nothing is rounded. The larger is wider than a float holds.
    let huge = mapped(&mesh, |p| p.map(|x| x * 2f32.powi(127)));
    let small = mapped(&mesh, |p| p.map(|x| x * 2f32.powi(-60)));
    for (what, mesh) in [("huge", &huge), ("small", &small)] {
        look_at(mesh);
        assert_eq!(simplify(what, mesh), plain, "{what}");
        simplify_by_all(what, mesh);
    }
    // A few steps of the finest grid that there is.
    for scale in [1e-33, 1e-38, 1e-42, 1e-44, 1e-45] {
        let tiny = mapped(&mesh, |p| p.map(|x| x * scale));
        look_at(&tiny);
        simplify_by_all("tiny", &tiny);
    }
    // One vertex so far away that the rest is in one place for all that single precision can tell.
    let mut positions = mesh.positions().to_vec();
    positions[7] = [f32::MAX, f32::MIN, f32::MAX];
    let stretched = Mesh::new(positions, mesh.triangles()).unwrap();
    look_at(&stretched);
    simplify_by_all("stretched", &stretched);
    simplify_by_all("flat", &mapped(&mesh, |p| [p[0], 0.0, p[2]]));
    simplify_by_all("a line", &mapped(&mesh, |p| [p[0] * 2e38, 0.0, 0.0]));
    simplify_by_all("three planes", &mapped(&mesh, |p| p.map(|x| if x > 0.0 { f32::MAX } else { f32::MIN })));
}

#[test]
fn points_in_one_place_are_nothing() {
    let mesh = shapes::torus(1.0, 0.4, 60, 40);
    for place in [[0.0; 3], [f32::MAX; 3], [f32::from_bits(1); 3]] {
        let point = mapped(&mesh, |_| place);
        look_at(&point);
        assert_eq!(simplify("one place", &point), 0);
        simplify_by_all("one place", &point);
        // Each with values of its own: wedges of one point.
        let ids: Vec<[f32; 1]> = (0..mesh.positions().len()).map(|v| [v as f32]).collect();
        let wedges = point.with_attribute(Attribute::floats("id", &ids)).unwrap();
        assert_eq!(simplify("wedges of one point", &wedges), 0);
    }
}

#[test]
fn vertices_that_nothing_uses_are_no_burden() {
    let positions: Vec<[f32; 3]> = (0..1 << 20).map(|i| [i as f32, 1.0, -1.0]).collect();
    let lone = Mesh::new(positions.clone(), []).unwrap();
    look_at(&lone);
    let sequence = Simplifier::new().run(&lone).unwrap();
    assert_holds("isolated", &lone, &sequence);
    assert!(sequence.is_empty());
    let copies = Mesh::new(vec![[2.0; 3]; 100_000], [[0, 1, 2], [7, 99_999, 4]]).unwrap();
    look_at(&copies);
    assert_eq!(simplify("copies", &copies), 0);
    let most = Mesh::new(positions, [[5, 70_000, 1 << 19], [70_000, 5, 9]]).unwrap();
    assert_holds("nearly isolated", &most, &Simplifier::new().run(&most).unwrap());
}

#[test]
fn hubs_are_taken_apart() {
    let n = 30_000;
    for (what, mesh, left) in [("fan", shapes::hub(n), 1), ("double fan", shapes::spindle(n), 4)] {
        look_at(&mesh);
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
            assert_holds(what, &mesh, &sequence);
            assert_eq!(sequence.triangles_after(sequence.len()), left, "{what}");
        }
    }
    // Triangles that meet in a point only, each with a wedge of its own there.
    let fan = shapes::hub(3000);
    let positions: Vec<[f32; 3]> = fan.indices().iter().map(|&v| fan.positions()[v as usize]).collect();
    let ids: Vec<[f32; 1]> = (0..positions.len()).map(|v| [v as f32]).collect();
    let triangles: Vec<[u32; 3]> = (0..3000).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let faces = Mesh::new(positions, triangles).unwrap();
    let faces = faces.with_attribute(Attribute::floats("id", &ids)).unwrap();
    look_at(&faces);
    assert_holds("fan of faces", &faces, &Simplifier::new().run(&faces).unwrap());
    let book = shapes::book(300);
    look_at(&book);
    assert_holds("book", &book, &Simplifier::new().run(&book).unwrap());
}

#[test]
fn heaps_of_one_triangle_are_seen_through() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let n = 100_000;
    let shared = Mesh::new(corners, vec![[0, 1, 2]; n]).unwrap();
    let turned: Vec<[u32; 3]> = (0..n).map(|t| [[0, 1, 2], [2, 1, 0], [1, 2, 0]][t % 3]).collect();
    let turned = Mesh::new(corners, turned).unwrap();
    // Three vertices each: copies, and copies with values of their own.
    let positions: Vec<[f32; 3]> = (0..3 * n).map(|v| corners[v % 3]).collect();
    let triangles: Vec<[u32; 3]> = (0..n as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let copies = Mesh::new(positions, triangles).unwrap();
    let ids: Vec<[f32; 1]> = (0..3 * n).map(|v| [v as f32]).collect();
    let wedges = copies.clone().with_attribute(Attribute::floats("id", &ids)).unwrap();
    for (what, mesh) in [("shared", shared), ("turned", turned), ("copies", copies), ("wedges", wedges)] {
        look_at(&mesh);
        let sequence = Simplifier::new().run(&mesh).unwrap();
        assert_holds(what, &mesh, &sequence);
        let sequence = Simplifier::new().oracles(Vec::new()).run(&mesh).unwrap();
        assert_holds(what, &mesh, &sequence);
        assert_eq!(sequence.triangles_after(sequence.len()), 0, "{what}");
    }
}
