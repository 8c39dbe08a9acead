//! Promise: of game models a twentieth is reached, seams giving where they must, and the attributes left are valid.
//!
//! The models lie in `$MULTIRES_MODELS`, `../shared/models` by default; what is missing is skipped by name.
#![cfg(feature = "io")]

use crate::meshes::{dot, mirrored, rows};
use multires::mesh::{Mesh, names};
use multires::simplify::{ErrorMeasure, Permissive, Placement, Simplifier, StopReason, Target};

const MODELS: [&str; 2] =
    ["game/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf", "game/FlightHelmet/FlightHelmet.gltf"];

fn model(file: &str) -> Option<Mesh> {
    crate::models::read("simplify/permissive_models", file)
}

/// Normals are unit vectors where those of the input are, and skin weights sum to 1 where the input's do.
fn assert_valid(name: &str, mesh: &Mesh, level: &Mesh) {
    let floats = |mesh: &Mesh, name: &str| Some(mesh.attribute(name)?.as_floats()?.to_vec());
    let worst = |mesh: &Mesh| {
        let normals: Vec<[f32; 3]> = rows(&floats(mesh, names::NORMAL).unwrap_or_default());
        let length = |n: &[f32; 3]| dot(n.map(f64::from), n.map(f64::from)).sqrt();
        let off = normals.iter().map(|n| (length(n) - 1.0).abs()).fold(0.0, f64::max);
        let weights: Vec<[f32; 4]> = rows(&floats(mesh, names::WEIGHTS).unwrap_or_default());
        let sum = |w: &[f32; 4]| (w.iter().map(|&w| f64::from(w)).sum::<f64>() - 1.0).abs();
        [off, weights.iter().map(sum).fold(0.0, f64::max)]
    };
    for (before, after) in worst(mesh).into_iter().zip(worst(level)) {
        assert!(after <= before.max(1e-4), "{name}: off by {after}, {before} in the input");
    }
}

#[test]
fn a_twentieth_is_reached_with_valid_attributes() {
    for name in MODELS {
        let Some(mesh) = model(name) else { continue };
        for (placement, measure) in [
            (Placement::Endpoint, ErrorMeasure::Measured),
            (Placement::Endpoint, ErrorMeasure::Verified),
            (Placement::Optimal, ErrorMeasure::Measured),
        ] {
            for permissive in [Permissive::Auto, Permissive::On] {
                let simplifier = Simplifier::new().placement(placement).error_measure(measure);
                let sequence =
                    { simplifier.permissive(permissive).target(Target::Ratio(0.05)) }.run(&mesh).unwrap();
                let what = format!("{name}, {placement:?}, {measure:?}, {permissive:?}");
                assert_eq!(sequence.report().stop, StopReason::Target, "{what}");
                assert_valid(&what, &mesh, &sequence.extract(&mesh, sequence.len()));
                if mesh.attribute(names::UV).is_some() {
                    for steps in [sequence.len() / 2, sequence.len()] {
                        assert_eq!(mirrored(&mesh, &sequence, steps), 0, "{what}");
                    }
                }
            }
        }
    }
}
