//! Fans: the faces around a point that are joined by edges at the point. A fan is what a vertex is to a surface; a point where
//! several fans meet counts as several.

use crate::mesh::NONE;

use super::complex::{Complex, FaceComplex};

/// How the faces of a fan lie around its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Around {
    /// All around: every edge at the point has two faces.
    Closed,
    /// From border to border.
    Open,
    /// Three faces or more at an edge.
    NonManifold,
}

/// The fans of a connected complex.
pub(super) struct Fans {
    /// Per face the fans at its corners.
    pub of_corner: Vec<[u32; 3]>,
    /// Per fan its lowest wedge.
    pub lowest_wedge: Vec<u32>,
}

impl Fans {
    /// Finds the fans. O(n), nearly.
    pub fn new(complex: &Complex, surface: &FaceComplex) -> Self {
        let corners = complex.corners.as_flattened();
        let end = |half_edge: u32| half_edge - half_edge % 3 + (half_edge + 1) % 3;
        let point = |corner: u32| surface.point(corners[corner as usize]);
        let mut sets: Vec<u32> = (0..corners.len() as u32).collect();
        for half_edge in 0..corners.len() as u32 {
            let other = complex.next(half_edge);
            let ends = match point(other) == point(half_edge) {
                true => [(half_edge, other), (end(half_edge), end(other))],
                false => [(half_edge, end(other)), (end(half_edge), other)],
            };
            for (a, b) in ends {
                let [a, b] = [root(&mut sets, a), root(&mut sets, b)];
                sets[a.max(b) as usize] = a.min(b);
            }
        }
        let mut number = vec![NONE; corners.len()];
        let mut lowest_wedge: Vec<u32> = Vec::new();
        let mut of_corner = vec![[NONE; 3]; complex.face_count()];
        for (corner, fan) in of_corner.as_flattened_mut().iter_mut().enumerate() {
            let number = &mut number[root(&mut sets, corner as u32) as usize];
            if *number == NONE {
                *number = lowest_wedge.len() as u32;
                lowest_wedge.push(NONE);
            }
            *fan = *number;
            let lowest = &mut lowest_wedge[*number as usize];
            *lowest = (*lowest).min(corners[corner]);
        }
        Self { of_corner, lowest_wedge }
    }
}

/// Returns the number of faces of each fan, and how they lie.
pub(super) fn around(complex: &Complex, of_corner: &[[u32; 3]], fans: usize) -> Vec<(u32, Around)> {
    let mut around = vec![(0, Around::Closed); fans];
    let of_corner = of_corner.as_flattened();
    for half_edge in 0..of_corner.len() as u32 {
        around[of_corner[half_edge as usize] as usize].0 += 1;
        let found = match complex.next(half_edge) {
            other if other == half_edge => Around::Open,
            _ if complex.is_non_manifold(half_edge) => Around::NonManifold,
            _ => continue,
        };
        for corner in [half_edge, half_edge - half_edge % 3 + (half_edge + 1) % 3] {
            let around = &mut around[of_corner[corner as usize] as usize].1;
            if *around != Around::NonManifold {
                *around = found;
            }
        }
    }
    around
}

/// Returns the representative of a set, and shortens the path to it.
fn root(sets: &mut [u32], mut at: u32) -> u32 {
    while sets[at as usize] != at {
        let above = sets[sets[at as usize] as usize];
        sets[at as usize] = above;
        at = above;
    }
    at
}
