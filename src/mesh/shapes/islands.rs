//! Many separate parts: a forest of leaf cards, a field of pebbles, a shell of two spheres.

use glam::DVec3;

use super::super::Mesh;
use super::noise::{direction, unit};
use super::part::{Assembly, Part};
use super::solids::icosphere;
use super::{awkward, bare};

/// Leaves per tree of a forest.
const LEAVES: u32 = 100;

/// A forest of `cards` leaf cards, 100 a tree, with trunks. Every leaf is a separate square of `cells` by `cells`
/// cells, turned any way, 0.16 to 0.24 wide, in a crown 1 unit wide.
///
/// Normals, texture coordinates (the whole picture on every leaf), and two materials, "leaves" and "bark". Trees stand
/// in a square grid 1.4 units apart. Triangles are stored tree by tree and leaf by leaf: `2 * cells^2` a leaf and 24 a
/// trunk. At most 100,000 cards of 16 by 16 cells. O(n).
pub fn forest(cards: u32, cells: u32, seed: u32) -> Mesh {
    let (cards, cells) = (cards.clamp(1, 100_000), cells.clamp(1, 16));
    let trees = cards.div_ceil(LEAVES);
    let mut side = 1;
    while side * side < trees {
        side += 1;
    }
    let mut assembly = Assembly::default();
    for tree in 0..trees {
        let foot = DVec3::new(f64::from(tree % side) * 1.4, 0.0, f64::from(tree / side) * 1.4);
        for leaf in LEAVES * tree..(LEAVES * (tree + 1)).min(cards) {
            assembly.add(card(foot, leaf, cells, seed), 0);
        }
        assembly.add(trunk(foot), 1);
    }
    assembly.finish(&["leaves", "bark"])
}

fn card(foot: DVec3, leaf: u32, cells: u32, seed: u32) -> Part {
    let random = |n: u32| f64::from(unit(8 * leaf + n, seed));
    // Roughly uniform in a ball: 1 less a product of random numbers, in place of a cube root.
    let out = direction(3 * leaf, seed);
    let far = 0.5 * (1.0 - random(0) * random(1));
    let middle = foot + DVec3::new(0.0, 1.3, 0.0) + far * out;
    let across = direction(3 * leaf + 1, seed);
    let up = across.cross(direction(3 * leaf + 2, seed)).normalize_or(across.any_orthonormal_vector());
    let half = 0.08 + 0.04 * random(2);
    Part::grid(cells, cells, |column, row| {
        let [u, v] = [column, row].map(|i| f64::from(i) / f64::from(cells));
        let at = middle + half * ((2.0 * u - 1.0) * across + (2.0 * v - 1.0) * up);
        (at, [u as f32, v as f32])
    })
}

/// A trunk of four sides from the ground into the crown.
fn trunk(foot: DVec3) -> Part {
    let corners = [[-0.06, -0.06], [-0.06, 0.06], [0.06, 0.06], [0.06, -0.06]];
    Part::grid(4, 3, |column, row| {
        let [x, z] = corners[column as usize % 4];
        let v = f64::from(row) / 3.0;
        let thin = 1.0 - 0.5 * v;
        (foot + DVec3::new(x * thin, 1.2 * v, z * thin), [column as f32 / 4.0, v as f32])
    })
}

/// A field of `stones` pebbles, every third a tetrahedron and the others spheres of 80 triangles. Radii 0.1 to 0.3, a
/// pebble per unit square. All vertices shared, every pebble closed. At most 100,000 pebbles. O(n).
pub fn gravel(stones: u32, seed: u32) -> Mesh {
    let stones = stones.clamp(1, 100_000);
    let mut side = 1;
    while side * side < stones {
        side += 1;
    }
    let kinds = [awkward::tetrahedron(), icosphere(1), icosphere(1)];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for stone in 0..stones {
        let random = |n: u32| unit(4 * stone + n, seed);
        let radius = 0.1 + 0.2 * random(0);
        let x = (stone % side) as f32 + 0.4 * random(1);
        let z = (stone / side) as f32 + 0.4 * random(2);
        let kind = &kinds[stone as usize % 3];
        let first = positions.len() as u32;
        positions
            .extend(kind.positions().iter().map(|p| [x + radius * p[0], radius * p[1], z + radius * p[2]]));
        triangles.extend(kind.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    bare(positions, triangles)
}

/// A thin shell: a sphere of radius 1 and inside it a sphere of radius `inner` facing inwards, `20 * 4^levels`
/// triangles each. No two triangles cross if `inner` leaves room. At most 10 levels; an `inner` not between 0 and 1
/// counts as 0.97. O(n).
pub fn shell(levels: u32, inner: f32) -> Mesh {
    let sphere = icosphere(levels.min(10));
    let inner = if inner > 0.0 && inner < 1.0 { inner } else { 0.97 };
    let count = sphere.positions().len() as u32;
    let mut positions = sphere.positions().to_vec();
    positions.extend(sphere.positions().iter().map(|p| p.map(|x| inner * x)));
    let mut triangles = sphere.triangles().to_vec();
    triangles.extend(sphere.triangles().iter().map(|&[a, b, c]| [a, c, b].map(|v| v + count)));
    bare(positions, triangles)
}
