//! Words of 4 bytes to a draft.
//!
//! ```text
//!     vertices faces edges
//!     vertex: x y z [w] [nx ny nz] [r g b [a]] [s t]           floats
//!     face:   n, n indices, [m, m components of a colour]      integers; floats
//! ```
//!
//! Geomview's files are big-endian, have four components a colour, and a colour count for each face. pmp-library writes
//! in the order of its machine, three components a colour, and no colour counts. Nothing in a file says which, so each
//! form is tried on the counts, sizes and indices; the first that ends with the file is taken, else the first that
//! fits. At most eight walks over the faces.

use super::layout::{Layout, MOST, Streams};
use crate::io::corners::CornerValues;
use crate::io::draft::Draft;
use crate::io::error::ReadError;
use crate::io::polygon::Polygons;

/// A form of binary files.
#[derive(Clone, Copy)]
struct Form {
    big: bool,
    /// Components of a vertex's colour.
    color: usize,
    /// Each face has a colour count.
    face_colors: bool,
}

/// Words of a binary file.
struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl Source<'_> {
    fn word(&mut self) -> Result<u32, ReadError> {
        let word = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<4>());
        self.at += 4;
        let missing = || ReadError::truncated(format!("4 bytes are needed at byte {}", self.at - 4));
        let word = *word.ok_or_else(missing)?;
        Ok(if self.big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) })
    }

    fn float(&mut self) -> Result<f32, ReadError> {
        self.word().map(f32::from_bits)
    }

    /// Reads a count of items of at least `least` bytes each.
    fn count(&mut self, least: usize, what: &str) -> Result<usize, ReadError> {
        let count = self.word()? as i32;
        let left = self.bytes.len().saturating_sub(self.at);
        match usize::try_from(count) {
            Ok(count) if count.saturating_mul(least) <= left => Ok(count),
            Ok(count) => Err(ReadError::truncated(format!("{count} {what}, {left} bytes are left"))),
            Err(_) => Err(ReadError::byte(self.at - 4, format!("{count} is no count of {what}"))),
        }
    }
}

/// Reads a binary file from byte `at` on.
pub(super) fn read(bytes: &[u8], at: usize, layout: Layout) -> Result<Draft, ReadError> {
    let forms = || {
        let colors: &[usize] = if layout.color { &[4, 3] } else { &[0] };
        [true, false].into_iter().flat_map(move |big| {
            [true, false].into_iter().flat_map(move |face_colors| {
                colors.iter().map(move |&color| Form { big, color, face_colors })
            })
        })
    };
    let mut fitting = None;
    let mut error = None;
    for form in forms() {
        match walk(bytes, at, layout, form) {
            Ok(end) if end == bytes.len() => return read_as(bytes, at, layout, form),
            Ok(_) => fitting = fitting.or(Some(form)),
            // The error of the form that comes farthest.
            Err((reached, found)) => match &error {
                Some((farthest, _)) if *farthest >= reached => {}
                _ => error = Some((reached, found)),
            },
        }
    }
    match (fitting, error) {
        (None, Some((_, error))) => Err(error),
        (form, _) => {
            let form = form.unwrap_or(Form { big: true, color: 4, face_colors: true });
            let mut draft = read_as(bytes, at, layout, form)?;
            draft.notes.push("bytes after the last face left out".to_owned());
            Ok(draft)
        }
    }
}

/// Returns where the last face ends; on failure, how far the walk came, and the error.
fn walk(bytes: &[u8], at: usize, layout: Layout, form: Form) -> Result<usize, (usize, ReadError)> {
    let mut source = Source { bytes, at, big: form.big };
    let result = (|| {
        let [vertices, faces] = counts(&mut source, layout, form)?;
        source.at += 4 * vertices * layout.width(form.color);
        for face in 0..faces {
            let size = source.count(4, "corners")?;
            for _ in 0..size {
                corner(&mut source, face, vertices)?;
            }
            if form.face_colors {
                source.at += 4 * source.count(4, "colour components")?;
            }
        }
        Ok(())
    })();
    match result {
        Ok(()) => Ok(source.at),
        Err(error) => Err((source.at, error)),
    }
}

fn counts(source: &mut Source, layout: Layout, form: Form) -> Result<[usize; 2], ReadError> {
    let vertices = source.count(4 * layout.width(form.color), "vertices")?;
    let faces = source.count(4 + 4 * usize::from(form.face_colors), "faces")?;
    source.word()?;
    let left = source.bytes.len().saturating_sub(source.at);
    let needed = 4 * vertices * layout.width(form.color);
    if needed > left {
        return Err(ReadError::truncated(format!("{vertices} vertices, {left} bytes are left")));
    }
    Ok([vertices, faces])
}

fn corner(source: &mut Source, face: usize, vertices: usize) -> Result<u32, ReadError> {
    let at = source.at;
    let index = source.word()?;
    if index as usize >= vertices {
        let what = format!("face {face} names vertex {}, but there are {vertices} vertices", index as i32);
        return Err(ReadError::byte(at, what));
    }
    Ok(index)
}

fn read_as(bytes: &[u8], at: usize, layout: Layout, form: Form) -> Result<Draft, ReadError> {
    let mut source = Source { bytes, at, big: form.big };
    let [vertices, faces] = counts(&mut source, layout, form)?;
    let width = layout.width(form.color);
    let mut streams = Streams::new(layout);
    streams.color_width = form.color;
    for vertex in 0..vertices {
        let mut values = [0.0; MOST];
        for value in &mut values[..width] {
            *value = f64::from(source.float()?);
        }
        if !streams.add(&values, form.color) {
            let what = format!("vertex {vertex} lies at infinity: its fourth coordinate is 0");
            return Err(ReadError::byte(source.at, what));
        }
    }
    let mut draft = streams.into_draft(1.0);

    let mut polygons = Polygons::new(bytes.len());
    let mut colors = CornerValues::default();
    for face in 0..faces {
        polygons.corners.clear();
        for _ in 0..source.count(4, "corners")? {
            polygons.corners.push(corner(&mut source, face, vertices)?);
        }
        let before = draft.triangles.len();
        polygons.add(face, &mut draft);
        if form.face_colors {
            let mut color = [0.0; 4];
            let count = source.count(4, "colour components")?;
            for component in 0..count {
                let value = source.float()?;
                if let Some(found) = color.get_mut(component) {
                    *found = value;
                }
            }
            if count >= 3 {
                colors.set_color(before, draft.triangles.len(), &color[..count.min(4)]);
            }
        }
    }
    polygons.note(&mut draft.notes);
    colors.apply(&mut draft)?;
    Ok(draft)
}
