//! Meshes of thin triangles, as files from CAD programs are made of.
#![allow(dead_code)]

use multires::mesh::Mesh;

/// A point of the unit circle by its share of the way round, by rational functions: the same on every platform. Points
/// of even shares lie nearly evenly.
pub fn on_circle(share: f32) -> [f32; 2] {
    let quarter = (4.0 * share).floor().min(3.0);
    let t = 4.0 * share - quarter;
    // The middle of a quarter is where a line of slope sqrt(2) - 1 meets it.
    let t = t * (0.83 + 0.17 * t);
    let (x, y) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
    match quarter as u8 {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

fn rim(sides: u32, radius: f32, z: f32) -> impl Iterator<Item = [f32; 3]> {
    (0..sides).map(move |i| {
        let [x, y] = on_circle(i as f32 / sides as f32);
        [radius * x, radius * y, z]
    })
}

/// A closed box of this length and a cross-section of 1 by 1, its length in so many sections.
pub fn beam(sections: u32, length: f32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..sections {
        let x = length * i as f32 / (sections - 1) as f32;
        positions.extend([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]]);
    }
    let mut triangles = vec![[0, 3, 2], [0, 2, 1]];
    for i in 0..sections - 1 {
        for side in 0..4 {
            let next = (side + 1) % 4;
            let (a, b, c, d) = (4 * i + side, 4 * i + next, 4 * i + 4 + next, 4 * i + 4 + side);
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let end = 4 * (sections - 1);
    triangles.extend([[end, end + 1, end + 2], [end, end + 2, end + 3]]);
    Mesh::new(positions, triangles).unwrap()
}

/// A closed cylinder of radius 10 and height 10 with fans as caps: 4 triangles a side.
pub fn cylinder(sides: u32) -> Mesh {
    let mut positions: Vec<[f32; 3]> = rim(sides, 10.0, 0.0).chain(rim(sides, 10.0, 10.0)).collect();
    positions.extend([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]]);
    let mut triangles = Vec::new();
    for i in 0..sides {
        let (j, top) = ((i + 1) % sides, sides);
        triangles.extend([[j, i, 2 * sides], [top + i, top + j, 2 * sides + 1]]);
        triangles.extend([[i, j, top + j], [i, top + j, top + i]]);
    }
    Mesh::new(positions, triangles).unwrap()
}

/// An open flat disc of radius 1: a fan around its middle.
pub fn disc(sides: u32) -> Mesh {
    let mut positions: Vec<[f32; 3]> = rim(sides, 1.0, 0.0).collect();
    positions.push([0.0; 3]);
    let triangles: Vec<_> = (0..sides).map(|i| [i, (i + 1) % sides, sides]).collect();
    Mesh::new(positions, triangles).unwrap()
}

/// An open flat disc of radius 1 in slivers: a fan around a point of its rim.
pub fn sliver_disc(sides: u32) -> Mesh {
    let positions: Vec<[f32; 3]> = rim(sides, 1.0, 0.0).collect();
    let triangles: Vec<_> = (1..sides - 1).map(|i| [0, i, i + 1]).collect();
    Mesh::new(positions, triangles).unwrap()
}
