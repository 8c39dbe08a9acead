//! An index buffer moved between resolutions at the cost of the difference.
//!
//! ```text
//!     buffer   | drawn of material 0 ...... | not drawn | drawn of material 1 ... | not drawn |
//! ```
//!
//! A vanishing triangle keeps its place and its corners. When the triangle comes back, the corners are right.

use std::sync::Arc;

use super::{Change, MaterialRange, Resolution, TomSteps};

#[derive(Debug, Clone)]
pub(super) struct Indices {
    steps: Arc<TomSteps>,
    buffer: Vec<u32>,
    ranges: Vec<MaterialRange>,
    resolution: Resolution,
}

impl Indices {
    /// Makes the buffer at full resolution.
    pub fn new(steps: Arc<TomSteps>) -> Self {
        let tom = steps.tom();
        let mut buffer = vec![0; 3 * tom.triangle_count()];
        let mut ranges = steps.empty_ranges().to_vec();
        for (t, corners) in tom.triangles().iter().enumerate() {
            let place = 3 * steps.place(t as u32) as usize;
            buffer[place..place + 3].copy_from_slice(corners);
            ranges[steps.range_of(t as u32)].count += 3;
        }
        let resolution = tom.finest();
        Self { steps, buffer, ranges, resolution }
    }

    pub fn steps(&self) -> &Arc<TomSteps> {
        &self.steps
    }

    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Returns all places, drawn or not.
    pub fn buffer(&self) -> &[u32] {
        &self.buffer
    }

    /// Returns the drawn range of each material, or a single range.
    pub fn ranges(&self) -> &[MaterialRange] {
        &self.ranges
    }

    /// Returns the resolution of this mesh nearest below a resolution that may come from another mesh: whole groups.
    pub fn rounded(&self, resolution: Resolution) -> Resolution {
        let tom = self.steps.tom();
        let vertices = tom.boundary_at_most(tom.clamp(resolution).vertices);
        // Counting triangles takes longer than all the rest of a still frame.
        if vertices == self.resolution.vertices { self.resolution } else { tom.resolution(vertices) }
    }

    /// Moves to a resolution of this mesh. Calls `wrote` with every place written, with some places twice.
    pub fn seek(&mut self, to: Resolution, mut wrote: impl FnMut(u32)) -> Change {
        let Self { steps, buffer, ranges, resolution: from } = self;
        let (tom, from) = (steps.tom(), *from);
        let mut written = 0;
        let mut write = |places: &[u32], vertex: u32| {
            for &place in places {
                buffer[place as usize] = vertex;
                wrote(place);
            }
            written += places.len();
        };
        for vertex in from.vertices..to.vertices {
            write(steps.moves(vertex), vertex);
        }
        let mut active = from.vertices;
        while active > to.vertices {
            let first = tom.boundary_at_most(active - 1);
            for vertex in first..active {
                write(steps.moves(vertex), tom.resolve(vertex, first));
            }
            active = first;
        }
        for triangle in from.triangles..to.triangles {
            ranges[steps.range_of(triangle)].count += 3;
        }
        for triangle in to.triangles..from.triangles {
            ranges[steps.range_of(triangle)].count -= 3;
        }
        self.resolution = to;
        Change { from, to, written }
    }

    /// Returns the bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.buffer[..]) + size_of_val(&self.ranges[..])
    }
}
