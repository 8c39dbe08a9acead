//! Promise: never more triangles than the budget, nearly as many as it allows, and the same ones whatever came before; never more
//! changes a frame than allowed.

use std::sync::Arc;

use crate::wavelet::{buffer, drawn_positions, instance, patchy, positions, uniform, view};
use multires::lod::{Lod, Triangulation};
use multires::mesh::shapes;
use multires::wavelet::{Normals, WaveletMesh, WaveletOptions};

fn meshes() -> Vec<Arc<WaveletMesh>> {
    let options = WaveletOptions::default();
    vec![
        Arc::new(WaveletMesh::recognise(&shapes::terrain(65, 2), &options).unwrap()),
        Arc::new(uniform(&shapes::icosphere(0), 5, 1, &options)),
        Arc::new(patchy(&shapes::torus(1.0, 0.4, 6, 4), 5, 1, &options)),
    ]
}

#[test]
fn a_budget_is_kept_and_used() {
    for mesh in meshes() {
        for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
            for budget in [0, 500, 1_500, 4_000] {
                let drawing = buffer(false).with_triangulation(triangulation);
                let mut lod = instance(&mesh, &drawing.with_triangles(Some(budget)));
                let mut free = instance(&mesh, &drawing);
                for step in 0..30 {
                    let view = [view(&mesh, step / 10, 0.3 + 0.01 * step as f32).of_world()];
                    let change = lod.adapt(&view, 1.0 / 60.0);
                    let wanted = free.adapt(&view, 1.0 / 60.0).triangles;
                    assert_eq!(change.triangles, lod.triangles(0).len());
                    let least = mesh.subdivision().base_face_count();
                    assert!(change.triangles <= budget.max(least), "{} of {budget}", change.triangles);
                    assert_eq!(change.over_budget, budget < least);
                    if budget > least {
                        // Some is left for what comes; in one step a wavelet may bring several.
                        let enough = (0.93 * budget as f64) as usize - 20;
                        assert!(
                            change.triangles >= wanted.min(enough),
                            "{} of {budget}, {wanted}",
                            change.triangles
                        );
                    }
                    assert_eq!(drawn_positions(&lod), positions(&lod.to_mesh_with(Normals::Kept)));
                }
                lod.set_options(&drawing).unwrap();
                let view = [view(&mesh, 1, 0.4).of_world()];
                lod.adapt(&view, 1.0 / 60.0);
                free.adapt(&view, 1.0 / 60.0);
                assert_eq!(drawn_positions(&lod), drawn_positions(&free));
            }
        }
    }
}

#[test]
fn a_smaller_budget_draws_a_part_of_a_larger_one() {
    for mesh in meshes() {
        let shown = |budget: usize| {
            let mut lod = instance(&mesh, &buffer(false).with_triangles(Some(budget)));
            lod.adapt(&[view(&mesh, 4, 0.2).of_world()], 1.0 / 60.0);
            (0..mesh.subdivision().wavelet_count() as u32).filter(|&w| lod.shows(w)).collect::<Vec<_>>()
        };
        let (small, large) = (shown(700), shown(2_500));
        assert!(small.len() < large.len() && small.iter().all(|w| large.contains(w)));
    }
}

#[test]
fn operations_are_limited_and_nothing_is_lost() {
    for mesh in meshes() {
        for triangulation in [Triangulation::Exact, Triangulation::Minimal] {
            let drawing = buffer(false).with_triangulation(triangulation);
            let mut lod = instance(&mesh, &drawing.with_operations(Some(40)));
            let mut free = instance(&mesh, &drawing);
            for step in 0..4 {
                let view = [view(&mesh, step, 1.0).of_world()];
                free.adapt(&view, 1.0 / 60.0);
                loop {
                    let change = lod.adapt(&view, 1.0 / 60.0);
                    assert!(change.cut.splits + change.cut.collapses <= 40);
                    assert_eq!(drawn_positions(&lod), positions(&lod.to_mesh_with(Normals::Kept)));
                    if change.pending == 0 {
                        break;
                    }
                }
                assert_eq!(drawn_positions(&lod), drawn_positions(&free));
            }
            lod.adapt(&[view(&mesh, 9, 0.5).of_world()], 1.0 / 60.0);
            free.adapt(&[view(&mesh, 9, 0.5).of_world()], 1.0 / 60.0);
            lod.settle();
            assert_eq!(drawn_positions(&lod), drawn_positions(&free));
        }
    }
}
