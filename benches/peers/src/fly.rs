//! Flies a path past a mesh, in one run: a cluster hierarchy selected anew every frame, and vertex hierarchies that follow.
//!
//! ```text
//! for each mesh:
//!     build all
//!     one flight that counts: triangles, tests, bytes            <- not timed
//!     the rounds: everybody flies once a round, frame by frame   <- interleaved, thread CPU time
//!     per frame the median of all rounds; of those the median and the 99th percentile
//!     slow paths, and splits and collapses of everything
//! ```

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use multires::adapt::Refinements;
use multires::hierarchy::{Dependencies, HierarchyLod, HierarchyOptions, VertexHierarchy};
use multires::lod::{Baked, Lod};
use multires::mesh::Mesh;
use multires::simplify::metric::LindstromTurk;
use multires::simplify::{CollapseSequence, Placement, Simplifier};
use multires::view::{Answer, Bounds, Criterion, Motion, ObjectView};
use serde_json::{Value, json};

use crate::clock::{cpu_times, timed};
use crate::clod::{ClusterDag, Look};
use crate::fly_options::Options;
use crate::fly_report::{Bulk, Flight, Slow, print_bulk, print_flight, print_slow};
use crate::input::Input;
use crate::path::{self, Pose};
use crate::statistics::{mean, median, percentile_99, sorted};

pub(crate) const VIEWPORT: [u32; 2] = [1920, 1080];
pub(crate) const FIELD_OF_VIEW_DEGREES: f32 = 60.0;

/// Triangles between two changed ones that are copied along.
const GAP: usize = 8;
/// Of how many frames the front is counted in one.
const FRONT_EVERY: usize = 10;

pub(crate) fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let (path_name, path) = flown(options)?;
    let mut all = Vec::new();
    for input in options.inputs()? {
        let value = one(&input, &path, options).map_err(|e| format!("{}: {e}", input.name))?;
        all.push(value);
    }
    if options.json {
        let object = json!({
            "path": path_name,
            "frames": path.len(),
            "tolerance_px": options.tolerance,
            "viewport": VIEWPORT,
            "field_of_view_degrees": FIELD_OF_VIEW_DEGREES,
            "clock": crate::simplify::CLOCK,
            "rounds": options.rounds,
            "meshes": all,
        });
        println!("{object}");
    }
    Ok(())
}

/// The path asked for, one that lies beside the models, or the formula's.
fn flown(options: &Options) -> Result<(String, Vec<Pose>), Box<dyn Error>> {
    let beside = std::env::var_os("MULTIRES_MODELS")
        .map(|models| PathBuf::from(models).join("../paths/approach.csv"))
        .filter(|file| file.is_file());
    match options.path.clone().or(beside) {
        Some(file) => {
            let path = path::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
            Ok((file.display().to_string(), path))
        }
        None => Ok(("approach, by its formula".to_owned(), path::approach())),
    }
}

fn one(input: &Input, path: &[Pose], options: &Options) -> Result<Value, Box<dyn Error>> {
    let mesh = &input.mesh;
    let poses = path::around(mesh, path);
    let views = views(&poses, options.tolerance)?;
    let (dag, dag_ms) = timed(|| ClusterDag::build(mesh));
    let (sequence, sequence_ms) = timed(|| sequence(mesh, options.optimal));
    let sequence = sequence?;
    let mut flyers = vec![Flyer::clusters(dag?, mesh, &poses, options.tolerance, dag_ms[0])];
    for &(name, dependencies) in &options.dependencies {
        flyers.push(Flyer::splits(name, mesh, &sequence, dependencies, sequence_ms[0])?);
    }
    for flyer in &mut flyers {
        flyer.count(&views, &poses);
    }
    for _ in 0..options.rounds {
        flyers.iter_mut().for_each(|flyer| flyer.time(&views));
    }
    let flights: Vec<Flight> = flyers.iter().map(|flyer| flyer.flight(mesh)).collect();
    if !options.json {
        println!("{}, {} triangles", input.name, mesh.triangles().len());
        print_flight(&flights);
    }
    let hierarchies: Vec<_> = flyers
        .iter()
        .filter_map(|flyer| match &flyer.kind {
            Kind::Splits { lod, .. } => Some((flyer.name, lod.hierarchy().clone())),
            Kind::Clusters { .. } => None,
        })
        .collect();
    let (mut slow, mut bulk) = (Vec::new(), Vec::new());
    for (name, hierarchy) in hierarchies {
        if options.still_path {
            slow.extend(slowly(name, &hierarchy, &poses, options.tolerance)?);
        }
        bulk.push(everything(name, hierarchy, options.rounds));
    }
    if !options.json {
        print_slow(&slow);
        print_bulk(&bulk);
    }
    Ok(json!({
        "mesh": input.name,
        "triangles": mesh.triangles().len(),
        "flights": flights.iter().map(Flight::json).collect::<Vec<_>>(),
        "slow": slow.iter().map(Slow::json).collect::<Vec<_>>(),
        "everything": bulk.iter().map(Bulk::json).collect::<Vec<_>>(),
    }))
}

