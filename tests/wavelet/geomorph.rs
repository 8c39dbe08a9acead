//! Promise: coefficients grow and shrink, each at its speed (Azuma et al., equation 6), whatever happens around; no point of the
//! surface jumps, and at rest everything is at its place.

use std::sync::Arc;

use crate::wavelet::{
    Given, bases, buffer, drawn_positions, instance, on_surface, patchy, positions, uniform,
};
use multires::adapt::Geomorph;
use multires::lod::{Lod, Triangulation};
use multires::mesh::shapes;
use multires::view::{Motion, View, look_at};
use multires::wavelet::{Normals, WaveletLod, WaveletMesh, WaveletOptions};
use proptest::prelude::*;

type Place = [f32; 3];

fn slow() -> Geomorph {
    Geomorph::default().with_duration(1.0).with_travel(f32::INFINITY).with_turn(f32::INFINITY)
}

/// A copy of the vertex buffer, kept by dirty ranges alone.
fn upload(lod: &mut WaveletLod<Place>, buffer: &mut Vec<Place>, gap: usize) {
    buffer.resize(lod.values().len(), [f32::NAN; 3]);
    for range in lod.dirty_vertices(gap) {
        buffer[range.clone()].copy_from_slice(&lod.values()[range]);
    }
    lod.clean();
}

/// Where the vertices of the full resolution are on what is drawn.
fn surface(mesh: &WaveletMesh, lod: &WaveletLod<Place>) -> Vec<[f64; 3]> {
    let of = mesh.subdivision();
    on_surface(mesh, |vertex| match of.wavelet_of(vertex) {
        Some(wavelet) if !lod.shows(wavelet) => None,
        _ => lod.value(vertex),
    })
}

/// The share of its coefficient that a wavelet has, and by how much its vertex is off that, of the coefficient's length.
fn weight(mesh: &WaveletMesh, lod: &WaveletLod<Place>, wavelet: u32) -> (f64, f64) {
    let of = mesh.subdivision();
    let vertex = of.vertex_of(wavelet);
    let s = mesh.coefficient(vertex).unwrap();
    let [a, b] = of.ends(vertex).unwrap().map(|end| lod.value(end).unwrap().map(f64::from));
    let own = lod.value(vertex).unwrap().map(f64::from);
    let off: [f64; 3] = std::array::from_fn(|i| own[i] - 0.5 * (a[i] + b[i]));
    let square: f64 = s.iter().map(|x| x * x).sum();
    let weight = (0..3).map(|i| off[i] * s[i]).sum::<f64>() / square;
    let rest: f64 = (0..3).map(|i| (off[i] - weight * s[i]).powi(2)).sum::<f64>();
    (weight, (rest / square).sqrt())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn nothing_jumps_and_equation_6_holds(
        base in 0usize..9,
        is_patchy in any::<bool>(),
        packed in any::<bool>(),
        operations in prop_oneof![Just(None), (1usize..30).prop_map(Some)],
        triangles in prop_oneof![Just(None), (0usize..300).prop_map(Some)],
        steps in prop::collection::vec((0u64..4, 0.0..1.0, prop::collection::vec(0usize..5, 1..6)), 1..8),
    ) {
        let (name, base) = bases().swap_remove(base);
        let make = if is_patchy { patchy } else { uniform };
        let mesh = Arc::new(make(&base, 3, 1, &WaveletOptions::default()));
        let options = buffer(packed).with_geomorph(Some(slow()));
        let options = options.with_operations(operations).with_triangles(triangles);
        let mut lod = instance(&mesh, &options);
        let longest = (0..mesh.subdivision().wavelet_count() as u32)
            .map(|w| mesh.coefficient(mesh.subdivision().vertex_of(w)).unwrap())
            .map(|s| s.iter().map(|x| x * x).sum::<f64>().sqrt())
            .fold(0.0, f64::max);
        let mut before = surface(&mesh, &lod);
        let mut buffer = Vec::new();
        for (seed, share, frames) in steps {
            let asked = Given::random(&mesh, seed, share);
            for frame in frames {
                let seconds = [0.0, 0.002, 0.05, 0.3, 0.6][frame];
                let change = lod.adapt_by(&asked, Motion::Other, seconds);
                prop_assert!(operations.is_none_or(|most| change.cut.splits + change.cut.collapses <= most), "{}", name);
                prop_assert!(triangles.is_none_or(|most| change.triangles <= most || change.over_budget));
                prop_assert_eq!(change.moving, lod.moving());
                let now = surface(&mesh, &lod);
                // Weights change by the time that passed, on each of three levels.
                let farthest = f64::from(seconds) * longest * 3.0 + 1e-5 * longest + 1e-6;
                for (a, b) in before.iter().zip(&now) {
                    let far = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                    prop_assert!(far <= farthest, "{}: {} of {} in {}", name, far, longest, seconds);
                }
                before = now;
                for wavelet in (0..mesh.subdivision().wavelet_count() as u32).filter(|&w| lod.shows(w)) {
                    let (weight, off) = weight(&mesh, &lod, wavelet);
                    prop_assert!((-1e-3..=1.001).contains(&weight) && off < 1e-3, "{}: {} {}", name, weight, off);
                }
                upload(&mut lod, &mut buffer, frame);
                for group in 0..lod.groups() {
                    for &index in lod.triangles(group).as_flattened() {
                        let vertex = lod.vertices().map_or(index, |vertices| vertices[index as usize]);
                        prop_assert_eq!(Some(buffer[index as usize]), lod.value(vertex));
                    }
                }
            }
        }
        // In the end all is at its place.
        let asked = Given::random(&mesh, 9, 0.4);
        for _ in 0..2_000 {
            // Between operations nothing may move for a frame.
            let pending = lod.adapt_by(&asked, Motion::Other, 0.4).pending;
            if (pending == 0 || triangles.is_some()) && lod.moving() == 0 && drawn_positions(&lod) == positions(&lod.to_mesh_with(Normals::Kept)) {
                break;
            }
        }
        prop_assert_eq!(lod.moving(), 0);
        prop_assert_eq!(drawn_positions(&lod), positions(&lod.to_mesh_with(Normals::Kept)));
        if triangles.is_none() {
            for wavelet in 0..mesh.subdivision().wavelet_count() as u32 {
                prop_assert_eq!(lod.shows(wavelet), lod.cut().holds(wavelet));
            }
        }
    }
}

