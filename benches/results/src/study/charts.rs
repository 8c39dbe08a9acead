//! Measures against triangles kept, one sheet of small charts: a line for each metric, or for each placement.
//!
//! A point is the mean over all models and all ways that share the metric (or the placement) at one step. Both axes are
//! logarithmic, except that triangle shapes have a linear one; a mean of 0, as of the model itself, has no place there.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::grid::{CHANGE, L1, L2, MAX, MEASURES, METRICS, METRO, PLACEMENTS, Row, SILHOUETTE, SLIVER};
use super::statistics::mean;

/// What the lines of a sheet are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lines {
    Metrics,
    Placements,
}

impl Lines {
    fn names(self) -> Vec<&'static str> {
        match self {
            Self::Metrics => METRICS.iter().map(|metric| metric.symbol).collect(),
            Self::Placements => PLACEMENTS.iter().map(|placement| placement.1).collect(),
        }
    }

    fn of(self, row: &Row) -> usize {
        match self {
            Self::Metrics => row.metric,
            Self::Placements => row.placement,
        }
    }
}

/// The measures drawn, row after row; the legend comes last.
const CHARTS: [usize; 7] = [L1, L2, SILHOUETTE, METRO, MAX, CHANGE, SLIVER];
const GRID: (usize, usize) = (2, 4);
const SIZE: (u32, u32) = (1200, 560);
const FONT: &str = "sans-serif";
/// Okabe and Ito's colours, told apart by the colour-blind too.
const COLOURS: [RGBColor; 8] = [
    RGBColor(213, 94, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(0, 0, 0),
    RGBColor(204, 121, 167),
    RGBColor(150, 150, 150),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn Error>>;

/// The sheet as SVG.
pub fn sheet(rows: &[Row], lines: Lines) -> Result<String, Box<dyn Error>> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(shown)?;
        let areas = root.split_evenly(GRID);
        for (&measure, area) in CHARTS.iter().zip(&areas) {
            chart(area, rows, lines, measure)?;
        }
        if let Some(area) = areas.last() {
            legend(area, &lines.names())?;
        }
        root.present().map_err(shown)?;
    }
    Ok(svg)
}

/// Kept percent and mean of every step of one line, coarse to fine.
fn points(rows: &[Row], lines: Lines, line: usize, measure: usize) -> Vec<(f64, f64)> {
    let own: Vec<&Row> = rows.iter().filter(|row| lines.of(row) == line).collect();
    let steps = own.iter().map(|row| row.step + 1).max().unwrap_or(0);
    let point = |step: usize| {
        let level: Vec<&&Row> = own.iter().filter(|row| row.step == step).collect();
        let values: Vec<f64> = level.iter().filter_map(|row| row.values[measure]).collect();
        Some((100.0 * level.first()?.kept, mean(&values)?))
    };
    (0..steps).rev().filter_map(point).filter(|p| p.0 > 0.0 && p.1 > 0.0).collect()
}

/// The smallest range around all numbers, with some room if it is narrow; `None` of none.
fn span(numbers: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = numbers.fold((f64::INFINITY, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
    (low <= high).then_some(if high > 1.02 * low { low..high } else { 0.98 * low..1.02 * high })
}

/// 1, 2 and 5 of every decade in a range; of a long one the decades alone.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let of = |leads: &[f64]| -> Vec<f64> {
        let all = decades.clone().flat_map(|decade| leads.iter().map(move |lead| lead * 10f64.powi(decade)));
        all.filter(|tick| *tick >= 0.999 * range.start && *tick <= 1.001 * range.end).collect()
    };
    let fine = of(&[1.0, 2.0, 5.0]);
    if fine.len() > 8 { of(&[1.0]) } else { fine }
}

fn chart(area: &Area<'_>, rows: &[Row], lines: Lines, measure: usize) -> Drawn {
    let all: Vec<_> = (0..lines.names().len()).map(|line| points(rows, lines, line, measure)).collect();
    let flat = || all.iter().flatten();
    let log = |range: &Range<f64>| range.clone().log_scale().with_key_points(ticks(range));
    let (Some(x), Some(y)) = (span(flat().map(|p| p.0)), span(flat().map(|p| p.1))) else {
        return Ok(());
    };
    let mut builder = ChartBuilder::on(area);
    builder
        .margin(8)
        .caption(MEASURES[measure].title, (FONT, 15))
        .x_label_area_size(34)
        .y_label_area_size(52);
    // The coordinates' types differ, so the two kinds of axis do not meet in one variable.
    macro_rules! draw {
        ($y:expr) => {{
            let mut chart = builder.build_cartesian_2d(log(&x), $y).map_err(shown)?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .bold_line_style(RGBColor(225, 225, 225))
                .label_style((FONT, 12))
                .x_labels(5)
                .y_labels(6)
                .x_desc("triangles kept, %")
                .x_label_formatter(&|x| short(*x))
                .y_label_formatter(&|y| short(*y))
                .draw()
                .map_err(shown)?;
            for (line, points) in all.iter().enumerate() {
                let style = COLOURS[line % COLOURS.len()].stroke_width(2);
                chart.draw_series(LineSeries::new(points.iter().copied(), style)).map_err(shown)?;
            }
        }};
    }
    if measure == SLIVER {
        draw!(y)
    } else {
        draw!(log(&y))
    }
    Ok(())
}

fn legend(area: &Area<'_>, names: &[&str]) -> Drawn {
    for (line, name) in names.iter().enumerate() {
        let y = 48 + 24 * line as i32;
        let style = COLOURS[line % COLOURS.len()].stroke_width(3);
        area.draw(&PathElement::new([(40, y), (70, y)], style)).map_err(shown)?;
        area.draw(&Text::new((*name).to_owned(), (80, y - 7), (FONT, 15))).map_err(shown)?;
    }
    Ok(())
}

/// A number as short as three digits allow.
fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
        return format!("{x:.0e}");
    }
    let decimals = if x == 0.0 { 0 } else { (2 - x.abs().log10().floor() as i32).clamp(0, 6) as usize };
    let text = format!("{x:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The drawing library's errors borrow what is drawn on; their words do not.
fn shown(error: impl Error) -> String {
    error.to_string()
}
