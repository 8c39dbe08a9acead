//! Promise: the parts of a vertex hierarchy come back equal; forged ones are refused by name, or are a hierarchy that shows the
//! image of its triangles at every cut; and no parts make that take long.

use std::sync::Arc;

use crate::support;
use crate::support::lod::{Random, drawn, image_at, is_closed};
use multires::adapt::Refinements;
use multires::hierarchy::{Dependencies, HierarchyLod, HierarchyParts, VertexHierarchy};
use multires::lod::Lod;
use multires::mesh::Mesh;
use multires::simplify::{CollapseSequence, NewVertex};
use multires::view::{Bounds, Motion, View, look_at};
use proptest::prelude::*;

/// Two rows of three vertices and one apart; two materials.
fn small() -> HierarchyParts {
    let places = [[0., 1.], [1., 1.], [2., 1.], [0., 0.], [1., 0.], [2., 0.], [3., 0.]];
    let positions: Vec<[f32; 3]> = places.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let triangles = [[0, 3, 1], [3, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 6]];
    let mesh = Mesh::new(positions, triangles).unwrap().with_materials([7, 7, 9, 9, 7]).unwrap();
    let half = NewVertex { from: [1, 4], weight: 0.5, position: [1.0, 0.5, 0.0] };
    let steps: [(&[[u32; 2]], f32); 3] =
        [(&[[1, 7], [4, 7]], 0.5), (&[[0, 3]], 0.25), (&[[7, 3], [2, 5]], 1.0)];
    let sequence = CollapseSequence::from_collapses(&mesh, &[half], steps).unwrap();
    VertexHierarchy::build(&mesh, &sequence, Dependencies::Neighbours).unwrap().hierarchy.into()
}

fn refusal(parts: HierarchyParts) -> String {
    VertexHierarchy::try_from(parts).expect_err("broken parts").to_string()
}

type Break = fn(&mut HierarchyParts);

