//! `multires build`: all levels of detail of a mesh in a baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::gmesh::{Gmesh, GmeshOptions};
use multires::hierarchy::{Dependencies, HierarchyOptions, VertexHierarchy};
use multires::io::{BakeOptions, Compression, Stored};
use multires::lod::{FromSequence, Structure as _};
use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, Normals, NormalsDone, Target};
use multires::tom::{TomOptions, TotallyOrderedMesh};
use multires::view::ErrorShape;
use multires::wavelet::{Component, ErrorBound, WaveletError, WaveletMesh, WaveletOptions, recognise_uneven};
use serde_json::{Value, json};

use crate::batches::{Independent, Sequence};
use crate::facts::Facts;
use crate::model::Model;
use crate::output::{Answer, Failure, Run, Table};
use crate::progress::Bar;
use crate::remesh::{Base, Deep, Remeshed};
use crate::rules::{self, Given, Place, share};
use crate::{batches, files, simplify};

/// Bake all levels of detail of a mesh into one file.
///
/// The totally ordered mesh (tom) needs endpoint placement, which is then the default for every metric. The vertex hierarchy
/// (hierarchy) takes any placement; --placement optimal with --metric lindstrom-turk, then its default, draws the fewest triangles.
/// Berkey and Song's system is --metric edge-length --placement midpoint --order batched
/// --dependencies neighbours, with --radius in `adapt` and `fly`.
///
/// The g-mesh (gmesh) has few levels that turn into each other, for objects drawn many times. Batches that nearly halve the
/// mesh are then the default, and each is a level.
///
/// Wavelets (wavelet) are for meshes made by four-to-one subdivision of coarser meshes. Nothing is simplified: the coarsest
/// such mesh is found, and every vertex above it is a wavelet. With --remesh any mesh is first made such a mesh, as by the
/// command `remesh`.
#[derive(Args, Clone)]
pub struct Build {
    /// The mesh file to read.
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The baked file to write.
    #[arg(value_name = "OUT.mres")]
    output: PathBuf,
    /// Structure to build.
    #[arg(long, value_name = "S", value_enum)]
    structure: Structure,
    /// Vertices that must be active before a hierarchy's split, besides its own: none, those that keep every cut of a manifold mesh
    /// a manifold, the vertices of its triangles and of the triangles beside them, or all neighbours at the time of simplification
    /// [default: none].
    #[arg(long, value_name = "D", value_enum)]
    dependencies: Option<Needs>,
    /// Errors covered by a wavelet's bounds: all possible errors, or errors of leaving out all wavelets of its level and finer
    /// levels (Azuma et al.), for fewer triangles and no proof [default: conservative].
    #[arg(long, value_name = "B", value_enum)]
    bound: Option<Bound>,
    /// Shape around a wavelet's errors: a spheroid, or a sphere with two cones (Hoppe) [default: spheroid].
    #[arg(long, value_name = "E", value_enum)]
    shape: Option<Shape>,
    /// Largest share of the triangles kept from a level of a g-mesh to the next, above 0 to 0.9 [default: 0.65].
    #[arg(long, value_name = "R", value_parser = share)]
    level_share: Option<f64>,
    /// Stop simplifying at this many triangles [default: at the base mesh].
    #[arg(long, value_name = "N")]
    coarsest: Option<usize>,
    /// Compress the file to less than half its size. It then takes longer to open, since its arrays are not used in place.
    #[arg(long)]
    compress: bool,
    /// Remesh first: for wavelets of a mesh without subdivision connectivity.
    #[arg(long)]
    remesh: bool,
    #[command(flatten)]
    deep: Deep,
    #[command(flatten)]
    base: Base,
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
    /// Geomorph mesh: few levels that turn into each other in a vertex shader.
    Gmesh,
    /// Wavelets over subdivision connectivity: fine where a view needs it, and nothing slides.
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

/// How near cuts stay to meshes seen by the simplifier.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Needs {
    None,
    Manifold,
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
        only_for(self.dependencies.is_some(), "--dependencies", Structure::Hierarchy, "hierarchy")?;
        only_for(self.bound.is_some(), "--bound", Structure::Wavelet, "wavelet")?;
        only_for(self.shape.is_some(), "--shape", Structure::Wavelet, "wavelet")?;
        only_for(self.remesh, "--remesh", Structure::Wavelet, "wavelet")?;
        if !self.remesh && (self.deep.is_given() || !self.base.is_default()) {
            let reason = "--levels, --error, --error-percent, --base, --features, --smoothing and --fitting are for --remesh";
            return Err(Failure::Usage(reason.to_owned()));
        }
        only_for(self.level_share.is_some(), "--level-share", Structure::Gmesh, "gmesh")?;
        match self.structure {
            Structure::Tom => {
                let place = self.given.rules.placement.unwrap_or(Place::Endpoint);
                if place != Place::Endpoint || self.given.rules.batches.makes_vertices() {
                    let reason = "--structure tom needs --placement endpoint: substitution of vertices makes no new ones";
                    return Err(Failure::Usage(reason.to_owned()));
                }
                self.of_sequence::<TotallyOrderedMesh>(place, &TomOptions::default())
            }
            Structure::Hierarchy => {
                let dependencies = match self.dependencies {
                    None | Some(Needs::None) => Dependencies::None,
                    Some(Needs::Manifold) => Dependencies::Manifold,
                    Some(Needs::Adjacent) => Dependencies::Adjacent,
                    Some(Needs::Neighbours) => Dependencies::Neighbours,
                };
                let options = HierarchyOptions::default().with_dependencies(dependencies);
                let mut build = self.clone();
                // The fewest triangles drawn.
                if self.given.metric().is_none() && self.given.rules.place() == Place::Optimal {
                    build.given.rules.metric = "lindstrom-turk".to_owned();
                }
                build.of_sequence::<VertexHierarchy>(self.given.rules.place(), &options)
            }
            Structure::Gmesh => {
                let mut build = self.clone();
                let batches = &mut build.given.rules.batches;
                batches.order.get_or_insert(Sequence::Batched);
                if batches.is_batched() {
                    batches.independence.get_or_insert(Independent::Matching);
                }
                let options = GmeshOptions::default();
                let options = self.level_share.map_or(options, |share| options.with_share(share as f32));
                build.of_sequence::<Gmesh>(self.given.rules.place(), &options)
            }
            Structure::Wavelet => self.wavelet(),
        }
    }
}

