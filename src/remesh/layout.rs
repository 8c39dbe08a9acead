//! A map between a mesh and a coarser mesh, as a list of retriangulated polygons.
//!
//! ```text
//!          r2____r1                 r2____r1
//!          /\   /\                  /   _/ \            Both triangulations lie over the same flat polygon, so a point
//!      r3 /__\v/__\ r0    <-->   r3/__-----_\ r0        of one is a point of the other. The triangulations are fans:
//!         \  / \  /                \  -----_/           around a vertex inside, or around a vertex of the ring.
//!          \/___\/                  \/_____\/
//!          r4    r5                 r4    r5
//! ```
//!
//! The map of the whole mesh is the composition of all of them: continuous, and one to one, since each of them is. A point
//! travels in either direction in time proportional to the number of polygons it lies in, about the logarithm of the sizes'
//! ratio. (Lee et al. 1998 move the vertices; Liu et al. 2020 compose maps in this way.)

use glam::DVec2;

use crate::mesh::NONE;

/// A point of a triangulation: a face, and barycentric coordinates in it which sum to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub face: u32,
    pub weights: [f64; 3],
}

/// The vertex common to all triangles of a fan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hub {
    /// A vertex inside the polygon, or on the line between the ends of an open star.
    Inside(DVec2),
    /// A vertex of the ring.
    Ring(usize),
}

/// A face before a retriangulation, and which of its corners is the hub.
#[derive(Debug, Clone, Copy)]
pub(super) struct FanFace {
    pub face: u32,
    pub hub_corner: u8,
}

#[derive(Debug, Clone, Copy)]
struct Patch {
    /// First point of the ring; hubs inside come after it.
    points: u32,
    /// First of the faces before.
    before: u32,
    /// First face after.
    first_face: u32,
    /// Ring vertices.
    ring: u16,
    /// Hub before and after: a ring vertex, or `INSIDE`.
    hubs: [u16; 2],
    closed: bool,
}

const INSIDE: u16 = u16::MAX;

/// All retriangulations in order. About 100 bytes a triangle of the input.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    input_faces: u32,
    patches: Vec<Patch>,
    points: Vec<[f64; 2]>,
    /// `face << 2 | hub corner`.
    before: Vec<u32>,
    /// Patch that made each face beyond the input's.
    made_by: Vec<u32>,
    /// Patch that replaced each face, or `NONE`.
    replaced_by: Vec<u32>,
}

impl Layout {
    /// Without patches; with room for `patches`, of a few points more than usual: growing arrays take twice their size.
    pub fn new(input_faces: usize, patches: usize) -> Self {
        let mut replaced_by = Vec::with_capacity(input_faces + 5 * patches);
        replaced_by.resize(input_faces, NONE);
        Self {
            input_faces: input_faces as u32,
            patches: Vec::with_capacity(patches),
            points: Vec::with_capacity(8 * patches),
            before: Vec::with_capacity(7 * patches),
            made_by: Vec::with_capacity(5 * patches),
            replaced_by,
        }
    }

    /// Gives back room that is not needed.
    pub fn shrink(&mut self) {
        self.patches.shrink_to_fit();
        self.points.shrink_to_fit();
        self.before.shrink_to_fit();
        self.made_by.shrink_to_fit();
        self.replaced_by.shrink_to_fit();
    }

    /// Number of faces ever made, input faces included.
    pub fn face_count(&self) -> usize {
        self.replaced_by.len()
    }

    /// Whether no patch replaced a face.
    pub fn is_last(&self, face: u32) -> bool {
        self.replaced_by[face as usize] == NONE
    }

    /// Replaces a fan of faces by the fan around another hub of the same polygon. Returns the first new face: new faces are
    /// numbered in order around the ring, and their first corner is the hub.
    pub fn replace(&mut self, ring: &[DVec2], closed: bool, hubs: [Hub; 2], before: &[FanFace]) -> u32 {
        let first_face = self.face_count() as u32;
        let patch = self.patches.len() as u32;
        let (points, first_before) = (self.points.len() as u32, self.before.len() as u32);
        self.points.extend(ring.iter().map(|p| p.to_array()));
        let hubs_stored = hubs.map(|hub| match hub {
            Hub::Ring(at) => at as u16,
            Hub::Inside(_) => INSIDE,
        });
        for hub in hubs {
            if let Hub::Inside(at) = hub {
                self.points.push(at.to_array());
            }
        }
        self.before.extend(before.iter().map(|fan| fan.face << 2 | u32::from(fan.hub_corner)));
        for fan in before {
            self.replaced_by[fan.face as usize] = patch;
        }
        let made = Self::fan(ring.len(), closed, hubs_stored[1]).count();
        self.made_by.resize(self.made_by.len() + made, patch);
        self.replaced_by.resize(self.replaced_by.len() + made, NONE);
        self.patches.push(Patch {
            points,
            before: first_before,
            first_face,
            ring: ring.len() as u16,
            hubs: hubs_stored,
            closed,
        });
        first_face
    }