/// One break of each promise, and what is then said.
const BREAKS: [(&str, Break); 53] = [
    // Lengths and ranges.
    ("9 first leaves of new vertices where 8", |p| p.first_leaf = vec![0; 9]),
    ("entry 0 of first leaves is 7", |p| p.first_leaf[0] = 7),
    ("entry 1 of substitutes is 8", |p| p.substitute[1] = 8),
    ("9 splits, more than the 8", |p| p.bounds = vec![p.bounds[0]; 9]),
    ("0 starts of brings where 4", |p| p.brings_start.clear()),
    ("3 starts of brings where 4", |p| p.brings_start.truncate(3)),
    ("start of brings of split 0", |p| p.brings_start[0] = 1),
    ("start of brings of split 2", |p| p.brings_start[1] = 4),
    ("start of brings of split 3", |p| p.brings_start[3] = 4),
    ("start of brings of split 3", |p| p.brings.push(0)),
    ("entry 4 of brings is 8", |p| p.brings[4] = 8),
    ("0 starts of dependencies where 4", |p| p.dependencies_start.clear()),
    ("start of dependencies of split 0", |p| p.dependencies_start = vec![1; 4]),
    ("start of dependencies of split 2", |p| p.dependencies_start[1] = 1),
    ("start of dependencies of split 3", |p| p.dependencies.clear()),
    ("entry 0 of dependencies is 3", |p| p.dependencies[0] = 3),
    ("1 dependencies where 0", |p| p.dependency_kind = Dependencies::None),
    ("entry 12 of corners of triangles is 7", |p| p.triangles[4][0] = 7),
    ("3 starts of splits' triangles where 4", |p| p.first_triangle.truncate(3)),
    ("first triangle of split 2", |p| p.first_triangle[1] = 4),
    ("first triangle of split 3", |p| p.first_triangle[3] = 4),
    ("first triangle of split 3", |p| p.first_triangle[3] = 6),
    ("4 groups of triangles where 5", |p| p.group_of.truncate(4)),
    ("5 groups of triangles where 0", |p| p.materials.truncate(1)),
    ("group of triangle 1", |p| p.group_of[1] = 2),
    ("order of materials at 1", |p| p.materials[1] = 7),
    ("65537 materials", |p| p.materials = (0..65_537).collect()),
    ("diagonal", |p| p.diagonal = f64::NAN),
    ("diagonal", |p| p.diagonal = -1.0),
    ("diagonal", |p| p.diagonal = f64::INFINITY),
    ("diagonal", |p| p.diagonal = 1e-300),
    // The forest.
    ("substitute of vertex 1", |p| p.substitute[1] = 1),
    ("substitute of vertex 0", |p| p.substitute[0] = 4),
    ("substitute of vertex 3", |p| p.brings[4] = 2),
    ("what is brought by split 1", |p| p.brings_start[1] = 3),
    ("collapse of vertex 2", |p| (p.brings[4], p.substitute[3]) = (2, 3)),
    ("collapse of vertex 3", |p| p.substitute[3] = 2),
    ("collapse of vertex 1", |p| (p.brings[3], p.substitute[2]) = (1, 2)),
    // 1 and 0 in each other's place.
    ("collapse of vertex", |p| {
        (p.substitute[0], p.brings) = (1, vec![7, 5, 0, 2, 3]);
        (p.substitute[7], p.brings_start) = (1, vec![0, 2, 3, 5]);
        p.brings.push(1);
        p.brings_start[3] = 6;
    }),
    ("run of leaves of vertex 2", |p| p.first_leaf[0] = 1),
    ("run of leaves of vertex 2", |p| p.first_leaf.clear()),
    ("run of leaves of vertex 3", |p| p.brings.swap(3, 4)),
    ("run of leaves of vertex 1", |p| p.substitute[1] = 4),
    // Needs.
    ("cycle of dependencies", |p| (p.dependencies_start, p.dependencies) = (vec![0, 1, 1, 1], vec![2])),
    ("cycle of dependencies", |p| (p.dependencies_start, p.dependencies) = (vec![0, 0, 1, 2], vec![2, 1])),
    ("cycle of dependencies", |p| (p.dependencies_start, p.dependencies) = (vec![0, 0, 1, 1], vec![1])),
    // Bounds.
    ("bounds of split 1", |p| p.bounds[1].radius = f32::NAN),
    ("bounds of split 1", |p| p.bounds[1].error = -1.0),
    ("bounds of split 2", |p| p.bounds[2].centre[1] = f32::INFINITY),
    ("parents, the bounds of split 2", |p| p.bounds[2].radius = 9.0),
    // Triangles.
    ("brings back triangle 3", |p| p.triangles[3] = [2, 2, 4]),
    ("brings back triangle 0", |p| p.triangles.swap(0, 3)),
    ("brings back triangle 0", |p| p.first_triangle[0] = 1),
];

#[test]
fn every_promise_is_checked() {
    let good = small();
    assert_eq!((&good.brings[..], &good.first_triangle[..]), (&[7, 5, 1, 2, 3][..], &[0, 2, 3, 5][..]));
    let hierarchy = VertexHierarchy::try_from(good.clone()).unwrap();
    assert_eq!(hierarchy.validate(), Ok(()));
    assert_eq!(HierarchyParts::from(hierarchy), good);
    for (why, damage) in BREAKS {
        let mut parts = good.clone();
        damage(&mut parts);
        let said = refusal(parts);
        assert!(said.contains(why), "{why}: {said}");
    }
}

#[test]
fn nothing_is_a_hierarchy_too() {
    let none =
        HierarchyParts { brings_start: vec![0], dependencies_start: vec![0], ..HierarchyParts::default() };
    let parts = HierarchyParts { first_triangle: vec![0], ..none };
    use_it(VertexHierarchy::try_from(parts).unwrap(), 1);
    assert!(refusal(HierarchyParts::default()).contains("starts of brings"));
}

