//! Places on the base: where faces and vertices are, as a base face and barycentric coordinates in it.
//!
//! ```text
//!            c2 (0, 0, 1)
//!            /\                  the corners of a face are halves of halves of the base face's corners: numbers with
//!           /__\                 as many binary digits as the face has levels
//!          /\  /\
//!      c0 /__\/__\ c1            a point of an edge of the base has a place in each base face there
//! (1, 0, 0)  m0   (0, 1, 0)
//!        (1/2, 1/2, 0)
//! ```
//!
//! So data given on the base (a texture, say) is defined for every set of wavelets.

use crate::wavelet::Subdivision;
use crate::wavelet::subdivision::Part;
use crate::wavelet::subdivision::Side;

/// A point of the base.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct DomainPoint {
    /// The base face.
    pub base_face: u32,
    /// Barycentric coordinates in the base face; they sum to 1. Exact for vertices.
    pub barycentric: [f64; 3],
}

impl DomainPoint {
    /// Makes a point of a base face.
    pub fn new(base_face: u32, barycentric: [f64; 3]) -> Self {
        Self { base_face, barycentric }
    }
}

/// Barycentric coordinates of a child's corners in its parent.
pub(crate) fn child_corners(child: usize) -> [[f64; 3]; 3] {
    let corner = |i: usize| std::array::from_fn(|k| f64::from(k == i % 3));
    let middle = |i: usize| blend(corner(i), corner(i + 1));
    match child {
        3 => [middle(0), middle(1), middle(2)],
        i => [corner(i), middle(i), middle(i + 2)],
    }
}

fn blend(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| 0.5 * a[i] + 0.5 * b[i])
}

/// Converts coordinates `inner` in a triangle to the coordinates in which its `corners` are given.
pub(crate) fn compose(inner: [f64; 3], corners: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| inner[k] * corners[k][i]).sum())
}

impl Subdivision {
    /// Vertices at the corners of a face of any level; `None` out of range. O(1) on average.
    pub fn face(&self, face: u32) -> Option<[u32; 3]> {
        ((face as usize) < self.face_count()).then(|| self.corners(face))
    }

    /// Places of a face's corners in its base face; `None` out of range. O(level).
    pub fn domain_of_face(&self, face: u32) -> Option<[DomainPoint; 3]> {
        if face as usize >= self.face_count() {
            return None;
        }
        let mut corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut at = face;
        while let Some((parent, _, child)) = self.parent(at) {
            let of_child = child_corners(child);
            corners = corners.map(|corner| compose(corner, &of_child));
            at = parent;
        }
        Some(corners.map(|barycentric| DomainPoint { base_face: at, barycentric }))
    }

    /// Places of a vertex: one in each base face with the vertex inside, or for each corner or side of base faces at the
    /// vertex. Empty out of range. O(level); for base vertices O(base faces).
    pub fn domain_of(&self, vertex: u32) -> impl Iterator<Item = DomainPoint> + '_ {
        let wavelet = self.wavelet_of(vertex);
        let base = self.base.iter().take(if wavelet.is_none() { self.base.len() } else { 0 });
        let at_corners = base.zip(0..).flat_map(move |(corners, base_face)| {
            (0..3).filter(move |&k| corners[k] == vertex).map(move |corner| DomainPoint {
                base_face,
                barycentric: std::array::from_fn(|k| f64::from(k == corner)),
            })
        });
        let mut last = None;
        let on_sides = wavelet.into_iter().flat_map(move |wavelet| {
            let sides = self.faces_along(wavelet);
            sides.filter_map(move |side| {
                let point = self.is_at(vertex, wavelet, side).then(|| self.domain_beside(wavelet, side))?;
                // Inside base faces all sides give the same point.
                (last.replace(point) != Some(point)).then_some(point)
            })
        });
        at_corners.chain(on_sides)
    }

    /// Whether a face has `vertex` as the wavelet's midpoint on the side `along`, or in a part of the face there.
    fn is_at(&self, vertex: u32, wavelet: u32, along: Side) -> bool {
        let (face, side) = (along.face(), along.side());
        if self.seam_vertices.is_empty() || !self.is_split(face) {
            return self.vertices_at(wavelet, face, side)[0] == vertex;
        }
        Part::ALL.into_iter().any(|part| {
            let (child, corner) = part.corner(side);
            self.corner(self.child(face, child), corner) == vertex
        })
    }

    /// Returns the place of the midpoint of a wavelet's edge, as seen from a side containing the edge.
    pub(crate) fn domain_beside(&self, wavelet: u32, side: Side) -> DomainPoint {
        let corners = self.domain_of_face(side.face()).unwrap_or([DomainPoint::new(0, [0.0; 3]); 3]);
        let [a, b] = [corners[side.side()], corners[(side.side() + 1) % 3]];
        let t = self.along_side(wavelet, side);
        let barycentric = std::array::from_fn(|i| (1.0 - t) * a.barycentric[i] + t * b.barycentric[i]);
        DomainPoint { base_face: a.base_face, barycentric }
    }

    /// Returns the position, 0 to 1, of the midpoint of a wavelet's edge along a side containing the edge.
    pub(crate) fn along_side(&self, wavelet: u32, side: Side) -> f64 {
        let parent_edges = self.parent_edges(wavelet, side.face());
        let t = parent_edges.fold(0.5, |t, (_, half)| 0.5 * (t + half as f64));
        if side.against() { 1.0 - t } else { t }
    }
}
