//! Samples a second of `distance`, and what preparing the surfaces costs beside them; pixels a second of `render` and of
//! comparing by images.
//!
//! On the bunny and its 5 % level, read from `$MULTIRES_MODELS` (`../shared/models` by default); where it is missing, or
//! without the feature `io`, on the generated demo, and it says so. `RAYON_NUM_THREADS` sets the threads.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use multires::{
    Simplifier,
    mesh::{Mesh, shapes},
    quality::{Camera, DistanceOptions, ImageOptions, ReferenceImages, RenderOptions, Surface, render},
};

/// A bumpy torus of `2 * rings * sides` triangles.
fn torus(rings: u32, sides: u32) -> Mesh {
    let turn = |i: u32, of: u32| i as f32 / of as f32 * std::f32::consts::TAU;
    let positions: Vec<[f32; 3]> = (0..rings * sides)
        .map(|i| {
            let (a, b) = (turn(i / sides, rings), turn(i % sides, sides));
            let tube = 0.4 + 0.03 * (9.0 * a).sin() * (5.0 * b).cos();
            let radius = 1.0 + tube * b.cos();
            [radius * a.cos(), radius * a.sin(), tube * b.sin()]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..rings * sides)
        .flat_map(|i| {
            let (ring, side) = (i / sides, i % sides);
            let at = |r: u32, s: u32| (ring + r) % rings * sides + (side + s) % sides;
            [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
        })
        .collect();
    Mesh::new(positions, triangles).expect("finite, in range")
}

/// The bunny, or the demo where it cannot be had.
fn model() -> (&'static str, Mesh) {
    let root = std::env::var_os("MULTIRES_MODELS").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models"),
        std::path::PathBuf::from,
    );
    let path = root.join("real/stanford-bunny.ply");
    match multires::io::read(&path) {
        Ok(mesh) => return ("bunny", mesh),
        Err(error) => eprintln!("quality: no bunny, the demo instead: {}: {error}", path.display()),
    }
    ("demo", shapes::demo())
}

fn distances(criterion: &mut Criterion) {
    let (name, mesh) = model();
    let sequence = Simplifier::new().run(&mesh).expect("default options");
    let level = sequence.extract(&mesh, sequence.steps_for_triangles(mesh.triangles().len() / 20));
    let (original, coarse) =
        (Surface::new(&mesh).expect("has a surface"), Surface::new(&level).expect("has a surface"));

    let mut group = criterion.benchmark_group(format!("distance of {name} and its 5 %"));
    group.sample_size(10);
    group.bench_function("prepare both surfaces", |b| {
        b.iter(|| (Surface::new(black_box(&mesh)), Surface::new(black_box(&level))));
    });
    let samples = 1_000_000;
    let options = DistanceOptions::default().with_samples(samples);
    let both = original.distance(&coarse, &options).expect("samples in range");
    let taken = [both.forward, both.backward].map(|one| (one.face_samples + one.edge_samples) as u64);
    group.throughput(Throughput::Elements(taken[0] + taken[1]));
    group.bench_function("1M samples each way, and edges and corners", |b| {
        b.iter(|| original.distance(black_box(&coarse), &options));
    });
    group.throughput(Throughput::Elements(taken[0]));
    group.bench_function("from the original", |b| {
        b.iter(|| original.distance_to(black_box(&coarse), &options));
    });
    group.throughput(Throughput::Elements(taken[1]));
    group.bench_function("from the level", |b| b.iter(|| coarse.distance_to(black_box(&original), &options)));
    group.finish();
}

fn pictures(criterion: &mut Criterion) {
    let mesh = torus(360, 120);
    let camera = Camera::framing(&mesh, [0.3, -0.5, -1.0]);
    let mut group = criterion.benchmark_group("render");
    group.sample_size(10);
    group.throughput(Throughput::Elements(256 * 256));
    for (name, rays) in [("256 x 256, no occlusion", 0), ("256 x 256, 4 occlusion rays", 4)] {
        let options = RenderOptions::default().with_size(256, 256).with_occlusion_rays(rays);
        group.bench_function(name, |b| b.iter(|| render(black_box(&mesh), &camera, &options)));
    }
    group.finish();
}

fn images(criterion: &mut Criterion) {
    let (fine, coarse) = (torus(360, 120), torus(48, 24));
    let options = ImageOptions::default();
    let mut group = criterion.benchmark_group("images");
    group.sample_size(10);
    group.throughput(Throughput::Elements((options.views * options.size * options.size) as u64));
    group.bench_function("42 views of 512 x 512 of 86k triangles", |b| {
        b.iter(|| ReferenceImages::new(black_box(&fine), &options));
    });
    if let Ok(reference) = ReferenceImages::new(&fine, &options) {
        group.bench_function("42 views of 512 x 512 of 2k triangles, compared", |b| {
            b.iter(|| reference.difference(black_box(&coarse)));
        });
    }
    group.finish();
}

criterion_group!(benches, distances, pictures, images);
criterion_main!(benches);