fn sequence(mesh: &Mesh, optimal: bool) -> Result<CollapseSequence, Box<dyn Error>> {
    Ok(if optimal {
        Simplifier::new().metric(LindstromTurk::new()).placement(Placement::Optimal).run(mesh)?
    } else {
        Simplifier::new().run(mesh)?
    })
}

fn views(poses: &[Pose], tolerance: f32) -> Result<Vec<ObjectView>, Box<dyn Error>> {
    let view = |pose: &Pose| {
        pose.view(FIELD_OF_VIEW_DEGREES.to_radians(), VIEWPORT, tolerance).map(|v| v.of_world())
    };
    Ok(poses.iter().map(view).collect::<Result<_, _>>()?)
}

/// Who follows the path, with what was counted and timed.
struct Flyer {
    name: &'static str,
    kind: Kind,
    build_ms: f64,
    /// Per frame.
    drawn: Vec<f64>,
    in_frustum: Vec<f64>,
    tests: Vec<f64>,
    operations: Vec<f64>,
    bytes: Vec<f64>,
    front: Vec<f64>,
    /// Per frame and round: to the cut (or the selection), and copying what is drawn, microseconds.
    times: Vec<Vec<[f64; 2]>>,
}

enum Kind {
    Clusters { dag: ClusterDag, looks: Vec<Look> },
    Splits { lod: Box<HierarchyLod>, positions: Vec<[f32; 3]> },
}

impl Flyer {
    fn new(name: &'static str, kind: Kind, build_ms: f64) -> Self {
        Self {
            name,
            kind,
            build_ms,
            drawn: Vec::new(),
            in_frustum: Vec::new(),
            tests: Vec::new(),
            operations: Vec::new(),
            bytes: Vec::new(),
            front: Vec::new(),
            times: Vec::new(),
        }
    }

    fn clusters(dag: ClusterDag, mesh: &Mesh, poses: &[Pose], tolerance: f32, build_ms: f64) -> Self {
        let half = (FIELD_OF_VIEW_DEGREES.to_radians() * 0.5).tan();
        let reach = VIEWPORT[1] as f32 * 0.5 / half / tolerance;
        let near = (mesh.diagonal() * 1e-4) as f32;
        let looks = poses.iter().map(|pose| Look { eye: pose.eye.map(|x| x as f32), reach, near });
        let kind = Kind::Clusters { dag, looks: looks.collect() };
        Self::new("clusterlod", kind, build_ms)
    }

    fn splits(
        name: &'static str,
        mesh: &Mesh,
        sequence: &CollapseSequence,
        dependencies: Dependencies,
        sequence_ms: f64,
    ) -> Result<Self, Box<dyn Error>> {
        let options = HierarchyOptions::default().with_dependencies(dependencies);
        let (built, ms) = timed(|| Baked::<VertexHierarchy>::of_sequence(mesh, sequence, &options));
        let built = built?;
        let positions = built.vertices().positions().to_vec();
        let lod = Box::new(HierarchyLod::new(Arc::clone(built.structure())));
        Ok(Self::new(name, Kind::Splits { lod, positions }, sequence_ms + ms[0]))
    }

