//! [`GltfPose`]: a mesh bent by its skin and morph targets; the poses that bend it most.

use glam::{DMat4, DVec3, DVec4};

use crate::error::MeshError;
use crate::io::error::ReadError;
use crate::mesh::{Attribute, AttributeValues, Mesh, names};

use super::gltf_document::GltfDocument;
use super::rig::{Curves, Posture};

/// Most frames looked at.
const MOST_FRAMES: usize = 480;

/// Number of the first set of displacements of poses: beyond the morph targets of any file.
const FIRST_POSE: usize = 1_000_000;

/// Most vertices by which poses are compared.
const COMPARED: usize = 256;

/// A mesh at a moment of an animation, or with a morph target at its full weight.
#[derive(Debug, Clone, PartialEq)]
pub struct GltfPose {
    name: String,
    time: Option<f64>,
    /// From the mesh to the pose, scaled back to the units of the mesh; empty without a skin.
    joints: Vec<DMat4>,
    /// Weights of morph targets; missing ones are 0.
    weights: Vec<f64>,
}

impl GltfPose {
    /// Returns the name of the animation or of the morph target.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the time in the animation, seconds; `None` for morph targets.
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// Returns the positions of a mesh of the document, or of a level of it, in this pose: offsets of morph targets, then
    /// joints (`joints`, `weights` and their further sets). Units are those of the mesh. O(vertices).
    pub fn positions(&self, mesh: &Mesh) -> Vec<[f32; 3]> {
        let bent = Bent::new(self, mesh);
        (0..mesh.positions().len()).map(|v| bent.at(v).as_vec3().to_array()).collect()
    }
}

/// What bends a mesh.
struct Bent<'a> {
    mesh: &'a Mesh,
    joints: &'a [DMat4],
    /// Sets of joints and weights, 4 a vertex.
    sets: Vec<(&'a [u32], &'a [f32])>,
    /// Offsets and their weights.
    targets: Vec<(&'a [f32], f64)>,
}

impl<'a> Bent<'a> {
    fn new(pose: &'a GltfPose, mesh: &'a Mesh) -> Self {
        let numbered =
            |first: &str, set: usize| if set == 0 { first.to_owned() } else { format!("{first}{set}") };
        let set = |set: usize| {
            let [joints, weights] =
                [names::JOINTS, names::WEIGHTS].map(|name| mesh.attribute(&numbered(name, set)));
            let AttributeValues::Uint(joints) = joints.filter(|a| a.width() == 4)?.values() else {
                return None;
            };
            Some((&joints[..], weights.filter(|a| a.width() == 4)?.as_floats()?))
        };
        let sets = (0..).map_while(set).filter(|_| !pose.joints.is_empty()).collect();
        let targets = pose.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        let targets = targets.filter_map(|(t, &weight)| {
            let offsets = mesh.attribute(&numbered(names::DISPLACEMENT, t)).filter(|a| a.width() == 3)?;
            Some((offsets.as_floats()?, weight))
        });
        Self { mesh, joints: &pose.joints, sets, targets: targets.collect() }
    }

    fn at(&self, v: usize) -> DVec3 {
        let mut position = DVec3::from_array(self.mesh.positions()[v].map(f64::from));
        for (offsets, weight) in &self.targets {
            let [x, y, z] = [0, 1, 2].map(|i| f64::from(offsets[3 * v + i]));
            position += *weight * DVec3::new(x, y, z);
        }
        let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
        for (joints, weights) in &self.sets {
            for (&joint, &weight) in joints[4 * v..4 * v + 4].iter().zip(&weights[4 * v..4 * v + 4]) {
                let Some(matrix) = self.joints.get(joint as usize).filter(|_| weight > 0.0) else { continue };
                sum += f64::from(weight) * matrix.transform_point3(position);
                whole += f64::from(weight);
            }
        }
        if whole > 0.0 { sum / whole } else { position }
    }
}

impl GltfDocument {
    /// Returns a mesh at `frames` even moments of each animation, first and last among them. None if no skinned node and no
    /// morph weights show the mesh, or without animations. At most 480 poses: with many animations fewer frames of each.
    ///
    /// # Errors
    /// A damaged accessor of inverse bind matrices.
    pub fn poses(&self, mesh: usize, frames: usize) -> Result<Vec<GltfPose>, ReadError> {
        let store = self.store();
        let document = &self.document;
        let targets = self.target_poses(mesh).len();
        let bends = |n: &usize| {
            let node = &document.nodes[*n];
            node.mesh == Some(mesh) && (targets > 0 || node.skin.is_some_and(|s| s < self.rig.skins.len()))
        };
        let Some(node) = (0..document.nodes.len()).find(bends) else { return Ok(Vec::new()) };
        let skin = document.nodes[node].skin;
        let at = |posture: &Posture| skin.map_or(Vec::new(), |skin| self.rig.joints(skin, posture));
        // Lengths are compared with those of the mesh.
        let unit = 1.0 / self.mesh_scale(mesh);
        let mut curves = Curves::default();
        let animations = self.rig.animations.len().min(MOST_FRAMES / 2);
        let frames = frames.min(MOST_FRAMES / animations.max(1)).max(1);
        let mut poses = Vec::new();
        for animation in 0..animations {
            let Some([first, last]) = self.rig.duration(&store, animation, &mut curves) else { continue };
            for frame in 0..frames {
                let time = first + (last - first) * frame as f64 / (frames - 1).max(1) as f64;
                let mut posture = self.rig.at(&store, animation, time, &mut curves);
                let joints = at(&posture).into_iter().map(|m| DMat4::from_scale(DVec3::splat(unit)) * m);
                poses.push(GltfPose {
                    name: self.rig.animations[animation].name.clone(),
                    time: Some(time),
                    joints: joints.collect(),
                    weights: posture.weights.remove(&node).unwrap_or_default(),
                });
            }
        }
        Ok(poses)
    }

