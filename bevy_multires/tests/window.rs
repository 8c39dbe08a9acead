//! The example in a window draws 500 models and their levels. With feature `window`: `cargo test -p bevy_multires --features window`

use std::process::Command;

/// Returns a screen to draw on: the user's, or one of Xvfb.
fn screen() -> Option<Command> {
    let example = std::env::current_exe().ok()?.parent()?.parent()?.join("examples/models");
    if !example.exists() {
        eprintln!("there is no {}: build the examples too", example.display());
        return None;
    }
    if std::env::var_os("DISPLAY").is_some() {
        return Some(Command::new(example));
    }
    let found = Command::new("xvfb-run").arg("--help").output().is_ok_and(|output| output.status.success());
    found.then(|| {
        let mut command = Command::new("xvfb-run");
        command.arg("-a").arg("--server-args=-screen 0 1280x720x24").arg(example);
        command
    })
}

#[test]
fn the_example_in_a_window() {
    let Some(mut command) = screen() else {
        eprintln!("the_example_in_a_window skips: there is no screen, and no xvfb-run");
        return;
    };
    let output = command.args(["--frames", "5"]).output().expect("the example runs");
    let (said, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if errors.contains("Unable to find a GPU") {
        eprintln!("the_example_in_a_window skips: there is no adapter to draw with");
        return;
    }
    assert!(output.status.success(), "{errors}");
    assert!(said.contains("triangles after 5 frames"), "{said}{errors}");
}
