//! Levels whose parts have grown to cover parts vanished beside them.
//!
//! ```text
//!     . . . .        .   .        A part that vanished is taken for a vertex of one that is left (engine/vanish.rs).
//!     . . . .   ->             ->    kin of it grow about their middles by the area they stand for, so that what is
//!     . . . .        .   .           covered, seen along each axis, stays what it was
//! ```
//!
//! How much must grow depends on how parts hide each other, so it is found by projecting: three powers, per axis, to
//! which every part's own ratio of areas is raised. The area covered along an axis depends on the powers of the two other
//! axes, so the missing area along each axis (its logarithm) determines how much each power has to change.

use glam::{DVec3, Vec3};

use crate::geometry::sets::Sets;
use crate::mesh::{Attribute, AttributeValues, Mesh, NONE, Topology, names};
use crate::sequence::CollapseSequence;

use super::parts::Shape;

/// Number of picture cells along its longer side.
const CELLS: usize = 1024;
/// Number of rounds of measuring and growing. `STEP`: share of the missing area made up for by each round.
const ROUNDS: usize = 16;
const STEP: f64 = 0.7;
/// Number of rounds without notable gain (5 %) after which the search stops.
const IDLE: usize = 4;
/// Tolerated logarithm of the missing area along each axis.
const ENOUGH: f64 = 0.005;
/// Range of the power of a part's own missing area by which it may shrink or grow along an axis.
const POWERS: [f64; 2] = [-1.0, 6.0];

/// Effect of growing on a level.
///
/// ```
/// use multires::{Simplifier, mesh::shapes};
///
/// // A forest whose trees vanish: the trees that are left grow, so that the wood stays as dense from afar.
/// let forest = shapes::forest(300, 2, 1);
/// let sequence = Simplifier::new().run(&forest)?;
/// let steps = sequence.steps_for_triangles(forest.triangles().len() / 20);
/// let (level, growth) = sequence.extract_grown(&forest, steps, 2.0);
/// assert!(level.triangles().len() <= forest.triangles().len() / 20);
/// println!("{growth:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Growth {
    /// Number of grown parts.
    pub parts: usize,
    /// Maximum distance of a moved vertex, object units: the level may lie this much farther from the input than the
    /// sequence's error.
    pub distance: f32,
    /// Covered area of the level along x, y and z, relative to the input's; 1 where the input covers nothing. Both
    /// directions along an axis cover the same area.
    pub coverage: [f64; 3],
}

impl CollapseSequence {
    /// Returns the level of detail after `steps` steps, as by [`extract`](CollapseSequence::extract), with parts grown
    /// about their middles where kin (of the same material, similar in size and direction) vanished beside them
    /// ([`Parts::Vanish`](super::Parts::Vanish)), until the covered area, seen along the axes, equals the input's. No
    /// vertex moves farther than `most`, object units. Returns the level itself where nothing has vanished.
    ///
    /// O(input + pixels).
    pub fn extract_grown(&self, mesh: &Mesh, steps: usize, most: f32) -> (Mesh, Growth) {
        self.grow(mesh, steps, self.extract(mesh, steps), most)
    }

    /// Grows the parts of a level, as by [`extract_grown`](CollapseSequence::extract_grown). The level must come from
    /// [`extract`](CollapseSequence::extract) or [`extract_fitted`](CollapseSequence::extract_fitted) for the same mesh
    /// and number of steps. A level with other triangles is returned unchanged.
    pub fn grow(&self, mesh: &Mesh, steps: usize, level: Mesh, most: f32) -> (Mesh, Growth) {
        let none = Growth { coverage: [1.0; 3], ..Growth::default() };
        if steps == 0 || !self.fits(mesh) || level.triangles().is_empty() {
            return (level, none);
        }
        if level.triangles().len() != self.triangles_after(steps) {
            return (level, none);
        }
        let parts = self.level_parts(mesh, &level, steps);
        if !parts.iter().any(|part| part.missing > 0.0) {
            return (level, none);
        }
        grow(mesh, level, &parts, f64::from(most))
    }

