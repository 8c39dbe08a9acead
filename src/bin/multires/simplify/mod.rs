//! `multires simplify`: levels of detail from meshes.
//!
//! ```text
//!     one file, any format    mesh_file.rs    all meshes of a file as one
//!     glTF to glTF            document.rs     every mesh of a document for itself, all else kept
//!     many files              batch.rs        each as one of the above, on all cores
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `level.rs` | a level of a mesh, and what is known of it |
//! | `asked.rs`, `told.rs` | what is asked for of all meshes of a document, and what is said about it |
//! | `common_error.rs` | a number of triangles shared by meshes so that all have the same error |
//! | `report.rs` | a page about what was done |
//! | `posed.rs` | errors in poses of skins and morph targets |

mod asked;
mod batch;
mod common_error;
mod document;
mod level;
mod mesh_file;
mod posed;
mod report;
mod told;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use multires::io::Format;
use multires::mesh::{Mesh, names};
use multires::simplify::{AttributeDeviation, Target};
use serde_json::{Value, json};

use crate::extract::round_down;
use crate::files;
use crate::output::{Answer, Failure, Run};
use crate::rules::{self, Rules, not_negative, share};

/// Simplify a mesh until a target is reached; with several targets, the first reached.
///
/// Seams, materials, borders and the topology are kept as far as a size asked for allows: see --permissive. If no legal
/// collapse is left before the target is reached, the mesh is written in that state, and a warning names the rules in the
/// way.
///
/// From glTF to glTF, every mesh is simplified for itself, with the same error in the scene, and all else of the document
/// stays: nodes, skins, animations, morph targets, materials, pictures, extras. Numbers asked for are for all meshes together.
#[derive(Args)]
pub struct Simplify {
    /// The mesh file to read and the one to write, which may be the same; with --out, all files to read.
    #[arg(value_names = ["IN", "OUT"], num_args = 1.., required = true)]
    files: Vec<PathBuf>,
    /// Read many files, and write each under its name to this folder, several at a time; a line a file.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the files written to the folder of --out: an extension [default: each as it was].
    #[arg(long, value_name = "EXT", requires = "out")]
    format: Option<String>,
    #[command(flatten)]
    targets: Targets,
    /// Leave parts as large as they are where others like them vanished, instead of letting them grow to cover as much.
    #[arg(long)]
    no_growth: bool,
    #[command(flatten)]
    rules: Rules,
    /// Attribute values of the written mesh: fitted to the whole surface of the input (fitted), or its vertices' values in
    /// the input (kept).
    #[arg(long, value_name = "V", value_enum, default_value_t = Values::Fitted)]
    attribute_values: Values,
    /// Form of --levels: the extension MSFT_lod and a name for each level in a single file (msft-lod, names: glTF only), or a
    /// file for each level [default: msft-lod for glTF, else files].
    #[arg(long, value_name = "F", value_enum, requires = "levels")]
    level_form: Option<LevelForm>,
    /// Write a page about what was done: pictures before and after, sizes, errors, what stood in the way.
    #[arg(long, value_name = "PAGE.html")]
    report: Option<PathBuf>,
    /// Poses of an animated mesh that count in its simplification and in which its error is measured: those that bend it most.
    #[arg(long, value_name = "N", default_value_t = 4)]
    poses: usize,
}

/// How several levels are written.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum LevelForm {
    MsftLod,
    Names,
    Files,
}

/// Source of attribute values.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Values {
    Fitted,
    Kept,
}

impl Values {
    fn name(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::Kept => "kept",
        }
    }
}

#[derive(Args, Clone)]
#[group(required = true, multiple = true)]
struct Targets {
    /// Several levels at once: shares of the triangles in percent, falling.
    #[arg(long, value_name = "P,...", value_delimiter = ',', value_parser = share_in_percent)]
    levels: Vec<f64>,
    /// At most this many triangles.
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// At most this many vertices.
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// At most this share of the triangles, 0 to 1.
    #[arg(long, value_name = "R", value_parser = share)]
    ratio: Option<f64>,
    /// As few triangles as possible while the error stays within this, object units.
    #[arg(long, value_name = "E", value_parser = not_negative)]
    error: Option<f64>,
    /// As few triangles as possible while the error stays within this, in percent of the diagonal of the mesh's box.
    #[arg(long, value_name = "P", value_parser = not_negative)]
    error_percent: Option<f64>,
    /// At most this many bytes as an indexed mesh with 32-bit indices, all attributes and 4 bytes a number.
    #[arg(long, value_name = "B")]
    bytes: Option<usize>,
}

