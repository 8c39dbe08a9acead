//! Promise: no reader reserves more than a multiple of the file's size, whatever counts the file declares.
#![cfg(feature = "io")]

#[path = "support/models.rs"]
mod models;

use multires::io::{self, Format};
use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Most bytes held at once by a call, above what was held before.
fn peak<T>(call: impl FnOnce() -> T) -> (usize, T) {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let result = call();
    (ALLOCATOR.peak_usage().saturating_sub(before), result)
}

/// Small things may be reserved in whole pages.
const FLOOR: usize = 64 << 10;
/// A vertex of three one-byte coordinates grows most: to three doubles, three singles and what welding needs.
const FACTOR: usize = 32;

fn ply(vertices: &str, faces: &str, list: &str, body: &[u8]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty char x\nproperty char y\nproperty char z\n\
         element face {faces}\nproperty list {list} int vertex_indices\nend_header\n"
    );
    [header.as_bytes(), body].concat()
}

fn glb(json: &str, chunk: &[u8]) -> Vec<u8> {
    let json = format!("{json:<0$}", json.len().next_multiple_of(4));
    let word = |n: usize| (n as u32).to_le_bytes();
    let length = 28 + json.len() + chunk.len();
    let parts: [&[u8]; 8] = [
        b"glTF\x02\0\0\0",
        &word(length),
        &word(json.len()),
        b"JSON",
        json.as_bytes(),
        &word(chunk.len()),
        b"BIN\0",
        chunk,
    ];
    parts.concat()
}

fn lying_glb(count: u64, view: &str) -> Vec<u8> {
    glb(
        &format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":64}}],"bufferViews":[{{"buffer":0,"byteLength":64}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{{view}"componentType":5126,"count":{count},"type":"VEC3"}}]}}"#
        ),
        &[0; 64],
    )
}

