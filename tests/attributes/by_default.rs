//! Promise: attributes count unless they are told not to: with every metric and every placement, normals, texture
//! coordinates and colours steer the collapses, and what has no attributes is simplified as if there were none.

use crate::meshes::*;
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::simplify::metric::{NAMES, by_name};
use multires::simplify::{AttributeWeights, CollapseSequence, OptionError, Placement, Simplifier};

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

/// A flat square of 2 x `n` x `n` triangles with one attribute.
fn painted<const N: usize>(n: u32, name: &str, value: impl Fn(f32, f32) -> [f32; N]) -> Mesh {
    let mesh = grid(n, n, |_, _| 0.0);
    let values: Vec<[f32; N]> = mesh.positions().iter().map(|p| value(p[0], p[1])).collect();
    mesh.with_attribute(Attribute::floats(name, &values)).unwrap()
}

/// Black inside of a disc, white outside.
fn colour_edge(n: u32) -> Mesh {
    painted(n, names::COLOR, |u, v| {
        let inside = (u - 0.5).powi(2) + (v - 0.5).powi(2) < 0.09;
        if inside { [0.0, 0.0, 0.0] } else { [1.0, 1.0, 1.0] }
    })
}

/// The texture runs to the middle and back again.
fn mirrored(n: u32) -> Mesh {
    painted(n, names::UV, |u, v| [if u < 0.5 { u } else { 1.0 - u }, v])
}

/// Normals lean over in a stripe.
fn stripe(n: u32) -> Mesh {
    painted(n, names::NORMAL, |u, _| if (u - 0.5).abs() < 0.13 { [0.6, 0.0, 0.8] } else { [0.0, 0.0, 1.0] })
}

/// Mean difference of an attribute between the vertices of a flat mesh and a level, looked up in the plane.
fn off(mesh: &Mesh, level: &Mesh, name: &str) -> f64 {
    let values = |m: &Mesh| {
        let attribute = m.attribute(name).unwrap();
        let width = attribute.width();
        attribute.as_floats().unwrap().chunks(width).map(<[f32]>::to_vec).collect::<Vec<_>>()
    };
    let (fine, coarse) = (values(mesh), values(level));
    let mut sum = 0.0;
    for (p, own) in mesh.positions().iter().zip(&fine) {
        let inside = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| level.positions()[v as usize]);
            let area = |a, b, c| normal([a, b, c])[2];
            let whole = area(a, b, c);
            [area(*p, b, c) / whole, area(a, *p, c) / whole, area(a, b, *p) / whole]
        };
        let least = |w: &[f64; 3]| w.iter().copied().fold(f64::INFINITY, f64::min);
        let places = level.triangles().iter().map(|t| (t, inside(t)));
        let (t, w) = places.max_by(|a, b| least(&a.1).total_cmp(&least(&b.1))).unwrap();
        let there = |i: usize| (0..3).map(|k| w[k] * f64::from(coarse[t[k] as usize][i])).sum::<f64>();
        sum += own.iter().enumerate().map(|(i, &x)| (there(i) - f64::from(x)).abs()).fold(0.0, f64::max);
    }
    sum / fine.len() as f64
}

fn at(sequence: &CollapseSequence, mesh: &Mesh, share: usize) -> Mesh {
    sequence.extract(mesh, sequence.steps_for_triangles(mesh.triangles().len() / share))
}

#[test]
fn edges_of_colour_mirrors_and_stripes_stay() {
    for (mesh, name) in
        [(colour_edge(32), names::COLOR), (mirrored(32), names::UV), (stripe(32), names::NORMAL)]
    {
        for placement in PLACEMENTS {
            let run = |simplifier: Simplifier| {
                let sequence = simplifier.placement(placement).run(&mesh).unwrap();
                off(&mesh, &at(&sequence, &mesh, 8), name)
            };
            let on = run(Simplifier::new());
            let blind = run(Simplifier::new().attributes(AttributeWeights::Off));
            // Mirrored coordinates are exact either way where no triangle may turn over: rounding then tells nothing.
            assert!(
                on < 0.5 * blind || on.max(blind) < 1e-9,
                "{name}: {on} with, {blind} without, {placement:?}"
            );
        }
    }
}

#[test]
fn a_mirrored_texture_is_exact_where_the_mirror_lies() {
    let mesh = mirrored(16);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    assert!(off(&mesh, &at(&sequence, &mesh, 8), names::UV) < 1e-6);
}

/// Every metric brings an exchange rate of its own: none is blind, and none is for nothing but attributes.
#[test]
fn every_metric_takes_them_with_every_placement() {
    let bumpy = |u: f32, v: f32| 0.1 * (1.0 - (2.0 * u - 1.0).powi(2)) * (1.0 - (2.0 * v - 1.0).powi(2));
    let shape = grid(24, 24, bumpy);
    let edge = |p: &[f32; 3]| if p[0] + 0.3 * p[1] < 0.6 { [0.0, 0.2, 0.0] } else { [1.0, 0.8, 1.0] };
    let colours: Vec<[f32; 3]> = shape.positions().iter().map(edge).collect();
    let mesh = shape.with_attribute(Attribute::floats(names::COLOR, &colours)).unwrap();
    for name in NAMES {
        for placement in PLACEMENTS {
            let run = |weights: AttributeWeights| {
                let simplifier = Simplifier::new().metric(by_name(name).unwrap()).placement(placement);
                let sequence = simplifier.attributes(weights).run(&mesh).unwrap();
                let level = at(&sequence, &mesh, 8);
                assert!(level.triangles().len() <= mesh.triangles().len() / 8, "{name}, {placement:?}");
                (off(&mesh, &level, names::COLOR), sequence.error_after(sequence.steps_for_triangles(144)))
            };
            let ((on, error), (blind, plain)) =
                (run(AttributeWeights::Customary), run(AttributeWeights::Off));
            assert!(on < 0.8 * blind, "{name}, {placement:?}: {on} with, {blind} without");
            // A colour that is fully off is worth a hundredth of the diagonal: the shape may give in by a few of these,
            // with metrics that look at it.
            let sees = name != "edge-length";
            assert!(
                !sees || error < plain + 0.05,
                "{name}, {placement:?}: shape off by {error}, was {plain}"
            );
        }
    }
}

#[test]
fn nothing_changes_where_there_is_nothing_to_count() {
    let mesh = shapes::rock(2000, 3);
    let bare = Mesh::new(mesh.positions(), mesh.triangles()).unwrap();
    for name in NAMES {
        let run = |weights| {
            Simplifier::new().metric(by_name(name).unwrap()).attributes(weights).run(&bare).unwrap()
        };
        assert_eq!(run(AttributeWeights::Customary), run(AttributeWeights::Off));
    }
}

#[test]
fn chosen_weights_are_checked() {
    let mesh = colour_edge(4);
    let run = |list: &[(&str, f32)]| {
        let list = list.iter().map(|&(name, weight)| (name.to_owned(), weight)).collect();
        Simplifier::new().attributes(AttributeWeights::Chosen(list)).run(&mesh)
    };
    assert!(run(&[(names::COLOR, 0.1)]).is_ok());
    assert!(run(&[]).is_ok());
    assert!(matches!(run(&[("tint", 0.1)]), Err(OptionError::NoAttribute { name }) if name == "tint"));
    assert!(matches!(run(&[(names::COLOR, -1.0)]), Err(OptionError::OutOfRange { .. })));
    assert!(matches!(run(&[(names::COLOR, f32::NAN)]), Err(OptionError::OutOfRange { .. })));
}
