//! An instance through any frames: what uploads put on a card is what the instance holds and says that it draws, and in the end it is
//! as a new instance would be.

use std::collections::BTreeMap;

use multires::lod::{Baked, Lod, LodOptions, Structure, Values};
use multires::mesh::Mesh;

use super::choices::Choices;
use super::edges::Edges;
use super::gpu::Gpu;
use super::options::{lod_options, view};

/// What is promised of everything that an instance draws.
#[derive(Clone, Copy)]
pub struct Promise {
    /// Edges have an even number of triangles, by the places of their ends.
    pub is_closed: bool,
    /// At rest vertices lie at the very places that the mesh says. Where halves round, sums of wavelets differ in the last bit.
    pub is_exact: bool,
    /// Two triangles an edge at rest, and so many points and triangles less edges.
    pub euler: Option<i64>,
}

type Corners = [[u32; 3]; 3];

/// Triangles by material and places, in whatever order they lie and from whichever corner they start.
fn counted(triangles: impl Iterator<Item = (u32, Corners)>) -> BTreeMap<(u32, Corners), usize> {
    let mut count = BTreeMap::new();
    for (material, mut corners) in triangles {
        let least = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
        corners.rotate_left(least);
        *count.entry((material, corners)).or_default() += 1;
    }
    count
}

fn triangles(mesh: &Mesh) -> impl Iterator<Item = (u32, Corners)> + '_ {
    let place = |v: u32| mesh.positions()[v as usize].map(f32::to_bits);
    (0..).zip(mesh.triangles()).map(move |(t, corners): (usize, _)| {
        (mesh.materials().get(t).copied().unwrap_or(u32::MAX), corners.map(place))
    })
}

struct Flight<'a> {
    lod: Box<dyn Lod>,
    gpu: Gpu,
    shared: Vec<[f32; 3]>,
    kind: &'static str,
    promise: Promise,
    mesh: &'a Mesh,
}

impl Flight<'_> {
    /// Applies what was written, and holds it against the instance.
    fn draw(&mut self, at_rest: bool) {
        let Self { lod, gpu, kind, .. } = self;
        gpu.upload(&**lod);
        lod.clean();
        if !lod.shares_vertices() {
            assert!(gpu.held(0, lod.vertex_bytes().len()) == lod.vertex_bytes(), "{kind}: vertices");
        }
        for group in 0..lod.groups() {
            let indices: &[u8] = bytemuck::cast_slice(lod.buffered_triangles(group));
            assert!(gpu.held(1 + group, indices.len()) == indices, "{kind}: group {group}");
        }
        let drawn = gpu.draw(&**lod, &self.shared);
        let places = || drawn.iter().map(|(material, t)| (*material, t.map(|p| p.map(f32::to_bits))));
        let edges = Edges::of(drawn.iter().map(|(_, t)| *t));
        assert!(!self.promise.is_closed || edges.are_even(), "{kind}: a closed mesh has opened");
        if at_rest {
            let said = counted(triangles(&lod.to_mesh()));
            assert!(!self.promise.is_exact || counted(places()) == said, "{kind}: drawn and said");
            if let Some(euler) = self.promise.euler {
                assert!(edges.are_two(), "{kind}: an edge of other than two triangles");
                assert_eq!(edges.euler(), euler, "{kind}");
            }
        }
    }

    fn frame(&mut self, choices: &mut Choices<'_>) {
        let before = *self.lod.options();
        let mut moving = false;
        match choices.below(16) {
            0 => {
                let options = lod_options(choices);
                let was_shared = self.lod.shares_vertices();
                self.lod.set_options(&options).expect("values that blend");
                if options.buffer != before.buffer
                    || options.triangulation != before.triangulation
                    || options.geomorph.is_some() != before.geomorph.is_some()
                {
                    self.lose();
                }
                if self.lod.shares_vertices() && !was_shared {
                    self.shared = bytemuck::cast_slice(self.lod.vertex_bytes()).to_vec();
                }
                moving = true;
            }
            1 => {
                self.lod.set_tolerance_factor(choices.one(&[0.5, 1.0, 3.0, 0.0, f32::INFINITY, f32::NAN]));
                moving = true;
            }
            2 => self.lod.settle(),
            3 => moving = self.lod.refine_fully().moving > 0,
            4 => {
                self.lose();
                moving = true;
            }
            _ => {
                let count = choices.one(&[1, 1, 1, 1, 0, 2, 3]);
                let views: Vec<_> = (0..count).filter_map(|_| view(choices, self.mesh)).collect();
                let seconds = choices.one(&[0.016, 0.1, 0.0, 5.0, -1.0, f32::NAN, f32::INFINITY]);
                moving = self.lod.adapt(&views, seconds).moving > 0;
            }
        }
        self.draw(!moving);
    }

    fn lose(&mut self) {
        self.gpu = Gpu::default();
        self.lod.invalidate();
    }
}

/// Flies an instance of a model. Returns whether there is anything to draw.
pub fn fly<S: Structure>(choices: &mut Choices<'_>, mesh: &Mesh, model: &Baked<S>, promise: Promise) -> bool {
    let values: Values<[f32; 3]> = model.values(|v| model.vertices().positions()[v]).with_blending();
    let make = |options: &LodOptions| -> Box<dyn Lod> {
        Box::new(model.instance(values.clone(), options).expect("values that blend"))
    };
    let options = lod_options(choices);
    let shared = values.shared().to_vec();
    let mut flight =
        Flight { lod: make(&options), gpu: Gpu::default(), shared, kind: S::KIND, promise, mesh };
    flight.draw(true);
    for _ in 0..50 {
        if choices.is_over() {
            break;
        }
        flight.frame(choices);
    }
    // What it has seen before makes no difference.
    let views: Vec<_> = view(choices, mesh).into_iter().collect();
    let options = flight.lod.options().with_triangles(None).with_operations(None).with_geomorph(None);
    let mut new = make(&options);
    new.set_tolerance_factor(flight.lod.tolerance_factor());
    flight.lod.set_options(&options).expect("values that blend");
    for lod in [&mut flight.lod, &mut new] {
        lod.adapt(&views, 1.0);
        lod.settle();
    }
    assert_eq!(flight.lod.refinements(), new.refinements(), "{}: as a new one", S::KIND);
    let [held, fresh] = [&flight.lod, &new].map(|lod| counted(triangles(&lod.to_mesh())));
    assert!(held == fresh, "{}: as a new one", S::KIND);
    !fresh.is_empty()
}
