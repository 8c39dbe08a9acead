//! The command flies the path past a model, everybody in the same run, and reports what it counted.

use std::process::{Command, Output};

use serde_json::Value;

fn peers(arguments: &[&str]) -> Output {
    // Without models there is nothing beside them: the path is the formula's.
    let mut command = Command::new(env!("CARGO_BIN_EXE_multires-peers"));
    command.env_remove("MULTIRES_MODELS").args(arguments).output().unwrap()
}

#[test]
fn every_contender_flies() {
    let directory = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = directory.join("path.csv");
    std::fs::write(
        &path,
        "# a comment\nframe,ex,ey,ez,tx,ty,tz\n0,2,0.5,0,0,0,0\n1,1,0.5,0.1,0,0,0\n2,0.6,0.3,0.1,0,0,0\n",
    )
    .unwrap();
    let model = directory.join("octahedron.off");
    let octahedron = "OFF\n6 8 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n\
        3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n";
    std::fs::write(&model, octahedron).unwrap();
    let [path, model] = [&path, &model].map(|p| p.to_str().unwrap());
    let output =
        peers(&["fly", model, "--subdivide", "4", "--path", path, "--rounds", "1", "--still-path", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["frames"], 3);
    let mesh = &result["meshes"][0];
    let triangles = mesh["triangles"].as_f64().unwrap();
    assert_eq!(triangles, 8.0 * 256.0);
    let flights = mesh["flights"].as_array().unwrap();
    let names: Vec<&str> = flights.iter().map(|f| f["contender"].as_str().unwrap()).collect();
    assert_eq!(names, ["clusterlod", "none", "manifold", "adjacent", "neighbours"]);
    for flight in flights {
        let drawn = flight["drawn"]["mean"].as_f64().unwrap();
        let inside = flight["in_frustum"].as_f64().unwrap();
        assert!(drawn > 0.0 && drawn <= triangles && inside > 0.0 && inside <= drawn, "{flight}");
        assert!(flight["median_us"]["cut"].as_f64().unwrap() > 0.0, "{flight}");
    }
    assert!(!mesh["slow"].as_array().unwrap().is_empty());
    assert!(mesh["everything"][0]["splits"].as_u64().unwrap() > 500);
}

#[test]
fn bad_paths_and_wrong_usage_differ_in_status() {
    assert_eq!(peers(&["fly", "--dependencies", "some"]).status.code(), Some(2));
    assert_eq!(peers(&["fly", "--tolerance", "0"]).status.code(), Some(2));
    let missing = peers(&["fly", "--path", "no-such-path.csv"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no-such-path.csv"));
}

/// The formula that is built in is the one of the path that lies beside the models.
#[test]
fn the_formula_is_the_file() {
    let models = std::env::var("MULTIRES_MODELS").unwrap_or("../../../shared/models".to_owned());
    let file = std::path::Path::new(&models).join("../paths/approach.csv");
    if !file.is_file() {
        eprintln!("the_formula_is_the_file: skipped, there is no {}", file.display());
        return;
    }
    let run = |arguments: &[&str]| {
        let common = ["fly", "--rounds", "1", "--dependencies", "none", "--json"];
        let output = peers(&[&common[..], arguments].concat());
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        result["meshes"][0]["flights"][1].clone()
    };
    let (formula, read) = (run(&[]), run(&["--path", file.to_str().unwrap()]));
    for what in ["drawn", "tests", "operations"] {
        let mean = |flight: &Value| flight[what].as_f64().or(flight[what]["mean"].as_f64()).unwrap();
        assert!((mean(&formula) - mean(&read)).abs() <= 0.01 * mean(&read), "{what}: {formula} {read}");
    }
}
