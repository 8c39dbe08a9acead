//! Promise: crossings of a surface are counted, and a rule keeps a surface that does not cross itself from coming to.
#![cfg(feature = "quality")]

use multires::mesh::{Mesh, shapes};
use multires::quality::self_intersections;
use multires::simplify::oracle::SelfIntersection;
use multires::simplify::{Order, Placement, Simplifier, StopReason, Target, metric};

/// Several meshes in one, each moved.
fn together(parts: &[(Mesh, [f32; 3])]) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (part, by) in parts {
        let first = positions.len() as u32;
        positions.extend(part.positions().iter().map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]));
        triangles.extend(part.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Mesh::new(positions, triangles).unwrap()
}

fn triangles(corners: &[[[f32; 3]; 3]]) -> Mesh {
    let count = corners.len() as u32;
    let triangles: Vec<[u32; 3]> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(corners.as_flattened().to_vec(), triangles).unwrap()
}

#[test]
fn known_crossings_are_counted() {
    let flat = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let upright = |x: f32| [[x, 1.0, -1.0], [x, 1.0, 1.0], [x, 3.0, 0.0]];
    assert_eq!(self_intersections(&triangles(&[flat])), 0);
    assert_eq!(self_intersections(&triangles(&[flat, upright(1.0)])), 1);
    assert_eq!(self_intersections(&triangles(&[flat, upright(9.0)])), 0);
    // A row of uprights crosses the flat one and not each other; two flat ones make it twice as many.
    let row = [0.5, 0.7, 0.9, 1.1].map(upright);
    assert_eq!(self_intersections(&triangles(&[[flat].as_slice(), &row].concat())), 4);
    let lower = flat.map(|[x, y, _]| [x, y, -0.1]);
    assert_eq!(self_intersections(&triangles(&[[flat, lower].as_slice(), &row].concat())), 8);
    // Sharing a corner, touching with a tip, lying in the plane, the same twice: none.
    let tip = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
    let corner = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 2.0, -1.0]];
    let within = [[1.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 9.0, 0.0]];
    for other in [tip, corner, within, flat] {
        assert_eq!(self_intersections(&triangles(&[flat, other])), 0);
    }
    assert_eq!(self_intersections(&Mesh::default()), 0);
}

#[test]
fn crossings_are_counted_wherever_the_mesh_lies() {
    let [a, b] = [shapes::icosphere(3), shapes::uv_sphere(20, 12)];
    let near = together(&[(a.clone(), [0.0; 3]), (b.clone(), [0.75, 0.5, 0.25])]);
    let count = self_intersections(&near);
    assert!(count > 60 && count < 400, "{count}");
    let far = |scale: f32, by: f32| {
        let positions: Vec<[f32; 3]> = near.positions().iter().map(|p| p.map(|x| scale * x + by)).collect();
        self_intersections(&Mesh::new(positions, near.triangles().to_vec()).unwrap())
    };
    assert_eq!(far(1024.0, 0.0), count);
    assert_eq!(far(1.0 / 4096.0, 0.0), count);
    assert_eq!(far(4.0, 0.0), count);
    // Every pair, tried one by one, in the other order of the triangles.
    let mut reversed = near.triangles().to_vec();
    reversed.reverse();
    assert_eq!(self_intersections(&Mesh::new(near.positions().to_vec(), reversed).unwrap()), count);
    assert_eq!(self_intersections(&together(&[(a, [0.0; 3]), (b, [2.1, 0.0, 0.0])])), 0);
}

#[test]
fn a_thin_shell_stays_one() {
    let mesh = shapes::shell(4, 0.97);
    assert_eq!(mesh.triangles().len(), 10_240);
    assert_eq!(self_intersections(&mesh), 0);
    let level = |ratio: f64, placement, apart: bool| {
        let mut simplifier = Simplifier::new().placement(placement).target(Target::Ratio(ratio));
        if apart {
            simplifier = simplifier.oracle(SelfIntersection::new());
        }
        let sequence = simplifier.run(&mesh).unwrap();
        (sequence.extract(&mesh, sequence.len()), sequence.report().clone())
    };
    for placement in [Placement::Endpoint, Placement::Optimal] {
        let (free, _) = level(0.05, placement, false);
        assert!(self_intersections(&free) > 5, "{placement:?}: nothing to refuse");
        for ratio in [0.25, 0.05] {
            let (apart, report) = level(ratio, placement, true);
            assert_eq!(self_intersections(&apart), 0, "{placement:?} {ratio}");
            assert_eq!(report.stop, StopReason::Target, "{placement:?} {ratio}");
            let named = report.refusals.iter().find(|r| r.oracle == "self-intersection").unwrap();
            assert!(ratio > 0.1 || named.count > 0);
        }
    }
}

/// Every metric, both orders, again on the same simplifier, and down to the base mesh.
#[test]
fn no_way_leads_through() {
    let mesh = shapes::shell(2, 0.95);
    for name in metric::NAMES {
        for order in [Order::Linear, Order::Batched] {
            let metric = metric::by_name(name).unwrap();
            let mut simplifier =
                Simplifier::new().metric(metric).order(order).oracle(SelfIntersection::new());
            let sequence = simplifier.run(&mesh).unwrap();
            for part in 1..=4 {
                let level = sequence.extract(&mesh, part * sequence.len() / 4);
                assert_eq!(self_intersections(&level), 0, "{name} {order:?} {part}");
            }
            assert_eq!(simplifier.run(&mesh).unwrap(), sequence);
        }
    }
}

/// What crosses in the input may go on: only new crossings are refused.
#[test]
fn crossings_of_the_input_do_not_hold_it() {
    let mesh = together(&[(shapes::icosphere(3), [0.0; 3]), (shapes::icosphere(3), [0.9, 0.1, 0.0])]);
    let before = self_intersections(&mesh);
    let mut simplifier = Simplifier::new().oracle(SelfIntersection::new()).target(Target::Ratio(0.1));
    let sequence = simplifier.run(&mesh).unwrap();
    assert_eq!(sequence.report().stop, StopReason::Target);
    let after = self_intersections(&sequence.extract(&mesh, sequence.len()));
    assert!(before > 0 && after <= before, "{after} of {before}");
}
