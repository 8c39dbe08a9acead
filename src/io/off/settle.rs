//! Which values a vertex has that the first word leaves open.
//!
//! MeshLab writes `r g b a nx ny nz` where Geomview has `nx ny nz r g b a`, and many programs write colours under a
//! plain `OFF`. A negative value is no colour, nor is a fraction above 1; a normal mostly has length 1.

use super::layout::{Layout, MOST};
use crate::io::text::{number, words};

/// Returns the layout that the rows of the vertices have. Adds a note if it is not the one of the first word.
pub(super) fn settled<'a>(
    mut layout: Layout,
    rows: impl Iterator<Item = (usize, &'a [u8])> + Clone,
    notes: &mut Vec<String>,
) -> Layout {
    let mut rows = rows.map(|(_, row)| values(row));
    if layout.color && layout.normal {
        layout.color_first = has_color_first(layout, rows);
        return layout;
    }
    let Some((_, first)) = rows.clone().next() else { return layout };
    let width = layout.width(0);
    if layout.color || layout.normal || first <= width {
        return layout;
    }
    let at = layout.coordinates();
    let is_color = |values: &[f64]| !values[at..at + 3].iter().any(|&x| x < 0.0);
    match first - width {
        3 if !rows.all(|(values, _)| is_color(&values)) => {
            layout.normal = true;
            notes.push(
                "vertices have three more values than the first word says: taken for normals".to_owned(),
            );
        }
        extra @ (3 | 4) => {
            (layout.color, layout.implied) = (true, true);
            notes.push(format!(
                "vertices have {extra} more values than the first word says: taken for colours"
            ));
        }
        extra => {
            notes.push(format!("vertices have {extra} more values than the first word says: left out"));
        }
    }
    layout
}

/// Returns the numbers of a row and their count. Words that are no numbers are NaN here, and refused later.
fn values(row: &[u8]) -> ([f64; MOST], usize) {
    let mut values = [0.0; MOST];
    let mut count = 0;
    for (value, word) in values.iter_mut().zip(words(row)) {
        *value = number(word).unwrap_or(f64::NAN);
        count += 1;
    }
    (values, count)
}

/// Tests if colours come before normals. The first row with one possible order decides; without such a row, the length
/// of normals; else the order of letters in the first word.
pub(super) fn has_color_first(layout: Layout, rows: impl Iterator<Item = ([f64; MOST], usize)>) -> bool {
    let at = layout.coordinates();
    let mut unit_lengths = 0_i64;
    for (values, count) in rows {
        let color = count.saturating_sub(layout.width(0)).min(4);
        if color < 3 {
            break;
        }
        let normal_first = is_color(&values[at + 3..at + 3 + color]);
        let color_first = is_color(&values[at..at + color]);
        if normal_first != color_first {
            return color_first;
        }
        let is_unit = |at: usize| is_unit(&values[at..at + 3]);
        unit_lengths += i64::from(is_unit(at + color)) - i64::from(is_unit(at));
    }
    match unit_lengths {
        0 => layout.color_first,
        more => more > 0,
    }
}

/// Tests if values may be a colour.
fn is_color(values: &[f64]) -> bool {
    values.iter().all(|&x| (0.0..=1.0).contains(&x) || (x > 0.0 && x.fract() == 0.0))
}

fn is_unit(normal: &[f64]) -> bool {
    (normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 0.02
}
