//! A step of the controllers for 1,000 and for 100,000 objects, on one thread; and frames of a terrain within 50,000 triangles: by
//! factors of tolerances, by the limit of the instance, without a budget, and under a budget that is not needed.

use std::hint::black_box;
use std::time::Instant;

use criterion::measurement::WallTime;
use criterion::{
    BatchSize, BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use multires::control::{
    Bias, BiasOptions, Budget, BudgetOptions, Ladder, LadderObject, SceneBudget, SceneObject, SceneOptions,
    StairObject, Stairs,
};
use multires::lod::{Lod, LodOptions, Structure, VertexBuffer};
use multires::mesh::shapes;
use multires::view::{ObjectView, View, look_at};
use multires::{Gmesh, TotallyOrderedMesh, VertexHierarchy};

const LEVELS: [usize; 7] = [10_000, 5_200, 2_700, 1_400, 730, 380, 200];
const SIZES: [usize; 2] = [1_000, 100_000];

/// Distances from 0 to 1 that look random, and swell a little from frame to frame.
fn distances(count: usize, frame: usize) -> Vec<f32> {
    let swell = 1.0 + 0.01 * (frame as f32 * 0.3).sin();
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1_u64 << 24) as f32
    };
    (0..count).map(|_| next() * swell).collect()
}

