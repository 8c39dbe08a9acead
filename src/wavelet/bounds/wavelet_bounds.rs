//! Bounds on the change from leaving out a wavelet: a sphere around its support, a cone of the normals there, a shape
//! around the errors.
//!
//! Leaving out wavelet e of level j leaves out all its descendants. The error at a point of its support is the sum of the
//! wavelets left out there (Azuma et al., equation 2), of level j and finer:
//!
//! ```text
//!     without siblings   all of them: full surface less level j - 1, at every vertex inside the support. The paper's bound.
//!     conservative       some of them, whichever: |s_e|, and for each finer level the largest coefficient of those whose
//!                        hats cover the point, summed along the way down. Of the wavelets left out at a point take the
//!                        largest of the coarsest level: it was tested itself, and those beside it are no larger, and
//!                        hats of one level sum to 1 at most. So its bound holds, whatever else is in.
//! ```
//!
//! Both are nested afterwards: a wavelet's bounds contain its children's, or the cut would not be closed.
//!
//! Nothing is summed over the whole mesh. The mean normal of a support is found along its rim (Stokes). Errors in the
//! support are searched for some levels, where they could be the largest; still finer wavelets count by their own bounds.
//! So a wavelet's bounds cost O(length of its rim), and can be recomputed individually where something changed.

use std::ops::ControlFlow;

use glam::DVec3;

use crate::geometry::{parallel, rounding};
use crate::lod::Progress;
use crate::mesh::NONE;
use crate::view::{DeviationBounds, ErrorShape, angle_between};
use crate::wavelet::ErrorBound;
use crate::wavelet::instance::surface::finest_triangles;
use crate::wavelet::mesh::WaveletMesh;
use crate::wavelet::subdivision::Subdivision;

use super::error_search::Search;

/// Share by which a sphere is enlarged, so containment survives rounding.
const ROOM: f64 = 4e-7;
/// Radians by which a cone is widened.
const WIDER: f64 = 1e-6;

/// Where more than 1 in `FEW` wavelets get new bounds, the bends of all wavelets are computed first.
const FEW: usize = 16;

/// Bounds of a wavelet, 16 bytes. Not stored: the centre, which is its vertex, and the shape of errors, common to all.
/// The numbers are explained at [`DeviationBounds`].
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct WaveletBounds {
    /// Radius of the sphere around all changes where the wavelet is left out, object units.
    pub radius: f32,
    /// Half-length of the shape around errors along the cone's axis, object units.
    pub along: f32,
    /// Half-length of the shape around errors across the cone's axis, object units.
    pub across: f32,
    /// Cone of normals: axis in 127ths, half-angle in 255ths of a right angle.
    pub cone: [i8; 4],
}

impl WaveletBounds {
    #[inline]
    pub(crate) fn unpack(&self, centre: [f32; 3], shape: ErrorShape) -> DeviationBounds {
        let Self { radius, along, across, cone } = *self;
        DeviationBounds { centre, radius, cone, shape, along, across }
    }
}

/// The surface whose wavelets are bounded.
pub(crate) struct Grounds<'a> {
    pub mesh: &'a WaveletMesh,
    pub of: &'a Subdivision,
    /// Per wavelet twice the area between its edge at full resolution and the straight line from end to end; empty where
    /// computed on demand.
    bends: Vec<DVec3>,
    /// Length added to every radius, object units.
    room: f64,
}

impl<'a> Grounds<'a> {
    pub fn new(mesh: &'a WaveletMesh, many: bool) -> Self {
        let of = mesh.subdivision();
        let mut grounds = Self { mesh, of, bends: Vec::new(), room: room(mesh.diagonal()) };
        if many {
            let mut bends = vec![DVec3::ZERO; of.wavelet_count()];
            for wavelet in (0..of.wavelet_count() as u32).rev() {
                bends[wavelet as usize] = grounds.bend_of(wavelet, |half| bends[half as usize]);
            }
            grounds.bends = bends;
        }
        grounds
    }

    /// Returns twice the area, as a vector, between an edge at full resolution and the straight line from end to end.
    fn bend(&self, wavelet: u32) -> DVec3 {
        match self.bends.get(wavelet as usize) {
            Some(&bend) => bend,
            None => self.bend_of(wavelet, |half| self.bend(half)),
        }
    }

    fn bend_of(&self, wavelet: u32, of_half: impl Fn(u32) -> DVec3) -> DVec3 {
        let vertex = self.of.vertex_of(wavelet);
        let Some(ends) = self.of.ends(vertex) else { return DVec3::ZERO };
        let [a, b] = ends.map(|end| self.position(end));
        let halves = self.of.halves(wavelet).into_iter().filter(|&half| half != NONE);
        halves.fold((self.position(vertex) - a).cross(b - a), |sum, half| sum + of_half(half))
    }

    /// Returns the area-weighted normal (twice the area) of a face at full resolution: the normal of the plane triangle,
    /// plus the bends along its sides.
    fn normal(&self, face: u32) -> DVec3 {
        let corners = self.of.corners(face);
        if !self.of.is_split(face) && self.of.is_uniform() {
            return self.area_normal(corners);
        }
        (0..3).fold(self.area_normal(corners), |sum, k| match self.of.side(face, k) {
            (NONE, _) => sum,
            (wavelet, false) => sum + self.bend(wavelet),
            (wavelet, true) => sum - self.bend(wavelet),
        })
    }

