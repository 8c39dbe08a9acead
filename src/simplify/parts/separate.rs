//! The parts of a surface (points joined by triangles): the shape of each part, and the part it was joined into.
//!
//! ```text
//!     part      a leaf, a pebble, a strut ...: its points and triangles, area, size and direction, all of the input
//!     debt      what vanished parts cost that now count as the part beside them
//! ```
//!
//! A part simplified down to a remnant vanishes as a whole (`engine/vanish.rs`). The loss is measured like other costs,
//! as an integral of squared distance over area: `area * max(spread, distance^2) + debt`, where `spread` is the mean
//! squared distance of the part from its centre, `distance` the distance of its centre from the nearest remaining
//! surface, and `debt` the losses of parts that vanished beside it before. The debt thins out a forest evenly.

use glam::Vec3;

use crate::geometry::{lists::Lists, sets::Sets};
use crate::mesh::NONE;
use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;

use super::near::Near;

/// Least cosine between the directions of kindred parts, and largest ratio of their areas.
const KIN_COSINE: f32 = 0.5;
const KIN_AREA: f32 = 4.0;
/// A part has no direction if its area vectors add up to at most this share of its area.
const NO_DIRECTION: f32 = 0.2;

/// Shape of a part in the input, inner units.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shape {
    pub area: f32,
    pub centre: Vec3,
    /// Mean squared distance of the surface from its centre.
    pub spread: f32,
    /// Sum of the area vectors.
    pub direction: Vec3,
    /// Material of the first triangle.
    pub material: u32,
}

impl Shape {
    /// Whether the part has a main direction: a card rather than a pebble.
    pub fn is_flat(&self) -> bool {
        self.direction.length() > NO_DIRECTION * self.area
    }

    /// Whether two parts look alike: equal material, similar size and direction.
    pub fn is_kin(&self, other: &Self) -> bool {
        let (small, large) = (self.area.min(other.area), self.area.max(other.area));
        let along = match (self.is_flat(), other.is_flat()) {
            (true, true) => {
                let dot = self.direction.dot(other.direction).abs();
                dot >= KIN_COSINE * self.direction.length() * other.direction.length()
            }
            (a, b) => a == b,
        };
        self.material == other.material && large <= KIN_AREA * small && along
    }

    /// Returns the shape of two parts together.
    fn join(&self, other: &Self) -> Self {
        let area = self.area + other.area;
        let share = if area > 0.0 { other.area / area } else { 0.5 };
        let centre = self.centre.lerp(other.centre, share);
        let spread = |shape: &Self| shape.spread + shape.centre.distance_squared(centre);
        Self {
            area,
            centre,
            spread: spread(self) * (1.0 - share) + spread(other) * share,
            direction: self.direction + other.direction,
            material: self.material,
        }
    }
}

/// The parts of a surface.
#[derive(Debug, Clone)]
pub(crate) struct Parts {
    /// Per point its part in the input; `NONE` if no triangle uses the point.
    first: Vec<u32>,
    /// Per input triangle its part; `NONE` if `surface.triangle` is `None` at the start.
    of_triangle: Vec<u32>,
    /// Union-find with chains: per part the part it was joined into (or itself), the next part in the chain of joined
    /// parts, the last part of the chain, and the number of points.
    joined: Vec<u32>,
    next: Vec<u32>,
    last: Vec<u32>,
    size: Vec<u32>,
    /// Start of each part's points; length parts + 1.
    start: Vec<u32>,
    points: Vec<u32>,
    /// Per part its remaining triangles.
    live: Vec<u32>,
    /// `shapes`: per part the shape of everything it stands for. `looks`: per part its shape in the input.
    shapes: Vec<Shape>,
    looks: Vec<Shape>,
    /// Per part the losses of parts that vanished beside it: area times squared distance.
    debt: Vec<f32>,
    /// Area of all parts in the input.
    area: f32,
    /// Whether a part was joined with other parts.
    is_joined: Vec<bool>,
    any_joined: bool,
    /// Whether a part was found unable to vanish.
    stays: Vec<bool>,
    /// Per point the point it was merged into, or itself.
    into: Vec<u32>,
    near: Near,
    left: usize,
    scratch: Vec<u32>,
}

