//! STL: triangles without indices, binary or text.
//!
//! Vertices at exactly equal positions (after rounding to single precision, with -0 equal to 0) are welded, numbered by
//! first appearance. Face normals, attribute bytes and solids' names are not kept. A file is binary if its size matches
//! its count, for any start of its header. Otherwise it is text if it starts with `solid` and contains `facet` or
//! `endsolid`, else binary.
//!
//! The parser is our own: `stl_io` reads only the first solid of a text, in single precision, and rejects unnamed
//! solids, normals of NaN and facets of more than three corners (`docs/architecture.md`, Readers).

use super::draft::Draft;
use super::error::{ReadError, WriteError};
use super::polygon::Triangulator;
use super::text::{Words, number, push_position, quoted, without_mark};
use crate::mesh::Mesh;

/// Bytes before the first triangle of a binary file: a free-form header and the count.
const START: usize = 84;
/// Bytes of a triangle: normal, three corners, and two bytes without a defined meaning.
const FACET: usize = 50;

/// Reads a whole file. O(n) in its size.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let declared = bytes.get(80..START).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let size = declared.and_then(|count| count.checked_mul(FACET)?.checked_add(START));
    if size == Some(bytes.len()) || !is_text(bytes) {
        read_binary(bytes, declared.unwrap_or(0))
    } else {
        read_text(bytes)
    }
}

/// Tests if the bytes start with `solid` and contain the keyword `facet` or `endsolid`.
fn is_text(bytes: &[u8]) -> bool {
    let starts = |word: &[u8]| word.eq_ignore_ascii_case(b"solid");
    let speaks = |word: &[u8]| word.eq_ignore_ascii_case(b"facet") || word.eq_ignore_ascii_case(b"endsolid");
    let mut words = Words::new(without_mark(bytes), 1);
    words.next().is_some_and(starts) && words.any(speaks)
}

fn read_binary(bytes: &[u8], count: usize) -> Result<Draft, ReadError> {
    let body = bytes.get(START..).ok_or_else(|| {
        ReadError::truncated(format!(
            "a binary STL file has {START} bytes before its triangles, here are {}",
            bytes.len()
        ))
    })?;
    let there = body.len() / FACET;
    if there < count {
        return Err(ReadError::truncated(format!("{count} triangles are declared, {there} are there")));
    }
    let mut draft = Draft { weld: true, ..Draft::default() };
    draft.positions.reserve_exact(3 * count);
    let (corners, rest) = (body[..count * FACET].chunks_exact(FACET), body.len() - count * FACET);
    for corner in corners.flat_map(|facet| facet[12..48].chunks_exact(12)) {
        let axis = |i: usize| {
            f64::from(f32::from_le_bytes([corner[i], corner[i + 1], corner[i + 2], corner[i + 3]]))
        };
        draft.positions.push([axis(0), axis(4), axis(8)]);
    }
    draft.triangles = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    if rest > 0 {
        draft.notes.push(format!("{rest} bytes after the last triangle left out"));
    }
    Ok(draft)
}

fn read_text(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut draft = Draft { weld: true, ..Draft::default() };
    let mut triangulator = Triangulator::new(bytes.len());
    let mut words = Words::new(without_mark(bytes), 1);
    let mut facet: Vec<[f64; 3]> = Vec::new();
    let mut open = false;
    while let Some(word) = words.next() {
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
        if is("solid") || is("endsolid") {
            words.skip_line();
        } else if is("vertex") {
            let mut position = [0.0; 3];
            for x in &mut position {
                let word = words.next().ok_or_else(|| ReadError::truncated("the file ends in a vertex"))?;
                let fail = || ReadError::line(words.line(), format!("{} is not a number", quoted(word)));
                *x = number(word).ok_or_else(fail)?;
            }
            facet.push(position);
        } else if is("facet") {
            open = true;
        } else if is("endfacet") {
            open = false;
            if facet.len() < 3 {
                return Err(ReadError::line(words.line(), format!("a facet has {} vertices", facet.len())));
            }
            let first = draft.positions.len() as u32;
            triangulator.split(&facet, |t| draft.triangles.push(t.map(|i| first + i)));
            draft.positions.append(&mut facet);
        } else if !open {
            return Err(ReadError::line(words.line(), format!("{} is no STL keyword", quoted(word))));
        }
    }
    if open {
        return Err(ReadError::truncated(format!(
            "the facet at the end, line {}, is not finished",
            words.line()
        )));
    }
    triangulator.note(&mut draft.notes);
    Ok(draft)
}

/// Encodes a mesh as binary, or as text if its origin is not zero. Writes positions and triangles only. Normals are
/// computed; zero without an area.
pub(super) fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    if mesh.origin() != [0.0; 3] {
        return Ok(write_text(mesh));
    }
    let count = u32::try_from(mesh.triangles().len()).map_err(|_| WriteError::Unsupported {
        format: "STL",
        what: format!("{} triangles", mesh.triangles().len()),
    })?;
    let mut out = vec![0; 80];
    out.reserve(4 + FACET * mesh.triangles().len());
    out.extend_from_slice(&count.to_le_bytes());
    for triangle in mesh.triangles() {
        let corners = triangle.map(|v| mesh.positions()[v as usize]);
        for value in std::iter::once(&normal(corners)).chain(&corners).flatten() {
            out.extend_from_slice(&value.to_le_bytes());
        }
        out.extend_from_slice(&[0; 2]);
    }
    Ok(out)
}

/// Encodes a mesh as text: holds positions with an origin, too large for the single precision of the binary form.
fn write_text(mesh: &Mesh) -> Vec<u8> {
    let mut out = b"solid multires\n".to_vec();
    for triangle in mesh.triangles() {
        let corners = triangle.map(|v| mesh.positions()[v as usize]);
        out.extend_from_slice(b"facet normal ");
        push_position(normal(corners), [0.0; 3], &mut out);
        out.extend_from_slice(b"\nouter loop\n");
        for corner in corners {
            out.extend_from_slice(b"vertex ");
            push_position(corner, mesh.origin(), &mut out);
            out.push(b'\n');
        }
        out.extend_from_slice(b"endloop\nendfacet\n");
    }
    out.extend_from_slice(b"endsolid multires\n");
    out
}

fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| glam::DVec3::from_array(p.map(f64::from)));
    (b - a).cross(c - a).normalize_or_zero().to_array().map(|x| x as f32)
}
