//! A mesh as base faces and wavelets, with its vertices: baked, shared by instances, edited and taken apart.

use std::ops::ControlFlow;

use crate::adapt::Refinements;
use crate::geometry::array::Array;
use crate::geometry::boxes;
use crate::lod::Progress;
use crate::mesh::{Mesh, Used};
use crate::view::DeviationBounds;

use super::bounds::{WaveletBounds, bounds};
use super::from_quadrisection::from_quadrisection;
use super::instance::surface::WaveletSurface;
use super::recognise::{Component, recognise_across_seams, recognise_uneven};
use super::{Normals, Subdivision, Triangulation, WaveletError, WaveletOptions};

/// Share of the build time spent on finding the connectivity.
const RECOGNITION: f32 = 0.25;

/// Most different materials: group numbers have 16 bits.
pub(super) const MOST_MATERIALS: usize = 1 << 16;

/// A mesh with subdivision connectivity: base faces, and a lazy wavelet for every vertex added by subdivision. Immutable except
/// for [edits](Self::edit). Made by recognising the connectivity of a mesh ([`WaveletMesh::recognise`]) or from a base mesh
/// ([`WaveletBuilder`](super::WaveletBuilder)).
///
/// Vertices are stored at their own places, not as coefficients, so the full resolution equals the input bit for bit. The cut
/// is closed (Azuma et al., section 3.4), so the vertices of every wavelet in the cut are drawn at their own places. A
/// coefficient costs [a subtraction](Self::coefficient).
///
/// ```
/// use multires::wavelet::{Normals, WaveletMesh, WaveletOptions};
/// use multires::mesh::shapes;
///
/// let mesh = WaveletMesh::recognise(&shapes::icosphere(3), &WaveletOptions::default())?;
/// assert_eq!(mesh.subdivision().base_face_count(), 20);
/// assert_eq!(mesh.at_level(1, Normals::Kept).triangles().len(), 80);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::WaveletParts"))]
pub struct WaveletMesh {
    pub(super) subdivision: Subdivision,
    /// Positions, attributes and locks of all vertices.
    pub(super) vertices: Mesh,
    /// Different material ids, ascending; empty for a mesh without materials.
    pub(super) materials: Vec<u32>,
    /// Per base face the index of its material in `materials`; empty for a mesh without materials.
    pub(super) group_of: Array<u16>,
    pub(super) bounds: Array<WaveletBounds>,
    pub(super) options: WaveletOptions,
    pub(super) diagonal: f64,
    /// The box around all vertices; `None` without vertices.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) extent: Option<[[f32; 3]; 2]>,
}

impl WaveletMesh {
    /// Recognises a mesh as a four-to-one subdivision of a coarser mesh, in all or some of its components. Finds the coarsest
    /// such mesh. Material borders may run only along coarse edges. In a component whose coarsening attribute seams would stop,
    /// seams may run inside coarse faces, else only along coarse edges. Faces with a seam inside are drawn split wherever in
    /// view, so values are not smeared across the seam. Faces may be split to different depths if vertices are in the order of
    /// levels ([`recognise_uneven`](super::recognise_uneven)). O(n x levels), and O(n log n) for meshes of uneven depth.
    ///
    /// # Errors
    /// [`WaveletError::NoConnectivity`] with a reason: no component is such a subdivision. Also too many faces or materials.
    pub fn recognise(mesh: &Mesh, options: &WaveletOptions) -> Result<Self, WaveletError> {
        Ok(Self::recognise_with(mesh, options, &mut |_| ControlFlow::Continue(()))?.0)
    }

