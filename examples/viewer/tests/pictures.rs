//! Promise: what the card draws of any structure is what a ray-cast of the same slices shows: silhouettes within 0.5 % of their
//! pixels, and colours within 2/255 in the mean.

mod card;

use std::sync::Arc;

use card::{mesh_of, model, moving, open, ray_cast, shared, shown};
use multires::hierarchy::Dependencies;
use multires::lod::{LodOptions, Triangulation};
use multires::mesh::{Mesh, shapes};
use multires::quality::{RenderOptions, Shading};
use multires::simplify::Placement;
use multires_viewer::camera::{Lens, Orbit, Tolerances};
use multires_viewer::gpu::Gpu;
use multires_viewer::headless::{STEP, Stage};
use multires_viewer::renderer::Look;
use multires_viewer::scene::{BuildOptions, Model, Overlays, StructureKind};

const SIDE: usize = 400;

/// Mean difference of the colours of those pixels, of 255.
fn mean(drawn: &[[u8; 4]], rays: &[[u8; 3]], counts: impl Fn(usize) -> bool) -> f64 {
    let (mut sum, mut pixels) = (0_u64, 0_u64);
    for i in (0..rays.len()).filter(|&i| counts(i)) {
        sum += (0..3).map(|c| u64::from(drawn[i][c].abs_diff(rays[i][c]))).sum::<u64>();
        pixels += 3;
    }
    sum as f64 / pixels.max(1) as f64
}

/// Draws three frames of a flight towards a model, and compares each with rays: with one sample in the middle of each pixel, where
/// every pixel counts, and with four, which lie elsewhere than the rays. `flat`: one normal a triangle.
fn compare(gpu: &Gpu, what: &str, model: &Arc<Model>, options: LodOptions, flat: bool) {
    let place = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let mut stages = [1, 4].map(|samples| {
        Stage::new(gpu.clone(), Arc::clone(model), &[place], options, [SIDE as u32; 2], samples).unwrap()
    });
    let lens = Lens { field_of_view: 0.8, size: [SIDE as u32; 2] };
    let tolerances = Tolerances::default().with_anywhere(1.5);
    let (centre, diagonal) = (stages[0].scene().centre(), stages[0].scene().diagonal());
    let pictured = || {
        let shading = if flat { Shading::Flat } else { Shading::Smooth };
        RenderOptions::default().with_size(SIDE, SIDE).with_shading(shading)
    };
    let mut triangles = Vec::new();
    for (share, around) in [(2.0, 0.3), (0.9, 1.4), (0.35, 2.4)] {
        let mut orbit = Orbit::framing(centre, 0.5 * diagonal, lens.field_of_view, false);
        (orbit.distance, orbit.around) = (share * diagonal, around);
        let pose = orbit.pose();
        let look = Look { flat, ..pose.look(&lens, diagonal) };
        let views = [pose.view(&lens, &tolerances).unwrap()];
        // A few frames on the spot: vertices that move are then half-way.
        let drawn = stages.each_mut().map(|stage| {
            for last in [false, false, true] {
                stage.frame(&views, last.then_some(&look), Overlays::default(), STEP);
            }
            stage.picture().unwrap()
        });
        let mesh = mesh_of(stages[0].scene().instances().next().unwrap(), model);
        triangles.push(mesh.triangles().len());
        let rays = [false, true].map(|four| ray_cast(&mesh, &pose, 0.8, pictured().with_supersampling(four)));
        let shown = shown(&mesh, &pose, 0.8, pictured());

        let surface = shown.iter().filter(|&&shown| shown).count();
        assert!(surface > SIDE * SIDE / 50, "{what}: only {surface} pixels show anything");
        let edge = drawn[0].iter().zip(&shown).filter(|(drawn, shown)| (drawn[3] > 0) != **shown).count();
        let colour = mean(&drawn[0], &rays[0], |i| shown[i] || drawn[0][i][3] > 0);
        let smooth = mean(&drawn[1], &rays[1], |_| true);
        eprintln!(
            "{what}: {} triangles, {edge} of {surface} pixels of the silhouette, mean {colour:.3} and {smooth:.3}",
            mesh.triangles().len(),
        );
        assert!(edge * 200 <= surface, "{what}: {edge} of {surface} pixels of the silhouette differ");
        assert!(colour < 2.0, "{what}: {colour} of 255 in the mean");
        assert!(smooth < 2.0, "{what}: {smooth} of 255 in the mean with four samples");
    }
    assert_eq!(gpu.error(), None, "{what}");
    assert!(triangles[0] < triangles[1], "{what}: nothing was refined: {triangles:?}");
}

