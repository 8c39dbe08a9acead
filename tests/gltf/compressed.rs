//! Files compressed by meshopt are read as if they were not, and written uncompressed.

use multires::io::{self, Format, GltfDocument};
use multires::mesh::names;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::compare::{File, same_but_for_surfaces};
use crate::gltf_samples::{self, Sample, glb};
use crate::hostile::{numbers, renumber};
use crate::meshopt_encoder as encoder;
use crate::whole::{corners, halved, meshes};
use crate::{models, validator};

const EXT: &str = "EXT_meshopt_compression";
const KHR: &str = "KHR_meshopt_compression";

/// An extension, its version of attributes, and the mode of their channels.
type How = (&'static str, u8, encoder::Channel);

const ALL: [How; 5] = [(EXT, 0, 0), (KHR, 0, 0), (KHR, 1, 0), (KHR, 1, 1), (KHR, 1, 0x52)];

/// A document whose views are compressed, as JSON and the binary chunk.
struct Compressed {
    json: Value,
    buffer: Vec<u8>,
    extension: &'static str,
    /// Bytes of the placeholder.
    fallback: usize,
}

impl Compressed {
    fn new(json: &Value, extension: &'static str) -> Self {
        let mut json = json.clone();
        for list in ["extensionsUsed", "extensionsRequired"] {
            let root = json.as_object_mut().unwrap();
            root.entry(list).or_insert_with(|| json!([])).as_array_mut().unwrap().push(json!(extension));
        }
        Self { json, buffer: Vec::new(), extension, fallback: 0 }
    }

    fn append(&mut self, bytes: &[u8]) -> usize {
        let start = self.buffer.len().next_multiple_of(4);
        self.buffer.resize(start, 0);
        self.buffer.extend_from_slice(bytes);
        start
    }

    /// Makes a view one of `count * stride` bytes that are stored as a stream.
    fn compress(
        &mut self,
        view: usize,
        stream: &[u8],
        stride: usize,
        count: usize,
        mode: &str,
        filter: &str,
    ) {
        let start = self.append(stream);
        let length = stride * count;
        let view = &mut self.json["bufferViews"][view];
        view["buffer"] = json!(1);
        view["byteOffset"] = json!(self.fallback);
        view["byteLength"] = json!(length);
        view["extensions"][self.extension] = json!({ "buffer": 0, "byteOffset": start, "byteLength": stream.len(),
            "byteStride": stride, "count": count, "mode": mode });
        if filter != "NONE" {
            view["extensions"][self.extension]["filter"] = json!(filter);
        }
        self.fallback += length.next_multiple_of(4);
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.buffer.len().next_multiple_of(4) },
            { "byteLength": self.fallback, "extensions": { self.extension: { "fallback": true } } }]);
        glb(&json, &self.buffer)
    }
}

/// Compresses every view for which there is a mode.
fn compressed(sample: &Sample, (extension, version, channel): How) -> Compressed {
    let file = File::of_glb(&sample.glb());
    let mut made = Compressed::new(&file.json, extension);
    for v in 0..file.json["bufferViews"].as_array().unwrap().len() {
        let (json, bytes) = (&file.json["bufferViews"][v], file.view(&json!(v)));
        let accessors = file.json["accessors"].as_array().unwrap().iter();
        let kind = accessors.filter(|a| a["bufferView"] == v).find_map(|a| a["componentType"].as_u64());
        let size = if kind == Some(5123) { 2 } else { 4 };
        if json["target"] == 34963 && kind != Some(5121) {
            let mut list = Vec::new();
            for word in bytes.chunks_exact(size) {
                list.push(word.iter().rev().fold(0, |index, &byte| index << 8 | u32::from(byte)));
            }
            if list.len() % 3 == 0 {
                made.compress(v, &encoder::triangles(&list), size, list.len(), "TRIANGLES", "NONE");
            } else {
                made.compress(v, &encoder::indices(&list), size, list.len(), "INDICES", "NONE");
            }
            continue;
        }
        let stride = json["byteStride"].as_u64().map_or(4, |stride| stride as usize);
        if bytes.len() % stride == 0 {
            let stream = encoder::attributes(version, bytes, stride, channel);
            made.compress(v, &stream, stride, bytes.len() / stride, "ATTRIBUTES", "NONE");
        } else {
            let start = made.append(bytes);
            made.json["bufferViews"][v]["byteOffset"] = json!(start);
        }
    }
    made
}

