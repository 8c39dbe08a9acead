//! Connectivity of a subdivision: split faces, edges with a wavelet, parents and children.
//!
//! ```text
//!                c2                     side k runs from corner k to corner k + 1, m_k is its midpoint
//!                /\
//!               /2 \                    child 0, 1, 2   the corner at c_i:  [c_i, m_i, m_(i+2)]
//!            m2/____\m1                 child 3         the centre:         [m_0, m_1, m_2]
//!             /\ 3  /\
//!            /0 \  /1 \                 a wavelet sits on an edge of a split face: its vertex is the midpoint
//!          c0/____\/____\c1
//!                 m0
//! ```
//!
//! Faces are numbered level by level, four children in a row; wavelets level by level, in the order of faces. So most of the
//! dependency graph (Azuma et al., section 3.4) is arithmetic. Stored are only the wavelets on the sides of every split face,
//! and the faces along every wavelet's edge.

use crate::mesh::NONE;

/// Most faces of all levels together: a face, a side and a direction fit 31 bits.
pub(crate) const MOST_FACES: usize = 1 << 28;
/// Most levels: barycentric coordinates stay exact in double precision, and loops along levels stay short.
pub(crate) const MOST_LEVELS: usize = 52;
/// Most faces along an edge.
pub(crate) const MOST_ALONG: usize = 250;
/// Marks a side whose midpoint lies on a seam: its children there have other vertices than the wavelet's own.
const SEAM: u32 = 1 << 31;

/// A side of a face, and whether it runs against the direction of the edge's wavelet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Side(pub(crate) u32);

impl Side {
    pub const NONE: Self = Self(NONE);

    pub fn new(face: u32, side: usize, against: bool) -> Self {
        Self(face << 3 | (side as u32) << 1 | u32::from(against))
    }

    pub fn face(self) -> u32 {
        self.0 >> 3
    }

    pub fn side(self) -> usize {
        (self.0 >> 1 & 3) as usize
    }

    pub fn against(self) -> bool {
        self.0 & 1 == 1
    }
}

/// The connectivity of a mesh made by splitting triangles in four: base faces, splits and wavelets. Base faces may form any
/// complex: open, non-manifold, pinched, of several components. Neighbours may be split to different depths.
///
/// Memory: 8 bytes a wavelet and 12 a split face where all faces are split equally deep; otherwise 4 bytes a split face and at
/// most 1.5 bits a face more.
///
/// ```
/// use multires::wavelet::{WaveletMesh, WaveletOptions};
/// use multires::mesh::shapes;
///
/// let mesh = WaveletMesh::recognise(&shapes::icosphere(2), &WaveletOptions::default())?;
/// let subdivision = mesh.subdivision();
/// let [first, second] = [1, 2].map(|level| subdivision.wavelets_of(level).len());
/// assert_eq!((first, second), (30, 120)); // a wavelet per edge
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subdivision {
    /// Vertices at the corners of every base face.
    pub(crate) base: Vec<[u32; 3]>,
    /// Wavelets on the sides of every base face, or `NONE`.
    pub(crate) base_sides: Vec<[u32; 3]>,
    /// Number of vertices of the base faces; larger than the number of points where the base has seams.
    pub(crate) base_vertices: u32,
    /// Start of every level's faces, and the end of the last level.
    pub(crate) face_levels: Vec<u32>,
    /// Start of every level's wavelets, and the end of the last level. Wavelets of the first level lie on base edges.
    pub(crate) levels: Vec<u32>,
    /// Split faces in order; empty where they are faces `0..split_count`.
    pub(crate) split_faces: Vec<u32>,
    pub(crate) split_count: u32,
    /// Per face a bit, set where split; `before`: split faces before each word. Both empty where faces `0..split_count` are
    /// split.
    pub(crate) split: Vec<u64>,
    pub(crate) before: Vec<u32>,
    /// Wavelets on the sides of every split face, possibly marked by [`SEAM`].
    pub(crate) sides: Vec<[u32; 3]>,
    /// Two faces along every wavelet's edge, the first of the wavelet's own level. The second may be missing, or be a coarser
    /// unsplit face with the edge as a part of its side.
    pub(crate) along: Vec<[Side; 2]>,
    /// Third and further faces along wavelets' edges: wavelet and side, ascending.
    pub(crate) more: Vec<(u32, Side)>,
    /// Corners of children (`4 * face + corner`) at midpoints on seams, each with its vertex, where the vertex differs from the
    /// wavelet's own; ascending.
    pub(crate) seams: Vec<(u32, u32)>,
    /// Wavelets with a seam inside a face: at the midpoint, children of the same face have several vertices. Ascending.
    pub(crate) interior_seams: Vec<u32>,
    /// Further vertices of wavelets on seams, numbered after all others: wavelet, and a side at which the vertex is; ascending.
    /// If the side belongs to an unsplit face, the vertex is at no other side.
    pub(crate) seam_vertices: Vec<(u32, Side)>,
}

