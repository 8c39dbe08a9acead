//! The collapses of a batch are independent, by the chosen rule of independence.

use std::collections::BTreeSet;

use multires::mesh::{Mesh, shapes};
use multires::simplify::metric::{Batch, EdgeLength, ErrorMetric, LindstromTurk, PerBatch};
use multires::simplify::{CollapseSequence, Independence, Order, Placement, Simplifier};
use proptest::prelude::*;

fn batched(mesh: &Mesh, independence: Independence, placement: Placement) -> CollapseSequence {
    let simplifier = Simplifier::new().placement(placement).order(Order::Batched);
    simplifier.independence(independence).run(mesh).expect("legal options")
}

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

/// Calls `visit` with the triangles at the start of each batch and the batch's steps.
fn for_batches(
    mesh: &Mesh,
    sequence: &CollapseSequence,
    mut visit: impl FnMut(&[[u32; 3]], std::ops::Range<usize>),
) {
    let mut start = 0;
    for &end in sequence.batches() {
        visit(&sequence.triangles_at(mesh, start).0, start..end as usize);
        start = end as usize;
    }
}

fn assert_rings_do_not_touch(mesh: &Mesh) {
    let sequence = batched(mesh, Independence::Ring, Placement::Endpoint);
    assert!(sequence.batches().len() > 2);
    for_batches(mesh, &sequence, |triangles, steps| {
        let around = neighbours(triangles, mesh.positions().len());
        let mut touched = vec![false; mesh.positions().len()];
        for step in steps {
            for &[from, to] in sequence.substitutions(step) {
                assert!(!touched[from as usize] && !touched[to as usize], "step {step}: {from} to {to}");
                for point in [from, to] {
                    touched[point as usize] = true;
                    around[point as usize].iter().for_each(|&n| touched[n as usize] = true);
                }
            }
        }
    });
}

/// An edge is merged only if no triangle of it was changed before in the batch. Shapes without seams.
fn assert_domains_do_not_share_edges(mesh: &Mesh) {
    let sequence = batched(mesh, Independence::Domain, Placement::Endpoint);
    assert!(sequence.batches().len() > 2);
    for_batches(mesh, &sequence, |triangles, steps| {
        let mut triangles: Vec<[u32; 3]> = triangles.to_vec();
        let mut taken = BTreeSet::new();
        for step in steps {
            let &[[from, to]] = sequence.substitutions(step) else { panic!("a shape without seams") };
            assert!(!taken.contains(&[from.min(to), from.max(to)]), "step {step}: {from} to {to}");
            for triangle in &mut triangles {
                if !triangle.contains(&from) && !triangle.contains(&to) {
                    continue;
                }
                *triangle = triangle.map(|v| if v == from { to } else { v });
                for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|i| triangle[i])) {
                    taken.insert([a.min(b), a.max(b)]);
                }
            }
            triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
        }
    });
}

/// No vertex takes part in two steps of a batch: neither twice as the end of a merge, nor first as its end, then as its start.
fn assert_matches_once(mesh: &Mesh, sequence: &CollapseSequence) {
    let mut start = 0;
    for &end in sequence.batches() {
        let mut in_step = std::collections::BTreeMap::new();
        for step in start..end as usize {
            for &vertex in sequence.substitutions(step).as_flattened() {
                let first = *in_step.entry(vertex).or_insert(step);
                assert_eq!(first, step, "vertex {vertex} of a batch that starts at {start}");
            }
        }
        start = end as usize;
    }
    assert!(sequence.fits(mesh));
}

#[test]
fn collapses_of_a_batch_do_not_touch() {
    assert_rings_do_not_touch(&shapes::torus(1.0, 0.4, 40, 20));
    assert_rings_do_not_touch(&shapes::rock(3000, 2));
}

#[test]
fn domains_of_a_batch_share_no_edge() {
    assert_domains_do_not_share_edges(&shapes::torus(1.0, 0.4, 40, 20));
    assert_domains_do_not_share_edges(&shapes::rock(3000, 2));
}

