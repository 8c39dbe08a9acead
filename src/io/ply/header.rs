//! The header of a PLY file: its encoding, and its elements with their typed properties.
//!
//! Counts are as declared; `body.rs` checks them against the bytes present.

use crate::io::error::ReadError;
use crate::io::text::{Lines, integer, quoted, words};

/// Keyword of header comments holding material names.
pub(super) const MATERIAL_COMMENT: &str = "material_name";

/// Encoding of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Little,
    Big,
}

/// Type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Returns the size in a binary file, bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    pub fn is_signed(self) -> bool {
        matches!(self, Self::I8 | Self::I16 | Self::I32)
    }

    /// Returns the largest value of an integer type, meaning 1 for colours; `None` for floats.
    pub fn maximum(self) -> Option<f64> {
        Some(match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => return None,
        })
    }

    /// Returns the first value in `bytes`; `bytes` holds at least [`size`](Self::size) bytes. Exact: every type fits a
    /// double.
    pub fn value(self, bytes: &[u8], encoding: Encoding) -> f64 {
        let mut word = [0; 8];
        let size = self.size();
        word[..size].copy_from_slice(&bytes[..size]);
        if encoding == Encoding::Big {
            word[..size].reverse();
        }
        let low = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
        match self {
            Self::I8 => f64::from(low as i8),
            Self::U8 => f64::from(low as u8),
            Self::I16 => f64::from(low as i16),
            Self::U16 => f64::from(low as u16),
            Self::I32 => f64::from(low as i32),
            Self::U32 => f64::from(low),
            Self::F32 => f64::from(f32::from_bits(low)),
            Self::F64 => f64::from_le_bytes(word),
        }
    }
}

/// A property: a single value, or a list with its own count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
    /// Type of the list's count; `None` if the property is not a list.
    pub count: Option<Kind>,
}

/// An element: `count` entries with these properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// Returns the minimum size of an entry, bytes.
    pub fn least_size(&self, encoding: Encoding) -> u64 {
        let of = |p: &Property| match encoding {
            Encoding::Text => 2,
            _ => p.count.unwrap_or(p.kind).size() as u64,
        };
        self.properties.iter().map(of).sum()
    }

    /// Tests if all entries have equal size: no property is a list.
    pub fn is_flat(&self) -> bool {
        self.properties.iter().all(|p| p.count.is_none())
    }
}

/// A PLY header.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    pub material_names: Vec<String>,
    /// Offset of the body, and its line number.
    pub body: usize,
    pub body_line: usize,
}

/// Reads the header, including `end_header`.
pub(super) fn read(bytes: &[u8]) -> Result<Header, ReadError> {
    let mut lines = Lines::new(bytes);
    // Where lines end in a lone CR, LF is the first byte of the body.
    let first_end = bytes.iter().position(|&b| b == b'\r' || b == b'\n').unwrap_or(bytes.len());
    let lone_cr = bytes[first_end..].starts_with(b"\r") && !bytes[first_end..].starts_with(b"\r\n");
    if lines.next().is_none_or(|(_, line)| line.trim_ascii() != b"ply") {
        return Err(ReadError::line(1, "a PLY file starts with \"ply\""));
    }
    let mut encoding = None;
    let (mut elements, mut material_names): (Vec<Element>, Vec<String>) = (Vec::new(), Vec::new());
    while let Some((number, line)) = lines.next() {
        let fail = |what: &str| ReadError::line(number, what.to_owned());
        let mut rest = words(line);
        match rest.next() {
            None | Some(b"obj_info") => {}
            Some(b"comment") => {
                if rest.next() == Some(MATERIAL_COMMENT.as_bytes()) {
                    let after = line
                        .trim_ascii_start()
                        .get("comment ".len()..)
                        .unwrap_or_default()
                        .trim_ascii_start();
                    let name = after.get(MATERIAL_COMMENT.len() + 1..).unwrap_or_default();
                    material_names.push(String::from_utf8_lossy(name).into_owned());
                }
            }
            Some(b"format") => {
                encoding = Some(match rest.next() {
                    Some(b"ascii") => Encoding::Text,
                    Some(b"binary_little_endian") => Encoding::Little,
                    Some(b"binary_big_endian") => Encoding::Big,
                    _ => {
                        return Err(fail(
                            "the format is none of ascii, binary_little_endian, binary_big_endian",
                        ));
                    }
                });
            }
            Some(b"element") => {
                let name = rest.next().ok_or_else(|| fail("an element has no name"))?;
                let count = rest.next().and_then(integer).and_then(|n| u64::try_from(n).ok());
                let count = count.ok_or_else(|| fail("an element has no count"))?;
                let name = String::from_utf8_lossy(name).into_owned();
                elements.push(Element { name, count, properties: Vec::new() });
            }
            Some(b"property") => {
                let element =
                    elements.last_mut().ok_or_else(|| fail("a property comes before any element"))?;
                element
                    .properties
                    .push(property(rest).ok_or_else(|| fail("a property without known type and name"))?);
            }
            Some(b"end_header") => {
                let encoding = encoding.ok_or_else(|| fail("the header names no format"))?;
                let mut body = bytes.len() - lines.left();
                if lone_cr && encoding != Encoding::Text && bytes[..body].ends_with(b"\r\n") {
                    body -= 1;
                }
                return Ok(Header { encoding, elements, material_names, body, body_line: number + 1 });
            }
            Some(word) => return Err(fail(&format!("{} is no PLY header line", quoted(word)))),
        }
    }
    Err(ReadError::truncated("the PLY header has no end_header"))
}

fn property<'a>(mut rest: impl Iterator<Item = &'a [u8]>) -> Option<Property> {
    let first = rest.next()?;
    let (count, kind) = match first {
        b"list" => (Some(Kind::named(rest.next()?)?), Kind::named(rest.next()?)?),
        _ => (None, Kind::named(first)?),
    };
    Some(Property { name: String::from_utf8_lossy(rest.next()?).into_owned(), kind, count })
}