    fn position(&self, vertex: u32) -> DVec3 {
        DVec3::from_array(self.mesh.vertices.positions()[vertex as usize].map(f64::from))
    }

    fn area_normal(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|v| self.position(v));
        (b - a).cross(c - a)
    }

    /// Calls `visit` with the triangles of a face which is not split.
    fn triangles(&self, face: u32, mut visit: impl FnMut([u32; 3])) {
        if self.of.is_uniform() {
            return visit(self.of.corners(face));
        }
        finest_triangles(self.of, face, visit);
    }

    /// Returns a wavelet's coefficient.
    pub fn coefficient(&self, wavelet: u32) -> DVec3 {
        let vertex = self.of.vertex_of(wavelet);
        self.mesh.coefficient(vertex).map_or(DVec3::ZERO, DVec3::from_array)
    }

    /// Calls `visit` with the parts of a wavelet's support: three children of each split face along its edge, or the face
    /// itself if not split. The flags mark sides on the rim of the support.
    pub fn support(&self, wavelet: u32, mut visit: impl FnMut(u32, [bool; 3])) {
        let of = self.of;
        for along in of.faces_along(wavelet) {
            let (face, k) = (along.face(), along.side());
            if !of.is_split(face) {
                visit(face, [0, 1, 2].map(|side| side != k));
                continue;
            }
            let next = (k + 1) % 3;
            let rim = |side: usize| [0, 1, 2].map(|s| s == side);
            visit(of.child(face, k), rim(2));
            visit(of.child(face, next), rim(0));
            visit(of.child(face, 3), rim(next));
        }
    }

    /// Returns the axis of a wavelet's bounds before packing, the mean normal of its support; `None` without a mean
    /// normal.
    fn axis(&self, wavelet: u32) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        self.support(wavelet, |face, _| sum += self.normal(face));
        sum.try_normalize()
    }

    /// Computes the bounds of a wavelet, given the bounds of finer wavelets.
    pub fn bounds(&self, wavelet: u32, finer: impl Fn(u32) -> WaveletBounds) -> WaveletBounds {
        let of = self.of;
        let shape = self.mesh.options().shape;
        let centre = self.mesh.vertices.positions()[of.vertex_of(wavelet) as usize];
        let middle = DVec3::from_array(centre.map(f64::from));
        let axis = self.axis(wavelet);

        let mut radius = 0.0_f64;
        let mut wide = if axis.is_some() { 0.0_f64 } else { f64::INFINITY };
        self.support(wavelet, |face, _| {
            if of.is_split(face) {
                let corners = of.corners(face).map(|v| self.position(v).distance(middle));
                radius = corners.into_iter().fold(radius, f64::max);
                return;
            }
            self.triangles(face, |triangle| {
                let far = triangle.map(|v| self.position(v).distance(middle));
                radius = far.into_iter().fold(radius, f64::max);
                if let (Some(axis), Some(normal)) = (axis, self.area_normal(triangle).try_normalize()) {
                    wide = wide.max(angle_between(axis, normal));
                }
            });
        });
        for (child, _) in of.incident_edges(wavelet) {
            let packed = finer(child);
            let bounds = packed.unpack([0.0; 3], shape);
            let to = self.position(of.vertex_of(child)).distance(middle);
            radius = radius.max(to + f64::from(packed.radius));
            wide = match (axis, bounds.cone()) {
                (Some(axis), Some((other, angle))) => {
                    wide.max(angle_between(axis, DVec3::from_array(other)) + angle)
                }
                _ => f64::INFINITY,
            };
        }
        let radius = rounding::up(radius * (1.0 + ROOM) + self.room + middle.abs().max_element() * 1e-12);
        let mut bounds = DeviationBounds::new(centre, radius, shape)
            .with_cone(axis.unwrap_or(DVec3::ZERO).to_array(), wide + WIDER);

        // The shape is about the axis as stored.
        let search =
            Search { grounds: self, wavelet, axis: bounds.axis().map(DVec3::from_array), finer: &finer };
        [bounds.along, bounds.across] = search.fit();
        // Without an axis, a ball.
        if search.axis.is_none() {
            bounds.across = bounds.along;
        }
        if of.interior_seams.binary_search(&wavelet).is_ok() {
            // Leaving it out smears attributes across a seam, an unmeasured error.
            (bounds.along, bounds.across) = (f32::MAX, f32::MAX);
        }
        for (child, _) in of.incident_edges(wavelet) {
            bounds.hold_errors_of(&finer(child).unpack(centre, shape));
        }
        let DeviationBounds { radius, cone, along, across, .. } = bounds;
        WaveletBounds { radius, along, across, cone }
    }
}

/// Returns the length added to radii, for a diagonal: a constant times a power of two, so it seldom changes.
fn room(diagonal: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(diagonal.to_bits() & EXPONENT) * 2e-9
}

