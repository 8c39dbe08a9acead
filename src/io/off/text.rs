//! Rows of text, or words in sequence, to a draft.
//!
//! Each vertex and each face has a row of its own in most files: a row may then have a colour, or not. If there are
//! fewer rows than vertices and faces, words are read in sequence, and faces have no colours.

use super::colors::{FaceColors, Range};
use super::layout::{Layout, MOST, Streams};
use super::settle::{has_color_first, settled};
use crate::io::draft::Draft;
use crate::io::error::ReadError;
use crate::io::polygon::Polygons;
use crate::io::text::{Lines, Words, integer, number, quoted, words};

/// Returns a line up to any `#`, except for the `#` in numbers like `1.#IND`.
pub(super) fn without_hash(line: &[u8]) -> &[u8] {
    match line.iter().position(|&b| b == b'#') {
        Some(first) => before_comment(line, first),
        None => line,
    }
}

/// Returns a line up to its comment; `first` is the place of the first `#`.
#[cold]
fn before_comment(line: &[u8], first: usize) -> &[u8] {
    let is_comment = |&at: &usize| {
        let after_point = at > 0 && line[at - 1] == b'.';
        line[at] == b'#' && !(after_point && matches!(line.get(at + 1), Some(b'I' | b'Q' | b'S')))
    };
    (first..line.len()).find(is_comment).map_or(line, |end| &line[..end])
}

/// Returns the next word that is no comment.
pub(super) fn next<'a>(words: &mut Words<'a>) -> Option<&'a [u8]> {
    loop {
        let word = words.next()?;
        let kept = without_hash(word);
        if kept.len() < word.len() {
            words.skip_line();
        }
        if !kept.is_empty() {
            return Some(kept);
        }
    }
}

/// Tests if only blanks and a comment follow in the line.
pub(super) fn ends_line(words: &mut Words) -> bool {
    words.at_line_end() || words.rest().starts_with(b"#")
}

/// Reads the vertices and faces. `bytes` begins at the end of the header's last line, `line`.
pub(super) fn read(
    bytes: &[u8],
    line: usize,
    counts: [usize; 2],
    layout: Layout,
) -> Result<Draft, ReadError> {
    // Line ends before the last row: the number of rows after the header's.
    let upto_last = bytes.trim_ascii_end();
    let ends = match count(upto_last, b'\n') {
        0 => count(upto_last, b'\r'),
        ends => ends,
    };
    let needed = counts[0].saturating_add(counts[1]);
    if ends >= needed {
        return read_rows(bytes, line, counts, layout);
    }
    let in_sequence = |color| read_words(Words::new(bytes, line), counts, layout, color);
    let found = match in_sequence(4) {
        Err(error) if layout.color => in_sequence(3).map_err(|_| error),
        found => found,
    };
    // A file that lacks its last rows is told by row.
    let is_cut = found.is_err() && ends >= needed / 2;
    if is_cut { read_rows(bytes, line, counts, layout) } else { found }
}

/// Returns how often a byte occurs. Sums of a byte each, in chunks, are fast.
fn count(bytes: &[u8], byte: u8) -> usize {
    let in_chunk = |chunk: &[u8]| usize::from(chunk.iter().map(|&b| u8::from(b == byte)).sum::<u8>());
    bytes.chunks(255).map(in_chunk).sum()
}

fn read_rows(bytes: &[u8], line: usize, counts: [usize; 2], layout: Layout) -> Result<Draft, ReadError> {
    let [vertices, faces] = counts;
    let mut rows = Lines::from_line(bytes, line)
        .skip(1)
        .map(|(number, line)| (number, without_hash(line)))
        .filter(|(_, line)| words(line).next().is_some());
    let mut notes = Vec::new();
    let layout = settled(layout, rows.clone().take(vertices), &mut notes);
    let mut draft = read_vertices(&mut rows, vertices, layout)?;
    draft.notes = notes;

    let mut polygons = Polygons::new(bytes.len());
    let mut colors = FaceColors::default();
    for face in 0..faces {
        let (line, content) = rows
            .next()
            .ok_or_else(|| ReadError::truncated(format!("{faces} faces are declared, {face} are there")))?;
        let mut rest = words(content);
        read_corners(&mut rest, face, vertices, &mut polygons.corners)
            .map_err(|what| ReadError::line(line, what))?;
        let before = draft.triangles.len();
        polygons.add(face, &mut draft);
        if let Some(word) = rest.next() {
            colors.add(face, [before, draft.triangles.len()], std::iter::once(word).chain(rest));
        }
    }
    polygons.note(&mut draft.notes);
    colors.apply(&mut draft)?;
    Ok(draft)
}

