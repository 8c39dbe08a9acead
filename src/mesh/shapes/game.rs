//! Game assets: atlases of many charts, hard edges, several materials, mirrored texture coordinates, cards, facets with
//! separate normals, skins and painted vertices.

use glam::{DVec3, Vec3};

use super::super::{Attribute, AttributeValues, Mesh, names};
use super::fit;
use super::nature::rock;
use super::noise::{octaves, sin_cos, unit};
use super::part::{Assembly, Part};
use super::solids::{FACES, face_axes};

/// A chart: its lower left corner and its size in the texture. A negative width mirrors the chart.
#[derive(Clone, Copy)]
struct Chart {
    low: [f64; 2],
    size: [f64; 2],
}

impl Chart {
    /// Returns a cell of an atlas of `columns` by `rows` cells, less a margin.
    fn cell(index: u32, columns: u32, rows: u32) -> Self {
        let size = [1.0 / f64::from(columns), 1.0 / f64::from(rows)];
        let low = [f64::from(index % columns) * size[0], f64::from(index / columns % rows) * size[1]];
        Self { low: [0, 1].map(|i| low[i] + 0.04 * size[i]), size: size.map(|s| 0.92 * s) }
    }

    fn mirrored(self) -> Self {
        Self { low: [self.low[0] + self.size[0], self.low[1]], size: [-self.size[0], self.size[1]] }
    }

    fn at(&self, u: f64, v: f64) -> [f32; 2] {
        [(self.low[0] + u * self.size[0]) as f32, (self.low[1] + v * self.size[1]) as f32]
    }
}

/// A wooden crate with a metal frame, 1 unit high: `12 * n^2` triangles, hard edges between its six sides, two
/// materials, twelve charts in an atlas. The boards are worn, the frame is straight.
///
/// `n` cells along a side, 8 to 6000. Welded, it is closed. O(n^2).
pub fn prop(n: u32) -> Mesh {
    let n = n.clamp(8, 6000);
    let frame = (n / 8).max(1);
    let mut assembly = Assembly::default();
    for (face, (axis, side)) in FACES.into_iter().enumerate() {
        let [right, up] = face_axes(axis, side);
        let place = |column: u32, row: u32| {
            let along = |i: u32| f64::from(i) / f64::from(n) - 0.5;
            let mut p = [if side { 0.5 } else { -0.5 }; 3];
            (p[right], p[up]) = (along(column), along(row));
            let inside = |i: u32| frame < i && i < n - frame;
            if inside(column) && inside(row) {
                // Four worn boards, behind the frame.
                let board = (column - frame - 1) * 4 / (n - 2 * frame - 1);
                let depth = 0.02 + 0.01 * f64::from(unit(board, face as u32));
                let grain = f64::from(octaves(Vec3::from(p.map(|x| (x * 9.0) as f32)), 3, face as u32));
                p[axis] -= p[axis].signum() * (depth + 0.006 * grain);
            }
            DVec3::from(p)
        };
        // Boards, then the four sides of the frame: separate grids with equal positions where they meet.
        let charts = [Chart::cell(2 * face as u32, 4, 3), Chart::cell(2 * face as u32 + 1, 4, 3)];
        let share = |i: u32| f64::from(i) / f64::from(n);
        let grid = |part: &mut Part, chart: Chart, from: [u32; 2], to: [u32; 2]| {
            part.add_grid(to[0] - from[0], to[1] - from[1], |column, row| {
                let [column, row] = [from[0] + column, from[1] + row];
                (place(column, row), chart.at(share(column), share(row)))
            });
        };
        let (low, high) = (frame, n - frame);
        let mut boards = Part::default();
        grid(&mut boards, charts[0], [low, low], [high, high]);
        let mut metal = Part::default();
        grid(&mut metal, charts[1], [0, 0], [n, low]);
        grid(&mut metal, charts[1], [0, high], [n, n]);
        grid(&mut metal, charts[1], [0, low], [low, high]);
        grid(&mut metal, charts[1], [high, low], [n, high]);
        assembly.add(boards, 0);
        assembly.add(metal, 1);
    }
    assembly.finish(&["wood", "metal"])
}

