//! Promise: no file makes the command line panic; levels of every real model keep its topology, its orientation, its
//! materials, and its surface free of new borders, flips and slivers; and what views ask for of its hierarchy keeps its topology,
//! its materials, and its surface free of new borders.
//!
//! *Flipped* is said of a collapse: it turns the normal of a triangle that survives it by 90 degrees or more. A level as
//! such has no flipped triangles where no collapse that leads to it flips any. Triangles whose area is at most 1e-6 of
//! the square of their longest edge have no normal worth the name and are not asked.
#![cfg(feature = "cli")]

use std::path::{Path, PathBuf};

use crate::command::{Folder, Said, json};
use glam::DVec3;
use multires::io::{self, Format};
use multires::lod::{Baked, Level};
use multires::mesh::{Mesh, Report};
use multires::simplify::{CollapseSequence, Parts, Simplifier};
use multires::tom::{TomOptions, TotallyOrderedMesh};

/// The model files of a part of the collection; `None`, with a word on stderr, where it is not there.
fn models(part: &str) -> Option<Vec<PathBuf>> {
    let mut folders = vec![crate::models::find("cli/every_model", part)?];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.filter_map(|e| Some(e.ok()?.path())) {
            if path.is_dir() {
                folders.push(path);
            } else if Format::from_path(&path).is_some() {
                files.push(path);
            }
        }
    }
    files.sort();
    Some(files)
}

/// All commands on one file. The mesh and two of its levels as the commands wrote them; `None` where the file was
/// refused, by all commands and with the same reason.
fn commands(file: &Path, folder: &Folder) -> Option<(Mesh, [Mesh; 3])> {
    let [output, baked, level] = ["out.ply", "all.mres", "level.ply"].map(|n| folder.file(n));
    let commands = [
        json("info", &[file], ""),
        json("simplify", &[file, &output], "--ratio 0.1 --keep-parts --permissive off"),
        json("build", &[file, &baked], "--structure tom --keep-parts"),
    ];
    if commands[0].code == Some(1) {
        let reasons = commands.each_ref().map(Said::refusal);
        assert!(reasons.iter().all(|r| r == &reasons[0]), "{reasons:?}");
        assert!(io::read(file).is_err() && folder.names().is_empty());
        return None;
    }
    let [info, simplified, built] = commands.map(|said| said.answer());
    let mesh = io::read(file).unwrap();
    assert_eq!(info["stored"]["triangles"], mesh.triangles().len());
    let levels = ["--level 0.3", "--level 0"].map(|how| {
        let answer = json("extract", &[&baked, &level], how).answer();
        let result = io::read(&level).unwrap();
        assert_eq!(answer["output"]["triangles"], result.triangles().len());
        result
    });
    assert_eq!(built["coarsest"]["triangles"], levels[1].triangles().len());
    let simple = io::read(&output).unwrap();
    assert_eq!(simplified["output"]["triangles"], simple.triangles().len());
    let stuck = simplified["stop"] == "nothing-legal" || simplified["stop"] == "guard";
    assert!(stuck || 10 * simple.triangles().len() <= mesh.triangles().len());
    for name in ["out.ply", "all.mres", "level.ply"] {
        std::fs::remove_file(folder.file(name)).unwrap();
    }
    assert!(folder.names().is_empty());
    let [middle, base] = levels;
    Some((mesh, [simple, middle, base]))
}

