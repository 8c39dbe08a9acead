//! `multires fly`: a camera path over a baked structure, measured frame by frame.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use multires::io::atomic;
use multires::lod::{Lod, LodOptions, VertexBuffer};
use serde_json::{Value, json};

use crate::camera::Camera;
use crate::files;
use crate::model::{Model, Style};
use crate::output::{Answer, Failure, Run, Table};
use crate::path;

/// Fly along a camera path over a baked model, and write what every frame drew and cost.
///
/// A row a frame: frame, triangles and vertices drawn; tests, splits and collapses made; microseconds they took; bytes of
/// changed buffers to upload, vertices with all attributes of the mesh. The first frame starts from the base mesh, all of it
/// new. Splits and collapses of a wavelet mesh are wavelets coming and going, and its vertices change where a neighbour comes
/// or goes. Splits and collapses of a totally ordered mesh are vertices.
#[derive(Args)]
pub struct Fly {
    /// The baked file.
    #[arg(value_name = "IN.mres")]
    input: PathBuf,
    /// The camera path: # comments, a header line, then frame, eye x y z, target x y z, with commas.
    #[arg(long, value_name = "CAMERA.csv")]
    path: PathBuf,
    #[command(flatten)]
    camera: Camera,
    /// Keep the vertices in use packed in a buffer of their own, instead of all vertices in a shared buffer.
    #[arg(long)]
    packed: bool,
    /// At most this many triangles in any frame, but never fewer than the base mesh has: the most urgent for the view.
    #[arg(long, value_name = "N")]
    budget: Option<usize>,
    /// At most this many splits and collapses a frame, or vertices of a totally ordered mesh but at least a step; the rest is
    /// carried over.
    #[arg(long, value_name = "M")]
    operations: Option<usize>,
    #[command(flatten)]
    style: Style,
    /// The table to write.
    #[arg(long, value_name = "FRAMES.csv")]
    csv: PathBuf,
}

/// Seconds from frame to frame.
const SECONDS: f32 = 1.0 / 60.0;

/// Columns of the table, after the frame's number.
const COLUMNS: [&str; 7] =
    ["triangles", "vertices", "tests", "splits", "collapses", "microseconds", "bytes_changed"];

/// Counts the vertices drawn by an instance.
#[derive(Default)]
struct Used {
    /// Per index, the last frame to draw it.
    seen: Vec<u32>,
    frame: u32,
}

impl Used {
    fn count(&mut self, lod: &dyn Lod) -> usize {
        self.frame += 1;
        let mut count = 0;
        for &index in (0..lod.groups()).flat_map(|group| lod.triangles(group).as_flattened()) {
            let index = index as usize;
            if index >= self.seen.len() {
                self.seen.resize((index + 1).next_power_of_two(), 0);
            }
            count += usize::from(self.seen[index] != self.frame);
            self.seen[index] = self.frame;
        }
        count
    }
}

/// Returns the bytes written since the last call.
fn bytes_changed(lod: &mut dyn Lod, per_vertex: usize) -> usize {
    let triangles = (0..lod.groups()).flat_map(|group| lod.dirty_triangles(group, 0));
    let triangles: usize = triangles.map(|range| range.len()).sum();
    let vertices: usize = lod.dirty_vertices(0).map(|range| range.len()).sum();
    lod.clean();
    triangles * size_of::<[u32; 3]>() + vertices * per_vertex
}

/// Returns mean, median, 99th percentile (nearest rank) and maximum.
fn summary(mut values: Vec<f64>) -> [f64; 4] {
    values.sort_unstable_by(f64::total_cmp);
    let rank = |share: f64| {
        let at = (share * values.len() as f64).ceil() as usize;
        values.get(at.max(1) - 1).copied().unwrap_or(0.0)
    };
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    [mean, rank(0.5), rank(0.99), rank(1.0)]
}

