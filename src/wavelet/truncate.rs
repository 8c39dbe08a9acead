//! Truncation: the wavelets with the largest errors, as many as fit.
//!
//! Bounds contain the children's bounds. So, ordered by decreasing error and then by level, every prefix is closed under
//! parents.

use crate::adapt::Refinements;

use super::instance::use_counts::{UseCounts, UseSink};
use super::{Subdivision, Triangulation, WaveletMesh};

impl WaveletMesh {
    /// Returns the set of wavelets with the largest bounds drawn with at most `triangles` triangles, as a flag a wavelet. Empty
    /// set if even the base mesh has more. O(n log n).
    pub fn largest_within(&self, triangles: usize, triangulation: Triangulation) -> Vec<bool> {
        self.largest_while(triangulation, |drawn, _| drawn <= triangles)
    }

    /// Returns the set of wavelets with the largest bounds drawn with at most `vertices` vertices, as a flag a wavelet. Empty
    /// set if even the base mesh has more. O(n log n).
    pub fn largest_within_vertices(&self, vertices: usize, triangulation: Triangulation) -> Vec<bool> {
        self.largest_while(triangulation, |_, used| used <= vertices)
    }

    /// Returns the set of wavelets with the largest bounds, as long as the numbers of triangles and vertices drawn fit.
    fn largest_while(&self, triangulation: Triangulation, fits: impl Fn(usize, usize) -> bool) -> Vec<bool> {
        let of = self.subdivision();
        let count = of.wavelet_count() as u32;
        // No smaller than any child's error, despite rounding.
        let mut size: Vec<f32> = (0..count).map(|wavelet| self.bounds(wavelet).largest_error()).collect();
        for wavelet in (0..count).rev() {
            let own = size[wavelet as usize];
            of.parents_of(wavelet).for_each(|parent| {
                let size = &mut size[parent as usize];
                *size = size.max(own);
            });
        }
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by(|&a, &b| size[b as usize].total_cmp(&size[a as usize]));

        let mut set = vec![false; count as usize];
        let mut uses = UseCounts::new(of, triangulation);
        let mut drawn = of.base_face_count();
        let mut used = Used { of, vertices: of.base_vertex_count() };
        for wavelet in order {
            drawn += uses.change(of, wavelet, true, &mut used);
            if !fits(drawn, used.vertices) {
                break;
            }
            set[wavelet as usize] = true;
        }
        set
    }

    /// Returns the longest error of the wavelets outside a set, object units. It bounds the distance of the set's mesh from the
    /// full resolution if bounds are [conservative](super::ErrorBound::Conservative) and triangles
    /// [exact](Triangulation::Exact). O(n).
    pub fn largest_left_out(&self, holds: impl Fn(u32) -> bool) -> f32 {
        let left_out = (0..self.subdivision().wavelet_count() as u32).filter(|&wavelet| !holds(wavelet));
        left_out.map(|wavelet| self.bounds(wavelet).largest_error()).fold(0.0, f32::max)
    }
}

/// Counts vertices in use.
struct Used<'a> {
    of: &'a Subdivision,
    vertices: usize,
}

impl UseSink for Used<'_> {
    fn used(&mut self, wavelet: u32) {
        self.vertices += 1 + self.of.seam_vertices_of(wavelet).count();
    }

    fn turned(&mut self, _: u32) {}
}
