//! Triangles in a bounding volume hierarchy: nearest point, and first hit along a ray.
//!
//! ```text
//!   triangles --drop degenerate--> --sort by hash of the box--> --one primitive per box--> locally ordered clustering
//! ```
//!
//! [`obvhs`] builds the tree (Meister and Bittner, "Parallel Locally-Ordered Clustering", TVCG 2018): mutually nearest
//! neighbours become pairs. Many equal boxes all prefer the same neighbour, so each round makes a single pair: O(n^2).
//! Sorting by a hash brings equal boxes together, and equal boxes become a single primitive. It also shuffles the
//! remaining boxes, so no order of the input can cause such a chain.
//!
//! Where the boxes of long thin triangles crowd, each node has a second, turned box (`turned_boxes.rs`).
//!
//! Boxes are single precision in their own frame (centred, scaled by a power of two to lie in -1..1). Triangles are
//! tested in double precision in object units: answers are exact to rounding for any position and size.
//! Rounding of the boxes only widens the search.

use glam::{DVec3, Vec3A};
use obvhs::{
    Boundable,
    aabb::Aabb,
    bvh2::{Bvh2, leaf_collapser::collapse, node::Bvh2Node},
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};

use super::{
    boxes, hash,
    lists::NONE,
    triangle::{Corners, closest_on_triangle, has_area, hit_triangle},
    turned_boxes::{self, TurnedBox},
};

/// Margin added to boxes (frame units), far larger than the rounding of a coordinate.
const BOX_MARGIN: f32 = 1.0 / (1 << 20) as f32;
/// Largest distance of a query from the frame's centre (frame units). A farther query is moved to this distance along
/// its direction, where boxes can still be told apart. From there the surface's width matters by 1 / FAR^2: the point
/// nearest to the moved query is nearest to the original query to within that share of the distance.
const FAR: f64 = (1 << 12) as f64;

/// A surface: triangles with an area, coincident triangles once.
///
/// Triangles are renumbered into *slots* in the order of the tree's leaves: slots near in number are near in space. 40
/// bytes a slot and at most 96 for the nodes, 160 more with turned boxes. Built in O(n log n).
#[derive(Debug)]
pub(crate) struct Bvh {
    nodes: Vec<Bvh2Node>,
    /// Per node, or empty.
    turned: Vec<TurnedBox>,
    corners: Vec<[[f32; 3]; 3]>,
    triangle_of: Vec<u32>,
    frame: Frame,
}

/// The centre and scale of the boxes' coordinates.
#[derive(Debug, Clone, Copy)]
struct Frame {
    centre: DVec3,
    /// A power of two: scaling never rounds.
    scale: f64,
}

/// The point of a surface nearest to a query point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closest {
    /// Slot of the triangle containing the point.
    pub slot: u32,
    /// The nearest point, object units.
    pub point: DVec3,
    /// Squared distance from the query point, object units.
    pub distance_squared: f64,
}

/// First intersection of a ray with a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RayHit {
    /// Slot of the triangle hit.
    pub slot: u32,
    /// Barycentric weights of the triangle's corners.
    pub weights: [f64; 3],
    /// Distance along the ray, in lengths of its direction.
    pub t: f64,
}

struct PrimitiveBox(Aabb);

impl Boundable for PrimitiveBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl Bvh {
    /// Builds the hierarchy of triangles, whose vertices must all exist; `None` if no triangle has an area.
    pub(crate) fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let mesh = Triangles { positions, triangles };
        let kept: Vec<u32> = (0..triangles.len() as u32).filter(|&t| has_area(&mesh.corners(t))).collect();
        let frame = Frame::around(kept.iter().flat_map(|&t| mesh.corners(t)))?;
        let boxes: Vec<Aabb> = kept.iter().map(|&t| frame.bounds(&mesh.corners(t))).collect();

