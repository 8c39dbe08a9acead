//! Promise: the command line bakes g-meshes and lists their levels, takes any state out, flies over them, and changes metric and
//! placement between batches.
#![cfg(feature = "cli")]

use crate::command::{Folder, json};
use multires::io;
use multires::mesh::{Mesh, shapes};
use serde_json::Value;

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no count")) as usize
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list"))
}

fn built(folder: &Folder, mesh: &Mesh, how: &str) -> Value {
    let [input, baked] = ["in.ply", "all.mres"].map(|n| folder.file(n));
    io::write(&input, mesh).unwrap();
    json("build", &[&input, &baked], how).answer()
}

#[test]
fn a_g_mesh_is_baked_and_its_levels_are_listed() {
    let folder = Folder::new("gmesh-baked");
    let mesh = shapes::rock(10_000, 1);
    let built = built(&folder, &mesh, "--structure gmesh --coarsest 200");
    let [baked, out] = ["all.mres", "out.ply"].map(|n| folder.file(n));
    let info = json("info", &[&baked], "").answer();
    assert_eq!((&built["structure"], &info["kind"]), (&"gmesh".into(), &"gmesh".into()));
    assert_eq!((&built["order"], &built["independence"]), (&"batched".into(), &"matching".into()));
    for key in ["levels", "starts_by_volume", "starts_by_error", "memory", "origins_memory"] {
        assert_eq!(built[key], info[key], "{key}");
    }
    let levels = list(&info["levels"]);
    assert!((5..=8).contains(&levels.len()), "{}", levels.len());
    // Every batch is a level, and is listed with the same facts; the last keeps too much to be a level of its own, and takes the place
    // of the one before.
    let mut batches = list(&built["batches"]).to_vec();
    assert_eq!(batches.len(), levels.len() + 1);
    let joined = batches.remove(levels.len() - 1);
    let most = number(&joined["triangles"]) * 65 / 100;
    assert!(number(&batches[levels.len() - 1]["triangles"]) > most);
    for (batch, level) in batches.iter().zip(levels) {
        assert_eq!((&batch["triangles"], &batch["error"]), (&level["triangles"], &level["error"]));
        let [a, b] = [&batch["volume"], &level["volume"]].map(|volume| volume.as_f64().unwrap());
        assert!((a - b).abs() <= 1e-6 * a.abs());
    }
    let triangles: Vec<usize> = levels.iter().map(|level| number(&level["triangles"])).collect();
    assert_eq!(triangles[0], mesh.triangles().len());
    // All keep at most as much as a batch.
    assert!(triangles.windows(2).all(|pair| pair[1] * 100 < pair[0] * 65));

    for (level, count) in triangles.iter().enumerate().take(4) {
        for (part, share) in [("", 0.0), (".25", 0.25)] {
            let answer = json("extract", &[&baked, &out], &format!("--level {level}{part}")).answer();
            assert_eq!(io::read(&out).unwrap().triangles().len(), *count);
            let [low, high] = [level, level + 1].map(|level| levels[level]["error"].as_f64().unwrap());
            // On the way to a level, its error.
            let error = answer["error"].as_f64().unwrap();
            assert!((error - if share == 0.0 { low } else { high }).abs() < 1e-6);
        }
    }
    let same =
        json("build", &[&folder.file("in.ply"), &baked], "--structure gmesh --order batched --coarsest 200")
            .answer();
    assert_eq!((&same["independence"], &same["levels"]), (&built["independence"], &built["levels"]));
    let answer = json("extract", &[&baked, &out], "--triangles 3000").answer();
    assert!(number(&answer["output"]["triangles"]) <= 3000);
    let near = json("adapt", &[&baked, &out], "--eye 0,0,2 --target 0,0,0").answer();
    let far = json("adapt", &[&baked, &out], "--eye 0,0,50 --target 0,0,0").answer();
    assert!(number(&near["output"]["triangles"]) > number(&far["output"]["triangles"]));
}

/// A level with a fraction is a state of a g-mesh. Only the file says what it holds, so others refuse it once it is read.
#[test]
fn a_fraction_of_a_level_is_refused_where_nothing_morphs() {
    let folder = Folder::new("gmesh-fraction");
    let [input, baked, out] = ["in.ply", "all.mres", "out.ply"].map(|n| folder.file(n));
    io::write(&input, &shapes::terrain(17, 1)).unwrap();
    for (structure, reason) in [
        ("tom", "--level of this structure is from 0 to 1"),
        ("hierarchy", "--level of this structure is from 0 to 1"),
        ("wavelet", "--level of a wavelet mesh is a whole number"),
    ] {
        json("build", &[&input, &baked], &format!("--structure {structure}")).answer();
        let said = json("extract", &[&baked, &out], "--level 1.5");
        assert_ne!(said.code, Some(0), "{structure}");
        assert!(said.out.contains(reason), "{structure}: {}", said.out);
        assert_eq!(folder.names(), ["all.mres", "in.ply"]);
        // The fraction is what is refused.
        json("extract", &[&baked, &out], "--level 1").answer();
        std::fs::remove_file(&out).unwrap();
    }
}

#[test]
fn metric_and_placement_change_between_batches() {
    let folder = Folder::new("gmesh-schedule");
    let mesh = shapes::rock(4_000, 2);
    let all = |how: &str| built(&folder, &mesh, &format!("--structure hierarchy --order batched {how}"));
    let plain = all("--metric edge-length");
    let changed = all("--metric edge-length --schedule 0.5=quadric,0.1=lindstrom-turk/optimal");
    assert_eq!(number(&plain["vertices"]["all"]), number(&plain["vertices"]["finest"]));
    assert!(number(&changed["vertices"]["all"]) > number(&changed["vertices"]["finest"]));
    let stages = list(&changed["schedule"]);
    assert_eq!(stages[0]["metric"], "quadric");
    assert_eq!(
        (&stages[1]["metric"], &stages[1]["placement"]),
        (&"lindstrom-turk".into(), &"optimal".into())
    );
    // The first batches are the same: the schedule begins later.
    let [plain, changed] = [&plain, &changed].map(|built| list(&built["batches"]));
    assert_eq!(plain[1], changed[1]);
    assert_ne!(plain.last(), changed.last());
}

#[test]
fn arguments_without_a_use_are_refused() {
    let folder = Folder::new("gmesh-refused");
    let [input, baked] = ["in.ply", "all.mres"].map(|n| folder.file(n));
    io::write(&input, &shapes::cube()).unwrap();
    for (how, word) in [
        ("--structure tom --independence matching", "--order batched"),
        ("--structure tom --schedule 0.5=quadric", "--order batched"),
        ("--structure tom --order batched --schedule 0.5=quadric/optimal", "endpoint"),
        ("--structure tom --level-share 0.5", "gmesh"),
        ("--structure gmesh --level-share 0", "share"),
        ("--structure gmesh --schedule 0.5=cubic", "quadric"),
        ("--structure gmesh --schedule 2=quadric", "0 to 1"),
        ("--structure gmesh --schedule quadric", "SHARE=METRIC"),
        ("--structure wavelet --coarsest 5", "--coarsest"),
    ] {
        let said = json("build", &[&input, &baked], how);
        assert_ne!(said.code, Some(0), "{how}");
        assert!(said.out.contains(word), "{how}: {}", said.out);
    }
    assert_eq!(folder.names(), ["in.ply"]);
}
