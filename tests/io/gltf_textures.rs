//! Promise: a glTF file refers to pictures as the format asks for, and is read as without them.
#![cfg(feature = "io")]

use std::sync::atomic::{AtomicUsize, Ordering};

use multires::io::{self, GltfTextures, WriteError};
use multires::mesh::{Mesh, shapes};
use serde_json::{Value, json};

fn document(mesh: &Mesh, textures: &GltfTextures) -> Value {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let number = FILES.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("multires-{}-textured-{number}.gltf", std::process::id()));
    io::write_textured(&path, mesh, textures).unwrap();
    let document = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(io::read(&path).unwrap().triangles().len(), mesh.triangles().len());
    std::fs::remove_file(&path).unwrap();
    document
}

#[test]
fn materials_refer_to_the_pictures() {
    let both = GltfTextures::default().with_base_colour("pictures/base colour%.png").with_normal("ü.png");
    // Two materials, and none.
    let sphere = shapes::uv_sphere(8, 4);
    assert!(sphere.materials().is_empty());
    for (mesh, materials) in [(shapes::prop(8), 2), (sphere, 1)] {
        let document = document(&mesh, &both);
        assert_eq!(
            document["images"],
            json!([{ "uri": "pictures/base%20colour%25.png" }, { "uri": "%C3%BC.png" }])
        );
        let texture = |i: u32| json!({ "sampler": 0, "source": i });
        assert_eq!(document["textures"], json!([texture(0), texture(1)]));
        assert_eq!(document["samplers"].as_array().unwrap().len(), 1);
        let all = document["materials"].as_array().unwrap();
        assert_eq!(all.len(), materials);
        for material in all {
            assert_eq!(material["pbrMetallicRoughness"]["baseColorTexture"], json!({ "index": 0 }));
            assert_eq!(material["pbrMetallicRoughness"]["metallicFactor"], json!(0.0));
            assert_eq!(material["normalTexture"], json!({ "index": 1 }));
        }
        for primitive in document["meshes"][0]["primitives"].as_array().unwrap() {
            assert!((primitive["material"].as_u64().unwrap() as usize) < materials);
            assert!(primitive["attributes"]["TEXCOORD_0"].is_u64());
        }
    }
    // One picture alone.
    let normal = document(&shapes::uv_sphere(8, 4), &GltfTextures::default().with_normal("n.png"));
    assert_eq!(normal["materials"][0]["normalTexture"], json!({ "index": 0 }));
    assert!(normal["materials"][0]["pbrMetallicRoughness"].get("baseColorTexture").is_none());
}

#[test]
fn nothing_is_added_without_pictures() {
    let mesh = shapes::uv_sphere(8, 4);
    let plain: Value = serde_json::from_slice(&io::write_bytes(io::Format::Gltf, &mesh).unwrap()).unwrap();
    assert_eq!(document(&mesh, &GltfTextures::default()), plain);
    assert!(plain.get("images").is_none() && plain.get("materials").is_none());
}

#[test]
fn pictures_need_coordinates_and_a_format_that_has_them() {
    let normal = GltfTextures::default().with_normal("n.png");
    let path = std::env::temp_dir().join(format!("multires-{}-refused", std::process::id()));
    let error = io::write_textured(path.with_extension("glb"), &shapes::icosphere(1), &normal).unwrap_err();
    assert!(error.to_string().contains("texture coordinates"), "{error}");
    let error =
        io::write_textured(path.with_extension("obj"), &shapes::uv_sphere(8, 4), &normal).unwrap_err();
    assert!(matches!(error, WriteError::UnknownFormat { .. }), "{error}");
    assert!(!path.with_extension("glb").exists() && !path.with_extension("obj").exists());
}
