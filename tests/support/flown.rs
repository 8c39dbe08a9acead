//! What tests of view-dependent refinement share: the camera path, models, and what a cut draws.
#![allow(dead_code)]

#[path = "flight.rs"]
pub mod path;

use glam::DVec3;
use multires::hierarchy::HierarchyLod;
use multires::lod::Lod;
use multires::mesh::Mesh;
use multires::simplify::CollapseSequence;

/// Stands for no step.
pub const NEVER: u32 = u32::MAX;

/// The drawn triangles: number in the hierarchy and corners as vertices of the hierarchy.
pub fn drawn(lod: &HierarchyLod) -> Vec<(u32, [u32; 3])> {
    let mut all = Vec::new();
    for group in 0..lod.groups() {
        all.extend(lod.surface().drawn(group).iter().copied().zip(lod.triangles(group).iter().copied()));
    }
    all
}

/// The vertices of a baked hierarchy, where they are.
pub struct Placed {
    pub positions: Vec<DVec3>,
}

impl Placed {
    pub fn new(vertices: &Mesh) -> Self {
        let positions = vertices.positions().iter();
        Self { positions: positions.map(|p| DVec3::from_array(p.map(f64::from))).collect() }
    }

    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.positions[v as usize])
    }
}

/// When the sequence puts which vertex in whose place.
pub struct History {
    /// Per vertex of the sequence the one that takes its place, or itself.
    substitute: Vec<u32>,
    /// Per vertex of the sequence the steps after which it is gone.
    end: Vec<u32>,
}

impl History {
    pub fn new(sequence: &CollapseSequence) -> Self {
        let count = sequence.input_vertices() + sequence.new_vertices().len();
        let mut history = Self { substitute: (0..count as u32).collect(), end: vec![NEVER; count] };
        for step in 0..sequence.len() {
            for &[from, to] in sequence.substitutions(step) {
                history.substitute[from as usize] = to;
                history.end[from as usize] = step as u32 + 1;
            }
        }
        history
    }

    /// The step that takes a vertex, counted from 1; [`NEVER`] if none does.
    pub fn end(&self, vertex: u32) -> u32 {
        self.end[vertex as usize]
    }

    /// The vertex that takes its place, or itself.
    pub fn substitute(&self, vertex: u32) -> u32 {
        self.substitute[vertex as usize]
    }

    /// After how many steps (from, to; without the last) a leaf is drawn at a vertex.
    pub fn stay(&self, leaf: u32, at: u32) -> [u32; 2] {
        let (mut vertex, mut since) = (leaf, 0);
        while vertex != at {
            since = self.end[vertex as usize];
            vertex = self.substitute[vertex as usize];
        }
        [since, self.end[at as usize]]
    }
}