    /// Returns a pose for each morph target of a mesh, at weight 1.
    pub fn target_poses(&self, mesh: usize) -> Vec<GltfPose> {
        let json = self.mesh_value(mesh);
        let primitives = super::sections::elements(json.get("primitives"));
        let count = primitives.iter().map(|p| super::sections::elements(p.get("targets")).len()).max();
        let names =
            super::sections::elements(json.get("extras").and_then(|extras| extras.get("targetNames")));
        let pose = |target: usize| {
            let name = names.get(target).and_then(|name| name.as_str());
            let mut weights = vec![0.0; target + 1];
            weights[target] = 1.0;
            let name = name.map_or_else(|| format!("target {target}"), str::to_owned);
            GltfPose { name, time: None, joints: Vec::new(), weights }
        };
        (0..count.unwrap_or(0)).map(pose).collect()
    }
}

/// Returns the places in `poses` of the `count` poses that differ most from the mesh and from each other, but for motions
/// as a whole: the farthest first, then each time the one farthest from all that are chosen. Poses that bend the mesh by less
/// than 1 / 1000 of its diagonal are left out.
pub(super) fn extremes(poses: &[GltfPose], mesh: &Mesh, count: usize) -> Vec<usize> {
    let vertices = mesh.positions().len();
    let step = vertices.div_ceil(COMPARED).max(1);
    let at = |v: usize| DVec3::from_array(mesh.positions()[v].map(f64::from));
    let compared: Vec<usize> = (0..vertices).step_by(step).filter(|&v| at(v).is_finite()).collect();
    let rest: Vec<DVec3> = compared.iter().map(|&v| at(v)).collect();
    let bends: Vec<Vec<DVec3>> = poses
        .iter()
        .map(|pose| {
            let bent = Bent::new(pose, mesh);
            let there: Vec<DVec3> = compared.iter().map(|&v| bent.at(v)).collect();
            bend(&rest, &there)
        })
        .collect();
    // Root mean square of the differences.
    let apart = |a: &[DVec3], b: &[DVec3]| {
        let sum: f64 = a.iter().zip(b).map(|(a, b)| (*a - *b).length_squared()).sum();
        (sum / a.len().max(1) as f64).sqrt()
    };
    let least = mesh.diagonal() / 1000.0;
    let zero = vec![DVec3::ZERO; rest.len()];
    let mut nearest: Vec<f64> = bends.iter().map(|bend| apart(bend, &zero)).collect();
    let mut chosen = Vec::new();
    while chosen.len() < count {
        let farthest = (0..poses.len()).fold(None, |most: Option<usize>, i| match most {
            Some(most) if nearest[most] >= nearest[i] => Some(most),
            _ => Some(i),
        });
        // False for NaN.
        let Some(farthest) = farthest.filter(|&i| nearest[i] > least) else { break };
        chosen.push(farthest);
        for (i, bend) in bends.iter().enumerate() {
            nearest[i] = nearest[i].min(apart(bend, &bends[farthest]));
        }
    }
    chosen
}

/// Returns where points are beyond the affine map that takes `from` to `to` best.
fn bend(from: &[DVec3], to: &[DVec3]) -> Vec<DVec3> {
    let mut square = DMat4::ZERO;
    let mut product = DMat4::ZERO;
    for (p, q) in from.iter().zip(to) {
        let (p, q) = (p.extend(1.0), q.extend(1.0));
        let outer = |a: DVec4| DMat4::from_cols(a * p.x, a * p.y, a * p.z, a * p.w);
        square += outer(p);
        product += outer(q);
    }
    // Flat meshes too have an inverse then.
    let slack = 1e-9 * (square.x_axis.x + square.y_axis.y + square.z_axis.z + square.w_axis.w);
    square += DMat4::from_diagonal(DVec4::splat(slack));
    let map = product * square.inverse();
    from.iter().zip(to).map(|(p, q)| *q - (map * p.extend(1.0)).truncate()).collect()
}

impl GltfDocument {
    /// Returns a mesh with the offsets to poses as further sets of [`names::DISPLACEMENT`]: simplified with customary attribute
    /// weights, it keeps its shape in all of them (Mohr and Gleicher 2003). [`replace`](Self::replace) leaves the sets out again.
    ///
    /// # Errors
    /// A mesh with such sets of poses already.
    pub fn with_poses(mesh: &Mesh, poses: &[GltfPose]) -> Result<Mesh, MeshError> {
        let mut with = mesh.clone();
        for (i, pose) in poses.iter().enumerate() {
            let to = pose.positions(mesh);
            let offset = |(to, from): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|i| to[i] - from[i]);
            let offsets = to.iter().zip(mesh.positions()).flat_map(offset).collect();
            let name = format!("{}{}", names::DISPLACEMENT, FIRST_POSE + i);
            with = with.with_attribute(Attribute::new(name, 3, AttributeValues::Float(offsets)))?;
        }
        Ok(with)
    }

    /// Returns the poses among `poses` that bend a mesh most and differ most from each other, at most `count`; the farthest
    /// first. Motions of the mesh as a whole do not count. O(poses * count).
    pub fn extreme_poses(poses: &[GltfPose], mesh: &Mesh, count: usize) -> Vec<GltfPose> {
        extremes(poses, mesh, count).into_iter().map(|i| poses[i].clone()).collect()
    }
}
