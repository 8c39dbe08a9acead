//! A vertex hierarchy at any cut is the image of the input under the collapses that are left; and the cut is what the view asks for,
//! whatever it was before.

mod support;

use std::sync::Arc;

use multires::adapt::{Cut, LevelOfDetail, Refinements};
use multires::hierarchy::{Dependencies, HierarchyBuild, HierarchyLod, VertexHierarchy};
use multires::mesh::{Mesh, shapes};
use multires::simplify::{CollapseSequence, Placement, Simplifier};
use multires::view::{Answer, Bounds, Criterion, Motion, ObjectView, View};
use proptest::prelude::*;

const POLICIES: [Dependencies; 3] = [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours];

/// Needs what a hash says, but for what needs its parents' hash: so any closed set can be asked for.
#[derive(Clone)]
struct Random<'a> {
    hierarchy: &'a VertexHierarchy,
    needed: Vec<bool>,
}

impl<'a> Random<'a> {
    fn new(hierarchy: &'a VertexHierarchy, seed: u64, share: u64) -> Self {
        let mut needed: Vec<bool> = Vec::new();
        for split in 0..hierarchy.split_count() as u32 {
            let hash =
                (u64::from(split) + 1).wrapping_mul(seed | 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
            let own = hash % 100 < share;
            needed.push(own && hierarchy.parents(split).all(|parent| needed[parent as usize]));
        }
        Self { hierarchy, needed }
    }
}

impl Criterion for Random<'_> {
    fn needs(&self, bounds: &Bounds) -> Answer {
        let first = self.hierarchy.bounds(0);
        let split =
            (std::ptr::from_ref(bounds).addr() - std::ptr::from_ref(first).addr()) / size_of::<Bounds>();
        Answer::once(self.needed[split])
    }

    fn motion(&self, _: &Self) -> Motion {
        Motion::Other
    }
}

/// The triangles that are drawn, by number, as vertices of the hierarchy.
fn drawn(lod: &HierarchyLod) -> Vec<(u32, [u32; 3])> {
    let mut all = Vec::new();
    for group in 0..lod.groups() {
        let named = lod.triangles(group).iter().map(|t| match lod.vertices() {
            Some(vertices) => t.map(|slot| vertices[slot as usize]),
            None => *t,
        });
        all.extend(lod.surface().drawn(group).iter().copied().zip(named));
    }
    all.sort_unstable();
    all
}

/// The same from the definition.
fn image(hierarchy: &VertexHierarchy, cut: &Cut) -> Vec<(u32, [u32; 3])> {
    let triangles = hierarchy.triangles().iter().enumerate();
    let all = triangles.map(|(t, corners)| (t as u32, corners.map(|v| hierarchy.stand_in(v, cut))));
    all.filter(|(_, [a, b, c])| a != b && b != c && c != a).collect()
}

fn splits(hierarchy: &VertexHierarchy, cut: &Cut) -> Vec<u32> {
    (0..hierarchy.split_count() as u32).filter(|&split| cut.holds(split)).collect()
}

fn assert_closed(hierarchy: &VertexHierarchy, cut: &Cut) {
    for split in splits(hierarchy, cut) {
        assert!(hierarchy.parents(split).chain(hierarchy.needs(split)).all(|other| cut.holds(other)));
    }
}

/// The smallest closed set that holds what is asked for.
fn closure(hierarchy: &VertexHierarchy, needed: &[bool]) -> Vec<u32> {
    let mut holds = vec![false; needed.len()];
    let mut stack: Vec<u32> = (0..needed.len() as u32).filter(|&split| needed[split as usize]).collect();
    while let Some(split) = stack.pop() {
        if !std::mem::replace(&mut holds[split as usize], true) {
            stack.extend(hierarchy.parents(split).chain(hierarchy.needs(split)));
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
        policy in 0usize..3,
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
            lod.adapt_by(&asked, Motion::Other);
            prop_assert_eq!(splits(&hierarchy, lod.cut()), closure(&hierarchy, &asked.needed));
            prop_assert_eq!(drawn(&lod), image(&hierarchy, lod.cut()));
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

fn shape(which: usize) -> Mesh {
    match which {
        0 => shapes::rock(2_000, 1),
        1 => shapes::terrain(24, 3),
        2 => shapes::uv_sphere(24, 12),
        3 => shapes::book(5),
        4 => shapes::two_spheres_touching(2),
        5 => shapes::soup(200, 4),
        6 => support::naive::torus(20, 30, true, true),
        _ => shapes::box_with_face_normals(6),
    }
}

/// A view of a mesh from somewhere around it.
fn view(mesh: &Mesh, [x, y, z]: [f32; 3], turn: f32, tolerance: f32) -> ObjectView {
    let [low, high] = mesh.bounds().unwrap();
    let diagonal = mesh.diagonal() as f32;
    let middle = |i: usize| (low[i] + high[i]) * 0.5;
    let eye = [middle(0) + x * diagonal, middle(1) + y * diagonal, middle(2) + z * diagonal];
    // A turn about y, then the eye moved to the origin.
    let (sine, cosine) = turn.sin_cos();
    let rows = [[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]];
    let along = |row: [f32; 3]| -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]);
    let column = |i: usize| [rows[0][i], rows[1][i], rows[2][i], 0.0];
    let matrix = [column(0), column(1), column(2), [along(rows[0]), along(rows[1]), along(rows[2]), 1.0]];
    View::perspective(matrix, 1.0, [640, 480])
        .unwrap()
        .with_tolerance_px(tolerance)
        .with_silhouette_px(tolerance * 0.5)
        .of_world()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Many small and large motions later, the cut is the one that a fresh instance finds for the last view: sleeping
    /// never misses anything, and the cut does not depend on the way.
    #[test]
    fn the_cut_depends_on_the_view_alone(
        which in 0usize..8,
        policy in 0usize..3,
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
            let view = view(&mesh, eye, turn, tolerance);
            lod.adapt(std::slice::from_ref(&view));
            let mut fresh = HierarchyLod::new(hierarchy.clone());
            fresh.adapt(&[view]);
            prop_assert_eq!(splits(&hierarchy, lod.cut()), splits(&hierarchy, fresh.cut()));
            prop_assert_eq!(drawn(&lod), drawn(&fresh));
        }
        assert_closed(&hierarchy, lod.cut());
    }
}
