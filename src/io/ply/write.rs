//! A mesh to a file; which property belongs to which attribute.

use crate::io::error::WriteError;
use crate::mesh::{Attribute, AttributeValues, Mesh, names};

use super::body;
use super::header::MATERIAL_COMMENT;

/// A column of the vertex element.
struct Column<'a> {
    name: String,
    kind: &'static str,
    attribute: &'a Attribute,
    component: usize,
    as_byte: bool,
}

/// Encodes a mesh as binary little-endian, with all attributes but `vertex`, and material ids and names. Locks are not
/// written. Colours are bytes if no precision is lost, else floats.
pub(in crate::io) fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    let columns = columns(mesh)?;
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    if !mesh.materials().is_empty() {
        for name in mesh.material_names() {
            header += &format!("comment {MATERIAL_COMMENT} {}\n", name.replace(['\n', '\r'], " "));
        }
    }
    header += &format!("element vertex {}\n", mesh.positions().len());
    let moved = mesh.origin() != [0.0; 3];
    for axis in ["x", "y", "z"] {
        header += &format!("property {} {axis}\n", if moved { "double" } else { "float" });
    }
    for column in &columns {
        header += &format!("property {} {}\n", column.kind, column.name);
    }
    header += &format!("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles().len());
    if !mesh.materials().is_empty() {
        header += "property uint material_index\n";
    }
    header += "end_header\n";

    let mut out = header.into_bytes();
    out.reserve(mesh.positions().len() * (12 + 4 * columns.len()) + 17 * mesh.triangles().len());
    for (v, position) in mesh.positions().iter().enumerate() {
        for (&x, origin) in position.iter().zip(mesh.origin()) {
            if moved {
                out.extend_from_slice(&(f64::from(x) + origin).to_le_bytes());
            } else {
                out.extend_from_slice(&x.to_le_bytes());
            }
        }
        for column in &columns {
            let at = v * column.attribute.width() + column.component;
            match column.attribute.values() {
                AttributeValues::Float(values) if column.as_byte => {
                    out.push((values[at] * 255.0).round() as u8)
                }
                AttributeValues::Float(values) => out.extend_from_slice(&values[at].to_le_bytes()),
                AttributeValues::Int(values) => out.extend_from_slice(&values[at].to_le_bytes()),
                AttributeValues::Uint(values) => out.extend_from_slice(&values[at].to_le_bytes()),
            }
        }
    }
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        out.push(3);
        triangle.iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
        if let Some(id) = mesh.materials().get(t) {
            out.extend_from_slice(&id.to_le_bytes());
        }
    }
    Ok(out)
}

/// Returns the vertex properties after x, y and z.
fn columns(mesh: &Mesh) -> Result<Vec<Column<'_>>, WriteError> {
    let mut columns: Vec<Column> = Vec::new();
    // The `vertex` attribute (identity of the caller's vertices) is not written.
    for attribute in mesh.attributes().iter().filter(|a| a.name() != names::VERTEX) {
        let as_byte = attribute.name() == names::COLOR && attribute.as_floats().is_some_and(are_bytes);
        let known: &[&str] = match (attribute.name(), attribute.as_floats(), attribute.width()) {
            (names::NORMAL, Some(_), 3) => &["nx", "ny", "nz"],
            (names::UV, Some(_), 2) => &["s", "t"],
            (names::COLOR, Some(_), width @ (3 | 4)) => &["red", "green", "blue", "alpha"][..width],
            _ => &[],
        };
        let kind = match attribute.values() {
            AttributeValues::Float(_) if as_byte && !known.is_empty() => "uchar",
            AttributeValues::Float(_) => "float",
            AttributeValues::Int(_) => "int",
            AttributeValues::Uint(_) => "uint",
        };
        let base: String = attribute
            .name()
            .chars()
            .map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c })
            .collect();
        for component in 0..attribute.width() {
            let name = match known.get(component) {
                Some(name) => (*name).to_owned(),
                None if attribute.width() == 1 => base.clone(),
                None => format!("{base}_{component}"),
            };
            let as_byte = as_byte && !known.is_empty();
            columns.push(Column { name, kind, attribute, component, as_byte });
        }
    }
    let mut sorted: Vec<&str> = columns.iter().map(|c| c.name.as_str()).chain(["x", "y", "z"]).collect();
    sorted.sort_unstable();
    let twice = sorted.windows(2).find(|pair| pair[0] == pair[1] || pair[1].is_empty());
    match twice {
        Some(pair) => Err(WriteError::Unsupported {
            format: "PLY",
            what: format!("two vertex properties named {:?}, or one without a name", pair[1]),
        }),
        None => Ok(columns),
    }
}

/// Tests if every value is exactly k / 255 as computed on reading, with integer k.
fn are_bytes(values: &[f32]) -> bool {
    let exact = |&x: &f32| (0.0..=1.0).contains(&x) && body::unit(f64::from((x * 255.0).round()), 255.0) == x;
    values.iter().all(exact)
}
