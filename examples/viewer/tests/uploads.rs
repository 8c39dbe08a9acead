//! Promise: after the first frame only dirty ranges are uploaded, also where buffers grow; and what is on the card is, byte for
//! byte, what the level of detail holds.

mod card;

use card::{model, moving, open, read_back, shared};
use multires::lod::{Lod, LodOptions, Triangulation};
use multires::mesh::shapes;
use multires::view::View;
use multires_viewer::camera::{Lens, Orbit, Pose, Tolerances};
use multires_viewer::gpu::Gpu;
use multires_viewer::renderer::{LodBuffers, SharedBuffers, TRIANGLE, Uploaded, Uploads, Vertex};
use multires_viewer::scene::{BuildOptions, Model, StructureKind};

const LENS: Lens = Lens { field_of_view: 0.9, size: [1280, 720] };

fn view(pose: &Pose) -> View {
    pose.view(&LENS, &Tolerances::default()).unwrap()
}

/// A pose on a way around a model, so many frames from its start.
fn pose(model: &Model, frame: usize) -> Pose {
    let [low, high] = model.bounds();
    let centre = std::array::from_fn(|i| f64::from(low[i] + high[i]) * 0.5);
    let radius = (0..3).map(|i| f64::from(high[i] - low[i]).powi(2)).sum::<f64>().sqrt() * 0.5;
    let mut orbit = Orbit::framing(centre, radius, LENS.field_of_view, false);
    orbit.distance = radius * (1.3 + 0.2 * (frame as f64 * 0.1).sin());
    orbit.around = frame as f64 * 0.01;
    orbit.pose()
}

/// Bytes of the ranges that an instance says are dirty, of triangles and of vertices; those across a small gap together.
fn dirty(lod: &dyn Lod) -> [u64; 2] {
    let triangles: usize =
        (0..lod.groups()).flat_map(|g| lod.dirty_triangles(g, 4)).map(|range| range.len()).sum();
    let vertices: usize = lod.dirty_vertices(1).map(|range| range.len()).sum();
    [triangles as u64 * TRIANGLE, vertices as u64 * size_of::<Vertex>() as u64]
}

struct Flight {
    gpu: Gpu,
    instance: Box<dyn Lod>,
    buffers: LodBuffers,
    uploads: Uploads,
}

impl Flight {
    fn new(gpu: &Gpu, model: &Model, options: &LodOptions) -> Self {
        let instance = model.instance(options).unwrap();
        let (mut shared, mut uploads) = (SharedBuffers::default(), Uploads::default());
        shared.add(&gpu.device, &mut uploads, &*instance, model.vertices(), model.baked().morph_targets());
        let buffers = LodBuffers::new(&gpu.device, &*instance, &shared);
        let mut flight = Self { gpu: gpu.clone(), instance, buffers, uploads };
        let shares = flight.instance.shares_vertices();
        let uploaded = flight.flush();
        assert_eq!(uploaded.vertices, if shares { size_of_val(&model.vertices()[..]) as u64 } else { 0 });
        flight
    }

