//! Polygons to triangles: a fan if every corner is strictly convex, ear clipping otherwise.
//!
//! A fan over a concave corner makes a flipped triangle; over a straight corner, a triangle without area. Ear clipping
//! makes neither if the polygon does not cross itself. Corners keep their order, and n corners always give n - 2
//! triangles.
//!
//! Ear clipping is quadratic in the corners, and slower on hostile polygons. So each file has a budget of point tests;
//! a polygon exceeding it is fanned and counted. Source: Meisters, Polygons have ears, 1975.

use super::draft::{Draft, Tally};

/// Adds the faces of an indexed file to a draft, in sequence.
pub(super) struct Polygons {
    triangulator: Triangulator,
    /// Vertices of the current face; they must exist.
    pub corners: Vec<u32>,
    points: Vec<[f64; 3]>,
    small: Tally,
}

impl Polygons {
    /// Prepares for a file of `file_size` bytes.
    pub fn new(file_size: usize) -> Self {
        let (corners, points) = (Vec::new(), Vec::new());
        Self { triangulator: Triangulator::new(file_size), corners, points, small: Tally::default() }
    }

    /// Adds the triangles of `corners`.
    pub fn add(&mut self, face: usize, draft: &mut Draft) {
        self.add_each(face, draft, |_| ());
    }

    /// Adds the triangles of `corners`, and calls `each` with the corners of each triangle, as indices into `corners`.
    pub fn add_each(&mut self, face: usize, draft: &mut Draft, mut each: impl FnMut([u32; 3])) {
        match self.corners[..] {
            [] | [_] | [_, _] => self.small.add(face),
            [a, b, c] => {
                draft.triangles.push([a, b, c]);
                each([0, 1, 2]);
            }
            _ => {
                self.points.clear();
                self.points.extend(self.corners.iter().map(|&c| draft.positions[c as usize]));
                let (corners, triangles) = (&self.corners, &mut draft.triangles);
                self.triangulator.split(&self.points, |t| {
                    triangles.push(t.map(|i| corners[i as usize]));
                    each(t);
                });
            }
        }
    }

    /// Adds notes about faces left out or fanned.
    pub fn note(&self, notes: &mut Vec<String>) {
        self.small.note("faces with fewer than 3 corners left out", "face", notes);
        self.triangulator.note(notes);
    }
}

/// Splits polygons, reusing scratch memory.
pub(super) struct Triangulator {
    budget: u64,
    fanned: usize,
    flat: Vec<[f64; 2]>,
    next: Vec<u32>,
    previous: Vec<u32>,
}

impl Triangulator {
    /// Prepares for a file of `file_size` bytes.
    pub fn new(file_size: usize) -> Self {
        let budget = (1 << 28) + 64 * file_size as u64;
        Self { budget, fanned: 0, flat: Vec::new(), next: Vec::new(), previous: Vec::new() }
    }

    /// Adds a note with the number of concave polygons fanned because the budget was spent.
    pub fn note(&self, notes: &mut Vec<String>) {
        if self.fanned > 0 {
            notes.push(format!("{} concave polygons are too large to clip and were fanned", self.fanned));
        }
    }

    /// Calls `emit` with the corners of each triangle, as indices into `points`. Fewer than three points give no
    /// triangles.
    pub fn split(&mut self, points: &[[f64; 3]], mut emit: impl FnMut([u32; 3])) {
        let count = points.len() as u32;
        if count == 3 || self.is_strictly_convex(points) {
            (1..count.saturating_sub(1)).for_each(|i| emit([0, i, i + 1]));
        } else if count > 3 {
            self.clip(&mut emit);
        }
    }

    /// Projects along the dominant axis of the polygon's normal (Newell's sum) and tests if every corner is strictly
    /// convex.
    fn is_strictly_convex(&mut self, points: &[[f64; 3]]) -> bool {
        let Some(&origin) = points.first() else { return true };
        let relative = |i: usize| {
            let p = points[i % points.len()];
            [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]
        };
        let mut normal = [0.0_f64; 3];
        for i in 0..points.len() {
            let (a, b) = (relative(i), relative(i + 1));
            for (axis, sum) in normal.iter_mut().enumerate() {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                *sum += a[u] * b[v] - a[v] * b[u];
            }
        }
        let size = normal.map(f64::abs);
        let axis =
            if size[0] > size[1] && size[0] > size[2] { 0 } else { 2 - usize::from(size[1] > size[2]) };
        // The order of the two kept axes makes the polygon counter-clockwise.
        let (u, v) = match normal[axis] < 0.0 {
            false => ((axis + 1) % 3, (axis + 2) % 3),
            true => ((axis + 2) % 3, (axis + 1) % 3),
        };
        self.flat.clear();
        self.flat.extend((0..points.len()).map(|i| [relative(i)[u], relative(i)[v]]));
        let count = points.len() as u32;
        (0..count).all(|i| self.turns_left((i + count - 1) % count, i, (i + 1) % count))
    }

