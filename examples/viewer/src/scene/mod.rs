//! What is drawn: a model, its objects, and how they follow the view.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`Scene`]: objects that adapt, upload and draw together |
//! | `model.rs` | [`Model`]: a structure and its vertices |
//! | `texture.rs` | [`Texture`]: a wavelet mesh's own, by its base |
//! | `pictures.rs` | base colours and normal maps of glTF files |
//! | `control.rs` | [`ControlOptions`]: triangles or time held over all objects |
//! | `instance.rs` | an instance, as a g-mesh where it is one |
//! | `builtin.rs` | [`Builtin`]: scenes that need no file |
//! | `load.rs` | `Loading`: models that are built in a thread of their own |

mod builtin;
mod control;
mod instance;
#[cfg(feature = "program")]
mod load;
mod model;
mod pictures;
mod texture;

pub use builtin::Builtin;
pub use control::{ControlOptions, Controlled, Controller, SceneControlError};
#[cfg(feature = "program")]
pub use load::{Loading, Source};
pub use model::{BuildOptions, Coordinates, Model, ModelError, Progress, StructureKind};
pub use texture::Texture;

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use glam::{DVec3, Mat4, Vec3};
use multires::adapt::Change;
use multires::lod::{Lod, LodError, LodOptions, MorphUniform, VertexBuffer};
use multires::quality::palette;
use multires::view::{ObjectView, View};
use web_time::Instant;

use crate::renderer::{
    Eye, Instance as InstanceRecord, Kind, LodBuffers, Paint, Renderer, SharedBuffers, Target, Uploads,
    card_morph, linear,
};
use control::Control;
use instance::Instance;

/// Frames for which triangles glow after they were written.
const GLOW: usize = 12;
/// Colours of triangle edges and of what was written of late.
const WIRE: [f32; 4] = [0.02, 0.03, 0.05, 0.55];
const WRITTEN: [f32; 4] = [1.0, 0.2, 0.02, 0.5];

/// What lies over the surfaces of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Overlays {
    /// Edges of triangles.
    pub wire: bool,
    /// Triangles written in the last frames.
    pub written: bool,
}

/// What one frame did to all objects.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adapted {
    /// Sums over all objects.
    pub change: Change,
    /// How long it took.
    pub time: Duration,
    /// What the controller did; `None` without one. Then the change counts no splits, collapses and moving vertices, except by
    /// a bias.
    pub controlled: Option<Controlled>,
}

/// Adds a change to a sum.
fn add(sum: &mut Change, change: Change) {
    sum.cut.tests += change.cut.tests;
    sum.cut.splits += change.cut.splits;
    sum.cut.collapses += change.cut.collapses;
    sum.triangles += change.triangles;
    sum.pending += change.pending;
    sum.moving += change.moving;
    sum.over_budget |= change.over_budget;
}

struct Object {
    instance: Instance,
    buffers: LodBuffers,
    /// Whether its vertices are those that all share.
    shared: bool,
    matrix: [[f32; 4]; 4],
    /// Per frame, the group and the triangles that were written.
    written: VecDeque<Vec<(usize, Range<u32>)>>,
}

/// Objects of one model.
pub struct Scene {
    model: Arc<Model>,
    options: LodOptions,
    control: Control,
    /// Triangles drawn by the last frame.
    triangles: usize,
    shared: SharedBuffers,
    objects: Vec<Object>,
    /// For every object and group its surface, then the same for edges, then for what was written.
    records: wgpu::Buffer,
    /// For every object and group the way of its vertices to their targets.
    morphs: Vec<MorphUniform>,
    /// `morphs` on the card.
    morph_buffer: wgpu::Buffer,
    centre: [f64; 3],
    diagonal: f64,
    /// Room for the views of all objects.
    views: Vec<ObjectView>,
}

impl Scene {
    /// Objects at those places (matrices from object to world, column-major; even scale), at the coarsest level of detail.
    pub fn new(
        device: &wgpu::Device,
        uploads: &mut Uploads,
        model: Arc<Model>,
        places: &[[[f32; 4]; 4]],
        options: LodOptions,
    ) -> Result<Self, LodError> {
        let instances = places.iter().map(|_| Instance::new(&model, &options)).collect::<Result<_, _>>()?;
        Ok(Self::of(device, uploads, model, places, options, instances, SharedBuffers::default()))
    }

    /// The same objects at full resolution.
    ///
    /// # Errors
    /// None that the objects as they are have not met.
    pub fn full(&self, device: &wgpu::Device, uploads: &mut Uploads) -> Result<Self, LodError> {
        let places: Vec<_> = self.objects.iter().map(|object| object.matrix).collect();
        let options = LodOptions::default().with_buffer(VertexBuffer::Shared);
        let full = |_| {
            let mut instance = Instance::new(&self.model, &options)?;
            instance.lod_mut().refine_fully();
            Ok(instance)
        };
        let instances = places.iter().map(full).collect::<Result<_, _>>()?;
        let (model, shared) = (Arc::clone(&self.model), self.shared.clone());
        Ok(Self::of(device, uploads, model, &places, options, instances, shared))
    }

