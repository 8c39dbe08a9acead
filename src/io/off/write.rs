//! A mesh to text.

use crate::io::text::{push_float, push_position};
use crate::mesh::{Mesh, names};

/// Encodes a mesh as text.
pub(in crate::io) fn write(mesh: &Mesh) -> Vec<u8> {
    let floats = |name, widths: &[usize]| {
        let attribute = mesh.attribute(name).filter(|a| widths.contains(&a.width()))?;
        Some((attribute.as_floats()?, attribute.width()))
    };
    let (uv, color, normal) =
        (floats(names::UV, &[2]), floats(names::COLOR, &[3, 4]), floats(names::NORMAL, &[3]));
    let prefix = |given: bool, name: &'static str| if given { name } else { "" };
    let (uv_prefix, color_prefix, normal_prefix) =
        (prefix(uv.is_some(), "ST"), prefix(color.is_some(), "C"), prefix(normal.is_some(), "N"));
    let counts = format!("{} {} 0\n", mesh.positions().len(), mesh.triangles().len());
    let mut out = format!("{uv_prefix}{color_prefix}{normal_prefix}OFF\n{counts}").into_bytes();
    for (v, position) in mesh.positions().iter().enumerate() {
        push_position(*position, mesh.origin(), &mut out);
        let mut put = |values: &[f32]| {
            for &x in values {
                out.push(b' ');
                push_float(x, &mut out);
            }
        };
        for (values, width) in [normal, color, uv].into_iter().flatten() {
            put(&values[v * width..(v + 1) * width]);
        }
        out.push(b'\n');
    }
    for [a, b, c] in mesh.triangles() {
        out.extend_from_slice(format!("3 {a} {b} {c}\n").as_bytes());
    }
    out
}
