//! A short run of all targets.

use std::process::Command;

use multires_fuzz::TARGETS;

fn run(runs: &str, is_built: bool) {
    let names = TARGETS.iter().filter(|target| target.is_built == is_built).map(|target| target.name);
    let status = Command::new(env!("CARGO_BIN_EXE_bounded"))
        .args(["--runs", runs])
        .args(names)
        .status()
        .expect("a run");
    assert!(status.success());
}

#[test]
fn any_bytes_are_refused_or_taken() {
    run("3000", false);
}

#[test]
fn whatever_is_built_keeps_its_promises() {
    run("1000", true);
}
