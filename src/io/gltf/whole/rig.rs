//! Skins and animations: where joints are at a time (glTF 2.0, 3.7.3 and 3.11).
//!
//! Read leniently: what is damaged moves nothing, since the file's animations are only looked at, and written as they were.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DQuat, DVec3};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked;
use serde_json::Value;

use crate::io::error::ReadError;
use crate::io::gltf::accessor::Store;
use crate::io::gltf::document::Document;
use crate::io::gltf::scene::{self, largest_scale};
use crate::io::gltf::semantics::attributes;

use super::sections::{Sections, elements, index, value};

/// The joints of a mesh.
#[derive(Debug, Clone)]
pub(super) struct Skin {
    pub joints: Vec<usize>,
    inverse_bind: Vec<DMat4>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    Linear,
    Step,
    CubicSpline,
}

/// A property of a node over time: accessors of times and values.
#[derive(Debug, Clone, Copy)]
struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    input: usize,
    output: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Animation {
    pub name: String,
    channels: Vec<Channel>,
}

/// Skins, animations and the tree of nodes.
#[derive(Debug, Clone, Default)]
pub(super) struct Rig {
    pub skins: Vec<Skin>,
    pub animations: Vec<Animation>,
    /// Nodes reached from roots, with their parents; parents come first.
    order: Vec<(usize, Option<usize>)>,
}

/// World transforms of all nodes, and weights of morph targets by node.
pub(super) struct Posture {
    pub worlds: Vec<DMat4>,
    pub weights: BTreeMap<usize, Vec<f64>>,
}

/// Values of accessors, loaded once.
#[derive(Default)]
pub(super) struct Curves {
    values: BTreeMap<usize, Vec<f64>>,
    /// Values loaded.
    count: usize,
}

impl Curves {
    /// Loads an accessor once. Values beyond a multiple of the file's size are not loaded.
    fn load(&mut self, store: &Store, accessor: usize) {
        if self.values.contains_key(&accessor) {
            return;
        }
        let most = (1 << 22) + 4 * store.bytes();
        let mut read = || {
            let width = store.shape(accessor)?.width;
            let length = width.saturating_mul(store.count(accessor)?);
            let work = length.saturating_add(store.replaced(accessor));
            self.count = self.count.saturating_add(work);
            if self.count > most {
                return Ok(Vec::new());
            }
            let mut values = vec![0.0; length];
            store.values(accessor, |i, component, value| values[width * i + component] = value)?;
            Ok::<_, ReadError>(values)
        };
        let values = read().unwrap_or_default();
        self.values.insert(accessor, values);
    }

    fn get(&self, accessor: usize) -> &[f64] {
        self.values.get(&accessor).map_or(&[], Vec::as_slice)
    }
}

impl Rig {
    pub fn new(store: &Store, sections: &Sections) -> Result<Self, ReadError> {
        let skin = |json: Value| {
            let joints =
                elements(json.get("joints")).iter().filter_map(|j| index(Some(j))).collect::<Vec<_>>();
            let mut inverse_bind = vec![DMat4::IDENTITY; joints.len()];
            if let Some(accessor) = index(json.get("inverseBindMatrices")) {
                let is_matrix = store.shape(accessor)?.width == 16;
                store.count(accessor)?;
                let mut columns = vec![[0.0; 16]; joints.len()];
                if is_matrix {
                    store.values(accessor, |i, component, value| {
                        if let Some(matrix) = columns.get_mut(i) {
                            matrix[component] = value;
                        }
                    })?;
                    inverse_bind = columns.iter().map(DMat4::from_cols_array).collect();
                }
            }
            Ok(Skin { joints, inverse_bind })
        };
        let skins = sections.array("skins");
        let skins = skins.iter().map(|text| skin(value(text))).collect::<Result<_, ReadError>>()?;
        let animations = sections.array("animations").iter().map(|text| animation(&value(text))).collect();
        Ok(Self { skins, animations, order: order(store.document) })
    }

    /// Returns the transforms of the document's nodes as they are stored.
    pub fn at_rest(&self, document: &Document) -> Posture {
        self.posture(document, &BTreeMap::new(), BTreeMap::new())
    }

