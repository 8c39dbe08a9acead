//! Hash, gradient noise, sine and cosine with equal bits on every platform.
//!
//! Gradient noise after Perlin, *An Image Synthesizer*, SIGGRAPH 1985 (with the quintic fade of *Improving Noise*,
//! 2002); ridges after Musgrave, in *Texturing and Modeling: A Procedural Approach*.

use std::f64::consts::TAU;

use glam::{DVec3, Mat3, Vec3};

/// Mixes all bits of a word by alternating multiplications and folds.
pub(super) fn scramble(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x9e37_79b1);
    x = (x ^ x >> 15).wrapping_mul(0x85eb_ca77);
    x ^ x >> 16
}

/// Returns a random number from 0 to below 1 for an index and a seed.
pub(super) fn unit(index: u32, seed: u32) -> f32 {
    // 24 bits are exact in a float.
    (scramble(index ^ scramble(seed)) >> 8) as f32 / 16_777_216.0
}

/// Returns a random direction for an index and a seed, uniform on the sphere.
pub(super) fn direction(index: u32, seed: u32) -> DVec3 {
    let height = f64::from(unit(2 * index, seed)) * 2.0 - 1.0;
    let [sin, cos] = sin_cos(f64::from(unit(2 * index + 1, seed)));
    let radius = (1.0 - height * height).sqrt();
    DVec3::new(radius * cos, height, radius * sin)
}