/// The hierarchy of one file, through all commands: what two views ask for, and a flight. With all neighbours as
/// dependencies every split happens in the star that the simplifier judged, so topology is kept at every cut.
fn hierarchy(file: &Path, folder: &Folder) -> Vec<(String, Mesh)> {
    let [baked, level, camera, frames] =
        ["all.mres", "level.ply", "camera.csv", "frames.csv"].map(|n| folder.file(n));
    let mut path = "frame,ex,ey,ez,tx,ty,tz\n".to_owned();
    for frame in 0..20 {
        let (angle, far) = (0.1 * f64::from(frame), 0.4 + 0.05 * f64::from(frame));
        path += &format!("{frame},{},0.2,{},0,0,0\n", far * angle.sin(), far * angle.cos());
    }
    let mut levels = Vec::new();
    for policy in ["neighbours", "none"] {
        let how = format!("--structure hierarchy --dependencies {policy} --keep-parts");
        let built = json("build", &[file, &baked], &how).answer();
        let info = json("info", &[&baked], "").answer();
        assert_eq!((&info["splits"], &info["dependencies"]), (&built["splits"], &policy.into()));
        for view in ["--eye 0.1,0.2,0.6 --tolerance 2", "--eye -1.5,0.3,1 --tolerance 8 --silhouette 2"] {
            let said = json("adapt", &[&baked, &level], &format!("{view} --target 0,0,0"));
            // A box larger than single precision has no view from beyond it.
            if said.code == Some(1) {
                assert!(said.refusal().contains("finite"), "{file:?}");
                continue;
            }
            let answer = said.answer();
            let mesh = io::read(&level).unwrap();
            assert_eq!(answer["output"]["triangles"], mesh.triangles().len());
            levels.push((format!("--dependencies {policy} {view}"), mesh));
        }
        std::fs::write(&camera, &path).unwrap();
        let how = format!("--path {} --csv {}", camera.display(), frames.display());
        let said = json("fly", &[&baked], &how);
        if said.code == Some(1) {
            assert!(said.refusal().contains("finite"), "{file:?}");
        } else {
            assert_eq!(said.answer()["frames"], 20);
            assert_eq!(std::fs::read_to_string(&frames).unwrap().lines().count(), 21);
        }
    }
    for name in folder.names() {
        std::fs::remove_file(folder.file(&name)).unwrap();
    }
    levels
}

/// What a view's mesh does not keep of its model, with or without dependencies.
fn breaches_of_a_view(mesh: &Mesh, level: &Mesh, all_neighbours: bool) -> Vec<String> {
    let sheets = Report::new(mesh).duplicate_triangles > 0;
    let [before, after] = [mesh, level].map(|mesh| Report::welded(&without_collapsed(mesh, sheets)));
    let mut breaches = Vec::new();
    let mut check = |holds: bool, what: &str| {
        if !holds {
            breaches.push(format!("{what} {before:?} {after:?}"));
        }
    };
    check(after.border_edges <= before.border_edges, "border edges");
    check(materials(level) == materials(mesh), "materials");
    if all_neighbours {
        check(after.euler_characteristic == before.euler_characteristic, "Euler characteristic");
        check(after.components == before.components, "components");
        check(after.non_manifold_edges <= before.non_manifold_edges, "non-manifold edges");
        check(after.non_manifold_vertices <= before.non_manifold_vertices, "non-manifold vertices");
    }
    breaches
}

fn materials(mesh: &Mesh) -> Vec<u32> {
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.dedup();
    ids
}

/// The mesh without triangles that have two corners at one position: they have no area, and no level keeps them. And, where
/// `sheets` says so, with those over the same three positions once: they are simplified as one.
fn without_collapsed(mesh: &Mesh, sheets: bool) -> Mesh {
    let at = |v: u32| mesh.positions()[v as usize];
    let mut seen = std::collections::BTreeSet::new();
    let is_whole = |&&[a, b, c]: &&[u32; 3]| {
        let mut sheet = [a, b, c].map(|v| at(v).map(|x| (x + 0.0).to_bits()));
        sheet.sort_unstable();
        at(a) != at(b) && at(b) != at(c) && at(c) != at(a) && (seen.insert(sheet) || !sheets)
    };
    Mesh::new(mesh.positions(), mesh.triangles().iter().filter(is_whole).copied().collect::<Vec<_>>())
        .unwrap()
}

