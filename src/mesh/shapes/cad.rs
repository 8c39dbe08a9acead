//! Machine parts: flat faces, sharp rims, few vertices; closed unless stated otherwise.
//!
//! ```text
//!     plate_with_hole     washer       stepped_shaft        gear        pocketed_block     extruded outlines
//!       .--------.        .--.          .--.                _   _        .---------.        .---.  .-.
//!      /   .--.   \      / __ \     .--.|  |.--.          .' '-' '.      | .-. .-. |        | .-' | O |
//!     |   ( hole)  |    | (__) |    |  ||  ||  |           )  O  (       | '-' '-' |        | '-. '---'
//!      \   '--'   /      \    /     '--'|  |'--'          '._.-._.'      '---------'        '---'
//!       '--------'        '--'          '--'
//! ```
//!
//! Flat faces are filled from corner to corner (holes bridged, ears clipped), as modellers do. Triangles are large and
//! thin, and triangles at a rim vertex reach far into a flat face.

use super::super::{Attribute, Mesh, names};
use super::noise::{sin_cos, unit};
use super::{bare, length_or};

/// A closed line in a plane.
type Outline = Vec<[f64; 2]>;

/// Maximum number of sides of a circle: filling a face takes cubic time.
const MOST_SIDES: u32 = 512;

fn sides(count: u32) -> u32 {
    count.clamp(3, MOST_SIDES)
}

/// A regular polygon around `centre`.
fn circle(centre: [f64; 2], radius: f64, sides: u32) -> Outline {
    let point = |i: u32| {
        let [sin, cos] = sin_cos(f64::from(i) / f64::from(sides));
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..sides).map(point).collect()
}

fn rectangle([left, low]: [f64; 2], [right, high]: [f64; 2]) -> Outline {
    vec![[left, low], [right, low], [right, high], [left, high]]
}

fn turned(mut outline: Outline) -> Outline {
    outline.reverse();
    outline
}

/// A square plate from -1 to 1, `thickness` thick, with a round hole of `sides` sides and radius 0.5 in its middle.
/// Thickness 0 makes an open sheet; a thickness outside 1e-18 to 1e18 counts as 0.25.
///
/// 3 to 512 sides. O(sides^3).
pub fn plate_with_hole(sides: u32, thickness: f32) -> Mesh {
    let hole = turned(circle([0.0; 2], 0.5, self::sides(sides)));
    part(&[rectangle([-1.0; 2], [1.0; 2]), hole], thickness)
}

/// A flat ring of outer radius 1 and `inner` radius (between 0 and 1; 0.5 otherwise), `thickness` thick. Thickness 0
/// makes an open sheet; a thickness outside 1e-18 to 1e18 counts as 0.25.
///
/// 3 to 512 sides. O(sides^3).
pub fn washer(sides: u32, inner: f32, thickness: f32) -> Mesh {
    let (sides, inner) = (self::sides(sides), if inner > 0.0 && inner < 1.0 { inner } else { 0.5 });
    part(&[circle([0.0; 2], 1.0, sides), turned(circle([0.0; 2], f64::from(inner), sides))], thickness)
}

/// A spur gear of `teeth` teeth and outer radius 1.005 with a round bore of radius 0.3, `thickness` thick. Thickness 0
/// makes an open sheet; a thickness outside 1e-18 to 1e18 counts as 0.25.
///
/// 3 to 64 teeth. O(teeth^3).
pub fn gear(teeth: u32, thickness: f32) -> Mesh {
    let teeth = teeth.clamp(3, 64);
    let mut outline = Vec::new();
    for tooth in 0..teeth {
        // Root, flank, tip, flank.
        for (share, radius) in [(0.0, 0.8), (0.3, 0.8), (0.42, 1.0), (0.5, 1.005), (0.58, 1.0), (0.7, 0.8)] {
            let [sin, cos] = sin_cos((f64::from(tooth) + share) / f64::from(teeth));
            outline.push([radius * cos, radius * sin]);
        }
    }
    part(&[outline, turned(circle([0.0; 2], 0.3, 2 * teeth + 8))], thickness)
}

