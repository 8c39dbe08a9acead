//! A totally ordered mesh is the sequence at every resolution, whichever way it is asked, and refuses broken parts.

use std::sync::Arc;

use crate::support::lod::bake_tom;
use crate::support::naive::degenerate;
use crate::support::{endpoint, naive};
use multires::MeshError;
use multires::lod::Baked;
use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::{CollapseSequence, NewVertex};
use multires::tom::{
    ErrorMark, Level, MaterialRange, Resolution, TomBuild, TomCursor, TomError, TomOptions, TomParts,
    TomSteps, TotallyOrderedMesh,
};
use proptest::prelude::*;

fn build(mesh: &Mesh, sequence: &CollapseSequence) -> TomBuild {
    let built = TotallyOrderedMesh::build(mesh, sequence).unwrap();
    assert_eq!(built.tom.validate(), Ok(()));
    built
}

/// All resolutions, finest first.
fn resolutions(tom: &TotallyOrderedMesh) -> Vec<Resolution> {
    std::iter::successors(Some(tom.finest()), |&r| tom.coarser(r)).collect()
}

fn indices(tom: &TotallyOrderedMesh, resolution: Resolution) -> Vec<u32> {
    let mut out = vec![77];
    tom.fill_indices(resolution, &mut out);
    out
}

fn triples(indices: &[u32]) -> &[[u32; 3]] {
    bytemuck::cast_slice(indices)
}

/// Triangles of the input by number, as the input's vertices.
fn in_input(built: &TomBuild, indices: &[u32]) -> Vec<(u32, [u32; 3])> {
    let triangles = triples(indices).iter().map(|t| t.map(|v| built.vertex_order[v as usize]));
    let mut all: Vec<_> = built.triangle_order.iter().copied().zip(triangles).collect();
    all.sort_unstable();
    all
}

fn with_new_vertices() -> (Mesh, CollapseSequence) {
    let mesh = Mesh::new([[0.0; 3], [1.0; 3]], []).unwrap();
    let new = NewVertex { from: [0, 1], weight: 0.5, position: [0.5; 3] };
    let sequence = CollapseSequence::from_collapses(&mesh, &[new], [([[0, 2], [1, 2]], 1.0)]).unwrap();
    (mesh, sequence)
}