/// What something is to a level: as it is, and with cracks of rounding closed, as the simplifier takes it.
fn taken(mesh: &Mesh) -> Vec<Mesh> {
    let cracks = Report::new(mesh).near_twins > 0;
    std::iter::once(mesh.clone()).chain(cracks.then(|| mesh.welded(1e-6 * mesh.diagonal()))).collect()
}

/// What a level does not keep of its mesh, taken in the way that has least of it.
fn least(mesh: &Mesh, breaches: impl Fn(&Mesh) -> Vec<String>) -> Vec<String> {
    taken(mesh).iter().map(breaches).min_by_key(Vec::len).unwrap_or_default()
}

/// What a level does not keep of its mesh.
fn breaches(mesh: &Mesh, level: &Mesh) -> Vec<String> {
    let sheets = Report::new(mesh).duplicate_triangles > 0;
    let [before, after] = [mesh, level].map(|mesh| Report::welded(&without_collapsed(mesh, sheets)));
    let mut breaches = Vec::new();
    let mut check = |holds: bool, what: &str| {
        if !holds {
            breaches.push(format!("{what} {before:?} {after:?}"));
        }
    };
    check(after.euler_characteristic == before.euler_characteristic, "Euler characteristic");
    check(after.components == before.components, "components");
    check(after.is_closed() == before.is_closed(), "closed");
    check(after.border_edges <= before.border_edges, "border edges");
    check(after.non_manifold_edges <= before.non_manifold_edges, "non-manifold edges");
    check(after.non_manifold_vertices <= before.non_manifold_vertices, "non-manifold vertices");
    check(after.flipped_edges <= before.flipped_edges, "flipped edges");
    check(after.degenerate_triangles <= before.degenerate_triangles, "degenerate triangles");
    check(materials(level) == materials(mesh), "materials");
    let streams =
        |mesh: &Mesh| mesh.attributes().iter().map(|a| (a.name().to_owned(), a.width())).collect::<Vec<_>>();
    check(streams(level) == streams(mesh), "attributes");
    breaches
}

/// Replays every collapse of an endpoint sequence, counting flipped triangles.
fn flips(mesh: &Mesh, sequence: &CollapseSequence) -> usize {
    let mut triangles = mesh.triangles().to_vec();
    let mut folded: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    sequence.aliases().iter().for_each(|&[duplicate, kept]| folded[duplicate as usize] = kept);
    triangles.as_flattened_mut().iter_mut().for_each(|v| *v = folded[*v as usize]);
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); mesh.positions().len()];
    for (t, corners) in triangles.iter().enumerate() {
        corners.iter().for_each(|&v| around[v as usize].push(t as u32));
    }
    let normal = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let normal = (b - a).cross(c - a);
        (normal.length() > 2e-6 * longest).then(|| normal.normalize())
    };
    let mut flipped = 0;
    let mut changed: Vec<u32> = Vec::new();
    for step in 0..sequence.len() {
        changed.clear();
        for &[from, _] in sequence.substitutions(step) {
            changed.extend(&around[from as usize]);
        }
        changed.sort_unstable();
        changed.dedup();
        let before: Vec<_> = changed.iter().map(|&t| normal(triangles[t as usize])).collect();
        for &[from, to] in sequence.substitutions(step) {
            let moved = std::mem::take(&mut around[from as usize]);
            for &t in &moved {
                triangles[t as usize].iter_mut().filter(|v| **v == from).for_each(|v| *v = to);
            }
            around[to as usize].extend(moved);
        }
        let pairs = changed.iter().zip(before);
        flipped += pairs
            .filter_map(|(&t, before)| Some((before?, normal(triangles[t as usize])?)))
            .filter(|(before, after)| before.dot(*after) <= 0.0)
            .count();
    }
    flipped
}

