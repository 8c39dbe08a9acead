//! Line charts over a common axis, as one SVG.

use std::fmt::Write;

/// Several lines in one panel.
pub struct Panel<'a> {
    pub title: &'a str,
    /// Name, colour and a value per step.
    pub lines: Vec<(&'a str, &'a str, Vec<f64>)>,
    /// Share of the values that the panel must hold; the largest beyond are cut off at its top.
    pub holds: f64,
}

const WIDTH: f64 = 920.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 20.0;
const PANEL: f64 = 120.0;
const TITLE: f64 = 34.0;
const FOOT: f64 = 46.0;

/// Panels one below the other; `steps` names the axis that they share.
pub fn svg(panels: &[Panel<'_>], steps: &str) -> String {
    let height = panels.len() as f64 * (PANEL + TITLE) + FOOT;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#343a44\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"#ffffff\"/>\n"
    );
    let count = panels.iter().flat_map(|p| p.lines.iter().map(|l| l.2.len())).max().unwrap_or(0);
    let across =
        |step: usize| LEFT + (WIDTH - LEFT - RIGHT) * step as f64 / count.max(2).saturating_sub(1) as f64;
    let every = nice(count as f64 / 6.0).max(1.0) as usize;
    for (number, panel) in panels.iter().enumerate() {
        let top = number as f64 * (PANEL + TITLE) + TITLE;
        let most = most(panel);
        let tick = nice(most / 4.0);
        let most = (most / tick).ceil() * tick;
        let up = |value: f64| top + PANEL * (1.0 - (value / most).clamp(0.0, 1.0));
        put(
            &mut out,
            format_args!(
                "<text x=\"{LEFT}\" y=\"{:.1}\" font-weight=\"bold\">{}</text>",
                top - 11.0,
                panel.title
            ),
        );
        let mut right = WIDTH - RIGHT;
        for (name, colour, _) in panel.lines.iter().rev().filter(|_| panel.lines.len() > 1) {
            put(
                &mut out,
                format_args!(
                    "<text x=\"{right:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>",
                    top - 11.0
                ),
            );
            right -= 9.0 * name.len() as f64 + 14.0;
        }
        for i in 0..=(most / tick).round() as usize {
            let value = i as f64 * tick;
            let y = up(value);
            put(
                &mut out,
                format_args!(
                    "<line x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{y:.1}\" stroke=\"#e2e5ea\"/>",
                    WIDTH - RIGHT
                ),
            );
            put(
                &mut out,
                format_args!(
                    "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                    LEFT - 8.0,
                    y + 4.5,
                    label(value)
                ),
            );
        }
        for step in (0..count).step_by(every) {
            let x = across(step);
            put(
                &mut out,
                format_args!(
                    "<line x1=\"{x:.1}\" y1=\"{top}\" x2=\"{x:.1}\" y2=\"{:.1}\" stroke=\"#eef0f3\"/>",
                    top + PANEL
                ),
            );
        }
        for (_, colour, values) in &panel.lines {
            let points: Vec<String> =
                values.iter().enumerate().map(|(i, &v)| format!("{:.1},{:.1}", across(i), up(v))).collect();
            put(
                &mut out,
                format_args!(
                    "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\" points=\"{}\"/>",
                    points.join(" ")
                ),
            );
        }
    }
    let foot = height - FOOT + 18.0;
    for step in (0..count).step_by(every) {
        put(
            &mut out,
            format_args!("<text x=\"{:.1}\" y=\"{foot}\" text-anchor=\"middle\">{step}</text>", across(step)),
        );
    }
    let middle = (LEFT + WIDTH - RIGHT) * 0.5;
    put(
        &mut out,
        format_args!(
            "<text x=\"{middle}\" y=\"{:.1}\" text-anchor=\"middle\">{steps}</text>\n</svg>",
            foot + 20.0
        ),
    );
    out
}

fn put(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{text}");
}

/// The largest value that the panel must hold.
fn most(panel: &Panel<'_>) -> f64 {
    let mut all: Vec<f64> = panel.lines.iter().flat_map(|line| line.2.iter().copied()).collect();
    all.sort_by(f64::total_cmp);
    let last = all.len().saturating_sub(1) as f64;
    all.get((last * panel.holds) as usize).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE)
}

/// 1, 2 or 5 times a power of ten, not below.
fn nice(x: f64) -> f64 {
    let power = 10_f64.powf(x.max(1e-9).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|&n| n >= x * (1.0 - 1e-9))
        .unwrap_or(power * 10.0)
}

fn label(value: f64) -> String {
    if value >= 10_000.0 { format!("{} k", value / 1000.0) } else { format!("{value}") }
}
