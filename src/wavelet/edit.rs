//! Edits at a level: vertices are moved, and all finer vertices follow with their coefficients.
//!
//! ```text
//!     level 0     .-----------o-----------.      o: moved            (Azuma et al., equation 1, and back)
//!     level 1     .     x     o     x     .      x: its ends moved; keeps its coefficient, in the frame of the object or in that of
//!     level 2     .  x  .  x  o  x  .  x  .         the coarser surface
//!     ...
//! ```
//!
//! Dependent vertices are found level by level, over the faces at the corners moved. First, all coefficients are computed from
//! the old mesh. Then vertices are placed again, coarse to fine. Nothing else is visited, unless the box around the mesh may
//! have shrunk.

use glam::{DMat3, DVec3};

use crate::error::MeshError;

use super::bounds::update;
use super::{WaveletError, WaveletMesh};

/// Frame in which coefficients of finer levels are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum DetailFrame {
    /// The object's frame: details keep their directions.
    #[default]
    Global,
    /// The frame of the coarser surface at the vertex: along the vertex's edge, and the mean normal of the faces along the
    /// edge. Details turn with the surface (Zorin, Schroeder and Sweldens 1997, Interactive multiresolution mesh editing).
    /// Falls back to the object's frame where the edge or the normal is degenerate.
    Local,
}

/// Result of an edit.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Edited {
    /// Moved vertices, ascending.
    pub vertices: Vec<u32>,
    /// Positions of the moved vertices before the edit, object units.
    pub before: Vec<[f32; 3]>,
    /// Wavelets with recomputed bounds, ascending.
    pub wavelets: Vec<u32>,
}

/// A vertex that follows an edit: its offset from the middle of its ends.
struct Detail {
    wavelet: u32,
    coefficient: DVec3,
    /// The coefficient in the frame of the coarser surface, for [`DetailFrame::Local`] where the frame exists.
    in_frame: Option<DVec3>,
}

impl WaveletMesh {
    /// Moves vertices of levels up to `level` (0: base vertices) to other positions, object units. Other vertices of levels up
    /// to `level` stay; vertices of finer levels keep their coefficients in `frame`. Coincident vertices move together: all
    /// vertices of a wavelet, and all base vertices at the same position. If several are moved, the last move counts.
    /// Attributes stay, including normals: see [`Normals::Recomputed`](super::Normals::Recomputed).
    ///
    /// Bounds equal the bounds of a mesh built anew. Time: proportional to the moved vertices and the rims of the supports
    /// containing them. Moving base vertices adds a pass over the base. A pass over all vertices is added if a vertex moves
    /// inwards from a side of the box around the mesh, or if the power of two below the box's diagonal changes.
    ///
    /// Coefficients are kept up to rounding. [`WaveletMesh::undo`] reverts an edit bit for bit.
    ///
    /// # Errors
    /// The first move of a missing vertex, of a vertex of a finer level, or to a non-finite position. Then nothing has changed.
    ///
    /// ```
    /// use multires::mesh::shapes;
    /// use multires::wavelet::{DetailFrame, WaveletBuilder, WaveletOptions};
    ///
    /// let mut builder = WaveletBuilder::new(&shapes::icosphere(0))?;
    /// for _ in 0..3 {
    ///     builder.subdivide(|midpoint| midpoint.middle)?;
    /// }
    /// let mut mesh = builder.build(&WaveletOptions::default())?;
    /// let before = mesh.clone();
    /// let edited = mesh.edit(0, &[(0, [0.0, 3.0, 0.0])], DetailFrame::Global)?;
    /// assert!(edited.vertices.len() > 1);
    /// mesh.undo(&edited)?;
    /// assert_eq!(mesh, before);
    /// # Ok::<(), multires::wavelet::WaveletError>(())
    /// ```
    pub fn edit(
        &mut self,
        level: usize,
        moves: &[(u32, [f32; 3])],
        frame: DetailFrame,
    ) -> Result<Edited, WaveletError> {
        self.check_moves(moves)?;
        let of = &self.subdivision;
        let finer = |&&(vertex, _): &&(u32, [f32; 3])| {
            of.wavelet_of(vertex).is_some_and(|wavelet| of.level_of(wavelet) > level)
        };
        if let Some(&(vertex, _)) = moves.iter().find(finer) {
            let what = "a vertex of a finer level than that of the edit";
            return Err(WaveletError::Invalid { what, at: vertex as usize });
        }
        Ok(self.apply(level, self.together(moves), frame))
    }

