//! Sectors: the triangles around a point between two feature edges.
//!
//! ```text
//!        \  2 /                A vertex for every sector of every point, so that feature curves are seams of the mesh given
//!      1  \  /                 to the simplifier: a sector moves along with its curve and never leaves it. A point without
//!      ----*---- feature       feature edges has one sector; so has a point where a single curve ends.
//!        3  \
//! ```

use std::borrow::Cow;

use glam::{DVec3, Vec3};

use crate::geometry::lists::Lists;
use crate::geometry::sets::Sets;
use crate::mesh::{Attribute, AttributeValues, Edges, Mesh, NONE, Tolerances, Topology};
use crate::simplify::{Normals, NormalsDone, Rim, WorkingSurface};

use super::{Creasing, Features, RemeshError};

/// Largest turn of a curve at a point which is no corner, degrees.
const CORNER_DEGREES: f64 = 45.0;

/// Cosine of the angle between two triangles' normals below which their edge can continue a crease: 41.4 degrees.
const CREASE: f64 = 0.75;

/// A mesh with one vertex a sector.
pub(super) struct Sectors {
    /// Positions of sectors, triangles of the input over sectors (degenerate triangles left as they are), labels, locks.
    pub mesh: Mesh,
    /// Whether each input triangle has three different points.
    pub is_face: Vec<bool>,
    /// Whether each side of each input triangle, from corner `k` to the next, lies on a feature edge.
    pub is_feature: Vec<[bool; 3]>,
    /// Whether normals of the input make features. Otherwise they are hard everywhere.
    pub keeps_normals: bool,
}

/// Splits a mesh along its features.
pub(super) fn split(mesh: &Mesh, features: &Features) -> Result<Sectors, RemeshError> {
    let keeps_normals = Normals::Automatic.resolve(mesh)? == NormalsDone::Kept;
    let bare = if keeps_normals { Cow::Borrowed(mesh) } else { Cow::Owned(mesh.without_normals()) };
    let topology = Topology::with(&bare, &Tolerances::default());
    let point_of = topology.point_of();
    let points: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| point_of[v as usize])).collect();
    let is_face: Vec<bool> = points.iter().map(|[a, b, c]| a != b && b != c && c != a).collect();
    let edges = Edges::new(&points, topology.point_count());
    let is_feature = feature_edges(&bare, &topology, &points, &edges, features);

    // Corners on both sides of other edges are of one sector.
    let mut sets = Sets::new(3 * points.len());
    for edge in (0..edges.len() as u32).filter(|&edge| !is_feature[edge as usize]) {
        let &[a, b] = edges.half_edges(edge) else { continue };
        let next = |h: u32| h - h % 3 + (h + 1) % 3;
        sets.join(a, next(b));
        sets.join(next(a), b);
    }
    let mut number = vec![NONE; 3 * points.len()];
    let mut labels_of_point = vec![0u32; topology.point_count()];
    let (mut positions, mut sector_point, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    let mut triangles = Vec::with_capacity(points.len());
    for (t, corners) in points.iter().enumerate() {
        triangles.push([0, 1, 2].map(|k| {
            let corner = sets.find((3 * t + k) as u32);
            let slot = &mut number[corner as usize];
            if *slot == NONE {
                *slot = positions.len() as u32;
                let point = corners[k];
                positions.push(mesh.positions()[topology.vertex_of_point()[point as usize] as usize]);
                sector_point.push(point);
                labels.push(labels_of_point[point as usize]);
                labels_of_point[point as usize] += 1;
            }
            *slot
        }));
    }
    let curves: Vec<[u32; 2]> =
        (0..edges.len()).filter(|&edge| is_feature[edge]).map(|edge| edges.ends()[edge]).collect();
    let corners = corners(mesh, &topology, &curves);
    let locks: Vec<bool> = sector_point.iter().map(|&point| corners[point as usize]).collect();
    let label = Attribute::new("sector", 1, AttributeValues::Uint(labels));
    let sectors = Mesh::new(positions, triangles)?.with_attribute(label)?.with_locks(locks)?;
    let on_feature = |edge: u32| is_feature.get(edge as usize).copied().unwrap_or(false);
    let is_feature =
        edges.of_half_edges(points.len()).into_iter().map(|sides| sides.map(on_feature)).collect();
    Ok(Sectors { mesh: sectors, is_face, is_feature, keeps_normals })
}

