//! What a mesh holds, apart from the order of its vertices and triangles.

#![allow(dead_code)]

use multires::mesh::{AttributeValues, Mesh};

/// Corners and material of every triangle, lowest corner first, sorted: equal for meshes that differ in order only.
pub type Content = Vec<([Vec<u32>; 3], u32)>;

/// Returns the position, all attributes and the lock of a vertex, as words.
pub fn words(mesh: &Mesh, vertex: u32) -> Vec<u32> {
    let v = vertex as usize;
    let mut words: Vec<u32> = mesh.positions()[v].iter().map(|x| (x + 0.0).to_bits()).collect();
    for a in mesh.attributes() {
        let range = v * a.width()..(v + 1) * a.width();
        match a.values() {
            AttributeValues::Float(all) => words.extend(all[range].iter().map(|x| x.to_bits())),
            AttributeValues::Uint(all) => words.extend(&all[range]),
            AttributeValues::Int(all) => words.extend(all[range].iter().map(|&x| x as u32)),
            _ => {}
        }
    }
    words.push(u32::from(mesh.locks().get(v).copied().unwrap_or(false)));
    words
}

/// Returns all that a mesh holds.
pub fn content(mesh: &Mesh) -> Content {
    content_of(mesh, |vertex| words(mesh, vertex))
}

/// Returns what a mesh holds, where `words` tells what counts at a vertex.
pub fn content_of(mesh: &Mesh, words: impl Fn(u32) -> Vec<u32>) -> Content {
    let triangles = mesh.triangles().iter().enumerate().map(|(t, corners)| {
        let mut corners = corners.map(&words);
        let lowest = (0..3).min_by_key(|&i| &corners[i]).unwrap_or(0);
        corners.rotate_left(lowest);
        (corners, mesh.materials().get(t).copied().unwrap_or(0))
    });
    let mut content: Content = triangles.collect();
    content.sort_unstable();
    content
}
