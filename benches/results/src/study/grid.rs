//! What the study goes through: metrics, placements, levels and measures, and the row that each level makes.
//!
//! A row is one level of one model, simplified with one metric and one placement. Rows go to CSV and come back from it,
//! so that a long run need not be repeated to look at it anew.

use multires::simplify::Placement;

/// A metric: the name that the library knows it by, and the one it goes by in tables.
pub struct Metric {
    pub name: &'static str,
    pub symbol: &'static str,
    /// The placement Southern compared it with (table 4.1), an index into [`PLACEMENTS`].
    pub paired: usize,
}

const fn metric(name: &'static str, symbol: &'static str, paired: usize) -> Metric {
    Metric { name, symbol, paired }
}

/// Southern's five, then those added.
pub const METRICS: [Metric; 8] = [
    metric("edge-length", "E_edge", MIDPOINT),
    metric("unsigned-volume", "E_uvol", SUBSET),
    metric("progressive-mesh", "E_pm", SUBSET),
    metric("memoryless-quadric", "E_quadric", SUBSET),
    metric("hybrid", "E_hybrid", SUBSET),
    metric("quadric", "accumulated quadric", SUBSET),
    metric("lindstrom-turk", "Lindstrom-Turk", SUBSET),
    metric("volume-area", "volume-area", SUBSET),
];
/// How many of [`METRICS`] are Southern's.
pub const SOUTHERNS: usize = 5;
/// The two metrics that his comparison of placements takes.
pub const QUADRIC: usize = 3;
pub const HYBRID: usize = 4;

/// Where merged vertices go.
pub const PLACEMENTS: [(Placement, &str); 4] = [
    (Placement::Midpoint, "midpoint"),
    (Placement::Endpoint, "endpoint"),
    (Placement::Subset, "subset"),
    (Placement::Optimal, "optimal"),
];
pub const MIDPOINT: usize = 0;
pub const SUBSET: usize = 2;
pub const OPTIMAL: usize = 3;

/// Something measured of a level.
pub struct Measure {
    pub name: &'static str,
    pub symbol: &'static str,
    /// What a chart says of it.
    pub title: &'static str,
    /// At or below this a value is nothing, or the rounding of positions, and has no ratio to others.
    pub floor: f64,
}

const fn measure(name: &'static str, symbol: &'static str, title: &'static str, floor: f64) -> Measure {
    Measure { name, symbol, title, floor }
}

/// Single precision, in percent of the diagonal.
const ROUNDING: f64 = 1e-5;

/// Southern's six in the order of his tables, then those added.
pub const MEASURES: [Measure; 8] = [
    measure("l1", "K_L1", "K_L1: image difference", 0.0),
    measure("l2", "K_L2", "K_L2: image difference", 0.0),
    measure("silhouette", "K_sil", "K_sil: silhouette", 0.0),
    measure("sliver", "K_sliver", "K_sliver: triangle shape", 0.0),
    measure("volume", "K_vol", "K_vol: volume / model's", 0.0),
    measure("metro_mean", "K_metro", "K_metro: mean distance, %", ROUNDING),
    measure("metro_max", "K_max", "K_max: largest distance, %", ROUNDING),
    measure("volume_change", "abs(1 - K_vol)", "abs(1 - K_vol)", 0.0),
];
pub const L1: usize = 0;
pub const L2: usize = 1;
pub const SILHOUETTE: usize = 2;
pub const SLIVER: usize = 3;
pub const VOLUME: usize = 4;
pub const METRO: usize = 5;
pub const MAX: usize = 6;
pub const CHANGE: usize = 7;
/// How many of [`MEASURES`] are Southern's.
pub const SIX: usize = 6;

/// Which levels there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Schedule {
    /// (n - m) / n of the triangles for m = 0 to n - 1 (Southern 4.4.1).
    Even,
    /// Half as many each time.
    Halving,
}

impl Schedule {
    /// The share of the triangles that step `m` of `n` keeps; step 0 is the model.
    pub fn kept(self, m: usize, n: usize) -> f64 {
        match self {
            Self::Even => (n - m.min(n)) as f64 / n.max(1) as f64,
            Self::Halving => 0.5f64.powi(m as i32),
        }
    }
}

/// One level of one model, simplified in one way.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub model: String,
    /// Of the model's box, object units.
    pub diagonal: f64,
    /// Index into [`METRICS`].
    pub metric: usize,
    /// Index into [`PLACEMENTS`].
    pub placement: usize,
    /// 0 is the model itself.
    pub step: usize,
    /// Share of the triangles asked for.
    pub kept: f64,
    /// Triangles there are; more than asked for where nothing legal was left, and then nothing is measured.
    pub triangles: usize,
    /// Collapses down to here.
    pub collapses: usize,
    /// Time it took down to here.
    pub seconds: f64,
    /// As [`MEASURES`]; none where it does not exist (the volume of an open mesh).
    pub values: [Option<f64>; MEASURES.len()],
}

/// All rows, one a line, under a header; numbers in as many digits as they have.
pub fn to_csv(rows: &[Row]) -> String {
    let mut out = String::from("model,diagonal,metric,placement,step,kept,triangles,collapses,seconds");
    MEASURES.iter().for_each(|measure| out += &format!(",{}", measure.name));
    out.push('\n');
    for row in rows {
        let model = row.model.replace([',', '"', '\n', '\r'], "_");
        let (metric, placement) = (METRICS[row.metric].name, PLACEMENTS[row.placement].1);
        let Row { diagonal, step, kept, triangles, collapses, seconds, .. } = row;
        out += &format!(
            "{model},{diagonal},{metric},{placement},{step},{kept},{triangles},{collapses},{seconds}"
        );
        row.values.iter().for_each(|value| out += &value.map_or(",".into(), |x| format!(",{x:e}")));
        out.push('\n');
    }
    out
}

/// The rows that [`to_csv`] wrote.
///
/// # Errors
/// The first line that is not one of them.
pub fn from_csv(text: &str) -> Result<Vec<Row>, String> {
    let row = |(number, line): (usize, &str)| {
        read_row(line).ok_or_else(|| format!("line {} is not a row of levels.csv", number + 1))
    };
    text.lines().enumerate().skip(1).map(row).collect()
}

fn read_row(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split(',').collect();
    if cells.len() != 9 + MEASURES.len() {
        return None;
    }
    let mut values = [None; MEASURES.len()];
    for (value, cell) in values.iter_mut().zip(&cells[9..]).filter(|(_, cell)| !cell.is_empty()) {
        *value = Some(cell.parse::<f64>().ok().filter(|x| x.is_finite())?);
    }
    Some(Row {
        model: cells[0].to_owned(),
        diagonal: cells[1].parse().ok()?,
        metric: METRICS.iter().position(|metric| metric.name == cells[2])?,
        placement: PLACEMENTS.iter().position(|placement| placement.1 == cells[3])?,
        step: cells[4].parse().ok()?,
        kept: cells[5].parse().ok()?,
        triangles: cells[6].parse().ok()?,
        collapses: cells[7].parse().ok()?,
        seconds: cells[8].parse().ok()?,
        values,
    })
}
