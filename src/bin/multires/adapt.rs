//! `multires adapt`: the mesh a view asks for, out of a baked structure.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use multires::adapt::Change;
use multires::lod::{Lod, LodOptions, VertexBuffer};
use multires::view::ObjectView;
use serde_json::json;

use crate::camera::{Camera, Point, point};
use crate::files;
use crate::model::{Model, Style};
use crate::output::{Answer, Failure, Run, Table, percent};

/// Write the mesh a view asks for, out of a baked model.
///
/// For a hierarchy and for wavelets: fine where the view needs it, coarse where it is far, outside the picture or faces away.
/// For a totally ordered mesh: the level asked for by its nearest point. Baked files are made by `build`.
#[derive(Args)]
pub struct Adapt {
    /// The baked file.
    #[arg(value_name = "IN.mres")]
    input: PathBuf,
    /// The mesh file to write.
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Position of the eye.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    eye: Point,
    /// Point the eye looks at.
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    target: Point,
    #[command(flatten)]
    camera: Camera,
    /// At most this many triangles, but never fewer than the base mesh has: all tolerances grow by a common factor until they
    /// fit.
    #[arg(long, value_name = "N")]
    budget: Option<usize>,
    #[command(flatten)]
    style: Style,
}

/// Bisection steps for the logarithm of a budget's factor on tolerances, and the largest such logarithm to base 2.
const HALVINGS: usize = 30;
const COARSEST: f64 = 64.0;

/// Adapts, as coarsely as the budget needs. Returns the factor on tolerances, and the change.
fn adapt(lod: &mut dyn Lod, view: &ObjectView, budget: Option<usize>) -> (f64, Change) {
    let mut at = |octaves: f64| lod.adapt(&[view.coarsened(octaves.exp2())], 0.0);
    let change = at(0.0);
    let budget = budget.unwrap_or(usize::MAX);
    if change.triangles <= budget {
        return (1.0, change);
    }
    let (mut fine, mut coarse) = (0.0, COARSEST);
    for _ in 0..HALVINGS {
        let middle = (fine + coarse) * 0.5;
        if at(middle).triangles <= budget { coarse = middle } else { fine = middle }
    }
    (coarse.exp2(), at(coarse))
}

impl Run for Adapt {
    fn run(&self) -> Result<Answer, Failure> {
        files::check_mesh_output(&self.output)?;
        let model = Model::read(&self.input)?;
        let place = self.camera.place(&model);
        let view = self.camera.view(&place, self.eye, self.target)?;

        let options = LodOptions::default().with_buffer(VertexBuffer::Shared);
        let mut lod = model.instance(&self.style, options)?;
        let start = Instant::now();
        let (factor, change) = adapt(&mut *lod, &view, self.budget);
        let seconds = start.elapsed().as_secs_f64();
        let mesh = lod.to_mesh();
        files::write_mesh(&self.output, &mesh)?;

        let [all, base] = model.0.triangle_counts();
        let of = percent(mesh.triangles().len() as f64, all as f64);
        let refinements = lod.refinements();
        let mut warnings = Vec::new();
        if self.budget.is_some_and(|budget| change.triangles > budget) {
            warnings.push(format!("{} triangles is as coarse as this view gets", change.triangles));
        }
        let json = json!({
            "command": "adapt",
            "input": {
                "path": self.input.display().to_string(),
                "bytes": files::size(&self.input),
                "triangles": all,
                "base_triangles": base,
            },
            "output": files::describe(&self.output, &mesh),
            "eye": self.eye,
            "target": self.target,
            "view": self.camera.describe(),
            "budget": self.budget,
            "coarsened": factor,
            "ratio": of.map(|p| p / 100.0),
            "triangulation": self.style.name(&model),
            "tests": change.cut.tests,
            "refinements": refinements,
            "seconds": seconds,
            "warnings": warnings,
        });
        let mut table = Table::default();
        table.row("input", format!("{}: {all} triangles", self.input.display()));
        table.row("output", files::describe_text(&self.output, &mesh));
        table.row("of the finest", format!("{:.2} % of the triangles", of.unwrap_or(100.0)));
        table.row("view", self.camera.describe_text());
        if factor > 1.0 {
            table.row("tolerances", format!("{factor:.3} times as large, for the budget"));
        }
        table.row("tests, refinements", format!("{}, {refinements}", change.cut.tests));
        Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
    }
}
