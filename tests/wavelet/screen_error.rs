//! Promise: with conservative bounds no point of the surface is drawn farther from where it belongs than the tolerance, as the
//! eye sees it; bounds are nested; and a spheroid never asks for more triangles than Hoppe's shape.

use std::sync::Arc;

use crate::wavelet::{bases, buffer, hash, instance, on_surface, patchy, uniform};
use multires::adapt::Refinements;
use multires::lod::{Lod, Triangulation};
use multires::mesh::{Mesh, shapes};
use multires::view::{ErrorShape, ObjectView, View, look_at};
use multires::wavelet::{ErrorBound, Normals, WaveletMesh, WaveletOptions};

const HEIGHT: u32 = 480;
const FOV: f32 = 1.0;

fn options(bound: ErrorBound, shape: ErrorShape) -> WaveletOptions {
    WaveletOptions::default().with_bound(bound).with_shape(shape)
}

const ALL: [(ErrorBound, ErrorShape); 4] = [
    (ErrorBound::Conservative, ErrorShape::Spheroid),
    (ErrorBound::Conservative, ErrorShape::SphereAndCones),
    (ErrorBound::WithoutSiblings, ErrorShape::Spheroid),
    (ErrorBound::WithoutSiblings, ErrorShape::SphereAndCones),
];

#[test]
fn bounds_are_nested() {
    for (bound, shape) in ALL {
        let options = options(bound, shape);
        for (name, base) in bases() {
            for mesh in [uniform(&base, 4, 1, &options), patchy(&base, 4, 2, &options)] {
                for wavelet in 0..mesh.subdivision().wavelet_count() as u32 {
                    let own = Refinements::bounds(&mesh, wavelet);
                    for child in mesh.children(wavelet) {
                        let child_bounds = Refinements::bounds(&mesh, child);
                        assert!(own.contains(&child_bounds), "{name}: {own:?} {child_bounds:?}");
                        assert!(mesh.parents(child).any(|parent| parent == wavelet), "{name}");
                        assert!(child > wavelet);
                    }
                    assert!(mesh.children(wavelet).count() <= 6 || name == "book" || name == "pillow");
                    assert!(mesh.parents(wavelet).count() <= 2);
                }
            }
        }
    }
}

/// Where each vertex of the full resolution is drawn.
fn drawn(mesh: &WaveletMesh, view: &ObjectView) -> Vec<[f64; 3]> {
    let mesh = &Arc::new(mesh.clone());
    let mut lod = instance(mesh, &buffer(false));
    lod.adapt(std::slice::from_ref(view), 1.0 / 60.0);
    let places = mesh.vertices().positions();
    let of = mesh.subdivision();
    on_surface(mesh, |vertex| match of.wavelet_of(vertex) {
        Some(wavelet) if !lod.shows(wavelet) => None,
        _ => Some(places[vertex as usize]),
    })
}

