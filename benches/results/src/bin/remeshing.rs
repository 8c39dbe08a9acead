//! Tables and pictures of docs/results/remeshing.md: any mesh as one with subdivision connectivity.
//!
//! ```text
//! cargo run --release -p multires-results --bin remeshing [-- --out DIR]              pictures of models made by the crate
//! cargo run --release -p multires-results --bin remeshing -- MODEL[:LEVELS]...        a row of the table a model
//! cargo run --release -p multires-results --bin remeshing -- --against ORIGINAL REMESH...   beside remeshes by others
//! cargo run --release -p multires-results --bin remeshing -- --flown MODEL[:LEVELS] [DIR]   flown past, beside the original
//! ```
//!
//! Bases of 500 faces, 4 levels unless given. Pictures go to `target/remeshing/` (or DIR). Everything runs on one thread;
//! seconds are those that the thread ran, where the system tells, from the mesh to the baked model.

use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use glam::DVec3;
use multires::io;
use multires::mesh::{Creases, Mesh, names, shapes};
use multires::quality::{Distance, DistanceOptions, Surface};
use multires::remesh::{Depth, Distortion, Remesher};
use multires::wavelet::{Normals, WaveletOptions, recognise_across_seams};
use multires_results::flight::{self, Pose};
use multires_results::painted::{self, Painted};
use multires_results::parameter_lines::checkered;
use multires_results::picture::{Shown, sheet};
use multires_results::plates::Plates;
use multires_results::say::{self, grouped};

const USAGE: &str = "usage: remeshing [--out DIR] | MODEL[:LEVELS]... | --against ORIGINAL REMESH... | --flown MODEL[:LEVELS] [DIR]";
const FACES: usize = 500;
const LEVELS: usize = 4;
/// Pixels that a mesh is rendered in.
const PIXELS: usize = 420;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let alone = |run: &mut (dyn FnMut() -> Result<(), Box<dyn Error>> + Send)| {
        // An error crosses threads as text.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        pool.install(|| run().map_err(|error| error.to_string())).map_err(Box::<dyn Error>::from)
    };
    let out = |folder: &Path| alone(&mut || pictures(folder));
    match &arguments[..] {
        [] => say::to_stdout(|_| out(Path::new("target/remeshing"))),
        [flag, folder] if flag == "--out" => say::to_stdout(|_| out(&PathBuf::from(folder))),
        [flag, original, others @ ..] if flag == "--against" && !others.is_empty() => {
            say::to_stdout(|says| {
                let mut rows = Vec::new();
                alone(&mut || against(original, others, &mut rows))?;
                Ok(says.write_all(&rows)?)
            })
        }
        [flag, model, folder @ ..] if flag == "--flown" && folder.len() < 2 => {
            let folder = folder.first().map_or("target/remeshing", |folder| folder);
            say::to_stdout(|says| flown(model, Path::new(folder), says))
        }
        [first, ..] if first.starts_with('-') => {
            eprintln!("{USAGE}");
            ExitCode::from(2)
        }
        models => say::to_stdout(|says| {
            writeln!(says, "{HEAD}")?;
            for model in models {
                let mut row = String::new();
                alone(&mut || {
                    row = row_of(model);
                    Ok(())
                })?;
                writeln!(says, "{row}")?;
            }
            Ok(())
        }),
    }
}

const HEAD: &str = "\
| model | triangles | base faces | level | angle, mean | 99 % | area, mean | 99 % | folded | unfolded | mean to the remesh, % | back | max, % | back | seconds | bytes a triangle |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|";

/// A remesh and its figures.
struct Remeshed {
    base_faces: usize,
    mesh: Mesh,
    /// Triangles that face away from the mesh, and that did until they were unfolded.
    folded: [usize; 2],
    distortion: Distortion,
    seconds: f64,
    map_bytes: usize,
}

