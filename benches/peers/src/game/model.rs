//! A model as every contender gets it: one array of vertices with position, normal, texture coordinate and colour, split
//! where any of them differs and between materials, as a game's file stores them. Skin joints and weights come along.
//!
//! What only the other simplifier needs is made beforehand and is not timed: interleaved attributes, and the arrays in
//! which mirrored texture coordinates are split, with the vertices of texture seams and material borders protected.

use std::error::Error;
use std::path::Path;

use meshopt::SimplifyVertex;
use multires::mesh::{Attribute, AttributeValues, Mesh, Topology, names};
use multires::simplify::AttributeWeights;

use super::picture::units_per_uv;

/// A named model.
pub(crate) struct Model {
    pub name: String,
    /// Every vertex is of one material, no two are equal, each is used.
    pub mesh: Mesh,
    /// Material of every vertex; empty where the mesh has none.
    pub material_of: Vec<u32>,
    /// What the other simplifier's permissive mode gets.
    pub protected: Protected,
    /// What attributes weigh for ours.
    pub weights: AttributeWeights,
}

/// The mesh with its vertices split where texture coordinates are mirrored.
pub(crate) struct Protected {
    pub triangles: Vec<[u32; 3]>,
    /// The mesh's vertex that each is a copy of.
    pub vertex_of: Vec<u32>,
    pub locks: Vec<SimplifyVertex>,
}

/// Attributes that take part; others are left behind.
const CARRIED: [&str; 5] = [names::NORMAL, names::UV, names::COLOR, names::JOINTS, names::WEIGHTS];

/// Reads a file of any format that multires reads.
pub(crate) fn read(path: &Path) -> Result<Model, Box<dyn Error>> {
    let stem = path.file_stem().ok_or("not a file name")?.to_string_lossy();
    let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let name = match folder {
        Some(folder) if stem == "scene" => folder,
        _ => stem.into_owned(),
    };
    Model::new(&name, &multires::io::read(path)?)
}

impl Model {
    /// A model of a mesh. Triangles with two corners at the same place are left out.
    ///
    /// # Errors
    /// Nothing is left.
    pub(crate) fn new(name: &str, mesh: &Mesh) -> Result<Self, Box<dyn Error>> {
        let mut bare = Mesh::new(mesh.positions(), mesh.triangles())?;
        for attribute in mesh.attributes().iter().filter(|a| CARRIED.contains(&a.name())) {
            bare = bare.with_attribute(attribute.clone())?;
        }
        let topology = Topology::new(&bare);
        let (points, wedges) = (topology.point_of(), topology.wedge_of());
        let kept = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            a != b && b != c && c != a
        };
        let materials = |triangle: usize| mesh.materials().get(triangle).copied().unwrap_or(0);

        // A vertex for every pair of wedge and material, in the order in which they are met.
        let mut pairs = Vec::new();
        for (triangle, corners) in mesh.triangles().iter().enumerate().filter(|(_, t)| kept(t)) {
            pairs.extend(corners.map(|v| (wedges[v as usize], materials(triangle))));
        }
        if pairs.is_empty() {
            return Err("no triangle has three corners".into());
        }
        let mut distinct = pairs.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let number = |pair: &(u32, u32)| distinct.binary_search(pair).unwrap_or(0) as u32;
        let triangles: Vec<[u32; 3]> =
            pairs.chunks_exact(3).map(|t| [number(&t[0]), number(&t[1]), number(&t[2])]).collect();
        let vertices: Vec<u32> = distinct.iter().map(|pair| pair.0).collect();
        let mut split = gather(&bare, &vertices, &[], triangles)?;
        let mut material_of = Vec::new();
        if !mesh.materials().is_empty() {
            material_of = distinct.iter().map(|pair| pair.1).collect();
            let ids: Vec<u32> = split.triangles().iter().map(|t| material_of[t[0] as usize]).collect();
            split = split.with_materials(ids)?;
        }
        let protected = Protected::new(&split, &material_of);
        let weights = AttributeWeights::default();
        Ok(Self { name: name.to_owned(), mesh: split, material_of, protected, weights })
    }

    /// With these weights of normals, of a texture that slides and of colours, in place of the customary ones.
    pub(crate) fn with_weights(mut self, [normal, slide, colour]: [f32; 3]) -> Self {
        let units = units_per_uv(&self.mesh) / self.mesh.diagonal();
        let weights = [(names::NORMAL, normal), (names::UV, slide * units as f32), (names::COLOR, colour)];
        let here = weights.iter().filter(|(name, _)| self.mesh.attribute(name).is_some());
        self.weights =
            AttributeWeights::Chosen(here.map(|&(name, weight)| (name.to_owned(), weight)).collect());
        self
    }

    /// Triangles on the mesh's vertices as a mesh of its own, each with the material of its vertices.
    pub(crate) fn subset(&self, triangles: Vec<[u32; 3]>) -> Result<Mesh, Box<dyn Error>> {
        let mut used = vec![false; self.mesh.positions().len()];
        triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
        let vertices: Vec<u32> = (0..used.len() as u32).filter(|&v| used[v as usize]).collect();
        let mut number = vec![0; used.len()];
        vertices.iter().enumerate().for_each(|(new, &old)| number[old as usize] = new as u32);
        let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        gather(&self.mesh, &vertices, &self.material_of, triangles)
    }
}

