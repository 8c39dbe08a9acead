//! `multires measure`: how far two meshes differ, by distance, volume, shape and looks.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use clap::builder::RangedU64ValueParser;
use multires::io::Imported;
use multires::mesh::{Mesh, Report};
use multires::quality::{self, Distance, DistanceOptions, ImageDifference, ImageOptions, OneSided};
use multires::quality::{QualityError, ShapeReport};
use serde_json::{Value, json};

use crate::files;
use crate::output::{Answer, Failure, Run, Table, percent};
use crate::paint::Painted;
use crate::progress::Bar;

/// Measure how far two meshes differ; A is the reference.
///
/// Distances between the surfaces both ways (largest, mean and root mean square, in object units and in percent of the
/// diagonal of A's box), enclosed volumes, areas, pairs of crossing triangles (without a common corner), and how far
/// triangles are from equilateral. With --images also how different they look from all sides: K_L1 and K_L2 in grey levels
/// of 0 to 255 over the pixels showing either mesh, and K_sil, the number of pixels, of 512 x 512 a view, showing only one
/// of the meshes.
#[derive(Args)]
pub struct Measure {
    /// The reference.
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The mesh to compare with it.
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Sample each surface at this many points, and its edges at a quarter as many.
    #[arg(long, value_name = "N", default_value_t = 500_000,
        value_parser = RangedU64ValueParser::<usize>::new().range(1..=u64::from(u32::MAX)))]
    samples: usize,
    /// Compare pictures from all sides too.
    #[arg(long)]
    images: bool,
    /// Number of sides.
    #[arg(long, value_name = "N", default_value_t = 42, requires = "images",
        value_parser = RangedU64ValueParser::<usize>::new().range(1..=4096))]
    views: usize,
    /// Write A with every vertex coloured by its distance from B, as a PLY file with the distance as a property.
    #[arg(long, visible_alias = "color", value_name = "OUT.ply")]
    colour: Option<PathBuf>,
    /// Draw the coloured A from the front and from the back, with a colour scale, as a PNG file.
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,
}

