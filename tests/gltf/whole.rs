//! Meshes are replaced; nothing else changes.

use multires::io::{GltfDocument, WriteError};
use multires::mesh::{Mesh, names, shapes};
use multires::simplify::AttributeWeights;
use multires::{Simplifier, Target};

use crate::compare::{File, same_but_for_surfaces};
use crate::gltf_samples::{self, Sample};
use crate::{models, validator};

/// Extensions of primitives in samples that speak of vertices.
const LOST: &[&str] = &["ACME_outline"];

fn lost(sample: &Sample) -> &'static [&'static str] {
    if sample.name.starts_with("unknown") { LOST } else { &[] }
}

/// The surfaces of a document; `None` where a mesh has none.
pub fn meshes(document: &GltfDocument) -> Vec<Option<Mesh>> {
    (0..document.mesh_count()).map(|i| document.mesh(i).unwrap().map(|imported| imported.mesh)).collect()
}

/// Every surface of a document at half its triangles.
pub fn halved(document: &GltfDocument) -> GltfDocument {
    let mut lighter = document.clone();
    for (i, mesh) in meshes(document).iter().enumerate() {
        let Some(mesh) = mesh else { continue };
        let sequence = Simplifier::new().target(Target::Ratio(0.5)).run(mesh).unwrap();
        lighter.replace(i, &sequence.extract(mesh, sequence.len())).unwrap();
    }
    lighter
}

/// The bits of every triangle's corners: positions and attributes, triangle by triangle.
pub fn corners(mesh: &Mesh) -> Vec<Vec<u32>> {
    let row = |v: u32| -> Vec<u32> {
        let v = v as usize;
        let mut words: Vec<u32> = mesh.positions()[v].iter().map(|x| x.to_bits()).collect();
        for attribute in mesh.attributes() {
            let range = v * attribute.width()..(v + 1) * attribute.width();
            match attribute.values() {
                multires::mesh::AttributeValues::Float(x) => {
                    words.extend(x[range].iter().map(|x| x.to_bits()))
                }
                multires::mesh::AttributeValues::Int(x) => words.extend(x[range].iter().map(|&x| x as u32)),
                multires::mesh::AttributeValues::Uint(x) => words.extend(&x[range]),
                _ => unreachable!(),
            }
        }
        words
    };
    let mut all: Vec<Vec<u32>> = Vec::new();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        all.push(std::iter::once(mesh.materials()[t]).chain(triangle.iter().flat_map(|&v| row(v))).collect());
    }
    all
}

#[test]
fn a_document_comes_back_as_it_was() {
    for sample in gltf_samples::all() {
        let document = GltfDocument::from_bytes(&sample.glb()).unwrap();
        let back = document.to_glb().unwrap();
        let [a, b] = [sample.glb(), back.clone()].map(|bytes| File::of_glb(&bytes));
        same_but_for_surfaces(sample.name, &a, &b, &[]);
        let again = GltfDocument::from_bytes(&back).unwrap();
        for (a, b) in meshes(&document).iter().zip(meshes(&again)) {
            assert_eq!(a.as_ref().map(corners), b.as_ref().map(corners), "{}", sample.name);
        }
        // What is written is what comes back: a second time byte for byte.
        assert_eq!(again.to_glb().unwrap(), back, "{}", sample.name);
    }
}

#[test]
fn meshes_put_back_unchanged_are_written_bit_for_bit() {
    for sample in gltf_samples::all() {
        let document = GltfDocument::from_bytes(&sample.glb()).unwrap();
        let mut same = document.clone();
        for (i, mesh) in meshes(&document).iter().enumerate() {
            if let Some(mesh) = mesh {
                same.replace(i, mesh).unwrap();
            }
        }
        let back = same.to_glb().unwrap();
        let [a, b] = [sample.glb(), back.clone()].map(|bytes| File::of_glb(&bytes));
        same_but_for_surfaces(sample.name, &a, &b, lost(&sample));
        let again = GltfDocument::from_bytes(&back).unwrap();
        for (a, b) in meshes(&document).iter().zip(meshes(&again)) {
            assert_eq!(a.as_ref().map(corners), b.as_ref().map(corners), "{}", sample.name);
        }
    }
}

