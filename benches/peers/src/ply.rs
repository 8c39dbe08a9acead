//! PLY, as far as the measurements need it: reads positions and faces (ascii, little and big endian), writes binary.

use crate::input::Soup;

/// How the body's numbers are stored.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Ascii,
    Little,
    Big,
}

/// A scalar type: its size in bytes, and whether it is a float or signed.
#[derive(Clone, Copy)]
struct Scalar {
    size: usize,
    float: bool,
    signed: bool,
}

struct Property {
    name: String,
    /// The count's type where the property is a list.
    count: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: String,
    rows: usize,
    properties: Vec<Property>,
}

/// Positions and triangles; polygons are cut into fans, other elements and properties are skipped.
///
/// # Errors
/// A sentence about the first thing that is wrong: the header, the end of the file, an index.
pub(crate) fn read(bytes: &[u8]) -> Result<Soup, String> {
    let (format, elements, body) = header(bytes)?;
    let mut body = Body { format, rest: body };
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut corners = Vec::new();
    for element in &elements {
        let axes = ["x", "y", "z"].map(|axis| element.properties.iter().position(|p| p.name == axis));
        let face = element.name == "face";
        for row in 0..element.rows {
            let mut position = [0.0f32; 3];
            for (index, property) in element.properties.iter().enumerate() {
                let count = match property.count {
                    Some(scalar) => body.next(scalar)? as usize,
                    None => 1,
                };
                let is_corners = face && property.name.starts_with("vertex_ind");
                corners.clear();
                for _ in 0..count {
                    let value = body.next(property.scalar)?;
                    if let Some(axis) = axes.iter().position(|&a| a == Some(index)) {
                        position[axis] = value as f32;
                    } else if is_corners {
                        if !(0.0..f64::from(u32::MAX)).contains(&value) {
                            return Err(format!("face {row} names vertex {value}"));
                        }
                        corners.push(value as u32);
                    }
                }
                if is_corners && corners.len() >= 3 {
                    triangles.extend(corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]));
                }
            }
            if element.name == "vertex" {
                positions.push(position);
            }
        }
    }
    Ok((positions, triangles))
}

/// The format, the elements and the bytes after the header.
fn header(bytes: &[u8]) -> Result<(Format, Vec<Element>, &[u8]), String> {
    let mut rest = bytes;
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut first = true;
    loop {
        let end = rest.iter().position(|&b| b == b'\n').ok_or("the header has no end")?;
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| "the header is no text")?.trim_end();
        rest = &rest[end + 1..];
        if std::mem::take(&mut first) != (line == "ply") {
            return Err("not a PLY file".to_owned());
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = || format!("header line {line:?}");
        match words[..] {
            ["ply"] | ["comment" | "obj_info", ..] | [] => {}
            ["format", "ascii", _] => format = Some(Format::Ascii),
            ["format", "binary_little_endian", _] => format = Some(Format::Little),
            ["format", "binary_big_endian", _] => format = Some(Format::Big),
            ["element", name, rows] => {
                let rows = rows.parse().map_err(|_| wrong())?;
                elements.push(Element { name: name.to_owned(), rows, properties: Vec::new() });
            }
            ["property", ref kind @ .., name] => {
                let (count, scalar) = match kind {
                    ["list", count, scalar] => (Some(scalar_type(count).ok_or_else(wrong)?), scalar),
                    [scalar] => (None, scalar),
                    _ => return Err(wrong()),
                };
                let scalar = scalar_type(scalar).ok_or_else(wrong)?;
                let element = elements.last_mut().ok_or_else(wrong)?;
                element.properties.push(Property { name: name.to_owned(), count, scalar });
            }
            ["end_header"] => break,
            _ => return Err(wrong()),
        }
    }
    // Without properties a row has no bytes, and a hostile count would never end.
    if let Some(empty) = elements.iter().find(|e| e.properties.is_empty() && e.rows > 0) {
        return Err(format!("element {:?} has no properties", empty.name));
    }
    Ok((format.ok_or("the header names no format")?, elements, rest))
}

fn scalar_type(name: &str) -> Option<Scalar> {
    let (size, float, signed) = match name {
        "char" | "int8" => (1, false, true),
        "uchar" | "uint8" => (1, false, false),
        "short" | "int16" => (2, false, true),
        "ushort" | "uint16" => (2, false, false),
        "int" | "int32" => (4, false, true),
        "uint" | "uint32" => (4, false, false),
        "float" | "float32" => (4, true, true),
        "double" | "float64" => (8, true, true),
        _ => return None,
    };
    Some(Scalar { size, float, signed })
}

/// The numbers after the header, one after another.
struct Body<'a> {
    format: Format,
    rest: &'a [u8],
}

impl Body<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, String> {
        let short = || "the file ends too early".to_owned();
        if self.format == Format::Ascii {
            let word = self.rest.trim_ascii_start();
            let end = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
            if end == 0 {
                return Err(short());
            }
            self.rest = &word[end..];
            let word = String::from_utf8_lossy(&word[..end]);
            return word.parse().map_err(|_| format!("{word:?} is no number"));
        }
        let (bytes, rest) = self.rest.split_at_checked(scalar.size).ok_or_else(short)?;
        self.rest = rest;
        let mut word = [0; 8];
        word[..scalar.size].copy_from_slice(bytes);
        if self.format == Format::Big {
            word[..scalar.size].reverse();
        }
        let bits = u64::from_le_bytes(word);
        let unused = 64 - 8 * scalar.size as u32;
        Ok(match scalar {
            Scalar { float: true, size: 4, .. } => f64::from(f32::from_bits(bits as u32)),
            Scalar { float: true, .. } => f64::from_bits(bits),
            Scalar { signed: true, .. } => ((bits << unused) as i64 >> unused) as f64,
            Scalar { .. } => bits as f64,
        })
    }
}

/// The bytes of a binary little-endian PLY file.
pub(crate) fn write(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    for x in positions.as_flattened() {
        bytes.extend(x.to_le_bytes());
    }
    for triangle in triangles {
        bytes.push(3);
        triangle.iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let positions = vec![[0.5, -1.25, 3e-20], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [-0.0, 7.0, 1e30]];
        let triangles = vec![[0, 1, 2], [2, 1, 3]];
        let bytes = write(&positions, &triangles);
        assert_eq!(read(&bytes).unwrap(), (positions, triangles));
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end]).is_err(), "cut at {end}");
        }
    }

    #[test]
    fn text_quads_and_other_properties_are_read() {
        let text = "ply\r\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty uchar red\nproperty double x\n\
                    property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                    property list int float weights\nend_header\n\
                    9 0 0 0\n9 1 0 0\n9 1 1 0\n9 0 1 -2.5\n4 0 1 2 3 2 0.5 0.5\n";
        let (positions, triangles) = read(text.as_bytes()).unwrap();
        assert_eq!(positions[3], [0.0, 1.0, -2.5]);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn big_endian_numbers_keep_their_sign() {
        let mut bytes =
            b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\nproperty uchar y\n\
            property double z\nend_header\n"
                .to_vec();
        bytes.extend((-300i16).to_be_bytes());
        bytes.push(200);
        bytes.extend(0.25f64.to_be_bytes());
        assert_eq!(read(&bytes).unwrap().0, [[-300.0, 200.0, 0.25]]);
    }

    #[test]
    fn an_element_without_bytes_does_not_run_for_ever() {
        let text = "ply\nformat ascii 1.0\nelement vertex 99999999999999\nend_header\n";
        assert!(read(text.as_bytes()).is_err());
    }
}