impl Subdivision {
    /// Number of base faces.
    pub fn base_face_count(&self) -> usize {
        self.base.len()
    }

    /// Number of base vertices, which are vertices `0..base_vertex_count`.
    pub fn base_vertex_count(&self) -> usize {
        self.base_vertices as usize
    }

    /// Number of wavelets: edges with a vertex of their own.
    pub fn wavelet_count(&self) -> usize {
        self.along.len()
    }

    /// Number of all vertices: base vertices, the vertex of each wavelet, and further vertices of wavelets on seams.
    pub fn vertex_count(&self) -> usize {
        self.base_vertex_count() + self.along.len() + self.seam_vertices.len()
    }

    /// Number of faces of all levels.
    pub fn face_count(&self) -> usize {
        self.face_levels.last().map_or(0, |&end| end as usize)
    }

    /// Number of unsplit faces: triangles at full resolution, except where a face is cut because its neighbours are split
    /// deeper.
    pub fn leaf_count(&self) -> usize {
        self.face_count() - self.split_count as usize
    }

    /// Number of triangles at full resolution: base faces + faces along the edge of each wavelet, summed. O(wavelets).
    pub fn triangle_count(&self) -> usize {
        let second = self.along.iter().filter(|along| along[1] != Side::NONE).count();
        self.base.len() + self.along.len() + second + self.more.len()
    }

