//! Nodes and their world transforms (glTF 2.0, 3.5): the meshes shown by a scene, and their placement.
//!
//! The walk uses an explicit stack, so no depth overflows. A node has at most one parent, so a second visit is an
//! error.

use glam::{DMat4, DQuat, DVec3};

use super::document::{Document, Node};
use crate::io::error::ReadError;

/// A mesh shown by a node.
pub(super) struct Instance {
    pub mesh: usize,
    pub world: DMat4,
}

/// Returns the meshes of the default scene, else of the first scene, else of all nodes without a parent. Order: depth
/// first, as in the document. A document without nodes shows each mesh once.
pub(super) fn instances(document: &Document) -> Result<Vec<Instance>, ReadError> {
    let (nodes, meshes) = (document.nodes.len(), document.meshes.len());
    if nodes == 0 {
        return Ok((0..meshes).map(|mesh| Instance { mesh, world: DMat4::IDENTITY }).collect());
    }
    let roots = roots(document)?;
    let mut stack: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|n| (n, DMat4::IDENTITY)).collect();
    let mut visited = vec![false; nodes];
    let mut found = Vec::new();
    while let Some((n, parent)) = stack.pop() {
        let node = document.nodes.get(n);
        let node =
            node.ok_or_else(|| ReadError::invalid(format!("node {n} is named, but there are {nodes}")))?;
        if std::mem::replace(&mut visited[n], true) {
            return Err(ReadError::invalid(format!("node {n} has two parents or is its own ancestor")));
        }
        let world = parent * local(node);
        if let Some(mesh) = node.mesh {
            if mesh >= meshes {
                return Err(ReadError::invalid(format!(
                    "node {n} names mesh {mesh}, but there are {meshes}"
                )));
            }
            found.push(Instance { mesh, world });
        }
        stack.extend(node.children.iter().rev().map(|&child| (child, world)));
    }
    match visited.iter().position(|v| !v) {
        Some(n) if document.scenes.is_empty() => {
            Err(ReadError::invalid(format!("node {n} is its own ancestor")))
        }
        _ => Ok(found),
    }
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

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let length = rotation.length();
    let rotation = if length > 0.0 { rotation * (1.0 / length) } else { DQuat::IDENTITY };
    let (scale, translation) = (node.scale.unwrap_or([1.0; 3]), node.translation.unwrap_or([0.0; 3]));
    DMat4::from_scale_rotation_translation(DVec3::from_array(scale), rotation, DVec3::from_array(translation))
}
