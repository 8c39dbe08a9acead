//! Promise: where a simplification stops short, the advice printed was tried: following it gets further, and what would not help is
//! not named.
#![cfg(feature = "cli")]

use crate::command::{Folder, json};
use multires::io;
use multires::mesh::{Mesh, shapes};
use serde_json::Value;

/// Simplifies a mesh by the command line: its answer and its warning.
fn simplify(folder: &Folder, how: &str) -> (Value, String) {
    let [input, output] = ["in.ply", "out.ply"].map(|name| folder.file(name));
    let said = json("simplify", &[&input, &output], how);
    (said.answer(), said.err)
}

fn triangles(answer: &Value) -> u64 {
    answer["output"]["triangles"].as_u64().unwrap()
}

/// Stops short, and every advice that is given gets further when it is followed.
fn follow(what: &str, mesh: &Mesh, how: &str, at_least: usize) {
    let folder = Folder::new(what);
    io::write(folder.file("in.ply"), mesh).unwrap();
    let (answer, warning) = simplify(&folder, how);
    assert_eq!(answer["stop"], "nothing-legal", "{what}");
    let advice = answer["advice"].as_array().unwrap();
    assert!(advice.len() >= at_least, "{what}: {warning}");
    for one in advice {
        let option = one["option"].as_str().unwrap();
        assert!(warning.contains(option), "{what}: {option} in {warning}");
        let mut followed = how.to_owned();
        for part in option.split(" and ") {
            followed = match part.strip_prefix("leaving out ") {
                Some(unwanted) => followed.replace(unwanted, ""),
                None => {
                    // In place of what was given.
                    let (name, _) = part.split_once(' ').unwrap();
                    let mut words: Vec<&str> = followed.split_whitespace().collect();
                    if let Some(at) = words.iter().position(|word| *word == name) {
                        words.drain(at..at + 2);
                    }
                    format!("{} {part}", words.join(" "))
                }
            };
        }
        let (after, _) = simplify(&folder, &followed);
        assert!(triangles(&after) < triangles(&answer), "{what}: {followed}");
    }
    // And nothing is named besides.
    let named = warning.matches("--").count();
    let said: usize = advice.iter().map(|one| one["option"].as_str().unwrap().matches("--").count()).sum();
    assert_eq!(named, said, "{what}: {warning}");
}

#[test]
fn what_is_advised_helps() {
    follow("locked borders", &shapes::plane(8), "--triangles 4 --lock-borders", 1);
    follow("kept parts", &shapes::gravel(50, 1), "--triangles 20 --keep-parts", 1);
    follow("seams", &shapes::box_with_face_normals(4), "--triangles 8 --max-turn 40", 0);
    follow("turns", &shapes::rock(600, 1), "--triangles 20 --max-turn 5", 1);
    follow("shell", &shapes::shell(1, 0.97), "--triangles 1 --keep-parts --keep-apart", 0);
}

#[test]
fn what_does_not_help_is_not_named() {
    for (what, mesh) in [("tetrahedron", shapes::tetrahedron()), ("torus", shapes::torus(1.0, 0.4, 12, 8))] {
        let folder = Folder::new(what);
        io::write(folder.file("in.ply"), &mesh).unwrap();
        let (answer, warning) = simplify(&folder, "--triangles 1 --max-turn 180 --min-quality 0");
        assert_eq!(answer["stop"], "nothing-legal", "{what}");
        assert!(answer["advice"].as_array().unwrap().is_empty(), "{what}: {warning}");
        assert!(warning.contains("parts") && !warning.contains("--"), "{what}: {warning}");
    }
}
