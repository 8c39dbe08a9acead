//! `multires build`: all levels of detail of a mesh in one baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::hierarchy::{Dependencies, HierarchyMesh};
use multires::io;
use multires::mesh::Mesh;
use multires::simplify::CollapseSequence;
use multires::tom::TomMesh;
use serde_json::{Value, json};

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Place, Rules};
use crate::{files, info, simplify};

/// Bake all levels of detail of a mesh into one file.
///
/// The totally ordered mesh (tom) needs endpoint placement, which is then the default for every metric. The vertex
/// hierarchy (hierarchy) takes any. Berkey and Song's system is --metric edge-length --placement midpoint --order batched
/// --dependencies neighbours, with --radius where it is looked at.
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
    /// What a split of a hierarchy needs besides its own vertex: nothing, the vertices of its triangles and of those beside
    /// them, or all neighbours as the simplifier had them [default: none].
    #[arg(long, value_name = "D", value_enum)]
    dependencies: Option<Needs>,
    #[command(flatten)]
    rules: Rules,
}

/// A multiresolution structure.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Structure {
    /// Totally ordered mesh: any level of detail of the whole object.
    Tom,
    /// Vertex hierarchy: fine where a view needs it.
    Hierarchy,
}

/// How near cuts stay to meshes that the simplifier has seen.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Needs {
    None,
    Adjacent,
    Neighbours,
}

impl Run for Build {
    fn run(&self) -> Result<Answer, Failure> {
        self.rules.check()?;
        files::check_output(&self.output, "mres")?;
        match self.structure {
            Structure::Tom if self.dependencies.is_some() => {
                Err(Failure::Usage("--dependencies is for --structure hierarchy".to_owned()))
            }
            Structure::Tom => self.tom(),
            Structure::Hierarchy => self.hierarchy(),
        }
    }
}

/// A mesh, and its simplification down to the base mesh.
struct Simplified {
    /// The file that was read, for JSON and for people.
    input: Value,
    input_text: String,
    notes: Vec<String>,
    mesh: Mesh,
    sequence: CollapseSequence,
    start: Instant,
}

impl Build {
    fn simplified(&self, place: Place) -> Result<Simplified, Failure> {
        let imported = files::read_mesh(&self.input)?;
        let input = files::describe(&self.input, &imported.mesh);
        let input_text = files::describe_text(&self.input, &imported.mesh);
        let mesh = self.rules.dropped(imported.mesh)?;
        let start = Instant::now();
        let bar = Bar::new("simplifying");
        let mut simplifier = self.rules.simplifier(&mesh, place)?;
        let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
        Ok(Simplified { input, input_text, notes: imported.notes, mesh, sequence, start })
    }

    fn tom(&self) -> Result<Answer, Failure> {
        let place = self.rules.placement.unwrap_or(Place::Endpoint);
        if place != Place::Endpoint {
            let reason =
                "--structure tom needs --placement endpoint: substitution of vertices makes no new ones";
            return Err(Failure::Usage(reason.to_owned()));
        }
        let Simplified { input, input_text, notes, mesh, sequence, start } = self.simplified(place)?;
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
            "warnings": notes,
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
        Ok(Answer { json, text: table.text(), warnings: notes })
    }
    fn hierarchy(&self) -> Result<Answer, Failure> {
        let place = self.rules.place();
        let Simplified { input, input_text, notes, mesh, sequence, start } = self.simplified(place)?;
        let dependencies = match self.dependencies {
            None | Some(Needs::None) => Dependencies::None,
            Some(Needs::Adjacent) => Dependencies::Adjacent,
            Some(Needs::Neighbours) => Dependencies::Neighbours,
        };
        let bundle = HierarchyMesh::new(&mesh, &sequence, dependencies).map_err(Failure::input)?;
        let seconds = start.elapsed().as_secs_f64();
        io::write_baked(&self.output, HierarchyMesh::KIND, &bundle)
            .map_err(|error| files::baked(&self.output, &error))?;

        let bytes = files::size(&self.output);
        let mut json = json!({
            "command": "build",
            "structure": HierarchyMesh::KIND,
            "input": input,
            "output": { "path": self.output.display().to_string(), "bytes": bytes },
            "steps": sequence.len(),
            "stop": rules::stop_name(sequence.report().stop),
            "refusals": rules::refusals(sequence.report()),
            "seconds": seconds,
            "warnings": notes,
        });
        simplify::add(&mut json, info::hierarchy(&bundle));
        simplify::add(&mut json, self.rules.describe(place));

        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", format!("{}: {bytes} bytes", self.output.display()));
        info::hierarchy_rows(&mut table, &bundle);
        table.row("by", self.rules.describe_text(place));
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings: notes })
    }
}
