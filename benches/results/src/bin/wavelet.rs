//! Flights past meshes with subdivision connectivity: what wavelets draw, by bound, shape and triangulation, and what it looks like.
//!
//! ```text
//! cargo run --release -p multires-results --bin wavelet                      a sphere of 8,192 and a terrain of 2 million triangles
//! cargo run --release -p multires-results --bin wavelet -- FILE [--out DIR] [--path CSV] [--up y|z] [--px N] [--silhouette N]
//! ```
//!
//! The path and the picture are those of `flythrough`. At most N pixels of error (1), and N on silhouettes (as inside); the sphere
//! has 3.5 and 0.5 unless told otherwise. `--rounds N` (3): each frame's time is the least of so many flights. Leaves in
//! `target/wavelet/` (or DIR), in a folder for each model:
//!
//! | file | what |
//! |---|---|
//! | `frames.csv` | every frame: what is drawn, changed and uploaded, times, and triangles of all ways to draw |
//! | `frames.svg` | the full and the adapted mesh along the path (Azuma et al., Fig. 9) |
//! | `bounds.svg` | shapes around errors and kinds of bounds (Fig. 10), and triangulations |
//! | `beside.png` | full and adapted, flat shaded and textured (Fig. 8) |
//! | `outside.png` | full, adapted, and adapted from outside (Fig. 11) |
//! | `levels.png` | coarse, adapted and full, with edges and textured (Fig. 13) |

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use glam::DVec3;
use multires::io;
use multires::mesh::shapes;
use multires::wavelet::{Normals, WaveletMesh};
use multires_results::chart::Panel;
use multires_results::flight::{Pose, VIEWPORT};
use multires_results::painted::{Paint, Painted};
use multires_results::plates::{COMPARED, Difference, Plates};
use multires_results::race::{Build, Frame, Racer, Way};
use multires_results::say::{grouped, name_file};
use multires_results::{chart, flight, painted, race, say, sphere};

const USAGE: &str =
    "usage: wavelet [FILE] [--out DIR] [--path CSV] [--up y|z] [--px N] [--silhouette N] [--rounds N]";
/// Vertices on a side of the terrain.
const TERRAIN: u32 = 1025;
/// Every how many frames pictures are compared.
const COMPARE_EVERY: usize = 60;
/// Errors inside and on the silhouette at which they are, pixels.
const TOLERANCES: [[f32; 2]; 4] = [[1.0, 1.0], [1.0, 0.25], [0.5, 0.5], [0.25, 0.25]];
/// From the middle, in diagonals: far and near.
const FAR: f64 = 1.3;
const NEAR: f64 = 0.5;

struct Arguments {
    model: Option<PathBuf>,
    out: PathBuf,
    path: Option<PathBuf>,
    up: DVec3,
    pixels: Option<f32>,
    silhouette: Option<f32>,
    rounds: usize,
}

/// What is flown past.
struct Model<'a> {
    name: &'a str,
    build: Build<'a>,
    paint: Paint,
    /// Errors inside and on the silhouette, pixels.
    pixels: [f32; 2],
    /// The frame that is pictured.
    pictured: usize,
}