/// Note on a mesh held up by its normals.
const HARD_EDGES: &str = "every face has normals of its own, so that edges can hardly go: --normals drop leaves them out, \
    for a renderer that shades by face";

/// A mesh, and its simplification down to the base mesh.
struct Simplified {
    /// The input file, for JSON and for people.
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
        // Vertices of a structure are fixed, so their normals are the input's.
        let mut simplifier = self.given.rules.simplifier(place, Normals::Keep)?;
        if let Some(triangles) = self.coarsest {
            simplifier = simplifier.target(Target::Triangles(triangles));
        }
        let sequence = simplifier.run_with(&mesh, |progress| bar.show(progress)).map_err(Failure::input)?;
        let mut notes = imported.notes;
        if Normals::Automatic.resolve(&mesh) != Ok(NormalsDone::Kept) {
            notes.push(HARD_EDGES.to_owned());
        }
        Ok(Simplified { input, input_text, notes, mesh, sequence, start })
    }

    /// Bakes a model from a simplification with a placement.
    fn of_sequence<S: FromSequence + Stored>(
        &self,
        place: Place,
        options: &S::Options,
    ) -> Result<Answer, Failure> {
        let Simplified { input, input_text, notes, mesh, sequence, start } = self.simplified(place)?;
        let bar = Bar::new("building");
        let baked = S::bake_sequence(&mesh, &sequence, options, &mut |share| bar.share(share));
        drop(bar);
        let baked = baked.map_err(Failure::input)?;
        let report = sequence.report();
        let mut members = vec![
            ("steps", json!(sequence.len())),
            ("stop", json!(rules::stop_name(report.stop))),
            ("refusals", json!(rules::refusals(report))),
            ("given_up", json!(rules::given_up(report))),
            ("parts_removed", json!(report.parts_removed)),
        ];
        members.extend(self.given.rules.describe(place));
        if self.given.rules.batches.is_batched() {
            members.push(("batches", batches::list(&mesh, &sequence)));
        }
        let mut rows = Table::default();
        if let Some(given_up) = rules::given_up_text(report) {
            rows.row("gave", given_up);
        }
        rows.row("by", self.given.rules.describe_text(place));
        self.answer(Built { model: Model(Box::new(baked)), start, input, input_text, notes, members, rows })
    }

    fn wavelet(&self) -> Result<Answer, Failure> {
        let (used, does): (&[_], _) = match self.remesh {
            true => (&["drop", "weld", "metric"], "--remesh simplifies by rules of its own"),
            false => (&["drop", "weld"], "--structure wavelet simplifies nothing"),
        };
        self.given.check_unused(used, does)?;
        if self.coarsest.is_some() {
            return Err(Failure::Usage(format!("--coarsest: {does}")));
        }
        if self.remesh {
            self.deep.check()?;
        }
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
        let mut notes = imported.notes;
        if self.remesh {
            let how = (&self.deep, &self.base, self.given.metric());
            let Remeshed { baked, members, rows, warnings, .. } =
                Remeshed::new(&mesh, how, &options).map_err(|failure| failure.about(&self.input))?;
            notes.extend(warnings);
            let members = vec![("remesh", members.into_iter().collect())];
            let model = Model(Box::new(baked));
            return self.answer(Built { model, start, input, input_text, notes, members, rows });
        }
        let bar = Bar::new("building");
        let baked = WaveletMesh::bake_with(&mesh, &options, |share| bar.share(share));
        drop(bar);
        let baked = baked.map_err(|error| match error {
            WaveletError::NoConnectivity { .. } => {
                Failure::Input(format!("{}: {error}; {WAY_OUT}", self.input.display()))
            }
            _ => Failure::Input(format!("{}: {error}", self.input.display())),
        })?;
        let components = recognise_uneven(&mesh).components;
        notes.extend(rigid(&components));
        let members = vec![("components", components.iter().map(component).collect())];
        let mut rows = Table::default();
        for component in components.iter().take(LISTED) {
            rows.row("component", component);
        }
        if components.len() > LISTED {
            rows.row("component", format!("... {} in all", components.len()));
        }
        self.answer(Built { model: Model(Box::new(baked)), start, input, input_text, notes, members, rows })
    }

    /// Writes the model built, and describes it.
    fn answer(&self, built: Built) -> Result<Answer, Failure> {
        let Built { model, start, input, input_text, notes, members, rows } = built;
        let seconds = start.elapsed().as_secs_f64();
        let compression = if self.compress { Compression::Lz4 } else { Compression::None };
        let options = BakeOptions::default().with_compression(compression);
        model.0.write_with(&self.output, options).map_err(|error| files::baked(&self.output, &error))?;
        let bytes = files::size(&self.output);
        let facts = Facts::new(&model);
        let mut json = json!({
            "command": "build",
            "structure": model.0.kind(),
            "input": input,
            "output": { "path": self.output.display().to_string(), "bytes": bytes },
            "seconds": seconds,
            "warnings": notes,
        });
        simplify::add(&mut json, facts.members);
        simplify::add(&mut json, members);
        let mut table = Table::default();
        table.row("input", input_text);
        table.row("output", format!("{}: {bytes} bytes", self.output.display()));
        table.block(facts.rows.text());
        table.block(rows.text());
        table.row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings: notes, failures: Vec::new() })
    }
}

