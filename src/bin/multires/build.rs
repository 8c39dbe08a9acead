//! `multires build`: all levels of detail of a mesh in one baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::io;
use multires::tom::TomMesh;
use serde_json::json;

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Place, Rules};
use crate::{files, info, simplify};

/// Bake all levels of detail of a mesh into one file.
///
/// The totally ordered mesh (tom) needs endpoint placement, which is then the default for every metric.
#[derive(Args)]
pub struct Build {
    /// The mesh file to read.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The baked file to write.
    #[arg(value_name = "OUT.mres")]
    output: PathBuf,
    /// What to build.
    #[arg(long, value_name = "S", value_enum)]
    structure: Structure,
    #[command(flatten)]
    rules: Rules,
}

/// A multiresolution structure.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Structure {
    /// Totally ordered mesh: any level of detail of the whole object.
    Tom,
}

impl Run for Build {
    fn run(&self) -> Result<Answer, Failure> {
        self.rules.check()?;
        files::check_output(&self.output, "mres")?;
        match self.structure {
            Structure::Tom => self.tom(),
        }
    }
}

impl Build {
    fn tom(&self) -> Result<Answer, Failure> {
        let place = self.rules.placement.unwrap_or(Place::Endpoint);
        if place != Place::Endpoint {
            let reason =
                "--structure tom needs --placement endpoint: substitution of vertices makes no new ones";
            return Err(Failure::Usage(reason.to_owned()));
        }
        let imported = files::read_mesh(&self.input)?;
        let input = files::describe(&self.input, &imported.mesh);
        let input_text = files::describe_text(&self.input, &imported.mesh);
        let mesh = self.rules.dropped(imported.mesh)?;

        let start = Instant::now();
        let bar = Bar::new("simplifying");
        let sequence = self
            .rules
            .simplifier(&mesh, place)?
            .run_with(&mesh, |progress| bar.show(progress))
            .map_err(Failure::input)?;
        drop(bar);
        let bundle = TomMesh::new(&mesh, &sequence).map_err(Failure::input)?;
        let seconds = start.elapsed().as_secs_f64();
        io::write_baked(&self.output, TomMesh::KIND, &bundle)
            .map_err(|error| files::baked(&self.output, &error))?;

        let tom = bundle.tom();
        let diagonal = mesh.diagonal();
        let share = percent(bundle.memory() as f64, bundle.plain_memory() as f64);
        let bytes = files::size(&self.output);
        let mut json = json!({
            "command": "build",
            "structure": TomMesh::KIND,
            "input": input,
            "output": { "path": self.output.display().to_string(), "bytes": bytes },
            "finest": info::level(tom.finest(), diagonal),
            "coarsest": info::level(tom.coarsest(), diagonal),
            "steps": sequence.len(),
            "memory": bundle.memory(),
            "memory_percent": share,
            "stop": rules::stop_name(sequence.report().stop),
            "refusals": rules::refusals(sequence.report()),
            "seconds": seconds,
            "warnings": imported.notes,
        });
        simplify::add(&mut json, self.rules.describe(place));

        let coarsest = tom.coarsest();
        let error = f64::from(coarsest.error());
        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", format!("{}: {bytes} bytes", self.output.display()));
        for (label, resolution) in [("finest", tom.finest()), ("coarsest", coarsest)] {
            let (vertices, triangles) = (resolution.vertices(), resolution.triangles());
            table.row(label, format!("{vertices} vertices, {triangles} triangles"));
        }
        table.row("error of coarsest", error_text(error, percent(error, diagonal)));
        let share = share.map_or(String::from("-"), |p| format!("{p:.1}"));
        table.row("memory", format!("{} bytes, {share} % of the plain mesh", bundle.memory()));
        table.row("by", self.rules.describe_text(place));
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings: imported.notes })
    }
}
