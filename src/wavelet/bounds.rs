//! What leaving a wavelet out can change: a sphere around its support, a cone of the normals there, a shape around the errors.
//!
//! Leaving out wavelet e of level j leaves out all that it is an ancestor of. The error at a point of its support is the sum
//! of the wavelets that are left out there (Azuma et al., equation 2), of level j and finer:
//!
//! ```text
//!     without siblings   all of them: full surface less level j - 1, at every vertex inside the support. The paper's bound.
//!     conservative       some of them, whichever: |s_e|, and for each finer level the largest coefficient of those whose
//!                        hats cover the point, summed along the way down. Of the wavelets left out at a point take the
//!                        largest of the coarsest level: it was tested itself, and those beside it are no larger, and
//!                        hats of one level sum to 1 at most. So its bound holds, whatever else is in.
//! ```
//!
//! Both are nested afterwards: a wavelet's bounds hold its children's, or the cut would not be closed.

use glam::DVec3;

use crate::mesh::NONE;
use crate::view::{DeviationBounds, ErrorShape, angle_between};

use super::mesh::WaveletMesh;
use super::subdivision::Subdivision;
use super::surface::Surface;
use super::{ErrorBound, Triangulation};

/// Share by which a sphere is larger than it need be, so that containment survives rounding.
const ROOM: f64 = 4e-7;
/// Radians by which a cone is wider than it need be.
const WIDER: f64 = 1e-6;

/// Bounds of one wavelet but the centre, which is its vertex, and the shape of errors, which all share: 16 bytes. What the
/// numbers mean is said at [`DeviationBounds`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WaveletBounds {
    /// Radius of the sphere around all that changes where the wavelet is left out, object units.
    pub radius: f32,
    /// Half-length of the shape around errors along the cone's axis, object units.
    pub along: f32,
    /// The same across the axis.
    pub across: f32,
    /// Axis in 127ths and half-angle in 255ths of a right angle of the cone of normals.
    pub cone: [i8; 4],
}

impl WaveletBounds {
    #[inline]
    pub(super) fn unpack(&self, centre: [f32; 3], shape: ErrorShape) -> DeviationBounds {
        let Self { radius, along, across, cone } = *self;
        DeviationBounds { centre, radius, cone, shape, along, across }
    }
}

/// The surface that bounds are of, prepared.
pub(super) struct Grounds<'a> {
    mesh: &'a WaveletMesh,
    of: &'a Subdivision,
    /// Per face the sum of its normals times twice its area.
    normal: Vec<DVec3>,
    /// Triangles of faces that are not split, by face; empty where each such face is one.
    cut: Vec<(u32, [u32; 3])>,
}

impl<'a> Grounds<'a> {
    pub fn new(mesh: &'a WaveletMesh) -> Self {
        let of = mesh.subdivision();
        let cut = if of.is_uniform() {
            Vec::new()
        } else {
            let mut surface = Surface::new(of, Triangulation::Exact, 1);
            (0..of.wavelet_count() as u32).for_each(|wavelet| surface.change(of, wavelet, true));
            surface.write(of, |vertex| vertex, |_| 0);
            let mut cut: Vec<_> = surface.faces(0).zip(surface.triangles(0).iter().copied()).collect();
            cut.sort_unstable();
            cut
        };
        let mut grounds = Self { mesh, of, normal: Vec::new(), cut };
        grounds.sum_normals();
        grounds
    }

    fn sum_normals(&mut self) {
        let of = self.of;
        let mut normal = vec![DVec3::ZERO; of.face_count()];
        for face in (0..of.face_count() as u32).rev() {
            normal[face as usize] = if of.is_split(face) {
                let first = of.child(face, 0) as usize;
                normal[first..first + 4].iter().sum()
            } else {
                let mut sum = DVec3::ZERO;
                self.triangles(face, |t| sum += self.area_normal(t));
                sum
            };
        }
        self.normal = normal;
    }

    fn position(&self, vertex: u32) -> DVec3 {
        DVec3::from_array(self.mesh.vertices.positions()[vertex as usize].map(f64::from))
    }