    /// Returns twice the area of the triangle a, b, c, and the magnitude of its terms.
    fn area(&self, a: u32, b: u32, c: u32) -> (f64, f64) {
        let [a, b, c] = [a, b, c].map(|i| self.flat[i as usize]);
        let (first, second) = ((b[0] - a[0]) * (c[1] - a[1]), (b[1] - a[1]) * (c[0] - a[0]));
        (first - second, first.abs() + second.abs())
    }

    /// Tests if the corner b is convex by more than rounding.
    fn turns_left(&self, a: u32, b: u32, c: u32) -> bool {
        let (area, terms) = self.area(a, b, c);
        area > 1e-12 * terms
    }

    fn clip(&mut self, emit: &mut impl FnMut([u32; 3])) {
        let count = self.flat.len() as u32;
        self.next.clear();
        self.next.extend((0..count).map(|i| (i + 1) % count));
        self.previous.clear();
        self.previous.extend((0..count).map(|i| (i + count - 1) % count));
        let (mut left, mut at, mut refused) = (count, 0, 0);
        let mut out_of_budget = false;
        while left > 3 {
            let (before, after) = (self.previous[at as usize], self.next[at as usize]);
            // If no corner is an ear, the polygon crosses itself: take any, so the loop ends.
            let take = refused >= left || out_of_budget || self.is_ear(before, at, after, left);
            if take {
                emit([before, at, after]);
                self.next[before as usize] = after;
                self.previous[after as usize] = before;
                left -= 1;
                refused = 0;
                // Advancing two corners spreads the triangles; staying makes a fan.
                at = if out_of_budget { after } else { self.next[after as usize] };
            } else {
                refused += 1;
                at = after;
            }
            if self.budget == 0 && !out_of_budget {
                out_of_budget = true;
                self.fanned += 1;
            }
        }
        emit([self.previous[at as usize], at, self.next[at as usize]]);
    }

    /// Tests if b is an ear: convex, with no other corner in the triangle or on its border (except corners at the
    /// position of a, b or c).
    fn is_ear(&mut self, a: u32, b: u32, c: u32, left: u32) -> bool {
        self.budget = self.budget.saturating_sub(u64::from(left));
        if !self.turns_left(a, b, c) {
            return false;
        }
        let own = [a, b, c].map(|i| self.flat[i as usize]);
        let mut other = self.next[c as usize];
        while other != a {
            let inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| self.area(s, t, other).0 >= 0.0);
            if inside && !own.contains(&self.flat[other as usize]) {
                return false;
            }
            other = self.next[other as usize];
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let mut out = Vec::new();
        Triangulator::new(0).split(points, |t| out.push(t));
        out
    }

    fn areas(points: &[[f64; 3]]) -> Vec<f64> {
        let double = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        split(points).into_iter().map(double).collect()
    }

    #[test]
    fn convex_polygons_are_fanned() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(split(&square), [[0, 1, 2], [0, 2, 3]]);
        assert!(split(&square[..2]).is_empty());
    }

    /// ```text
    ///   5---------4
    ///   |   3-----2     a fan from 0 is right, one from 1 would cross the notch
    ///   |   |
    ///   0---1
    /// ```
    #[test]
    fn concave_polygons_have_no_flipped_triangles() {
        let l: [[f64; 3]; 6] =
            [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [2., 1., 0.], [2., 2., 0.], [0., 2., 0.]];
        for turn in 0..6 {
            let mut points = l;
            points.rotate_left(turn);
            let areas = areas(&points);
            assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
            assert_eq!(areas.iter().sum::<f64>(), 3.0);
        }
    }

    #[test]
    fn straight_corners_give_no_empty_triangles() {
        let points = [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [2., 2., 0.], [1., 2., 0.], [0., 2., 0.]];
        for turn in 0..6 {
            let mut points = points;
            points.rotate_left(turn);
            assert!(areas(&points).iter().all(|&a| a > 0.0));
        }
    }

    #[test]
    fn anything_gives_two_triangles_less_than_corners() {
        let nan = f64::NAN;
        for points in [
            vec![[0.0; 3]; 9],
            vec![[nan; 3]; 7],
            vec![[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]],
        ] {
            assert_eq!(split(&points).len(), points.len() - 2);
        }
    }
}