/// Finds the feature edges: all edges but those between two triangles of equal orientation, material and values that meet at
/// less than the crease angle.
fn feature_edges(
    mesh: &Mesh,
    topology: &Topology,
    points: &[[u32; 3]],
    edges: &Edges,
    features: &Features,
) -> Vec<bool> {
    let wedge = |half_edge: u32| topology.wedge_of()[mesh.indices()[half_edge as usize] as usize];
    let next = |h: u32| h - h % 3 + (h + 1) % 3;
    let material = |h: u32| mesh.materials().get(h as usize / 3).copied().unwrap_or(0);
    let at = |point: u32| Vec3::from(mesh.positions()[topology.vertex_of_point()[point as usize] as usize]);
    let normal = |h: u32| {
        let [a, b, c] = points[h as usize / 3].map(|p| at(p).as_dvec3());
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut is_feature: Vec<bool> = (0..edges.len() as u32)
        .map(|edge| {
            let &[a, b] = edges.half_edges(edge) else { return true };
            edges.is_flipped(edge)
                || wedge(a) != wedge(next(b))
                || wedge(next(a)) != wedge(b)
                || material(a) != material(b)
                || matches!(features.creasing, Creasing::Angle(degrees)
                    if normal(a).dot(normal(b)) < f64::from(degrees).to_radians().cos())
        })
        .collect();
    for marked in &features.marked {
        let ends = marked.map(|v| topology.point_of().get(v as usize).copied().unwrap_or(NONE));
        if let Some(edge) = edges.find(ends[0], ends[1]) {
            is_feature[edge as usize] = true;
        }
    }
    if features.creasing == Creasing::Automatic {
        let surface = WorkingSurface::new(mesh, topology);
        let curves = surface.curves();
        let mut reached = Vec::new();
        for edge in 0..curves.edge_count() as u32 {
            let ends = curves.ends(edge);
            if let Some(at) = edges.find(ends[0], ends[1]) {
                is_feature[at as usize] = true;
            }
            if curves.rim(edge) == Rim::Crease {
                reached.extend(ends);
            }
        }
        let is_bent =
            |edge: u32| matches!(edges.half_edges(edge), &[a, b] if normal(a).dot(normal(b)) < CREASE);
        spread(topology.point_count(), edges, reached, &mut is_feature, is_bent);
    }
    is_feature
}

/// Marks edges that continue marked ones: the ends of creases which fade out outline nothing, but belong to the drawing.
fn spread(
    points: usize,
    edges: &Edges,
    mut reached: Vec<u32>,
    is_feature: &mut [bool],
    is_bent: impl Fn(u32) -> bool,
) {
    if reached.is_empty() {
        return;
    }
    let bent = (0..edges.len() as u32).filter(|&edge| !is_feature[edge as usize] && is_bent(edge));
    let bent: Vec<u32> = bent.collect();
    let pairs = bent.iter().flat_map(|&edge| edges.ends()[edge as usize].map(|end| (end, edge)));
    let around = Lists::from_pairs(points, pairs);
    while let Some(point) = reached.pop() {
        for &edge in around.get(point) {
            if !std::mem::replace(&mut is_feature[edge as usize], true) {
                reached.extend(edges.ends()[edge as usize]);
            }
        }
    }
}

/// Returns which points are corners: locked by the caller, or where a curve turns sharply. Curves of which more than a
/// quarter of the points turn sharply are the ragged borders of scans: they have no corners.
fn corners(mesh: &Mesh, topology: &Topology, curves: &[[u32; 2]]) -> Vec<bool> {
    let mut is_corner = vec![false; topology.point_count()];
    for (vertex, _) in mesh.locks().iter().enumerate().filter(|(_, locked)| **locked) {
        is_corner[topology.point_of()[vertex] as usize] = true;
    }
    let mut sets = Sets::new(topology.point_count());
    let mut around: Vec<(u32, u32)> = Vec::with_capacity(2 * curves.len());
    for &[a, b] in curves {
        sets.join(a, b);
        around.extend([(a, b), (b, a)]);
    }
    around.sort_unstable();
    let at = |p: u32| {
        DVec3::from_array(mesh.positions()[topology.vertex_of_point()[p as usize] as usize].map(f64::from))
    };
    let least = CORNER_DEGREES.to_radians().cos();
    let mut sharp = Vec::new();
    let mut counts = vec![[0u32; 2]; topology.point_count()];
    for star in around.chunk_by(|a, b| a.0 == b.0) {
        let &[(point, a), (_, b)] = star else { continue };
        let set = sets.find(point) as usize;
        counts[set][0] += 1;
        let (before, after) =
            ((at(point) - at(a)).normalize_or_zero(), (at(b) - at(point)).normalize_or_zero());
        if before.dot(after) < least {
            sharp.push(point);
            counts[set][1] += 1;
        }
    }
    for point in sharp {
        let [all, sharp] = counts[sets.find(point) as usize];
        is_corner[point as usize] |= 4 * sharp <= all.max(16);
    }
    // A curve of a single edge has one sector at each end, so nothing else holds its ends.
    let degree = |p: u32| around.partition_point(|end| end.0 <= p) - around.partition_point(|end| end.0 < p);
    for &[a, b] in curves.iter().filter(|edge| edge.iter().all(|&end| degree(end) == 1)) {
        (is_corner[a as usize], is_corner[b as usize]) = (true, true);
    }
    is_corner
}