impl Parts {
    /// Finds the parts of a surface; `None` if there are fewer than two. O(n); with two or more parts O(n log n).
    pub fn new(surface: &WorkingSurface) -> Option<Self> {
        let points = surface.point_count();
        let (first, count) = components(surface)?;
        let mut live = vec![0u32; count];
        let mut shapes = vec![Shape { material: NONE, ..Shape::default() }; count];
        // First areas and centres, then the spread of the surface about the centres.
        let triangles = || {
            (0..surface.triangle_count() as u32).filter_map(|t| {
                let corners = surface.triangle(t)?;
                let [p, q, r] = corners.map(|v| surface.at(v));
                Some((t, first[corners[0] as usize] as usize, [p, q, r], 0.5 * (q - p).cross(r - p)))
            })
        };
        for (t, part, [p, q, r], vector) in triangles() {
            let shape = &mut shapes[part];
            live[part] += 1 + surface.followers(t).len() as u32;
            shape.area += vector.length();
            shape.direction += vector;
            shape.centre += vector.length() * (p + q + r) / 3.0;
            if shape.material == NONE {
                shape.material = surface.material(t);
            }
        }
        for shape in &mut shapes {
            shape.centre /= shape.area;
        }
        let points_of =
            (0..).zip(&first).filter(|&(_, &part)| part != NONE).map(|(point, &part)| (part, point));
        let Lists { start, items: list } = Lists::from_pairs(count, points_of);
        for part in 0..count {
            // Without an area: the mean of the part's points.
            let points = &list[start[part] as usize..start[part + 1] as usize];
            let shape = &mut shapes[part];
            if !shape.centre.is_finite() {
                let sum: Vec3 = points.iter().map(|&p| surface.at(p)).sum();
                shape.centre = sum / points.len().max(1) as f32;
            }
        }
        for (_, part, corners, vector) in triangles() {
            let shape = &mut shapes[part];
            let squares: f32 = corners.iter().map(|p| p.distance_squared(shape.centre)).sum();
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            // The mean squared distance over a triangle, from its corners and its middle.
            let mean = (squares + 9.0 * middle.distance_squared(shape.centre)) / 12.0;
            shape.spread += if shape.area > 0.0 { mean * vector.length() / shape.area } else { 0.0 };
        }
        let of_triangle = (0..surface.triangle_count() as u32)
            .map(|t| surface.triangle(t).map_or(NONE, |corners| first[corners[0] as usize]))
            .collect();
        let near =
            Near::new(list.iter().map(|&p| (surface.at(p), p)).collect(), points, |p| first[p as usize]);
        Some(Self {
            of_triangle,
            joined: (0..count as u32).collect(),
            size: (0..count).map(|part| start[part + 1] - start[part]).collect(),
            next: vec![NONE; count],
            last: (0..count as u32).collect(),
            start: start.into_vec(),
            points: list.into_vec(),
            live,
            area: shapes.iter().map(|shape| shape.area).sum(),
            looks: shapes.clone(),
            shapes,
            debt: vec![0.0; count],
            is_joined: vec![false; count],
            any_joined: false,
            stays: vec![false; count],
            into: (0..points as u32).collect(),
            near,
            left: count,
            scratch: Vec::new(),
            first,
        })
    }

    /// Number of parts in the input.
    pub fn count(&self) -> usize {
        self.joined.len()
    }

    /// Number of parts with remaining triangles; joined parts count once.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Returns the part that `part` was joined into, or `part` itself.
    pub fn root(&self, part: u32) -> u32 {
        root(&self.joined, part)
    }

    /// Returns the part of a point. The point must have a triangle in the input.
    pub fn of(&self, point: u32) -> u32 {
        self.root(self.first[point as usize])
    }