proptest! {
    /// Every step of the sequence is a resolution, and nothing else is.
    #[test]
    fn resolutions_are_the_sequences_levels((mesh, sequence) in endpoint()) {
        let built = build(&mesh, &sequence);
        let tom = &built.tom;
        let mut left = resolutions(tom).into_iter().rev();
        let mut at = left.next();
        for steps in (0..=sequence.len()).rev() {
            if steps < sequence.len() && !sequence.substitutions(steps).is_empty() {
                at = left.next();
            }
            let at = at.unwrap();
            let to = sequence.representatives(steps.max(1).min(sequence.len()));
            let fold = |v: u32| match sequence.aliases().iter().find(|a| a[0] == v) {
                Some(&[_, kept]) => kept,
                None => v,
            };
            let expected: Vec<(u32, [u32; 3])> = (mesh.triangles().iter().enumerate())
                .map(|(t, c)| (t as u32, c.map(|v| if steps == 0 { fold(v) } else { to[v as usize] })))
                .filter(|&(_, c)| !degenerate(c))
                .collect();
            prop_assert_eq!(in_input(&built, &indices(tom, at)), expected);
            prop_assert_eq!(at.triangles(), sequence.triangles_after(steps));
            // Steps that change nothing leave the bound as it was before them.
            let same = (0..=steps).rev().take_while(|&k| k == steps || sequence.substitutions(k).is_empty()).last();
            let bound = sequence.error_after(same.unwrap());
            prop_assert!(at.error() >= bound && (at.error() == 0.0 || at != tom.finest()));
            prop_assert_eq!(tom.index_count(at), 3 * at.triangles());
        }
        prop_assert!(left.next().is_none());
    }

    #[test]
    fn drawn_indices_are_active_and_triangles_whole((mesh, sequence) in endpoint()) {
        let tom = build(&mesh, &sequence).tom;
        for r in resolutions(&tom) {
            let drawn = indices(&tom, r);
            prop_assert!(drawn.iter().all(|&v| (v as usize) < r.vertices()));
            prop_assert!(triples(&drawn).iter().all(|&t| !degenerate(t)));
        }
    }

    #[test]
    fn a_request_gets_the_finest_that_does_not_exceed_it((mesh, sequence) in endpoint(), count in 0usize..70, error in 0f32..260.0) {
        let tom = build(&mesh, &sequence).tom;
        let all = resolutions(&tom);
        let finest = |fits: &dyn Fn(&Resolution) -> bool| *all.iter().find(|r| fits(r)).unwrap_or(&tom.coarsest());
        prop_assert_eq!(tom.at(Level::Triangles(count)), finest(&|r| r.triangles() <= count));
        prop_assert_eq!(tom.at(Level::Vertices(count)), finest(&|r| r.vertices() <= count));
        let ratio = count as f32 / 64.0;
        let most = (ratio * tom.triangle_count() as f32) as usize;
        prop_assert_eq!(tom.at(Level::Ratio(ratio)), finest(&|r| r.triangles() <= most));
        let given = tom.at(Level::Error(error));
        prop_assert!(given.error() <= error);
        prop_assert!(all.contains(&given));
        let coarser_mark = tom.error_marks().iter().any(|m| m.error <= error && (m.vertices as usize) < given.vertices());
        prop_assert!(!coarser_mark);
    }

    #[test]
    fn by_material_is_the_same_triangles_sorted((mesh, sequence) in endpoint()) {
        let built = build(&mesh, &sequence);
        let (mut out, mut ranges) = (vec![1], vec![MaterialRange::default()]);
        for r in resolutions(&built.tom) {
            built.tom.fill_by_material(r, &mut out, &mut ranges);
            let flat = indices(&built.tom, r);
            let mut start = 0;
            for range in &ranges {
                prop_assert_eq!(range.start, start);
                start += range.count;
                let own: Vec<[u32; 3]> = (triples(&flat).iter().zip(&built.triangle_order))
                    .filter(|&(_, &t)| mesh.materials().get(t as usize).is_none_or(|&m| m == range.material))
                    .map(|(t, _)| *t)
                    .collect();
                prop_assert_eq!(own.as_flattened(), &out[range.start as usize..start as usize]);
            }
            prop_assert_eq!(start as usize, out.len());
            prop_assert_eq!(out.len(), flat.len());
        }
    }

    #[test]
    fn a_slice_takes_whole_triangles((mesh, sequence) in endpoint(), room in 0usize..40) {
        let tom = build(&mesh, &sequence).tom;
        for r in resolutions(&tom) {
            let mut out = vec![u32::MAX; room];
            let written = tom.write_indices(r, &mut out);
            let all = indices(&tom, r);
            prop_assert_eq!(written, all.len().min(room / 3 * 3));
            prop_assert_eq!(&out[..written], &all[..written]);
            prop_assert!(out[written..].iter().all(|&v| v == u32::MAX));
        }
    }

    /// Cursors, plain and by material, and a copy of the buffer kept up to date by dirty ranges alone.
    #[test]
    fn cursors_agree_with_filling((mesh, sequence) in endpoint(), walk in prop::collection::vec(0usize..70, 1..20)) {
        let tom = build(&mesh, &sequence).tom;
        for by_material in [false, true] {
            let steps = if by_material { TomSteps::by_material(tom.clone()) } else { TomSteps::new(tom.clone()) };
            let mut cursor = TomCursor::new(Arc::new(steps.unwrap()));
            let mut copy = vec![9; cursor.buffer().len()];
            let (mut out, mut ranges) = (Vec::new(), Vec::new());
            let mut from = tom.finest();
            for &count in &walk {
                let to = tom.at(Level::Triangles(count));
                let change = cursor.seek(to);
                prop_assert_eq!((change.from, change.to), (from, to));
                prop_assert_eq!(cursor.resolution(), to);
                from = to;
                // Not every move is followed by an upload.
                if count % 3 > 0 {
                    for dirty in cursor.take_dirty().to_vec() {
                        copy[dirty.clone()].copy_from_slice(&cursor.buffer()[dirty]);
                    }
                    prop_assert_eq!(&copy[..], cursor.buffer());
                    prop_assert!(cursor.take_dirty().is_empty());
                }
                if by_material {
                    tom.fill_by_material(to, &mut out, &mut ranges);
                    prop_assert_eq!(ranges.len(), cursor.ranges().len());
                    for (a, b) in ranges.iter().zip(cursor.ranges()) {
                        prop_assert_eq!((a.material, a.count), (b.material, b.count));
                        let [a, b] = [a, b].map(|r| r.start as usize..(r.start + r.count) as usize);
                        prop_assert_eq!(&out[a], &cursor.buffer()[b]);
                    }
                } else {
                    prop_assert_eq!(cursor.indices(), &indices(&tom, to)[..]);
                }
            }
        }
    }

    /// The finer indices with every vertex at its target are the coarser ones, and some vanished triangles.
    #[test]
    fn geomorphs_end_in_the_coarser_resolution((mesh, sequence) in endpoint(), a in 0usize..70, b in 0usize..70) {
        let tom = build(&mesh, &sequence).tom;
        let (a, b) = (tom.at(Level::Vertices(a)), tom.at(Level::Vertices(b)));
        let (coarse, fine) = if a.vertices() < b.vertices() { (a, b) } else { (b, a) };
        let mut targets = vec![5; 3];
        tom.geomorph(a, b, &mut targets);
        prop_assert_eq!(targets.len(), fine.vertices() - coarse.vertices());
        let moved: Vec<u32> = (indices(&tom, fine).into_iter())
            .map(|v| if (v as usize) < coarse.vertices() { v } else { targets[v as usize - coarse.vertices()] })
            .collect();
        let kept: Vec<[u32; 3]> = triples(&moved).iter().copied().filter(|&t| !degenerate(t)).collect();
        prop_assert_eq!(kept.as_flattened(), indices(&tom, coarse));
    }

    #[test]
    fn stepping_finer_undoes_stepping_coarser((mesh, sequence) in endpoint()) {
        let tom = build(&mesh, &sequence).tom;
        let all = resolutions(&tom);
        prop_assert_eq!(*all.last().unwrap(), tom.coarsest());
        for pair in all.windows(2) {
            prop_assert_eq!(tom.finer(pair[1]), Some(pair[0]));
            prop_assert!(pair[1].triangles() <= pair[0].triangles());
            prop_assert!(pair[1].error() >= pair[0].error());
        }
        prop_assert_eq!(tom.finer(tom.finest()), None);
    }

    #[test]
    fn another_meshs_resolution_does_no_harm((mesh, sequence) in endpoint(), (other, foreign) in endpoint()) {
        let (tom, other) = (build(&mesh, &sequence).tom, build(&other, &foreign).tom);
        let mut cursor = TomCursor::new(Arc::new(TomSteps::by_material(tom.clone()).unwrap()));
        let (mut out, mut ranges, mut targets) = (Vec::new(), Vec::new(), Vec::new());
        for r in resolutions(&other) {
            tom.fill_indices(r, &mut out);
            prop_assert!(out.iter().all(|&v| (v as usize) < tom.vertex_count()));
            tom.fill_by_material(r, &mut out, &mut ranges);
            tom.geomorph(r, other.finest(), &mut targets);
            tom.traversal_overhead(r);
            let to = cursor.seek(r).to;
            prop_assert!(to == tom.at(Level::Vertices(r.vertices())));
            let _ = (tom.coarser(r), tom.finer(r));
        }
    }

    #[test]
    fn parts_come_back_as_they_were((mesh, sequence) in endpoint()) {
        let tom = build(&mesh, &sequence).tom;
        prop_assert_eq!(TotallyOrderedMesh::try_from(TomParts::from(tom.clone())), Ok(tom));
    }

    /// Whatever parts pass the check can be used in every way.
    #[test]
    fn parts_that_pass_are_usable(
        (mesh, sequence) in endpoint(),
        changes in prop::collection::vec((0u8..9, any::<prop::sample::Index>(), any::<u8>(), any::<bool>()), 1..4),
    ) {
        let mut parts = TomParts::from(build(&mesh, &sequence).tom);
        for (what, at, value, flag) in changes {
            let value = if flag { u32::MAX - u32::from(value) } else { u32::from(value) % 48 };
            let change = |array: &mut [u32]| if !array.is_empty() { array[at.index(array.len())] = value };
            match what {
                0 => change(&mut parts.substitute),
                1 => change(parts.triangles.as_flattened_mut()),
                2 => change(&mut parts.material_of),
                3 => change(&mut parts.material_ids),
                4 => parts.base_vertices = value,
                5 => drop(parts.substitute.pop()),
                6 => drop(parts.triangles.pop()),
                7 => parts.joined = vec![u64::from(value) << (value % 48)],
                _ => parts.error_marks.iter_mut().for_each(|m| m.vertices ^= value),
            }
        }
        if let Ok(tom) = TotallyOrderedMesh::try_from(parts) {
            let mut cursor = TomCursor::new(Arc::new(TomSteps::new(tom.clone()).unwrap()));
            for r in resolutions(&tom) {
                let drawn = indices(&tom, r);
                prop_assert!(drawn.iter().all(|&v| (v as usize) < r.vertices()));
                prop_assert!(triples(&drawn).iter().all(|&t| !degenerate(t)));
                cursor.seek(r);
                prop_assert_eq!(cursor.indices(), &drawn[..]);
                prop_assert_eq!(tom.at(Level::Triangles(r.triangles())).triangles(), r.triangles());
            }
        }
    }
}