/// A standing figure of boxes and tubes, 2.4 units high: a chart for every side of every part, hard edges at every end,
/// three materials. Left and right limbs share a part of the texture, mirrored. `240 * n^2 + 144 * n` triangles.
///
/// `n` cells along a side, 2 to 1000. Welded, every part is closed; parts pass through each other. O(n^2).
pub fn robot(n: u32) -> Mesh {
    let n = n.clamp(2, 1000);
    let mut assembly = Assembly::default();
    let mut next = 0;
    let mut cell = || {
        next += 1;
        Chart::cell(next - 1, 6, 6)
    };
    for (middle, half, material) in [
        (DVec3::new(0.0, 1.45, 0.0), DVec3::new(0.4, 0.45, 0.22), 0),
        (DVec3::new(0.0, 2.15, 0.0), DVec3::new(0.2, 0.2, 0.2), 1),
    ] {
        for (axis, side) in FACES {
            block(&mut assembly, n, [axis, usize::from(side)], middle, half, cell(), material);
        }
    }
    // Limbs: from, to, radius.
    for (from, to, radius, material) in [
        (DVec3::new(0.5, 1.85, 0.0), DVec3::new(0.75, 0.95, 0.1), 0.11, 2),
        (DVec3::new(0.2, 1.02, 0.0), DVec3::new(0.28, 0.0, 0.0), 0.15, 2),
        (DVec3::new(0.62, 1.86, 0.0), DVec3::new(0.4, 1.84, 0.0), 0.16, 0),
    ] {
        let charts = [cell(), cell(), cell()];
        limb(&mut assembly, n, from, to, radius, charts, material);
        let other = |p: DVec3| DVec3::new(-p.x, p.y, p.z);
        limb(&mut assembly, n, other(from), other(to), radius, charts.map(Chart::mirrored), material);
    }
    assembly.finish(&["armour", "head", "limbs"])
}

/// A side of a box, slightly domed, with straight edges.
fn block(
    assembly: &mut Assembly,
    n: u32,
    [axis, side]: [usize; 2],
    middle: DVec3,
    half: DVec3,
    chart: Chart,
    material: u32,
) {
    let [right, up] = face_axes(axis, side == 1);
    let sign = if side == 1 { 1.0 } else { -1.0 };
    let part = Part::grid(2 * n, 2 * n, |column, row| {
        let [u, v] = [column, row].map(|i| f64::from(i) / f64::from(n) - 1.0);
        let mut p = [sign; 3];
        (p[right], p[up]) = (u, v);
        p[axis] *= 1.0 + 0.15 * (1.0 - u * u) * (1.0 - v * v);
        (middle + DVec3::from(p) * half, chart.at(0.5 * (u + 1.0), 0.5 * (v + 1.0)))
    });
    assembly.add(part, material);
}

/// A tube with two flat ends, swollen in the middle.
fn limb(
    assembly: &mut Assembly,
    n: u32,
    from: DVec3,
    to: DVec3,
    radius: f64,
    charts: [Chart; 3],
    material: u32,
) {
    let axis = (to - from).normalize();
    let side = axis.cross(DVec3::Z).normalize();
    let across = axis.cross(side);
    let segments = 4 * n;
    let rim = |column: u32, along: f64| {
        let [sin, cos] = sin_cos(f64::from(column % segments) / f64::from(segments));
        let swollen = radius * (1.0 + 0.6 * along * (1.0 - along));
        from + (to - from) * along + (side * cos + across * sin) * swollen
    };
    let rows = 3 * n;
    let tube = Part::grid(segments, rows, |column, row| {
        let along = f64::from(row) / f64::from(rows);
        (rim(column, along), charts[0].at(f64::from(column) / f64::from(segments), along))
    });
    assembly.add(tube, material);
    for (end, chart) in [(0.0, charts[1]), (1.0, charts[2])] {
        let centre = from + (to - from) * end;
        let turned = |column: u32| if end == 0.0 { segments - column } else { column };
        let cap = Part::grid(segments, 2, |column, row| {
            let share = 1.0 - f64::from(row) / 2.0;
            let [sin, cos] = sin_cos(f64::from(turned(column) % segments) / f64::from(segments));
            let rim = rim(turned(column), end);
            let point = if row == 2 { centre } else { centre + (rim - centre) * share };
            let point = if row == 0 { rim } else { point };
            (point, chart.at(0.5 + 0.5 * share * cos, 0.5 + 0.5 * share * sin))
        });
        assembly.add(cap, material);
    }
}

