//! Primitives to a mesh.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat3, DMat4, DVec3};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use crate::io::draft::{Draft, Tally};
use crate::io::error::ReadError;
use crate::mesh::{Attribute, AttributeValues, names};

use super::accessor::Store;
use super::document::{self, Document};
use super::scene;
use super::semantics::{attribute, attributes};

/// Reads a whole file; external buffers are read from `directory`. O(n) in file and result. The result is bounded by a
/// multiple of the bytes read, for any number of instances of a mesh.
pub(in crate::io) fn read(bytes: &[u8], directory: Option<&Path>) -> Result<Draft, ReadError> {
    let (document, chunk) = document::parse(bytes)?;
    let buffers = document::buffers(&document, chunk, directory)?;
    let store = Store::new(&document, &buffers);
    let instances = scene::instances(&document)?;
    let mut shown = vec![false; document.meshes.len()];
    instances.iter().for_each(|instance| shown[instance.mesh] = true);

    let mut builder = Builder {
        store: &store,
        streams: streams(&document, &store, &shown)?,
        draft: Draft::default(),
        has_materials: primitives(&document, &shown).any(|(_, p)| p.material.is_some()),
        // 64 MiB plus a generous multiple: legitimate scenes show a mesh many times, too.
        budget: (1 << 26) + 256 * (bytes.len() as u64 + store.bytes() as u64),
        loose: Tally::default(),
        other_modes: Tally::default(),
    };
    for instance in &instances {
        builder.add(instance.mesh, instance.world)?;
    }
    let Builder { mut draft, streams, loose, other_modes, .. } = builder;
    other_modes.note("primitives are no triangles and are left out", "mesh", &mut draft.notes);
    loose.note("primitives have corners that make no whole triangle", "mesh", &mut draft.notes);
    draft.material_names = document.materials.iter().map(|m| m.name.clone()).collect();
    draft.attributes = streams.into_iter().map(|s| Attribute::new(s.name, s.width, s.values)).collect();
    Ok(draft)
}

/// Returns all primitives of the meshes shown, with the index of the mesh.
fn primitives<'a>(document: &'a Document, shown: &'a [bool]) -> impl Iterator<Item = (usize, &'a Primitive)> {
    let meshes = document.meshes.iter().enumerate().filter(|(i, _)| shown[*i]);
    meshes.flat_map(|(i, mesh)| mesh.primitives.iter().map(move |p| (i, p)))
}

fn is_surface(primitive: &Primitive) -> bool {
    use Mode::{TriangleFan, TriangleStrip, Triangles};
    matches!(primitive.mode, Checked::Valid(Triangles | TriangleStrip | TriangleFan))
}

/// An attribute of the whole mesh being read.
struct Stream {
    name: String,
    width: usize,
    values: AttributeValues,
}

impl Stream {
    fn grow(&mut self, vertices: usize) {
        let length = vertices * self.width;
        match &mut self.values {
            AttributeValues::Float(values) => values.resize(length, 0.0),
            AttributeValues::Int(values) => values.resize(length, 0),
            AttributeValues::Uint(values) => values.resize(length, 0),
        }
    }