#[test]
fn requests_out_of_range_get_the_ends() {
    let mesh = naive::torus(12, 10, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 40)).tom;
    let (full, base) = (tom.finest(), tom.coarsest());
    assert_eq!((full.triangles(), full.error()), (240, 0.0));
    assert!(base.triangles() <= 40 && base.error() > 0.0);
    for level in [Level::Triangles(usize::MAX), Level::Vertices(usize::MAX), Level::Ratio(f32::INFINITY)] {
        assert_eq!(tom.at(level), full);
    }
    for level in [Level::Error(-1.0), Level::Error(f32::NAN), Level::Error(0.0), Level::Ratio(1.0)] {
        assert_eq!(tom.at(level), full);
    }
    for level in [Level::Triangles(0), Level::Vertices(0), Level::Ratio(f32::NAN), Level::Ratio(-1.0)] {
        assert_eq!(tom.at(level), base);
    }
    assert_eq!(tom.at(Level::Error(f32::INFINITY)), base);
    assert_eq!(tom.substitute(tom.vertex_count() as u32), None);
    assert_eq!(tom.substitute(0), Some(0));
}

#[test]
fn an_empty_mesh_has_one_resolution() {
    let empty = Mesh::default();
    let sequence = CollapseSequence::from_substitutions(&empty, [([[0u32; 2]; 0], 0.0)]).unwrap();
    let tom = build(&empty, &sequence).tom;
    assert_eq!(tom.finest(), tom.coarsest());
    assert_eq!(tom.at(Level::Error(1.0)), tom.finest());
    assert_eq!(tom.traversal_overhead(tom.finest()), 0.0);
    let mut cursor = TomCursor::new(Arc::new(TomSteps::by_material(tom.clone()).unwrap()));
    cursor.seek(tom.at(Level::Ratio(0.5)));
    assert!(cursor.indices().is_empty() && cursor.take_dirty().is_empty());
}

