//! A bounded run of all targets, on any compiler: seeds with changes, or any bytes, the same in every run.
//!
//! ```text
//! cargo run --release -p multires-fuzz --bin bounded [-- --runs N] [--from N] [TARGET...]
//! cargo run --release -p multires-fuzz --bin bounded -- --write-seeds                  of decoders, anew
//! cargo run --release -p multires-fuzz --bin bounded -- --from N --keep TARGET         one run of what is built
//! ```
//!
//! For each target so many runs (default 20,000). A run that panics is named by its number, and `--from` begins there. Memory beyond
//! 64 MiB for data of at most one is an error too, and beyond 256 MiB for meshes of a thousand triangles.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use multires::io::{BakeOptions, Compression, Format, Stored, write_bytes};
use multires::lod::Baked;
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::store::{StoreOptions, write_store};
use multires::stream::{Client, ClientOptions, Server, StreamOptions, write_prefix};
use multires::view::look_at;
use multires::wavelet::WaveletMesh;
use multires::{Gmesh, TotallyOrderedMesh};
use multires_fuzz::{TARGETS, Target};
use peak_alloc::PeakAlloc;

/// Vertices around and along the tube of the samples.
const TUBE: [usize; 2] = [4, 5];
#[path = "../../../tests/support/gltf_samples.rs"]
mod gltf_samples;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Most bytes that a run may take, of decoders and of what is built: that follows what comes out, and not the data.
const MOST: [usize; 2] = [64 << 20, 256 << 20];

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn seeds_of(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(target)
}

fn main() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Outcome<()> {
    let (mut runs, mut from, mut keeps, mut names) = (20_000, 0, false, Vec::new());
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        let mut number =
            || arguments.next().ok_or("a number is missing")?.parse::<u64>().map_err(|e| e.to_string());
        match argument.as_str() {
            "--write-seeds" => return write_seeds(),
            "--keep" => keeps = true,
            "--runs" => runs = number()?,
            "--from" => from = number()?,
            name if TARGETS.iter().any(|target| target.name == name) => names.push(name),
            other => return Err(format!("there is no target {other:?}").into()),
        }
    }
    // Each has its turn, whatever others find.
    let asked = TARGETS.iter().filter(|target| names.is_empty() || names.contains(&target.name));
    if keeps {
        for target in asked.filter(|target| target.is_built) {
            seed(target.name, &format!("run-{from}"), &[], &any_bytes(&mut of_run(from)))?;
        }
        return Ok(());
    }
    let found: Vec<String> =
        asked.filter_map(|target| fuzz(target, from, runs).err()).map(|error| error.to_string()).collect();
    if found.is_empty() { Ok(()) } else { Err(found.join("\n").into()) }
}

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
        ((mixed ^ mixed >> 32) % most.max(1) as u64) as usize
    }
}

/// Changes data: bits, bytes, numbers of 4 bytes, pieces that go, come twice or come from other data.
fn change(data: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..1 + random.below(4) {
        if data.len() < 5 {
            data.extend([random.below(256) as u8; 5]);
        }
        let at = random.below(data.len() - 4);
        let length = 1 + random.below((data.len() - at).min(64));
        match random.below(8) {
            0 => data[at] ^= 1 << random.below(8),
            1 => data[at] = random.below(256) as u8,
            2 => data[at..at + 4].copy_from_slice(&(random.below(1 << 32) as u32).to_le_bytes()),
            3 => {
                let number = u32::from_le_bytes([data[at], data[at + 1], data[at + 2], data[at + 3]]);
                let near = number.wrapping_add(random.below(5) as u32).wrapping_sub(2);
                data[at..at + 4].copy_from_slice(&near.to_le_bytes());
            }
            4 => data[at..at + 4].copy_from_slice(&[0, 1, u32::MAX, 1 << 31][random.below(4)].to_le_bytes()),
            5 => drop(data.drain(at..at + length)),
            6 => {
                let piece = data[at..at + length].to_vec();
                let to = random.below(data.len());
                data.splice(to..to, piece);
            }
            _ if other.is_empty() => {}
            _ => {
                let from = random.below(other.len());
                let piece = &other[from..(from + length).min(other.len())];
                data.splice(at..at + length, piece.iter().copied());
            }
        }
    }
    data.truncate(1 << 20);
}

/// Bytes to choose from: often few, so that what follows has its simplest choice.
fn any_bytes(random: &mut Random) -> Vec<u8> {
    let length = 8 << random.below(8);
    (0..length).map(|_| random.below(256) as u8).collect()
}

fn of_run(run: u64) -> Random {
    Random(run.wrapping_mul(0x2545_f491_4f6c_dd1d))
}

fn seeds(name: &str) -> Outcome<Vec<(PathBuf, Vec<u8>)>> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(seeds_of(name))?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    paths.sort();
    paths.into_iter().map(|path| Ok((path.clone(), std::fs::read(path)?))).collect()
}