    /// Number of remaining triangles of a part.
    pub fn live(&self, part: u32) -> u32 {
        self.live[part as usize]
    }

    /// Returns a point of the part in the input.
    pub fn first_point(&self, part: u32) -> u32 {
        self.points[self.start[part as usize] as usize]
    }

    /// Area of all parts in the input.
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Shape of a part, including parts joined into it.
    pub fn shape(&self, part: u32) -> &Shape {
        &self.shapes[part as usize]
    }

    /// Whether two parts look alike, by their shapes in the input.
    pub fn are_kin(&self, a: u32, b: u32) -> bool {
        self.looks[a as usize].is_kin(&self.looks[b as usize])
    }

    /// Whether a part was joined with other parts.
    pub fn is_joined(&self, part: u32) -> bool {
        self.is_joined[part as usize]
    }

    /// Whether either point of a pair belongs to a part joined with other parts.
    pub fn has_joined(&self, pair: Pair) -> bool {
        let joined = |point: u32| self.first[point as usize] != NONE && self.is_joined(self.of(point));
        self.any_joined && (joined(pair.lost) || joined(pair.kept))
    }

    /// Whether a part may vanish: another part remains, and the part was not found unable to vanish.
    pub fn may_vanish(&self, part: u32) -> bool {
        self.left > 1 && !self.stays[part as usize]
    }

    /// Marks a part as unable to vanish.
    pub fn keep(&mut self, part: u32) {
        self.stays[part as usize] = true;
    }

    /// Lower bound of the loss by vanishing, from the part's size alone: `area * spread + debt`.
    pub fn least_loss(&self, part: u32) -> f32 {
        let shape = self.shape(part);
        shape.area * shape.spread + self.debt[part as usize]
    }

    /// Loss by vanishing, if the squared distance of the part's centre from the remaining surface is `distance_squared`:
    /// `area * max(spread, distance_squared) + debt`.
    pub fn loss(&self, part: u32, distance_squared: f32) -> f32 {
        let shape = self.shape(part);
        shape.area * shape.spread.max(distance_squared) + self.debt[part as usize]
    }

    /// Appends the input points of a part, including merged points.
    pub fn points(&self, part: u32, list: &mut Vec<u32>) {
        let mut at = part;
        while at != NONE {
            let range = self.start[at as usize] as usize..self.start[at as usize + 1] as usize;
            list.extend_from_slice(&self.points[range]);
            at = self.next[at as usize];
        }
    }

    /// Returns the point that `point` was merged into, shortening the path.
    pub fn current(&mut self, mut point: u32) -> u32 {
        while self.into[point as usize] != point {
            let next = self.into[self.into[point as usize] as usize];
            self.into[point as usize] = next;
            point = next;
        }
        point
    }

    /// Returns the point that `point` was merged into, without shortening the path: as many steps as merges lie between.
    pub fn now(&self, mut point: u32) -> u32 {
        while self.into[point as usize] != point {
            point = self.into[point as usize];
        }
        point
    }

    /// Records that `lost` was merged into `kept` and that `died` triangles died. Returns whether two parts were joined.
    pub fn merge(&mut self, lost: u32, kept: u32, died: usize) -> bool {
        self.into[lost as usize] = kept;
        if self.first[lost as usize] == NONE || self.first[kept as usize] == NONE {
            return false;
        }
        let (a, b) = (self.of(lost), self.of(kept));
        let to = if a == b { a } else { self.join(a, b) };
        if a != b {
            self.is_joined[to as usize] = true;
            self.any_joined = true;
        }
        self.live[to as usize] -= died as u32;
        if died > 0 && self.live[to as usize] == 0 {
            self.left -= 1;
            let mut points = std::mem::take(&mut self.scratch);
            points.clear();
            self.points(to, &mut points);
            points.iter().for_each(|&point| self.near.remove(point));
            self.scratch = points;
        }
        a != b
    }