/// Extruded capitals: `count` outlines picked by `seed`, some with holes, each a separate part, 1 high and `thickness`
/// thick. Thickness 0 makes open sheets; a thickness outside 1e-18 to 1e18 counts as 0.25.
///
/// 1 to 64 letters. O(count).
pub fn lettering(count: u32, seed: u32, thickness: f32) -> Mesh {
    let mut mesh = Builder::default();
    for letter in 0..count.clamp(1, 64) {
        let left = 1.1 * f64::from(letter);
        let moved = |outline: Outline| -> Outline { outline.iter().map(|&[x, y]| [x + left, y]).collect() };
        let outlines: Vec<Outline> =
            letter_outlines((unit(letter, seed) * 5.0) as u32).into_iter().map(moved).collect();
        mesh.extrude(&outlines, thickness_of(thickness));
    }
    mesh.finish()
}

/// Outlines of C, D with a hole, E, L and O, by number.
fn letter_outlines(which: u32) -> Vec<Outline> {
    let arc = |radius: f64, from: f64, to: f64, steps: u32| -> Outline {
        let point = |i: u32| {
            let [sin, cos] = sin_cos(from + (to - from) * f64::from(i) / f64::from(steps));
            [0.5 + radius * cos, 0.5 + radius * sin]
        };
        (0..=steps).map(point).collect()
    };
    match which {
        0 => {
            let mut bow = arc(0.5, 0.125, 0.875, 18);
            bow.extend(turned(arc(0.3, 0.125, 0.875, 14)));
            vec![bow]
        }
        1 => {
            let mut outer = arc(0.5, -0.25, 0.25, 14);
            outer.extend([[0.0, 1.0], [0.0, 0.0]]);
            let mut inner = arc(0.3, -0.25, 0.25, 10);
            inner.extend([[0.2, 0.8], [0.2, 0.2]]);
            vec![outer, turned(inner)]
        }
        2 => vec![vec![
            [0.0, 0.0],
            [0.8, 0.0],
            [0.8, 0.2],
            [0.2, 0.2],
            [0.2, 0.4],
            [0.6, 0.4],
            [0.6, 0.6],
            [0.2, 0.6],
            [0.2, 0.8],
            [0.8, 0.8],
            [0.8, 1.0],
            [0.0, 1.0],
        ]],
        3 => vec![vec![[0.0, 0.0], [0.7, 0.0], [0.7, 0.2], [0.2, 0.2], [0.2, 1.0], [0.0, 1.0]]],
        _ => vec![circle([0.5; 2], 0.5, 28), turned(circle([0.5; 2], 0.3, 20))],
    }
}

/// A turned shaft along y: `steps` cylinders of different radii on top of each other, `sides` sides each.
///
/// 1 to 64 steps, 3 to 512 sides. O(steps sides + sides^3).
pub fn stepped_shaft(steps: u32, sides: u32, seed: u32) -> Mesh {
    let (steps, sides) = (steps.clamp(1, 64), self::sides(sides));
    // A wide step follows a narrow one.
    let radius = |step: u32| 0.25 + 0.25 * f64::from(unit(step, seed)) + 0.4 * f64::from(step % 2);
    let mut mesh = Builder::default();
    let mut rings = Vec::new();
    let mut height = 0.0;
    for step in 0..steps {
        let top = height + 0.2 + 0.8 * f64::from(unit(100 + step, seed));
        for y in [height, top] {
            rings.push(mesh.ring(&circle([0.0; 2], radius(step), sides), |[x, z]| [x, y, -z]));
        }
        height = top;
    }
    for pair in rings.windows(2) {
        mesh.band(&pair[0], &pair[1]);
    }
    let cap = circle([0.0; 2], 1.0, sides);
    let (bottom, top) = (rings[0].clone(), rings[rings.len() - 1].clone());
    mesh.fill(std::slice::from_ref(&cap), &bottom, true);
    mesh.fill(&[cap], &top, false);
    mesh.finish()
}

