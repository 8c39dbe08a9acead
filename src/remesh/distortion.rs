//! How far a map is from keeping angles and areas.

use glam::{DVec2, DVec3};

use crate::geometry::parallel;
use crate::mesh::{Mesh, MeshPoint};
use crate::wavelet::DomainPoint;

use super::Parameterisation;
use super::cells::Cell;
use super::corners::barycentric;

/// Mean and 99th percentile of a figure, weighted by area on the base.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The 99th percentile.
    pub p99: f64,
}

/// Distortion of the map from the base's triangles to the mesh, measured on the triangles of a level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Distortion {
    /// Quasi-conformal factor: the ratio of the singular values, 1 where angles are kept.
    pub angle: Spread,
    /// Area on the mesh over area on the base, or the inverse, relative to the whole mesh's; at least 1.
    pub area: Spread,
    /// Triangles of the level that face away from the mesh at their corners and their middle.
    pub folded: usize,
    /// Triangles measured.
    pub triangles: usize,
}

impl Parameterisation {
    /// Measures the distortion on the triangles of a level, each base face split `level` times (at most 10). `mesh` is the
    /// mesh that the map was made from. O(4^level base faces).
    pub fn distortion(&self, mesh: &Mesh, level: usize) -> Distortion {
        let faces = self.base().triangles().len();
        let of_faces = parallel::map(faces, 1, |face| self.of_face(mesh, face as u32, level.min(10)));
        let (mut angles, mut areas, mut folded) = (Vec::new(), Vec::new(), 0);
        for face in of_faces {
            angles.extend(face.angles.into_iter().map(|angle| (angle, face.area)));
            areas.extend(face.areas.into_iter().map(|area| (area, face.area)));
            folded += face.folded;
        }
        // Areas relative to the whole mesh's.
        let sum = |list: &[(f64, f64)]| list.iter().map(|(value, weight)| value * weight).sum::<f64>();
        let whole = sum(&areas) / areas.iter().map(|(_, weight)| weight).sum::<f64>();
        for (area, _) in &mut areas {
            *area /= whole;
            *area = area.max(1.0 / area.max(f64::MIN_POSITIVE));
        }
        let triangles = angles.len();
        Distortion { angle: spread(angles), area: spread(areas), folded, triangles }
    }

    fn of_face(&self, mesh: &Mesh, face: u32, level: usize) -> OfFace {
        let n = 1u16 << level;
        let corners = self.base().triangles()[face as usize];
        let flat = Flat::new(corners.map(|v| self.base().positions()[v as usize]), f64::from(n));
        let mut of_face = OfFace { area: flat.area, ..OfFace::default() };
        let rows = self.rows(mesh, face, level);
        for cell in Cell::of_level(face, level) {
            let points = cell.corners().map(|[i, j]| rows[usize::from(j)][usize::from(i)]);
            let [a, b, c] = points.map(|point| point.0);
            // Corners of downward cells come in the same order, turned by half a turn.
            let turn = if cell.down { -1.0 } else { 1.0 };
            let (angle, area) = flat.stretch(turn * (b - a), turn * (c - a));
            of_face.angles.push(angle);
            of_face.areas.push(area);
            let facing = (b - a).cross(c - a);
            let is_away = |normal: DVec3| facing.dot(normal) < 0.0;
            if points.iter().all(|point| is_away(point.1)) {
                let middle = cell.point(level, [1.0 / 3.0; 3]);
                of_face.folded += usize::from(is_away(self.point_and_normal(mesh, face, middle).1));
            }
        }
        of_face
    }

    /// Returns the points of the mesh at the corners of a level's cells, with the normals of their triangles: row j holds the
    /// corners (i, j).
    pub(super) fn rows(&self, mesh: &Mesh, face: u32, level: usize) -> Vec<Vec<(DVec3, DVec3)>> {
        let n = 1u16 << level;
        let at = |i, j| self.point_and_normal(mesh, face, barycentric(level, [i, j]));
        (0..=n).map(|j| (0..=n - j).map(|i| at(i, j)).collect()).collect()
    }

    /// Returns the point of the mesh at a place on the base, and the normal of its triangle.
    pub(super) fn point_and_normal(&self, mesh: &Mesh, face: u32, weights: [f64; 3]) -> (DVec3, DVec3) {
        let point = self.to_mesh(&DomainPoint::new(face, weights));
        let found =
            point.and_then(|point| Some((DVec3::from_array(point.position(mesh)?), normal_at(mesh, &point))));
        found.unwrap_or_default()
    }
}

/// Figures of the triangles over a base face, which all have the same area on it.
#[derive(Debug, Default)]
struct OfFace {
    angles: Vec<f64>,
    areas: Vec<f64>,
    folded: usize,
    area: f64,
}

/// Returns the normal of the triangle at a point, as long as twice its area.
pub(super) fn normal_at(mesh: &Mesh, point: &MeshPoint) -> DVec3 {
    let corners = mesh.triangles()[point.triangle as usize];
    let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
    (b - a).cross(c - a)
}

/// A triangle in the plane, `n` times smaller.
struct Flat {
    side: f64,
    third: DVec2,
    area: f64,
}

impl Flat {
    fn new(corners: [[f32; 3]; 3], n: f64) -> Self {
        let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)) / n);
        let (e, f) = (b - a, c - a);
        let side = e.length().max(f64::MIN_POSITIVE);
        let third = DVec2::new(f.dot(e) / side, e.cross(f).length() / side);
        Self { side, third, area: 0.5 * side * third.y }
    }

    /// Returns the ratio of the singular values, and their product, of the map that takes the two sides to `d1` and `d2`.
    fn stretch(&self, d1: DVec3, d2: DVec3) -> (f64, f64) {
        let x = d1 / self.side;
        let y = (d2 - x * self.third.x) / self.third.y.max(f64::MIN_POSITIVE);
        let (a, b, c) = (x.length_squared(), x.dot(y), y.length_squared());
        let (mean, half) = (0.5 * (a + c), (0.25 * (a - c) * (a - c) + b * b).sqrt());
        let angle = ((mean + half) / (mean - half).max(1e-12 * mean).max(f64::MIN_POSITIVE)).sqrt();
        (angle, (a * c - b * b).max(0.0).sqrt())
    }
}

/// Returns the spread of values with weights.
fn spread(mut values: Vec<(f64, f64)>) -> Spread {
    let whole: f64 = values.iter().map(|(_, weight)| weight).sum();
    if whole.is_nan() || whole <= 0.0 {
        return Spread::default();
    }
    let mean = values.iter().map(|(value, weight)| value * weight).sum::<f64>() / whole;
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let p99 = values.iter().find(|(_, weight)| {
        sum += weight;
        sum >= 0.99 * whole
    });
    Spread { mean, p99: p99.map_or(mean, |value| value.0) }
}
