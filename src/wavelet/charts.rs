//! A mesh that wears an atlas: vertices on edges of the base are one for each base face there, with its coordinates.

use crate::mesh::{Attribute, Mesh, names};

use super::bounds::bounds;
use super::{Atlas, Subdivision, WaveletError, WaveletMesh};

impl Subdivision {
    /// The same where every edge of the base is a seam, whatever is split beside it: base faces share no vertices. And for every
    /// vertex of that the one here.
    pub(super) fn apart(&self) -> (Self, Vec<u32>) {
        let count = self.base.len() as u32;
        let mut apart = Self {
            base: (0..count).map(|face| [0, 1, 2].map(|corner| 3 * face + corner)).collect(),
            base_vertices: 3 * count,
            seams: Vec::new(),
            doubles: Vec::new(),
            ..self.clone()
        };
        apart.forget_seams();
        // A side of a base face has one face at every place: so each has a key of its own on edges of the base.
        apart.tell_apart(|_, _| true, Self::base_side);

        let sides =
            (0..self.wavelet_count() as u32).map(|wavelet| (wavelet, self.along[wavelet as usize][0]));
        let wavelets = sides.chain(apart.doubles.iter().copied());
        let of_wavelets = wavelets.map(|(wavelet, side)| self.vertex_at(wavelet, side.face(), side.side()));
        let order = self.base.as_flattened().iter().copied().chain(of_wavelets).collect();
        (apart, order)
    }

    /// The side of a base face that a side of a face is on, or the base face with `None` where it is inside.
    fn base_side(&self, mut face: u32, side: usize) -> (u32, Option<usize>) {
        let mut side = Some(side);
        while let Some((parent, _, child)) = self.parent(face) {
            side = match (child, side) {
                (3, _) | (_, Some(1) | None) => None,
                (corner, Some(0)) => Some(corner),
                (corner, Some(_)) => Some((corner + 2) % 3),
            };
            face = parent;
        }
        (face, side)
    }
}

impl WaveletMesh {
    /// The same mesh with the texture coordinates of an atlas, as attribute `uv`, instead of those that it had. Base faces share
    /// no vertices any more: those on edges of the base are there once for each face. Places, other attributes, faces, wavelets
    /// and bounds stay; vertices of the base that no face uses go.
    ///
    /// Every vertex of a wavelet has the middle of its ends' coordinates, bit for bit. O(n).
    ///
    /// # Errors
    /// The atlas is of another number of base faces.
    pub fn with_atlas(&self, atlas: &Atlas) -> Result<Self, WaveletError> {
        atlas.check(self)?;
        let (subdivision, order) = self.subdivision.apart();
        let mut uv = vec![[0.0_f32; 2]; subdivision.vertex_count()];
        for (face, corners) in (0..).zip(&subdivision.base) {
            let Some(chart) = atlas.chart(face) else { continue };
            corners.iter().zip(chart).for_each(|(&vertex, at)| uv[vertex as usize] = at);
        }
        // Level by level, so that ends come first.
        for wavelet in 0..subdivision.wavelet_count() as u32 {
            let own = subdivision.vertex_of(wavelet);
            for vertex in std::iter::once(own).chain(subdivision.doubles_of(wavelet)) {
                let Some(ends) = subdivision.ends(vertex) else { continue };
                let [a, b] = ends.map(|end| uv[end as usize]);
                uv[vertex as usize] = std::array::from_fn(|i| 0.5 * a[i] + 0.5 * b[i]);
            }
        }
        let vertices = match order.is_empty() {
            true => Mesh::default().with_material_names(self.vertices.material_names()),
            false => self.vertices.gather(&order, Vec::new(), Vec::new()),
        };
        let mut attributes = vertices.attributes().to_vec();
        let uv = Attribute::floats(names::UV, &uv);
        match attributes.iter_mut().find(|attribute| attribute.name() == names::UV) {
            Some(before) => *before = uv,
            None => attributes.push(uv),
        }
        let vertices = Mesh::from_trusted(
            vertices.positions().to_vec(),
            Vec::new(),
            attributes,
            Vec::new(),
            vertices.material_names().to_vec(),
            vertices.locks().to_vec(),
        );
        let mut mesh = Self { subdivision, vertices, ..self.clone() };
        let diagonal = mesh.find_diagonal();
        // Unless vertices that no face used were out of the way.
        if diagonal.to_bits() != self.diagonal.to_bits() {
            mesh.diagonal = diagonal;
            mesh.bounds = bounds(&mesh);
        }
        Ok(mesh)
    }
}