    /// Reverts an edit; revert the latest edit first. Positions and bounds are restored bit for bit. The result is the edit
    /// which redoes `edited`.
    ///
    /// # Errors
    /// `edited` names a missing vertex or a non-finite position, or has different numbers of vertices and positions, as an edit
    /// of another mesh may.
    pub fn undo(&mut self, edited: &Edited) -> Result<Edited, WaveletError> {
        let (found, expected) = (edited.before.len(), edited.vertices.len());
        if found != expected {
            return Err(WaveletError::Length { what: "places", found, expected });
        }
        let mut moves: Vec<_> = edited.vertices.iter().copied().zip(edited.before.iter().copied()).collect();
        self.check_moves(&moves)?;
        moves.sort_unstable_by_key(|moved| moved.0);
        Ok(self.apply(self.subdivision.depth(), moves, DetailFrame::Global))
    }

    fn check_moves(&self, moves: &[(u32, [f32; 3])]) -> Result<(), WaveletError> {
        let count = self.subdivision.vertex_count();
        for &(vertex, position) in moves {
            let vertex = vertex as usize;
            if vertex >= count {
                return Err(WaveletError::Invalid { what: "there is no such vertex", at: vertex });
            }
            if !position.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NonFinitePosition { vertex, position }.into());
            }
        }
        Ok(())
    }

    /// Returns the moves of all vertices that move together, each vertex once, ascending.
    fn together(&self, moves: &[(u32, [f32; 3])]) -> Vec<(u32, [f32; 3])> {
        let of = &self.subdivision;
        let place = |vertex: u32| self.vertices.positions()[vertex as usize].map(|x| (x + 0.0).to_bits());
        let base = of.base_vertex_count() as u32;
        let mut by_place: Vec<([u32; 3], u32)> = Vec::new();
        if moves.iter().any(|&(vertex, _)| vertex < base) {
            by_place.extend((0..base).map(|vertex| (place(vertex), vertex)));
            by_place.sort_unstable();
        }
        let mut all = Vec::new();
        for (order, &(vertex, to)) in moves.iter().enumerate() {
            match of.wavelet_of(vertex) {
                Some(wavelet) => {
                    let vertices = std::iter::once(of.vertex_of(wavelet)).chain(of.seam_vertices_of(wavelet));
                    all.extend(vertices.map(|vertex| (vertex, order, to)));
                }
                None => {
                    let here = place(vertex);
                    let start = by_place.partition_point(|other| other.0 < here);
                    let same = by_place[start..].iter().take_while(|other| other.0 == here);
                    all.extend(same.map(|other| (other.1, order, to)));
                }
            }
        }
        // The last move of each vertex.
        all.sort_unstable_by_key(|&(vertex, order, _)| (vertex, std::cmp::Reverse(order)));
        all.dedup_by_key(|moved| moved.0);
        all.into_iter().map(|(vertex, _, to)| (vertex, to)).collect()
    }

    /// Applies moves: ascending, of vertices of levels up to `level`.
    fn apply(&mut self, level: usize, moves: Vec<(u32, [f32; 3])>, frame: DetailFrame) -> Edited {
        let base = self.subdivision.base_vertex_count() as u32;
        let split = moves.partition_point(|moved| moved.0 < base);
        let corners: Vec<u32> = moves[..split].iter().map(|moved| moved.0).collect();
        let mut wavelets: Vec<u32> =
            moves[split..].iter().filter_map(|moved| self.subdivision.wavelet_of(moved.0)).collect();
        wavelets.sort_unstable();
        wavelets.dedup();
        let (details, faces) = self.ripple(level, &corners, &wavelets, frame);

        let mut before: Vec<(u32, [f32; 3])> = Vec::new();
        for (vertex, to) in moves {
            self.put(vertex, to, &mut before);
        }
        for detail in details {
            let of = &self.subdivision;
            let own = of.vertex_of(detail.wavelet);
            let Some(middle) = self.middle(own) else { continue };
            let turned = detail.in_frame.and_then(|inner| Some(self.frame(detail.wavelet)? * inner));
            let most = DVec3::splat(f64::from(f32::MAX));
            let place = (middle + turned.unwrap_or(detail.coefficient)).clamp(-most, most);
            let place = place.as_vec3().to_array();
            let seam_vertices = of.seam_vertices_of(detail.wavelet);
            std::iter::once(own).chain(seam_vertices).for_each(|vertex| self.put(vertex, place, &mut before));
        }
        before.sort_unstable_by_key(|moved| moved.0);
        let diagonal = self.diagonal;
        self.extend_box(&before);
        let wavelets = update(self, faces, diagonal);
        let (vertices, before) = before.into_iter().unzip();
        Edited { vertices, before, wavelets }
    }

    fn put(&mut self, vertex: u32, to: [f32; 3], before: &mut Vec<(u32, [f32; 3])>) {
        let from = self.vertices.positions()[vertex as usize];
        if from.map(f32::to_bits) != to.map(f32::to_bits) {
            before.push((vertex, from));
            self.vertices.edit_positions(|positions| positions[vertex as usize] = to);
        }
    }

    fn place(&self, vertex: u32) -> DVec3 {
        DVec3::from_array(self.vertices.positions()[vertex as usize].map(f64::from))
    }

    fn middle(&self, vertex: u32) -> Option<DVec3> {
        let [a, b] = self.subdivision.ends(vertex)?.map(|end| self.place(end));
        Some(0.5 * (a + b))
    }

    /// Returns the frame of the coarser surface at a wavelet's midpoint; `None` where the edge or the normal is degenerate.
    fn frame(&self, wavelet: u32) -> Option<DMat3> {
        let of = &self.subdivision;
        let [a, b] = of.ends(of.vertex_of(wavelet))?.map(|end| self.place(end));
        let along = (b - a).try_normalize()?;
        let start = of.faces_of(of.level_of(wavelet) - 1).start;
        let mut normal = DVec3::ZERO;
        let mut first = None;
        for side in of.faces_along(wavelet).filter(|side| side.face() >= start) {
            let [a, b, c] = of.corners(side.face()).map(|corner| self.place(corner));
            let own = (b - a).cross(c - a).reject_from_normalized(along);
            // Consistently oriented faces run against each other along their edge; other faces count as if turned over.
            let &mut (against, one) = first.get_or_insert((side.against(), own));
            normal += if side.against() == against && normal != DVec3::ZERO { -own } else { own };
            // Where the faces lie on each other, use the normal of the first.
            if normal.length() < 1e-6 * own.length() {
                normal = one;
            }
        }
        let normal = normal.try_normalize()?;
        Some(DMat3::from_cols(along, normal, along.cross(normal)))
    }

    fn detail(&self, wavelet: u32, frame: DetailFrame) -> Detail {
        let own = self.subdivision.vertex_of(wavelet);
        let coefficient = self.middle(own).map_or(DVec3::ZERO, |middle| self.place(own) - middle);
        let inner = || Some(self.frame(wavelet)?.transpose() * coefficient);
        let in_frame = if frame == DetailFrame::Local { inner() } else { None };
        Detail { wavelet, coefficient, in_frame }
    }

    /// Finds the details that follow base vertices `corners` and `wavelets` up to `level`, coarse to fine. Also returns all
    /// faces with a moved corner or a moved midpoint of a side.
    fn ripple(
        &self,
        level: usize,
        corners: &[u32],
        wavelets: &[u32],
        frame: DetailFrame,
    ) -> (Vec<Detail>, Vec<u32>) {
        let of = &self.subdivision;
        let mut details = Vec::new();
        let mut faces = Vec::new();
        // Faces of the level with a moved corner, ascending, with a bit for each moved corner.
        let mut active: Vec<(u32, u8)> = Vec::new();
        if !corners.is_empty() {
            let masks = of.base.iter().map(|face| {
                let moves = |k: usize| u8::from(corners.binary_search(&face[k]).is_ok()) << k;
                moves(0) | moves(1) | moves(2)
            });
            active.extend((0..).zip(masks).filter(|(_, mask)| *mask != 0));
        }
        let mut seeds = wavelets;
        for coarser in 0..of.depth() {
            if active.is_empty() && seeds.is_empty() {
                break;
            }
            let own = of.wavelets_of(coarser + 1);
            let (here, rest) = seeds.split_at(seeds.partition_point(|&wavelet| wavelet < own.end));
            seeds = rest;
            let mut moved = here.to_vec();
            if coarser >= level {
                for &(face, mask) in active.iter().filter(|(face, _)| of.is_split(*face)) {
                    let sides = of.sides_of_split(face);
                    let follows = |k: &usize| {
                        frame == DetailFrame::Local || (mask >> k | mask >> ((k + 1) % 3)) & 1 != 0
                    };
                    moved.extend([0, 1, 2].into_iter().filter(follows).map(|k| sides[k]));
                }
                moved.sort_unstable();
                moved.dedup();
                details.extend(moved.iter().map(|&wavelet| self.detail(wavelet, frame)));
            }
            faces.extend(active.iter().map(|active| active.0));
            let mut parents = std::mem::take(&mut active);
            for along in moved.iter().flat_map(|&wavelet| of.faces_along(wavelet)) {
                faces.push(along.face());
                parents.push((along.face(), 0));
            }
            // Of equal faces, keep the entry with moved corners.
            parents.sort_unstable_by_key(|&(face, mask)| (face, std::cmp::Reverse(mask)));
            parents.dedup_by_key(|parent| parent.0);
            for (face, mask) in parents.into_iter().filter(|(face, _)| of.is_split(*face)) {
                let middles =
                    of.sides_of_split(face).map(|side| u8::from(moved.binary_search(&side).is_ok()));
                for i in 0..3 {
                    let mask = mask >> i & 1 | middles[i] << 1 | middles[(i + 2) % 3] << 2;
                    active.extend((mask != 0).then(|| (of.child(face, i), mask)));
                }
                let mask = middles[0] | middles[1] << 1 | middles[2] << 2;
                active.extend((mask != 0).then(|| (of.child(face, 3), mask)));
            }
        }
        faces.extend(active.iter().map(|active| active.0));
        (details, faces)
    }

    /// Updates the box around all vertices after some have moved.
    fn extend_box(&mut self, before: &[(u32, [f32; 3])]) {
        let Some([mut low, mut high]) = self.extent else { return };
        let positions = self.vertices.positions();
        let mut leaves = false;
        for &(vertex, from) in before {
            let to = positions[vertex as usize];
            for i in 0..3 {
                leaves |= from[i] == low[i] && to[i] > low[i] || from[i] == high[i] && to[i] < high[i];
            }
        }
        if leaves {
            self.measure();
            return;
        }
        for &(vertex, _) in before {
            let to = positions[vertex as usize];
            low = std::array::from_fn(|i| low[i].min(to[i]));
            high = std::array::from_fn(|i| high[i].max(to[i]));
        }
        self.set_box(Some([low, high]));
    }
}
