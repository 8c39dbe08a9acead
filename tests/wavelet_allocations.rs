//! Promise: nothing allocates once warm.

#[path = "support/wavelet.rs"]
mod wavelet;

use std::sync::Arc;

use multires::adapt::Geomorph;
use multires::lod::{Lod, LodOptions, Triangulation};
use multires::mesh::shapes;
use multires::view::{View, look_at};
use multires::wavelet::{WaveletMesh, WaveletOptions};
use peak_alloc::PeakAlloc;
use wavelet::{buffer, instance, patchy};

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// A flight to and around the mesh, with a jump, from the coarsest and back to it. Whether no more memory was in use at any time
/// than before.
fn fly(lod: &mut impl Lod) -> bool {
    let views: Vec<_> = (0..80)
        .map(|frame| {
            let angle = frame as f32 * 0.05;
            let far = if frame > 50 { 3.0 } else { 2.0 - 0.03 * frame as f32 };
            let eye = [far * angle.sin(), 0.3 * far, far * angle.cos()];
            let world = look_at(eye, [0.3 * angle, 0.0, 0.0], [0.0, 1.0, 0.0]);
            [View::perspective(world, 1.0, [640, 480]).unwrap().with_tolerance_px(0.3).of_world()]
        })
        .collect();
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let mut written = 0;
    let rest: &[_] = &[];
    for views in views.iter().map(|views| &views[..]).chain([rest; 80]) {
        lod.adapt(views, 1.0 / 60.0);
        written += lod.dirty_triangles(0, 4).map(|range| range.len()).sum::<usize>();
        written += lod.dirty_vertices(4).map(|range| range.len()).sum::<usize>();
        lod.clean();
    }
    assert!(written > 2_000, "{written}");
    ALLOCATOR.peak_usage() == before && ALLOCATOR.current_usage() == before
}

/// One test, so that nothing else allocates meanwhile.
#[test]
fn the_second_flight_allocates_nothing() {
    let options = WaveletOptions::default();
    let terrain = WaveletMesh::recognise(&shapes::terrain(65, 2), &options).unwrap();
    let rough = patchy(&shapes::icosphere(0), 5, 1, &options);
    for mesh in [Arc::new(terrain), Arc::new(rough)] {
        for (i, limits) in [
            LodOptions::default(),
            LodOptions::default().with_operations(Some(60)),
            LodOptions::default().with_triangles(Some(1_500)),
            LodOptions::default().with_operations(Some(60)).with_triangles(Some(1_500)),
        ]
        .into_iter()
        .enumerate()
        {
            for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
                for packed in [false, true] {
                    for geomorph in [None, Some(Geomorph::default().with_frames(10.0))] {
                        let options =
                            limits.with_buffer(buffer(packed).buffer).with_triangulation(triangulation);
                        let options = options.with_geomorph(geomorph);
                        let mut lod = instance(&mesh, &options);
                        let first = fly(&mut lod);
                        let second = fly(&mut lod);
                        assert!(!first, "the first flight must grow buffers");
                        assert!(second, "limits {i}, {options:?}");
                    }
                }
            }
        }
    }
}