/// Many cuts in many orders, by criteria and by views: each shows the image.
fn use_it(hierarchy: VertexHierarchy, seed: u64) {
    assert_eq!(hierarchy.validate(), Ok(()));
    let hierarchy = Arc::new(hierarchy);
    let reach = reach(&hierarchy);
    for packed in [false, true] {
        let shared = hierarchy.clone();
        let mut lod = if packed { HierarchyLod::packed(shared) } else { HierarchyLod::new(shared) };
        for step in 0..6u64 {
            let share = [100, 50, 80, 0, 90, 30][step as usize];
            lod.adapt_by(&Random::new(&hierarchy, seed ^ step, share), Motion::Other, 0.0);
            assert!(is_closed(&hierarchy, lod.cut()));
            assert_eq!(drawn(&lod), image_at(&hierarchy, lod.cut()));
        }
        for step in 0..6 {
            let eye = [reach * (step as f32 - 2.0), reach * 0.3, reach / (step + 1) as f32];
            let matrix = look_at(eye, [0.0; 3], [0.0, 1.0, 0.0]);
            let Ok(view) = View::perspective(matrix, 1.0, [300, 200]) else { continue };
            lod.adapt(&[view.with_tolerance_px(2.0).with_silhouette_px(1.0).of_world()], 1.0 / 60.0);
            assert!(is_closed(&hierarchy, lod.cut()));
            assert_eq!(drawn(&lod), image_at(&hierarchy, lod.cut()));
            let _ = (lod.dirty_triangles(0, 0).count(), lod.dirty_vertices(3).count());
            lod.clean();
        }
    }
}

/// About as far as anything lies from the origin.
fn reach(hierarchy: &VertexHierarchy) -> f32 {
    let far = |split| {
        let b = hierarchy.bounds(split);
        b.centre.iter().fold(b.radius, |far, x| far.max(x.abs()))
    };
    (0..hierarchy.split_count() as u32).map(far).fold(1.0, f32::max).min(1e6)
}

/// Where in the parts something is changed, and how.
fn forge(parts: &mut HierarchyParts, changes: &[(u8, prop::sample::Index, u32)]) {
    for &(which, at, value) in changes {
        let small = value % 24;
        let set = |array: &mut Vec<u32>| match array.len() {
            0 => array.push(small),
            len => array[at.index(len)] = small,
        };
        match which % 16 {
            0 => set(&mut parts.substitute),
            1 => set(&mut parts.first_leaf),
            2 => set(&mut parts.brings_start),
            3 => set(&mut parts.brings),
            4 => set(&mut parts.dependencies_start),
            5 => set(&mut parts.dependencies),
            6 => set(&mut parts.first_triangle),
            7 => set(&mut parts.materials),
            8 if parts.brings.len() > 1 => {
                let [a, b] = [at.index(parts.brings.len()), small as usize % parts.brings.len()];
                parts.brings.swap(a, b);
            }
            9 if !parts.triangles.is_empty() => {
                let triangle = at.index(parts.triangles.len());
                parts.triangles[triangle][value as usize % 3] = small;
            }
            10 if !parts.triangles.is_empty() => {
                let triangle = at.index(parts.triangles.len());
                parts.triangles[triangle].swap(0, value as usize % 3);
            }
            11 if !parts.group_of.is_empty() => {
                let triangle = at.index(parts.group_of.len());
                parts.group_of[triangle] = (value % 5) as u16;
            }
            12 if !parts.bounds.is_empty() => {
                let split = at.index(parts.bounds.len());
                let bounds = &mut parts.bounds[split];
                match value % 5 {
                    0 => bounds.cone[(value / 5 % 4) as usize] = (value / 20) as i8,
                    1 => bounds.radius = f32::from_bits(value),
                    2 => bounds.error = f32::from_bits(value),
                    3 => bounds.parametric *= small as f32 * 0.1,
                    _ => bounds.centre[(value / 5 % 3) as usize] = f32::from_bits(value),
                }
            }
            13 => parts.diagonal = f64::from(f32::from_bits(value)),
            14 => {
                parts.dependencies_start = vec![0; parts.bounds.len() + 1];
                parts.dependencies.clear();
            }
            // One more need, if there may be any.
            _ if !parts.bounds.is_empty() => {
                let split = at.index(parts.bounds.len());
                parts.dependency_kind = Dependencies::Adjacent;
                if let (Some(&start), true) = (
                    parts.dependencies_start.get(split),
                    parts
                        .dependencies_start
                        .get(split)
                        .is_some_and(|&s| s as usize <= parts.dependencies.len()),
                ) {
                    parts.dependencies.insert(start as usize, value % parts.bounds.len() as u32);
                    parts.dependencies_start.iter_mut().skip(split + 1).for_each(|start| *start += 1);
                }
            }
            _ => {}
        }
    }
}