    /// Returns the parts of a level: their vertices, and the area vanished beside them.
    fn level_parts(&self, mesh: &Mesh, level: &Mesh, steps: usize) -> Vec<LevelPart> {
        let (of_vertex, count) = components(mesh);
        let (of_level_vertex, level_count) = components(level);
        let (shapes, level_shapes) =
            (shapes(mesh, &of_vertex, count), shapes(level, &of_level_vertex, level_count));
        // Vertices of the level by their numbers in the sequence: in order of first use.
        let (triangles, origin) = self.triangles_at(mesh, steps);
        let mut number = vec![NONE; self.vertex_count()];
        let mut used = 0;
        for &corner in triangles.as_flattened() {
            if number[corner as usize] == NONE {
                number[corner as usize] = used;
                used += 1;
            }
        }
        if used as usize != level.positions().len() {
            return Vec::new();
        }
        let mut parts: Vec<LevelPart> =
            level_shapes.iter().map(|&now| LevelPart { now, ..LevelPart::default() }).collect();
        // Find each part's source in the input; parts joined from several stay unchanged.
        let mut lives = vec![false; count];
        let mut source = vec![NONE; level_count];
        for (corners, &t) in triangles.iter().zip(&origin) {
            let from = of_vertex[mesh.triangles()[t as usize][0] as usize];
            let part = of_level_vertex[number[corners[0] as usize] as usize];
            lives[from as usize] = true;
            let source = &mut source[part as usize];
            if *source == NONE {
                *source = from;
            }
            parts[part as usize].is_joined |= *source != from;
        }
        for (part, &from) in parts.iter_mut().zip(&source).filter(|(part, _)| !part.is_joined) {
            part.missing = f64::from(shapes[from as usize].area) - f64::from(part.now.area);
        }
        let to = self.representatives(steps);
        let mut seen = lives;
        let mut grows = vec![false; level_count];
        for (vertex, &from) in of_vertex.iter().enumerate().filter(|&(_, &from)| from != NONE) {
            if std::mem::replace(&mut seen[from as usize], true) {
                continue;
            }
            let heir = number[to[vertex] as usize];
            if heir == NONE {
                continue;
            }
            let heir = of_level_vertex[heir as usize] as usize;
            let part = &mut parts[heir];
            if !part.is_joined && shapes[source[heir] as usize].is_kin(&shapes[from as usize]) {
                part.missing += f64::from(shapes[from as usize].area);
                grows[heir] = true;
            }
        }
        for (part, &grows) in parts.iter_mut().zip(&grows) {
            part.missing = if grows { part.missing.max(0.0) } else { 0.0 };
        }
        for (vertex, &part) in of_level_vertex.iter().enumerate().filter(|&(_, &part)| part != NONE) {
            parts[part as usize].vertices.push(vertex as u32);
        }
        parts
    }
}

/// A part of a level.
#[derive(Debug, Clone, Default)]
struct LevelPart {
    now: Shape,
    vertices: Vec<u32>,
    is_joined: bool,
    /// Missing area: represented by the part, but not covered by its triangles.
    missing: f64,
}

/// A level while it grows.
struct Growing<'a> {
    level: &'a Mesh,
    parts: Vec<&'a LevelPart>,
    most: f64,
}

impl Growing<'_> {
    /// Returns the factor by which a part grows along each axis.
    fn scales(&self, part: &LevelPart, powers: [f64; 3]) -> DVec3 {
        let ratio = 1.0 + part.missing / f64::from(part.now.area);
        let at = |v: &u32| Vec3::from(self.level.positions()[*v as usize]);
        let radius = part.vertices.iter().map(|v| at(v).distance(part.now.centre)).fold(0.0, f32::max);
        let room = self.most / f64::from(radius);
        let scale = |power: f64| {
            let wanted = power_of(ratio, 0.5 * power);
            if wanted.is_finite() { wanted.clamp((1.0 - room).max(0.1), 1.0 + room) } else { 1.0 }
        };
        DVec3::from(powers.map(scale))
    }

    /// Moves every vertex; returns the maximum distance moved.
    fn place(&self, powers: [f64; 3], positions: &mut [[f32; 3]]) -> f32 {
        let mut farthest: f32 = 0.0;
        for part in &self.parts {
            let scales = self.scales(part, powers);
            let centre = part.now.centre.as_dvec3();
            for &v in &part.vertices {
                let from = Vec3::from(self.level.positions()[v as usize]);
                let to = (centre + scales * (from.as_dvec3() - centre)).as_vec3();
                farthest = farthest.max(from.distance(to).next_up());
                positions[v as usize] = to.to_array();
            }
        }
        farthest
    }
}

/// Returns `x` to a power, for `x >= 1`, by squares and square roots: identical on every platform.
fn power_of(x: f64, power: f64) -> f64 {
    let (size, mut result, mut square) = (power.abs(), 1.0, x);
    let mut whole = size as u32;
    while whole > 0 {
        if whole & 1 == 1 {
            result *= square;
        }
        square *= square;
        whole >>= 1;
    }
    let (mut rest, mut root) = (size - size.floor(), x);
    for _ in 0..24 {
        root = root.sqrt();
        rest *= 2.0;
        if rest >= 1.0 {
            rest -= 1.0;
            result *= root;
        }
    }
    if power < 0.0 { 1.0 / result } else { result }
}

