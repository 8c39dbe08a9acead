//! A crowd of mock geomorph meshes: 1,000 objects of 6 partitions, 10,000 to 200 triangles, and the two paths of Southern,
//! section 6.4: a circle around all, and straight through the middle.

#![allow(dead_code)]

use multires::control::{Sight, StairObject, Stairs};

/// Triangles of the levels, finest first; a seventh of the parameter each.
pub const LEVELS: [usize; 7] = [10_000, 5_200, 2_700, 1_400, 730, 380, 200];
pub const FRAMES: usize = 120;

pub fn stairs() -> Stairs {
    let levels: Vec<_> = LEVELS.iter().zip(0..).map(|(&count, i)| (i as f32 / 6.0, count)).collect();
    Stairs::new(&levels).unwrap()
}

/// A generator of numbers that look random, the same everywhere.
pub struct Random(pub u64);

impl Random {
    /// A number from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from 0 to below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

type Point = [f64; 3];

/// An eye, where it looks, and the distance at which objects are at their coarsest.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    pub eye: Point,
    pub target: Point,
    pub far: f64,
}

/// Around the crowd: all objects are seen all the time.
pub fn circle(frame: usize) -> Pose {
    let (sine, cosine) = (std::f64::consts::TAU * frame as f64 / FRAMES as f64).sin_cos();
    Pose { eye: [2.5 * cosine, 0.3, 2.5 * sine], target: [0.0; 3], far: 4.0 }
}

/// Through the middle, looking at a point just below it: in the middle, straight down at few objects, and soon back at many.
pub fn through(frame: usize) -> Pose {
    let along = 3.0 - 6.0 * frame as f64 / FRAMES as f64;
    Pose { eye: [along, 0.0, 0.0], target: [0.0, -0.1, 0.0], far: 1.5 }
}

pub struct Crowd {
    places: Vec<Point>,
}

impl Crowd {
    /// Objects about the places of a grid in the cube from -1 to 1.
    pub fn new(side: usize) -> Self {
        let mut random = Random(1);
        let mut places = Vec::new();
        for number in 0..side * side * side {
            let cell = [number % side, number / side % side, number / side / side];
            places.push(cell.map(|i| 2.0 * (i as f64 + random.unit()) / side as f64 - 1.0));
        }
        Self { places }
    }

    /// The objects as seen at a pose: parameters by distance, culled outside a cone of 25 degrees.
    pub fn objects<'a>(&self, stairs: &'a Stairs, pose: Pose, objects: &mut Vec<StairObject<'a>>) {
        let sub = |a: Point, b: Point| -> Point { std::array::from_fn(|i| a[i] - b[i]) };
        let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let ahead = sub(pose.target, pose.eye);
        objects.clear();
        objects.extend(self.places.iter().map(|&place| {
            let to = sub(place, pose.eye);
            let distance = dot(to, to).sqrt();
            let cosine = dot(to, ahead) / (distance * dot(ahead, ahead).sqrt());
            let seen = if cosine > 25_f64.to_radians().cos() { Sight::Seen } else { Sight::Culled };
            StairObject::new(stairs, ((distance - 0.1) / (pose.far - 0.1)) as f32).with_sight(seen)
        }));
    }
}
