//! Which faces to split.
//!
//! ```text
//!     1  each base face alone: split a cell while a point of the mesh over it is further from it than the tolerance
//!     2  from the finest level to the coarsest: split the cells beside split cells of the next level, so that cells at a
//!        common edge differ by one level at most, and those across features from split cells
//!     3  subdivide
//! ```

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use crate::geometry::lists::Lists;
use crate::geometry::parallel;
use crate::geometry::triangle;
use crate::mesh::{Mesh, MeshPoint};
use crate::simplify::OptionError;
use crate::wavelet::{DomainPoint, WaveletBuilder, WaveletError};

use super::cells::{BaseEdges, Cell, DEEPEST};
use super::distortion::normal_at;
use super::{Parameterisation, RemeshError};

/// How deep a base is subdivided.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Depth {
    /// Every base face is split this many times, at most 14.
    Levels(usize),
    /// Faces are split until every vertex of the mesh is within this distance, object units, of the face it lies over, and
    /// so are seven points of the mesh over the face; points of features are as near to the sides on the feature. Also split
    /// are faces which face away from the mesh at their corners and in the middle. Faces at a common edge differ by at most
    /// one level. Ends at 12 levels, and is refused at about 2^26 faces.
    ///
    /// Less than 2^-21 of the mesh's diagonal is rounding, and counts as that.
    Error(f32),
}

/// Deepest level for a tolerance.
const DEEPEST_FOR_ERROR: usize = 12;
/// Cells facing away from the mesh are split to this level.
const DEEPEST_FOR_FOLDS: usize = 8;
/// Most faces for a tolerance, before neighbours are balanced.
const MOST_FOR_ERROR: usize = 1 << 26;
/// Distances below this share of the mesh's diagonal are rounding.
const ROUNDING: f64 = 1.0 / 2_097_152.0;

impl Depth {
    /// Subdivides. Returns how many faces were left facing away from the mesh, as far as that was looked at.
    pub(super) fn subdivide(
        self,
        map: &Parameterisation,
        mesh: &Mesh,
        builder: &mut WaveletBuilder,
        place: impl Fn(&DomainPoint) -> [f32; 3],
    ) -> Result<usize, RemeshError> {
        match self {
            Self::Levels(levels) if levels > DEEPEST => {
                let (option, value) = ("levels", levels as f64);
                Err(OptionError::OutOfRange { option, value, expected: "0 to 14" }.into())
            }
            Self::Levels(levels) => {
                for _ in 0..levels {
                    builder.subdivide(|midpoint| place(&midpoint.domain))?;
                }
                Ok(0)
            }
            Self::Error(error) if error.is_nan() || error < 0.0 => {
                let (option, value) = ("error", f64::from(error));
                Err(OptionError::OutOfRange { option, value, expected: "0 or more" }.into())
            }
            Self::Error(error) => {
                let tolerance = f64::from(error).max(ROUNDING * mesh.diagonal());
                let Splits { levels: mut split, folded } = Splits::new(map, mesh, tolerance, MOST_FOR_ERROR)?;
                balance(map, &mut split);
                for (level, cells) in split.iter().enumerate() {
                    builder.subdivide_where(
                        |face| {
                            let cell = Cell::of_corners(face.base_face, level, &face.barycentric);
                            cells.binary_search(&cell).is_ok()
                        },
                        |midpoint| place(&midpoint.domain),
                    )?;
                }
                Ok(folded)
            }
        }
    }
}

/// Splits the cells beside split cells of the next level, and those across features from split cells: a vertex on a feature
/// has the values of both sides.
fn balance(map: &Parameterisation, split: &mut [Vec<Cell>]) {
    let edges = &BaseEdges::new(map.base());
    for level in (0..split.len()).rev() {
        add_across_features(map, edges, level, &mut split[level]);
        if level == 0 {
            break;
        }
        let (coarser, finer) = split.split_at_mut(level);
        let needed = &mut coarser[level - 1];
        for &cell in &finer[0] {
            (0..3).for_each(|side| {
                edges.for_neighbours(cell, level, side, |other| needed.push(other.parent()));
            });
        }
        needed.sort_unstable();
        needed.dedup();
    }
}

fn add_across_features(map: &Parameterisation, edges: &BaseEdges, level: usize, split: &mut Vec<Cell>) {
    let mut at = 0;
    let mut is_split: BTreeSet<Cell> =
        split.iter().copied().filter(|cell| (0..3).any(|side| cell.across(level, side).is_err())).collect();
    while let Some(&cell) = split.get(at) {
        at += 1;
        for side in 0..3 {
            if cell.across(level, side).is_err_and(|side| map.is_feature(cell.base, side)) {
                edges.for_neighbours(cell, level, side, |other| {
                    if is_split.insert(other) {
                        split.push(other);
                    }
                });
            }
        }
    }
    split.sort_unstable();
}

