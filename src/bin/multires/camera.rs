//! Arguments common to `adapt` and `fly`: how to look at a model, and the views made from them.

use clap::{Args, ValueEnum};
use multires::view::{ErrorKind, ObjectView, View, look_at};
use serde_json::{Value, json};

use crate::model::Model;
use crate::output::Failure;
use crate::rules::not_negative;

#[derive(Args)]
pub struct Camera {
    /// Units of eye, target and radius: multiples of the diagonal of the model's box, from the box's centre; or the units and
    /// coordinates of the file the model was made from.
    #[arg(long, value_name = "U", value_enum, default_value_t = Units::Diagonal)]
    units: Units,
    /// Direction of up on the picture.
    #[arg(long, value_name = "X,Y,Z", default_value = "0,1,0", value_parser = point, allow_hyphen_values = true)]
    up: Point,
    /// Vertical field of view, degrees.
    #[arg(long, value_name = "D", default_value_t = 60.0, value_parser = field_of_view)]
    fov: f64,
    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = viewport)]
    viewport: [u32; 2],
    /// Largest error on the picture, pixels.
    #[arg(long, value_name = "P", default_value_t = 1.0, value_parser = not_negative)]
    tolerance: f64,
    /// Largest error on the picture at possible silhouettes, pixels [default: as anywhere].
    #[arg(long, value_name = "P", value_parser = not_negative)]
    silhouette: Option<f64>,
    /// Kind of error: the distance of the surface from the original (geometric), or of its points from where they belong
    /// (parametric), which also keeps a texture in place. Both are equal for wavelet meshes, where nothing slides.
    #[arg(long, value_name = "K", value_enum, default_value_t = Measure::Geometric)]
    error: Measure,
    /// Replaces errors: full resolution within this distance from the eye and in the picture, nothing elsewhere (Berkey and
    /// Song).
    #[arg(long, value_name = "R", value_parser = not_negative,
          conflicts_with_all = ["tolerance", "silhouette", "error", "no_frustum", "both_sides"])]
    radius: Option<f64>,
    /// Refine outside the picture too.
    #[arg(long)]
    no_frustum: bool,
    /// Refine triangles facing away too, for models drawn from both sides.
    #[arg(long)]
    both_sides: bool,
}

/// Units of places.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Units {
    Object,
    Diagonal,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Measure {
    Geometric,
    Parametric,
}

/// Three numbers.
pub type Point = [f64; 3];

/// Origin and unit of places, to convert them to object units.
pub struct Place {
    origin: Point,
    unit: f64,
}

impl Camera {
    /// Returns the origin and the unit of places.
    pub fn place(&self, model: &Model) -> Place {
        match (self.units, model.0.bounds()) {
            (Units::Diagonal, Some([low, high])) => {
                let [low, high] = [low, high].map(|p| p.map(f64::from));
                let square: f64 = (0..3).map(|i| (high[i] - low[i]).powi(2)).sum();
                Place { origin: std::array::from_fn(|i| (low[i] + high[i]) * 0.5), unit: square.sqrt() }
            }
            _ => Place { origin: model.vertices().origin().map(|x| -x), unit: 1.0 },
        }
    }

    /// Makes the view from `eye` towards `target`.
    pub fn view(&self, place: &Place, eye: Point, target: Point) -> Result<ObjectView, Failure> {
        let at =
            |p: Point| -> [f32; 3] { std::array::from_fn(|i| (place.origin[i] + place.unit * p[i]) as f32) };
        let matrix = look_at(at(eye), at(target), self.up.map(|x| x as f32));
        let view = View::perspective(matrix, (self.fov as f32).to_radians(), self.viewport)
            .map_err(|error| Failure::Input(format!("no view from {eye:?} to {target:?}: {error}")))?;
        let view = match self.radius {
            Some(radius) => view.with_radius_test((radius * place.unit) as f32),
            None => {
                let kind = match self.error {
                    Measure::Geometric => ErrorKind::Geometric,
                    Measure::Parametric => ErrorKind::Parametric,
                };
                let view = view
                    .with_tolerance_px(self.tolerance as f32)
                    .with_error(kind)
                    .with_frustum(!self.no_frustum)
                    .with_back_faces_culled(!self.both_sides);
                match self.silhouette {
                    Some(pixels) => view.with_silhouette_px(pixels as f32),
                    None => view,
                }
            }
        };
        Ok(view.of_world())
    }

    /// Describes the arguments, for JSON.
    pub fn describe(&self) -> Value {
        json!({
            "units": match self.units { Units::Object => "object", Units::Diagonal => "diagonal" },
            "up": self.up,
            "fov": self.fov,
            "viewport": self.viewport,
            "tolerance": if self.radius.is_some() { None } else { Some(self.tolerance) },
            "silhouette": self.silhouette,
            "error": self.measure_name(),
            "radius": self.radius,
            "frustum": !self.no_frustum,
            "both_sides": self.both_sides,
        })
    }

    fn measure_name(&self) -> &'static str {
        match self.error {
            Measure::Geometric => "geometric",
            Measure::Parametric => "parametric",
        }
    }

    /// Describes the arguments, for people.
    pub fn describe_text(&self) -> String {
        let [width, height] = self.viewport;
        let what = match self.radius {
            Some(radius) => format!("all within {radius}"),
            None => format!("{} px, {} error", self.tolerance, self.measure_name()),
        };
        format!("{what}, {width} x {height} pixels, {} degrees", self.fov)
    }
}

/// Parses three finite numbers with commas between them.
pub fn point(text: &str) -> Result<Point, String> {
    let wrong = || format!("{text:?} is not X,Y,Z");
    let mut parts = text.split(',').map(|part| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()));
    let mut next = || parts.next().flatten().ok_or_else(wrong);
    let point = [next()?, next()?, next()?];
    if parts.next().is_some() { Err(wrong()) } else { Ok(point) }
}

fn field_of_view(text: &str) -> Result<f64, String> {
    let degrees = text.trim().parse::<f64>().ok().filter(|d| *d >= 0.001 && *d <= 179.0);
    degrees.ok_or_else(|| "not a number of degrees from 0.001 to 179".to_owned())
}

fn viewport(text: &str) -> Result<[u32; 2], String> {
    let size = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    size.filter(|size| !size.contains(&0)).ok_or_else(|| format!("{text:?} is not WIDTHxHEIGHT in pixels"))
}
