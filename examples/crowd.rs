//! A thousand objects in one frame: geomorph meshes under a bias, totally ordered meshes under stress.
//!
//! ```text
//! cargo run --release --example crowd
//! ```
//!
//! The first part flies around and through a crowd of 1,000 instances of a g-mesh (10,000 to 200 triangles), as they are and
//! with the number of triangles held by [`Bias`](multires::control::Bias) (Southern, Figs. 6.7 and 6.10). The second part flies
//! along a street of totally ordered meshes of 1.15 million triangles with the time of a simulated card held by
//! [`Stress`](multires::control::Stress) (Bouvier and Gobbetti, Fig. 9). No clock and no card take part, so all figures but the
//! last are the same on every machine. Charts of the same flights: `docs/results/control.md`.

#[path = "support/crowd.rs"]
mod crowd;

use std::time::Instant;

use multires::control::Stairs;
use multires::gmesh::{GmeshBuilder, GmeshLod, Partition};
use multires::mesh::shapes;
use multires::prelude::*;

fn main() -> Result<(), multires::Error> {
    // Once: a model of few levels, and how T is divided among them.
    let rock = shapes::rock(10_000, 5);
    let simplifier = Gmesh::simplifier().target(Target::Triangles(200));
    let model = GmeshBuilder::new().simplifier(simplifier).bake(&rock)?;
    let gmesh = model.structure();
    let partition = Partition::by_error(gmesh);
    let stairs = Stairs::of_gmesh(gmesh, &partition)?;
    let levels: Vec<String> = gmesh.levels().iter().map(|level| level.triangles.to_string()).collect();
    println!("levels of {} triangles", levels.join(", "));

    println!("\ntriangles of 1,000 objects, wanted to within {}", stairs.largest_step());
    println!(
        "path                 wanted    change a frame   mean       least      most       frames inside"
    );
    for (name, path, wanted) in crowd::PATHS {
        for change in [None, Some(0.01), Some(0.1)] {
            let drawn: Vec<usize> =
                crowd::biased(&stairs, path, change, wanted).iter().map(|frame| frame.0).collect();
            let inside = drawn.iter().filter(|drawn| drawn.abs_diff(wanted) <= stairs.largest_step()).count();
            let mean = drawn.iter().sum::<usize>() / drawn.len();
            let [least, most] =
                [drawn.iter().min(), drawn.iter().max()].map(|n| n.copied().unwrap_or_default());
            let change = change.map_or("no control".to_owned(), |change| change.to_string());
            println!(
                "{name:<20} {wanted:<9} {change:<16} {mean:<10} {least:<10} {most:<10} {inside} of {}",
                drawn.len()
            );
        }
    }

    println!("\nstress: 100 ms, alpha 0.4, loads of 0.5 to 1");
    let street = TotallyOrderedMesh::bake(&shapes::rock(crowd::STRESSED[1] as u32, 6))?;
    let tom = street.structure();
    let frames = crowd::stressed(|asked| tom.at(Level::Triangles(asked)).triangles());
    println!("frame   complexity   drawn     load   stress");
    for (number, frame) in frames.iter().enumerate().step_by(20) {
        let crowd::Stressed { complexity, drawn, load, stress } = frame;
        println!("{number:<7} {complexity:<12} {drawn:<9} {load:<6.2} {stress:.2}");
    }
    let above = frames.iter().filter(|frame| frame.load > 1.0).count();
    println!("{above} of {} frames above a load of 1", frames.len());

    // What the processor does a frame: a number for each object. Vertices move in a shader.
    let values = model.arrange(rock.positions())?;
    let shared = LodOptions::default().with_buffer(VertexBuffer::Shared);
    let instances: Result<Vec<GmeshLod<_>>, _> =
        (0..1_000).map(|_| model.instance(values.clone(), &shared)).collect();
    let mut instances = instances?;
    let mut objects = Vec::new();
    let crowd = crowd::Crowd::new(10);
    let (mut triangles, start) = (0, Instant::now());
    for frame in 0..crowd::FRAMES {
        crowd.objects(&stairs, crowd::circle(frame), &mut objects);
        for (lod, object) in instances.iter_mut().zip(&objects) {
            triangles += lod.show(partition.at(object.parameter_at(0.2))).triangles;
        }
    }
    let each = start.elapsed().as_secs_f64() * 1e6 / crowd::FRAMES as f64;
    println!(
        "\n1,000 instances placed and shown in {each:.0} us a frame, {} triangles",
        triangles / crowd::FRAMES
    );
    Ok(())
}
