//! Distances between the input's curves and a level's curves, both ways; `tracked_samples.rs` does so for the surface.
//!
//! ```text
//!        input      a--b--c--d--e        Points that a curve has lost hang on the edge of its image that they are
//!                       o                nearest to, and their distance is taken whenever that edge changes. For the
//!        level      a--/-\--e            other way, points along a new edge of the image are held against the input's
//!                     o   o              edges at what hangs on it.
//! ```
//!
//! A removed point of a rim still lies on the flat face around it, so the surface's distance does not notice; and where a
//! hole shrinks, the level covers empty space. The curve's distance shows both. A curve shrunk to a point counts with its
//! distance from the point: its size.

use glam::Vec3;

use crate::mesh::NONE;
use crate::simplify::metric::Pair;
use crate::simplify::surface::{HUB, WorkingSurface};

/// Maximum number of the kept point's edges looked at where the point stays: with more, it is a hub.
const MOST_KEPT: usize = 16;
/// Maximum number of edges looked at beyond the far end of another edge.
const MOST_BEYOND: usize = 4;
/// Samples along a new edge for the way back: shares of its length from the merged point on.
const ALONG: [f32; 4] = [0.0, 0.25, 0.5, 0.75];

/// Assigns each lost point of a curve to an edge of the image.
#[derive(Debug, Clone, Default)]
pub(crate) struct CurveSamples {
    /// Per point its curve point in the input, or `NONE`.
    number: Vec<u32>,
    /// Curve points. `start`, `neighbours`, `merged` and `placed` are per curve point too.
    points: Vec<CurvePoint>,
    /// Start of each curve point's input neighbours in `neighbours`; length: curve points + 1.
    start: Vec<u32>,
    neighbours: Vec<u32>,
    merged: Vec<bool>,
    /// Squared distance when last placed.
    placed: Vec<f32>,
    /// First curve point on each edge of the image.
    on_edge: Vec<u32>,
    /// First curve point at each point to which a whole curve has shrunk.
    at_point: Vec<u32>,
    spokes: Vec<Spoke>,
    loose: Vec<u32>,
}

/// A point of an input curve, and the next point assigned to the same edge.
#[derive(Debug, Clone, Copy)]
struct CurvePoint {
    position: Vec3,
    next: u32,
}

/// An edge of the image around the merged point, or the edge beyond; positions are relative to the merged point.
#[derive(Debug, Clone, Copy)]
struct Spoke {
    edge: u32,
    from: Vec3,
    to: Vec3,
    /// Far end.
    other: u32,
    is_new: bool,
    /// Least squared distance of each sample along the edge from the input's curve.
    back: [f32; ALONG.len()],
}

/// Effect of a merge on the input's curves.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CurveChange {
    /// Largest squared distance.
    pub worst: f32,
    /// Growth of the sum of squared distances.
    pub added: f32,
}

impl CurveSamples {
    /// Starts with no point assigned to an edge.
    pub fn new(surface: &WorkingSurface) -> Self {
        let curves = surface.curves();
        if curves.is_empty() {
            return Self::default();
        }
        let mut number = vec![NONE; surface.point_count()];
        let (mut points, mut start, mut neighbours) = (Vec::new(), vec![0], Vec::new());
        for point in 0..surface.point_count() as u32 {
            let before = neighbours.len();
            neighbours.extend(curves.around(point).map(|[_, other]| other));
            if neighbours.len() > before {
                number[point as usize] = points.len() as u32;
                points.push(CurvePoint { position: surface.at(point), next: NONE });
                start.push(neighbours.len() as u32);
            }
        }
        neighbours.iter_mut().for_each(|n| *n = number[*n as usize]);
        Self {
            merged: vec![false; points.len()],
            placed: vec![0.0; points.len()],
            on_edge: vec![NONE; curves.edge_count()],
            at_point: vec![NONE; surface.point_count()],
            number,
            points,
            start,
            neighbours,
            spokes: Vec::new(),
            loose: Vec::new(),
        }
    }

