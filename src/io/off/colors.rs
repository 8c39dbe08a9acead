//! Colours: their range, and the colours of faces.

use crate::io::corners::CornerValues;
use crate::io::draft::{Draft, Tally};
use crate::io::error::ReadError;
use crate::io::text::number;

/// Range of all colours of a file. Bytes are told from shares by their words.
#[derive(Default)]
pub(super) struct Range {
    fractions: bool,
    above_one: bool,
}

impl Range {
    /// Takes a component into account: its word and value.
    pub fn add(&mut self, word: &[u8], value: f64) {
        self.fractions |= !word.iter().all(u8::is_ascii_digit);
        self.above_one |= value > 1.0;
    }

    /// Returns the value of full intensity: 255 if all components are integers and one is above 1, else 1.
    pub fn maximum(&self) -> f64 {
        if self.above_one && !self.fractions { 255.0 } else { 1.0 }
    }
}

/// Colours of faces, before their range is known.
#[derive(Default)]
pub(super) struct FaceColors {
    range: Range,
    /// Triangles of a coloured face, number of components, and components.
    colors: Vec<([usize; 2], usize, [f32; 4])>,
    indices: Tally,
}

impl FaceColors {
    /// Adds the words after a face's corners: nothing, an index into a colour map, `r g b` or `r g b a`.
    pub fn add<'a>(&mut self, face: usize, triangles: [usize; 2], rest: impl Iterator<Item = &'a [u8]>) {
        let mut color = [0.0; 4];
        let mut count = 0;
        for (component, word) in color.iter_mut().zip(rest) {
            let Some(value) = number(word) else { break };
            self.range.add(word, value);
            *component = value as f32;
            count += 1;
        }
        if count >= 3 {
            self.colors.push((triangles, count, color));
        } else {
            self.indices.add(face);
        }
    }

    /// Adds the colours to the draft, and notes.
    pub fn apply(self, draft: &mut Draft) -> Result<(), ReadError> {
        self.indices.note("faces have an index into a colour map, left out", "face", &mut draft.notes);
        let maximum = self.range.maximum();
        let mut values = CornerValues::default();
        for ([from, to], count, color) in self.colors {
            let color = color.map(|x| (f64::from(x) / maximum) as f32);
            values.set_color(from, to, &color[..count]);
        }
        values.apply(draft)
    }
}
