//! The wavelets that change most, as many as fit.
//!
//! Bounds hold those of children, so in the order of the longest error, then of levels, every beginning is closed.

use crate::adapt::Refinements;

use super::use_counts::{UseCounts, UseSink};
use super::{Subdivision, Triangulation, WaveletMesh};

impl WaveletMesh {
    /// The set of the wavelets with the largest bounds that is drawn with at most so many triangles, as one flag a wavelet: none
    /// where not even the base mesh is. O(n log n).
    pub fn largest_within(&self, triangles: usize, triangulation: Triangulation) -> Vec<bool> {
        self.largest_while(triangulation, |drawn, _| drawn <= triangles)
    }

    /// The same with at most so many vertices.
    pub fn largest_within_vertices(&self, vertices: usize, triangulation: Triangulation) -> Vec<bool> {
        self.largest_while(triangulation, |_, used| used <= vertices)
    }

    /// The set of the wavelets with the largest bounds, as long as the numbers of triangles and vertices drawn fit.
    fn largest_while(&self, triangulation: Triangulation, fits: impl Fn(usize, usize) -> bool) -> Vec<bool> {
        let of = self.subdivision();
        let count = of.wavelet_count() as u32;
        // No smaller than that of any child, whatever was rounded.
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

    /// The longest error of the wavelets that are not in a set, object units: what the mesh of the set is away from the full
    /// resolution at most, where bounds are [conservative](super::ErrorBound::Conservative) and triangles
    /// [exact](Triangulation::Exact). O(n).
    pub fn largest_left_out(&self, holds: impl Fn(u32) -> bool) -> f32 {
        let left_out = (0..self.subdivision().wavelet_count() as u32).filter(|&wavelet| !holds(wavelet));
        left_out.map(|wavelet| self.bounds(wavelet).largest_error()).fold(0.0, f32::max)
    }
}

/// Counts vertices that come into use.
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
