//! A short run of all targets.

use std::process::Command;

#[test]
fn any_bytes_are_refused_or_taken() {
    let status =
        Command::new(env!("CARGO_BIN_EXE_bounded")).args(["--runs", "3000"]).status().expect("a run");
    assert!(status.success());
}
