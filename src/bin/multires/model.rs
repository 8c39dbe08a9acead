//! A baked model of any structure, and how the program draws it.

use std::path::Path;

use clap::{Args, ValueEnum};
use multires::io;
use multires::lod::{Lod, LodOptions, Triangulation};
use multires::mesh::{AttributeValues, Mesh, names};
use serde_json::{Value, json};

use crate::output::Failure;
use crate::{files, rules};

/// A drawn vertex: its position, and its normal, or zeros without normals.
pub type Vertex = [[f32; 3]; 2];

/// How models are drawn.
#[derive(Args)]
pub struct Style {
    /// Triangles of a wavelet mesh: the exact sum of its wavelets, with known errors (exact); or as few as possible, with no
    /// vertex but the wavelets' (minimal) [default: exact].
    #[arg(long, value_name = "K", value_enum)]
    triangulation: Option<Triangles>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Triangles {
    Exact,
    Minimal,
}

impl Style {
    /// Returns the triangulation.
    pub fn triangulation(&self) -> Triangulation {
        match self.triangulation {
            None | Some(Triangles::Exact) => Triangulation::Exact,
            Some(Triangles::Minimal) => Triangulation::Minimal,
        }
    }

    /// Returns the triangulation's name; null for a model without a choice.
    pub fn name(&self, model: &Model) -> Value {
        match self.triangulation() {
            _ if !model.0.has_triangulations() => Value::Null,
            Triangulation::Minimal => json!("minimal"),
            _ => json!("exact"),
        }
    }

    /// Refuses a triangulation for a model without a choice.
    pub fn check(&self, model: &Model) -> Result<(), Failure> {
        if self.triangulation.is_none() || model.0.has_triangulations() {
            return Ok(());
        }
        Err(Failure::Usage("--triangulation is for wavelet meshes".to_owned()))
    }
}

/// A baked model.
pub struct Model(pub Box<dyn io::StoredModel<Vertex>>);

impl Model {
    /// Reads a baked file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        io::read_model(path).map(Self).map_err(|error| files::baked(path, &error))
    }

    /// Returns the vertices in the structure's order.
    pub fn vertices(&self) -> &Mesh {
        self.0.vertices()
    }

    /// Returns the diagonal of the box around the full resolution.
    pub fn diagonal(&self) -> f64 {
        let [low, high] = self.0.bounds().unwrap_or_default();
        (0..3).map(|i| (f64::from(high[i]) - f64::from(low[i])).powi(2)).sum::<f64>().sqrt()
    }

    /// Makes an instance.
    pub fn instance(&self, style: &Style, options: LodOptions) -> Result<Box<dyn Lod>, Failure> {
        style.check(self)?;
        let vertices = self.vertices();
        let normals = normals(vertices);
        let vertex = |(i, &position): (usize, &[f32; 3])| [position, normals.map_or([0.0; 3], |n| n[i])];
        let values: Vec<Vertex> = vertices.positions().iter().enumerate().map(vertex).collect();
        let values = multires::lod::Values::from(values).with_blending();
        let options = options.with_triangulation(style.triangulation());
        self.0.instance(&values, &options).map_err(Failure::input)
    }

    /// Returns the bytes written for a vertex coming into use: position and all attributes.
    pub fn bytes_per_vertex(&self) -> usize {
        rules::bytes_per_vertex(self.vertices())
    }
}

/// Returns the normals of all vertices, if there are any.
fn normals(mesh: &Mesh) -> Option<&[[f32; 3]]> {
    let attribute = mesh.attribute(names::NORMAL).filter(|attribute| attribute.width() == 3)?;
    match attribute.values() {
        AttributeValues::Float(values) => bytemuck::try_cast_slice(values).ok(),
        _ => None,
    }
}
