//! Promise: a grid of heights of any size is a wavelet mesh that goes through every sample, without cracks, in few more triangles than
//! the grid has.

use std::collections::{BTreeMap, BTreeSet};

use multires::lod::{Baked, Level};
use multires::mesh::Report;
use multires::wavelet::{Normals, WaveletError, WaveletMesh, WaveletOptions};
use proptest::prelude::*;

fn heights([w, h]: [usize; 2]) -> Vec<f32> {
    let height = |i: usize| {
        let (x, y) = ((i % w) as f32, (i / w) as f32);
        (0.37 * x).sin() * (0.23 * y).cos() + 0.01 * x * y
    };
    (0..w * h).map(height).collect()
}

fn terrain(size: [usize; 2]) -> WaveletMesh {
    WaveletMesh::from_heights(&heights(size), size, [0.5, 0.25], &WaveletOptions::default()).unwrap()
}

fn assert_holds(size: [usize; 2]) -> WaveletMesh {
    let terrain = terrain(size);
    let finest = terrain.finest(Normals::Kept);
    let places: BTreeSet<[u32; 3]> = finest.positions().iter().map(|p| p.map(f32::to_bits)).collect();
    let heights = heights(size);
    for (i, height) in heights.iter().enumerate() {
        let place = [(i % size[0]) as f32 * 0.5, *height, (i / size[0]) as f32 * 0.25];
        assert!(places.contains(&place.map(f32::to_bits)), "{size:?}: sample {i} is missing");
    }
    // A disc, every triangle of it facing up, with the grid's outline as its only border.
    let report = Report::new(&finest);
    assert!(report.is_manifold() && report.components == 1, "{size:?}: {report}");
    let [low, high] = finest.bounds().unwrap();
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for triangle in finest.triangles() {
        let [a, b, c] = triangle.map(|v| finest.positions()[v as usize]);
        let up = (c[0] - a[0]) * (b[2] - a[2]) - (b[0] - a[0]) * (c[2] - a[2]);
        assert!(up > 0.0, "{size:?}: {a:?} {b:?} {c:?} faces down");
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    for (edge, _) in edges.iter().filter(|(_, uses)| **uses == 1) {
        let [a, b] = edge.map(|v| finest.positions()[v as usize]);
        let outline = [0, 2].iter().any(|&k| a[k] == b[k] && (a[k] == low[k] || a[k] == high[k]));
        assert!(outline, "{size:?}: a crack from {a:?} to {b:?}");
    }
    terrain
}

#[test]
fn sizes_that_fail_as_meshes_have_levels() {
    for (size, depth) in
        [([1_000, 1_000], 10), ([1_024, 1_024], 10), ([513, 513], 9), ([1_000, 700], 8), ([400, 90], 5)]
    {
        let terrain = terrain(size);
        let cells = 2 * (size[0] - 1) * (size[1] - 1);
        let made = terrain.subdivision().triangle_count();
        assert!(terrain.subdivision().depth() >= depth, "{size:?}: {} levels", terrain.subdivision().depth());
        assert!(made as f64 <= 1.15 * cells as f64, "{size:?}: {made} triangles of {cells}");
        assert!(terrain.subdivision().base_face_count() * 30 < cells, "{size:?}");
    }
}

#[test]
fn levels_of_it_are_right() {
    let terrain = Baked::from(assert_holds([100, 70]));
    let half = terrain.level(Level::Ratio(0.5));
    assert!(half.mesh.triangles().len() <= terrain.structure().subdivision().triangle_count() / 2);
    assert!(half.error > 0.0);
    assert!(Report::new(&half.mesh).is_manifold());
}

#[test]
fn what_is_no_grid_is_refused() {
    let of = |heights: &[f32], size| {
        WaveletMesh::from_heights(heights, size, [1.0; 2], &WaveletOptions::default())
    };
    assert!(matches!(of(&[0.0; 6], [2, 2]), Err(WaveletError::Length { found: 6, .. })));
    assert!(matches!(of(&[0.0; 3], [3, 1]), Err(WaveletError::Invalid { at: 1, .. })));
    assert!(of(&[], [0, 0]).is_err() && of(&[0.0; 2], [usize::MAX, 2]).is_err());
    assert!(of(&[0.0, 1.0, f32::NAN, 0.0], [2, 2]).is_err());
    let flat = |spacing| WaveletMesh::from_heights(&[0.0; 9], [3, 3], spacing, &WaveletOptions::default());
    assert!(flat([f32::INFINITY, 1.0]).is_err());
    assert!(flat([0.0, 0.0]).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_size_goes_through_its_samples(w in 2_usize..70, h in 2_usize..70) {
        assert_holds([w, h]);
    }
}
