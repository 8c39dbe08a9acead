//! `multires build`: all levels of detail of a mesh in one baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::hierarchy::{Dependencies, HierarchyMesh};
use multires::io;
use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, Normals, NormalsDone};
use multires::tom::TomMesh;
use multires::view::ErrorShape;
use multires::wavelet::{
    Component, ErrorBound, WaveletError, WaveletMesh, WaveletOptions, recognise_across_seams,
};
use serde_json::{Value, json};

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::progress::Bar;
use crate::rules::{self, Given, Place};
use crate::{files, info, simplify};

/// Bake all levels of detail of a mesh into one file.
///
/// The totally ordered mesh (tom) needs endpoint placement, which is then the default for every metric. The vertex
/// hierarchy (hierarchy) takes any. Berkey and Song's system is --metric edge-length --placement midpoint --order batched
/// --dependencies neighbours, with --radius where it is looked at.
///
/// Wavelets (wavelet) are for meshes that are four-to-one subdivisions of coarser ones. Nothing is simplified: the coarsest such
/// mesh is found, and every vertex above it is a wavelet.
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
    /// Which errors bounds of a wavelet hold: all that can come about, or those of leaving out all wavelets of its level and finer
    /// ones (Azuma et al.), which gives fewer triangles and no proof [default: conservative].
    #[arg(long, value_name = "B", value_enum)]
    bound: Option<Bound>,
    /// The shape around errors of a wavelet: a spheroid, or a sphere with two cones (Hoppe) [default: spheroid].
    #[arg(long, value_name = "E", value_enum)]
    shape: Option<Shape>,
    #[command(flatten)]
    given: Given,
}

/// A multiresolution structure.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Structure {
    /// Totally ordered mesh: any level of detail of the whole object.
    Tom,
    /// Vertex hierarchy: fine where a view needs it.
    Hierarchy,
    /// Wavelets over subdivision connectivity: the same, and nothing slides.
    Wavelet,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Bound {
    Conservative,
    WithoutSiblings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    Spheroid,
    Hoppe,
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
        if let Some(Normals::Recompute { .. }) = self.given.rules.normals {
            let reason = "--normals recompute: vertices of a structure are fixed, and so are their normals";
            return Err(Failure::Usage(reason.to_owned()));
        }
        files::check_output(&self.output, "mres")?;
        let only_for = |given: bool, option: &str, structure: Structure, name: &str| {
            if given && self.structure != structure {
                return Err(Failure::Usage(format!("{option} is for --structure {name}")));
            }
            Ok(())
        };
        only_for(self.dependencies.is_some(), "--dependencies", Structure::Hierarchy, HierarchyMesh::KIND)?;
        only_for(self.bound.is_some(), "--bound", Structure::Wavelet, WaveletMesh::KIND)?;
        only_for(self.shape.is_some(), "--shape", Structure::Wavelet, WaveletMesh::KIND)?;
        match self.structure {
            Structure::Tom => self.tom(),
            Structure::Hierarchy => self.hierarchy(),
            Structure::Wavelet => self.wavelet(),
        }
    }
}

