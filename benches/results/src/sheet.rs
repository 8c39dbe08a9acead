//! Pictures in rows, each with a caption, and a legend at the foot.

use super::canvas::Canvas;
use super::lettering;

/// Pixels of a picture, and between and under pictures.
pub const SIZE: [usize; 2] = [512, 288];
const GAP: usize = 8;
const CAPTION: usize = 30;
const LEGEND: usize = 38;
const PAPER: [u8; 3] = [238, 238, 238];
const INK: [u8; 3] = [52, 58, 68];

/// A picture of [`SIZE`], row by row, and what to write below.
pub struct Cell {
    pub pixels: Vec<[u8; 3]>,
    pub caption: String,
}

/// Rows of pictures, and under them what colours mean, if there is anything to say.
pub fn sheet(rows: &[Vec<Cell>], entries: &[([u8; 3], &str)]) -> Canvas {
    let row = SIZE[1] + CAPTION;
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let foot = if entries.is_empty() { 0 } else { LEGEND };
    let size = [columns * (SIZE[0] + GAP) + GAP, rows.len() * row + GAP + foot];
    let mut sheet = Canvas::new(size[0] as u32, size[1] as u32, PAPER);
    for (number, cells) in rows.iter().enumerate() {
        let top = GAP + number * row;
        for (column, Cell { pixels, caption }) in cells.iter().enumerate() {
            let left = GAP + column * (SIZE[0] + GAP);
            for (i, &pixel) in pixels.iter().enumerate() {
                let at = [left + i % SIZE[0], top + i / SIZE[0]].map(|n| n as u32);
                sheet.put(at[0], at[1], pixel);
            }
            let middle = [left + SIZE[0] / 2, top + SIZE[1] + CAPTION / 2].map(|n| n as f32);
            lettering::write(&mut sheet, caption, middle, INK);
        }
    }
    if !entries.is_empty() {
        legend(&mut sheet, entries, [size[0] as f32, (size[1] - LEGEND / 2) as f32]);
    }
    sheet
}

fn legend(sheet: &mut Canvas, entries: &[([u8; 3], &str)], [width, middle]: [f32; 2]) {
    const SWATCH: f32 = 18.0;
    let wide = |text: &str| SWATCH + 8.0 + lettering::length(text);
    let all: f32 = entries.iter().map(|(_, text)| wide(text) + 30.0).sum::<f32>() - 30.0;
    let mut x = (width - all) * 0.5;
    for &(colour, text) in entries {
        for py in 0..SWATCH as u32 {
            for px in 0..SWATCH as u32 {
                let at = [x as u32 + px, (middle - SWATCH * 0.5) as u32 + py];
                sheet.put(at[0], at[1], colour);
            }
        }
        let text_middle = x + SWATCH + 8.0 + lettering::length(text) * 0.5;
        lettering::write(sheet, text, [text_middle, middle], INK);
        x += wide(text) + 30.0;
    }
}