impl Run for Measure {
    fn run(&self) -> Result<Answer, Failure> {
        if let Some(path) = &self.colour {
            files::check_output(path, "ply")?;
        }
        if let Some(path) = &self.picture {
            files::check_output(path, "png")?;
        }
        let bar = Bar::new("reading");
        let (mut read_a, mut read_b) = (read(&self.a)?, read(&self.b)?);
        common_origin(&mut read_a.mesh, &mut read_b.mesh).map_err(Failure::input)?;
        let (a, b) = (&read_a.mesh, &read_b.mesh);

        let start = Instant::now();
        let refuse = |error| self.refuse(error);
        bar.begin("distances", 0.1);
        let options = DistanceOptions::default().with_samples(self.samples);
        let distance = quality::distance(a, b, &options).map_err(refuse)?;
        bar.begin("volumes", 0.4);
        let volumes = [a, b].map(Volume::of);
        let shapes = [a, b].map(ShapeReport::new);
        let areas = [a, b].map(quality::area);
        let crossings = [a, b].map(quality::self_intersections);
        let mut images = None;
        if self.images {
            bar.begin("images", 0.5);
            let options = ImageOptions::default().with_views(self.views);
            images = Some(quality::image_difference(a, b, &options).map_err(refuse)?);
        }
        let seconds = start.elapsed().as_secs_f64();
        let mut painted = None;
        if self.colour.is_some() || self.picture.is_some() {
            bar.begin("colours", 0.8);
            let paint = Painted::new(a, b).map_err(refuse)?;
            // Everything that can go wrong, before anything is written.
            let picture = self.picture.as_ref().map(|path| Ok((path, paint.picture(a)?))).transpose()?;
            if let Some(path) = &self.colour {
                files::write_mesh(path, &paint.mesh(a)?)?;
            }
            if let Some((path, bytes)) = picture {
                files::write_bytes(path, &bytes)?;
            }
            painted = Some(paint);
        }
        drop(bar);

        let warnings: Vec<String> = [(&self.a, &read_a), (&self.b, &read_b)]
            .into_iter()
            .flat_map(|(path, read)| read.notes.iter().map(move |n| format!("{}: {n}", path.display())))
            .collect();
        let path = |path: &Option<PathBuf>| path.as_ref().map(|p| p.display().to_string());
        let json = json!({
            "command": "measure",
            "a": files::describe(&self.a, a),
            "b": files::describe(&self.b, b),
            "diagonal": distance.diagonal,
            "samples": self.samples,
            "distance": distances(&distance),
            "volume": {
                "a": volumes[0].value,
                "b": volumes[1].value,
                "ratio": Volume::ratio(&volumes),
                "a_reason": volumes[0].reason,
                "b_reason": volumes[1].reason,
            },
            "area": { "a": areas[0], "b": areas[1], "ratio": ratio(areas) },
            "self_intersections": { "a": crossings[0], "b": crossings[1] },
            "shape": { "a": shapes[0], "b": shapes[1] },
            "images": images,
            "colours": painted.as_ref().map(|p| json!({
                "mesh": path(&self.colour),
                "picture": path(&self.picture),
                "from": 0.0,
                "to": p.most,
                "to_percent": percent(p.most, distance.diagonal),
            })),
            "seconds": seconds,
            "warnings": warnings,
        });

        let mut table = Table::default();
        table.row("A", files::describe_text(&self.a, a));
        table.row("B", files::describe_text(&self.b, b));
        table.row("diagonal of A", number(distance.diagonal));
        table.row("samples", self.samples);
        distance_rows(&mut table, &distance);
        table.block("");
        grid(&mut table, "", ["A", "B", "B / A"].map(String::from));
        let values = [0, 1].map(|i| volumes[i].value.map_or("-".to_owned(), number));
        pair(&mut table, "volume", values, Volume::ratio(&volumes));
        for (name, volume) in [("A", &volumes[0]), ("B", &volumes[1])] {
            if let Some(reason) = &volume.reason {
                table.row(&format!("no volume of {name}"), reason);
            }
        }
        pair(&mut table, "area", areas.map(number), ratio(areas));
        pair(&mut table, "crossing triangles", crossings.map(|count| count.to_string()), None);
        for (label, of) in SHAPE {
            let values = [0, 1].map(|i| of(&shapes[i]));
            pair(&mut table, label, values.map(number), None);
        }
        if let Some(images) = &images {
            image_rows(&mut table, images);
        }
        if let Some(painted) = &painted {
            let share = percent(painted.most, distance.diagonal).unwrap_or(0.0);
            let to = format!("{} ({} %)", number(painted.most), number(share));
            table.block("");
            for file in [&self.colour, &self.picture].into_iter().flatten() {
                table.row("coloured", file.display());
            }
            table.row("colours", format!("dark blue 0 to yellow {to}, distance of A's vertices from B"));
        }
        table.block("").row("seconds", format!("{seconds:.3}"));
        Ok(Answer { json, text: table.text(), warnings, failures: Vec::new() })
    }
}

impl Measure {
    /// Makes a reason naming the file at fault.
    fn refuse(&self, error: QualityError) -> Failure {
        match error {
            QualityError::NoSurface { which, triangles } => {
                let path = if which == "first" { &self.a } else { &self.b };
                let why = format!("no surface: none of its {triangles} triangles has an area");
                Failure::Input(format!("{}: {why}", path.display()))
            }
            other => Failure::input(other),
        }
    }
}

/// Moves both meshes to a common origin: the first mesh's, unless it has none.
fn common_origin(a: &mut Mesh, b: &mut Mesh) -> Result<(), multires::MeshError> {
    let origin = if a.origin() == [0.0; 3] { b.origin() } else { a.origin() };
    for mesh in [a, b] {
        if mesh.origin() != origin {
            *mesh = mesh.moved_to(origin)?;
        }
    }
    Ok(())
}

/// Reads a mesh. For a baked file, the error says what to do.
fn read(path: &Path) -> Result<Imported, Failure> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mres")) {
        let path = path.display();
        let advice = format!("take a level out of it first: multires extract {path} LEVEL.ply --level 1");
        return Err(Failure::Input(format!("{path}: a baked file is no mesh; {advice}")));
    }
    files::read_mesh(path)
}

/// The volume enclosed by a mesh, or why there is none.
struct Volume {
    value: Option<f64>,
    reason: Option<String>,
}