#[test]
fn compressed_documents_are_the_uncompressed_ones() {
    for sample in gltf_samples::all() {
        let plain = GltfDocument::from_bytes(&sample.glb()).unwrap();
        for how in ALL {
            let what = format!("{}, {how:?}", sample.name);
            let made = compressed(&sample, how);
            assert!(made.json.to_string().contains("byteStride"), "{what}");
            let bytes = made.glb();
            let mesh = io::read_bytes(Format::Glb, &bytes).unwrap();
            assert_eq!(mesh, io::read_bytes(Format::Glb, &sample.glb()).unwrap(), "{what}");

            let document = GltfDocument::from_bytes(&bytes).unwrap();
            let back = document.to_glb().unwrap();
            let [a, b] = [sample.glb(), back.clone()].map(|bytes| File::of_glb(&bytes));
            same_but_for_surfaces(&what, &a, &b, &[]);
            assert_eq!(a.json["extensionsRequired"], b.json["extensionsRequired"], "{what}");
            assert!(!b.json.to_string().contains("meshopt"), "{what}");
            assert_eq!(b.json["buffers"].as_array().unwrap().len(), 1, "{what}");
            let again = GltfDocument::from_bytes(&back).unwrap();
            for list in [meshes(&document), meshes(&again)] {
                for (a, b) in meshes(&plain).iter().zip(&list) {
                    assert_eq!(a.as_ref().map(corners), b.as_ref().map(corners), "{what}");
                }
            }
        }
    }
}

