//! Frames along a path past the demo: a vertex hierarchy follows the view, for every policy; and the coarsest and finest cuts to and
//! fro.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use multires::hierarchy::{Dependencies, HierarchyLod, VertexHierarchy};
use multires::lod::Lod;
use multires::mesh::{Mesh, shapes};
use multires::simplify::Simplifier;
use multires::view::{ObjectView, View};

/// Views from an eye that circles the mesh once in so many frames while it comes near and goes away again.
fn path(mesh: &Mesh, frames: usize) -> Vec<ObjectView> {
    let ([low, high], diagonal) = (mesh.bounds().unwrap_or_default(), mesh.diagonal());
    let middle: [f64; 3] = std::array::from_fn(|i| (f64::from(low[i]) + f64::from(high[i])) * 0.5);
    let view = |frame: usize| {
        let turn = std::f64::consts::TAU * frame as f64 / frames as f64;
        let (sine, cosine) = turn.sin_cos();
        let distance = diagonal * (0.9 + 0.5 * cosine);
        // The eye looks at the middle along -z, turned about y.
        let rows = [[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]];
        let column = |i: usize| [rows[0][i] as f32, rows[1][i] as f32, rows[2][i] as f32, 0.0];
        let moved = |row: [f64; 3]| -(0..3).map(|i| row[i] * middle[i]).sum::<f64>() as f32;
        let [x, y, z] = rows.map(moved);
        let matrix = [column(0), column(1), column(2), [x, y, z - distance as f32, 1.0]];
        View::perspective(matrix, 60_f32.to_radians(), [1920, 1080]).map(|view| view.of_world())
    };
    (0..frames).map(view).collect::<Result<_, _>>().unwrap_or_default()
}

fn frames(c: &mut Criterion) {
    let mesh = shapes::demo();
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let path = path(&mesh, 300);
    let mut group = c.benchmark_group("hierarchy");
    let policies = [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours];
    for dependencies in policies {
        let hierarchy = Arc::new(VertexHierarchy::build(&mesh, &sequence, dependencies).unwrap().hierarchy);
        let mut lod = HierarchyLod::new(hierarchy);
        let (mut tests, mut operations, mut drawn) = (0, 0, 0);
        lod.adapt(&path[path.len() - 1..], 1.0 / 60.0);
        for view in &path {
            let change = lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
            tests += change.cut.tests;
            operations += change.cut.splits + change.cut.collapses;
            drawn += change.triangles;
        }
        println!(
            "{dependencies:?}, a frame: {} triangles, {} tests, {} splits and collapses",
            drawn / path.len(),
            tests / path.len(),
            operations / path.len()
        );
        group.throughput(Throughput::Elements(path.len() as u64));
        group.bench_function(BenchmarkId::new("frames", format!("{dependencies:?}")), |b| {
            b.iter(|| {
                for view in &path {
                    black_box(lod.adapt(std::slice::from_ref(view), 1.0 / 60.0));
                    lod.clean();
                }
            });
        });
        // With a view from nearby and with none: all of a cut comes and goes.
        let change = lod.adapt(&path[150..=150], 1.0 / 60.0).triangles;
        println!("{dependencies:?}, nearby: {change} triangles");
        group.throughput(Throughput::Elements(2));
        group.bench_function(BenchmarkId::new("to and fro", format!("{dependencies:?}")), |b| {
            b.iter(|| {
                lod.adapt(&[], 1.0 / 60.0);
                black_box(lod.adapt(&path[150..=150], 1.0 / 60.0));
                lod.clean();
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_secs(3));
    targets = frames
}
criterion_main!(benches);
