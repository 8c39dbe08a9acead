//! Sends models to clients that have nothing, and counts.
//!
//! ```text
//! cargo run --release -p multires-results --bin streaming [-- --triangles N]   a model that the crate makes itself, of 100,000
//! cargo run --release -p multires-results --bin streaming -- FILE... [--sessions N] [--out DIR]
//! ```
//!
//! For each model, positions alone:
//!
//! | part | what |
//! |---|---|
//! | whole | bytes of the first picture (1 % of the triangles), and of all of it, by bits of a position |
//! | flight | splits and collapses sent along a flight: from the coarsest mesh for every view, with coherence, and with a cache |
//! | sessions | time of a round of packets for N (100) sessions at different places of the flight, on one core, and their memory |
//!
//! Leaves `flight.csv` and `flight.svg` in `target/streaming/` (or DIR): triangles along the flight with splits alone, and with
//! collapses too (Southern, Fig. 5.6).

use std::error::Error;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use glam::DVec3;
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::{Client, ClientOptions, Server, Session, StreamOptions, StreamVertex};
use multires::view::ObjectView;
use multires::{Baked, io};
use multires_results::chart::{self, Panel};
use multires_results::flight::{self, VIEWPORT};
use multires_results::say::{grouped, name_file};

const USAGE: &str = "usage: streaming [FILE...] [--triangles N] [--sessions N] [--out DIR]";

type Positions = Client<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

fn client(options: ClientOptions) -> Positions {
    Client::new(options, |vertex| vertex.position())
}

/// A view that needs everything.
fn everything() -> Result<ObjectView, Box<dyn Error>> {
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let view = View::perspective(identity, 1.0, VIEWPORT)?;
    Ok(view.with_frustum(false).with_back_faces_culled(false).with_tolerance_px(0.0).of_world())
}

/// Sends until nothing is left. Returns the bytes of the packets.
fn exchange(session: &mut Session, client: &mut Positions, budget: usize) -> Result<usize, Box<dyn Error>> {
    let mut bytes = 0;
    loop {
        session.receive(&client.request())?;
        let Some(packet) = session.packet(budget) else { return Ok(bytes) };
        bytes += packet.len();
        client.receive(&packet)?;
        client.clean();
    }
}

fn whole(model: &Baked<VertexHierarchy>, says: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let (vertices, triangles) = (model.structure().leaf_count(), model.structure().triangle_count());
    // Binary PLY: 12 bytes a vertex, 13 a triangle.
    let ply = 12 * vertices + 13 * triangles;
    writeln!(
        says,
        "{} vertices, {} triangles, {} bytes as binary PLY",
        grouped(vertices),
        grouped(triangles),
        grouped(ply)
    )?;
    writeln!(
        says,
        "{:>8} {:>14} {:>8} {:>14} {:>10} {:>10} {:>10}",
        "bits", "first picture", "% PLY", "whole", "bytes/v", "encode ms", "decode ms"
    )?;
    let bits = [("10", Some(10)), ("12", Some(12)), ("14", Some(14)), ("16", Some(16)), ("exact", None)];
    for (name, bits) in bits {
        let server = Server::new(model, &StreamOptions::default().with_position_bits(bits))?;
        let mut session = server.session();
        let mut client = client(ClientOptions::default().with_cache_share(0.0));
        let mut options = LodOptions::default();
        options.triangles = Some(triangles / 100);
        client.set_options(&options)?;
        client.adapt(&[everything()?], 0.0);
        let first = exchange(&mut session, &mut client, 1 << 16)?;
        client.set_options(&LodOptions::default())?;
        let mut all = first;
        let [mut encode, mut decode] = [0.0; 2];
        loop {
            session.receive(&client.request())?;
            let start = Instant::now();
            let Some(packet) = session.packet(1 << 16) else { break };
            encode += start.elapsed().as_secs_f64() * 1e3;
            all += packet.len();
            let start = Instant::now();
            client.receive(&packet)?;
            decode += start.elapsed().as_secs_f64() * 1e3;
            client.clean();
        }
        if client.triangles(0).len() != triangles {
            return Err("not all triangles came".into());
        }
        writeln!(
            says,
            "{name:>8} {:>14} {:>8.2} {:>14} {:>10.2} {encode:>10.0} {decode:>10.0}",
            grouped(first),
            100.0 * first as f64 / ply as f64,
            grouped(all),
            all as f64 / vertices as f64
        )?;
    }
    Ok(())
}

fn views(mesh: &Mesh) -> Result<Vec<ObjectView>, Box<dyn Error>> {
    let poses = flight::approach(DVec3::Y);
    poses.iter().step_by(2).map(|pose| Ok(pose.about(mesh).view(VIEWPORT)?.of_world())).collect()
}

/// One way to follow a flight.
struct Way {
    name: &'static str,
    /// Begins anew for every view.
    forgets: bool,
    options: ClientOptions,
}

