//! A crowd: 1,000 objects of one model with levels of 10,000 to 200 triangles, the two paths of Southern,
//! section 6.4 (a circle around all, and straight through the middle), and flights along them under control.

#![allow(dead_code)]

use multires::control::{Bias, BiasOptions, Sight, StairObject, Stairs, Stress, StressFrame, StressOptions};

/// Triangles of the levels, finest first; a sixth of the parameter each.
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

/// A path: the pose of a frame.
pub type Path = fn(usize) -> Pose;

/// The paths by name, each with the triangles wanted along it: 0.85 of what the circle shows without control, and more than all objects
/// of the way through have at their coarsest.
pub const PATHS: [(&str, Path, usize); 2] =
    [("circle", circle, 500_000), ("through the middle", through, 250_000)];

/// A flight along a path under control of a bias, of the objects as they are: triangles drawn and the bias, a frame each.
/// `change` limits the bias's change in a frame; `None`: no control.
pub fn biased(stairs: &Stairs, path: Path, change: Option<f64>, wanted: usize) -> Vec<(usize, f64)> {
    let crowd = Crowd::new(10);
    let options = BiasOptions::default().with_triangles(wanted).with_tolerance(stairs.largest_step());
    let mut bias = Bias::new(options.with_change(change)).expect("options in their ranges");
    let mut objects = Vec::new();
    let frame = |frame| {
        crowd.objects(stairs, path(frame), &mut objects);
        if change.is_some() {
            bias.update(&objects, true);
        }
        let at = bias.bias();
        let triangles = |object: &StairObject<'_>| match object.sight {
            Sight::Culled => 0,
            _ => stairs.triangles(object.level_at(at)),
        };
        (objects.iter().map(triangles).sum(), at)
    };
    (0..FRAMES).map(frame).collect()
}

/// A frame of a flight under stress.
#[derive(Debug, Clone, Copy)]
pub struct Stressed {
    /// Triangles of all visible objects at full resolution.
    pub complexity: usize,
    /// Triangles drawn.
    pub drawn: usize,
    /// Time over expected time.
    pub load: f64,
    /// The state from which the frame's resolutions came.
    pub stress: f64,
}

/// Frames of the flight under stress.
pub const STRESSED_FRAMES: usize = 240;
/// Objects of the flight under stress, and the triangles of each: 1.15 million together.
pub const STRESSED: [usize; 2] = [46, 25_000];
/// Seconds that the simulated card takes a triangle: 250,000 in the time of a frame.
pub const CARD: f64 = 4e-7;

/// A flight from left to right along a street of totally ordered meshes (Bouvier and Gobbetti, section 4.4, Fig. 9): 100 ms a
/// frame on a simulated card. `drawn` returns the triangles that an object draws when asked for so many.
pub fn stressed(drawn: impl Fn(usize) -> usize) -> Vec<Stressed> {
    let mut stress = Stress::new(StressOptions::paper()).expect("options in their ranges");
    let [objects, full] = STRESSED;
    let mut frame = |frame: usize| {
        let way = frame as f64 / STRESSED_FRAMES as f64;
        // The eye goes along the street and turns its head: into it, across it, away from it.
        let (eye, turn) = (-1.2 + 2.4 * way, 0.9 * (std::f64::consts::TAU * 3.0 * way).sin());
        let ahead = [turn.cos(), turn.sin()];
        let state = stress.stress();
        let mut now = Stressed { complexity: 0, drawn: 0, load: 0.0, stress: state };
        let (mut visible, mut at_full, mut at_base) = (0, 0, 0);
        for object in 0..objects {
            let side = if object % 2 == 0 { -0.12 } else { 0.12 };
            let to = [(object / 2) as f64 / (objects / 2) as f64 * 2.0 - 1.0 - eye, side];
            let distance = (to[0] * to[0] + to[1] * to[1]).sqrt();
            if (to[0] * ahead[0] + to[1] * ahead[1]) < 0.8 * distance {
                continue;
            }
            // A box of 0.08 in a view of 60 degrees.
            let coverage = (0.08 / (distance * 1.15)).min(1.0);
            let resolution = stress.resolution(coverage);
            now.complexity += full;
            now.drawn += drawn(stress.triangles(coverage, [100, full]));
            visible += 1;
            at_full += usize::from(resolution >= 1.0);
            at_base += usize::from(resolution <= 0.0);
        }
        let seconds = 1e-3 + CARD * now.drawn as f64;
        let measured = StressFrame::new(seconds, visible).with_ends(at_full, at_base);
        stress.update(measured).expect("a time above 0");
        now.load = seconds / 0.1;
        now
    };
    (0..STRESSED_FRAMES).map(&mut frame).collect()
}