/// Cells to split, by level, ascending.
struct Splits {
    levels: Vec<Vec<Cell>>,
    /// Cells left facing away from the mesh.
    folded: usize,
}

impl Splits {
    fn new(map: &Parameterisation, mesh: &Mesh, tolerance: f64, limit: usize) -> Result<Self, RemeshError> {
        let over = vertices_over(map, mesh);
        let left = AtomicUsize::new(limit / 4);
        let faces = parallel::map(map.base().triangles().len(), 1, |face| {
            let vertices = over.get(face as u32).iter().map(|&vertex| &over.points[vertex as usize]);
            let mut of_face = OfFace { map, mesh, tolerance, left: &left, levels: Vec::new(), folded: 0 };
            of_face.visit(Cell::base(face as u32), 0, vertices.copied().collect());
            (of_face.levels, of_face.folded)
        });
        if left.into_inner() == 0 {
            return Err(WaveletError::TooMany { what: "faces", count: limit + 1, limit }.into());
        }
        let depth = faces.iter().map(|face| face.0.len()).max().unwrap_or(0);
        let (mut levels, mut folded) = (vec![Vec::new(); depth], 0);
        for face in faces {
            levels.iter_mut().zip(face.0).for_each(|(all, own)| all.extend(own));
            folded += face.1;
        }
        levels.iter_mut().for_each(|cells| cells.sort_unstable());
        Ok(Self { levels, folded })
    }
}

/// A vertex of the mesh over a base face.
#[derive(Debug, Clone, Copy)]
struct Over {
    barycentric: [f64; 3],
    position: DVec3,
}

/// Vertices of the mesh by base face.
struct VerticesOver {
    lists: Lists,
    points: Vec<Over>,
}

impl VerticesOver {
    fn get(&self, face: u32) -> &[u32] {
        self.lists.get(face)
    }
}

fn vertices_over(map: &Parameterisation, mesh: &Mesh) -> VerticesOver {
    let mut corner_of = vec![None; mesh.positions().len()];
    for (triangle, corners) in (0..).zip(mesh.triangles()) {
        for (k, &vertex) in corners.iter().enumerate() {
            corner_of[vertex as usize].get_or_insert((triangle, k));
        }
    }
    let places = parallel::map(corner_of.len(), 256, |vertex| {
        let (triangle, k) = corner_of[vertex]?;
        let unit = std::array::from_fn(|i| f64::from(i == k));
        let place = map.to_base(&MeshPoint::new(triangle, unit))?;
        let position = DVec3::from_array(mesh.positions()[vertex].map(f64::from));
        Some((place.base_face, Over { barycentric: place.barycentric, position }))
    });
    let found: Vec<(u32, Over)> = places.into_iter().flatten().collect();
    let pairs = (0..).zip(&found).map(|(at, (face, _))| (*face, at));
    let lists = Lists::from_pairs(map.base().triangles().len(), pairs);
    VerticesOver { lists, points: found.into_iter().map(|(_, over)| over).collect() }
}

/// Cells to split in a base face.
struct OfFace<'a> {
    map: &'a Parameterisation,
    mesh: &'a Mesh,
    tolerance: f64,
    /// Cells that all faces together may still split; at 0 the result is of no use.
    left: &'a AtomicUsize,
    levels: Vec<Vec<Cell>>,
    folded: usize,
}

/// Points with a barycentric coordinate below this are on the side opposite of the corner.
const ON_SIDE: f64 = 1e-9;

/// Barycentric coordinates of the points at which a cell is compared with the mesh: the middle of the cell, of its sides, and
/// of its children at the corners.
const SAMPLES: [[f64; 3]; 7] = {
    const S: f64 = 1.0 / 6.0;
    [
        [2.0 * S, 2.0 * S, 2.0 * S],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [4.0 * S, S, S],
        [S, 4.0 * S, S],
        [S, S, 4.0 * S],
    ]
};

