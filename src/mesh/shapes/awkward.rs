//! Minimal meshes with awkward topology: they break careless code.
//!
//! ```text
//!     book(3), from above      bowtie             pillow            hub(6), from above
//!
//!          page                  .       .        .-----.               .---.
//!            \                   | \   / |         \ 2 /               / \ / \
//!             spine --- page     .---hub---.        \ /  triangles    .--hub--.
//!            /                   | /   \ |           .   back to       \ / \ /
//!          page                  .       .               back           .---.
//! ```

use glam::DVec3;

use super::super::Mesh;
use super::noise::{sin_cos, unit};
use super::solids::icosphere;
use super::{MAX_CELLS, bare, cells};

/// A tetrahedron: the smallest closed surface with volume.
pub fn tetrahedron() -> Mesh {
    bare(
        vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [3, 2, 1]],
    )
}

/// A flat square from -1 to 1 at y = 0, facing up, of `n` by `n` cells, with a single border loop.
///
/// `n`: 1 to 2^14. O(n^2).
pub fn plane(n: u32) -> Mesh {
    let n = n.clamp(1, 1 << 14);
    let at = |i: u32| (2.0 * f64::from(i) / f64::from(n) - 1.0) as f32;
    let positions: Vec<_> =
        (0..=n).flat_map(|row| (0..=n).map(move |column| [at(column), 0.0, -at(row)])).collect();
    let mut triangles = Vec::new();
    cells(n, n, &mut triangles, |column, row| row * (n + 1) + column);
    bare(positions, triangles)
}

/// Square pages around a common spine, the edge between vertices 0 and 1. Two triangles a page; every second page faces
/// the other way. With 3 or more pages the spine is a non-manifold edge.
///
/// 1 to 2^27 pages. O(n).
pub fn book(pages: u32) -> Mesh {
    let pages = pages.clamp(1, 1 << 27);
    let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut triangles = Vec::with_capacity(2 * pages as usize);
    for page in 0..pages {
        let [sin, cos] = sin_cos(f64::from(page) / f64::from(pages)).map(|x| x as f32);
        let outer = 2 + 2 * page;
        positions.extend([[cos, 0.0, -sin], [cos, 1.0, -sin]]);
        if page % 2 == 0 {
            triangles.extend([[0, outer, outer + 1], [0, outer + 1, 1]]);
        } else {
            triangles.extend([[0, outer + 1, outer], [0, 1, outer + 1]]);
        }
    }
    bare(positions, triangles)
}

/// Two open fans of two triangles sharing vertex 0 alone: a non-manifold vertex without a non-manifold edge.
pub fn bowtie() -> Mesh {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, -1.0],
        [-1.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0],
        [-1.0, 0.0, 1.0],
    ];
    bare(positions, vec![[0, 1, 2], [0, 2, 3], [0, 4, 5], [0, 5, 6]])
}

/// Two triangles back to back on the same three vertices: closed, manifold, without volume.
pub fn pillow() -> Mesh {
    bare(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], vec![[0, 1, 2], [2, 1, 0]])
}

/// Two unit icospheres on top of each other, sharing a vertex: closed, non-manifold at the shared vertex alone.
///
/// `2 * 20 * 4^levels` triangles; at most 12 levels. The shared vertex has number 0. O(n log n).
pub fn two_spheres_touching(levels: u32) -> Mesh {
    let lower = icosphere(levels);
    let mut positions = lower.positions().to_vec();
    let mut triangles = lower.triangles().to_vec();
    let base = positions.len() as u32;
    // The bottom of the upper sphere (vertex 11) is the top of the lower sphere (vertex 0).
    let bottom = 11;
    let number = |v: u32| if v == bottom { 0 } else { base + v - u32::from(v > bottom) };
    let upper = lower.positions().iter().enumerate().filter(|&(v, _)| v as u32 != bottom);
    positions.extend(upper.map(|(_, p)| [p[0], p[1] + 2.0, p[2]]));
    triangles.extend(lower.triangles().iter().map(|corners| corners.map(number)));
    bare(positions, triangles)
}

/// A shallow cone: a fan of `n` triangles around vertex 0, open at the rim.
///
/// `n`: 3 to 2^28. O(n).
pub fn hub(n: u32) -> Mesh {
    let n = n.clamp(3, MAX_CELLS);
    let mut positions = vec![[0.0, 0.5, 0.0]];
    positions.extend(rim(n));
    bare(positions, (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect::<Vec<_>>())
}

/// A closed double cone of `2 * n` triangles: vertex 0 at the top and vertex 1 at the bottom have valence `n`.
///
/// `n`: 3 to 2^28. O(n).
pub fn spindle(n: u32) -> Mesh {
    let n = n.clamp(3, MAX_CELLS);
    let mut positions = vec![[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    positions.extend(rim(n));
    let triangles: Vec<_> = (0..n)
        .flat_map(|i| {
            let (here, next) = (2 + i, 2 + (i + 1) % n);
            [[0, here, next], [1, next, here]]
        })
        .collect();
    bare(positions, triangles)
}

/// `n` points around the unit circle at y = 0.
fn rim(n: u32) -> impl Iterator<Item = [f32; 3]> {
    (0..n).map(move |i| {
        let [sin, cos] = sin_cos(f64::from(i) / f64::from(n));
        DVec3::new(cos, 0.0, -sin).as_vec3().to_array()
    })
}

/// `n` separate small triangles at random in the cube from -1 to 1, three vertices each.
///
/// `n`: at most 2^28. O(n).
pub fn soup(n: u32, seed: u32) -> Mesh {
    let n = n.min(MAX_CELLS);
    let mut positions = Vec::with_capacity(3 * n as usize);
    for triangle in 0..n {
        let number = |i: u32| 2.0 * unit(triangle.wrapping_mul(12).wrapping_add(i), seed) - 1.0;
        let middle = [number(0), number(1), number(2)];
        for corner in 0..3 {
            positions.push(
                [0, 1, 2].map(|axis| 0.9 * middle[axis as usize] + 0.1 * number(3 + 3 * corner + axis)),
            );
        }
    }
    bare(positions, (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect::<Vec<_>>())
}
