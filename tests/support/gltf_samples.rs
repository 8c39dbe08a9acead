//! Documents of the kinds that Khronos' samples show, each made here: skins, morph targets, instances, variants, several
//! texture coordinates, sparse and quantised accessors, and so on.

#![allow(dead_code)]

use serde_json::{Value, json};

/// A document in the making.
pub struct Sample {
    pub name: &'static str,
    pub json: Value,
    pub buffer: Vec<u8>,
}

/// A bent tube with a seam along it: vertices in rows of `AROUND + 1`.
pub const AROUND: usize = crate::TUBE[0];
pub const ALONG: usize = crate::TUBE[1];

fn angle(i: usize) -> f32 {
    std::f32::consts::TAU * (i % AROUND) as f32 / AROUND as f32
}

fn vertices<const N: usize>(value: impl Fn(usize, usize) -> [f32; N]) -> Vec<[f32; N]> {
    (0..=ALONG).flat_map(|row| (0..=AROUND).map(move |i| (row, i))).map(|(row, i)| value(row, i)).collect()
}

/// Positions: radius 1 with waves, length 10 along y.
pub fn positions() -> Vec<[f32; 3]> {
    vertices(|row, i| {
        let y = 10.0 * row as f32 / ALONG as f32;
        let radius = 1.0 + 0.15 * (1.3 * y).sin();
        [radius * angle(i).cos(), y, radius * angle(i).sin()]
    })
}

pub fn normals() -> Vec<[f32; 3]> {
    vertices(|row, i| {
        let y = 10.0 * row as f32 / ALONG as f32;
        let slope = -0.15 * 1.3 * (1.3 * y).cos();
        let length = (1.0 + slope * slope).sqrt();
        [angle(i).cos() / length, slope / length, angle(i).sin() / length]
    })
}

fn tangents() -> Vec<[f32; 4]> {
    vertices(|_, i| [-angle(i).sin(), 0.0, angle(i).cos(), -1.0])
}

fn uvs(scale: f32) -> Vec<[f32; 2]> {
    vertices(move |row, i| [scale * i as f32 / AROUND as f32, scale * row as f32 / ALONG as f32])
}

/// Triangles of rows `from..to`.
fn indices(from: usize, to: usize) -> Vec<u16> {
    let at = |row: usize, i: usize| (row * (AROUND + 1) + i) as u16;
    let quads = (from..to).flat_map(|row| (0..AROUND).map(move |i| (row, i)));
    quads
        .flat_map(|(row, i)| {
            let [a, b, c, d] = [at(row, i), at(row + 1, i), at(row, i + 1), at(row + 1, i + 1)];
            [a, b, c, c, b, d]
        })
        .collect()
}

impl Sample {
    pub fn new(name: &'static str) -> Self {
        let json = json!({
            "asset": { "version": "2.0", "generator": "samples", "copyright": "none", "extras": { "kept": [1, 2.5, "x"] } },
            "scene": 0,
            "scenes": [{ "name": "main", "nodes": [0] }],
            "nodes": [{ "name": "tube", "mesh": 0 }],
            "meshes": [], "accessors": [], "bufferViews": [],
        });
        Self { name, json, buffer: Vec::new() }
    }

