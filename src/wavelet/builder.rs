//! Builds a wavelet mesh from a base mesh level by level: functions place the new vertices and choose the faces to split.

use std::ops::ControlFlow;

use crate::lod::{Baked, Mixture, Origins, Progress};
use crate::mesh::{Mesh, MeshPoint, NONE, Topology};

use super::sources::{LEAST_WEIGHT, Sources};
use super::subdivision::SubdivisionBuilder;
use super::{DomainPoint, WaveletError, WaveletMesh, WaveletOptions};

/// A new vertex: the midpoint of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Midpoint {
    /// The first level with this vertex, from 1.
    pub level: usize,
    /// Ends of the edge, vertices of the mesh under construction.
    pub ends: [u32; 2],
    /// Positions of the ends, object units.
    pub positions: [[f32; 3]; 2],
    /// Mean of both positions, object units.
    pub middle: [f32; 3],
    /// Place on the base: of an edge of the base, in one of the base faces there.
    pub domain: DomainPoint,
}

/// A face which may be split.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Face {
    /// Its level, 0 for base faces.
    pub level: usize,
    /// The triangle of the base mesh containing the face.
    pub base_face: u32,
    /// Its corners, vertices of the mesh under construction.
    pub vertices: [u32; 3],
    /// Positions of the corners, object units.
    pub corners: [[f32; 3]; 3],
    /// Barycentric coordinates of the corners in the base face.
    pub barycentric: [[f64; 3]; 3],
}

/// Vertices not in the base, with their ends.
type Ends = Vec<(u32, [u32; 2])>;

/// Subdivides a base mesh. Attributes of a new vertex are the mean of its ends' attributes.
///
/// ```
/// use multires::mesh::shapes;
/// use multires::wavelet::{WaveletBuilder, WaveletOptions};
///
/// // A sphere: midpoints go out to radius 1.
/// let mut builder = WaveletBuilder::new(&shapes::icosphere(0))?;
/// for _ in 0..4 {
///     builder.subdivide(|midpoint| {
///         let length = midpoint.middle.iter().map(|x| x * x).sum::<f32>().sqrt();
///         midpoint.middle.map(|x| x / length)
///     })?;
/// }
/// let sphere = builder.build(&WaveletOptions::default())?;
/// assert_eq!(sphere.subdivision().leaf_count(), 20 * 256);
/// # Ok::<(), multires::wavelet::WaveletError>(())
/// ```
#[derive(Debug)]
pub struct WaveletBuilder {
    builder: SubdivisionBuilder,
    base: Mesh,
    /// Positions of base vertices, then of wavelets.
    positions: Vec<[f32; 3]>,
}

impl WaveletBuilder {
    /// Creates a builder from a base mesh: any triangles. Keeps the seams of its attributes.
    ///
    /// # Errors
    /// Too many triangles, or too many along the same edge.
    pub fn new(base: &Mesh) -> Result<Self, WaveletError> {
        let topology = Topology::new(base);
        let corners = base.triangles().to_vec();
        let points: Vec<[u32; 3]> =
            corners.iter().map(|t| t.map(|v| topology.point_of()[v as usize])).collect();
        // A vertex for each wedge, so seams are where attributes differ.
        let corners = corners.iter().map(|t| t.map(|v| topology.wedge_of()[v as usize])).collect();
        let builder = SubdivisionBuilder::new(corners, base.positions().len(), &points, &[])?;
        Ok(Self { builder, base: base.clone(), positions: base.positions().to_vec() })
    }

    /// Splits every face of the last level; `place` returns the position of each new vertex.
    ///
    /// # Errors
    /// Too many faces, more than 52 levels, or a position not finite.
    pub fn subdivide(&mut self, place: impl FnMut(&Midpoint) -> [f32; 3]) -> Result<&mut Self, WaveletError> {
        self.subdivide_where(|_| true, place)
    }

