//! Checks every invariant of a wavelet mesh. On a checked mesh, no operation can panic, run forever, or take more memory than
//! goes with its arrays.
//!
//! ```text
//!     base faces and what is along their sides   in range; no wavelet twice on a face or too often in all
//!     grow level by level                        as many vertices as there are
//!     numbers of wavelets, bits, seams           those that come out are those that went in
//!     values                                     as many as they should be; bounds nested
//! ```
//!
//! Grown structures are right by construction, so only the input is checked. Bounds are not checked to be large enough, but are
//! checked to be nested, so a cut is closed.

use crate::adapt::Refinements;
use crate::geometry::parallel;
use crate::mesh::NONE;

use super::mesh::MOST_MATERIALS;
use super::parts::{beside as beside_of, seams, sides, split};
use super::subdivision::{MOST_ALONG, MOST_FACES};
use super::subdivision::{Part, SubdivisionBuilder};
use super::{Subdivision, WaveletError, WaveletMesh, WaveletParts};

/// Input for growing a subdivision, as in [`WaveletParts`].
pub(super) struct Seeds<'a> {
    pub base: &'a [[u32; 3]],
    pub base_vertices: u32,
    pub sides: &'a [[u32; 3]],
    pub split: &'a [u64],
    pub seams: &'a [[u32; 2]],
    pub beside: &'a [[u32; 3]],
    /// Number of all vertices.
    pub vertices: usize,
}

impl WaveletParts {
    /// Grows the connectivity; fails if the parts are broken or do not fit the number of vertices.
    pub(super) fn grow(&self) -> Result<Subdivision, WaveletError> {
        let Self { base, base_vertices, sides, split, seams, beside, vertices, .. } = self;
        let vertices = vertices.positions().len();
        Seeds { base, base_vertices: *base_vertices, sides, split, seams, beside, vertices }.grow()
    }
}

impl Seeds<'_> {
    /// Grows the connectivity; fails if the seeds are broken or do not fit the number of vertices.
    pub fn grow(&self) -> Result<Subdivision, WaveletError> {
        let mut builder = self.base_faces()?;
        loop {
            let of = builder.subdivision();
            let flags: Vec<bool> = builder.last_level().map(|face| self.is_split(face)).collect();
            let splits = flags.iter().filter(|split| **split).count();
            if splits == 0 {
                break;
            }
            // Below the base, every face has an edge inside its parent, shared with at most 1 other face.
            let room = self.vertices - self.base_vertices as usize;
            if of.depth() > 0 && splits.div_ceil(2) > room.saturating_sub(of.wavelet_count()) {
                return broken("more faces are split than there are vertices for, of level", of.depth());
            }
            builder.split_only(&flags)?;
        }
        let least = self.base_vertices as usize + builder.subdivision().wavelet_count();
        if least > self.vertices {
            return Err(WaveletError::Length { what: "vertices", found: self.vertices, expected: least });
        }
        let key = |of: &Subdivision, face: u32, side: usize, part: Part| {
            let (child, corner) = part.corner(side);
            let corner = of.child(face, child) << 2 | corner as u32;
            let at = self.seams.binary_search_by_key(&corner, |seam| seam[0]);
            at.map_or(NONE, |at| self.seams[at][1])
        };
        let beside = |wavelet: u32, face: u32, side: usize| {
            let start = self.beside.partition_point(|beside| beside[0] < wavelet);
            let own = self.beside[start..].iter().take(MOST_ALONG);
            let mut own = own.take_while(|beside| beside[0] == wavelet);
            own.find(|beside| beside[1] == face << 2 | side as u32).map_or(NONE, |beside| beside[2])
        };
        let of = match (self.seams, self.beside) {
            ([], []) => builder.finish_without_seams(),
            // Without `beside`, unsplit faces use the wavelet's own vertex at every wavelet.
            _ => builder.finish_beside(|of, wavelet, face, side, part| match of.is_split(face) {
                true => key(of, face, side, part),
                false => beside(wavelet, face, side),
            }),
        };
        expect("vertices", self.vertices, of.vertex_count())?;
        same("the wavelets along base face", self.sides, &sides(&of))?;
        same("the bits of split faces, word", self.split, &split(&of))?;
        same("the corners at seams, entry", self.seams, &seams(&of))?;
        same("the sides beside seams, entry", self.beside, &beside_of(&of))?;
        Ok(of)
    }

    fn is_split(&self, face: u32) -> bool {
        self.split.get(face as usize / 64).is_some_and(|word| word >> (face % 64) & 1 == 1)
    }

    /// Starts from the base faces, with the wavelet on a side as the number of its edge.
    fn base_faces(&self) -> Result<SubdivisionBuilder, WaveletError> {
        let count = self.base.len();
        at_most("faces", count, MOST_FACES)?;
        at_most("base vertices", self.base_vertices as usize, self.vertices)?;
        expect("sides of base faces", self.sides.len(), count)?;
        if let Some(face) =
            self.base.iter().position(|corners| corners.iter().any(|&v| v >= self.base_vertices))
        {
            return broken("no base vertex at a corner of base face", face);
        }
        let mut times = vec![0_u8; 3 * count];
        let mut edges = vec![[NONE; 3]; count];
        let mut against = vec![[false; 3]; count];
        for (face, sides) in self.sides.iter().enumerate() {
            for (k, &side) in sides.iter().enumerate().filter(|side| *side.1 != NONE) {
                let edge = side >> 1;
                let Some(times) = times.get_mut(edge as usize).filter(|_| !edges[face].contains(&edge))
                else {
                    return broken("the wavelets along base face", face);
                };
                if usize::from(*times) == MOST_ALONG {
                    let (count, limit) = (MOST_ALONG + 1, MOST_ALONG);
                    return Err(WaveletError::TooManyAlongEdge { triangle: face, count, limit });
                }
                *times += 1;
                (edges[face][k], against[face][k]) = (edge, side & 1 == 1);
            }
        }
        // Sides without a wavelet get edges of their own.
        let mut edge_count = times.iter().rposition(|&times| times > 0).map_or(0, |last| last + 1);
        for edge in edges.as_flattened_mut().iter_mut().filter(|edge| **edge == NONE) {
            *edge = edge_count as u32;
            edge_count += 1;
        }
        Ok(SubdivisionBuilder::with_edges(self.base.to_vec(), self.base_vertices, edges, against, edge_count))
    }
}

