//! A text file to a draft: words across line ends; the words between a facet's keyword and its vertices are skipped.

use crate::io::draft::{Draft, Tally};
use crate::io::error::ReadError;
use crate::io::polygon::Triangulator;
use crate::io::text::{Words, number, quoted, words};

/// Reads a whole file.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut draft = Draft { weld: true, ..Draft::default() };
    let mut triangulator = Triangulator::new(bytes.len());
    let mut words = Words::new(bytes, 1);
    let mut facet: Vec<[f64; 3]> = Vec::new();
    let mut commas = Tally::default();
    let mut open = false;
    while let Some(word) = words.next() {
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
        if is("vertex") {
            facet.push(vertex(&mut words, &mut commas)?);
        } else if is("solid") || is("endsolid") || (is("end") && !open) {
            words.skip_line();
        } else if is("facet") {
            open = true;
        } else if is("endfacet") || (is("end") && skip_word(&mut words, "facet")) {
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
    let is_name = || Words::new(bytes, 1).any(|word| word.eq_ignore_ascii_case(b"endfacet"));
    if draft.triangles.is_empty() && is_name() {
        return Err(ReadError::line(1, "facets stand in the line of a solid's name"));
    }
    commas.note("vertices have decimal commas, or commas between numbers", "line", &mut draft.notes);
    triangulator.note(&mut draft.notes);
    Ok(draft)
}

/// Skips the next word if it is `keyword`. Returns whether it is.
fn skip_word(words: &mut Words, keyword: &str) -> bool {
    let mut ahead = words.clone();
    let is_next = ahead.next().is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()));
    if is_next {
        *words = ahead;
    }
    is_next
}

fn vertex(words: &mut Words, commas: &mut Tally) -> Result<[f64; 3], ReadError> {
    let start = words.clone();
    let mut position = [0.0; 3];
    for x in &mut position {
        let word = words.next().ok_or_else(|| ReadError::truncated("the file ends in a vertex"))?;
        match number(word) {
            Some(value) => *x = value,
            None => {
                let found = word.contains(&b',').then(|| with_commas(start.line_left())).flatten();
                let fail = || ReadError::line(words.line(), format!("{} is not a number", quoted(word)));
                let found = found.ok_or_else(fail)?;
                *words = start;
                words.skip_line();
                commas.add(words.line());
                return Ok(found);
            }
        }
    }
    Ok(position)
}

/// Parses three numbers in the rest of a line, with decimal commas or with commas between them.
fn with_commas(line: &[u8]) -> Option<[f64; 3]> {
    let three = |line: &[u8]| {
        let mut values = words(line).map(number);
        let found = [values.next()??, values.next()??, values.next()??];
        values.next().is_none().then_some(found)
    };
    let replaced = |by: u8| line.iter().map(|&b| if b == b',' { by } else { b }).collect::<Vec<u8>>();
    // Both give three numbers for "1, 2, 3": a comma before a blank separates.
    three(&replaced(b' ')).or_else(|| three(&replaced(b'.')))
}