#[test]
fn a_seam_never_tears() {
    let mesh = naive::torus(24, 20, true, true);
    let sequence = naive::sequence(&mesh, 60);
    let built = build(&mesh, &sequence);
    let tom = &built.tom;
    assert!((0..sequence.len()).any(|s| sequence.substitutions(s).len() == 2), "there are seams");
    let positions = bake_tom(&mesh, &sequence).arrange(mesh.positions()).unwrap();
    for r in resolutions(tom) {
        // Welded by position, every edge has two sides: the torus stays closed.
        let bits = |v: u32| positions[v as usize].map(f32::to_bits);
        let mut edges: Vec<_> = (triples(&indices(tom, r)).iter())
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| (bits(a).min(bits(b)), bits(a).max(bits(b))))
            .filter(|(a, b)| a != b)
            .collect();
        edges.sort_unstable();
        assert!(edges.chunk_by(|a, b| a == b).all(|e| e.len() % 2 == 0), "{} vertices", r.vertices());
    }
}

#[test]
fn base_vertices_and_triangles_keep_the_inputs_order() {
    let mesh = naive::torus(12, 10, false, false);
    let sequence = naive::sequence(&mesh, 40);
    let built = build(&mesh, &sequence);
    let base = built.tom.coarsest();
    assert!(built.vertex_order[..base.vertices()].is_sorted());
    for pair in resolutions(&built.tom).windows(2) {
        assert!(built.triangle_order[pair[1].triangles()..pair[0].triangles()].is_sorted());
    }
    // Then by reverse order of removal.
    let removed: Vec<u32> =
        (0..sequence.len()).rev().flat_map(|s| sequence.substitutions(s).iter().map(|s| s[0])).collect();
    assert_eq!(&built.vertex_order[base.vertices()..], removed);
}

