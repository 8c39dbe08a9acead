//! Counts of split faces and vertices in use, kept up to date for a set of wavelets.
//!
//! ```text
//!     exact     a face is split if any of its sides carries a wavelet of the set: the sum of hats, as it is
//!     minimal   only if all do; with two, the corner between them is cut off: no vertex but those of the set
//! ```
//!
//! Every vertex in use adds a triangle for each face along its edge, for either triangulation: a split face gains a triangle,
//! and so does a face cut because its neighbour is split. So the number of triangles is a sum over vertices.

use crate::geometry::paged::Paged;
use crate::wavelet::Triangulation;
use crate::wavelet::subdivision::Subdivision;

/// Counts of a set of wavelets closed under parents.
#[derive(Debug, Clone)]
pub(crate) struct UseCounts {
    exact: bool,
    /// Per split face the number of its sides with a wavelet of the set.
    set: Paged<u8, 8>,
    /// Per wavelet: 1 if it is in the set, plus (exact only) the number of faces along its edge split by the set.
    users: Paged<u8, 8>,
}

/// Receives the effects of changing the set.
pub(crate) trait UseSink {
    /// Called when a wavelet's vertex comes into use or goes out of use.
    fn used(&mut self, wavelet: u32);
    /// Called when a face is split or joined, or loses or regains a corner.
    fn turned(&mut self, face: u32);
}

impl UseSink for () {
    fn used(&mut self, _: u32) {}
    fn turned(&mut self, _: u32) {}
}

impl UseCounts {
    /// Makes the counts of the empty set.
    pub fn new(subdivision: &Subdivision, triangulation: Triangulation) -> Self {
        Self {
            exact: triangulation == Triangulation::Exact,
            set: Paged::of(subdivision.face_count(), 0),
            users: Paged::of(subdivision.wavelet_count(), 0),
        }
    }

    /// Whether the vertex of a wavelet is in use.
    #[inline]
    pub fn is_used(&self, wavelet: u32) -> bool {
        self.users.at(wavelet) > 0
    }

    /// Number of sides needed to split a face.
    #[inline]
    fn needed(&self) -> u8 {
        if self.exact { 1 } else { 3 }
    }

    /// Whether all four children of a face are drawn, or split further.
    #[inline]
    pub fn splits(&self, of: &Subdivision, face: u32) -> bool {
        self.set.at(face) >= self.needed() && of.is_split(face)
    }

    /// The corner of a face drawn as a triangle beside a quadrilateral.
    #[inline]
    pub fn cut_corner(&self, of: &Subdivision, face: u32) -> Option<usize> {
        if self.exact || self.set.at(face) != 2 || !of.is_split(face) {
            return None;
        }
        let bare = of.sides_of_split(face).iter().position(|&wavelet| !self.is_used(wavelet))?;
        Some((bare + 2) % 3)
    }

    /// Whether a face is drawn, or split further.
    #[inline]
    pub fn is_there(&self, of: &Subdivision, face: u32) -> bool {
        match of.parent(face) {
            None => true,
            Some((parent, _, child)) => {
                self.splits(of, parent) || !self.exact && self.cut_corner(of, parent) == Some(child)
            }
        }
    }

    /// Adds a wavelet to the set or removes it. Returns the number of triangles added or removed.
    pub fn change(&mut self, of: &Subdivision, wavelet: u32, comes: bool, sink: &mut impl UseSink) -> usize {
        let mut triangles = 0;
        if !comes {
            triangles += self.unuse(of, wavelet, sink);
        }
        for along in of.faces_along(wavelet) {
            let face = along.face();
            if !of.is_split(face) {
                continue;
            }
            let set = self.set.entry(face);
            let before = *set;
            let after = if comes { before + 1 } else { before - 1 };
            *set = after;
            if !self.exact && before.max(after) < 2 {
                continue;
            }
            if !self.exact {
                sink.turned(face);
            } else if before.min(after) == 0 {
                sink.turned(face);
                for side in of.sides_of_split(face) {
                    triangles +=
                        if comes { self.make_use(of, side, sink) } else { self.unuse(of, side, sink) };
                }
            }
        }
        if comes {
            triangles += self.make_use(of, wavelet, sink);
        }
        triangles
    }

    fn make_use(&mut self, of: &Subdivision, wavelet: u32, sink: &mut impl UseSink) -> usize {
        let users = self.users.entry(wavelet);
        *users += 1;
        if *users > 1 {
            return 0;
        }
        sink.used(wavelet);
        of.width(wavelet)
    }

    fn unuse(&mut self, of: &Subdivision, wavelet: u32, sink: &mut impl UseSink) -> usize {
        let users = self.users.entry(wavelet);
        *users -= 1;
        if *users > 0 {
            return 0;
        }
        sink.used(wavelet);
        of.width(wavelet)
    }

    /// Returns the number of triangles [`UseCounts::change`] would add or remove.
    pub fn cost(&self, of: &Subdivision, wavelet: u32, comes: bool) -> usize {
        if !self.exact {
            return of.width(wavelet);
        }
        // Changes to the users of few wavelets: this wavelet, and the sides of faces split or joined.
        const MOST: usize = 8;
        let mut changes = [(wavelet, 1_u8); MOST];
        let mut count = 1;
        let mut more = 0;
        for along in of.faces_along(wavelet) {
            let face = along.face();
            let turns = self.set.at(face) == u8::from(!comes) && of.is_split(face);
            for side in of.sides_of_split_if(face, turns) {
                match changes[..count].iter_mut().find(|change| change.0 == side) {
                    Some(change) => change.1 += 1,
                    None if count < MOST => {
                        changes[count] = (side, 1);
                        count += 1;
                    }
                    // Along non-manifold edges: each side by itself.
                    None => more += usize::from(self.users.at(side) == u8::from(!comes)) * of.width(side),
                }
            }
        }
        let turned = changes[..count].iter().filter(|(side, by)| {
            let users = self.users.at(*side);
            if comes { users == 0 } else { users == *by }
        });
        more + turned.map(|(side, _)| of.width(*side)).sum::<usize>()
    }

    /// Looks for pages that are not in use.
    pub fn sweep(&mut self) {
        self.set.sweep();
        self.users.sweep();
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        self.set.trim();
        self.users.trim();
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        self.set.memory() + self.users.memory()
    }
}
