//! The lexical side of text formats: lines, words and numbers out of bytes that need not be UTF-8.
//!
//! Everything borrows from the file; nothing allocates.

/// The lines of a file with their numbers from 1; LF, CRLF and CR all end a line.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line, after a byte-order mark if there is one.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: without_mark(bytes), line: 0 }
    }

    /// Bytes after the line that came last.
    pub fn left(&self) -> usize {
        self.rest.len()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        self.line += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.rest = &rest[ending..];
        Some((self.line, line))
    }
}

/// The bytes after a UTF-8 byte-order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| is_blank(*b)).filter(|word| !word.is_empty())
}

/// Spaces as C has them: vertical tab too.
pub(super) fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// A line up to its comment: `#` at the start or after a blank, so that names may hold one.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let starts = |&i: &usize| line[i] == b'#' && (i == 0 || is_blank(line[i - 1]));
    (0..line.len()).find(starts).map_or(line, |end| &line[..end])
}

/// The words of a whole file, across line ends, with the line each stands on.
#[derive(Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Words<'a> {
    /// `line` is the number of the first line in `bytes`.
    pub fn new(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line }
    }

    /// Line of the word that came last.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Leaves out the rest of the line.
    pub fn skip_line(&mut self) {
        while self.bytes.get(self.at).is_some_and(|&b| b != b'\n' && b != b'\r') {
            self.at += 1;
        }
    }

    /// Bytes not yet read.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        while let Some(&byte) = self.bytes.get(self.at) {
            if !is_blank(byte) {
                break;
            }
            let crlf = byte == b'\r' && self.bytes.get(self.at + 1) == Some(&b'\n');
            self.line += usize::from((byte == b'\n' || byte == b'\r') && !crlf);
            self.at += 1;
        }
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|&b| !is_blank(b)) {
            self.at += 1;
        }
        (start < self.at).then(|| &self.bytes[start..self.at])
    }
}

/// A decimal number; `nan` and `inf` are numbers here, to be refused by what they stand for.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A whole number that fits 64 bits.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as it may stand in a one-line message: short and printable.
pub(super) fn quoted(word: &[u8]) -> String {
    let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
    format!("{shown:?}{}", if word.len() > 40 { "..." } else { "" })
}

/// Appends a position, numbers apart: as [`push_float`] does, or moved by an origin, then as the shortest decimal form that
/// reads back to the same sum in double precision.
pub(super) fn push_position(position: [f32; 3], origin: [f64; 3], out: &mut Vec<u8>) {
    use std::io::Write;
    for axis in 0..3 {
        if axis > 0 {
            out.push(b' ');
        }
        if origin == [0.0; 3] {
            push_float(position[axis], out);
        } else {
            // Writing to a Vec cannot fail.
            let _ = write!(out, "{:?}", f64::from(position[axis]) + origin[axis]);
        }
    }
}

/// Appends the shortest decimal form of `x` that reads back to the same bits, also by way of double precision.
pub(super) fn push_float(x: f32, out: &mut Vec<u8>) {
    use std::io::Write;
    let start = out.len();
    // Writing to a Vec cannot fail.
    let _ = write!(out, "{x:?}");
    if number(&out[start..]).is_none_or(|back| back as f32 != x) {
        out.truncate(start);
        let _ = write!(out, "{:?}", f64::from(x));
    }
}
