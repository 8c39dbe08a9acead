//! Rows, and what they come to: geometric means over the models, against the best of the other simplifier's settings.

use serde_json::{Value, json};

use super::contender::CONTENDERS;
use super::measure::Measures;

/// Percent of the diagonal beyond which a level is a ruin.
const RUIN: f64 = 10.0;

/// One contender's level of one model.
pub(crate) struct Row {
    pub model: String,
    /// Triangles of the model.
    pub of: usize,
    pub contender: &'static str,
    pub peer: bool,
    pub percent: f64,
    pub target: usize,
    /// None where nothing is left.
    pub measures: Option<Measures>,
    /// CPU time of the thread, ms.
    pub ms: f64,
}

#[derive(Default)]
pub(crate) struct Table {
    rows: Vec<Row>,
}

/// A number to compare, and what counts as nothing: below it levels are equally good.
struct Column {
    name: &'static str,
    of: fn(&Row, &Measures) -> f64,
    nothing: f64,
    /// The contender to compare with; the best of the other simplifier's settings where there is none.
    against: Option<&'static str>,
}

/// The name under which the best of our contenders for each model and column is listed.
const OURS: &str = "best of ours";

const COLUMNS: [Column; 7] = [
    Column { name: "mean", of: |_, m| m.mean, nothing: 1e-4, against: None },
    Column { name: "max", of: |_, m| m.max, nothing: 1e-3, against: None },
    Column { name: "normals", of: |_, m| m.normals, nothing: 0.01, against: None },
    Column { name: "facets", of: |_, m| m.facets, nothing: 0.01, against: None },
    Column { name: "slide", of: |_, m| m.slide, nothing: 1e-3, against: None },
    Column { name: "image", of: |_, m| m.image, nothing: 0.01, against: None },
    Column { name: "ms", of: |row, _| row.ms, nothing: 0.01, against: Some("meshopt-uv") },
];

impl Column {
    fn value(&self, row: &Row) -> f64 {
        row.measures.as_ref().map_or(f64::INFINITY, |m| (self.of)(row, m).max(self.nothing))
    }

    /// The least of some rows.
    fn least(&self, rows: &[&Row]) -> f64 {
        rows.iter().map(|row| self.value(row)).fold(f64::INFINITY, f64::min)
    }

    /// What to compare with among the other simplifier's rows of a model, good and all; not a number where the one
    /// contender that counts did not run.
    fn rival(&self, good: &[&Row], all: &[&Row]) -> f64 {
        match self.against {
            None => self.least(good),
            Some(name) => {
                all.iter().find(|row| row.contender == name).map_or(f64::NAN, |row| self.value(row))
            }
        }
    }
}

impl Row {
    pub(crate) fn print(&self, first: bool) {
        if first {
            println!(
                "{:<20} {:>5} {:<17} {:>7} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>6} {:>5} {:>5} {:>8}",
                "model",
                "%",
                "contender",
                "left",
                "% left",
                "mean %",
                "max %",
                "normals",
                "facets",
                "slide %",
                "image",
                "flip",
                "bad",
                "ms"
            );
        }
        let Some(m) = &self.measures else {
            println!("{:<20} {:>5} {:<17} empty", self.model, self.percent, self.contender);
            return;
        };
        println!(
            "{:<20} {:>5} {:<17} {:>7} {:>6.1} {:>8.4} {:>7.3} {:>7.2} {:>7.2} {:>7.3} {:>6.2} {:>5} {:>5} {:>8.1}{}{}",
            self.model,
            self.percent,
            self.contender,
            m.triangles,
            self.share(),
            m.mean,
            m.max,
            m.normals,
            m.facets,
            m.slide,
            m.image,
            m.flipped,
            m.invalid,
            self.ms,
            if self.reached() { "" } else { "  stuck" },
            if self.ruined() { "  ruin" } else { "" }
        );
    }

    /// Percent of the triangles left.
    fn share(&self) -> f64 {
        100.0 * self.measures.map_or(0, |m| m.triangles) as f64 / self.of as f64
    }

    fn reached(&self) -> bool {
        self.measures.is_none_or(|m| m.triangles <= self.target)
    }

    fn ruined(&self) -> bool {
        self.measures.is_none_or(|m| m.max > RUIN)
    }

    fn json(&self) -> Value {
        let m = self.measures.unwrap_or_default();
        json!({
            "model": self.model,
            "triangles": self.of,
            "contender": self.contender,
            "percent": self.percent,
            "target": self.target,
            "left": m.triangles,
            "share": self.share(),
            "reached": self.reached(),
            "ruined": self.ruined(),
            "mean": m.mean,
            "max": m.max,
            "normals": m.normals,
            "facets": m.facets,
            "slide": m.slide,
            "image": m.image,
            "flipped": m.flipped,
            "invalid": m.invalid,
            "ms": self.ms,
        })
    }
}

/// What one contender comes to at one percentage.
struct Mean {
    percent: f64,
    contender: &'static str,
    /// Models that count: the contender and one of the other simplifier's settings reached the target unruined.
    models: usize,
    /// For each column; not a number without models.
    ratios: Vec<f64>,
    stuck: Vec<String>,
    ruined: Vec<String>,
}

