//! Ways to draw the same mesh, flown along the same path in turn: wavelets by bound, shape and triangulation, and a vertex hierarchy.

use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use multires::Simplifier;
use multires::hierarchy::{HierarchyLod, HierarchyOptions, VertexHierarchy};
use multires::lod::{Baked, Lod, LodOptions, Triangulation, Values, VertexBuffer};
use multires::mesh::Mesh;
use multires::view::{ErrorKind, ErrorShape, View};
use multires::wavelet::{ErrorBound, Normals, WaveletError, WaveletLod, WaveletMesh, WaveletOptions};

use super::flight::{Pose, VIEWPORT};

/// Bytes of a triangle's indices, and of a vertex (position and normal).
const TRIANGLE: usize = 12;
const VERTEX: usize = 24;

/// One frame of a flight. Times are microseconds.
#[derive(Clone, Copy)]
pub struct Frame {
    pub triangles: usize,
    pub refined: usize,
    pub tests: usize,
    pub changes: usize,
    pub adapt: f64,
    /// Of projecting the corners of what is drawn: in place of a renderer, whose work goes with triangles too.
    pub project: f64,
    pub bytes: usize,
}

/// One way to draw.
pub struct Racer {
    pub name: String,
    pub way: Way,
    /// Bytes of the structure beyond vertices, and of an instance after its flight.
    pub memory: [usize; 2],
    pub frames: Vec<Frame>,
}

pub enum Way {
    Wavelets(Arc<WaveletMesh>, Triangulation),
    Hierarchy(Arc<VertexHierarchy>, Arc<[[f32; 3]]>, ErrorKind),
}

/// Makes a wavelet mesh with bounds of one's choice.
pub type Build<'a> = &'a dyn Fn(&WaveletOptions) -> Result<WaveletMesh, WaveletError>;

/// All ways to draw, the default first.
pub fn racers(build: Build<'_>) -> Result<Vec<Racer>, Box<dyn Error>> {
    let mut racers = Vec::new();
    let mut enter = |name: String, way: Way, memory: usize| {
        racers.push(Racer { name, way, memory: [memory, 0], frames: Vec::new() });
    };
    let mut full = Mesh::default();
    let bounds = [("conservative", ErrorBound::Conservative), ("no siblings", ErrorBound::WithoutSiblings)];
    for (bound_name, bound) in bounds {
        let shapes = [("spheroid", ErrorShape::Spheroid), ("cones", ErrorShape::SphereAndCones)];
        for (shape_name, shape) in shapes {
            let mesh = Arc::new(build(&WaveletOptions::default().with_bound(bound).with_shape(shape))?);
            let memory = mesh.structure_memory();
            let name = |triangulation: &str| format!("{triangulation}, {bound_name}, {shape_name}");
            enter(name("exact"), Way::Wavelets(mesh.clone(), Triangulation::Exact), memory);
            if shape == ErrorShape::Spheroid {
                if full.triangles().is_empty() {
                    full = mesh.finest(Normals::Kept);
                }
                enter(name("minimal"), Way::Wavelets(mesh, Triangulation::Minimal), memory);
            }
        }
    }
    let sequence = Simplifier::new().run(&full)?;
    let model = Baked::<VertexHierarchy>::of_sequence(&full, &sequence, &HierarchyOptions::default())?;
    let positions: Arc<[[f32; 3]]> = model.vertices().positions().into();
    let hierarchy = model.structure();
    let kinds =
        [("vertex hierarchy", ErrorKind::Geometric), ("vertex hierarchy, parametric", ErrorKind::Parametric)];
    for (name, kind) in kinds {
        let way = Way::Hierarchy(hierarchy.clone(), positions.clone(), kind);
        enter(name.to_owned(), way, hierarchy.memory());
    }
    Ok(racers)
}

/// Flies all along the path, in turn, so many times; keeps the least time of each frame. `pixels` inside and on the silhouette.
pub fn race(
    racers: &mut [Racer],
    poses: &[Pose],
    pixels: [f32; 2],
    rounds: usize,
) -> Result<(), Box<dyn Error>> {
    for _ in 0..rounds {
        for racer in &mut *racers {
            let (frames, memory) = racer.way.fly(poses, pixels)?;
            racer.memory[1] = memory;
            if racer.frames.is_empty() {
                racer.frames = frames;
                continue;
            }
            for (least, frame) in racer.frames.iter_mut().zip(frames) {
                least.adapt = least.adapt.min(frame.adapt);
                least.project = least.project.min(frame.project);
            }
        }
    }
    Ok(())
}