#[test]
fn duplicates_and_unused_vertices_come_last() {
    let positions = [[9., 9., 9.], [1., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.], [0., 0., 0.]];
    let mesh = Mesh::new(positions, [[5, 1, 3], [3, 2, 4]]).unwrap();
    let sequence = CollapseSequence::from_substitutions(&mesh, [([[4, 3]], 1.0)]).unwrap();
    let built = build(&mesh, &sequence);
    assert_eq!(built.tom.vertex_count(), 4);
    assert_eq!(built.vertex_order, [1, 3, 5, 4, 2, 0]);
    assert_eq!(indices(&built.tom, built.tom.finest()), [2, 0, 1, 1, 0, 3]);
}

#[test]
fn arranging_carries_everything_along() {
    let mesh = naive::torus(8, 6, true, true);
    let locks: Vec<bool> = (0..mesh.positions().len()).map(|v| v % 3 == 0).collect();
    let ids: Vec<[f32; 1]> = (0..locks.len()).map(|v| [v as f32]).collect();
    let mesh = mesh.with_locks(locks).unwrap().with_attribute(Attribute::floats("id", &ids)).unwrap();
    let sequence = naive::sequence(&mesh, 30);
    let (built, model) = (build(&mesh, &sequence), bake_tom(&mesh, &sequence));
    assert_eq!(**model.structure(), built.tom);
    let (arranged, finest) = (model.vertices(), model.mesh_at(built.tom.finest()));
    assert_eq!(finest.triangles(), built.tom.triangles());
    // All of them are in use.
    assert_eq!(finest.positions(), arranged.positions());
    assert_eq!(arranged.positions().len(), built.tom.vertex_count());
    let id = arranged.attribute("id").unwrap().as_floats().unwrap();
    let uv = arranged.attribute(names::UV).unwrap().as_floats().unwrap();
    for (place, &v) in built.vertex_order[..built.tom.vertex_count()].iter().enumerate() {
        assert_eq!(arranged.positions()[place], mesh.positions()[v as usize]);
        assert_eq!(arranged.locks()[place], mesh.locks()[v as usize]);
        assert_eq!(id[place], v as f32);
        let source = mesh.attribute(names::UV).unwrap().as_floats().unwrap();
        assert_eq!(uv[2 * place..2 * place + 2], source[2 * v as usize..2 * v as usize + 2]);
    }
    for (place, &t) in built.triangle_order.iter().enumerate() {
        assert_eq!(finest.materials()[place], mesh.materials()[t as usize]);
    }
    assert!(matches!(model.arrange(&[1, 2, 3]), Err(MeshError::LengthMismatch { found: 3, .. })));
    let other = naive::torus(4, 4, false, false);
    assert!(model.arrange(other.positions()).is_err());
    assert!(Baked::<TotallyOrderedMesh>::of_sequence(&other, &sequence, &TomOptions::default()).is_err());
}

