//! Any mesh as one with subdivision connectivity: its base, the lines of its parameters, its levels.
//!
//! ```text
//! cargo run --release --example remesh --features io                           a model that the crate makes itself
//! cargo run --release --example remesh --features io -- FILE [--base N] [--levels J] [--out DIR]
//! ```
//!
//! Prints base, distortion, and for each level how far it is from the model. Leaves a picture, the finest level and the baked
//! wavelet mesh in `target/remesh/`.

#[path = "../src/bin/multires/canvas.rs"]
mod canvas;
#[path = "../src/bin/multires/lettering.rs"]
mod lettering;
#[path = "support/parameter_lines.rs"]
mod parameter_lines;
#[path = "support/picture.rs"]
mod picture;
#[path = "support/say.rs"]
mod say;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use multires::io;
use multires::mesh::{Mesh, MeshPoint, shapes};
use multires::quality::{DistanceOptions, Surface};
use multires::remesh::{Depth, Remesher};
use multires::wavelet::{Normals, WaveletOptions};
use picture::Shown;
use say::{grouped, name_file};

const USAGE: &str = "usage: remesh [FILE] [--base N] [--levels J] [--out DIR]";
/// Pixels that a mesh is rendered in.
const PIXELS: usize = 460;
/// Samples of a distance.
const SAMPLES: usize = 100_000;

/// The arguments.
struct Arguments {
    model: Option<PathBuf>,
    base: usize,
    levels: usize,
    out: PathBuf,
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
    let Arguments { model, base, levels, out } = arguments;
    let mesh = match model {
        None => shapes::rock(40_000, 3),
        Some(path) => io::read(path).map_err(|error| name_file(path, &error))?,
    };
    let name =
        model.as_deref().and_then(Path::file_name).map_or("rock".into(), |name| name.to_string_lossy());
    writeln!(says, "{name}: {} triangles, diagonal {:.4}", grouped(mesh.triangles().len()), mesh.diagonal())?;

    // Once: a base, and the map between the mesh and its base.
    let start = Instant::now();
    let map = Remesher::new().base_faces(*base).run(&mesh)?;
    let mapped = start.elapsed().as_secs_f64();
    let model = map.bake(&mesh, Depth::Levels(*levels), &WaveletOptions::default())?;
    let baked = start.elapsed().as_secs_f64();
    let each = map.memory() as f64 / mesh.triangles().len().max(1) as f64;
    writeln!(
        says,
        "base: {} faces, {} vertices; the map in {mapped:.2} s, {each:.0} bytes a triangle; baked after {baked:.2} s",
        grouped(map.base().triangles().len()),
        grouped(map.base().positions().len()),
    )?;
    let distortion = map.distortion(&mesh, *levels);
    writeln!(
        says,
        "angles stretched by {:.3} (mean), {:.3} (99 % are below); areas by {:.3}, {:.3}; {} of {} triangles folded\n",
        distortion.angle.mean,
        distortion.angle.p99,
        distortion.area.mean,
        distortion.area.p99,
        grouped(distortion.folded),
        grouped(distortion.triangles),
    )?;

    // The wavelet mesh is a model as any other: levels, views, files. Here all its levels.
    let wavelets = model.structure();
    let original = Surface::new(&mesh)?;
    let options = DistanceOptions::default().with_samples(SAMPLES);
    writeln!(says, "level   triangles   mean error   largest    in percent of the diagonal")?;
    for level in 0..=*levels {
        let coarse = wavelets.at_level(level, Normals::Recomputed);
        let apart = original.distance(&Surface::new(&coarse)?, &options)?;
        let (mean, most) = (apart.mean_percent(), apart.hausdorff_percent());
        writeln!(
            says,
            "{level:>5}   {:>9}   {mean:>8.4} %   {most:>6.3} %",
            grouped(coarse.triangles().len())
        )?;
    }

    // The map goes both ways: there and back again is the same place.
    let farthest = (0..mesh.triangles().len() as u32)
        .filter_map(|triangle| {
            let middle = MeshPoint::new(triangle, [1.0 / 3.0; 3]);
            let back = map.to_mesh(&map.to_base(&middle)?)?;
            let [from, to] = [middle.position(&mesh)?, back.position(&mesh)?];
            Some((0..3).map(|i| (from[i] - to[i]).powi(2)).sum::<f64>().sqrt())
        })
        .fold(0.0, f64::max);
    writeln!(says, "\nmiddles of triangles to the base and back: off by at most {farthest:.1e}")?;

    std::fs::create_dir_all(out).map_err(|error| name_file(out, &error))?;
    let plain = |caption: &str, mesh: Mesh| Shown {
        caption: format!("{caption}, {} triangles", grouped(mesh.triangles().len())),
        mesh,
        colours: None,
        edges: 1.0,
    };
    let lines = parameter_lines::checkered(wavelets, 2.min(*levels));
    let shown = [
        plain("original", mesh.clone()),
        plain("base", wavelets.at_level(0, Normals::Recomputed)),
        lines,
        plain("level 1", wavelets.at_level(1, Normals::Recomputed)),
        plain("level 2", wavelets.at_level(2, Normals::Recomputed)),
        plain(&format!("level {levels}"), wavelets.finest(Normals::Kept)),
    ];
    let [picture, finest, file] = ["remesh.png", "remesh.glb", "remesh.mres"].map(|file| out.join(file));
    std::fs::write(&picture, picture::sheet(&mesh, PIXELS, &shown)?.png(6)?)
        .map_err(|error| name_file(&picture, &error))?;
    io::write(&finest, &wavelets.finest(Normals::Kept))?;
    model.write(&file)?;
    writeln!(says, "{}, {}, {}", picture.display(), finest.display(), file.display())?;
    Ok(())
}

fn arguments() -> Result<Arguments, String> {
    let mut found = Arguments { model: None, base: 500, levels: 4, out: PathBuf::from("target/remesh") };
    let mut arguments = std::env::args_os().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = |most: usize| {
            let text = arguments.next().and_then(|text| text.into_string().ok());
            let number = text.and_then(|text| text.parse::<usize>().ok()).filter(|number| *number <= most);
            number.ok_or(format!("{} wants a number of at most {most}", argument.to_string_lossy()))
        };
        match argument.to_str() {
            Some("--base") => found.base = number(1_000_000)?,
            Some("--levels") => found.levels = number(8)?,
            Some("--out") => found.out = arguments.next().ok_or("--out wants a directory")?.into(),
            Some(flag) if flag.starts_with('-') => return Err(format!("{flag} is not known")),
            _ if found.model.is_some() => return Err("one file at a time".into()),
            _ => found.model = Some(PathBuf::from(argument)),
        }
    }
    Ok(found)
}
