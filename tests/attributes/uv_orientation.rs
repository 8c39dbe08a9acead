//! Promise: no collapse turns a triangle over in texture space, wherever merged vertices go and however errors are measured.

use crate::meshes::*;
use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::metric::WithAttributes;
use multires::simplify::oracle::{UvOrientation, default_oracles};
use multires::simplify::{ErrorMeasure, Oracle, Permissive, Placement, Simplifier, Target};
use proptest::prelude::*;

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

/// A rough sheet whose texture is folded in the middle: the right half runs backwards, without a seam.
fn folded(n: u32) -> Mesh {
    let mesh = grid(n, n, |u, v| 0.3 * u * v * (1.0 - v) + 0.01 * ((31.0 * u * v) % 1.0));
    let uv: Vec<[f32; 2]> = mesh.positions().iter().map(|p| [(p[0] - 0.5).abs(), p[1]]).collect();
    mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

#[test]
fn a_fold_stays_a_fold() {
    let mesh = folded(24);
    let mut without = 0;
    for placement in PLACEMENTS {
        for measure in [ErrorMeasure::Measured, ErrorMeasure::Verified] {
            let run = |rule: bool| {
                let mut rules = default_oracles();
                rules.retain(|oracle| rule || oracle.name() != UvOrientation.name());
                let simplifier = Simplifier::new().oracles(rules).placement(placement);
                { simplifier.error_measure(measure).target(Target::Ratio(0.1)) }.run(&mesh).unwrap()
            };
            let sequence = run(true);
            assert!(sequence.report().triangles <= mesh.triangles().len() / 10, "{placement:?}");
            for steps in (0..=30).map(|i| i * sequence.len() / 30) {
                assert_eq!(mirrored(&mesh, &sequence, steps), 0, "{placement:?} {measure:?} after {steps}");
            }
            let sequence = run(false);
            without += mirrored(&mesh, &sequence, sequence.len());
        }
    }
    assert!(without > 0, "without the rule nothing is mirrored either: the shape asks nothing");
}

/// A triangle without an area in texture space has no side to keep: a mesh whose coordinates are all the same is
/// simplified as if it had none.
#[test]
fn flat_textures_forbid_nothing() {
    let plain = grid(12, 12, |u, v| 0.2 * u * v);
    let uv = vec![[0.25f32, 0.5]; plain.positions().len()];
    let flat = plain.clone().with_attribute(Attribute::floats(names::UV, &uv)).unwrap();
    let run = |mesh: &Mesh| Simplifier::new().run(mesh).unwrap();
    let (a, b) = (run(&plain), run(&flat));
    assert_eq!(a.len(), b.len());
    assert!((0..a.len()).all(|step| a.substitutions(step) == b.substitutions(step)));
}

/// The second set of coordinates counts as the first does.
#[test]
fn every_set_counts() {
    let folded = folded(16);
    let uv1 = Attribute::new("uv1", 2, folded.attribute(names::UV).unwrap().values().clone());
    let flat: Vec<[f32; 2]> = folded.positions().iter().map(|p| [p[0], p[1]]).collect();
    let mesh = Mesh::new(folded.positions(), folded.triangles()).unwrap();
    let mesh = mesh.with_attribute(Attribute::floats(names::UV, &flat)).unwrap();
    let mesh = mesh.with_attribute(uv1.clone()).unwrap();
    for placement in PLACEMENTS {
        let sequence =
            { Simplifier::new().placement(placement).target(Target::Ratio(0.1)) }.run(&mesh).unwrap();
        // The second set as the first, to be looked at.
        let first = Attribute::new(names::UV, 2, uv1.values().clone());
        let swapped = Mesh::new(mesh.positions(), mesh.triangles()).unwrap().with_attribute(first).unwrap();
        assert_eq!(mirrored(&swapped, &sequence, sequence.len()), 0, "{placement:?}");
        assert_eq!(mirrored(&mesh, &sequence, sequence.len()), 0, "{placement:?}");
    }
}

/// Charts by chance, each placed and turned in the texture by chance.
fn charted(mesh: &Mesh, seed: u32) -> Mesh {
    let chart = |t: usize| {
        let block = (t as u32 / 10).wrapping_mul(2_654_435_761) ^ seed;
        ((block ^ block >> 13).wrapping_mul(0x85eb_ca6b) >> 29) % 5
    };
    let count = mesh.positions().len() as u32;
    let positions: Vec<[f32; 3]> = (0..5).flat_map(|_| mesh.positions().iter().copied()).collect();
    let triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().enumerate().map(|(t, c)| c.map(|v| v + chart(t) * count)).collect();
    let uv: Vec<[f32; 2]> = (0..5 * count)
        .map(|v| {
            let [x, y, z] = positions[v as usize];
            match v / count {
                0 => [x, y],
                1 => [3.0 - x, y],
                2 => [y + z, x],
                3 => [x + z, 5.0 - y],
                _ => [x * y, z - 7.0],
            }
        })
        .collect();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_charts_are_never_mirrored(
        seed in any::<u32>(), placement in 0usize..4, gives in 0usize..3, weighted in any::<bool>(),
        verified in any::<bool>(),
    ) {
        let mesh = charted(&torus(14, 10), seed);
        let permissive = [Permissive::Off, Permissive::Auto, Permissive::On][gives];
        let simplifier = Simplifier::new().placement(PLACEMENTS[placement]).permissive(permissive);
        let measure = if verified { ErrorMeasure::Verified } else { ErrorMeasure::Measured };
        let mut simplifier = simplifier.error_measure(measure).target(Target::Ratio(0.05));
        let sequence = if weighted {
            simplifier.metric(WithAttributes::new(&mesh)).run(&mesh).unwrap()
        } else {
            simplifier.run(&mesh).unwrap()
        };
        for steps in (0..=20).map(|i| i * sequence.len() / 20) {
            prop_assert_eq!(mirrored(&mesh, &sequence, steps), 0, "after {} steps", steps);
        }
        let point = points(&mesh, &sequence);
        let level = level(&mesh, &sequence, &point, sequence.len());
        // Where the topology gives, edges may meet; what is closed stays closed.
        prop_assert!(edges(&level.points).values().all(|&count| count % 2 == 0));
    }
}
