//! Finds the largest errors caused by leaving out a wavelet, without visiting every error.
//!
//! ```text
//!     support      errors one by one for some levels, as far as they could be the largest so far
//!      /   \
//!     .     .      below: what was before, and the bounds of the wavelets on the sides of a face, turned to the own axis
//! ```
//!
//! The result depends only on the inside of the support: bounds of wavelets on its rim are not used. So bounds recomputed one
//! by one equal bounds computed all at once. Errors some levels below are a small share of the total, so using bounds of finer
//! wavelets there widens the result little.

use std::cell::Cell;

use glam::DVec3;

use crate::mesh::NONE;
use crate::view::{ErrorShape, Fit};
use crate::wavelet::ErrorBound;

use super::wavelet_bounds::{Grounds, WaveletBounds};

/// Levels below a wavelet with errors visited one by one: for [`ErrorBound::WithoutSiblings`] and [`ErrorBound::Conservative`].
const LOOK_AT_ALL: u8 = 5;
const LOOK_AT_ANY: u8 = 4;
/// Factor by which a skipped error must be smaller than the result, so rounding cannot make it larger.
const CAUTION: f64 = 1.0 + 1e-9;

/// Lengths of an error along an axis and across it.
type Parts = [f64; 2];

/// Searches for the largest errors of a wavelet.
pub(crate) struct Search<'a, F> {
    pub grounds: &'a Grounds<'a>,
    pub wavelet: u32,
    /// Axis of the shapes; `None`: balls.
    pub axis: Option<DVec3>,
    /// Returns the bounds of a finer wavelet.
    pub finer: &'a F,
}

