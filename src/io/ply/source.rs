//! Values of the body in order, in any encoding.
//!
//! Checks every declared count against the bytes left before anyone reserves memory for it.

use std::cell::OnceCell;

use super::header::{Element, Encoding, Header, Kind, Property};
use crate::io::draft::Tally;
use crate::io::error::{Place, ReadError};
use crate::io::text::{Lines, Words, number, quoted, words};

/// Rows of a text body. Values may be spread over lines in any way. Only if there are as many rows as entries, a row is
/// an entry, and may have more values than its element has properties.
pub(super) struct Rows<'a> {
    body: &'a [u8],
    entries: u64,
    are_entries: OnceCell<bool>,
}

impl<'a> Rows<'a> {
    pub fn new(header: &Header, bytes: &'a [u8]) -> Self {
        let with_values = header.elements.iter().filter(|element| !element.properties.is_empty());
        let entries = with_values.fold(0, |sum: u64, element| sum.saturating_add(element.count));
        Self { body: &bytes[header.body..], entries, are_entries: OnceCell::new() }
    }

    /// Tests if there are as many rows as entries. The first call takes O(n) in the body, further calls O(1).
    fn are_entries(&self) -> bool {
        let count = || {
            let rows = Lines::from_line(self.body, 1).filter(|(_, row)| words(row).next().is_some());
            rows.count() as u64 == self.entries
        };
        *self.are_entries.get_or_init(count)
    }
}

/// A place in the body.
#[derive(Clone)]
pub(super) struct Source<'a> {
    pub encoding: Encoding,
    bytes: &'a [u8],
    at: usize,
    words: Words<'a>,
    rows: &'a Rows<'a>,
    long_rows: Tally,
}

impl<'a> Source<'a> {
    pub fn new(header: &Header, bytes: &'a [u8], rows: &'a Rows<'a>) -> Self {
        let words = Words::new(&bytes[header.body..], header.body_line);
        let long_rows = Tally::default();
        Self { encoding: header.encoding, bytes, at: header.body, words, rows, long_rows }
    }

    /// Ends an entry. In a text with a row for each entry, skips the values that the entry leaves in its row.
    #[inline]
    pub fn end_entry(&mut self) {
        if self.encoding == Encoding::Text && !self.words.at_line_end() {
            self.end_before_row();
        }
    }

    #[cold]
    fn end_before_row(&mut self) {
        if self.rows.are_entries() {
            self.long_rows.add(self.words.line());
            self.words.skip_line();
        }
    }

    /// Adds notes about rows with more values than properties, and about text after the last entry.
    pub fn note(&self, notes: &mut Vec<String>) {
        let what = "rows have more values than properties; these values are left out";
        self.long_rows.note(what, "line", notes);
        let mut rest = self.words.clone();
        if self.encoding == Encoding::Text && rest.next().is_some() {
            notes.push(format!("text after the last entry left out, from line {} on", rest.line()));
        }
    }

    pub fn left(&self) -> usize {
        match self.encoding {
            Encoding::Text => self.words.left(),
            _ => self.bytes.len() - self.at,
        }
    }

    /// Checks that the bytes left can hold the declared number of entries.
    pub fn check(&self, element: &Element) -> Result<(), ReadError> {
        let (least, left) = (element.least_size(self.encoding), self.left());
        // The last word of a text needs no blank after it.
        match element.count.checked_mul(least) {
            Some(needed) if needed <= left as u64 + u64::from(self.encoding == Encoding::Text) => Ok(()),
            _ => {
                let Element { name, count, .. } = element;
                let what =
                    format!("{count} entries of element {name:?} take {least} bytes each, {left} are left");
                Err(ReadError::truncated(what))
            }
        }
    }

    /// Reads `size` bytes of a binary file.
    pub fn take(&mut self, size: usize) -> Result<&'a [u8], ReadError> {
        let left = &self.bytes[self.at..];
        if size > left.len() {
            return Err(ReadError::truncated(format!(
                "{size} bytes are needed at byte {}, {} are left",
                self.at,
                left.len()
            )));
        }
        self.at += size;
        Ok(&left[..size])
    }

    pub fn value(&mut self, kind: Kind) -> Result<f64, ReadError> {
        if self.encoding != Encoding::Text {
            return Ok(kind.value(self.take(kind.size())?, self.encoding));
        }
        match self.words.next() {
            None => Err(ReadError::truncated(format!("a value is missing after line {}", self.words.line()))),
            Some(word) => number(word).ok_or_else(|| self.fail(format!("{} is not a number", quoted(word)))),
        }
    }

    /// Reads the length of a list. Checks it against the bytes left, at least 1 byte an entry.
    pub fn list(&mut self, count: Kind, kind: Kind) -> Result<usize, ReadError> {
        let count = self.value(count)?;
        let least = if self.encoding == Encoding::Text { 1 } else { kind.size() };
        if !(count >= 0.0 && count.fract() == 0.0) {
            return Err(self.fail(format!("{count} is no length of a list")));
        }
        if count * least as f64 > self.left() as f64 {
            let (place, left) = (self.place(), self.left());
            return Err(ReadError::truncated(format!(
                "a list of {count} values at {place}, {left} bytes are left"
            )));
        }
        Ok(count as usize)
    }

    pub fn skip_property(&mut self, property: &Property) -> Result<(), ReadError> {
        let count = match property.count {
            Some(count) => self.list(count, property.kind)?,
            None => 1,
        };
        if self.encoding == Encoding::Text {
            (0..count).try_for_each(|_| self.value(property.kind).map(|_| ()))
        } else {
            self.take(count * property.kind.size()).map(|_| ())
        }
    }

    pub fn skip(&mut self, element: &Element) -> Result<(), ReadError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        if self.encoding != Encoding::Text && element.is_flat() {
            let size = (element.count * element.least_size(self.encoding)) as usize;
            return self.take(size).map(|_| ());
        }
        for _ in 0..element.count {
            element.properties.iter().try_for_each(|p| self.skip_property(p))?;
            self.end_entry();
        }
        Ok(())
    }

    fn place(&self) -> Place {
        match self.encoding {
            Encoding::Text => Place::Line(self.words.line()),
            _ => Place::Byte(self.at),
        }
    }

    pub fn fail(&self, what: impl Into<String>) -> ReadError {
        ReadError::Syntax { place: self.place(), what: what.into() }
    }
}
