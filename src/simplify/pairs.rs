//! Vertex pairs that no edge joins: points closer than a distance, so that separate parts may grow together (TOM 4.1).
//!
//! Found once, by a grid of cells as wide as the distance; carried along as points merge. Two chains in flat arrays:
//! one of pairs around each point, and a union of merged points.

use glam::Vec3;

use crate::mesh::NONE;

use super::surface::Surface;

/// Most pairs kept per point, the nearest; without it a distance far too large would make quadratically many.
const MOST: usize = 8;

/// The points that each point may be joined with.
#[derive(Debug, Clone, Default)]
pub(super) struct Partners {
    /// First and last entry of each point's chain.
    first: Vec<u32>,
    last: Vec<u32>,
    /// Partner and next entry.
    entries: Vec<[u32; 2]>,
    /// The point that each point was merged into, or itself.
    merged: Vec<u32>,
}

impl Partners {
    /// All pairs without an edge that are at most `distance` (inner units) apart; none where it is 0 or not a number.
    /// O(n) expected for distances near the spacing of points.
    pub fn new(surface: &Surface, distance: f64) -> Self {
        if distance.is_nan() || distance <= 0.0 {
            return Self::default();
        }
        let points: Vec<u32> =
            (0..surface.point_count() as u32).filter(|&p| surface.valence(p) > 0).collect();
        let mut result = Self {
            first: vec![NONE; surface.point_count()],
            last: vec![NONE; surface.point_count()],
            entries: Vec::new(),
            merged: (0..surface.point_count() as u32).collect(),
        };
        // Cells no narrower than the distance, and no more of them an axis than 2^20.
        let cell = (distance as f32).max(2f32.powi(-20));
        let key = |p: Vec3| (p / cell).floor().as_ivec3();
        let code = |k: glam::IVec3| {
            let part = |x: i32| (i64::from(x) + (1 << 20)) as u64 & 0x1f_ffff;
            part(k.x) << 42 | part(k.y) << 21 | part(k.z)
        };
        let mut cells: Vec<(u64, u32)> = points.iter().map(|&p| (code(key(surface.at(p))), p)).collect();
        cells.sort_unstable();
        let mut near: Vec<(f32, u32)> = Vec::new();
        for &point in &points {
            let p = surface.at(point);
            let home = key(p);
            near.clear();
            for dx in -1..=1 {
                for dy in -1..=1 {
                    // The three cells of a row along z are neighbours in the sorted list.
                    let from = code(home + glam::IVec3::new(dx, dy, -1));
                    let to = code(home + glam::IVec3::new(dx, dy, 1));
                    let start = cells.partition_point(|c| c.0 < from);
                    for &(_, other) in cells[start..].iter().take_while(|c| c.0 <= to) {
                        let d = p.distance(surface.at(other));
                        if other != point && f64::from(d) <= distance {
                            let worse = near.len() == MOST && near[MOST - 1] <= (d, other);
                            if !worse && surface.edge_kind(point, other).is_none() {
                                let at = near.partition_point(|n| *n < (d, other));
                                near.insert(at, (d, other));
                                near.truncate(MOST);
                            }
                        }
                    }
                }
            }
            for &(_, other) in &near {
                result.push(point, other);
            }
        }
        result
    }

    /// Whether no point has a partner.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    fn push(&mut self, point: u32, other: u32) {
        let entry = self.entries.len() as u32;
        self.entries.push([other, NONE]);
        match self.last[point as usize] {
            NONE => self.first[point as usize] = entry,
            last => self.entries[last as usize][1] = entry,
        }
        self.last[point as usize] = entry;
    }

    /// Calls `visit` with what the partners of a point have become.
    #[inline]
    pub fn for_each(&self, point: u32, mut visit: impl FnMut(u32)) {
        let Some(&first) = self.first.get(point as usize) else { return };
        let mut at = first;
        while at != NONE {
            let [other, next] = self.entries[at as usize];
            let other = self.current(other);
            if other != point {
                visit(other);
            }
            at = next;
        }
    }

    fn current(&self, mut point: u32) -> u32 {
        while self.merged[point as usize] != point {
            point = self.merged[point as usize];
        }
        point
    }

    /// Gives the partners of `lost` to `kept`.
    pub fn merge(&mut self, lost: u32, kept: u32) {
        if self.first.is_empty() {
            return;
        }
        self.merged[lost as usize] = kept;
        let first = self.first[lost as usize];
        if first == NONE {
            return;
        }
        match self.last[kept as usize] {
            NONE => self.first[kept as usize] = first,
            last => self.entries[last as usize][1] = first,
        }
        self.last[kept as usize] = self.last[lost as usize];
        self.first[lost as usize] = NONE;
        self.last[lost as usize] = NONE;
    }
}