    fn area_normal(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|v| self.position(v));
        (b - a).cross(c - a)
    }

    /// The triangles of a face that is not split.
    fn triangles(&self, face: u32, mut visit: impl FnMut([u32; 3])) {
        if self.cut.is_empty() {
            return visit(self.of.corners(face));
        }
        let start = self.cut.partition_point(|cut| cut.0 < face);
        self.cut[start..].iter().take_while(|cut| cut.0 == face).for_each(|cut| visit(cut.1));
    }

    /// A wavelet's coefficient.
    fn coefficient(&self, wavelet: u32) -> DVec3 {
        let vertex = self.of.vertex_of(wavelet);
        self.mesh.coefficient(vertex).map_or(DVec3::ZERO, DVec3::from_array)
    }

    /// The parts of a wavelet's support: three children of each face along its edge, or a face that is not split, and which of
    /// their sides are on the rim of the support.
    fn support(&self, wavelet: u32, mut visit: impl FnMut(u32, [bool; 3])) {
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

    /// The axis of a wavelet's bounds as it is stored, and whether there is one: the mean normal of its support.
    fn axis(&self, wavelet: u32) -> Option<DVec3> {
        let mut sum = DVec3::ZERO;
        self.support(wavelet, |face, _| sum += self.normal[face as usize]);
        sum.try_normalize()
    }

    /// Bounds of a wavelet, given those of its children.
    pub fn bounds(&self, wavelet: u32, child_bounds: impl Fn(u32) -> WaveletBounds) -> WaveletBounds {
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
        for (child, _) in of.spokes(wavelet) {
            let packed = child_bounds(child);
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
        let scale = self.mesh.diagonal() * 1e-9 + middle.abs().max_element() * 1e-12;
        let radius = above(radius * (1.0 + ROOM) + scale);
        let mut bounds = DeviationBounds::new(centre, radius, shape)
            .with_cone(axis.unwrap_or(DVec3::ZERO).to_array(), wide + WIDER);

        // The shape is about the axis as it is stored.
        let axis = bounds.axis().map(DVec3::from_array);
        let mut errors: Vec<(f64, f64)> = Vec::new();
        let parts = |e: DVec3| match axis {
            Some(axis) => (e.dot(axis), e.cross(axis).length()),
            None => (e.length(), 0.0),
        };
        match self.mesh.options().bound {
            ErrorBound::WithoutSiblings => self.all_left_out(wavelet, |e| errors.push(parts(e))),
            ErrorBound::Conservative => self.any_left_out(wavelet, parts, &mut errors),
        }
        // Without an axis a ball.
        [bounds.along, bounds.across] = shape.fit(errors.iter().copied());
        if axis.is_none() {
            bounds.across = bounds.along;
        }
        if of.torn.binary_search(&wavelet).is_ok() {
            // Without it attributes are smeared across a seam, which has no measure.
            (bounds.along, bounds.across) = (f32::MAX, f32::MAX);
        }
        for (child, _) in of.spokes(wavelet) {
            bounds.hold_errors_of(&child_bounds(child).unpack(centre, shape));
        }
        let DeviationBounds { radius, cone, along, across, .. } = bounds;
        WaveletBounds { radius, along, across, cone }
    }

    /// Errors at the vertices inside the support where all wavelets of this level and finer ones are left out.
    fn all_left_out(&self, wavelet: u32, mut visit: impl FnMut(DVec3)) {
        let of = self.of;
        let own = self.coefficient(wavelet);
        visit(own);
        let mut stack: Vec<(u32, [DVec3; 3], [bool; 3])> = Vec::new();
        for along in of.faces_along(wavelet).filter(|along| of.is_split(along.face())) {
            let (face, k) = (along.face(), along.side());
            let middles = of.sides_of_split(face).map(|side| self.coefficient(side));
            let (next, far) = ((k + 1) % 3, (k + 2) % 3);
            let rim = |side: usize| [0, 1, 2].map(|s| s == side);
            stack.push((of.child(face, k), [DVec3::ZERO, middles[k], middles[far]], rim(2)));
            stack.push((of.child(face, next), [DVec3::ZERO, middles[next], middles[k]], rim(0)));
            stack.push((of.child(face, 3), middles, rim(next)));
        }
        while let Some((face, errors, rim)) = stack.pop() {
            if !of.is_split(face) {
                continue;
            }
            let sides = of.sides_of_split(face);
            let middles = [0, 1, 2].map(|k| {
                let error = self.coefficient(sides[k]) + (errors[k] + errors[(k + 1) % 3]) * 0.5;
                if !rim[k] {
                    visit(error);
                }
                error
            });
            for i in 0..3 {
                let j = (i + 2) % 3;
                stack.push((of.child(face, i), [errors[i], middles[i], middles[j]], [rim[i], false, rim[j]]));
            }
            stack.push((of.child(face, 3), middles, [false; 3]));
        }
    }

    /// For every face at full resolution in the support, the most that wavelets left out can move its points, along the axis and
    /// across it.
    fn any_left_out(&self, wavelet: u32, parts: impl Fn(DVec3) -> (f64, f64), errors: &mut Vec<(f64, f64)>) {
        let of = self.of;
        let parts = |wavelet: u32| {
            let (along, across) = parts(self.coefficient(wavelet));
            [along.abs(), across]
        };
        let own = parts(wavelet);
        let mut stack: Vec<(u32, [f64; 2])> = Vec::new();
        self.support(wavelet, |face, _| stack.push((face, own)));
        while let Some((face, so_far)) = stack.pop() {
            if of.is_split(face) {
                let sum = add(so_far, of.sides_of_split(face).map(parts).into_iter().fold([0.0; 2], most));
                (0..4).for_each(|child| stack.push((of.child(face, child), sum)));
                continue;
            }
            // Hats from deeper neighbours reach into it.
            let mut beside = [0.0; 2];
            if !self.cut.is_empty() {
                for side in [0, 1, 2].map(|side| of.side(face, side).0) {
                    beside = if side == wavelet {
                        of.halves(side).into_iter().fold(beside, |b, half| most(b, self.beside(half, &parts)))
                    } else {
                        most(beside, self.beside(side, &parts))
                    };
                }
            }
            let [along, across] = add(so_far, beside);
            errors.push((along, across));
        }
    }

    /// The most that the wavelets on an edge and on its parts can move a point beside it.
    fn beside(&self, wavelet: u32, parts: &impl Fn(u32) -> [f64; 2]) -> [f64; 2] {
        if wavelet == NONE {
            return [0.0; 2];
        }
        let [a, b] = self.of.halves(wavelet).map(|half| self.beside(half, parts));
        add(parts(wavelet), most(a, b))
    }
}

fn add([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a + c, b + d]
}

fn most([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.max(c), b.max(d)]
}

/// Bounds of every wavelet, from the finest to the coarsest. O(n x levels).
pub(super) fn bounds(mesh: &WaveletMesh) -> Vec<WaveletBounds> {
    let grounds = Grounds::new(mesh);
    let of = mesh.subdivision();
    let none = WaveletBounds { radius: 0.0, along: 0.0, across: 0.0, cone: [0; 4] };
    let mut all = vec![none; of.wavelet_count()];
    for level in (1..=of.depth()).rev() {
        let wavelets = of.wavelets_of(level);
        let (coarser, finer) = all.split_at_mut(wavelets.end as usize);
        let at = |child: u32| finer[(child - wavelets.end) as usize];
        let level = &mut coarser[wavelets.start as usize..];
        let find = |(at_level, packed): (usize, &mut WaveletBounds)| {
            *packed = grounds.bounds(wavelets.start + at_level as u32, at);
        };
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            level.par_iter_mut().enumerate().for_each(find);
        }
        #[cfg(not(feature = "parallel"))]
        level.iter_mut().enumerate().for_each(find);
    }
    all
}

/// The next single precision number that is not below.
fn above(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }.min(f32::MAX)
}
