//! From a collapse sequence to a g-mesh: levels at ends of batches, vertices by the last level that draws them, targets.

use crate::mesh::{Mesh, NONE};
use crate::sequence::CollapseSequence;
use crate::sequence::collapse_forest::CollapseForest;
use crate::simplify::OptionError;

use super::shrink::Vanishing;
use super::{Gmesh, GmeshError, GmeshOptions, GmeshParts};

/// A g-mesh, and the vertex of the sequence at each place of its order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct GmeshBuild {
    /// The structure.
    pub gmesh: Gmesh,
    /// Vertex of the sequence (input vertices, then new vertices) at each place of the order: all that some level draws.
    pub vertex_order: Vec<u32>,
}

impl Gmesh {
    /// Builds the structure from a mesh and its simplification, of any placement and order.
    ///
    /// Triangles keep the input's order within a material. Degenerate triangles are left out, duplicate vertices folded. Parts
    /// that vanish as a whole shrink to a point of their own. O(vertices + triangles) log, plus the output. To get vertices and
    /// their origins too, call [`Baked::of_sequence`](crate::lod::Baked::of_sequence).
    ///
    /// # Errors
    /// The share of the options is not above 0 and at most 0.9; the sequence belongs to another mesh, or does not hold
    /// together.
    pub fn build(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        options: &GmeshOptions,
    ) -> Result<GmeshBuild, GmeshError> {
        let share = f64::from(options.share);
        if !(share > 0.0 && share <= 0.9) {
            let expected = "above 0, at most 0.9";
            return Err(OptionError::OutOfRange { option: "share of a level", value: share, expected }.into());
        }
        let forest = CollapseForest::new(mesh, sequence)?;
        let marks = level_marks(sequence, share);
        let kept = Kept::new(sequence, &forest, &marks);
        let mut targets = targets(&forest, &marks);
        let ends: Vec<u32> = mesh.triangles().iter().map(|&t| forest.end(t)).collect();
        let corners = |t: &[u32; 3]| t.map(|v| forest.folded(v));
        let drawn = ends.iter().zip(mesh.triangles()).filter(|(end, _)| **end != 0);
        let drawn: Vec<(u32, [u32; 3])> = drawn.map(|(&end, t)| (end, corners(t))).collect();
        let placed = sequence.placed(mesh);
        let position = |number: u32| match forest.order[number as usize].checked_sub(sequence.input_vertices)
        {
            None => placed[forest.order[number as usize] as usize],
            Some(new) => sequence.new_vertices()[new as usize].position,
        };
        let vanishing = Vanishing {
            drawn: &drawn,
            marks: &marks,
            removed: &forest.removed,
            parent: &|number| forest.parent(number),
            position,
            is_kept: |number: u32| kept.place[number as usize] != NONE,
        };
        vanishing.shrink(&mut targets);

        let (triangles, group_ends, material_ids) =
            by_material(mesh, &ends, |t| corners(t).map(|v| kept.place[v as usize]));
        let place = |&number: &u32| kept.place[number as usize];
        let parts = GmeshParts {
            level_vertices: kept.level_vertices,
            level_errors: marks.iter().map(|&mark| sequence.error_after(mark as usize)).collect(),
            level_volumes: Vec::new(),
            targets: kept.numbers.iter().map(|&number| place(&targets[number as usize])).collect(),
            triangles,
            group_ends,
            material_ids,
        };
        let vertex_order: Vec<u32> =
            kept.numbers.iter().map(|&number| forest.order[number as usize]).collect();
        let gmesh =
            with_volumes(parts, &kept.numbers.iter().map(|&number| position(number)).collect::<Vec<_>>())?;
        Ok(GmeshBuild { gmesh, vertex_order })
    }
}

/// Returns the steps after which each level is reached, 0 first.
fn level_marks(sequence: &CollapseSequence, share: f64) -> Vec<u32> {
    let mut marks = vec![0_u32];
    let most = |marks: &[u32]| {
        let last = marks[marks.len() - 1];
        (share * sequence.triangles_after(last as usize) as f64) as usize
    };
    if sequence.batches().len() > 1 {
        for &end in sequence.batches() {
            if sequence.triangles_after(end as usize) <= most(&marks) {
                marks.push(end);
            }
        }
    } else {
        loop {
            let steps = sequence.steps_for_triangles(most(&marks)) as u32;
            if steps <= marks[marks.len() - 1] || sequence.triangles_after(steps as usize) > most(&marks) {
                break;
            }
            marks.push(steps);
        }
    }
    let last = marks[marks.len() - 1];
    if sequence.triangles_after(sequence.len()) < sequence.triangles_after(last as usize) {
        // A level that keeps more than the share is no level of its own: the level before it goes on to the end.
        if marks.len() > 1 {
            marks.pop();
        }
        marks.push(sequence.len() as u32);
    }
    marks
}

