//! Samples a second of `distance`, and what building the hierarchies costs beside them; pixels a second of `render` and of
//! comparing by images; on generated meshes.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use multires::{
    mesh::Mesh,
    quality::{Camera, DistanceOptions, ImageOptions, ReferenceImages, RenderOptions, distance, render},
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

fn distances(criterion: &mut Criterion) {
    let (fine, coarse) = (torus(360, 120), torus(48, 24));
    let mut group = criterion.benchmark_group("distance");
    group.sample_size(10);
    // One sample on the faces of each: what is left is the build, the corners and the edges.
    group.bench_function("86k and 2k triangles, 1 sample", |b| {
        let options = DistanceOptions::default().with_samples(1);
        b.iter(|| distance(black_box(&fine), black_box(&coarse), &options));
    });
    let samples = 200_000;
    // Both directions, and a quarter as many along edges.
    group.throughput(Throughput::Elements(samples * 5 / 2));
    group.bench_function("86k and 2k triangles, 200k samples", |b| {
        let options = DistanceOptions::default().with_samples(samples as usize);
        b.iter(|| distance(black_box(&fine), black_box(&coarse), &options));
    });
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