fn fuzz(&Target { name, run: decode, is_built }: &Target, from: u64, runs: u64) -> Outcome<()> {
    // What is built needs none.
    let seeds = if is_built && !seeds_of(name).exists() { Vec::new() } else { seeds(name)? };
    if let Some((path, _)) = seeds.iter().find(|(_, seed)| !is_built && !decode(seed)) {
        return Err(format!("{name}: {} is not sound: write the seeds anew", path.display()).into());
    }
    let start = Instant::now();
    let (mut sound, mut failed) = (0, 0);
    let (mut longest, mut largest) = ((Duration::ZERO, String::new()), (0, String::new()));
    // What was found by choices before is tried again.
    let kept =
        seeds.iter().filter(|_| is_built).map(|(path, seed)| (path.display().to_string(), seed.clone()));
    let of_run = |run: u64| {
        let mut random = of_run(run);
        if is_built {
            return any_bytes(&mut random);
        }
        let mut data = seeds[random.below(seeds.len())].1.clone();
        let other = &seeds[random.below(seeds.len())].1;
        change(&mut data, other, &mut random);
        data
    };
    for (which, data) in kept.chain((from..from + runs).map(|run| (format!("run {run}"), of_run(run)))) {
        let hook = std::panic::take_hook();
        let label = which.clone();
        std::panic::set_hook(Box::new(move |what| eprintln!("{name}, {label}: {what}")));
        let before = MEMORY.current_usage();
        MEMORY.reset_peak_usage();
        let begun = Instant::now();
        match std::panic::catch_unwind(|| decode(&data)) {
            Ok(is_sound) => sound += u64::from(is_sound),
            Err(_) => failed += 1,
        }
        longest = longest.max((begun.elapsed(), which.clone()));
        let taken = MEMORY.peak_usage().saturating_sub(before);
        std::panic::set_hook(hook);
        if taken > MOST[usize::from(is_built)] {
            return Err(format!("{name}, {which}: {taken} bytes of memory").into());
        }
        largest = largest.max((taken, which));
    }
    println!(
        "{name}: {} seeds, {runs} runs in {:.1} s, {sound} of sound data; longest {:.1} ms ({}), most memory {} bytes ({})",
        seeds.len(),
        start.elapsed().as_secs_f64(),
        longest.0.as_secs_f64() * 1e3,
        longest.1,
        largest.0,
        largest.1
    );
    if failed > 0 {
        return Err(format!("{name}: {failed} runs failed").into());
    }
    Ok(())
}

/// Writes a seed. `mends`: whether checksums are made to fit after changes.
fn seed(target: &str, name: &str, first: &[u8], bytes: &[u8]) -> Outcome<()> {
    let folder = seeds_of(target);
    std::fs::create_dir_all(&folder)?;
    Ok(std::fs::write(folder.join(name), [first, bytes].concat())?)
}

fn seed_model<S: Stored>(mesh: &Mesh, name: &str, bake: impl Fn(&Mesh) -> Outcome<Baked<S>>) -> Outcome<()> {
    let model = bake(mesh)?;
    for (kind, options) in [
        ("plain", BakeOptions::default()),
        ("short", BakeOptions::default().with_derived(false)),
        ("lz4", BakeOptions::default().with_compression(Compression::Lz4)),
    ] {
        seed("baked", &format!("{name}-{}-{kind}", S::KIND), &[1], &model.to_bytes_with(options)?)?;
    }
    Ok(())
}

/// Writes the seeds anew: small shapes that the crate makes itself.
fn write_seeds() -> Outcome<()> {
    for sample in gltf_samples::all() {
        let name: String =
            sample.name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
        seed("documents", &name, &[0], &sample.glb())?;
    }
    let prop = shapes::prop(1);
    for (name, mesh) in [("rock", shapes::rock(100, 1)), ("prop", prop.clone())] {
        seed_model::<VertexHierarchy>(&mesh, name, |mesh| Ok(VertexHierarchy::bake(mesh)?))?;
        seed_model::<TotallyOrderedMesh>(&mesh, name, |mesh| Ok(TotallyOrderedMesh::bake(mesh)?))?;
        seed_model::<Gmesh>(&mesh, name, |mesh| Ok(Gmesh::bake(mesh)?))?;
        let model = VertexHierarchy::bake(&mesh)?;
        for (kind, compression) in [("plain", Compression::None), ("lz4", Compression::Lz4)] {
            let mut bytes = Vec::new();
            write_store(&model, &StoreOptions::default().with_compression(compression), &mut bytes)?;
            seed("store", &format!("{name}-{kind}"), &[1], &bytes)?;
        }
        let options = StreamOptions::default();
        seed("prefix", name, &[1], &write_prefix(&model, &options)?)?;
        stream_seeds(&Server::new(&model, &options)?, name)?;
        for (at, format) in [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb, Format::Gltf]
            .into_iter()
            .enumerate()
        {
            let name = format!("{name}-{format:?}").to_lowercase();
            seed("meshes", &name, &[0, at as u8], &write_bytes(format, &mesh)?)?;
        }
    }
    seed_model::<WaveletMesh>(&shapes::icosphere(2), "sphere", |mesh| Ok(WaveletMesh::bake(mesh)?))?;
    // Text of other kinds than the writers'.
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    seed("meshes", "text-ply", &[0, 1], ply.as_bytes())?;
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    seed("meshes", "text-stl", &[0, 2], stl.as_bytes())
}

/// Requests and packets of a flight, one after the other.
fn stream_seeds(server: &Server, name: &str) -> Outcome<()> {
    let mut session = server.session();
    let mut client =
        Client::new(ClientOptions::default(), |vertex: multires::stream::StreamVertex<'_>| vertex.position());
    let (mut requests, mut packets) = (Vec::new(), Vec::new());
    for eye in [[0.0, 0.3, 6.0], [0.5, 0.3, 1.6], [0.0, 0.3, 9.0], [0.5, 0.3, 1.5]] {
        let camera = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
        let view = View::perspective(camera, 1.0, [1920, 1080])?.with_tolerance_px(0.5);
        client.adapt(&[view.of_world()], 0.0);
        let request = client.request();
        session.receive(&request)?;
        requests.extend(request);
        while let Some(packet) = session.packet(400) {
            client.receive(&packet)?;
            packets.extend(packet);
        }
    }
    seed("packets", name, &[1], &packets)?;
    seed("requests", name, &[1], &requests)
}
