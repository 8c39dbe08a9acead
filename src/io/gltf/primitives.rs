//! Primitives of meshes to vertices and triangles of a [`Draft`].
//!
//! ```text
//!     meshes --> Plan: streams, and the accessors of each primitive        once a mesh
//!     Plan, world transform --> Builder --> Draft                          once for each time a mesh is shown
//! ```

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3};
use gltf_json::mesh::{Mode, Primitive};
use gltf_json::validation::Checked;

use crate::io::draft::{Draft, Tally};
use crate::io::error::ReadError;
use crate::mesh::{Attribute, AttributeValues, names};

use super::accessor::Store;
use super::normals::{self, Surface};
use super::plan::{Part, Plan, Stream, Targets, is_surface};

/// The material ids of the triangles built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ids {
    /// Materials of the document; triangles without one get the number of materials.
    Material,
    /// Indices of primitives within their mesh.
    Primitive,
}

/// The mesh being built.
pub(super) struct Builder<'a> {
    store: &'a Store<'a>,
    plan: Plan,
    ids: Ids,
    has_materials: bool,
    /// Bytes and work that the result may still take.
    budget: u64,
    draft: Draft,
    repairs: normals::Repairs,
    loose: Tally,
    other_modes: Tally,
}

impl<'a> Builder<'a> {
    /// Starts a mesh of the meshes in `built`, which are there. `bytes`: size of the file.
    pub fn new(
        store: &'a Store<'a>,
        built: &BTreeSet<usize>,
        targets: Targets,
        ids: Ids,
        bytes: usize,
    ) -> Result<Self, ReadError> {
        let primitives = built.iter().flat_map(|&m| &store.document.meshes[m].primitives);
        Ok(Self {
            store,
            plan: Plan::new(store, built, targets)?,
            ids,
            has_materials: primitives.into_iter().any(|p| p.material.is_some()),
            // Legitimate scenes show a mesh many times, too.
            budget: (1 << 26) + 64 * (bytes as u64 + store.bytes() as u64),
            draft: Draft::default(),
            repairs: normals::Repairs::default(),
            loose: Tally::default(),
            other_modes: Tally::default(),
        })
    }

    /// Ends the mesh; returns it with the plan it was built by.
    pub fn finish(self) -> (Draft, Plan) {
        let Self { store, mut plan, mut draft, loose, other_modes, repairs, .. } = self;
        other_modes.note("primitives are no triangles and are left out", "mesh", &mut draft.notes);
        loose.note("primitives have corners that make no whole triangle", "mesh", &mut draft.notes);
        repairs.note(&mut draft.notes);
        draft.material_names = store.document.materials.iter().map(|m| m.name.clone()).collect();
        let take = |s: &mut Stream| {
            let values = std::mem::replace(&mut s.values, AttributeValues::Float(Vec::new()));
            Attribute::new(s.name.clone(), s.width, values)
        };
        draft.attributes = plan.streams.iter_mut().map(take).collect();
        (draft, plan)
    }

    /// Adds all primitives of a mesh.
    pub fn add(&mut self, mesh: usize, world: DMat4) -> Result<(), ReadError> {
        let document = self.store.document;
        let count = document.meshes[mesh].primitives.len();
        self.spend(64_usize.saturating_mul(count))?;
        let mut shared: Vec<Option<(usize, usize)>> = vec![None; count];
        let (vertices, triangles) = (self.draft.positions.len(), self.draft.triangles.len());
        for (p, primitive) in document.meshes[mesh].primitives.iter().enumerate() {
            let parts = &self.plan.meshes[&mesh];
            let (Some(Some(part)), Some(&first)) = (parts.primitives.get(p), parts.first_like.get(p)) else {
                self.other_modes.add(mesh);
                continue;
            };
            let (base, count) = match shared[first] {
                Some(known) => known,
                None => {
                    let part = part.clone();
                    *shared[first].insert(self.vertices(mesh, &part, world)?)
                }
            };
            let before = self.draft.triangles.len();
            if is_surface(primitive) {
                self.triangles(mesh, p, primitive, base, count)?;
            }
            if world.determinant() < 0.0 {
                self.draft.triangles[before..].iter_mut().for_each(|t| t.swap(1, 2));
            }
            self.material(mesh, p, primitive)?;
        }
        self.mend_normals(mesh, &shared, vertices, triangles);
        Ok(())
    }