#[test]
fn new_vertices_and_foreign_meshes_are_refused() {
    let (mesh, sequence) = with_new_vertices();
    assert_eq!(TotallyOrderedMesh::build(&mesh, &sequence), Err(TomError::NewVertices { count: 1 }));
    let mesh = naive::torus(6, 5, false, false);
    let sequence = naive::sequence(&mesh, 20);
    let other = naive::torus(6, 6, false, false);
    assert!(matches!(TotallyOrderedMesh::build(&other, &sequence), Err(TomError::Sequence(_))));
}

/// TOM, section 3.1: about 108 % of the plain mesh with positions and normals.
#[test]
fn memory_is_at_most_108_and_a_half_percent() {
    for (rows, columns) in [(50, 40), (120, 90)] {
        let mesh = naive::torus(rows, columns, false, false);
        let tom = build(&mesh, &naive::sequence(&mesh, 100)).tom;
        let plain = 24 * mesh.positions().len() + 12 * mesh.triangles().len();
        let share = tom.memory(24) as f64 / plain as f64;
        eprintln!("{} vertices: {share:.4} of the plain mesh", mesh.positions().len());
        assert!(share <= 1.085, "{share}");
        assert!(tom.error_marks().len() <= 1024);
    }
}

#[test]
fn cursor_memory_is_what_is_documented() {
    let mesh = naive::torus(60, 40, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 100)).tom;
    let (vertices, triangles) = (tom.vertex_count(), tom.triangle_count());
    let own = tom.memory(0);
    let steps = Arc::new(TomSteps::new(tom).unwrap());
    let table = (steps.memory() - own) as f64 / vertices as f64;
    eprintln!("the table takes {table:.1} bytes a vertex");
    assert!((12.0..24.0).contains(&table), "{table}");
    let cursor = TomCursor::new(steps);
    let over = cursor.memory() - 12 * triangles;
    assert!(over <= triangles * 3 / 64 / 8 + 1024, "{over}");
}

/// The last step's difference is written, not the mesh.
#[test]
fn one_step_writes_a_handful_of_indices() {
    let mesh = naive::torus(60, 40, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 100)).tom;
    let mut cursor = TomCursor::new(Arc::new(TomSteps::new(tom.clone()).unwrap()));
    let first = cursor.take_dirty();
    assert_eq!((first.len(), first[0].clone()), (1, 0..3 * tom.triangle_count()));
    let mut written = 0;
    for r in resolutions(&tom) {
        written += cursor.seek(r).written;
        assert!(cursor.take_dirty().len() <= 32);
    }
    let steps = tom.vertex_count() - tom.coarsest().vertices();
    assert!(written < 8 * steps, "{written} indices in {steps} steps");
    assert_eq!(cursor.seek(tom.coarsest()).written, 0);
}

#[test]
fn dirty_ranges_are_few_apart_and_ascending() {
    let mesh = naive::torus(120, 90, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 100)).tom;
    let mut cursor = TomCursor::new(Arc::new(TomSteps::new(tom.clone()).unwrap()));
    cursor.take_dirty();
    // Finer than most: writes scattered all over a long buffer.
    cursor.seek(tom.at(Level::Ratio(0.9)));
    let ranges = cursor.take_dirty();
    assert!((2..=32).contains(&ranges.len()), "{}", ranges.len());
    assert!(ranges.iter().all(|r| r.start < r.end));
    assert!(ranges.windows(2).all(|w| w[0].end < w[1].start));
}

