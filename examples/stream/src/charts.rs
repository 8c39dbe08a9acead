//! Line charts as SVG: panels below each other or side by side, each with its own axes.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::AnyError;

/// A line of a chart.
#[derive(Debug, Clone)]
pub struct Line {
    /// Name in the legend.
    pub name: &'static str,
    /// Colour.
    pub colour: RGBColor,
    /// Points from left to right.
    pub points: Vec<(f64, f64)>,
}

/// Several lines over common axes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Title.
    pub title: &'static str,
    /// Names of the axes.
    pub axes: [&'static str; 2],
    /// Whether both axes are logarithmic.
    pub log: bool,
    /// End of the vertical axis; `None` for the largest value.
    pub most: Option<f64>,
    /// The lines.
    pub lines: Vec<Line>,
}

/// Vermilion of the palette by Okabe and Ito, which the colour-blind tell apart.
pub const ORANGE: RGBColor = RGBColor(213, 94, 0);
/// Blue of the same palette.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Green of the same palette.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Grey, for what the lines are compared with.
pub const GREY: RGBColor = RGBColor(150, 150, 150);

const FONT: &str = "sans-serif";
/// Pixels around a panel.
const MARGIN: i32 = 8;

/// Draws panels in a grid of `rows` and `columns`, a picture of `size` pixels.
///
/// # Errors
/// There is no room for a panel.
pub fn svg(panels: &[Panel], grid: (usize, usize), size: (u32, u32)) -> Result<String, AnyError> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(shown)?;
        for (panel, area) in panels.iter().zip(&root.split_evenly(grid)) {
            draw(area, panel)?;
        }
        root.present().map_err(shown)?;
    }
    Ok(svg)
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), AnyError> {
    let all =
        || panel.lines.iter().flat_map(|line| &line.points).filter(|p| !panel.log || p.0 > 0.0 && p.1 > 0.0);
    let (x, mut y) = (span(all().map(|p| p.0)), span(all().map(|p| p.1)));
    if !panel.log {
        y.start = 0.0;
    }
    y.end = panel.most.unwrap_or(y.end * 1.05);
    if panel.log {
        y.start *= 0.8;
    }
    let mut builder = ChartBuilder::on(area);
    builder.margin(MARGIN).margin_right(MARGIN + 8);
    let title = (FONT, 15).into_font().into_text_style(area).pos(Pos::new(HPos::Left, VPos::Top));
    area.draw_text(panel.title, &title, (62 + MARGIN, MARGIN + 2)).map_err(shown)?;
    builder.margin_top(MARGIN + 24).x_label_area_size(36).y_label_area_size(62);
    // The coordinates' types differ, so the two kinds of axis do not meet in one variable.
    macro_rules! chart {
        ($x:expr, $y:expr) => {{
            let mut chart = builder.build_cartesian_2d($x, $y).map_err(shown)?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .bold_line_style(RGBColor(228, 228, 228))
                .label_style((FONT, 13))
                .x_labels(8)
                .y_labels(6)
                .x_desc(panel.axes[0])
                .y_desc(panel.axes[1])
                .x_label_formatter(&|x| short(*x))
                .y_label_formatter(&|y| short(*y))
                .draw()
                .map_err(shown)?;
            for line in &panel.lines {
                let style = line.colour.stroke_width(2);
                let points = line.points.iter().map(|p| (p.0, p.1.min(y.end)));
                chart.draw_series(LineSeries::new(points, style)).map_err(shown)?;
            }
        }};
    }
    if panel.log {
        let log = |range: &Range<f64>| range.clone().log_scale().with_key_points(ticks(range));
        chart!(log(&x), log(&y))
    } else {
        chart!(x.clone(), y.clone())
    }
    if panel.lines.len() > 1 {
        name_lines(area, &panel.lines)?;
    }
    Ok(())
}

/// Writes the names of lines in their colours above a panel, at the right: no name covers a line.
fn name_lines(area: &DrawingArea<SVGBackend<'_>, Shift>, lines: &[Line]) -> Result<(), AnyError> {
    let mut right = area.dim_in_pixel().0 as i32 - MARGIN;
    for line in lines.iter().rev() {
        let style = (FONT, 13).into_font().color(&line.colour).pos(Pos::new(HPos::Right, VPos::Top));
        area.draw_text(line.name, &style, (right, MARGIN + 4)).map_err(shown)?;
        right -= 7 * line.name.len() as i32 + 16;
    }
    Ok(())
}

fn span(numbers: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) =
        numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low < high { low..high } else { 0.0..1.0 }
}

/// Returns 1, 2 and 5 of every decade in a range.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|lead| lead * 10_f64.powi(decade)));
    all.filter(|tick| *tick >= 0.999 * range.start && *tick <= 1.001 * range.end).collect()
}

/// Writes a number with at most three digits, thousands as k.
fn short(x: f64) -> String {
    let (x, unit) = if x.abs() >= 10_000.0 { (x / 1000.0, " k") } else { (x, "") };
    let decimals = if x == 0.0 { 0 } else { (2 - x.abs().log10().floor() as i32).clamp(0, 6) as usize };
    let text = format!("{x:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text}{unit}")
}

/// The drawing library's errors borrow what is drawn on; their words do not.
fn shown(error: impl Error) -> String {
    error.to_string()
}
