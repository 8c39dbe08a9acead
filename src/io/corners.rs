//! Values by corner and by face: corners of one vertex with different values become vertices of their own.
//!
//! A mesh has values by vertex only. UV by corner and colours by face are kept by splitting: a vertex becomes as many
//! vertices as its corners have distinct values. The triangles look as in the file. Vertices whose corners agree are
//! not split, so a file with a single value per vertex keeps its numbering.

use super::draft::Draft;
use super::error::ReadError;
use crate::geometry::lists::Lists;
use crate::mesh::{Attribute, AttributeValues, MAX_ELEMENTS, NONE, names};

/// Returns the distinct rows in order of vertex (the first word) and then of first use, and the index of each corner's
/// row. Vertices without corners get a single row, filled with `NONE`. O(n) in the corners; O(n log n) if a vertex has
/// very many distinct rows.
pub(super) fn number_vertices<const N: usize>(
    corners: &[[u32; N]],
    vertices: usize,
) -> (Vec<[u32; N]>, Vec<u32>) {
    let by_vertex = Lists::from_pairs(vertices, (0..).zip(corners).map(|(c, corner)| (corner[0], c)));

    let mut rows: Vec<[u32; N]> = Vec::with_capacity(vertices);
    let mut numbers = vec![NONE; corners.len()];
    let mut sorted: Vec<u32> = Vec::new();
    for v in 0..vertices {
        let base = rows.len();
        let here = by_vertex.get(v as u32);
        if here.is_empty() {
            let mut unused = [NONE; N];
            unused[0] = v as u32;
            rows.push(unused);
        } else if here.len() <= 32 {
            for &c in here {
                let corner = corners[c as usize];
                let known = rows[base..].iter().position(|&x| x == corner);
                numbers[c as usize] = (base + known.unwrap_or(rows.len() - base)) as u32;
                if known.is_none() {
                    rows.push(corner);
                }
            }
        } else {
            // Sorting places equal rows side by side, first used in front; the other corners take its number.
            sorted.clear();
            sorted.extend_from_slice(here);
            sorted.sort_unstable_by_key(|&c| (corners[c as usize], c));
            let same = |a: &u32, b: &u32| corners[*a as usize] == corners[*b as usize];
            let mut leaders: Vec<u32> = sorted.chunk_by(same).map(|group| group[0]).collect();
            leaders.sort_unstable();
            for (i, &c) in leaders.iter().enumerate() {
                numbers[c as usize] = (base + i) as u32;
                rows.push(corners[c as usize]);
            }
            for group in sorted.chunk_by(same) {
                let leader = numbers[group[0] as usize];
                group.iter().for_each(|&c| numbers[c as usize] = leader);
            }
        }
    }
    (rows, numbers)
}

/// Values by corner and by face, gathered while a reader adds triangles to a draft.
#[derive(Default)]
pub(super) struct CornerValues {
    /// UV of the corners, three a triangle, up to the last triangle with UV.
    uvs: Vec<[f32; 2]>,
    /// Colours of the triangles, up to the last coloured triangle.
    colors: Vec<[f32; 4]>,
    /// 4 if a face has an alpha, else 3.
    color_width: usize,
}

/// Colour of faces without a colour.
const WHITE: [f32; 4] = [1.0; 4];

impl CornerValues {
    /// Sets the UV of the corners of triangle `triangle`. Triangles come in ascending order.
    pub fn set_uvs(&mut self, triangle: usize, uvs: [[f32; 2]; 3]) {
        self.uvs.resize(3 * triangle, [0.0; 2]);
        self.uvs.extend(uvs);
    }

    /// Sets the colour of triangles `from..to`: `r g b` or `r g b a`, each from 0 to 1. Triangles come in ascending
    /// order.
    pub fn set_color(&mut self, from: usize, to: usize, color: &[f32]) {
        self.colors.resize(from, WHITE);
        let mut full = WHITE;
        full[..color.len()].copy_from_slice(color);
        self.colors.resize(to, full);
        self.color_width = self.color_width.max(color.len());
    }

