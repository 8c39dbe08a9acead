//! No document does harm: not its numbers, not its bytes, not the files that it names.

use std::path::PathBuf;

use multires::io::{self, Format, GltfDocument, GltfLevels, ReadOptions};
use multires::mesh::{Mesh, shapes};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::gltf_samples;

/// Takes a document through everything; returns without a word if it is refused.
fn exercise(bytes: &[u8]) {
    let _ = io::read_bytes(Format::Glb, bytes);
    let Ok(mut document) = GltfDocument::from_bytes(bytes) else { return };
    let _ = document.to_glb();
    for i in 0..document.mesh_count().min(4) {
        let scale = document.mesh_scale(i);
        assert!(scale > 0.0 && scale.is_finite());
        let poses = document.poses(i, 3).unwrap_or_default();
        let Ok(Some(imported)) = document.mesh(i) else { continue };
        let mesh = imported.mesh;
        for pose in poses.iter().chain(&document.target_poses(i)).take(8) {
            assert_eq!(pose.positions(&mesh).len(), mesh.positions().len());
        }
        GltfDocument::extreme_poses(&poses, &mesh, 2);
        let _ = document.add_level(i, &mesh, 0.5);
        let _ = document.replace(i, &mesh);
    }
    document.link_levels(GltfLevels::MsftLod);
    if let Ok(written) = document.to_glb() {
        GltfDocument::from_bytes(&written).expect("what is written is read");
        // Nothing is stored twice: levels and meshes of their own, padding, text.
        assert!(written.len() < 16 * bytes.len() + (1 << 16), "{} bytes of {}", written.len(), bytes.len());
    }
}

/// Puts a number in the place of another somewhere in a document.
pub fn renumber(json: &mut Value, place: &mut usize, number: &Value) {
    match json {
        Value::Number(_) => {
            if *place == 0 {
                *json = number.clone();
            }
            *place = place.wrapping_sub(1);
        }
        Value::Array(list) => list.iter_mut().for_each(|value| renumber(value, place, number)),
        Value::Object(members) => members.values_mut().for_each(|value| renumber(value, place, number)),
        _ => {}
    }
}

pub fn numbers(json: &Value) -> usize {
    match json {
        Value::Number(_) => 1,
        Value::Array(list) => list.iter().map(numbers).sum(),
        Value::Object(members) => members.values().map(numbers).sum(),
        _ => 0,
    }
}

#[test]
fn every_number_may_be_wrong() {
    let wrong =
        [json!(0), json!(1), json!(7), json!(255), json!(u32::MAX), json!(u64::MAX), json!(-1), json!(1e300)];
    for mut sample in gltf_samples::all() {
        let whole = sample.json.clone();
        for place in 0..numbers(&whole) {
            // A few numbers at each place, others at the next.
            for number in wrong.iter().skip(place % 4).step_by(4) {
                sample.json = whole.clone();
                renumber(&mut sample.json, &mut place.clone(), number);
                exercise(&sample.glb());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_may_be_wrong(kind in 0..20usize, changes in prop::collection::vec((any::<u32>(), any::<u8>()), 1..6), cut in any::<u32>()) {
        let mut bytes = gltf_samples::all()[kind].glb();
        for (place, byte) in changes {
            let place = place as usize % bytes.len();
            bytes[place] = byte;
        }
        if cut % 4 == 0 {
            bytes.truncate(cut as usize % bytes.len());
        }
        exercise(&bytes);
    }
}

#[test]
fn small_files_cost_little() {
    // 10,000 nodes that show a mesh of 3 vertices with 40 attributes.
    let mut attributes = json!({ "POSITION": 0 });
    (0..40).for_each(|i| attributes[format!("_A{i}")] = json!(1));
    let nodes: Vec<Value> = (0..10_000).map(|_| json!({ "mesh": 0 })).collect();
    let attacks = [
        json!({ "asset": { "version": "2.0" }, "nodes": nodes, "meshes": [{ "primitives": [{ "attributes": attributes }] }],
            "accessors": [{ "componentType": 5126, "count": 30_000, "type": "VEC3" }, { "componentType": 5126, "count": 30_000, "type": "VEC4" }] }),
        // A thousand primitives that read the same million zeros.
        json!({ "asset": { "version": "2.0" },
            "meshes": [{ "primitives": (0..1000).map(|i| json!({ "attributes": { "POSITION": 0 }, "material": i })).collect::<Vec<_>>() }],
            "materials": vec![json!({}); 1000],
            "accessors": [{ "componentType": 5126, "count": 1_048_576, "type": "VEC3" }] }),
        // A million instances.
        json!({ "asset": { "version": "2.0" }, "extensionsUsed": ["EXT_mesh_gpu_instancing"],
            "nodes": (0..100).map(|_| json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 0 } } } })).collect::<Vec<_>>(),
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "accessors": [{ "componentType": 5126, "count": 1_048_576, "type": "VEC3" }] }),
    ];
    for attack in attacks {
        let error = io::read_bytes(Format::Gltf, attack.to_string().as_bytes()).unwrap_err().to_string();
        assert!(error.contains("too large"), "{error}");
    }
}

#[test]
fn files_beside_a_document_are_regular_files() {
    let folder = std::env::temp_dir().join(format!("multires-hostile-gltf-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    let at = |uri: &str, length: u64| -> PathBuf {
        let path = folder.join("scene.gltf");
        let json =
            json!({ "asset": { "version": "2.0" }, "buffers": [{ "uri": uri, "byteLength": length }] });
        std::fs::write(&path, json.to_string()).unwrap();
        path
    };
    let refused = |uri: &str, length: u64, words: &str| {
        let path = at(uri, length);
        for error in [io::read(&path).unwrap_err(), GltfDocument::read(&path).unwrap_err()] {
            let error = error.to_string();
            assert!(
                error.contains(words) && !error.contains('\n'),
                "{uri:?}: {error:?} where {words:?} was expected"
            );
        }
    };
    refused("", 4, "which is no file beside the document");
    refused(".", 4, "which is no file beside the document");
    refused("../x.bin", 4, "which is no file beside the document");
    refused("/dev/zero", 4, "which is no file beside the document");
    refused("sub", 4, "no regular file");
    std::fs::write(folder.join("small.bin"), [0; 4]).unwrap();
    refused("small.bin", 8, "buffer 0 says 8 bytes, 4 are there");
    refused("small.bin", 1 << 40, "too large");
    #[cfg(unix)]
    {
        let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status();
        if made.is_ok_and(|status| status.success()) {
            refused("pipe", 4, "no regular file");
        }
        std::os::unix::fs::symlink("/dev/zero", folder.join("link")).unwrap();
        refused("link", 4, "no regular file");
        // A file of ten terabytes without a byte.
        let sparse = std::fs::File::create(folder.join("sparse.bin")).unwrap();
        if sparse.set_len(10 << 40).is_ok() {
            refused("sparse.bin", 10 << 40, "too large");
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn vertices_without_triangles_come_back() {
    let points = Mesh::new(shapes::icosphere(1).positions(), Vec::<[u32; 3]>::new()).unwrap();
    for format in [Format::Glb, Format::Gltf] {
        let bytes = io::write_bytes(format, &points).unwrap();
        let back = io::read_bytes_with(format, &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(back.mesh.positions(), points.positions());
        assert!(back.mesh.triangles().is_empty() && back.notes.is_empty(), "{:?}", back.notes);
    }
}