        // For each primitive its run of `order`. Equal boxes share a primitive; only the first of coincident triangles
        // is kept.
        let (order, runs) = group_by_box(&mesh, &kept, &boxes);
        let primitives: Vec<PrimitiveBox> = runs
            .windows(2)
            .map(|run| {
                let mut all = Aabb::empty();
                for &item in &order[run[0] as usize..run[1] as usize] {
                    all = all.union(&boxes[item as usize]);
                }
                PrimitiveBox(all)
            })
            .collect();

        let mut tree = PlocBuilder::with_capacity(primitives.len()).build(
            PlocSearchDistance::Medium,
            &primitives,
            (0..primitives.len() as u32).collect(),
            SortPrecision::U64,
            1,
        );
        collapse(&mut tree, 4, 1.0);
        Some(Self::with_leaf_order(&mesh, tree, frame, &|primitive| {
            let run = runs[primitive as usize] as usize..runs[primitive as usize + 1] as usize;
            order[run].iter().map(|&item| kept[item as usize])
        }))
    }

    /// Stores the triangles in the order of the leaves, and points the leaves at them.
    fn with_leaf_order<I: Iterator<Item = u32>>(
        mesh: &Triangles<'_>,
        tree: Bvh2,
        frame: Frame,
        triangles_of_primitive: &impl Fn(u32) -> I,
    ) -> Self {
        let mut nodes = tree.nodes;
        let mut triangle_of = Vec::new();
        let mut stack = vec![0u32];
        while let Some(index) = stack.pop() {
            let Some(node) = nodes.get_mut(index as usize) else { continue };
            node.aabb.min -= BOX_MARGIN;
            node.aabb.max += BOX_MARGIN;
            if node.is_leaf() {
                let first = triangle_of.len() as u32;
                let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                for &primitive in &tree.primitive_indices[range] {
                    triangle_of.extend(triangles_of_primitive(primitive));
                }
                node.first_index = first;
                node.prim_count = triangle_of.len() as u32 - first;
            } else {
                stack.extend([node.first_index + 1, node.first_index]);
            }
        }
        let corners: Vec<[[f32; 3]; 3]> = triangle_of.iter().map(|&t| mesh.exact_corners(t)).collect();
        let in_frame = |slot: u32| corners[slot as usize].map(|p| frame.to_frame(wide(p)));
        let turned = turned_boxes::of_nodes(&nodes, in_frame, BOX_MARGIN);
        Self { nodes, turned, corners, triangle_of, frame }
    }

    /// Number of slots.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// Returns a power of two between half the longest side of the surface's box and that side, object units.
    pub(crate) fn size(&self) -> f64 {
        1.0 / self.frame.scale
    }

    /// Returns the length below which points of the surface cannot be told apart, object units: many times the rounding
    /// of its coordinates in double precision, far below the spacing of single precision.
    pub(crate) fn touch(&self) -> f64 {
        64.0 * f64::EPSILON * (self.frame.centre.abs().max_element() + self.size())
    }

    /// Returns the corners of a slot's triangle.
    pub(crate) fn corners(&self, slot: u32) -> Corners {
        self.corners[slot as usize].map(wide)
    }

    /// Returns the given triangle of each slot.
    pub(crate) fn triangle_of(&self) -> &[u32] {
        &self.triangle_of
    }

    /// Returns a walker for many queries.
    pub(crate) fn walker(&self) -> Walker<'_> {
        Walker { bvh: self, near: Vec::with_capacity(64), hint: NONE }
    }
}

/// Queries a surface many times: holds the stack, and the slot of the last nearest point.
pub(crate) struct Walker<'a> {
    bvh: &'a Bvh,
    /// First child of a pair of nodes, and the pair's lower bound: distance squared, or distance along the ray.
    near: Vec<(u32, f32)>,
    hint: u32,
}

