//! Levels of detail within a document.

use multires::io::{GltfDocument, GltfLevels};
use multires::{Simplifier, Target};

use crate::compare::File;
use crate::{gltf_samples, validator};

/// A document with levels of a half and a fifth.
fn with_levels(bytes: &[u8], how: GltfLevels) -> GltfDocument {
    let mut document = GltfDocument::from_bytes(bytes).unwrap();
    for i in 0..document.mesh_count() {
        let Some(mesh) = document.mesh(i).unwrap().map(|m| m.mesh) else { continue };
        let sequence = Simplifier::new().target(Target::Ratio(0.2)).run(&mesh).unwrap();
        let at = |share: f64| sequence.steps_for_triangles((share * mesh.triangles().len() as f64) as usize);
        for (share, coverage) in [(0.5, 0.4), (0.2, 0.1)] {
            document.add_level(i, &sequence.extract(&mesh, at(share)), coverage).unwrap();
        }
    }
    document.link_levels(how);
    document
}

#[test]
fn levels_are_tied_to_every_node() {
    let folder = std::env::temp_dir().join(format!("multires-lods-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    for (i, sample) in gltf_samples::all().into_iter().enumerate() {
        for how in [GltfLevels::MsftLod, GltfLevels::Names] {
            let bytes = with_levels(&sample.glb(), how).to_glb().unwrap();
            let (a, b) = (File::of_glb(&sample.glb()), File::of_glb(&bytes));
            let [old, new] = [&a, &b].map(|file| file.json["nodes"].as_array().unwrap().clone());
            let shown: Vec<usize> = (0..old.len())
                .filter(|&n| {
                    let mesh = old[n]["mesh"].as_u64();
                    mesh.is_some_and(|m| a.json["meshes"][m as usize]["primitives"][0]["mode"] != 0)
                })
                .collect();
            // A node that an animation moves holds its levels as children: see below.
            let is_moved = sample.name.starts_with("interleaved");
            let nodes = old.len() + 2 * shown.len() + usize::from(is_moved);
            assert_eq!(new.len(), nodes, "{}", sample.name);
            for n in shown.into_iter().filter(|_| !is_moved) {
                assert_eq!(old[n]["mesh"], new[n]["mesh"]);
                if how == GltfLevels::MsftLod {
                    let ids = new[n]["extensions"]["MSFT_lod"]["ids"].as_array().unwrap();
                    assert_eq!(ids.len(), 2, "{}", sample.name);
                    let coverages = &new[n]["extras"]["MSFT_screencoverage"];
                    assert_eq!(*coverages, serde_json::json!([0.4, 0.1, 0.0]));
                    for id in ids {
                        let level = &new[id.as_u64().unwrap() as usize];
                        assert_eq!(level["skin"], old[n]["skin"]);
                        assert_ne!(level["mesh"], old[n]["mesh"]);
                        for place in ["matrix", "translation", "rotation", "scale"] {
                            assert_eq!(level[place], old[n][place]);
                        }
                    }
                } else {
                    assert!(new[n]["name"].as_str().unwrap().ends_with("_LOD0"));
                    let name = new[n]["name"].as_str().unwrap().replace("_LOD0", "_LOD2");
                    let level = new.iter().position(|node| node["name"] == name.as_str()).unwrap();
                    let lists = new.iter().map(|node| &node["children"]);
                    let lists = lists.chain(b.json["scenes"].as_array().unwrap().iter().map(|s| &s["nodes"]));
                    let mut both = lists.filter_map(|list| list.as_array());
                    let has = |list: &Vec<serde_json::Value>, n: usize| list.iter().any(|i| i == n);
                    assert!(both.any(|list| has(list, n) && has(list, level)), "{}", sample.name);
                }
            }
            let path = folder.join(format!("{i}-{}.glb", how == GltfLevels::Names));
            std::fs::write(&path, bytes).unwrap();
            files.push(path);
        }
    }
    let errors = validator::errors("levels_are_tied_to_every_node", &files);
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

/// The node that shows a mesh at a finer level than its copies, beneath another that an animation moves.
#[test]
fn levels_move_with_their_node() {
    let bytes = gltf_samples::all().into_iter().find(|s| s.name.starts_with("interleaved")).unwrap().glb();
    for how in [GltfLevels::MsftLod, GltfLevels::Names] {
        let file = File::of_glb(&with_levels(&bytes, how).to_glb().unwrap());
        let nodes = file.json["nodes"].as_array().unwrap();
        // The animation still moves node 0, which holds the levels.
        assert_eq!(file.json["animations"][0]["channels"][0]["target"]["node"], 0);
        assert_eq!(nodes[0].get("mesh"), None);
        let holder = nodes[0]["children"][0].as_u64().unwrap() as usize;
        assert_eq!(nodes[holder]["mesh"], 0);
        let levels = if how == GltfLevels::MsftLod {
            nodes[holder]["extensions"]["MSFT_lod"]["ids"].as_array().unwrap().len()
        } else {
            nodes[0]["children"].as_array().unwrap().len() - 1
        };
        assert_eq!(levels, 2);
    }
}

#[test]
fn morph_weights_and_instances_reach_all_levels() {
    let file = File::of_glb(
        &with_levels(&gltf_samples::morphed(false).glb(), GltfLevels::MsftLod).to_glb().unwrap(),
    );
    let channels = file.json["animations"][0]["channels"].as_array().unwrap();
    let targets: Vec<u64> = channels.iter().map(|c| c["target"]["node"].as_u64().unwrap()).collect();
    assert_eq!(targets, [0, 1, 2]);
    let instances = gltf_samples::all().into_iter().find(|s| s.name == "instances").unwrap();
    let file = File::of_glb(&with_levels(&instances.glb(), GltfLevels::MsftLod).to_glb().unwrap());
    let of = |n: usize| file.json["nodes"][n]["extensions"]["EXT_mesh_gpu_instancing"].clone();
    assert!(of(0).is_object() && of(0) == of(1) && of(1) == of(2));
}
