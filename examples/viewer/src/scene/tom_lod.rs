//! A totally ordered mesh that follows the view: one resolution for all of the model, by what its nearest point asks for.
//!
//! Shows what it takes to bring a structure of one's own under [`LevelOfDetail`]: a rule for what a view asks for, triangles by
//! group, and ranges that changed.

use std::sync::Arc;

use multires::adapt::{Change, Dirty, DirtyRanges, LevelOfDetail};
use multires::tom::{Level, TomCursor, TomSteps};
use multires::view::{Bounds, Criterion, ObjectView};

use super::instance::{Instance, LodSettings};
use crate::renderer::{Drawn, Values};

/// A cursor of a totally ordered mesh.
pub struct TomLod {
    cursor: TomCursor,
    /// Around all of the model, with an error of one diagonal.
    bounds: Bounds,
    diagonal: f32,
    /// Written triangles of every group, drawn or not.
    dirty: Vec<Dirty>,
    /// Triangles of every group at full resolution.
    room: Vec<usize>,
}

impl TomLod {
    /// An instance at the coarsest resolution. `bounds` is the model's box.
    pub fn new(steps: Arc<TomSteps>, bounds: [[f32; 3]; 2]) -> Self {
        let [low, high] = bounds.map(glam::Vec3::from_array);
        let (centre, diagonal) = ((low + high) * 0.5, (high - low).length());
        let mut cursor = TomCursor::new(steps);
        let mut room: Vec<usize> = cursor.ranges().iter().map(|range| range.count as usize / 3).collect();
        if room.is_empty() {
            // A mesh without triangles has one group too.
            room.push(0);
        }
        let mut dirty = vec![Dirty::default(); room.len()];
        dirty.iter_mut().zip(&room).for_each(|(dirty, &room)| dirty.mark_all(room));
        cursor.take_dirty();
        let coarsest = cursor.steps().tom().coarsest();
        cursor.seek(coarsest);
        let bounds = Bounds::new(centre.to_array(), 0.5 * diagonal, diagonal, diagonal);
        let mut lod = Self { cursor, bounds, diagonal, dirty, room };
        lod.mark();
        lod
    }

    /// Takes over what the cursor wrote.
    fn mark(&mut self) {
        let starts: Vec<u32> = self.cursor.ranges().iter().map(|range| range.start).collect();
        for written in self.cursor.take_dirty() {
            for ((dirty, &start), &room) in self.dirty.iter_mut().zip(&starts).zip(&self.room) {
                let first = written.start.saturating_sub(start as usize) / 3;
                let end = written.end.saturating_sub(start as usize).div_ceil(3).min(room);
                (first..end).for_each(|triangle| dirty.mark(triangle as u32));
            }
        }
    }

    fn seek(&mut self, level: Level) -> Change {
        let from = self.cursor.resolution();
        let to = self.cursor.steps().tom().at(level);
        let moved = self.cursor.seek(to);
        self.mark();
        let mut change = Change::default();
        change.triangles = moved.to.triangles();
        change.cut.tests = 1;
        change.cut.splits = moved.to.vertices().saturating_sub(from.vertices());
        change.cut.collapses = from.vertices().saturating_sub(moved.to.vertices());
        change
    }
}

impl LevelOfDetail for TomLod {
    fn adapt(&mut self, views: &[ObjectView]) -> Change {
        // By how much the tolerance would have to grow for an error of one diagonal to be none too large: what is left of the
        // diagonal is the largest error that is allowed.
        let urgency = views.urgency(&self.bounds);
        let level = match urgency {
            u if u > 0.0 => Level::Error((f64::from(self.diagonal) / u) as f32),
            _ => Level::Vertices(0),
        };
        self.seek(level)
    }

    fn groups(&self) -> usize {
        self.room.len()
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        let range = self.cursor.ranges().get(group).copied().unwrap_or_default();
        let (start, end) = (range.start as usize, (range.start + range.count) as usize);
        bytemuck::cast_slice(&self.cursor.buffer()[start..end])
    }

    fn vertices(&self) -> Option<&[u32]> {
        None
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        // A group that there is not has no triangles, so any marks will do.
        self.dirty[group.min(self.dirty.len() - 1)].ranges(self.triangles(group).len(), gap)
    }

    fn dirty_vertices(&self, _: usize) -> DirtyRanges<'_> {
        self.dirty[0].ranges(0, 0)
    }

    fn clean(&mut self) {
        for (group, &room) in self.room.iter().enumerate() {
            // Triangles that are not drawn keep their marks: nobody uploaded them.
            let drawn = self.cursor.ranges().get(group).map_or(0, |range| range.count as usize / 3);
            let dirty = &mut self.dirty[group];
            let waiting: Vec<_> = dirty.ranges(room, 0).filter(|range| range.end > drawn).collect();
            dirty.clear();
            for range in waiting {
                (range.start.max(drawn)..range.end).for_each(|triangle| dirty.mark(triangle as u32));
            }
        }
    }
}

impl Drawn for TomLod {
    fn lod(&self) -> &dyn LevelOfDetail {
        self
    }

    fn lod_mut(&mut self) -> &mut dyn LevelOfDetail {
        self
    }

    fn values(&self) -> Values<'_> {
        Values::Shared
    }
}

impl Instance for TomLod {
    fn set(&mut self, _: &LodSettings) -> bool {
        true
    }

    fn settle(&mut self) {}

    fn refine_fully(&mut self) {
        self.seek(Level::Ratio(1.0));
    }

    fn memory(&self) -> usize {
        self.cursor.memory() + self.dirty.iter().map(Dirty::memory).sum::<usize>()
    }
}
