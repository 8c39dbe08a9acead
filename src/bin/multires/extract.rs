//! `multires extract`: a level of detail out of a baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use multires::Baked;
use multires::adapt::Refinements;
use multires::gmesh::{Gmesh, Morph};
use multires::lod::{Extracted, Level};
use multires::wavelet::{Normals, WaveletMesh};
use serde_json::json;

use crate::model::{Model, Style};
use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::rules::{not_negative, share};
use crate::{facts, files};

/// Write a level of detail from a baked file as a mesh.
///
/// The result is the finest level that does not exceed the arguments, and never less than the base mesh; the answer describes
/// it. For hierarchies and wavelet meshes, a number of triangles takes the splits or wavelets with the largest bounds, as many
/// as fit.
#[derive(Args)]
pub struct Extract {
    /// The baked file.
    #[arg(value_name = "IN.mres")]
    input: PathBuf,
    /// The mesh file to write.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    asked: Asked,
    #[command(flatten)]
    style: Style,
    /// Normals of a wavelet mesh's level: the finest level's (kept), or from the level's triangles [default: kept].
    #[arg(long, value_name = "K", value_enum)]
    normals: Option<Source>,
}

/// Source of normals.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Source {
    Kept,
    Recomputed,
}

#[derive(Args)]
#[group(required = true, multiple = false)]
struct Asked {
    /// At most this many triangles.
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// At most this many vertices.
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// At most this share of all triangles, 0 to 1.
    #[arg(long, value_name = "R", value_parser = share)]
    ratio: Option<f64>,
    /// The coarsest level with a known error of at most this, object units.
    #[arg(long, value_name = "E", value_parser = not_negative)]
    error: Option<f64>,
    /// The coarsest level with a known error of at most this, in percent of the diagonal of the mesh's box.
    #[arg(long, value_name = "P", value_parser = not_negative)]
    error_percent: Option<f64>,
    /// From 0, the coarsest level, to 1, the finest: this share of the vertices beyond the base mesh. For a wavelet mesh, the
    /// number of a level, from 0, the base mesh. For a g-mesh, the number of a level, from 0, the finest; with a fraction, the
    /// share of the way to the next level.
    #[arg(long, value_name = "T", value_parser = level)]
    level: Option<f64>,
}

impl Asked {
    /// Returns the level asked for, of a model that is no wavelet mesh.
    fn level(&self, model: &Model) -> Result<Level, Failure> {
        if self.level.is_some_and(|level| level > 1.0) {
            return Err(Failure::Usage("--level of this structure is from 0 to 1".to_owned()));
        }
        Ok(if let Some(triangles) = self.triangles {
            Level::Triangles(triangles)
        } else if let Some(vertices) = self.vertices {
            Level::Vertices(vertices)
        } else if let Some(ratio) = self.ratio {
            Level::Triangles((ratio * model.0.triangle_counts()[0] as f64) as usize)
        } else if let Some(error) = self.error {
            Level::Error(round_down(error))
        } else if let Some(percent) = self.error_percent {
            Level::Error(round_down(percent / 100.0 * model.diagonal()))
        } else {
            let base = facts::coarsest(model).mesh.positions().len();
            let every = model.0.finest_vertex_count();
            let share = self.level.unwrap_or(1.0);
            Level::Vertices(base + (share * every.saturating_sub(base) as f64).round() as usize)
        })
    }

    /// Returns the wavelets asked for: a flag for each wavelet, closed under parents.
    fn wavelets(&self, mesh: &WaveletMesh, style: &Style) -> Result<Vec<bool>, Failure> {
        let of = mesh.subdivision();
        let at_tolerance = |tolerance: f64| {
            let tolerance = round_down(tolerance);
            mesh.closure(|wavelet| mesh.bounds(wavelet).largest_error() > tolerance)
        };
        Ok(if let Some(vertices) = self.vertices {
            mesh.largest_within_vertices(vertices, style.triangulation())
        } else if let Some(triangles) = self.triangles {
            mesh.largest_within(triangles, style.triangulation())
        } else if let Some(ratio) = self.ratio {
            mesh.largest_within((ratio * of.triangle_count() as f64) as usize, style.triangulation())
        } else if let Some(error) = self.error {
            at_tolerance(error)
        } else if let Some(percent) = self.error_percent {
            at_tolerance(percent / 100.0 * mesh.diagonal())
        } else {
            let level = self.level.unwrap_or_default();
            if level.fract() != 0.0 {
                return Err(Failure::Usage("--level of a wavelet mesh is a whole number".to_owned()));
            }
            let level = (level as usize).min(of.depth());
            let end = of.wavelets_of(level).end;
            (0..of.wavelet_count() as u32).map(|wavelet| wavelet < end).collect()
        })
    }
}

/// Parses a share, or the number of a level.
fn level(text: &str) -> Result<f64, String> {
    not_negative(text).map_err(|_| "not a number from 0 to 1, nor the number of a level".to_owned())
}