#[test]
fn what_is_not_seen_is_changed_at_once() {
    let mesh = Arc::new(uniform(&shapes::icosphere(0), 4, 2, &WaveletOptions::default()));
    for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
        let drawing = buffer(false).with_triangulation(triangulation);
        let mut lod = instance(&mesh, &drawing.with_geomorph(Some(slow())));
        let mut at_once = instance(&mesh, &drawing);
        for step in 0..6 {
            let mut asked = Given::random(&mesh, step, 0.2 * step as f64);
            asked.seen = false;
            lod.adapt_by(&asked, Motion::Other, 0.001);
            at_once.adapt_by(&asked, Motion::Other, 0.001);
            assert_eq!(lod.moving(), 0);
            assert_eq!(drawn_positions(&lod), drawn_positions(&at_once));
        }
    }
}

#[test]
fn a_wavelet_and_its_descendants_move_together_and_turn_round_where_they_are() {
    let mesh = Arc::new(uniform(&shapes::icosphere(0), 4, 2, &WaveletOptions::default()));
    let mut lod = instance(&mesh, &buffer(false).with_geomorph(Some(slow())));
    let (all, none) = (Given::new(&mesh, |_| true), Given::new(&mesh, |_| false));
    let count = mesh.subdivision().wavelet_count();
    lod.adapt_by(&all, Motion::Other, 0.0);
    assert_eq!(lod.moving(), count, "wavelets of all levels are on their way at once");
    lod.adapt_by(&all, Motion::Other, 0.25);
    let at = |lod: &WaveletLod<Place>| (0..count as u32).map(|w| weight(&mesh, lod, w).0).collect::<Vec<_>>();
    assert!(at(&lod).iter().all(|weight| (weight - 0.25).abs() < 1e-3));
    // All turn round: from 0.25 to 0 in the time of a whole transition.
    lod.adapt_by(&none, Motion::Other, 0.0);
    assert!(at(&lod).iter().all(|weight| (weight - 0.25).abs() < 1e-3));
    lod.adapt_by(&none, Motion::Other, 0.5);
    assert!(at(&lod).iter().all(|weight| (weight - 0.125).abs() < 1e-3));
    assert_eq!(lod.moving(), count);
    lod.adapt_by(&all, Motion::Other, 0.0);
    lod.adapt_by(&all, Motion::Other, 0.5);
    assert!(at(&lod).iter().all(|weight| (weight - 0.5625).abs() < 1e-3));
    lod.adapt_by(&all, Motion::Other, 0.5);
    assert_eq!(lod.moving(), 0);
    assert_eq!(drawn_positions(&lod), positions(&mesh.finest(Normals::Kept)));
    lod.adapt_by(&none, Motion::Other, 0.0);
    lod.adapt_by(&none, Motion::Other, 1.0);
    lod.adapt_by(&none, Motion::Other, 0.0);
    assert_eq!(lod.triangles(0).len(), mesh.subdivision().base_face_count());
}

#[test]
fn a_moving_eye_makes_it_quicker() {
    let mesh = Arc::new(uniform(&shapes::icosphere(0), 4, 2, &WaveletOptions::default()));
    let frames = |speed: f32| {
        let geomorph = Geomorph::default().with_duration(1.0).with_travel(0.5);
        let mut lod = instance(&mesh, &buffer(false).with_geomorph(Some(geomorph)));
        let mut count = 0;
        for frame in 0..100 {
            let eye = [0.0, 0.0, 6.0 - speed * frame as f32];
            let view = View::perspective(look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]), 1.0, [640, 480]).unwrap();
            lod.adapt(&[view.with_tolerance_px(0.05).of_world()], 1.0 / 60.0);
            if lod.moving() > 0 {
                count += 1;
            } else if count > 0 {
                break;
            }
        }
        count
    };
    let (still, slow) = (frames(0.0), frames(0.01));
    assert!((58..=62).contains(&still), "{still} frames before a still eye");
    assert!(slow < 50, "{slow} frames before one that moves");
}