    /// Flies once and counts.
    fn count(&mut self, views: &[ObjectView], poses: &[Pose]) {
        let aspect = f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]);
        let (mut selected, mut indices) = (Vec::new(), Vec::new());
        for (frame, (view, pose)) in views.iter().zip(poses).enumerate() {
            let planes = pose.planes(f64::from(FIELD_OF_VIEW_DEGREES).to_radians(), aspect);
            match &mut self.kind {
                Kind::Clusters { dag, looks } => {
                    dag.select(looks[frame], &mut selected);
                    dag.concatenate(&selected, &mut indices);
                    self.bytes.push(size_of_val(&indices[..]) as f64);
                    self.drawn.push((indices.len() / 3) as f64);
                    self.in_frustum.push(dag.inside(&selected, &planes) as f64);
                }
                Kind::Splits { lod, positions } => {
                    let change = lod.adapt(std::slice::from_ref(view), 1.0 / 60.0).cut;
                    // The way from the coarsest mesh to the first frame is no frame.
                    if frame > 0 {
                        self.tests.push(change.tests as f64);
                        self.operations.push((change.splits + change.collapses) as f64);
                        let changed: usize = lod.dirty_triangles(0, 0).map(|range| range.len()).sum();
                        self.bytes.push((changed * size_of::<[u32; 3]>()) as f64);
                    }
                    lod.clean();
                    if frame % FRONT_EVERY == 0 {
                        self.front.push(front(lod) as f64);
                    }
                    let drawn = lod.triangles(0);
                    self.drawn.push(drawn.len() as f64);
                    let inside = drawn.iter().filter(|t| touches(&planes, t.map(|v| positions[v as usize])));
                    self.in_frustum.push(inside.count() as f64);
                }
            }
        }
        self.times = vec![Vec::new(); views.len()];
    }

    /// Flies once against the clock.
    fn time(&mut self, views: &[ObjectView]) {
        let (mut selected, mut copy, mut shadow) = (Vec::new(), Vec::new(), Vec::new());
        for (frame, view) in views.iter().enumerate() {
            let [at, then, end] = match &mut self.kind {
                Kind::Clusters { dag, looks, .. } => {
                    let at = cpu_times()[0];
                    dag.select(looks[frame], &mut selected);
                    let then = cpu_times()[0];
                    dag.concatenate(&selected, &mut copy);
                    [at, then, cpu_times()[0]]
                }
                Kind::Splits { lod, .. } => {
                    let at = cpu_times()[0];
                    lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
                    let then = cpu_times()[0];
                    let now = lod.triangles(0);
                    shadow.resize(now.len(), [0; 3]);
                    for range in lod.dirty_triangles(0, GAP) {
                        shadow[range.clone()].copy_from_slice(&now[range]);
                    }
                    lod.clean();
                    [at, then, cpu_times()[0]]
                }
            };
            let micros = [then.saturating_sub(at), end.saturating_sub(then)].map(|t| t.as_secs_f64() * 1e6);
            self.times[frame].push(micros);
        }
    }

    fn flight(&self, mesh: &Mesh) -> Flight {
        let vertices = mesh.positions().len() as f64;
        let (hierarchy, instance) = match &self.kind {
            Kind::Clusters { .. } => (f64::NAN, f64::NAN),
            Kind::Splits { lod, .. } => {
                (lod.hierarchy().overhead() as f64 / vertices, lod.memory() as f64 / vertices)
            }
        };
        // The first frame is far from the last of the round before.
        let frames = || self.times.iter().skip(1);
        let part = |part: usize| sorted(frames().map(|t| median(&sorted(t.iter().map(|t| t[part])))));
        let both = sorted(frames().map(|t| median(&sorted(t.iter().map(|t| t[0] + t[1])))));
        let times = [part(0), part(1), both];
        let total = mean(&times[2]) * 1e3 / mean(&self.drawn);
        let adapt = mean(&times[0]) * 1e3 / mean(&self.drawn);
        let drawn = sorted(self.drawn.iter().copied());
        Flight {
            name: self.name,
            build_ms: self.build_ms,
            drawn: [mean(&drawn), drawn[0], drawn[drawn.len() - 1]],
            in_frustum: mean(&self.in_frustum),
            tests: mean(&self.tests),
            operations: mean(&self.operations),
            front: mean(&self.front),
            bytes: mean(&self.bytes),
            median_us: [0, 1, 2].map(|i| median(&times[i])),
            p99_us: [0, 1, 2].map(|i| percentile_99(&times[i])),
            ns_a_triangle: [adapt, total],
            hierarchy_bytes_a_vertex: hierarchy,
            instance_bytes_a_vertex: instance,
        }
    }
}

