//! The first word and the counts.
//!
//! ```text
//!     [OFF] [BINARY]                      the word may be missing, or glued to the count of vertices
//!     [dimension] vertices faces [edges]  on the line of the word or on lines of their own
//! ```

use super::layout::Layout;
use super::text::{ends_line, next};
use crate::io::error::ReadError;
use crate::io::text::{Words, integer, quoted};

/// A header, and the bytes after it.
pub(super) struct Header<'a> {
    pub layout: Layout,
    pub body: Body<'a>,
}

/// The bytes after a header.
pub(super) enum Body<'a> {
    /// Offset of counts and values of 4 bytes each.
    Binary(usize),
    /// Text from the end of the counts on, the number of its first line, and the counts of vertices and faces.
    Text { rest: &'a [u8], line: usize, counts: [usize; 2] },
}

/// Reads the header. Checks the counts against the bytes present.
pub(super) fn read(bytes: &[u8]) -> Result<Header<'_>, ReadError> {
    let mut words = Words::new(bytes, 1);
    let none = || ReadError::truncated("the OFF header has no counts");
    let first = next(&mut words).ok_or_else(none)?;
    let (mut layout, glued) = match Layout::named(first) {
        Some(found) => found?,
        None => (Layout::default(), first),
    };
    let mut pending = Some(glued).filter(|word| !word.is_empty());
    if pending.is_none() {
        let word = next(&mut words).ok_or_else(none)?;
        if word.eq_ignore_ascii_case(b"BINARY") {
            if layout.dimension {
                return Err(ReadError::unsupported("binary OFF files of a declared dimension (nOFF)"));
            }
            words.skip_line();
            let rest = words.rest();
            let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
            return Ok(Header { layout, body: Body::Binary(bytes.len() - rest.len() + ending) });
        }
        pending = Some(word);
    }
    let mut count = |words: &mut Words<'_>| {
        let word = pending.take().or_else(|| next(words)).ok_or_else(none)?;
        let what = || format!("{} is no count of vertices, faces or edges", quoted(word));
        let count = integer(word).and_then(|n| usize::try_from(n).ok());
        count.ok_or_else(|| ReadError::line(words.line(), what()))
    };
    if layout.dimension {
        let dimension = count(&mut words)?;
        if dimension != 3 {
            return Err(ReadError::unsupported(format!("OFF files of dimension {dimension}")));
        }
        layout.dimension = false;
    }
    let counts = [count(&mut words)?, count(&mut words)?];
    if ends_line(&mut words) {
        // A line with a single word is no vertex: it is the count of edges.
        let mut ahead = words.clone();
        if counts[0] > 0 && next(&mut ahead).is_some_and(is_count) && ends_line(&mut ahead) {
            words = ahead;
        }
    } else {
        count(&mut words)?;
    }

    let [vertices, faces] = counts;
    // A vertex takes at least 6 bytes ("0 0 0\n"), a face 2.
    let needed = vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2));
    let (rest, line) = (words.rest(), words.line());
    if needed > rest.len() + 1 {
        let left = rest.len();
        return Err(ReadError::truncated(format!("{vertices} vertices and {faces} faces in {left} bytes")));
    }
    Ok(Header { layout, body: Body::Text { rest, line, counts } })
}

fn is_count(word: &[u8]) -> bool {
    integer(word).is_some_and(|n| n >= 0)
}
