//! Who takes part. A contender is a name and a function; the function alone is timed, from arrays to arrays.
//!
//! The other simplifier gets the whole model at once, its materials apart as stored, rather than each primitive by itself
//! at the same ratio: so the error is balanced over the whole model for every contender alike.

use std::error::Error;

use meshopt::{SimplifyOptions, VertexDataAdapter};
use multires::mesh::{Attribute, AttributeValues, Mesh, names};
use multires::simplify::metric::LindstromTurk;
use multires::simplify::{ErrorMetric, Permissive, Placement, Simplifier, Target};

use super::model::{Model, floats, gather, uv_area};

/// A simplifier with its settings.
pub(crate) struct Contender {
    pub name: &'static str,
    /// Whether it is a setting of the other simplifier.
    pub peer: bool,
    /// Simplifies to at most that many triangles, as far as it goes.
    pub run: fn(&Model, usize) -> Outcome,
}

/// What a contender returns, or why it could not.
pub(crate) type Outcome = Result<Output, Box<dyn Error>>;

/// What a contender hands over, in its own form: turning it into a mesh is not timed.
pub(crate) enum Output {
    /// Triangles on the model's vertices.
    Indices(Vec<u32>),
    /// Triangles on the vertices of [`Protected`](super::model::Protected).
    Split(Vec<u32>),
    /// The same, with new positions and attributes, interleaved as [`Attributes`] says.
    Updated { indices: Vec<u32>, positions: Vec<[f32; 3]>, values: Vec<f32>, width: usize },
    /// A mesh of its own.
    Mesh(Box<Mesh>),
}

/// Every contender, in the order they run.
pub(crate) const CONTENDERS: &[Contender] = &[
    Contender { name: "meshopt", peer: true, run: plain },
    Contender { name: "meshopt-gltfpack", peer: true, run: |model, n| permissive(model, n, false) },
    Contender { name: "meshopt-uv", peer: true, run: |model, n| permissive(model, n, true) },
    Contender { name: "meshopt-update", peer: true, run: update },
    Contender { name: "default", peer: false, run: default },
    Contender { name: "permissive", peer: false, run: given_up },
    Contender { name: "optimal", peer: false, run: optimal },
    Contender { name: "lindstrom-turk", peer: false, run: lindstrom_turk },
];

/// Refuses names that no contender has.
pub(crate) fn check_names(names: &[String]) -> Result<(), String> {
    match names.iter().find(|name| CONTENDERS.iter().all(|c| c.name != name.as_str())) {
        Some(unknown) => {
            let known: Vec<&str> = CONTENDERS.iter().map(|c| c.name).collect();
            Err(format!("there is no contender {unknown:?}; there are: {}", known.join(", ")))
        }
        None => Ok(()),
    }
}

/// gltfpack's weight of normals.
const NORMAL: f32 = 0.5;
/// The weight of colours, which are of the same range as normals.
const COLOUR: f32 = 1.0;

/// Interleaved attributes of some vertices, with a weight for each scalar.
struct Attributes {
    values: Vec<f32>,
    weights: Vec<f32>,
}

impl Attributes {
    /// Normals and colours, and texture coordinates where wanted; as they follow in the mesh.
    fn new(mesh: &Mesh, vertex_of: &[u32], textured: bool) -> Self {
        let mut streams: Vec<(&[f32], usize, f32)> = Vec::new();
        for attribute in mesh.attributes() {
            let Some(values) = attribute.as_floats() else { continue };
            if let Some(weight) = weight(mesh, attribute, textured) {
                streams.push((values, attribute.width(), weight));
            }
        }
        let mut weights = Vec::new();
        streams.iter().for_each(|&(_, width, weight)| weights.extend(std::iter::repeat_n(weight, width)));
        let row = |&v: &u32| {
            let streams = &streams;
            streams
                .iter()
                .flat_map(move |&(values, width, _)| &values[v as usize * width..][..width])
                .copied()
        };
        Self { values: vertex_of.iter().flat_map(row).collect(), weights }
    }

    fn stride(&self) -> usize {
        self.weights.len() * size_of::<f32>()
    }
}

/// The weight of an attribute's scalars; none where it does not count.
fn weight(mesh: &Mesh, attribute: &Attribute, textured: bool) -> Option<f32> {
    match attribute.name() {
        names::NORMAL => Some(NORMAL),
        names::COLOR => Some(COLOUR),
        names::UV if textured && attribute.width() == 2 => Some(uv_weight(mesh)),
        _ => None,
    }
}

/// As its README advises: the inverse root of a triangle's mean area in texture coordinates.
fn uv_weight(mesh: &Mesh) -> f32 {
    let Some(uv) = floats(mesh, names::UV, 2) else { return 0.0 };
    let area: f64 = mesh.triangles().iter().map(|&t| 0.5 * uv_area(uv, t).abs()).sum();
    let mean = area / mesh.triangles().len() as f64;
    if mean > 0.0 { (1.0 / mean.sqrt()) as f32 } else { 0.0 }
}

fn adapter(positions: &[[f32; 3]]) -> Result<VertexDataAdapter<'_>, meshopt::Error> {
    VertexDataAdapter::new(meshopt::typed_to_bytes(positions), size_of::<[f32; 3]>(), 0)
}

/// Positions alone, seams kept.
fn plain(model: &Model, triangles: usize) -> Outcome {
    let vertices = adapter(model.mesh.positions())?;
    let (indices, options) = (model.mesh.indices(), SimplifyOptions::None);
    Ok(Output::Indices(meshopt::simplify(indices, &vertices, triangles * 3, f32::MAX, options, None)))
}

