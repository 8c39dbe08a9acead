//! Labels faces: the state of a single face determines the states of all faces of its component.
//!
//! ```text
//!            o            In a subdivided complex every face is a centre (3) or the corner face at an old vertex:
//!           /0\           the old vertex is its corner 0, 1 or 2. Crossing an edge leaves no choice:
//!          m---m
//!         /0\3/0\         centre -> the corner face whose old vertex is opposite the edge
//!        o---m---o        corner -> across the edge opposite its old vertex: the centre
//!         \0/3\0/                   across another edge: the corner faces at the same old vertex, all of them
//!          m---m                    where three or more faces meet
//! ```
//!
//! So there are four assumptions about a component, one for each state of its first face. Each is followed breadth-first to the
//! end or to the first contradiction, in time linear in the faces reached.

use super::complex::{Complex, FaceComplex};
use super::stop::Stop;

/// State of a centre. States 0, 1 and 2: a corner face whose old vertex is its corner 0, 1 or 2.
pub(super) const CENTRE: u8 = 3;
/// Number of states.
pub(super) const STATES: u8 = 4;
const UNKNOWN: u8 = STATES;

/// Why an assumption fails, and how many faces it reached.
pub(super) struct Refusal {
    pub reached: usize,
    pub stop: Stop,
}

/// States of faces, with the memory to find them.
#[derive(Default)]
pub(super) struct Labels {
    /// At least as many as faces; `UNKNOWN` for all faces outside the queue.
    state: Vec<u8>,
    /// Faces of known state, in the order reached.
    queue: Vec<u32>,
}

impl Labels {
    /// Returns the state of a face after [`Labels::spread`].
    pub fn state(&self, face: u32) -> u8 {
        self.state[face as usize]
    }

    /// Labels all faces of a connected complex from the state of the first.
    pub fn spread(&mut self, complex: &Complex, surface: &FaceComplex, first: u8) -> Result<(), Refusal> {
        self.queue.drain(..).for_each(|face| self.state[face as usize] = UNKNOWN);
        if self.state.len() < complex.face_count() {
            self.state.resize(complex.face_count(), UNKNOWN);
        }
        self.state[0] = first;
        self.queue.push(0);
        let mut done = 0;
        while let Some(&face) = self.queue.get(done) {
            done += 1;
            for side in 0..3 {
                if let Err(stop) = self.cross(complex, surface, face, side) {
                    return Err(Refusal { reached: self.queue.len(), stop });
                }
            }
        }
        Ok(())
    }

    /// Carries the state of a face across one of its sides. Where many faces meet, carries it only to the next face in the
    /// ring: each face passes the state on, and the last face is checked against the first.
    fn cross(&mut self, complex: &Complex, surface: &FaceComplex, face: u32, side: u32) -> Result<(), Stop> {
        let state = self.state(face);
        let half_edge = 3 * face + side;
        let other = complex.next(half_edge);
        let start = |half_edge: u32| surface.point(complex.corners.as_flattened()[half_edge as usize]);
        let triangle = complex.lowest[face as usize];

        let expected = if is_inner(state, side) {
            if other == half_edge {
                return Err(Stop::Border { triangle });
            }
            if complex.is_non_manifold(half_edge) {
                return Err(Stop::NonManifold { triangle });
            }
            if start(other) == start(half_edge) {
                return Err(Stop::Orientation { triangle });
            }
            if state == CENTRE { ((other + 2) % 3) as u8 } else { CENTRE }
        } else {
            let old_vertex = start(3 * face + u32::from(state));
            let turn = u32::from(start(other) != old_vertex);
            ((other % 3 + turn) % 3) as u8
        };

        let reached = &mut self.state[(other / 3) as usize];
        if *reached == UNKNOWN {
            *reached = expected;
            self.queue.push(other / 3);
        } else if *reached != expected {
            return Err(Stop::Irregular { triangle: complex.lowest[(other / 3) as usize] });
        }
        Ok(())
    }
}

/// Whether a side lies inside the coarse face.
fn is_inner(state: u8, side: u32) -> bool {
    state == CENTRE || side == u32::from(state + 1) % 3
}