fn main() -> ExitCode {
    match arguments() {
        Ok(arguments) => say::to_stdout(|says| run(&arguments, says)),
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let pixels = |inside: f32, silhouette: f32| {
        let inside = arguments.pixels.unwrap_or(inside);
        let silhouette = if arguments.pixels.is_some() { inside } else { silhouette };
        [inside, arguments.silhouette.unwrap_or(silhouette)]
    };
    if let Some(path) = &arguments.model {
        let mesh = io::read(path).map_err(|error| name_file(path, &error))?;
        let name = path.file_stem().map_or("model".into(), |name| name.to_string_lossy());
        let build: Build<'_> = &|options| WaveletMesh::recognise(&mesh, options);
        return fly(
            &Model { name: &name, build, paint: painted::marble, pixels: pixels(1.0, 1.0), pictured: 240 },
            arguments,
            says,
        );
    }
    let sphere = Model {
        name: "sphere",
        build: &sphere::build,
        paint: painted::marble,
        pixels: pixels(sphere::PIXELS[0], sphere::PIXELS[1]),
        pictured: 240,
    };
    fly(&sphere, arguments, says)?;
    let found = sphere::distances(says)?;
    let folder = arguments.out.join(sphere.name);
    let picture = folder.join("outside.png");
    std::fs::write(&picture, found.png(6)?).map_err(|error| name_file(&picture, &error))?;
    writeln!(says, "{}\n", picture.display())?;

    let ground = shapes::terrain(TERRAIN, 3);
    let terrain = Model {
        name: "terrain",
        build: &|options| WaveletMesh::recognise(&ground, options),
        paint: painted::land,
        pixels: pixels(1.0, 1.0),
        pictured: 320,
    };
    fly(&terrain, arguments, says)
}

fn fly(model: &Model<'_>, arguments: &Arguments, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mut racers = race::racers(model.build)?;
    let Some(Racer { way: Way::Wavelets(mesh, _), .. }) = racers.first() else { return Ok(()) };
    let mesh = mesh.clone();
    let full = mesh.finest(Normals::Kept);
    let poses = match &arguments.path {
        None => flight::approach(arguments.up),
        Some(path) => flight::read(path, arguments.up)?,
    };
    let poses: Vec<Pose> = poses.iter().map(|pose| pose.about(&full)).collect();
    let out = arguments.out.join(model.name);
    std::fs::create_dir_all(&out).map_err(|error| name_file(&out, &error))?;

    let of = mesh.subdivision();
    writeln!(
        says,
        "{}: {} triangles, {} base faces, {} levels, {} wavelets",
        model.name,
        grouped(of.leaf_count()),
        grouped(of.base_face_count()),
        of.depth(),
        grouped(of.wavelet_count())
    )?;
    let [inside, silhouette] = model.pixels;
    writeln!(
        says,
        "{} frames, {} x {}, {inside} px inside, {silhouette} px on the silhouette\n",
        poses.len(),
        VIEWPORT[0],
        VIEWPORT[1]
    )?;
    race::race(&mut racers, &poses, model.pixels, arguments.rounds)?;
    let projected = race::project_full(&full, &poses);
    table(&racers, of.vertex_count(), says)?;
    compare_shapes(&racers, &poses, mesh.diagonal(), says)?;
    if let Some(first) = racers.first() {
        let projecting = sorted(steady(first), |f| f.project);
        let adapted = sorted(steady(first), |f| f.adapt + f.project);
        let median = |all: &[f64]| all.get(all.len() / 2).copied().unwrap_or(0.0);
        writeln!(
            says,
            "projecting all corners: full {projected:.0} us; adapted {:.0} us, with adapting {:.0} us (medians)",
            median(&projecting),
            median(&adapted)
        )?;
    }

    let save = |name: &str, text: String| {
        let file = out.join(name);
        std::fs::write(&file, text).map_err(|error| name_file(&file, &error))
    };
    save("frames.csv", rows(&racers))?;
    save("frames.svg", draw_frames(&racers, projected, of.leaf_count()))?;
    save("bounds.svg", draw_bounds(&racers))?;
    drop(racers);

    let painted = Painted::new(&mesh, model.paint)?;
    let plates = Plates { mesh: &mesh, painted: &painted, pixels: model.pixels };
    compare(&plates, &poses, says)?;
    if let Some(pose) = poses.get(model.pictured.min(poses.len().saturating_sub(1))) {
        let pictures = [
            ("beside.png", plates.beside(pose)?),
            ("outside.png", plates.outside(pose)?),
            ("levels.png", plates.levels(pose)?),
        ];
        for (name, picture) in pictures {
            let file = out.join(name);
            std::fs::write(&file, picture.png(6)?).map_err(|error| name_file(&file, &error))?;
        }
    }
    Ok(writeln!(says, "{}\n", out.display())?)
}

/// How different the adapted mesh looks, by tolerance.
fn compare(plates: &Plates<'_>, poses: &[Pose], says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let poses: Vec<&Pose> = poses.iter().step_by(COMPARE_EVERY).collect();
    let compared: Result<Vec<_>, _> =
        poses.iter().map(|pose| plates.differences(pose, &TOLERANCES)).collect();
    let compared = compared?;
    writeln!(
        says,
        "\ndifference from the full mesh, {} x {}, levels of 255, mean (worst) of {} frames",
        COMPARED[0],
        COMPARED[1],
        poses.len()
    )?;
    writeln!(says, "px, silhouette            lit       textured    where both are   flat shaded")?;
    for (at, pixels) in TOLERANCES.iter().enumerate() {
        let both = |of: fn(&Difference) -> f64| {
            let all = || compared.iter().filter_map(|frame| frame.get(at)).map(of);
            format!(
                "{:.2} ({:.2})",
                all().sum::<f64>() / poses.len().max(1) as f64,
                all().fold(0.0, f64::max)
            )
        };
        let [lit, textured, inside, flat] =
            [both(|d| d.lit), both(|d| d.textured), both(|d| d.inside), both(|d| d.flat)];
        writeln!(
            says,
            "{:<4} {:<10} {lit:>14} {textured:>14} {inside:>17} {flat:>13}",
            pixels[0], pixels[1]
        )?;
    }
    Ok(())
}

/// Without the first frame, which comes from the coarsest mesh.
fn steady(racer: &Racer) -> &[Frame] {
    racer.frames.get(1..).unwrap_or(&[])
}

fn sorted(frames: &[Frame], of: impl Fn(&Frame) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = frames.iter().map(of).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn table(racers: &[Racer], vertices: usize, says: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        says,
        "                                   triangles            refine-                     us a     ns a  kB      bytes a vertex"
    )?;
    writeln!(
        says,
        "                                        mean      p99     ments    tests  changes   frame  triangle  dirty   shared  instance"
    )?;
    for racer in racers {
        let frames = steady(racer);
        if frames.is_empty() {
            continue;
        }
        let mean =
            |of: fn(&Frame) -> usize| frames.iter().map(of).sum::<usize>() as f64 / frames.len() as f64;
        let [triangles, refined, tests, changes, bytes] = [
            mean(|f| f.triangles),
            mean(|f| f.refined),
            mean(|f| f.tests),
            mean(|f| f.changes),
            mean(|f| f.bytes),
        ];
        let high = sorted(frames, |f| f.triangles as f64)[(frames.len() - 1) * 99 / 100];
        let time = sorted(frames, |f| f.adapt)[frames.len() / 2];
        let ratio = sorted(frames, |f| 1e3 * f.adapt / f.triangles.max(1) as f64)[frames.len() / 2];
        let [shared, own] = racer.memory.map(|bytes| bytes as f64 / vertices.max(1) as f64);
        let whole = |x: f64| grouped(x.round() as usize);
        writeln!(
            says,
            "{:<34} {:>9} {:>8} {:>9} {:>8} {:>8} {time:>7.0} {ratio:>9.1} {:>6.1} {shared:>8.1} {own:>9.1}",
            racer.name,
            whole(triangles),
            whole(high),
            whole(refined),
            whole(tests),
            whole(changes),
            bytes / 1000.0,
        )?;
    }
    writeln!(says)
}

/// Triangles with cones over those with spheroids, frame by frame (Fig. 10).
fn compare_shapes(
    racers: &[Racer],
    poses: &[Pose],
    diagonal: f64,
    says: &mut impl Write,
) -> std::io::Result<()> {
    for bound in ["conservative", "no siblings"] {
        let of = |shape: &str| racers.iter().find(|r| r.name == format!("exact, {bound}, {shape}"));
        let (Some(spheroid), Some(cones)) = (of("spheroid"), of("cones")) else { continue };
        let ratios = |from: f64, to: f64| {
            let pairs = poses.iter().zip(spheroid.frames.iter().zip(&cones.frames));
            let near =
                move |pose: &Pose| (from..to).contains(&((pose.eye - pose.target).length() / diagonal));
            let ratios = pairs.filter(move |(pose, _)| near(pose));
            let mut all: Vec<f64> =
                ratios.map(|(_, (s, c))| c.triangles as f64 / s.triangles.max(1) as f64).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let [far, near, all] = [ratios(FAR, f64::INFINITY), ratios(0.0, NEAR), ratios(0.0, f64::INFINITY)];
        let span = |all: &[f64]| match all {
            [first, .., last] => format!("{first:.2} to {last:.2}, median {:.2}", all[all.len() / 2]),
            _ => "none".to_owned(),
        };
        writeln!(
            says,
            "{bound}: triangles with cones over with spheroids: far {}; near {}; fewer in {} of {} frames",
            span(&far),
            span(&near),
            all.iter().filter(|&&ratio| ratio < 1.0).count(),
            all.len()
        )?;
    }
    Ok(())
}

fn rows(racers: &[Racer]) -> String {
    let Some((first, others)) = racers.split_first() else { return String::new() };
    let mut out = String::from("frame,triangles,wavelets,tests,changes,bytes_changed,adapt_us,project_us");
    // Writing to a string cannot fail.
    for other in others {
        let _ = write!(out, ",triangles {}", other.name.replace(',', ""));
    }
    out.push('\n');
    for (number, frame) in first.frames.iter().enumerate() {
        let Frame { triangles, refined, tests, changes, adapt, project, bytes } = frame;
        let _ =
            write!(out, "{number},{triangles},{refined},{tests},{changes},{bytes},{adapt:.2},{project:.2}");
        for other in others {
            let _ = write!(out, ",{}", other.frames.get(number).map_or(0, |f| f.triangles));
        }
        out.push('\n');
    }
    out
}

const BLUE: &str = "#2f6fb0";
const ORANGE: &str = "#c8703a";
const GREY: &str = "#8a929e";
const GREEN: &str = "#4f9a5d";

/// The values of a racer's frames, the first as the second.
fn line(racer: &Racer, of: impl Fn(&Frame) -> f64) -> Vec<f64> {
    let first = racer.frames.get(1).or(racer.frames.first());
    first.into_iter().chain(steady(racer)).map(of).collect()
}

fn draw_frames(racers: &[Racer], projected: f64, triangles: usize) -> String {
    let Some(racer) = racers.first() else { return String::new() };
    let panels = [
        Panel {
            title: "triangles drawn",
            lines: vec![
                ("full", GREY, vec![triangles as f64; racer.frames.len()]),
                ("adapted", BLUE, line(racer, |f| f.triangles as f64)),
            ],
            holds: 1.0,
        },
        Panel {
            title: "microseconds a frame",
            lines: vec![
                ("full, projected", GREY, vec![projected; racer.frames.len()]),
                ("adapted and projected", BLUE, line(racer, |f| f.adapt + f.project)),
                ("adapted", ORANGE, line(racer, |f| f.adapt)),
            ],
            holds: 0.995,
        },
        Panel {
            title: "triangles drawn, adapted alone",
            lines: vec![("", BLUE, line(racer, |f| f.triangles as f64))],
            holds: 1.0,
        },
        Panel {
            title: "wavelets that come or go",
            lines: vec![("", BLUE, line(racer, |f| f.changes as f64))],
            holds: 0.995,
        },
    ];
    chart::svg(&panels, "frame")
}

fn draw_bounds(racers: &[Racer]) -> String {
    let of = |names: &[(&'static str, &'static str, &'static str)], value: fn(&Frame) -> f64| {
        let lines = names.iter().filter_map(|&(name, label, colour)| {
            let racer = racers.iter().find(|racer| racer.name == name)?;
            Some((label, colour, line(racer, value)))
        });
        lines.collect::<Vec<_>>()
    };
    let shapes = |bound: usize| {
        let names = [
            [
                ("exact, conservative, cones", "sphere and cones"),
                ("exact, conservative, spheroid", "spheroid"),
            ],
            [("exact, no siblings, cones", "sphere and cones"), ("exact, no siblings, spheroid", "spheroid")],
        ][bound];
        [(names[0].0, names[0].1, ORANGE), (names[1].0, names[1].1, BLUE)]
    };
    let ways = [
        ("exact, conservative, spheroid", "exact", BLUE),
        ("minimal, conservative, spheroid", "minimal", GREEN),
        ("vertex hierarchy, parametric", "hierarchy, parametric", GREY),
        ("vertex hierarchy", "hierarchy, measured", ORANGE),
    ];
    let triangles: fn(&Frame) -> f64 = |f| f.triangles as f64;
    let panel = |title, lines, holds| Panel { title, lines, holds };
    chart::svg(
        &[
            panel("triangles, conservative bounds", of(&shapes(0), triangles), 1.0),
            panel("triangles, bounds without siblings", of(&shapes(1), triangles), 1.0),
            panel("microseconds to adapt, conservative bounds", of(&shapes(0), |f| f.adapt), 0.99),
            panel("triangles, by structure and triangulation", of(&ways, triangles), 1.0),
        ],
        "frame",
    )
}

fn arguments() -> Result<Arguments, String> {
    let mut all = Arguments {
        model: None,
        out: PathBuf::from("target/wavelet"),
        path: None,
        up: DVec3::Y,
        pixels: None,
        silhouette: None,
        rounds: 3,
    };
    let mut given = std::env::args_os().skip(1);
    while let Some(argument) = given.next() {
        let mut number = |what: &str| {
            let number = given.next().and_then(|n| n.to_str()?.parse::<f32>().ok());
            number.filter(|n| *n > 0.0).ok_or(format!("{what} wants a number above 0"))
        };
        match argument.to_str() {
            Some("--px") => all.pixels = Some(number("--px")?),
            Some("--silhouette") => all.silhouette = Some(number("--silhouette")?),
            Some("--rounds") => all.rounds = (number("--rounds")? as usize).max(1),
            Some("--out") => all.out = given.next().ok_or("--out wants a directory")?.into(),
            Some("--path") => all.path = Some(given.next().ok_or("--path wants a file")?.into()),
            Some("--up") => {
                all.up = match given.next().as_ref().and_then(|up| up.to_str()) {
                    Some("y") => DVec3::Y,
                    Some("z") => DVec3::Z,
                    _ => return Err("--up wants y or z".into()),
                }
            }
            Some(flag) if flag.starts_with('-') => return Err(format!("{flag} is not known")),
            _ if all.model.is_some() => return Err("one file at a time".into()),
            _ => all.model = Some(PathBuf::from(argument)),
        }
    }
    Ok(all)
}