/// Where the triangles of a mesh are: sorted, each from its lowest corner on.
fn places(mesh: &Mesh) -> Vec<[[u32; 3]; 3]> {
    let at = |v: u32| mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits());
    let mut all: Vec<[[u32; 3]; 3]> = mesh.triangles().iter().map(|t| t.map(at)).collect();
    all.iter_mut().for_each(|t| {
        let low = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        t.rotate_left(low);
    });
    all.sort_unstable();
    all
}

/// The wavelets of one file, through all commands. Triangles of its base mesh; `None` where it was refused, with a line that
/// names it and says what else to do.
fn wavelets(file: &Path, folder: &Folder) -> Option<usize> {
    let [baked, level, camera, frames] =
        ["all.mres", "level.ply", "camera.csv", "frames.csv"].map(|n| folder.file(n));
    let built = json("build", &[file, &baked], "--structure wavelet");
    if built.code == Some(1) {
        let reason = built.refusal();
        let name = file.file_name().unwrap().to_string_lossy();
        assert!(reason.contains(&*name), "{reason}");
        assert!(io::read(file).is_err() || reason.contains("--structure hierarchy"), "{reason}");
        assert!(folder.names().is_empty());
        return None;
    }
    let built = built.answer();
    let info = json("info", &[&baked], "").answer();
    assert_eq!((&info["levels"], &info["wavelets"]), (&built["levels"], &built["wavelets"]));
    let depth = info["levels"].as_u64().unwrap();
    let extract = |how: &str| {
        let answer = json("extract", &[&baked, &level], how).answer();
        let mesh = io::read(&level).unwrap();
        assert_eq!(answer["output"]["triangles"], mesh.triangles().len());
        mesh
    };
    let mesh = io::read(file).unwrap();
    let finest = extract(&format!("--level {depth}"));
    assert_eq!(finest.triangles().len(), mesh.triangles().len(), "{file:?}");
    assert!(places(&finest) == places(&mesh), "{file:?}");
    let streams =
        |mesh: &Mesh| mesh.attributes().iter().map(|a| (a.name().to_owned(), a.width())).collect::<Vec<_>>();
    assert!(streams(&finest) == streams(&mesh), "{file:?}");
    let euler = Report::welded(&mesh).euler_characteristic;
    for how in ["--ratio 0.3", "--level 1", "--level 0"] {
        let mesh = extract(how);
        assert_eq!(Report::welded(&mesh).euler_characteristic, euler, "{file:?} {how}");
    }
    let base = io::read(&level).unwrap().triangles().len();
    assert_eq!(info["base_triangles"], base);

    let mut path = "frame,ex,ey,ez,tx,ty,tz\n".to_owned();
    for frame in 0..20 {
        let (angle, far) = (0.1 * f64::from(frame), 0.4 + 0.05 * f64::from(frame));
        path += &format!("{frame},{},0.2,{},0,0,0\n", far * angle.sin(), far * angle.cos());
    }
    std::fs::write(&camera, &path).unwrap();
    for style in ["--triangulation exact", "--triangulation minimal"] {
        let view = "--eye 0.1,0.2,0.8 --target 0,0,0 --tolerance 2";
        let said = json("adapt", &[&baked, &level], &format!("{view} {style}"));
        // A box larger than single precision has no view from beyond it.
        if said.code == Some(1) {
            assert!(said.refusal().contains("finite"), "{file:?}");
            continue;
        }
        let answer = said.answer();
        let seen = io::read(&level).unwrap();
        assert_eq!(answer["output"]["triangles"], seen.triangles().len());
        assert_eq!(Report::welded(&seen).euler_characteristic, euler, "{file:?} {style}");
        assert!((base..=mesh.triangles().len()).contains(&seen.triangles().len()), "{file:?} {style}");
        let how = format!("--path {} --csv {} {style}", camera.display(), frames.display());
        assert_eq!(json("fly", &[&baked], &how).answer()["frames"], 20);
    }
    for name in folder.names() {
        std::fs::remove_file(folder.file(&name)).unwrap();
    }
    Some(base)
}

