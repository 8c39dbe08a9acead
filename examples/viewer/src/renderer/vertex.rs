//! What the graphics card reads: one vertex, and one drawn instance.

use bytemuck::{Pod, Zeroable};
use multires::adapt::Blend;
use multires::lod::MorphUniform;

/// Bytes of a triangle's three indices.
pub const TRIANGLE: u64 = 12;

/// One vertex: 40 bytes. Put your own here: the structures number vertices and never look inside.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Object units.
    pub position: [f32; 3],
    /// Unit length, or zero where there is none: then the triangle's own normal is taken.
    pub normal: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// For shading by level: 0 for vertices of the coarsest mesh to 1 for those that come last.
    pub level: f32,
    /// For shading by error: how far the surface may be off where this vertex is left out, object units.
    pub error: f32,
}

impl Vertex {
    /// How pipelines read it.
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x2],
    };

    /// How pipelines read the vertices' targets: a second stream of equal layout.
    pub const TARGET_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        attributes: &wgpu::vertex_attr_array![8 => Float32x3, 9 => Float32x3, 10 => Float32x2, 11 => Float32x2],
        ..Self::LAYOUT
    };
}

/// How pipelines read the way of vertices to their targets: one for each drawn [`Instance`].
pub const MORPH_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<MorphUniform>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![12 => Uint32, 13 => Float32],
};

impl Blend for Vertex {
    fn blend(&self, other: &Self, t: f32) -> Self {
        let [a, b]: [[f32; 10]; 2] = [bytemuck::cast(*self), bytemuck::cast(*other)];
        bytemuck::cast(a.blend(&b, t))
    }

    fn moved(&self, from: &Self, to: &Self, t: f32) -> Self {
        let [own, a, b]: [[f32; 10]; 3] = [*self, *from, *to].map(bytemuck::cast);
        bytemuck::cast(own.moved(&a, &b, t))
    }
}

/// Where an object is drawn and in which colour: 64 bytes, one for each group of triangles of each object. Draws pick theirs by
/// the number of their first instance.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct Instance {
    /// The upper three rows of the matrix from object to world, which may turn, move and scale evenly.
    pub rows: [[f32; 4]; 3],
    /// Linear red, green, blue, and opacity.
    pub colour: [f32; 4],
}

impl Instance {
    /// How pipelines read it.
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4],
    };

    /// From a column-major matrix, as [`ObjectView`](multires::view::ObjectView)s take it.
    pub fn new(object_to_world: [[f32; 4]; 4], colour: [f32; 4]) -> Self {
        let row = |i: usize| object_to_world.map(|column| column[i]);
        Self { rows: [row(0), row(1), row(2)], colour }
    }
}