#[test]
fn halved_documents_are_valid_and_keep_all_else() {
    let folder = std::env::temp_dir().join(format!("multires-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    for (i, sample) in gltf_samples::all().into_iter().enumerate() {
        let document = GltfDocument::from_bytes(&sample.glb()).unwrap();
        let lighter = halved(&document);
        let bytes = lighter.to_glb().unwrap();
        let [a, b] = [sample.glb(), bytes.clone()].map(|bytes| File::of_glb(&bytes));
        same_but_for_surfaces(sample.name, &a, &b, lost(&sample));
        assert_eq!(lighter.notes().len(), lost(&sample).len(), "{}: {:?}", sample.name, lighter.notes());
        let again = GltfDocument::from_bytes(&bytes).unwrap();
        for (before, after) in meshes(&document).iter().zip(meshes(&again)) {
            let (Some(before), Some(after)) = (before, after) else { continue };
            assert!(2 * after.triangles().len() <= before.triangles().len(), "{}", sample.name);
            assert!(2 * after.triangles().len() > before.triangles().len() - 8, "{}", sample.name);
        }
        // Vertices that are gone take no room, but for those that lines use as well; lists take more than strips.
        let is_apart = sample.name == "points and lines" || sample.name.starts_with("strips");
        assert!(
            is_apart || 4 * bytes.len() < 3 * sample.glb().len(),
            "{}: {} bytes",
            sample.name,
            bytes.len()
        );
        for (number, content) in [(2 * i, sample.glb()), (2 * i + 1, bytes)] {
            let path = folder.join(format!("{number}.glb"));
            std::fs::write(&path, content).unwrap();
            files.push(path);
        }
    }
    let errors = validator::errors("halved_documents_are_valid_and_keep_all_else", &files);
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn game_models_stay_whole() {
    let Some(root) = models::all("game_models_stay_whole") else { return };
    let folder = std::env::temp_dir().join(format!("multires-game-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    let cases = [
        "game/Fox.glb",
        "game/pigman/scene.gltf",
        "game/FlightHelmet/FlightHelmet.gltf",
        "game/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf",
        "game/terrain/Mountains.gltf",
        "cases/gltf_gpu_instancing/five.glb",
        "cases/gltf_mixed_attributes/mixed.glb",
        "cases/gltf_modes/modes.glb",
        "cases/gltf_quantized/pos_i16_norm.glb",
        "cases/gltf_quantized/pos_i16_raw.glb",
        "cases/gltf_quantized/pos_u8_raw.glb",
        "cases/gltf_rigged/rigged.glb",
        "cases/gltf_scenes/two.glb",
        "cases/gltf_sparse_zero/sparse_all.glb",
    ];
    for (i, name) in cases.iter().enumerate() {
        let document = GltfDocument::read(root.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Put back as they are, meshes are the same bit for bit.
        let mut same = document.clone();
        let surfaces = meshes(&document);
        for (i, mesh) in surfaces.iter().enumerate().filter_map(|(i, mesh)| Some((i, mesh.as_ref()?))) {
            same.replace(i, mesh).unwrap();
        }
        let back = GltfDocument::from_bytes(&same.to_glb().unwrap()).unwrap();
        for (a, b) in surfaces.iter().zip(meshes(&back)) {
            assert!(a.as_ref().map(corners) == b.as_ref().map(corners), "{name}");
        }
        let lighter = halved(&document).to_glb().unwrap();
        let [a, b] = [document.to_glb().unwrap(), lighter.clone()].map(|bytes| File::of_glb(&bytes));
        same_but_for_surfaces(name, &a, &b, &[]);
        let path = folder.join(format!("{i}.glb"));
        std::fs::write(&path, lighter).unwrap();
        files.push(path);
    }
    let errors = validator::errors("game_models_stay_whole", &files);
    // The pictures of some models are not there; a file's own faults are its own.
    let errors: Vec<String> = errors.into_iter().filter(|e| !e.contains("IO_ERROR")).collect();
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn sparse_targets_stay_sparse() {
    for sample in [gltf_samples::morphed(true), gltf_samples::morphed(false)] {
        let is_sparse = sample.name != "morph";
        let document = GltfDocument::from_bytes(&sample.glb()).unwrap();
        let file = File::of_glb(&halved(&document).to_glb().unwrap());
        let bulge = &file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
        let accessor = &file.json["accessors"][bulge.as_u64().unwrap() as usize];
        assert_eq!(accessor.get("sparse").is_some(), is_sparse, "{}", sample.name);
    }
}

#[test]
fn kept_vertices_keep_joints_and_weights() {
    let document = GltfDocument::from_bytes(&gltf_samples::skinned().glb()).unwrap();
    let before = document.mesh(0).unwrap().unwrap().mesh;
    let again = GltfDocument::from_bytes(&halved(&document).to_glb().unwrap()).unwrap();
    let after = again.mesh(0).unwrap().unwrap().mesh;
    let rows = |mesh: &Mesh| -> Vec<(Vec<u32>, Vec<u32>, Vec<u32>)> {
        let multires::mesh::AttributeValues::Uint(joints) = mesh.attribute(names::JOINTS).unwrap().values()
        else {
            panic!("joints are integers")
        };
        let weights = mesh.attribute(names::WEIGHTS).unwrap().as_floats().unwrap();
        (0..mesh.positions().len())
            .map(|v| {
                let bits = |x: &[f32]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                (
                    bits(&mesh.positions()[v]),
                    joints[4 * v..4 * v + 4].to_vec(),
                    bits(&weights[4 * v..4 * v + 4]),
                )
            })
            .collect()
    };
    let all: std::collections::BTreeSet<_> = rows(&before).into_iter().collect();
    assert!(rows(&after).iter().all(|row| all.contains(row)));
}

#[test]
fn new_vertices_have_weights_that_sum_to_one() {
    for sample in [gltf_samples::skinned(), gltf_samples::all().swap_remove(2)] {
        let document = GltfDocument::from_bytes(&sample.glb()).unwrap();
        let mesh = document.mesh(0).unwrap().unwrap().mesh;
        let mut simplifier = Simplifier::new()
            .placement(multires::Placement::Optimal)
            .attributes(AttributeWeights::Customary)
            .target(Target::Ratio(0.3));
        let sequence = simplifier.run(&mesh).unwrap();
        assert!(!sequence.new_vertices().is_empty());
        let mut lighter = document.clone();
        lighter.replace(0, &sequence.extract(&mesh, sequence.len())).unwrap();
        let again = GltfDocument::from_bytes(&lighter.to_glb().unwrap()).unwrap();
        let level = again.mesh(0).unwrap().unwrap().mesh;
        let sets: Vec<&[f32]> = level
            .attributes()
            .iter()
            .filter(|a| names::is_set_of(a.name(), names::WEIGHTS))
            .map(|a| a.as_floats().unwrap())
            .collect();
        for v in 0..level.positions().len() {
            let sum: f32 = sets.iter().flat_map(|set| &set[4 * v..4 * v + 4]).sum();
            assert!((sum - 1.0).abs() <= 1.0 / 255.0, "{}: vertex {v}: {sum}", sample.name);
        }
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let mut document = GltfDocument::from_bytes(&gltf_samples::skinned().glb()).unwrap();
    let refused = |result: Result<(), WriteError>, words: &str| {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(words), "{error:?} where {words:?} was expected");
    };
    let sphere = shapes::icosphere(1);
    refused(document.replace(7, &sphere), "mesh 7 is asked for, but there are 1");
    refused(document.replace(0, &Mesh::default()), "a mesh without triangles");
    let other = sphere.clone().with_materials(vec![3; 80]).unwrap();
    refused(document.replace(0, &other), "material id 3");
    // A mesh that lacks attributes is written without them.
    document.replace(0, &sphere).unwrap();
    let file = File::of_glb(&document.to_glb().unwrap());
    let attributes = file.json["meshes"][0]["primitives"][0]["attributes"].as_object().unwrap().clone();
    assert_eq!(attributes.keys().collect::<Vec<_>>(), ["POSITION"]);
    assert!(document.mesh(7).is_err());
}
