//! The plain arrays of a wavelet mesh, in and out, without derived data.
//!
//! Connectivity is rebuilt from the base faces, the wavelets along their sides, and a bit a face: split or not. Bounds are
//! derived too, but computing them takes as long as making the mesh, so they are stored.

use crate::mesh::{Mesh, NONE};

use super::{Subdivision, WaveletBounds, WaveletError, WaveletMesh, WaveletOptions};

/// The arrays of a [`WaveletMesh`], for file formats of your own.
///
/// Faces and wavelets are numbered level by level: base faces first, then four children of each split face in order; wavelets
/// in the order of the split faces along their edges. Side k of a face runs from corner k to corner k + 1 (modulo 3).
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WaveletParts {
    /// Vertices at the corners of every base face.
    pub base: Vec<[u32; 3]>,
    /// Number of base vertices, which are vertices `0..base_vertices`.
    pub base_vertices: u32,
    /// Per side of every base face `2 * wavelet + against`: `against` is 1 if the side runs against the wavelet's edge, else 0.
    /// `u32::MAX` without a wavelet.
    pub sides: Vec<[u32; 3]>,
    /// A bit a face, from the lowest bit of the first word on: set if the face is split. For all levels but the finest.
    pub split: Vec<u64>,
    /// Corners of faces at midpoints where the vertex differs from the wavelet's own: `[4 * face + corner, vertex]`, ascending.
    pub seams: Vec<[u32; 2]>,
    /// Sides of unsplit faces beside deeper neighbours across a seam, where the vertex differs from the wavelet's own:
    /// `[wavelet, 4 * face + side, vertex]`, ordered by vertex. Empty if no such side differs.
    pub beside: Vec<[u32; 3]>,
    /// All vertices, without triangles: base vertices, each wavelet's own vertex, and further vertices at seams.
    pub vertices: Mesh,
    /// The material ids in use, ascending.
    pub materials: Vec<u32>,
    /// Per base face an index into `materials`; empty if `materials` is empty.
    pub group_of: Vec<u16>,
    /// Per wavelet the bounds of the change when it is left out.
    pub bounds: Vec<WaveletBounds>,
    /// Options used to make the bounds.
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
            group_of: mesh.group_of.into_vec(),
            bounds: mesh.bounds.into_vec(),
            options: mesh.options,
        }
    }
}

impl TryFrom<WaveletParts> for WaveletMesh {
    type Error = WaveletError;

    /// Builds and checks a mesh; fails as [`WaveletMesh::validate`]. O(n) time; O(mesh) memory.
    fn try_from(parts: WaveletParts) -> Result<Self, WaveletError> {
        let subdivision = parts.grow()?;
        let WaveletParts { vertices, materials, group_of, bounds, options, .. } = parts;
        let (group_of, bounds) = (group_of.into(), bounds.into());
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

/// Serialises the members of [`WaveletParts`] in the same order, without copying the large arrays.
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