    /// Adds the values to the draft as attributes `uv` and `color`, and splits vertices where corners differ. The mesh
    /// has one stream of each: UV by corner replaces UV by vertex; colours by vertex, as the finer ones, are preferred
    /// to colours by face. Notes name what was left out.
    pub fn apply(mut self, draft: &mut Draft) -> Result<(), ReadError> {
        let has = |name: &str, draft: &Draft| draft.attributes.iter().any(|a| a.name() == name);
        if !self.uvs.is_empty() && has(names::UV, draft) {
            draft.attributes.retain(|a| a.name() != names::UV);
            draft.notes.push("UV by vertex left out, because faces have UV by corner".to_owned());
        }
        if !self.colors.is_empty() && has(names::COLOR, draft) {
            self.colors = Vec::new();
            draft.notes.push("colours of faces left out, because vertices have colours".to_owned());
        }
        let corners = 3 * draft.triangles.len();
        // A position that is not finite is reported by its number in the file, when the draft is finished.
        let finite = || draft.positions.as_flattened().iter().all(|x| x.is_finite());
        if (self.uvs.is_empty() && self.colors.is_empty()) || !finite() {
            return Ok(());
        }
        if corners > MAX_ELEMENTS {
            return Err(ReadError::too_large(format!("{corners} corners with values of their own")));
        }
        let uv = |corner: usize| self.uvs.get(corner).copied().unwrap_or_default().map(f32::to_bits);
        let color = |corner: usize| self.colors.get(corner / 3).copied().unwrap_or(WHITE).map(f32::to_bits);
        match (self.uvs.is_empty(), self.colors.is_empty()) {
            (_, true) => {
                let rows = split(draft, |corner, v| {
                    let [s, t] = uv(corner);
                    [v, s, t]
                });
                draft.attributes.push(uv_of(&rows));
            }
            (true, false) => {
                let rows = split(draft, |corner, v| {
                    let [r, g, b, a] = color(corner);
                    [v, r, g, b, a]
                });
                draft.attributes.push(color_of(&rows, 1, self.color_width));
            }
            (false, false) => {
                let rows = split(draft, |corner, v| {
                    let ([s, t], [r, g, b, a]) = (uv(corner), color(corner));
                    [v, s, t, r, g, b, a]
                });
                draft.attributes.push(uv_of(&rows));
                draft.attributes.push(color_of(&rows, 3, self.color_width));
            }
        }
        Ok(())
    }
}

/// Splits the draft's vertices by the rows of their corners. Returns the row of each new vertex.
fn split<const N: usize>(draft: &mut Draft, row: impl Fn(usize, u32) -> [u32; N]) -> Vec<[u32; N]> {
    let corners: Vec<[u32; N]> =
        draft.triangles.as_flattened().iter().enumerate().map(|(corner, &v)| row(corner, v)).collect();
    let (rows, numbers) = number_vertices(&corners, draft.positions.len());
    draft.triangles = numbers.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect();
    if rows.len() > draft.positions.len() {
        let from: Vec<u32> = rows.iter().map(|row| row[0]).collect();
        draft.positions = from.iter().map(|&v| draft.positions[v as usize]).collect();
        draft.attributes = draft.attributes.iter().map(|a| a.gather(&from)).collect();
    }
    rows
}

/// Returns the attribute `uv` of words 1 and 2; 0 for vertices without corners.
fn uv_of<const N: usize>(rows: &[[u32; N]]) -> Attribute {
    Attribute::of(names::UV, rows, |row| match row[1..] {
        [NONE, NONE, ..] => [0.0; 2],
        _ => [f32::from_bits(row[1]), f32::from_bits(row[2])],
    })
}

/// Returns the attribute `color` of the words from `first` on; white for vertices without corners.
fn color_of<const N: usize>(rows: &[[u32; N]], first: usize, width: usize) -> Attribute {
    let value = |&word: &u32| if word == NONE { 1.0 } else { f32::from_bits(word) };
    let values = rows.iter().flat_map(|row| row[first..first + width].iter().map(value)).collect();
    Attribute::new(names::COLOR, width, AttributeValues::Float(values))
}
