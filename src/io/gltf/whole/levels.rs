//! Levels of detail within a document: nodes beside the nodes that show a mesh.
//!
//! ```text
//!     node: mesh                               node: mesh, MSFT_lod -> copies                  or "NAME_LOD0", "NAME_LOD1" ...
//!     node: mesh, moved by an animation        node --> child: mesh, MSFT_lod -> copies        what moves the node moves all levels
//! ```

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::io::error::WriteError;
use crate::mesh::Mesh;

use super::gltf_document::{Added, GltfDocument};
use super::sections::{Elements, elements, index, raw, value};

/// How a document says that meshes are levels of detail of others.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum GltfLevels {
    /// The extension `MSFT_lod`: a node names those that stand for it from afar. Readers that do not know it draw the finest.
    #[default]
    MsftLod,
    /// Names: `NAME_LOD0`, `NAME_LOD1` and so on beside each other, as Unity, Unreal and Godot import them. Readers that do not
    /// know the names draw all levels.
    Names,
}

impl GltfDocument {
    /// Adds a level of a mesh, coarser than the mesh and all levels added before: as a mesh of its own, which
    /// [`link_levels`](Self::link_levels) ties to the nodes that show the mesh. `coverage`: share of the screen's height, 0 to
    /// 1, below which the level is drawn.
    ///
    /// # Errors
    /// Errors of [`replace`](Self::replace).
    pub fn add_level(&mut self, mesh: usize, level: &Mesh, coverage: f64) -> Result<(), WriteError> {
        let encoded = self.encode(mesh, level)?;
        let number = 1 + self.added.iter().filter(|added| added.of == mesh).count();
        self.added.push(Added { of: mesh, level: number, coverage, encoded });
        Ok(())
    }

    /// Ties all levels added so far to the nodes that show their meshes, once. Nodes of levels have the transform, the skin, the
    /// instances and the morph weights of their node, and move with it.
    pub fn link_levels(&mut self, how: GltfLevels) {
        let mut tree = Tree::new(self);
        for n in 0..tree.nodes.len() {
            let node = value(&tree.nodes[n]);
            let Some(mesh) = index(node.get("mesh")) else { continue };
            let levels = self.added.iter().enumerate().filter(|(_, added)| added.of == mesh);
            let meshes: Vec<usize> = levels.map(|(i, _)| self.mesh_count() + i).collect();
            if meshes.is_empty() {
                continue;
            }
            let name = node.get("name").and_then(Value::as_str).map(str::to_owned);
            let name = name.unwrap_or_else(|| format!("node {n}"));
            let holder = if tree.moved.contains(&n) { tree.lower(n, &name) } else { n };
            let copies: Vec<usize> =
                (1..).zip(&meshes).map(|(i, &mesh)| tree.copy(holder, mesh, &name, i)).collect();
            tree.follow_weights(n, holder, &copies);
            match how {
                GltfLevels::MsftLod => {
                    // The least coverage of each level: where the next one takes over.
                    let next = self.added.iter().filter(|added| added.of == mesh).map(|added| added.coverage);
                    let coverages: Vec<f64> = next.chain([0.0]).collect();
                    tree.edit(holder, |node| {
                        node["extensions"]["MSFT_lod"] = json!({ "ids": copies });
                        if node.get("extras").is_none_or(Value::is_object) {
                            node["extras"]["MSFT_screencoverage"] = json!(coverages);
                        }
                    });
                }
                GltfLevels::Names => {
                    tree.edit(holder, |node| node["name"] = json!(format!("{name}_LOD0")));
                    tree.place_beside(holder, &copies);
                }
            }
        }
        let Tree { nodes, scenes, animations, .. } = tree;
        for (name, list) in [("nodes", nodes), ("scenes", scenes), ("animations", animations)] {
            if !list.is_empty() {
                self.sections.set_array(name, &list);
            }
        }
        if how == GltfLevels::MsftLod && !self.added.is_empty() {
            let mut used = self.sections.strings("extensionsUsed");
            if !used.iter().any(|name| name == "MSFT_lod") {
                used.push("MSFT_lod".to_owned());
                self.sections.set_strings("extensionsUsed", &used);
            }
        }
    }
}

/// The nodes of a document, and what names them.
struct Tree {
    nodes: Elements,
    scenes: Elements,
    animations: Elements,
    parents: Vec<Option<usize>>,
    /// Nodes whose place animations move.
    moved: BTreeSet<usize>,
    /// Nodes whose morph weights animations move.
    weighed: BTreeSet<usize>,
}

