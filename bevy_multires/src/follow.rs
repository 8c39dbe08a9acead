//! Meshes that follow the view: an instance for each entity, and its mesh made anew when the cut changes.

use std::sync::Arc;

use bevy::asset::{Assets, Handle};
use bevy::mesh::{Indices, Mesh};
use bevy::platform::cell::SyncCell;
use multires::lod::{Lod, LodError, LodOptions, Values};
use multires::view::ObjectView;

use crate::build::Following;
use crate::convert::{self, ConvertError};

/// An instance of an entity, and its mesh.
pub(crate) struct Follow {
    model: Arc<Following>,
    lod: SyncCell<Box<dyn Lod>>,
    /// Group of triangles drawn: one material.
    group: usize,
    /// Triangles of the group at full resolution.
    full: usize,
    triangles: usize,
    mesh: Option<Handle<Mesh>>,
    /// Made by [`Follow::adapt`], not handed to Bevy yet.
    made: Option<Mesh>,
}

impl Follow {
    /// Makes the instance, at the coarsest level.
    pub fn new(model: Arc<Following>, group: usize, full: usize) -> Result<Self, LodError> {
        let numbers: Vec<u32> = (0..model.model.vertex_count() as u32).collect();
        let lod = model.model.instance(&Values::from(numbers), &LodOptions::default())?;
        let lod = SyncCell::new(lod);
        Ok(Self { model, lod, group, full, triangles: 0, mesh: None, made: None })
    }

    /// Follows the views, and makes the mesh if the cut changed. May run on any thread.
    pub fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Result<(), ConvertError> {
        let lod = self.lod.get();
        let change = lod.adapt(views, seconds);
        let first = self.mesh.is_none() && self.made.is_none();
        if !first && change.cut.splits + change.cut.collapses == 0 {
            return Ok(());
        }
        lod.clean();
        let triangles = lod.triangles(self.group);
        self.triangles = triangles.len();
        self.made = Some(mesh_of(&self.model, triangles, bytemuck::cast_slice(lod.vertex_bytes()))?);
        Ok(())
    }

    /// Hands a mesh made by [`Follow::adapt`] to Bevy. Returns its bytes.
    pub fn hand_over(&mut self, meshes: &mut Assets<Mesh>) -> Option<usize> {
        let made = self.made.take()?;
        let bytes = byte_len(&made);
        match &self.mesh {
            // Nobody else removes the mesh while its handle is here.
            Some(own) => meshes.insert(own.id(), made).ok()?,
            None => self.mesh = Some(meshes.add(made)),
        }
        Some(bytes)
    }

    pub fn mesh(&self) -> Option<&Handle<Mesh>> {
        self.mesh.as_ref()
    }

    pub fn triangles(&self) -> usize {
        self.triangles
    }

    pub fn full_triangles(&self) -> usize {
        self.full
    }
}

/// Returns the mesh of a packed vertex buffer, whose values are numbers of vertices. A material's mesh holds the vertices that it uses.
fn mesh_of(model: &Following, triangles: &[[u32; 3]], vertices: &[u32]) -> Result<Mesh, ConvertError> {
    let mut slot = vec![u32::MAX; vertices.len()];
    let mut order = Vec::with_capacity(vertices.len());
    let mut corners = Vec::with_capacity(3 * triangles.len());
    for &corner in triangles.as_flattened() {
        let slot = &mut slot[corner as usize];
        if *slot == u32::MAX {
            *slot = order.len() as u32;
            order.push(vertices[corner as usize]);
        }
        corners.push(*slot);
    }
    if order.is_empty() {
        // Bevy allocates no empty buffers: a triangle without an area.
        order.extend(vertices.first());
        corners.extend(order.first().map(|_| [0; 3]).into_iter().flatten());
    }
    let mut mesh = convert::gather(&model.vertices, &order)?;
    mesh.try_insert_indices(convert::indices(&corners, model.short))?;
    Ok(mesh)
}

/// Returns the bytes that Bevy uploads for a mesh.
fn byte_len(mesh: &Mesh) -> usize {
    let indices = match mesh.try_indices_option() {
        Ok(Some(Indices::U16(indices))) => size_of_val(&indices[..]),
        Ok(Some(Indices::U32(indices))) => size_of_val(&indices[..]),
        _ => 0,
    };
    let attributes = mesh.try_attributes().into_iter().flatten();
    let vertices: usize = attributes.map(|(_, values)| values.get_bytes().len()).sum();
    vertices + indices + mesh.try_morph_targets().map_or(0, |targets| size_of_val(&targets[..]))
}