impl Walker<'_> {
    /// Returns the point of the surface nearest to `point`. Fastest when consecutive queries are near each other: the
    /// triangle of the last answer bounds the search from the start. O(log n) expected.
    pub(crate) fn closest(&mut self, point: DVec3) -> Closest {
        let bvh = self.bvh;
        let mut query = bvh.frame.to_frame(point);
        let mut searched = point;
        let reach = query.length();
        if reach > FAR {
            query *= FAR / reach;
            searched = bvh.frame.to_object(query);
        }
        let q = query.as_vec3a();
        // Rounding of the query and of the differences below.
        let slack = reach.clamp(1.0, FAR) * f64::from(BOX_MARGIN);
        let bound = |best: &Closest| -> f32 {
            let widened = best.distance_squared.sqrt() * bvh.frame.scale + slack;
            (widened * widened) as f32 * (1.0 + 4.0 * f32::EPSILON)
        };

        let mut best = bvh.closest_on_slot(if self.hint == NONE { 0 } else { self.hint }, searched);
        let mut limit = bound(&best);
        self.near.clear();
        let visit = |node: &Bvh2Node, best: &mut Closest, limit: &mut f32| {
            for slot in node.first_index..node.first_index + node.prim_count {
                let found = bvh.closest_on_slot(slot, searched);
                if found.distance_squared < best.distance_squared {
                    *best = found;
                    *limit = bound(best);
                }
            }
        };
        let root = &bvh.nodes[0];
        let mut pair = root.first_index;
        if root.is_leaf() {
            visit(root, &mut best, &mut limit);
        } else {
            loop {
                let (mut a, mut b) = (&bvh.nodes[pair as usize], &bvh.nodes[pair as usize + 1]);
                let (mut near, mut far) = (bvh.distance_squared(pair, q), bvh.distance_squared(pair + 1, q));
                if far < near {
                    (a, b, near, far) = (b, a, far, near);
                }
                let mut next = NONE;
                if near <= limit {
                    if a.is_leaf() {
                        visit(a, &mut best, &mut limit);
                    } else {
                        next = a.first_index;
                    }
                    if far <= limit {
                        if !b.is_leaf() {
                            if next == NONE {
                                next = b.first_index;
                            } else {
                                self.near.push((b.first_index, far));
                            }
                        } else {
                            visit(b, &mut best, &mut limit);
                        }
                    }
                }
                while next == NONE {
                    match self.near.pop() {
                        Some((waiting, distance)) if distance <= limit => next = waiting,
                        Some(_) => {}
                        None => break,
                    }
                }
                if next == NONE {
                    break;
                }
                pair = next;
            }
        }
        self.hint = best.slot;
        if reach > FAR { bvh.closest_on_slot(best.slot, point) } else { best }
    }

    /// Calls `visit` with the slot of every triangle within [`Bvh::touch`] of `point`, a point of the surface; always
    /// in the same order. O(log n) expected, plus the triangles around the point.
    pub(crate) fn touching(&mut self, point: DVec3, mut visit: impl FnMut(u32)) {
        let bvh = self.bvh;
        let q = bvh.frame.to_frame(point).as_vec3a();
        let reach = bvh.touch() * bvh.touch();
        self.near.clear();
        self.near.push((0, 0.0));
        while let Some((index, _)) = self.near.pop() {
            let node = &bvh.nodes[index as usize];
            // The boxes' margin is far wider than the reach.
            if bvh.distance_squared(index, q) > BOX_MARGIN * BOX_MARGIN {
                continue;
            }
            if node.is_leaf() {
                let slots = node.first_index..node.first_index + node.prim_count;
                slots
                    .filter(|&s| bvh.closest_on_slot(s, point).distance_squared <= reach)
                    .for_each(&mut visit);
            } else {
                self.near.extend([(node.first_index + 1, 0.0), (node.first_index, 0.0)]);
            }
        }
    }

    /// Calls `visit` with each slot after `slot` in leaves whose box meets the box of `slot`; always in the same order.
    /// O(log n) expected, plus the leaves met.
    pub(crate) fn overlapping(&mut self, slot: u32, mut visit: impl FnMut(u32)) {
        let bvh = self.bvh;
        let own = bvh.frame.bounds(&bvh.corners(slot));
        let points = bvh.corners(slot).map(|p| bvh.frame.to_frame(p).as_vec3a());
        self.near.clear();
        self.near.push((0, 0.0));
        while let Some((index, _)) = self.near.pop() {
            let node = &bvh.nodes[index as usize];
            // The boxes' margin is wider than the rounding.
            let apart = node.aabb.min.cmpgt(own.max) | node.aabb.max.cmplt(own.min);
            let beside = bvh.turned.get(index as usize).is_some_and(|turned| turned.misses(points));
            if apart.any() || beside {
                continue;
            }
            if node.is_leaf() {
                let slots = node.first_index..node.first_index + node.prim_count;
                slots.filter(|&other| other > slot).for_each(&mut visit);
            } else {
                self.near.extend([(node.first_index + 1, 0.0), (node.first_index, 0.0)]);
            }
        }
    }

    /// Returns where the ray first meets the surface, from either side, at `0 < t < reach`; `None` for a direction of
    /// length 0. O(log n) expected.
    pub(crate) fn first_hit(&mut self, origin: DVec3, direction: DVec3, reach: f64) -> Option<RayHit> {
        let bvh = self.bvh;
        let d = direction.normalize_or_zero();
        let o = bvh.frame.to_frame(origin);
        // Start where the ray enters the sphere around the frame's cube, so that boxes see small coordinates.
        let middle = -o.dot(d);
        let half_chord = 4.0 - (o + d * middle).length_squared();
        if d == DVec3::ZERO || !half_chord.is_finite() || half_chord < 0.0 {
            return None;
        }
        let skipped = (middle - half_chord.sqrt()).max(0.0);
        let start = (o + d * skipped).as_vec3a();
        // Never 0, so 0 * infinity cannot occur.
        let inverse =
            DVec3::from_array(d.to_array().map(|x| 1.0 / if x.abs() < 1e-20 { 1e-20 } else { x })).as_vec3a();
        let along = d.as_vec3a();
        // Frame distance from `start` is t * per_t - skipped.
        let per_t = direction.length() * bvh.frame.scale;

        // On an edge shared by two triangles, the first triangle given wins, for any shape of the tree.
        let before = |a: u32, b: u32| bvh.triangle_of[a as usize] < bvh.triangle_of[b as usize];
        let mut best: Option<RayHit> = None;
        let in_frame = |t: f64| (t * per_t - skipped) as f32 + 4.0 * BOX_MARGIN;
        let mut limit = in_frame(reach);
        self.near.clear();
        let mut visit = |node: &Bvh2Node, limit: &mut f32| {
            for slot in node.first_index..node.first_index + node.prim_count {
                if let Some((t, weights)) = hit_triangle(&bvh.corners(slot), origin, direction)
                    && best.map_or(t < reach, |b| t < b.t || (t == b.t && before(slot, b.slot)))
                {
                    best = Some(RayHit { slot, weights, t });
                    *limit = in_frame(t);
                }
            }
        };
        let root = &bvh.nodes[0];
        let mut pair = root.first_index;
        if root.is_leaf() {
            visit(root, &mut limit);
            return best;
        }
        loop {
            let (mut a, mut b) = (&bvh.nodes[pair as usize], &bvh.nodes[pair as usize + 1]);
            let (mut near, mut far) = (box_entry(a, start, inverse), box_entry(b, start, inverse));
            if let Some([turned_a, turned_b]) = bvh.turned.get(pair as usize..pair as usize + 2) {
                near = near.max(turned_a.entry(start, along));
                far = far.max(turned_b.entry(start, along));
            }
            if far < near {
                (a, b, near, far) = (b, a, far, near);
            }
            let mut next = NONE;
            for (node, entry) in [(a, near), (b, far)] {
                if entry > limit || entry == f32::INFINITY {
                    continue;
                }
                if node.is_leaf() {
                    visit(node, &mut limit);
                } else if next == NONE {
                    next = node.first_index;
                } else {
                    self.near.push((node.first_index, entry));
                }
            }
            while next == NONE {
                match self.near.pop() {
                    Some((waiting, entry)) if entry <= limit => next = waiting,
                    Some(_) => {}
                    None => return best,
                }
            }
            pair = next;
        }
    }
}