const POLICIES: [Dependencies; 4] =
    [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours, Dependencies::Manifold];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn forged_parts_are_refused_or_safe(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
        changes in prop::collection::vec((any::<u8>(), any::<prop::sample::Index>(), any::<u32>()), 1..4),
        seed in any::<u64>(),
    ) {
        let hierarchy = VertexHierarchy::build(&mesh, &sequence, POLICIES[policy]).unwrap().hierarchy;
        let mut parts = HierarchyParts::from(hierarchy);
        forge(&mut parts, &changes);
        if let Ok(hierarchy) = VertexHierarchy::try_from(parts) {
            use_it(hierarchy, seed);
        }
    }

    #[test]
    fn parts_come_back_as_what_they_were(
        (mesh, sequence) in support::any_placement(),
        policy in 0usize..4,
    ) {
        let hierarchy = VertexHierarchy::build(&mesh, &sequence, POLICIES[policy]).unwrap().hierarchy;
        prop_assert_eq!(hierarchy.validate(), Ok(()));
        let back = VertexHierarchy::try_from(HierarchyParts::from(hierarchy.clone())).unwrap();
        prop_assert_eq!(back, hierarchy);
    }
}

/// Every vertex merged into the one before it, so that chains are as long as can be.
fn chain(vertices: u32, triangles: Vec<[u32; 3]>, first_triangle: Vec<u32>) -> HierarchyParts {
    let splits = vertices - 1;
    HierarchyParts {
        substitute: (0..vertices).map(|v| v.saturating_sub(1)).collect(),
        brings_start: (0..vertices).collect(),
        brings: (1..vertices).collect(),
        dependencies_start: vec![0; vertices as usize],
        bounds: vec![Bounds::new([0.0; 3], 1.0, 1.0, 1.0); splits as usize],
        triangles,
        first_triangle,
        diagonal: 1.0,
        ..HierarchyParts::default()
    }
}

/// Hop by hop this would take 10^11 steps.
#[test]
fn long_chains_are_checked_quickly() {
    let count = 300_000;
    let triangles = vec![[0, 1, count - 1]; count as usize];
    let starts = (0..count).map(|split| if split < 2 { 0 } else { count }).collect();
    let mut parts = chain(count, triangles, starts);
    let hierarchy = VertexHierarchy::try_from(parts.clone()).unwrap();
    assert_eq!(hierarchy.validate(), Ok(()));
    let mut lod = HierarchyLod::new(Arc::new(hierarchy));
    lod.adapt_by(&Random::new(&lod.hierarchy().clone(), 1, 0), Motion::Other, 0.0);
    assert_eq!(lod.triangles(0).len(), 0);
    parts.first_triangle[2] = 5;
    assert!(refusal(parts).contains("brings back triangle 5"));
}

#[test]
fn long_chains_show_the_image() {
    let count = 5_000;
    let triangles: Vec<[u32; 3]> = (0..count - 2).map(|v| [v, v + 1, v + 2]).collect();
    let starts = (0..count).map(|split| split.saturating_sub(1).min(count - 2)).collect();
    use_it(VertexHierarchy::try_from(chain(count, triangles, starts)).unwrap(), 3);
    // Far corners, which are found from the leaf.
    let triangles: Vec<[u32; 3]> = (0..200).map(|v| [0, v + 1, count - 1 - v]).collect();
    let starts: Vec<u32> = (0..count).map(|split| split.saturating_sub(1).min(200)).collect();
    use_it(VertexHierarchy::try_from(chain(count, triangles, starts)).unwrap(), 4);
}
