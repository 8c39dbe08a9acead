//! Writes down what each collapse does to vertices and triangles, as the [`CollapseSequence`] wants it.

use std::ops::Range;

use crate::mesh::{Mesh, NONE, Topology};

use super::metric::{Pair, Substitutions};
use super::oracle::WedgeMap;
use super::report::SimplifyReport;
use super::sequence::{CollapseSequence, NewVertex};
use super::surface::Surface;

/// The sequence as it grows.
pub(super) struct Recorder {
    input_vertices: u32,
    new_vertices: Vec<NewVertex>,
    aliases: Vec<[u32; 2]>,
    substitutions: Vec<[u32; 2]>,
    step_start: Vec<u32>,
    step_error: Vec<f32>,
    /// Per step the errors of surface and curves; empty where the input has no curves.
    parts: Vec<[f32; 2]>,
    triangles_after: Vec<u32>,
    triangle_end: Vec<u32>,
    batch_end: Vec<u32>,
    live_vertices: usize,
    /// Start and number of every point's wedges; empty where every point has one. A merge never leaves a point more
    /// wedges than it had, so new ones take the old ones' places.
    spans: Vec<[u32; 2]>,
    wedges: Vec<u32>,
    /// The kept point's wedges and the vertex that each becomes, in the merge at hand.
    renamed: Vec<[u32; 2]>,
    /// Vertices and substitutions before the last merge.
    before: [usize; 2],
    has_curves: bool,
}

impl Recorder {
    pub fn new(mesh: &Mesh, topology: &Topology, surface: &Surface) -> Self {
        let wedge_of = topology.wedge_of();
        let aliases = (0..wedge_of.len() as u32)
            .filter(|&v| wedge_of[v as usize] != v)
            .map(|v| [v, wedge_of[v as usize]]);
        let mut used = vec![false; wedge_of.len()];
        for t in 0..surface.triangle_count() as u32 {
            if surface.triangle(t).is_some() {
                surface.corner_vertices(t).iter().for_each(|&v| used[v as usize] = true);
            }
        }
        let (spans, wedges) =
            if surface.has_seams() { wedge_lists(topology, &used) } else { (Vec::new(), Vec::new()) };
        let end = |t: usize| if surface.triangle(t as u32).is_some() { NONE } else { 0 };
        let steps = surface.point_count();
        let mut step_start = Vec::with_capacity(steps + 1);
        step_start.push(0);
        let mut triangles_after = Vec::with_capacity(steps + 1);
        triangles_after.push(surface.live_triangles() as u32);
        Self {
            input_vertices: wedge_of.len() as u32,
            new_vertices: Vec::new(),
            aliases: aliases.collect(),
            substitutions: Vec::with_capacity(steps),
            step_start,
            step_error: Vec::with_capacity(steps),
            parts: Vec::new(),
            triangles_after,
            triangle_end: (0..mesh.triangles().len()).map(end).collect(),
            batch_end: Vec::new(),
            live_vertices: used.iter().filter(|&&u| u).count(),
            spans,
            wedges,
            renamed: Vec::new(),
            before: [0; 2],
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

    /// The substitutions of merging `pair`, asked before the surface changes: `renew` is the new position (object
    /// units) and the share of `kept` in blends, or `None` where `kept` stays as it is. O(wedges).
    pub fn substitute(&mut self, surface: &Surface, pair: Pair, renew: Option<([f32; 3], f32)>) {
        self.before = [self.vertex_count(), self.substitutions.len()];
        if self.spans.is_empty() {
            let (a, b) = (surface.point_vertex(pair.lost), surface.point_vertex(pair.kept));
            self.merge(a, b, renew);
        } else {
            self.substitute_wedges(surface, pair, renew);
        }
        self.live_vertices += self.vertex_count() - self.before[0];
        self.live_vertices = self.live_vertices.saturating_sub(self.substitutions.len() - self.before[1]);
    }

    /// What the last merge did to vertices; `position` in the inner frame.
    pub fn last(&self, position: [f32; 3]) -> Substitutions<'_> {
        let [vertices, substitutions] = self.before;
        Substitutions {
            position,
            pairs: &self.substitutions[substitutions..],
            first_new: vertices as u32,
            new_vertices: &self.new_vertices[vertices - self.input_vertices as usize..],
        }
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

    fn substitute_wedges(&mut self, surface: &Surface, pair: Pair, renew: Option<([f32; 3], f32)>) {
        let map = WedgeMap::new(surface, pair);
        let [lost, kept] = [pair.lost, pair.kept].map(|point| self.wedges_of(point));
        let first_kept = self.wedges[kept.clone()].first();
        let Some(&anchor) = map.pairs().first().map(|p| &p[1]).or(first_kept) else { return };
        // Without a side to go to, the seam ends here: all wedges become one.
        let exact = map.is_complete() || map.pairs().is_empty();
        let target = |a: u32| if exact { map.get(a).unwrap_or(anchor) } else { anchor };

        // What the kept wedges become.
        let mut renamed = std::mem::take(&mut self.renamed);
        renamed.clear();
        for i in kept.clone() {
            let b = self.wedges[i];
            let b = if exact { b } else { anchor };
            let known = renamed.iter().find(|r| r[0] == b);
            let to = match (renew, known) {
                (None, _) => b,
                (_, Some(&[_, to])) => to,
                (Some((position, weight)), None) => {
                    let partner = map.pairs().iter().find(|p| exact && p[1] == b).map_or(b, |p| p[0]);
                    self.new_vertices.push(NewVertex { from: [partner, b], weight, position });
                    self.vertex_count() as u32 - 1
                }
            };
            renamed.push([b, to]);
            if self.wedges[i] != to {
                self.substitutions.push([self.wedges[i], to]);
            }
        }
        for i in lost {
            let a = self.wedges[i];
            let b = target(a);
            let to = renamed.iter().find(|r| r[0] == b).map_or(b, |r| r[1]);
            self.substitutions.push([a, to]);
        }
        let span = &mut self.spans[pair.kept as usize];
        span[1] = if exact { span[1] } else { 1 };
        for (i, &[_, to]) in kept.zip(&renamed).take(span[1] as usize) {
            self.wedges[i] = to;
        }
        self.renamed = renamed;
    }

    /// What the substitutions recorded last make of a vertex.
    pub fn image(&self, vertex: u32, first: usize) -> u32 {
        self.substitutions[first..].iter().find(|s| s[0] == vertex).map_or(vertex, |s| s[1])
    }

    /// Number of substitutions so far.
    pub fn mark(&self) -> usize {
        self.substitutions.len()
    }

    /// Where the vertices that sit at a point now are listed.
    fn wedges_of(&self, point: u32) -> Range<usize> {
        let [start, count] = self.spans[point as usize].map(|i| i as usize);
        start..start + count
    }

    /// Ends the step: the errors of surface and curves, and what vanished.
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

    /// Ends the batch, if anything was done in it.
    pub fn finish_batch(&mut self) -> bool {
        let steps = self.steps() as u32;
        let any = steps > self.batch_end.last().copied().unwrap_or(0);
        if any {
            self.batch_end.push(steps);
        }
        any
    }

    /// The sequence, in the order it was recorded, and per step the errors of surface and curves; none where the input
    /// has no curves.
    pub fn finish(self, report: SimplifyReport) -> (CollapseSequence, Vec<[f32; 2]>) {
        let mut sequence = CollapseSequence {
            input_vertices: self.input_vertices,
            new_vertices: self.new_vertices,
            solved: Vec::new(),
            aliases: self.aliases,
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

/// The used wedges of every point: start and number of each, and vertices; by counting.
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
