//! What tests of wavelet meshes share.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::sync::Arc;

use multires::lod::{Lod, LodOptions, Values, Vertex, VertexBuffer};
use multires::mesh::{Mesh, shapes};
use multires::view::{Answer, Criterion, DeviationBounds, Motion, View, look_at};
use multires::wavelet::{Face, Midpoint, WaveletBuilder, WaveletLod, WaveletMesh, WaveletOptions};

/// A number from 0 to 1 that looks random.
pub fn hash(a: u64, b: u64) -> f64 {
    let mut x = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_mul(0xd6e8_feb8_6659_fd93);
    x ^= x >> 32;
    x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (x >> 40) as f64 / (1u64 << 24) as f64
}

/// Midpoints moved by a share of their edge, the same for the same edge.
pub fn rough(seed: u64, share: f32) -> impl Fn(&Midpoint) -> [f32; 3] {
    move |midpoint| {
        let [a, b] = midpoint.positions;
        let length = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt();
        let key = u64::from(midpoint.ends[0]) << 32 | u64::from(midpoint.ends[1]);
        std::array::from_fn(|i| {
            let random = hash(key ^ seed, i as u64) as f32 - 0.5;
            midpoint.middle[i] + share * length * random
        })
    }
}

/// A base mesh split so often everywhere, with rough midpoints.
pub fn uniform(base: &Mesh, levels: usize, seed: u64, options: &WaveletOptions) -> WaveletMesh {
    let mut builder = WaveletBuilder::new(base).unwrap();
    for _ in 0..levels {
        builder.subdivide(rough(seed, 0.25)).unwrap();
    }
    builder.build(options).unwrap()
}

/// The same, but faces are split or not at random.
pub fn patchy(base: &Mesh, levels: usize, seed: u64, options: &WaveletOptions) -> WaveletMesh {
    let mut builder = WaveletBuilder::new(base).unwrap();
    for level in 0..levels {
        let split = |face: &Face| {
            let key = face
                .corners
                .as_flattened()
                .iter()
                .fold(seed, |h, x| h.rotate_left(7) ^ u64::from(x.to_bits()));
            level == 0 && face.base_face % 3 != 1 || hash(key, 7) < 0.4
        };
        builder.subdivide_where(split, rough(seed, 0.25)).unwrap();
    }
    builder.build(options).unwrap()
}

/// Base meshes of all kinds: closed, open, non-manifold, pinched, not orientable, several pieces.
pub fn bases() -> Vec<(&'static str, Mesh)> {
    vec![
        ("tetrahedron", shapes::tetrahedron()),
        ("icosahedron", shapes::icosphere(0)),
        ("torus", shapes::torus(1.0, 0.4, 7, 4)),
        ("terrain", shapes::terrain(3, 1)),
        ("book", shapes::book(5)),
        ("bowtie", shapes::bowtie()),
        ("moebius", shapes::moebius(9)),
        ("pillow", shapes::pillow()),
        ("touching", shapes::two_spheres_touching(0)),
        ("seams", shapes::box_with_face_normals(1)),
    ]
}

/// How often each edge is used: by vertices, or where there are seams by positions.
pub fn edge_counts(mesh: &Mesh) -> BTreeMap<[[u32; 3]; 2], usize> {
    let mut counts = BTreeMap::new();
    let seams = !mesh.attributes().is_empty();
    let at = |v: u32| if seams { mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits()) } else { [v; 3] };
    for t in mesh.triangles() {
        for k in 0..3 {
            let mut ends = [at(t[k]), at(t[(k + 1) % 3])];
            ends.sort_unstable();
            *counts.entry(ends).or_insert(0) += 1;
        }
    }
    counts
}

/// The drawn triangles of all groups as vertices of the mesh, each from its lowest corner on, in order.
pub fn drawn<V: Vertex>(lod: &WaveletLod<V>) -> Vec<[u32; 3]> {
    let mut all: Vec<[u32; 3]> = (0..lod.groups()).flat_map(|group| lod.triangles(group).to_vec()).collect();
    if let Some(vertices) = lod.vertices() {
        all.iter_mut().for_each(|t| *t = t.map(|slot| vertices[slot as usize]));
    }
    all.iter_mut().for_each(|t| {
        let low = (0..3).min_by_key(|&k| t[k]).unwrap();
        t.rotate_left(low);
    });
    all.sort_unstable();
    all
}

/// Where the corners of the drawn triangles are, in the same order of triangles for the same surface.
pub fn drawn_positions(lod: &WaveletLod<[f32; 3]>) -> Vec<[[f32; 3]; 3]> {
    let mut all: Vec<[[f32; 3]; 3]> = (0..lod.groups())
        .flat_map(|group| lod.triangles(group).iter().map(|t| t.map(|v| lod.values()[v as usize])))
        .collect();
    sort(&mut all);
    all
}

