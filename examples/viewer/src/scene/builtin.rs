//! Scenes that need no file.

use multires::mesh::{Mesh, shapes};

use super::model::StructureKind;
use crate::camera::Orbit;

/// A built-in scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "program", derive(clap::ValueEnum))]
pub enum Builtin {
    /// The library's demo model: seams, creases, five materials.
    Demo,
    /// A fractal terrain, half a million triangles unless told otherwise.
    Terrain,
    /// 289 instances of one rock.
    Rocks,
    /// 1,000 instances of one rock on a disc, each of about 10,000 triangles unless told otherwise, down to 200.
    Crowd,
}

/// Objects on a side of the field of rocks.
const FIELD: usize = 17;
/// Objects of the crowd.
const CROWD: usize = 1_000;
/// Triangles of the coarsest level of the crowd's objects.
const CROWD_COARSEST: usize = 200;
/// Mean distance from an object of the crowd to the next, object units. A rock is 2 wide.
const CROWD_SPACING: f32 = 3.0;

impl Builtin {
    /// Its mesh, with about so many triangles where that can be chosen: for wavelets the nearest number for which coarse faces
    /// can be split in four again and again.
    pub fn mesh(self, triangles: Option<u32>, structure: StructureKind) -> Mesh {
        let edges = |of: u32, count: f64| {
            let edges = (f64::from(of) / count).sqrt();
            if structure == StructureKind::Wavelet { edges.max(1.0).log2().round().exp2() } else { edges }
        };
        match self {
            Self::Demo => shapes::demo(),
            Self::Terrain => {
                let cells = edges(triangles.unwrap_or(500_000), 2.0).round() as u32;
                shapes::terrain(cells.saturating_add(1), 7)
            }
            Self::Rocks | Self::Crowd => {
                let triangles = triangles.unwrap_or(if self == Self::Rocks { 20_000 } else { 10_000 });
                match structure {
                    StructureKind::Wavelet => shapes::rock((20.0 * edges(triangles, 20.0).powi(2)) as u32, 3),
                    _ => shapes::rock(triangles, 3),
                }
            }
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Demo => "demo model",
            Self::Terrain => "terrain",
            Self::Rocks => "rocks",
            Self::Crowd => "crowd",
        }
    }

    /// Triangles of the coarsest level; `None`: as few as can be.
    pub fn coarsest(self) -> Option<usize> {
        (self == Self::Crowd).then_some(CROWD_COARSEST)
    }

    /// The first look at the scene, y up: all of it, or the crowd from its rim.
    pub fn orbit(self, centre: [f64; 3], diagonal: f64, field_of_view: f64) -> Orbit {
        let all = Orbit::framing(centre, 0.4 * diagonal, field_of_view, false);
        match self {
            Self::Crowd => {
                let (sin, cos) = all.around.sin_cos();
                let near = glam::DVec3::new(sin, 0.0, cos) * (0.17 * diagonal);
                let target = (glam::DVec3::from_array(centre) + near).to_array();
                Orbit { target, distance: 0.22 * diagonal, above: 0.33, ..all }
            }
            _ => all,
        }
    }

    /// Where its objects are: matrices from object to world, column-major.
    pub fn places(self) -> Vec<[[f32; 4]; 4]> {
        match self {
            Self::Demo | Self::Terrain => vec![glam::Mat4::IDENTITY.to_cols_array_2d()],
            Self::Rocks => (0..FIELD * FIELD).map(|i| field(i).to_cols_array_2d()).collect(),
            Self::Crowd => (0..CROWD).map(|i| crowd(i).to_cols_array_2d()).collect(),
        }
    }
}

/// Multiples of an irrational number, less the whole: they never repeat and never cluster.
fn part(i: usize, step: f32) -> f32 {
    (i as f32 * step).fract()
}

/// A turn of an object's own.
fn turn(i: usize) -> glam::Quat {
    let around = std::f32::consts::TAU * part(i, 0.414_214);
    glam::Quat::from_euler(glam::EulerRot::YXZ, around, part(i, 0.732_051), part(i, 0.236_068))
}

/// The place of a rock: on a grid, each turned and sized in its own way.
fn field(i: usize) -> glam::Mat4 {
    let [column, row] = [i % FIELD, i / FIELD].map(|x| x as f32 - (FIELD / 2) as f32);
    let shift = [part(i, 0.618_034) - 0.5, part(i, 0.754_878) - 0.5];
    let size = 0.5 + 0.8 * part(i, 0.569_84);
    glam::Mat4::from_scale_rotation_translation(
        glam::Vec3::splat(size),
        turn(i),
        glam::Vec3::new(3.2 * column + 1.4 * shift[0], 0.3 * size, 3.2 * row + 1.4 * shift[1]),
    )
}

/// The place of an object of the crowd: on a disc, as seeds of a sunflower (Vogel 1979), each turned in its own way.
fn crowd(i: usize) -> glam::Mat4 {
    let around = i as f32 * (3.0 - 5.0_f32.sqrt()) * std::f32::consts::PI;
    let out = CROWD_SPACING * (i as f32 + 0.5).sqrt() / std::f32::consts::PI.sqrt();
    let place = glam::Vec3::new(out * around.cos(), 0.0, out * around.sin());
    glam::Mat4::from_rotation_translation(turn(i), place)
}
