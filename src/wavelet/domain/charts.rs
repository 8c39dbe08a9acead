//! A mesh textured by an atlas: each vertex on an edge of the base is repeated for each base face there, with its
//! coordinates.

use crate::mesh::{Attribute, Mesh, names};
use crate::wavelet::bounds::all_bounds;
use crate::wavelet::subdivision::Part;
use crate::wavelet::{Atlas, Subdivision, WaveletError, WaveletMesh};

impl Subdivision {
    /// Returns this subdivision with every edge of the base as a seam, even beside unsplit faces: base faces share no
    /// vertices. Also returns the vertex of `self` for each vertex of the result. Vertices of the same wavelet with equal
    /// `name` become a single vertex, except on edges of the base.
    fn apart(&self, name: impl Fn(u32) -> u32) -> (Self, Vec<u32>) {
        let count = self.base.len() as u32;
        let mut apart = Self {
            base: (0..count).map(|face| [0, 1, 2].map(|corner| 3 * face + corner)).collect(),
            base_vertices: 3 * count,
            ..self.clone()
        };
        apart.forget_seams();
        // Each face beside an edge of the base is on the side of another base face, as tell_apart requires.
        let key = |_: &Self, _: u32, face: u32, side: usize, part: Part| {
            if !self.is_split(face) {
                return (self.base_side(face, side), None);
            }
            let (child, corner) = part.corner(side);
            let vertex = name(self.corner(self.child(face, child), corner));
            let is_own = self.wavelet_of(vertex).is_some_and(|wavelet| self.vertex_of(wavelet) == vertex);
            (self.base_side(face, side), (!is_own).then_some(vertex))
        };
        apart.tell_apart(|_, _| true, key);

        let mut order = self.base.as_flattened().to_vec();
        order.resize(apart.vertex_count(), 0);
        for wavelet in 0..self.wavelet_count() as u32 {
            for along in self.faces_along(wavelet) {
                let (face, side) = (along.face(), along.side());
                if !self.is_split(face) {
                    let [new, old] = [&apart, self].map(|of| of.vertices_at(wavelet, face, side)[0]);
                    order[new as usize] = old;
                    continue;
                }
                for part in Part::ALL {
                    let (child, corner) = part.corner(side);
                    let [new, old] = [&apart, self].map(|of| of.corner(of.child(face, child), corner));
                    order[new as usize] = old;
                }
            }
        }
        (apart, order)
    }

    /// Returns the side of a base face containing the face's side, or the base face with `None` for a side inside it.
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
    /// Returns the mesh with the texture coordinates of an atlas as attribute `uv`, replacing its previous `uv`. Base
    /// faces no longer share vertices: vertices on edges of the base are repeated for each face. Positions, other
    /// attributes, faces and wavelets stay. Removes unused vertices of the base, and seams of the previous `uv` inside
    /// base faces; if these changed the diagonal or the inner seams, bounds are recomputed, else they stay.
    ///
    /// Every vertex of a wavelet has the mean of its ends' coordinates, bit for bit. O(n).
    ///
    /// # Errors
    /// The atlas has a different number of base faces.
    pub fn with_atlas(&self, atlas: &Atlas) -> Result<Self, WaveletError> {
        atlas.check(self)?;
        let alike = |a: u32, b: u32| {
            let mut others = self.vertices.attributes().iter().filter(|values| values.name() != names::UV);
            others.all(|values| values.words(a) == values.words(b))
        };
        let of = &self.subdivision;
        // Seams of other attributes stay where they run inside base faces.
        let (subdivision, order) = of.apart(|vertex| {
            let Some(wavelet) = of.wavelet_of(vertex) else { return vertex };
            let mut all = std::iter::once(of.vertex_of(wavelet)).chain(of.seam_vertices_of(wavelet));
            all.find(|&other| alike(other, vertex)).unwrap_or(vertex)
        });
        let mut uv = vec![[0.0_f32; 2]; subdivision.vertex_count()];
        for (face, corners) in (0..).zip(&subdivision.base) {
            let Some(chart) = atlas.chart(face) else { continue };
            corners.iter().zip(chart).for_each(|(&vertex, at)| uv[vertex as usize] = at);
        }
        // Level by level, so ends come first.
        for wavelet in 0..subdivision.wavelet_count() as u32 {
            let own = subdivision.vertex_of(wavelet);
            for vertex in std::iter::once(own).chain(subdivision.seam_vertices_of(wavelet)) {
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
        )
        .at_origin_of(&self.vertices);
        let mut mesh = Self { subdivision, vertices, ..self.clone() };
        mesh.measure();
        // Keep the bounds, unless removed vertices or seams inside base faces changed the diagonal or the inner seams.
        if mesh.diagonal.to_bits() != self.diagonal.to_bits()
            || mesh.subdivision.interior_seams != of.interior_seams
        {
            mesh.bounds = all_bounds(&mesh).into();
        }
        Ok(mesh)
    }
}