/// Files that say more than they hold.
fn liars() -> Vec<(Format, Vec<u8>)> {
    let mut stl = vec![0; 84 + 500];
    // The largest number itself means that the count is not known.
    stl[80..84].copy_from_slice(&(u32::MAX - 1).to_le_bytes());
    let nodes: Vec<String> = (0..2000).map(|_| r#"{"mesh":0}"#.to_owned()).collect();
    let many = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"buffers":[{{"byteLength":120000}}],
        "bufferViews":[{{"buffer":0,"byteLength":120000}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":10000,"type":"VEC3"}}]}}"#,
        nodes.join(",")
    );
    vec![
        (Format::Ply, ply("4294967295", "4294967295", "uint", &[0; 100])),
        (Format::Ply, ply("18446744073709551615", "1", "uint", &[0; 100])),
        (Format::Ply, ply("9223372036854775807", "1", "uint", &[0; 100])),
        (Format::Ply, ply("3", "1", "uint", &[255; 100])),
        (Format::Ply, ply("3", "1", "int", &[255; 100])),
        (Format::Ply, ply("3", "1000000000", "uchar", &[0; 100])),
        (Format::Ply, b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n".to_vec()),
        (Format::Stl, stl),
        (Format::Off, b"OFF 2000000000 2000000000 0\n0 0 0\n".to_vec()),
        (Format::Off, b"OFF 9223372036854775807 9223372036854775807 0\n".to_vec()),
        (Format::Off, b"OFF 1 1 0\n0 0 0\n9223372036854775807 0\n".to_vec()),
        (Format::Off, [&b"OFF BINARY\n\x7f\xff\xff\xff\x7f\xff\xff\xff\0\0\0\0"[..], &[0; 99]].concat()),
        (Format::Off, [&b"OFF BINARY\n\0\0\0\x01\0\0\0\x01\0\0\0\0"[..], &[0; 12], &[0x7f, 255, 255, 255, 0, 0, 0, 0]].concat()),
        (Format::Glb, lying_glb(4_000_000_000, r#""bufferView":0,"#)),
        (Format::Glb, lying_glb(4_000_000_000, "")),
        (Format::Glb, lying_glb(u64::MAX, r#""bufferView":0,"#)),
        (Format::Glb, glb(&many, &[0; 120_000])),
    ]
}

/// One test, so that nothing else allocates meanwhile.
#[test]
fn readers_reserve_a_multiple_of_the_file() {
    for (i, (format, bytes)) in liars().into_iter().enumerate() {
        let (held, result) = peak(|| io::read_bytes(format, &bytes));
        let error = result.expect_err("a liar is refused").to_string();
        // A scene may show a mesh often; what that takes is bounded apart (64 MiB and 64 times the file).
        let limit = if error.contains("too many times") {
            (96 << 20) + 512 * bytes.len()
        } else {
            FLOOR + FACTOR * bytes.len()
        };
        assert!(held <= limit, "{format} {i}: {held} bytes for a file of {} ({error})", bytes.len());
    }

    // Honest files with the most to grow.
    let dense = ply("200000", "200000", "uchar", &[0; 800_000]);
    let empty_faces = ply("3", "900000", "uchar", &[0; 900_009]);
    let text = ["v 0 0 0\n".repeat(1000), "f 1 1 1\n".repeat(50_000), "f 1/1 1/1 1/1\n".repeat(9)].concat();
    let soup = [&[0; 80][..], &10_000_u32.to_le_bytes(), &[0; 500_000]].concat();
    let off =
        ["OFF 10000 50000 0\n".to_owned(), "0 0 0\n".repeat(10_000), "3 0 0 0\n".repeat(50_000)].concat();
    for (format, bytes) in [
        (Format::Ply, dense),
        (Format::Ply, empty_faces),
        (Format::Obj, text.into_bytes()),
        (Format::Stl, soup),
        (Format::Off, off.into_bytes()),
    ] {
        let (held, result) = peak(|| io::read_bytes(format, &bytes));
        assert!(result.is_ok(), "{format}: {:?}", result.err());
        assert!(held <= FLOOR + FACTOR * bytes.len(), "{format}: {held} bytes for a file of {}", bytes.len());
    }

    // An entry of a document takes three bytes there, and a structure here.
    let nodes = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{{}}{}]}}"#, ",{}".repeat(300_000));
    let (held, result) = peak(|| io::read_bytes(Format::Gltf, nodes.as_bytes()));
    assert!(result.is_ok());
    assert!(held <= 192 * nodes.len(), "{held} bytes for {} of nodes", nodes.len());

    let Some(root) = models::all("readers_reserve_a_multiple_of_the_file") else { return };
    for file in [
        "hostile/huge_count.ply",
        "hostile/truncated.ply",
        "hostile/truncated.stl",
        "real/igea.ply",
        "real/ogre.obj",
    ] {
        let size = std::fs::metadata(root.join(file)).unwrap().len() as usize;
        let (held, _) = peak(|| io::read(root.join(file)));
        assert!(held <= FLOOR + FACTOR * size, "{file}: {held} bytes for a file of {size}");
    }
    baked(&root.join("real/igea.ply"));
}

/// The baked container: a right checksum does not make a length right.
fn baked(model: &std::path::Path) {
    let mesh = io::read(model).unwrap();
    let bytes = io::bake("mesh", &mesh).unwrap();
    let (held, _) = peak(|| io::unbake::<multires::mesh::Mesh>("mesh", &bytes).unwrap());
    assert!(held <= 4 * bytes.len(), "{held} bytes for {}", bytes.len());
    // Bytes that claim to be a vector, or a string, of any length.
    for length in [u64::MAX, u64::from(u32::MAX), 1 << 40, 1 << 20] {
        let claim = io::bake("claim", &(length, 0_u64, 0_u64)).unwrap();
        let (held, result) = peak(|| io::unbake::<String>("claim", &claim));
        assert!(result.is_err());
        assert!(held <= FLOOR, "{held} bytes for a string of {length}");
        let (held, result) = peak(|| io::unbake::<Vec<[f32; 3]>>("claim", &claim));
        assert!(result.is_err());
        assert!(held <= (2 << 20), "{held} bytes for a vector of {length}");
        let (_, result) = peak(|| io::unbake::<multires::mesh::Mesh>("claim", &claim));
        assert!(result.is_err());
    }
}
