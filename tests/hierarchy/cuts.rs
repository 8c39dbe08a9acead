//! A vertex hierarchy at any cut is the image of the input under the collapses that are left; and the cut is what the view asks for,
//! whatever it was before.

use std::sync::Arc;

use crate::support;
use crate::support::lod::{POLICIES, Random, drawn, image_at, is_closed, shape, view, wanted};
use multires::adapt::Refinements;
use multires::hierarchy::{Dependencies, HierarchyBuild, HierarchyLod, VertexHierarchy};
use multires::lod::Lod;
use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, Placement, Simplifier};
use multires::view::Motion;
use proptest::prelude::*;

/// The smallest closed set that holds what is asked for.
fn closure(hierarchy: &VertexHierarchy, needed: &[bool]) -> Vec<u32> {
    let mut holds = vec![false; needed.len()];
    let mut stack: Vec<u32> = (0..needed.len() as u32).filter(|&split| needed[split as usize]).collect();
    while let Some(split) = stack.pop() {
        if !std::mem::replace(&mut holds[split as usize], true) {
            stack.extend(hierarchy.parents(split).chain(hierarchy.dependencies(split)));
        }
    }
    (0..needed.len() as u32).filter(|&split| holds[split as usize]).collect()
}

fn build(mesh: &Mesh, sequence: &CollapseSequence, dependencies: Dependencies) -> HierarchyBuild {
    VertexHierarchy::build(mesh, sequence, dependencies).unwrap()
}

/// A copy of the buffers, kept up to date by the dirty ranges alone.
#[derive(Default)]
struct Upload {
    triangles: Vec<Vec<[u32; 3]>>,
    vertices: Vec<u32>,
}

impl Upload {
    fn take(&mut self, lod: &mut HierarchyLod, gap: usize) {
        self.triangles.resize(lod.groups(), Vec::new());
        for (group, buffer) in self.triangles.iter_mut().enumerate() {
            let now = lod.triangles(group);
            buffer.resize(now.len(), [u32::MAX; 3]);
            for range in lod.dirty_triangles(group, gap) {
                buffer[range.clone()].copy_from_slice(&now[range]);
            }
            assert_eq!(buffer, now);
        }
        let now = lod.vertices().unwrap_or(&[]);
        self.vertices.resize(now.len(), u32::MAX);
        for range in lod.dirty_vertices(gap) {
            self.vertices[range.clone()].copy_from_slice(&now[range]);
        }
        assert_eq!(self.vertices, now);
        lod.clean();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Any mesh, any sequence, any closed set of splits in any order: the triangles are those of the definition, the
    /// set is the smallest closed one, dirty ranges name all that was written, and packed vertices are those in use.
    #[test]
    fn a_cut_is_the_image(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        packed in any::<bool>(),
        steps in prop::collection::vec((any::<u64>(), 0u64..110), 1..12),
    ) {
        let built = build(&mesh, &sequence, POLICIES[policy]);
        let hierarchy = Arc::new(built.hierarchy);
        prop_assert!(hierarchy.validate().is_ok());
        let mut lod = if packed { HierarchyLod::packed(hierarchy.clone()) } else { HierarchyLod::new(hierarchy.clone()) };
        let mut upload = Upload::default();
        upload.take(&mut lod, 0);
        for (i, (seed, share)) in steps.into_iter().enumerate() {
            let asked = Random::new(&hierarchy, seed, share);
            lod.adapt_by(&asked, Motion::Other, 0.0);
            prop_assert_eq!(wanted(&hierarchy, lod.cut()), closure(&hierarchy, &asked.needed));
            prop_assert_eq!(drawn(&lod), image_at(&hierarchy, lod.cut()));
            if let Some(vertices) = lod.vertices() {
                let mut used: Vec<u32> = drawn(&lod).iter().flat_map(|(_, t)| *t).collect();
                used.sort_unstable();
                used.dedup();
                let mut packed = vertices.to_vec();
                packed.sort_unstable();
                prop_assert_eq!(packed, used);
            }
            if i % 2 == 0 {
                upload.take(&mut lod, i);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Many small and large motions later, the cut is the one that a fresh instance finds for the last view: sleeping
    /// never misses anything, and the cut does not depend on the way.
    #[test]
    fn the_cut_depends_on_the_view_alone(
        which in 0usize..8,
        policy in 0usize..4,
        optimal in any::<bool>(),
        start in prop::array::uniform3(-1.5f32..1.5),
        moves in prop::collection::vec((prop::array::uniform3(-1.0f32..1.0), -1.0f32..1.0, 0i32..7), 1..40),
        tolerance in 0.2f32..8.0,
    ) {
        let mesh = shape(which);
        let placement = if optimal { Placement::Optimal } else { Placement::Endpoint };
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        let hierarchy = Arc::new(build(&mesh, &sequence, POLICIES[policy]).hierarchy);
        let mut lod = HierarchyLod::new(hierarchy.clone());
        let (mut eye, mut turn) = (start, 0.0);
        for (step, angle, size) in moves {
            let size = 10f32.powi(-size) * 3.0;
            eye = std::array::from_fn(|i| eye[i] + step[i] * size);
            turn += angle * size;
            let view = view(&mesh, eye, turn, tolerance).of_world();
            lod.adapt(std::slice::from_ref(&view), 1.0 / 60.0);
            let mut fresh = HierarchyLod::new(hierarchy.clone());
            fresh.adapt(&[view], 1.0 / 60.0);
            prop_assert_eq!(wanted(&hierarchy, lod.cut()), wanted(&hierarchy, fresh.cut()));
            prop_assert_eq!(drawn(&lod), drawn(&fresh));
        }
        prop_assert!(is_closed(&hierarchy, lod.cut()));
    }
}

/// What a still eye cannot have changed is not looked at, nor most of what a slow one cannot; and the cut is that of the view all the same,
/// however slowly it goes.
#[test]
fn a_slow_eye_lets_blocks_sleep() {
    let mesh = multires::mesh::shapes::rock(20_000, 1);
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let hierarchy = Arc::new(build(&mesh, &sequence, Dependencies::None).hierarchy);
    let mut lod = HierarchyLod::new(Arc::clone(&hierarchy));
    let (mut blocks, mut asleep) = (0, 0);
    for frame in 0..400 {
        // A 20,000th of the mesh's size a frame, and a turn as small; later a hundred times less, then faster and faster.
        let at = match frame {
            0..200 => frame as f32,
            200..300 => 200.0 + 0.01 * (frame - 200) as f32,
            _ => 201.0 + ((frame - 300) as f32).powf(1.7),
        };
        let view = view(&mesh, [0.0, 0.0, 1.2 - 5e-5 * at], 5e-5 * at, 0.3).of_world();
        let cut = lod.adapt(std::slice::from_ref(&view), 0.0).cut;
        if (10..300).contains(&frame) {
            blocks += cut.blocks;
            asleep += cut.asleep;
        }
        if frame % 20 == 19 {
            let cut = lod.adapt(std::slice::from_ref(&view), 0.0).cut;
            assert_eq!((cut.tests, cut.asleep), (0, cut.blocks), "frame {frame}");
            assert!(cut.blocks > 20);
            let mut anew = HierarchyLod::new(Arc::clone(&hierarchy));
            anew.adapt(std::slice::from_ref(&view), 0.0);
            assert!(
                (0..hierarchy.len() as u32).all(|split| lod.shows(split) == anew.shows(split)),
                "{frame}"
            );
        }
    }
    assert!(3 * asleep > 2 * blocks, "{asleep} of {blocks} blocks");
}