    fn push(&mut self, section: &str, value: Value) -> usize {
        let root = self.json.as_object_mut().unwrap();
        let list = root.entry(section).or_insert_with(|| json!([])).as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8], more: Value) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        for (key, value) in more.as_object().into_iter().flatten() {
            view[key] = value.clone();
        }
        self.buffer.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str, view: Value) -> usize {
        let view = self.view(bytes, view);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
        )
    }

    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        let view = json!({ "target": 34962 });
        self.accessor(bytemuck::cast_slice(values.as_flattened()), 5126, values.len(), kind, view)
    }

    /// Values no vertex has: of animations and skins.
    pub fn other(&mut self, values: &[f32], width: usize) -> usize {
        let kind = if width == 16 { "MAT4" } else { ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1] };
        let accessor =
            self.accessor(bytemuck::cast_slice(values), 5126, values.len() / width, kind, Value::Null);
        if width == 1 {
            self.range(accessor, &[values[0].into()], &[values[values.len() - 1].into()]);
        }
        accessor
    }

    fn range(&mut self, accessor: usize, low: &[f64], high: &[f64]) {
        self.json["accessors"][accessor]["min"] = json!(low);
        self.json["accessors"][accessor]["max"] = json!(high);
    }

    pub fn positions(&mut self, values: &[[f32; 3]]) -> usize {
        let accessor = self.floats(values);
        let ends = |f: fn(f64, f64) -> f64, from: f64| {
            [0, 1, 2].map(|i| values.iter().fold(from, |x, p| f(x, p[i].into())))
        };
        self.range(accessor, &ends(f64::min, f64::INFINITY), &ends(f64::max, f64::NEG_INFINITY));
        accessor
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        self.accessor(bytemuck::cast_slice(values), 5123, values.len(), "SCALAR", json!({ "target": 34963 }))
    }

    /// Attributes and indices of the whole tube.
    pub fn tube(&mut self) -> Value {
        let position = self.positions(&positions());
        let (normal, uv) = (self.floats(&normals()), self.floats(&uvs(1.0)));
        let indices = self.indices(&indices(0, ALONG));
        json!({
            "attributes": { "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv },
            "indices": indices,
        })
    }

    fn mesh(&mut self, primitives: &[Value]) -> usize {
        self.push("meshes", json!({ "name": "tube mesh", "primitives": primitives, "extras": { "id": 7 } }))
    }

    /// Returns the file as .glb.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let length = self.buffer.len().next_multiple_of(4);
        json["buffers"] = json!([{ "byteLength": length, "name": "all" }]);
        glb(&json, &self.buffer)
    }
}

/// Returns a document with its binary chunk as .glb.
pub fn glb(json: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut buffer = buffer.to_vec();
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    for word in [2, 28 + text.len() + buffer.len(), text.len()] {
        file.extend_from_slice(&(word as u32).to_le_bytes());
    }
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&text);
    file.extend_from_slice(&(buffer.len() as u32).to_le_bytes());
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(&buffer);
    file
}

/// The smallest picture: a black dot.
pub const DOT: &[u8] = &[
    0x89, b'P', b'N', b'G', 0x0d, 0x0a, 0x1a, 0x0a, 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0, 0,
    1, 8, 0, 0, 0, 0, 0x3a, 0x7e, 0x9b, 0x55, 0, 0, 0, 10, b'I', b'D', b'A', b'T', 0x78, 0x9c, 0x63, 0x60, 0,
    0, 0, 2, 0, 1, 0x48, 0xaf, 0xa4, 0x71, 0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82,
];

fn plain() -> Sample {
    let mut s = Sample::new("plain");
    let tube = s.tube();
    s.mesh(&[tube]);
    s
}

/// Two joints and an animation of them that bends the tube by a right angle.
pub fn skinned() -> Sample {
    let mut s = Sample::new("skinned");
    let mut tube = s.tube();
    let joints: Vec<[u8; 4]> = positions().iter().map(|_| [0, 1, 0, 0]).collect();
    let view = json!({ "target": 34962, "byteStride": 4 });
    let joints = s.accessor(joints.as_flattened(), 5121, joints.len(), "VEC4", view.clone());
    let weight = |p: &[f32; 3]| (((p[1] - 3.0) / 4.0).clamp(0.0, 1.0) * 255.0).round() as u8;
    let weights: Vec<[u8; 4]> = positions().iter().map(|p| [255 - weight(p), weight(p), 0, 0]).collect();
    let weights = s.accessor(weights.as_flattened(), 5121, weights.len(), "VEC4", view);
    s.json["accessors"][weights]["normalized"] = json!(true);
    tube["attributes"]["JOINTS_0"] = json!(joints);
    tube["attributes"]["WEIGHTS_0"] = json!(weights);
    s.mesh(&[tube]);
    s.json["nodes"] = json!([
        { "name": "hero", "children": [1, 2], "scale": [100.0, 100.0, 100.0] },
        { "name": "skin", "mesh": 0, "skin": 0 },
        { "name": "hip", "children": [3] },
        { "name": "spine", "translation": [0.0, 5.0, 0.0] },
    ]);
    let mut matrices = Vec::new();
    for y in [0.0, -5.0] {
        matrices.extend([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0]);
    }
    let matrices = s.other(&matrices, 16);
    s.push("skins", json!({ "joints": [2, 3], "skeleton": 2, "inverseBindMatrices": matrices }));
    let times = s.other(&[0.0, 1.0, 2.0], 1);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = s.other(&[0.0, 0.0, 0.0, 1.0, half, 0.0, 0.0, half, 0.0, 0.0, -half, half], 4);
    s.push(
        "animations",
        json!({ "name": "bend", "samplers": [{ "input": times, "output": turns }],
            "channels": [{ "sampler": 0, "target": { "node": 3, "path": "rotation" } }] }),
    );
    s
}