#[test]
fn nothing_grows_once_warm() {
    let mesh = naive::torus(60, 40, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 100)).tom;
    let mut out = Vec::with_capacity(3 * tom.triangle_count() + tom.vertex_count());
    let (capacity, place) = (out.capacity(), out.as_ptr());
    let mut cursor = TomCursor::new(Arc::new(TomSteps::new(tom.clone()).unwrap()));
    let (memory, buffer) = (cursor.memory(), cursor.buffer().as_ptr());
    for count in (0..tom.triangle_count()).step_by(97).map(|n| n * 31 % tom.triangle_count()) {
        let r = tom.at(Level::Triangles(count));
        tom.fill_indices(r, &mut out);
        cursor.seek(r);
        cursor.take_dirty();
        assert_eq!((out.capacity(), out.as_ptr()), (capacity, place));
        assert_eq!((cursor.memory(), cursor.buffer().as_ptr()), (memory, buffer));
    }
}

#[test]
fn overhead_counts_hops() {
    let mesh = naive::torus(12, 10, false, false);
    let tom = build(&mesh, &naive::sequence(&mesh, 40)).tom;
    assert_eq!(tom.traversal_overhead(tom.finest()), 0.0);
    // One step down, each corner that changed is one hop.
    let one = tom.coarser(tom.finest()).unwrap();
    let changed =
        (indices(&tom, one).iter().zip(tom.triangles().as_flattened())).filter(|(a, b)| a != b).count();
    assert_eq!(tom.traversal_overhead(one), changed as f64 / (3 * one.triangles()) as f64);
    assert!(tom.traversal_overhead(tom.coarsest()) > 1.0);
}

/// A small mesh's parts, to break: 3 base vertices, then groups of 1, 2 and 1.
///
/// ```text
///     0 ---- 1 ---- 3        3 -> 1      4 -> 3, 5 -> 4     6 -> 5
///      \    / \    / \
///       \  /   \  /   \
///        2 ---- 4 ---- 5 ---- 6
/// ```
fn parts() -> TomParts {
    TomParts {
        substitute: vec![0, 1, 2, 1, 3, 4, 5],
        joined: vec![1 << 5],
        base_vertices: 3,
        triangles: vec![[0, 2, 1], [1, 2, 4], [1, 4, 3], [3, 4, 5], [3, 5, 6]],
        error_marks: vec![ErrorMark { vertices: 3, error: 2.0 }, ErrorMark { vertices: 4, error: 1.0 }],
        material_of: vec![0, 1, 1, 0, 1],
        material_ids: vec![4, 9],
    }
}

fn refusal(change: impl Fn(&mut TomParts)) -> TomError {
    let mut parts = parts();
    change(&mut parts);
    TotallyOrderedMesh::try_from(parts).unwrap_err()
}

#[test]
fn the_parts_to_break_are_whole() {
    let tom = TotallyOrderedMesh::try_from(parts()).unwrap();
    let counts: Vec<_> = resolutions(&tom).iter().map(|r| (r.vertices(), r.triangles(), r.error())).collect();
    assert_eq!(counts, [(7, 5, 0.0), (6, 4, 1.0), (4, 2, 1.0), (3, 1, 2.0)]);
    assert_eq!(indices(&tom, tom.at(Level::Vertices(5))), [0, 2, 1, 1, 2, 3]);
}

#[test]
fn late_substitutes_are_refused() {
    assert_eq!(refusal(|p| p.substitute[4] = 4), TomError::LateSubstitute { vertex: 4, substitute: 4 });
    assert_eq!(refusal(|p| p.substitute[3] = 6), TomError::LateSubstitute { vertex: 3, substitute: 6 });
}

#[test]
fn base_vertices_that_go_are_refused() {
    assert_eq!(refusal(|p| p.substitute[1] = 0), TomError::BaseSubstitute { vertex: 1 });
    assert_eq!(refusal(|p| p.base_vertices = 4), TomError::BaseSubstitute { vertex: 3 });
    assert_eq!(refusal(|p| p.base_vertices = 2), TomError::LateSubstitute { vertex: 2, substitute: 2 });
    let error = refusal(|p| p.base_vertices = 8);
    assert_eq!(error, TomError::Length { what: "base vertices", found: 8, expected: 7 });
}

