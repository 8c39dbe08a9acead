//! OFF, the object file format of Geomview: text or binary, with vertex normals, colours and texture coordinates.
//!
//! The first word is `[ST][C][N]OFF` and may be missing. Each vertex has `x y z [nx ny nz] [r g b [a]] [s t]`. Colours
//! are divided by 255 if all components are integers. Colours of faces are skipped. 4OFF and nOFF (other dimensions)
//! are rejected. Comments start with `#`. Binary files (`OFF BINARY`) are big-endian.
//!
//! Written as text, read back to equal bits: `normal`, `color` and `uv` with the vertices; no other attributes, no
//! materials.
//!
//! The parser is our own: `off-rs` reads neither binary files nor normals and texture coordinates.

use super::draft::Draft;
use super::error::ReadError;
use super::polygon::Polygons;
use super::text::{Lines, integer, number, push_float, push_position, quoted, words};
use crate::mesh::{Attribute, AttributeValues, Mesh, names};

/// Data of each vertex, as declared by the first word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Layout {
    uv: bool,
    color: bool,
    normal: bool,
}

impl Layout {
    /// Parses `[ST][C][N]OFF`; `None` for any other word.
    fn named(word: &[u8]) -> Option<Result<Self, ReadError>> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut layout = Self::default();
        for (prefix, flag) in
            [(&b"ST"[..], &mut layout.uv), (b"C", &mut layout.color), (b"N", &mut layout.normal)]
        {
            if let Some(after) = rest.strip_prefix(prefix) {
                (*flag, rest) = (true, after);
            }
        }
        Some(match rest {
            [] => Ok(layout),
            _ => Err(ReadError::unsupported(format!("OFF files of the kind {}", quoted(word)))),
        })
    }
}

/// Attribute values of the vertices, flat.
#[derive(Default)]
struct Streams {
    normals: Vec<f32>,
    colors: Vec<f32>,
    color_width: usize,
    uvs: Vec<f32>,
}

impl Streams {
    fn attributes(self, layout: Layout) -> impl Iterator<Item = Attribute> {
        let of = |given: bool, name, width, values| {
            (given && width > 0).then(|| Attribute::new(name, width, AttributeValues::Float(values)))
        };
        [
            of(layout.normal, names::NORMAL, 3, self.normals),
            of(layout.color, names::COLOR, self.color_width, self.colors),
            of(layout.uv, names::UV, 2, self.uvs),
        ]
        .into_iter()
        .flatten()
    }
}

/// Reads a whole file. O(n) in its size; counts are checked against the bytes present.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut lines = Lines::new(bytes);
    let mut header: Vec<&[u8]> = Vec::new();
    let (mut layout, mut counts, mut line_number) = (Layout::default(), [0_i64; 3], 0);
    let mut named = false;
    // The three counts may share a line with the first word.
    while header.len() < 2 {
        let Some((line, content)) = lines.next() else {
            return Err(ReadError::truncated("the OFF header has no counts"));
        };
        line_number = line;
        for word in words(without_hash(content)) {
            if header.is_empty() && !named {
                named = true;
                if let Some(found) = Layout::named(word) {
                    layout = found?;
                    continue;
                }
            } else if header.is_empty() && word == b"BINARY" {
                return read_binary(bytes, bytes.len() - lines.left(), layout);
            }
            header.push(word);
        }
    }
    for (count, word) in counts.iter_mut().zip(&header) {
        *count = integer(word).filter(|&n| n >= 0).ok_or_else(|| {
            ReadError::line(line_number, format!("{} is no count of vertices, faces or edges", quoted(word)))
        })?;
    }
    let [vertices, faces, _] = counts;
    // A vertex takes at least 6 bytes ("0 0 0\n"), a face 2.
    let needed = vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2));
    if needed > lines.left() as i64 + 1 {
        let left = lines.left();
        return Err(ReadError::truncated(format!("{vertices} vertices and {faces} faces in {left} bytes")));
    }
    read_text(lines, vertices as usize, faces as usize, layout, bytes.len())
}

