//! A drawn instance of any structure: the calls of an engine's frame.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use crate::adapt::{Change, DirtyRanges};
use crate::mesh::Mesh;
use crate::view::ObjectView;

use super::{Draws, LodError, LodOptions, Uploads};

/// A state between two levels as a uniform of a vertex shader ([`MORPH_WGSL`](crate::gmesh::MORPH_WGSL)).
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
pub struct MorphUniform {
    /// The first moving vertex; earlier vertices stay.
    pub first_moving: u32,
    /// Share of the way to the targets, 0 to 1.
    pub share: f32,
}

/// A drawn instance; its level of detail follows the view. Made by [`Baked::instance`](super::Baked::instance).
///
/// ```text
///     every frame     adapt(views, seconds)  ->  write uploads() into buffers  ->  clean()  ->  draw draws()
/// ```
///
/// Buffer 0 holds vertices. Buffer `1 + group` holds the indices of a group of triangles. There is a group for each material,
/// in the order of the structure's materials, and at least 1 group.
///
/// Written ranges accumulate until [`clean`](Lod::clean), so frames may go by without an upload. An instance starts at the
/// coarsest level of detail, all of it written. Once buffers have reached their largest size, nothing allocates. Instances
/// share the structure and are otherwise independent; each may move to another thread.
pub trait Lod: Send {
    /// Moves to the level of detail asked for by all views together, and advances geomorphs by `seconds`, the time since the
    /// last call. Without views, moves to the coarsest level of detail.
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change;

    /// Does what [`adapt`](Lod::adapt) does, if that changes nothing: with the views of the last call, which has left nothing to do.
    /// Else does nothing and returns `None`. Reads little else than the views. By default always `None`: then call `adapt`, which
    /// tries this first by itself.
    fn adapt_at_rest(&mut self, views: &[ObjectView]) -> Option<Change> {
        let _ = views;
        None
    }

    /// Goes to the full resolution at once, within the triangle limit.
    fn refine_fully(&mut self) -> Change;

    /// Draws the last level asked for, at once, every vertex at its own place: after a cut to another camera, for example. A
    /// g-mesh rests between two levels as well: its vertices go to their places in the state asked for.
    fn settle(&mut self);

    /// Returns the options.
    fn options(&self) -> &LodOptions;

    /// Sets the options. If all limits are lifted, pending work is drawn at once. If the new triangle limit is below the drawn
    /// triangles, the surplus goes in the next call, whatever the number of operations. If the vertex buffer, the triangulation
    /// or the use of geomorphs changes, the level asked for is drawn at once, and all of it counts as written: O(n).
    ///
    /// # Errors
    /// Vertices would have to be mixed, but the values cannot be ([`LodError::NeedsBlending`]). Nothing has changed then.
    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError>;

    /// Returns the factor on the tolerances of all views; 1 at first.
    fn tolerance_factor(&self) -> f32;

    /// Multiplies the tolerances of all views by a factor above 0 from now on: for controllers, which change it every frame.
    /// While the factor moves by a few percent, only refinements about as large as the tolerance are tested again. Factors not
    /// above 0, or not finite, are ignored.
    fn set_tolerance_factor(&mut self, factor: f32);

    /// Returns the number of refinements last asked for, within the triangle limit: splits, wavelets, or vertices of a totally
    /// ordered mesh beyond the coarsest. O(n).
    fn refinements(&self) -> usize;

    /// Returns the number of groups of triangles: 1 for each material, at least 1.
    fn groups(&self) -> usize;

    /// Returns the material id of a group; `u32::MAX` where the mesh has no materials.
    fn material(&self, group: usize) -> u32;

    /// Returns the corners of a group's drawn triangles, dense; empty if there is no such group. Use
    /// [`as_flattened`](slice::as_flattened) for a flat slice of indices.
    fn triangles(&self, group: usize) -> &[[u32; 3]];

    /// Returns the triangles held by a group's index buffer: the drawn triangles, unless the buffer holds all levels of
    /// detail, as a g-mesh's does. Empty if there is no such group.
    fn buffered_triangles(&self, group: usize) -> &[[u32; 3]] {
        self.triangles(group)
    }

    /// Returns the place of the first drawn triangle of a group in [`buffered_triangles`](Lod::buffered_triangles).
    fn first_triangle(&self, group: usize) -> usize {
        let _ = group;
        0
    }

    /// Returns the drawn triangles of a group as a range of [`buffered_triangles`](Lod::buffered_triangles). Empty if there is no
    /// such group.
    fn drawn_range(&self, group: usize) -> Range<usize> {
        let first = self.first_triangle(group);
        first..first + self.triangles(group).len()
    }

    /// Returns the structure's vertex in every slot of a packed vertex buffer; `None` if indices name the structure's vertices.
    fn vertices(&self) -> Option<&[u32]>;

    /// Returns the vertex buffer for the graphics card: values of the type given to the instance.
    fn vertex_bytes(&self) -> &[u8];

    /// Returns the bytes of a vertex.
    fn vertex_size(&self) -> usize;

    /// Holds if the vertex buffer is the values themselves, shared by all instances and never written:
    /// [`VertexBuffer::Shared`](super::VertexBuffer::Shared).
    fn shares_vertices(&self) -> bool;

    /// Holds if index buffers hold the same for all instances, and are written once: a renderer may keep a single copy of
    /// [`buffered_triangles`](Lod::buffered_triangles), and leave out the uploads of all others.
    fn shares_triangles(&self) -> bool {
        false
    }

    /// Returns the uniform for the vertex shader that moves vertices to their targets: of a g-mesh whose vertices the processor does
    /// not move; a packed buffer holds the first of the structure's vertices. `None` if the vertex buffer holds vertices as drawn.
    /// Targets are [`Model::morph_targets`](super::Model::morph_targets).
    fn morph(&self) -> Option<MorphUniform> {
        None
    }

    /// Returns the triangles of a group's index buffer ([`buffered_triangles`](Lod::buffered_triangles)) written since the last
    /// [`clean`](Lod::clean), as ascending ranges. Ranges with at most `gap` unwritten triangles between them are merged.
    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_>;

    /// Returns the vertices of the vertex buffer written since the last [`clean`](Lod::clean), as ascending ranges. Ranges with
    /// at most `gap` unwritten vertices between them are merged.
    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_>;

    /// Returns the writes since the last [`clean`](Lod::clean), ready for the buffers of any graphics interface.
    fn uploads(&self) -> Uploads<'_>;

    /// Returns the draws: a range of indices for each material with triangles.
    fn draws(&self) -> Draws<'_>;

    /// Forgets what was written. Call it after the upload.
    fn clean(&mut self);

    /// Marks everything as written. Call it after a buffer was lost, or exchanged for an empty buffer.
    fn invalidate(&mut self);

    /// Returns the drawn level as a mesh, every vertex where it comes to rest, with all attributes of the baked model. Equal
    /// cuts give equal meshes. Empty if the instance was made without the model's vertices. O(n).
    fn to_mesh(&self) -> Mesh;

    /// Returns the bytes of this instance, without what it shares with others.
    fn memory(&self) -> usize;
}
