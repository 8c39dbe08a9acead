//! How to simplify: the arguments common to `simplify` and `build`, and the simplifier made from them.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, FromArgMatches, ValueEnum};
use multires::mesh::{Mesh, Tolerances};
use multires::simplify::metric::{self, ErrorMetric};
use multires::simplify::oracle::{Borders, NormalFlip, SelfIntersection, TriangleQuality};
use multires::simplify::{
    AttributeWeights, ErrorMeasure, GivenUp, Guard, Normals, NormalsDone, Parts, Permissive, Placement,
    Refusal, Simplifier, SimplifyReport, StopReason,
};
use serde_json::{Value, json};

use crate::batches::Batches;
use crate::output::Failure;
use crate::prepare::Preparation;

#[derive(Args, Clone)]
pub struct Rules {
    /// Cost of a collapse.
    #[arg(long, value_name = "M", default_value = "quadric", value_parser = metric_name())]
    pub metric: String,
    /// Place of the merged vertex: half-way, at one end (no new vertices), the better of these, or where the metric is least
    /// [default: optimal for lindstrom-turk, else endpoint].
    #[arg(long, value_name = "P", value_enum)]
    pub placement: Option<Place>,
    #[command(flatten)]
    pub batches: Batches,
    /// Measure of the error: how far points have travelled (quick, loose), their distance from the surface, or their distance
    /// with collapses put off if they turn out worse than foreseen (closest, slowest; for the quadric metric).
    #[arg(long, value_name = "K", value_enum, default_value_t = Measure::Measured)]
    pub error_measure: Measure,
    /// Whether attributes steer the collapses: off, on (normals, texture coordinates and colours with the customary weights),
    /// or NAME=WEIGHT,... with the weight as the share of the diagonal that a deviation of 1 is worth.
    #[arg(long, value_name = "off|on|NAME=WEIGHT,...", default_value = "on", value_parser = weights)]
    pub attributes: AttributeWeights,
    /// Normals: keep them and their seams, recompute them from each level's triangles (with the crease angle that best
    /// explains the input's, or recompute=DEGREES), drop them and tangents, or auto: recompute if every face has normals of
    /// its own, else keep [default: auto; keep for build, whose vertices are fixed].
    #[arg(long, value_name = "auto|keep|recompute[=DEGREES]|drop", value_parser = normals)]
    pub normals: Option<Normals>,
    #[command(flatten)]
    pub preparation: Preparation,
    /// Largest differences between vertices at the same place to merge them: 16-bit (a step of 16-bit storage), exact, or
    /// KIND=T,...: normal in degrees, uv in texels, texture (the texels of a side, 65536), color in steps of 1/255, other as
    /// a share of the value, position in steps of 2^-23 of the largest coordinate (between open borders). "inf" is any
    /// difference.
    #[arg(long, value_name = "16-bit|exact|KIND=T,...", default_value = "16-bit", value_parser = Weld::parse)]
    pub weld_tolerance: Weld,
    /// Whether seams, creases, borders between materials and, last, the topology may give: never, where it costs least, or
    /// only before a size asked for is missed.
    #[arg(long, value_name = "W", value_enum, default_value_t = Gives::Auto)]
    pub permissive: Gives,
    /// Neither move nor remove vertices on open borders.
    #[arg(long)]
    pub lock_borders: bool,
    /// Let parts at most this far apart (object units) grow together.
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = not_negative)]
    pub join_distance: f64,
    /// Keep every separate part: none vanishes as a whole, however small it is beside the others.
    #[arg(long)]
    pub keep_parts: bool,
    /// Refuse collapses after which the surface would cross itself at a new place: for thin shells and layers.
    #[arg(long)]
    pub keep_apart: bool,
    /// Degrees by which a collapse may turn a triangle's normal, 0 to 180.
    #[arg(long, value_name = "A", default_value_t = 78.0, value_parser = degrees)]
    pub max_turn: f64,
    /// Quality below which collapses making thinner triangles wait until dearer collapses are due, from 0 (any) to 1
    /// (equilateral only).
    #[arg(long, value_name = "Q", default_value_t = 0.01, value_parser = share)]
    pub min_quality: f64,
    /// Whether to refuse collapses with an error beyond what the remaining triangles explain.
    #[arg(long, value_name = "on|off", value_enum, default_value_t = Switch::On)]
    pub guard: Switch,
}