/// Returns a line up to any `#`.
fn without_hash(line: &[u8]) -> &[u8] {
    line.split(|&b| b == b'#').next().unwrap_or_default()
}

fn read_text(
    lines: Lines,
    vertices: usize,
    faces: usize,
    layout: Layout,
    file_size: usize,
) -> Result<Draft, ReadError> {
    let mut lines = lines
        .map(|(number, line)| (number, without_hash(line)))
        .filter(|(_, line)| words(line).next().is_some());
    let mut draft = Draft::default();
    let mut streams = Streams::default();
    let mut whole_colors = true;
    draft.positions.reserve_exact(vertices);
    for vertex in 0..vertices {
        let (line, content) = lines.next().ok_or_else(|| {
            ReadError::truncated(format!("{vertices} vertices are declared, {vertex} are there"))
        })?;
        let mut values = [0.0; 12];
        let mut count = 0_usize;
        let start = 3 + 3 * usize::from(layout.normal);
        for (i, word) in words(content).take(12).enumerate() {
            let fail = || ReadError::line(line, format!("{} is not a number", quoted(word)));
            values[i] = number(word).ok_or_else(fail)?;
            // Integers are divided by 255 only if all are integers: "1 0.5 0" has integers too.
            let in_color = layout.color && i >= start && i < start + 4;
            whole_colors &= !in_color || integer(word).is_some();
            count += 1;
        }
        let uv = 2 * usize::from(layout.uv);
        let color = if layout.color { count.saturating_sub(start + uv).min(4) } else { 0 };
        if count < start + uv || (layout.color && color < 3) {
            return Err(ReadError::line(line, format!("vertex {vertex} has {count} numbers, too few")));
        }
        draft.positions.push([values[0], values[1], values[2]]);
        streams.normals.extend(values[3..start].iter().map(|&x| x as f32));
        if layout.color {
            if vertex == 0 {
                streams.color_width = color;
            }
            let given = (0..streams.color_width).map(|i| if i < color { values[start + i] } else { 1.0 });
            streams.colors.extend(given.map(|x| x as f32));
        }
        streams.uvs.extend(values[start + color..start + color + uv].iter().map(|&x| x as f32));
    }
    if whole_colors {
        streams.colors.iter_mut().for_each(|x| *x = (f64::from(*x) / 255.0) as f32);
    }
    draft.attributes.extend(streams.attributes(layout));

    let mut polygons = Polygons::new(file_size);
    for face in 0..faces {
        let (line, content) = lines
            .next()
            .ok_or_else(|| ReadError::truncated(format!("{faces} faces are declared, {face} are there")))?;
        let mut rest = words(content);
        let size = rest.next().and_then(integer).filter(|&n| n >= 0);
        let size =
            size.ok_or_else(|| ReadError::line(line, format!("face {face} has no number of corners")))?;
        polygons.corners.clear();
        for i in 0..size {
            let word = rest.next().ok_or_else(|| {
                ReadError::line(line, format!("face {face} has {i} corners where {size} are said"))
            })?;
            let found =
                integer(word).and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < vertices);
            let fail =
                || format!("face {face} names vertex {}, but there are {vertices} vertices", quoted(word));
            polygons.corners.push(found.ok_or_else(|| ReadError::line(line, fail()))?);
        }
        polygons.add(face, &mut draft);
    }
    polygons.note(&mut draft.notes);
    Ok(draft)
}