    /// Records that the point `kept` of a vanished part takes the place of `lost` in another part, which stands for both
    /// parts from now on and keeps its looks.
    pub fn absorb(&mut self, lost: u32, kept: u32) {
        self.into[lost as usize] = kept;
        let (a, b) = (self.of(lost), self.of(kept));
        if a != b {
            let looks = self.looks[a as usize];
            let to = self.join(a, b);
            self.looks[to as usize] = looks;
        }
    }

    /// Joins two parts and returns the number of the joined part: the number of the part with more points, or of equal
    /// parts the lower number.
    fn join(&mut self, a: u32, b: u32) -> u32 {
        let size = |part: u32| self.size[part as usize];
        let (to, from) = if (size(a), b) >= (size(b), a) { (a, b) } else { (b, a) };
        self.size[to as usize] += self.size[from as usize];
        let both = self.live[to as usize] > 0 && self.live[from as usize] > 0;
        self.left -= usize::from(both);
        self.live[to as usize] += std::mem::take(&mut self.live[from as usize]);
        self.shapes[to as usize] = self.shapes[to as usize].join(&self.shapes[from as usize]);
        self.debt[to as usize] += self.debt[from as usize];
        self.is_joined[to as usize] |= self.is_joined[from as usize];
        self.stays[to as usize] |= self.stays[from as usize];
        self.joined[from as usize] = to;
        self.next[self.last[to as usize] as usize] = from;
        self.last[to as usize] = self.last[from as usize];
        to
    }

    /// Records that a part vanished beside the part of `into`, and adds `loss` to the debt there. `points` are all input
    /// points of the vanished part, including merged points.
    pub fn vanish(&mut self, part: u32, points: &[u32], into: u32, loss: f32) {
        for &point in points {
            self.near.remove(point);
        }
        self.live[part as usize] = 0;
        self.left -= 1;
        let beside = self.of(into);
        self.debt[beside as usize] += loss;
    }

    /// Finds the points nearest to `at`, by input positions, that belong to other parts: see [`Near::nearest`].
    pub fn nearest(&mut self, at: Vec3, own: u32, most: (usize, f32), found: &mut Vec<(f32, u32)>) {
        let (first, joined) = (&self.first, &self.joined);
        let part = |point: u32| root(joined, first[point as usize]);
        self.near.nearest(at, own, most, part, |part| root(joined, part), found);
    }

    /// Number of input parts without triangles after `steps` steps; `ends` as in a sequence.
    pub fn removed(&self, ends: &[u32], steps: usize) -> usize {
        let mut has = vec![false; self.count()];
        for (&part, _) in self.of_triangle.iter().zip(ends).filter(|&(_, &end)| end as usize > steps) {
            if part != NONE {
                has[part as usize] = true;
            }
        }
        has.iter().filter(|&&has| !has).count()
    }
}

fn root(joined: &[u32], mut part: u32) -> u32 {
    while joined[part as usize] != part {
        part = joined[part as usize];
    }
    part
}

/// Returns the part of every point, numbered by first point, and the number of parts; `None` for fewer than two parts.
fn components(surface: &WorkingSurface) -> Option<(Vec<u32>, usize)> {
    let mut sets = Sets::new(surface.point_count());
    let mut parts = surface.live_points();
    for triangle in 0..surface.triangle_count() as u32 {
        let Some([a, b, c]) = surface.triangle(triangle) else { continue };
        for other in [b, c] {
            parts -= usize::from(sets.join(a, other));
        }
    }
    if parts < 2 {
        return None;
    }
    let mut part = vec![NONE; sets.len()];
    let mut count = 0;
    for point in 0..sets.len() as u32 {
        if surface.valence(point) == 0 {
            continue;
        }
        // The lowest point of a part is its root.
        let root = sets.find(point);
        if root == point {
            part[point as usize] = count;
            count += 1;
        } else {
            part[point as usize] = part[root as usize];
        }
    }
    Some((part, count as usize))
}
