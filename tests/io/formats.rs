//! Promise: each reader understands the forms of its format, not only those that the writers use.
#![cfg(feature = "io")]

use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh};

fn text(format: Format, text: &str) -> Mesh {
    io::read_bytes(format, text.as_bytes()).unwrap_or_else(|e| panic!("{format}: {e}\n{text}"))
}

fn floats<'a>(mesh: &'a Mesh, name: &str) -> &'a [f32] {
    mesh.attribute(name).and_then(Attribute::as_floats).unwrap_or_else(|| panic!("no {name}"))
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn obj_line_ends_are_all_the_same() {
    let lf = format!("{SQUARE}# comment\nf 1 2 3\nf 1 3 \\\n 4\n");
    let mesh = text(Format::Obj, &lf);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(text(Format::Obj, &lf.replace('\n', "\r\n")), mesh);
    assert_eq!(text(Format::Obj, &lf.replace('\n', "\r")), mesh);
    assert_eq!(text(Format::Obj, &format!("\u{feff}{}", lf.replace(' ', "\t "))), mesh);
}

#[test]
fn obj_vertices_keep_their_order_and_count() {
    let mesh = text(Format::Obj, &format!("v 7 7 7\n{SQUARE}v 8 8 8\nf 5 4 3\nf 3 2 5\n"));
    assert_eq!(mesh.positions().len(), 6);
    assert_eq!(mesh.triangles(), [[4, 3, 2], [2, 1, 4]]);

    // Corner 2 has two texture coordinates, in order of use; the others stay in their place round it.
    let mesh = text(Format::Obj, &format!("{SQUARE}vt 0 0\nvt .5 .5\nf 1/1 2/2 3/1\nf 4/1 2/1 3/1\n"));
    let x: Vec<[f32; 2]> = mesh.positions().iter().map(|p| [p[0], p[1]]).collect();
    assert_eq!(x, [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(mesh.triangles(), [[0, 1, 3], [4, 2, 3]]);
    assert_eq!(floats(&mesh, "uv"), [0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(mesh.attribute("normal").is_none());
}

#[test]
fn obj_faces_may_come_before_vertices_and_be_concave() {
    let mesh = text(Format::Obj, "f 1 2 3 4\nv 0 0 0\nv 4 1 0\nv 0 2 0\nv 1 1 0\n");
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    assert_eq!(mesh.triangles().len(), 2);
    assert!(mesh.triangles().iter().all(|t| area(t) > 0.0), "{:?}", mesh.triangles());
}

#[test]
fn obj_materials_are_numbered_by_appearance() {
    let faces = "f 1 2 3\nusemtl red\nf 1 2 3 4\nusemtl two words # and a comment\nf 1 2 4\nusemtl red\ng x\nf 2 3 4\n";
    let mesh = text(Format::Obj, &format!("mtllib none.mtl\n{SQUARE}{faces}"));
    assert_eq!(mesh.materials(), [1, 0, 0, 2, 0]);
    assert_eq!(mesh.material_names(), ["red", "", "two words"]);
}

#[test]
fn obj_colours_follow_positions() {
    let mesh = text(Format::Obj, "v 0 0 0 1 .5 .25\nv 1 0 0 1 0 0\nv 0 1 0 1.0\nf 1 2 3\n");
    assert_eq!(floats(&mesh, "color"), [1.0, 0.5, 0.25, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let mesh = text(Format::Obj, "v 0 0 0 1 .5 .25 .75\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(floats(&mesh, "color"), [1.0, 0.5, 0.25, 0.75, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nobj_info nothing\nelement face 2\n\
    property list uchar uint vertex_index\nproperty int material_index\nelement other 1\nproperty list uchar float junk\n\
    element vertex 4\nproperty double x\nproperty float32 y\nproperty int16 z\nproperty float nx\nproperty float ny\n\
    property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
    property float texture_u\nproperty float texture_v\nproperty char label\nproperty ushort part_0\nproperty ushort part_1\n\
    property list uchar int neighbours\nend_header\n\
    3 0 1 2 5\n4 0 1 2 3 7\n2 0.5 0.5\n\
    0 0 -7 0 0 1 255 0 51 255 0 0 -1 1 2 0\n1 0 -7 0 0 1 255 0 51 255 1 0 -2 3 4 2 9 9\n\
    1 1 -7 0 0 1 255 0 51 255 1 1 -3 5 6 0\n0 1 -7 0 0 1 255 0 51 0 0 1 -4 7 65535 0\n";

#[test]
fn ply_properties_become_attributes() {
    let mesh = text(Format::Ply, PLY);
    assert_eq!(mesh.positions()[3], [0.0, 1.0, -7.0]);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.materials(), [5, 7, 7]);
    let names: Vec<(&str, usize)> = mesh.attributes().iter().map(|a| (a.name(), a.width())).collect();
    assert_eq!(names, [("normal", 3), ("color", 4), ("uv", 2), ("label", 1), ("part", 2)]);
    assert_eq!(floats(&mesh, "color")[..4], [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(floats(&mesh, "uv"), [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
    assert_eq!(mesh.attribute("label").unwrap().values(), &AttributeValues::Int(vec![-1, -2, -3, -4]));
    let part = AttributeValues::Uint(vec![1, 2, 3, 4, 5, 6, 7, 65_535]);
    assert_eq!(mesh.attribute("part").unwrap().values(), &part);
    assert_eq!(text(Format::Ply, &PLY.replace('\n', "\r\n")), mesh);
}

/// The values of `PLY` in binary. Layout: b, h, i, f, d are numbers of 1, 2, 4, 4 and 8 bytes; I and F lists.
fn binary(big: bool) -> Vec<u8> {
    fn put(kind: char, value: f64, big: bool, out: &mut Vec<u8>) {
        let mut bytes = match kind {
            'b' => (value as i64 as u8).to_le_bytes().to_vec(),
            'h' => (value as i64 as u16).to_le_bytes().to_vec(),
            'i' => (value as i64 as u32).to_le_bytes().to_vec(),
            'f' => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        out.extend(bytes);
    }
    let order = if big { "binary_big_endian" } else { "binary_little_endian" };
    let (header, body) = PLY.split_once("end_header\n").unwrap();
    let mut out = format!("{}end_header\n", header.replace("ascii", order)).into_bytes();
    let mut words = body.split_whitespace().map(|w| w.parse::<f64>().unwrap());
    let vertex = "dfhfffbbbbffbhhI";
    for kind in ["IiIiF", vertex, vertex, vertex, vertex].concat().chars() {
        let value = words.next().unwrap();
        if kind.is_uppercase() {
            put('b', value, big, &mut out);
            (0..value as usize)
                .for_each(|_| put(kind.to_ascii_lowercase(), words.next().unwrap(), big, &mut out));
        } else {
            put(kind, value, big, &mut out);
        }
    }
    assert_eq!(words.next(), None);
    out
}

#[test]
fn ply_is_the_same_in_every_encoding() {
    let mesh = text(Format::Ply, PLY);
    for big in [false, true] {
        assert_eq!(io::read_bytes(Format::Ply, &binary(big)).unwrap(), mesh, "big: {big}");
    }
}

#[test]
fn ply_strips_turn_every_second_triangle() {
    let header = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let body = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n10 0 1 2 3 3 4 -1 3 4 5\n";
    let mesh = text(Format::Ply, &format!("{header}{body}"));
    assert_eq!(mesh.triangles(), [[0, 1, 2], [2, 1, 3], [3, 4, 5]]);
}

#[test]
fn stl_text_may_hold_several_solids() {
    let facet = |z: i32| {
        format!(
            "  facet normal 0 0 1\n    OUTER LOOP\n      vertex 0 0 {z}\n      vertex 1e0 0 {z}\n      vertex 0 1 {z}\n    endloop\n  endfacet\n"
        )
    };
    let solids =
        format!("solid facet vertex\n{}{}endsolid a b\nsolid\n{}endsolid\n", facet(0), facet(0), facet(5));
    let mesh = text(Format::Stl, &solids);
    assert_eq!(mesh.positions().len(), 6);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 1, 2], [3, 4, 5]]);
    assert_eq!(text(Format::Stl, &solids.replace('\n', "\r\n")), mesh);
}

#[test]
fn stl_binary_may_start_like_text_and_has_minus_zero() {
    let mesh = Mesh::new(
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, -0.0]],
        [[0, 1, 2], [3, 2, 1]],
    );
    let mut bytes = io::write_bytes(Format::Stl, &mesh.unwrap()).unwrap();
    bytes[..19].copy_from_slice(b"solid facet endsoli");
    let mesh = io::read_bytes(Format::Stl, &bytes).unwrap();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 1]]);
    bytes.extend([1, 2, 3]);
    bytes[..19].fill(0);
    let found = io::read_bytes_with(Format::Stl, &bytes, &io::ReadOptions::default()).unwrap();
    assert_eq!(found.notes, ["3 bytes after the last triangle left out"]);
    // The normal of the first facet.
    assert_eq!(bytes[84..96], [0.0_f32, 0.0, 1.0].map(f32::to_le_bytes).concat());
}

#[test]
fn off_vertices_have_what_the_first_word_says() {
    let off = "# c\n\nSTCNOFF # d\n# e\n4 2 0\n0 0 0 0 0 1 255 0 51 255 0 0\n1 0 0 0 0 1 0 0 0 0 1 0\n1 1 0 0 0 1 0 0 0 0 1 1\n\
        0 1 0 0 0 1 0 0 0 0 0 1\n4 0 1 2 3 255 0 0\n3 0 2 3\n";
    let mesh = text(Format::Off, off);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    assert_eq!(floats(&mesh, "color")[..4], [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(floats(&mesh, "normal")[..3], [0.0, 0.0, 1.0]);
    assert_eq!(floats(&mesh, "uv")[2..6], [1.0, 0.0, 1.0, 1.0]);
    let mesh = text(Format::Off, "COFF 3 1 0\n0 0 0 1 0.5 0\n1 0 0 1 1 1\n0 1 0 0 0 0\n3 0 1 2");
    assert_eq!(floats(&mesh, "color"), [1.0, 0.5, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let mesh = text(Format::Off, "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 2 1 0\n");
    assert_eq!(mesh.triangles(), [[2, 1, 0]]);
}

#[test]
fn off_binary_is_big_endian() {
    let word = |n: i32| n.to_be_bytes();
    let real = |x: f32| x.to_be_bytes();
    let mut bytes = b"NOFF BINARY\n".to_vec();
    [3, 1, 0].iter().for_each(|&n| bytes.extend(word(n)));
    for p in [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.5]] {
        p.iter().chain(&[0.0, 0.0, 1.0]).for_each(|&x| bytes.extend(real(x)));
    }
    [3, 0, 1, 2, 1, 0].iter().for_each(|&n| bytes.extend(word(n)));
    let mesh = io::read_bytes(Format::Off, &bytes).unwrap();
    assert_eq!(mesh.positions()[2], [0.0, 3.0, 0.5]);
    assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    assert_eq!(floats(&mesh, "normal"), [0.0, 0.0, 1.0].repeat(3));
}

/// A triangle (0 0 0, 1 0 0, 0 1 0) with its normal and tangent, and the indices 0 1 2, as a glTF document.
fn gltf(nodes: &str, primitives: &str) -> Mesh {
    let document = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{primitives}]}}],"materials":[{{"name":"m"}},{{}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC4"}},
        {{"bufferView":2,"componentType":5121,"count":3,"type":"SCALAR"}},
        {{"bufferView":2,"componentType":5121,"normalized":true,"count":3,"type":"SCALAR"}},
        {{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,
        "indices":{{"bufferView":2,"byteOffset":2,"componentType":5121}},"values":{{"bufferView":0,"byteOffset":12}}}}}}],
        "bufferViews":[{{"buffer":0,"byteLength":72}},{{"buffer":0,"byteOffset":72,"byteLength":48}},
        {{"buffer":0,"byteOffset":120,"byteLength":3}}],
        "buffers":[{{"byteLength":123,"uri":"data:application/octet-stream;base64,{BUFFER}"}}]}}"#
    );
    text(Format::Gltf, &document)
}

