//! A terrain as a wavelet mesh, beside the vertex hierarchy of the same terrain on the same path: frames, building, recognising.
//!
//! Throughput of frames is in drawn triangles, so that times a triangle can be compared. 2^9 cells a side; with `MULTIRES_BIG=1`
//! 2^10, two million triangles.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use multires::hierarchy::{HierarchyBuilder, HierarchyLod};
use multires::lod::{Lod, LodOptions, Triangulation, Values, VertexBuffer};
use multires::mesh::{Mesh, shapes};
use multires::view::{ObjectView, View, look_at};
use multires::wavelet::{WaveletLod, WaveletMesh, WaveletOptions, recognise};

/// Views from an eye that circles the terrain once while it comes down and near and goes away again.
fn path(frames: usize) -> Vec<ObjectView> {
    let view = |frame: usize| {
        let turn = std::f32::consts::TAU * frame as f32 / frames as f32;
        let far = 0.9 + 0.6 * turn.cos();
        let eye = [far * turn.sin(), 0.1 + 0.3 * far, far * turn.cos()];
        let matrix = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
        View::perspective(matrix, 60_f32.to_radians(), [1920, 1080]).map(|view| view.of_world())
    };
    (0..frames).map(view).collect::<Result<_, _>>().unwrap_or_default()
}

fn terrain() -> Mesh {
    shapes::terrain(if std::env::var_os("MULTIRES_BIG").is_some() { 1025 } else { 513 }, 1)
}

fn frames(c: &mut Criterion) {
    let mesh = terrain();
    let path = path(400);
    let mut group = c.benchmark_group("wavelet frames");
    let mut fly = |name: &str, lod: &mut dyn Lod| {
        let (mut tests, mut operations, mut drawn) = (0, 0, 0);
        lod.adapt(&path[path.len() - 1..], 1.0 / 60.0);
        for view in &path {
            let change = lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
            tests += change.cut.tests;
            operations += change.cut.splits + change.cut.collapses;
            drawn += change.triangles;
        }
        let frames = path.len();
        println!(
            "{name}: {} triangles, {} tests, {} changes",
            drawn / frames,
            tests / frames,
            operations / frames
        );
        group.throughput(Throughput::Elements(drawn as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                for view in &path {
                    black_box(lod.adapt(std::slice::from_ref(view), 1.0 / 60.0));
                    lod.clean();
                }
            });
        });
    };
    let hierarchy = HierarchyBuilder::new().bake(&mesh).unwrap();
    fly("hierarchy", &mut HierarchyLod::new(Arc::clone(hierarchy.structure())));
    let wavelets = Arc::new(WaveletMesh::recognise(&mesh, &WaveletOptions::default()).unwrap());
    let values = Values::from(wavelets.vertices().positions().to_vec()).with_blending();
    for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
        let drawing =
            LodOptions::default().with_buffer(VertexBuffer::Whole).with_triangulation(triangulation);
        let mut lod = WaveletLod::new(Arc::clone(&wavelets), values.clone(), &drawing).unwrap();
        fly(&format!("{triangulation:?}"), &mut lod);
    }
    group.finish();
}

fn building(c: &mut Criterion) {
    let mesh = terrain();
    let mut group = c.benchmark_group("wavelet building");
    group.throughput(Throughput::Elements(mesh.triangles().len() as u64));
    group.bench_function("recognise", |b| b.iter(|| black_box(recognise(&mesh))));
    let options = WaveletOptions::default();
    group.bench_function("build", |b| b.iter(|| black_box(WaveletMesh::recognise(&mesh, &options))));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_secs(3));
    targets = frames, building
}
criterion_main!(benches);