fn grow(mesh: &Mesh, level: Mesh, parts: &[LevelPart], most: f64) -> (Mesh, Growth) {
    let view = View::around(mesh);
    let covered = |positions: &[[f32; 3]], triangles: &[[u32; 3]]| {
        [0, 1, 2].map(|axis| view.covered(positions, triangles, axis) as f64)
    };
    let asked = covered(mesh.positions(), mesh.triangles());
    let growing = Growing {
        level: &level,
        parts: parts.iter().filter(|part| part.missing > 0.0 && part.now.area > 0.0).collect(),
        most: most.max(0.0),
    };
    // Mean effect of a power of 1 on a part's width, as a step of its logarithm; halved, which is accurate enough.
    let ratios = growing.parts.iter().map(|part| (part.missing / f64::from(part.now.area)).min(1e6));
    let mean = 1.0 + ratios.sum::<f64>() / growing.parts.len().max(1) as f64;
    let unit = 0.5 * log_of(mean).max(0.05);
    let mut positions = level.positions().to_vec();
    let (mut powers, mut best, mut idle) = ([0.0; 3], ([0.0; 3], f64::INFINITY), 0);
    for _ in 0..ROUNDS {
        growing.place(powers, &mut positions);
        let now = covered(&positions, level.triangles());
        let missing: [f64; 3] = std::array::from_fn(|axis| {
            if asked[axis] > 0.0 && now[axis] > 0.0 { log_of(asked[axis] / now[axis]) } else { 0.0 }
        });
        let worst = missing.iter().fold(0.0f64, |worst, x| worst.max(x.abs()));
        idle = if worst < 0.95 * best.1 { 0 } else { idle + 1 };
        if worst < best.1 {
            best = (powers, worst);
        }
        if worst < ENOUGH || idle == IDLE {
            break;
        }
        let sum: f64 = missing.iter().sum();
        powers = std::array::from_fn(|axis| {
            (powers[axis] + STEP * (0.5 * sum - missing[axis]) / unit).clamp(POWERS[0], POWERS[1])
        });
    }
    let distance = growing.place(best.0, &mut positions);
    let now = covered(&positions, level.triangles());
    let coverage = [0, 1, 2].map(|axis| if asked[axis] > 0.0 { now[axis] / asked[axis] } else { 1.0 });
    let growth = Growth { parts: growing.parts.len(), distance, coverage };
    let attributes = level.attributes().iter().map(|attribute| {
        let mut values = match attribute.values() {
            AttributeValues::Float(values) if attribute.width() >= 3 => values.clone(),
            _ => return attribute.clone(),
        };
        for part in &growing.parts {
            let scales = growing.scales(part, best.0);
            // Normals scale inversely to tangents.
            let turn = match attribute.name() {
                names::NORMAL => 1.0 / scales,
                names::TANGENT => scales,
                _ => continue,
            };
            for &v in &part.vertices {
                let at = v as usize * attribute.width();
                let value = &mut values[at..at + 3];
                let d = DVec3::new(f64::from(value[0]), f64::from(value[1]), f64::from(value[2]));
                let turned = (turn * d).normalize_or_zero();
                if turned != DVec3::ZERO {
                    value.copy_from_slice(&turned.as_vec3().to_array());
                }
            }
        }
        Attribute::new(attribute.name(), attribute.width(), AttributeValues::Float(values))
    });
    let attributes = attributes.collect();
    if !positions.as_flattened().iter().all(|x| x.is_finite()) {
        return (level, Growth { coverage: [1.0; 3], ..Growth::default() });
    }
    let grown = Mesh::from_trusted(
        positions,
        level.triangles().to_vec(),
        attributes,
        level.materials().to_vec(),
        level.material_names().to_vec(),
        level.locks().to_vec(),
    )
    .at_origin_of(&level);
    (grown, growth)
}

/// Returns the natural logarithm to a few digits, by square roots and a fraction: identical on every platform.
fn log_of(x: f64) -> f64 {
    let (mut root, mut times) = (x, 1.0);
    for _ in 0..5 {
        root = root.sqrt();
        times *= 2.0;
    }
    // The first term of the series in (x - 1) / (x + 1), near 1.
    2.0 * times * (root - 1.0) / (root + 1.0)
}

/// Returns, per vertex, its part (`NONE` where no triangle uses it), and the number of parts. Vertices at the same
/// position belong to the same part.
fn components(mesh: &Mesh) -> (Vec<u32>, usize) {
    let topology = Topology::new(mesh);
    let point_of = topology.point_of();
    let mut parts = Sets::new(topology.point_count());
    let mut used = vec![false; parts.len()];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|v| point_of[v as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        for other in [a, b, c] {
            used[other as usize] = true;
            parts.join(a, other);
        }
    }
    let mut number = vec![NONE; parts.len()];
    let mut count = 0;
    for point in 0..parts.len() as u32 {
        if used[point as usize] && parts.find(point) == point {
            number[point as usize] = count;
            count += 1;
        }
    }
    let of = |&point: &u32| if used[point as usize] { number[parts.find(point) as usize] } else { NONE };
    (point_of.iter().map(of).collect(), count as usize)
}

