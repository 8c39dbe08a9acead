//! `multires extract`: a level of detail out of a baked file.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use multires::tom::{Level, TomMesh};
use serde_json::json;

use crate::output::{Answer, Failure, Run, Table, error_text, percent};
use crate::rules::{not_negative, share};
use crate::{files, info};

/// Write a level of detail from a baked file as a mesh.
///
/// What comes out is the finest level that does not exceed what is asked for, and never less than the base mesh; the
/// answer says which one it is.
#[derive(Args)]
pub struct Extract {
    /// The baked file.
    #[arg(value_name = "IN.mres")]
    input: PathBuf,
    /// The mesh file to write.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    level: Asked,
}

#[derive(Args)]
#[group(required = true, multiple = false)]
struct Asked {
    /// At most so many triangles.
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// At most so many vertices.
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// At most this share of all triangles, 0 to 1.
    #[arg(long, value_name = "R", value_parser = share)]
    ratio: Option<f64>,
    /// The coarsest level known to err by at most this, object units.
    #[arg(long, value_name = "E", value_parser = not_negative)]
    error: Option<f64>,
    /// The coarsest level known to err by at most this, in percent of the diagonal of the mesh's box.
    #[arg(long, value_name = "P", value_parser = not_negative)]
    error_percent: Option<f64>,
    /// From 0, the coarsest level, to 1, the finest: this share of the vertices that are not in the base mesh.
    #[arg(long, value_name = "T", value_parser = share)]
    level: Option<f64>,
}

impl Asked {
    fn level(&self, bundle: &TomMesh, diagonal: f64) -> Level {
        let tom = bundle.tom();
        let base = tom.coarsest().vertices();
        let every = tom.vertex_count();
        if let Some(triangles) = self.triangles {
            Level::Triangles(triangles)
        } else if let Some(vertices) = self.vertices {
            Level::Vertices(vertices)
        } else if let Some(ratio) = self.ratio {
            Level::Triangles((ratio * tom.triangle_count() as f64) as usize)
        } else if let Some(error) = self.error {
            Level::Error(round_down(error))
        } else if let Some(percent) = self.error_percent {
            Level::Error(round_down(percent / 100.0 * diagonal))
        } else {
            let share = self.level.unwrap_or(1.0);
            Level::Vertices(base + (share * (every - base) as f64).round() as usize)
        }
    }
}

/// The nearest single-precision number that is not above, for promises of "at most".
pub fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

impl Run for Extract {
    fn run(&self) -> Result<Answer, Failure> {
        files::check_mesh_output(&self.output)?;
        let bundle = files::read_tom(&self.input)?;
        let tom = bundle.tom();
        let diagonal = bundle.mesh_at(tom.finest()).diagonal();

        let start = Instant::now();
        let resolution = tom.at(self.level.level(&bundle, diagonal));
        let mesh = bundle.mesh_at(resolution);
        let seconds = start.elapsed().as_secs_f64();
        files::write_mesh(&self.output, &mesh)?;

        let error = f64::from(resolution.error());
        let error_percent = percent(error, diagonal);
        let of = percent(mesh.triangles().len() as f64, tom.triangle_count() as f64);
        let json = json!({
            "command": "extract",
            "input": {
                "path": self.input.display().to_string(),
                "bytes": files::size(&self.input),
                "finest": info::level(tom.finest(), diagonal),
                "coarsest": info::level(tom.coarsest(), diagonal),
            },
            "output": files::describe(&self.output, &mesh),
            "ratio": of.map(|p| p / 100.0),
            "error": resolution.error(),
            "error_percent": error_percent,
            "seconds": seconds,
        });
        let mut table = Table::default();
        table.row("input", self.input.display());
        table.row("output", files::describe_text(&self.output, &mesh));
        table.row("of the finest", format!("{:.2} % of the triangles", of.unwrap_or(100.0)));
        table.row("error", error_text(error, error_percent));
        Ok(Answer { json, text: table.text(), warnings: Vec::new() })
    }
}
