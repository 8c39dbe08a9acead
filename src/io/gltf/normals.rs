//! Normals that a file lacks, or that are no directions.
//!
//! A primitive without normals beside others with normals is lit like the others: by smooth normals from its triangles, and
//! so is a vertex whose normal is zero or not finite. Other lengths than 1 are kept, with a note.

use std::cell::OnceCell;

use glam::{DVec3, Vec3};

use crate::io::draft::Tally;

/// Largest deviation of a normal's length from 1: what three bytes round away, and as much again.
pub(super) const LENGTH_SLACK: f32 = 0.0065;

/// Counts of what was mended.
#[derive(Default)]
pub(super) struct Repairs {
    missing: Tally,
    unequal: Tally,
    broken: Tally,
}

impl Repairs {
    /// Mends the normals of the vertices from `base` on, 3 floats a vertex. `is_there`: the file has normals for them.
    pub fn mend(
        &mut self,
        mesh: usize,
        is_there: bool,
        normals: &mut [f32],
        base: usize,
        surface: &Surface<'_>,
    ) {
        for (v, normal) in normals.chunks_exact_mut(3).enumerate() {
            let length = Vec3::from_slice(normal).length();
            // False for NaN.
            if (length - 1.0).abs() <= LENGTH_SLACK {
                continue;
            }
            if length > 0.0 && length.is_finite() {
                self.unequal.add(mesh);
                continue;
            }
            if is_there {
                self.broken.add(mesh);
            }
            normal.copy_from_slice(&surface.normal(base + v));
        }
        if !is_there {
            self.missing.add(mesh);
        }
    }

    pub fn note(&self, notes: &mut Vec<String>) {
        self.missing.note("primitives have no normals, unlike others: computed", "mesh", notes);
        self.unequal.note("normals are not of length 1", "mesh", notes);
        self.broken.note("normals are no directions: computed", "mesh", notes);
    }
}

/// The triangles that normals are made from, when the first is asked for.
pub(super) struct Surface<'a> {
    positions: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    /// Number of the first vertex.
    base: usize,
    normals: OnceCell<Vec<[f32; 3]>>,
}

impl<'a> Surface<'a> {
    pub fn new(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]], base: usize) -> Self {
        Self { positions, triangles, base, normals: OnceCell::new() }
    }

    /// Returns a smooth normal weighted by area; the z axis where there is no area.
    pub fn normal(&self, vertex: usize) -> [f32; 3] {
        self.normals.get_or_init(|| self.all())[vertex - self.base]
    }

    fn all(&self) -> Vec<[f32; 3]> {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in self.triangles {
            let corners = triangle.map(|v| v as usize - self.base);
            let [a, b, c] = corners.map(|v| DVec3::from_array(self.positions[v]));
            let normal = (b - a).cross(c - a);
            if normal.is_finite() {
                corners.iter().for_each(|&v| sums[v] += normal);
            }
        }
        sums.iter().map(|n| n.normalize_or(DVec3::Z).as_vec3().to_array()).collect()
    }
}