    /// Recognises a mesh like [`Self::recognise`]; also returns, for each vertex of the result, the input's vertex.
    pub(super) fn recognise_with(
        mesh: &Mesh,
        options: &WaveletOptions,
        progress: Progress<'_>,
    ) -> Result<(Self, Vec<u32>), WaveletError> {
        let mut stage = |share: f32| match progress(share) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(WaveletError::Cancelled),
        };
        stage(0.0)?;
        let found = recognise_uneven(mesh);
        if found.quadrisection.levels() == 0 {
            return Err(WaveletError::NoConnectivity { reason: refusal(&found.components) });
        }
        stage(RECOGNITION)?;
        let mut rest = |share: f32| progress(RECOGNITION + (1.0 - RECOGNITION) * share);
        match from_quadrisection(mesh, &found, options, &mut rest) {
            Err(WaveletError::NoConnectivity { .. }) => {}
            made => return made,
        }
        // Only components of equal depth.
        let found = recognise_across_seams(mesh);
        if found.quadrisection.levels() == 0 {
            return Err(WaveletError::NoConnectivity { reason: refusal(&found.components) });
        }
        from_quadrisection(mesh, &found, options, &mut rest)
    }

    /// Assembles matching parts. `materials`: ids of the base faces, or empty.
    pub(super) fn assemble(
        subdivision: Subdivision,
        vertices: Mesh,
        materials: &[u32],
        options: &WaveletOptions,
        progress: Progress<'_>,
    ) -> Result<Self, WaveletError> {
        let mut ids = materials.to_vec();
        ids.sort_unstable();
        ids.dedup();
        if ids.len() > MOST_MATERIALS {
            let (count, limit) = (ids.len(), MOST_MATERIALS);
            return Err(WaveletError::TooMany { what: "materials", count, limit });
        }
        let group = |id: &u32| ids.binary_search(id).unwrap_or(0) as u16;
        let group_of = materials.iter().map(group).collect();
        let mut mesh = Self {
            subdivision,
            vertices,
            materials: ids,
            group_of,
            bounds: Array::default(),
            options: *options,
            diagonal: 0.0,
            extent: None,
        };
        mesh.measure();
        mesh.bounds = bounds(&mesh, progress).ok_or(WaveletError::Cancelled)?.into();
        Ok(mesh)
    }

    /// Finds the box around all vertices. Every vertex is used by a face.
    pub(super) fn measure(&mut self) {
        self.set_box(boxes::around_any(self.vertices.positions().iter().copied()));
    }

    pub(super) fn set_box(&mut self, extent: Option<[[f32; 3]; 2]>) {
        self.extent = extent;
        self.diagonal = boxes::diagonal(extent.unwrap_or_default());
    }

    /// The connectivity.
    pub fn subdivision(&self) -> &Subdivision {
        &self.subdivision
    }

    /// Positions, attributes and locks of all vertices at their own places, and the names of materials: the source of an
    /// instance's values. Base vertices come first, then each wavelet's own vertex, then further vertices on seams. Has no
    /// triangles.
    pub fn vertices(&self) -> &Mesh {
        &self.vertices
    }

    /// Different material ids, ascending: a group of triangles for each. Empty for a mesh without materials.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Whether the connectivity and the materials equal those of `other`.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.subdivision == other.subdivision
            && self.materials == other.materials
            && self.group_of == other.group_of
    }

    /// Options used to make the bounds.
    pub fn options(&self) -> &WaveletOptions {
        &self.options
    }

    /// Number of groups of triangles drawn by instances: 1 a material, at least 1.
    pub fn groups(&self) -> usize {
        self.materials.len().max(1)
    }

    pub(super) fn group(&self, base_face: u32) -> usize {
        self.group_of.get(base_face as usize).copied().map_or(0, usize::from)
    }

    /// Smallest and largest corner of the box around all vertices; `None` without vertices.
    pub fn extent(&self) -> Option<[[f32; 3]; 2]> {
        self.extent
    }

    /// Length of the diagonal of the [box](Self::extent) around all vertices, object units.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Coefficient of a wavelet's vertex (Azuma et al., equation 1): its own place minus the middle of its ends, object units.
    /// `None` for base vertices and out of range.
    pub fn coefficient(&self, vertex: u32) -> Option<[f64; 3]> {
        let positions = self.vertices.positions();
        let [a, b] = self.subdivision.ends(vertex)?.map(|end| positions[end as usize].map(f64::from));
        let own = positions[vertex as usize].map(f64::from);
        Some(std::array::from_fn(|i| own[i] - 0.5 * (a[i] + b[i])))
    }

    /// Returns the smallest set of wavelets which contains all wavelets asked for and is closed under parents, as a flag a
    /// wavelet. O(n).
    pub fn closure(&self, asked: impl Fn(u32) -> bool) -> Vec<bool> {
        let mut set: Vec<bool> = (0..self.subdivision.wavelet_count() as u32).map(asked).collect();
        for wavelet in (0..set.len() as u32).rev() {
            if set[wavelet as usize] {
                self.subdivision.parents_of(wavelet).for_each(|parent| set[parent as usize] = true);
            }
        }
        set
    }

    /// Returns the mesh at full resolution.
    pub fn finest(&self, normals: Normals) -> Mesh {
        self.extract(|_| true, Triangulation::Exact, normals)
    }

    /// Returns the mesh at a level: all wavelets of levels up to `level`; the base mesh at level 0.
    pub fn at_level(&self, level: usize, normals: Normals) -> Mesh {
        let end = self.subdivision.wavelets_of(level).end;
        let end = if level > self.subdivision.depth() { u32::MAX } else { end };
        self.extract(|wavelet| wavelet < end, Triangulation::Exact, normals)
    }

    /// Returns the mesh of all wavelets whose absence moves a point by more than `tolerance`, object units, for any view.
    pub fn at_tolerance(&self, tolerance: f32, triangulation: Triangulation, normals: Normals) -> Mesh {
        let far = |wavelet: u32| {
            let bounds = &self.bounds[wavelet as usize];
            bounds.along.max(bounds.across)
        };
        self.extract(|wavelet| far(wavelet) > tolerance, triangulation, normals)
    }

    /// Returns the mesh of the smallest closed set containing the wavelets asked for: vertices in use with their attributes and
    /// locks, and triangles with their materials, in the order of faces. Vertices in use only because of a split lie on the
    /// surface, in the middle of their ends. O(n).
    pub fn extract(
        &self,
        asked: impl Fn(u32) -> bool,
        triangulation: Triangulation,
        normals: Normals,
    ) -> Mesh {
        let of = &self.subdivision;
        let set = self.closure(asked);
        let mut surface = WaveletSurface::new(of, triangulation, self.groups());
        let wavelets = (0..of.wavelet_count() as u32).filter(|&wavelet| set[wavelet as usize]);
        wavelets.for_each(|wavelet| surface.change(of, wavelet, true));
        surface.write(of, |vertex| vertex, |base_face| self.group(base_face));

        let mut drawn: Vec<(u32, usize, [u32; 3])> = Vec::with_capacity(surface.triangle_count());
        for group in 0..surface.groups() {
            let triangles = surface.faces(group).zip(surface.triangles(group));
            drawn.extend(triangles.map(|(face, &triangle)| (face, group, triangle)));
        }
        drawn.sort_by_key(|&(face, ..)| face);
        let triangles: Vec<[u32; 3]> = drawn.iter().map(|&(.., triangle)| triangle).collect();
        let Used { vertices: used, number } = Used::new(of.vertex_count(), &triangles);
        let materials = match self.materials.is_empty() {
            true => Vec::new(),
            false => drawn.iter().map(|&(_, group, _)| self.materials[group]).collect(),
        };
        let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        let mesh = self.settle(&set, &number, self.vertices.gather(&used, triangles, materials), &used);
        if normals == Normals::Recomputed { mesh.with_smooth_normals() } else { mesh }
    }

    /// Moves vertices of wavelets outside the set to the middle of their ends.
    fn settle(&self, set: &[bool], number: &[u32], mesh: Mesh, used: &[u32]) -> Mesh {
        let of = &self.subdivision;
        // In the order of levels, so ends come first.
        let mut between: Vec<(u32, u32)> = used
            .iter()
            .filter_map(|&vertex| Some((of.wavelet_of(vertex)?, vertex)))
            .filter(|(wavelet, _)| !set[*wavelet as usize])
            .collect();
        if between.is_empty() {
            return mesh;
        }
        between.sort_unstable();
        let ends = between.iter().filter_map(|&(_, vertex)| {
            let ends = of.ends(vertex)?.map(|end| number[end as usize]);
            Some((number[vertex as usize], ends))
        });
        mesh.with_midpoints(ends)
    }

    /// Bytes of the structure and its vertices, without instances.
    pub fn memory(&self) -> usize {
        self.vertices.memory() + self.structure_memory()
    }

    /// Bytes of the structure alone: connectivity, bounds and materials.
    pub fn structure_memory(&self) -> usize {
        self.subdivision.memory() + size_of_val(&self.bounds[..]) + size_of_val(&self.group_of[..])
    }

    /// Bytes of the full resolution as a plain indexed mesh.
    pub fn plain_memory(&self) -> usize {
        let material = if self.materials.is_empty() { 0 } else { size_of::<u32>() };
        self.vertices.memory() + (size_of::<[u32; 3]>() + material) * self.subdivision.leaf_count()
    }
}

