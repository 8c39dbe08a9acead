//! What is drawn: a model, its objects, and how they follow the view.
//!
//! | file | idea |
//! |---|---|
//! | `mod.rs` | [`Scene`]: objects that adapt, upload and draw together |
//! | `model.rs` | [`Model`]: a structure and its vertices |
//! | `texture.rs` | [`Texture`]: a wavelet mesh's own, by its base |
//! | `builtin.rs` | [`Builtin`]: scenes that need no file |
//! | `load.rs` | [`Loading`]: models that are built in a thread of their own |

mod builtin;
mod load;
mod model;
mod texture;

pub use builtin::Builtin;
pub use load::{Loading, Source};
pub use model::{BuildOptions, Coordinates, Model, ModelError, Progress, StructureKind};
pub use texture::Texture;

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{DVec3, Mat4, Vec3};
use multires::adapt::Change;
use multires::lod::{Lod, LodError, LodOptions, VertexBuffer};
use multires::quality::palette;
use multires::view::{ObjectView, View};

use crate::renderer::{
    Eye, Instance as InstanceRecord, Kind, LodBuffers, Paint, Renderer, Target, Uploads, linear,
    shared_vertices,
};

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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Adapted {
    /// Sums over all objects.
    pub change: Change,
    /// How long it took.
    pub time: Duration,
}

struct Object {
    instance: Box<dyn Lod>,
    buffers: LodBuffers,
    /// Whether its vertices are those that all share.
    shared: bool,
    matrix: [[f32; 4]; 4],
    triangles: usize,
    /// Per frame, the group and the triangles that were written.
    written: VecDeque<Vec<(usize, Range<u32>)>>,
}