/// Said of a mesh that its normals hold.
const HARD_EDGES: &str = "every face has normals of its own, so that edges can hardly go: --normals drop leaves them out, \
    for a renderer that shades by face";

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
        let mesh = self.given.rules.prepared(imported.mesh)?;
        let start = Instant::now();
        let bar = Bar::new("simplifying");
        // Vertices of a structure are fixed, so their normals are those of the input.
        let mut simplifier = self.given.rules.simplifier(place, Normals::Keep)?;
        let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
        let mut notes = imported.notes;
        if Normals::Automatic.resolve(&mesh) != Ok(NormalsDone::Kept) {
            notes.push(HARD_EDGES.to_owned());
        }
        Ok(Simplified { input, input_text, notes, mesh, sequence, start })
    }

    fn tom(&self) -> Result<Answer, Failure> {
        let place = self.given.rules.placement.unwrap_or(Place::Endpoint);
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
            "given_up": rules::given_up(sequence.report()),
            "parts_removed": sequence.report().parts_removed,
            "seconds": seconds,
            "warnings": notes,
        });
        simplify::add(&mut json, self.given.rules.describe(place));

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
        if let Some(given_up) = rules::given_up_text(sequence.report()) {
            table.row("gave", given_up);
        }
        table.row("by", self.given.rules.describe_text(place));
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings: notes })
    }
    fn hierarchy(&self) -> Result<Answer, Failure> {
        let place = self.given.rules.place();
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
            "given_up": rules::given_up(sequence.report()),
            "parts_removed": sequence.report().parts_removed,
            "seconds": seconds,
            "warnings": notes,
        });
        simplify::add(&mut json, info::hierarchy(&bundle));
        simplify::add(&mut json, self.given.rules.describe(place));

        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", format!("{}: {bytes} bytes", self.output.display()));
        info::hierarchy_rows(&mut table, &bundle);
        if let Some(given_up) = rules::given_up_text(sequence.report()) {
            table.row("gave", given_up);
        }
        table.row("by", self.given.rules.describe_text(place));
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings: notes })
    }

    fn wavelet(&self) -> Result<Answer, Failure> {
        self.given.check_unused("--structure wavelet simplifies nothing")?;
        let imported = files::read_mesh(&self.input)?;
        let input = files::describe(&self.input, &imported.mesh);
        let input_text = files::describe_text(&self.input, &imported.mesh);
        let mesh = self.given.rules.prepared(imported.mesh)?;
        let bound = match self.bound {
            None | Some(Bound::Conservative) => ErrorBound::Conservative,
            Some(Bound::WithoutSiblings) => ErrorBound::WithoutSiblings,
        };
        let shape = match self.shape {
            None | Some(Shape::Spheroid) => ErrorShape::Spheroid,
            Some(Shape::Hoppe) => ErrorShape::SphereAndCones,
        };
        let options = WaveletOptions::default().with_bound(bound).with_shape(shape);
        let start = Instant::now();
        let bundle = WaveletMesh::recognise(&mesh, &options).map_err(|error| match error {
            WaveletError::NoConnectivity { .. } => {
                Failure::Input(format!("{}: {error}; {WAY_OUT}", self.input.display()))
            }
            _ => Failure::Input(format!("{}: {error}", self.input.display())),
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let components = recognise_across_seams(&mesh).components;
        io::write_baked(&self.output, WaveletMesh::KIND, &bundle)
            .map_err(|error| files::baked(&self.output, &error))?;

        let mut warnings = imported.notes;
        warnings.extend(rigid(&components));
        let bytes = files::size(&self.output);
        let mut json = json!({
            "command": "build",
            "structure": WaveletMesh::KIND,
            "input": input,
            "output": { "path": self.output.display().to_string(), "bytes": bytes },
            "components": components.iter().map(component).collect::<Vec<_>>(),
            "seconds": seconds,
            "warnings": warnings,
        });
        simplify::add(&mut json, info::wavelet(&bundle));

        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", format!("{}: {bytes} bytes", self.output.display()));
        for component in components.iter().take(LISTED) {
            table.row("component", component);
        }
        if components.len() > LISTED {
            table.row("component", format!("... {} in all", components.len()));
        }
        info::wavelet_rows(&mut table, &bundle);
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings })
    }
}

/// What to do with a mesh that is no subdivision.
const WAY_OUT: &str = "--structure hierarchy and --structure tom take any mesh; or subdivide a coarse one (Loop, midpoint), \
                       or --drop materials whose borders are in the way";

/// Components that are listed for people; more are counted.
const LISTED: usize = 12;

/// A component for JSON.
fn component(component: &Component) -> Value {
    json!({
        "triangles": component.triangles,
        "levels": component.levels,
        "base_faces": component.base_faces,
        "first_triangle": component.first_triangle,
        "stop": component.stop.to_string(),
    })
}

/// Of components that have no levels, and are drawn whole from everywhere.
fn rigid(components: &[Component]) -> Option<String> {
    let rigid = || components.iter().filter(|component| component.levels == 0);
    let largest = rigid().max_by_key(|component| component.triangles)?;
    let triangles: u64 = rigid().map(|component| u64::from(component.triangles)).sum();
    let (count, all) = (rigid().count(), components.len());
    Some(format!(
        "{count} of {all} components are no subdivisions: {triangles} triangles in the base mesh, the largest {largest}"
    ))
}