/// The model built, and facts to report besides.
struct Built {
    model: Model,
    start: Instant,
    input: Value,
    input_text: String,
    notes: Vec<String>,
    members: Vec<(&'static str, Value)>,
    rows: Table,
}

/// Advice for a mesh without subdivision connectivity.
const WAY_OUT: &str = "--remesh --levels 4 makes one of any mesh; --structure hierarchy and --structure tom take any mesh as \
                       it is; or subdivide a coarse one (Loop, midpoint), or --drop materials whose borders are in the way";

/// Most components listed for people; the rest are counted.
const LISTED: usize = 12;

/// Describes a component, for JSON.
fn component(component: &Component) -> Value {
    json!({
        "triangles": component.triangles,
        "levels": component.levels,
        "base_faces": component.base_faces,
        "uneven": component.uneven,
        "first_triangle": component.first_triangle,
        "stop": component.stop.to_string(),
    })
}

/// Describes components without levels, drawn whole from everywhere.
fn rigid(components: &[Component]) -> Option<String> {
    let rigid = || components.iter().filter(|component| component.levels == 0);
    let largest = rigid().max_by_key(|component| component.triangles)?;
    let triangles: u64 = rigid().map(|component| u64::from(component.triangles)).sum();
    let (count, all) = (rigid().count(), components.len());
    Some(format!(
        "{count} of {all} components are no subdivisions: {triangles} triangles in the base mesh, the largest {largest}"
    ))
}
