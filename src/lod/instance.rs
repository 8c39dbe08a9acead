//! A drawn instance of any structure: what an engine calls every frame.

use crate::adapt::{Change, DirtyRanges};
use crate::mesh::Mesh;
use crate::view::ObjectView;

use super::{Draws, LodError, LodOptions, Uploads};

/// A drawn instance whose level of detail follows the view. Made by [`Baked::instance`](super::Baked::instance).
///
/// ```text
///     every frame     adapt(views, seconds)  ->  write uploads() into buffers  ->  clean()  ->  draw draws()
/// ```
///
/// Buffer 0 holds vertices, buffer `1 + group` the indices of one group of triangles: one group for each material, in the
/// order of the structure's materials, at least one.
///
/// What was written gathers until [`clean`](Lod::clean), so frames may go by without an upload. Starts at the coarsest level of
/// detail, all of it written. Once buffers are as large as they get, nothing allocates. Instances share the structure and are
/// otherwise independent; each may move to another thread.
pub trait Lod: Send {
    /// Moves to what the views ask for together, `seconds` after the last call: as far as vertices move, they go on by that.
    /// Without views, to the coarsest level of detail.
    fn adapt(&mut self, views: &[ObjectView], seconds: f32) -> Change;

    /// Goes to the full resolution at once, within the limit of triangles.
    fn refine_fully(&mut self) -> Change;

    /// Draws all that was last asked for, every vertex at its place: after a cut to another camera, say.
    fn settle(&mut self);

    /// How it follows the view.
    fn options(&self) -> &LodOptions;

    /// Follows the view in another way from now on. Where all limits are lifted, what is still to come is drawn at once; where
    /// triangles are fewer than drawn, what is too much goes in the next call, whatever the number of operations. Where the
    /// vertex buffer, the triangulation or whether vertices move changes, what was asked for is drawn at once, and all of it
    /// counts as written: O(n).
    ///
    /// # Errors
    /// Vertices would have to be mixed, and the values cannot be ([`LodError::NeedsBlending`]); then nothing has changed.
    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError>;

    /// What tolerances of all views are multiplied by; 1 at first.
    fn tolerance_factor(&self) -> f32;

    /// Multiplies tolerances of all views by a factor above 0 from now on: for controllers, who turn it every frame. While it
    /// moves by a few percent, only refinements that are about as large as the tolerance are asked about again. Numbers that
    /// are no such factor are ignored.
    fn set_tolerance_factor(&mut self, factor: f32);

    /// Refinements that were last asked for, within the limit of triangles: splits, wavelets, or of a totally ordered mesh
    /// vertices beyond the coarsest. O(n).
    fn refinements(&self) -> usize;

    /// Number of groups of triangles: one for each material, at least one.
    fn groups(&self) -> usize;

    /// The material id of a group; `u32::MAX` where the mesh has no materials.
    fn material(&self, group: usize) -> u32;

    /// Corners of the drawn triangles of a group, dense; empty where there is no such group. Use
    /// [`as_flattened`](slice::as_flattened) for one flat slice of indices.
    fn triangles(&self, group: usize) -> &[[u32; 3]];

    /// The structure's vertex in every slot of a packed vertex buffer; `None` where indices name the structure's vertices.
    fn vertices(&self) -> Option<&[u32]>;

    /// The vertex buffer, as it is to be on the graphics card: values of the type that the instance was made with.
    fn vertex_bytes(&self) -> &[u8];

    /// Bytes of one vertex.
    fn vertex_size(&self) -> usize;

    /// Whether the vertex buffer is that of the values, the same for all instances, and never written:
    /// [`VertexBuffer::Shared`](super::VertexBuffer::Shared).
    fn shares_vertices(&self) -> bool;

    /// Triangles of a group written since the last [`clean`](Lod::clean), as ascending ranges; those that at most `gap`
    /// unwritten triangles part are one.
    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_>;

    /// Vertices of the vertex buffer written since the last [`clean`](Lod::clean), likewise.
    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_>;

    /// What was written since the last [`clean`](Lod::clean), ready for the buffers of any graphics interface.
    fn uploads(&self) -> Uploads<'_>;

    /// What is to be drawn: a range of indices for each material that has triangles.
    fn draws(&self) -> Draws<'_>;

    /// Forgets what was written: call it when it is uploaded.
    fn clean(&mut self);

    /// Takes all for written: after a buffer was lost, or exchanged for an empty one.
    fn invalidate(&mut self);

    /// What is drawn as a mesh of its own, every vertex where it comes to rest, with all attributes of the baked model: the same
    /// mesh for the same cut. Empty where the instance was made without the model's vertices. O(n).
    fn to_mesh(&self) -> Mesh;

    /// Bytes of this instance; what it shares with others is not counted.
    fn memory(&self) -> usize;
}