    fn material(&mut self, mesh: usize, p: usize, primitive: &Primitive) -> Result<(), ReadError> {
        let materials = self.store.document.materials.len();
        let material = primitive.material.map(|m| m.value());
        if let Some(id) = material.filter(|&id| id >= materials) {
            return Err(ReadError::invalid(format!(
                "mesh {mesh} names material {id}, but there are {materials}"
            )));
        }
        let id = match self.ids {
            Ids::Material if !self.has_materials => return Ok(()),
            Ids::Material => material.unwrap_or(materials) as u32,
            Ids::Primitive => p as u32,
        };
        self.draft.materials.resize(self.draft.triangles.len(), id);
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
    fn vertices(&mut self, mesh: usize, part: &Part, world: DMat4) -> Result<(usize, usize), ReadError> {
        let (base, count) = (self.draft.positions.len(), self.store.count(part.position)?);
        if self.store.shape(part.position)?.width != 3 {
            return Err(ReadError::invalid(format!("mesh {mesh} has positions that are not of type VEC3")));
        }
        let width: usize = self.plan.streams.iter().map(|s| s.width).sum();
        self.spend(count.saturating_mul(2 * (24 + 4 * width)))?;
        let replaced = part.inputs.iter().map(|input| self.store.replaced(input.0));
        let replaced = replaced.fold(self.store.replaced(part.position), usize::saturating_add);
        self.spend(replaced.saturating_mul(64).saturating_add(64 * part.inputs.len()))?;
        self.draft.positions.resize(base + count, [0.0; 3]);
        self.plan.streams.iter_mut().for_each(|s| s.grow(base + count));
        self.store.values(part.position, |v, axis, value| self.draft.positions[base + v][axis] = value)?;
        let is_moved = world != DMat4::IDENTITY;
        if is_moved {
            for p in &mut self.draft.positions[base..] {
                *p = world.transform_point3(DVec3::from_array(*p)).to_array();
            }
        }
        for &(accessor, stream) in &part.inputs {
            let stream = &mut self.plan.streams[stream];
            let found = self.store.count(accessor)?;
            if found != count {
                let what =
                    format!("mesh {mesh} has {found} values of {:?} for {count} positions", stream.name);
                return Err(ReadError::invalid(what));
            }
            self.store.values(accessor, |v, component, value| stream.put(base + v, component, value))?;
            if is_moved {
                turn(stream, base, world);
            }
        }
        Ok((base, count))
    }

    /// Gives normals to the vertices of a mesh that lack them or whose normals are no directions. `shared`: first vertex
    /// and number of vertices of primitives; `vertices` and `triangles`: the first of the mesh.
    fn mend_normals(
        &mut self,
        mesh: usize,
        shared: &[Option<(usize, usize)>],
        vertices: usize,
        triangles: usize,
    ) {
        let Self { plan, draft, repairs, .. } = self;
        let Some(at) = plan.streams.iter().position(|s| s.name == names::NORMAL && s.width == 3) else {
            return;
        };
        let AttributeValues::Float(values) = &mut plan.streams[at].values else { return };
        let surface = Surface::new(&draft.positions[vertices..], &draft.triangles[triangles..], vertices);
        for (part, &range) in plan.meshes[&mesh].primitives.iter().zip(shared) {
            let (Some(part), Some((base, count))) = (part, range) else { continue };
            let is_there = part.inputs.iter().any(|input| input.1 == at);
            repairs.mend(mesh, is_there, &mut values[3 * base..3 * (base + count)], base, &surface);
        }
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
            let work = length.saturating_add(self.store.replaced(accessor));
            self.spend(work.saturating_mul(2 * 16))?;
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