/// Returns sine and cosine of an angle in turns; exact at quarter turns. Errors below 1e-15.
pub(super) fn sin_cos(turns: f64) -> [f64; 2] {
    let part = turns - turns.floor();
    let quarter = (4.0 * part + 0.5).floor();
    let x = (part - quarter / 4.0) * TAU;
    // The power series in Horner's form, for |x| up to an eighth of a turn.
    let series = |first: u32| {
        let mut sum = 1.0;
        for n in (0..8).rev() {
            let n = f64::from(2 * n + first);
            sum = 1.0 - sum * x * x / (n * (n + 1.0));
        }
        sum
    };
    let (sin, cos) = (x * series(2), series(1));
    match quarter as i32 & 3 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

/// Returns 0 below `low`, 1 above `high`, a smooth step between.
pub(super) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Gradient noise in space, about -1 to 1.
pub(super) fn noise(p: Vec3, seed: u32) -> f32 {
    let floor = p.floor();
    let [x, y, z] = [floor.x as i32 as u32, floor.y as i32 as u32, floor.z as i32 as u32];
    let f = p - floor;
    let corner = |dx: u32, dy: u32, dz: u32| {
        let row = scramble(scramble(seed ^ z.wrapping_add(dz)).wrapping_add(y.wrapping_add(dy)));
        let h = scramble(row.wrapping_add(x.wrapping_add(dx)));
        let part = |shift: u32| (h >> shift & 0x3ff) as f32 / 511.5 - 1.0;
        let gradient = Vec3::new(part(0), part(10), part(20));
        gradient.dot(f - Vec3::new(dx as f32, dy as f32, dz as f32))
    };
    let along_x = |dy: u32, dz: u32| lerp(corner(0, dy, dz), corner(1, dy, dz), fade(f.x));
    let along_y = |dz: u32| lerp(along_x(0, dz), along_x(1, dz), fade(f.y));
    1.3 * lerp(along_y(0), along_y(1), fade(f.z))
}

/// Maps an octave to the next: twice as fine, and rotated to misalign the lattices.
const FINER: Mat3 = Mat3::from_cols_array(&[
    4.0 / 3.0,
    4.0 / 3.0,
    -2.0 / 3.0,
    -2.0 / 3.0,
    4.0 / 3.0,
    4.0 / 3.0,
    4.0 / 3.0,
    -2.0 / 3.0,
    4.0 / 3.0,
]);

/// Sums octaves of noise, each half as high and twice as fine: about -1 to 1.
pub(super) fn octaves(mut p: Vec3, count: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut height = 0.5;
    for octave in 0..count {
        sum += height * noise(p, seed.wrapping_add(octave));
        height *= 0.5;
        p = FINER * p;
    }
    sum
}

/// Sums octaves of sharp crests, fine octaves only where coarse octaves are high: 0 to about 1.
pub(super) fn ridges(mut p: Vec3, count: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let (mut height, mut weight) = (0.5, 1.0_f32);
    for octave in 0..count {
        let crest = 1.0 - noise(p, seed.wrapping_add(octave)).abs();
        weight *= crest * crest;
        sum += height * weight;
        weight = (1.6 * weight).min(1.0);
        height *= 0.5;
        p = FINER * p;
    }
    sum
}

/// Gradient noise in a plane along a row of ascending x. Work common to a lattice cell is done once per cell.
pub(super) struct NoiseRow {
    seed: u32,
    row: u32,
    y: f32,
    fade_y: f32,
    cell: i32,
    /// Left and right of the cell: noise there is `slope * distance + offset`.
    left: [f32; 2],
    right: [f32; 2],
}

impl NoiseRow {
    pub(super) fn new(y: f32, seed: u32) -> Self {
        let floor = y.floor();
        let row = floor as i32;
        let mut noise = Self {
            seed: scramble(seed),
            row: row as u32,
            y: y - floor,
            fade_y: fade(y - floor),
            cell: 0,
            left: [0.0; 2],
            right: [0.0; 2],
        };
        noise.enter(0);
        noise
    }

    /// Returns the noise at `x`, about -1 to 1.
    pub(super) fn at(&mut self, x: f32) -> f32 {
        // `x` is never negative here, so truncating rounds down.
        let cell = x as i32;
        if cell != self.cell {
            self.enter(cell);
        }
        let t = x - cell as f32;
        let (a, b) = (self.left[0] * t + self.left[1], self.right[0] * (t - 1.0) + self.right[1]);
        1.5 * lerp(a, b, fade(t))
    }

    fn enter(&mut self, cell: i32) {
        self.left = if cell == self.cell.wrapping_add(1) { self.right } else { self.side(cell as u32) };
        self.right = self.side((cell as u32).wrapping_add(1));
        self.cell = cell;
    }

    /// Returns slope along x and offset at a side of a cell, blended between its lower and upper corner.
    fn side(&self, x: u32) -> [f32; 2] {
        let gradient = |row: u32| {
            let h = scramble(scramble(self.seed ^ row).wrapping_add(x));
            [(h & 0xffff) as f32 / 32_767.5 - 1.0, (h >> 16) as f32 / 32_767.5 - 1.0]
        };
        let (low, high) = (gradient(self.row), gradient(self.row.wrapping_add(1)));
        [lerp(low[0], high[0], self.fade_y), lerp(low[1] * self.y, high[1] * (self.y - 1.0), self.fade_y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_right() {
        for i in -3000..3000 {
            let turns = f64::from(i) / 991.0;
            let [sin, cos] = sin_cos(turns);
            assert!((sin - (turns * TAU).sin()).abs() < 2e-14 && (cos - (turns * TAU).cos()).abs() < 2e-14);
            assert!((sin * sin + cos * cos - 1.0).abs() < 1e-15);
        }
        assert_eq!([0.0, 0.25, 0.5, 0.75].map(sin_cos), [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]]);
    }

    #[test]
    fn noise_is_continuous_and_spread() {
        let step = 1.0 / 64.0;
        let mut row = NoiseRow::new(3.3, 5);
        let line: Vec<_> = (0..64 * 40).map(|i| row.at(i as f32 * step)).collect();
        let space: Vec<_> =
            (0..64 * 40).map(|i| noise(Vec3::new(i as f32 * step - 20.0, 0.3, 0.7), 5)).collect();
        for values in [line, space] {
            assert!(values.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 0.12));
            assert!(values.iter().any(|&v| v > 0.3) && values.iter().any(|&v| v < -0.3));
            assert!(values.iter().all(|v| v.abs() < 1.6));
        }
    }
}