#[test]
fn halved_documents_are_valid_and_uncompressed() {
    let folder = std::env::temp_dir().join(format!("multires-meshopt-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    for (i, sample) in gltf_samples::all().into_iter().enumerate() {
        let made = compressed(&sample, ALL[i % ALL.len()]);
        let lighter = halved(&GltfDocument::from_bytes(&made.glb()).unwrap());
        let bytes = lighter.to_glb().unwrap();
        assert!(!File::of_glb(&bytes).json.to_string().contains("meshopt"), "{}", sample.name);
        let plain = halved(&GltfDocument::from_bytes(&sample.glb()).unwrap());
        assert_eq!(lighter.notes(), plain.notes(), "{}", sample.name);
        for (a, b) in meshes(&plain).iter().zip(&meshes(&lighter)) {
            assert_eq!(a.as_ref().map(corners), b.as_ref().map(corners), "{}", sample.name);
        }
        let path = folder.join(format!("{i}.glb"));
        std::fs::write(&path, bytes).unwrap();
        files.push(path);
    }
    let errors = validator::errors("halved_documents_are_valid_and_uncompressed", &files);
    assert!(errors.is_empty(), "{} errors\n{}", errors.len(), errors[..errors.len().min(20)].join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect()
}

/// Decodes a stream: as the only view of a document, written uncompressed.
fn decoded(stream: &[u8], stride: usize, count: usize, mode: &str, filter: &str) -> Result<Vec<u8>, String> {
    let json = json!({ "asset": { "version": "2.0" }, "bufferViews": [{}] });
    let mut made = Compressed::new(&json, KHR);
    made.compress(0, stream, stride, count, mode, filter);
    let document = GltfDocument::from_bytes(&made.glb()).map_err(|e| e.to_string())?;
    Ok(File::of_glb(&document.to_glb().unwrap()).view(&json!(0)).to_vec())
}

/// Streams of our own values, made by the encoder of meshoptimizer 1.3.0 (its npm package: `encodeVertexBufferLevel`,
/// `encodeIndexBuffer`, `encodeIndexSequence`).
#[test]
fn streams_of_meshoptimizer_are_read() {
    let words: Vec<u8> = (0..40_u32)
        .flat_map(|i| [i * i, 65_535 - 3 * i, 7_919 * i, 500])
        .flat_map(|x| (x as u16).to_le_bytes())
        .collect();
    for stream in [
        "a01f0002060a0e12161a1e22262a2e32363a3e42464a4e52565a5e62666a6e72767affff00007e82868a8e92969a1480020080808000002a055555555555555555555555555555555555555500000000001f0021212121212121212121212121212121212121212121212121212121212121ffff000021212121212121211f003c3e3e3e3e3e3e3e3e3e3e3e3e3e3e3c3e3e3e3e3e3e3e3e3e3e3e3e3e3e3cffff00003e3e3e3e3e3e3e3e00000000000000000000000000000000000000000000000000000000ffff0000f401",
        "a19baf0002060a0e12161a1e22262a2e32363a3e42464a4e52565a5e62666a6e72767a7e82868a8e92969a2a05555555555555555555555555555555555555550000000000212121212121212121212121212121212121212121212121212121212121212121212121212121003c3e3e3e3e3e3e3e3e3e3e3e3e3e3e3c3e3e3e3e3e3e3e3e3e3e3e3e3e3e3c3e3e3e3e3e3e3e3e00000000000000000000000000000000ffff0000f4010100",
    ] {
        assert_eq!(decoded(&bytes(stream), 8, 40, "ATTRIBUTES", "NONE").unwrap(), words);
    }
    let floats: Vec<u8> = (0..40).flat_map(|i| (0.25 * i as f32 - 3.0).to_le_bytes()).collect();
    for stream in [
        "a000001f001f1f1f1f3f3f3f3f7f7fffffffff8080404040402020202020202020101010ffff0000101010101010101005001001f8847c0080000000000000000000000000000000000000000000000000000000000000000040c0",
        "a13a001f1f1f1f3f3f3f3f7f7fff00000080804040404020202020202020201010101010101010101010010070837d0100000000000000000000000000000000000000000040c001",
        "a1680520300f170710000f1a0e262f4c4f8ffff8fc1830d0d030f4c4f262e262f13118fc1edddd000007030f0300000000000000000000000000000000000000000040c052",
    ] {
        assert_eq!(decoded(&bytes(stream), 4, 40, "ATTRIBUTES", "NONE").unwrap(), floats);
    }
    // Triangles of a grid of 4 x 5 squares; this encoder turns some of them.
    let stream = "e1fe1e001e001e001ede0e061e051e041ede0e041e041e041ede0e041e041e041ede0e041e041e041ef00a007687566778a9866589689801690000";
    let turned = |t: [u16; 3]| {
        let first = (0..3).min_by_key(|&i| t[i]).unwrap();
        [0, 1, 2].map(|i| t[(first + i) % 3])
    };
    let list = decoded(&bytes(stream), 2, 120, "TRIANGLES", "NONE").unwrap();
    let list: Vec<u16> = list.chunks_exact(2).map(|x| u16::from_le_bytes([x[0], x[1]])).collect();
    let quads = (0..20).map(|i| i / 4 * 5 + i % 4);
    let expected: Vec<[u16; 3]> = quads.flat_map(|a| [[a, a + 5, a + 1], [a + 1, a + 5, a + 6]]).collect();
    let list: Vec<[u16; 3]> = list.chunks_exact(3).map(|t| turned([t[0], t[1], t[2]])).collect();
    assert_eq!(list, expected.into_iter().map(turned).collect::<Vec<_>>());
    let stream = "d10085b5180809080908090809080908090809080908090809080908090809080900000000";
    let expected: Vec<u8> = (0..30_u32).flat_map(|i| ((i & 1) * 100_000 + i).to_le_bytes()).collect();
    assert_eq!(decoded(&bytes(stream), 4, 30, "INDICES", "NONE").unwrap(), expected);
}

/// Streams and results of meshoptimizer 1.3.0, of vectors, rotations, floats and colours that are written here; a result may
/// be 1 off (KHR_meshopt_compression, appendix B), but for floats.
#[test]
fn filters_of_meshoptimizer_are_applied() {
    let vectors = "7f00007f008100810000817f4c009a81c44c527fc4b4ae81";
    let wide_vectors =
        "ff7f00000000ff7f0000018000000180000000000180ff7fc54c00009599018097c2ca4cf351ff7f97c236b30dae0180";
    let rotations = "000000000000ff7f0f4006c0fa3ffa3f6566000033b300000000ff7f00000000";
    let cases = [
        (
            "OCTAHEDRAL",
            4,
            "a0013cf00000fdfebc5f013ff00000fd036b39f000020434340000000000000000000000000000000000000000000000000000000000000000007f007f7f",
            vectors,
        ),
        (
            "OCTAHEDRAL",
            8,
            "a00124f00000730c013cf000000d0e1305012ff0000003d970e4013ff000000f1e05030f00000204343400000000000126600000000000000000000000000000000000000000000000000000ff070000ff07ff7f",
            wide_vectors,
        ),
        (
            "QUATERNION",
            8,
            "a0013c000000b2b1013c0000000b0c013f000000b1df6d013f0000000a170e013c000000b1b2013c0000000a0901320000000500000000000000000000000000000000000000000000000000000000000000ff07",
            rotations,
        ),
        (
            "COLOR",
            4,
            "a1ff0001824c0000fe9c00007d7e00fe7d4c000000000000000000000000000000000000000000008000",
            "00000000fffffffffe010080336699cc",
        ),
        (
            "COLOR",
            8,
            "a1ffff000102cc001e15040000016300000e150000020100000708000102cc000e0504000000000000000000000000000000000000000000080000",
            "0000000000000000ffffffffffffffffefff100000000880333366669999cccc",
        ),
    ];
    for (filter, stride, stream, expected) in cases {
        let expected = bytes(expected);
        let found = decoded(&bytes(stream), stride, expected.len() / stride, "ATTRIBUTES", filter).unwrap();
        let size = stride / 4;
        for (a, b) in found.chunks_exact(size).zip(expected.chunks_exact(size)) {
            let value = |x: &[u8]| x.iter().rev().fold(0_i32, |value, &byte| value << 8 | i32::from(byte));
            assert!((value(a) - value(b)).abs() <= 1, "{filter}: {found:?}, {expected:?}");
        }
    }
    let floats = [0.0, 1.0, -1.0, 0.1, 1e-20, -123_456.79, 3e20, 65_535.0_f32];
    let stream = "a00103ff0000ce3a92e74e0103ff0000cc1805c31b013fff000080ffb30f528b7c0123ff0000077da6686900000000000000000000000000000000000000000000000000000000000000e9";
    let found = decoded(&bytes(stream), 4, 8, "ATTRIBUTES", "EXPONENTIAL").unwrap();
    assert_eq!(found, bytes("000000000000803f000080bfcecccc3d08e53c1e6620f1c7b21a826100ff7f47"));
    for (bytes, float) in found.chunks_exact(4).zip(floats) {
        let found = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        assert!((found - float).abs() <= float.abs() * 2e-7, "{found} {float}");
    }
}

/// Forms of floats: exponent in the highest 8 bits, mantissa in 24.
fn forms(values: &[f32], exponent: i32) -> Vec<u8> {
    let scale = 2_f64.powi(-exponent);
    let forms = values.iter().map(|&x| exponent << 24 | (f64::from(x) * scale).round() as i32 & 0xff_ffff);
    forms.flat_map(i32::to_le_bytes).collect()
}

#[test]
fn bounds_are_those_of_filtered_values() {
    let sample = gltf_samples::all().swap_remove(0);
    let file = File::of_glb(&sample.glb());
    let position =
        sample.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let view = sample.json["accessors"][position]["bufferView"].as_u64().unwrap() as usize;
    let values: &[f32] = &gltf_samples::positions().concat();
    let mut made = compressed(&sample, ALL[2]);
    // 1/256: far from the bounds that are written.
    let stream = encoder::attributes(1, &forms(values, -8), 12, 0);
    made.compress(view, &stream, 12, values.len() / 3, "ATTRIBUTES", "EXPONENTIAL");
    let document = GltfDocument::from_bytes(&made.glb()).unwrap();
    let mesh = document.mesh(0).unwrap().unwrap().mesh;
    for (found, value) in mesh.positions().as_flattened().iter().zip(values) {
        assert_eq!(*found, (value * 256.0).round() / 256.0);
    }
    let back = File::of_glb(&document.to_glb().unwrap());
    let [old, new] = [&file, &back].map(|file| file.json["accessors"][position].clone());
    assert_ne!(old["max"], new["max"]);
    let bounds = mesh.bounds().unwrap().map(|corner| json!(corner.map(f64::from)));
    assert_eq!([&new["min"], &new["max"]], [&bounds[0], &bounds[1]]);
    assert!(mesh.attribute(names::NORMAL).is_some());
}

#[test]
fn uncompressed_bytes_come_first() {
    // A stream that is none: read is what lies beside it.
    let mut made = compressed(&gltf_samples::all().swap_remove(0), ALL[0]);
    let plain = GltfDocument::from_bytes(&made.glb()).unwrap().to_glb().unwrap();
    let mut file = File::of_glb(&plain);
    for view in file.json["bufferViews"].as_array_mut().unwrap() {
        let form = json!({ "buffer": 0, "byteLength": 3, "byteStride": 4, "count": 1, "mode": "ATTRIBUTES" });
        view["extensions"] = json!({ EXT: form });
    }
    let expected = io::read_bytes(Format::Glb, &plain).unwrap();
    for required in [json!([]), json!([EXT])] {
        file.json["extensionsUsed"] = json!([EXT]);
        file.json["extensionsRequired"] = required;
        let bytes = glb(&file.json, &file.buffer);
        assert_eq!(io::read_bytes(Format::Glb, &bytes).unwrap(), expected);
        let back = GltfDocument::from_bytes(&bytes).unwrap().to_glb().unwrap();
        assert_eq!(File::of_glb(&back).json["extensionsUsed"], Value::Null);
    }
    // A fallback that is not there, and a placeholder without a mark.
    for buffer in [
        json!({ "byteLength": made.fallback, "uri": "gone.bin", "extensions": { EXT: { "fallback": true } } }),
        json!({ "byteLength": made.fallback }),
    ] {
        made.json["buffers"] = json!([{ "byteLength": made.buffer.len().next_multiple_of(4) }, buffer]);
        let bytes = glb(&made.json, &made.buffer);
        assert_eq!(io::read_bytes(Format::Glb, &bytes).unwrap(), expected);
    }
    // Without compressed views it is missing, and a file that is no fallback too.
    for buffer in [json!({ "byteLength": 4 }), json!({ "byteLength": 4, "uri": "gone.bin" })] {
        made.json["buffers"].as_array_mut().unwrap().truncate(2);
        made.json["buffers"].as_array_mut().unwrap().push(buffer);
        assert!(io::read_bytes(Format::Glb, &glb(&made.json, &made.buffer)).is_err());
    }
}

#[test]
fn streams_that_are_none_are_refused() {
    let elements: Vec<u8> = (0..64).collect();
    let good = encoder::attributes(1, &elements, 4, 0);
    let triangles = encoder::triangles(&[0, 1, 2, 2, 1, 3, 2, 3, 9]);
    let indices = encoder::indices(&[5, 6, 7]);
    let with = |stream: &[u8], at: usize, byte: u8| {
        let mut stream = stream.to_vec();
        stream[at] = byte;
        stream
    };
    let longer = |stream: &[u8]| {
        let mut stream = stream.to_vec();
        stream.insert(stream.len() - 30.min(stream.len() / 2), 0);
        stream
    };
    // Stream, stride, count, mode, filter, words of the error.
    type Case<'a> = (Vec<u8>, usize, usize, &'a str, &'a str, &'a str);
    let cases: &[Case] = &[
        (
            good.clone(),
            4,
            1 << 40,
            "ATTRIBUTES",
            "NONE",
            "truncated: buffer view 0 has 1099511627776 elements",
        ),
        (good.clone(), 4, 300, "ATTRIBUTES", "NONE", "ends too early"),
        (good[..20].to_vec(), 4, 16, "ATTRIBUTES", "NONE", "truncated"),
        (longer(&good), 4, 16, "ATTRIBUTES", "NONE", "meshopt compression"),
        (with(&good, 0, 0xa2), 4, 16, "ATTRIBUTES", "NONE", "no version that is known"),
        (with(&good, good.len() - 1, 3), 4, 16, "ATTRIBUTES", "NONE", "mode is not known"),
        (with(&good, good.len() - 1, 0x10), 4, 16, "ATTRIBUTES", "NONE", "mode is not known"),
        (good.clone(), 6, 16, "ATTRIBUTES", "NONE", "cannot be"),
        (good.clone(), 260, 16, "ATTRIBUTES", "NONE", "cannot be"),
        (good.clone(), 4, 16, "ATTRIBUTES", "QUATERNION", "cannot be"),
        (
            good.clone(),
            4,
            16,
            "ATTRIBUTES",
            "SHARP",
            "not supported: buffer view 0, meshopt compression: the filter \"SHARP\"",
        ),
        (
            good,
            4,
            16,
            "POINTS\n",
            "NONE",
            "not supported: buffer view 0, meshopt compression: the mode \"POINTS\\n\"",
        ),
        (triangles.clone(), 4, 8, "TRIANGLES", "NONE", "cannot be"),
        (triangles.clone(), 8, 9, "TRIANGLES", "NONE", "cannot be"),
        (triangles.clone(), 4, 9, "TRIANGLES", "COLOR", "cannot be"),
        (triangles.clone(), 4, 12, "TRIANGLES", "NONE", "too early"),
        (triangles.clone(), 4, 6, "TRIANGLES", "NONE", "bytes are left"),
        (with(&triangles, 0, 0xe0), 4, 9, "TRIANGLES", "NONE", "no version that is known"),
        (with(&triangles, 1, 0x40), 4, 9, "TRIANGLES", "NONE", "before the first"),
        (with(&triangles, triangles.len() - 1, 1), 4, 9, "TRIANGLES", "NONE", "table"),
        (with(&triangles, triangles.len() - 9, 0xf0), 4, 9, "TRIANGLES", "NONE", "table"),
        (triangles, 4, 3 << 40, "TRIANGLES", "NONE", "truncated"),
        ([0xd1, 0x80, 0x80, 0, 0, 0, 0].to_vec(), 4, 2, "INDICES", "NONE", "too early"),
        (indices.clone(), 4, 2, "INDICES", "NONE", "bytes are left"),
        (indices.clone(), 4, 1 << 40, "INDICES", "NONE", "truncated"),
        (with(&indices, 0, 0xd0), 4, 3, "INDICES", "NONE", "no version that is known"),
        (
            [0xd1, 0xff, 0xff, 0xff, 0xff, 0xff, 1, 0, 0, 0, 0].to_vec(),
            4,
            1,
            "INDICES",
            "NONE",
            "longer than 5 bytes",
        ),
        (Vec::new(), 4, 0, "INDICES", "NONE", "truncated"),
    ];
    for (stream, stride, count, mode, filter, words) in cases {
        let error = decoded(stream, *stride, *count, mode, filter).expect_err(words);
        assert!(error.contains(words) && !error.contains('\n'), "{error:?} where {words:?} was expected");
    }
    // Views that share a stream of zeros.
    let zeros = encoder::attributes(1, &vec![0; 1 << 20], 4, 0);
    let json = json!({ "asset": { "version": "2.0" }, "bufferViews": vec![json!({}); 20] });
    let mut made = Compressed::new(&json, EXT);
    (0..20).for_each(|view| made.compress(view, &zeros, 4, 1 << 18, "ATTRIBUTES", "NONE"));
    let start = made.json["bufferViews"][0]["extensions"][EXT]["byteOffset"].clone();
    for view in made.json["bufferViews"].as_array_mut().unwrap() {
        view["extensions"][EXT]["byteOffset"] = start.clone();
    }
    made.buffer.truncate(zeros.len());
    let error = GltfDocument::from_bytes(&made.glb()).unwrap_err().to_string();
    assert!(error.contains("too large: 20971520 decoded bytes"), "{error}");
}

#[cfg(not(feature = "draco"))]
#[test]
fn draco_is_refused_with_a_way_out() {
    let mut sample = gltf_samples::all().swap_remove(0);
    sample.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    assert!(GltfDocument::from_bytes(&sample.glb()).is_ok());
    sample.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let error = GltfDocument::from_bytes(&sample.glb()).unwrap_err().to_string();
    assert!(error.contains("KHR_draco_mesh_compression") && error.contains("gltf-transform"), "{error}");
    assert!(!error.contains('\n'), "{error}");
}

#[test]
fn cases_with_compressed_views() {
    let Some(root) = models::all("cases_with_compressed_views") else { return };
    let folder = root.join("cases/gltf_meshopt_fallback");
    let [a, b] = ["optional.glb", "required.glb"].map(|name| io::read(folder.join(name)).unwrap());
    assert_eq!((a.triangles().len(), a.positions().len()), (320, 162));
    assert_eq!(a, b);
}

#[test]
fn every_number_of_an_extension_may_be_wrong() {
    let wrong = [
        json!(0),
        json!(1),
        json!(3),
        json!(4),
        json!(65_536),
        json!(1_u64 << 53),
        json!(u64::MAX),
        json!(-1),
    ];
    let mut made = compressed(&gltf_samples::all()[3], ALL[3]);
    let whole = made.json.clone();
    for place in 0..numbers(&whole) {
        for number in &wrong {
            made.json = whole.clone();
            renumber(&mut made.json, &mut place.clone(), number);
            let bytes = made.glb();
            let _ = io::read_bytes(Format::Glb, &bytes);
            let Ok(document) = GltfDocument::from_bytes(&bytes) else { continue };
            if let Ok(written) = document.to_glb() {
                GltfDocument::from_bytes(&written).expect("what is written is read");
            }
        }
    }
}

/// Streams of every mode, with their strides, counts and filters.
fn streams() -> Vec<(Vec<u8>, usize, usize, &'static str, &'static str)> {
    let words: Vec<u8> =
        (0..300_u32).flat_map(|i| [i, i * i, 7 * i, 0x7f]).flat_map(|x| (x as u16).to_le_bytes()).collect();
    let list: Vec<u32> = (0..100).flat_map(|i| [i, i + 1, i * 7 % 50]).collect();
    let mut all = vec![
        (encoder::triangles(&list), 2, 300, "TRIANGLES", "NONE"),
        (encoder::indices(&list), 4, 300, "INDICES", "NONE"),
    ];
    for (version, channel, filter) in [
        (0, 0, "NONE"),
        (0, 0, "OCTAHEDRAL"),
        (1, 0, "QUATERNION"),
        (1, 1, "COLOR"),
        (1, 0x32, "EXPONENTIAL"),
    ] {
        all.push((encoder::attributes(version, &words, 8, channel), 8, 300, "ATTRIBUTES", filter));
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// Any element comes back, whatever the stride, version and channels.
    #[test]
    fn attributes_come_back(
        words in prop::collection::vec(prop_oneof![3 => Just(0_u32), 2 => 0..9_u32, 1 => any::<u32>()], 64..2_000),
        stride in 1..=64_usize,
        how in prop_oneof![Just((0, 0)), Just((1, 0)), Just((1, 1)), (0..16_u8).prop_map(|turn| (1, 2 | turn << 4))],
    ) {
        let bytes: Vec<u8> = words.iter().flat_map(|x| x.to_le_bytes()).collect();
        let bytes = &bytes[..bytes.len() / (4 * stride) * 4 * stride];
        let stream = encoder::attributes(how.0, bytes, 4 * stride, how.1);
        let found = decoded(&stream, 4 * stride, bytes.len() / (4 * stride), "ATTRIBUTES", "NONE");
        prop_assert_eq!(found.unwrap(), bytes);
    }

    /// Any indices come back.
    #[test]
    fn indices_come_back(list in prop::collection::vec(prop_oneof![0..20_u32, 0..1_u32 << 29], 1..100)) {
        let list: Vec<u32> = list.iter().flat_map(|&i| [i, i / 2, i + 1]).collect();
        let expected: Vec<u8> = list.iter().flat_map(|x| x.to_le_bytes()).collect();
        for (stream, mode) in [(encoder::triangles(&list), "TRIANGLES"), (encoder::indices(&list), "INDICES")] {
            prop_assert_eq!(decoded(&stream, 4, list.len(), mode, "NONE").unwrap(), expected.clone());
        }
    }

    /// Changed and random streams are decoded or refused.
    #[test]
    fn damaged_streams_do_no_harm(
        which in 0..7_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        length in any::<prop::sample::Index>(),
        count in prop_oneof![4 => Just(None), 1 => (0..2_000_usize).prop_map(Some)],
        random in prop_oneof![3 => Just(None), 1 => prop::collection::vec(any::<u8>(), 1..600).prop_map(Some)],
        is_cut in prop::bool::weighted(0.2),
    ) {
        let (mut stream, stride, own, mode, filter) = streams().swap_remove(which);
        if let Some(random) = random {
            // Kept: the version.
            let first = stream[0];
            stream = random;
            stream[0] = first;
        }
        for (place, byte) in changes {
            let place = place.index(stream.len());
            stream[place] = byte;
        }
        if is_cut {
            stream.truncate(length.index(stream.len()));
        }
        let count = count.unwrap_or(own);
        if let Ok(bytes) = decoded(&stream, stride, count, mode, filter) {
            prop_assert_eq!(bytes.len(), count * stride);
        }
    }

    /// Changed files are read or refused.
    #[test]
    fn damaged_files_do_no_harm(
        which in 0..5_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let sample = &gltf_samples::all()[8];
        let mut bytes = compressed(sample, ALL[which]).glb();
        for (place, byte) in changes {
            let place = 20 + place.index(bytes.len() - 20);
            bytes[place] = byte;
        }
        let _ = io::read_bytes(Format::Glb, &bytes);
        if let Ok(document) = GltfDocument::from_bytes(&bytes) {
            let _ = document.to_glb();
        }
    }
}