    /// Returns the first and last time of an animation, seconds; `None` if it moves nothing.
    pub fn duration(&self, store: &Store, animation: usize, curves: &mut Curves) -> Option<[f64; 2]> {
        let channels = &self.animations.get(animation)?.channels;
        channels.iter().for_each(|c| curves.load(store, c.input));
        let ends = channels.iter().filter_map(|c| {
            let times = curves.get(c.input);
            times.first().copied().zip(times.last().copied())
        });
        let ends = ends.filter(|(first, last)| first.is_finite() && last.is_finite() && first <= last);
        ends.map(<[f64; 2]>::from).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Returns the transforms of the nodes at a time of an animation.
    pub fn at(&self, store: &Store, animation: usize, time: f64, curves: &mut Curves) -> Posture {
        let mut moved: BTreeMap<usize, Trs> = BTreeMap::new();
        let mut weights = BTreeMap::new();
        let channels = self.animations.get(animation).map_or(&[][..], |a| &a.channels);
        for channel in channels {
            curves.load(store, channel.input);
            curves.load(store, channel.output);
            let Some(node) = store.document.nodes.get(channel.node) else { continue };
            let Some(found) = sample(channel, time, curves) else { continue };
            let trs = moved.entry(channel.node).or_insert_with(|| {
                let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                Trs(node.translation.unwrap_or([0.0; 3]), rotation, node.scale.unwrap_or([1.0; 3]))
            });
            match (channel.property, found.len()) {
                (Property::Translation, 3) => trs.0.copy_from_slice(&found),
                (Property::Rotation, 4) => trs.1.copy_from_slice(&found),
                (Property::Scale, 3) => trs.2.copy_from_slice(&found),
                (Property::Weights, _) => {
                    weights.insert(channel.node, found);
                }
                _ => {}
            }
        }
        self.posture(store.document, &moved, weights)
    }

    fn posture(
        &self,
        document: &Document,
        moved: &BTreeMap<usize, Trs>,
        weights: BTreeMap<usize, Vec<f64>>,
    ) -> Posture {
        let mut worlds = vec![DMat4::IDENTITY; document.nodes.len()];
        for &(n, parent) in &self.order {
            let local = moved.get(&n).map_or_else(|| scene::local(&document.nodes[n]), Trs::matrix);
            worlds[n] = parent.map_or(local, |parent| worlds[parent] * local);
        }
        Posture { worlds, weights }
    }

    /// Returns the transforms of a skin's joints from the mesh to the world.
    pub fn joints(&self, skin: usize, posture: &Posture) -> Vec<DMat4> {
        let Some(skin) = self.skins.get(skin) else { return Vec::new() };
        let world = |joint: usize| posture.worlds.get(joint).copied().unwrap_or(DMat4::IDENTITY);
        skin.joints.iter().zip(&skin.inverse_bind).map(|(&joint, inverse)| world(joint) * *inverse).collect()
    }

    /// Returns the largest length of a unit of a mesh over the nodes that show it; 0 if none does. O(nodes + vertices).
    pub fn scale(&self, store: &Store, mesh: usize) -> f64 {
        let rest = self.at_rest(store.document);
        let mut skins = BTreeSet::new();
        let mut scale = 0.0f64;
        for (n, node) in store.document.nodes.iter().enumerate().filter(|(_, node)| node.mesh == Some(mesh)) {
            match node.skin.filter(|skin| *skin < self.skins.len()) {
                None => {
                    let instances = node.extensions.as_ref().and_then(|e| e.instancing.as_ref());
                    let most = instances.map_or(1.0, |instances| scene::largest_instance(store, instances));
                    scale = scale.max(most * largest_scale(&rest.worlds[n]));
                }
                Some(skin) => {
                    skins.insert(skin);
                }
            }
        }
        if skins.is_empty() {
            return scale;
        }
        // Skins have joints for all meshes of a figure, some of them of other scales.
        let used = used_joints(store, mesh);
        let scales = skins.iter().flat_map(|&skin| {
            let joints = self.joints(skin, &rest).into_iter().enumerate();
            joints
                .filter(|(j, _)| used.contains(j))
                .map(|(_, matrix)| largest_scale(&matrix))
                .collect::<Vec<_>>()
        });
        scales.fold(scale, f64::max)
    }
}

/// Returns the joints that move vertices of a mesh.
fn used_joints(store: &Store, mesh: usize) -> BTreeSet<usize> {
    let mut pairs = BTreeSet::new();
    for primitive in &store.document.meshes[mesh].primitives {
        for (semantic, joints) in attributes(primitive) {
            let Semantic::Joints(set) = semantic else { continue };
            let weights = primitive.attributes.get(&Checked::Valid(Semantic::Weights(*set)));
            pairs.extend(weights.map(|weights| (joints, weights.value())));
        }
    }
    let mut used = BTreeSet::new();
    let mut curves = Curves::default();
    for (joints, weights) in pairs {
        [joints, weights].iter().for_each(|&accessor| curves.load(store, accessor));
        let pairs = curves.get(joints).iter().zip(curves.get(weights));
        let mut last = f64::NAN;
        for (&joint, _) in pairs.filter(|(_, weight)| **weight > 0.0) {
            // Neighbours mostly have the same joints.
            if joint != last {
                used.insert(joint as usize);
                last = joint;
            }
        }
    }
    used
}

/// Translation, rotation and scale of a node.
struct Trs([f64; 3], [f64; 4], [f64; 3]);

impl Trs {
    fn matrix(&self) -> DMat4 {
        let rotation = scene::unit(DQuat::from_array(self.1));
        DMat4::from_scale_rotation_translation(DVec3::from_array(self.2), rotation, DVec3::from_array(self.0))
    }
}

/// Returns the nodes below roots, parents first, each once.
fn order(document: &Document) -> Vec<(usize, Option<usize>)> {
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|n| &n.children) {
        if let Some(flag) = is_child.get_mut(child) {
            *flag = true;
        }
    }
    let mut stack: Vec<(usize, Option<usize>)> =
        (0..is_child.len()).rev().filter(|&n| !is_child[n]).map(|n| (n, None)).collect();
    let mut visited = vec![false; is_child.len()];
    let mut order = Vec::with_capacity(is_child.len());
    while let Some((n, parent)) = stack.pop() {
        if n >= visited.len() || std::mem::replace(&mut visited[n], true) {
            continue;
        }
        order.push((n, parent));
        stack.extend(document.nodes[n].children.iter().rev().map(|&child| (child, Some(n))));
    }
    order
}