/// Two targets, one with normals; one is animated.
pub fn morphed(sparse: bool) -> Sample {
    let mut s = Sample::new(if sparse { "morph, sparse" } else { "morph" });
    let mut tube = s.tube();
    let bulge: Vec<[f32; 3]> = positions()
        .iter()
        .map(|p| {
            let far = (1.0 - (p[1] - 5.0).abs() / 2.0).max(0.0);
            [2.0 * far * p[0], 0.0, 2.0 * far * p[2]]
        })
        .collect();
    let lean: Vec<[f32; 3]> = positions().iter().map(|p| [0.05 * p[1] * p[1], 0.0, 0.0]).collect();
    let nothing: Vec<[f32; 3]> = vec![[0.0; 3]; lean.len()];
    let bulge = if sparse {
        let rows: Vec<usize> = (0..bulge.len()).filter(|&i| bulge[i] != [0.0; 3]).collect();
        let index: Vec<u16> = rows.iter().map(|&i| i as u16).collect();
        let values: Vec<[f32; 3]> = rows.iter().map(|&i| bulge[i]).collect();
        let index = s.view(bytemuck::cast_slice(&index), Value::Null);
        let values = s.view(bytemuck::cast_slice(values.as_flattened()), Value::Null);
        let accessor = json!({ "componentType": 5126, "count": bulge.len(), "type": "VEC3", "sparse": {
            "count": rows.len(), "indices": { "bufferView": index, "componentType": 5123 }, "values": { "bufferView": values } } });
        let accessor = s.push("accessors", accessor);
        s.range(accessor, &[-2.3, 0.0, -2.3], &[2.3, 0.0, 2.3]);
        let of =
            |f: fn(f32, f32) -> f32, axis: usize| bulge.iter().map(|p| p[axis]).reduce(f).unwrap().into();
        let [low, high] =
            [f32::min as fn(f32, f32) -> f32, f32::max].map(|f| [0, 1, 2].map(|axis| of(f, axis)));
        s.range(accessor, &low, &high);
        accessor
    } else {
        s.positions(&bulge)
    };
    let lean = s.positions(&lean);
    let still = s.floats(&nothing);
    tube["targets"] = json!([{ "POSITION": bulge, "NORMAL": still }, { "POSITION": lean, "NORMAL": still }]);
    let mesh = s.mesh(&[tube]);
    s.json["meshes"][mesh]["weights"] = json!([0.25, 0.0]);
    s.json["meshes"][mesh]["extras"]["targetNames"] = json!(["bulge", "lean"]);
    let times = s.other(&[0.0, 1.0], 1);
    let weights = s.other(&[0.0, 0.0, 1.0, 0.5], 1);
    for member in ["min", "max"] {
        s.json["accessors"][weights].as_object_mut().unwrap().remove(member);
    }
    s.push(
        "animations",
        json!({ "samplers": [{ "input": times, "output": weights, "interpolation": "LINEAR" }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }] }),
    );
    s
}

fn instanced() -> Sample {
    let mut s = plain();
    s.name = "instances";
    let places = s.other(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 10.0, 0.0, 0.0], 3);
    let ids = s.other(&[1.0, 2.0, 3.0], 1);
    s.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places, "_ID": ids } } });
    s.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    s.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    s
}

