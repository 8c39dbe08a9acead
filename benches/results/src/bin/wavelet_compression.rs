//! How near a share of the wavelet coefficients comes: lazy wavelets beside k-disk wavelets at equal counts, as tables
//! in markdown.
//!
//! ```text
//! cargo run --release -p multires-results --bin wavelet_compression -- [MODEL...] [--samples N]
//! ```
//!
//! Models need subdivision connectivity; where a texture's seams cut through coarse faces, positions go alone. Without
//! models three are made. Kept are the coefficients of largest length times norm; the base is always kept. `L2` is the
//! root of the mean square between the same points of the surface, exact; `distance` the mean of both directions' mean
//! distances between the surfaces, by samples (50,000 a mesh). Both in millionths of the diagonal.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use multires::mesh::shapes;
use multires::quality::{DistanceOptions, Surface};
use multires::wavelet::{
    Normals, Wavelet, WaveletBuilder, WaveletMesh, WaveletOptions, WaveletTransform, l2_error,
};
use multires::{Mesh, io};
use multires_results::say;

/// The shares kept, in percent of the coefficients.
const PERCENTS: [usize; 7] = [0, 1, 2, 5, 10, 20, 50];
const KINDS: [(&str, Wavelet); 4] = [
    ("lazy", Wavelet::Lazy),
    ("0-disk", Wavelet::Disk(0)),
    ("1-disk", Wavelet::Disk(1)),
    ("2-disk", Wavelet::Disk(2)),
];

fn main() -> ExitCode {
    let (mut models, mut samples) = (Vec::new(), 50_000);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--samples" => match arguments.next().and_then(|n| n.parse().ok()) {
                Some(n) => samples = n,
                None => return usage(),
            },
            flag if flag.starts_with('-') => return usage(),
            _ => models.push(argument),
        }
    }
    say::to_stdout(|says| {
        if models.is_empty() {
            table("terrain", &recognise(&shapes::terrain(257, 1))?, samples, says)?;
            table("rock", &recognise(&shapes::rock(20 << 12, 1))?, samples, says)?;
            return table("fractal", &fractal(6)?, samples, says);
        }
        models.iter().try_for_each(|model| {
            let path = Path::new(model);
            let mesh = io::read(path).map_err(|error| say::name_file(path, &error))?;
            let name = path.file_name().map_or(model.clone(), |name| name.to_string_lossy().into_owned());
            table(&name, &recognise(&mesh)?, samples, says)
        })
    })
}

fn usage() -> ExitCode {
    eprintln!("usage: wavelet_compression [MODEL...] [--samples N]");
    ExitCode::from(2)
}

fn recognise(mesh: &Mesh) -> Result<WaveletMesh, Box<dyn Error>> {
    let options = WaveletOptions::default();
    let found = WaveletMesh::recognise(mesh, &options);
    let bare = Mesh::new(mesh.positions(), mesh.triangles())?;
    Ok(found.or_else(|_| WaveletMesh::recognise(&bare, &options))?)
}

/// A ball whose midpoints are put out of the middle by chance, less on every level: by an eighth of the edge.
fn fractal(levels: usize) -> Result<WaveletMesh, Box<dyn Error>> {
    let mut builder = WaveletBuilder::new(&shapes::icosphere(1))?;
    let mut state = 1_u64;
    for _ in 0..levels {
        builder.subdivide(|midpoint| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let chance = (state >> 40) as f32 / (1 << 23) as f32 - 1.0;
            let [a, b] = midpoint.positions;
            let edge = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt();
            let radius = midpoint.middle.iter().map(|x| x * x).sum::<f32>().sqrt();
            midpoint.middle.map(|x| x * (1.0 + 0.125 * edge * chance / radius))
        })?;
    }
    Ok(builder.build(&WaveletOptions::default())?)
}

/// Runs timed, of which the fastest counts.
const RUNS: usize = 5;

/// A transform and how long it took to make, to analyse and to synthesise, in milliseconds.
struct Timed<'a> {
    name: &'a str,
    transform: WaveletTransform,
    times: [f64; 3],
}