fn fly(
    model: &Baked<VertexHierarchy>,
    views: &[ObjectView],
    says: &mut impl Write,
) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let server = Server::new(model, &StreamOptions::default().with_position_bits(Some(12)))?;
    let none = ClientOptions::default().with_cache_share(0.0);
    let ways = [
        Way { name: "every view anew", forgets: true, options: none },
        Way { name: "splits alone", forgets: false, options: none.with_keeps(true) },
        Way { name: "coherence", forgets: false, options: none },
        Way { name: "and a cache of 5 %", forgets: false, options: ClientOptions::default() },
    ];
    writeln!(
        says,
        "{:>20} {:>10} {:>10} {:>10} {:>12} {:>12}",
        "flight of 300 views", "splits", "cached", "collapses", "bytes", "triangles"
    )?;
    let mut curves = Vec::new();
    for way in ways {
        let (mut session, mut client) = (server.session(), client(way.options));
        let (mut counts, mut curve) = ([0; 4], Vec::new());
        let mut add = |session: &Session, before: [usize; 4]| {
            let now = session.counts();
            let now = [now.splits, now.cached, now.collapses, now.bytes];
            counts = std::array::from_fn(|at| counts[at] + now[at] - before[at]);
            now
        };
        let mut before = [0; 4];
        for view in views {
            if way.forgets {
                (session, client) = (server.session(), self::client(way.options));
                before = [0; 4];
            }
            client.adapt(std::slice::from_ref(view), 0.0);
            exchange(&mut session, &mut client, 1 << 16)?;
            before = add(&session, before);
            curve.push(client.triangles(0).len() as f64);
        }
        let mean = curve.iter().sum::<f64>() / curve.len() as f64;
        writeln!(
            says,
            "{:>20} {:>10} {:>10} {:>10} {:>12} {mean:>12.0}",
            way.name,
            counts[0],
            counts[1],
            counts[2],
            grouped(counts[3])
        )?;
        curves.push(curve);
    }
    Ok(curves)
}

fn sessions(
    model: &Baked<VertexHierarchy>,
    views: &[ObjectView],
    count: usize,
    says: &mut impl Write,
) -> Result<(), Box<dyn Error>> {
    let server = Server::new(model, &StreamOptions::default().with_position_bits(Some(12)))?;
    let mut options = LodOptions::default();
    options.triangles = Some(5_000);
    let mut pairs: Vec<(Session, Positions, usize)> = Vec::new();
    for number in 0..count {
        let mut client = client(ClientOptions::default());
        client.set_options(&options)?;
        pairs.push((server.session(), client, number * views.len() / count));
    }
    let (mut worst, mut all, mut bytes) = (0.0_f64, Vec::new(), 0);
    for round in 0..60 {
        for (session, client, at) in &mut pairs {
            client.adapt(std::slice::from_ref(&views[(*at + 3 * round) % views.len()]), 0.0);
            session.receive(&client.request())?;
        }
        let start = Instant::now();
        let packets: Vec<Option<Vec<u8>>> =
            pairs.iter_mut().map(|(session, ..)| session.packet(8_192)).collect();
        let time = start.elapsed().as_secs_f64() * 1e3;
        if round >= 10 {
            worst = worst.max(time);
            all.push(time);
        }
        for ((_, client, _), packet) in pairs.iter_mut().zip(packets) {
            if let Some(packet) = packet {
                bytes += packet.len();
                client.receive(&packet)?;
                client.clean();
            }
        }
    }
    all.sort_unstable_by(f64::total_cmp);
    let memory = pairs.iter().map(|(session, ..)| session.memory()).max().unwrap_or(0);
    writeln!(
        says,
        "{count} sessions: a round of packets in {:.0} ms (median), {worst:.0} ms (worst); {} bytes a round; at most {} bytes a session; shared {:.0} bytes a vertex",
        all[all.len() / 2],
        grouped(bytes / 60),
        grouped(memory),
        server.memory() as f64 / model.structure().leaf_count() as f64
    )?;
    Ok(())
}

fn number(argument: Option<OsString>) -> Result<usize, Box<dyn Error>> {
    Ok(argument.and_then(|n| n.to_str()?.parse().ok()).ok_or(USAGE)?)
}

fn run() -> Result<(), Box<dyn Error>> {
    let (mut files, mut count, mut triangles) = (Vec::new(), 100, 100_000);
    let mut out = PathBuf::from("target/streaming");
    let mut arguments = std::env::args_os().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.to_str() {
            Some("--sessions") => count = number(arguments.next())?,
            Some("--triangles") => triangles = number(arguments.next())?,
            Some("--out") => out = arguments.next().ok_or(USAGE)?.into(),
            Some(text) if text.starts_with("--") => return Err(USAGE.into()),
            _ => files.push(PathBuf::from(argument)),
        }
    }
    let mut models = Vec::new();
    if files.is_empty() {
        models.push(("a rock".to_owned(), shapes::rock(triangles as u32, 1)));
    }
    for file in &files {
        let mesh = io::read(file).map_err(|error| name_file(file, &error))?;
        let mesh = Mesh::new(mesh.positions(), mesh.triangles())?;
        models.push((file.file_name().unwrap_or_default().to_string_lossy().into_owned(), mesh));
    }
    let mut says = std::io::stdout().lock();
    for (name, mesh) in &models {
        writeln!(says, "\n== {name}")?;
        let model = VertexHierarchy::bake(mesh)?;
        whole(&model, &mut says)?;
        let views = views(mesh)?;
        let curves = fly(&model, &views, &mut says)?;
        sessions(&model, &views, count, &mut says)?;
        std::fs::create_dir_all(&out)?;
        let mut csv = String::from("view,splits alone,splits and collapses\n");
        for (at, (alone, both)) in curves[1].iter().zip(&curves[2]).enumerate() {
            writeln!(csv, "{at},{alone},{both}")?;
        }
        std::fs::write(out.join("flight.csv"), csv)?;
        let lines = vec![
            ("splits alone", "#c8703a", curves[1].clone()),
            ("splits and collapses", "#2f6fab", curves[2].clone()),
        ];
        let panel = Panel { title: "triangles", lines, holds: 1.0 };
        std::fs::write(out.join("flight.svg"), chart::svg(&[panel], "view"))?;
    }
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