/// Two materials of the same primitive, and a clear coat with pictures within the file.
fn variants() -> Sample {
    let mut s = plain();
    s.name = "variants";
    let picture = s.view(DOT, Value::Null);
    s.push("images", json!({ "bufferView": picture, "mimeType": "image/png", "name": "dot" }));
    s.push("samplers", json!({ "wrapS": 33071 }));
    s.push("textures", json!({ "source": 0, "sampler": 0 }));
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2.0, 2.0], "rotation": 0.1 } } });
    for name in ["red", "blue"] {
        s.push(
            "materials",
            json!({ "name": name, "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
                "pbrMetallicRoughness": { "baseColorTexture": texture, "roughnessFactor": 0.123456789 },
                "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 0.7, "clearcoatTexture": { "index": 0 } } } }),
        );
    }
    s.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    s.json["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_materials_variants": { "mappings": [
        { "material": 0, "variants": [0] }, { "material": 1, "variants": [1] } ] } });
    s.json["extensions"] =
        json!({ "KHR_materials_variants": { "variants": [{ "name": "a" }, { "name": "b" }] } });
    s.json["extensionsUsed"] =
        json!(["KHR_materials_variants", "KHR_materials_clearcoat", "KHR_texture_transform"]);
    s
}

fn several_uvs() -> Sample {
    let mut s = plain();
    s.name = "two sets of texture coordinates, tangents, colours";
    let (second, tangent) = (s.floats(&uvs(3.0)), s.floats(&tangents()));
    let bytes: Vec<[u8; 4]> =
        vertices(|row, i| [row as f32, i as f32, 128.0, 255.0]).iter().map(|c| c.map(|x| x as u8)).collect();
    let colour = s.accessor(
        bytes.as_flattened(),
        5121,
        bytes.len(),
        "VEC4",
        json!({ "target": 34962, "byteStride": 4 }),
    );
    s.json["accessors"][colour]["normalized"] = json!(true);
    let attributes = &mut s.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_1"] = json!(second);
    attributes["TANGENT"] = json!(tangent);
    attributes["COLOR_0"] = json!(colour);
    s
}

