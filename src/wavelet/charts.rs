//! A mesh that wears an atlas: vertices on edges of the base are one for each base face there, with its coordinates.

use crate::mesh::{Attribute, Mesh, names};

use super::bounds::all_bounds;
use super::build::Part;
use super::{Atlas, Subdivision, WaveletError, WaveletMesh};

impl Subdivision {
    /// The same where every edge of the base is a seam, whatever is split beside it: base faces share no vertices. And for every
    /// vertex of that the one here. Of vertices of one wavelet those that are one by `name` are one, but on edges of the base.
    fn apart(&self, name: impl Fn(u32) -> u32) -> (Self, Vec<u32>) {
        let count = self.base.len() as u32;
        let mut apart = Self {
            base: (0..count).map(|face| [0, 1, 2].map(|corner| 3 * face + corner)).collect(),
            base_vertices: 3 * count,
            ..self.clone()
        };
        apart.forget_seams();
        // Of the faces beside an edge of the base each is on a base face's side of its own, as tell_apart asks for.
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
    /// and bounds stay; vertices of the base that no face uses go, and seams that coordinates had inside base faces.
    ///
    /// Every vertex of a wavelet has the middle of its ends' coordinates, bit for bit. O(n).
    ///
    /// # Errors
    /// The atlas is of another number of base faces.
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
        // Level by level, so that ends come first.
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
        // They stay, unless vertices that no face used were out of the way, or coordinates were torn inside base faces.
        if mesh.diagonal.to_bits() != self.diagonal.to_bits()
            || mesh.subdivision.interior_seams != of.interior_seams
        {
            mesh.bounds = all_bounds(&mesh);
        }
        Ok(mesh)
    }
}