/// Objects of one model.
pub struct Scene {
    model: Arc<Model>,
    options: LodOptions,
    shared: wgpu::Buffer,
    objects: Vec<Object>,
    /// For every object and group its surface, then the same for edges, then for what was written.
    records: wgpu::Buffer,
    centre: [f64; 3],
    diagonal: f64,
    /// Room for the views of one object.
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
        let instances = places.iter().map(|_| model.instance(&options)).collect::<Result<_, _>>()?;
        Ok(Self::of(device, uploads, model, places, options, instances))
    }

    /// The same objects at full resolution.
    ///
    /// # Errors
    /// None that the objects as they are have not met.
    pub fn full(&self, device: &wgpu::Device, uploads: &mut Uploads) -> Result<Self, LodError> {
        let places: Vec<_> = self.objects.iter().map(|object| object.matrix).collect();
        let options = LodOptions::default().with_buffer(VertexBuffer::Shared);
        let full = |_| {
            let mut instance = self.model.instance(&options)?;
            instance.refine_fully();
            Ok(instance)
        };
        let instances = places.iter().map(full).collect::<Result<_, _>>()?;
        Ok(Self::of(device, uploads, Arc::clone(&self.model), &places, options, instances))
    }

    fn of(
        device: &wgpu::Device,
        uploads: &mut Uploads,
        model: Arc<Model>,
        places: &[[[f32; 4]; 4]],
        options: LodOptions,
        instances: Vec<Box<dyn Lod>>,
    ) -> Self {
        // Those that no instance shares need not lie on the card.
        let is_shared = instances.iter().any(|instance| instance.shares_vertices());
        let shared = shared_vertices(device, uploads, if is_shared { model.vertices() } else { &[] });
        let objects: Vec<Object> = instances
            .into_iter()
            .zip(places)
            .map(|(instance, &matrix)| Object {
                buffers: LodBuffers::new(device, &*instance),
                shared: instance.shares_vertices(),
                instance,
                matrix,
                triangles: 0,
                written: VecDeque::new(),
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
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("instances"),
            size: (size_of_val(&records[..]) as u64).max(64),
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        uploads.write(Kind::Other, &buffer, 0, bytemuck::cast_slice(&records));
        let (low, high) = extent(model.bounds(), places);
        Self {
            model,
            options,
            shared,
            objects,
            records: buffer,
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
            object.instance.set_options(&options)?;
            if options.buffer != self.options.buffer || object.instance.shares_vertices() != object.shared {
                object.shared = object.instance.shares_vertices();
                object.buffers = LodBuffers::new(device, &*object.instance);
                object.instance.invalidate();
                object.written.clear();
            }
        }
        if self.shared.size() <= 4 && self.objects.iter().any(|object| object.shared) {
            self.shared = shared_vertices(device, uploads, self.model.vertices());
        }
        self.options = options;
        Ok(())
    }

    /// Lets all objects follow the views, `seconds` after the last call.
    pub fn adapt(&mut self, views: &[View], seconds: f32) -> Adapted {
        let start = Instant::now();
        let mut sum = Change::default();
        for object in &mut self.objects {
            self.views.clear();
            // A place that is no even scale shows the object as the world's views do.
            self.views.extend(
                views.iter().map(|view| view.of_object(object.matrix).unwrap_or_else(|_| view.of_world())),
            );
            let change = object.instance.adapt(&self.views, seconds);
            object.triangles = change.triangles;
            sum.cut.tests += change.cut.tests;
            sum.cut.splits += change.cut.splits;
            sum.cut.collapses += change.cut.collapses;
            sum.triangles += change.triangles;
            sum.pending += change.pending;
            sum.moving += change.moving;
            sum.over_budget |= change.over_budget;
        }
        Adapted { change: sum, time: start.elapsed() }
    }

    /// Draws at once all that was asked for: after a jump of the camera.
    pub fn settle(&mut self) {
        self.objects.iter_mut().for_each(|object| object.instance.settle());
    }

    /// Uploads what was written since the last call. With `remember` the triangles are kept, to glow.
    pub fn sync(&mut self, device: &wgpu::Device, uploads: &mut Uploads, remember: bool) {
        for object in &mut self.objects {
            if remember {
                let lod = &*object.instance;
                let of = |group: usize| {
                    let ranges = lod.dirty_triangles(group, 0);
                    ranges.map(move |range| (group, range.start as u32..range.end as u32))
                };
                object.written.push_back((0..lod.groups()).flat_map(of).collect());
            }
            while object.written.len() > if remember { GLOW } else { 0 } {
                object.written.pop_front();
            }
            object.buffers.sync(device, uploads, &mut *object.instance);
        }
    }

    /// Bytes of index buffers that are drawn.
    pub fn index_bytes(&self) -> u64 {
        let groups = self.objects.iter().flat_map(|object| object.buffers.groups());
        groups.map(|(_, triangles)| u64::from(triangles) * crate::renderer::TRIANGLE).sum()
    }

    /// Bytes on the card: of all instances, and of what they share.
    pub fn card_memory(&self) -> [u64; 2] {
        [self.objects.iter().map(|object| object.buffers.memory()).sum(), self.shared.size()]
    }

    /// Bytes of all instances in memory.
    pub fn memory(&self) -> usize {
        self.objects.iter().map(|object| object.instance.memory()).sum()
    }

    /// Instances, to look at what they hold.
    pub fn instances(&self) -> impl Iterator<Item = &dyn Lod> {
        self.objects.iter().map(|object| &*object.instance)
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
        pass.set_vertex_buffer(1, self.records.slice(..));
        let groups = self.model.materials().len() as u32;
        let all = self.objects.len() as u32 * groups;
        let each = || self.objects.iter().zip((0_u32..).step_by(groups as usize));
        renderer.surfaces(pass);
        each().for_each(|(object, first)| renderer.draw(pass, &object.buffers, &self.shared, first));
        if overlays.wire && renderer.wires(pass) {
            each().for_each(|(object, first)| {
                renderer.draw(pass, &object.buffers, &self.shared, all + first);
            });
        }
        if overlays.written {
            renderer.overlays(pass);
            for (object, first) in each() {
                for (group, range) in object.written.iter().flatten() {
                    let instance = 2 * all + first + *group as u32;
                    let ranges = std::iter::once(range.clone());
                    renderer.draw_some(pass, &object.buffers, &self.shared, *group, ranges, instance);
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