/// Shares of the tolerance by which vertices and middles of faces at full resolution are drawn off.
fn screen_errors(mesh: &WaveletMesh, eye: [f32; 3], target: [f32; 3], pixels: f32) -> Vec<f64> {
    let view = View::perspective(look_at(eye, target, [0.0, 1.0, 0.0]), FOV, [640, HEIGHT])
        .unwrap()
        .with_tolerance_px(pixels)
        .with_frustum(false)
        .with_back_faces_culled(false);
    let shown = drawn(mesh, &view.of_world());
    let own: Vec<[f64; 3]> = mesh.vertices().positions().iter().map(|p| p.map(f64::from)).collect();
    let scale = 0.5 * f64::from(HEIGHT) / (0.5 * f64::from(FOV)).tan();
    let error = |own: [f64; 3], shown: [f64; 3]| {
        let to: [f64; 3] = std::array::from_fn(|i| own[i] - f64::from(eye[i]));
        let off: [f64; 3] = std::array::from_fn(|i| own[i] - shown[i]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let far = dot(to, to);
        let across = (dot(off, off) - dot(off, to).powi(2) / far).max(0.0);
        (across / far).sqrt() * scale / f64::from(pixels)
    };
    let mut errors: Vec<f64> = own.iter().zip(&shown).map(|(&own, &shown)| error(own, shown)).collect();
    let full = mesh.finest(Normals::Kept);
    // The full resolution has all vertices in their order.
    for t in full.triangles() {
        let middle = |all: &[[f64; 3]]| -> [f64; 3] {
            std::array::from_fn(|i| t.iter().map(|&v| all[v as usize][i]).sum::<f64>() / 3.0)
        };
        errors.push(error(middle(&own), middle(&shown)));
    }
    errors
}

fn models(options: &WaveletOptions) -> Vec<(&'static str, WaveletMesh)> {
    let recognise = |mesh: &Mesh| WaveletMesh::recognise(mesh, options).unwrap();
    vec![
        ("terrain", recognise(&shapes::terrain(65, 5))),
        ("rough sphere", uniform(&shapes::icosphere(0), 4, 3, options)),
        ("rough torus", uniform(&shapes::torus(1.0, 0.4, 5, 4), 4, 3, options)),
        ("smooth sphere", recognise(&shapes::icosphere(5))),
    ]
}

#[test]
fn conservative_bounds_are_never_exceeded() {
    for shape in [ErrorShape::Spheroid, ErrorShape::SphereAndCones] {
        for (name, mesh) in models(&options(ErrorBound::Conservative, shape)) {
            let mut coarse = 0;
            for seed in 0..12 {
                let place = |salt: u64, size: f64| -> [f32; 3] {
                    std::array::from_fn(|i| (size * (hash(seed, salt + i as u64) - 0.5)) as f32)
                };
                let (eye, target) = (place(1, if seed % 2 == 0 { 2.0 } else { 8.0 }), place(5, 1.0));
                for pixels in [0.5, 3.0, 20.0] {
                    let errors = screen_errors(&mesh, eye, target, pixels);
                    let worst = errors.iter().copied().fold(0.0, f64::max);
                    assert!(worst <= 1.0, "{name} from {eye:?} at {pixels} px: {worst} of the tolerance");
                    coarse += usize::from(worst > 0.05);
                }
            }
            assert!(coarse > 5, "{name} was never coarse");
        }
    }
}

/// The paper's bound is no upper bound: it is exceeded now and then, by little.
#[test]
fn without_siblings_bounds_are_exceeded_rarely() {
    for (name, mesh) in models(&options(ErrorBound::WithoutSiblings, ErrorShape::Spheroid)) {
        let (mut samples, mut over, mut worst) = (0, 0, 0.0_f64);
        for seed in 0..12 {
            let place = |salt: u64, size: f64| -> [f32; 3] {
                std::array::from_fn(|i| (size * (hash(seed, salt + i as u64) - 0.5)) as f32)
            };
            let (eye, target) = (place(1, if seed % 2 == 0 { 2.0 } else { 8.0 }), place(5, 1.0));
            for pixels in [0.5, 3.0, 20.0] {
                let errors = screen_errors(&mesh, eye, target, pixels);
                samples += errors.len();
                over += errors.iter().filter(|&&error| error > 1.0).count();
                worst = errors.into_iter().fold(worst, f64::max);
            }
        }
        println!("{name}: {over} of {samples} over the tolerance, at worst {worst:.3} of it");
        assert!((over as f64) < 0.01 * samples as f64 && worst < 2.0, "{name}: {over} of {samples}, {worst}");
    }
}

#[test]
fn a_spheroid_never_asks_for_more_than_hoppes_shape() {
    for bound in [ErrorBound::Conservative, ErrorBound::WithoutSiblings] {
        let [round, pointed] =
            [ErrorShape::Spheroid, ErrorShape::SphereAndCones].map(|s| models(&options(bound, s)));
        for ((name, round), (_, pointed)) in round.into_iter().zip(pointed) {
            let [mut round, mut pointed] =
                [round, pointed].map(|mesh| instance(&Arc::new(mesh), &buffer(false)));
            let (mut few, mut many) = (0, 0);
            for frame in 0..120 {
                let angle = frame as f32 * 0.1;
                let far = 4.0 - 0.025 * frame as f32;
                let eye = [far * angle.sin(), 0.4 * far, far * angle.cos()];
                let view =
                    View::perspective(look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]), FOV, [640, HEIGHT]).unwrap();
                let view = [view.with_tolerance_px(0.5).of_world()];
                let [a, b] = [&mut round, &mut pointed].map(|lod| lod.adapt(&view, 1.0 / 60.0).triangles);
                // Errors of all directions alike are balls to both, nearly.
                let room = if name.starts_with("rough") { b / 1000 } else { 0 };
                assert!(a <= b + room, "{name} {bound:?}, frame {frame}: {a} and {b}");
                (few, many) = (few + a, many + b);
            }
            println!("{name} {bound:?}: {few} and {many}");
            assert!(few <= many, "{name} {bound:?}: {few} and {many}");
        }
    }
}

/// The fewest vertices: of the same cut, minimal never has more triangles.
#[test]
fn minimal_has_no_more_triangles_than_exact() {
    for (_, mesh) in models(&WaveletOptions::default()) {
        for share in [0.01, 0.1, 0.5] {
            let count = |triangulation| {
                mesh.extract(|w| hash(u64::from(w), 3) < share, triangulation, Normals::Kept)
                    .triangles()
                    .len()
            };
            assert!(count(Triangulation::Minimal) <= count(Triangulation::Exact));
        }
    }
}