impl Bvh {
    /// Returns a lower bound for the squared distance of a point from the triangles of a node, frame units.
    #[inline]
    fn distance_squared(&self, node: u32, q: Vec3A) -> f32 {
        let of_box = box_distance_squared(&self.nodes[node as usize], q);
        match self.turned.get(node as usize) {
            Some(turned) => of_box.max(turned.distance_squared(q)),
            None => of_box,
        }
    }

    fn closest_on_slot(&self, slot: u32, point: DVec3) -> Closest {
        let (point, distance_squared) = closest_on_triangle(&self.corners(slot), point);
        Closest { slot, point, distance_squared }
    }
}

impl Frame {
    /// Returns the frame in which the points lie in -1..1; `None` without points or if all coincide.
    fn around(points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let [low, high] = boxes::around(points);
        let half = (high - low).max_element() * 0.5;
        if !(half.is_finite() && half > 0.0) {
            return None;
        }
        // The next power of two from the exponent bits: exact, unlike a logarithm.
        let exponent = half.to_bits() >> 52;
        Some(Self { centre: low + (high - low) * 0.5, scale: f64::from_bits((2045 - exponent) << 52) })
    }

    fn to_frame(self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    fn to_object(self, point: DVec3) -> DVec3 {
        point / self.scale + self.centre
    }

    fn bounds(self, corners: &Corners) -> Aabb {
        Aabb::from_points(&corners.map(|p| self.to_frame(p).as_vec3a()))
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

/// The triangles as given.
struct Triangles<'a> {
    positions: &'a [[f32; 3]],
    triangles: &'a [[u32; 3]],
}

impl Triangles<'_> {
    fn exact_corners(&self, triangle: u32) -> [[f32; 3]; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    fn corners(&self, triangle: u32) -> Corners {
        self.exact_corners(triangle).map(wide)
    }
}

/// Returns the items of `kept` sorted by a hash of their box, coincident triangles once, and the start of each run of
/// equal boxes (plus the end of the last run). Boxes whose hashes collide share a run: slower, but correct.
fn group_by_box(mesh: &Triangles<'_>, kept: &[u32], boxes: &[Aabb]) -> (Vec<u32>, Vec<u32>) {
    let word = |x: f32| u64::from((x + 0.0).to_bits());
    let corner_hash = |v: u32| hash::words(mesh.positions[v as usize].map(word));
    let mut sorted: Vec<(u64, u64, u32)> = (0..kept.len())
        .map(|item| {
            let Aabb { min, max } = boxes[item];
            let of_box = hash::words([min.x, min.y, min.z, max.x, max.y, max.z].map(word));
            // A sum, so the order and orientation of the corners do not matter.
            let of_corners = mesh.triangles[kept[item] as usize]
                .iter()
                .fold(0u64, |sum, &v| sum.wrapping_add(corner_hash(v)));
            (of_box, of_corners, item as u32)
        })
        .collect();
    sorted.sort_unstable();
    sorted.dedup_by(|next, first| {
        next.0 == first.0
            && next.1 == first.1
            && coincident(mesh, kept[next.2 as usize], kept[first.2 as usize])
    });
    let mut runs: Vec<u32> =
        (0..sorted.len()).filter(|&i| i == 0 || sorted[i].0 != sorted[i - 1].0).map(|i| i as u32).collect();
    runs.push(sorted.len() as u32);
    (sorted.into_iter().map(|(_, _, item)| item).collect(), runs)
}

/// Tests if two triangles have the same three corners, in any order.
fn coincident(mesh: &Triangles<'_>, a: u32, b: u32) -> bool {
    let (a, b) = (mesh.exact_corners(a), mesh.exact_corners(b));
    a.iter().all(|p| b.contains(p)) && b.iter().all(|p| a.contains(p))
}

#[inline]
fn box_distance_squared(node: &Bvh2Node, q: Vec3A) -> f32 {
    let outside = (node.aabb.min - q).max(q - node.aabb.max).max(Vec3A::ZERO);
    outside.length_squared()
}

/// Returns where the ray enters a box (0: starts inside); infinity if it misses.
#[inline]
fn box_entry(node: &Bvh2Node, start: Vec3A, inverse: Vec3A) -> f32 {
    let (low, high) = ((node.aabb.min - start) * inverse, (node.aabb.max - start) * inverse);
    let entry = low.min(high).max_element().max(0.0);
    let exit = low.max(high).min_element();
    if entry <= exit { entry } else { f32::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fan of long thin triangles, bent into a saddle and turned.
    fn fan(triangles: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let rim = |i: u32| {
            let angle = std::f32::consts::TAU * i as f32 / triangles as f32;
            let (x, y, z) = (angle.cos(), angle.sin(), 0.2 * (5.0 * angle).sin());
            [0.8 * x - 0.6 * z, y, 0.6 * x + 0.8 * z]
        };
        let positions = std::iter::once([0.0; 3]).chain((0..triangles).map(rim)).collect();
        (positions, (0..triangles).map(|i| [0, 1 + i, 1 + (i + 1) % triangles]).collect())
    }

    /// Points in -2..2, always the same.
    fn places() -> impl Iterator<Item = DVec3> {
        let number = |i: u64| hash::words([i]) as f64 / u64::MAX as f64 * 4.0 - 2.0;
        (0..2000).map(move |i| DVec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)))
    }

    #[test]
    fn a_crowded_surface_answers_as_if_every_triangle_were_tried() {
        let (positions, triangles) = fan(600);
        let bvh = Bvh::new(&positions, &triangles).unwrap();
        assert_eq!(bvh.turned.len(), bvh.nodes.len());
        let mut walker = bvh.walker();
        for place in places() {
            let all = (0..bvh.len() as u32).map(|slot| bvh.closest_on_slot(slot, place).distance_squared);
            assert_eq!(walker.closest(place).distance_squared, all.fold(f64::INFINITY, f64::min));
        }
        let mut hits = 0;
        for (origin, to) in places().zip(places().skip(1)) {
            let direction = to * 0.3 - origin;
            let all = (0..bvh.len() as u32).filter_map(|s| hit_triangle(&bvh.corners(s), origin, direction));
            let first = all.map(|(t, _)| t).fold(f64::INFINITY, f64::min);
            let found = walker.first_hit(origin, direction, f64::INFINITY).map_or(f64::INFINITY, |hit| hit.t);
            assert_eq!(found, first);
            hits += u32::from(found.is_finite());
        }
        assert!(hits > 100, "{hits}");
        let point = bvh.corners(0)[0];
        let mut touched = 0;
        walker.touching(point, |_| touched += 1);
        let on = |slot: &u32| bvh.closest_on_slot(*slot, point).distance_squared == 0.0;
        assert_eq!(touched, (0..bvh.len() as u32).filter(on).count());
    }

    #[test]
    fn boxes_that_meet_are_visited_where_surfaces_cross() {
        let (mut positions, mut triangles) = fan(600);
        // A triangle through all of them.
        positions.extend([[0.3, 0.3, -1.0], [0.3, 0.3, 1.0], [-0.4, 0.4, 0.0]]);
        triangles.push([601, 602, 603]);
        let bvh = Bvh::new(&positions, &triangles).unwrap();
        let cross =
            |a: u32, b: u32| super::super::crossing::triangles_cross(&bvh.corners(a), &bvh.corners(b));
        let (mut found, mut all) = (0, 0);
        for slot in 0..bvh.len() as u32 {
            bvh.walker().overlapping(slot, |other| found += u32::from(cross(slot, other)));
            all += (slot + 1..bvh.len() as u32).filter(|&other| cross(slot, other)).count() as u32;
        }
        assert!(all > 100, "{all}");
        assert_eq!(found, all);
    }
}