/// The triangles of a mesh the same way.
pub fn positions(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    let mut all: Vec<[[f32; 3]; 3]> =
        mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize])).collect();
    sort(&mut all);
    all
}

fn sort(all: &mut [[[f32; 3]; 3]]) {
    let key = |p: &[f32; 3]| p.map(|x| (x + 0.0).to_bits());
    for t in all.iter_mut() {
        let low = (0..3).min_by_key(|&k| key(&t[k])).unwrap();
        t.rotate_left(low);
    }
    all.sort_unstable_by_key(|t| t.map(|p| key(&p)));
}

/// An eye somewhere about an object, looking at some point of it.
pub fn view(mesh: &WaveletMesh, seed: u64, tolerance: f32) -> View {
    let [low, high] = mesh.extent().unwrap();
    let size = mesh.diagonal() as f32;
    let middle: [f32; 3] = std::array::from_fn(|i| 0.5 * low[i] + 0.5 * high[i]);
    // No eye can be further away than numbers reach, however far a forged mesh is.
    let offset = |salt: u64, scale: f32| -> [f32; 3] {
        let place = |i: usize| middle[i] + scale * (hash(seed, salt + i as u64) as f32 - 0.5);
        std::array::from_fn(|i| place(i).clamp(-1e30, 1e30))
    };
    let eye = offset(10, size * if seed.is_multiple_of(3) { 4.0 } else { 1.2 });
    let target = offset(20, size * 0.5);
    let up = [0.0, 1.0, 0.0];
    View::perspective(look_at(eye, target, up), 60_f32.to_radians(), [640, 480])
        .unwrap()
        .with_tolerance_px(tolerance)
}

/// Options of a buffer of the vertices in use alone, or of all.
pub fn buffer(packed: bool) -> LodOptions {
    LodOptions::default().with_buffer(if packed { VertexBuffer::Packed } else { VertexBuffer::Whole })
}

/// An instance of positions.
pub fn instance(mesh: &Arc<WaveletMesh>, options: &LodOptions) -> WaveletLod<[f32; 3]> {
    let positions: Arc<[[f32; 3]]> = mesh.vertices().positions().into();
    WaveletLod::new(Arc::clone(mesh), Values::from(positions).with_blending(), options).unwrap()
}

/// Needs what it is told, as a set closed under parents; knows wavelets by where they are.
#[derive(Clone)]
pub struct Given {
    of_place: BTreeMap<[u32; 3], bool>,
    pub seen: bool,
}

impl Given {
    /// The closure of a random set. Places must differ.
    pub fn random(mesh: &WaveletMesh, seed: u64, share: f64) -> Self {
        Self::new(mesh, |wavelet| hash(u64::from(wavelet) + 1, seed) < share)
    }

    pub fn new(mesh: &WaveletMesh, asked: impl Fn(u32) -> bool) -> Self {
        let set = mesh.closure(asked);
        let place = |wavelet: usize| {
            let vertex = mesh.subdivision().vertex_of(wavelet as u32);
            mesh.vertices().positions()[vertex as usize].map(f32::to_bits)
        };
        let of_place: BTreeMap<_, _> = set.iter().enumerate().map(|(w, &asked)| (place(w), asked)).collect();
        assert_eq!(of_place.len(), set.len(), "two wavelets at one place");
        Self { of_place, seen: true }
    }
}

impl Criterion<DeviationBounds> for Given {
    fn test(&self, bounds: &DeviationBounds) -> Answer {
        Answer::once(self.of_place[&bounds.centre.map(f32::to_bits)])
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }

    fn sees(&self, _: &DeviationBounds) -> bool {
        self.seen
    }
}

/// Where every vertex of the full resolution is on the surface that is drawn: its own place on the way, or the middle of its
/// ends where it is not drawn.
pub fn on_surface(mesh: &WaveletMesh, value: impl Fn(u32) -> Option<[f32; 3]>) -> Vec<[f64; 3]> {
    let of = mesh.subdivision();
    let mut places: Vec<[f64; 3]> = Vec::new();
    for vertex in 0..of.vertex_count() as u32 {
        let ends = of.ends(vertex).map(|ends| ends.map(|end| places[end as usize]));
        let place = value(vertex).map(|x| x.map(f64::from));
        places.push(place.unwrap_or_else(|| {
            let [a, b] = ends.unwrap();
            std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
        }));
    }
    places
}
