//! A binary file to a draft.
//!
//! ```text
//!     80 bytes   header of any content
//!      4 bytes   count of triangles, little-endian
//!     50 bytes   a triangle: normal, three corners, two bytes without a defined meaning
//! ```

use crate::io::draft::Draft;
use crate::io::error::ReadError;

/// Bytes before the first triangle.
const START: usize = 84;
/// Bytes of a triangle.
pub(super) const FACET: usize = 50;
/// Counts by programs that did not go back to write the count when they were done.
const UNKNOWN: [u32; 2] = [0, u32::MAX];

/// How a file's count fits its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fit {
    /// The triangles end with the file.
    Exact,
    /// The file has bytes after its triangles, or its count is unknown and there are triangles.
    Some,
    /// The file lacks triangles, or is too short for a count.
    None,
}

/// Returns the count as declared; `None` if the file is too short.
fn declared(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..START).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

/// Returns the count that the size gives; `None` unless the declared count is unknown and there are triangles. Zero is
/// a count of its own, unless whole triangles fill the file.
fn derived(bytes: &[u8], declared: u32) -> Option<usize> {
    let body = bytes.len() - START;
    let is_unknown =
        UNKNOWN.contains(&declared) && body >= FACET && (declared > 0 || body.is_multiple_of(FACET));
    is_unknown.then_some(body / FACET)
}

/// Compares a file's count with its size.
pub(super) fn fit(bytes: &[u8]) -> Fit {
    let Some(count) = declared(bytes) else { return Fit::None };
    let size = (count as usize).checked_mul(FACET).and_then(|size| size.checked_add(START));
    match size {
        Some(size) if size == bytes.len() => Fit::Exact,
        Some(size) if size < bytes.len() => Fit::Some,
        _ if derived(bytes, count).is_some() => Fit::Some,
        _ => Fit::None,
    }
}

/// Reads a whole file.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let declared = declared(bytes).ok_or_else(|| {
        ReadError::truncated(format!(
            "a binary STL file has {START} bytes before its triangles, here are {}",
            bytes.len()
        ))
    })?;
    let mut draft = Draft { weld: true, ..Draft::default() };
    let body = &bytes[START..];
    let count = match derived(bytes, declared) {
        Some(count) => {
            draft.notes.push(format!("the file declares {declared} triangles; its size gives {count}"));
            count
        }
        None => declared as usize,
    };
    let there = body.len() / FACET;
    if there < count {
        return Err(ReadError::truncated(format!("{count} triangles are declared, {there} are there")));
    }
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
