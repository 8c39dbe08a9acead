//! A state between two levels: which vertices move, and where to.

use std::ops::Range;

use crate::adapt::Blend;

use super::Gmesh;

/// A state of a g-mesh: a level, and the share of the way of its moving vertices to their targets in the next level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Morph {
    /// The level whose triangles are drawn; 0 is the finest.
    pub level: usize,
    /// Share of the way to the next level, 0 to 1. 0 for the last level.
    pub share: f32,
}

impl Morph {
    /// Makes the state at a position: the level plus the share of the way to the next level. `levels` counts the levels.
    /// Positions are clamped; NaN is the finest level.
    pub(super) fn at(position: f32, levels: usize) -> Self {
        let last = levels.saturating_sub(1);
        if position.is_nan() || position <= 0.0 {
            return Self::default();
        }
        if position >= last as f32 {
            return Self { level: last, share: 0.0 };
        }
        let level = position as usize;
        Self { level, share: position - level as f32 }
    }

    /// Returns the position of the state: the level plus the share of the way to the next level.
    pub(super) fn position(self) -> f32 {
        self.level as f32 + self.share
    }
}

impl Gmesh {
    /// Returns the state with a level and share that exist: the level at most the last, the share 0 to 1, and 0 for the last
    /// level and for NaN.
    pub fn clamped(&self, morph: Morph) -> Morph {
        let last = self.levels().len() - 1;
        if morph.level >= last {
            return Morph { level: last, share: 0.0 };
        }
        let share = if morph.share > 0.0 { morph.share.min(1.0) } else { 0.0 };
        Morph { level: morph.level, share }
    }

    /// Returns the vertices moving while a level is drawn: behind the prefix of the next level. Empty for the last level.
    pub fn moving(&self, level: usize) -> Range<usize> {
        let count = |level: usize| self.levels().get(level).map_or(0, |level| level.vertices);
        let end = count(level);
        let start = if level + 1 < self.levels().len() { count(level + 1) } else { end };
        start..end
    }

    /// Returns a bound for the error of a state, object units: the level's at rest, the next level's on the way. A bound in
    /// proportion to the share would not hold: errors are distances between surfaces, and a surface half-way between two may
    /// be nearly as far off as the farther of them.
    pub fn error(&self, morph: Morph) -> f32 {
        let Morph { level, share } = self.clamped(morph);
        self.levels()[if share == 0.0 { level } else { level + 1 }].error
    }

    /// Fills `drawn` with the vertices of a state: the prefix of its level, each value `(1 - share) * own + share *
    /// target's` where it moves. Draw with the level's triangles ([`Gmesh::triangles`]). `values` are in the structure's
    /// order; vertices without a value are left out. O(vertices of the level).
    ///
    /// ```
    /// use multires::gmesh::{Gmesh, Morph};
    /// use multires::{Structure, mesh::shapes};
    ///
    /// let mesh = shapes::rock(1_000, 1);
    /// let model = Gmesh::bake(&mesh)?;
    /// let values = model.arrange(mesh.positions())?;
    /// let mut drawn = Vec::new();
    /// model.structure().fill(&values, Morph { level: 1, share: 0.25 }, &mut drawn);
    /// assert_eq!(drawn.len(), model.structure().levels()[1].vertices);
    /// # Ok::<(), multires::Error>(())
    /// ```
    pub fn fill<V: Blend>(&self, values: &[V], morph: Morph, drawn: &mut Vec<V>) {
        let Morph { level, share } = self.clamped(morph);
        let moving = self.moving(level);
        drawn.clear();
        drawn.extend_from_slice(&values[..moving.end.min(values.len())]);
        if share > 0.0 {
            let from = moving.start.min(drawn.len());
            for (value, &target) in drawn[from..].iter_mut().zip(&self.targets()[from..]) {
                if let Some(target) = values.get(target as usize) {
                    *value = value.blend(target, share);
                }
            }
        }
    }

    /// Returns the value of each vertex's target, its own where it has none: the second vertex stream of the shader
    /// ([`MORPH_WGSL`](super::MORPH_WGSL)). `values` are in the structure's order. O(vertices).
    pub fn target_values<V: Copy>(&self, values: &[V]) -> Vec<V> {
        let targets = values.iter().zip(self.targets());
        targets.map(|(own, &target)| values.get(target as usize).copied().unwrap_or(*own)).collect()
    }
}