fn read_vertices<'a>(
    rows: &mut impl Iterator<Item = (usize, &'a [u8])>,
    vertices: usize,
    layout: Layout,
) -> Result<Draft, ReadError> {
    let mut streams = Streams::new(layout);
    let mut range = Range::default();
    let without_color = layout.width(0);
    let color_at = layout.color_at();
    let is_plain = layout == Layout::default();
    let least = if layout.implied { 0 } else { layout.width(3) - without_color };
    streams.positions.reserve_exact(vertices);
    for vertex in 0..vertices {
        let (line, content) = rows.next().ok_or_else(|| {
            ReadError::truncated(format!("{vertices} vertices are declared, {vertex} are there"))
        })?;
        let mut values = [0.0; MOST];
        let mut count = 0_usize;
        for (value, word) in values.iter_mut().zip(words(content)) {
            let fail = || ReadError::line(line, format!("{} is not a number", quoted(word)));
            *value = number(word).ok_or_else(fail)?;
            count += 1;
        }
        if count < without_color + least {
            return Err(ReadError::line(line, format!("vertex {vertex} has {count} numbers, too few")));
        }
        if is_plain {
            streams.positions.push([values[0], values[1], values[2]]);
            continue;
        }
        let color = if layout.color { (count - without_color).min(4) } else { 0 };
        if layout.color {
            for (word, &value) in words(content).zip(&values).skip(color_at).take(color) {
                range.add(word, value);
            }
            if vertex == 0 {
                streams.color_width = color;
            }
        }
        if !streams.add(&values, color) {
            return Err(ReadError::line(line, at_infinity(vertex)));
        }
    }
    Ok(streams.into_draft(range.maximum()))
}

fn at_infinity(vertex: usize) -> String {
    format!("vertex {vertex} lies at infinity: its fourth coordinate is 0")
}

/// Reads the number of corners and the corners of a face. On failure, returns words for the error.
#[inline]
fn read_corners<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    face: usize,
    vertices: usize,
    corners: &mut Vec<u32>,
) -> Result<(), String> {
    let size = words.next().and_then(integer).filter(|&n| n >= 0);
    let size = size.ok_or_else(|| format!("face {face} has no number of corners"))?;
    corners.clear();
    for i in 0..size {
        let word =
            words.next().ok_or_else(|| format!("face {face} has {i} corners where {size} are said"))?;
        let found = integer(word).and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < vertices);
        let fail = || format!("face {face} names vertex {}, but there are {vertices} vertices", quoted(word));
        corners.push(found.ok_or_else(fail)?);
    }
    Ok(())
}

/// Reads words in sequence. Colours have `color` components.
fn read_words(
    mut words: Words,
    [vertices, faces]: [usize; 2],
    mut layout: Layout,
    color: usize,
) -> Result<Draft, ReadError> {
    let width = layout.width(color);
    if layout.color && layout.normal {
        let mut ahead = words.clone();
        let mut vertex = || {
            let mut values = [0.0; MOST];
            for value in &mut values[..width] {
                *value = number(next(&mut ahead)?).unwrap_or(f64::NAN);
            }
            Some((values, width))
        };
        layout.color_first = has_color_first(layout, (0..vertices).map_while(|_| vertex()));
    }
    let file_size = words.rest().len();
    let mut streams = Streams::new(layout);
    streams.color_width = color * usize::from(layout.color);
    let mut range = Range::default();
    let color_at = layout.color_at();
    streams.positions.reserve_exact(vertices);
    for vertex in 0..vertices {
        let mut values = [0.0; MOST];
        for (i, value) in values[..width].iter_mut().enumerate() {
            let word = next(&mut words).ok_or_else(|| {
                ReadError::truncated(format!("{vertices} vertices are declared, {vertex} are there"))
            })?;
            let fail = || format!("{} is not a number", quoted(word));
            *value = number(word).ok_or_else(|| ReadError::line(words.line(), fail()))?;
            if layout.color && (color_at..color_at + color).contains(&i) {
                range.add(word, *value);
            }
        }
        if !streams.add(&values, color) {
            return Err(ReadError::line(words.line(), at_infinity(vertex)));
        }
    }
    let mut draft = streams.into_draft(range.maximum());

    let mut polygons = Polygons::new(file_size);
    for face in 0..faces {
        let mut rest = std::iter::from_fn(|| next(&mut words)).peekable();
        if rest.peek().is_none() {
            return Err(ReadError::truncated(format!("{faces} faces are declared, {face} are there")));
        }
        let found = read_corners(&mut rest, face, vertices, &mut polygons.corners);
        found.map_err(|what| ReadError::line(words.line(), what))?;
        polygons.add(face, &mut draft);
    }
    if let Some(word) = next(&mut words) {
        return Err(ReadError::line(words.line(), format!("{} follows the last face", quoted(word))));
    }
    polygons.note(&mut draft.notes);
    Ok(draft)
}
