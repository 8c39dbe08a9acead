//! Samples the full resolution at places on the base: descends the levels, then interpolates in a triangle.

use glam::DVec3;

use crate::mesh::names;
use crate::wavelet::instance::surface::finest_triangles;
use crate::wavelet::{Subdivision, WaveletMesh};

use super::DomainPoint;

/// A point of the full resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SurfacePoint {
    /// Place on the base.
    pub domain: DomainPoint,
    /// Position, object units.
    pub position: [f32; 3],
    /// Unit normal: interpolated from the vertices where the mesh has normals, else the triangle's; zero for a triangle without
    /// area.
    pub normal: [f32; 3],
    /// Vertices of the mesh at the corners of the triangle with the point: for any attribute.
    pub vertices: [u32; 3],
    /// Barycentric coordinates of the point in the triangle.
    pub weights: [f64; 3],
}

/// Finds points of the full resolution; made by [`WaveletMesh::sampler`].
///
/// ```
/// use multires::wavelet::{DomainPoint, WaveletMesh, WaveletOptions};
/// use multires::mesh::shapes;
///
/// // The same place on the base, whatever the level drawn.
/// let mesh = WaveletMesh::recognise(&shapes::icosphere(3), &WaveletOptions::default())?;
/// let middle = DomainPoint::new(0, [1.0 / 3.0; 3]);
/// assert!(mesh.sampler().at(&middle).is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SurfaceSampler<'a> {
    mesh: &'a WaveletMesh,
    normals: Option<&'a [f32]>,
    /// Triangles of unsplit faces cut into several triangles, by face, with the barycentric coordinates of their corners in the
    /// face.
    cut: Vec<(u32, [u32; 3], [[f64; 3]; 3])>,
}

impl WaveletMesh {
    /// Makes a sampler, which finds points of the full resolution by their place on the base. O(1) where all base faces are
    /// split equally deep, else O(n).
    pub fn sampler(&self) -> SurfaceSampler<'_> {
        let of = self.subdivision();
        let mut cut = Vec::new();
        let faces = if of.is_uniform() { 0 } else { of.face_count() as u32 };
        for face in (0..faces).filter(|&face| !of.is_split(face)) {
            let first = cut.len();
            finest_triangles(of, face, |triangle| {
                cut.push((face, triangle, triangle.map(|vertex| within(of, face, vertex))))
            });
            if cut.len() == first + 1 {
                cut.truncate(first);
            }
        }
        let normals = self.vertices().attribute(names::NORMAL).filter(|normals| normals.width() == 3);
        SurfaceSampler { mesh: self, normals: normals.and_then(|normals| normals.as_floats()), cut }
    }
}

/// Returns the barycentric coordinates, in a face, of a vertex at a corner or on a side of the face.
fn within(of: &Subdivision, face: u32, vertex: u32) -> [f64; 3] {
    let side = of.wavelet_of(vertex).and_then(|wavelet| {
        let mut sides = of.faces_along(wavelet).filter(|side| side.face() == face);
        sides.find(|side| of.vertices_at(wavelet, face, side.side())[0] == vertex).map(|side| (wavelet, side))
    });
    match side {
        Some((wavelet, side)) => {
            let (t, k) = (of.along_side(wavelet, side), side.side());
            std::array::from_fn(|i| match i {
                i if i == k => 1.0 - t,
                i if i == (k + 1) % 3 => t,
                _ => 0.0,
            })
        }
        None => {
            let corner = of.corners(face).iter().position(|&corner| corner == vertex);
            std::array::from_fn(|i| f64::from(Some(i) == corner))
        }
    }
}

impl Subdivision {
    /// Returns the unsplit face at a place, the coordinates there in the face, and the place with coordinates that sum to 1.
    /// `None` as [`SurfaceSampler::at`]. O(level).
    pub(crate) fn face_at(&self, domain: &DomainPoint) -> Option<(u32, [f64; 3], DomainPoint)> {
        let mut weights = domain.barycentric.map(|weight| weight.max(0.0));
        let sum: f64 = weights.iter().sum();
        let fits = (domain.base_face as usize) < self.base_face_count();
        if !fits || !sum.is_finite() || sum <= 0.0 || domain.barycentric.iter().any(|w| !w.is_finite()) {
            return None;
        }
        weights = weights.map(|weight| weight / sum);
        let domain = DomainPoint { barycentric: weights, ..*domain };
        let mut face = domain.base_face;
        while self.is_split(face) {
            let child = weights.iter().position(|&weight| weight >= 0.5).unwrap_or(3);
            weights = match child {
                3 => [0, 1, 2].map(|k| (1.0 - 2.0 * weights[(k + 2) % 3]).max(0.0)),
                i => [2.0 * weights[i] - 1.0, 2.0 * weights[(i + 1) % 3], 2.0 * weights[(i + 2) % 3]],
            };
            face = self.child(face, child);
        }
        Some((face, weights, domain))
    }
}

impl SurfaceSampler<'_> {
    /// Returns the point at a place. `None` if the base face is missing, a coordinate is not finite, or no coordinate is above
    /// 0. Negative coordinates are set to 0, then all are scaled to sum to 1. O(level).
    pub fn at(&self, domain: &DomainPoint) -> Option<SurfacePoint> {
        let of = self.mesh.subdivision();
        let (face, mut weights, domain) = of.face_at(domain)?;
        let mut corners = of.corners(face);
        let start = self.cut.partition_point(|cut| cut.0 < face);
        let mut best = f64::NEG_INFINITY;
        let in_face = weights;
        for (_, triangle, at) in self.cut[start..].iter().take_while(|cut| cut.0 == face) {
            let Some(inner) = weights_in(at, in_face) else { continue };
            let least = inner.iter().copied().fold(f64::INFINITY, f64::min);
            if least > best {
                (best, corners, weights) = (least, *triangle, inner.map(|weight| weight.max(0.0)));
            }
        }
        let positions = self.mesh.vertices().positions();
        let places = corners.map(|vertex| DVec3::from_array(positions[vertex as usize].map(f64::from)));
        let position = mix(&places, weights);
        let normal = match self.normals {
            Some(normals) => {
                let at = |vertex: u32| -> [f64; 3] {
                    std::array::from_fn(|i| f64::from(normals[3 * vertex as usize + i]))
                };
                mix(&corners.map(|vertex| DVec3::from_array(at(vertex))), weights)
            }
            None => (places[1] - places[0]).cross(places[2] - places[0]),
        };
        let normal = normal.try_normalize().unwrap_or(DVec3::ZERO);
        Some(SurfacePoint {
            domain,
            position: position.as_vec3().to_array(),
            normal: normal.as_vec3().to_array(),
            vertices: corners,
            weights,
        })
    }
}

fn mix(values: &[DVec3; 3], weights: [f64; 3]) -> DVec3 {
    (0..3).map(|k| values[k] * weights[k]).sum()
}

/// Returns the barycentric coordinates of a point in a triangle; both are given in the coordinates of another triangle. `None`
/// for a triangle without area.
fn weights_in(corners: &[[f64; 3]; 3], point: [f64; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(DVec3::from_array);
    let p = DVec3::from_array(point);
    let whole = a.dot(b.cross(c));
    let weights = [p.dot(b.cross(c)), a.dot(p.cross(c)), a.dot(b.cross(p))];
    (whole != 0.0).then(|| weights.map(|weight| weight / whole))
}
