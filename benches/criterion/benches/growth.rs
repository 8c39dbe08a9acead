//! How time grows when an input doubles: many triangles around one vertex or one edge, many parts, seams everywhere. Prints the times
//! of both sizes and their ratio; 2 is linear. `cargo bench -p multires-benches --bench growth`.

use std::time::{Duration, Instant};

use multires::mesh::{Attribute, Mesh, names, shapes};
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
    let cases: [Case; 7] = [
        ("hub, simplified", shapes::hub, simplify, 16_000),
        ("hub with seams, simplified", |n| torn(&shapes::hub(n)), simplify, 16_000),
        ("spindle, simplified", shapes::spindle, simplify, 16_000),
        ("book, simplified", shapes::book, simplify, 8_000),
        ("book with seams, simplified", |n| torn(&shapes::book(n)), simplify, 8_000),
        ("lone triangles, simplified", |n| torn(&shapes::plane(n.isqrt())), simplify, 16_000),
        ("strip of seams, one face split", strip, split_one, 40_000),
    ];
    println!("{:<32}{:>9}{:>11}{:>11}{:>7}", "", "n", "ms at n", "at 2 n", "ratio");
    for (name, shape, work, n) in cases {
        let [once, twice] = [n, 2 * n].map(|n| 1e3 * time(work, &shape(n)).as_secs_f64());
        println!("{name:<32}{n:>9}{once:>11.1}{twice:>11.1}{:>7.2}", twice / once);
    }
}