    fn of(
        device: &wgpu::Device,
        uploads: &mut Uploads,
        model: Arc<Model>,
        places: &[[[f32; 4]; 4]],
        options: LodOptions,
        instances: Vec<Instance>,
        mut shared: SharedBuffers,
    ) -> Self {
        let objects: Vec<Object> = instances
            .into_iter()
            .zip(places)
            .map(|(instance, &matrix)| {
                let lod = instance.lod();
                shared.add(device, uploads, lod, model.vertices(), model.baked().morph_targets());
                Object {
                    buffers: LodBuffers::new(device, lod, &shared),
                    shared: lod.shares_vertices(),
                    instance,
                    matrix,
                    written: VecDeque::new(),
                }
            })
            .collect();
        let colours: Vec<[f32; 4]> =
            model.materials().iter().map(|&id| linear(palette::categorical(id), 1.0)).collect();
        let in_colours = |colours: &[[f32; 4]]| -> Vec<InstanceRecord> {
            let of = |&place: &[[f32; 4]; 4]| colours.iter().map(move |&c| InstanceRecord::new(place, c));
            places.iter().flat_map(of).collect()
        };
        let records = [
            in_colours(&colours),
            in_colours(&vec![WIRE; colours.len()]),
            in_colours(&vec![WRITTEN; colours.len()]),
        ]
        .concat();
        let buffer = |label, bytes: usize| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (bytes as u64).max(64),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let instances = buffer("instances", size_of_val(&records[..]));
        uploads.write(Kind::Other, &instances, 0, bytemuck::cast_slice(&records));
        // On the card zeros: all vertices are at rest.
        let morphs = vec![MorphUniform::default(); objects.len() * colours.len()];
        let (low, high) = extent(model.bounds(), places);
        Self {
            model,
            options,
            control: Control::default(),
            triangles: 0,
            shared,
            objects,
            records: instances,
            morph_buffer: buffer("ways to targets", size_of_val(&morphs[..])),
            morphs,
            centre: ((low + high) * 0.5).to_array(),
            diagonal: (high - low).length(),
            views: Vec::new(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// How instances follow the view.
    pub fn options(&self) -> &LodOptions {
        &self.options
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Whether there are no objects.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// Middle of the box around all objects, world units.
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// Diagonal of that box.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Lets all objects follow the view in another way.
    ///
    /// # Errors
    /// The structure cannot be drawn that way.
    pub fn set_options(
        &mut self,
        device: &wgpu::Device,
        uploads: &mut Uploads,
        options: LodOptions,
    ) -> Result<(), LodError> {
        if options == self.options {
            return Ok(());
        }
        for object in &mut self.objects {
            let lod = object.instance.lod_mut();
            lod.set_options(&options)?;
            if options.buffer != self.options.buffer || lod.shares_vertices() != object.shared {
                let targets = self.model.baked().morph_targets();
                self.shared.add(device, uploads, lod, self.model.vertices(), targets);
                object.shared = lod.shares_vertices();
                object.buffers = LodBuffers::new(device, lod, &self.shared);
                lod.invalidate();
                object.written.clear();
            }
        }
        self.options = options;
        Ok(())
    }

    /// How triangles or time are held over all objects.
    pub fn control(&self) -> &ControlOptions {
        self.control.options()
    }

    /// Holds triangles or time over all objects in another way.
    ///
    /// # Errors
    /// The controller does not fit the scene, or its target is outside the range. Nothing has changed then.
    pub fn set_control(&mut self, options: ControlOptions) -> Result<(), SceneControlError> {
        if options == *self.control.options() {
            return Ok(());
        }
        let other = options.controller != self.control.options().controller;
        self.control.set_options(options, self.model.gmesh())?;
        if other {
            self.objects.iter_mut().for_each(|object| object.instance.lod_mut().set_tolerance_factor(1.0));
        }
        Ok(())
    }

    /// Tells the controller how long the last frame took, from its start to the start of the next, seconds.
    pub fn measured(&mut self, seconds: f64) {
        self.control.measured(seconds, self.triangles);
    }

    /// Lets all objects follow the views, `seconds` after the last call.
    pub fn adapt(&mut self, views: &[View], seconds: f32) -> Adapted {
        let start = Instant::now();
        let Self { control, objects, views: all, .. } = self;
        all.clear();
        for object in &*objects {
            // A place that is no even scale shows the object as the world's views do.
            let of_object = |view: &View| view.of_object(object.matrix).unwrap_or_else(|_| view.of_world());
            all.extend(views.iter().map(of_object));
        }
        let controlled = control.adapt(objects.iter_mut().map(|object| &mut object.instance), all, seconds);
        let change = controlled.map(|controlled| controlled.change).unwrap_or_else(|| {
            let mut sum = Change::default();
            for (i, object) in objects.iter_mut().enumerate() {
                let views = &all[i * views.len()..(i + 1) * views.len()];
                add(&mut sum, object.instance.lod_mut().adapt(views, seconds));
            }
            sum
        });
        self.triangles = change.triangles;
        Adapted { change, time: start.elapsed(), controlled }
    }

    /// Draws at once all that was asked for: after a jump of the camera.
    pub fn settle(&mut self) {
        self.objects.iter_mut().for_each(|object| object.instance.lod_mut().settle());
    }

    /// Uploads what was written since the last call, and whatever else the overlays need.
    pub fn sync(
        &mut self,
        device: &wgpu::Device,
        uploads: &mut Uploads,
        renderer: &Renderer,
        overlays: Overlays,
    ) {
        let remember = overlays.written;
        let groups = self.model.materials().len();
        let mut moved = false;
        for (object, morphs) in self.objects.iter_mut().zip(self.morphs.chunks_mut(groups)) {
            if remember {
                let lod = object.instance.lod();
                let of = |group: usize| {
                    let ranges = lod.dirty_triangles(group, 0);
                    ranges.map(move |range| (group, range.start as u32..range.end as u32))
                };
                object.written.push_back((0..lod.groups()).flat_map(of).collect());
            }
            while object.written.len() > if remember { GLOW } else { 0 } {
                object.written.pop_front();
            }
            if overlays.wire && renderer.needs_edges() {
                object.buffers.sync_edges(device, uploads, object.instance.lod(), &mut self.shared);
            } else {
                object.buffers.drop_edges();
            }
            object.buffers.sync(device, uploads, object.instance.lod_mut());
            moved |= morphs[0] != object.buffers.morph();
            morphs.fill(object.buffers.morph());
        }
        if moved {
            uploads.write(Kind::Other, &self.morph_buffer, 0, bytemuck::cast_slice(&self.morphs));
        }
    }

    /// Bytes of index buffers that are drawn.
    pub fn index_bytes(&self) -> u64 {
        let groups = self.objects.iter().flat_map(|object| object.buffers.groups());
        groups.map(|(_, triangles)| triangles.len() as u64 * crate::renderer::TRIANGLE).sum()
    }

    /// Bytes on the card: of all instances, and of what they share.
    pub fn card_memory(&self) -> [u64; 2] {
        let moving = self.objects.iter().any(|object| card_morph(object.instance.lod()).is_some());
        let morphs = if moving { self.morph_buffer.size() } else { 0 };
        let own: u64 = self.objects.iter().map(|object| object.buffers.memory()).sum();
        [own + morphs, self.shared.memory()]
    }

    /// Bytes of all instances in memory.
    pub fn memory(&self) -> usize {
        self.objects.iter().map(|object| object.instance.lod().memory()).sum()
    }

    /// Instances, to look at what they hold.
    pub fn instances(&self) -> impl Iterator<Item = &dyn Lod> {
        self.objects.iter().map(|object| object.instance.lod())
    }

    /// Draws everything into a target.
    pub fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut wgpu::RenderPass<'_>,
        eye: &Eye,
        paint: &Paint,
        overlays: Overlays,
    ) {
        renderer.begin(pass, eye, paint);
        if self.objects.is_empty() {
            return;
        }
        let groups = self.model.materials().len();
        let each = || self.objects.iter().zip((0_u32..).step_by(groups));
        let colours = |pass: &mut wgpu::RenderPass<'_>, part: usize| {
            let start = part * self.morphs.len() * size_of::<InstanceRecord>();
            renderer.instances(pass, self.records.slice(start as u64..), self.morph_buffer.slice(..));
        };
        renderer.surfaces(pass);
        colours(pass, 0);
        each().for_each(|(object, first)| renderer.draw(pass, &object.buffers, first));
        if overlays.wire {
            renderer.wires(pass);
            colours(pass, 1);
            each().for_each(|(object, first)| renderer.draw_wire(pass, &object.buffers, first));
        }
        if overlays.written {
            renderer.overlays(pass);
            colours(pass, 2);
            for (object, first) in each() {
                for (group, range) in object.written.iter().flatten() {
                    let ranges = std::iter::once(range.clone());
                    renderer.draw_some(pass, &object.buffers, *group, ranges, first + *group as u32);
                }
            }
        }
    }

    /// The same in a pass of its own.
    pub fn draw_to(
        &self,
        renderer: &Renderer,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        eye: &Eye,
        paint: &Paint,
        overlays: Overlays,
    ) {
        let mut pass = target.pass(encoder);
        self.draw(renderer, &mut pass, eye, paint, overlays);
    }
}

/// The box around a box at all those places.
fn extent([low, high]: [[f32; 3]; 2], places: &[[[f32; 4]; 4]]) -> (DVec3, DVec3) {
    let corner = |i: usize| Vec3::from_array(std::array::from_fn(|a| [low[a], high[a]][i >> a & 1]));
    let corners = places.iter().flat_map(|place| {
        let place = Mat4::from_cols_array_2d(place);
        (0..8).map(move |i| place.transform_point3(corner(i)).as_dvec3())
    });
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = corners.fold(nothing, |(low, high), p| (low.min(p), high.max(p)));
    if low.is_finite() && high.is_finite() { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) }
}
