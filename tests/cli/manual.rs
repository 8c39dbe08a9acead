//! Completions, the manual, and the way to the viewer.

#![cfg(feature = "cli")]

use crate::command::{Folder, json, run};

#[test]
fn shells_complete_every_command() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let said = run(["completions", shell]);
        assert_eq!(said.code, Some(0), "{said:?}");
        for word in ["simplify", "--attribute-values", "remesh"] {
            assert!(said.out.contains(word.trim_start_matches('-')), "{shell}: {word}");
        }
    }
    assert_eq!(run(["completions", "cmd"]).code, Some(2));
}

#[test]
fn every_command_has_a_page() {
    let folder = Folder::new("man");
    let to = folder.file("man1");
    let pages = json("man", &[&to], "").answer()["pages"].as_array().unwrap().len();
    let names: Vec<String> =
        std::fs::read_dir(&to).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(names.len(), pages);
    for name in ["multires.1", "multires-simplify.1", "multires-build.1"] {
        let text = std::fs::read_to_string(to.join(name)).unwrap();
        assert!(text.contains(".SH NAME") && text.contains(".SH OPTIONS"), "{name}");
    }
    let simplify = std::fs::read_to_string(to.join("multires-simplify.1")).unwrap();
    assert!(simplify.contains("multires simplify"), "usage names the whole command");
}

#[test]
fn the_viewer_is_named_where_it_is_missing() {
    let folder = Folder::new("view");
    let missing = json("view", &[&folder.file("none.glb")], "").refusal();
    assert!(missing.contains("no such file"), "{missing}");
    let mesh = folder.file("rock.obj");
    multires::io::write(&mesh, &multires::mesh::shapes::rock(100, 1)).unwrap();
    let mut command = crate::command::command(["view"]);
    let output = command.arg(&mesh).env("PATH", folder.file("nothing")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let beside = std::path::Path::new(env!("CARGO_BIN_EXE_multires")).with_file_name("multires-viewer");
    if !beside.exists() {
        assert_eq!(output.status.code(), Some(1));
        assert!(said.contains("cargo install"), "{said}");
    }
}