    /// Splits the faces of the last level for which `split` is true; `place` returns the position of each new vertex. New
    /// vertices cut unsplit neighbours too, so no position opens a crack. Faces across seams of attributes are split
    /// together. A face with two corners at one place shares no edges: split, it has a border.
    ///
    /// # Errors
    /// Too many faces, more than 52 levels, or a position not finite.
    pub fn subdivide_where(
        &mut self,
        mut split: impl FnMut(&Face) -> bool,
        mut place: impl FnMut(&Midpoint) -> [f32; 3],
    ) -> Result<&mut Self, WaveletError> {
        let of = self.builder.subdivision();
        let level = of.depth();
        let at = |vertex: u32| self.positions[vertex as usize];
        let faces = self.builder.last_level().map(|face| {
            let vertices = of.corners(face);
            let places = of.domain_of_face(face).unwrap_or([DomainPoint::new(0, [0.0; 3]); 3]);
            split(&Face {
                level,
                base_face: places[0].base_face,
                vertices,
                corners: vertices.map(at),
                barycentric: places.map(|place| place.barycentric),
            })
        });
        let faces = faces.collect();
        let before = of.wavelet_count() as u32;
        self.builder.split(faces)?;
        let of = self.builder.subdivision();
        for wavelet in before..of.wavelet_count() as u32 {
            let vertex = of.vertex_of(wavelet);
            let Some(ends) = of.ends(vertex) else { continue };
            let positions = ends.map(|end| self.positions[end as usize]);
            let middle = std::array::from_fn(|i| 0.5 * positions[0][i] + 0.5 * positions[1][i]);
            let along = of.faces_along(wavelet).next();
            let domain = along.map_or(DomainPoint::new(0, [0.0; 3]), |side| of.domain_beside(wavelet, side));
            let position = place(&Midpoint { level: level + 1, ends, positions, middle, domain });
            if !position.iter().all(|x| x.is_finite()) {
                let vertex = vertex as usize;
                return Err(crate::error::MeshError::NonFinitePosition { vertex, position }.into());
            }
            self.positions.push(position);
        }
        Ok(self)
    }

    /// Builds the mesh.
    ///
    /// # Errors
    /// Too many materials.
    pub fn build(self, options: &WaveletOptions) -> Result<WaveletMesh, WaveletError> {
        Ok(self.finish(options, &mut |_| ControlFlow::Continue(()))?.0)
    }