/// Vertices that some level draws, in the order of the forest.
struct Kept {
    /// The forest's number of each.
    numbers: Vec<u32>,
    /// Per number of the forest its place; `NONE` where no level draws it.
    place: Vec<u32>,
    /// Vertices of each level.
    level_vertices: Vec<u32>,
}

impl Kept {
    fn new(sequence: &CollapseSequence, forest: &CollapseForest<'_>, marks: &[u32]) -> Self {
        let inputs = sequence.input_vertices();
        let mut born = vec![0_u32; sequence.vertex_count() - inputs];
        for step in (0..sequence.len()).rev() {
            for &[_, to] in sequence.substitutions(step) {
                if let Some(new) = (to as usize).checked_sub(inputs) {
                    born[new] = step as u32 + 1;
                }
            }
        }
        let mut kept =
            Self { numbers: Vec::new(), place: vec![NONE; forest.order.len()], level_vertices: Vec::new() };
        for number in 0..forest.real {
            let vertex = forest.order[number as usize] as usize;
            let born = vertex.checked_sub(inputs).map_or(0, |new| born[new]);
            // The first level after its birth must come before its removal.
            let first = marks.partition_point(|&mark| mark < born);
            if marks.get(first).is_some_and(|&mark| mark < forest.removed[number as usize]) {
                kept.place[number as usize] = kept.numbers.len() as u32;
                kept.numbers.push(number);
            }
        }
        // Numbers ascend from last removed to first removed.
        let count = |&mark: &u32| kept.numbers.partition_point(|&n| forest.removed[n as usize] > mark) as u32;
        kept.level_vertices = marks.iter().map(count).collect();
        kept
    }
}

/// Returns for every number of the forest the number that stands for it in the first level that lacks it; itself for roots.
fn targets(forest: &CollapseForest<'_>, marks: &[u32]) -> Vec<u32> {
    let removed = |number: u32| forest.removed[number as usize];
    let mut targets: Vec<u32> = Vec::with_capacity(forest.real as usize);
    for number in 0..forest.real {
        let gone = removed(number);
        let next = marks.partition_point(|&mark| mark < gone);
        let target = match marks.get(next) {
            // Parents have lower numbers. One that is gone at the same level leads on to a target there.
            Some(&mark) if gone != NONE => {
                let parent = forest.parent(number);
                if removed(parent) > mark { parent } else { targets[parent as usize] }
            }
            _ => number,
        };
        targets.push(target);
    }
    targets
}

/// Returns the triangles in input order by ascending material, the end of every material, and the ids.
fn by_material(
    mesh: &Mesh,
    ends: &[u32],
    corners: impl Fn(&[u32; 3]) -> [u32; 3],
) -> (Vec<[u32; 3]>, Vec<u32>, Vec<u32>) {
    let drawn = (0..ends.len()).filter(|&t| ends[t] != 0);
    let mut order: Vec<usize> = drawn.collect();
    let mut ids = Vec::new();
    if !mesh.materials().is_empty() {
        order.sort_by_key(|&t| mesh.materials()[t]);
        ids.extend(order.iter().map(|&t| mesh.materials()[t]));
        ids.dedup();
    }
    let triangles = order.iter().map(|&t| corners(&mesh.triangles()[t])).collect();
    let end = |&id: &u32| order.partition_point(|&t| mesh.materials()[t] <= id) as u32;
    let group_ends = if ids.is_empty() { vec![order.len() as u32] } else { ids.iter().map(end).collect() };
    (triangles, group_ends, ids)
}

/// Makes the levels, and measures the volume of each.
fn with_volumes(mut parts: GmeshParts, positions: &[[f32; 3]]) -> Result<Gmesh, GmeshError> {
    parts.level_volumes = vec![f64::NAN; parts.level_vertices.len()];
    let mut gmesh = Gmesh::try_from(parts)?;
    let vertices =
        Mesh::from_trusted(positions.to_vec(), Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for level in 0..gmesh.levels.len() {
        let of_group = (0..gmesh.groups()).flat_map(|group| gmesh.triangles(level, group)).copied();
        let triangles: Vec<[u32; 3]> = of_group.collect();
        gmesh.levels[level].volume = vertices.gather_used(&triangles, Vec::new()).volume();
    }
    Ok(gmesh)
}
