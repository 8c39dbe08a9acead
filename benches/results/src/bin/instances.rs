//! Many instances of a large model: the table "Instances" of docs/performance.md.
//!
//! ```text
//! cargo run --release -p multires-results --bin instances [-- --triangles N]
//! ```
//!
//! Bakes a rock of N triangles (default 1,000,000) as a vertex hierarchy. Prints what an instance takes at its coarsest, near the eye,
//! and once it is far away again; and the time of a frame for a thousand instances far away while the eye stands still, turns, and
//! jumps, one by one and over all cores.

use std::error::Error;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use multires::hierarchy::HierarchyLod;
use multires::lod::{VertexBuffer, adapt_all};
use multires::mesh::shapes;
use multires::prelude::*;
use multires::view::{ObjectView, look_at};
use multires_results::say;

const USAGE: &str = "usage: instances [--triangles N]";
const TRIANGLES: u32 = 1_000_000;
const INSTANCES: usize = 1_000;
const FRAMES: usize = 200;
const SECONDS: f32 = 1.0 / 60.0;

type Position = [f32; 3];
/// Distance and angle of the eye, by frame.
type Flight = fn(usize) -> [f32; 2];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = match &arguments[..] {
        [] => Some(TRIANGLES),
        [flag, n] if flag == "--triangles" => n.parse().ok(),
        _ => None,
    };
    let Some(count) = count else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    say::to_stdout(|says| run(count, says))
}

/// Returns the view of an instance `distance` ahead, by an eye turned by an angle.
fn view(distance: f32, turned: f32) -> Result<ObjectView, Box<dyn Error>> {
    let to = [distance * turned.sin(), 0.0, -distance * turned.cos()];
    let view = View::perspective(look_at([0.0; 3], to, [0.0, 1.0, 0.0]), 1.0, [1920, 1080])?;
    let mut place = glam::Mat4::IDENTITY;
    place.w_axis.z = -distance;
    Ok(view.of_object(place.to_cols_array_2d())?)
}

fn run(count: u32, says: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let mesh = shapes::rock(count, 1);
    let start = Instant::now();
    let model = VertexHierarchy::bake(&mesh)?;
    let triangles = model.structure().triangle_count();
    writeln!(
        says,
        "{triangles} triangles, {} at the coarsest; baked in {:.1} s; shared {:.1} MB",
        model.structure().base_triangle_count(),
        start.elapsed().as_secs_f64(),
        model.structure().memory() as f64 / 1e6
    )?;
    let values = model.arrange(mesh.positions())?;
    let takes = |lod: &HierarchyLod<Position>| size_of_val(lod) + lod.memory();

    writeln!(says, "\nan instance         triangles      bytes   a triangle")?;
    for (name, buffer) in [("packed", VertexBuffer::Packed), ("shared buffer", VertexBuffer::Shared)] {
        let options = LodOptions::default().with_buffer(buffer);
        let mut lod = model.instance(values.clone(), &options)?;
        let start = Instant::now();
        let other = model.instance(values.clone(), &options)?;
        let made = start.elapsed().as_secs_f64() * 1e6;
        drop(other);
        let mut say = |what: &str, lod: &HierarchyLod<Position>| {
            let (drawn, bytes) = (lod.surface().triangle_count(), takes(lod));
            writeln!(says, "{what:<18} {drawn:>10} {bytes:>10} {:>12.1}", bytes as f64 / drawn as f64)
        };
        say(&format!("{name}, new"), &lod)?;
        for distance in [100.0, 10.0, 2.0] {
            lod.clean();
            lod.adapt(&[view(distance, 0.0)?], SECONDS);
            say(&format!("  at {distance}"), &lod)?;
        }
        lod.refine_fully();
        say("  whole", &lod)?;
        lod.adapt(&[], SECONDS);
        lod.clean();
        // Memory is given back after a while.
        for _ in 0..1_100 {
            lod.adapt(&[view(1_000.0, 0.0)?], SECONDS);
        }
        say("  far again", &lod)?;
        writeln!(says, "  made in {made:.0} us")?;
    }

    let options = LodOptions::default();
    let lods: Result<Vec<_>, _> = (0..INSTANCES).map(|_| model.instance(values.clone(), &options)).collect();
    let mut lods = lods?;
    writeln!(says, "\n{INSTANCES} instances, us a frame   one by one   all cores   tests   changes")?;
    let flights: [(&str, Flight); 4] = [
        ("far away, still", |_| [1_000.0, 0.0]),
        ("far away, turning", |frame| [1_000.0, 0.001 * frame as f32]),
        ("at 30, still", |_| [30.0, 0.0]),
        ("at 30, nearing", |frame| [30.0 - 0.05 * frame as f32, 0.0]),
    ];
    for (name, flight) in flights {
        let mut each = [0.0; 2];
        let (mut tests, mut changes) = (0, 0);
        for (together, each) in [false, true].into_iter().zip(&mut each) {
            let mut times = Vec::new();
            for frame in 0..FRAMES {
                let [distance, turned] = flight(frame);
                let views: Result<Vec<_>, _> = (0..INSTANCES)
                    .map(|at| Ok::<_, Box<dyn Error>>([view(distance + 0.1 * at as f32, turned)?]))
                    .collect();
                let views = views?;
                let start = Instant::now();
                let made = if together {
                    adapt_all(lods.iter_mut().zip(&views).map(|(lod, views)| (lod, &views[..])), SECONDS)
                } else {
                    lods.iter_mut().zip(&views).map(|(lod, views)| lod.adapt(views, SECONDS)).collect()
                };
                times.push(start.elapsed().as_secs_f64() * 1e6);
                if frame > 0 {
                    tests += made.iter().map(|change| change.cut.tests).sum::<usize>();
                    changes +=
                        made.iter().map(|change| change.cut.splits + change.cut.collapses).sum::<usize>();
                }
            }
            times.sort_unstable_by(f64::total_cmp);
            *each = times[FRAMES / 2];
        }
        let frames = 2 * (FRAMES - 1);
        writeln!(
            says,
            "{name:<32} {:>10.0} {:>11.0} {:>7} {:>9}",
            each[0],
            each[1],
            tests / frames,
            changes / frames
        )?;
    }
    let bytes: usize = lods.iter().map(takes).sum();
    let drawn: usize = lods.iter().map(|lod| lod.surface().triangle_count()).sum();
    writeln!(says, "{INSTANCES} instances draw {drawn} triangles and take {:.1} MB", bytes as f64 / 1e6)?;
    Ok(())
}