    /// Whether merging `pair` at `x` touches a curve.
    #[inline]
    pub fn concerns(&self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> bool {
        surface.is_on_curve(pair.lost) || surface.is_on_curve(pair.kept) && surface.at(pair.kept) != x
    }

    /// Returns the effect of merging `pair` at `x`.
    pub fn measure(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> CurveChange {
        self.spread(surface, pair, x);
        self.gather(surface, pair, x);
        let mut change = CurveChange::default();
        let loose = std::mem::take(&mut self.loose);
        for &point in &loose {
            let (distance, spoke) = self.nearest(self.points[point as usize].position - x);
            change.worst = change.worst.max(distance);
            change.added += distance - self.placed[point as usize];
            self.look_back(point, spoke, x);
        }
        self.loose = loose;
        change.worst = change.worst.max(self.way_back(surface, pair, x));
        change
    }

    /// Returns the effect of merging `pair` at `x`, just before the merge is done, and hands over the points of
    /// changing edges.
    pub fn hand_over(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> CurveChange {
        self.spread(surface, pair, x);
        self.gather(surface, pair, x);
        self.cut_off(surface, pair, x);
        let mut change = CurveChange::default();
        let loose = std::mem::take(&mut self.loose);
        for &point in &loose {
            let (distance, spoke) = self.nearest(self.points[point as usize].position - x);
            change.worst = change.worst.max(distance);
            change.added += distance - self.placed[point as usize];
            self.look_back(point, spoke, x);
            self.merged[point as usize] = true;
            self.placed[point as usize] = distance;
            let head = match self.spokes.get(spoke) {
                Some(spoke) => &mut self.on_edge[spoke.edge as usize],
                None => &mut self.at_point[pair.kept as usize],
            };
            self.points[point as usize].next = std::mem::replace(head, point);
        }
        self.loose = loose;
        change.worst = change.worst.max(self.way_back(surface, pair, x));
        change
    }

    /// Number of points handed over by the last step.
    pub fn handed_over(&self) -> usize {
        self.loose.len()
    }

    /// Before a step that may not touch a curve.
    pub fn clear_loose(&mut self) {
        self.loose.clear();
    }

    /// Collects the edges around the merged point, changing edges first.
    fn spread(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) {
        let curves = surface.curves();
        let moves = surface.at(pair.kept) != x;
        self.spokes.clear();
        let spoke = |edge: u32, other: u32, is_new: bool| Spoke {
            edge,
            from: Vec3::ZERO,
            to: surface.at(other) - x,
            other,
            is_new,
            back: [f32::INFINITY; ALONG.len()],
        };
        for [edge, other] in curves.around(pair.lost) {
            if other != pair.kept && curves.find(pair.kept, other).is_none() {
                self.spokes.push(spoke(edge, other, true));
            }
        }
        let most = if moves { usize::MAX } else { MOST_KEPT };
        let kept = curves.around(pair.kept).filter(|&[_, other]| other != pair.lost).take(most);
        self.spokes.extend(kept.map(|[edge, other]| spoke(edge, other, moves)));
        // Edges beyond the far ends may be nearer to a point moving far.
        let near = self.spokes.len();
        if near > MOST_KEPT {
            return;
        }
        for i in 0..near {
            let Spoke { edge: known, other: far, to, .. } = self.spokes[i];
            for [edge, other] in curves.around(far).take(MOST_BEYOND) {
                if edge != known && other != pair.lost && other != pair.kept {
                    self.spokes.push(Spoke { from: to, ..spoke(edge, other, false) });
                }
            }
        }
    }

    /// Collects the points left without an edge by the merge.
    fn gather(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) {
        self.loose.clear();
        let moves = surface.at(pair.kept) != x;
        for point in [Some(pair.lost), moves.then_some(pair.kept)].into_iter().flatten() {
            let number = self.number[point as usize];
            if number != NONE && !self.merged[number as usize] {
                self.loose.push(number);
            }
            let heads = surface.curves().around(point);
            let heads = heads.filter(|&[_, other]| point == pair.lost || other != pair.lost);
            let heads = heads.map(|[edge, _]| self.on_edge[edge as usize]);
            for mut at in heads.chain([self.at_point[point as usize]]) {
                while at != NONE {
                    self.loose.push(at);
                    at = self.points[at as usize].next;
                }
            }
        }
    }

    fn cut_off(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) {
        let moves = surface.at(pair.kept) != x;
        for point in [Some(pair.lost), moves.then_some(pair.kept)].into_iter().flatten() {
            surface.curves().around(point).for_each(|[edge, _]| self.on_edge[edge as usize] = NONE);
            self.at_point[point as usize] = NONE;
        }
    }

    /// Returns the squared distance from the nearest edge around the merged point, and the edge's index; from the point
    /// itself where there is no edge.
    fn nearest(&self, p: Vec3) -> (f32, usize) {
        let mut best = (f32::INFINITY, usize::MAX);
        for (i, spoke) in self.spokes.iter().enumerate() {
            let distance = from_segment(p, spoke.from, spoke.to);
            if distance < best.0 {
                best = (distance, i);
            }
        }
        if best.1 == usize::MAX { (p.length_squared(), best.1) } else { best }
    }

    /// Measures the samples along a new edge against the input's edges at a curve point.
    fn look_back(&mut self, point: u32, spoke: usize, x: Vec3) {
        let Some(spoke) = self.spokes.get_mut(spoke).filter(|spoke| spoke.is_new) else { return };
        let p = self.points[point as usize].position - x;
        let edges = self.start[point as usize] as usize..self.start[point as usize + 1] as usize;
        // Near a hub, the edge's far end tells enough.
        if edges.len() > HUB {
            return;
        }
        for &neighbour in &self.neighbours[edges] {
            let q = self.points[neighbour as usize].position - x;
            for (share, least) in ALONG.iter().zip(&mut spoke.back) {
                *least = least.min(from_segment(spoke.to * *share, p, q));
            }
        }
    }

    /// Returns the largest squared distance of a sample along a new edge from the input's edges at the edge's ends and
    /// at the points assigned to it.
    fn way_back(&mut self, surface: &WorkingSurface, pair: Pair, x: Vec3) -> f32 {
        let stays = surface.at(pair.kept) == x;
        let near = [self.number[pair.lost as usize], self.number[pair.kept as usize]];
        let mut worst: f32 = 0.0;
        for i in 0..self.spokes.len() {
            let spoke = self.spokes[i];
            if !spoke.is_new {
                continue;
            }
            let far = self.number[spoke.other as usize];
            for point in near.into_iter().chain([far]).filter(|&point| point != NONE) {
                self.look_back(point, i, x);
            }
            // If the kept point stays and is on the input's curve, the first sample lies on the curve.
            let first = usize::from(stays && near[1] != NONE);
            let finite = self.spokes[i].back[first..].iter().filter(|least| least.is_finite());
            worst = finite.fold(worst, |worst, &least| worst.max(least));
        }
        worst
    }
}

/// Returns the squared distance of a point from a segment.
#[inline]
fn from_segment(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let (ab, ap) = (b - a, p - a);
    let share = ap.dot(ab) / ab.length_squared();
    // NaN where both ends coincide.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    (ap - ab * share).length_squared()
}
