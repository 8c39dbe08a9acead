//! A mesh over a base: every point of one has its point on the other.

use std::borrow::Cow;
use std::ops::ControlFlow;

use glam::DVec3;

use crate::lod::Baked;
use crate::mesh::{Mesh, MeshPoint, NONE, names};
use crate::simplify::SimplifyReport;
use crate::wavelet::{DomainPoint, WaveletBuilder, WaveletError, WaveletMesh, WaveletOptions};

use super::cells::{BaseEdges, DEEPEST};
use super::coarsen::Coarse;
use super::fit::{Fitted, fit};
use super::layout::{Layout, Place};
use super::sectors::Sectors;
use super::smooth::{Target, smooth};
use super::unfold::{Unfolded, unfold};
use super::warp::Warp;
use super::{Depth, Fitting, RemeshError, Smoothing};

/// Coarsest and finest level of cells moved by smoothing: about as many cells as the mesh has triangles.
const LEAST_LEVEL: f64 = 2.0;
const MOST_LEVEL: f64 = 6.0;

/// Weight below which a point lies on a side of its triangle.
const ON_SIDE: f64 = 1e-9;

/// Share of a bake's time until the bounds are computed.
const PLACING: f32 = 0.3;

/// A one-to-one map between a mesh and its base: continuous, and linear in pieces. Made by a
/// [`Remesher`](super::Remesher).
///
/// Base vertices are vertices of the mesh. Points on borders, seams, material borders and creases lie on edges of the base.
/// For baking textures and normal maps, and to bring attributes or poses from one to the other.
#[derive(Debug, Clone)]
pub struct Parameterisation {
    base: Mesh,
    layout: Layout,
    /// Face of the layout of every base face, ascending.
    faces: Vec<u32>,
    /// Which sides of base faces are features.
    features: Vec<[bool; 3]>,
    /// Smooths the map: applied to places on the base before they go to the mesh.
    warp: Option<Warp>,
    /// Where the vertices of remeshes go.
    fitting: Fitting,
    /// What the simplification to the base ended with.
    report: SimplifyReport,
    source_triangles: usize,
    /// Per vertex of the mesh its sector, over which normals are to be smooth; empty where the mesh's normals are kept.
    smooth_over: Vec<u32>,
}

impl Parameterisation {
    pub(super) fn new(
        source: &Mesh,
        sectors: &Sectors,
        coarse: Coarse,
        (smoothing, fitting): (Smoothing, Fitting),
    ) -> Self {
        let Coarse { layout, corners, report } = coarse;
        let is_base = |&face: &u32| {
            layout.is_last(face) && sectors.is_face.get(face as usize).is_none_or(|&is_face| is_face)
        };
        let faces: Vec<u32> = (0..layout.face_count() as u32).filter(is_base).collect();
        // A vertex of the source for every sector.
        let mut vertex_of = vec![NONE; sectors.mesh.positions().len()];
        for (sector_corners, vertices) in sectors.mesh.triangles().iter().zip(source.triangles()).rev() {
            for k in 0..3 {
                vertex_of[sector_corners[k] as usize] = vertices[k];
            }
        }
        let mut number = vec![NONE; vertex_of.len()];
        let mut order = Vec::new();
        let triangles = faces.iter().map(|&face| {
            corners[face as usize].map(|sector| {
                let slot = &mut number[sector as usize];
                if *slot == NONE {
                    *slot = order.len() as u32;
                    order.push(vertex_of[sector as usize]);
                }
                *slot
            })
        });
        let triangles: Vec<[u32; 3]> = triangles.collect();
        let middle = |&face: &u32| layout.up(Place { face, weights: [1.0 / 3.0; 3] }).face;
        let materials = match source.materials() {
            [] => Vec::new(),
            materials => faces.iter().map(|face| materials[middle(face) as usize]).collect(),
        };
        let base = source.gather(&order, triangles, materials);
        let mut smooth_over = Vec::new();
        if !sectors.keeps_normals {
            smooth_over = vec![0; source.positions().len()];
            for (sectors, vertices) in sectors.mesh.triangles().iter().zip(source.triangles()) {
                (0..3).for_each(|k| smooth_over[vertices[k] as usize] = sectors[k]);
            }
        }
        let edges = &BaseEdges::new(&base);
        let mut features = edges.features(&base);
        // A curve with a single sector at both ends has the same base vertices on both sides: ask the mesh.
        for (sides, &face) in features.iter_mut().zip(&faces) {
            for (side, is_feature) in sides.iter_mut().enumerate().filter(|(_, is_feature)| !**is_feature) {
                let mut weights = [0.0; 3];
                (weights[side], weights[(side + 1) % 3]) = (0.6, 0.4);
                let place = layout.up(Place { face, weights });
                let of_triangle = sectors.is_feature[place.face as usize];
                *is_feature = (0..3).any(|k| of_triangle[k] && place.weights[(k + 2) % 3] < ON_SIDE);
            }
        }
        let warp = (smoothing == Smoothing::Harmonic).then(|| {
            let (layout, faces, features) = (&layout, &faces[..], &features[..]);
            let cells = source.triangles().len() as f64 / faces.len().max(1) as f64;
            let level = (cells.log2() / 2.0).round().clamp(LEAST_LEVEL, MOST_LEVEL) as usize;
            smooth(&Target { base: &base, edges, features, layout, faces, mesh: source }, level)
        });
        let source_triangles = source.triangles().len();
        Self { base, layout, faces, features, warp, fitting, report, source_triangles, smooth_over }
    }

