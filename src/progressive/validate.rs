//! Checks all invariants of a progressive mesh. Files are let in through here only.
//!
//! Tables are checked first. Then all splits are applied from the base mesh up. Each split must exactly invert its
//! step. On the way, the current level must be reached bit for bit.

use crate::mesh::{MAX_ELEMENTS, NONE};

use super::{ProgressiveError, ProgressiveMesh};

impl ProgressiveMesh {
    /// Checks the invariants used by every other call: levels are prefixes, and each split exactly inverts its step.
    /// O(vertices + triangles + moved corners), with a copy of the whole mesh.
    ///
    /// Succeeds for every mesh made by [`ProgressiveMesh::new`]. Files are let in through it only.
    ///
    /// # Errors
    /// The first element violating an invariant.
    pub fn validate(&self) -> Result<(), ProgressiveError> {
        self.check_tables()?;
        self.check_positions()?;
        let mut mesh = self.clone();
        mesh.seek(self.len());
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            mesh.check_triangle(triangle, corners)?;
        }
        while mesh.steps() > 0 {
            mesh.check_split()?;
            mesh.refine();
            mesh.check_split_done()?;
            self.check_level(&mesh)?;
        }
        Ok(())
    }

    fn check_tables(&self) -> Result<(), ProgressiveError> {
        let Some(steps) = self.vertices_after.len().checked_sub(1) else {
            return Err(ProgressiveError::Length { what: "levels", found: 0, expected: 1 });
        };
        let (vertices, triangles) = (self.positions.len(), self.triangles.len());
        for (what, found) in [("steps", steps), ("vertices", vertices), ("triangles", triangles)] {
            expect(what, found, found.min(MAX_ELEMENTS))?;
        }
        expect("steps", self.steps, self.steps.min(steps))?;
        for (what, after, most) in [
            ("vertex counts", &self.vertices_after, vertices),
            ("triangle counts", &self.triangles_after, triangles),
            ("place counts", &self.places_after, self.places.len()),
        ] {
            expect(what, after.len(), steps + 1)?;
            expect(what, after[0] as usize, most)?;
            if let Some(entry) = after.windows(2).position(|w| w[0] < w[1]) {
                return Err(ProgressiveError::Order { what, entry: entry + 1 });
            }
        }
        let base = self.vertices_after[steps] as usize;
        expect("places at the base", self.places_after[steps] as usize, 0)?;
        expect("pairs", self.parted.len(), vertices - base)?;
        for (pair, &[k, l]) in self.parted.iter().enumerate() {
            if l as usize != base + pair || k > l {
                return Err(ProgressiveError::Pair { pair, k, l });
            }
        }
        expect("corner starts", self.corner_start.len(), self.parted.len() + 1)?;
        expect("first corner start", self.corner_start[0] as usize, 0)?;
        expect("last corner start", self.corner_start[self.parted.len()] as usize, self.corners.len())?;
        if let Some(entry) = self.corner_start.windows(2).position(|w| w[0] > w[1]) {
            return Err(ProgressiveError::Order { what: "corner starts", entry: entry + 1 });
        }
        let beyond = self.corners.iter().position(|&corner| (corner / 3) as usize >= triangles);
        if let Some(at) = beyond {
            let pair = self.corner_start.partition_point(|&start| start as usize <= at) - 1;
            return Err(ProgressiveError::Corner { pair, corner: self.corners[at] });
        }
        check_permutation("vertices", &self.vertex_order, vertices)?;
        check_permutation("triangles", &self.triangle_order, triangles)?;
        let mut earlier = 0;
        for (entry, &end) in self.batches.iter().enumerate() {
            if end < earlier || end as usize > steps {
                return Err(ProgressiveError::Order { what: "batches", entry });
            }
            earlier = end;
        }
        expect("batched steps", earlier as usize, steps)
    }

    fn check_positions(&self) -> Result<(), ProgressiveError> {
        let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
        if let Some(slot) = self.positions.iter().position(|p| !finite(p)) {
            return Err(ProgressiveError::NonFinitePosition { slot });
        }
        for (place, moved) in self.places.iter().enumerate() {
            if moved.slot as usize >= self.positions.len() || bits(moved.fine) == bits(moved.coarse) {
                return Err(ProgressiveError::Place { place, slot: moved.slot });
            }
            if !(finite(&moved.fine) && finite(&moved.coarse)) {
                return Err(ProgressiveError::NonFinitePosition { slot: moved.slot as usize });
            }
        }
        Ok(())
    }

    /// Checks the corners and slots of the next split: they must be as left by the step it undoes.
    fn check_split(&self) -> Result<(), ProgressiveError> {
        let step = self.steps() - 1;
        let (vertices, triangles) = (self.positions().len(), self.triangles().len());
        for pair in self.parted_range(step) {
            let [k, _] = self.parted[pair];
            for &corner in &self.corners[self.corner_range(pair)] {
                let triangle = (corner / 3) as usize;
                let there = triangle < triangles && (k as usize) < vertices;
                if !there || self.triangles[triangle][(corner % 3) as usize] != k {
                    return Err(ProgressiveError::Corner { pair, corner });
                }
            }
        }
        for place in self.place_range(step) {
            let moved = &self.places[place];
            let slot = moved.slot as usize;
            if slot >= vertices || bits(self.positions[slot]) != bits(moved.coarse) {
                return Err(ProgressiveError::Place { place, slot: moved.slot });
            }
        }
        Ok(())
    }

    /// Checks the corners and slots written by the last split, and the slots named by added triangles.
    fn check_split_done(&self) -> Result<(), ProgressiveError> {
        let step = self.steps();
        for pair in self.parted_range(step) {
            let [_, l] = self.parted[pair];
            for &corner in &self.corners[self.corner_range(pair)] {
                if self.triangles[(corner / 3) as usize][(corner % 3) as usize] != l {
                    return Err(ProgressiveError::Corner { pair, corner });
                }
            }
        }
        for place in self.place_range(step) {
            let moved = &self.places[place];
            if bits(self.positions[moved.slot as usize]) != bits(moved.fine) {
                return Err(ProgressiveError::Place { place, slot: moved.slot });
            }
        }
        let came = self.triangles_after[step + 1] as usize..self.triangles_after[step] as usize;
        came.into_iter().try_for_each(|triangle| self.check_triangle(triangle, &self.triangles[triangle]))
    }

    fn check_triangle(&self, triangle: usize, corners: &[u32; 3]) -> Result<(), ProgressiveError> {
        match corners.iter().find(|&&slot| slot as usize >= self.positions().len()) {
            Some(&slot) => Err(ProgressiveError::Triangle { triangle, slot }),
            None => Ok(()),
        }
    }

    /// Checks bit equality with `level`, if both are after the same number of steps.
    fn check_level(&self, level: &Self) -> Result<(), ProgressiveError> {
        let same = self.steps != level.steps
            || self.triangles == level.triangles
                && self.positions.iter().zip(&level.positions).all(|(&a, &b)| bits(a) == bits(b));
        if same { Ok(()) } else { Err(ProgressiveError::Level { steps: self.steps }) }
    }
}

