//! Vertices to be drawn, made of those that arrived; and the drawn mesh with everything that arrived.

use crate::hierarchy::CutSurface;
use crate::mesh::Mesh;

use super::client::StreamVertex;
use super::error::StreamError;
use super::header::Header;

/// Vertices to be drawn, by slot.
#[derive(Clone)]
pub(super) struct DrawnValues<V, F> {
    make: F,
    drawn: Vec<V>,
    words: Vec<u32>,
}

impl<V, F: FnMut(StreamVertex<'_>) -> V> DrawnValues<V, F> {
    pub fn new(make: F) -> Self {
        Self { make, drawn: Vec::new(), words: Vec::new() }
    }

    /// Makes the vertices of slots that were written. `scalars` appends the bits of a vertex's scalars.
    pub fn write(
        &mut self,
        surface: &CutSurface,
        header: &Header,
        mut scalars: impl FnMut(u32, &mut Vec<u32>),
    ) {
        let Self { make, drawn, words } = self;
        let vertices = surface.vertices().unwrap_or(&[]);
        let mut value = |vertex: u32| {
            words.clear();
            scalars(vertex, words);
            make(StreamVertex { words, header })
        };
        drawn.truncate(vertices.len());
        for range in surface.dirty_vertices(0) {
            for slot in range {
                let value = value(vertices[slot]);
                match drawn.get_mut(slot) {
                    Some(place) => *place = value,
                    None => drawn.push(value),
                }
            }
        }
    }

    pub fn clear(&mut self) {
        self.drawn.clear();
    }

    pub fn all(&self) -> &[V] {
        &self.drawn
    }
}

/// Where the drawn vertices and triangles of a surface come from.
pub(super) trait Arrived {
    /// Returns the leaves of a triangle.
    fn leaves(&self, triangle: u32) -> [u32; 3];
    /// Returns the first leaf of a drawn vertex: a name that does not depend on what arrived before.
    fn first_leaf(&self, vertex: u32) -> u32;
    /// Appends the bits of the scalars of a vertex.
    fn scalars(&self, vertex: u32, words: &mut Vec<u32>);
}

/// Returns the drawn triangles with all attributes: vertices by their first leaves, triangles by their leaves.
pub(super) fn drawn_mesh(
    surface: &CutSurface,
    header: &Header,
    from: &impl Arrived,
) -> Result<Mesh, StreamError> {
    let slots = surface.vertices().unwrap_or(&[]);
    let mut drawn = Vec::new();
    for group in 0..surface.groups() {
        let corners = surface.triangles(group).iter().map(|t| t.map(|slot| slots[slot as usize]));
        let leaves = surface.drawn(group).iter().map(|&t| from.leaves(t));
        drawn.extend(leaves.zip(corners).map(|(leaves, corners)| (leaves, corners, group)));
    }
    drawn.sort_unstable();
    let mut used: Vec<u32> = slots.to_vec();
    used.sort_unstable_by_key(|&vertex| from.first_leaf(vertex));
    let place = |vertex: u32| {
        let first = from.first_leaf(vertex);
        used.partition_point(|&other| from.first_leaf(other) < first) as u32
    };
    let triangles = drawn.iter().map(|(_, corners, _)| corners.map(place)).collect();
    let mut words = Vec::with_capacity(used.len() * header.layout.len());
    used.iter().for_each(|&vertex| from.scalars(vertex, &mut words));
    let mesh = header.layout.mesh(&words, triangles)?;
    if header.materials.is_empty() {
        return Ok(mesh);
    }
    let materials: Vec<u32> = drawn.iter().map(|(.., group)| header.materials[*group]).collect();
    mesh.with_materials(materials).map_err(|_| StreamError::Damaged { what: "materials make no mesh" })
}
