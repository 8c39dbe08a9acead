//! Levels of detail within a document.

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

    /// Ties all levels added so far to the nodes that show their meshes, once. Nodes of levels have the transform, the skin and
    /// the morph weights of their node.
    pub fn link_levels(&mut self, how: GltfLevels) {
        let own = self.mesh_count();
        let mut nodes = self.sections.array("nodes");
        let mut beside: Vec<(usize, Vec<usize>)> = Vec::new();
        for n in 0..nodes.len() {
            let mut node = value(&nodes[n]);
            let Some(mesh) = index(node.get("mesh")) else { continue };
            let levels = self.added.iter().enumerate().filter(|(_, added)| added.of == mesh);
            let levels: Vec<(usize, usize)> = levels.map(|(i, added)| (own + i, added.level)).collect();
            if levels.is_empty() {
                continue;
            }
            let name = node.get("name").and_then(Value::as_str).map(str::to_owned);
            let name = name.unwrap_or_else(|| format!("node {n}"));
            let mut ids = Vec::new();
            for &(mesh, level) in &levels {
                let mut copy = node.clone();
                if let Some(members) = copy.as_object_mut() {
                    ["children", "camera", "extensions"].iter().for_each(|key| {
                        members.remove(*key);
                    });
                }
                copy["name"] = json!(format!("{name}_LOD{level}"));
                copy["mesh"] = json!(mesh);
                ids.push(nodes.len());
                nodes.push(raw(&copy));
            }
            match how {
                GltfLevels::MsftLod => {
                    node["extensions"]["MSFT_lod"] = json!({ "ids": ids });
                    // The least coverage of each level: where the next one takes over.
                    let next = self.added.iter().filter(|added| added.of == mesh).map(|added| added.coverage);
                    let coverages: Vec<f64> = next.chain([0.0]).collect();
                    if node.get("extras").is_none_or(Value::is_object) {
                        node["extras"]["MSFT_screencoverage"] = json!(coverages);
                    }
                }
                GltfLevels::Names => {
                    node["name"] = json!(format!("{name}_LOD0"));
                    beside.push((n, ids));
                }
            }
            nodes[n] = raw(&node);
        }
        if how == GltfLevels::Names {
            self.place_beside(&mut nodes, &beside);
        }
        self.sections.set_array("nodes", &nodes);
        if how == GltfLevels::MsftLod {
            let mut used = self.sections.strings("extensionsUsed");
            if !used.iter().any(|name| name == "MSFT_lod") {
                used.push("MSFT_lod".to_owned());
                self.sections.set_strings("extensionsUsed", &used);
            }
        }
    }

    /// Adds nodes to the parent, or to the scenes, of the node they belong to.
    fn place_beside(&mut self, nodes: &mut Elements, beside: &[(usize, Vec<usize>)]) {
        let mut parents = vec![None; nodes.len()];
        for (n, node) in self.document.nodes.iter().enumerate() {
            for &child in &node.children {
                if let Some(parent) = parents.get_mut(child) {
                    *parent = Some(n);
                }
            }
        }
        let mut scenes = self.sections.array("scenes");
        for (n, ids) in beside {
            let append = |list: &Value| {
                let mut list = elements(Some(list)).to_vec();
                list.extend(ids.iter().map(|&id| json!(id)));
                Value::from(list)
            };
            match parents[*n] {
                Some(parent) => {
                    let mut json = value(&nodes[parent]);
                    json["children"] = append(&json["children"]);
                    nodes[parent] = raw(&json);
                }
                None => {
                    for scene in &mut scenes {
                        let mut json = value(scene);
                        if elements(json.get("nodes")).iter().any(|root| index(Some(root)) == Some(*n)) {
                            json["nodes"] = append(&json["nodes"]);
                            *scene = raw(&json);
                        }
                    }
                }
            }
        }
        if !scenes.is_empty() {
            self.sections.set_array("scenes", &scenes);
        }
    }
}
