//! Where buffers and pictures go.

use std::path::{Path, PathBuf};

use multires::io::GltfDocument;
use serde_json::{Value, json};

use crate::gltf_samples::{self, DOT};
use crate::whole::halved;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("multires-{name}-{}", std::process::id()));
        std::fs::create_dir_all(path.join("in/pictures")).unwrap();
        std::fs::create_dir_all(path.join("out")).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Writes a document with its buffer and two pictures beside it, one of them missing.
fn beside(folder: &Path) -> PathBuf {
    let sample = &gltf_samples::all()[1];
    let mut json = sample.json.clone();
    json["buffers"] = json!([{ "byteLength": sample.buffer.len(), "uri": "my%20data.bin" }]);
    json["images"] = json!([{ "uri": "pictures/my%20dot.png" }, { "uri": "gone.png" }]);
    json["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
    std::fs::write(folder.join("in/my data.bin"), &sample.buffer).unwrap();
    std::fs::write(folder.join("in/pictures/my dot.png"), DOT).unwrap();
    let path = folder.join("in/hero.gltf");
    std::fs::write(&path, json.to_string()).unwrap();
    path
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn a_gltf_refers_to_pictures_where_they_are() {
    let folder = Folder::new("pictures");
    let document = halved(&GltfDocument::read(beside(&folder.0)).unwrap());
    let out = folder.0.join("out/small hero.gltf");
    document.write(&out).unwrap();
    let written = json(&out);
    assert_eq!(written["images"][0]["uri"], "../in/pictures/my%20dot.png");
    assert_eq!(written["images"][1]["uri"], "../in/gone.png");
    assert_eq!(written["buffers"][0]["uri"], "small%20hero.bin");
    let names = std::fs::read_dir(folder.0.join("out")).unwrap().map(|e| e.unwrap().file_name());
    let mut names: Vec<_> = names.collect();
    names.sort();
    assert_eq!(names, ["small hero.bin", "small hero.gltf"]);
    let again = GltfDocument::read(&out).unwrap();
    let count = |d: &GltfDocument| d.mesh(0).unwrap().unwrap().mesh.triangles().len();
    assert!(2 * count(&again) <= count(&GltfDocument::read(folder.0.join("in/hero.gltf")).unwrap()));

    // Beside the input nothing changes, byte for byte; in its place too.
    for name in ["in/other.gltf", "in/hero.gltf"] {
        document.write(folder.0.join(name)).unwrap();
        assert_eq!(json(&folder.0.join(name))["images"][0]["uri"], "pictures/my%20dot.png");
    }
    GltfDocument::read(folder.0.join("in/hero.gltf")).unwrap();
}

#[test]
fn a_glb_has_its_pictures_within() {
    let folder = Folder::new("embedded");
    let document = halved(&GltfDocument::read(beside(&folder.0)).unwrap());
    let out = folder.0.join("out/hero.glb");
    document.write(&out).unwrap();
    let file = crate::compare::File::of_glb(&std::fs::read(&out).unwrap());
    assert_eq!(file.view(&file.json["images"][0]["bufferView"]), DOT);
    assert_eq!(file.json["images"][0]["mimeType"], "image/png");
    assert_eq!(file.json["images"][0].get("uri"), None);
    // What is not there is named as before.
    assert_eq!(file.json["images"][1]["uri"], "gone.png");
}

#[test]
fn a_glb_becomes_a_single_gltf() {
    let folder = Folder::new("single");
    let document = GltfDocument::from_bytes(&gltf_samples::skinned().glb()).unwrap();
    let out = folder.0.join("out/hero.gltf");
    document.write(&out).unwrap();
    assert!(json(&out)["buffers"][0]["uri"].as_str().unwrap().starts_with("data:"));
    let again = GltfDocument::read(&out).unwrap();
    assert_eq!(again.mesh(0).unwrap(), document.mesh(0).unwrap());
    let error = document.write(folder.0.join("out/hero.obj")).unwrap_err().to_string();
    assert!(error.contains("hero.obj"), "{error}");
}