impl WaveletMesh {
    /// Checks the invariants of the structure: the connectivity equals what grows from its base faces; the numbers of vertices,
    /// bounds and materials are right; bounds are lengths, each within the bounds of the wavelet's parents.
    ///
    /// Every built mesh passes; parts and files are accepted only after this check. O(n) on any input, and no more memory than
    /// the mesh takes.
    ///
    /// # Errors
    /// The first broken invariant, and where.
    pub fn validate(&self) -> Result<(), WaveletError> {
        let of = &self.subdivision;
        let grown = Seeds {
            base: &of.base,
            base_vertices: of.base_vertices,
            sides: &sides(of),
            split: &split(of),
            seams: &seams(of),
            beside: &beside_of(of),
            vertices: self.vertices.positions().len(),
        };
        if grown.grow()? != *of {
            return broken("connectivity is not what grows from its base, of face", 0);
        }
        self.check_values()
    }

    /// Checks the lengths of arrays: what a trusted file must have.
    pub(super) fn check_lengths(&self) -> Result<(), WaveletError> {
        let of = &self.subdivision;
        expect("vertices", self.vertices.positions().len(), of.vertex_count())?;
        expect("triangles beside the faces", self.vertices.triangles().len(), 0)?;
        at_most("materials", self.materials.len(), MOST_MATERIALS)?;
        let grouped = if self.materials.is_empty() { 0 } else { of.base_face_count() };
        expect("groups of base faces", self.group_of.len(), grouped)?;
        expect("bounds", self.bounds.len(), of.wavelet_count())
    }

    /// Checks everything except the connectivity.
    pub(super) fn check_values(&self) -> Result<(), WaveletError> {
        let of = &self.subdivision;
        self.check_lengths()?;
        if let Some(at) = self.materials.windows(2).position(|w| w[0] >= w[1]) {
            return broken("materials that do not ascend", at + 1);
        }
        if let Some(face) = self.group_of.iter().position(|&g| usize::from(g) >= self.materials.len()) {
            return broken("no such material of base face", face);
        }
        let is_length = |x: &f32| x.is_finite() && *x >= 0.0;
        if let Some(wavelet) =
            self.bounds.iter().position(|b| ![b.radius, b.along, b.across].iter().all(is_length))
        {
            return broken("bounds that are no lengths, of wavelet", wavelet);
        }
        let sticks_out = |wavelet: u32| {
            let bounds = Refinements::bounds(self, wavelet);
            of.parents_of(wavelet).any(|parent| !Refinements::bounds(self, parent).contains(&bounds))
        };
        match parallel::first(of.wavelet_count() as u32, sticks_out) {
            Some(wavelet) => broken("bounds that are not within a parent's, of wavelet", wavelet as usize),
            None => Ok(()),
        }
    }
}

fn broken<T>(what: &'static str, at: usize) -> Result<T, WaveletError> {
    Err(WaveletError::Invalid { what, at })
}

fn expect(what: &'static str, found: usize, expected: usize) -> Result<(), WaveletError> {
    if found == expected { Ok(()) } else { Err(WaveletError::Length { what, found, expected }) }
}

fn at_most(what: &'static str, count: usize, limit: usize) -> Result<(), WaveletError> {
    if count <= limit { Ok(()) } else { Err(WaveletError::TooMany { what, count, limit }) }
}

/// Fails at the first element where `known` differs from `found`.
fn same<T: PartialEq>(what: &'static str, known: &[T], found: &[T]) -> Result<(), WaveletError> {
    let first = known.iter().zip(found).position(|(a, b)| a != b);
    match first {
        Some(at) => broken(what, at),
        None if known.len() != found.len() => broken(what, known.len().min(found.len())),
        None => Ok(()),
    }
}
