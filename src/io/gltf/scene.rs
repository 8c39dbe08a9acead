//! Nodes and their world transforms (glTF 2.0, 3.5): the meshes shown by a scene, and their placement.
//!
//! The walk uses an explicit stack, so no depth overflows. A node has at most one parent, so a second visit is an
//! error.

use glam::{DMat3, DMat4, DQuat, DVec3};

use super::accessor::Store;
use super::document::{Document, Instancing, Node};
use crate::io::error::ReadError;

/// A mesh shown by a node.
pub(super) struct Instance {
    pub mesh: usize,
    pub world: DMat4,
}

/// Returns the meshes of the default scene, else of the first scene, else of all nodes without a parent. Order: depth
/// first, as in the document. A document without nodes shows each mesh once.
///
/// The transform of a node with a skin is ignored: the joints place the mesh (glTF 2.0, 3.7.3.3). A node of
/// `EXT_mesh_gpu_instancing` shows its mesh once for each instance. `bytes`: size of the file.
pub(super) fn instances(store: &Store, bytes: usize) -> Result<Vec<Instance>, ReadError> {
    let document = store.document;
    let meshes = document.meshes.len();
    if document.nodes.is_empty() {
        return Ok((0..meshes).map(|mesh| Instance { mesh, world: DMat4::IDENTITY }).collect());
    }
    // An instance takes 144 bytes: instances from accessors without bytes of their own must not multiply the file's size.
    let mut most = (1 << 16) + (bytes + store.bytes()) / 4;
    let mut found = Vec::new();
    walk(document, roots(document)?, |n, world| {
        let node = &document.nodes[n];
        let Some(mesh) = node.mesh else { return Ok(()) };
        if mesh >= meshes {
            return Err(ReadError::invalid(format!("node {n} names mesh {mesh}, but there are {meshes}")));
        }
        let world = if node.skin.is_some() { DMat4::IDENTITY } else { world };
        let instancing = node.extensions.as_ref().and_then(|e| e.instancing.as_ref());
        let Some(instancing) = instancing else {
            found.push(Instance { mesh, world });
            return Ok(());
        };
        let locals = instanced(store, n, instancing, most)?;
        most -= locals.len().min(most);
        found.extend(locals.into_iter().map(|local| Instance { mesh, world: world * local }));
        Ok(())
    })?;
    Ok(found)
}

/// Calls `visit` with the nodes below `roots` and their world transforms, depth first.
fn walk(
    document: &Document,
    roots: Vec<usize>,
    mut visit: impl FnMut(usize, DMat4) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let nodes = document.nodes.len();
    let mut stack: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY)).collect();
    let mut visited = vec![false; nodes];
    while let Some((n, parent)) = stack.pop() {
        let node = document.nodes.get(n);
        let node =
            node.ok_or_else(|| ReadError::invalid(format!("node {n} is named, but there are {nodes}")))?;
        if std::mem::replace(&mut visited[n], true) {
            return Err(ReadError::invalid(format!("node {n} has two parents or is its own ancestor")));
        }
        let world = parent * local(node);
        visit(n, world)?;
        stack.extend(node.children.iter().rev().map(|&child| (child, world)));
    }
    match visited.iter().position(|v| !v) {
        Some(n) if document.scenes.is_empty() => {
            Err(ReadError::invalid(format!("node {n} is its own ancestor")))
        }
        _ => Ok(()),
    }
}

