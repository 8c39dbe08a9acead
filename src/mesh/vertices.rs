//! Meshes from an engine's buffers: vertices of any type, indices, and ranges of materials.

use std::ops::Range;

use bytemuck::NoUninit;

use super::group::{Key, group};
use super::{Attribute, AttributeValues, MAX_ELEMENTS, Mesh, Topology, names};
use crate::error::MeshError;

/// An index of a vertex buffer: `u16` or `u32`.
pub trait Index: Copy + Into<u32> {}

impl Index for u16 {}
impl Index for u32 {}

impl Mesh {
    /// Builds a mesh from an engine's vertex and index buffers. Vertices have any type without padding. Three indices
    /// make a triangle, counter-clockwise seen from outside. `position` returns a vertex's position in object units.
    /// O(n) expected time.
    ///
    /// Vertices equal byte for byte are a single wedge; all others are different wedges. Vertices at equal positions
    /// with a differing byte (a normal, a texture coordinate, a colour, a joint) form a seam, and the simplifier keeps
    /// it. The mesh then has an attribute [`names::VERTEX`] to tell them apart. Vertices keep their numbers.
    ///
    /// Add values as attributes ([`Attribute::of`]) if they should *count* in simplification or be fitted.
    ///
    /// ```
    /// use multires::mesh::{Attribute, Mesh, names};
    ///
    /// #[derive(Clone, Copy, bytemuck::NoUninit)]
    /// #[repr(C)]
    /// struct Vertex {
    ///     position: [f32; 3],
    ///     uv: [f32; 2],
    /// }
    ///
    /// // Two triangles that meet at an edge where the texture does not.
    /// let vertex = |position, uv| Vertex { position, uv };
    /// let (a, b) = ([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    /// let vertices = [
    ///     vertex([-1.0, 0.5, 0.0], [0.0, 0.5]),
    ///     vertex(a, [0.4, 0.0]),
    ///     vertex(b, [0.4, 1.0]),
    ///     vertex(a, [0.6, 0.0]),
    ///     vertex([1.0, 0.5, 0.0], [1.0, 0.5]),
    ///     vertex(b, [0.6, 1.0]),
    /// ];
    /// let indices: [u16; 6] = [0, 1, 2, 3, 4, 5];
    /// let mesh = Mesh::from_vertices(&vertices, &indices, |v| v.position)?
    ///     .with_attribute(Attribute::of(names::UV, &vertices, |v| v.uv))?
    ///     .with_material_ranges(&[0..3, 3..6])?;
    /// assert_eq!(mesh.materials(), [0, 1]);
    /// # Ok::<(), multires::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// Fails if the number of indices is not a multiple of 3, or where [`Mesh::new`] fails.
    pub fn from_vertices<V: NoUninit>(
        vertices: &[V],
        indices: &[impl Index],
        position: impl Fn(&V) -> [f32; 3],
    ) -> Result<Self, MeshError> {
        if !indices.len().is_multiple_of(3) {
            return Err(MeshError::OddIndices { indices: indices.len() });
        }
        if vertices.len() > MAX_ELEMENTS {
            return Err(MeshError::TooMany { what: "vertices", count: vertices.len(), limit: MAX_ELEMENTS });
        }
        let triangles: Vec<[u32; 3]> =
            indices.chunks_exact(3).map(|t| [t[0].into(), t[1].into(), t[2].into()]).collect();
        let mesh = Self::new(vertices.iter().map(position).collect::<Vec<_>>(), triangles)?;
        let topology = Topology::new(&mesh);
        let point_of = topology.point_of();
        let bytes = |v: usize| bytemuck::bytes_of(&vertices[v]);
        let first = group(
            vertices.len(),
            |key, v| hash(key, u64::from(point_of[v]), bytes(v)),
            |a, b| point_of[a] == point_of[b] && bytes(a) == bytes(b),
        );
        let wedges = first.iter().zip(0..).filter(|&(&first, vertex)| first == vertex).count();
        if wedges == topology.point_count() {
            return Ok(mesh);
        }
        mesh.with_attribute(Attribute::new(names::VERTEX, 1, AttributeValues::Uint(first)))
    }

    /// Sets materials by ranges of *indices*, as an engine's draw calls name them: triangles of range `i` get material
    /// `i`. O(n).
    ///
    /// # Errors
    /// Fails if a range does not hold whole triangles or exceeds the indices, or if a triangle is in no range or in
    /// several.
    pub fn with_material_ranges(self, ranges: &[Range<usize>]) -> Result<Self, MeshError> {
        let count = self.triangles().len();
        let mut materials = vec![u32::MAX; count];
        for (i, range) in ranges.iter().enumerate() {
            let refused = || MeshError::MaterialRange { range: i, start: range.start, end: range.end };
            let ends = [range.start, range.end];
            let whole = ends.iter().all(|end| end.is_multiple_of(3)) && range.start <= range.end;
            let triangles = range.start / 3..range.end / 3;
            let own = materials.get_mut(triangles).filter(|_| whole).ok_or_else(refused)?;
            if own.iter().any(|&material| material != u32::MAX) {
                return Err(refused());
            }
            own.fill(i as u32);
        }
        match materials.iter().position(|&material| material == u32::MAX) {
            Some(triangle) => Err(MeshError::NoMaterial { triangle }),
            None => self.with_materials(materials),
        }
    }
}

/// Filters pairs of vertices: keeps pairs used by triangles and equal in position and all attributes, bit for bit
/// (zeros of both signs are equal positions but different values). O(n).
pub(crate) fn folded(mesh: &Mesh, duplicates: impl Iterator<Item = [u32; 2]>) -> Vec<[u32; 2]> {
    let mut used = vec![false; mesh.positions().len()];
    mesh.indices().iter().for_each(|&v| used[v as usize] = true);
    let position = |v: u32| mesh.positions()[v as usize].map(f32::to_bits);
    let are_one = |&[a, b]: &[u32; 2]| {
        used[a as usize]
            && used[b as usize]
            && position(a) == position(b)
            && mesh.attributes().iter().all(|values| values.words(a) == values.words(b))
    };
    duplicates.filter(are_one).collect()
}

/// Checks that values do not differ between `folded` vertices: the mesh merged each pair, as nothing told them apart.
pub(crate) fn check_folded<V: NoUninit>(values: &[V], folded: &[[u32; 2]]) -> Result<(), MeshError> {
    let bytes = |v: u32| values.get(v as usize).map(bytemuck::bytes_of);
    match folded.iter().find(|[duplicate, kept]| bytes(*duplicate) != bytes(*kept)) {
        Some(&[duplicate, kept]) => Err(MeshError::Folded { vertices: [kept, duplicate] }),
        None => Ok(()),
    }
}

/// Hashes a point and the bytes of a vertex.
fn hash(key: Key, point: u64, bytes: &[u8]) -> u64 {
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    words.fold(key.mix(point), |hash, word| key.mix(hash ^ word))
}