/// A choice of on or off.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    On,
    Off,
}

/// Rules, and the names of the given ones: for commands that take none.
#[derive(Clone)]
pub struct Given {
    pub rules: Rules,
    /// Names of the given rules on the command line.
    names: Vec<String>,
}

impl Given {
    /// Refuses all given rules but those in use.
    pub fn check_unused(&self, used: &[&str], reason: &str) -> Result<(), Failure> {
        match self.names.iter().find(|name| !used.contains(&name.as_str())) {
            None => Ok(()),
            Some(name) => Err(Failure::Usage(format!("--{name}: {reason}"))),
        }
    }

    /// Returns the metric, if it was given.
    pub fn metric(&self) -> Option<&str> {
        self.names.iter().any(|name| name == "metric").then_some(&self.rules.metric)
    }
}

impl FromArgMatches for Given {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let rules = Rules::augment_args(Command::new(""));
        let is_given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
        let given = rules.get_arguments().filter(|argument| is_given(argument.get_id().as_str()));
        let names = given.filter_map(|argument| Some(argument.get_long()?.to_owned())).collect();
        Ok(Self { rules: Rules::from_arg_matches(matches)?, names })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Given {
    fn augment_args(command: Command) -> Command {
        Rules::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Rules::augment_args_for_update(command)
    }
}

/// Place of the merged vertex.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Place {
    Midpoint,
    Endpoint,
    Subset,
    Optimal,
}

/// Measure of a level's error.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Measure {
    Parametric,
    Measured,
    Verified,
}

/// Whether seams, creases, borders and the topology may give.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Gives {
    Off,
    On,
    Auto,
}

/// Parses the weights of attributes.
fn weights(text: &str) -> Result<AttributeWeights, String> {
    match text {
        "off" => return Ok(AttributeWeights::Off),
        "on" => return Ok(AttributeWeights::Customary),
        _ => {}
    }
    let one = |part: &str| {
        let (name, weight) = part.split_once('=').ok_or(format!("{part:?} is not NAME=WEIGHT"))?;
        Ok((name.to_owned(), not_negative(weight)? as f32))
    };
    text.split(',').map(one).collect::<Result<_, String>>().map(AttributeWeights::Chosen)
}

/// Largest differences between vertices to merge, and the argument's text.
#[derive(Clone)]
pub struct Weld {
    tolerances: Tolerances,
    text: String,
}

impl Weld {
    fn parse(text: &str) -> Result<Self, String> {
        let mut tolerances = if text == "exact" { Tolerances::exact() } else { Tolerances::default() };
        let named = if ["exact", "16-bit"].contains(&text) { "" } else { text };
        for part in named.split(',').filter(|_| !named.is_empty()) {
            let (kind, value) = part.split_once('=').ok_or(format!("{part:?} is not KIND=T"))?;
            let value = match value {
                "inf" => f32::INFINITY,
                _ => not_negative(value)? as f32,
            };
            tolerances = match kind {
                "normal" => tolerances.with_normal(value),
                "uv" => tolerances.with_uv(value),
                "texture" if value > 0.0 => tolerances.with_texture_size(value),
                "texture" => return Err("texture: not a number above 0".to_owned()),
                "color" => tolerances.with_color(value),
                "other" => tolerances.with_relative(value),
                "position" => tolerances.with_position(value),
                _ => return Err(format!("{kind:?} is none of normal, uv, texture, color, other, position")),
            };
        }
        Ok(Self { tolerances, text: text.to_owned() })
    }
}

impl Place {
    pub fn placement(self) -> Placement {
        match self {
            Self::Midpoint => Placement::Midpoint,
            Self::Endpoint => Placement::Endpoint,
            Self::Subset => Placement::Subset,
            Self::Optimal => Placement::Optimal,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Midpoint => "midpoint",
            Self::Endpoint => "endpoint",
            Self::Subset => "subset",
            Self::Optimal => "optimal",
        }
    }
}

impl Rules {
    /// Returns the place of the merged vertex, as asked for or as suits the metric.
    pub fn place(&self) -> Place {
        let suits = if self.metric == "lindstrom-turk" { Place::Optimal } else { Place::Endpoint };
        self.placement.unwrap_or(suits)
    }