    /// Returns the base: vertices of the mesh with all attributes, materials by triangle.
    pub fn base(&self) -> &Mesh {
        &self.base
    }

    /// Returns the report of the simplification to the base: why it ended, and the rules that refused what was left. Its errors are
    /// lengths of paths of merged points, which say nothing of a remesh.
    pub fn report(&self) -> &SimplifyReport {
        &self.report
    }

    /// Returns the number of triangles of the mesh.
    pub(super) fn source_triangles(&self) -> usize {
        self.source_triangles
    }

    /// Whether a side of a base face, from corner `side` to the next, lies on a feature: a border, a crease, a seam, a border
    /// between materials, or an edge marked by the caller. False out of range.
    pub fn is_feature(&self, base_face: u32, side: usize) -> bool {
        self.features.get(base_face as usize).and_then(|sides| sides.get(side)).copied().unwrap_or(false)
    }

    /// Returns the point of the mesh at a place on the base. `None` if the base face does not exist, or no coordinate is
    /// above 0. Negative coordinates count as 0. O(log n) expected.
    pub fn to_mesh(&self, domain: &DomainPoint) -> Option<MeshPoint> {
        if domain.base_face as usize >= self.faces.len() {
            return None;
        }
        let place = Place { face: domain.base_face, weights: normalised(domain.barycentric)? };
        let place = self.warp.as_ref().map_or(place, |warp| warp.apply(place));
        let place = self.layout.up(Place { face: self.faces[place.face as usize], ..place });
        Some(MeshPoint::new(place.face, place.weights))
    }

    /// Returns the place on the base of a point of the mesh. `None` if the triangle does not exist or has two equal points,
    /// or no coordinate is above 0. Negative coordinates count as 0. O(log n) expected.
    pub fn to_base(&self, point: &MeshPoint) -> Option<DomainPoint> {
        if point.triangle as usize >= self.source_triangles {
            return None;
        }
        let weights = normalised(point.barycentric)?;
        let place = self.layout.down(Place { face: point.triangle, weights });
        let face = self.faces.binary_search(&place.face).ok()? as u32;
        let place = Place { face, ..place };
        let place = self.warp.as_ref().map_or(place, |warp| warp.undo(place));
        Some(DomainPoint::new(place.face, place.weights))
    }

    /// Remeshes: subdivides the base, with every new vertex at its point of `mesh` ([`Fitting`] moves it off the mesh), and all
    /// attributes there. `mesh` is the
    /// mesh that the map was made from, or one with the same triangles in another pose or with other attributes.
    ///
    /// # Errors
    /// Another number of triangles, or too many faces.
    pub fn bake(
        &self,
        mesh: &Mesh,
        depth: Depth,
        options: &WaveletOptions,
    ) -> Result<Baked<WaveletMesh>, RemeshError> {
        Ok(self.bake_with(mesh, depth, options, |_| ControlFlow::Continue(()))?.model)
    }