/// Parses a share in percent.
fn share_in_percent(text: &str) -> Result<f64, String> {
    let parsed = text.trim().parse::<f64>().ok().filter(|x| (0.0..=100.0).contains(x));
    parsed.map(|x| x / 100.0).ok_or_else(|| "not a number from 0 to 100".to_owned())
}

impl Targets {
    /// Returns the targets of a mesh of its own.
    fn list(&self, mesh: &Mesh) -> Vec<Target> {
        let per_vertex = rules::bytes_per_vertex(mesh);
        let absolute = |percent: f64| percent / 100.0 * mesh.diagonal();
        let targets = [
            self.triangles.map(Target::Triangles),
            self.vertices.map(Target::Vertices),
            self.ratio.map(Target::Ratio),
            self.error.map(|e| Target::Error(round_down(e))),
            self.error_percent.map(|p| Target::Error(round_down(absolute(p)))),
            self.bytes.map(|bytes| Target::Bytes { bytes, per_vertex }),
        ];
        targets.into_iter().flatten().collect()
    }
}

impl Targets {
    /// Checks what no parser of a single argument sees.
    fn check(&self) -> Result<(), Failure> {
        let others = [self.triangles.is_some(), self.vertices.is_some(), self.bytes.is_some()];
        let others = others.contains(&true) || self.ratio.or(self.error).or(self.error_percent).is_some();
        if self.levels.is_empty() {
            return Ok(());
        }
        if others {
            return Err(Failure::Usage("--levels: sizes of their own; no other target".to_owned()));
        }
        if self.levels.windows(2).any(|pair| pair[0] <= pair[1]) {
            return Err(Failure::Usage("--levels: not falling".to_owned()));
        }
        Ok(())
    }
}

impl Run for Simplify {
    fn run(&self) -> Result<Answer, Failure> {
        self.targets.check()?;
        if let Some(page) = &self.report {
            files::check_output(page, "html")?;
        }
        let answer = match (&self.out, &self.files[..]) {
            (Some(folder), inputs) => batch::run(self, inputs, folder)?,
            (None, [input, output]) => self.one(input, output)?,
            (None, [_]) => return Err(Failure::Usage("the file to write is missing".to_owned())),
            _ => return Err(Failure::Usage("more than two files: --out DIR says where they go".to_owned())),
        };
        if let Some(page) = &self.report {
            let many = answer.json["files"].as_array();
            let answers = many.map_or(std::slice::from_ref(&answer.json), Vec::as_slice);
            report::write(page, answers, &answer.failures)?;
        }
        Ok(answer)
    }
}

impl Simplify {
    /// Simplifies a file.
    fn one(&self, input: &Path, output: &Path) -> Result<Answer, Failure> {
        files::check_mesh_output(output)?;
        let is_gltf = |path: &Path| matches!(Format::from_path(path), Some(Format::Glb | Format::Gltf));
        if is_gltf(input) && is_gltf(output) {
            document::run(self, input, output)
        } else {
            mesh_file::run(self, input, output)
        }
    }
}

/// Describes an attribute's deviation, for JSON.
fn deviation(d: &AttributeDeviation) -> Value {
    json!({ "name": d.name, "mean": d.mean, "max": d.max, "unit": unit(&d.name) })
}

/// Returns the unit of a deviation.
fn unit(name: &str) -> &'static str {
    match name {
        names::NORMAL => "degrees",
        _ if names::is_set_of(name, names::UV) => "object units",
        _ => "of a channel",
    }
}

/// Adds members to an object.
pub fn add(json: &mut Value, members: impl IntoIterator<Item = (&'static str, Value)>) {
    if let Some(object) = json.as_object_mut() {
        object.extend(members.into_iter().map(|(key, value)| (key.to_owned(), value)));
    }
}
