//! Promise: bounds hold what leaving wavelets out moves, however many levels there are below.

use crate::wavelet::{hash, on_surface, rough, uniform};
use multires::adapt::Refinements;
use multires::mesh::shapes;
use multires::view::ErrorShape;
use multires::wavelet::{ErrorBound, WaveletBuilder, WaveletMesh, WaveletOptions};

/// Many levels, with details that fall fast, slowly, or are large where they are fine.
fn meshes(options: &WaveletOptions) -> Vec<(&'static str, WaveletMesh)> {
    let mut smooth = WaveletBuilder::new(&shapes::icosphere(0)).unwrap();
    for _ in 0..6 {
        let place = |p: [f32; 3]| p.map(|x| x / p.iter().map(|x| x * x).sum::<f32>().sqrt());
        smooth.subdivide(|midpoint| place(midpoint.middle)).unwrap();
    }
    let mut spiky = WaveletBuilder::new(&shapes::terrain(2, 1)).unwrap();
    let mut patchy = WaveletBuilder::new(&shapes::torus(1.0, 0.4, 5, 3)).unwrap();
    let mut count = 0;
    for level in 0..7 {
        let spike = |p: [f32; 3]| [p[0], p[1] + 0.001 * (level * level) as f32, p[2]];
        spiky.subdivide(|midpoint| spike(midpoint.middle)).unwrap();
        let half = |_: &multires::wavelet::Face| {
            count += 1;
            hash(count, 3) < 0.5
        };
        patchy.subdivide_where(half, rough(5, 0.2)).unwrap();
    }
    vec![
        ("smooth", smooth.build(options).unwrap()),
        ("spiky", spiky.build(options).unwrap()),
        ("rough", uniform(&shapes::terrain(2, 1), 7, 3, options)),
        ("patchy", patchy.build(options).unwrap()),
    ]
}

/// How far any vertex is from where it is on the surface of a set of wavelets.
fn off(mesh: &WaveletMesh, set: &[bool]) -> f64 {
    let of = mesh.subdivision();
    let places = mesh.vertices().positions();
    let is_in = |vertex: u32| of.wavelet_of(vertex).is_none_or(|wavelet| set[wavelet as usize]);
    let on = on_surface(mesh, |vertex| is_in(vertex).then(|| places[vertex as usize]));
    let distance = |(on, place): (&[f64; 3], &[f32; 3])| {
        (0..3).map(|i| (on[i] - f64::from(place[i])).powi(2)).sum::<f64>().sqrt()
    };
    on.iter().zip(places).map(distance).fold(0.0, f64::max)
}

#[test]
fn any_set_is_as_near_as_its_bounds_say() {
    for shape in [ErrorShape::Spheroid, ErrorShape::SphereAndCones] {
        for (name, mesh) in meshes(&WaveletOptions::default().with_shape(shape)) {
            let far: Vec<f32> = (0..mesh.subdivision().wavelet_count() as u32)
                .map(|wavelet| Refinements::bounds(&mesh, wavelet).largest_error())
                .collect();
            let most = far.iter().copied().fold(0.0, f32::max);
            for share in [1.0, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01] {
                let tolerance = share * most;
                let needed = |wavelet: u32| far[wavelet as usize] > tolerance;
                let off_needed = off(&mesh, &mesh.closure(needed));
                assert!(off_needed <= f64::from(tolerance), "{name}: {off_needed} for {tolerance}");
                // And with any more of them.
                let more = mesh.closure(|w| needed(w) || hash(u64::from(w), 9) < 0.05);
                assert!(off(&mesh, &more) <= f64::from(tolerance), "{name}");
            }
            assert!(off(&mesh, &vec![false; far.len()]) > 0.25 * f64::from(most), "{name}: far too wide");
        }
    }
}

#[test]
fn levels_are_as_near_as_bounds_without_siblings_say() {
    for shape in [ErrorShape::Spheroid, ErrorShape::SphereAndCones] {
        let options = WaveletOptions::default().with_shape(shape).with_bound(ErrorBound::WithoutSiblings);
        for (name, mesh) in meshes(&options) {
            let of = mesh.subdivision();
            for level in 0..of.depth() {
                let start = of.wavelets_of(level + 1).start;
                let largest = of
                    .wavelets_of(level + 1)
                    .map(|wavelet| Refinements::bounds(&mesh, wavelet).largest_error())
                    .fold(0.0, f32::max);
                let set: Vec<bool> = (0..of.wavelet_count() as u32).map(|wavelet| wavelet < start).collect();
                let off = off(&mesh, &set);
                assert!(off <= f64::from(largest), "{name}, level {level}: {off} for {largest}");
                assert!(off >= 0.35 * f64::from(largest), "{name}, level {level}: far too wide, {largest}");
            }
        }
    }
}
