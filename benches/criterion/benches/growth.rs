//! How time grows when an input doubles: many triangles around one vertex or one edge, many parts, seams everywhere. Prints the times
//! of both sizes and their ratio; 2 is linear. `cargo bench -p multires-benches --bench growth`.

use std::time::{Duration, Instant};

use multires::hierarchy::{Dependencies, VertexHierarchy};
use multires::mesh::{Attribute, Mesh, names, shapes};
use multires::quality::{DistanceOptions, distance};
use multires::simplify::{Simplifier, Target};
use multires::wavelet::WaveletBuilder;

/// Runs of each size; the least time counts.
const RUNS: usize = 3;

/// Every triangle with vertices and values of its own.
fn torn(mesh: &Mesh) -> Mesh {
    let corners = mesh.triangles().as_flattened();
    let positions: Vec<[f32; 3]> = corners.iter().map(|&v| mesh.positions()[v as usize]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let values: Vec<[f32; 2]> = (0..corners.len()).map(|corner| [corner as f32, 0.5]).collect();
    Mesh::new(positions, triangles)
        .and_then(|mesh| mesh.with_attribute(Attribute::floats(names::UV, &values)))
        .expect("a mesh of finite numbers")
}

/// A strip of triangles, seams between all.
fn strip(triangles: u32) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..triangles + 2).map(|v| [v as f32, (v % 2) as f32, 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (0..triangles).map(|t| [t, t + 1 + t % 2, t + 2 - t % 2]).collect();
    torn(&Mesh::new(positions, triangles).expect("a strip"))
}

/// A strip of triangles without area along a straight line.
fn line(triangles: u32) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..triangles + 2).map(|v| [v as f32, 0.0, 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (0..triangles).map(|t| [t, t + 1, t + 2]).collect();
    Mesh::new(positions, triangles).expect("a line")
}

/// A strip along a spiral, each triangle larger than the one before: in all by a factor of e^60.
fn comb(triangles: u32) -> Mesh {
    let count = triangles + 2;
    let place = |i: u32| {
        let (along, across) = (f64::from(i / 2), f64::from(i % 2));
        let (angle, radius) = (0.05 * along, 1.0 + 0.002 * along + 0.1 * across);
        let scale = (60.0 * f64::from(i) / f64::from(count)).exp();
        [radius * angle.cos(), radius * angle.sin(), 0.0005 * f64::from(i)].map(|x| (x * scale) as f32)
    };
    let triangles: Vec<[u32; 3]> = (0..triangles).map(|t| [t, t + 1 + t % 2, t + 2 - t % 2]).collect();
    Mesh::new((0..count).map(place).collect::<Vec<_>>(), triangles).expect("a strip")
}

/// Triangles around a point, with no edge in common.
fn stars(triangles: u32) -> Mesh {
    let place = |i: u32| {
        let angle = f64::from(i) * std::f64::consts::PI / f64::from(triangles);
        [angle.cos() as f32, angle.sin() as f32, 0.1 * (i % 7) as f32]
    };
    let positions: Vec<[f32; 3]> = std::iter::once([0.0; 3]).chain((0..2 * triangles).map(place)).collect();
    let triangles: Vec<[u32; 3]> = (0..triangles).map(|t| [0, 1 + 2 * t, 2 + 2 * t]).collect();
    Mesh::new(positions, triangles).expect("a mesh of finite numbers")
}

/// Radii and heights at random.
fn rough(mesh: &Mesh) -> Mesh {
    let shares = (0u32..).map(|i| i.wrapping_mul(2_654_435_769) as f32 / u32::MAX as f32);
    let positions: Vec<[f32; 3]> = mesh
        .positions()
        .iter()
        .zip(shares)
        .map(|(&[x, y, z], share)| [x * (1.0 + 0.3 * share), y * (1.0 + 0.3 * share), z + 0.3 * share])
        .collect();
    Mesh::new(positions, mesh.triangles()).expect("a mesh of finite numbers")
}

fn bake(mesh: &Mesh) {
    let sequence = Simplifier::new().run(mesh).expect("simplified");
    VertexHierarchy::build(mesh, &sequence, Dependencies::None).expect("a hierarchy");
}

/// Measures the distance from a shrunk copy.
fn measure(mesh: &Mesh) {
    let shrunk: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.map(|x| 0.99 * x)).collect();
    let shrunk = Mesh::new(shrunk, mesh.triangles()).expect("a mesh of finite numbers");
    distance(mesh, &shrunk, &DistanceOptions::default().with_samples(50_000)).expect("surfaces");
}

/// Any two parts may be joined.
fn join(mesh: &Mesh) {
    let far = 10.0 * mesh.diagonal() as f32;
    Simplifier::new().join_distance(far).target(Target::Ratio(0.1)).run(mesh).expect("simplified");
}

fn simplify(mesh: &Mesh) {
    Simplifier::new().target(Target::Ratio(0.1)).run(mesh).expect("simplified");
}

/// Splits one face, which takes all others along.
fn split_one(mesh: &Mesh) {
    let mut builder = WaveletBuilder::new(mesh).expect("a base");
    builder.subdivide_where(|face| face.base_face == 0, |midpoint| midpoint.middle).expect("subdivided");
}

fn time(work: fn(&Mesh), mesh: &Mesh) -> Duration {
    let run = |_| {
        let start = Instant::now();
        work(mesh);
        start.elapsed()
    };
    (0..RUNS).map(run).min().unwrap_or_default()
}

fn main() {
    type Case = (&'static str, fn(u32) -> Mesh, fn(&Mesh), u32);
    let cases: [Case; 19] = [
        ("hub, simplified", shapes::hub, simplify, 16_000),
        ("hub with seams, simplified", |n| torn(&shapes::hub(n)), simplify, 16_000),
        ("spindle, simplified", shapes::spindle, simplify, 16_000),
        ("book, simplified", shapes::book, simplify, 8_000),
        ("book with seams, simplified", |n| torn(&shapes::book(n)), simplify, 8_000),
        ("lone triangles, simplified", |n| torn(&shapes::plane(n.isqrt())), simplify, 16_000),
        ("lone triangles, joined", |n| torn(&shapes::plane(n.isqrt())), join, 8_000),
        ("fans at a point, simplified", stars, simplify, 16_000),
        ("growing strip, simplified", comb, simplify, 2_000),
        ("rough hub, simplified", |n| rough(&shapes::hub(n)), simplify, 8_000),
        ("line, simplified", line, simplify, 16_000),
        ("hub, hierarchy", shapes::hub, bake, 16_000),
        ("lone triangles, hierarchy", |n| torn(&shapes::plane(n.isqrt())), bake, 16_000),
        ("fans at a point, hierarchy", stars, bake, 16_000),
        ("rough spindle, hierarchy", |n| rough(&shapes::spindle(n)), bake, 20_000),
        ("book, hierarchy", shapes::book, bake, 16_000),
        ("hub, measured", shapes::hub, measure, 8_000),
        ("book, measured", shapes::book, measure, 8_000),
        ("strip of seams, one face split", strip, split_one, 40_000),
    ];
    println!("{:<32}{:>9}{:>11}{:>11}{:>7}", "", "n", "ms at n", "at 2 n", "ratio");
    for (name, shape, work, n) in cases {
        let [once, twice] = [n, 2 * n].map(|n| 1e3 * time(work, &shape(n)).as_secs_f64());
        println!("{name:<32}{n:>9}{once:>11.1}{twice:>11.1}{:>7.2}", twice / once);
    }
}
