//! Grids of cells, and the limits that all shapes share.

use crate::mesh::Mesh;

/// Maximum number of cells of a grid: four vertices or two triangles per cell stay below
/// [`MAX_ELEMENTS`](crate::mesh::MAX_ELEMENTS).
pub(super) const MAX_CELLS: u32 = 1 << 28;

/// Builds a mesh of positions and triangles alone.
pub(super) fn bare(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::from_trusted(positions, triangles, Vec::new(), Vec::new(), Vec::new(), Vec::new())
}

/// Clamps the columns and rows of a grid to `least`, and to [`MAX_CELLS`] cells in all.
pub(super) fn fit(columns: u32, rows: u32, least: [u32; 2]) -> [u32; 2] {
    let columns = columns.clamp(least[0], MAX_CELLS / least[1]);
    [columns, rows.clamp(least[1], (MAX_CELLS / columns).max(least[1]))]
}

/// Appends the two triangles of every cell of a grid, row by row. `at(column, row)` returns a vertex number. Columns
/// run right and rows up, seen from outside.
pub(super) fn cells(columns: u32, rows: u32, triangles: &mut Vec<[u32; 3]>, at: impl Fn(u32, u32) -> u32) {
    triangles.reserve(2 * columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [at(column, row), at(column + 1, row)];
            let [d, c] = [at(column, row + 1), at(column + 1, row + 1)];
            triangles.push([a, b, c]);
            triangles.push([a, c, d]);
        }
    }
}

/// Returns `length` if it is between 1e-18 and 1e18 (far from overflow), else `default`.
pub(super) fn length_or(length: f32, default: f32) -> f64 {
    f64::from(if length > 1e-18 && length < 1e18 { length } else { default })
}

#[cfg(test)]
mod tests {
    use super::fit;
    use crate::mesh::MAX_ELEMENTS;

    #[test]
    fn grids_of_any_size_fit_a_mesh() {
        let counts = [0, 1, 2, 3, 4, 1000, 1 << 14, 1 << 27, 1 << 28, u32::MAX];
        for (columns, rows) in counts.iter().flat_map(|&c| counts.map(|r| (c, r))) {
            for least in [[3, 3], [3, 2], [3, 1], [1, 1]] {
                let [c, r] = fit(columns, rows, least);
                assert!(c >= least[0] && r >= least[1]);
                let (c, r) = (c as usize, r as usize);
                assert!((c + 1) * (r + 1) <= MAX_ELEMENTS && 2 * c * r <= MAX_ELEMENTS, "{columns} x {rows}");
                let small = columns >= least[0] && rows >= least[1] && columns <= 16384 && rows <= 16384;
                assert!(!small || (c, r) == (columns as usize, rows as usize));
            }
        }
    }
}
