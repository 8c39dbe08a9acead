//! Building every level of a mesh: by error measure, and how the cost grows with the mesh.
//!
//! `MULTIRES_BIG=1` adds terrains of 1 and 4 million triangles.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use multires::mesh::shapes;
use multires::simplify::{ErrorMeasure, Simplifier};

fn measures(criterion: &mut Criterion) {
    let mesh = shapes::demo();
    let mut group = criterion.benchmark_group("demo model");
    group.sample_size(10).measurement_time(Duration::from_secs(3));
    group.throughput(Throughput::Elements(mesh.triangles().len() as u64));
    for measure in [ErrorMeasure::Parametric, ErrorMeasure::Measured, ErrorMeasure::Verified] {
        group.bench_function(format!("{measure:?}"), |bencher| {
            bencher.iter(|| black_box(Simplifier::new().error_measure(measure).run(&mesh)));
        });
    }
    group.finish();
}

fn growth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("terrain");
    group.sample_size(10).measurement_time(Duration::from_secs(3));
    let big = std::env::var_os("MULTIRES_BIG").is_some();
    for size in [72, 225, 708, 1415].into_iter().take(if big { 4 } else { 2 }) {
        let mesh = shapes::terrain(size, 1);
        let triangles = mesh.triangles().len();
        group.throughput(Throughput::Elements(triangles as u64));
        group.bench_with_input(BenchmarkId::from_parameter(triangles), &mesh, |bencher, mesh| {
            bencher.iter(|| black_box(Simplifier::new().run(mesh)));
        });
    }
    group.finish();
}

criterion_group!(benches, measures, growth);
criterion_main!(benches);