/// Big-endian words of a binary file.
struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Binary<'_> {
    fn word(&mut self) -> Result<[u8; 4], ReadError> {
        let word = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<4>());
        self.at += 4;
        word.copied()
            .ok_or_else(|| ReadError::truncated(format!("4 bytes are needed at byte {}", self.at - 4)))
    }

    fn float(&mut self) -> Result<f32, ReadError> {
        Ok(f32::from_be_bytes(self.word()?))
    }

    /// Reads a count of items of at least `least` bytes each.
    fn count(&mut self, least: usize, what: &str) -> Result<usize, ReadError> {
        let count = i32::from_be_bytes(self.word()?);
        let left = self.bytes.len().saturating_sub(self.at);
        match usize::try_from(count) {
            Ok(count) if count.saturating_mul(least) <= left => Ok(count),
            Ok(count) => Err(ReadError::truncated(format!("{count} {what}, {left} bytes are left"))),
            Err(_) => Err(ReadError::byte(self.at - 4, format!("{count} is no count of {what}"))),
        }
    }
}

fn read_binary(bytes: &[u8], at: usize, layout: Layout) -> Result<Draft, ReadError> {
    let mut source = Binary { bytes, at };
    let color_width = 4 * usize::from(layout.color);
    let width = 3 + 3 * usize::from(layout.normal) + color_width + 2 * usize::from(layout.uv);
    let vertices = source.count(4 * width, "vertices")?;
    let faces = source.count(8, "faces")?;
    source.word()?;
    let mut draft = Draft::default();
    let mut streams = Streams { color_width, ..Streams::default() };
    for _ in 0..vertices {
        let mut position = [0.0; 3];
        for x in &mut position {
            *x = f64::from(source.float()?);
        }
        draft.positions.push(position);
        for (given, count, values) in [
            (layout.normal, 3, &mut streams.normals),
            (layout.color, color_width, &mut streams.colors),
            (layout.uv, 2, &mut streams.uvs),
        ] {
            for _ in 0..if given { count } else { 0 } {
                values.push(source.float()?);
            }
        }
    }
    draft.attributes.extend(streams.attributes(layout));
    let mut polygons = Polygons::new(bytes.len());
    for face in 0..faces {
        polygons.corners.clear();
        for _ in 0..source.count(4, "corners")? {
            let at = source.at;
            let index = u32::from_be_bytes(source.word()?);
            if index as usize >= vertices {
                let what =
                    format!("face {face} names vertex {}, but there are {vertices} vertices", index as i32);
                return Err(ReadError::byte(at, what));
            }
            polygons.corners.push(index);
        }
        for _ in 0..source.count(4, "colour components")? {
            source.word()?;
        }
        polygons.add(face, &mut draft);
    }
    polygons.note(&mut draft.notes);
    Ok(draft)
}

/// Encodes a mesh as text.
pub(super) fn write(mesh: &Mesh) -> Vec<u8> {
    let floats = |name, widths: &[usize]| {
        let attribute = mesh.attribute(name).filter(|a| widths.contains(&a.width()))?;
        Some((attribute.as_floats()?, attribute.width()))
    };
    let (uv, color, normal) =
        (floats(names::UV, &[2]), floats(names::COLOR, &[3, 4]), floats(names::NORMAL, &[3]));
    let prefix = |given: bool, name: &'static str| if given { name } else { "" };
    let (uv_prefix, color_prefix, normal_prefix) =
        (prefix(uv.is_some(), "ST"), prefix(color.is_some(), "C"), prefix(normal.is_some(), "N"));
    let counts = format!("{} {} 0\n", mesh.positions().len(), mesh.triangles().len());
    let mut out = format!("{uv_prefix}{color_prefix}{normal_prefix}OFF\n{counts}").into_bytes();
    for (v, position) in mesh.positions().iter().enumerate() {
        push_position(*position, mesh.origin(), &mut out);
        let mut put = |values: &[f32]| {
            for &x in values {
                out.push(b' ');
                push_float(x, &mut out);
            }
        };
        for (values, width) in [normal, color, uv].into_iter().flatten() {
            put(&values[v * width..(v + 1) * width]);
        }
        out.push(b'\n');
    }
    for [a, b, c] in mesh.triangles() {
        out.extend_from_slice(format!("3 {a} {b} {c}\n").as_bytes());
    }
    out
}
