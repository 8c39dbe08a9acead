//! Between the cut that a view asks for and the mesh that is drawn: budgets, and vertices that move.

use crate::adapt::{Budget, Change, Cut, Follow, Limits, LodOptions, Picture, Refinements, is_done};
use crate::view::{Criterion, Motion};

use super::{Surface, VertexHierarchy};

/// Who moves the vertices that splits bring.
pub(super) trait Movement {
    /// All go on by a share of their way.
    fn advance(&mut self, hierarchy: &VertexHierarchy, progress: f32);
    /// The vertices of a split start at their substitutes, or at their own places.
    fn open(&mut self, hierarchy: &VertexHierarchy, split: u32, smoothly: bool);
    /// They turn to their substitutes, or to their own places.
    fn turn(&mut self, hierarchy: &VertexHierarchy, split: u32, closing: bool);
    /// They are gone.
    fn end(&mut self, hierarchy: &VertexHierarchy, split: u32);
}

/// Nobody.
impl Movement for () {
    fn advance(&mut self, _: &VertexHierarchy, _: f32) {}
    fn open(&mut self, _: &VertexHierarchy, _: u32, _: bool) {}
    fn turn(&mut self, _: &VertexHierarchy, _: u32, _: bool) {}
    fn end(&mut self, _: &VertexHierarchy, _: u32) {}
}

/// What is drawn, and where.
struct Drawn<'a, M> {
    hierarchy: &'a VertexHierarchy,
    surface: &'a mut Surface,
    movement: &'a mut M,
}

impl<M: Movement> Picture for Drawn<'_, M> {
    fn cost(&self, split: u32) -> usize {
        self.hierarchy.owned(split).len()
    }

    fn advance(&mut self, progress: f32) {
        self.movement.advance(self.hierarchy, progress);
    }

    fn refine(&mut self, split: u32, smoothly: bool, there: impl Fn(u32) -> bool + Copy) {
        self.surface.split(self.hierarchy, split, there);
        self.movement.open(self.hierarchy, split, smoothly);
    }

    fn coarsen(&mut self, split: u32) {
        self.surface.collapse(self.hierarchy, split);
        self.movement.end(self.hierarchy, split);
    }

    fn close(&mut self, split: u32) {
        self.movement.turn(self.hierarchy, split, true);
    }

    fn reopen(&mut self, split: u32) {
        self.movement.turn(self.hierarchy, split, false);
    }
}

/// What a level of detail with limits, or with vertices that move, keeps besides its cut.
#[derive(Debug, Clone)]
pub(super) struct Pace {
    operations: usize,
    triangles: usize,
    budget: Option<Budget>,
    follow: Follow,
}

impl Pace {
    /// Where the cut is what is drawn.
    pub fn new(hierarchy: &VertexHierarchy, cut: &Cut, triangles: usize, moves: bool) -> Self {
        let follow = Follow::new(hierarchy, |split| cut.holds(split), triangles, moves);
        Self { operations: usize::MAX, triangles: usize::MAX, budget: None, follow }
    }

    /// Sets the limits. `triangles` is what the cut has.
    pub fn set(&mut self, options: &LodOptions, triangles: usize) {
        self.operations = options.operations.unwrap_or(usize::MAX);
        self.triangles = options.triangles.unwrap_or(usize::MAX);
        match (options.triangles, &mut self.budget) {
            (Some(limit), Some(budget)) => budget.set_limit(limit),
            (limit, budget) => *budget = limit.map(|limit| Budget::new(limit, triangles)),
        }
    }

    pub fn follow(&self) -> &Follow {
        &self.follow
    }

    /// One frame: vertices go on by `progress`, the cut moves to what the criterion needs within the budget, and what is drawn
    /// follows as far as it may.
    pub fn update<C: Criterion + ?Sized>(
        &mut self,
        (hierarchy, cut, surface): (&VertexHierarchy, &mut Cut, &mut Surface),
        criterion: &C,
        motion: Motion,
        progress: f32,
        movement: &mut impl Movement,
    ) -> Change {
        let mut picture = Drawn { hierarchy, surface, movement };
        let Self { operations, triangles, budget, follow } = self;
        follow.advance(progress, &mut picture);
        let mut report = match budget {
            Some(budget) => {
                let cost = |split: u32| hierarchy.owned(split).len();
                budget
                    .update(cut, hierarchy, criterion, motion, cost, |split, comes| follow.want(split, comes))
            }
            None => cut.update(hierarchy, criterion, motion, |_, split, comes| follow.want(split, comes)),
        };
        let smooth = progress < 1.0;
        let limits = Limits { operations: *operations, triangles: *triangles, smooth };
        let sees = |split: u32| criterion.sees(hierarchy.bounds(split));
        let (splits, collapses) = follow.run(hierarchy, limits, sees, &mut picture);
        (report.splits, report.collapses) = (splits, collapses);
        if follow.triangles() > *triangles && follow.pending() > 0 {
            // The number of triangles was lowered: that cannot wait.
            let (splits, collapses) = settle(follow, &mut picture);
            report.splits += splits;
            report.collapses += collapses;
        }
        Change {
            cut: report,
            triangles: follow.triangles(),
            pending: follow.pending(),
            moving: follow.transitions(),
            over_budget: follow.triangles() > *triangles,
        }
    }

    /// Shows what is wanted, at once.
    pub fn settle(
        &mut self,
        hierarchy: &VertexHierarchy,
        surface: &mut Surface,
        movement: &mut impl Movement,
    ) {
        settle(&mut self.follow, &mut Drawn { hierarchy, surface, movement });
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.follow.memory() + self.budget.as_ref().map_or(0, Budget::memory)
    }
}

fn settle<M: Movement>(follow: &mut Follow, picture: &mut Drawn<'_, M>) -> (usize, usize) {
    follow.advance(1.0, picture);
    follow.run(picture.hierarchy, Limits::NONE, |_| false, picture)
}

/// The fast way: what is asked for is drawn at once.
pub(super) fn direct<C: Criterion + ?Sized>(
    (hierarchy, cut, surface): (&VertexHierarchy, &mut Cut, &mut Surface),
    criterion: &C,
    motion: Motion,
) -> Change {
    let cut = cut.update(hierarchy, criterion, motion, |state, split, comes| {
        if comes {
            surface.split(hierarchy, split, |other| is_done(state, other));
        } else {
            surface.collapse(hierarchy, split);
        }
    });
    Change { cut, triangles: surface.triangle_count(), ..Change::default() }
}
