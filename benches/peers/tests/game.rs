//! The command measures every contender on game assets: a complete table, nothing for what is the same, and a known
//! slide at its value.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use multires::mesh::{Attribute, Mesh, names, shapes};
use serde_json::Value;

fn peers(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_multires-peers")).args(arguments).output().unwrap()
}

fn game(path: &Path, arguments: &[&str]) -> Value {
    let output =
        peers(&[&["game", path.to_str().unwrap(), "--json", "--samples", "2000"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn save(name: &str, mesh: &Mesh) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    multires::io::write(&path, mesh).unwrap();
    path
}

/// Every row has every number, and means are of the contenders that reached the target.
#[test]
fn the_table_is_complete() {
    let path = save("game-sphere.ply", &shapes::uv_sphere(24, 16));
    let result = game(&path, &["--percent", "50,20"]);
    let rows = result["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["contender"].as_str().unwrap()).collect();
    for name in [
        "meshopt",
        "meshopt-gltfpack",
        "meshopt-uv",
        "meshopt-update",
        "default",
        "permissive",
        "optimal",
        "lindstrom-turk",
    ] {
        assert_eq!(names.iter().filter(|n| **n == name).count(), 2, "{name}");
    }
    for row in rows {
        assert_eq!(row["triangles"], 24 * 15 * 2);
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("left") > 0.0 && number("ms") > 0.0, "{row}");
        for key in ["mean", "max", "normals", "facets", "slide", "image"] {
            assert!(number(key) > 0.0 && number(key).is_finite(), "{key}: {row}");
        }
        assert!(number("mean") < number("max"), "{row}");
        assert_eq!(row["invalid"], 0, "{row}");
    }
    for mean in result["means"].as_array().unwrap() {
        let stuck = mean["stuck"].as_array().unwrap().len();
        assert_eq!(mean["models"].as_u64().unwrap() + stuck as u64, 1, "{mean}");
        if stuck == 0 {
            assert!(mean["ratios"]["image"].as_f64().unwrap() > 0.1, "{mean}");
        }
    }
    // The least share of those asked for, by anyone.
    let least = &result["least"][0];
    assert_eq!(least["model"], "game-sphere");
    let shares = rows.iter().map(|row| row["share"].as_f64().unwrap()).fold(100.0, f64::min);
    let found = least["meshopt"].as_f64().unwrap().min(least["ours"].as_f64().unwrap());
    assert_eq!(found, shares);
    // A setting of the other simplifier is never better than the best of its settings.
    let peer =
        |mean: &&Value| mean["contender"].as_str().unwrap().starts_with("meshopt") && mean["models"] == 1;
    for mean in result["means"].as_array().unwrap().iter().filter(peer) {
        assert!(mean["ratios"]["image"].as_f64().unwrap() >= 1.0, "{mean}");
    }
}

#[test]
fn a_level_that_is_the_model_has_no_difference() {
    let path = save("game-whole.ply", &shapes::uv_sphere(24, 16));
    // Contenders that collapse nothing and solve nothing anew.
    let names = "meshopt,meshopt-gltfpack,meshopt-uv,default,permissive,optimal,lindstrom-turk";
    for row in game(&path, &["--percent", "100", "--only", names])["rows"].as_array().unwrap() {
        for key in ["mean", "max", "normals", "facets", "slide", "image"] {
            assert!(row[key].as_f64().unwrap() < 1e-4, "{key}: {row}");
        }
        assert_eq!((&row["flipped"], &row["invalid"]), (&Value::from(0), &Value::from(0)));
    }
}

/// A flat strip whose texture is stretched over its first half: without the vertices in the middle the texture runs
/// evenly, so it has slid by `|x/2 - f(x)|` of the width, in the mean by 1/8 of it.
#[test]
fn a_known_slide_has_its_value() {
    let columns = 64;
    let (mut positions, mut uv, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=columns {
        let x = i as f32 / columns as f32;
        // The first half has a quarter of the texture.
        let u = if x < 0.5 { 0.5 * x } else { 0.25 + 1.5 * (x - 0.5) };
        for y in [0.0, 0.02] {
            positions.push([x, y, 0.0]);
            uv.push([u, y]);
        }
    }
    for i in 0..columns {
        triangles.extend([[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]);
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mesh = mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap();
    let path = save("game-strip.ply", &mesh);
    // Positions alone are flat: a simplifier that does not look at the texture keeps two triangles.
    let result = game(&path, &["--percent", "2", "--only", "meshopt"]);
    let row = &result["rows"][0];
    assert_eq!(row["left"], 2, "{row}");
    // |u - x| in texture units is 0 at both ends and 1/4 in the middle. A unit covers 2 x 1 of the first half's area, so
    // sqrt 2 of length; and 1/1.5 of the second's, so sqrt(2/3).
    let expected = 100.0 * 0.125 * 0.5 * (2f64.sqrt() + (2.0f64 / 3.0).sqrt()) / 1f64.hypot(0.02);
    let slide = row["slide"].as_f64().unwrap();
    // No place counts more than a tenth of the diagonal, so less than without that limit.
    assert!(slide > 0.5 * expected && slide < expected, "{slide}, without the limit {expected}");
    assert!(row["mean"].as_f64().unwrap() < 1e-5, "{row}");
}

#[test]
fn wrong_usage_has_its_status() {
    assert_eq!(peers(&["game"]).status.code(), Some(2));
    assert_eq!(peers(&["game", "--generated", "--only", "nobody"]).status.code(), Some(2));
    assert_eq!(peers(&["reach"]).status.code(), Some(2));
    assert_eq!(peers(&["game", "no-such-file.ply"]).status.code(), Some(1));
}

/// A folder's models that can be read and have triangles enough, with what was reached.
#[test]
fn reach_goes_through_a_folder() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("reach");
    std::fs::create_dir_all(&folder).unwrap();
    multires::io::write(folder.join("ball.ply"), &shapes::icosphere(4)).unwrap();
    multires::io::write(folder.join("cube.ply"), &shapes::cube()).unwrap();
    std::fs::write(folder.join("broken.obj"), "v 0 0\n").unwrap();
    let output = peers(&["reach", folder.to_str().unwrap(), "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = result["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1, "{result}");
    assert_eq!(rows[0]["model"], "reach/ball.ply");
    assert_eq!((rows[0]["target"].as_u64(), result["short"].as_u64()), (Some(256), Some(0)));
    assert!(rows[0]["left"].as_u64().unwrap() <= 256);
}
