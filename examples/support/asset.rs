//! A game asset as an engine holds it: one array of vertices with all that a skinned, painted model has, indices, and two
//! materials with an atlas chart each.

use bytemuck::{Pod, Zeroable};
use multires::adapt::Blend;

/// 52 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub uv: [f32; 2],
    pub colour: [u8; 4],
    pub joints: [u16; 4],
    /// In 65535ths.
    pub weights: [u16; 4],
}

impl Blend for Vertex {
    fn blend(&self, other: &Self, t: f32) -> Self {
        let near = if t < 0.5 { self } else { other };
        let channel =
            |i: usize| f32::from(self.colour[i]).blend(&f32::from(other.colour[i]), t).round() as u8;
        Self {
            position: self.position.blend(&other.position, t),
            normal: self.normal.blend(&other.normal, t),
            uv: self.uv.blend(&other.uv, t),
            colour: std::array::from_fn(channel),
            // Joints are names, not numbers: weights only mean something beside their own.
            ..*near
        }
    }
}

/// What an engine loads.
pub struct Asset {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    /// Indices of each material.
    pub ranges: [std::ops::Range<usize>; 2],
}

/// A hilly patch of `2 x cells` by `2 x cells` squares: the left half of one material, the right half of another, with a texture
/// seam where they meet.
pub fn patch(cells: u32) -> Asset {
    let mut asset = Asset { vertices: Vec::new(), indices: Vec::new(), ranges: [0..0, 0..0] };
    for half in 0..2 {
        let first = asset.vertices.len() as u32;
        let start = asset.indices.len();
        for row in 0..=2 * cells {
            for column in 0..=cells {
                asset.vertices.push(vertex(half, column + half * cells, row, cells));
            }
        }
        for row in 0..2 * cells {
            for column in 0..cells {
                let corner = |x: u32, y: u32| first + (row + y) * (cells + 1) + column + x;
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                asset.indices.extend([a, b, c, a, c, d]);
            }
        }
        asset.ranges[half as usize] = start..asset.indices.len();
    }
    asset
}

fn vertex(half: u32, column: u32, row: u32, cells: u32) -> Vertex {
    let [x, z] = [column, row].map(|i| i as f32 / cells as f32 - 1.0);
    let height = 0.15 * (5.0 * x).sin() * (4.0 * z).cos() + 0.02 * (31.0 * x + 17.0 * z).sin();
    let slope = [
        0.75 * (5.0 * x).cos() * (4.0 * z).cos() + 0.62 * (31.0 * x + 17.0 * z).cos(),
        -0.6 * (5.0 * x).sin() * (4.0 * z).sin() + 0.34 * (31.0 * x + 17.0 * z).cos(),
    ];
    let length = (slope[0] * slope[0] + slope[1] * slope[1] + 1.0).sqrt();
    let weight = ((z + 1.0) * 0.5 * 65_535.0) as u16;
    Vertex {
        position: [x, height, -z],
        normal: [-slope[0] / length, 1.0 / length, slope[1] / length],
        // The charts lie apart in the atlas.
        uv: [0.1 + 0.35 * (x + 1.0 - half as f32) + 0.5 * half as f32, 0.5 * (z + 1.0)],
        colour: [(128.0 + 120.0 * height / 0.2) as u8, 90, 60, 255],
        joints: [0, 1, 0, 0],
        weights: [65_535 - weight, weight, 0, 0],
    }
}