/// Describes why the largest component was refused, standing for all components.
fn refusal(components: &[Component]) -> String {
    let Some(largest) = components.iter().rev().max_by_key(|component| component.triangles) else {
        return "there are no triangles".to_owned();
    };
    match components.len() {
        1 => largest.to_string(),
        count => format!("the largest of {count} components has {largest}"),
    }
}

impl Refinements for WaveletMesh {
    type Bounds = DeviationBounds;

    fn len(&self) -> usize {
        self.bounds.len()
    }

    fn roots(&self) -> impl Iterator<Item = u32> {
        self.subdivision.wavelets_of(1)
    }

    #[inline]
    fn bounds(&self, wavelet: u32) -> DeviationBounds {
        // Nothing is in the way of a wavelet that is not there.
        let bounds = self.bounds.get(wavelet as usize).copied();
        let bounds = bounds.unwrap_or(bytemuck::Zeroable::zeroed());
        let vertex = self.subdivision.base_vertices as usize + wavelet as usize;
        let centre = self.vertices.positions().get(vertex).copied().unwrap_or_default();
        bounds.unpack(centre, self.options.shape)
    }

    #[inline]
    fn parents(&self, wavelet: u32) -> impl Iterator<Item = u32> {
        self.subdivision.parents_of(wavelet)
    }

    #[inline]
    fn children(&self, wavelet: u32) -> impl Iterator<Item = u32> {
        self.subdivision.incident_edges(wavelet).map(|incident| incident.0)
    }

    #[inline]
    fn dependencies(&self, _: u32) -> impl Iterator<Item = u32> {
        std::iter::empty()
    }
}
