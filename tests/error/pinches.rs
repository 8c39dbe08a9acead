//! Promise: triangles that hang by one corner may shrink into it where the topology gives, and what is told counts them.
#![cfg(feature = "quality")]

use multires::mesh::Mesh;
use multires::quality::vertex_distances;
use multires::simplify::{ErrorMeasure, Guard, Permissive, Placement, Simplifier, Target};
use proptest::prelude::*;

/// Two flat fans joined at one corner, of so many triangles and so large.
fn fans_at_a_corner(triangles: [usize; 2], radii: [f32; 2]) -> Mesh {
    let (mut positions, mut corners) = (vec![[0.0; 3]], Vec::new());
    for (side, (&count, &radius)) in [1.0_f32, -1.0].iter().zip(triangles.iter().zip(&radii)) {
        let first = positions.len() as u32;
        for i in 0..=count {
            // From -45 to 45 degrees.
            let angle = std::f32::consts::FRAC_PI_2 * (i as f32 / count as f32 - 0.5);
            positions.push([side * radius * angle.cos(), radius * angle.sin(), 0.1 * (i % 2) as f32]);
        }
        corners.extend((0..count as u32).map(|i| [0, first + i, first + i + 1]));
    }
    Mesh::new(positions, corners).unwrap()
}

proptest! {
    #[test]
    fn what_shrinks_into_a_corner_is_told(
        triangles in [1..5_usize, 1..5],
        radii in [0.05..2.0_f32, 0.05..2.0],
        measure in prop::sample::select(vec![ErrorMeasure::Measured, ErrorMeasure::Parametric, ErrorMeasure::Verified]),
        placement in prop::sample::select(vec![Placement::Endpoint, Placement::Optimal, Placement::Midpoint]),
    ) {
        let mesh = fans_at_a_corner(triangles, radii);
        let simplifier = Simplifier::new().permissive(Permissive::On).guard(Guard::Off).placement(placement);
        let sequence = simplifier.error_measure(measure).target(Target::Triangles(1)).run(&mesh).unwrap();
        prop_assert_eq!(sequence.report().triangles, 1, "{:?}", sequence.report());
        for steps in 0..=sequence.len() {
            let level = sequence.extract(&mesh, steps);
            let farthest = vertex_distances(&mesh, &level).unwrap().into_iter().fold(0.0, f64::max);
            let told = f64::from(sequence.error_after(steps));
            prop_assert!(farthest <= told * 1.001 + 1e-5, "{} after {} is told {}", farthest, steps, told);
        }
    }
}