/// Splits at the cut of what the view asks for: those that may go, and those that may come.
fn front(lod: &HierarchyLod) -> usize {
    let (hierarchy, cut) = (lod.hierarchy(), lod.cut());
    let at_cut = |&split: &u32| {
        if cut.asks_for(split) {
            !hierarchy.children(split).any(|child| cut.asks_for(child))
        } else {
            hierarchy.parents(split).all(|parent| cut.asks_for(parent))
        }
    };
    (0..hierarchy.split_count() as u32).filter(at_cut).count()
}

/// Whether no plane has all of a triangle outside.
fn touches(planes: &[[f64; 4]; 5], corners: [[f32; 3]; 3]) -> bool {
    planes.iter().all(|[x, y, z, w]| {
        corners.iter().any(|p| {
            let [px, py, pz] = p.map(f64::from);
            x * px + y * py + z * pz + w >= 0.0
        })
    })
}

/// Tests a frame on slow paths from near and far, once ten frames have gone by.
fn slowly(
    name: &'static str,
    hierarchy: &Arc<VertexHierarchy>,
    poses: &[Pose],
    tolerance: f32,
) -> Result<Vec<Slow>, Box<dyn Error>> {
    const WARM: usize = 10;
    let mut rows = Vec::new();
    for share in [20, 50, 75] {
        let Some(&pose) = poses.get(poses.len() * share / 100) else { continue };
        let paths = [
            ("turn 1 degree", path::turning(pose)),
            ("forward 0.2 %", path::moving(pose, false)),
            ("sideways 0.2 %", path::moving(pose, true)),
        ];
        for (motion, path) in paths {
            let mut lod = HierarchyLod::new(hierarchy.clone());
            let (mut tests, mut fronts, mut operations, mut times) =
                (Vec::new(), Vec::new(), Vec::new(), Vec::new());
            for (frame, view) in views(&path, tolerance)?.into_iter().enumerate() {
                let (change, ms) = timed(|| lod.adapt(&[view], 1.0 / 60.0));
                lod.clean();
                if frame >= WARM {
                    tests.push(change.cut.tests as f64);
                    operations.push((change.cut.splits + change.cut.collapses) as f64);
                    fronts.push(front(&lod) as f64);
                    times.push(ms[0] * 1e3);
                }
            }
            rows.push(Slow {
                name,
                frame: poses.len() * share / 100,
                motion,
                tests: mean(&tests),
                operations: mean(&operations),
                front: mean(&fronts),
                median_us: median(&sorted(times.into_iter())),
            });
        }
    }
    Ok(rows)
}

/// Needs all or nothing.
struct All(bool);

impl Criterion for All {
    fn test(&self, _: &Bounds) -> Answer {
        if self.0 { Answer::ALWAYS } else { Answer::NEVER }
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

/// Refines everything and coarsens everything; the first time, when buffers grow, does not count.
fn everything(name: &'static str, hierarchy: Arc<VertexHierarchy>, rounds: usize) -> Bulk {
    let splits = hierarchy.split_count();
    let mut lod = HierarchyLod::new(hierarchy);
    let mut times = [Vec::new(), Vec::new()];
    for round in 0..=rounds {
        for (refine, times) in [true, false].into_iter().zip(&mut times) {
            let (_, ms) = timed(|| lod.adapt_by(&All(refine), Motion::Other, 0.0));
            lod.clean();
            if round > 0 {
                times.push(ms[0] * 1e6 / splits as f64);
            }
        }
    }
    let [split_ns, collapse_ns] = times.map(|t| median(&sorted(t.into_iter())));
    Bulk { name, splits, split_ns, collapse_ns }
}
