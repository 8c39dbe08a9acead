//! The command measures every contender to the counts asked for, and writes meshes that hold what it reported.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

fn peers(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_multires-peers")).args(arguments).output().unwrap()
}

#[test]
fn every_contender_reaches_its_target_and_writes_its_mesh() {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("simplify");
    let out = directory.to_str().unwrap();
    let output = peers(&[
        "simplify",
        "--generated",
        "--grid",
        "24",
        "--runs",
        "1",
        "--percent",
        "50,12.5",
        "--out",
        out,
        "--json",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = result["rows"].as_array().unwrap();
    assert!(rows.iter().any(|row| row["contender"] == "meshopt"));
    assert!(rows.len() >= 4);
    for row in rows {
        let (target, reached) = (row["target"].as_u64().unwrap(), row["reached"].as_u64().unwrap());
        assert!(reached > 0 && reached <= target, "{row}");
        assert!(row["median_ms"].as_f64().unwrap() > 0.0, "{row}");
        let name = format!(
            "{}.{}.{}.ply",
            row["mesh"].as_str().unwrap(),
            row["contender"].as_str().unwrap(),
            row["percent"].as_f64().unwrap()
        );
        let bytes = std::fs::read(directory.join(name)).unwrap();
        let header = String::from_utf8_lossy(&bytes[..bytes.len().min(300)]).into_owned();
        assert!(header.contains(&format!("element face {reached}\n")), "{header}");
    }
    // What was written is itself a model that the command reads.
    let original = directory.join("terrain-24.original.ply");
    let again = peers(&["simplify", original.to_str().unwrap(), "--runs", "1", "--percent", "50"]);
    assert!(again.status.success());
    assert!(String::from_utf8_lossy(&again.stdout).contains("1152"));
}

#[test]
fn bad_input_and_wrong_usage_differ_in_status() {
    assert_eq!(peers(&[]).status.code(), Some(2));
    assert_eq!(peers(&["simplify"]).status.code(), Some(2));
    assert_eq!(peers(&["simplify", "--generated", "--runs", "0"]).status.code(), Some(2));
    assert_eq!(peers(&["simplify", "--generated", "--only", "nobody"]).status.code(), Some(2));
    let missing = peers(&["simplify", "no-such-file.ply"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no-such-file.ply"));
}