/// Returns the shape of each part, object units.
fn shapes(mesh: &Mesh, of_vertex: &[u32], count: usize) -> Vec<Shape> {
    let mut sums = vec![(0.0, DVec3::ZERO, DVec3::ZERO, NONE); count];
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let part = of_vertex[corners[0] as usize];
        if part == NONE {
            continue;
        }
        let [p, q, r] = corners.map(|v| Vec3::from(mesh.positions()[v as usize]).as_dvec3());
        let vector = 0.5 * (q - p).cross(r - p);
        let (area, centre, direction, material) = &mut sums[part as usize];
        *area += vector.length();
        *centre += vector.length() * (p + q + r) / 3.0;
        *direction += vector;
        if *material == NONE {
            *material = mesh.materials().get(t).copied().unwrap_or(0);
        }
    }
    let shape = |&(area, centre, direction, material): &(f64, DVec3, DVec3, u32)| Shape {
        area: area as f32,
        centre: (centre / area).as_vec3(),
        spread: 0.0,
        direction: direction.as_vec3(),
        material,
    };
    sums.iter().map(shape).collect()
}

/// A picture of cells onto which triangles are projected along an axis.
struct View {
    low: [f64; 3],
    cell: f64,
    cells: [usize; 3],
}

impl View {
    /// Creates a view of a mesh with a margin around it.
    fn around(mesh: &Mesh) -> Self {
        let [low, high] = mesh.bounds().unwrap_or([[0.0; 3]; 2]).map(|p| p.map(f64::from));
        let side = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        let cell = if side > 0.0 { 1.125 * side / CELLS as f64 } else { 1.0 };
        let room = 0.0625 * side;
        Self {
            low: low.map(|x| x - room),
            cell,
            cells: std::array::from_fn(|i| {
                (((high[i] - low[i] + 2.0 * room) / cell) as usize).clamp(1, CELLS)
            }),
        }
    }

    /// Counts the cells whose middle a triangle covers, seen along an axis.
    fn covered(&self, positions: &[[f32; 3]], triangles: &[[u32; 3]], axis: usize) -> usize {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let (width, height) = (self.cells[u], self.cells[v]);
        let mut cells = vec![0u8; width * height];
        let at = |vertex: u32| {
            let p = positions[vertex as usize];
            [u, v].map(|i| (f64::from(p[i]) - self.low[i]) / self.cell - 0.5)
        };
        for corners in triangles {
            let [a, b, c] = corners.map(at);
            let turn = |p: [f64; 2], q: [f64; 2], x: [f64; 2]| {
                (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])
            };
            let area = turn(a, b, c);
            if area == 0.0 || !area.is_finite() {
                continue;
            }
            let low = ceil(a[1].min(b[1]).min(c[1])).max(0);
            let high = floor(a[1].max(b[1]).max(c[1])).min(height as i64 - 1);
            // A rising edge bounds rows from one side, a falling edge from the other.
            let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                let rise = (q[1] - p[1]) * area.signum();
                (p, rise, if rise == 0.0 { 0.0 } else { (q[0] - p[0]) / (q[1] - p[1]) })
            });
            for y in low..=high {
                let (mut from, mut to) = (0, width as i64 - 1);
                for &(p, rise, slope) in &edges {
                    let x = p[0] + (y as f64 - p[1]) * slope;
                    if rise < 0.0 {
                        from = from.max(ceil(x));
                    } else if rise > 0.0 {
                        to = to.min(floor(x));
                    }
                }
                if from <= to {
                    let row = y as usize * width;
                    cells[row + from as usize..=row + to as usize].fill(1);
                }
            }
        }
        // Sum in runs whose sum fits in a byte.
        let sum = |run: &[u8]| usize::from(run.iter().sum::<u8>());
        cells.chunks(255).map(sum).sum()
    }
}

/// Returns the least integer not below `x`. An almost horizontal edge reaches far beyond all integers.
fn ceil(x: f64) -> i64 {
    let whole = x as i64;
    whole.saturating_add(i64::from((whole as f64) < x))
}

/// Returns the largest integer not above `x`.
fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole.saturating_sub(i64::from(whole as f64 > x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_beyond_all_are_the_last() {
        assert_eq!([0.5, -0.5, 2.0, 1e300, f64::INFINITY].map(ceil), [1, 0, 2, i64::MAX, i64::MAX]);
        assert_eq!([0.5, -0.5, 2.0, -1e300, f64::NEG_INFINITY].map(floor), [0, -1, 2, i64::MIN, i64::MIN]);
    }
}