/// The mesh with these of its vertices, in this order, and triangles on them. A triangle has its first vertex's material.
pub(crate) fn gather(
    mesh: &Mesh,
    vertices: &[u32],
    material_of: &[u32],
    triangles: Vec<[u32; 3]>,
) -> Result<Mesh, Box<dyn Error>> {
    let positions: Vec<[f32; 3]> = vertices.iter().map(|&v| mesh.positions()[v as usize]).collect();
    let materials: Vec<u32> = match material_of {
        [] => Vec::new(),
        _ => triangles.iter().map(|t| material_of[vertices[t[0] as usize] as usize]).collect(),
    };
    let mut result = Mesh::new(positions, triangles)?.with_materials(materials)?;
    for attribute in mesh.attributes() {
        let values = match attribute.values() {
            AttributeValues::Float(values) => {
                AttributeValues::Float(pick(values, attribute.width(), vertices))
            }
            AttributeValues::Int(values) => AttributeValues::Int(pick(values, attribute.width(), vertices)),
            AttributeValues::Uint(values) => AttributeValues::Uint(pick(values, attribute.width(), vertices)),
            _ => continue,
        };
        result = result.with_attribute(Attribute::new(attribute.name(), attribute.width(), values))?;
    }
    Ok(result)
}

fn pick<T: Copy>(values: &[T], width: usize, vertices: &[u32]) -> Vec<T> {
    vertices.iter().flat_map(|&v| &values[v as usize * width..][..width]).copied().collect()
}

/// Floats of an attribute, where the mesh has it with that width.
pub(crate) fn floats<'a>(mesh: &'a Mesh, name: &str, width: usize) -> Option<&'a [f32]> {
    mesh.attribute(name).filter(|a| a.width() == width).and_then(|a| a.as_floats())
}

/// Twice the signed area of a triangle's texture coordinates.
pub(crate) fn uv_area(uv: &[f32], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| [0, 1].map(|i| f64::from(uv[2 * v as usize + i])));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Protected {
    fn new(mesh: &Mesh, material_of: &[u32]) -> Self {
        let uv = floats(mesh, names::UV, 2);
        // Vertices of triangles of both orientations are split: the later half stands for the mirrored triangles.
        let count = mesh.positions().len();
        let mirrored: Vec<bool> =
            mesh.triangles().iter().map(|&t| uv.is_some_and(|uv| uv_area(uv, t) < 0.0)).collect();
        let mut sides = vec![[false; 2]; count];
        for (t, &mirrored) in mesh.triangles().iter().zip(&mirrored) {
            t.iter().for_each(|&v| sides[v as usize][usize::from(mirrored)] = true);
        }
        let mut vertex_of: Vec<u32> = (0..count as u32).collect();
        let mut twin: Vec<u32> = vertex_of.clone();
        for v in 0..count as u32 {
            if sides[v as usize] == [true; 2] {
                twin[v as usize] = vertex_of.len() as u32;
                vertex_of.push(v);
            }
        }
        let triangles = mesh.triangles().iter().zip(&mirrored);
        let triangles =
            triangles.map(|(t, &mirrored)| t.map(|v| if mirrored { twin[v as usize] } else { v })).collect();

        // A point whose vertices differ in texture coordinate or material, or that was split, is protected.
        let topology = Topology::new(mesh);
        let points = topology.point_of();
        let value = |v: u32| {
            let at = uv.map(|uv| [uv[2 * v as usize], uv[2 * v as usize + 1]].map(f32::to_bits));
            (at, material_of.get(v as usize).copied())
        };
        let mut protected = vec![false; topology.point_count()];
        for v in 0..count as u32 {
            let point = points[v as usize];
            let first = topology.vertex_of_point()[point as usize];
            if value(v) != value(first) || twin[v as usize] != v {
                protected[point as usize] = true;
            }
        }
        let lock = |&v: &u32| match protected[points[v as usize] as usize] {
            true => SimplifyVertex::Protect,
            false => SimplifyVertex::None,
        };
        let locks = vertex_of.iter().map(lock).collect();
        Self { triangles, vertex_of, locks }
    }
}
