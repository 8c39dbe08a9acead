//! The corners around each point: slices of a shared pool, each moved to the pool's end when it outgrows its place.
//!
//! An entry is `4 * triangle + slot`; `slot`: corner of the triangle at the point.

use crate::mesh::NONE;

use super::hub_edges::HUB;

/// The corners around every point.
#[derive(Debug, Clone)]
pub(crate) struct PointStars {
    pool: Vec<u32>,
    /// Start, length and room of each star.
    spans: Vec<Span>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Span {
    start: usize,
    len: u32,
    room: u32,
}

impl PointStars {
    pub fn new(triangles: &[[u32; 3]], points: usize) -> Self {
        let mut spans = vec![Span::default(); points];
        let live = || triangles.iter().enumerate().filter(|(_, t)| t[0] != NONE);
        for (_, t) in live() {
            for &p in t {
                spans[p as usize].room += 1;
            }
        }
        let mut start = 0;
        for span in &mut spans {
            span.start = start;
            start += span.room as usize;
        }
        // Merged stars move to the end: about twice as much again over a whole simplification.
        let mut pool = Vec::with_capacity(start * 3);
        pool.resize(start, 0);
        for (i, t) in live() {
            for (slot, &p) in t.iter().enumerate() {
                let span = &mut spans[p as usize];
                pool[span.start + span.len as usize] = (i as u32) << 2 | slot as u32;
                span.len += 1;
            }
        }
        Self { pool, spans }
    }

    #[inline]
    pub fn of(&self, point: u32) -> &[u32] {
        let Span { start, len, .. } = self.spans[point as usize];
        &self.pool[start..start + len as usize]
    }

    /// Returns the place of a triangle in a star.
    pub fn find(&self, point: u32, triangle: u32) -> Option<usize> {
        let star = self.of(point);
        let is_it = |entry: &u32| entry >> 2 == triangle;
        let mut from = 0;
        if star.len() > HUB {
            // In wide steps.
            let mut chunks = star.chunks(32);
            let chunk = chunks.position(|chunk| chunk.iter().fold(false, |any, entry| any | is_it(entry)));
            from = 32 * chunk.unwrap_or(0);
        }
        star[from..].iter().position(is_it).map(|at| from + at)
    }

    /// Removes a triangle, which occurs once.
    pub fn remove(&mut self, point: u32, triangle: u32) {
        if let Some(at) = self.find(point, triangle) {
            let Span { start, len, .. } = self.spans[point as usize];
            self.pool[start..start + len as usize].copy_within(at + 1.., at);
            self.spans[point as usize].len -= 1;
        }
    }

    #[inline]
    pub fn retain(&mut self, point: u32, keep: impl Fn(u32) -> bool) {
        let span = &mut self.spans[point as usize];
        let star = &mut self.pool[span.start..span.start + span.len as usize];
        // Branchless compaction: the place is unpredictable.
        let mut kept = 0;
        for i in 0..star.len() {
            let entry = star[i];
            star[kept] = entry;
            kept += usize::from(keep(entry >> 2));
        }
        span.len = kept as u32;
    }

    pub fn clear(&mut self, point: u32) {
        self.spans[point as usize].len = 0;
    }

    pub fn append(&mut self, point: u32, entries: &[u32]) {
        let span = self.spans[point as usize];
        let end = span.start + span.len as usize;
        let len = span.len + entries.len() as u32;
        if len > span.room {
            let start = self.pool.len();
            self.pool.extend_from_within(span.start..end);
            self.pool.extend_from_slice(entries);
            // Room in proportion: a hub swallowing its neighbours is not copied each time.
            let room = if len < 32 { len + 2 } else { len + len / 2 };
            self.pool.resize(start + room as usize, 0);
            self.spans[point as usize] = Span { start, len, room };
        } else {
            self.pool[end..end + entries.len()].copy_from_slice(entries);
            self.spans[point as usize].len = len;
        }
    }
}
