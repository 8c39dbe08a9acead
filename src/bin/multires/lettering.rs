//! Captions without a font file: every character is a few strokes on a grid, 6 units from the baseline to the top.

use image::{Rgb, RgbImage};

/// Pixels of one unit, and half the width of a stroke.
const UNIT: f32 = 1.8;
const HALF_STROKE: f32 = 0.85;
/// Units between characters, and of a blank.
const GAP: f32 = 1.7;
const BLANK: f32 = 1.4;

type Stroke = &'static [[f32; 2]];

/// The strokes of the characters that captions need; none for others.
fn strokes(character: char) -> &'static [Stroke] {
    match character {
        '0' => &[&[
            [0., 1.5],
            [0., 4.5],
            [1., 6.],
            [3., 6.],
            [4., 4.5],
            [4., 1.5],
            [3., 0.],
            [1., 0.],
            [0., 1.5],
        ]],
        '1' => &[&[[0., 4.8], [1.6, 6.], [1.6, 0.]]],
        '2' => &[&[[0., 4.8], [1., 6.], [3., 6.], [4., 5.], [4., 4.], [0., 0.], [4., 0.]]],
        '3' => &[
            &[[0., 5.], [1., 6.], [3., 6.], [4., 5.], [4., 4.2], [3., 3.2], [1.5, 3.2]],
            &[[3., 3.2], [4., 2.2], [4., 1.], [3., 0.], [1., 0.], [0., 1.]],
        ],
        '4' => &[&[[3., 0.], [3., 6.], [0., 1.8], [4.2, 1.8]]],
        '5' => &[&[
            [3.8, 6.],
            [0.4, 6.],
            [0.1, 3.3],
            [1., 3.8],
            [3., 3.8],
            [4., 2.8],
            [4., 1.],
            [3., 0.],
            [1., 0.],
            [0., 0.9],
        ]],
        '6' => &[&[
            [3.5, 6.],
            [1.8, 6.],
            [0., 3.8],
            [0., 1.],
            [1., 0.],
            [3., 0.],
            [4., 1.],
            [4., 2.6],
            [3., 3.6],
            [1., 3.6],
            [0., 2.6],
        ]],
        '7' => &[&[[0., 6.], [4., 6.], [1.4, 0.]]],
        '8' => &[&[
            [1., 3.2],
            [0., 4.2],
            [0., 5.],
            [1., 6.],
            [3., 6.],
            [4., 5.],
            [4., 4.2],
            [3., 3.2],
            [1., 3.2],
            [0., 2.2],
            [0., 1.],
            [1., 0.],
            [3., 0.],
            [4., 1.],
            [4., 2.2],
            [3., 3.2],
        ]],
        '9' => &[&[
            [0.5, 0.],
            [2.2, 0.],
            [4., 2.2],
            [4., 5.],
            [3., 6.],
            [1., 6.],
            [0., 5.],
            [0., 3.4],
            [1., 2.4],
            [3., 2.4],
            [4., 3.4],
        ]],
        '%' => &[
            &[[0.6, 0.], [4.4, 6.]],
            &[[0., 4.9], [0.9, 6.], [1.8, 4.9], [0.9, 3.8], [0., 4.9]],
            &[[3.2, 1.1], [4.1, 2.2], [5., 1.1], [4.1, 0.], [3.2, 1.1]],
        ],
        '-' => &[&[[0.3, 2.4], [3., 2.4]]],
        ',' => &[&[[0.5, 0.3], [0., -1.2]]],
        '.' => &[&[[0.2, 0.], [0.2, 0.1]]],
        'a' => &[
            &[[3.2, 4.], [3.2, 0.]],
            &[[3.2, 3.], [2.2, 4.], [1., 4.], [0., 3.], [0., 1.], [1., 0.], [2.2, 0.], [3.2, 1.]],
        ],
        'e' => {
            &[&[[0., 2.], [3.2, 2.], [3.2, 3.], [2.2, 4.], [1., 4.], [0., 3.], [0., 1.], [1., 0.], [2.8, 0.]]]
        }
        'g' => &[
            &[[3.2, 4.], [3.2, -1.], [2.2, -2.], [0.6, -2.]],
            &[[3.2, 3.], [2.2, 4.], [1., 4.], [0., 3.], [0., 1.], [1., 0.], [2.2, 0.], [3.2, 1.]],
        ],
        'i' => &[&[[0., 0.], [0., 4.]], &[[0., 5.7], [0., 5.8]]],
        'l' => &[&[[0., 0.], [0., 6.2]]],
        'n' => &[&[[0., 0.], [0., 4.]], &[[0., 3.], [1., 4.], [2.2, 4.], [3.2, 3.], [3.2, 0.]]],
        'r' => &[&[[0., 0.], [0., 4.]], &[[0., 2.8], [1.2, 4.], [2.2, 4.]]],
        's' => &[&[
            [3., 3.3],
            [2.2, 4.],
            [0.9, 4.],
            [0., 3.2],
            [0.5, 2.3],
            [2.5, 1.8],
            [3., 0.9],
            [2.1, 0.],
            [0.8, 0.],
            [0., 0.7],
        ]],
        't' => &[&[[0.9, 5.6], [0.9, 1.], [1.7, 0.], [2.4, 0.]], &[[0., 4.], [2.3, 4.]]],
        _ => &[],
    }
}

fn width(character: char) -> f32 {
    let points = strokes(character).iter().copied().flatten();
    if character == ' ' { BLANK } else { points.fold(0.0, |width: f32, point| width.max(point[0])) }
}

/// Writes a line centred about a point, pixels from the top left.
pub fn write(sheet: &mut RgbImage, text: &str, middle: [f32; 2], ink: [u8; 3]) {
    let length: f32 = text.chars().map(|c| width(c) + GAP).sum::<f32>() - GAP;
    let (mut x, baseline) = (middle[0] - 0.5 * length * UNIT, middle[1] + 3.0 * UNIT);
    for character in text.chars() {
        let place = |p: [f32; 2]| [x + p[0] * UNIT, baseline - p[1] * UNIT];
        let segments: Vec<_> = strokes(character)
            .iter()
            .flat_map(|s| s.windows(2))
            .map(|s| [place(s[0]), place(s[1])])
            .collect();
        let (low, high) = (place([-1.0, 7.5]), place([width(character) + 1.0, -3.5]));
        for py in low[1] as u32..high[1] as u32 {
            for px in low[0] as u32..high[0] as u32 {
                let at = [px as f32 + 0.5, py as f32 + 0.5];
                let nearest = segments.iter().map(|s| distance(at, *s)).fold(f32::MAX, f32::min);
                let cover = (HALF_STROKE + 0.5 - nearest).clamp(0.0, 1.0);
                if let (true, Some(Rgb(pixel))) = (cover > 0.0, sheet.get_pixel_mut_checked(px, py)) {
                    for (value, ink) in pixel.iter_mut().zip(ink) {
                        *value = (f32::from(*value) * (1.0 - cover) + f32::from(ink) * cover) as u8;
                    }
                }
            }
        }
        x += (width(character) + GAP) * UNIT;
    }
}

/// From a point to a segment.
fn distance(p: [f32; 2], [a, b]: [[f32; 2]; 2]) -> f32 {
    let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = ab[0] * ab[0] + ab[1] * ab[1];
    let t = if length > 0.0 { ((ap[0] * ab[0] + ap[1] * ab[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (ap[0] - t * ab[0]).hypot(ap[1] - t * ab[1])
}