fn remesh(mesh: &Mesh, faces: usize, levels: usize) -> Result<Remeshed, Box<dyn Error>> {
    let start = seconds();
    let map = Remesher::new().base_faces(faces).run(mesh)?;
    let options = WaveletOptions::default();
    let done = map.bake_with(mesh, Depth::Levels(levels), &options, |_| ControlFlow::Continue(()))?;
    let seconds = seconds() - start;
    Ok(Remeshed {
        base_faces: map.base().triangles().len(),
        mesh: done.model.structure().finest(Normals::Kept),
        folded: [done.folded, done.unfolded],
        distortion: map.distortion(mesh, levels),
        seconds,
        map_bytes: map.memory(),
    })
}

/// Seconds that this thread has run; of the clock, where the system does not tell.
fn seconds() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let start = START.get_or_init(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

fn distance(a: &Mesh, b: &Mesh) -> Result<Distance, Box<dyn Error>> {
    Ok(Surface::new(a)?.distance(&Surface::new(b)?, &DistanceOptions::default())?)
}

/// Takes the levels off the end of a path.
fn path_and_levels(model: &str) -> (&str, usize) {
    match model.rsplit_once(':').map(|(path, levels)| (path, levels.parse())) {
        Some((path, Ok(levels))) => (path, levels),
        _ => (model, LEVELS),
    }
}

/// A row of the table, with the reason where there are no figures.
fn row_of(model: &str) -> String {
    let (path, levels) = path_and_levels(model);
    let name = Path::new(path).file_stem().map_or(path.into(), |name| name.to_string_lossy());
    let figures = || -> Result<String, Box<dyn Error>> {
        let mesh = io::read(path)?;
        let done = remesh(&mesh, FACES, levels)?;
        let Distortion { angle, area, .. } = done.distortion;
        let apart = distance(&mesh, &done.mesh)?;
        let percent = |length: f64| apart.percent(length);
        let count = mesh.triangles().len();
        Ok(format!(
            "{} | {} | {levels} | {:.3} | {:.2} | {:.3} | {:.2} | {} | {} | {:.4} | {:.4} | {:.3} | {:.3} | {:.2} | {:.0} |",
            grouped(count),
            grouped(done.base_faces),
            angle.mean,
            angle.p99,
            area.mean,
            area.p99,
            grouped(done.folded[0]),
            grouped(done.folded[1]),
            percent(apart.forward.mean),
            percent(apart.backward.mean),
            percent(apart.forward.max),
            percent(apart.backward.max),
            done.seconds,
            done.map_bytes as f64 / count.max(1) as f64,
        ))
    };
    format!("| {name} | {}", figures().unwrap_or_else(|error| format!("{error} |")))
}

/// Remeshes by others beside remeshes with bases of as many faces and as many levels.
fn against(original: &str, others: &[String], rows: &mut Vec<u8>) -> Result<(), Box<dyn Error>> {
    let mesh = io::read(original)?;
    writeln!(
        rows,
        "| remesh | base faces | levels | mean to the remesh, % | back | max, % | back |\n|---|--:|--:|--:|--:|--:|--:|"
    )?;
    for other in others {
        let name = Path::new(other).file_stem().map_or(other.into(), |name| name.to_string_lossy());
        let theirs = io::read(other)?;
        let components = recognise_across_seams(&theirs).components;
        let faces: usize = components.iter().map(|component| component.base_faces as usize).sum();
        let levels = components.iter().map(|component| component.levels as usize).max().unwrap_or(0);
        let ours = remesh(&mesh, faces, levels)?;
        let rows_of =
            [(format!("`{name}`"), faces, &theirs), ("multires".to_owned(), ours.base_faces, &ours.mesh)];
        for (name, faces, remeshed) in rows_of {
            let apart = distance(&mesh, remeshed)?;
            let [mean, back, most, most_back] =
                [apart.forward.mean, apart.backward.mean, apart.forward.max, apart.backward.max]
                    .map(|length| apart.percent(length));
            writeln!(
                rows,
                "| {name} | {faces} | {levels} | {mean:.4} | {back:.4} | {most:.3} | {most_back:.3} |"
            )?;
        }
    }
    Ok(())
}

/// Tolerances of a flight, pixels: everywhere, and on the silhouette.
const TOLERANCES: [[f32; 2]; 5] = [[0.05, 0.05], [1.0, 1.0], [1.0, 0.25], [2.0, 2.0], [10.0, 10.0]];
/// A flight is compared in every so many frames.
const COMPARED_EVERY: usize = 60;
/// The frame of Fig. 13.
const PICTURED: usize = 240;

/// Flies past a remesh, beside the original: how different it looks, and what is drawn.
fn flown(model: &str, out: &Path, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let (path, levels) = path_and_levels(model);
    let mesh = io::read(path)?;
    // Lit by smooth normals, which the remesh has from the mesh.
    let smooth = |mesh: Mesh| mesh.with_crease_normals(&Creases::with_angle(&mesh, 180.0));
    let mesh = if mesh.attribute(names::NORMAL).is_some() { mesh } else { smooth(mesh) };
    let map = Remesher::new().base_faces(FACES).run(&mesh)?;
    let baked = map.bake(&mesh, Depth::Levels(levels), &WaveletOptions::default())?;
    drop(map);
    let wavelets = baked.structure();
    let painted = Painted::new(wavelets, painted::marble)?;
    let plates = Plates { mesh: wavelets, painted: &painted, pixels: TOLERANCES[0] };
    let poses: Vec<Pose> = flight::approach(DVec3::Y).iter().map(|pose| pose.about(&mesh)).collect();
    let mut frames = Vec::new();
    for pose in poses.iter().step_by(COMPARED_EVERY) {
        frames.push(plates.against(&mesh, pose, &TOLERANCES)?);
    }
    writeln!(
        says,
        "| px inside, silhouette | K_L1, mean | worst | triangles, mean | least | most |\n|---|--:|--:|--:|--:|--:|"
    )?;
    for (i, [inside, silhouette]) in TOLERANCES.iter().enumerate() {
        let differences: Vec<f64> = frames.iter().map(|frame| frame[i].0).collect();
        let drawn: Vec<usize> = frames.iter().map(|frame| frame[i].1).collect();
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        let worst = differences.iter().copied().fold(0.0, f64::max);
        let [least, most] = [drawn.iter().min(), drawn.iter().max()].map(|n| n.copied().unwrap_or(0));
        let average = drawn.iter().sum::<usize>() / drawn.len().max(1);
        let [average, least, most] = [average, least, most].map(grouped);
        writeln!(says, "| {inside}, {silhouette} | {mean:.2} | {worst:.2} | {average} | {least} | {most} |")?;
    }
    std::fs::create_dir_all(out)?;
    let name = Path::new(path).file_stem().map_or("model".into(), |name| name.to_string_lossy());
    let picture = out.join(format!("{name}-flown.png"));
    std::fs::write(&picture, plates.tolerances(&mesh, &poses[PICTURED], [2.0, 10.0])?.png(6)?)?;
    Ok(writeln!(says, "{}", picture.display())?)
}

/// The original, its base, the lines of the parameters, and levels.
fn pictures(out: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(out)?;
    let gear = (0..3).fold(shapes::gear(12, 0.4), |mesh, _| shapes::cut_in_four(&mesh));
    let models = [
        ("rock", shapes::rock(40_000, 3), 300),
        ("knot", shapes::torus_knot(2, 3, 400, 40), 300),
        ("gear", gear, 300),
    ];
    for (name, mesh, faces) in models {
        let map = Remesher::new().base_faces(faces).run(&mesh)?;
        let baked = map.bake(&mesh, Depth::Levels(LEVELS), &WaveletOptions::default())?;
        let wavelets = baked.structure();
        let plain = |caption: String, mesh: Mesh| Shown {
            caption: format!("{caption}, {} triangles", grouped(mesh.triangles().len())),
            mesh,
            colours: None,
            edges: 1.0,
        };
        let level = |level: usize| plain(format!("level {level}"), wavelets.at_level(level, Normals::Kept));
        let shown = [
            plain("original".to_owned(), mesh.clone()),
            plain("base".to_owned(), wavelets.at_level(0, Normals::Kept)),
            checkered(wavelets, 2),
            level(1),
            level(2),
            level(LEVELS),
        ];
        std::fs::write(out.join(name).with_extension("png"), sheet(&mesh, PIXELS, &shown)?.png(6)?)?;
    }
    Ok(())
}
