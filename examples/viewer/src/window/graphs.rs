//! Numbers of the last frames, as curves.

use std::collections::VecDeque;

use egui::{Color32, Pos2, Sense, Stroke, Ui, vec2};

/// Frames kept.
const FRAMES: usize = 240;
/// Height of a curve, points.
const HEIGHT: f32 = 30.0;

/// One number a frame.
#[derive(Debug, Clone, Default)]
struct Curve {
    values: VecDeque<f32>,
}

/// What curves show, and in what.
const CURVES: [(&str, &str); 8] = [
    ("Triangles", ""),
    ("Tests", ""),
    ("Splits and collapses", ""),
    ("Adapt", "us"),
    ("Upload", "us"),
    ("Frame", "ms"),
    ("Bytes uploaded", ""),
    ("Tolerance factor, or bias", ""),
];
/// Places of the curves.
pub const TRIANGLES: usize = 0;
pub const TESTS: usize = 1;
pub const CHANGES: usize = 2;
pub const ADAPT: usize = 3;
pub const UPLOAD: usize = 4;
pub const FRAME: usize = 5;
pub const BYTES: usize = 6;
/// What the controller puts out.
pub const OUTPUT: usize = 7;

/// Curves of all numbers.
#[derive(Debug, Clone, Default)]
pub struct History {
    curves: [Curve; CURVES.len()],
}

/// The numbers of one frame, in the order of the curves: triangles, tests, splits and collapses, microseconds of adapt and of
/// upload, milliseconds of the frame, bytes uploaded, output of the controller.
pub type Numbers = [f32; CURVES.len()];

impl History {
    /// One more frame.
    pub fn push(&mut self, numbers: Numbers) {
        for (curve, value) in self.curves.iter_mut().zip(numbers) {
            if curve.values.len() == FRAMES {
                curve.values.pop_front();
            }
            curve.values.push_back(value);
        }
    }

    /// Shows some curves, with the last and the largest number of each.
    pub fn show(&self, ui: &mut Ui, which: impl IntoIterator<Item = usize>) {
        for i in which {
            let (curve, (name, unit)) = (&self.curves[i], CURVES[i]);
            let last = curve.values.back().copied().unwrap_or(0.0);
            let most = curve.values.iter().copied().fold(0.0, f32::max);
            let least = curve.values.iter().copied().fold(0.0, f32::min);
            ui.horizontal(|ui| {
                ui.label(name);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.weak(format!("most {}", short(most, unit)));
                    ui.strong(short(last, unit));
                });
            });
            curve.show(ui, least, most);
        }
    }
}

impl Curve {
    fn show(&self, ui: &mut Ui, least: f32, most: f32) {
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 3.0, ui.visuals().extreme_bg_color);
        let step = area.width() / (FRAMES - 1) as f32;
        let start = area.right() - step * (self.values.len().max(1) - 1) as f32;
        let at = |(i, &value): (usize, &f32)| {
            let high = if most > least { (value - least) / (most - least) } else { 0.0 };
            Pos2::new(start + step * i as f32, area.bottom() - 2.0 - high * (area.height() - 5.0))
        };
        let points: Vec<Pos2> = self.values.iter().enumerate().map(at).collect();
        painter.line(points, Stroke::new(1.5, Color32::from_rgb(96, 170, 230)));
    }
}

/// A number as people read it.
pub fn short(value: f32, unit: &str) -> String {
    if unit == "us" && value.abs() >= 9999.5 {
        return short(value / 1e3, "ms");
    }
    let number = match value.abs() {
        x if x >= 1e7 => format!("{:.0} M", value / 1e6),
        x if x >= 1e6 => format!("{:.1} M", value / 1e6),
        x if x >= 1e4 => format!("{:.0} k", value / 1e3),
        x if x >= 100.0 || value == 0.0 || (unit.is_empty() && x >= 1.0) => format!("{value:.0}"),
        x if x >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    };
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let all = [
            (0.0, "", "0"),
            (7.0, "", "7"),
            (1234.0, "", "1234"),
            (69_451.0, "", "69 k"),
            (2_500_000.0, "", "2.5 M"),
            (9.834, "us", "9.83 us"),
            (96.1, "us", "96.1 us"),
            (22_000.0, "us", "22.0 ms"),
            (16.67, "ms", "16.7 ms"),
        ];
        for (value, unit, text) in all {
            assert_eq!(short(value, unit), text);
        }
    }
}
