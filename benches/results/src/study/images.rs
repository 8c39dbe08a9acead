//! The measures that are taken from pictures, in one place.

use std::error::Error;

use multires::Mesh;
use multires::quality::{ImageOptions, ReferenceImages};

/// Pictures of a model, to compare its levels with.
pub struct Images(ReferenceImages);

impl Images {
    /// Takes the pictures: `views` of `size` by `size` pixels.
    pub fn new(mesh: &Mesh, views: usize, size: usize) -> Result<Self, Box<dyn Error>> {
        Ok(Self(ReferenceImages::new(mesh, &ImageOptions::default().with_views(views).with_size(size))?))
    }

    /// K_L1 and K_L2 in grey levels, K_sil in pixels a view; none of a level that has no surface left.
    pub fn difference(&self, level: &Mesh) -> [Option<f64>; 3] {
        self.0.difference(level).map_or([None; 3], |seen| [seen.l1, seen.l2, seen.silhouette].map(Some))
    }
}
