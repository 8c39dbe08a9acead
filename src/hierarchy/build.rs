//! Builds a vertex hierarchy from a collapse sequence: vertices depth first, splits from coarse to fine.
//!
//! ```text
//!     leaves   | x, what joined x first, second, ... last | next root ...     all that a vertex stands for is one run, and
//!                                                                            what its last collapse brought ends it
//!     splits   | coarsest | next two | next four | ...                       in each octave by place, so that a region at
//!                                                                            one level lies together
//! ```

use std::ops::ControlFlow;

use crate::geometry::array::Array;
use crate::geometry::lists::Lists;
use crate::lod::Progress;
use crate::mesh::{Mesh, NONE, Topology};
use crate::sequence::collapse_forest::CollapseForest;
use crate::sequence::{CollapseSequence, Origin};

use super::bounds::bounds;
use super::context::lonely_errors;
use super::dependencies::dependency_lists;
use super::stars::MOST_CORNERS;
use super::{Dependencies, HierarchyError, VertexHierarchy};

/// Maximum number of triangles: all may lie around a single vertex.
pub(super) const MOST_TRIANGLES: usize = MOST_CORNERS;
/// Maximum number of different materials: group numbers are 16 bits.
pub(super) const MOST_MATERIALS: usize = 1 << 16;

/// A vertex hierarchy, with the relation of its numbers to the input's numbers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HierarchyBuild {
    /// The structure.
    pub hierarchy: VertexHierarchy,
    /// Per vertex of the structure, its number in the sequence: an input vertex or a new vertex.
    pub vertex_order: Vec<u32>,
    /// Per triangle of the structure, its number in the input.
    pub triangle_order: Vec<u32>,
}

impl VertexHierarchy {
    /// Builds a hierarchy from a sequence and its mesh. O(n log n), plus O(n x neighbours) with dependencies. To get
    /// vertices and their origins too, use [`Baked::of_sequence`](crate::lod::Baked::of_sequence).
    ///
    /// # Errors
    /// The sequence belongs to another mesh or is inconsistent; there are more elements than can be numbered.
    pub fn build(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        dependencies: Dependencies,
    ) -> Result<HierarchyBuild, HierarchyError> {
        Self::build_with(mesh, sequence, dependencies, &mut |_| ControlFlow::Continue(()))
    }

    pub(super) fn build_with(
        mesh: &Mesh,
        sequence: &CollapseSequence,
        dependencies: Dependencies,
        progress: Progress<'_>,
    ) -> Result<HierarchyBuild, HierarchyError> {
        let mut stage = |share: f32| match progress(share) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(HierarchyError::Cancelled),
        };
        stage(0.0)?;
        let collapse_forest = CollapseForest::new(mesh, sequence)?;
        let triangles = mesh.triangles().len();
        if triangles > MOST_TRIANGLES {
            return Err(HierarchyError::TooMany {
                what: "triangles",
                count: triangles,
                limit: MOST_TRIANGLES,
            });
        }
        stage(0.2)?;
        let forest = Forest::new(mesh, sequence, &collapse_forest);
        stage(0.4)?;
        let splits = Splits::new(sequence, &collapse_forest, &forest);
        let count = splits.brings.start.len() - 1;

        // Groups triangles by the split bringing them back.
        let key = |t: usize| match collapse_forest.end(mesh.triangles()[t]) {
            0 => None,
            NONE => Some(0),
            end => Some(splits.of_step[end as usize - 1] + 1),
        };
        let keys: Vec<Option<u32>> = (0..triangles).map(key).collect();
        let kept = || keys.iter().enumerate().filter_map(|(t, key)| key.map(|key| (key, t as u32)));
        let by_split = Lists::from_pairs(count + 1, kept());
        let leaf = |v: u32| forest.vertex[collapse_forest.folded(v) as usize];
        let mut materials = mesh.materials().to_vec();
        materials.sort_unstable();
        materials.dedup();
        if materials.len() > MOST_MATERIALS {
            let (count, limit) = (materials.len(), MOST_MATERIALS);
            return Err(HierarchyError::TooMany { what: "materials", count, limit });
        }
        let group = |t: &u32| materials.partition_point(|&id| id < mesh.materials()[*t as usize]) as u16;
        let group_of =
            if materials.len() > 1 { by_split.items.iter().map(group).collect() } else { Array::default() };
        let corners = by_split.items.iter().map(|&t| mesh.triangles()[t as usize].map(leaf)).collect();