    fn put(&mut self, vertex: usize, component: usize, value: f64) {
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

/// Returns the attributes present in any primitive, each with its largest width; floats if primitives differ in type.
fn streams(document: &Document, store: &Store, shown: &[bool]) -> Result<Vec<Stream>, ReadError> {
    // Sorted by the names in the file.
    let mut found: BTreeMap<String, Stream> = BTreeMap::new();
    for (_, primitive) in primitives(document, shown).filter(|(_, p)| is_surface(p)) {
        for (semantic, accessor) in attributes(primitive) {
            let Some((name, width, values)) = attribute(semantic, store.shape(accessor)?) else { continue };
            let stream = found.entry(semantic.to_string()).or_insert_with(|| Stream {
                name,
                width,
                values: values.clone(),
            });
            stream.width = stream.width.max(width);
            if std::mem::discriminant(&stream.values) != std::mem::discriminant(&values) {
                stream.values = AttributeValues::Float(Vec::new());
            }
        }
    }
    if found.len() > MAX_STREAMS {
        return Err(ReadError::unsupported(format!(
            "{} different attributes, more than {MAX_STREAMS}",
            found.len()
        )));
    }
    Ok(found.into_values().collect())
}

/// Most attributes. Every attribute gets a value for every vertex, so many attributes in small primitives would
/// multiply the file's size.
const MAX_STREAMS: usize = 64;

/// The accessors of a primitive: primitives with equal accessors share vertices.
type Accessors = BTreeMap<Checked<Semantic>, Index<Accessor>>;

struct Builder<'a> {
    store: &'a Store<'a>,
    streams: Vec<Stream>,
    draft: Draft,
    has_materials: bool,
    budget: u64,
    loose: Tally,
    other_modes: Tally,
}

impl<'a> Builder<'a> {
    /// Adds all primitives of a mesh.
    fn add(&mut self, mesh: usize, world: DMat4) -> Result<(), ReadError> {
        let document = self.store.document;
        let mut shared: BTreeMap<&Accessors, (usize, usize)> = BTreeMap::new();
        for (p, primitive) in document.meshes[mesh].primitives.iter().enumerate() {
            self.spend(64)?;
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            let (true, Some(position)) = (is_surface(primitive), position) else {
                self.other_modes.add(mesh);
                continue;
            };
            let (base, count) = match shared.get(&primitive.attributes) {
                Some(&known) => known,
                None => {
                    let added = self.vertices(mesh, primitive, position.value(), world)?;
                    shared.insert(&primitive.attributes, added);
                    added
                }
            };
            let before = self.draft.triangles.len();
            self.triangles(mesh, p, primitive, base, count)?;
            if world.determinant() < 0.0 {
                self.draft.triangles[before..].iter_mut().for_each(|t| t.swap(1, 2));
            }
            let materials = document.materials.len();
            let material = primitive.material.map(|m| m.value());
            if let Some(id) = material.filter(|&id| id >= materials) {
                return Err(ReadError::invalid(format!(
                    "mesh {mesh} names material {id}, but there are {materials}"
                )));
            }
            if self.has_materials {
                let id = material.unwrap_or(materials) as u32;
                self.draft.materials.resize(self.draft.triangles.len(), id);
            }
        }
        Ok(())
    }

    /// Counts bytes of the result against the budget: twice its size, as arrays grow by doubling.
    fn spend(&mut self, bytes: usize) -> Result<(), ReadError> {
        let left = self.budget.checked_sub(bytes as u64);
        self.budget = left
            .ok_or_else(|| ReadError::too_large("the scene shows its meshes too many times for its size"))?;
        Ok(())
    }

    /// Adds the vertices of a primitive; returns the first vertex and their number.
    fn vertices(
        &mut self,
        mesh: usize,
        primitive: &Primitive,
        position: usize,
        world: DMat4,
    ) -> Result<(usize, usize), ReadError> {
        let (base, count) = (self.draft.positions.len(), self.store.count(position)?);
        if self.store.shape(position)?.width != 3 {
            return Err(ReadError::invalid(format!("mesh {mesh} has positions that are not of type VEC3")));
        }
        let width: usize = self.streams.iter().map(|s| s.width).sum();
        self.spend(count.saturating_mul(2 * (24 + 4 * width)))?;
        self.draft.positions.resize(base + count, [0.0; 3]);
        self.streams.iter_mut().for_each(|s| s.grow(base + count));
        self.store.values(position, |v, axis, value| self.draft.positions[base + v][axis] = value)?;
        let is_moved = world != DMat4::IDENTITY;
        if is_moved {
            for p in &mut self.draft.positions[base..] {
                *p = world.transform_point3(DVec3::from_array(*p)).to_array();
            }
        }
        for (semantic, accessor) in attributes(primitive) {
            let shape = self.store.shape(accessor)?;
            let Some((name, ..)) = attribute(semantic, shape) else { continue };
            let Some(stream) = self.streams.iter_mut().find(|s| s.name == name) else { continue };
            let found = self.store.count(accessor)?;
            if found != count {
                let semantic = semantic.to_string();
                let what = format!("mesh {mesh} has {found} values of {semantic} for {count} positions");
                return Err(ReadError::invalid(what));
            }
            if name.starts_with(names::COLOR) && shape.width == 3 {
                // Without alpha: opaque.
                (0..count).for_each(|v| stream.put(base + v, 3, 1.0));
            }
            self.store.values(accessor, |v, component, value| stream.put(base + v, component, value))?;
            if is_moved {
                turn(stream, base, world);
            }
        }
        Ok((base, count))
    }