/// Microseconds to project all triangles of the full resolution, which takes as long from everywhere: the least of some poses.
pub fn project_full(mesh: &Mesh, poses: &[Pose]) -> f64 {
    let time = |pose: &Pose| {
        let start = Instant::now();
        black_box(project(mesh.positions(), [mesh.triangles()].into_iter(), pose));
        start.elapsed().as_secs_f64() * 1e6
    };
    poses.iter().step_by(20).map(time).fold(f64::INFINITY, f64::min)
}

impl Way {
    fn fly(&self, poses: &[Pose], pixels: [f32; 2]) -> Result<(Vec<Frame>, usize), Box<dyn Error>> {
        match self {
            Self::Wavelets(mesh, triangulation) => {
                let values = Values::from(mesh.vertices().positions().to_vec()).with_blending();
                let drawing =
                    LodOptions::default().with_buffer(VertexBuffer::Whole).with_triangulation(*triangulation);
                let mut lod = WaveletLod::new(mesh.clone(), values, &drawing)?;
                let frames =
                    fly(&mut lod, poses, pixels, ErrorKind::default(), (&[], |lod, _| lod.values()))?;
                Ok((frames, lod.memory()))
            }
            Self::Hierarchy(hierarchy, positions, kind) => {
                let mut lod = HierarchyLod::new(hierarchy.clone());
                let frames = fly(&mut lod, poses, pixels, *kind, (positions, |_, fixed| fixed))?;
                Ok((frames, lod.memory()))
            }
        }
    }
}

/// Where vertices are drawn: by the instance, or always at the same places.
type Positions<L> = for<'a> fn(&'a L, &'a [[f32; 3]]) -> &'a [[f32; 3]];

fn fly<L: Lod>(
    lod: &mut L,
    poses: &[Pose],
    pixels: [f32; 2],
    kind: ErrorKind,
    (fixed, positions): (&[[f32; 3]], Positions<L>),
) -> Result<Vec<Frame>, Box<dyn Error>> {
    let mut frames = Vec::with_capacity(poses.len());
    let mut refined = 0;
    for pose in poses {
        let view: View = pose.view(VIEWPORT)?.with_tolerance_px(pixels[0]).with_silhouette_px(pixels[1]);
        let views = [view.with_error(kind).of_world()];
        let start = Instant::now();
        let change = lod.adapt(&views, 1.0 / 60.0);
        let adapted = start.elapsed();
        let groups = (0..lod.groups()).map(|group| lod.triangles(group));
        black_box(project(positions(lod, fixed), groups, pose));
        let all = start.elapsed();
        refined = refined + change.cut.splits - change.cut.collapses;
        let triangles = (0..lod.groups()).flat_map(|group| lod.dirty_triangles(group, 0));
        let triangles: usize = triangles.map(|range| range.len()).sum();
        let vertices: usize = lod.dirty_vertices(0).map(|range| range.len()).sum();
        frames.push(Frame {
            triangles: change.triangles,
            refined,
            tests: change.cut.tests,
            changes: change.cut.splits + change.cut.collapses,
            adapt: adapted.as_secs_f64() * 1e6,
            project: (all - adapted).as_secs_f64() * 1e6,
            bytes: TRIANGLE * triangles + VERTEX * vertices,
        });
        lod.clean();
    }
    Ok(frames)
}

/// Projects the corners of all triangles and counts those that face the eye.
fn project<'a>(positions: &[[f32; 3]], groups: impl Iterator<Item = &'a [[u32; 3]]>, pose: &Pose) -> usize {
    let rows = pose.axes().map(DVec3::as_vec3);
    let eye = pose.eye.as_vec3();
    let mut facing = 0;
    for triangle in groups.flatten() {
        let [a, b, c] = triangle.map(|v| {
            let p = glam::Vec3::from_array(positions[v as usize]) - eye;
            let [x, y, z] = rows.map(|row| row.dot(p));
            [x / z, y / z]
        });
        facing += usize::from((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]));
    }
    facing
}
