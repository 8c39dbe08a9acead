//! A mesh to a file.

use super::binary::FACET;
use crate::io::error::WriteError;
use crate::io::text::push_position;
use crate::mesh::Mesh;

/// Encodes a mesh as binary, or as text if its origin is not zero. Writes positions and triangles only. Normals are
/// computed; zero without an area.
pub(in crate::io) fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
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