/// A tree: a trunk of bark, and leaves on cards. Each card is a separate quad showing the whole leaf. About 3 units
/// high; `2 * cards` triangles of leaves and 480 of the trunk.
///
/// 1 to 2^26 cards. O(cards).
pub fn tree(cards: u32) -> Mesh {
    let cards = cards.clamp(1, 1 << 26);
    let mut assembly = Assembly::default();
    let trunk = Part::grid(12, 20, |column, row| {
        let [sin, cos] = sin_cos(f64::from(column % 12) / 12.0);
        let height = f64::from(row) / 20.0;
        let radius = 0.16 - 0.12 * height + 0.1 * (1.0 - height).powi(8);
        let bend = 0.15 * height * height;
        let point = DVec3::new(radius * cos + bend, 1.8 * height, -radius * sin);
        (point, [f64::from(column) as f32 / 12.0, (3.0 * height) as f32])
    });
    assembly.add(trunk, 0);
    let mut leaves = Part::default();
    let mut normals = Vec::new();
    for card in 0..cards {
        let random = |k: u32| f64::from(unit(card, k));
        // Uniform in a ball around the end of the trunk, by rejection; up to 8 tries.
        let mut place = DVec3::ZERO;
        for try_again in 0..8 {
            place = DVec3::from([0, 1, 2].map(|i| 2.0 * random(10 + 3 * try_again + i) - 1.0));
            if place.length_squared() <= 1.0 {
                break;
            }
        }
        let out = (place + DVec3::new(0.0, 0.3, 0.0)).normalize_or(DVec3::Y);
        let spin = DVec3::from([1, 2, 3].map(|i| random(i) - 0.5)).normalize_or(DVec3::X);
        let right = out.cross(spin).normalize_or(DVec3::X);
        let up = out.cross(right).normalize_or(DVec3::Z);
        let size = 0.06 + 0.06 * random(4);
        let middle = DVec3::new(0.15, 2.0, 0.0) + place * DVec3::new(0.9, 0.8, 0.9);
        leaves.add_grid(1, 1, |column, row| {
            let [u, v] = [column, row].map(f64::from);
            let point = middle + right * (size * (2.0 * u - 1.0)) + up * (size * (2.0 * v - 1.0));
            (point, [u as f32, v as f32])
        });
        // All four corners look outwards, so that the crown is lit as a whole.
        let facet = right.cross(up);
        let normal = (out + facet * 0.5).normalize_or(facet).as_vec3().to_array();
        normals.extend([normal; 4]);
    }
    assembly.add_with_normals(leaves, normals, 1);
    assembly.finish(&["bark", "leaves"])
}