    /// Adds the triangles of a primitive with vertices `base..base + count`.
    fn triangles(
        &mut self,
        mesh: usize,
        p: usize,
        primitive: &Primitive,
        base: usize,
        count: usize,
    ) -> Result<(), ReadError> {
        let mut corners: Vec<u32> = Vec::new();
        if let Some(accessor) = primitive.indices {
            let accessor = accessor.value();
            let shape = self.store.shape(accessor)?;
            if shape.width != 1 || shape.is_float() || shape.is_signed() {
                return Err(ReadError::invalid(format!(
                    "mesh {mesh} primitive {p} has indices of no index type"
                )));
            }
            let length = self.store.count(accessor)?;
            self.spend(length.saturating_mul(2 * 16))?;
            corners.resize(length, 0);
            let mut beyond = None;
            self.store.values(accessor, |i, _, value| {
                let index = value as usize;
                if index >= count {
                    beyond = beyond.or(Some((i, index)));
                }
                corners[i] = (base + index) as u32;
            })?;
            if let Some((i, index)) = beyond {
                let what = format!(
                    "mesh {mesh} primitive {p}: index {i} names vertex {index}, but there are {count} vertices"
                );
                return Err(ReadError::invalid(what));
            }
        } else {
            self.spend(count.saturating_mul(2 * 16))?;
            corners.extend((base..base + count).map(|v| v as u32));
        }
        let triangles = &mut self.draft.triangles;
        let distinct = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        match primitive.mode {
            Checked::Valid(Mode::Triangles) => {
                if !corners.len().is_multiple_of(3) {
                    self.loose.add(mesh);
                }
                triangles.extend(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]));
            }
            // Degenerate triangles of a strip only move it to another place.
            Checked::Valid(Mode::TriangleStrip) => {
                let strip = corners.windows(3).enumerate();
                triangles.extend(strip.map(|(i, c)| [c[i % 2], c[1 - i % 2], c[2]]).filter(distinct));
            }
            _ => {
                let first = corners.first().copied().unwrap_or_default();
                triangles
                    .extend(corners.get(1..).unwrap_or_default().windows(2).map(|c| [first, c[0], c[1]]));
            }
        }
        Ok(())
    }
}

/// Transforms normals and tangents from vertex `first` on to world space: normals by the inverse transpose, tangents as
/// directions in the surface. A mirror flips the handedness of tangents.
fn turn(stream: &mut Stream, first: usize, world: DMat4) {
    let linear = DMat3::from_mat4(world);
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    // The inverse transpose up to scale: exists for flat transforms too.
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
    let matrix = match stream.name.as_str() {
        names::NORMAL => cofactor,
        names::TANGENT => linear,
        _ => return,
    };
    let AttributeValues::Float(values) = &mut stream.values else { return };
    for value in values[first * stream.width..].chunks_exact_mut(stream.width) {
        let turned = matrix * DVec3::new(f64::from(value[0]), f64::from(value[1]), f64::from(value[2]));
        let unit = turned.normalize_or_zero().to_array();
        value.iter_mut().zip(unit).for_each(|(x, turned)| *x = turned as f32);
        if let Some(hand) = value.get_mut(3) {
            *hand *= sign as f32;
        }
    }
}