/// Returns the nearest single-precision number not above `x`, for promises of "at most".
pub fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

impl Run for Extract {
    fn run(&self) -> Result<Answer, Failure> {
        files::check_mesh_output(&self.output)?;
        let model = Model::read(&self.input)?;
        if let Some(wavelets) = model.0.as_any().downcast_ref::<Baked<WaveletMesh>>() {
            return self.wavelet(&model, wavelets.structure());
        }
        self.style.check(&model)?;
        if self.normals.is_some() {
            return Err(Failure::Usage("--normals is for wavelet meshes".to_owned()));
        }
        let start = Instant::now();
        let (mesh, error) = match (model.0.as_any().downcast_ref::<Baked<Gmesh>>(), self.asked.level) {
            (Some(gmesh), Some(level)) => {
                let state =
                    gmesh.structure().clamped(Morph { level: level as usize, share: level.fract() as f32 });
                (gmesh.mesh_at(state), gmesh.structure().error(state))
            }
            _ => {
                let Extracted { mesh, error, .. } = model.0.level(self.asked.level(&model)?);
                (mesh, error)
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        files::write_mesh(&self.output, &mesh)?;

        let diagonal = model.diagonal();
        let [all, _] = model.0.triangle_counts();
        let coarsest = facts::coarsest(&model);
        let base = &coarsest.mesh;
        let error_percent = percent(f64::from(error), diagonal);
        let of = percent(mesh.triangles().len() as f64, all as f64);
        let json = json!({
            "command": "extract",
            "input": {
                "path": self.input.display().to_string(),
                "bytes": files::size(&self.input),
                "finest": facts::counts(model.0.finest_vertex_count(), all, 0.0, diagonal),
                "coarsest":
                    facts::counts(base.positions().len(), base.triangles().len(), coarsest.error, diagonal),
            },
            "output": files::describe(&self.output, &mesh),
            "ratio": of.map(|p| p / 100.0),
            "error": error,
            "error_percent": error_percent,
            "seconds": seconds,
        });
        let mut table = Table::default();
        table.row("input", self.input.display());
        table.row("output", files::describe_text(&self.output, &mesh));
        table.row("of the finest", format!("{:.2} % of the triangles", of.unwrap_or(100.0)));
        table.row("error", error_text(f64::from(error), error_percent));
        Ok(Answer { json, text: table.text(), warnings: Vec::new(), failures: Vec::new() })
    }
}

impl Extract {
    fn wavelet(&self, model: &Model, bundle: &WaveletMesh) -> Result<Answer, Failure> {
        let of = bundle.subdivision();
        let normals = match self.normals {
            None | Some(Source::Kept) => Normals::Kept,
            Some(Source::Recomputed) => Normals::Recomputed,
        };
        let start = Instant::now();
        let set = self.asked.wavelets(bundle, &self.style)?;
        let mesh = bundle.extract(|wavelet| set[wavelet as usize], self.style.triangulation(), normals);
        let seconds = start.elapsed().as_secs_f64();
        files::write_mesh(&self.output, &mesh)?;

        let error = bundle.largest_left_out(|wavelet| set[wavelet as usize]);
        let error_percent = percent(f64::from(error), bundle.diagonal());
        let count = set.iter().filter(|there| **there).count();
        let deepest = set.iter().rposition(|there| *there).map_or(0, |last| of.level_of(last as u32));
        let all = of.triangle_count();
        let ratio = percent(mesh.triangles().len() as f64, all as f64);
        let json = json!({
            "command": "extract",
            "input": {
                "path": self.input.display().to_string(),
                "bytes": files::size(&self.input),
                "triangles": all,
                "base_triangles": of.base_face_count(),
                "levels": of.depth(),
            },
            "output": files::describe(&self.output, &mesh),
            "ratio": ratio.map(|p| p / 100.0),
            "wavelets": count,
            "deepest_level": deepest,
            "error": error,
            "error_percent": error_percent,
            "bound": facts::bound(bundle),
            "triangulation": self.style.name(model),
            "normals": if normals == Normals::Kept { "kept" } else { "recomputed" },
            "seconds": seconds,
        });
        let mut table = Table::default();
        table.row("input", format!("{}: {all} triangles", self.input.display()));
        table.row("output", files::describe_text(&self.output, &mesh));
        table.row("of the finest", format!("{:.2} % of the triangles", ratio.unwrap_or(100.0)));
        table.row(
            "wavelets",
            format!("{count} of {}, down to level {deepest} of {}", of.wavelet_count(), of.depth()),
        );
        let error = error_text(f64::from(error), error_percent);
        table.row("error", format!("{error}, {} bound", facts::bound(bundle)));
        Ok(Answer { json, text: table.text(), warnings: Vec::new(), failures: Vec::new() })
    }
}
