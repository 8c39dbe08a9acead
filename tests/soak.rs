//! Promise: an instance lives as long as a game. After any number of frames of any views, budgets and options it holds what a new one
//! would, and its memory has stopped growing.
//!
//! `MULTIRES_SOAK=1000000 cargo test --release --test soak` runs a million frames.

#[path = "../examples/support/asset.rs"]
mod asset;
mod support;

use std::collections::BTreeMap;

use asset::{Asset, Vertex};
use multires::adapt::Geomorph;
use multires::lod::{Baked, Lod, LodOptions, Structure, Triangulation, Values, VertexBuffer};
use multires::mesh::{Attribute, Mesh, names};
use multires::view::ObjectView;
use multires::{Gmesh, TotallyOrderedMesh, VertexHierarchy, WaveletMesh};
use peak_alloc::PeakAlloc;
use support::lod::view;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Frames of all structures together where nobody asks for more.
const FRAMES: u64 = 6_000;
/// Frames between comparisons with a new instance.
const BETWEEN: u64 = 1_000;

/// Numbers without end (Steele et al. 2014, SplitMix).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }

    fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1 << 24) as f32
    }
}

type Make = Box<dyn Fn(&LodOptions) -> Box<dyn Lod>>;

fn maker<S: Structure>(mesh: &Mesh, asset: &Asset) -> Make {
    let Ok(model) = S::bake(mesh) else { panic!("{} of it", S::KIND) };
    let model: Baked<S> = model;
    let values: Values<Vertex> = model.arrange(&asset.vertices).unwrap().with_blending();
    Box::new(move |options| Box::new(model.instance(values.clone(), options).unwrap()))
}

/// One instance, and where its eye is.
struct Life {
    make: Make,
    lod: Box<dyn Lod>,
    eye: [f32; 3],
    turn: f32,
    views: Vec<ObjectView>,
    /// Frames in which what is drawn has changed.
    changes: u64,
}

impl Life {
    fn new(make: Make) -> Self {
        let lod = make(&LodOptions::default());
        Self { make, lod, eye: [0.0, 0.3, 1.5], turn: 0.0, views: Vec::new(), changes: 0 }
    }

    fn frame(&mut self, mesh: &Mesh, random: &mut Random) {
        match random.below(400) {
            0 => self.lod.set_options(&options(random)).unwrap(),
            1 => self.lod.set_tolerance_factor(random.between(0.3, 3.0)),
            2 => self.lod.settle(),
            3 => drop(self.lod.refine_fully()),
            4 => self.lod.invalidate(),
            // A jump.
            5 => self.eye = [random.between(-1.5, 1.5), random.between(0.0, 1.0), random.between(0.1, 4.0)],
            _ => {}
        }
        let step = if random.below(4) == 0 { 0.0 } else { random.between(0.0, 0.02) };
        for (at, [low, high]) in self.eye.iter_mut().zip([[-1.5, 1.5], [0.0, 1.0], [0.1, 4.0]]) {
            *at = (*at + step * random.between(-1.0, 1.0)).clamp(low, high);
        }
        self.turn = (self.turn + step * random.between(-1.0, 1.0)).clamp(-0.6, 0.6);
        self.views.clear();
        if random.below(50) != 0 {
            self.views.push(view(mesh, self.eye, self.turn, 4.0).of_world());
        }
        self.lod.adapt(&self.views, random.between(0.0, 0.04));
        self.changes += u64::from(self.lod.uploads().next().is_some());
        if random.below(3) != 0 {
            self.lod.clean();
        }
    }

    /// Lets the instance come to rest, and compares it with one that has seen nothing before.
    fn assert_as_new(&mut self) {
        let options = self.lod.options().with_triangles(None).with_operations(None).with_geomorph(None);
        let mut new = (self.make)(&options);
        new.set_tolerance_factor(self.lod.tolerance_factor());
        self.lod.set_options(&options).unwrap();
        for lod in [&mut self.lod, &mut new] {
            lod.adapt(&self.views, 1.0);
            lod.settle();
            lod.clean();
        }
        assert_eq!(self.lod.refinements(), new.refinements());
        assert!(counted(&self.lod.to_mesh()) == counted(&new.to_mesh()));
    }
}

fn options(random: &mut Random) -> LodOptions {
    let buffer = [VertexBuffer::Packed, VertexBuffer::Whole, VertexBuffer::Shared][random.below(3) as usize];
    let geomorph = (random.below(2) == 0).then(|| random.between(0.05, 0.4));
    let triangulation = [Triangulation::Minimal, Triangulation::Exact][random.below(2) as usize];
    LodOptions::default()
        .with_buffer(buffer)
        .with_geomorph(geomorph.map(|seconds| Geomorph::default().with_duration(seconds)))
        .with_triangles((random.below(2) == 0).then(|| 50 + random.below(3_000) as usize))
        .with_operations((random.below(2) == 0).then(|| 1 + random.below(400) as usize))
        .with_triangulation(triangulation)
}

/// Triangles by material and the places of their corners, in whatever order they lie.
fn counted(mesh: &Mesh) -> BTreeMap<(u32, [[u32; 3]; 3]), usize> {
    let mut count = BTreeMap::new();
    for (triangle, &material) in mesh.triangles().iter().zip(mesh.materials()) {
        let mut corners = triangle.map(|v| mesh.positions()[v as usize].map(f32::to_bits));
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
        corners.rotate_left(least);
        *count.entry((material, corners)).or_default() += 1;
    }
    count
}

#[test]
fn nothing_drifts_and_nothing_grows() {
    let frames = std::env::var("MULTIRES_SOAK").ok().and_then(|frames| frames.parse().ok()).unwrap_or(FRAMES);
    let asset = asset::patch(24);
    let mesh = Mesh::from_vertices(&asset.vertices, &asset.indices, |v| v.position)
        .unwrap()
        .with_attribute(Attribute::of(names::UV, &asset.vertices, |v| v.uv))
        .unwrap()
        .with_material_ranges(&asset.ranges)
        .unwrap();
    let mut random = Random(1);
    let mut lives = [
        maker::<VertexHierarchy>(&mesh, &asset),
        maker::<TotallyOrderedMesh>(&mesh, &asset),
        maker::<WaveletMesh>(&mesh, &asset),
        maker::<Gmesh>(&mesh, &asset),
    ]
    .map(Life::new);
    // Most memory in use after a frame, by quarters of the run.
    let mut most = [0; 4];
    for frame in 0..frames {
        let life = &mut lives[random.below(4) as usize];
        life.frame(&mesh, &mut random);
        if frame % BETWEEN == BETWEEN - 1 {
            lives.iter_mut().for_each(Life::assert_as_new);
        }
        let quarter = &mut most[(4 * frame / frames) as usize];
        *quarter = ALLOCATOR.current_usage().max(*quarter);
    }
    let changes = lives.map(|life| life.changes);
    assert!(changes.iter().all(|&changes| changes > frames / 200), "{changes:?}");
    eprintln!("{frames} frames, of which {changes:?} changed something; bytes by quarters: {most:?}");
    assert!(most[3] <= most[1] + most[1] / 20, "{most:?}");
}
