//! Files compressed by Draco are read as if they were not, and written uncompressed.

use multires::io::{self, Format, GltfDocument};
use multires::mesh::{AttributeValues, names};
use proptest::prelude::*;
use serde_json::json;

use crate::compare::File;
use crate::gltf_samples::{self, glb};
use crate::validator;
use crate::whole::{corners, halved, meshes};

/// A grid of 4 x 4 squares with heights `x * y`, texture coordinates, and row and column as bytes: made by Google's encoder
/// (npm package draco3dgltf 1.5.7), positions in 11 bits.
const STREAMS: [(&str, &str); 3] = [
    (
        "edgebreaker",
        "445241434f020201010000001920022003000aefd3ea53adea53d5aa1aff0111ff02cc42ff02cc4203ff000000000001000001000903000002010309020001020104020400020101010101038010492169036903ffffffe7b501033d0af905dcffffffffffffffffffffffebdcdcdcdcfffffffffffffffffffffffffffffff7b501192898481662dc3bd145de6d732ad8c5496a75ae3622c0c37f8100000000ff0700000000000000000000000000000000803f0b010101000b03152e3d0a172105910206a8a674eaffa1ffffefff7f7f000818002042080800000000ff03000000000000000000000000803f0a010101010205cd3c4901a40349010762c38fdee96f840000000004000000",
    ),
    (
        "valence",
        "445241434f020201010000001920022003000aefd3ea53adea53d5aa1aff0111ff02cc42ff02cc4203ff000100000001000001000903000002010309020001020104020400020101010101068010492169036903ffffffe7b501033d0af905dcffffffffffffffffffffffebdcdcdcdcfffffffffffffffffffffffffffffff7b50119fa6cc8486a8ec8cd484820fbc21e0d3721adc4277dd8abff8000000000ff0700000000000000000000000000000000803f0b050101000b032105039102032105cd0ce9115d0f910291020b6507f2fce9fe6ff3c65f80ffffefff3f4273016800709f2d9719269ab401a10f14000880800d40ef81a9002797c10024b7d83b00170000000102784100000000ff03000000000000000000000000803f0a010101010505cd3c4901a40349010762c38fdee96f840000000004000000",
    ),
    (
        "sequential",
        "445241434f020201000000201901000501010506010602020607020703030708030804040809050a06060a0b060b07070b0c070c08080c0d080d09090d0e0a0f0b0b0f100b100c0c10110c110d0d11120d120e0e12130f1410101415101511111516111612121617121713131718010300090300000309020001040204000202020100010101028010e517036903fffffff36903fffffffb6903fffffff3dc039102fffffff3f905dced1103dcffffffffffffffffffffffffffffffefdc1a412028deb7087fb9aee65c46d7106fe700a7592e0e6a926754af00000000ff07000000010101018104251c032105ffffffffffffffebb107030d170df8911f7d3b0efe47439240938b00000000ff030000000101010103152e03ed110d58f6f8f6c7fb1cb525c8339a8900000000040000000000000000000000000000000000803f0b00000000000000000000803f0a",
    ),
];

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect()
}

/// Returns a document with a stream as its only primitive. Bounds are those of the values that were encoded.
fn document(stream: &[u8]) -> Vec<u8> {
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "extensionsUsed": ["KHR_draco_mesh_compression"], "extensionsRequired": ["KHR_draco_mesh_compression"],
        "buffers": [{ "byteLength": stream.len().next_multiple_of(4) }],
        "bufferViews": [{ "buffer": 0, "byteLength": stream.len() }],
        "accessors": [
            { "componentType": 5123, "count": 96, "type": "SCALAR" },
            { "componentType": 5126, "count": 25, "type": "VEC3", "min": [-0.1, 0.0, 0.0], "max": [1.1, 1.0, 1.0] },
            { "componentType": 5126, "count": 25, "type": "VEC2" },
            { "componentType": 5121, "count": 25, "type": "VEC4" },
        ],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 1, "TEXCOORD_0": 2, "_PLACE": 3 }, "indices": 0,
            "extensions": { "KHR_draco_mesh_compression": {
                "bufferView": 0, "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "_PLACE": 2 } } },
        }] }],
    });
    glb(&json, stream)
}

