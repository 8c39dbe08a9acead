//! Fractal terrain and rocks.

use glam::{DVec3, Vec3};

use super::super::Mesh;
use super::noise::{NoiseRow, direction, noise, octaves, ridges, smoothstep, unit};
use super::solids::geodesic;
use super::{bare, cells};

/// Approximate height of the terrain's peaks above its plains, object units.
const RELIEF: f32 = 0.16;

/// A fractal height field over the unit square, y up: `size * size` vertices row by row, `2 * (size - 1)^2` triangles.
///
/// Plains of gentle swells rise into ridged mountains, with relief down to the width of a few cells. Vertex `row * size
/// + column` lies at x = `column / (size - 1) - 0.5` and z = `row / (size - 1) - 0.5`. `size`: 2 to 2^14, not only `2^k
/// + 1`. O(n log n) in the number of vertices.
pub fn terrain(size: u32, seed: u32) -> Mesh {
    let size = size.clamp(2, 1 << 14);
    let across = size - 1;
    let step = 1.0 / across as f32;
    // The finest octave has at least 5 cells to a lattice cell, except in very small terrains.
    let count = across.ilog2().saturating_sub(3).clamp(2, 10);
    let mut positions = Vec::with_capacity(size as usize * size as usize);
    let mut heights = vec![0.0_f32; size as usize];
    let mut ridge_state = vec![[0.0_f32; 2]; size as usize];
    for row in 0..size {
        let z = row as f32 * step;
        terrain_row(z, step, count, seed, &mut heights, &mut ridge_state);
        let line = heights.iter().enumerate();
        positions.extend(line.map(|(column, &height)| [column as f32 * step - 0.5, height, z - 0.5]));
    }
    let mut triangles = Vec::new();
    // Rows run towards +z; with +z upwards, +x is to the left as seen from above.
    cells(across, across, &mut triangles, |column, row| row * size + across - column);
    bare(positions, triangles)
}

/// Computes the heights along a row, octave by octave: each lattice cell is entered once per octave.
///
/// The state of a column: how mountainous it is, and its weight for the next octave.
fn terrain_row(z: f32, step: f32, count: u32, seed: u32, heights: &mut [f32], state: &mut [[f32; 2]]) {
    let mut broad = NoiseRow::new(1.7 * z, seed);
    let mut swell = NoiseRow::new(3.4 * z, seed.wrapping_add(1));
    for (column, (height, state)) in heights.iter_mut().zip(&mut *state).enumerate() {
        let x = column as f32 * step;
        let land = 0.65 * broad.at(1.7 * x) + 0.35 * swell.at(3.4 * x);
        let mountains = (1.2 * land + 0.45).clamp(0.0, 1.0);
        *state = [mountains * mountains * (3.0 - 2.0 * mountains), 1.0];
        *height = 0.35 * RELIEF * land;
    }
    let mut amplitude = 0.5 * RELIEF;
    for octave in 0..count {
        let scale = 3.1 * (1_u32 << octave) as f32;
        let mut row = NoiseRow::new(scale * z, seed.wrapping_add(2 + octave));
        for (column, (height, [mountains, weight])) in heights.iter_mut().zip(&mut *state).enumerate() {
            let value = row.at(scale * column as f32 * step);
            let crest = 1.0 - value.abs();
            let crest = crest * crest * *weight;
            *weight = (1.4 * crest).min(1.0);
            // Plains keep a faint trace of every octave: no region is exactly flat.
            *height += amplitude * (*mountains * crest + 0.04 * value);
        }
        amplitude *= 0.5;
    }
}

/// A closed rock of radius about 1, with lumps, ridges, grain and a few craters. The number of triangles is the next
/// `20 * k^2` from `triangles` up (20 to 980 million). All vertices are shared.
///
/// The grain is as fine as the triangles can show; all coarser features are independent of the number of triangles.
/// Every surface point is visible from the middle, so the surface never cuts itself. O(n log n).
pub fn rock(triangles: u32, seed: u32) -> Mesh {
    let frequency = (f64::from(triangles) / 20.0).sqrt().ceil().min(7000.0) as u32;
    let (directions, triangles) = geodesic(frequency);
    let shape = Rock::new(frequency, seed);
    let positions: Vec<_> = directions.iter().map(|&d| (d * shape.radius(d)).as_vec3().to_array()).collect();
    bare(positions, triangles)
}

struct Rock {
    seed: u32,
    /// Octaves of grain; the finest spans a few triangles.
    grain: u32,
    /// Direction and size (as a chord) of every crater.
    craters: [(DVec3, f64); 7],
}

impl Rock {
    const GRAIN: f32 = 9.0;

    fn new(frequency: u32, seed: u32) -> Self {
        let grain = (frequency as f32 / (2.0 * Self::GRAIN)) as u32;
        let sown = seed.wrapping_add(100);
        let crater = |i: u32| {
            let large = f64::from(unit(1000 + i, sown));
            (direction(i, sown), 0.2 + 0.36 * large * large)
        };
        let grain = grain.checked_ilog2().map_or(0, |finest| finest + 1);
        Self { seed, grain, craters: std::array::from_fn(|i| crater(i as u32)) }
    }

    fn radius(&self, d: DVec3) -> f64 {
        let p = d.as_vec3();
        let seed = |layer: u32| self.seed.wrapping_add(20 * layer);
        let lumps = 0.5 * noise(1.1 * p, seed(0)) + 0.4 * octaves(2.0 * p, 3, seed(1));
        let warp = Vec3::new(noise(1.7 * p, seed(2)), noise(1.7 * p, seed(3)), noise(1.7 * p, seed(4)));
        let crests = 0.16 * ridges(2.0 * (p + 0.3 * warp), 4, seed(6));
        let grain = 0.05 * octaves(Self::GRAIN * p, self.grain, seed(7));
        let (depth, rough) = self.craters(d);
        let radius = 0.9 + f64::from(0.55 * lumps) + rough * f64::from(crests + grain) + depth;
        radius.max(0.3)
    }

    /// Returns the craters' contribution to the radius (a bowl inside, a rim at the edge, an apron outside), and the
    /// share of relief left.
    fn craters(&self, d: DVec3) -> (f64, f64) {
        self.craters.iter().fold((0.0, 1.0), |(depth, rough), &(middle, size)| {
            let x = (d - middle).length() / size;
            let bowl = 0.45 * size * (x * x - 1.0).min(0.0);
            let rim = (1.0 - smoothstep(0.0, 0.45, (x - 1.0).abs())) * 0.12 * size;
            (depth + bowl + rim, rough * (0.2 + 0.8 * smoothstep(0.5, 1.1, x)))
        })
    }
}
