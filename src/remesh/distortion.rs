//! How far a map is from keeping angles and areas.

use glam::{DVec2, DVec3};

use crate::mesh::Mesh;
use crate::wavelet::DomainPoint;

use super::Parameterisation;

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
    /// Triangles of the level that face away from the mesh at their middle.
    pub folded: usize,
    /// Triangles measured.
    pub triangles: usize,
}

impl Parameterisation {
    /// Measures the distortion on the triangles of a level, each base face split `level` times (at most 10). `mesh` is the
    /// mesh that the map was made from. O(4^level base faces).
    pub fn distortion(&self, mesh: &Mesh, level: usize) -> Distortion {
        let n = 1usize << level.min(10);
        let (mut angles, mut areas, mut folded) = (Vec::new(), Vec::new(), 0);
        for (face, corners) in (0..).zip(self.base().triangles()) {
            let at = |i: usize, j: usize| self.position(mesh, face, [i, j].map(|x| x as f64 / n as f64));
            let of_base = Flat::new(corners.map(|v| self.base().positions()[v as usize]), n);
            let weight = of_base.area;
            let mut row: Vec<DVec3> = (0..=n).map(|j| at(0, j)).collect();
            for i in 0..n {
                let next: Vec<DVec3> = (0..n - i).map(|j| at(i + 1, j)).collect();
                for j in 0..n - i {
                    let mut add = |p: [DVec3; 3], turn: f64, middle: [f64; 2]| {
                        let [d1, d2] = [p[1] - p[0], p[2] - p[0]].map(|side| turn * side);
                        let (angle, area) = of_base.stretch(d1, d2);
                        angles.push((angle, weight));
                        areas.push((area, weight));
                        let weights = [middle[0] / n as f64, middle[1] / n as f64];
                        folded += usize::from(d1.cross(d2).dot(self.normal(mesh, face, weights)) < 0.0);
                    };
                    let (x, y) = (i as f64, j as f64);
                    add([row[j], next[j], row[j + 1]], 1.0, [x + 1.0 / 3.0, y + 1.0 / 3.0]);
                    if j + 1 < n - i {
                        add([next[j + 1], row[j + 1], next[j]], -1.0, [x + 2.0 / 3.0, y + 2.0 / 3.0]);
                    }
                }
                row = next;
            }
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

    fn position(&self, mesh: &Mesh, face: u32, [u, v]: [f64; 2]) -> DVec3 {
        let point = self.to_mesh(&DomainPoint::new(face, [1.0 - u - v, u, v]));
        point.and_then(|point| point.position(mesh)).map_or(DVec3::ZERO, DVec3::from_array)
    }

    fn normal(&self, mesh: &Mesh, face: u32, [u, v]: [f64; 2]) -> DVec3 {
        let Some(point) = self.to_mesh(&DomainPoint::new(face, [1.0 - u - v, u, v])) else { return DVec3::ZERO };
        let corners = mesh.triangles()[point.triangle as usize];
        let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        (b - a).cross(c - a)
    }
}

/// A triangle in the plane, `n` times smaller.
struct Flat {
    side: f64,
    third: DVec2,
    area: f64,
}

impl Flat {
    fn new(corners: [[f32; 3]; 3], n: usize) -> Self {
        let [a, b, c] = corners.map(|p| DVec3::from_array(p.map(f64::from)) / n as f64);
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