impl Tree {
    fn new(document: &GltfDocument) -> Self {
        let nodes = document.sections.array("nodes");
        let mut parents = vec![None; nodes.len()];
        for (n, node) in document.document.nodes.iter().enumerate() {
            for &child in &node.children {
                if let Some(parent) = parents.get_mut(child) {
                    *parent = Some(n);
                }
            }
        }
        let animations = document.sections.array("animations");
        let (mut moved, mut weighed) = (BTreeSet::new(), BTreeSet::new());
        for animation in &animations {
            for channel in elements(value(animation).get("channels")) {
                let target = channel.get("target");
                let Some(node) = index(target.and_then(|t| t.get("node"))) else { continue };
                match target.and_then(|t| t.get("path")).and_then(Value::as_str) {
                    Some("weights") => weighed.insert(node),
                    Some(_) => moved.insert(node),
                    None => false,
                };
            }
        }
        Self { nodes, scenes: document.sections.array("scenes"), animations, parents, moved, weighed }
    }

    fn edit(&mut self, n: usize, change: impl FnOnce(&mut Value)) {
        let mut json = value(&self.nodes[n]);
        change(&mut json);
        self.nodes[n] = raw(&json);
    }

    fn push(&mut self, node: &Value, parent: Option<usize>) -> usize {
        self.nodes.push(raw(node));
        self.parents.push(parent);
        self.nodes.len() - 1
    }

    /// Moves what a node shows to a child of it; returns the child.
    fn lower(&mut self, n: usize, name: &str) -> usize {
        let mut child = json!({ "name": format!("{name} mesh") });
        let mut node = value(&self.nodes[n]);
        if let Some(members) = node.as_object_mut() {
            for key in ["mesh", "skin", "weights"] {
                if let Some(moved) = members.remove(key) {
                    child[key] = moved;
                }
            }
            let extensions = members.get_mut("extensions").and_then(Value::as_object_mut);
            if let Some(instances) = extensions.and_then(|extensions| extensions.remove(INSTANCES)) {
                child["extensions"] = json!({ INSTANCES: instances });
            }
            if members.get("extensions").and_then(Value::as_object).is_some_and(|left| left.is_empty()) {
                members.remove("extensions");
            }
        }
        let child = self.push(&child, Some(n));
        node["children"] = appended(node.get("children"), &[child]);
        self.nodes[n] = raw(&node);
        child
    }

    /// Adds a node that shows a level in the place of another.
    fn copy(&mut self, n: usize, mesh: usize, name: &str, level: usize) -> usize {
        let mut copy = value(&self.nodes[n]);
        let instances = copy.get("extensions").and_then(|extensions| extensions.get(INSTANCES)).cloned();
        if let Some(members) = copy.as_object_mut() {
            ["children", "camera", "extensions"].iter().for_each(|key| {
                members.remove(*key);
            });
        }
        if let Some(instances) = instances {
            copy["extensions"] = json!({ INSTANCES: instances });
        }
        copy["name"] = json!(format!("{name}_LOD{level}"));
        copy["mesh"] = json!(mesh);
        self.push(&copy, None)
    }

    /// Lets animations of a node's morph weights reach the node that shows the mesh now, and all levels.
    fn follow_weights(&mut self, n: usize, holder: usize, copies: &[usize]) {
        if !self.weighed.contains(&n) {
            return;
        }
        for animation in &mut self.animations {
            let mut json = value(animation);
            let mut channels = Vec::new();
            let mut is_changed = false;
            for channel in elements(json.get("channels")) {
                let target = &channel["target"];
                if index(target.get("node")) != Some(n) || target["path"] != "weights" {
                    channels.push(channel.clone());
                    continue;
                }
                for node in std::iter::once(&holder).chain(copies) {
                    let mut channel = channel.clone();
                    channel["target"]["node"] = json!(node);
                    channels.push(channel);
                }
                is_changed = true;
            }
            if is_changed {
                json["channels"] = Value::from(channels);
                *animation = raw(&json);
            }
        }
    }

    /// Adds nodes to the parent, or to the scenes, of the node they belong to.
    fn place_beside(&mut self, n: usize, copies: &[usize]) {
        copies.iter().for_each(|&copy| self.parents[copy] = self.parents[n]);
        if let Some(parent) = self.parents[n] {
            return self.edit(parent, |node| node["children"] = appended(node.get("children"), copies));
        }
        for scene in &mut self.scenes {
            let mut json = value(scene);
            if elements(json.get("nodes")).iter().any(|root| index(Some(root)) == Some(n)) {
                json["nodes"] = appended(json.get("nodes"), copies);
                *scene = raw(&json);
            }
        }
    }
}

/// Instances stay with the mesh.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";

/// Returns a list with further nodes.
fn appended(list: Option<&Value>, nodes: &[usize]) -> Value {
    let mut list = elements(list).to_vec();
    list.extend(nodes.iter().map(|&node| json!(node)));
    Value::from(list)
}
