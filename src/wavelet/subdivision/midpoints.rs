//! Vertices at the midpoints of sides: one a wavelet, and further ones where a seam runs along or across its edge.

use super::{Side, Subdivision};

impl Subdivision {
    /// Gives each wavelet a vertex for every distinct key of the `looked_at` sides along its edge. `key` gets wavelet,
    /// face, side and part. For an unsplit face `key` returns the first side's key, or a key of no other side.
    pub(crate) fn tell_apart<K: PartialEq>(
        &mut self,
        looked_at: impl Fn(&Self, Side) -> bool,
        key: impl Fn(&Self, u32, u32, usize, Part) -> K,
    ) {
        let mut known: Vec<(K, u32)> = Vec::new();
        for wavelet in 0..self.along.len() as u32 {
            known.clear();
            let sides: Vec<Side> = self.faces_along(wavelet).filter(|&side| looked_at(self, side)).collect();
            let mut has_seam = false;
            for along in sides {
                let vertices = Part::ALL.map(|part| {
                    let key = key(self, wavelet, along.face(), along.side(), part);
                    self.vertex_for(wavelet, along, key, &mut known)
                });
                if self.is_split(along.face()) {
                    has_seam |= vertices.iter().any(|&vertex| vertex != vertices[0]);
                    self.set_midpoint(wavelet, along, vertices);
                }
            }
            if has_seam {
                self.interior_seams.push(wavelet);
            }
        }
        self.seams.sort_unstable();
    }

    /// Returns the wavelet's vertex for a key: its own for the first key, a new vertex for each further one.
    fn vertex_for<K: PartialEq>(
        &mut self,
        wavelet: u32,
        along: Side,
        key: K,
        known: &mut Vec<(K, u32)>,
    ) -> u32 {
        if let Some(&(_, vertex)) = known.iter().find(|known| known.0 == key) {
            return vertex;
        }
        let vertex = if known.is_empty() {
            self.vertex_of(wavelet)
        } else {
            self.seam_vertices.push((wavelet, along));
            (self.base_vertices as usize + self.along.len() + self.seam_vertices.len() - 1) as u32
        };
        known.push((key, vertex));
        vertex
    }

    /// Gives the children at the midpoint of a side their vertices, where these are not the wavelet's own.
    fn set_midpoint(&mut self, wavelet: u32, along: Side, vertices: [u32; 3]) {
        let (face, side) = (along.face(), along.side());
        for (part, vertex) in Part::ALL.into_iter().zip(vertices) {
            if vertex != self.vertex_of(wavelet) {
                let (child, corner) = part.corner(side);
                self.seams.push((self.child(face, child) << 2 | corner as u32, vertex));
                self.mark_seam(face, side);
            }
        }
    }
}

/// Children of a split face meeting at the midpoint of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    First,
    Second,
    Centre,
}

impl Part {
    pub const ALL: [Self; 3] = [Self::First, Self::Second, Self::Centre];

    /// Returns the child, and its corner at the midpoint of the side.
    pub fn corner(self, side: usize) -> (usize, usize) {
        match self {
            Self::First => (side, 1),
            Self::Second => ((side + 1) % 3, 2),
            Self::Centre => (3, side),
        }
    }
}