    /// Builds the mesh as a baked model: values of the base mesh's vertices are arranged by [`Baked::arrange_blended`].
    /// `progress` receives the progress, 0 to 1, and may break.
    ///
    /// # Errors
    /// Too many materials, or `progress` breaks.
    pub fn bake_with(
        self,
        options: &WaveletOptions,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Baked<WaveletMesh>, WaveletError> {
        let input = self.base.positions().len();
        let base = self.base.clone();
        let (mesh, ends) = self.finish(options, &mut progress)?;
        let of = mesh.subdivision();
        let mut order: Vec<u32> = (0..of.vertex_count() as u32).collect();
        let mut mixtures = Vec::with_capacity(ends.len());
        for (vertex, ends) in ends {
            order[vertex as usize] = (input + mixtures.len()) as u32;
            mixtures.push(Mixture { from: ends.map(|end| order[end as usize]), weight: 0.5 });
        }
        Ok(Baked::new(
            mesh,
            None,
            Origins::new(input, order, mixtures).folded_as(&base, &Topology::new(&base)),
        ))
    }

    /// Builds the mesh as a baked model of another surface, to which the base's points are mapped: `at` returns the point of
    /// `source` at a place on the base. Attributes of every vertex, base vertices included, are those of `source` there, on
    /// the vertex's own side of a seam; [`Baked::arrange_blended`] does as much for values of the source's vertices.
    /// `progress` receives the progress, 0 to 1, and may break.
    ///
    /// # Errors
    /// Too many materials, a triangle that `source` does not have, or `progress` breaks.
    pub fn bake_from(
        self,
        source: &Mesh,
        options: &WaveletOptions,
        at: impl Fn(&DomainPoint) -> MeshPoint,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Baked<WaveletMesh>, WaveletError> {
        let Self { builder, base, mut positions } = self;
        let wedges = Topology::new(source);
        // A seam may open between two base vertices and have no gap at either: sides are told apart by the source's wedges
        // there too.
        let subdivision = builder.finish(|of, face, side, _| {
            let key = seam_key(of, face, side);
            let places = of.domain_of_face(face).filter(|_| key != [0; 2]);
            let around = places.map(|corners| {
                let [a, b] = [corners[side], corners[(side + 1) % 3]];
                let middle = std::array::from_fn(|i| 0.5 * (a.barycentric[i] + b.barycentric[i]));
                wedges_at(source, &wedges, &at(&DomainPoint::new(a.base_face, middle)))
            });
            (key, around)
        });
        for double in &subdivision.seam_vertices {
            positions.push(positions[subdivision.vertex_of(double.0) as usize]);
        }
        let input = source.positions().len();
        let mut corner_of = vec![None; subdivision.base_vertices as usize];
        for (face, corners) in (0..).zip(base.triangles()) {
            for (corner, &vertex) in corners.iter().enumerate() {
                let unit = std::array::from_fn(|k| f64::from(k == corner));
                corner_of[vertex as usize].get_or_insert(DomainPoint::new(face, unit));
            }
        }
        let mut sources = Sources::new(source);
        for vertex in 0..subdivision.vertex_count() as u32 {
            let place = match corner_of.get(vertex as usize) {
                Some(&corner) => corner,
                None => subdivision.domain_of(vertex).next(),
            };
            // A base vertex of no face is of no use.
            let point = place.map_or(MeshPoint::new(0, [1.0, 0.0, 0.0]), |place| at(&place));
            if !sources.push(&point) && (place.is_some() || !source.triangles().is_empty()) {
                let at = point.triangle as usize;
                return Err(WaveletError::Invalid { what: "the source has no triangle", at });
            }
        }
        let (attributes, order, mixtures) = sources.finish();
        let names = source.material_names().to_vec();
        let vertices = Mesh::from_trusted(positions, Vec::new(), attributes, Vec::new(), names, Vec::new())
            .at_origin_of(source);
        let mesh = WaveletMesh::assemble(subdivision, vertices, base.materials(), options, &mut progress)?;
        let origins = Origins::new(input, order, mixtures).folded_as(source, &Topology::new(source));
        Ok(Baked::new(mesh, None, origins))
    }

    /// Builds the mesh. Also returns all vertices not in the base with their ends; a vertex comes after its ends.
    fn finish(
        self,
        options: &WaveletOptions,
        progress: Progress<'_>,
    ) -> Result<(WaveletMesh, Ends), WaveletError> {
        let Self { builder, base, mut positions } = self;
        // Sides of a seam have their own vertices: told apart by the vertices at their ends.
        let subdivision = builder.finish(|of, face, side, _| seam_key(of, face, side));
        for double in &subdivision.seam_vertices {
            positions.push(positions[subdivision.vertex_of(double.0) as usize]);
        }
        let ends = (subdivision.base_vertices..subdivision.vertex_count() as u32)
            .filter_map(|vertex| Some((vertex, subdivision.ends(vertex)?)));
        // Ends of doubles may be doubles of coarser levels: coarser levels come first.
        let mut ends: Vec<(u32, [u32; 2])> = ends.collect();
        ends.sort_by_key(|&(vertex, _)| subdivision.wavelet_of(vertex));
        let order: Vec<u32> = (0..subdivision.vertex_count() as u32)
            .map(|v| if v < subdivision.base_vertices { v } else { 0 })
            .collect();
        let vertices = match base.positions().is_empty() {
            true => base.gather(&[], Vec::new(), Vec::new()),
            false => base.gather(&order, Vec::new(), Vec::new()),
        };
        let vertices = vertices.with_midpoints(ends.iter().copied()).with_positions(positions);
        let mesh = WaveletMesh::assemble(subdivision, vertices, base.materials(), options, progress)?;
        Ok((mesh, ends))
    }
}

/// Returns the wedges that a point takes its values from, ascending.
fn wedges_at(source: &Mesh, topology: &Topology, point: &MeshPoint) -> [u32; 3] {
    let Some(corners) = source.triangles().get(point.triangle as usize) else { return [NONE; 3] };
    let mut wedges = [0, 1, 2].map(|k| match point.barycentric[k] > LEAST_WEIGHT {
        true => topology.wedge_of()[corners[k] as usize],
        false => NONE,
    });
    wedges.sort_unstable();
    wedges
}

/// Returns a key for a side: the base vertices at the ends of its base edge. Constant inside base faces, where sides need
/// no telling apart.
fn seam_key(of: &super::Subdivision, face: u32, side: usize) -> [u32; 2] {
    let (mut face, mut side) = (face, side);
    loop {
        match of.parent(face) {
            None => break,
            Some((parent, _, child)) => match (child, side) {
                (3, _) | (_, 1) => return [0; 2],
                (i, 0) => (face, side) = (parent, i),
                (i, _) => (face, side) = (parent, (i + 2) % 3),
            },
        }
    }
    let [a, b] = [side, (side + 1) % 3].map(|corner| of.base[face as usize][corner]);
    [a.min(b), a.max(b)]
}