/// Number of wavelets bounded between two calls of progress.
const CHUNK: usize = 1 << 14;

/// Computes the bounds of every wavelet, from the finest to the coarsest; `None` where `progress` breaks. O(n x levels)
/// at most.
pub(crate) fn bounds(mesh: &WaveletMesh, progress: Progress<'_>) -> Option<Vec<WaveletBounds>> {
    let grounds = Grounds::new(mesh, true);
    let of = mesh.subdivision();
    let none = WaveletBounds { radius: 0.0, along: 0.0, across: 0.0, cone: [0; 4] };
    let mut all = vec![none; of.wavelet_count()];
    let mut done = 0;
    for level in (1..=of.depth()).rev() {
        let wavelets = of.wavelets_of(level);
        let (coarser, finer) = all.split_at_mut(wavelets.end as usize);
        let at_finer = |wavelet: u32| finer[(wavelet - wavelets.end) as usize];
        let level = &mut coarser[wavelets.start as usize..];
        for (chunk, first) in level.chunks_mut(CHUNK).zip((wavelets.start..).step_by(CHUNK)) {
            let find = |(at, packed): (usize, &mut WaveletBounds)| {
                *packed = grounds.bounds(first + at as u32, at_finer);
            };
            parallel::fill(chunk, find);
            done += chunk.len();
            if progress(done as f32 / of.wavelet_count() as f32).is_break() {
                return None;
            }
        }
    }
    Some(all)
}

/// Computes the bounds of every wavelet, without progress.
pub(crate) fn all_bounds(mesh: &WaveletMesh) -> Vec<WaveletBounds> {
    // Never breaks.
    bounds(mesh, &mut |_| ControlFlow::Continue(())).unwrap_or_default()
}

/// Recomputes the bounds of wavelets whose supports contain any of these faces, of any level. The result equals
/// [`all_bounds`]. `diagonal`: the mesh's before the change. Returns the recomputed wavelets, ascending.
pub(crate) fn update(mesh: &mut WaveletMesh, faces: Vec<u32>, diagonal: f64) -> Vec<u32> {
    let of = mesh.subdivision();
    if room(diagonal) != room(mesh.diagonal()) {
        let all = (0..of.wavelet_count() as u32).collect();
        mesh.bounds = all_bounds(mesh).into();
        return all;
    }
    let mut all = std::mem::take(&mut mesh.bounds).into_vec();
    let of = mesh.subdivision();
    let siblings = mesh.options().bound == ErrorBound::WithoutSiblings;
    let wavelets = wavelets_over(of, faces, siblings);
    let grounds = Grounds::new(mesh, wavelets.len() > of.wavelet_count() / FEW);
    let mut end = wavelets.len();
    while end > 0 {
        // Wavelets of the same level are independent.
        let level = of.wavelets_of(of.level_of(wavelets[end - 1]));
        let start = wavelets[..end].partition_point(|&wavelet| wavelet < level.start);
        let find = |&wavelet: &u32| grounds.bounds(wavelet, |finer| all[finer as usize]);
        let found = parallel::map_items(&wavelets[start..end], find);
        for (&wavelet, packed) in wavelets[start..end].iter().zip(found) {
            all[wavelet as usize] = packed;
        }
        end = start;
    }
    mesh.bounds = all.into();
    wavelets
}

/// Returns the wavelets whose supports contain any of these faces or their ancestors, ascending. With `siblings`, also
/// the wavelets on the sides of these faces: their bounds use the coefficients on the other sides, and so the opposite
/// corner.
fn wavelets_over(of: &Subdivision, mut faces: Vec<u32>, siblings: bool) -> Vec<u32> {
    faces.sort_unstable();
    let mut wavelets = Vec::new();
    let mut on_sides: Vec<u32> = Vec::new();
    // Parents come out in the order of their children: two queues, and the larger head is next.
    let mut parents = std::collections::VecDeque::new();
    loop {
        let next = match (faces.last(), parents.front()) {
            (Some(&face), Some(&parent)) => face.max(parent),
            (Some(&face), None) | (None, Some(&face)) => face,
            (None, None) => break,
        };
        while faces.last() == Some(&next) {
            faces.pop();
        }
        while parents.front() == Some(&next) {
            parents.pop_front();
        }
        if !of.is_split(next) {
            on_sides.extend([0, 1, 2].map(|side| of.side(next, side).0).iter().filter(|&&w| w != NONE));
            while let Some(wavelet) = on_sides.pop() {
                wavelets.push(wavelet);
                on_sides.extend(of.halves(wavelet).into_iter().filter(|&half| half != NONE));
            }
        }
        wavelets.extend(of.sides_of_split_if(next, siblings && of.is_split(next)));
        if let Some((parent, _, child)) = of.parent(next) {
            let sides = of.sides_of_split(parent);
            wavelets.extend(match child {
                3 => sides,
                i => [sides[i], sides[i], sides[(i + 2) % 3]],
            });
            if parents.back() != Some(&parent) {
                parents.push_back(parent);
            }
        }
    }
    wavelets.sort_unstable();
    wavelets.dedup();
    wavelets
}
