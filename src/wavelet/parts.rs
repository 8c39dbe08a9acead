//! The plain arrays that a wavelet mesh is made of, in and out. What follows from others is not among them.
//!
//! Connectivity is grown anew from the base faces, what is along their sides, and one bit a face: who is split. Bounds would follow
//! too, but finding them takes as long as making the mesh, so they are stored.

use crate::mesh::{Mesh, NONE};

use super::{Subdivision, WaveletBounds, WaveletError, WaveletMesh, WaveletOptions};

/// The arrays of a [`WaveletMesh`], for file formats of your own.
///
/// Faces and wavelets are numbered level by level: base faces first, then four children of each split face in order; wavelets
/// in the order of the split faces whose sides they are on. Side k of a face runs from corner k to the next.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WaveletParts {
    /// Vertices at the corners of every base face.
    pub base: Vec<[u32; 3]>,
    /// Number of base vertices, which are the first ones.
    pub base_vertices: u32,
    /// Per side of every base face twice the wavelet on it, and one more if the side runs against the wavelet's edge; `u32::MAX`
    /// without one.
    pub sides: Vec<[u32; 3]>,
    /// One bit a face, from the lowest bit of the first word on: whether it is split. Of all levels but the finest.
    pub split: Vec<u64>,
    /// Corners of faces at midpoints where they have another vertex than the wavelet's own, as four times the face and the corner,
    /// ascending; and that vertex.
    pub seams: Vec<[u32; 2]>,
    /// The same for sides of faces that are not split, beside deeper neighbours across a seam: wavelet, four times the face and the side,
    /// and vertex; by vertex. Without any, faces across a seam are split together.
    pub beside: Vec<[u32; 3]>,
    /// All vertices, without triangles: of the base, one for each wavelet, and the others at seams.
    pub vertices: Mesh,
    /// The material ids in use, ascending.
    pub materials: Vec<u32>,
    /// Per base face an index into `materials`; empty where that is.
    pub group_of: Vec<u16>,
    /// Per wavelet what leaving it out can change.
    pub bounds: Vec<WaveletBounds>,
    /// How bounds were made.
    pub options: WaveletOptions,
}

impl From<WaveletMesh> for WaveletParts {
    fn from(mesh: WaveletMesh) -> Self {
        let of = &mesh.subdivision;
        Self {
            base_vertices: of.base_vertices,
            sides: sides(of),
            split: split(of),
            seams: seams(of),
            beside: beside(of),
            base: mesh.subdivision.base,
            vertices: mesh.vertices,
            materials: mesh.materials,
            group_of: mesh.group_of,
            bounds: mesh.bounds,
            options: mesh.options,
        }
    }
}

impl TryFrom<WaveletParts> for WaveletMesh {
    type Error = WaveletError;

    /// As [`WaveletMesh::validate`]. O(n), in memory as the mesh itself.
    fn try_from(parts: WaveletParts) -> Result<Self, WaveletError> {
        let subdivision = parts.grow()?;
        let WaveletParts { vertices, materials, group_of, bounds, options, .. } = parts;
        let mut mesh =
            Self { subdivision, vertices, materials, group_of, bounds, options, diagonal: 0.0, extent: None };
        mesh.measure();
        mesh.check_values()?;
        Ok(mesh)
    }
}

/// [`WaveletParts::sides`] of a subdivision.
pub(super) fn sides(of: &Subdivision) -> Vec<[u32; 3]> {
    let side = |face: u32, k: usize| match of.side(face, k) {
        (NONE, _) => NONE,
        (wavelet, against) => wavelet << 1 | u32::from(against),
    };
    (0..of.base_face_count() as u32).map(|face| [0, 1, 2].map(|k| side(face, k))).collect()
}

/// [`WaveletParts::split`] of a subdivision.
pub(super) fn split(of: &Subdivision) -> Vec<u64> {
    let end = of.faces_of(of.depth()).start;
    let word = |first: u32| {
        (first..end.min(first + 64))
            .fold(0, |word, face| word | u64::from(of.is_split(face)) << (face - first))
    };
    (0..end).step_by(64).map(word).collect()
}

/// [`WaveletParts::seams`] of a subdivision.
pub(super) fn seams(of: &Subdivision) -> Vec<[u32; 2]> {
    of.seams.iter().map(|&(corner, vertex)| [corner, vertex]).collect()
}

/// [`WaveletParts::beside`] of a subdivision.
pub(super) fn beside(of: &Subdivision) -> Vec<[u32; 3]> {
    let first = of.base_vertices + of.wavelet_count() as u32;
    let seam_vertices =
        of.seam_vertices.iter().zip(first..).filter(|((_, along), _)| !of.is_split(along.face()));
    seam_vertices
        .map(|(&(wavelet, along), vertex)| [wavelet, along.face() << 2 | along.side() as u32, vertex])
        .collect()
}

/// The same members in the same order as [`WaveletParts`], without a copy of the large ones.
#[cfg(feature = "serde")]
impl serde::Serialize for WaveletMesh {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(serde::Serialize)]
        #[serde(rename = "WaveletParts")]
        struct Borrowed<'a> {
            base: &'a [[u32; 3]],
            base_vertices: u32,
            sides: Vec<[u32; 3]>,
            split: Vec<u64>,
            seams: Vec<[u32; 2]>,
            beside: Vec<[u32; 3]>,
            vertices: &'a Mesh,
            materials: &'a [u32],
            group_of: &'a [u16],
            bounds: &'a [WaveletBounds],
            options: WaveletOptions,
        }
        let of = &self.subdivision;
        let parts = Borrowed {
            base: &of.base,
            base_vertices: of.base_vertices,
            sides: sides(of),
            split: split(of),
            seams: seams(of),
            beside: beside(of),
            vertices: &self.vertices,
            materials: &self.materials,
            group_of: &self.group_of,
            bounds: &self.bounds,
            options: self.options,
        };
        parts.serialize(serializer)
    }
}