const BUFFER: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AACA\
    PwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAIA/AAAAAAAAAAAAAIA/AAEC";

const PLAIN: &str = r#"{"attributes":{"POSITION":0,"NORMAL":1,"TANGENT":2},"indices":3}"#;

#[test]
fn gltf_nodes_place_their_meshes() {
    let still = gltf(r#"{"mesh":0}"#, PLAIN);
    assert_eq!(still.positions(), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(still.triangles(), [[0, 1, 2]]);
    assert_eq!(floats(&still, "normal")[..3], [0.0, 0.0, 1.0]);
    assert_eq!(floats(&still, "tangent")[..4], [1.0, 0.0, 0.0, 1.0]);

    // A parent that moves and a child that turns by 90 degrees round z and stretches along its own x.
    let turned = r#"{"children":[1],"translation":[10,0,0]},{"mesh":0,"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1]}"#;
    let mesh = gltf(turned, PLAIN);
    let near = |found: &[f32], wanted: &[f32]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(&mesh.positions()[1], &[10.0, 2.0, 0.0]), "{:?}", mesh.positions());
    assert!(near(&mesh.positions()[2], &[9.0, 0.0, 0.0]));
    assert!(near(&floats(&mesh, "tangent")[..4], &[0.0, 1.0, 0.0, 1.0]));

    // A mirror turns the triangle, so that its normal stays the one computed from it.
    let mirror = gltf(r#"{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}"#, PLAIN);
    assert_eq!(mirror.positions()[1], [-1.0, 0.0, 0.0]);
    assert_eq!(mirror.triangles(), [[0, 2, 1]]);
    assert_eq!(floats(&mirror, "normal")[..3], [0.0, 0.0, 1.0]);
    assert_eq!(floats(&mirror, "tangent")[..4], [-1.0, 0.0, 0.0, -1.0]);

    // A shear that moves z along x leans the normal of the plane z = 0 by nothing, one that lifts x along z against it.
    let sheared = r#"{"mesh":0,"matrix":[1,0,1,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}"#;
    let half = 0.5_f32.sqrt();
    assert!(near(&floats(&gltf(sheared, PLAIN), "normal")[..3], &[-half, 0.0, half]));
}

#[test]
fn gltf_shows_a_mesh_once_for_each_node() {
    let twice = gltf(r#"{"children":[1,2]},{"mesh":0},{"mesh":0,"translation":[0,0,5]}"#, PLAIN);
    assert_eq!((twice.positions().len(), twice.triangles().len()), (6, 2));
    assert_eq!(twice.positions()[3], [0.0, 0.0, 5.0]);
    assert_eq!(gltf(r#"{},{"mesh":0}"#, PLAIN).positions().len(), 0);
}

#[test]
fn gltf_primitives_share_vertices_and_have_materials() {
    let three = format!(
        r#"{PLAIN},{{"attributes":{{"POSITION":0,"NORMAL":1,"TANGENT":2}},"mode":6,"material":1}},
        {{"attributes":{{"POSITION":0,"_PART":3,"_SHARE":4}},"mode":5,"material":0}},{{"attributes":{{"POSITION":0}},"mode":1}}"#
    );
    let mesh = gltf(r#"{"mesh":0}"#, &three);
    assert_eq!(mesh.positions().len(), 6);
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.materials(), [2, 1, 0]);
    assert_eq!(mesh.material_names(), ["m", ""]);
    // Where a primitive lacks an attribute: normals from its triangles, zeros of others.
    assert_eq!(floats(&mesh, "normal")[9..], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    assert_eq!(mesh.attribute("PART").unwrap().values(), &AttributeValues::Uint(vec![0, 0, 0, 0, 1, 2]));
    assert_eq!(floats(&mesh, "SHARE")[3..], [0.0, 1.0 / 255.0, 2.0 / 255.0]);
}

#[test]
fn gltf_sparse_accessors_replace_elements() {
    let mesh = gltf(r#"{"mesh":0}"#, r#"{"attributes":{"POSITION":5}}"#);
    assert_eq!(mesh.positions(), [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]]);
}

#[test]
fn gltf_passes_over_what_is_no_geometry() {
    for part in [
        r#""scenes":[{}],"nodes":[{}]"#,
        r#""animations":[{"channels":[{"sampler":0,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{}}}}]}]"#,
        r#""textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}],"extensionsRequired":["KHR_texture_basisu"]"#,
        r#""materials":[{"name":"m","alphaMode":7}],"cameras":[{}],"skins":[{}],"extras":[1]"#,
    ] {
        let document = format!(r#"{{"asset":{{"version":"2.0"}},{part}}}"#);
        assert_eq!(text(Format::Gltf, &document).triangles().len(), 0);
    }

    // A chunk of a kind that is not known, between the document and the buffer.
    let triangle = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]).unwrap();
    let mut glb = io::write_bytes(Format::Glb, &triangle).unwrap();
    let end = 20 + u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    glb.splice(end..end, *b"\x04\0\0\0XTRA1234");
    let length = (glb.len() as u32).to_le_bytes();
    glb[8..12].copy_from_slice(&length);
    assert_eq!(io::read_bytes(Format::Glb, &glb).unwrap(), triangle);
}

#[test]
fn gltf_nodes_far_away_keep_their_digits() {
    let document = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0,"translation":[5411932.51,0,0]},
        {"mesh":0,"translation":[5411932.76,0,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:;base64,AAAA AAAA"}]}"#;
    let document = document.replace("AAAA AAAA", &"AAAA".repeat(12));
    let options = io::ReadOptions::default().with_origin(io::SceneOrigin::Center);
    let mesh = io::read_bytes_with(Format::Gltf, document.as_bytes(), &options).unwrap().mesh;
    assert!((mesh.positions()[3][0] - mesh.positions()[0][0] - 0.25).abs() < 1e-6, "{:?}", mesh.positions());
}

#[test]
fn gltf_data_may_lack_its_padding() {
    let buffer = |data: &str| {
        let document = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":4,"uri":"data:application/gltf-buffer;base64,{data}"}}]}}"#
        );
        io::read_bytes(Format::Gltf, document.as_bytes()).map_err(|e| e.to_string())
    };
    assert!(buffer("AAECAw==").is_ok());
    assert!(buffer("AAECAw").is_ok());
    assert!(buffer("AAECA").unwrap_err().contains("buffer 0 has a damaged data URI"));
    assert!(buffer("AAE!Aw==").unwrap_err().contains("buffer 0 has a damaged data URI"));
    assert!(buffer("AAEC").unwrap_err().contains("buffer 0 says 4 bytes, 3 are there"));
}

#[test]
fn gltf_buffers_may_be_files_beside_it() {
    let folder = std::env::temp_dir().join(format!("multires-buffers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let triangle = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]).unwrap();
    let glb = io::write_bytes(Format::Glb, &triangle).unwrap();
    let json_length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    let json = String::from_utf8(glb[20..20 + json_length].to_vec()).unwrap();
    std::fs::write(folder.join("a b.bin"), &glb[28 + json_length..]).unwrap();
    let path = folder.join("scene.gltf");
    std::fs::write(&path, json.replace(r#""byteLength":44}]"#, r#""byteLength":44,"uri":"./a%20b.bin"}]"#))
        .unwrap();
    assert_eq!(io::read(&path).unwrap(), triangle);
    std::fs::remove_dir_all(folder).unwrap();
}