/// A box from -1 to 1 along x and z, 0.5 high, with boxes cut out of it: a pattern of `n` by `n` pockets of different
/// depths, some of them through holes.
///
/// `n`: 1 to 64. O(n^2).
pub fn pocketed_block(n: u32, seed: u32) -> Mesh {
    let n = n.clamp(1, 64);
    let cells = 2 * n + 1;
    // Walls and pockets of different widths.
    let lines: Vec<f64> = (0..=cells)
        .scan(0.0, |sum, i| {
            let at = *sum;
            *sum += 0.4 + 0.6 * f64::from(unit(i, seed));
            Some(at)
        })
        .collect();
    let all = lines[cells as usize];
    let place = |i: u32| 2.0 * lines[i as usize] / all - 1.0;
    const HIGH: f64 = 0.5;
    // Height of a cell's surface: the top, or a pocket's floor. `None` outside the block and in through holes.
    let floor = |column: i64, row: i64| -> Option<f64> {
        let inside = |x: i64| (0..i64::from(cells)).contains(&x);
        if !(inside(column) && inside(row)) {
            return None;
        }
        if column % 2 == 0 || row % 2 == 0 {
            return Some(HIGH);
        }
        let chance = unit((row * 200 + column) as u32, seed ^ 0x5eed);
        if chance < 0.3 { None } else { Some(HIGH * f64::from(chance)) }
    };
    let mut mesh = Builder::default();
    let corner = |i: u32, y: f64, j: u32| [place(i), y, -place(j)];
    for row in 0..cells {
        for column in 0..cells {
            let (c, r) = (i64::from(column), i64::from(row));
            let Some(height) = floor(c, r) else { continue };
            let ends = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
            mesh.quad(ends.map(|(i, j)| corner(i, height, j)));
            mesh.quad([0, 3, 2, 1].map(|k: usize| corner(ends[k].0, 0.0, ends[k].1)));
            // A wall to each lower neighbour, facing it.
            for (side, (dc, dr)) in [(0, -1), (1, 0), (0, 1), (-1, 0)].into_iter().enumerate() {
                let below = floor(c + dc, r + dr);
                if below.is_none_or(|below| below < height) {
                    let [(i, j), (k, l)] = [ends[side], ends[(side + 1) % 4]];
                    let low = below.unwrap_or(0.0);
                    mesh.quad([
                        corner(i, low, j),
                        corner(k, low, l),
                        corner(k, height, l),
                        corner(i, height, j),
                    ]);
                }
            }
        }
    }
    mesh.finish()
}

/// A flat open ring, radii 0.5 and 1, of `sides` by `rows` cells. Four ramps in it rise to a height of 0.5.
///
/// 8 to 512 sides, 1 to 64 rows. O(sides rows).
pub fn ring_with_ramps(sides: u32, rows: u32) -> Mesh {
    let (sides, rows) = (sides.clamp(8, MOST_SIDES), rows.clamp(1, 64));
    let mut mesh = Builder::default();
    let rings: Vec<Vec<u32>> = (0..=rows)
        .map(|row| {
            let radius = 1.0 - 0.5 * f64::from(row) / f64::from(rows);
            let mut side = 0;
            mesh.ring(&circle([0.0; 2], radius, sides), |[x, z]| {
                let share = 4.0 * f64::from(side) / f64::from(sides);
                side += 1;
                // Up and down within the middle quarter of each quarter turn.
                let up = (8.0 * (share - share.floor() - 0.5)).abs();
                [x, 0.5 * (1.0 - up).max(0.0), -z]
            })
        })
        .collect();
    rings.windows(2).for_each(|pair| mesh.band(&pair[0], &pair[1]));
    mesh.finish()
}

