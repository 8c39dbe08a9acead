//! Game assets: seams, hard edges, materials and cards, simplified by every contender on the same arrays.
//!
//! | file | idea |
//! |---|---|
//! | `options.rs` | the arguments |
//! | `model.rs` | the arrays that every contender gets |
//! | `contender.rs` | who takes part: **add a setting here** |
//! | `measure.rs` | distance, normals, texture sliding; `picture.rs`: what is seen; `validity.rs`: what no renderer can use |
//! | `table.rs` | rows, and geometric means against the best of the other simplifier's settings |
//! | `reach.rs` | how far down every model of a folder goes |
//!
//! ```text
//! for each model, for each percentage:
//!     every contender: the runs, their least CPU time, the level's measures
//! for each percentage, for each measure:
//!     ours / best of the other simplifier's settings that reached the target and did not ruin the model
//! ```

mod contender;
mod measure;
mod model;
mod options;
mod picture;
pub(crate) mod reach;
mod table;
mod validity;

use std::error::Error;

use multires::mesh::shapes;

use crate::clock::timed;
use contender::{CONTENDERS, Contender};
use measure::Reference;
use model::Model;
pub(crate) use options::Options;
use table::{Row, Table};

/// Samples on the faces of each mesh.
const SAMPLES: usize = 40_000;

pub(crate) fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut models = Vec::new();
    for path in &options.models {
        models.push(model::read(path).map_err(|e| format!("{}: {e}", path.display()))?);
    }
    if options.generated {
        models.extend(generated()?);
    }
    if let Some(weights) = options.weights {
        models = models.into_iter().map(|model| model.with_weights(weights)).collect();
    }
    if let Some(directory) = &options.out {
        std::fs::create_dir_all(directory)?;
    }
    let wanted = |c: &&Contender| options.only.is_empty() || options.only.iter().any(|name| name == c.name);
    let contenders: Vec<&Contender> = CONTENDERS.iter().filter(wanted).collect();
    let mut table = Table::default();
    for model in &models {
        measure(model, &contenders, options, &mut table)?;
    }
    if options.json {
        println!("{}", table.json(&options.percents));
    } else {
        table.print_summary(&options.percents);
    }
    Ok(())
}

/// Models from formulas, for whoever has no others.
fn generated() -> Result<Vec<Model>, Box<dyn Error>> {
    let all = [
        ("demo", shapes::demo()),
        ("prop", shapes::prop(40)),
        ("robot", shapes::robot(8)),
        ("tree", shapes::tree(1_500)),
        ("flat-rock", shapes::flat_rock(4_000, 1)),
        ("skinned-tube", shapes::skinned_tube(48, 60)),
        ("painted-disc", shapes::painted_disc(64, 24)),
    ];
    all.iter().map(|(name, mesh)| Model::new(name, mesh)).collect()
}

fn measure(
    model: &Model,
    contenders: &[&Contender],
    options: &Options,
    table: &mut Table,
) -> Result<(), Box<dyn Error>> {
    let reference = Reference::new(model, options.samples, true)?;
    let triangles = model.mesh.triangles().len();
    if let Some(directory) = &options.out {
        save(directory, &format!("{}.original", model.name), &model.mesh, &reference, options.view)?;
    }
    for &percent in &options.percents {
        let target = (triangles as f64 * percent / 100.0).floor() as usize;
        for contender in contenders {
            let mut least = f64::INFINITY;
            let mut output = None;
            for _ in 0..options.runs {
                let (result, [thread, _]) = timed(|| (contender.run)(model, target));
                output = Some(result?);
                least = least.min(thread);
            }
            let Some(output) = output else { continue };
            let level = output.into_mesh(model)?;
            let row = Row {
                model: model.name.clone(),
                of: triangles,
                contender: contender.name,
                peer: contender.peer,
                percent,
                target,
                measures: reference.measure(&level)?,
                ms: least,
            };
            if !options.json {
                row.print(table.is_empty());
            }
            table.push(row);
            if let Some(directory) = &options.out {
                let name = format!("{}.{}.{percent}", model.name, contender.name);
                save(directory, &name, &level, &reference, options.view)?;
            }
        }
    }
    Ok(())
}

/// Writes a level as PLY, and its picture as PPM.
fn save(
    directory: &std::path::Path,
    name: &str,
    level: &multires::mesh::Mesh,
    reference: &Reference<'_>,
    view: usize,
) -> Result<(), Box<dyn Error>> {
    let path = directory.join(format!("{name}.ply"));
    multires::io::write(&path, level).map_err(|e| format!("{}: {e}", path.display()))?;
    if let Some(pictures) = reference.pictures() {
        let path = directory.join(format!("{name}.ppm"));
        let mut bytes = format!("P6\n{0} {0}\n255\n", picture::SIDE).into_bytes();
        bytes.extend(pictures.picture(level, view));
        std::fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}
