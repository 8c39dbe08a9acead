//! What must be equal in two documents: everything but the vertices and triangles of meshes.

use serde_json::Value;

/// A file taken apart.
pub struct File {
    pub json: Value,
    pub buffer: Vec<u8>,
}

impl File {
    pub fn of_glb(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(8)), (&b"glTF"[..], bytes.len()));
        let json = serde_json::from_slice(&bytes[20..20 + word(12)]).unwrap();
        let buffer = bytes.get(28 + word(12)..).unwrap_or_default().to_vec();
        Self { json, buffer }
    }

    /// Returns the bytes of a view.
    pub fn view(&self, view: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][view.as_u64().unwrap() as usize];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        &self.buffer[start..start + view["byteLength"].as_u64().unwrap() as usize]
    }

    /// Returns an accessor's type and the bytes of its elements; sparse parts replace elements.
    pub fn accessor(&self, index: &Value) -> (Value, Value, Vec<u8>) {
        let accessor = &self.json["accessors"][index.as_u64().unwrap() as usize];
        let size = |kind: &Value| match kind.as_u64().unwrap() {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let (bytes, count) =
            (width * size(&accessor["componentType"]), accessor["count"].as_u64().unwrap() as usize);
        let mut values = vec![0; bytes * count];
        if let Some(view) = accessor.get("bufferView") {
            let stride = self.json["bufferViews"][view.as_u64().unwrap() as usize]["byteStride"].as_u64();
            let stride = stride.map_or(bytes, |s| s as usize);
            let from = &self.view(view)[accessor["byteOffset"].as_u64().unwrap_or(0) as usize..];
            for i in 0..count {
                values[i * bytes..(i + 1) * bytes].copy_from_slice(&from[i * stride..i * stride + bytes]);
            }
        }
        if let Some(sparse) = accessor.get("sparse") {
            let indices = &sparse["indices"];
            let width = size(&indices["componentType"]);
            let places = self.view(&indices["bufferView"]);
            let replaced = self.view(&sparse["values"]["bufferView"]);
            for i in 0..sparse["count"].as_u64().unwrap() as usize {
                let mut word = [0; 4];
                word[..width].copy_from_slice(&places[i * width..(i + 1) * width]);
                let place = u32::from_le_bytes(word) as usize;
                values[place * bytes..(place + 1) * bytes]
                    .copy_from_slice(&replaced[i * bytes..(i + 1) * bytes]);
            }
        }
        (accessor["componentType"].clone(), accessor["type"].clone(), values)
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Asserts that two documents differ in the surfaces of meshes alone. `lost`: extensions that may be missing in the second.
pub fn same_but_for_surfaces(what: &str, a: &File, b: &File, lost: &[&str]) {
    let sections = |file: &File| -> Vec<String> {
        let names = file.json.as_object().unwrap().keys().cloned();
        names.filter(|name| name != "extensionsUsed" || !lost.is_empty()).collect()
    };
    if lost.is_empty() {
        assert_eq!(sections(a), sections(b), "{what}");
        assert_eq!(a.json["extensionsUsed"], b.json["extensionsUsed"], "{what}");
    }
    let moved = ["accessors", "bufferViews", "buffers", "meshes", "images", "extensionsUsed"];
    for (name, section) in a.json.as_object().unwrap() {
        if !moved.contains(&name.as_str()) {
            assert_eq!(section, &b.json[name], "{what}: {name}");
        }
    }
    assert_eq!(list(&a.json["images"]).len(), list(&b.json["images"]).len(), "{what}");
    for (x, y) in list(&a.json["images"]).iter().zip(list(&b.json["images"])) {
        assert_eq!(x["name"], y["name"], "{what}");
        if let Some(view) = x.get("bufferView") {
            assert_eq!(a.view(view), b.view(&y["bufferView"]), "{what}");
        }
    }
    assert_eq!(list(&a.json["meshes"]).len(), list(&b.json["meshes"]).len(), "{what}");
    for (x, y) in list(&a.json["meshes"]).iter().zip(list(&b.json["meshes"])) {
        mesh(what, a, b, [x, y], lost);
    }
    // What is no mesh reads the same values.
    let pairs = list(&a.json["skins"]).iter().zip(list(&b.json["skins"]));
    for (x, y) in pairs.filter(|(x, _)| x.get("inverseBindMatrices").is_some()) {
        let [x, y] = [(a, x), (b, y)].map(|(file, skin)| file.accessor(&skin["inverseBindMatrices"]));
        assert_eq!(x, y, "{what}");
    }
    for (x, y) in list(&a.json["animations"]).iter().zip(list(&b.json["animations"])) {
        for (x, y) in list(&x["samplers"]).iter().zip(list(&y["samplers"])) {
            for end in ["input", "output"] {
                assert_eq!(a.accessor(&x[end]), b.accessor(&y[end]), "{what}");
            }
        }
    }
    for (x, y) in list(&a.json["nodes"]).iter().zip(list(&b.json["nodes"])) {
        let instances = |node: &Value| node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"].clone();
        for (name, accessor) in instances(x).as_object().into_iter().flatten() {
            assert_eq!(a.accessor(accessor), b.accessor(&instances(y)[name]), "{what}");
        }
    }
}

fn mesh(what: &str, a: &File, b: &File, [x, y]: [&Value; 2], lost: &[&str]) {
    let rest = |mesh: &Value| {
        let mut rest = mesh.clone();
        rest.as_object_mut().unwrap().remove("primitives");
        rest
    };
    assert_eq!(rest(x), rest(y), "{what}");
    assert_eq!(list(&x["primitives"]).len(), list(&y["primitives"]).len(), "{what}");
    for (x, y) in list(&x["primitives"]).iter().zip(list(&y["primitives"])) {
        if x.get("mode").is_some_and(|mode| mode.as_u64() < Some(4)) {
            assert_eq!(x, y, "{what}");
            assert_eq!(
                a.accessor(&x["attributes"]["POSITION"]),
                b.accessor(&y["attributes"]["POSITION"]),
                "{what}"
            );
            continue;
        }
        let mut kept = x.clone();
        let members = kept.as_object_mut().unwrap();
        if let Some(extensions) = members.get_mut("extensions") {
            let extensions = extensions.as_object_mut().unwrap();
            extensions.retain(|name, _| !lost.contains(&name.as_str()));
            if extensions.is_empty() {
                members.remove("extensions");
            }
        }
        for name in ["material", "extras", "extensions"] {
            assert_eq!(kept.get(name), y.get(name), "{what}: {name}");
        }
        let semantics = |list: &Value| list.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        assert_eq!(semantics(&x["attributes"]), semantics(&y["attributes"]), "{what}");
        let kinds = |file: &File, list: &Value| -> Vec<(Value, Value, Value)> {
            let kind = |index: &Value| {
                let accessor = &file.json["accessors"][index.as_u64().unwrap() as usize];
                (accessor["componentType"].clone(), accessor["type"].clone(), accessor["normalized"].clone())
            };
            list.as_object().unwrap().values().map(kind).collect()
        };
        assert_eq!(kinds(a, &x["attributes"]), kinds(b, &y["attributes"]), "{what}");
        assert_eq!(list(&x["targets"]).len(), list(&y["targets"]).len(), "{what}");
        for (x, y) in list(&x["targets"]).iter().zip(list(&y["targets"])) {
            assert_eq!(semantics(x), semantics(y), "{what}");
            assert_eq!(kinds(a, x), kinds(b, y), "{what}");
        }
    }
}
