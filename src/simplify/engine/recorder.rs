//! Records the effect of each collapse on vertices and triangles, in the form of a [`CollapseSequence`].

use std::ops::Range;

use crate::mesh::{Mesh, NONE, Topology};
use crate::sequence::{CollapseSequence, NewVertex, SimplifyReport};
use crate::simplify::metric::{Pair, Substitutions};
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::wedge_map::WedgeMap;

/// A sequence under construction.
pub(super) struct Recorder {
    input_vertices: u32,
    new_vertices: Vec<NewVertex>,
    aliases: Vec<[u32; 2]>,
    snaps: Vec<[u32; 2]>,
    substitutions: Vec<[u32; 2]>,
    step_start: Vec<u32>,
    step_error: Vec<f32>,
    /// Per step the errors of surface and curves; empty where the input has no curves.
    parts: Vec<[f32; 2]>,
    triangles_after: Vec<u32>,
    triangle_end: Vec<u32>,
    batch_end: Vec<u32>,
    live_vertices: usize,
    /// Start and count of each point's wedges; empty where each point has a single wedge.
    spans: Vec<[u32; 2]>,
    wedges: Vec<u32>,
    /// Positions of the input's vertices, object units; empty unless wedges may move.
    positions: Vec<[f32; 3]>,
    /// `[wedge, image]` of the kept point's wedges in the current merge.
    renamed: Vec<[u32; 2]>,
    /// Number of vertices and substitutions before the last merge.
    before: [usize; 2],
    /// True if the last merge left the kept point's wedges as they were.
    kept_stay: bool,
    has_curves: bool,
}

impl Recorder {
    pub fn new(mesh: &Mesh, topology: &Topology, surface: &WorkingSurface) -> Self {
        let wedge_of = topology.wedge_of();
        let aliases = (0..wedge_of.len() as u32)
            .filter(|&v| wedge_of[v as usize] != v)
            .map(|v| [v, wedge_of[v as usize]]);
        let place = |v: u32| mesh.positions()[v as usize];
        let leader = |v: u32| topology.vertex_of_point()[topology.point_of()[v as usize] as usize];
        let snaps = (0..wedge_of.len() as u32)
            .map(|v| [v, leader(v)])
            .filter(|&[v, to]| wedge_of[v as usize] == v && place(v) != place(to));
        let mut used = vec![false; wedge_of.len()];
        let mut triangle_end = vec![0; mesh.triangles().len()];
        for t in 0..surface.triangle_count() as u32 {
            if surface.triangle(t).is_some() {
                surface.corner_vertices(t).iter().for_each(|&v| used[v as usize] = true);
                triangle_end[t as usize] = NONE;
                let followers = surface.followers(t);
                if !followers.is_empty() {
                    followers.iter().for_each(|&follower| triangle_end[follower as usize] = NONE);
                    surface.layers(t).flat_map(|layer| layer.vertices).for_each(|v| used[v as usize] = true);
                }
            }
        }
        let (spans, wedges) =
            if surface.has_seams() { wedge_lists(topology, &used) } else { (Vec::new(), Vec::new()) };
        let steps = surface.point_count();
        let mut step_start = Vec::with_capacity(steps + 1);
        step_start.push(0);
        let mut triangles_after = Vec::with_capacity(steps + 1);
        triangles_after.push(surface.live_triangles() as u32);
        Self {
            input_vertices: wedge_of.len() as u32,
            new_vertices: Vec::new(),
            aliases: aliases.collect(),
            snaps: snaps.collect(),
            substitutions: Vec::with_capacity(steps),
            step_start,
            step_error: Vec::with_capacity(steps),
            parts: Vec::new(),
            triangles_after,
            triangle_end,
            batch_end: Vec::new(),
            live_vertices: used.iter().filter(|&&u| u).count(),
            positions: if surface.moves_wedges && !spans.is_empty() {
                mesh.positions().to_vec()
            } else {
                Vec::new()
            },
            spans,
            wedges,
            renamed: Vec::new(),
            before: [0; 2],
            kept_stay: false,
            has_curves: !surface.curves().is_empty(),
        }
    }

    pub fn steps(&self) -> usize {
        self.step_error.len()
    }

    /// Vertices so far, input and new.
    pub fn vertex_count(&self) -> usize {
        self.input_vertices as usize + self.new_vertices.len()
    }

    pub fn live_vertices(&self) -> usize {
        self.live_vertices
    }

