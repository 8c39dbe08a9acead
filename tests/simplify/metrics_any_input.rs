//! Every metric with every placement and order takes any mesh: no panic, a valid forest, the same bytes twice and for
//! any number of threads.

use multires::mesh::{Mesh, shapes};
use multires::simplify::metric::{NAMES, by_name};
use multires::simplify::{CollapseSequence, Order, Placement, Simplifier};

const PLACEMENTS: [Placement; 4] =
    [Placement::Midpoint, Placement::Endpoint, Placement::Subset, Placement::Optimal];

fn run(mesh: &Mesh, name: &str, placement: Placement, order: Order, join: f32) -> CollapseSequence {
    Simplifier::new()
        .metric(by_name(name).expect("a known name"))
        .placement(placement)
        .order(order)
        .join_distance(join)
        .run(mesh)
        .expect("legal options")
}

/// Every vertex is replaced at most once, by one that is still there; triangle counts only fall; positions are finite.
fn assert_forest(mesh: &Mesh, sequence: &CollapseSequence, what: &str) {
    let vertices = sequence.input_vertices() + sequence.new_vertices().len();
    let mut gone = vec![false; vertices];
    for step in 0..sequence.len() {
        for &[from, to] in sequence.substitutions(step) {
            assert!(!gone[from as usize], "{what}: {from} is replaced twice");
            gone[from as usize] = true;
            assert!(!gone[to as usize], "{what}: {from} goes to {to}, which is gone");
        }
        assert!(sequence.triangles_after(step + 1) <= sequence.triangles_after(step), "{what}");
    }
    let base = sequence.extract(mesh, sequence.len());
    assert_eq!(base.triangles().len(), sequence.triangles_after(sequence.len()), "{what}");
    assert!(base.positions().as_flattened().iter().all(|x| x.is_finite()), "{what}");
    assert!(base.triangles().iter().all(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]), "{what}");
}

/// Triangles without area, of equal corners, on top of each other, and of sizes that squares do not survive.
fn degenerate() -> Mesh {
    let grid: Vec<[f32; 3]> = (0..36u8).map(|i| [f32::from(i % 6), f32::from(i / 6), 0.0]).collect();
    let mut positions: Vec<[f32; 3]> = grid.iter().map(|p| [p[0], 0.0, 0.0]).collect();
    positions.extend(grid.iter().map(|p| [p[0] * 1e-20, p[1] * 1e-20, p[0] * 1e-30]));
    positions.extend(grid);
    let mut triangles = Vec::new();
    for part in [0, 36, 72] {
        for i in (0..30).filter(|i| i % 6 != 5) {
            triangles
                .extend([[part + i, part + i + 1, part + i + 7], [part + i, part + i + 7, part + i + 6]]);
        }
        triangles.extend([
            [part, part, part + 1],
            [part + 8, part + 9, part + 15],
            [part + 8, part + 15, part + 9],
        ]);
    }
    Mesh::new(positions, triangles).expect("degenerate")
}

fn meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("closed", shapes::torus(1.0, 0.4, 16, 8)),
        ("rough", shapes::rock(400, 9)),
        ("open", shapes::terrain(12, 4)),
        ("open at both ends", shapes::open_cylinder(12, 5)),
        ("flat", shapes::plane(8)),
        ("one-sided", shapes::moebius(16)),
        ("non-manifold edge", shapes::book(5)),
        ("non-manifold vertex", shapes::two_spheres_touching(1)),
        ("hub", shapes::hub(40)),
        ("seams", shapes::box_with_face_normals(3)),
        ("soup", shapes::soup(60, 2)),
        ("pillow", shapes::pillow()),
        ("degenerate", degenerate()),
        ("empty", Mesh::default()),
    ]
}

#[test]
fn any_metric_takes_any_mesh() {
    for (kind, mesh) in meshes() {
        for name in NAMES {
            for placement in PLACEMENTS {
                for order in [Order::Linear, Order::Batched] {
                    let what = format!("{kind}, {name}, {placement:?}, {order:?}");
                    let first = run(&mesh, name, placement, order, 0.0);
                    assert_forest(&mesh, &first, &what);
                    assert_eq!(first, run(&mesh, name, placement, order, 0.0), "{what}: not the same twice");
                }
            }
        }
    }
}

#[test]
fn parts_may_be_joined_under_any_metric() {
    let mesh = shapes::soup(80, 5);
    for name in NAMES {
        for placement in PLACEMENTS {
            let what = format!("{name}, {placement:?}");
            assert_forest(&mesh, &run(&mesh, name, placement, Order::Linear, 0.5), &what);
        }
    }
}

/// More points than one thread takes at once.
#[cfg(feature = "parallel")]
#[test]
fn threads_change_nothing() {
    let mesh = shapes::rock(20_000, 4);
    let with_threads = |threads: usize, name: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&mesh, name, Placement::Optimal, Order::Batched, 0.0))
    };
    for name in NAMES {
        assert_eq!(with_threads(1, name), with_threads(4, name), "{name}");
    }
}