/// Positions in 16 bits, normals in bytes, as `KHR_mesh_quantization` has them.
fn quantised() -> Sample {
    let mut s = Sample::new("quantised");
    let packed: Vec<[i16; 4]> = positions()
        .iter()
        .map(|p| [p[0], p[1] - 5.0, p[2], 0.0].map(|x| (x / 5.0 * 32_767.0) as i16))
        .collect();
    let view = json!({ "target": 34962, "byteStride": 8 });
    let position = s.accessor(bytemuck::cast_slice(packed.as_flattened()), 5122, packed.len(), "VEC3", view);
    s.json["accessors"][position]["normalized"] = json!(true);
    let of = |f: fn(i16, i16) -> i16, axis: usize| packed.iter().map(|p| p[axis]).reduce(f).unwrap().into();
    let [low, high] = [i16::min as fn(i16, i16) -> i16, i16::max].map(|f| [0, 1, 2].map(|axis| of(f, axis)));
    s.range(position, &low, &high);
    let bytes: Vec<[i8; 4]> =
        normals().iter().map(|n| [n[0], n[1], n[2], 0.0].map(|x| (x * 127.0).round() as i8)).collect();
    let view = json!({ "target": 34962, "byteStride": 4 });
    let normal =
        s.accessor(bytemuck::cast_slice(bytes.as_flattened()), 5120, bytes.len(), "VEC3", view.clone());
    s.json["accessors"][normal]["normalized"] = json!(true);
    let uv: Vec<[u16; 2]> = uvs(1.0).iter().map(|p| p.map(|x| (x * 65_535.0).round() as u16)).collect();
    let uv = s.accessor(bytemuck::cast_slice(uv.as_flattened()), 5123, uv.len(), "VEC2", view);
    s.json["accessors"][uv]["normalized"] = json!(true);
    let indices = s.indices(&indices(0, ALONG));
    s.mesh(&[json!({ "attributes": { "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv }, "indices": indices })]);
    s.json["nodes"][0]["scale"] = json!([5.0, 5.0, 5.0]);
    s.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    s.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    s
}

/// Triangles beside lines and points, and a mesh of points alone.
fn other_modes() -> Sample {
    let mut s = plain();
    s.name = "points and lines";
    let tube = s.json["meshes"][0]["primitives"][0].clone();
    let line = s.indices(&[0, 1, 2, 3, 4, 5]);
    let lines =
        json!({ "attributes": { "POSITION": tube["attributes"]["POSITION"] }, "indices": line, "mode": 1 });
    s.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    let dots = s.positions(&[[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
    s.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": dots }, "mode": 0 }] }));
    s.push("nodes", json!({ "mesh": 1 }));
    s.json["scenes"][0]["nodes"] = json!([0, 1]);
    s
}

/// Strips and fans, and triangles without indices.
fn strips() -> Sample {
    let mut s = Sample::new("strips, fans, no indices");
    let position = s.positions(&positions());
    let strip: Vec<u16> = (0..ALONG)
        .flat_map(|row| {
            (0..=AROUND).flat_map(move |i| [row * (AROUND + 1) + i, (row + 1) * (AROUND + 1) + i])
        })
        .map(|v| v as u16)
        .collect();
    let strip = s.indices(&strip);
    let fan = s.positions(&[
        [0.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, -1.0, 1.0],
        [0.0, -1.0, 1.0],
        [-1.0, -1.0, 1.0],
    ]);
    let single = s.positions(&[[0.0, -2.0, 0.0], [1.0, -2.0, 0.0], [1.0, -2.0, 1.0]]);
    s.mesh(&[
        json!({ "attributes": { "POSITION": position }, "indices": strip, "mode": 5 }),
        json!({ "attributes": { "POSITION": fan }, "mode": 6 }),
        json!({ "attributes": { "POSITION": single } }),
    ]);
    s
}

/// Primitives that share their vertices, each with a material of its own.
fn shared_vertices() -> Sample {
    let mut s = Sample::new("primitives that share vertices");
    let tube = s.tube();
    for name in ["wood", "iron", "cloth"] {
        s.push("materials", json!({ "name": name }));
    }
    let part = |s: &mut Sample, material: usize, from: usize, to: usize| {
        let indices = s.indices(&indices(from, to));
        json!({ "attributes": tube["attributes"], "indices": indices, "material": material, "extras": { "part": material } })
    };
    let cut = [ALONG / 4, 3 * ALONG / 4];
    let parts = [part(&mut s, 2, 0, cut[0]), part(&mut s, 0, cut[0], cut[1]), part(&mut s, 2, cut[1], ALONG)];
    s.mesh(&parts);
    s
}

/// A primitive with normals and texture coordinates beside one with colours alone.
fn mixed() -> Sample {
    let mut s = Sample::new("mixed attributes");
    let tube = s.tube();
    let colours: Vec<[f32; 3]> = vertices(|row, _| [row as f32 / ALONG as f32, 0.0, 1.0]);
    let colour = s.floats(&colours);
    let [low, high] = [indices(0, ALONG / 2), indices(ALONG / 2, ALONG)].map(|list| s.indices(&list));
    s.mesh(&[
        json!({ "attributes": tube["attributes"], "indices": low }),
        json!({ "attributes": { "POSITION": tube["attributes"]["POSITION"], "COLOR_0": colour }, "indices": high }),
    ]);
    s
}

/// Cameras, lights and scenes that show a mesh many times.
fn scenes() -> Sample {
    let mut s = plain();
    s.name = "scenes, cameras, lights";
    s.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.01 } }));
    s.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 2.5 }] } });
    s.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    s.json["nodes"] = json!([
        { "mesh": 0, "children": [1], "matrix": [1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 1.0] },
        { "mesh": 0, "camera": 0, "rotation": [0.0, 0.6, 0.0, 0.8] },
        { "mesh": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    ]);
    s.json["scenes"] = json!([{ "nodes": [0] }, { "name": "other", "nodes": [2], "extras": {} }]);
    s.json["scene"] = json!(1);
    s
}

/// Attributes of the application's own, and indices of a byte.
fn custom() -> Sample {
    let mut s = Sample::new("attributes of its own, indices of a byte");
    let rows = ALONG.min(10);
    let [positions, normals] = [positions(), normals()].map(|values| values[..rows * (AROUND + 1)].to_vec());
    let (position, normal) = (s.positions(&positions), s.floats(&normals));
    let feature: Vec<[f32; 1]> = (0..positions.len()).map(|i| [(i / 50) as f32]).collect();
    let feature = s.floats(&feature);
    let list: Vec<u8> = indices(0, rows - 1).iter().map(|&i| i as u8).filter(|&i| i < 255).collect();
    let list = &list[..list.len() / 3 * 3];
    let indices = s.accessor(list, 5121, list.len(), "SCALAR", json!({ "target": 34963 }));
    s.mesh(&[json!({ "attributes": { "POSITION": position, "NORMAL": normal, "_FEATURE_ID_0": feature }, "indices": indices })]);
    s
}