fn table(
    name: &str,
    mesh: &WaveletMesh,
    samples: usize,
    says: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let of = mesh.subdivision();
    let positions = mesh.vertices().positions().as_flattened();
    let finest = mesh.finest(Normals::Kept);
    let original = Surface::new(&finest)?;
    let options = DistanceOptions::default().with_samples(samples);
    let millionths = |length: f64| 1e6 * length / mesh.diagonal();

    let mut kinds = Vec::new();
    for (name, kind) in KINDS {
        let mut times = [f64::INFINITY; 3];
        let mut lap = |at: usize, start: Instant| times[at] = start.elapsed().as_secs_f64().min(times[at]);
        let mut transform = WaveletTransform::of_points(mesh, kind)?;
        for _ in 0..RUNS {
            let start = Instant::now();
            transform = WaveletTransform::of_points(mesh, kind)?;
            lap(0, start);
            let start = Instant::now();
            let coefficients = transform.analyse(positions, 3)?;
            lap(1, start);
            let start = Instant::now();
            let back = coefficients.synthesise();
            lap(2, start);
            let off = positions.iter().zip(&back).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
            if millionths(off) > 1.0 {
                return Err(format!("{name}: {off} off after a round trip").into());
            }
        }
        kinds.push(Timed { name, transform, times: times.map(|seconds| 1e3 * seconds) });
    }

    let triangles = say::grouped(of.leaf_count());
    let (base, depth) = (say::grouped(of.base_face_count()), of.depth());
    let s = if depth == 1 { "" } else { "s" };
    writeln!(says, "## {name}\n\n{triangles} triangles, {depth} level{s} above {base} base faces.\n")?;
    write!(says, "| kept % | coefficients ")?;
    kinds.iter().try_for_each(|kind| write!(says, "| L2 {} ", kind.name))?;
    kinds.iter().try_for_each(|kind| write!(says, "| distance {} ", kind.name))?;
    writeln!(says, "|\n|{}", "--:|".repeat(2 + 2 * kinds.len()))?;
    for percent in PERCENTS {
        let (mut errors, mut distances) = (String::new(), String::new());
        let mut count = 0;
        for kind in &kinds {
            let all = kind.transform.analyse(positions, 3)?;
            count = all.count() * percent / 100;
            let values = all.to_count(count).synthesise();
            let error = l2_error(of, 3, positions, &values)?;
            errors += &format!("| {} ", digits(millionths(error)));
            let some = with_positions(mesh, &finest, &values)?;
            let distance = original.distance(&Surface::new(&some)?, &options)?;
            distances += &format!("| {} ", digits(millionths(distance.mean())));
        }
        writeln!(says, "| {percent} | {} {errors}{distances}|", say::grouped(count))?;
    }
    writeln!(
        says,
        "\n| | systems solved | make, ms | analyse, ms | synthesise, ms |\n|---|--:|--:|--:|--:|"
    )?;
    for Timed { name, transform, times } in &kinds {
        let [make, analyse, synthesise] = times.map(digits);
        let patterns = say::grouped(transform.patterns());
        writeln!(says, "| {name} | {patterns} | {make} | {analyse} | {synthesise} |")?;
    }
    Ok(writeln!(says)?)
}

/// The finest triangles with other positions, given for all vertices.
fn with_positions(mesh: &WaveletMesh, finest: &Mesh, values: &[f32]) -> Result<Mesh, Box<dyn Error>> {
    let of = mesh.subdivision();
    // The base may have vertices that no face uses; all others are in the finest mesh, in order.
    let mut used = vec![false; of.base_vertex_count()];
    let base = (0..of.base_face_count() as u32).filter_map(|face| of.base_face(face));
    base.flatten().for_each(|vertex| used[vertex as usize] = true);
    let all = values.chunks_exact(3).map(|xyz| [xyz[0], xyz[1], xyz[2]]).enumerate();
    let positions = all.filter(|&(vertex, _)| used.get(vertex) != Some(&false)).map(|(_, p)| p);
    Ok(Mesh::new(positions.collect::<Vec<_>>(), finest.triangles())?)
}

/// Three digits.
fn digits(x: f64) -> String {
    let decimals = if x > 0.0 { (2.0 - x.log10().floor()).clamp(0.0, 4.0) as usize } else { 0 };
    format!("{x:.decimals$}")
}
