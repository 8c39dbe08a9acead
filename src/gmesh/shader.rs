//! A state in a vertex shader: two numbers, and functions for WGSL and GLSL.

use crate::lod::MorphUniform;

use super::{Gmesh, Morph};

/// WGSL functions for a vertex shader with two vertex streams: a vertex's own values and its target's
/// ([`Gmesh::target_values`]). Append it to a shader:
///
/// ```wgsl
/// struct Morph { first_moving: u32, share: f32 }   // MorphUniform
///
/// @vertex fn vertex(@builtin(vertex_index) index: u32, @location(0) own: vec3<f32>, @location(1) target: vec3<f32>) -> ...
///     let share = multires_morph_share(index, morph.first_moving, morph.share);
///     let position = multires_morph3(own, target, share);
/// ```
///
/// With a base vertex, add it to `first_moving`: `vertex_index` counts from there.
pub const MORPH_WGSL: &str = include_str!("morph.wgsl");

/// GLSL functions for a vertex shader, as [`MORPH_WGSL`], from GLSL ES 3.00 on (WebGL 2): the vertex's number is `gl_VertexID`
/// (Vulkan: `gl_VertexIndex`). Insert it after `#version` and precision.
pub const MORPH_GLSL: &str = include_str!("morph.glsl");

impl Gmesh {
    /// Returns a state as a uniform of a shader.
    pub fn uniform(&self, morph: Morph) -> MorphUniform {
        let morph = self.clamped(morph);
        MorphUniform { first_moving: self.moving(morph.level).start as u32, share: morph.share }
    }
}