        let mut hierarchy = VertexHierarchy {
            substitute: forest.substitute.into(),
            split_of: splits.of_vertex.into(),
            first_leaf: forest.first_leaf.into(),
            leaves: forest.leaves,
            brings: splits.brings,
            parents: splits.parents,
            children: splits.children,
            dependencies: Lists::default(),
            dependency_kind: dependencies,
            bounds: Array::default(),
            roots: splits.roots.into(),
            triangles: corners,
            first_triangle: by_split.start[1..].to_vec().into(),
            group_of,
            materials: materials.into(),
            diagonal: mesh.diagonal(),
            jump: Array::default(),
        };
        hierarchy.jump = hierarchy.jumps().into();
        stage(0.6)?;
        let lonely = lonely_errors(&hierarchy, &hierarchy.brings, &forest.end, &forest.positions);
        let error: Vec<f32> = splits.error.iter().zip(&lonely).map(|(a, b)| a.max(*b)).collect();
        stage(0.8)?;
        hierarchy.bounds = bounds(&hierarchy, &forest.positions, &error).into();
        stage(0.9)?;
        let point_of = || {
            let topology = Topology::new(mesh);
            let leaves = &forest.order[..forest.leaves as usize];
            leaves.iter().map(|&vertex| topology.point_of()[vertex as usize]).collect()
        };
        let Lists { start, items } = dependency_lists(&hierarchy, &splits.order, point_of, dependencies);
        hierarchy.dependencies = Lists::of(start.into_vec(), items.into_vec());
        stage(1.0)?;
        Ok(HierarchyBuild {
            hierarchy,
            vertex_order: forest.order,
            triangle_order: by_split.items.into_vec(),
        })
    }
}

/// Vertices in their new order.
struct Forest {
    /// Per number in the `collapse_forest`, its vertex; `NONE` for duplicate and unused vertices.
    vertex: Vec<u32>,
    leaves: u32,
    substitute: Vec<u32>,
    first_leaf: Vec<u32>,
    /// Per vertex, the end of its run of leaves.
    end: Vec<u32>,
    /// Per vertex, its number in the sequence.
    order: Vec<u32>,
    positions: Vec<[f32; 3]>,
}

impl Forest {
    fn new(mesh: &Mesh, sequence: &CollapseSequence, collapse_forest: &CollapseForest) -> Self {
        let count = collapse_forest.real as usize;
        let placed = sequence.placed(mesh);
        let is_leaf = |number: usize| (collapse_forest.order[number] as usize) < sequence.input_vertices();
        let position = |number: usize| match sequence.origin(collapse_forest.order[number]) {
            Origin::Input(v) => placed[v as usize],
            Origin::Blend(new) => new.position,
        };
        let parent = |number: usize| collapse_forest.parent(number as u32) as usize;

        // Number of leaves under each vertex. Parents have smaller numbers.
        let mut size: Vec<u32> = (0..count).map(|number| u32::from(is_leaf(number))).collect();
        for number in (collapse_forest.roots as usize..count).rev() {
            size[parent(number)] += size[number];
        }
        let extent = mesh.bounds().unwrap_or_default();
        let mut roots: Vec<(u32, u32)> =
            (0..collapse_forest.roots).map(|root| (morton(extent, position(root as usize)), root)).collect();
        roots.sort_unstable();

        // Runs of leaves. Within a run, the leaves taken last are at the end.
        let mut start = vec![0_u32; count];
        let mut end = vec![0_u32; count];
        let mut leaves = 0;
        for (_, root) in roots {
            start[root as usize] = leaves;
            leaves += size[root as usize];
            end[root as usize] = leaves;
        }
        for number in collapse_forest.roots as usize..count {
            let of = parent(number);
            end[number] = end[of];
            end[of] -= size[number];
            start[number] = end[of];
        }

        let mut made: Vec<u32> = (0..count as u32).filter(|&number| !is_leaf(number as usize)).collect();
        made.sort_by_key(|&number| (start[number as usize], number));
        let mut vertex = vec![NONE; collapse_forest.order.len()];
        let mut number_of = vec![0_u32; count];
        for number in 0..count {
            if is_leaf(number) {
                vertex[number] = start[number];
            }
        }
        for (i, &number) in made.iter().enumerate() {
            vertex[number as usize] = leaves + i as u32;
        }
        for number in 0..count {
            number_of[vertex[number] as usize] = number as u32;
        }
        Self {
            leaves,
            end: number_of.iter().map(|&number| start[number as usize] + size[number as usize]).collect(),
            substitute: number_of.iter().map(|&number| vertex[parent(number as usize)]).collect(),
            first_leaf: made.iter().map(|&number| start[number as usize]).collect(),
            order: number_of.iter().map(|&number| collapse_forest.order[number as usize]).collect(),
            positions: number_of.iter().map(|&number| position(number as usize)).collect(),
            vertex,
        }
    }
}

