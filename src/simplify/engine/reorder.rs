//! Sorts a sequence found tile by tile into order of cost, and cuts it where its targets are reached.
//!
//! Two steps may be swapped unless the later step merges a point whose triangles the earlier step changed. The engine
//! gives each step a rank no less than the ranks of the steps it depends on. A stable sort by rank is therefore a valid
//! sequence with equal patches and errors.

use crate::mesh::NONE;
use crate::sequence::CollapseSequence;
use crate::simplify::options::Limits;

/// Sorts the steps of each batch by rank, stably; and `parts`, which has an entry per step or is empty. Returns the
/// steps' former numbers in the new order. O(steps log steps + vertices + triangles).
pub(super) fn sort_by_rank(
    sequence: &mut CollapseSequence,
    ranks: &[u32],
    parts: &mut Vec<[f32; 2]>,
) -> Vec<u32> {
    let steps = sequence.step_error.len();
    let mut order: Vec<u32> = (0..steps as u32).collect();
    let mut start = 0;
    for &end in &sequence.batch_end {
        order[start..end as usize].sort_by_key(|&step| ranks[step as usize]);
        start = end as usize;
    }

    // New vertices are numbered in order of creation.
    let input = sequence.input_vertices;
    let made = new_vertices_of_steps(sequence);
    let mut number = vec![NONE; sequence.new_vertices.len()];
    let mut next = input;
    for &step in &order {
        for new in made[step as usize]..made[step as usize + 1] {
            number[new as usize] = next;
            next += 1;
        }
    }
    let rename = |vertex: u32| match vertex.checked_sub(input) {
        Some(new) => number[new as usize],
        None => vertex,
    };
    let mut new_vertices = sequence.new_vertices.clone();
    for (new, &at) in sequence.new_vertices.iter().zip(&number) {
        let mut new = *new;
        new.from = new.from.map(rename);
        new_vertices[(at - input) as usize] = new;
    }
    sequence.new_vertices = new_vertices;

    let mut substitutions = Vec::with_capacity(sequence.substitutions.len());
    let mut step_start = Vec::with_capacity(steps + 1);
    step_start.push(0);
    let mut place = vec![0u32; steps];
    for (at, &step) in order.iter().enumerate() {
        place[step as usize] = at as u32;
        substitutions.extend(sequence.substitutions(step as usize).iter().map(|s| s.map(rename)));
        step_start.push(substitutions.len() as u32);
    }
    sequence.substitutions = substitutions;
    sequence.step_start = step_start;
    sequence.step_error = order.iter().map(|&step| sequence.step_error[step as usize]).collect();
    sequence.accumulate_errors();
    if !parts.is_empty() {
        *parts = order.iter().map(|&step| parts[step as usize]).collect();
    }

    let mut gone = vec![0u32; steps + 1];
    for end in sequence.triangle_end.iter_mut().filter(|end| **end != 0 && **end != NONE) {
        *end = place[*end as usize - 1] + 1;
        gone[*end as usize] += 1;
    }
    let mut left = sequence.triangles_after[0];
    for (after, gone) in sequence.triangles_after.iter_mut().zip(gone) {
        left -= gone;
        *after = left;
    }
    order
}

/// Cuts a sequence after the fewest steps reaching a limit. `vertices`: number of vertices used by triangles at the
/// start.
pub(super) fn cut(sequence: &mut CollapseSequence, limits: &Limits, vertices: usize) {
    let made = new_vertices_of_steps(sequence);
    let reached = (0..=sequence.step_error.len()).find(|&step| {
        let live = (vertices + made[step] as usize).saturating_sub(sequence.step_start[step] as usize);
        limits.reached(sequence.triangles_after[step] as usize, live)
    });
    let Some(steps) = reached else { return };
    sequence.new_vertices.truncate(made[steps] as usize);
    sequence.substitutions.truncate(sequence.step_start[steps] as usize);
    sequence.step_start.truncate(steps + 1);
    sequence.step_error.truncate(steps);
    sequence.max_error.truncate(steps);
    sequence.triangles_after.truncate(steps + 1);
    for end in sequence.triangle_end.iter_mut().filter(|end| **end as usize > steps) {
        *end = NONE;
    }
    sequence.batch_end.retain(|&end| (end as usize) < steps);
    if steps > 0 {
        sequence.batch_end.push(steps as u32);
    }
}

/// Number of new vertices made before each step; length steps + 1.
fn new_vertices_of_steps(sequence: &CollapseSequence) -> Vec<u32> {
    let input = sequence.input_vertices;
    let mut made = Vec::with_capacity(sequence.step_error.len() + 1);
    made.push(0);
    let mut most = 0;
    for step in 0..sequence.step_error.len() {
        for &[_, to] in sequence.substitutions(step) {
            most = most.max((to + 1).saturating_sub(input));
        }
        made.push(most);
    }
    made
}