impl OfFace<'_> {
    fn visit(&mut self, cell: Cell, level: usize, vertices: Vec<Over>) {
        if level == DEEPEST_FOR_ERROR || !self.is_split(cell, level, &vertices) {
            return;
        }
        let take = |left: usize| left.checked_sub(1);
        if !matches!(self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take), Ok(2..)) {
            return;
        }
        if self.levels.len() == level {
            self.levels.push(Vec::new());
        }
        self.levels[level].push(cell);
        let mut parts: [Vec<Over>; 4] = std::array::from_fn(|_| Vec::new());
        for over in vertices {
            let weights = cell.weights(level, over.barycentric);
            let child = weights.iter().position(|&weight| weight >= 0.5).unwrap_or(3);
            parts[child].push(over);
        }
        for (child, part) in cell.children().into_iter().zip(parts) {
            self.visit(child, level + 1, part);
        }
    }

    fn is_split(&mut self, cell: Cell, level: usize, vertices: &[Over]) -> bool {
        let at = |weights: [f64; 3]| {
            let point = self.map.to_mesh(&DomainPoint::new(cell.base, cell.point(level, weights)));
            point.and_then(|point| Some((DVec3::from_array(point.position(self.mesh)?), point)))
        };
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(at);
        let [Some(a), Some(b), Some(c)] = corners else { return false };
        let corners = [a.0, b.0, c.0];
        let limit = self.tolerance * self.tolerance;
        let is_far = |point: DVec3| triangle::distance_squared(&corners, point) > limit;
        if vertices.iter().any(|over| is_far(over.position)) {
            return true;
        }
        // A side on a feature follows the feature.
        let is_feature =
            |&side: &usize| cell.across(level, side).is_err_and(|side| self.map.is_feature(cell.base, side));
        let leaves_feature = |side: usize| {
            let ends = [corners[side], corners[(side + 1) % 3]];
            let is_off = |point: DVec3| distance_to_segment_squared(ends, point) > limit;
            let is_over = |over: &&Over| cell.weights(level, over.barycentric)[(side + 2) % 3] < ON_SIDE;
            let mut points = vertices.iter().filter(is_over).map(|over| over.position);
            let along = |t: f64| {
                let mut weights = [0.0; 3];
                (weights[side], weights[(side + 1) % 3]) = (1.0 - t, t);
                at(weights).map(|point| point.0)
            };
            points.any(is_off) || [0.25, 0.5, 0.75].into_iter().filter_map(along).any(is_off)
        };
        if (0..3).filter(is_feature).any(leaves_feature) {
            return true;
        }
        let samples = SAMPLES.map(at);
        let is_folded = || {
            let Some((_, middle)) = samples[0] else { return false };
            let own = triangle::normal(&corners);
            let points = [a.1, b.1, c.1, middle];
            points.iter().all(|point| own.dot(normal_at(self.mesh, point)) < 0.0)
        };
        if samples.iter().flatten().any(|sample| is_far(sample.0)) {
            return true;
        }
        let is_folded = is_folded();
        self.folded += usize::from(is_folded && level >= DEEPEST_FOR_FOLDS);
        is_folded && level < DEEPEST_FOR_FOLDS
    }
}

fn distance_to_segment_squared([a, b]: [DVec3; 2], point: DVec3) -> f64 {
    let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    // Two equal ends give NaN.
    let nearest = if along.is_nan() { a } else { a + along * (b - a) };
    nearest.distance_squared(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lod::Structure;
    use crate::mesh::shapes;
    use crate::remesh::{Remesher, Smoothing};

    #[test]
    fn an_error_of_rounding_splits_nothing_flat() {
        let ball = shapes::icosphere(2);
        let tiny = ball.positions().iter().map(|p| p.map(|x| x * 1e-44)).collect();
        for mesh in [ball.clone(), ball.clone().with_positions(tiny)] {
            let map = Remesher::new().base_faces(320).smoothing(Smoothing::Off).run(&mesh).unwrap();
            assert_eq!(map.base().triangles().len(), 320);
            let model = map.bake(&mesh, Depth::Error(0.0), &Default::default()).unwrap();
            assert_eq!(model.structure().triangle_count(), 320);
        }
    }

    #[test]
    fn more_faces_than_allowed_are_refused() {
        let mesh = shapes::icosphere(3);
        let map = Remesher::new().base_faces(20).run(&mesh).unwrap();
        let error = 1e-3 * mesh.diagonal();
        let splits: usize =
            Splits::new(&map, &mesh, error, 1 << 20).unwrap().levels.iter().map(Vec::len).sum();
        assert!(splits > 10);
        assert!(Splits::new(&map, &mesh, error, 4 * (splits + 1)).is_ok());
        let refused = Splits::new(&map, &mesh, error, 4 * splits).map(|splits| splits.folded);
        let too_many = WaveletError::TooMany { what: "faces", count: 4 * splits + 1, limit: 4 * splits };
        assert_eq!(refused, Err(too_many.into()));
    }
}