/// Interleaves ten bits of each coordinate within a box.
fn morton([low, high]: [[f32; 3]; 2], position: [f32; 3]) -> u32 {
    (0..3).fold(0, |code, axis| {
        let wide = f64::from(high[axis]) - f64::from(low[axis]);
        let along = if wide > 0.0 { (f64::from(position[axis]) - f64::from(low[axis])) / wide } else { 0.0 };
        let cell = (along * 1024.0).clamp(0.0, 1023.0) as u32;
        (0..10).fold(code, |code, bit| code | (cell >> bit & 1) << (3 * bit + axis))
    })
}

/// Splits in their new order.
struct Splits {
    /// Per step, its split; `NONE` if the step takes no vertex.
    of_step: Vec<u32>,
    of_vertex: Vec<u32>,
    brings: Lists,
    parents: Lists,
    children: Lists,
    roots: Vec<u32>,
    error: Vec<f32>,
    /// Splits in the order of their collapses.
    order: Vec<u32>,
}

impl Splits {
    fn new(sequence: &CollapseSequence, collapse_forest: &CollapseForest, forest: &Forest) -> Self {
        let steps: Vec<usize> =
            (0..sequence.len()).filter(|&s| !sequence.substitutions(s).is_empty()).collect();
        let count = steps.len();
        let vertex = |v: u32| forest.vertex[collapse_forest.number[v as usize] as usize];

        // A collapse is undone after the next collapse touching any of its vertices.
        let mut last = vec![NONE; forest.substitute.len()];
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(2 * count);
        for (i, &step) in steps.iter().enumerate() {
            for pair in sequence.substitutions(step) {
                for v in pair.map(vertex) {
                    let before = std::mem::replace(&mut last[v as usize], i as u32);
                    if before != NONE && before != i as u32 {
                        edges.push([before, i as u32]);
                    }
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();

        // Coarsest first, in octaves. Within an octave by place, but never before a parent.
        let above = Lists::from_pairs(count, edges.iter().map(|&[child, parent]| (child, parent)));
        let octave = |i: usize| (count - i).ilog2();
        let mut place = vec![0_u32; count];
        for i in (0..count).rev() {
            let own = sequence.substitutions(steps[i]).iter().map(|pair| {
                let to = vertex(pair[1]);
                if to < forest.leaves { to } else { forest.first_leaf[(to - forest.leaves) as usize] }
            });
            let parents = above.get(i as u32).iter().map(|&parent| parent as usize);
            let same = parents.filter(|&parent| octave(parent) == octave(i)).map(|parent| place[parent]);
            place[i] = own.chain(same).max().unwrap_or(0);
        }
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_unstable_by_key(|&i| (octave(i as usize), place[i as usize], std::cmp::Reverse(i)));
        let mut split = vec![0_u32; count];
        for (s, &i) in order.iter().enumerate() {
            split[i as usize] = s as u32;
        }

        for edge in &mut edges {
            *edge = edge.map(|i| split[i as usize]);
        }
        edges.sort_unstable();
        let parents = Lists::from_pairs(count, edges.iter().map(|&[child, parent]| (child, parent)));
        let children = Lists::from_pairs(count, edges.iter().map(|&[child, parent]| (parent, child)));
        let taken = order.iter().enumerate().flat_map(|(s, &i)| {
            sequence.substitutions(steps[i as usize]).iter().map(move |pair| (s as u32, vertex(pair[0])))
        });
        let brings = Lists::from_pairs(count, taken);
        let mut of_vertex = vec![NONE; forest.substitute.len()];
        for s in 0..count as u32 {
            brings.get(s).iter().for_each(|&v| of_vertex[v as usize] = s);
        }
        let mut of_step = vec![NONE; sequence.len()];
        for (i, &step) in steps.iter().enumerate() {
            of_step[step] = split[i];
        }
        Self {
            of_step,
            of_vertex,
            brings,
            roots: (0..count as u32).filter(|&s| parents.get(s).is_empty()).collect(),
            parents,
            children,
            error: order.iter().map(|&i| sequence.step_error(steps[i as usize])).collect(),
            order: split,
        }
    }
}