/// Every mesh here that has the connectivity, and how many faces its base has; some others.
const BASES: [(&str, usize); 13] = [
    ("3holes.ply", 450),
    ("boat.obj", 2026),
    ("bumpy-s2.ply", 2496),
    ("bunny-rand-s1.obj", 500),
    ("bunny-rand-s2.obj", 500),
    ("bunny-rand-s3.ply", 500),
    ("bunny-ssp-s1.obj", 499),
    ("bunny-ssp-s2.obj", 499),
    ("cube-uv-s1.obj", 12),
    ("icosphere-s3.obj", 20),
    ("penguin-s3.ply", 6720),
    ("torus-s3.obj", 72),
    ("homer.obj", 3000),
];

#[test]
fn wavelets_of_subdivision_meshes() {
    let (Some(mut files), Some(real)) = (models("subdivision"), models("real")) else { return };
    files.extend(real.into_iter().filter(|file| file.ends_with("homer.obj") || file.ends_with("cow.obj")));
    let folder = Folder::new("subdivision-wavelets");
    let mut found = Vec::new();
    for file in &files {
        let name = file.file_name().unwrap().to_string_lossy();
        let base = wavelets(file, &folder);
        found.extend(base.map(|base| (name.into_owned(), base)));
    }
    found.sort();
    let mut known = BASES.map(|(name, base)| (name.to_owned(), base));
    known.sort();
    assert_eq!(found, known);
}

#[test]
fn wavelets_of_hostile_files() {
    let Some(files) = models("hostile") else { return };
    let folder = Folder::new("hostile-wavelets");
    for file in &files {
        let _ = wavelets(file, &folder);
    }
}

/// Everything about one part of the collection; only the files named in `refused` may be.
fn check(part: &str, refused: &[&str]) {
    let Some(files) = models(part) else { return };
    let folder = Folder::new(part);
    let (mut not_loaded, mut broken) = (Vec::new(), Vec::new());
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let Some((mesh, levels)) = commands(&file, &folder) else {
            not_loaded.push(name);
            continue;
        };
        for (level, how) in levels.iter().zip(["--ratio 0.1", "--level 0.3", "--level 0"]) {
            let found = least(&mesh, |mesh| breaches(mesh, level));
            broken.extend(found.into_iter().map(|breach| format!("{name} {how}: {breach}")));
        }
        for (how, level) in hierarchy(&file, &folder) {
            let found = least(&mesh, |mesh| breaches_of_a_view(mesh, &level, how.contains("neighbours")));
            broken.extend(found.into_iter().map(|breach| format!("{name} {how}: {breach}")));
        }
        let sequence = Simplifier::new().parts(Parts::Keep).run(&mesh).unwrap();
        let flipped = flips(&mesh, &sequence);
        // Spheres of 1e-30 beside one of 3e38 are points to single precision, and points have no side to turn.
        if flipped > 0 && name != "huge_tiny_coords.obj" {
            broken.push(format!("{name}: {flipped} flipped triangles"));
        }
        let bundle =
            Baked::<TotallyOrderedMesh>::of_sequence(&mesh, &sequence, &TomOptions::default()).unwrap();
        let base = bundle.level(Level::Ratio(0.0)).mesh;
        assert_eq!(base.triangles().len(), levels[2].triangles().len(), "{name}");
        if !mesh.triangles().is_empty() {
            assert!(bundle.level(Level::Ratio(1.0)).mesh.triangles().len() <= mesh.triangles().len());
        }
    }
    assert_eq!(not_loaded, refused);
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn real_models() {
    check("real", &[]);
}

#[test]
fn game_assets() {
    check("game", &[]);
}

#[test]
fn subdivision_meshes() {
    check("subdivision", &[]);
}

#[test]
fn hostile_files() {
    let refused =
        ["bad_index.glb", "bad_index.obj", "huge_count.ply", "nan_inf.obj", "truncated.ply", "truncated.stl"];
    check("hostile", &refused);
}
