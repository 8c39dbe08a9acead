//! Promise: a window opens, shows every layout at any size, says what is wrong with a file, and closes; without a display there is
//! one line that says so.

mod card;

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Output, Stdio};

use card::open;

/// A display without a screen, ended with the test.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn open() -> Result<Self, String> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1024x768x24", "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("Xvfb cannot be run ({error})"))?;
        let mut number = String::new();
        if let Some(told) = server.stdout.as_mut() {
            let _ = BufReader::new(told).read_line(&mut number);
        }
        let name = format!(":{}", number.trim());
        let display = Self { server, name };
        if display.name == ":" { Err("Xvfb opened no display".to_owned()) } else { Ok(display) }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Runs the program on a display, or on none.
fn run(display: Option<&Display>, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_multires-viewer"));
    command.args(arguments).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").env_remove("DISPLAY");
    if let Some(display) = display {
        command.env("DISPLAY", &display.name);
    }
    command.output().unwrap()
}

#[test]
fn windows_open_and_close() {
    let test = "windows_open_and_close";
    let Some(_) = open(test) else { return };
    let display = match Display::open() {
        Ok(display) => display,
        Err(reason) => {
            eprintln!("skipped {test}: {reason}");
            return;
        }
    };
    let runs: [&[&str]; 9] = [
        &["--scene", "rocks", "--triangles", "500"],
        &["--scene", "rocks", "--triangles", "500", "--beside", "difference", "--size", "900x300"],
        &["--scene", "rocks", "--triangles", "500", "--beside", "distance", "--size", "900x300"],
        &["--scene", "terrain", "--triangles", "2000", "--beside", "full", "--size", "240x180", "--wire"],
        &[
            "--scene",
            "terrain",
            "--triangles",
            "2000",
            "--size",
            "300x700",
            "--beside",
            "full",
            "--geomorph",
            "0.1",
        ],
        &["--scene", "demo", "--structure", "tom", "--shading", "dirty"],
        &["--scene", "terrain", "--triangles", "2000", "--structure", "wavelet", "--shading", "texture"],
        &["--scene", "crowd", "--triangles", "500", "--structure", "gmesh", "--budget-scene", "250000"],
        &["no-such-file.ply"],
    ];
    for arguments in runs {
        let output = run(Some(&display), &[arguments, &["--end-after", "6"]].concat());
        let [said, error] = [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned());
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {said}{error}");
        assert!(said.contains("frames"), "{arguments:?}: {said}{error}");
        // A bad file is a message in the window, and in the last line here.
        assert_eq!(said.contains("no-such-file.ply: "), arguments == ["no-such-file.ply"], "{said}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_there_is_a_line() {
    let output = run(None, &[]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("no window could be opened"), "{error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{error}");
}
