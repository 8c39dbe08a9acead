//! Scenes that need no file.

use multires::mesh::{Mesh, shapes};

use super::model::StructureKind;

/// A built-in scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Builtin {
    /// The library's demo model: seams, creases, five materials.
    Demo,
    /// A fractal terrain, half a million triangles unless told otherwise.
    Terrain,
    /// 289 instances of one rock.
    Rocks,
}

/// Objects on a side of the field of rocks.
const FIELD: usize = 17;

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
            Self::Rocks => {
                let triangles = triangles.unwrap_or(20_000);
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
        }
    }

    /// Where its objects are: matrices from object to world, column-major.
    pub fn places(self) -> Vec<[[f32; 4]; 4]> {
        match self {
            Self::Demo | Self::Terrain => vec![glam::Mat4::IDENTITY.to_cols_array_2d()],
            Self::Rocks => (0..FIELD * FIELD).map(|i| field(i).to_cols_array_2d()).collect(),
        }
    }
}

/// The place of a rock: on a grid, each turned and sized in its own way.
fn field(i: usize) -> glam::Mat4 {
    let [column, row] = [i % FIELD, i / FIELD].map(|x| x as f32 - (FIELD / 2) as f32);
    // Steps of irrational parts of a whole never repeat and never cluster.
    let part = |step: f32| (i as f32 * step).fract();
    let shift = [part(0.618_034) - 0.5, part(0.754_878) - 0.5];
    let size = 0.5 + 0.8 * part(0.569_84);
    glam::Mat4::from_scale_rotation_translation(
        glam::Vec3::splat(size),
        glam::Quat::from_euler(
            glam::EulerRot::YXZ,
            std::f32::consts::TAU * part(0.414_214),
            part(0.732_051),
            part(0.236_068),
        ),
        glam::Vec3::new(3.2 * column + 1.4 * shift[0], 0.3 * size, 3.2 * row + 1.4 * shift[1]),
    )
}