fn animation(json: &Value) -> Animation {
    let samplers = elements(json.get("samplers"));
    let channel = |json: &Value| {
        let target = json.get("target")?;
        let sampler = samplers.get(index(json.get("sampler"))?)?;
        Some(Channel {
            node: index(target.get("node"))?,
            property: match target.get("path")?.as_str()? {
                "translation" => Property::Translation,
                "rotation" => Property::Rotation,
                "scale" => Property::Scale,
                "weights" => Property::Weights,
                _ => return None,
            },
            interpolation: match sampler.get("interpolation").and_then(Value::as_str) {
                Some("STEP") => Interpolation::Step,
                Some("CUBICSPLINE") => Interpolation::CubicSpline,
                _ => Interpolation::Linear,
            },
            input: index(sampler.get("input"))?,
            output: index(sampler.get("output"))?,
        })
    };
    let name = json.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    Animation { name, channels: elements(json.get("channels")).iter().filter_map(channel).collect() }
}

/// Returns the value of a channel at a time; `None` if it has none.
fn sample(channel: &Channel, time: f64, curves: &Curves) -> Option<Vec<f64>> {
    let (times, values) = (curves.get(channel.input), curves.get(channel.output));
    let rows = if channel.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let width = values.len() / (rows * times.len()).max(1);
    if width == 0 || times.is_empty() {
        return None;
    }
    // Part `part` of key `key`: in-tangent, value, out-tangent of splines.
    let row = |key: usize, part: usize| &values[(rows * key + part) * width..][..width];
    let value = |key: usize| row(key, rows / 2);
    let after = times.partition_point(|&t| t <= time);
    let (Some(before), true) = (after.checked_sub(1), after < times.len()) else {
        return Some(value(if after == 0 { 0 } else { times.len() - 1 }).to_vec());
    };
    let length = times[after] - times[before];
    let share = if length > 0.0 { (time - times[before]) / length } else { 0.0 };
    let (a, b) = (value(before), value(after));
    let mixed = |wa: f64, wb: f64| a.iter().zip(b).map(|(a, b)| wa * a + wb * b).collect::<Vec<f64>>();
    Some(match channel.interpolation {
        Interpolation::Step => a.to_vec(),
        Interpolation::Linear if channel.property == Property::Rotation && width == 4 => {
            let [a, b] = [a, b].map(DQuat::from_slice);
            scene::unit(a).slerp(scene::unit(b), share).to_array().to_vec()
        }
        Interpolation::Linear => mixed(1.0 - share, share),
        Interpolation::CubicSpline => {
            let (s, s2, s3) = (share, share * share, share * share * share);
            let mut point = mixed(2.0 * s3 - 3.0 * s2 + 1.0, 3.0 * s2 - 2.0 * s3);
            let tangents = row(before, 2).iter().zip(row(after, 0));
            for (x, (out, into)) in point.iter_mut().zip(tangents) {
                *x += length * ((s3 - 2.0 * s2 + s) * out + (s3 - s2) * into);
            }
            point
        }
    })
}
