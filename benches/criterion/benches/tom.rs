//! Extraction of a totally ordered mesh against a plain table gather of as many indices, and cursors over small moves.

#[path = "../../../tests/support/naive.rs"]
mod naive;

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use multires::tom::{Level, TomCursor, TomSteps, TotallyOrderedMesh};

fn extraction(c: &mut Criterion) {
    // 84,000 triangles.
    let mesh = naive::torus(210, 200, false, false);
    let sequence = naive::sequence(&mesh, 200);
    let tom = TotallyOrderedMesh::build(&mesh, &sequence).unwrap().tom;
    let table: Vec<u32> = (0..tom.vertex_count() as u32).rev().collect();
    let mut group = c.benchmark_group("tom");
    let mut out = Vec::new();
    for percent in [100, 50, 25, 10, 5, 1] {
        let resolution = tom.at(Level::Triangles(tom.triangle_count() * percent / 100));
        let count = tom.index_count(resolution);
        println!("{percent} %: {count} indices, {:.2} hops a corner", tom.traversal_overhead(resolution));
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::new("fill", percent), |b| {
            b.iter(|| tom.fill_indices(black_box(resolution), &mut out));
        });
        let indices = &tom.triangles().as_flattened()[..count];
        let mut gathered = vec![0; count];
        group.bench_function(BenchmarkId::new("gather", percent), |b| {
            b.iter(|| {
                for (out, &i) in gathered.iter_mut().zip(black_box(indices)) {
                    *out = table[i as usize];
                }
                black_box(&mut gathered);
            });
        });
    }
    let mut cursor = TomCursor::new(Arc::new(TomSteps::new(tom.clone()).unwrap()));
    for percent in [90, 10] {
        let ends = [percent, percent + 1].map(|p| tom.at(Level::Triangles(tom.triangle_count() * p / 100)));
        group.throughput(Throughput::Elements((ends[1].vertices() - ends[0].vertices()) as u64));
        group.bench_function(BenchmarkId::new("cursor, 1 % to and fro, at", percent), |b| {
            b.iter(|| {
                cursor.seek(ends[0]);
                cursor.seek(ends[1]);
                cursor.take_dirty().len()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30).measurement_time(std::time::Duration::from_secs(2));
    targets = extraction
}
criterion_main!(benches);
