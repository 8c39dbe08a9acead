//! From glTF to glTF everything stays but the triangles; many files; several levels; a page about it.

#![cfg(feature = "cli")]

use std::path::Path;

use multires::io::{self, GltfDocument};
use multires::mesh::shapes;
use serde_json::Value;

use crate::command::{Folder, json, run};
use crate::{gltf_samples, models, validator};

fn file(folder: &Folder, sample: &gltf_samples::Sample, number: usize) -> std::path::PathBuf {
    let path = folder.file(&format!("in{number}.glb"));
    std::fs::write(&path, sample.glb()).unwrap();
    path
}

/// The document of a .glb file.
fn document(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn every_kind_of_document_is_halved() {
    let folder = Folder::new("gltf-kinds");
    let mut written = Vec::new();
    for (i, sample) in gltf_samples::all().iter().enumerate() {
        let (input, output) = (file(&folder, sample, i), folder.file(&format!("out{i}.glb")));
        let answer = json("simplify", &[&input, &output], "--ratio 0.5").answer();
        let [before, after] = [&answer["input"], &answer["output"]].map(|a| a["triangles"].as_u64().unwrap());
        assert!(2 * after <= before && 2 * after + 8 > before, "{}: {before} -> {after}", sample.name);
        assert!(answer["error"].as_f64() > Some(0.0), "{}", sample.name);
        let (old, new) = (document(&input), document(&output));
        for section in
            ["nodes", "skins", "materials", "scenes", "scene", "cameras", "textures", "asset", "extensions"]
        {
            assert_eq!(old[section], new[section], "{}: {section}", sample.name);
        }
        written.push(output);
    }
    let errors = validator::errors("every_kind_of_document_is_halved", &written);
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
}

#[test]
fn errors_in_poses_are_told() {
    let folder = Folder::new("gltf-poses");
    for (sample, names) in [
        (gltf_samples::skinned(), vec!["bend"; 4]),
        (gltf_samples::morphed(false), vec!["", "bulge", "lean"]),
    ] {
        let (input, output) = (file(&folder, &sample, 0), folder.file("out.glb"));
        let answer = json("simplify", &[&input, &output], "--ratio 0.25").answer();
        let poses = answer["meshes"][0]["poses"].as_array().unwrap();
        let found: Vec<&str> = poses.iter().map(|p| p["name"].as_str().unwrap()).collect();
        assert!(!found.is_empty() && found.iter().all(|name| names.contains(name)), "{found:?}");
        let (still, posed) = (answer["error"].as_f64().unwrap(), answer["pose_error"].as_f64().unwrap());
        assert!(posed > 0.0 && posed <= 1.5 * still, "{}: {posed} in poses, {still} still", sample.name);
        let none = json("simplify", &[&input, &output], "--ratio 0.25 --poses 0").answer();
        assert_eq!(none["pose_error"], Value::Null);
        // Chosen weights leave the poses as they are.
        json("simplify", &[&input, &output], "--ratio 0.25 --attributes uv=0.01").answer();
        json("simplify", &[&input, &output], "--ratio 0.25 --attributes off").answer();
    }
}

#[test]
fn meshes_of_a_document_share_their_triangles_by_error() {
    let folder = Folder::new("gltf-shared");
    let sample = gltf_samples::all().into_iter().find(|s| s.name == "two meshes").unwrap();
    let (input, output) = (file(&folder, &sample, 0), folder.file("out.glb"));
    let answer = json("simplify", &[&input, &output], "--triangles 1000").answer();
    let meshes = answer["meshes"].as_array().unwrap();
    let number = |mesh: &Value, key: &str| mesh[key].as_f64().unwrap();
    assert_eq!(meshes.len(), 2);
    let total: f64 = meshes.iter().map(|m| number(m, "triangles")).sum();
    assert!((990.0..=1000.0).contains(&total), "{total}");
    // The same tube ten times as large needs more triangles for the same error.
    assert_eq!((number(&meshes[0], "scale"), number(&meshes[1], "scale")), (10.0, 1.0));
    assert!(number(&meshes[0], "triangles") > 2.0 * number(&meshes[1], "triangles"), "{meshes:?}");
    assert!(number(&meshes[0], "error") < 2.0 * number(&meshes[1], "error").max(1e-9), "{meshes:?}");
    // Other sizes are of all meshes together, too.
    for (target, key, most) in [("--vertices 500", "vertices", 500), ("--error 0.05", "", 0)] {
        let answer = json("simplify", &[&input, &output], target).answer();
        if key.is_empty() {
            assert!(answer["error"].as_f64().unwrap() <= 0.05, "{answer}");
        } else {
            assert!(answer["output"][key].as_u64().unwrap() <= most, "{answer}");
        }
    }
    let answer = json("simplify", &[&input, &output], "--bytes 30000").answer();
    let size = |key: &str| answer["output"][key].as_u64().unwrap();
    assert!(12 * size("triangles") + 32 * size("vertices") <= 30_000);
}

#[test]
fn levels_are_written_as_engines_take_them() {
    let folder = Folder::new("gltf-levels");
    let input = file(&folder, &gltf_samples::skinned(), 0);
    let output = folder.file("hero.glb");
    let answer = json("simplify", &[&input, &output], "--levels 50,25,10").answer();
    let triangles: Vec<u64> = answer["levels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| l["output"]["triangles"].as_u64().unwrap())
        .collect();
    for (triangles, most) in triangles.iter().zip([960, 480, 192]) {
        assert!(*triangles <= most && triangles + 2 > most, "{triangles} of {most}");
    }
    let msft = document(&output);
    let node = &msft["nodes"][1];
    assert_eq!(node["extensions"]["MSFT_lod"]["ids"].as_array().unwrap().len(), 3);
    let coverages: Vec<f64> = node["extras"]["MSFT_screencoverage"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c.as_f64().unwrap())
        .collect();
    assert!(coverages.len() == 4 && coverages.windows(2).all(|pair| pair[0] >= pair[1]), "{coverages:?}");
    assert_eq!(GltfDocument::read(&output).unwrap().mesh_count(), 4);

    json("simplify", &[&input, &output], "--levels 50,25 --level-form names").answer();
    let names = document(&output);
    let names: Vec<&str> =
        names["nodes"].as_array().unwrap().iter().filter_map(|n| n["name"].as_str()).collect();
    assert!(["skin_LOD0", "skin_LOD1", "skin_LOD2"].iter().all(|name| names.contains(name)), "{names:?}");

    std::fs::remove_file(&output).unwrap();
    json("simplify", &[&input, &output], "--levels 50,25 --level-form files").answer();
    let plain = folder.file("rock.ply");
    io::write(&plain, &shapes::rock(2_000, 1)).unwrap();
    let answer = json("simplify", &[&plain, &folder.file("rock.obj")], "--levels 50,25").answer();
    assert_eq!(answer["levels"].as_array().unwrap().len(), 2);
    let expected =
        ["hero_LOD1.glb", "hero_LOD2.glb", "in0.glb", "rock.ply", "rock_LOD1.obj", "rock_LOD2.obj"];
    assert_eq!(folder.names(), expected);

    for arguments in
        ["--levels 25,50", "--levels 50 --ratio 0.5", "--levels 150", "--level-form names --ratio 0.5"]
    {
        let said = json("simplify", &[&input, &output], arguments);
        assert_eq!(said.code, Some(2), "{arguments}: {said:?}");
    }
}

#[test]
fn many_files_at_once() {
    let folder = Folder::new("many");
    let mut inputs: Vec<std::path::PathBuf> =
        (0..3).map(|i| file(&folder, &gltf_samples::all()[i], i)).collect();
    let rock = folder.file("rock.obj");
    io::write(&rock, &shapes::rock(2_000, 1)).unwrap();
    let broken = folder.file("broken.glb");
    std::fs::write(&broken, b"glTF").unwrap();
    inputs.extend([rock, broken]);
    let (out, page) = (folder.file("out"), folder.file("page.html"));
    let mut arguments: Vec<std::ffi::OsString> = vec!["simplify".into()];
    arguments.extend(inputs.iter().map(|path| path.clone().into_os_string()));
    arguments.extend(["--out".into(), out.clone().into_os_string(), "--ratio".into(), "0.3".into()]);
    arguments.extend(["--report".into(), page.clone().into_os_string()]);
    let said = run(&arguments);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert_eq!(said.out.lines().count(), 5, "{said:?}");
    assert!(said.err.lines().last().unwrap().contains("broken.glb"), "{said:?}");
    let mut names: Vec<_> =
        std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["in0.glb", "in1.glb", "in2.glb", "rock.obj"]);

    // The page has all that it shows within it.
    let html = std::fs::read_to_string(&page).unwrap();
    assert_eq!(html.matches("<img ").count(), 8);
    assert_eq!(html.matches("src=\"data:image/png;base64,").count(), 8);
    assert!(html.contains("broken.glb") && !html.contains("http"), "no address of another place");

    // As JSON, one object; the same bytes each time; another format where one is named.
    let again = folder.file("again");
    arguments.truncate(6);
    arguments.extend([
        "--out".into(),
        again.clone().into_os_string(),
        "--ratio".into(),
        "0.3".into(),
        "--json".into(),
    ]);
    let answer = run(&arguments).json();
    assert_eq!(answer["files"].as_array().unwrap().len(), 4);
    assert_eq!(answer["failures"].as_array().unwrap().len(), 1);
    for name in &names {
        assert_eq!(
            std::fs::read(out.join(name)).unwrap(),
            std::fs::read(again.join(name)).unwrap(),
            "{name}"
        );
    }
    let gltf = folder.file("gltf");
    let to =
        |more: &str| json("simplify", &[&inputs[0]], &format!("--ratio 0.3 --out {} {more}", gltf.display()));
    to("--format gltf").answer();
    assert!(gltf.join("in0.gltf").is_file());
    assert_eq!(to("--format xyz").code, Some(2));
    let twice = json("simplify", &[&inputs[0], &inputs[0]], &format!("--ratio 0.3 --out {}", gltf.display()));
    assert_eq!(twice.code, Some(2), "{twice:?}");
    assert_eq!(json("simplify", &[&inputs[0]], "--ratio 0.3").code, Some(2));
    assert_eq!(json("simplify", &[&inputs[0], &inputs[1], &inputs[2]], "--ratio 0.3").code, Some(2));
}

#[test]
fn what_is_left_out_is_told() {
    let folder = Folder::new("gltf-told");
    // To another format a skin is lost.
    let (input, output) = (file(&folder, &gltf_samples::skinned(), 0), folder.file("out.ply"));
    let said = json("simplify", &[&input, &output], "--ratio 0.5");
    let told = said.answer()["warnings"].to_string();
    assert!(told.contains("1 skin, 1 animation"), "{told}");
    // From glTF to glTF an extension that speaks of vertices is.
    let sample = gltf_samples::all().into_iter().find(|s| s.name == "unknown extensions").unwrap();
    let (input, output) = (file(&folder, &sample, 1), folder.file("out.glb"));
    let told = json("simplify", &[&input, &output], "--ratio 0.5").answer()["warnings"].to_string();
    assert!(told.contains("ACME_outline") && !told.contains("ACME_world"), "{told}");
    let used = document(&output)["extensionsUsed"].clone();
    assert_eq!(used, serde_json::json!(["ACME_world"]));
    // Attributes may be dropped from all meshes.
    json("simplify", &[&input, &output], "--ratio 0.5 --drop uv").answer();
    let attributes = document(&output)["meshes"][0]["primitives"][0]["attributes"].clone();
    assert_eq!(attributes.as_object().unwrap().keys().collect::<Vec<_>>(), ["NORMAL", "POSITION"]);
    let refused = json("simplify", &[&input, &output], "--ratio 0.5 --drop colour").refusal();
    assert!(refused.contains("colour"), "{refused}");
}

#[test]
fn game_models_through_the_program() {
    let folder = Folder::new("gltf-game");
    let mut written = Vec::new();
    for (i, name) in ["game/Fox.glb", "game/pigman/scene.gltf"].into_iter().enumerate() {
        let Some(input) = models::find("game_models_through_the_program", name) else { return };
        let output = folder.file(&format!("{i}.glb"));
        let answer = json("simplify", &[&input, &output], "--ratio 0.25").answer();
        let (still, posed) = (answer["error"].as_f64().unwrap(), answer["pose_error"].as_f64().unwrap());
        assert!(posed <= 1.5 * still, "{name}: {posed} in poses, {still} still");
        assert_eq!(answer["warnings"].as_array().unwrap().len(), 0, "{name}: {}", answer["warnings"]);
        written.push(output);
    }
    let errors = validator::errors("game_models_through_the_program", &written);
    let errors: Vec<String> = errors.into_iter().filter(|e| !e.contains("IO_ERROR")).collect();
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
}
