//! Promise: no file makes a reader panic or hang, and each broken one has the outcome that is written here.
#![cfg(feature = "io")]

use std::path::{Path, PathBuf};

use multires::io::{self, Format, Imported, ReadError, ReadOptions, SceneOrigin};
use multires::mesh::{Attribute, Mesh, Topology};
use proptest::prelude::*;

const FORMATS: [Format; 6] = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb, Format::Gltf];

/// The folder of broken files, or a word on stderr that the test is skipped.
fn hostile(test: &str) -> Option<PathBuf> {
    crate::models::find(test, "hostile")
}

fn load(path: &Path) -> Result<Imported, ReadError> {
    io::read_with(path, &ReadOptions::default())
}

/// What a reader must make of a file.
enum Outcome {
    /// Vertices, triangles, and words of the only note (or of none).
    Mesh(usize, usize, &'static str),
    /// Words in the error.
    Refused(&'static str),
}

use Outcome::{Mesh as Loads, Refused};

const TABLE: &[(&str, Outcome)] = &[
    ("angle_block.stl", Loads(398, 704, "")),
    ("bad_index.glb", Refused("but there are 42 vertices")),
    ("bad_index.obj", Refused("line 124: a face names vertex 0")),
    (
        "bad_uv.obj",
        Loads(70, 80, "3 texture or normal indices name nothing and count as not given, such as at line 142"),
    ),
    ("book_edge.obj", Loads(172, 328, "")),
    ("bowtie_vertex.obj", Loads(90, 164, "")),
    ("bunny-nonmanifold.ply", Loads(8_171, 16_301, "")),
    ("crlf_mess.obj", Loads(19, 8, "")),
    ("degenerate_faces.obj", Loads(175, 329, "")),
    ("duplicate_faces.obj", Loads(162, 345, "")),
    ("far_offset.obj", Loads(2_562, 5_120, "")),
    ("flipped_half.obj", Loads(642, 1_280, "")),
    ("huge_count.ply", Refused("truncated: 4294967295 entries of element \"vertex\"")),
    ("huge_tiny_coords.obj", Loads(246, 480, "")),
    ("islands.obj", Loads(1_250, 1_200, "")),
    ("joined_tetrahedra.obj", Loads(15, 8, "")),
    ("moebius.obj", Loads(180, 240, "")),
    ("multibody.stl", Loads(20, 32, "")),
    ("nan_inf.obj", Refused("vertex 5 has a non-finite position")),
    ("nancolor.obj", Loads(8, 12, "\"color\" has 3 non-finite values, first at vertex 6")),
    ("near_duplicates.obj", Loads(3_840, 1_280, "")),
    ("negative_indices.obj", Loads(24, 12, "")),
    ("pillow_and_hub.obj", Loads(1_016, 2_011, "")),
    ("shared.stl", Loads(14, 24, "")),
    ("soup.stl", Loads(300, 100, "")),
    ("truck.obj", Loads(2_956, 4_770, "")),
    ("truncated.ply", Refused("truncated: a list of 3 values at byte 18323, 6 bytes are left")),
    ("truncated.stl", Refused("truncated: 320 triangles are declared, 199 are there")),
    ("wallhole.obj", Loads(92, 66, "")),
    ("zero_bytes.obj", Loads(0, 0, "")),
];

#[test]
fn every_hostile_file_has_its_outcome() {
    let Some(folder) = hostile("every_hostile_file_has_its_outcome") else { return };
    let mut wrong = Vec::new();
    for (file, outcome) in TABLE {
        let loaded = load(&folder.join(file));
        match (outcome, &loaded) {
            (&Loads(vertices, triangles, note), Ok(found)) => {
                let counts = (found.mesh.positions().len(), found.mesh.triangles().len());
                if counts != (vertices, triangles) || !found.notes.join("; ").contains(note) {
                    wrong.push(format!("{file}: {counts:?} {:?}", found.notes));
                }
            }
            (Refused(words), Err(error)) => {
                let message = error.to_string();
                if !message.contains(words) || message.contains('\n') {
                    wrong.push(format!("{file}: {message}"));
                }
            }
            (_, Ok(found)) => {
                wrong.push(format!("{file}: loads {} {:?}", found.mesh.positions().len(), found.notes))
            }
            (_, Err(error)) => wrong.push(format!("{file}: {error}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let listed = |name: &str| TABLE.iter().any(|(file, _)| *file == name);
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(listed(&name), "{name} has no outcome");
    }
}

/// Open edges after welding by position: none on a closed surface.
pub fn open_edges(mesh: &Mesh) -> usize {
    let topology = Topology::new(mesh);
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for triangle in mesh.triangles() {
        let points = triangle.map(|v| topology.point_of()[v as usize]);
        edges.extend((0..3).map(|i| [points[i], points[(i + 1) % 3]]).map(|[a, b]| [a.min(b), a.max(b)]));
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|edge| edge.len() == 1).count()
}

#[test]
fn ugly_but_readable_text_gives_a_closed_octahedron() {
    let Some(folder) = hostile("ugly_but_readable_text_gives_a_closed_octahedron") else { return };
    let mesh = load(&folder.join("crlf_mess.obj")).unwrap().mesh;
    assert_eq!(open_edges(&mesh), 0);
    assert_eq!(Topology::new(&mesh).point_count(), 7);
    assert_eq!(mesh.material_names(), ["été"]);
    assert_eq!(mesh.positions().last(), Some(&[9.0; 3]));
}

#[test]
fn concave_polygons_give_no_triangle_without_area() {
    let Some(folder) = hostile("concave_polygons_give_no_triangle_without_area") else { return };
    let mesh = load(&folder.join("wallhole.obj")).unwrap().mesh;
    assert_eq!(open_edges(&mesh), 0);
    let at = |v: u32| glam::DVec3::from_array(mesh.positions()[v as usize].map(f64::from));
    let normals = mesh.attribute("normal").unwrap().as_floats().unwrap();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(at);
        let area = (b - a).cross(c - a);
        assert!(area.length() > 1e-6, "{t:?}");
        let n = &normals[3 * t[0] as usize..][..3];
        assert!(area.dot(glam::DVec3::new(n[0].into(), n[1].into(), n[2].into())) > 0.0, "{t:?} is flipped");
    }
}

#[test]
fn bad_texture_indices_are_told_and_the_geometry_is_kept() {
    let Some(folder) = hostile("bad_texture_indices_are_told_and_the_geometry_is_kept") else { return };
    let found = load(&folder.join("bad_uv.obj")).unwrap();
    assert_eq!(Topology::new(&found.mesh).point_count(), 42);
    assert_eq!(open_edges(&found.mesh), 0);
    let notes = found.notes.join("\n");
    assert!(notes.contains("3 texture or normal indices name nothing"), "{notes}");
    assert!(notes.contains("\"uv\" has 2 non-finite values"), "{notes}");
}

#[test]
fn moving_the_origin_keeps_small_things_far_away() {
    let Some(folder) = hostile("moving_the_origin_keeps_small_things_far_away") else { return };
    let path = folder.join("far_offset.obj");
    let keep = ReadOptions::default().with_origin(SceneOrigin::Keep);
    let kept = Topology::new(&io::read_with(&path, &keep).unwrap().mesh).point_count();
    assert_eq!(kept, 1_027);
    let moved = load(&path).unwrap();
    assert_eq!(Topology::new(&moved.mesh).point_count(), 2_562, "moved by itself");
    assert!(moved.notes.iter().any(|note| note.contains("relative to")), "{:?}", moved.notes);
    let options = ReadOptions::default().with_origin(SceneOrigin::Center);
    let moved = io::read_with(&path, &options).unwrap();
    assert_eq!(Topology::new(&moved.mesh).point_count(), 2_562);
    assert!((moved.mesh.diagonal() - 0.1732).abs() < 1e-3);
    assert!((moved.origin[1] - 5_411_932.5).abs() < 1e-6, "{:?}", moved.origin);
    let same =
        io::read_with(&path, &ReadOptions::default().with_origin(SceneOrigin::At(moved.origin))).unwrap();
    assert_eq!(same, moved);
}

#[test]
fn notes_name_a_line() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/9 3\nf 1 2\n";
    let found = io::read_bytes_with(Format::Obj, text, &ReadOptions::default()).unwrap();
    let notes = found.notes.join("\n");
    assert!(
        notes.contains("1 texture or normal indices name nothing and count as not given, such as at line 5"),
        "{notes}"
    );
    assert!(notes.contains("1 faces with fewer than 3 corners left out, such as at line 6"), "{notes}");
}

/// A file, its format, and words of the error.
#[test]
fn damaged_files_are_refused_with_their_place() {
    let cases: &[(Format, &[u8], &str)] = &[
        (Format::Obj, b"v 0 0 0\nf 1 2 3\n", "line 2: a face names vertex 3, but there are 1"),
        (Format::Obj, b"v 0 0\n", "line 1: v has 2 numbers where 3 are needed"),
        (Format::Obj, b"v 0 0 zero\n", "line 1: \"zero\" is not a number"),
        (Format::Obj, b"v 1 2 1e39", "vertex 0 has a non-finite position"),
        (Format::Obj, b"\x00\x01 binary", "no OBJ statement"),
        (Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967297", "line 4: a face names vertex 4294967297"),
        (Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2", "line 4: a face names vertex -4"),
        (Format::Obj, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 x 2", "line 4: the face corner \"x\""),
        (Format::Ply, b"", "line 1: a PLY file starts with"),
        (Format::Ply, b"ply\nformat ascii 1.0\nelement vertex 1\n", "truncated: the PLY header has no end_header"),
        (Format::Ply, b"ply\nformat ascii 2\nelement vertex -1\n", "line 3: an element has no count"),
        (Format::Ply, b"ply\nformat ascii 1.0\nelement vertex 0\nproperty real x\nend_header\n", "line 4: a property"),
        (Format::Ply, b"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n", "no property y"),
        (
            Format::Ply,
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 -1\n",
            "line 11: face 0 names vertex -1, but there are 1 vertices",
        ),
        (Format::Stl, b"", "truncated: a binary STL file has 84 bytes"),
        (Format::Stl, b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2", "truncated: the file ends in a vertex"),
        (Format::Stl, b"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\n", "truncated: the facet at the end"),
        (Format::Stl, b"solid\nfacet\nvertex 1 2 3\nendfacet\n", "line 4: a facet has 1 vertices"),
        (Format::Off, b"OFF\n", "truncated: the OFF header has no counts"),
        (Format::Off, b"4OFF\n1 0 0\n0 0 0 0\n", "line 3: vertex 0 lies at infinity: its fourth coordinate is 0"),
        (Format::Off, b"5OFF\n1 0 0\n0 0 0 0 0\n", "not supported: OFF files of the kind \"5OFF\""),
        (Format::Off, b"nOFF\n4\n1 0 0\n0 0 0 0\n", "not supported: OFF files of dimension 4"),
        (Format::Off, b"nOFF BINARY\n\0\0\0\x03", "not supported: binary OFF files of a declared dimension"),
        (Format::Off, b"OFF 2 0 0 0 0 0 1 1.00", "truncated: 2 vertices are declared, 1 are there"),
        (Format::Off, b"OFF 1 1 0 0 0 0 3 0 0 0 7", "line 1: \"7\" follows the last face"),
        (Format::Off, b"OFF 1 1 0 0 0 0 3 0 0 1", "line 1: face 0 names vertex \"1\""),
        (Format::Off, b"OFF 1 0 0\n1.#IND 0 0\n", "vertex 0 has a non-finite position"),
        (Format::Off, b"OFF BINARY\n\0\0\0\x01\0\0\0\0\0\0\0\0", "truncated: 1 vertices, 8 bytes are left"),
        (Format::Off, b"OFF BINARY\n\xff\xff\xff\xff\0\0\0\0\0\0\0\0", "byte 11: -1 is no count of vertices"),
        (Format::Stl, b"solid\nfacet\nvertex -1.#IND 2 3\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n", "vertex 0 has a non-finite"),
        (Format::Stl, b"solid\nfacet\nvertex 1,2,3,4 2 3\n", "line 3: \"1,2,3,4\" is not a number"),
        (Format::Stl, b"solid a facet vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endfacet endsolid", "line 1: facets stand in"),
        (Format::Stl, b"solid\nfacet\nvertex 1 2 3\nend facet\n", "line 4: a facet has 1 vertices"),
        (
            Format::Ply,
            b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1 1 1 9\n1 1 1 9\n3 0 0 0\nmore\n",
            "line 11: face 0 names vertex 9, but there are 2 vertices",
        ),
        (Format::Off, b"OFF 1 1 0\n0 0 0\n3 0 0 1\n", "line 3: face 0 names vertex \"1\", but there are 1 vertices"),
        (Format::Off, b"OFF 2 0 0\n0 0 0 # one\n\n", "truncated: 2 vertices are declared, 1 are there"),
        (Format::Glb, b"glTF\x02\0\0\0\xff\0\0\0", "truncated: the GLB file says 255 bytes, 12 are there"),
        (Format::Gltf, b"{", "the glTF document: EOF"),
        (Format::Gltf, b"{}", "no asset version"),
        (Format::Gltf, br#"{"asset":{"version":"1.0"}}"#, "not supported: glTF version"),
        (Format::Gltf, br#"{"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]}"#, "draco"),
        (Format::Gltf, br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4}]}"#, "no binary chunk"),
        (Format::Gltf, br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../secret"}]}"#, "not supported"),
        (
            Format::Gltf,
            br#"{"asset":{"version":"2.0"},"nodes":[{"children":[1]},{"children":[0]}]}"#,
            "node 0 is its own ancestor",
        ),
        (
            Format::Gltf,
            br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]}"#,
            "node 0 has two parents or is its own ancestor",
        ),
        (
            Format::Gltf,
            br#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":7}}]}]}"#,
            "accessor 7 is named, but there are 0",
        ),
        (Format::Glb, b"glTF\x02\0\0\0\0\0\0\0", "truncated: the GLB file ends at byte 12"),
    ];
    // With the feature, a document that requires Draco and has no meshes is empty.
    let is_read = |words: &str| words == "draco" && cfg!(feature = "draco");
    for (format, bytes, words) in cases.iter().filter(|case| !is_read(case.2)) {
        let error = io::read_bytes(*format, bytes).expect_err(words).to_string();
        assert!(error.contains(words), "{format}: {error:?} where {words:?} was expected");
        assert!(!error.contains('\n'), "{error:?} is more than a line");
    }
}

/// An accessor, its view, and words of the error.
#[test]
fn damaged_accessors_are_refused_by_number() {
    let good = r#""bufferView":0,"componentType":5126,"count":3,"type":"VEC3""#;
    let sparse = |count: &str, kind: &str| {
        format!(
            r#"{good},"sparse":{{"count":{count},"indices":{{"bufferView":0,"componentType":{kind}}},"values":{{"bufferView":0}}}}"#
        )
    };
    let view = r#""buffer":0,"byteLength":36"#;
    let cases: &[(&str, &str, &str)] = &[
        (&good.replace("5126", "5124"), view, "accessor 0 is of a type that glTF does not have"),
        (&good.replace("VEC3", "VEC5"), view, "accessor 0 is of a type that glTF does not have"),
        (&good.replace("VEC3", "VEC2"), view, "mesh 0 has positions that are not of type VEC3"),
        (&good.replace(":3", ":4"), view, "accessor 0 reaches beyond buffer view 0"),
        (&good.replace(":3", ":99"), view, "accessor 0 has 99 elements, the buffers 36 bytes"),
        (&format!(r#"{good},"byteOffset":18446744073709551615"#), view, "accessor 0 reaches beyond"),
        (&good.replace(":0", ":7"), view, "accessor 0 names buffer view 7"),
        (good, r#""buffer":1,"byteLength":36"#, "buffer view 0 names buffer 1"),
        (good, r#""buffer":0,"byteLength":40"#, "buffer view 0 reaches beyond buffer 0"),
        (
            good,
            r#""buffer":0,"byteLength":36,"byteStride":8"#,
            "buffer view 0 has a stride of 8 for elements of 12",
        ),
        (good, r#""buffer":0,"byteLength":36,"byteStride":16"#, "accessor 0 reaches beyond buffer view 0"),
        (&sparse("1", "5126"), view, "accessor 0 has sparse indices of no index type"),
        (&sparse("4", "5121"), view, "accessor 0 reaches beyond buffer view 0"),
        (r#""count":"many""#, view, "the glTF document: invalid type: string \"many\""),
    ];
    for (accessor, view, words) in cases {
        let document = format!(
            r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{{accessor}}}],"bufferViews":[{{{view}}}],
            "buffers":[{{"byteLength":36,"uri":"data:;base64,{}"}}]}}"#,
            "AAAA".repeat(12)
        );
        let error = io::read_bytes(Format::Gltf, document.as_bytes()).expect_err(words).to_string();
        assert!(error.contains(words), "{error:?} where {words:?} was expected");
        assert!(!error.contains('\n'), "{error:?} is more than a line");
    }
}

#[test]
fn a_missing_buffer_is_named() {
    let folder = std::env::temp_dir().join(format!("multires-missing-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("scene.gltf");
    std::fs::write(
        &path,
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"no%20such.bin"}]}"#,
    )
    .unwrap();
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("no such.bin"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn buffers_elsewhere_are_not_opened() {
    let folder = std::env::temp_dir().join(format!("multires-elsewhere-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("scene.gltf");
    for uri in [
        "../secret",
        "%2E%2E/secret",
        "/secret",
        "%2Fsecret",
        "C:/secret",
        "C%3A/secret",
        "a/../../secret",
        "%FF",
    ] {
        let document =
            format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":4,"uri":"{uri}"}}]}}"#);
        std::fs::write(&path, document).unwrap();
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains("which is no file beside the document"), "{uri}: {error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// A star of very many corners that winds many times: clipping it to the end would take hours.
#[test]
fn large_polygons_end() {
    let mut text = String::new();
    let count = 200_000;
    for i in 0..count {
        let angle = 40.0 * f64::from(i) / f64::from(count) * std::f64::consts::TAU;
        let radius = if i % 2 == 0 { 1.0 + f64::from(i) } else { 0.5 };
        text += &format!("v {} {} 0\n", radius * angle.cos(), radius * angle.sin());
    }
    text += "f";
    (1..=count).for_each(|i| text += &format!(" {i}"));
    let found = io::read_bytes_with(Format::Obj, text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(found.mesh.triangles().len(), count as usize - 2);
    assert!(found.notes[0].contains("1 concave polygons are too large to clip"), "{:?}", found.notes);
}

/// One position with very many normals must not be searched one by one.
#[test]
fn many_vertices_at_one_position_end() {
    let mut text = String::from("v 0 0 0\nvn 0 0 1\n");
    let count = 300_000;
    (0..count).for_each(|i| text += &format!("vt {i} 0\nf 1/{0}/1 1/{0}/1 1/1/1\n", i + 1));
    let mesh = io::read_bytes(Format::Obj, text.as_bytes()).unwrap();
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (count, count));
    assert_eq!(mesh.attribute("uv").unwrap().as_floats().unwrap()[2 * count - 2], (count - 1) as f32);
}

fn seed() -> Mesh {
    let positions: Vec<[f32; 3]> =
        (0..8).map(|i| [(i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32]).collect();
    let triangles = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4]];
    let uvs: Vec<[f32; 2]> = positions.iter().map(|p| [p[0], p[1]]).collect();
    let mesh =
        Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats("uv", &uvs)).unwrap();
    mesh.with_materials([0, 0, 1, 1, 0, 0]).unwrap().with_material_names(["a", "b"].map(str::to_owned))
}

/// Handwritten files with the constructs that no writer makes.
fn seeds(format: Format) -> Vec<Vec<u8>> {
    let mut all = vec![io::write_bytes(format, &seed()).unwrap()];
    match format {
        Format::Obj => all.push(b"v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv .5 .5 0\nvt 0\nf -1/1 -2// 1 2 \\\n 3\nusemtl x\nf 1 2 3\n".to_vec()),
        Format::Ply => {
            let header = "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex 5\nproperty float x\nproperty double y\nproperty char z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar float junk\nelement other 2\nproperty short a\nend_header\n";
            let body = "7 0 1 2 3 -1 2 4\n0 0 0 1 2 3 0\n1 0 0 1 2 3 1 5\n0 1 0 4 5 6 0\n1 1 1 7 8 9 0\n2 2 2 1 1 1 0\n5\n6\n";
            all.push([header, body].concat().into_bytes());
            let binary = header.replace("ascii", "binary_big_endian");
            all.push([binary.as_bytes(), &[0; 200]].concat());
            let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int texnumber\nend_header\n";
            all.push([header, "0 0 0\n1 0 0 7\n1 1 0\n0 1 0\n8 0 0 1 0 1 1 0 1 4 0 1 2 3 9 9 9 0\n0 3 0 1 2 8 8 8 1\n"].concat().into_bytes());
        }
        Format::Stl => {
            all.push(b"solid facet\nfacet normal 1.#IND 0 1\nouter loop\nvertex 0,5 0 0\nvertex 1.5, 0, 0\nvertex 0 1 0\nend loop\nend facet\nend\n".to_vec());
            all.push([&[b'x'; 80][..], &[255; 4], &[0; 103]].concat());
            all.push(b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n".to_vec());
        }
        Format::Off => {
            all.push(b"OFF3 2\n0 0 0 9 9 9\n1 0 0\n0 1 0\n3 0 1 2 1.0 0.5 0\n3 0 2 1 4\n".to_vec());
            all.push(b"NC4OFF 3 1 0 0 0 0 1 9 9 9 9 0 0 1 1 0 0 1 9 9 9 9 0 0 1 0 1 0 1 9 9 9 9 0 0 1 3 0 1 2".to_vec());
            all.push(b"ncoff\n1 0 0\n0 0 0 9 9 9 0 0 -1\n".to_vec());
            all.push([&b"COFF BINARY\n\x03\0\0\0\x01\0\0\0\0\0\0\0"[..], &[0; 72], &b"\x03\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0"[..]].concat());
            all.push(b"STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 255 0 0 255 0 0\n0 1 0 0 0 1 255 0 0 255 0 0\n3 0 1 2 7 7 7\n".to_vec());
            all.push([&b"OFF BINARY\n\0\0\0\x03\0\0\0\x01\0\0\0\0"[..], &[0; 36], &b"\0\0\0\x03\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0\0"[..]].concat());
        }
        Format::Glb | Format::Gltf => all.push(br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2]}],"nodes":[{"children":[1],"scale":[-1,1,2]},{"mesh":0},{"mesh":0,"rotation":[0,0,1,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0,"_X":1},"mode":5,"indices":1,"material":0},{"attributes":{"POSITION":0},"mode":6}]}],"materials":[{}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"byteOffset":36,"componentType":5121},"values":{"bufferView":0}}},{"bufferView":1,"byteOffset":36,"componentType":5121,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":40,"byteStride":12},{"buffer":0,"byteLength":40}],"buffers":[{"byteLength":40,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAg=="}]}"#.to_vec()),
        _ => {}
    }
    all
}

#[test]
fn seeds_of_the_fuzzing_tests_are_read_or_refused_as_meant() {
    for format in FORMATS {
        for (i, bytes) in seeds(format).iter().enumerate() {
            let found = io::read_bytes(format, bytes);
            assert!(found.is_ok(), "{format} {i}: {}", found.unwrap_err());
        }
    }
}

const VOCABULARY: &str = "end|1,5|OFF2|NCOFF|4OFF|BINARY|255|property list uchar float texcoord|property uchar red|property uchar green|property uchar blue|v|vt|vn|f|usemtl|1|2|-1|1//1|1/1/1|0.5|nan|\\|#|\n|\n|\r|OFF|COFF|solid|facet|endfacet|vertex|3|ply|format ascii 1.0|element vertex 2|property float x|property float y|property float z|element face 1|property list uchar int vertex_index|end_header";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in FORMATS {
            let _ = io::read_bytes(format, &bytes);
        }
    }

    #[test]
    fn changed_files_are_read_or_refused(
        pick in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        for format in FORMATS {
            let seeds = seeds(format);
            let mut bytes = pick.get(&seeds).clone();
            for (at, value, how) in &changes {
                let at = at.index(bytes.len());
                match how {
                    0 => bytes[at] = *value,
                    1 => bytes.insert(at, b"0123456789-/ \n.e"[usize::from(*value) % 16]),
                    2 => bytes[at] = b"0123456789-/ \n.e"[usize::from(*value) % 16],
                    _ => drop(bytes.remove(at)),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            if let Some(cut) = cut.filter(|_| !bytes.is_empty()) {
                bytes.truncate(cut.index(bytes.len()));
            }
            if let Ok(found) = io::read_bytes_with(format, &bytes, &ReadOptions::default().with_origin(SceneOrigin::Center)) {
                // What is read can be written and read again, geometry unchanged.
                let again = io::read_bytes(Format::Ply, &io::write_bytes(Format::Ply, &found.mesh).unwrap_or_default());
                if let Ok(again) = again {
                    prop_assert_eq!(again.triangles(), found.mesh.triangles());
                }
            }
        }
    }

    #[test]
    fn any_words_of_a_format_are_read_or_refused(
        words in prop::collection::vec(
            prop::sample::select(VOCABULARY.split('|').collect::<Vec<&'static str>>()),
            0..40,
        ),
    ) {
        let text = words.join(" ");
        for format in FORMATS {
            let _ = io::read_bytes(format, text.as_bytes());
        }
    }
}