    /// Prepares the mesh for simplification: drops attributes, snaps near positions.
    pub fn prepared(&self, mesh: Mesh) -> Result<Mesh, Failure> {
        self.preparation.prepared(self.without_normals(mesh))
    }

    /// Returns the mesh without dropped attributes.
    pub fn dropped(&self, mesh: Mesh) -> Result<Mesh, Failure> {
        self.preparation.dropped(self.without_normals(mesh))
    }

    fn without_normals(&self, mesh: Mesh) -> Mesh {
        if self.normals == Some(Normals::Drop) { mesh.without_normals() } else { mesh }
    }

    /// Makes the simplifier, with no target yet.
    pub fn simplifier(
        &self,
        place: Place,
        normals: Normals,
    ) -> Result<Simplifier<Box<dyn ErrorMetric>>, Failure> {
        let unknown = || Failure::Usage(format!("there is no metric named {}", self.metric));
        self.batches.check()?;
        let metric = self.batches.metric(&self.metric).ok_or_else(unknown)?;
        let measure = match self.error_measure {
            Measure::Parametric => ErrorMeasure::Parametric,
            Measure::Measured => ErrorMeasure::Measured,
            Measure::Verified => ErrorMeasure::Verified,
        };
        let parts = if self.keep_parts { Parts::Keep } else { Parts::Vanish };
        let borders = if self.lock_borders { Borders::Locked } else { Borders::Slide };
        let simplifier = Simplifier::new()
            .metric(metric)
            .placement(place.placement())
            .order(self.batches.order())
            .independence(self.batches.independence())
            .error_measure(measure)
            .permissive(match self.permissive {
                Gives::Off => Permissive::Off,
                Gives::On => Permissive::On,
                Gives::Auto => Permissive::Auto,
            })
            .attributes(self.attributes.clone())
            .normals(normals)
            .join_distance(self.join_distance as f32)
            .tolerances(self.weld_tolerance.tolerances.clone())
            .guard(if self.guard == Switch::On { Guard::On } else { Guard::Off })
            .parts(parts)
            .oracle(borders)
            .oracle(NormalFlip::degrees(self.max_turn as f32))
            .oracle(TriangleQuality::at_least(self.min_quality as f32));
        let simplifier = match self.batches.placement(place) {
            Some(choose) => simplifier.placement_per_batch(choose),
            None => simplifier,
        };
        Ok(if self.keep_apart { simplifier.oracle(SelfIntersection::new()) } else { simplifier })
    }

    /// Describes the rules, for JSON.
    pub fn describe(&self, place: Place) -> Vec<(&'static str, Value)> {
        let attributes = match &self.attributes {
            AttributeWeights::Off => json!("off"),
            AttributeWeights::Chosen(list) => {
                list.iter().map(|(name, weight)| (name.clone(), json!(weight))).collect()
            }
            _ => json!("on"),
        };
        let mut members = vec![
            ("metric", json!(self.metric)),
            ("placement", json!(place.name())),
            ("error_measure", json!(self.measure_name())),
            ("attributes", attributes),
            ("weld_tolerance", json!(self.weld_tolerance.text)),
            ("weld", json!(self.preparation.weld)),
            ("guard", json!(if self.guard == Switch::On { "on" } else { "off" })),
            ("permissive", json!(self.permissive_name())),
            ("join_distance", json!(self.join_distance)),
            ("keep_parts", json!(self.keep_parts)),
            ("keep_apart", json!(self.keep_apart)),
        ];
        members.extend(self.batches.describe());
        members
    }

    /// Describes the rules, for people.
    pub fn describe_text(&self, place: Place) -> String {
        let (order, measure) = (self.batches.order_name(), self.measure_name());
        format!("{}, {} placement, {order} order, {measure} error", self.metric, place.name())
    }

