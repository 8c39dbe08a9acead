//! The collapses of one batch do not touch: each merges two points that no earlier one of the batch came near.

use multires::mesh::{Mesh, shapes};
use multires::simplify::{Order, Placement, Simplifier};

/// The neighbours of every vertex, each twice or so.
fn neighbours(triangles: &[[u32; 3]], vertices: usize) -> Vec<Vec<u32>> {
    let mut result = vec![Vec::new(); vertices];
    for t in triangles {
        for i in 0..3 {
            result[t[i] as usize].extend([t[(i + 1) % 3], t[(i + 2) % 3]]);
        }
    }
    result
}

fn assert_batches_do_not_touch(mesh: &Mesh) {
    let sequence = Simplifier::new()
        .placement(Placement::Endpoint)
        .order(Order::Batched)
        .run(mesh)
        .expect("legal options");
    assert!(sequence.batches().len() > 2);
    let mut start = 0;
    for &end in sequence.batches() {
        let (triangles, _) = sequence.triangles_at(mesh, start);
        let around = neighbours(&triangles, mesh.positions().len());
        let mut touched = vec![false; mesh.positions().len()];
        for step in start..end as usize {
            for &[from, to] in sequence.substitutions(step) {
                assert!(!touched[from as usize] && !touched[to as usize], "step {step}: {from} to {to}");
                for point in [from, to] {
                    touched[point as usize] = true;
                    around[point as usize].iter().for_each(|&n| touched[n as usize] = true);
                }
            }
        }
        start = end as usize;
    }
}

#[test]
fn collapses_of_a_batch_do_not_touch() {
    assert_batches_do_not_touch(&shapes::torus(1.0, 0.4, 40, 20));
    assert_batches_do_not_touch(&shapes::rock(3000, 2));
}