impl Volume {
    fn of(mesh: &Mesh) -> Self {
        let value = quality::volume(mesh);
        let reason = value.is_none().then(|| {
            let report = Report::welded(mesh);
            if report.border_edges > 0 {
                format!("it is open: edges with one triangle: {}", report.border_edges)
            } else if report.flipped_edges > 0 {
                format!("its triangles do not agree what is outside: at {} edges", report.flipped_edges)
            } else {
                let edges = report.non_manifold_edges;
                format!("it has no outside: edges with three triangles or more: {edges}")
            }
        });
        Self { value, reason }
    }

    fn ratio([a, b]: &[Self; 2]) -> Option<f64> {
        ratio([a.value?, b.value?])
    }
}

/// Returns `b / a`, if it is finite.
fn ratio([a, b]: [f64; 2]) -> Option<f64> {
    Some(b / a).filter(|r| r.is_finite())
}

/// Describes distances both ways, for JSON.
pub fn distances(distance: &Distance) -> Value {
    json!({
        "forward": one_sided(distance, &distance.forward),
        "backward": one_sided(distance, &distance.backward),
        "both": sizes(distance, [distance.hausdorff(), distance.mean(), distance.rms()]),
    })
}

fn sizes(distance: &Distance, [max, mean, rms]: [f64; 3]) -> Value {
    json!({
        "max": max,
        "mean": mean,
        "rms": rms,
        "max_percent": distance.percent(max),
        "mean_percent": distance.percent(mean),
        "rms_percent": distance.percent(rms),
    })
}

fn one_sided(distance: &Distance, side: &OneSided) -> Value {
    let mut value = sizes(distance, [side.max, side.mean, side.rms]);
    value["max_at"] = json!(side.max_at);
    value["max_to"] = json!(side.max_to);
    value["face_samples"] = json!(side.face_samples);
    value["edge_samples"] = json!(side.edge_samples);
    value
}

fn distance_rows(table: &mut Table, distance: &Distance) {
    let [forward, backward] = [distance.forward, distance.backward].map(|s| [s.max, s.mean, s.rms]);
    let both = [distance.hausdorff(), distance.mean(), distance.rms()];
    table.block("");
    grid(table, "distance", ["max", "mean", "rms"].map(String::from));
    for (label, sizes) in [("A to B", forward), ("B to A", backward), ("both", both)] {
        grid(table, label, sizes.map(number));
    }
    for (label, sizes) in [("A to B, %", forward), ("B to A, %", backward), ("both, %", both)] {
        grid(table, label, sizes.map(|x| number(distance.percent(x))));
    }
}

/// Rows on the triangles' shapes.
type ShapeRow = (&'static str, fn(&ShapeReport) -> f64);
const SHAPE: [ShapeRow; 4] = [
    ("sliver ratio, mean", |s| s.sliver_mean),
    ("sliver ratio, max", |s| s.sliver_max),
    ("smallest angle, deg", |s| s.angle_min.to_degrees()),
    ("without area", |s| s.degenerate as f64),
];

fn image_rows(table: &mut Table, images: &ImageDifference) {
    let ImageDifference { views, size, .. } = images;
    table.block("");
    table.row("images", format!("{views} views of {size} x {size} pixels"));
    grid(table, "", ["mean of views", "worst view", "which (from 0)"].map(String::from));
    let worst = images.silhouette_max as f64;
    for (label, mean, worst, view) in [
        ("K_L1, grey levels", images.l1, images.l1_max, images.l1_max_view),
        ("K_L2, grey levels", images.l2, images.l2_max, images.l2_max_view),
        ("K_sil, pixels", images.silhouette, worst, images.silhouette_max_view),
    ] {
        grid(table, label, [number(mean), number(worst), view.to_string()]);
    }
    table.row("K_sil, % of A", number(100.0 * images.silhouette_share));
}

fn pair(table: &mut Table, label: &str, [a, b]: [String; 2], ratio: Option<f64>) {
    grid(table, label, [a, b, ratio.map_or(String::new(), number)]);
}

/// Adds a row of three columns.
fn grid(table: &mut Table, label: &str, [a, b, c]: [String; 3]) {
    table.row(label, format!("{a:<15} {b:<15} {c}").trim_end());
}

/// Formats a number with five significant digits, whatever its unit.
pub fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || x.fract() == 0.0 && size < 1e9 {
        format!("{x}")
    } else if (1e-4..1e6).contains(&size) {
        // Digits after the point, for five significant digits.
        let decimals = (4 - size.log10().floor() as i32).clamp(0, 8) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.4e}")
    }
}