    /// The deepest level; 0 where nothing is split.
    pub fn depth(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    /// Vertices at the corners of a base face; `None` out of range.
    pub fn base_face(&self, face: u32) -> Option<[u32; 3]> {
        self.base.get(face as usize).copied()
    }

    /// Wavelets of a level, 1 to [`depth`](Self::depth), by number; empty for any other level.
    pub fn wavelets_of(&self, level: usize) -> std::ops::Range<u32> {
        match level.checked_sub(1).and_then(|l| self.levels.get(l..)?.get(..2)) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    /// Faces of a level, 0 to [`depth`](Self::depth), by number; empty for any other level.
    pub fn faces_of(&self, level: usize) -> std::ops::Range<u32> {
        match self.face_levels.get(level..).and_then(|rest| rest.get(..2)) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    /// The level of a wavelet, from 1.
    pub fn level_of(&self, wavelet: u32) -> usize {
        self.levels.partition_point(|&start| start <= wavelet)
    }

    /// The level of a face, from 0.
    pub fn level_of_face(&self, face: u32) -> usize {
        self.face_levels.partition_point(|&start| start <= face) - 1
    }

    /// Whether every base face is split equally deep, so that levels are whole meshes.
    pub fn is_uniform(&self) -> bool {
        self.split_count == *self.face_levels.iter().nth_back(1).unwrap_or(&0)
    }

    /// Whether a face is split.
    #[inline]
    pub fn is_split(&self, face: u32) -> bool {
        if self.split.is_empty() {
            face < self.split_count
        } else {
            self.split.get(face as usize / 64).is_some_and(|word| word >> (face % 64) & 1 == 1)
        }
    }

    /// Returns the number of split faces before a split face.
    #[inline]
    pub(crate) fn rank(&self, face: u32) -> usize {
        if self.split.is_empty() {
            return face as usize;
        }
        let word = face as usize / 64;
        let lower = self.split[word] & ((1 << (face % 64)) - 1);
        (self.before[word] + lower.count_ones()) as usize
    }

    /// Returns child 0 to 3 of a split face.
    #[inline]
    pub(crate) fn child(&self, face: u32, child: usize) -> u32 {
        (self.base.len() + 4 * self.rank(face) + child) as u32
    }

    /// Returns the parent of a face, the parent's rank among split faces, and which child the face is; `None` for base faces.
    #[inline]
    pub(crate) fn parent(&self, face: u32) -> Option<(u32, usize, usize)> {
        let at = (face as usize).checked_sub(self.base.len())?;
        let rank = at / 4;
        let parent = if self.split_faces.is_empty() { rank as u32 } else { self.split_faces[rank] };
        Some((parent, rank, at % 4))
    }

    /// Returns the base face containing a face; `u32::MAX` out of range. O(level).
    pub fn base_face_of(&self, mut face: u32) -> u32 {
        if face as usize >= self.face_count() {
            return NONE;
        }
        while let Some((parent, ..)) = self.parent(face) {
            face = parent;
        }
        face
    }

    /// Returns the vertex at a corner of a face. O(1) on average, O(level) at most.
    #[inline]
    pub(crate) fn corner(&self, mut face: u32, mut corner: usize) -> u32 {
        loop {
            let Some((parent, rank, child)) = self.parent(face) else {
                return self.base[face as usize][corner];
            };
            let side = match (child, corner) {
                (3, corner) => corner,
                (child, 0) => {
                    (face, corner) = (parent, child);
                    continue;
                }
                (child, 1) => child,
                (child, _) => (child + 2) % 3,
            };
            let wavelet = self.sides[rank][side];
            let own = self.base_vertices + (wavelet & !SEAM);
            return if wavelet & SEAM == 0 { own } else { self.seam_vertex(face, corner).unwrap_or(own) };
        }
    }

    /// Vertices at the corners of a face.
    #[inline]
    pub(crate) fn corners(&self, face: u32) -> [u32; 3] {
        [0, 1, 2].map(|corner| self.corner(face, corner))
    }

    #[cold]
    fn seam_vertex(&self, face: u32, corner: usize) -> Option<u32> {
        let at = self.seams.binary_search_by_key(&(face << 2 | corner as u32), |seam| seam.0);
        at.ok().map(|at| self.seams[at].1)
    }

    /// Returns the vertices of a wavelet's midpoint at a side of a face along its edge, as used by the first half of the side
    /// and by the second. The two are equal, unless a seam runs inside the face.
    #[inline]
    pub(crate) fn vertices_at(&self, wavelet: u32, face: u32, side: usize) -> [u32; 2] {
        let own = self.base_vertices + wavelet;
        if self.seam_vertices.is_empty() {
            return [own; 2];
        }
        if self.is_split(face) {
            return [(side, 1), ((side + 1) % 3, 2)]
                .map(|(child, k)| self.corner(self.child(face, child), k));
        }
        let is_at = |&double: &u32| {
            let at = self.seam_vertices[double as usize - self.base_vertices as usize - self.along.len()].1;
            at.face() == face && at.side() == side
        };
        [self.seam_vertices_of(wavelet).find(is_at).unwrap_or(own); 2]
    }

    /// Returns the wavelet on a side of a split face.
    #[inline]
    pub(crate) fn side_of_split(&self, face: u32, side: usize) -> u32 {
        self.sides[self.rank(face)][side] & !SEAM
    }

    /// Returns the wavelets on the sides of a split face.
    #[inline]
    pub(crate) fn sides_of_split(&self, face: u32) -> [u32; 3] {
        self.sides[self.rank(face)].map(|wavelet| wavelet & !SEAM)
    }

    /// Iterates over the wavelets on the sides of a split face if `yes`, otherwise over nothing; then the face need not be
    /// split.
    #[inline]
    pub(crate) fn sides_of_split_if(&self, face: u32, yes: bool) -> impl Iterator<Item = u32> + use<> {
        let sides = if yes { self.sides_of_split(face) } else { [NONE; 3] };
        sides.into_iter().filter(move |_| yes)
    }

    /// Marks a side as on a seam: not all children use the wavelet's own vertex at its midpoint.
    pub(crate) fn mark_seam(&mut self, face: u32, side: usize) {
        let rank = self.rank(face);
        self.sides[rank][side] |= SEAM;
    }

    /// Removes all seams: every child uses the wavelet's own vertex at a midpoint.
    pub(crate) fn forget_seams(&mut self) {
        (self.seams, self.interior_seams, self.seam_vertices) = (Vec::new(), Vec::new(), Vec::new());
        self.sides.as_flattened_mut().iter_mut().for_each(|wavelet| *wavelet &= !SEAM);
    }

    /// Returns the wavelet on an edge inside a split face, from `m_i` to `m_(i+1)`, or `NONE`.
    #[inline]
    fn inner(&self, face: u32, edge: usize) -> u32 {
        let [centre, corner] = [3, (edge + 1) % 3].map(|child| self.child(face, child));
        if self.is_split(centre) {
            self.side_of_split(centre, edge)
        } else if self.is_split(corner) {
            self.side_of_split(corner, 1)
        } else {
            NONE
        }
    }

    /// Returns the wavelet on a side of any face, or `NONE`; and whether the side runs against the wavelet's direction.
    pub(crate) fn side(&self, face: u32, side: usize) -> (u32, bool) {
        let wavelet = self.side_wavelet(face, side);
        if wavelet == NONE {
            return (NONE, false);
        }
        let found = self.faces_along(wavelet).find(|s| s.face() == face && s.side() == side);
        (wavelet, found.is_some_and(Side::against))
    }

    fn side_wavelet(&self, face: u32, side: usize) -> u32 {
        if self.is_split(face) {
            return self.side_of_split(face, side);
        }
        let Some((parent, _, child)) = self.parent(face) else {
            return self.base_sides[face as usize][side];
        };
        match (child, side) {
            (3, edge) => self.inner(parent, edge),
            (corner, 1) => self.inner(parent, (corner + 2) % 3),
            (corner, 0) => self.half_of_side(parent, corner, 0),
            (corner, _) => self.half_of_side(parent, (corner + 2) % 3, 1),
        }
    }

    /// Returns the wavelet on the first or second half of a side of a split face.
    fn half_of_side(&self, face: u32, side: usize, half: usize) -> u32 {
        let (wavelet, against) = self.side(face, side);
        self.halves(wavelet)[half ^ usize::from(against)]
    }

    /// Iterates over all faces along a wavelet's edge, including coarser unsplit faces.
    #[inline]
    pub(crate) fn faces_along(&self, wavelet: u32) -> impl Iterator<Item = Side> + '_ {
        // None out of range.
        let [a, b] = self.along.get(wavelet as usize).copied().unwrap_or([Side::NONE; 2]);
        let more = if self.more.is_empty() { &[][..] } else { self.more_along(wavelet) };
        let count = usize::from(a != Side::NONE) + usize::from(b != Side::NONE);
        [a, b].into_iter().take(count).chain(more.iter().map(|more| more.1))
    }

    #[cold]
    fn more_along(&self, wavelet: u32) -> &[(u32, Side)] {
        let start = self.more.partition_point(|more| more.0 < wavelet);
        let count = self.more[start..].partition_point(|more| more.0 == wavelet);
        &self.more[start..start + count]
    }

    /// Returns the number of faces along a wavelet's edge, which is the number of triangles added by its vertex.
    #[inline]
    pub(crate) fn width(&self, wavelet: u32) -> usize {
        let two = if self.along[wavelet as usize][1] == Side::NONE { 1 } else { 2 };
        if self.more.is_empty() { two } else { two + self.more_along(wavelet).len() }
    }

    /// Returns the wavelets on the two halves of a wavelet's edge, in its direction; `NONE` where there is none.
    pub(crate) fn halves(&self, wavelet: u32) -> [u32; 2] {
        let mut halves = [NONE; 2];
        for along in self.faces_along(wavelet) {
            let (face, side) = (along.face(), along.side());
            if !self.is_split(face) {
                continue;
            }
            for (half, child, side) in [(0, side, 0), (1, (side + 1) % 3, 2)] {
                let child = self.child(face, child);
                if self.is_split(child) {
                    halves[half ^ usize::from(along.against())] = self.side_of_split(child, side);
                }
            }
            if !halves.contains(&NONE) {
                break;
            }
        }
        halves
    }

    /// Iterates over the children of a wavelet: wavelets on the edges of the next level meeting in its vertex, each with
    /// whether its edge starts there. Six inside a surface.
    #[inline]
    pub(crate) fn incident_edges(&self, wavelet: u32) -> impl Iterator<Item = (u32, bool)> + '_ {
        let [first, second] = self.halves(wavelet);
        let halves = [(first, false), (second, true)];
        let inner = self.faces_along(wavelet).filter(|along| self.is_split(along.face())).flat_map(|along| {
            let (face, side) = (along.face(), along.side());
            // Edges inside run in the direction of the centre's sides.
            [(self.inner(face, side), true), (self.inner(face, (side + 2) % 3), false)]
        });
        halves.into_iter().chain(inner).filter(|incident| incident.0 != NONE)
    }

    /// Iterates over the parents of a wavelet: up to two.
    #[inline]
    pub(crate) fn parents_of(&self, wavelet: u32) -> impl Iterator<Item = u32> + use<> {
        let (mut first, mut second) = (NONE, NONE);
        let along = self.along.get(wavelet as usize).map(|along| along[0]);
        if let Some((along, (_, rank, child))) =
            along.and_then(|along| Some((along, self.parent(along.face())?)))
        {
            let side = |k: usize| self.sides[rank][k % 3] & !SEAM;
            match (child, along.side()) {
                (3, k) => (first, second) = (side(k), side(k + 1)),
                (i, 0) => first = side(i),
                (i, 1) => (first, second) = (side(i), side(i + 2)),
                (i, _) => first = side(i + 2),
            }
        }
        [first, second].into_iter().filter(|&parent| parent != NONE)
    }

    /// Returns the ends of the edge whose midpoint a vertex is; `None` for base vertices and out of range. O(1) on average.
    pub fn ends(&self, vertex: u32) -> Option<[u32; 2]> {
        let at = vertex.checked_sub(self.base_vertices)? as usize;
        match self.along.get(at) {
            Some(along) => Some(self.side_ends(along[0])),
            None => {
                let &(wavelet, along) = self.seam_vertices.get(at - self.along.len())?;
                Some(self.ends_beside(wavelet, along))
            }
        }
    }

    /// Returns the ends of a wavelet's edge as vertices of the face at `side`. The side may be longer than the edge. O(level).
    fn ends_beside(&self, wavelet: u32, side: Side) -> [u32; 2] {
        let mut ends = [NONE; 2];
        for (whole, half) in self.parent_edges(wavelet, side.face()) {
            let end = &mut ends[1 - half];
            if *end == NONE {
                *end = self.vertices_at(whole, side.face(), side.side())[0];
            }
            if !ends.contains(&NONE) {
                return ends;
            }
        }
        let far = self.side_ends(side);
        [0, 1].map(|end| if ends[end] == NONE { far[end] } else { ends[end] })
    }

    /// Iterates over the wavelets of coarser edges containing a wavelet's edge, finest first. Each comes with the half (0 or 1)
    /// containing the edge before it. Ends at the level of the wavelets of `face` if it is, or were, split. All edges have the
    /// same direction.
    pub(crate) fn parent_edges(&self, wavelet: u32, face: u32) -> impl Iterator<Item = (u32, usize)> + '_ {
        let start = self.face_levels[self.level_of_face(face) + 1];
        let mut along = self.along[wavelet as usize][0];
        std::iter::from_fn(move || {
            if along.face() < start {
                return None;
            }
            let (parent, rank, child) = self.parent(along.face())?;
            let (side, half) = match (child, along.side()) {
                (3, _) | (_, 1) => return None,
                (corner, 0) => (corner, 0),
                (corner, _) => ((corner + 2) % 3, 1),
            };
            let half = half ^ usize::from(along.against());
            along = Side::new(parent, side, along.against());
            Some((self.sides[rank][side] & !SEAM, half))
        })
    }

