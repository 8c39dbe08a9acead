//! Promise: a write goes through links to the file they lead to, leaves nothing behind when its process is killed that the next
//! process does not remove, and disturbs no other write to the same file.
#![cfg(target_os = "linux")]

use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::Command;

use multires::io::atomic;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn names(folder: &PathBuf) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn links_to_files_that_are_not_there_are_kept() {
    let folder = folder("dangling");
    std::fs::create_dir(folder.join("deep")).unwrap();
    symlink("deep/two", folder.join("one")).unwrap();
    symlink("../three", folder.join("deep/two")).unwrap();
    atomic::write(folder.join("one"), b"new").unwrap();
    assert!(std::fs::symlink_metadata(folder.join("one")).unwrap().is_symlink());
    assert!(std::fs::symlink_metadata(folder.join("deep/two")).unwrap().is_symlink());
    assert_eq!(std::fs::read(folder.join("three")).unwrap(), b"new");
    assert_eq!(
        (names(&folder), names(&folder.join("deep"))),
        (["deep", "one", "three"].map(String::from).to_vec(), vec!["two".to_owned()])
    );

    // Into a folder that is not there, and in a circle: refused, and the links stay.
    symlink("nowhere/file", folder.join("lost")).unwrap();
    symlink("round", folder.join("round")).unwrap();
    assert_eq!(atomic::write(folder.join("lost"), b"x").unwrap_err().kind(), std::io::ErrorKind::NotFound);
    let round = atomic::write(folder.join("round"), b"x").unwrap_err();
    assert!(round.to_string().contains("links"), "{round}");
    for link in ["lost", "round"] {
        assert!(std::fs::symlink_metadata(folder.join(link)).unwrap().is_symlink());
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// Says that this process is the writer, and whether it is killed while it writes.
const WRITER: &str = "MULTIRES_TEST_WRITER";

/// The process that is killed, or writes at the same time, into its working directory; no test where nobody started it as that.
#[test]
fn writer() {
    let Some(killed) = std::env::var_os(WRITER).map(|how| how == "killed") else { return };
    for round in 0..50_u8 {
        let content = [std::process::id() as u8 ^ round; 1000];
        let written = atomic::write_with("out.mres", |file| {
            std::io::Write::write_all(file, &content)?;
            if killed {
                let _ = Command::new("kill").args(["-9", &std::process::id().to_string()]).status();
            }
            Ok(())
        });
        written.unwrap();
    }
}

fn start_writer(folder: &PathBuf, how: &str) -> std::process::Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "atomic_links::writer"])
        .env(WRITER, how)
        .current_dir(folder)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn what_a_killed_process_left_is_removed_by_the_next() {
    let folder = folder("killed");
    std::fs::write(folder.join("out.mres"), b"old").unwrap();
    let mut child = start_writer(&folder, "killed");
    assert_eq!(child.wait().unwrap().code(), None);
    assert_eq!(std::fs::read(folder.join("out.mres")).unwrap(), b"old");
    let left = names(&folder);
    assert!(left.len() == 2 && left[0].ends_with(".multires.tmp"), "{left:?}");
    // Files of others stay, whatever they are called.
    for foreign in [".out.mres.tmp", ".a.multires.tmp", ".a.00000001-1-1-0.multires.tmp"] {
        std::fs::write(folder.join(foreign), b"mine").unwrap();
    }
    // One of this very process, which is running.
    let written = atomic::write_with(folder.join("out.mres"), |file| {
        let before = names(&folder);
        assert!(!before.contains(&left[0]) && before.len() == 5, "{before:?}");
        assert!(start_writer(&folder, "lives").wait().unwrap().success());
        assert_eq!(names(&folder), before, "a running process keeps its file");
        std::io::Write::write_all(file, b"last")
    });
    written.unwrap();
    assert_eq!(std::fs::read(folder.join("out.mres")).unwrap(), b"last");
    assert_eq!(names(&folder).len(), 4);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn processes_that_write_one_file_leave_one_whole_file() {
    let folder = folder("two");
    let mut writers: Vec<_> = (0..4).map(|_| start_writer(&folder, "lives")).collect();
    for writer in &mut writers {
        assert!(writer.wait().unwrap().success());
    }
    let content = std::fs::read(folder.join("out.mres")).unwrap();
    assert!(content.len() == 1000 && content.iter().all(|byte| *byte == content[0]));
    assert_eq!(names(&folder), ["out.mres"]);
    std::fs::remove_dir_all(folder).unwrap();
}
