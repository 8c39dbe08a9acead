//! What the frames of a path upload and take, as a table.

use std::fmt::Write as _;
use std::time::Duration;

use super::FrameReport;
use crate::scene::Scene;

/// Mean, median, 99th percentile and most of some numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Summary {
    /// Mean.
    pub mean: f64,
    /// Half are at most this.
    pub median: f64,
    /// 99 of a hundred are at most this.
    pub p99: f64,
    /// Most.
    pub most: f64,
}

impl Summary {
    /// Of numbers in any order; zeros of none.
    pub fn of(mut numbers: Vec<f64>) -> Self {
        numbers.sort_unstable_by(f64::total_cmp);
        let Some(&most) = numbers.last() else { return Self::default() };
        let at = |share: f64| numbers[((numbers.len() - 1) as f64 * share).round() as usize];
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        Self { mean, median: at(0.5), p99: at(0.99), most }
    }
}

/// Frames so far.
#[derive(Debug, Clone, Default)]
pub struct Bench {
    rows: Vec<[f64; COLUMNS.len()]>,
    /// From the start of the program to the end of the first frame that was drawn.
    pub first_picture: Option<Duration>,
}

/// What is measured of every frame, and its digits after the point.
const COLUMNS: [(&str, usize); 13] = [
    ("triangles", 0),
    ("tests", 0),
    ("splits", 0),
    ("collapses", 0),
    ("ranges written", 0),
    ("index bytes written", 0),
    ("vertex bytes written", 0),
    ("index buffer written, %", 2),
    ("adapt, us", 1),
    ("upload, us", 1),
    ("record draws, us", 1),
    ("all of the CPU, us", 1),
    ("wait for the card, us", 1),
];
/// The column of the written share of the index buffer.
const SHARE: usize = 7;

impl Bench {
    /// One more frame.
    pub fn add(&mut self, report: &FrameReport, scene: &Scene) {
        let micros = |time: Duration| time.as_secs_f64() * 1e6;
        let change = report.adapted.change;
        let drawn = scene.index_bytes().max(1);
        self.rows.push([
            change.triangles as f64,
            change.cut.tests as f64,
            change.cut.splits as f64,
            change.cut.collapses as f64,
            report.uploaded.ranges as f64,
            report.uploaded.indices as f64,
            report.uploaded.vertices as f64,
            100.0 * report.uploaded.indices as f64 / drawn as f64,
            micros(report.adapted.time),
            micros(report.upload),
            micros(report.draw),
            micros(report.cpu()),
            micros(report.wait),
        ]);
    }

    /// The share of the drawn index buffer, in percent, that frames write: the first, which writes all, left out.
    pub fn written_share(&self) -> Summary {
        Summary::of(self.rows.iter().skip(1).map(|row| row[SHARE]).collect())
    }

    /// A table over all frames but the first, which builds up everything and has a line of its own.
    pub fn table(&self, scene: &Scene) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        if let Some(first) = self.first_picture {
            let _ = writeln!(text, "first picture after {:.2} s", first.as_secs_f64());
        }
        if let Some(first) = self.rows.first() {
            let _ = writeln!(
                text,
                "first frame: {:.0} triangles, {:.0} bytes of indices and {:.0} of vertices written, {:.0} us of CPU",
                first[0], first[5], first[6], first[11],
            );
        }
        let [own, shared] = scene.card_memory();
        let _ = writeln!(
            text,
            "{} objects; bytes on the card: {own} of instances, {shared} shared; in memory: {} of instances",
            scene.len(),
            scene.memory(),
        );
        let frames = self.rows.len().saturating_sub(1);
        let heads = ["mean", "median", "99 %", "most"];
        let _ = write!(text, "{:<26}", format!("{frames} frames after it"));
        for head in heads {
            let _ = write!(text, "{head:>13}");
        }
        for (i, (name, digits)) in COLUMNS.into_iter().enumerate() {
            let Summary { mean, median, p99, most } =
                Summary::of(self.rows.iter().skip(1).map(|row| row[i]).collect());
            let _ = write!(text, "\n{name:<26}");
            for number in [mean, median, p99, most] {
                let _ = write!(text, "{number:>13.digits$}");
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summaries_are_of_all_numbers() {
        let summary = Summary::of((0..=100).rev().map(f64::from).collect());
        assert_eq!(summary, Summary { mean: 50.0, median: 50.0, p99: 99.0, most: 100.0 });
        assert_eq!(Summary::of(Vec::new()), Summary::default());
    }
}