    /// Remeshes with progress: the share done, 0 to 1. Where `progress` breaks, the run ends. Also returns how many triangles
    /// had to be unfolded.
    ///
    /// # Errors
    /// Another number of triangles, too many faces, or `progress` breaks.
    pub fn bake_with(
        &self,
        mesh: &Mesh,
        depth: Depth,
        options: &WaveletOptions,
        mut progress: impl FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Remesh, RemeshError> {
        if mesh.triangles().len() != self.source_triangles {
            let (found, expected) = (mesh.triangles().len(), self.source_triangles);
            return Err(WaveletError::Length { what: "triangles", found, expected }.into());
        }
        let mesh = &*self.with_smooth_normals(mesh);
        let mut builder = WaveletBuilder::new(&self.posed_base(mesh))?;
        let unfolded = match depth {
            Depth::Levels(levels) if levels <= DEEPEST => unfold(self, mesh, levels),
            _ => Unfolded::default(),
        };
        let at = |domain: &DomainPoint| {
            self.to_mesh(&unfolded.apply(domain)).unwrap_or(MeshPoint::new(0, [1.0, 0.0, 0.0]))
        };
        let fitted = match depth {
            Depth::Levels(levels) if levels <= DEEPEST && self.fitting == Fitting::LeastSquares => {
                fit(self, mesh, levels, &unfolded)
            }
            _ => Fitted::none(unfolded.folded[1]),
        };
        let place = |domain: &DomainPoint| {
            let point = DVec3::from_array(at(domain).position(mesh).unwrap_or_default());
            (point + fitted.shift(domain)).as_vec3().to_array()
        };
        let left = depth.subdivide(self, mesh, &mut builder, place)?;
        if progress(PLACING).is_break() {
            return Err(RemeshError::Cancelled);
        }
        let rest = |share: f32| progress(PLACING + (1.0 - PLACING) * share);
        let [found, folded] = if left > 0 { [left; 2] } else { [unfolded.folded[0], fitted.folded] };
        // Fitting and unfolding tell folds each in its way: near the ends of single precision fitting was seen to count more.
        let unfolded = found.saturating_sub(folded);
        Ok(Remesh { model: builder.bake_from(mesh, options, at, rest)?, unfolded, folded })
    }

    /// Returns the mesh with normals smooth up to features, where its own are hard everywhere.
    fn with_smooth_normals<'a>(&self, mesh: &'a Mesh) -> Cow<'a, Mesh> {
        if self.smooth_over.len() != mesh.positions().len() || mesh.attribute(names::NORMAL).is_none() {
            return Cow::Borrowed(mesh);
        }
        let sectors = self.smooth_over.iter().max().map_or(0, |&last| last as usize + 1);
        let mut sums = vec![DVec3::ZERO; sectors];
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
            let normal = (b - a).cross(c - a);
            corners.iter().for_each(|&v| sums[self.smooth_over[v as usize] as usize] += normal);
        }
        let unit = |&sector: &u32| sums[sector as usize].normalize_or(DVec3::Z).as_vec3().to_array();
        let normals: Vec<[f32; 3]> = self.smooth_over.iter().map(unit).collect();
        Cow::Owned(mesh.clone().with_normals(&normals))
    }

    /// Returns the base with the positions of another pose.
    fn posed_base(&self, mesh: &Mesh) -> Mesh {
        let mut positions = vec![[0.0; 3]; self.base.positions().len()];
        for (face, corners) in (0..).zip(self.base.triangles()) {
            for (k, &vertex) in corners.iter().enumerate() {
                let unit = std::array::from_fn(|i| f64::from(i == k));
                if let Some(point) = self.to_mesh(&DomainPoint::new(face, unit)) {
                    positions[vertex as usize] = point.position(mesh).unwrap_or_default().map(|x| x as f32);
                }
            }
        }
        self.base.clone().with_positions(positions)
    }

    /// Returns the bytes of the map's arrays, without the base.
    pub fn memory(&self) -> usize {
        let warp = self.warp.as_ref().map_or(0, Warp::memory);
        let features = size_of_val(&self.features[..]);
        features
            + self.layout.memory()
            + warp
            + size_of_val(&self.faces[..])
            + size_of_val(&self.smooth_over[..])
    }
}

/// A remesh, and what had to be done.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Remesh {
    /// The model: a wavelet mesh with the attributes of the mesh.
    pub model: Baked<WaveletMesh>,
    /// Triangles of the full resolution which faced away from the mesh, at their corners and in the middle, until corners
    /// were moved over the mesh, or off it. Each lies beside folds of the mesh finer than itself.
    pub unfolded: usize,
    /// Triangles which still face away.
    pub folded: usize,
}

fn normalised(weights: [f64; 3]) -> Option<[f64; 3]> {
    let positive = weights.map(|weight| weight.max(0.0));
    let sum: f64 = positive.iter().sum();
    (sum > 0.0 && sum.is_finite() && weights.iter().all(|weight| weight.is_finite()))
        .then(|| positive.map(|weight| weight / sum))
}
