//! Lexing of text formats: lines, words and numbers from bytes that need not be UTF-8.
//!
//! All tokens borrow from the file; lexing does not allocate.

/// Lines of a file with their numbers from 1; LF, CRLF and CR each end a line.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Lines<'a> {
    /// Starts at the first line, skipping a byte-order mark.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: without_mark(bytes), line: 0 }
    }

    /// Starts in line `line`, of which `bytes` holds the end.
    pub fn from_line(bytes: &'a [u8], line: usize) -> Self {
        Self { rest: bytes, line: line - 1 }
    }

    /// Returns the number of bytes after the last line returned.
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

/// Returns the bytes after a UTF-8 byte-order mark, if present.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Returns the words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|b| is_blank(*b)).filter(|word| !word.is_empty())
}

/// Tests for white space as in C, including vertical tab.
pub(super) fn is_blank(byte: u8) -> bool {
    byte == b' ' || (b'\t'..=b'\r').contains(&byte)
}

/// Returns a line up to its comment: `#` at the start or after a blank. Names may contain `#`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let starts = |&i: &usize| line[i] == b'#' && (i == 0 || is_blank(line[i - 1]));
    (0..line.len()).find(starts).map_or(line, |end| &line[..end])
}

/// Words of a whole file, across line ends, with line numbers.
#[derive(Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Words<'a> {
    /// Starts at the first word; `line` is the number of the first line in `bytes`.
    pub fn new(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line }
    }

    /// Returns the line of the last word returned.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Tests if the rest of the line is blank, and skips it up to the line end.
    #[inline]
    pub fn at_line_end(&mut self) -> bool {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'\n' || byte == b'\r' {
                return true;
            }
            if !is_blank(byte) {
                return false;
            }
            self.at += 1;
        }
        true
    }

    /// Returns the rest of the line.
    pub fn line_left(&self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        &rest[..end]
    }

    /// Returns the bytes not yet read.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Skips the rest of the line.
    pub fn skip_line(&mut self) {
        while self.bytes.get(self.at).is_some_and(|&b| b != b'\n' && b != b'\r') {
            self.at += 1;
        }
    }

    /// Returns the number of bytes not yet read.
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

/// Parses a decimal number. `nan` and `inf` are accepted here, also as spelled by the C library of Microsoft; the caller
/// rejects them where needed.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let float = || std::str::from_utf8(word).ok()?.parse().ok();
    digits(word).map(|value| value as f64).or_else(float).or_else(|| special(word))
}

/// Parses 1 to 15 digits: exact as a float too, and faster than the parser of floats. Lists of indices are made of such
/// words.
#[inline]
fn digits(word: &[u8]) -> Option<u64> {
    if word.is_empty() || word.len() > 15 {
        return None;
    }
    let mut value = 0;
    for &byte in word {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = 10 * value + u64::from(digit);
    }
    Some(value)
}

/// Parses `1.#IND`, `1.#QNAN`, `1.#SNAN`, `1.#INF` (digits may follow) and `nan(ind)`, with or without a sign.
#[cold]
fn special(word: &[u8]) -> Option<f64> {
    let (sign, word) = match word {
        [b'-', rest @ ..] => (-1.0, rest),
        [b'+', rest @ ..] => (1.0, rest),
        _ => (1.0, word),
    };
    let is_nan = |name: &&[u8]| word.starts_with(name);
    if [&b"1.#IND"[..], b"1.#QNAN", b"1.#SNAN"].iter().any(is_nan) {
        return Some(f64::NAN);
    }
    if word.starts_with(b"1.#INF") {
        return Some(sign * f64::INFINITY);
    }
    let (name, rest) = word.split_at_checked(4)?;
    (name.eq_ignore_ascii_case(b"nan(") && rest.ends_with(b")")).then_some(f64::NAN)
}

/// Parses an integer of 64 bits.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    digits(word).map(|value| value as i64).or_else(|| std::str::from_utf8(word).ok()?.parse().ok())
}

/// Formats a word for a single-line message: short and printable.
pub(super) fn quoted(word: &[u8]) -> String {
    let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
    format!("{shown:?}{}", if word.len() > 40 { "..." } else { "" })
}

/// Appends a position, numbers separated by blanks. Without an origin, formats like [`push_float`]. With an origin,
/// appends the shortest decimal form that reads back to the sum in double precision.
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

/// Appends the shortest decimal form of `x` that reads back to equal bits, also by way of double precision.
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