/// One view with all attributes of a vertex beside each other, which an animation reads too.
fn interleaved() -> Sample {
    let mut s = Sample::new("interleaved, shared with an animation");
    let mut floats = Vec::new();
    let (positions, normals, uvs) = (positions(), normals(), uvs(1.0));
    for i in 0..positions.len() {
        floats.extend_from_slice(&positions[i]);
        floats.extend_from_slice(&normals[i]);
        floats.extend_from_slice(&uvs[i]);
    }
    let count = positions.len();
    // Behind the vertices: three keys, 32 bytes apart.
    let keys: [[f32; 8]; 3] = [0.0, 1.0, 2.5].map(|t| [t, t, 2.0 * t, 0.0, 0.0, 0.0, 0.0, 0.0]);
    floats.extend_from_slice(keys.as_flattened());
    let view = s.view(bytemuck::cast_slice(&floats), json!({ "byteStride": 32, "target": 34962 }));
    let offsets = [("POSITION", 0, "VEC3"), ("NORMAL", 12, "VEC3"), ("TEXCOORD_0", 24, "VEC2")];
    let mut attributes = json!({});
    for (semantic, offset, kind) in offsets {
        let accessor = json!({ "bufferView": view, "byteOffset": offset, "componentType": 5126, "count": count, "type": kind });
        attributes[semantic] = json!(s.push("accessors", accessor));
    }
    s.range(0, &[-1.15, 0.0, -1.15], &[1.15, 10.0, 1.15]);
    let of =
        |f: fn(f32, f32) -> f32, axis: usize| positions.iter().map(|p| p[axis]).reduce(f).unwrap().into();
    let [low, high] = [f32::min as fn(f32, f32) -> f32, f32::max].map(|f| [0, 1, 2].map(|axis| of(f, axis)));
    s.range(0, &low, &high);
    let indices = s.indices(&indices(0, ALONG));
    s.mesh(&[json!({ "attributes": attributes, "indices": indices })]);
    // A view of its own for the same bytes, since vertices and keys must not share one.
    let start = 32 * count;
    let keys = s.push("bufferViews", json!({ "buffer": 0, "byteOffset": start, "byteLength": 96 }));
    let times = s.other(&[0.0, 1.0, 2.5], 1);
    let values = json!({ "bufferView": keys, "componentType": 5126, "count": 3, "type": "VEC3" });
    let values = s.push("accessors", values);
    s.push(
        "animations",
        json!({ "samplers": [{ "input": times, "output": values, "interpolation": "STEP" }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }),
    );
    s
}

/// Extensions that nobody knows, optional ones.
fn unknown() -> Sample {
    let mut s = plain();
    s.name = "unknown extensions";
    s.json["extensionsUsed"] = json!(["ACME_outline", "ACME_world"]);
    s.json["extensions"] = json!({ "ACME_world": { "gravity": -9.81, "list": [1, 2, 3] } });
    s.json["nodes"][0]["extensions"] = json!({ "ACME_world": { "tag": "x" } });
    let outline = s.json["meshes"][0]["primitives"][0]["indices"].clone();
    s.json["meshes"][0]["primitives"][0]["extensions"] = json!({ "ACME_outline": { "edges": outline } });
    s
}

/// Positions that are zeros but for a few.
fn sparse() -> Sample {
    let mut s = Sample::new("sparse");
    let all = positions();
    let index: Vec<u16> = (0..all.len() as u16).collect();
    let index = s.view(bytemuck::cast_slice(&index), Value::Null);
    let values = s.view(bytemuck::cast_slice(all.as_flattened()), Value::Null);
    let accessor = json!({ "componentType": 5126, "count": all.len(), "type": "VEC3", "sparse": {
        "count": all.len(), "indices": { "bufferView": index, "componentType": 5123 }, "values": { "bufferView": values } } });
    let position = s.push("accessors", accessor);
    let of = |f: fn(f32, f32) -> f32, axis: usize| all.iter().map(|p| p[axis]).reduce(f).unwrap().into();
    let [low, high] = [f32::min as fn(f32, f32) -> f32, f32::max].map(|f| [0, 1, 2].map(|axis| of(f, axis)));
    s.range(position, &low, &high);
    let indices = s.indices(&indices(0, ALONG));
    s.mesh(&[json!({ "attributes": { "POSITION": position }, "indices": indices })]);
    s
}

/// Two nodes with a mesh each, the second without a name.
fn two_meshes() -> Sample {
    let mut s = plain();
    s.name = "two meshes";
    let tube = s.tube();
    s.push("meshes", json!({ "primitives": [tube] }));
    s.json["nodes"] = json!([{ "name": "big", "mesh": 0, "scale": [10.0, 10.0, 10.0] }, { "mesh": 1 }]);
    s.json["scenes"][0]["nodes"] = json!([0, 1]);
    s
}

/// Skin weights as floats in two sets.
fn two_sets_of_joints() -> Sample {
    let mut s = skinned();
    s.name = "two sets of joints, float weights";
    let second: Vec<[f32; 4]> =
        positions().iter().map(|p| [(0.02 * p[1]).clamp(0.0, 0.25), 0.0, 0.0, 0.0]).collect();
    let first: Vec<[f32; 4]> = positions()
        .iter()
        .zip(&second)
        .map(|(p, two)| {
            let b = ((p[1] - 3.0) / 4.0).clamp(0.0, 1.0) * (1.0 - two[0]);
            [1.0 - two[0] - b, b, 0.0, 0.0]
        })
        .collect();
    let joints = s.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"].clone();
    let [first, all] = [first, second.clone()].map(|values| s.floats(&values));
    let attributes = &mut s.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["WEIGHTS_0"] = json!(first);
    attributes["WEIGHTS_1"] = json!(all);
    let zeros: Vec<[u8; 4]> = second.iter().map(|w| [if w[0] > 0.0 { 2 } else { 0 }, 0, 0, 0]).collect();
    let view = json!({ "target": 34962, "byteStride": 4 });
    let zeros = s.accessor(zeros.as_flattened(), 5121, zeros.len(), "VEC4", view);
    s.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = joints;
    // A third joint, that stays where it is.
    s.json["nodes"][0]["children"] = json!([1, 2, 4]);
    s.push("nodes", json!({ "name": "tail" }));
    let matrices: Vec<f32> = [0.0, -5.0, 0.0]
        .into_iter()
        .flat_map(|y| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0])
        .collect();
    let matrices = s.other(&matrices, 16);
    s.json["skins"][0] = json!({ "joints": [2, 3, 4], "inverseBindMatrices": matrices });
    s.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_1"] = json!(zeros);
    s
}