#[test]
fn every_method_of_connectivity_is_read() {
    let folder = std::env::temp_dir().join(format!("multires-draco-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    for (name, stream) in STREAMS {
        let stream = bytes(stream);
        let file = document(&stream);
        let mesh = io::read_bytes(Format::Glb, &file).unwrap();
        assert_eq!((mesh.triangles().len(), mesh.positions().len()), (32, 25), "{name}");
        let AttributeValues::Uint(place) = mesh.attribute("PLACE").unwrap().values() else {
            panic!("{name}")
        };
        let uv = mesh.attribute(names::UV).unwrap().as_floats().unwrap();
        let [low, _] = mesh.bounds().unwrap();
        for (v, p) in mesh.positions().iter().enumerate() {
            let [y, x] = [0, 1].map(|i| place[4 * v + i] as f32);
            for (found, expected) in p.iter().zip([x / 4.0, y / 4.0, x * y / 16.0]) {
                assert!((found - low[0] - expected).abs() < 1e-3, "{name}: {p:?} at {x} {y}");
            }
            assert!((uv[2 * v] - x / 4.0).abs() < 1e-3 && (uv[2 * v + 1] - y / 4.0).abs() < 1e-3, "{name}");
        }
        // Each square has two triangles, of the same side.
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|v| [place[4 * v as usize + 1] as i32, place[4 * v as usize] as i32]);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert_eq!(area, -1, "{name}");
        }

        let document = GltfDocument::from_bytes(&file).unwrap();
        for (i, document) in [document.clone(), halved(&document)].into_iter().enumerate() {
            let back = document.to_glb().unwrap();
            assert!(!back.windows(5).any(|word| word == b"DRACO" || word == b"draco"), "{name}");
            let json = File::of_glb(&back).json;
            assert!(json.get("extensionsUsed").is_none() && json.get("extensionsRequired").is_none());
            assert!(json["accessors"][1]["min"][0].as_f64() > Some(-0.01), "{name}");
            let again = GltfDocument::from_bytes(&back).unwrap();
            if i == 0 {
                let [a, b] = [&document, &again].map(|d| meshes(d).into_iter().map(|m| corners(&m.unwrap())));
                assert!(a.eq(b), "{name}");
            }
            let path = folder.join(format!("{name}-{i}.glb"));
            std::fs::write(&path, back).unwrap();
            files.push(path);
        }
    }
    let errors = validator::errors("every_method_of_connectivity_is_read", &files);
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn uncompressed_accessors_come_first() {
    let mut sample = gltf_samples::all().swap_remove(0);
    let expected = io::read_bytes(Format::Glb, &sample.glb()).unwrap();
    let view = sample.view(b"none", json!({}));
    let extension = json!({ "bufferView": view, "attributes": { "POSITION": 0 } });
    sample.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": extension });
    sample.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    assert_eq!(io::read_bytes(Format::Glb, &sample.glb()).unwrap(), expected);
    // Kept: its primitive was not changed.
    let back = GltfDocument::from_bytes(&sample.glb()).unwrap().to_glb().unwrap();
    assert_eq!(File::of_glb(&back).json["extensionsUsed"], json!(["KHR_draco_mesh_compression"]));
}

#[test]
fn streams_that_are_none_are_refused() {
    let stream = bytes(STREAMS[0].1);
    let with = |from: &str, to: &str| {
        let file = document(&stream);
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let text = std::str::from_utf8(&file[20..20 + word(12)]).unwrap().replace(from, to);
        glb(&serde_json::from_str(&text).unwrap(), &stream)
    };
    let cases = [
        (document(&stream[..100]), "mesh 0, primitive 0, Draco compression"),
        (document(b"none"), "mesh 0, primitive 0, Draco compression"),
        (with("\"TEXCOORD_0\":1", "\"TEXCOORD_0\":9"), "there is no attribute 9"),
        (with("VEC2", "VEC3"), "another width"),
        (with("\"bufferView\":0", "\"bufferView\":7"), "buffer view 7 is not there"),
        (with("\"indices\":0", "\"indices\":0,\"mode\":5"), "no list of triangles"),
    ];
    for (file, words) in cases {
        let error = io::read_bytes(Format::Glb, &file).expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error:?} where {words:?} was expected");
        assert!(GltfDocument::from_bytes(&file).is_err(), "{words}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    /// Changed streams are decoded or refused.
    #[test]
    fn damaged_streams_do_no_harm(
        which in 0..3_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let mut stream = bytes(STREAMS[which].1);
        for (place, byte) in changes {
            let place = place.index(stream.len());
            stream[place] = byte;
        }
        if let Some(length) = length {
            stream.truncate(length.index(stream.len()) + 1);
        }
        let file = document(&stream);
        let _ = io::read_bytes(Format::Glb, &file);
        if let Ok(document) = GltfDocument::from_bytes(&file) {
            let _ = document.to_glb();
        }
    }
}