    /// Records the substitutions of merging `pair`. Call before the surface changes. `renew`: the new position (object
    /// units) and the share of `kept` in blends, or `None` where `kept` stays as it is. O(wedges).
    pub fn substitute(&mut self, surface: &WorkingSurface, pair: Pair, renew: Option<([f32; 3], f32)>) {
        self.before = [self.vertex_count(), self.substitutions.len()];
        self.kept_stay = false;
        if self.spans.is_empty() {
            let (a, b) = (surface.point_vertex(pair.lost), surface.point_vertex(pair.kept));
            self.merge(a, b, renew);
        } else {
            self.substitute_wedges(surface, pair, renew);
        }
        self.live_vertices += self.vertex_count() - self.before[0];
        self.live_vertices = self.live_vertices.saturating_sub(self.substitutions.len() - self.before[1]);
    }

    /// Returns the changes of vertices by the last merge.
    pub fn last(&self) -> Substitutions<'_> {
        let [vertices, substitutions] = self.before;
        Substitutions {
            pairs: &self.substitutions[substitutions..],
            first_new: vertices as u32,
            new_vertices: &self.new_vertices[vertices - self.input_vertices as usize..],
        }
    }

    /// Returns true if the last merge left the kept point's wedges as they were.
    pub fn kept_stay(&self) -> bool {
        self.kept_stay
    }

    fn merge(&mut self, a: u32, b: u32, renew: Option<([f32; 3], f32)>) {
        match renew {
            None => self.substitutions.push([a, b]),
            Some((position, weight)) => {
                let n = self.input_vertices + self.new_vertices.len() as u32;
                self.new_vertices.push(NewVertex { from: [a, b], weight, position });
                self.substitutions.push([a, n]);
                if b != a {
                    self.substitutions.push([b, n]);
                }
            }
        }
    }

    fn substitute_wedges(&mut self, surface: &WorkingSurface, pair: Pair, renew: Option<([f32; 3], f32)>) {
        let map = WedgeMap::chosen(surface, pair);
        let [lost, kept] = [pair.lost, pair.kept].map(|point| self.wedges_of(point));
        let Some(&anchor) = self.wedges[kept.clone()].first() else { return };
        // Too many wedges to keep apart: all become a single wedge.
        let all_one = map.overflows();
        let root = |kept: u32| if all_one { anchor } else { map.root(kept) };

        // Images of the kept wedges. Nothing to do where all stay: a hub may have many.
        let mut renamed = std::mem::take(&mut self.renamed);
        renamed.clear();
        let adds = map.pairs().iter().any(|pair| pair[0] == pair[1]);
        let all_stay = renew.is_none() && !all_one && !map.joins_kept() && !adds;
        self.kept_stay = all_stay;
        for i in kept.filter(|_| !all_stay) {
            let b = root(self.wedges[i]);
            let known = renamed.iter().find(|r| r[0] == b).map(|r| r[1]);
            let to = match (renew, known) {
                (_, Some(to)) => to,
                (None, None) => b,
                (Some((position, weight)), None) => {
                    let partner = if all_one { None } else { map.partner(b) };
                    self.make(NewVertex { from: [partner.unwrap_or(b), b], weight, position })
                }
            };
            if known.is_none() {
                renamed.push([b, to]);
            }
            if self.wedges[i] != to {
                self.substitutions.push([self.wedges[i], to]);
            }
        }
        for i in lost {
            let a = self.wedges[i];
            let to = if all_one { Some(anchor) } else { map.get(a) };
            let to = match to {
                Some(own) if own == a && surface.moves_wedges => {
                    let position = renew.map_or_else(|| self.position(anchor), |(position, _)| position);
                    let moved = self.make(NewVertex { from: [a, a], weight: 0.0, position });
                    renamed.push([a, moved]);
                    moved
                }
                Some(b) if b != a => renamed.iter().find(|r| r[0] == b).map_or(b, |r| r[1]),
                _ => renamed.first().map_or(anchor, |r| r[1]),
            };
            self.substitutions.push([a, to]);
        }
        if !all_stay {
            self.replace_wedges(pair.kept, &renamed);
        }
        self.renamed = renamed;
    }

    fn make(&mut self, vertex: NewVertex) -> u32 {
        self.new_vertices.push(vertex);
        self.vertex_count() as u32 - 1
    }

    /// Returns the position of a vertex, object units.
    fn position(&self, vertex: u32) -> [f32; 3] {
        match vertex.checked_sub(self.input_vertices) {
            Some(new) => self.new_vertices[new as usize].position,
            None => self.positions[vertex as usize],
        }
    }

    /// Sets a point's wedges to the images in `renamed`: in the old place where they fit, else at the end.
    fn replace_wedges(&mut self, point: u32, renamed: &[[u32; 2]]) {
        let span = &mut self.spans[point as usize];
        if renamed.len() > span[1] as usize {
            span[0] = self.wedges.len() as u32;
            self.wedges.resize(self.wedges.len() + renamed.len(), 0);
        }
        span[1] = renamed.len() as u32;
        for (wedge, &[_, to]) in self.wedges[span[0] as usize..].iter_mut().zip(renamed) {
            *wedge = to;
        }
    }

    /// Records the substitutions of a vanishing part: each vertex of `points` is replaced by `into`. Call before the
    /// surface changes. O(wedges).
    pub fn vanish(&mut self, surface: &WorkingSurface, points: impl Iterator<Item = u32>, into: u32) {
        let before = self.substitutions.len();
        for point in points {
            if self.spans.is_empty() {
                self.substitutions.push([surface.point_vertex(point), into]);
            } else {
                let wedges = self.wedges_of(point);
                self.substitutions.extend(self.wedges[wedges].iter().map(|&wedge| [wedge, into]));
                self.spans[point as usize][1] = 0;
            }
        }
        self.live_vertices = self.live_vertices.saturating_sub(self.substitutions.len() - before);
    }

    /// Reduces a point to a single vertex and returns the vertex, which replaces the point's other vertices. Part of a
    /// step in which the point's part vanishes.
    pub fn leave_one(&mut self, surface: &WorkingSurface, point: u32) -> u32 {
        if self.spans.is_empty() {
            return surface.point_vertex(point);
        }
        let wedges = self.wedges_of(point);
        let one = self.wedges[wedges.start];
        let before = self.substitutions.len();
        self.substitutions.extend(self.wedges[wedges].iter().skip(1).map(|&wedge| [wedge, one]));
        self.spans[point as usize][1] = 1;
        self.live_vertices = self.live_vertices.saturating_sub(self.substitutions.len() - before);
        one
    }

    /// Returns the target of `vertex` in the substitutions from number `first` on, or `vertex` where it has none.
    pub fn image(&self, vertex: u32, first: usize) -> u32 {
        self.substitutions[first..].iter().find(|s| s[0] == vertex).map_or(vertex, |s| s[1])
    }

    /// Number of substitutions so far.
    pub fn mark(&self) -> usize {
        self.substitutions.len()
    }

    /// Returns the range in `wedges` of the current vertices at a point.
    fn wedges_of(&self, point: u32) -> Range<usize> {
        let [start, count] = self.spans[point as usize].map(|i| i as usize);
        start..start + count
    }

    /// Ends the step. Takes the errors of surface and curves, the dead triangles and the number of live triangles.
    pub fn finish_step(&mut self, [surface, curve]: [f32; 2], dead: &[u32], live: usize) {
        self.step_error.push(surface.max(curve));
        if self.has_curves {
            self.parts.push([surface, curve]);
        }
        self.step_start.push(self.substitutions.len() as u32);
        self.triangles_after.push(live as u32);
        let end = self.step_error.len() as u32;
        dead.iter().for_each(|&t| self.triangle_end[t as usize] = end);
    }

    /// Ends the batch; returns false if nothing was done in it.
    pub fn finish_batch(&mut self) -> bool {
        let steps = self.steps() as u32;
        let any = steps > self.batch_end.last().copied().unwrap_or(0);
        if any {
            self.batch_end.push(steps);
        }
        any
    }

    /// Returns the sequence in recorded order, and per step the errors of surface and curves (empty where the input has
    /// no curves).
    pub fn finish(self, report: SimplifyReport) -> (CollapseSequence, Vec<[f32; 2]>) {
        let mut sequence = CollapseSequence {
            input_vertices: self.input_vertices,
            new_vertices: self.new_vertices,
            solved: Vec::new(),
            aliases: self.aliases,
            snaps: self.snaps,
            substitutions: self.substitutions,
            step_start: self.step_start,
            step_error: self.step_error,
            max_error: Vec::new(),
            surface_error: Vec::new(),
            curve_error: Vec::new(),
            triangles_after: self.triangles_after,
            triangle_end: self.triangle_end,
            batch_end: self.batch_end,
            report,
        };
        sequence.accumulate_errors();
        (sequence, self.parts)
    }
}

/// Lists the used wedges of each point by counting sort: start and count per point, and the vertices.
fn wedge_lists(topology: &Topology, used: &[bool]) -> (Vec<[u32; 2]>, Vec<u32>) {
    let wedges = || (0..used.len()).filter(|&v| used[v]);
    let point = |v: usize| topology.point_of()[v] as usize;
    let mut spans = vec![[0u32; 2]; topology.point_count()];
    wedges().for_each(|v| spans[point(v)][1] += 1);
    let mut start = 0;
    for span in &mut spans {
        span[0] = start;
        start += std::mem::take(&mut span[1]);
    }
    let mut list = vec![0; start as usize];
    for v in wedges() {
        let [start, count] = &mut spans[point(v)];
        list[(*start + *count) as usize] = v as u32;
        *count += 1;
    }
    (spans, list)
}
