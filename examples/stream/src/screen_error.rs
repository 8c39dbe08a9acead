//! Distance of the drawn mesh from the model in pixels, measured on the surface: no bound of the server is used.

use glam::DVec3;
use multires::mesh::Mesh;
use multires::quality::vertex_distances;

use crate::AnyError;
use crate::camera::Pose;

/// A point of the model, and the normal of its triangle.
#[derive(Debug, Clone, Copy)]
struct Sample {
    at: DVec3,
    normal: DVec3,
}

/// Points spread over the triangles of a model.
#[derive(Debug, Clone)]
pub struct ScreenError {
    samples: Vec<Sample>,
}

impl ScreenError {
    /// Takes the middles of about `count` triangles, at even steps through the list.
    pub fn new(model: &Mesh, count: usize) -> Self {
        let every = model.triangles().len().div_ceil(count.max(1)).max(1);
        let samples = model.triangles().iter().step_by(every).map(|corners| {
            let [a, b, c] = corners.map(|v| DVec3::from_array(model.positions()[v as usize].map(f64::from)));
            Sample { at: (a + b + c) / 3.0, normal: (b - a).cross(c - a) }
        });
        Self { samples: samples.collect() }
    }

    /// Returns the 95th percentile of the distances in pixels, over the points that are in the picture and face the eye. `None` if
    /// there is no such point, or nothing is drawn.
    ///
    /// # Errors
    /// The measurement refuses the mesh.
    pub fn measure(&self, drawn: &Mesh, pose: &Pose, viewport: [u32; 2]) -> Result<Option<f64>, AnyError> {
        let seen = self.samples.iter().filter(|sample| sample.normal.dot(pose.eye - sample.at) > 0.0);
        let (points, pixels): (Vec<[f32; 3]>, Vec<f64>) = seen
            .filter_map(|sample| Some((sample.at.as_vec3().to_array(), pose.pixels_at(sample.at, viewport)?)))
            .unzip();
        if points.is_empty() || drawn.triangles().is_empty() {
            return Ok(None);
        }
        let distances = vertex_distances(&Mesh::new(points, [])?, drawn)?;
        let mut errors: Vec<f64> = distances.iter().zip(&pixels).map(|(d, p)| d * p).collect();
        errors.sort_unstable_by(f64::total_cmp);
        Ok(Some(errors[(errors.len() - 1) * 95 / 100]))
    }
}