fn steps(c: &mut Criterion) {
    let stairs: Vec<_> = LEVELS.iter().zip(0..).map(|(&n, i)| (i as f32 / 6.0, n)).collect();
    let stairs = Stairs::new(&stairs).unwrap();
    let ladder: Vec<_> = LEVELS.iter().map(|&n| (n, 1.0 / n as f32)).collect();
    let ladder = Ladder::new(&ladder).unwrap();
    let mut group = c.benchmark_group("control");
    for count in SIZES {
        group.throughput(Throughput::Elements(count as u64));
        let frames: Vec<Vec<f32>> = (0..20).map(|frame| distances(count, frame)).collect();
        for (name, change) in [("bias, 0.01", Some(0.01)), ("bias, free", None)] {
            let options = BiasOptions::default()
                .with_triangles(1_500 * count)
                .with_tolerance(5_000)
                .with_change(change);
            let mut bias = Bias::new(options).unwrap();
            let scenes: Vec<Vec<_>> =
                frames.iter().map(|f| f.iter().map(|&t| StairObject::new(&stairs, t)).collect()).collect();
            let mut frame = 0;
            group.bench_function(BenchmarkId::new(name, count), |b| {
                b.iter(|| {
                    frame += 1;
                    black_box(bias.update(&scenes[frame % scenes.len()], false))
                });
            });
        }
        let scenes: Vec<Vec<_>> = frames
            .iter()
            .map(|f| f.iter().map(|&t| LadderObject::new(&ladder, 1.0 / (0.05 + t))).collect())
            .collect();
        let options = BudgetOptions::default().with_triangles(1_500 * count);
        let mut budget = Budget::new(options).unwrap();
        let mut frame = 0;
        group.bench_function(BenchmarkId::new("budget", count), |b| {
            b.iter(|| {
                frame += 1;
                black_box(budget.split(&scenes[frame % scenes.len()]))
            });
        });
        group.bench_function(BenchmarkId::new("budget, first frame", count), |b| {
            b.iter_batched_ref(
                || {
                    budget.forget();
                    budget.clone()
                },
                |budget| black_box(budget.split(&scenes[0])),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

/// Views along a flight low over the terrain, and up again.
fn flight(frames: usize) -> Vec<[ObjectView; 1]> {
    let view = |frame: usize| {
        let along = frame as f32 / frames as f32;
        let height = 0.35 + 0.2 * (along * 12.0).cos();
        let eye = [1.2 * along - 0.6, height, 0.6 - 0.3 * along];
        let matrix = look_at(eye, [0.3 * along, 0.0, -0.2], [0.0, 1.0, 0.0]);
        [View::perspective(matrix, 1.0, [1920, 1080]).unwrap().with_tolerance_px(0.3).of_world()]
    };
    (0..frames).map(view).collect()
}

/// Flights of which every frame's least time counts.
const FLIGHTS: usize = 5;

fn terrain(_: &mut Criterion) {
    let mesh = shapes::terrain(513, 1);
    let model = VertexHierarchy::bake(&mesh).unwrap();
    let values = model.arrange(mesh.positions()).unwrap();
    let views = flight(300);
    let ways = ["without a budget", "by factors", "by factors, not needed", "by the limit of the instance"];
    let mut times = ways.map(|_| vec![f64::INFINITY; views.len()]);
    let mut counts = ways.map(|_| [0; 3]);
    // All flights of a way do the same: of every frame the least counts, or interruptions would be the worst frames. Ways take turns,
    // so that a slow minute is a slow minute of all.
    for _ in 0..FLIGHTS {
        for ((way, times), counts) in ways.iter().zip(&mut times).zip(&mut counts) {
            let mut options = LodOptions::default();
            if *way == "by the limit of the instance" {
                options = options.with_triangles(50_000);
            }
            let triangles = if *way == "by factors, not needed" { 1_000_000 } else { 50_000 };
            let [drawn, most, rounds] = counts;
            (*drawn, *most, *rounds) = (0, 0, 0);
            let mut lod = model.instance(values.clone(), &options).unwrap();
            let mut budget = SceneBudget::new(SceneOptions::default().with_triangles(triangles)).unwrap();
            for (views, time) in views.iter().zip(times) {
                let start = Instant::now();
                let triangles = if way.starts_with("by factors") {
                    let report = budget.adapt(&mut [SceneObject::new(&mut lod, views)], 1.0 / 60.0);
                    *rounds += report.rounds;
                    report.triangles
                } else {
                    lod.adapt(views, 1.0 / 60.0).triangles
                };
                *time = time.min(start.elapsed().as_secs_f64() * 1e3);
                lod.clean();
                *drawn += triangles;
                *most = (*most).max(triangles);
            }
        }
    }
    for ((way, times), [drawn, most, rounds]) in ways.iter().zip(&mut times).zip(counts) {
        // The first frame comes from the coarsest mesh.
        let times = &mut times[1..];
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        times.sort_unstable_by(f64::total_cmp);
        println!(
            "terrain {way}: {mean:.2} ms a frame, 99 % {:.2}, worst {:.2}; {} triangles, at most {most}; {rounds} rounds",
            times[times.len() * 99 / 100],
            times[times.len() - 1],
            drawn / views.len(),
        );
    }
}

/// A frame of 1,000 instances of one model: level and slices, no upload.
fn instances(c: &mut Criterion) {
    let rock = shapes::rock(10_000, 5);
    // 10 seconds away from an object.
    let views: Vec<ObjectView> = (0..600)
        .map(|frame| {
            let eye = [0.0, 0.2, 2.0 + 0.02 * frame as f32];
            let view = View::perspective(look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]), 1.0, [1920, 1080]).unwrap();
            view.with_tolerance_px(1.0).of_world()
        })
        .collect();
    let shared = LodOptions::default().with_buffer(VertexBuffer::Shared);
    let mut group = c.benchmark_group("1,000 instances");
    fn fly<L: Lod>(
        group: &mut BenchmarkGroup<'_, WallTime>,
        name: &str,
        mut lods: Vec<L>,
        views: &[ObjectView],
    ) {
        let mut frame = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                frame += 1;
                let mut triangles = 0;
                for (i, lod) in lods.iter_mut().enumerate() {
                    // Each has its own way, forth and back.
                    let at = (frame + 97 * i) % (2 * views.len());
                    let view = &views[at.min(2 * views.len() - 1 - at)];
                    lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
                    triangles += lod.draws().map(|draw| draw.indices.len()).sum::<usize>();
                    lod.clean();
                }
                black_box(triangles)
            });
        });
    }
    let gmesh = Gmesh::bake(&rock).unwrap();
    let values = gmesh.arrange(rock.positions()).unwrap();
    fly(
        &mut group,
        "g-mesh",
        (0..1_000).map(|_| gmesh.instance(values.clone(), &shared).unwrap()).collect(),
        &views,
    );
    let tom = TotallyOrderedMesh::bake(&rock).unwrap();
    let values = tom.arrange(rock.positions()).unwrap();
    fly(
        &mut group,
        "tom",
        (0..1_000).map(|_| tom.instance(values.clone(), &shared).unwrap()).collect(),
        &views,
    );
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(2));
    targets = steps, terrain, instances
}
criterion_main!(benches);