/// As gltfpack does it; with the texture coordinates' weight where wanted.
fn permissive(model: &Model, triangles: usize, textured: bool) -> Outcome {
    let split = &model.protected;
    let positions: Vec<[f32; 3]> =
        split.vertex_of.iter().map(|&v| model.mesh.positions()[v as usize]).collect();
    let attributes = Attributes::new(&model.mesh, &split.vertex_of, textured);
    Ok(Output::Split(meshopt::simplify_with_attributes_and_locks(
        split.triangles.as_flattened(),
        &adapter(&positions)?,
        &attributes.values,
        &attributes.weights,
        attributes.stride(),
        &split.locks,
        triangles * 3,
        f32::MAX,
        SimplifyOptions::Prune | SimplifyOptions::Permissive,
        None,
    )))
}

/// The same with positions and attributes solved anew.
fn update(model: &Model, triangles: usize) -> Outcome {
    let split = &model.protected;
    let mut positions: Vec<[f32; 3]> =
        split.vertex_of.iter().map(|&v| model.mesh.positions()[v as usize]).collect();
    let mut attributes = Attributes::new(&model.mesh, &split.vertex_of, true);
    let mut indices = split.triangles.as_flattened().to_vec();
    let (stride, width) = (attributes.stride(), attributes.weights.len());
    let count = meshopt::simplify_with_update(
        &mut indices,
        &mut positions,
        &mut attributes.values,
        &attributes.weights,
        stride,
        Some(&split.locks),
        triangles * 3,
        f32::MAX,
        SimplifyOptions::Prune | SimplifyOptions::Permissive,
        None,
    );
    indices.truncate(count);
    Ok(Output::Updated { indices, positions, values: attributes.values, width })
}

fn default(model: &Model, triangles: usize) -> Outcome {
    fitted(model, Simplifier::new().target(Target::Triangles(triangles)))
}

fn given_up(model: &Model, triangles: usize) -> Outcome {
    fitted(model, Simplifier::new().permissive(Permissive::On).target(Target::Triangles(triangles)))
}

fn optimal(model: &Model, triangles: usize) -> Outcome {
    fitted(model, Simplifier::new().placement(Placement::Optimal).target(Target::Triangles(triangles)))
}

fn lindstrom_turk(model: &Model, triangles: usize) -> Outcome {
    let simplifier = Simplifier::new().metric(LindstromTurk::new()).placement(Placement::Optimal);
    fitted(model, simplifier.target(Target::Triangles(triangles)))
}

/// Simplifies, and fits the last level's attributes, as `multires simplify` does.
fn fitted<M: ErrorMetric>(model: &Model, simplifier: Simplifier<M>) -> Outcome {
    let mut simplifier = simplifier.attributes(model.weights.clone());
    let sequence = simplifier.run(&model.mesh)?;
    Ok(Output::Mesh(Box::new(sequence.extract_fitted(&model.mesh, sequence.len()))))
}

impl Output {
    /// As a mesh of its own.
    pub(crate) fn into_mesh(self, model: &Model) -> Result<Mesh, Box<dyn Error>> {
        let split = &model.protected.vertex_of;
        match self {
            Self::Indices(indices) => model.subset(chunks(&indices)),
            Self::Split(indices) => {
                let indices: Vec<u32> = indices.iter().map(|&v| split[v as usize]).collect();
                model.subset(chunks(&indices))
            }
            Self::Updated { indices, positions, values, width } => {
                updated(model, &indices, &positions, &values, width)
            }
            Self::Mesh(mesh) => Ok(*mesh),
        }
    }
}

fn chunks(indices: &[u32]) -> Vec<[u32; 3]> {
    indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()
}

/// The mesh of updated vertices; normals are brought back to unit length, as its user has to.
fn updated(
    model: &Model,
    indices: &[u32],
    positions: &[[f32; 3]],
    values: &[f32],
    width: usize,
) -> Result<Mesh, Box<dyn Error>> {
    let mut used: Vec<u32> = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.binary_search(&v).unwrap_or(0) as u32;
    let triangles = chunks(indices).iter().map(|t| t.map(number)).collect();
    let old: Vec<u32> = used.iter().map(|&v| model.protected.vertex_of[v as usize]).collect();
    let carried = gather(&model.mesh, &old, &model.material_of, triangles)?;

    let places: Vec<[f32; 3]> = used.iter().map(|&v| positions[v as usize]).collect();
    let mut mesh = Mesh::new(places, carried.triangles())?.with_materials(carried.materials())?;
    let mut first = 0;
    for attribute in carried.attributes() {
        let counted = attribute.as_floats().and_then(|_| weight(&model.mesh, attribute, true));
        if counted.is_none() {
            mesh = mesh.with_attribute(attribute.clone())?;
            continue;
        }
        let own = |&v: &u32| &values[v as usize * width + first..][..attribute.width()];
        let mut new: Vec<f32> = used.iter().flat_map(own).copied().collect();
        first += attribute.width();
        if attribute.name() == names::NORMAL {
            for normal in new.chunks_exact_mut(3) {
                let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
                if length > 0.0 {
                    normal.iter_mut().for_each(|x| *x /= length);
                }
            }
        }
        let values = AttributeValues::Float(new);
        mesh = mesh.with_attribute(Attribute::new(attribute.name(), attribute.width(), values))?;
    }
    Ok(mesh)
}
