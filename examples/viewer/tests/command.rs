//! Promise: the program makes pictures and tables without a window, says which adapter draws, and exits 0, 1, 2 or 3 with one
//! line that says why.

mod card;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use card::open;
use multires::io;
use multires::lod::Structure;
use multires::mesh::shapes;
use multires::wavelet::WaveletMesh;
use multires_viewer::headless::read_png;

fn run(arguments: &[&str], environment: &[(&str, &str)]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_multires-viewer"));
    command.args(arguments).envs(environment.iter().copied()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder of a test's own, removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("multires-viewer-{}-{test}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const PATH: &str = "frame,ex,ey,ez,tx,ty,tz\n0,0,0.2,1.6,0,0,0\n5,0.4,0.2,1,0,0,0\n9,0.3,0.1,0.6,0,0,0\n";

/// Pixels of a picture that are darker in some colour than the background is.
fn surface(path: &Path) -> usize {
    let picture = read_png(path).unwrap();
    picture.pixels.iter().filter(|[r, g, b, _]| [r, g, b].into_iter().any(|&channel| channel < 200)).count()
}

#[test]
fn frames_of_a_path_become_pictures() {
    let Some(_) = open("frames_of_a_path_become_pictures") else { return };
    let folder = Folder::new("pictures");
    let (model, path, out) = (folder.file("rock.ply"), folder.file("path.csv"), folder.file("out"));
    io::write(&model, &shapes::rock(3_000, 1)).unwrap();
    std::fs::write(&path, PATH).unwrap();
    for shading in ["material", "level", "error", "normal", "texture", "dirty"] {
        let arguments = [
            model.as_str(),
            "--headless",
            "--path",
            &path,
            "--frames",
            "0,9",
            "--out",
            &out,
            "--size",
            "160x120",
            "--shading",
            shading,
            "--wire",
        ];
        let output = run(&arguments, &[]);
        assert!(output.status.success(), "{shading}: {}", text(&output.stderr));
        assert!(text(&output.stdout).starts_with("adapter "), "{}", text(&output.stdout));
        let [far, near] = ["frame-0000.png", "frame-0009.png"].map(|n| surface(&Path::new(&out).join(n)));
        assert!(far > 300 && near > 2 * far, "{shading}: {far} and {near} pixels");
        assert!(!Path::new(&out).join("frame-0005.png").exists());
    }
}

#[test]
fn every_structure_and_scene_is_drawn() {
    let Some(_) = open("every_structure_and_scene_is_drawn") else { return };
    let folder = Folder::new("scenes");
    let out = folder.file("out");
    let baked = folder.file("rock.mres");
    WaveletMesh::bake(&shapes::rock(1_280, 1)).unwrap().write(&baked).unwrap();
    let runs: [&[&str]; 11] = [
        &["--scene", "terrain", "--triangles", "5000", "--storage", "compact"],
        &["--scene", "rocks", "--triangles", "500", "--geomorph", "0.2"],
        &["--scene", "rocks", "--triangles", "500", "--structure", "tom"],
        &["--scene", "crowd", "--triangles", "2000", "--structure", "gmesh"],
        &["--scene", "crowd", "--triangles", "500", "--structure", "gmesh", "--budget-scene", "250000"],
        &["--scene", "demo", "--structure", "gmesh", "--placement", "optimal", "--geomorph", "0.2"],
        &["--scene", "demo", "--dependencies", "adjacent", "--budget", "5000"],
        &["--scene", "demo", "--placement", "midpoint", "--silhouette", "0.5", "--parametric"],
        &["--scene", "terrain", "--triangles", "5000", "--structure", "wavelet", "--shading", "texture"],
        &[
            "--scene",
            "rocks",
            "--triangles",
            "500",
            "--structure",
            "wavelet",
            "--storage",
            "compact",
            "--triangulation",
            "minimal",
            "--bound",
            "without-siblings",
            "--shading",
            "error",
        ],
        &[&baked, "--shading", "level", "--coordinates", "own"],
    ];
    for arguments in runs {
        let common = ["--headless", "--size", "200x150", "--tolerance", "2", "--out", &out];
        let output = run(&[arguments, &common].concat(), &[]);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        let shown = surface(&Path::new(&out).join("frame-0000.png"));
        assert!(shown > 1_000, "{arguments:?}: {shown} pixels");
    }
}

#[test]
fn the_bench_is_a_table() {
    let Some(_) = open("the_bench_is_a_table") else { return };
    let folder = Folder::new("bench");
    let path = folder.file("path.csv");
    std::fs::write(&path, PATH).unwrap();
    let arguments =
        ["--scene", "rocks", "--triangles", "500", "--bench", "--size", "64x48", "--path", path.as_str()];
    let output = run(&arguments, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for row in ["first picture after", "2 frames after it", "index bytes written", "all of the CPU, us"] {
        assert!(table.contains(row), "{table}");
    }
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let folder = Folder::new("wrong");
    let [bad, none, path, short] =
        ["bad.obj", "none.ply", "bad.csv", "short.csv"].map(|name| folder.file(name));
    std::fs::write(&bad, "v 0 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(&path, "0,1,2\n").unwrap();
    std::fs::write(&short, PATH).unwrap();
    let wrong = |arguments: &[&str], environment: &[(&str, &str)], code: i32, says: &str| {
        let output = run(arguments, environment);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
        assert!(error.contains(says), "{arguments:?}: {error}");
        if code != 2 {
            assert_eq!(error.trim_end().lines().count(), 1, "{error}");
        }
    };
    wrong(&["--shading", "pink"], &[], 2, "pink");
    wrong(&["--size", "0x5"], &[], 2, "0x5");
    wrong(&["a.ply", "--scene", "demo"], &[], 2, "--scene");
    // A backend that is not built in has no adapters.
    wrong(&["--headless"], &[("WGPU_BACKEND", "gl")], 3, "no graphics adapter was found");
    wrong(&["--headless", "--path", &path], &[], 1, "line 1");
    if open("what_is_wrong_is_said_in_one_line").is_some() {
        wrong(&[&bad, "--headless"], &[], 1, "bad.obj");
        wrong(&[&none, "--headless"], &[], 1, "none.ply");
        let odd = folder.file("odd.ply");
        io::write(&odd, &shapes::rock(500, 1)).unwrap();
        wrong(&[&odd, "--headless", "--structure", "wavelet"], &[], 1, "a vertex hierarchy takes any mesh");
        wrong(&["--headless", "--path", &short, "--frames", "3"], &[], 1, "no frame 3");
        wrong(&["--headless", "--texture", &none], &[], 1, "none.ply");
    }
}