fn bits(position: [f32; 3]) -> [u32; 3] {
    position.map(f32::to_bits)
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), ProgressiveError> {
    if found == expected { Ok(()) } else { Err(ProgressiveError::Length { what, found, expected }) }
}

fn check_permutation(what: &'static str, order: &[u32], count: usize) -> Result<(), ProgressiveError> {
    expect(what, order.len(), count)?;
    let mut place_of = vec![NONE; count];
    for (place, &index) in order.iter().enumerate() {
        match place_of.get_mut(index as usize) {
            Some(known) if *known == NONE => *known = place as u32,
            _ => return Err(ProgressiveError::NotPermutation { what, place, index }),
        }
    }
    Ok(())
}

/// Deserialised fields, not validated yet.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
pub(super) struct Parts {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    vertex_order: Vec<u32>,
    triangle_order: Vec<u32>,
    vertices_after: Vec<u32>,
    triangles_after: Vec<u32>,
    places_after: Vec<u32>,
    parted: Vec<[u32; 2]>,
    corner_start: Vec<u32>,
    corners: Vec<u32>,
    places: Vec<super::progressive_mesh::Place>,
    batches: Vec<u32>,
    steps: usize,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for ProgressiveMesh {
    type Error = ProgressiveError;

    fn try_from(parts: Parts) -> Result<Self, ProgressiveError> {
        let mesh = Self {
            positions: parts.positions,
            triangles: parts.triangles,
            vertex_order: parts.vertex_order,
            triangle_order: parts.triangle_order,
            vertices_after: parts.vertices_after,
            triangles_after: parts.triangles_after,
            places_after: parts.places_after,
            parted: parts.parted,
            corner_start: parts.corner_start,
            corners: parts.corners,
            places: parts.places,
            batches: parts.batches,
            steps: parts.steps,
        };
        mesh.validate()?;
        Ok(mesh)
    }
}
