//! What other programs write is read as they mean it, or refused by name.

use multires::io::{self, Format, GltfDocument};
use multires::mesh::{Mesh, names};

use crate::{gltf_samples, models};

fn sample(name: &str) -> Vec<u8> {
    gltf_samples::all().iter().find(|s| s.name == name).unwrap().glb()
}

fn read(bytes: &[u8]) -> Mesh {
    io::read_bytes(Format::Glb, bytes).unwrap()
}

#[test]
fn instances_are_all_shown() {
    let one = read(&sample("plain"));
    let three = read(&sample("instances"));
    assert_eq!(three.triangles().len(), 3 * one.triangles().len());
    let [low, high] = three.bounds().unwrap();
    assert!((high[0] - low[0] - 12.3).abs() < 0.1, "{low:?} {high:?}");
}

#[test]
fn a_skinned_mesh_ignores_the_transform_of_its_node() {
    let mesh = read(&gltf_samples::skinned().glb());
    assert!(mesh.diagonal() < 20.0, "{}", mesh.diagonal());
}

#[test]
fn missing_attributes_are_made_up_as_people_expect() {
    let mesh = read(&sample("mixed attributes"));
    let values = |name: &str| mesh.attribute(name).unwrap().as_floats().unwrap().to_vec();
    let normals = values(names::NORMAL);
    for (v, n) in normals.chunks_exact(3).enumerate() {
        let length = n.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-3, "vertex {v}: {n:?}");
    }
    // The half with colours comes second; the first is white.
    let colours = values(names::COLOR);
    let white = colours.chunks_exact(3).filter(|c| *c == [1.0; 3]).count();
    assert_eq!(white, mesh.positions().len() / 2);
}

#[test]
fn tangents_that_some_lack_are_left_out_with_a_word() {
    let mut sample = gltf_samples::all().into_iter().find(|s| s.name.starts_with("two sets of tex")).unwrap();
    let mut second = sample.json["meshes"][0]["primitives"][0].clone();
    second["attributes"].as_object_mut().unwrap().remove("TANGENT");
    sample.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let imported = io::read_bytes_with(Format::Glb, &sample.glb(), &io::ReadOptions::default()).unwrap();
    assert!(imported.mesh.attribute(names::TANGENT).is_none());
    assert!(imported.notes.iter().any(|note| note.contains("no tangents")), "{:?}", imported.notes);
}

#[test]
fn normals_that_are_none_are_mended_with_a_word() {
    let mut sample = gltf_samples::all().swap_remove(0);
    // Behind the positions.
    let start = sample.json["bufferViews"][1]["byteOffset"].as_u64().unwrap() as usize;
    for (row, value) in [(3, f32::NAN), (4, 0.0), (5, 30.0)] {
        for i in 0..3 {
            sample.buffer[start + 12 * row + 4 * i..][..4].copy_from_slice(&value.to_le_bytes());
        }
    }
    let imported = io::read_bytes_with(Format::Glb, &sample.glb(), &io::ReadOptions::default()).unwrap();
    let normals = imported.mesh.attribute(names::NORMAL).unwrap().as_floats().unwrap();
    for (v, n) in normals.chunks_exact(3).enumerate() {
        let length = n.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-3 || (v == 5 && *n == [30.0; 3]), "{n:?}");
    }
    for words in ["2 normals are no directions", "1 normals are not of length 1"] {
        assert!(imported.notes.iter().any(|note| note.contains(words)), "{words}: {:?}", imported.notes);
    }
}

#[test]
fn unknown_required_extensions_are_refused_by_name() {
    for name in ["ACME_surfaces", "KHR_gaussian_splatting"] {
        let mut sample = gltf_samples::all().swap_remove(0);
        sample.json["extensionsUsed"] = serde_json::json!([name]);
        sample.json["extensionsRequired"] = serde_json::json!([name]);
        let bytes = sample.glb();
        for error in [io::read_bytes(Format::Glb, &bytes).err(), GltfDocument::from_bytes(&bytes).err()] {
            let error = error.unwrap().to_string();
            assert!(error.contains(name) && !error.contains('\n'), "{error}");
        }
    }
}

#[test]
fn cases_of_other_programs() {
    let Some(root) = models::all("cases_of_other_programs") else { return };
    let root = root.join("cases");
    let read = |name: &str| io::read(root.join(name));
    let one = read("gltf_gpu_instancing/five.glb").unwrap();
    assert_eq!(one.triangles().len() % 5, 0);
    let error = read("gltf_unknown_required/acme.glb").unwrap_err().to_string();
    assert!(error.contains("ACME"), "{error}");
    assert!(read("gltf_rigged/rigged.glb").unwrap().diagonal() < 10.0);
    for name in [
        "sparse_zero/sparse_all",
        "sparse_zero/sparse_long",
        "modes/modes",
        "scenes/two",
        "meshopt_fallback/optional",
    ] {
        assert!(!read(&format!("gltf_{name}.glb")).unwrap().triangles().is_empty(), "{name}");
    }
    let mixed = read("gltf_mixed_attributes/mixed.glb").unwrap();
    let normals = mixed.attribute(names::NORMAL).unwrap().as_floats().unwrap();
    assert!(normals.chunks_exact(3).all(|n| n.iter().map(|x| x * x).sum::<f32>() > 0.5));
}