fn bare() -> Mesh {
    shapes::rock(30_000, 5)
}

#[test]
fn a_static_hierarchy_looks_like_its_slices() {
    let Some(gpu) = open("a_static_hierarchy_looks_like_its_slices") else { return };
    let demo = model(&shapes::demo(), &BuildOptions::default());
    compare(&gpu, "static", &demo, shared(), false);
    compare(&gpu, "static, flat", &demo, shared(), true);
    let options =
        BuildOptions::default().with_placement(Placement::Optimal).with_dependencies(Dependencies::Adjacent);
    compare(&gpu, "static, new vertices", &model(&bare(), &options), shared(), false);
}

#[test]
fn a_compact_hierarchy_looks_like_its_slices() {
    let Some(gpu) = open("a_compact_hierarchy_looks_like_its_slices") else { return };
    let demo = model(&shapes::demo(), &BuildOptions::default());
    compare(&gpu, "compact", &demo, LodOptions::default(), false);
    let limits = LodOptions::default().with_triangles(9_000).with_operations(400);
    let limited = limits;
    compare(&gpu, "compact, limited", &demo, limited, false);
}

#[test]
fn moving_vertices_look_like_their_slices() {
    let Some(gpu) = open("moving_vertices_look_like_their_slices") else { return };
    let rock = model(&bare(), &BuildOptions::default());
    for options in [shared(), LodOptions::default()] {
        compare(&gpu, &format!("moving, {:?}", options.buffer), &rock, moving(options, 0.1), false);
    }
}

#[test]
fn a_totally_ordered_mesh_looks_like_its_slices() {
    let Some(gpu) = open("a_totally_ordered_mesh_looks_like_its_slices") else { return };
    let options = BuildOptions::default().with_structure(StructureKind::Tom);
    let demo = model(&shapes::demo(), &options);
    compare(&gpu, "tom", &demo, shared(), false);
    compare(&gpu, "tom, compact", &demo, LodOptions::default(), false);
    // A rock, since creases that unfold lie on one another, and who is in front there is for rounding to say.
    compare(&gpu, "tom, moving", &model(&bare(), &options), moving(shared(), 0.1), false);
}

#[test]
fn a_gmesh_looks_like_its_slices() {
    let Some(gpu) = open("a_gmesh_looks_like_its_slices") else { return };
    let options = BuildOptions::default().with_structure(StructureKind::Gmesh);
    let rock = model(&bare(), &options);
    compare(&gpu, "gmesh, moved by the card", &rock, shared(), false);
    compare(&gpu, "gmesh, moved by the card, flat", &rock, shared(), true);
    compare(&gpu, "gmesh, compact", &rock, LodOptions::default(), false);
    compare(&gpu, "gmesh, moved by the processor", &rock, moving(shared(), 0.1), false);
    let placed = model(&bare(), &options.with_placement(Placement::Optimal));
    compare(&gpu, "gmesh, new vertices", &placed, shared(), false);
}

#[test]
fn a_wavelet_mesh_looks_like_its_slices() {
    let Some(gpu) = open("a_wavelet_mesh_looks_like_its_slices") else { return };
    let options = BuildOptions::default().with_structure(StructureKind::Wavelet);
    let rock = model(&shapes::rock(20_480, 5), &options);
    compare(&gpu, "wavelet", &rock, shared(), false);
    compare(&gpu, "wavelet, flat", &rock, shared(), true);
    let compact = LodOptions::default();
    compare(&gpu, "wavelet, compact", &rock, compact, false);
    let minimal = compact.with_triangulation(Triangulation::Minimal);
    compare(&gpu, "wavelet, compact, minimal", &rock, minimal, false);
    for options in [shared(), minimal] {
        compare(&gpu, "wavelet, moving", &rock, moving(options, 0.1), false);
    }
    let terrain = model(&shapes::terrain(129, 3), &options);
    compare(&gpu, "wavelet terrain", &terrain, shared(), false);
}