    fn measure_name(&self) -> &'static str {
        match self.error_measure {
            Measure::Parametric => "parametric",
            Measure::Measured => "measured",
            Measure::Verified => "verified",
        }
    }

    fn permissive_name(&self) -> &'static str {
        match self.permissive {
            Gives::Off => "off",
            Gives::On => "on",
            Gives::Auto => "auto",
        }
    }

    /// Names the rules in the way where nothing legal was left. For remedies see `advice.rs`.
    pub fn obstacles(report: &SimplifyReport) -> String {
        let list = |number: fn(&Refusal) -> u64| {
            let some = report.refusals.iter().filter(|r| number(r) > 0);
            let lines: Vec<String> = some.map(|r| format!("{} {}", r.oracle, number(r))).collect();
            lines.join(", ")
        };
        // Refusals at the end say most; refusals on the way say something.
        match (list(|r| r.standing), list(|r| r.count)) {
            (standing, _) if !standing.is_empty() => {
                format!("no legal collapse is left; refused there: {standing}")
            }
            (_, count) if !count.is_empty() => {
                format!("no legal collapse is left; refused since the start: {count}")
            }
            _ => "nothing is left to collapse".to_owned(),
        }
    }
}

/// Describes the treatment of normals, for JSON and for people.
pub fn normals_done(report: &SimplifyReport) -> (Value, String) {
    match report.normals {
        NormalsDone::Recomputed(creases) => {
            let angle = creases.angle;
            let text = format!("recomputed, with creases where edges turn by more than {angle:.1} degrees");
            (json!({ "recomputed": { "crease_angle": angle } }), text)
        }
        NormalsDone::Dropped => (json!("dropped"), "dropped".to_owned()),
        _ => (json!("kept"), "kept".to_owned()),
    }
}

/// Lists a report's refusals, for JSON.
pub fn refusals(report: &SimplifyReport) -> Vec<Value> {
    let one = |r: &Refusal| json!({ "oracle": r.oracle, "count": r.count, "standing": r.standing });
    report.refusals.iter().map(one).collect()
}

/// Lists constraints given up, for JSON.
pub fn given_up(report: &SimplifyReport) -> Value {
    let GivenUp { seams, creases, materials, topology, .. } = report.given_up;
    json!({ "seams": seams, "creases": creases, "materials": materials, "topology": topology })
}

/// Lists constraints given up, for people; `None` if there are none.
pub fn given_up_text(report: &SimplifyReport) -> Option<String> {
    let GivenUp { seams, creases, materials, topology, .. } = report.given_up;
    let parts =
        [(seams, "seams"), (creases, "creases"), (materials, "material borders"), (topology, "topology")];
    let some = parts.iter().filter(|part| part.0 > 0);
    let list: Vec<String> = some.map(|(count, what)| format!("{what} by {count} collapses")).collect();
    (!list.is_empty()).then(|| list.join(", "))
}

/// Returns the name of a simplification's stop reason.
pub fn stop_name(stop: StopReason) -> &'static str {
    match stop {
        StopReason::Target => "target",
        StopReason::Error => "error",
        StopReason::NothingLegal => "nothing-legal",
        StopReason::Guard => "guard",
        StopReason::Cancelled => "cancelled",
        _ => "other",
    }
}

/// Returns the bytes of a vertex: position and attributes.
pub fn bytes_per_vertex(mesh: &Mesh) -> usize {
    size_of::<[f32; 3]>() + mesh.attributes().iter().map(|a| 4 * a.width()).sum::<usize>()
}

pub fn metric_name() -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(metric::NAMES)
}

fn number(text: &str, range: impl std::ops::RangeBounds<f64>, expected: &str) -> Result<f64, String> {
    let parsed = text.trim().parse::<f64>().ok().filter(|x| x.is_finite() && range.contains(x));
    parsed.ok_or_else(|| format!("not {expected}"))
}

/// Parses a number from 0 to 1.
pub fn share(text: &str) -> Result<f64, String> {
    number(text, 0.0..=1.0, "a number from 0 to 1")
}

/// Parses a finite number of at least 0.
pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text, 0.0.., "a number of 0 or more")
}

fn normals(text: &str) -> Result<Normals, String> {
    match text.split_once('=') {
        None if text == "auto" => Ok(Normals::Automatic),
        None if text == "keep" => Ok(Normals::Keep),
        None if text == "drop" => Ok(Normals::Drop),
        None if text == "recompute" => Ok(Normals::Recompute { crease_angle: None }),
        Some(("recompute", angle)) => Ok(Normals::Recompute { crease_angle: Some(degrees(angle)? as f32) }),
        _ => Err("not auto, keep, recompute, recompute=DEGREES or drop".to_owned()),
    }
}

/// Parses an angle.
pub fn degrees(text: &str) -> Result<f64, String> {
    number(text, 0.0..=180.0, "a number from 0 to 180")
}