impl Fly {
    /// Returns the columns of every frame, each after the frame's number.
    fn frames(&self, model: &Model, poses: &[path::Pose]) -> Result<Vec<(u64, [f64; 7])>, Failure> {
        let place = self.camera.place(model);
        let buffer = if self.packed { VertexBuffer::Packed } else { VertexBuffer::Shared };
        let options = LodOptions::default()
            .with_buffer(buffer)
            .with_triangles(self.budget)
            .with_operations(self.operations);
        let mut lod = model.instance(&self.style, options)?;
        let lod = &mut *lod;
        let per_vertex = model.bytes_per_vertex();
        let mut used = Used::default();
        let mut rows = Vec::with_capacity(poses.len());
        for pose in poses {
            let view = self.camera.view(&place, pose.eye, pose.target);
            let view = view.map_err(|failure| match failure {
                Failure::Input(reason) => Failure::Input(format!("frame {}: {reason}", pose.frame)),
                usage => usage,
            })?;
            let start = Instant::now();
            let change = lod.adapt(&[view], SECONDS);
            let microseconds = start.elapsed().as_secs_f64() * 1e6;
            let counts = [change.triangles, used.count(lod), change.cut.tests, change.cut.splits];
            let [triangles, vertices, tests, splits] = counts.map(|count| count as f64);
            let bytes = bytes_changed(lod, per_vertex) as f64;
            let collapses = change.cut.collapses as f64;
            rows.push((pose.frame, [triangles, vertices, tests, splits, collapses, microseconds, bytes]));
        }
        Ok(rows)
    }
}

impl Run for Fly {
    fn run(&self) -> Result<Answer, Failure> {
        files::check_place(&self.csv)?;
        let poses = path::read(&self.path)?;
        let model = Model::read(&self.input)?;
        let rows = self.frames(&model, &poses)?;

        let [triangles, base_triangles] = model.0.triangle_counts();
        let mut csv = format!("frame,{}\n", COLUMNS.join(","));
        for (frame, row) in &rows {
            let _ = write!(csv, "{frame}");
            for (name, value) in COLUMNS.iter().zip(row) {
                let digits = if *name == "microseconds" { 3 } else { 0 };
                let _ = write!(csv, ",{value:.digits$}");
            }
            csv.push('\n');
        }
        atomic::write(&self.csv, csv.as_bytes())
            .map_err(|error| Failure::Input(format!("{}: {error}", self.csv.display())))?;

        let mut table = Table::default();
        table.row("input", format!("{}: {triangles} triangles", self.input.display()));
        table.row("output", format!("{}: {} frames", self.csv.display(), rows.len()));
        table.row("view", self.camera.describe_text());
        if let Some(budget) = self.budget {
            table.row("budget", format!("{budget} triangles"));
        }
        if let Some(operations) = self.operations {
            table.row("at most", format!("{operations} splits and collapses a frame"));
        }
        table.row("", format!("{:>12} {:>12} {:>12} {:>12}", "mean", "median", "99 %", "most"));
        let mut columns = serde_json::Map::new();
        for (i, name) in COLUMNS.into_iter().enumerate() {
            let [mean, median, p99, max] = summary(rows.iter().map(|(_, row)| row[i]).collect());
            table.row(name, format!("{mean:>12.1} {median:>12.1} {p99:>12.1} {max:>12.1}"));
            let value: Value = json!({ "mean": mean, "median": median, "p99": p99, "max": max });
            columns.insert(name.to_owned(), value);
        }
        let json = json!({
            "command": "fly",
            "input": {
                "path": self.input.display().to_string(),
                "bytes": files::size(&self.input),
                "triangles": triangles,
                "base_triangles": base_triangles,
            },
            "path": self.path.display().to_string(),
            "output": { "path": self.csv.display().to_string(), "bytes": files::size(&self.csv) },
            "view": self.camera.describe(),
            "packed": self.packed,
            "triangulation": self.style.name(&model),
            "budget": self.budget,
            "operations": self.operations,
            "frames": rows.len(),
            "columns": columns,
        });
        Ok(Answer { json, text: table.text(), warnings: Vec::new(), failures: Vec::new() })
    }
}