    fn flush(&mut self) -> Uploaded {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let uploaded = self.uploads.flush(&self.gpu.device, &self.gpu.queue, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        uploaded
    }

    fn frame(&mut self, pose: &Pose) -> Uploaded {
        self.instance.adapt(&[view(pose).of_world()], 1.0 / 60.0);
        let [indices, vertices] = dirty(&*self.instance);
        self.buffers.sync(&self.gpu.device, &mut self.uploads, &mut *self.instance);
        let uploaded = self.flush();
        assert_eq!((uploaded.indices, uploaded.vertices), (indices, vertices));
        uploaded
    }

    /// Compares all that is drawn.
    fn check(&self) {
        let lod = &*self.instance;
        for (group, (buffer, triangles)) in self.buffers.groups().enumerate() {
            let held: &[u8] = bytemuck::cast_slice(lod.triangles(group));
            assert_eq!(triangles, 0..lod.triangles(group).len() as u32);
            if !held.is_empty() {
                assert!(read_back(&self.gpu, buffer, held.len()) == held, "group {group} differs");
            }
        }
        if lod.shares_vertices() {
            return;
        }
        let held = lod.vertex_bytes();
        let buffer = self.buffers.vertices();
        assert!(read_back(&self.gpu, buffer, held.len()) == held, "vertices differ");
    }
}

#[test]
fn a_hundred_steady_frames_upload_dirty_ranges_alone() {
    let Some(gpu) = open("a_hundred_steady_frames_upload_dirty_ranges_alone") else { return };
    let rock = model(&shapes::rock(40_000, 3), &BuildOptions::default());
    let wavelets = BuildOptions::default().with_structure(StructureKind::Wavelet);
    let wavelets = model(&shapes::rock(81_920, 3), &wavelets);
    let fixed = shared();
    let compact = LodOptions::default();
    let minimal = compact.with_triangulation(Triangulation::Minimal);
    let kinds = [
        ("static", &rock, fixed),
        ("compact", &rock, compact),
        ("moving", &rock, moving(fixed, 0.2)),
        ("moving, compact", &rock, moving(compact, 0.2)),
        ("wavelets", &wavelets, fixed),
        ("wavelets, compact", &wavelets, compact),
        ("wavelets, compact, minimal", &wavelets, minimal),
        ("wavelets, moving", &wavelets, moving(fixed, 0.2)),
        ("wavelets, moving, compact", &wavelets, moving(compact, 0.2)),
    ];
    for (what, rock, settings) in kinds {
        let mut flight = Flight::new(&gpu, rock, &settings);
        for frame in 0..80 {
            flight.frame(&pose(rock, frame));
        }
        let (mut written, mut held) = (0, 0);
        for frame in 80..180 {
            let uploaded = flight.frame(&pose(rock, frame));
            written += uploaded.indices;
            held += flight.buffers.groups().map(|(_, drawn)| drawn.len() as u64 * TRIANGLE).sum::<u64>();
            assert_eq!(uploaded.grown, 0, "{what}: a buffer grew in frame {frame}");
        }
        assert!(written > 0, "{what}: nothing changed");
        assert!(written * 4 < held, "{what}: {written} of {held} bytes written");
        flight.check();

        // From the same place nothing changes; vertices may still be on their way for a while.
        let still = pose(rock, 179);
        for _ in 0..60 {
            flight.frame(&still);
        }
        assert_eq!(flight.frame(&still).bytes(), 0, "{what}: a still eye uploads");
        flight.check();
    }
    assert_eq!(gpu.error(), None);
}

#[test]
fn buffers_that_grow_hold_what_they_held() {
    let Some(gpu) = open("buffers_that_grow_hold_what_they_held") else { return };
    let (demo, rock) = (shapes::demo(), shapes::rock(81_920, 3));
    let structures =
        [(StructureKind::Hierarchy, &demo), (StructureKind::Tom, &demo), (StructureKind::Wavelet, &rock)];
    for (structure, mesh) in structures {
        let demo = model(mesh, &BuildOptions::default().with_structure(structure));
        for options in [shared(), LodOptions::default()] {
            let mut flight = Flight::new(&gpu, &demo, &options);
            let mut grown = 0;
            for frame in 0..40 {
                let mut pose = pose(&demo, frame);
                // From far away to close by and back.
                let away = 0.2 + 12.0 * (frame as f64 / 20.0 - 1.0).powi(2);
                pose.eye = std::array::from_fn(|i| pose.target[i] + away * (pose.eye[i] - pose.target[i]));
                grown += flight.frame(&pose).grown;
                flight.check();
            }
            assert!(grown > 0, "{structure:?}: no buffer ever grew");
        }
    }
    assert_eq!(gpu.error(), None);
}