/// A [`rock`] with three separate vertices per triangle and the triangle's normal: low-poly style.
///
/// As many triangles as the rock. O(n).
pub fn flat_rock(triangles: u32, seed: u32) -> Mesh {
    let smooth = rock(triangles, seed);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for corners in smooth.triangles() {
        let places = corners.map(|v| smooth.positions()[v as usize]);
        let [a, b, c] = places.map(|p| Vec3::from(p).as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or(DVec3::Y).as_vec3().to_array();
        positions.extend(places);
        normals.extend([normal; 3]);
    }
    let triangles = (0..smooth.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let attributes = vec![Attribute::floats(names::NORMAL, &normals)];
    Mesh::from_trusted(positions, triangles, attributes, Vec::new(), Vec::new(), Vec::new())
}

/// A tube along y, 2 units high, skinned to five joints, with normals and a texture seam along a side. Each vertex has
/// four joints with weights of sum 1. `2 * segments * rows` triangles.
///
/// Joints are sorted by weight, the largest first, so neighbouring vertices may hold a joint in different slots. At
/// least 4 segments and 2 rows, at most 2^28 cells. Open at both ends. O(n).
pub fn skinned_tube(segments: u32, rows: u32) -> Mesh {
    let [segments, rows] = fit(segments, rows, [4, 2]);
    let height = |row: u32| f64::from(row) / f64::from(rows);
    let part = Part::grid(segments, rows, |column, row| {
        let [sin, cos] = sin_cos(f64::from(column % segments) / f64::from(segments));
        let y = height(row);
        let radius =
            0.3 + 0.1 * y * (1.0 - y) + 0.02 * f64::from(octaves(Vec3::new(0.0, y as f32 * 8.0, 0.0), 2, 7));
        let point = DVec3::new(radius * cos, 2.0 * y, -radius * sin);
        (point, [(f64::from(column) / f64::from(segments)) as f32, y as f32])
    });
    let mut assembly = Assembly::default();
    let (mut joints, mut weights) = (Vec::new(), Vec::new());
    for row in 0..=rows {
        // Five joints at even heights. Each vertex hangs on the four nearest, mostly on the nearest two.
        let along = 4.0 * height(row);
        let first = (along as u32).min(3);
        let lowest = first.saturating_sub(1).min(1);
        let strength = [0, 1, 2, 3].map(|i| {
            let apart = (along - f64::from(lowest + i)).abs();
            (1.2 - apart).max(0.0).powi(2)
        });
        let total: f64 = strength.iter().sum();
        for _ in 0..=segments {
            // The strongest first, as exporters sort them.
            let mut order = [0usize, 1, 2, 3];
            order.sort_by(|&a, &b| strength[b].total_cmp(&strength[a]).then(a.cmp(&b)));
            joints.extend(order.map(|i| lowest + i as u32));
            let mut shares = order.map(|i| (strength[i] / total) as f32);
            // Rounding goes to the strongest.
            shares[0] = 1.0 - shares[1] - shares[2] - shares[3];
            weights.extend(shares);
        }
    }
    assembly.add(part, 0);
    let mesh = assembly.finish(&[]);
    let mut attributes = mesh.attributes().to_vec();
    attributes.push(Attribute::new(names::JOINTS, 4, AttributeValues::Uint(joints)));
    attributes.push(Attribute::new(names::WEIGHTS, 4, AttributeValues::Float(weights)));
    let (positions, triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    Mesh::from_trusted(positions, triangles, attributes, Vec::new(), Vec::new(), Vec::new())
}

/// A flat disc at y = 0, radius 1, painted red inside ring `rings / 2` (half the radius) and white outside, with a
/// sharp edge: no triangle has two colours. `segments * (2 * rings - 1)` triangles. Vertices are shared, but doubled at
/// the edge.
///
/// At least 3 segments and 4 rings, at most 2^28 cells. O(n).
pub fn painted_disc(segments: u32, rings: u32) -> Mesh {
    let [segments, rings] = fit(segments, rings, [3, 4]);
    let edge = rings / 2;
    let (mut positions, mut colours, mut triangles) = (vec![[0.0; 3]], vec![RED], Vec::new());
    let add_ring = |positions: &mut Vec<[f32; 3]>, colours: &mut Vec<[f32; 3]>, ring: u32, colour| {
        let first = positions.len() as u32;
        for segment in 0..segments {
            let [sin, cos] = sin_cos(f64::from(segment) / f64::from(segments));
            let radius = f64::from(ring) / f64::from(rings);
            positions.push([(radius * cos) as f32, 0.0, (-radius * sin) as f32]);
            colours.push(colour);
        }
        first
    };
    let mut inner = add_ring(&mut positions, &mut colours, 1, RED);
    for segment in 0..segments {
        triangles.push([0, inner + segment, inner + (segment + 1) % segments]);
    }
    for ring in 2..=rings {
        let colour = if ring <= edge { RED } else { WHITE };
        let outer = add_ring(&mut positions, &mut colours, ring, colour);
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            triangles.push([inner + segment, outer + segment, outer + next]);
            triangles.push([inner + segment, outer + next, inner + next]);
        }
        inner = if ring == edge { add_ring(&mut positions, &mut colours, ring, WHITE) } else { outer };
    }
    let attributes = vec![Attribute::floats(names::COLOR, &colours)];
    Mesh::from_trusted(positions, triangles, attributes, Vec::new(), Vec::new(), Vec::new())
}

const RED: [f32; 3] = [0.8, 0.1, 0.1];
const WHITE: [f32; 3] = [1.0; 3];