/// A flat square sheet from -1 to 1 at y = 0 of two materials: "plate", and in its middle a round "island" of `sides`
/// sides and `radius` (between 0 and 1; 0.3 otherwise).
///
/// 3 to 512 sides. O(sides^3).
pub fn two_material_plate(sides: u32, radius: f32) -> Mesh {
    let (mesh, inside) = plate_with_island(sides, radius, false);
    let materials = (0..mesh.triangles().len()).map(|t| u32::from(t >= inside)).collect();
    let (positions, triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    let names = ["plate", "island"].map(str::to_owned).to_vec();
    Mesh::from_trusted(positions, triangles, Vec::new(), materials, names, Vec::new())
}

/// The sheet of [`two_material_plate`] without materials, with texture coordinates in two charts: a seam around the
/// island.
///
/// 3 to 512 sides. O(sides^3).
pub fn plate_with_seam_island(sides: u32, radius: f32) -> Mesh {
    let (mesh, inside) = plate_with_island(sides, radius, true);
    let mut uv: Vec<[f32; 2]> =
        mesh.positions().iter().map(|p| [0.5 + 0.5 * p[0], 0.5 - 0.5 * p[2]]).collect();
    // The island has separate vertices, numbered after the plate's vertices.
    let first = mesh.triangles()[inside..].as_flattened().iter().copied().min().unwrap_or(0);
    uv[first as usize..].iter_mut().for_each(|uv| uv[0] += 2.0);
    let (positions, triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    let uv = vec![Attribute::floats(names::UV, &uv)];
    Mesh::from_trusted(positions, triangles, uv, Vec::new(), Vec::new(), Vec::new())
}

/// Returns the sheet and the number of the island's first triangle. With `apart` the island has separate vertices.
fn plate_with_island(sides: u32, radius: f32, apart: bool) -> (Mesh, usize) {
    let radius = f64::from(if radius > 0.0 && radius < 1.0 { radius } else { 0.3 });
    let island = circle([0.0; 2], radius, self::sides(sides));
    let outlines = [rectangle([-1.0; 2], [1.0; 2]), turned(island.clone())];
    let mut mesh = Builder::default();
    let flat = |[x, z]: [f64; 2]| [x, 0.0, -z];
    let all = mesh.ring(&outlines.concat(), flat);
    mesh.fill(&outlines, &all, false);
    let inside = mesh.triangles.len();
    let rim: Vec<u32> = if apart {
        mesh.ring(&island, flat)
    } else {
        all[outlines[0].len()..].iter().rev().copied().collect()
    };
    mesh.fill(&[island], &rim, false);
    (bare(mesh.positions, mesh.triangles), inside)
}

/// A part by number: `seed % 8` picks the kind, `seed` its dimensions. Some parts are subdivided ([`cut_in_four`]).
///
/// Fewer than 20,000 triangles.
pub fn cad_part(seed: u32) -> Mesh {
    let share = |index: u32| unit(index, seed);
    let between = |index: u32, low: u32, high: u32| low + (share(index) * (high - low + 1) as f32) as u32;
    let thickness = 0.05 + 0.6 * share(1);
    let sides = between(2, 10, 64);
    let mesh = match seed % 8 {
        0 => plate_with_hole(sides, thickness),
        1 => washer(sides, 0.2 + 0.6 * share(3), if share(4) < 0.5 { 0.0 } else { thickness }),
        2 => stepped_shaft(between(3, 1, 6), sides, seed),
        3 => gear(between(3, 8, 32), thickness),
        4 => lettering(between(3, 1, 6), seed, thickness),
        5 => pocketed_block(between(3, 1, 6), seed),
        6 => ring_with_ramps(8 * between(3, 2, 16), between(4, 1, 8)),
        _ => two_material_plate(sides, 0.1 + 0.7 * share(3)),
    };
    let times = if mesh.triangles().len() > 1200 { 0 } else { between(5, 0, 2) };
    (0..times).fold(mesh, |mesh, _| cut_in_four(&mesh))
}

/// Cuts every triangle in four at its edge midpoints: an equal surface up to rounding, with redundant vertices. Drops
/// triangles naming a vertex twice. Keeps materials, not attributes.
pub fn cut_in_four(mesh: &Mesh) -> Mesh {
    let mut positions = mesh.positions().to_vec();
    let edges = super::super::Edges::new(mesh.triangles(), positions.len());
    let first = positions.len() as u32;
    for &[a, b] in edges.ends() {
        let [p, q] = [a, b].map(|v| mesh.positions()[v as usize].map(f64::from));
        positions.push(std::array::from_fn(|i| (0.5 * (p[i] + q[i])) as f32));
    }
    let middle = |a: u32, b: u32| {
        let ends = [a.min(b), a.max(b)];
        first + edges.ends().partition_point(|&other| other < ends) as u32
    };
    let (mut triangles, mut materials) = (Vec::new(), Vec::new());
    for (t, &[a, b, c]) in mesh.triangles().iter().enumerate() {
        if a == b || b == c || c == a {
            continue;
        }
        let [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        if let Some(&material) = mesh.materials().get(t) {
            materials.extend([material; 4]);
        }
    }
    Mesh::from_trusted(
        positions,
        triangles,
        Vec::new(),
        materials,
        mesh.material_names().to_vec(),
        Vec::new(),
    )
}

fn thickness_of(thickness: f32) -> f64 {
    if thickness == 0.0 { 0.0 } else { length_or(thickness, 0.25) }
}

fn part(outlines: &[Outline], thickness: f32) -> Mesh {
    let mut mesh = Builder::default();
    mesh.extrude(outlines, thickness_of(thickness));
    mesh.finish()
}

/// A mesh under construction. Equal positions are welded at the end.
#[derive(Default)]
struct Builder {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    /// Adds a vertex per point of a line, lifted to space.
    fn ring(&mut self, outline: &[[f64; 2]], mut lift: impl FnMut([f64; 2]) -> [f64; 3]) -> Vec<u32> {
        let first = self.positions.len() as u32;
        // Adding zero turns a negative zero into a positive one.
        self.positions.extend(outline.iter().map(|&p| lift(p).map(|x| x as f32 + 0.0)));
        (first..self.positions.len() as u32).collect()
    }

    /// Adds quads between two closed lines of equal length.
    fn band(&mut self, low: &[u32], high: &[u32]) {
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            self.triangles.extend([[low[i], low[j], high[j]], [low[i], high[j], high[i]]]);
        }
    }

    fn quad(&mut self, corners: [[f64; 3]; 4]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners.map(|p| p.map(|x| x as f32 + 0.0)));
        self.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }

    /// Fills a face between outlines (outer outline counter-clockwise, holes clockwise). `vertices` holds the vertex of
    /// each point.
    fn fill(&mut self, outlines: &[Outline], vertices: &[u32], back: bool) {
        for [a, b, c] in fill(outlines) {
            let [a, b, c] = [a, b, c].map(|i| vertices[i as usize]);
            self.triangles.push(if back { [a, c, b] } else { [a, b, c] });
        }
    }

    /// Adds the area enclosed by outlines: a sheet at y = 0, or a solid from y = 0 to `thickness`.
    fn extrude(&mut self, outlines: &[Outline], thickness: f64) {
        let all = outlines.concat();
        let top = self.ring(&all, |[x, z]| [x, thickness, -z]);
        self.fill(outlines, &top, false);
        if thickness > 0.0 {
            let bottom = self.ring(&all, |[x, z]| [x, 0.0, -z]);
            self.fill(outlines, &bottom, true);
            let mut first = 0;
            for outline in outlines {
                let range = first..first + outline.len();
                self.band(&bottom[range.clone()], &top[range]);
                first += outline.len();
            }
        }
    }

    fn finish(self) -> Mesh {
        let topology = super::super::Topology::new(&bare(self.positions.clone(), self.triangles.clone()));
        let point_of = topology.point_of();
        if topology.point_count() == self.positions.len() {
            return bare(self.positions, self.triangles);
        }
        let position = |&v: &u32| self.positions[v as usize];
        let positions = topology.vertex_of_point().iter().map(position).collect();
        let triangles = self.triangles.iter().map(|t| t.map(|v| point_of[v as usize])).collect();
        bare(positions, triangles)
    }
}

/// Twice the signed area of a triangle.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Triangulates the area between outlines, whose points are numbered consecutively. Joins every hole to its
/// surroundings by a bridge crossing nothing, then cuts off the ears with the shortest diagonal first.
fn fill(outlines: &[Outline]) -> Vec<[u32; 3]> {
    let points = outlines.concat();
    let at = |i: u32| points[i as usize];
    let mut first = outlines[0].len() as u32;
    let mut line: Vec<u32> = (0..first).collect();
    let mut holes: Vec<Vec<u32>> = Vec::new();
    for outline in &outlines[1..] {
        let last = first + outline.len() as u32;
        holes.push((first..last).collect());
        first = last;
    }
    while !holes.is_empty() {
        // The shortest bridge to any hole.
        let mut best: Option<(f64, usize, usize, usize)> = None;
        for (h, hole) in holes.iter().enumerate() {
            for (i, &p) in hole.iter().enumerate() {
                for (j, &q) in line.iter().enumerate() {
                    let [a, b] = [at(p), at(q)];
                    let length = (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
                    if best.is_none_or(|best| length < best.0) {
                        best = Some((length, h, i, j));
                    }
                }
            }
        }
        // The shortest bridge between two lines without contact crosses neither.
        let Some((_, h, i, j)) = best else { break };
        let mut hole = holes.remove(h);
        hole.rotate_left(i);
        let (start, end) = (hole[0], line[j]);
        line.splice(j + 1..j + 1, hole.into_iter().chain([start, end]));
    }
    let mut triangles = Vec::with_capacity(line.len());
    while line.len() > 3 {
        let n = line.len();
        let ear = |i: usize| -> Option<f64> {
            let [a, b, c] = [line[(i + n - 1) % n], line[i], line[(i + 1) % n]].map(at);
            if turn(a, b, c) <= 0.0 {
                return None;
            }
            let holds = |&p: &u32| {
                let p = at(p);
                p != a
                    && p != b
                    && p != c
                    && turn(a, b, p) >= 0.0
                    && turn(b, c, p) >= 0.0
                    && turn(c, a, p) >= 0.0
            };
            if line.iter().any(holds) {
                return None;
            }
            Some((a[0] - c[0]) * (a[0] - c[0]) + (a[1] - c[1]) * (a[1] - c[1]))
        };
        let ears = (0..n).filter_map(|i| Some((ear(i)?, i)));
        let Some((_, i)) = ears.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) else { break };
        triangles.push([line[(i + n - 1) % n], line[i], line[(i + 1) % n]]);
        line.remove(i);
    }
    if line.len() == 3 {
        triangles.push([line[0], line[1], line[2]]);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::super::super::Edges;
    use super::*;

    /// Area of a mesh.
    fn area(mesh: &Mesh) -> f64 {
        let corner = |v: u32| glam::DVec3::from(mesh.positions()[v as usize].map(f64::from));
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            0.5 * (b - a).cross(c - a).length()
        };
        mesh.triangles().iter().map(area).sum()
    }

    #[test]
    fn faces_are_filled_to_the_rim() {
        let hole = |sides: u32| {
            let [sin, _] = sin_cos(1.0 / f64::from(sides));
            0.5 * f64::from(sides) * sin
        };
        for sides in [3, 4, 7, 32, 100] {
            let plate = plate_with_hole(sides, 0.0);
            assert_eq!(plate.triangles().len() as u32, sides + 4);
            assert!((area(&plate) - (4.0 - 0.25 * hole(sides))).abs() < 1e-5, "{sides}");
            let washer = washer(sides, 0.4, 0.0);
            assert!((area(&washer) - 0.84 * hole(sides)).abs() < 1e-5, "{sides}");
        }
    }

    #[test]
    fn parts_are_closed_and_oriented() {
        for seed in 0..80 {
            let mesh = cad_part(seed);
            assert!(mesh.triangles().len() < 20_000, "{seed}: {}", mesh.triangles().len());
            let edges = Edges::new(mesh.triangles(), mesh.positions().len());
            let open = seed % 8 == 6 || seed % 8 == 7 || seed % 8 == 1;
            let mut borders = 0;
            for edge in 0..edges.len() as u32 {
                let [forward, backward] = [edges.forward(edge).len(), edges.backward(edge).len()];
                assert!(forward <= 1 && backward <= 1, "{seed}");
                borders += usize::from(forward + backward == 1);
            }
            assert!(open || borders == 0, "{seed}: {borders}");
            assert_eq!(mesh, cad_part(seed));
        }
    }
}