/// Returns the transforms of a node's instances, at most `most`.
fn instanced(store: &Store, n: usize, instancing: &Instancing, most: usize) -> Result<Vec<DMat4>, ReadError> {
    let mut count = None;
    for &accessor in instancing.attributes.values() {
        let own = store.count(accessor)?;
        if *count.get_or_insert(own) != own {
            return Err(ReadError::invalid(format!(
                "node {n} has attributes of different counts of instances"
            )));
        }
    }
    let count = count.unwrap_or(0);
    if count > most {
        return Err(ReadError::too_large("the scene shows its meshes too many times for its size"));
    }
    let column = |name: &str, width: usize, fill: f64| -> Result<Vec<f64>, ReadError> {
        let mut values = vec![fill; width * count];
        let Some(&accessor) = instancing.attributes.get(name) else { return Ok(values) };
        if store.shape(accessor)?.width != width {
            return Err(ReadError::invalid(format!("node {n} has instances with {name} of another type")));
        }
        store.values(accessor, |i, component, value| values[width * i + component] = value)?;
        Ok(values)
    };
    let translations = column("TRANSLATION", 3, 0.0)?;
    let mut rotations = column("ROTATION", 4, 0.0)?;
    if !instancing.attributes.contains_key("ROTATION") {
        rotations.chunks_exact_mut(4).for_each(|q| q[3] = 1.0);
    }
    let scales = column("SCALE", 3, 1.0)?;
    let rows = scales.chunks_exact(3).zip(rotations.chunks_exact(4)).zip(translations.chunks_exact(3));
    Ok(rows
        .map(|((s, r), t)| {
            DMat4::from_scale_rotation_translation(
                DVec3::from_slice(s),
                unit(DQuat::from_slice(r)),
                DVec3::from_slice(t),
            )
        })
        .collect())
}

/// Returns the largest scale of a node's instances; 1 if they have none.
pub(super) fn largest_instance(store: &Store, instancing: &Instancing) -> f64 {
    let Some(&accessor) = instancing.attributes.get("SCALE") else { return 1.0 };
    let mut most = 0.0f64;
    let bounded = store.count(accessor).is_ok() && store.replaced(accessor) <= store.bytes();
    let read = bounded.then(|| store.values(accessor, |_, _, value| most = most.max(value.abs())).ok());
    if read.flatten().is_some() { most } else { 1.0 }
}

fn roots(document: &Document) -> Result<Vec<usize>, ReadError> {
    let scenes = document.scenes.len();
    match (document.scene, document.scenes.first()) {
        (None, None) => {
            let mut is_child = vec![false; document.nodes.len()];
            for &child in document.nodes.iter().flat_map(|n| &n.children) {
                if let Some(flag) = is_child.get_mut(child) {
                    *flag = true;
                }
            }
            Ok((0..is_child.len()).filter(|&n| !is_child[n]).collect())
        }
        (None, Some(first)) => Ok(first.nodes.clone()),
        (Some(scene), _) => match document.scenes.get(scene) {
            Some(scene) => Ok(scene.nodes.clone()),
            None => Err(ReadError::invalid(format!("the default scene is {scene}, but there are {scenes}"))),
        },
    }
}

/// Returns the transform of a node relative to its parent.
pub(super) fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = unit(DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0])));
    let (scale, translation) = (node.scale.unwrap_or([1.0; 3]), node.translation.unwrap_or([0.0; 3]));
    DMat4::from_scale_rotation_translation(DVec3::from_array(scale), rotation, DVec3::from_array(translation))
}

/// Returns the largest length of the image of a unit vector, by squaring: the root of the largest eigenvalue.
pub(super) fn largest_scale(transform: &DMat4) -> f64 {
    let linear = DMat3::from_mat4(*transform);
    let square = linear.transpose() * linear;
    let trace = square.x_axis.x + square.y_axis.y + square.z_axis.z;
    if !trace.is_finite() || trace <= 0.0 {
        return 0.0;
    }
    let mut power = square * (1.0 / trace);
    for _ in 0..8 {
        let next = power * power;
        power = next * (1.0 / (next.x_axis.x + next.y_axis.y + next.z_axis.z));
    }
    // The trace of the square times a projector upon the largest direction.
    let along = square * power;
    (along.x_axis.x + along.y_axis.y + along.z_axis.z).sqrt()
}

/// Returns a rotation of length 1; none for a rotation of length 0.
pub(super) fn unit(rotation: DQuat) -> DQuat {
    let length = rotation.length();
    if length > 0.0 { rotation * (1.0 / length) } else { DQuat::IDENTITY }
}