    /// Ring vertices of the triangles of a fan, in order.
    pub fn fan(ring: usize, closed: bool, hub: u16) -> impl Iterator<Item = [usize; 2]> {
        let count = if closed || hub != INSIDE { ring } else { ring - 1 };
        let hub = usize::from(hub);
        (0..count).map(move |i| [i, (i + 1) % ring]).filter(move |side| !side.contains(&hub))
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.patches[..])
            + size_of_val(&self.points[..])
            + 4 * (self.before.len() + self.made_by.len() + self.replaced_by.len())
    }

    fn ring(&self, patch: &Patch) -> &[[f64; 2]] {
        &self.points[patch.points as usize..][..usize::from(patch.ring)]
    }

    fn hub(&self, patch: &Patch, after: bool) -> DVec2 {
        let hub = patch.hubs[usize::from(after)];
        let at = match hub {
            INSIDE => usize::from(patch.ring) + usize::from(after && patch.hubs[0] == INSIDE),
            hub => usize::from(hub),
        };
        DVec2::from_array(self.points[patch.points as usize + at])
    }

    /// Returns the triangle of a fan that contains a point, and its weights: hub, then both ring vertices.
    fn locate(&self, patch: &Patch, after: bool, point: DVec2) -> (usize, [f64; 3]) {
        let ring = self.ring(patch);
        let hub = self.hub(patch, after);
        let mut best = (0, [1.0, 0.0, 0.0]);
        let mut largest = f64::NEG_INFINITY;
        let sides = Self::fan(ring.len(), patch.closed, patch.hubs[usize::from(after)]);
        for (number, [i, j]) in sides.enumerate() {
            let (a, b) = (DVec2::from_array(ring[i]) - hub, DVec2::from_array(ring[j]) - hub);
            let p = point - hub;
            let area = a.perp_dot(b);
            if area <= 0.0 {
                continue;
            }
            let (u, v) = (p.perp_dot(b) / area, a.perp_dot(p) / area);
            let weights = [1.0 - u - v, u, v];
            let least = weights[0].min(u).min(v);
            if least > largest {
                (best, largest) = ((number, weights), least);
                if least >= 0.0 {
                    break;
                }
            }
        }
        let weights = best.1.map(|weight| weight.max(0.0));
        let sum: f64 = weights.iter().sum();
        (best.0, weights.map(|weight| weight / sum))
    }

    /// Returns the point of the flat polygon at weights (hub, ring, ring) of the given triangle of a fan.
    fn flat(&self, patch: &Patch, after: bool, triangle: usize, weights: [f64; 3]) -> DVec2 {
        let ring = self.ring(patch);
        let hub = patch.hubs[usize::from(after)];
        let mut sides = Self::fan(ring.len(), patch.closed, hub);
        let [i, j] = sides.nth(triangle).unwrap_or_default();
        weights[0] * self.hub(patch, after)
            + weights[1] * DVec2::from_array(ring[i])
            + weights[2] * DVec2::from_array(ring[j])
    }

    /// Moves a point to the coarser mesh, as far as it goes.
    pub fn down(&self, mut place: Place) -> Place {
        while self.replaced_by[place.face as usize] != NONE {
            let patch = &self.patches[self.replaced_by[place.face as usize] as usize];
            let faces = &self.before[patch.before as usize..];
            let number = faces.iter().position(|entry| entry >> 2 == place.face).unwrap_or(0);
            let corner = (faces[number] & 3) as usize;
            let weights = [0, 1, 2].map(|k| place.weights[(corner + k) % 3]);
            let at = self.flat(patch, false, number, weights);
            let (triangle, weights) = self.locate(patch, true, at);
            place = Place { face: patch.first_face + triangle as u32, weights };
        }
        place
    }

    /// Moves a point to the input.
    pub fn up(&self, mut place: Place) -> Place {
        while let Some(made) = place.face.checked_sub(self.input_faces) {
            let patch = &self.patches[self.made_by[made as usize] as usize];
            let at = self.flat(patch, true, (place.face - patch.first_face) as usize, place.weights);
            let (number, weights) = self.locate(patch, false, at);
            let entry = self.before[patch.before as usize + number];
            let corner = (entry & 3) as usize;
            let mut of_face = [0.0; 3];
            for k in 0..3 {
                of_face[(corner + k) % 3] = weights[k];
            }
            place = Place { face: entry >> 2, weights: of_face };
        }
        place
    }
}