impl<F: Fn(u32) -> WaveletBounds> Search<'_, F> {
    /// Returns half-lengths of the smallest shape around all errors.
    pub fn fit(&self) -> [f32; 2] {
        let shape = self.grounds.mesh.options().shape;
        let span = Cell::new([0.0; 2]);
        self.run(
            |[h, t]| h * CAUTION > span.get()[0] || t * CAUTION > span.get()[1],
            |[h, t]| span.set(Fit::span(span.get(), (h, t))),
        );
        let fit = Cell::new(Fit::new(shape, span.get()));
        self.run(
            |[h, t]| fit.get().grows_by((h * CAUTION, t * CAUTION)),
            |[h, t]| {
                let mut with = fit.get();
                with.add((h, t));
                fit.set(with);
            },
        );
        fit.get().sizes()
    }

    /// Visits errors, skipping errors no larger than a bound not `worth` visiting.
    fn run(&self, worth: impl Fn(Parts) -> bool, found: impl FnMut(Parts)) {
        match self.grounds.mesh.options().bound {
            ErrorBound::WithoutSiblings => self.all_left_out(worth, found),
            ErrorBound::Conservative => self.any_left_out(worth, found),
        }
    }

    fn parts(&self, error: DVec3) -> Parts {
        match self.axis {
            Some(axis) => [error.dot(axis).abs(), error.cross(axis).length()],
            None => [error.length(), 0.0],
        }
    }

    fn coefficient_parts(&self, wavelet: u32) -> Parts {
        self.parts(self.grounds.coefficient(wavelet))
    }

    /// Returns the largest displacement of a point at an edge by the wavelets on the edge and on its parts.
    fn beside(&self, wavelet: u32, parts: &impl Fn(u32) -> Parts) -> Parts {
        if wavelet == NONE {
            return [0.0; 2];
        }
        let [a, b] = self.grounds.of.halves(wavelet).map(|half| self.beside(half, parts));
        add(parts(wavelet), most(a, b))
    }

    /// Returns an upper bound of the sum of a wavelet and all finer wavelets in its support, from the wavelet's bounds, which
    /// have another axis. `own`: a part of the sum to subtract.
    fn most_of(&self, wavelet: u32, own: Option<DVec3>) -> Parts {
        let shape = self.grounds.mesh.options().shape;
        let bounds = (self.finer)(wavelet).unpack([0.0; 3], shape);
        let (mut along, mut across) = (f64::from(bounds.along), f64::from(bounds.across));
        if shape == ErrorShape::SphereAndCones {
            along = along.max(across);
        }
        let Some(other) = bounds.axis().map(DVec3::from_array) else {
            let most = (along.max(across) - own.map_or(0.0, DVec3::length)).max(0.0);
            return [most; 2];
        };
        if let Some(own) = own {
            along = (along - own.dot(other).abs()).max(0.0);
            across = (across - own.cross(other).length()).max(0.0);
        }
        match self.axis {
            None => [along + across, 0.0],
            Some(axis) => {
                let (cosine, sine) = (axis.dot(other).abs(), axis.cross(other).length());
                [along * cosine + across * sine, along * sine + across]
            }
        }
    }

    /// Visits errors at the vertices inside the support, with all wavelets of the wavelet's level and finer left out.
    fn all_left_out(&self, worth: impl Fn(Parts) -> bool, mut found: impl FnMut(Parts)) {
        let (grounds, of) = (self.grounds, self.grounds.of);
        found(self.coefficient_parts(self.wavelet));
        let mut stack: Vec<(u32, [DVec3; 3], [bool; 3], u8)> = Vec::new();
        for along in of.faces_along(self.wavelet).filter(|along| of.is_split(along.face())) {
            let (face, k) = (along.face(), along.side());
            let middles = of.sides_of_split(face).map(|side| grounds.coefficient(side));
            let (next, far) = ((k + 1) % 3, (k + 2) % 3);
            let rim = |side: usize| [0, 1, 2].map(|s| s == side);
            stack.push((of.child(face, k), [DVec3::ZERO, middles[k], middles[far]], rim(2), LOOK_AT_ALL));
            stack.push((of.child(face, next), [DVec3::ZERO, middles[next], middles[k]], rim(0), LOOK_AT_ALL));
            stack.push((of.child(face, 3), middles, rim(next), LOOK_AT_ALL));
        }
        while let Some((face, errors, rim, look)) = stack.pop() {
            if !of.is_split(face) {
                continue;
            }
            // Between the corners, errors are bounded by the errors at the corners plus the finer wavelets.
            let sides = of.sides_of_split(face);
            let so_far = errors.into_iter().fold([0.0; 2], |found, error| most(found, self.parts(error)));
            let inside = (0..3).filter(|&k| !rim[k]).map(|k| self.most_of(sides[k], None));
            let finer = inside.fold([0.0; 2], most);
            let bound = add(so_far, finer);
            if !worth(bound) {
                continue;
            }
            if look == 0 {
                found(bound);
                continue;
            }
            let middles = [0, 1, 2].map(|k| {
                let error = grounds.coefficient(sides[k]) + (errors[k] + errors[(k + 1) % 3]) * 0.5;
                if !rim[k] {
                    found(self.parts(error));
                }
                error
            });
            for i in 0..3 {
                let j = (i + 2) % 3;
                let (errors, rim) = ([errors[i], middles[i], middles[j]], [rim[i], false, rim[j]]);
                stack.push((of.child(face, i), errors, rim, look - 1));
            }
            stack.push((of.child(face, 3), middles, [false; 3], look - 1));
        }
    }

    /// For every face at full resolution in the support, visits the largest displacement of its points by wavelets left out,
    /// along the axis and across it.
    fn any_left_out(&self, worth: impl Fn(Parts) -> bool, mut found: impl FnMut(Parts)) {
        let (grounds, of) = (self.grounds, self.grounds.of);
        let parts = |wavelet: u32| self.coefficient_parts(wavelet);
        let own = parts(self.wavelet);
        let mut stack: Vec<(u32, Parts, [bool; 3], u8)> = Vec::new();
        grounds.support(self.wavelet, |face, rim| stack.push((face, own, rim, LOOK_AT_ANY)));
        while let Some((face, so_far, rim, look)) = stack.pop() {
            if of.is_split(face) {
                let sides = of.sides_of_split(face);
                let coefficients = sides.map(|side| grounds.coefficient(side));
                let own = coefficients.map(|coefficient| self.parts(coefficient));
                let sum = add(so_far, own.into_iter().fold([0.0; 2], most));
                // Finer wavelets on the rim reach out of the support.
                let finer = [0, 1, 2].map(|k| match rim[k] {
                    true => [f64::INFINITY; 2],
                    false => self.most_of(sides[k], Some(coefficients[k])),
                });
                for i in 0..4 {
                    // Each child is in the supports of two sides, or of all three. At most 1 side is on the rim.
                    let j = (i + 2) % 3;
                    let (inside, rim) = match i {
                        3 => (finer.into_iter().fold(finer[0], least), [false; 3]),
                        i => (least(finer[i], finer[j]), [rim[i], false, rim[j]]),
                    };
                    let child = of.child(face, i);
                    if !of.is_split(child) && of.is_uniform() {
                        found(sum);
                    } else if worth(add(sum, inside)) {
                        if look == 0 {
                            found(add(sum, inside));
                        } else {
                            stack.push((child, sum, rim, look - 1));
                        }
                    }
                }
                continue;
            }
            // Hats from deeper neighbours reach into the face.
            let mut beside = [0.0; 2];
            if !of.is_uniform() {
                for side in [0, 1, 2].map(|side| of.side(face, side).0) {
                    beside = if side == self.wavelet {
                        of.halves(side).into_iter().fold(beside, |b, half| most(b, self.beside(half, &parts)))
                    } else {
                        most(beside, self.beside(side, &parts))
                    };
                }
            }
            found(add(so_far, beside));
        }
    }
}

fn add([a, b]: Parts, [c, d]: Parts) -> Parts {
    [a + c, b + d]
}

fn least([a, b]: Parts, [c, d]: Parts) -> Parts {
    [a.min(c), b.min(d)]
}

fn most([a, b]: Parts, [c, d]: Parts) -> Parts {
    [a.max(c), b.max(d)]
}