#[test]
fn misplaced_groups_are_refused() {
    assert_eq!(refusal(|p| p.joined[0] |= 1 << 3), TomError::Group { vertex: 3 });
    assert_eq!(refusal(|p| p.joined[0] |= 1), TomError::Group { vertex: 0 });
    assert_eq!(refusal(|p| p.joined[0] |= 1 << 7), TomError::Group { vertex: 7 });
    let error = refusal(|p| p.joined.push(0));
    assert_eq!(error, TomError::Length { what: "group words", found: 2, expected: 1 });
    // Two steps become one, at whose end an error mark then has no place.
    assert_eq!(refusal(|p| p.joined[0] |= 1 << 4), TomError::ErrorMark { mark: 1 });
}

#[test]
fn triangles_out_of_range_or_order_are_refused() {
    let missing = TomError::Corner { triangle: 3, vertex: 7, vertices: 7 };
    assert_eq!(refusal(|p| p.triangles[3][1] = 7), missing);
    assert_eq!(refusal(|p| p.triangles[2][1] = 1), TomError::Degenerate { triangle: 2 });
    assert_eq!(refusal(|p| p.triangles.swap(0, 1)), TomError::TriangleOrder { triangle: 1 });
    assert_eq!(refusal(|p| p.triangles.swap(1, 4)), TomError::TriangleOrder { triangle: 2 });
}

#[test]
fn rising_or_misplaced_errors_are_refused() {
    assert_eq!(refusal(|p| p.error_marks[1].error = 2.5), TomError::ErrorMark { mark: 1 });
    assert_eq!(refusal(|p| p.error_marks[1].error = -0.5), TomError::ErrorMark { mark: 1 });
    assert_eq!(refusal(|p| p.error_marks[0].error = f32::NAN), TomError::ErrorMark { mark: 0 });
    assert_eq!(refusal(|p| p.error_marks[1].vertices = 5), TomError::ErrorMark { mark: 1 });
    assert_eq!(refusal(|p| p.error_marks[1].vertices = 3), TomError::ErrorMark { mark: 1 });
    assert_eq!(refusal(|p| p.error_marks[1].vertices = 99), TomError::ErrorMark { mark: 1 });
    assert_eq!(refusal(|p| p.error_marks[0].vertices = 4), TomError::ErrorMark { mark: 0 });
    assert_eq!(refusal(|p| p.error_marks.clear()), TomError::ErrorMark { mark: 0 });
}

#[test]
fn materials_out_of_range_are_refused() {
    assert_eq!(refusal(|p| p.material_of[3] = 2), TomError::Material { entry: 3 });
    assert_eq!(refusal(|p| p.material_ids.swap(0, 1)), TomError::Material { entry: 1 });
    let short = TomError::Length { what: "triangle materials", found: 4, expected: 5 };
    assert_eq!(refusal(|p| p.material_of.truncate(4)), short);
    let none = TomError::Length { what: "triangle materials", found: 5, expected: 0 };
    assert_eq!(refusal(|p| p.material_ids.truncate(1)), none);
}

#[cfg(feature = "serde")]
#[test]
fn a_broken_file_is_refused() {
    let tom = TotallyOrderedMesh::try_from(parts()).unwrap();
    let text = serde_json::to_string(&tom).unwrap();
    assert_eq!(serde_json::from_str::<TotallyOrderedMesh>(&text).unwrap(), tom);
    let broken = text.replace("[3,5,6]", "[3,5,60]");
    assert_ne!(broken, text);
    let error = serde_json::from_str::<TotallyOrderedMesh>(&broken).unwrap_err();
    assert!(error.to_string().contains("triangle 4 names vertex 60"), "{error}");
}

/// Chains as long as the mesh must not make checking take the square of it.
#[test]
fn long_chains_are_checked_in_time() {
    let count = 200_000u32;
    let mut parts = TomParts { base_vertices: 3, substitute: vec![0, 1, 2], ..TomParts::default() };
    parts.substitute.extend((3..count).map(|v| v - 1));
    parts.triangles = vec![[count - 1, 0, 1]; 200_000];
    parts.error_marks = vec![ErrorMark { vertices: 3, error: 1.0 }];
    assert!(TotallyOrderedMesh::try_from(parts).is_ok());
}