#[test]
fn a_matching_nearly_halves_the_mesh() {
    let mesh = shapes::rock(20_000, 3);
    let shares = |independence| {
        let sequence = batched(&mesh, independence, Placement::Endpoint);
        let mut before = mesh.triangles().len();
        let mut shares = Vec::new();
        for &end in sequence.batches() {
            let after = sequence.triangles_after(end as usize);
            shares.push(after as f64 / before as f64);
            before = after;
            if after < mesh.triangles().len() / 20 {
                break;
            }
        }
        shares
    };
    let [ring, domain, matching] =
        [Independence::Ring, Independence::Domain, Independence::Matching].map(shares);
    assert!(ring.iter().all(|&share| (0.80..0.90).contains(&share)), "{ring:?}");
    assert!(domain.iter().all(|&share| (0.65..0.76).contains(&share)), "{domain:?}");
    assert!(matching.iter().all(|&share| (0.45..0.60).contains(&share)), "{matching:?}");
}

/// Triangles before and after each batch of a matching.
fn halvings(mesh: &Mesh) -> Vec<[usize; 2]> {
    let sequence = batched(mesh, Independence::Matching, Placement::Endpoint);
    let ends = sequence.batches().iter().map(|&end| sequence.triangles_after(end as usize));
    let ends: Vec<usize> = std::iter::once(mesh.triangles().len()).chain(ends).collect();
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// A matching could go on to 0.54.
#[test]
fn a_batch_is_full_at_a_share_of_its_triangles() {
    for mesh in [shapes::rock(20_000, 3), shapes::torus(1.0, 0.4, 120, 60)] {
        let mut batches = 0;
        for [before, after] in halvings(&mesh) {
            let full = 0.59 * before as f64;
            // A collapse takes a few triangles at most.
            let is_full = (full - 8.0..=full).contains(&(after as f64));
            assert!(is_full || before < 3_000, "{after} of {before}");
            batches += usize::from(is_full);
        }
        assert!(batches >= 3);
    }
}

/// Flat faces cost nothing beside creases and bores. Once a batch has thinned out the flat faces, costs leap by more than 2^10,
/// and the batch ends above its share.
#[test]
fn a_leap_of_cost_ends_a_batch() {
    let [first, second, ..] = halvings(&shapes::cad_part(3))[..] else { panic!("at least two batches") };
    for ([before, after], shares) in [(first, 0.63..0.67), (second, 0.70..0.77)] {
        let share = after as f64 / before as f64;
        assert!(shares.contains(&share), "{after} of {before}");
    }
}

#[test]
fn metric_and_placement_change_between_batches() {
    let mesh = shapes::rock(4_000, 5);
    let is_first = |batch: &Batch| batch.triangles > 2_500;
    let metric = PerBatch::new(move |batch| -> Box<dyn ErrorMetric> {
        if is_first(&batch) { Box::new(EdgeLength::new()) } else { Box::new(LindstromTurk::new()) }
    });
    let placement = move |batch: Batch| {
        if is_first(&batch) { Placement::Endpoint } else { Placement::Optimal }
    };
    let sequence = Simplifier::new()
        .metric(metric)
        .order(Order::Batched)
        .independence(Independence::Matching)
        .placement_per_batch(placement)
        .run(&mesh)
        .expect("legal options");
    let makes_vertices = |steps: std::ops::Range<usize>| {
        let mut all = steps.flat_map(|step| sequence.substitutions(step));
        all.any(|&[_, to]| to as usize >= mesh.positions().len())
    };
    let mut start = 0;
    for (index, &end) in sequence.batches().iter().enumerate().take(4) {
        let is_first = sequence.triangles_after(start) > 2_500;
        assert_eq!(makes_vertices(start..end as usize), !is_first, "batch {index}");
        start = end as usize;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn nothing_is_merged_twice_in_a_batch(
        n in 20_u32..1500, seed in 0_u32..1000, place in 0_usize..4, rule in 0_usize..3, kind in 0_usize..3,
    ) {
        let mesh = match kind {
            0 => shapes::rock(n, seed),
            1 => shapes::soup(n / 4 + 4, seed),
            _ => shapes::gravel(n / 20 + 2, seed),
        };
        let independence = [Independence::Ring, Independence::Domain, Independence::Matching][rule];
        let placement = [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal][place];
        assert_matches_once(&mesh, &batched(&mesh, independence, placement));
    }
}
