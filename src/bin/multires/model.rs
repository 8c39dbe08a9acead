//! A baked structure that follows the view, whichever it is: what `adapt` and `fly` need to know of it.

use std::sync::Arc;

use clap::{Args, ValueEnum};
use multires::adapt::{LevelOfDetail, LodOptions};
use multires::hierarchy::{HierarchyLod, HierarchyMesh};
use multires::mesh::{AttributeValues, Mesh, names};
use multires::wavelet::{Drawing, Normals, Triangulation, WaveletLod, WaveletMesh};
use serde_json::{Value, json};

use crate::output::Failure;

/// How wavelet meshes are drawn.
#[derive(Args)]
pub struct Style {
    /// Triangles of a wavelet mesh: the sum of its wavelets as it is, which errors are known of (exact); or the fewest, without
    /// a vertex that is no wavelet's (minimal) [default: exact].
    #[arg(long, value_name = "K", value_enum)]
    triangulation: Option<Triangles>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Triangles {
    Exact,
    Minimal,
}

impl Style {
    /// Which triangles.
    pub fn triangulation(&self) -> Triangulation {
        match self.triangulation {
            None | Some(Triangles::Exact) => Triangulation::Exact,
            Some(Triangles::Minimal) => Triangulation::Minimal,
        }
    }

    /// The same in words.
    pub fn name(&self) -> &'static str {
        if self.triangulation == Some(Triangles::Minimal) { "minimal" } else { "exact" }
    }

    /// Refuses what was asked for of another structure.
    pub fn check_unused(&self) -> Result<(), Failure> {
        match self.triangulation {
            None => Ok(()),
            Some(_) => Err(Failure::Usage("--triangulation is for wavelet meshes".to_owned())),
        }
    }
}

/// A structure that follows the view.
pub enum Model {
    Hierarchy(HierarchyMesh),
    Wavelet(Arc<WaveletMesh>),
}

/// One drawn instance of it.
pub enum Instance {
    Hierarchy(HierarchyLod),
    /// With positions that are drawn, or with normals beside them.
    Positions(WaveletLod<[f32; 3]>),
    Normals(WaveletLod<[[f32; 3]; 2]>),
}

impl Model {
    /// What its positions are relative to.
    pub fn origin(&self) -> [f64; 3] {
        match self {
            Self::Hierarchy(model) => model.vertices().origin(),
            Self::Wavelet(model) => model.vertices().origin(),
        }
    }

    /// Smallest and largest corner of the box around the full resolution.
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        match self {
            Self::Hierarchy(model) => model.bounds(),
            Self::Wavelet(model) => model.extent(),
        }
    }

    /// Triangles of the finest and of the coarsest mesh.
    pub fn triangles(&self) -> [usize; 2] {
        match self {
            Self::Hierarchy(model) => {
                let hierarchy = model.hierarchy();
                [hierarchy.triangle_count(), hierarchy.base_triangle_count()]
            }
            Self::Wavelet(model) => {
                let of = model.subdivision();
                [of.triangle_count(), of.base_face_count()]
            }
        }
    }

    /// An instance. With `packed`, only vertices in use are in its buffer.
    pub fn instance(&self, style: &Style, packed: bool, limits: LodOptions) -> Result<Instance, Failure> {
        let drawing = Drawing::default().with_triangulation(style.triangulation()).with_packed(packed);
        Ok(match self {
            Self::Hierarchy(model) => {
                style.check_unused()?;
                let shared = Arc::clone(model.hierarchy());
                let lod = if packed { HierarchyLod::packed(shared) } else { HierarchyLod::new(shared) };
                Instance::Hierarchy(lod.with_options(limits))
            }
            Self::Wavelet(model) => {
                let positions = model.vertices().positions();
                let model = Arc::clone(model);
                match normals(model.vertices()) {
                    Some(normals) => {
                        let both = positions.iter().zip(normals).map(|(&p, &n)| [p, n]).collect();
                        let lod = WaveletLod::new(model, both, &drawing).map_err(Failure::input)?;
                        Instance::Normals(lod.with_options(limits))
                    }
                    None => {
                        let lod = WaveletLod::new(Arc::clone(&model), positions.into(), &drawing);
                        Instance::Positions(lod.map_err(Failure::input)?.with_options(limits))
                    }
                }
            }
        })
    }

    /// What an instance of it draws, as a mesh of its own.
    pub fn mesh_at(&self, instance: &Instance) -> Mesh {
        match (self, instance) {
            (Self::Hierarchy(model), Instance::Hierarchy(lod)) => model.mesh_at(lod),
            (_, Instance::Positions(lod)) => lod.to_mesh(Normals::Kept),
            (_, Instance::Normals(lod)) => lod.to_mesh(Normals::Kept),
            (Self::Wavelet(_), Instance::Hierarchy(_)) => Mesh::default(),
        }
    }

    /// Bytes that are written for one vertex whose values change: those of a hierarchy are all that the mesh has.
    pub fn bytes_per_vertex(&self, instance: &Instance) -> usize {
        match (self, instance) {
            (Self::Hierarchy(model), _) => crate::rules::bytes_per_vertex(model.vertices()),
            (_, Instance::Normals(_)) => size_of::<[[f32; 3]; 2]>(),
            _ => size_of::<[f32; 3]>(),
        }
    }

    /// What its refinements are called, and how many of them an instance's cut has.
    pub fn refined(&self, instance: &Instance) -> (&'static str, usize) {
        let count = |all: usize, holds: &dyn Fn(u32) -> bool| (0..all as u32).filter(|&r| holds(r)).count();
        match instance {
            Instance::Hierarchy(lod) => {
                ("splits", count(lod.hierarchy().split_count(), &|split| lod.cut().holds(split)))
            }
            Instance::Positions(lod) => {
                ("wavelets", count(lod.mesh().subdivision().wavelet_count(), &|w| lod.cut().holds(w)))
            }
            Instance::Normals(lod) => {
                ("wavelets", count(lod.mesh().subdivision().wavelet_count(), &|w| lod.cut().holds(w)))
            }
        }
    }

    /// Which triangles are drawn, for JSON.
    pub fn triangulation(&self, style: &Style) -> Value {
        match self {
            Self::Hierarchy(_) => Value::Null,
            Self::Wavelet(_) => json!(style.name()),
        }
    }
}

impl Instance {
    pub fn lod(&mut self) -> &mut dyn LevelOfDetail {
        match self {
            Self::Hierarchy(lod) => lod,
            Self::Positions(lod) => lod,
            Self::Normals(lod) => lod,
        }
    }
}

/// Normals of all vertices, where there are such.
fn normals(mesh: &Mesh) -> Option<&[[f32; 3]]> {
    let attribute = mesh.attribute(names::NORMAL).filter(|attribute| attribute.width() == 3)?;
    match attribute.values() {
        AttributeValues::Float(values) => bytemuck::try_cast_slice(values).ok(),
        _ => None,
    }
}
