//! What meshes to build consist of: streams of attributes, and the accessors of each primitive. Found once a mesh, however
//! often it is shown.

use std::collections::{BTreeMap, BTreeSet};

use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use crate::io::error::ReadError;
use crate::mesh::{AttributeValues, names};

use super::accessor::Store;
use super::semantics::{attribute, attributes, displacement};

/// Most attributes. Every attribute gets a value for every vertex, so many attributes in small primitives would
/// multiply the file's size.
const MAX_STREAMS: usize = 64;

/// Whether a primitive is triangles. If a document has points alone, as those that this crate writes for meshes without
/// triangles, they are read as vertices: see [`is_cloud`].
pub(super) fn is_surface(primitive: &Primitive) -> bool {
    use Mode::{TriangleFan, TriangleStrip, Triangles};
    let has_positions = primitive.attributes.contains_key(&Checked::Valid(Semantic::Positions));
    has_positions && matches!(primitive.mode, Checked::Valid(Triangles | TriangleStrip | TriangleFan))
}

/// Whether a primitive is points, one a vertex.
fn is_cloud(primitive: &Primitive) -> bool {
    let has_positions = primitive.attributes.contains_key(&Checked::Valid(Semantic::Positions));
    has_positions && primitive.mode == Checked::Valid(Mode::Points) && primitive.indices.is_none()
}

/// An attribute of the mesh being built.
#[derive(Debug)]
pub(super) struct Stream {
    /// Name of the mesh's attribute.
    pub name: String,
    pub width: usize,
    pub values: AttributeValues,
}

impl Stream {
    pub fn grow(&mut self, vertices: usize) {
        let length = vertices * self.width;
        match &mut self.values {
            // Where a colour is missing it is white; other attributes are 0.
            AttributeValues::Float(values) if names::is_set_of(&self.name, names::COLOR) => {
                values.resize(length, 1.0);
            }
            AttributeValues::Float(values) => values.resize(length, 0.0),
            AttributeValues::Int(values) => values.resize(length, 0),
            AttributeValues::Uint(values) => values.resize(length, 0),
        }
    }

    pub fn put(&mut self, vertex: usize, component: usize, value: f64) {
        if component >= self.width {
            return;
        }
        let at = vertex * self.width + component;
        match &mut self.values {
            AttributeValues::Float(values) => values[at] = value as f32,
            AttributeValues::Int(values) => values[at] = value as i32,
            AttributeValues::Uint(values) => values[at] = value as u32,
        }
    }
}

/// A primitive to build: the accessors of its positions, and of its other attributes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Part {
    pub position: usize,
    /// Accessor, and index of its stream.
    pub inputs: Vec<(usize, usize)>,
}

/// A mesh to build.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// Each primitive of the mesh; `None` if it is no surface.
    pub primitives: Vec<Option<Part>>,
    /// For each primitive the first with equal accessors: they share vertices.
    pub first_like: Vec<usize>,
}

/// What the meshes to build consist of.
pub(super) struct Plan {
    pub streams: Vec<Stream>,
    /// The meshes to build, by index.
    pub meshes: BTreeMap<usize, Parts>,
}

/// Displacements of morph targets: for a mesh and a primitive the accessors of each target by semantic.
pub(super) type Targets<'a> = &'a dyn Fn(usize, usize) -> Vec<BTreeMap<String, usize>>;

impl Plan {
    /// Looks at all primitives of the meshes to build. O(n log n) in their accessors.
    pub fn new(store: &Store, built: &BTreeSet<usize>, targets: Targets) -> Result<Self, ReadError> {
        // Sorted by the names in the file, displacements last.
        let mut found: BTreeMap<(usize, String), Stream> = BTreeMap::new();
        let mut keyed: Vec<(usize, Vec<Option<Keyed>>)> = Vec::with_capacity(built.len());
        let all = || built.iter().flat_map(|&m| &store.document.meshes[m].primitives);
        let clouds = !all().any(is_surface) && all().all(is_cloud);
        for &m in built {
            let mut primitives = Vec::new();
            for (p, primitive) in store.document.meshes[m].primitives.iter().enumerate() {
                let is_built = clouds || is_surface(primitive);
                let keyed = is_built.then(|| Keyed::new(store, primitive, &targets(m, p), &mut found));
                primitives.push(keyed.transpose()?.flatten());
            }
            keyed.push((m, primitives));
        }
        let own = found.keys().filter(|key| key.0 == 0).count();
        if own > MAX_STREAMS {
            return Err(ReadError::unsupported(format!(
                "{own} different attributes, more than {MAX_STREAMS}"
            )));
        }
        let place: BTreeMap<&(usize, String), usize> =
            found.keys().enumerate().map(|(i, key)| (key, i)).collect();
        let part = |keyed: Keyed| Part {
            position: keyed.position,
            inputs: keyed.inputs.iter().map(|(accessor, key)| (*accessor, place[key])).collect(),
        };
        let mut meshes = BTreeMap::new();
        for (m, primitives) in keyed {
            let primitives: Vec<Option<Part>> = primitives.into_iter().map(|p| p.map(part)).collect();
            let mut first: BTreeMap<&Part, usize> = BTreeMap::new();
            let first_like = primitives.iter().enumerate();
            let first_like =
                first_like.map(|(p, part)| part.as_ref().map_or(p, |part| *first.entry(part).or_insert(p)));
            let first_like = first_like.collect();
            meshes.insert(m, Parts { primitives, first_like });
        }
        Ok(Self { streams: found.into_values().collect(), meshes })
    }
}

/// A primitive with its attributes by name.
struct Keyed {
    position: usize,
    /// Accessor, and key of its stream.
    inputs: Vec<(usize, (usize, String))>,
}

impl Keyed {
    /// Adds the streams of a primitive, each with its largest width; floats if primitives differ in type.
    fn new(
        store: &Store,
        primitive: &Primitive,
        targets: &[BTreeMap<String, usize>],
        found: &mut BTreeMap<(usize, String), Stream>,
    ) -> Result<Option<Self>, ReadError> {
        let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let Some(position) = position else { return Ok(None) };
        let mut inputs = Vec::new();
        let mut add = |key: (usize, String), accessor: usize, stream: Stream| {
            inputs.push((accessor, key.clone()));
            let Stream { name, width, values } = stream;
            let known = found.entry(key).or_insert(Stream { name, width, values: values.clone() });
            known.width = known.width.max(width);
            if std::mem::discriminant(&known.values) != std::mem::discriminant(&values) {
                known.values = AttributeValues::Float(Vec::new());
            }
        };
        for (semantic, accessor) in attributes(primitive) {
            let Some((name, width, values)) = attribute(semantic, store.shape(accessor)?) else { continue };
            add((0, semantic.to_string()), accessor, Stream { name, width, values });
        }
        for (t, target) in targets.iter().enumerate() {
            for (semantic, &accessor) in target {
                let width = store.shape(accessor)?.width;
                let values = AttributeValues::Float(Vec::new());
                add(
                    (1 + t, semantic.clone()),
                    accessor,
                    Stream { name: displacement(t, semantic), width, values },
                );
            }
        }
        Ok(Some(Self { position: position.value(), inputs }))
    }
}
