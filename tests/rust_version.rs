//! The `rust-version` in Cargo.toml is no promise that a dependency breaks: no package that the library or its command
//! line builds on, with any features, asks for a newer Rust. Tests and benches may (they are not a user's concern).

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::{Value, json};

/// Major, minor, patch.
type Version = [u32; 3];

/// Every package that `root` is built from, normal and build dependencies, `root` left out: name and version, and the
/// Rust it asks for (zeros where it does not say).
fn dependencies(metadata: &Value, root: &str) -> Vec<(String, Version)> {
    let by_id = |list: &Value| -> BTreeMap<String, Value> {
        let entries = list.as_array().expect("cargo metadata lists packages and nodes");
        entries.iter().map(|e| (text(&e["id"]).to_owned(), e.clone())).collect()
    };
    let packages = by_id(&metadata["packages"]);
    let nodes = by_id(&metadata["resolve"]["nodes"]);

    let mut found = BTreeSet::new();
    let mut open: Vec<&str> =
        packages.values().filter(|p| p["name"] == root).map(|p| text(&p["id"])).collect();
    assert_eq!(open.len(), 1, "one package is named {root}");
    while let Some(id) = open.pop() {
        if !found.insert(id) {
            continue;
        }
        for dependency in nodes[id]["deps"].as_array().expect("every node has its dependencies") {
            let kinds = dependency["dep_kinds"].as_array().expect("every dependency has its kinds");
            if kinds.iter().any(|k| k["kind"] != "dev") {
                open.push(text(&dependency["pkg"]));
            }
        }
    }
    let packages = found.iter().map(|&id| &packages[id]).filter(|p| p["name"] != root);
    packages
        .map(|p| {
            (format!("{} {}", text(&p["name"]), text(&p["version"])), version(p["rust_version"].as_str()))
        })
        .collect()
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string in cargo metadata")
}

fn version(text: Option<&str>) -> Version {
    let mut version = [0; 3];
    for (part, digits) in version.iter_mut().zip(text.unwrap_or("0").split('.')) {
        *part = digits.parse().expect("a rust-version holds numbers and dots");
    }
    version
}

fn show(version: Version) -> String {
    version.map(|part| part.to_string()).join(".")
}

#[test]
fn no_dependency_asks_for_a_newer_rust_than_the_crate() {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(&cargo);
        command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output()
    };
    // Only what this platform builds: packages of other platforms may not be at hand.
    let about = match cargo(&["-vV"]) {
        Ok(output) => String::from_utf8_lossy(&output.stdout).into_owned(),
        Err(error) => {
            eprintln!(
                "skipped no_dependency_asks_for_a_newer_rust_than_the_crate: cargo cannot be run ({error})"
            );
            return;
        }
    };
    let host = about.lines().find_map(|line| line.strip_prefix("host: ")).expect("cargo names its host");
    let output = cargo(&["metadata", "--format-version", "1", "--all-features", "--filter-platform", host])
        .expect("cargo ran a moment ago");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON");

    let ours = version(Some(env!("CARGO_PKG_RUST_VERSION")));
    let dependencies = dependencies(&metadata, env!("CARGO_PKG_NAME"));
    assert!(dependencies.len() > 10, "the graph was read: {dependencies:?}");
    let newest = dependencies.iter().map(|d| d.1).max().unwrap_or_default();
    let dictating: Vec<&str> = dependencies.iter().filter(|d| d.1 == newest).map(|d| d.0.as_str()).collect();
    println!(
        "Rust {} is dictated by {}; this crate promises {}",
        show(newest),
        dictating.join(", "),
        show(ours)
    );

    let too_new: Vec<String> =
        dependencies.iter().filter(|d| d.1 > ours).map(|d| format!("{} needs {}", d.0, show(d.1))).collect();
    assert!(too_new.is_empty(), "rust-version is {}, but {}", show(ours), too_new.join(", "));
}

#[test]
fn the_graph_leaves_out_what_only_tests_need() {
    let package = |name: &str, rust: Value| json!({ "id": name, "name": name, "version": "1.2.3", "rust_version": rust });
    let edge = |to: &str, kinds: Value| json!({ "pkg": to, "dep_kinds": kinds });
    let (normal, build, dev) =
        (json!({ "kind": null }), json!({ "kind": "build" }), json!({ "kind": "dev" }));
    let metadata = json!({
        "packages": [
            package("root", json!("1.80")),
            package("direct", json!(null)),
            package("nested", json!("1.85.1")),
            package("script", json!("1.70")),
            package("tests", json!("1.99")),
        ],
        "resolve": { "nodes": [
            { "id": "root", "deps": [edge("direct", json!([dev, normal])), edge("tests", json!([dev]))] },
            { "id": "direct", "deps": [edge("nested", json!([normal])), edge("script", json!([build]))] },
            { "id": "nested", "deps": [edge("direct", json!([normal]))] },
            { "id": "script", "deps": [] },
            { "id": "tests", "deps": [] },
        ] },
    });
    let expected = [("direct 1.2.3", [0, 0, 0]), ("nested 1.2.3", [1, 85, 1]), ("script 1.2.3", [1, 70, 0])];
    assert_eq!(dependencies(&metadata, "root"), expected.map(|(name, rust)| (name.to_owned(), rust)));
}