/// Glass: extensions of materials on each other, and an animation of a property that no node has.
fn glass() -> Sample {
    let mut s = plain();
    s.name = "glass, animated material";
    s.push(
        "materials",
        json!({ "name": "glass", "emissiveFactor": [0.1, 0.2, 0.3], "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 0.9 },
            "KHR_materials_volume": { "thicknessFactor": 0.5, "attenuationColor": [0.9, 0.95, 1.0] },
            "KHR_materials_ior": { "ior": 1.52 },
            "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } } }),
    );
    s.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let times = s.other(&[0.0, 2.0], 1);
    let factors = s.other(&[0.9, 0.1], 1);
    for member in ["min", "max"] {
        s.json["accessors"][factors].as_object_mut().unwrap().remove(member);
    }
    let pointer = "/materials/0/extensions/KHR_materials_transmission/transmissionFactor";
    s.push(
        "animations",
        json!({ "samplers": [{ "input": times, "output": factors }], "channels": [{ "sampler": 0, "target": {
            "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } } }] }),
    );
    s.json["extensionsUsed"] = json!([
        "KHR_materials_transmission",
        "KHR_materials_volume",
        "KHR_materials_ior",
        "KHR_materials_emissive_strength",
        "KHR_animation_pointer",
    ]);
    s
}

/// Every kind.
pub fn all() -> Vec<Sample> {
    vec![
        plain(),
        skinned(),
        two_sets_of_joints(),
        morphed(false),
        morphed(true),
        instanced(),
        variants(),
        several_uvs(),
        quantised(),
        other_modes(),
        strips(),
        shared_vertices(),
        mixed(),
        scenes(),
        custom(),
        interleaved(),
        unknown(),
        sparse(),
        two_meshes(),
        glass(),
    ]
}
