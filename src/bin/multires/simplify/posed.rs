//! Errors of a level where skins and morph targets move it.

use multires::io::{GltfDocument, GltfPose};
use multires::mesh::{Attribute, Mesh, names};
use multires::quality::{DistanceOptions, distance};
use multires::simplify::AttributeWeights;
use serde_json::{Value, json};

use crate::output::Failure;

/// Frames of an animation among which the poses are chosen.
const FRAMES: usize = 30;

/// Most morph targets in which the error is measured.
const MOST_TARGETS: usize = 64;

/// Points compared of each pose.
const SAMPLES: usize = 20_000;

/// The poses that count for a mesh.
#[derive(Default)]
pub struct Poses {
    /// Extremes of animations; they steer the simplification.
    extremes: Vec<GltfPose>,
    /// Morph targets: their displacements steer as attributes of the mesh.
    targets: Vec<GltfPose>,
}

/// The error in a pose, units of the mesh.
pub struct PoseError {
    name: String,
    time: Option<f64>,
    pub error: f64,
}

impl Poses {
    /// Finds the poses of a mesh of a document: `count` extremes of its animations, and its morph targets.
    pub fn new(document: &GltfDocument, index: usize, mesh: &Mesh, count: usize) -> Result<Self, Failure> {
        if count == 0 {
            return Ok(Self::default());
        }
        let frames = document.poses(index, FRAMES).map_err(Failure::input)?;
        let mut targets = document.target_poses(index);
        targets.truncate(MOST_TARGETS);
        Ok(Self { extremes: GltfDocument::extreme_poses(&frames, mesh, count), targets })
    }

    /// Adds the displacements of the poses to a mesh, and to the attributes that count.
    pub fn added_to(
        &self,
        mesh: Mesh,
        weights: &AttributeWeights,
    ) -> Result<(Mesh, AttributeWeights), Failure> {
        let mesh = GltfDocument::with_poses(&mesh, &self.extremes).map_err(Failure::input)?;
        let mut weights = weights.clone();
        let weight = 1.0 / mesh.diagonal();
        if let (AttributeWeights::Chosen(list), true) = (&mut weights, weight.is_finite()) {
            let sets = mesh.attributes().iter().map(Attribute::name);
            let sets = sets.filter(|name| names::is_set_of(name, names::DISPLACEMENT));
            let new = sets.filter(|name| list.iter().all(|(chosen, _)| chosen != name));
            let new: Vec<_> = new.map(|name| (name.to_owned(), weight.min(1e6) as f32)).collect();
            list.extend(new);
        }
        Ok((mesh, weights))
    }

    /// Measures a level of a mesh in all poses, by samples both ways.
    pub fn errors(&self, mesh: &Mesh, level: &Mesh) -> Vec<PoseError> {
        let options = DistanceOptions::default().with_samples(SAMPLES);
        let one = |pose: &GltfPose| {
            let [from, to] = [mesh, level].map(|mesh| Mesh::new(pose.positions(mesh), mesh.triangles()).ok());
            let error = distance(&from?, &to?, &options).ok()?.hausdorff();
            Some(PoseError { name: pose.name().to_owned(), time: pose.time(), error })
        };
        self.extremes.iter().chain(&self.targets).filter_map(one).collect()
    }
}

impl PoseError {
    /// Describes the error, for JSON. `scale`: of the mesh in the scene.
    pub fn json(&self, scale: f64) -> Value {
        json!({ "name": self.name, "time": self.time, "error": self.error * scale })
    }
}
