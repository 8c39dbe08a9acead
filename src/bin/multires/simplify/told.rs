//! What is said about a document that was simplified.

use std::path::{Path, PathBuf};

use multires::io::GltfDocument;
use multires::mesh::names;
use multires::simplify::StopReason;
use serde_json::{Value, json};

use super::deviation;
use super::document::{Made, Part, name, totals};
use crate::files;
use crate::output::{Table, error_text, percent};
use crate::rules::{self, Rules};

/// Most meshes listed for people; the rest are counted.
const LISTED: usize = 16;

/// A document that was simplified.
pub struct Told<'a> {
    pub document: &'a GltfDocument,
    pub parts: &'a [Part],
    /// Levels, finest first, each of all parts.
    pub levels: &'a [Vec<Made>],
    /// A file for each level, or one for all.
    pub written: &'a [PathBuf],
    /// Triangles of the input.
    pub triangles: usize,
    /// Largest diagonal of a mesh, scene units.
    pub diagonal: f64,
}

impl Told<'_> {
    /// Says which meshes have more triangles than asked for, and why.
    pub fn stuck(&self, is_sized: bool) -> Vec<String> {
        let made = self.parts.iter().zip(self.levels.last().into_iter().flatten());
        let stuck = made.filter(|(part, made)| {
            let stop = part.sequence.report().stop;
            let is_at_end = made.steps == part.sequence.len();
            // Four triangles are as few as a closed part has.
            let is_stuck = matches!(stop, StopReason::NothingLegal | StopReason::Guard);
            is_sized && is_at_end && is_stuck && made.level.mesh.triangles().len() > 4
        });
        let line = |(part, made): (&Part, &Made)| {
            let left = made.level.mesh.triangles().len();
            let obstacles = Rules::obstacles(part.sequence.report());
            format!("{}: stopped at {left} triangles: {obstacles}", name(self.document, part.index))
        };
        stuck.map(line).collect()
    }

    /// Describes each level: for people in the table, for JSON in the result.
    pub fn describe(&self, table: &mut Table) -> Vec<Value> {
        (0..self.levels.len()).map(|level| self.level(table, level)).collect()
    }

    fn level(&self, table: &mut Table, number: usize) -> Value {
        let levels = &self.levels[number];
        let [vertices, left] = totals(levels.iter().map(|made| &made.level.mesh));
        let path = self.written.get(number).or(self.written.last());
        let path = path.map(|path| path.display().to_string()).unwrap_or_default();
        let percent_of = |error: f64| percent(error, self.diagonal);
        let largest = |of: &dyn Fn(&Part, &Made) -> f64| {
            let scaled = self.parts.iter().zip(levels).map(|(part, made)| part.scale * of(part, made));
            scaled.fold(0.0, f64::max)
        };
        let error = largest(&|_, made| f64::from(made.level.error));
        let surface = largest(&|part, made| part.sequence.surface_error_after(made.steps).into());
        let curves = largest(&|part, made| part.sequence.curve_error_after(made.steps).into());
        let posed = largest(&|_, made| made.poses.iter().map(|pose| pose.error).fold(0.0, f64::max));
        let share = percent(left as f64, self.triangles as f64);
        table.row("output", format!("{path}: {vertices} vertices, {left} triangles"));
        table.row("kept", format!("{:.2} % of the triangles", share.unwrap_or(100.0)));
        table.row("error", error_text(error, percent_of(error)));
        let any_poses = levels.iter().any(|made| !made.poses.is_empty());
        if any_poses {
            table.row("in poses", error_text(posed, percent_of(posed)));
        }
        let meshes = self.parts.iter().zip(levels).map(|(part, made)| self.mesh(part, made));
        json!({
            "output": { "path": path, "bytes": files::size(Path::new(&path)), "vertices": vertices, "triangles": left },
            "ratio": share.map(|p| p / 100.0),
            "error": error,
            "error_percent": percent_of(error),
            "surface_error": surface,
            "curve_error": curves,
            "pose_error": any_poses.then_some(posed),
            "meshes": meshes.collect::<Vec<_>>(),
        })
    }

    fn mesh(&self, part: &Part, made: &Made) -> Value {
        let report = part.sequence.report();
        let at_end = made.steps == part.sequence.len();
        let Made { level, poses, .. } = made;
        let has_fewer = level.mesh.triangles().len() < part.mesh.triangles().len();
        let deviations = level.deviations.iter().filter(|d| !d.name.starts_with(names::DISPLACEMENT));
        json!({
            "mesh": part.index,
            "name": self.document.mesh_name(part.index),
            "triangles": level.mesh.triangles().len(),
            "input_triangles": part.mesh.triangles().len(),
            "vertices": level.mesh.positions().len(),
            "scale": part.scale,
            "error": f64::from(level.error) * part.scale,
            "poses": poses.iter().map(|pose| pose.json(part.scale)).collect::<Vec<_>>(),
            "attribute_deviations": deviations.map(deviation).collect::<Vec<_>>(),
            "stop": if at_end { rules::stop_name(report.stop) } else { "target" },
            "given_up": if at_end && has_fewer { rules::given_up(report) } else { Value::Null },
            "parts_grown": level.growth.parts,
        })
    }

    /// Lists the meshes for people.
    pub fn list(&self, table: &mut Table) {
        if self.parts.len() < 2 {
            return;
        }
        for (p, part) in self.parts.iter().enumerate().take(LISTED) {
            let left = self.levels.iter().map(|level| level[p].level.mesh.triangles().len().to_string());
            let left = left.collect::<Vec<_>>().join(", ");
            let text = format!("{} -> {left} triangles", part.mesh.triangles().len());
            let name = self.document.mesh_name(part.index);
            table.row(&format!("mesh {}", part.index), format!("{text}  {name}"));
        }
        if self.parts.len() > LISTED {
            table.row("meshes", format!("{} in all", self.parts.len()));
        }
    }
}