impl Table {
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    /// Every contender's geometric means, in order; then those of our best for each model and column.
    fn means(&self, percents: &[f64]) -> Vec<Mean> {
        let mut means = Vec::new();
        for &percent in percents {
            let ours: Vec<&str> = CONTENDERS.iter().filter(|c| !c.peer).map(|c| c.name).collect();
            for contender in CONTENDERS {
                means.extend(self.mean(percent, contender.name, &[contender.name]));
            }
            means.extend(self.mean(percent, OURS, &ours));
        }
        means
    }

    /// The best of some contenders against the best of the other simplifier's; nothing where none of them ran.
    fn mean(&self, percent: f64, name: &'static str, contenders: &[&str]) -> Option<Mean> {
        let good = |row: &&&Row| row.reached() && !row.ruined();
        let mut models: Vec<&str> = Vec::new();
        self.rows.iter().for_each(|row| {
            if !models.contains(&&*row.model) {
                models.push(&row.model);
            }
        });
        let mut logs = vec![0.0; COLUMNS.len()];
        let (mut counted, mut ran) = (0, false);
        let (mut stuck, mut ruined) = (Vec::new(), Vec::new());
        for model in models {
            let of_model = |row: &&Row| row.percent == percent && row.model == model;
            let rows: Vec<&Row> = self.rows.iter().filter(of_model).collect();
            let own: Vec<&Row> =
                rows.iter().copied().filter(|row| contenders.contains(&row.contender)).collect();
            if own.is_empty() {
                continue;
            }
            ran = true;
            if own.iter().all(|row| !row.reached()) {
                stuck.push(model.to_owned());
            }
            if own.iter().all(|row| row.ruined()) {
                ruined.push(model.to_owned());
            }
            let own: Vec<&Row> = own.iter().filter(good).copied().collect();
            let rivals: Vec<&Row> = rows.iter().copied().filter(|row| row.peer).collect();
            let good: Vec<&Row> = rivals.iter().filter(good).copied().collect();
            if own.is_empty() || good.is_empty() {
                continue;
            }
            counted += 1;
            for (log, column) in logs.iter_mut().zip(&COLUMNS) {
                *log += (column.least(&own) / column.rival(&good, &rivals)).ln();
            }
        }
        let ratios = logs.iter().map(|log| (log / counted as f64).exp()).collect();
        ran.then_some(Mean { percent, contender: name, models: counted, ratios, stuck, ruined })
    }

    /// For each model the least share, in percent of its triangles, that any of the other simplifier's settings and any of ours
    /// reached with every attribute valid and without ruin, of the percentages that were asked for.
    fn least(&self) -> Vec<(&str, [f64; 2])> {
        let mut all: Vec<(&str, [f64; 2])> = Vec::new();
        for row in &self.rows {
            let at = all.iter().position(|(model, _)| *model == row.model).unwrap_or_else(|| {
                all.push((&row.model, [100.0; 2]));
                all.len() - 1
            });
            if row.measures.is_some_and(|m| m.invalid == 0) && !row.ruined() {
                let least = &mut all[at].1[usize::from(!row.peer)];
                *least = least.min(row.share());
            }
        }
        all
    }

    pub(crate) fn print_summary(&self, percents: &[f64]) {
        println!(
            "\ngeometric means over models, against the best of meshopt's settings for each model and column (ms: against \
             meshopt-uv)\n"
        );
        print!("{:>5} {:<17} {:>6}", "%", "contender", "models");
        COLUMNS.iter().for_each(|column| print!(" {:>7}", column.name));
        println!("  not counted");
        for mean in self.means(percents) {
            print!("{:>5} {:<17} {:>6}", mean.percent, mean.contender, mean.models);
            mean.ratios.iter().for_each(|ratio| print!(" {ratio:>7.2}"));
            let mut notes = Vec::new();
            if !mean.stuck.is_empty() {
                notes.push(format!("stuck: {}", mean.stuck.join(" ")));
            }
            if !mean.ruined.is_empty() {
                notes.push(format!("ruined: {}", mean.ruined.join(" ")));
            }
            println!("  {}", notes.join("; "));
        }
        println!(
            "\nleast share reached with valid attributes, farther off nowhere than {RUIN} % of the diagonal\n"
        );
        println!("{:<20} {:>8} {:>8}", "model", "meshopt", "ours");
        for (model, [peer, ours]) in self.least() {
            println!("{model:<20} {peer:>8.2} {ours:>8.2}");
        }
    }

    pub(crate) fn json(&self, percents: &[f64]) -> Value {
        let rows: Vec<Value> = self.rows.iter().map(Row::json).collect();
        let least = self.least();
        let one = |(model, [peer, ours]): &(&str, [f64; 2])| json!({ "model": model, "meshopt": peer, "ours": ours });
        let least: Vec<Value> = least.iter().map(one).collect();
        let means = self.means(percents);
        let means: Vec<Value> = means
            .iter()
            .map(|mean| {
                let ratios: serde_json::Map<String, Value> =
                    COLUMNS.iter().zip(&mean.ratios).map(|(c, &r)| (c.name.to_owned(), json!(r))).collect();
                json!({
                    "percent": mean.percent,
                    "contender": mean.contender,
                    "models": mean.models,
                    "ratios": ratios,
                    "stuck": mean.stuck,
                    "ruined": mean.ruined,
                })
            })
            .collect();
        json!({ "unit": "percent of the diagonal, degrees, levels of 255, ms", "rows": rows, "means": means, "least": least })
    }
}