    /// Returns the vertices at the ends of a side, in the direction of the edge.
    #[inline]
    pub(crate) fn side_ends(&self, along: Side) -> [u32; 2] {
        let [a, b] = [along.side(), (along.side() + 1) % 3].map(|corner| self.corner(along.face(), corner));
        if along.against() { [b, a] } else { [a, b] }
    }

    /// Returns a wavelet's own vertex; on a seam there are [others](Self::seam_vertices_of) too. Out of range, a number that is no
    /// vertex of a wavelet.
    pub fn vertex_of(&self, wavelet: u32) -> u32 {
        if (wavelet as usize) < self.along.len() { self.base_vertices + wavelet } else { NONE }
    }

    /// Returns the wavelet of a vertex; `None` for base vertices and out of range.
    pub fn wavelet_of(&self, vertex: u32) -> Option<u32> {
        let at = vertex.checked_sub(self.base_vertices)?;
        if (at as usize) < self.along.len() {
            return Some(at);
        }
        self.seam_vertices.get(at as usize - self.along.len()).map(|double| double.0)
    }

    /// Further vertices of a wavelet on a seam, by number.
    pub fn seam_vertices_of(&self, wavelet: u32) -> std::ops::Range<u32> {
        let first = self.base_vertices + self.along.len() as u32;
        let start = self.seam_vertices.partition_point(|double| double.0 < wavelet);
        let count = self.seam_vertices[start..].partition_point(|double| double.0 == wavelet);
        first + start as u32..first + (start + count) as u32
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.base[..])
            + size_of_val(&self.base_sides[..])
            + size_of_val(&self.split_faces[..])
            + size_of_val(&self.split[..])
            + size_of_val(&self.before[..])
            + size_of_val(&self.sides[..])
            + size_of_val(&self.along[..])
            + size_of_val(&self.more[..])
            + size_of_val(&self.seams[..])
            + size_of_val(&self.interior_seams[..])
            + size_of_val(&self.seam_vertices[..])
    }
}
