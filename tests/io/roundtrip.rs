//! Promise: what a format keeps comes back bit for bit; real models have the counts that are known of them.
#![cfg(feature = "io")]

use std::path::PathBuf;

use multires::io::{self, Format};
use multires::mesh::{Attribute, AttributeValues, Mesh};
use proptest::prelude::*;

const ALL: [Format; 6] = [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::Glb, Format::Gltf];

fn again(format: Format, mesh: &Mesh) -> Mesh {
    let bytes = io::write_bytes(format, mesh).unwrap_or_else(|e| panic!("{format}: {e}"));
    io::read_bytes(format, &bytes).unwrap_or_else(|e| panic!("{format}: {e}"))
}

fn bits(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.positions().iter().map(|p| p.map(f32::to_bits)).collect()
}

/// A strip of triangles over nine vertices, the last unused, with every kind of attribute.
fn rich() -> Mesh {
    let positions: Vec<[f32; 3]> =
        (0..9).map(|i| [i as f32 * 0.1, (i % 2) as f32 - 1e-20, -3e38 + 1e37 * i as f32]).collect();
    let triangles: Vec<[u32; 3]> =
        (0..6).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
    let floats = |width: usize, step: f32| {
        AttributeValues::Float((0..9 * width).map(|i| 0.3 + step * i as f32).collect())
    };
    let color = (0..27).map(|i| ((f64::from(i) * 9.0) / 255.0) as f32).collect();
    let attributes = [
        Attribute::new("normal", 3, floats(3, 0.01)),
        Attribute::new("uv", 2, floats(2, -0.7)),
        Attribute::new("color", 3, AttributeValues::Float(color)),
        Attribute::new("tangent", 4, floats(4, 0.1)),
        Attribute::new("uv1", 2, floats(2, 0.3)),
        Attribute::new("joints", 4, AttributeValues::Uint((0..36).map(|i| i * 1800).collect())),
        Attribute::new("weights", 4, floats(4, 0.02)),
        Attribute::new("confidence", 1, floats(1, 1.5)),
        Attribute::new("label", 3, AttributeValues::Int((0..27).map(|i| i * 1000 - 13_000).collect())),
        Attribute::new("part", 1, AttributeValues::Uint((0..9).collect())),
    ];
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mesh = mesh.with_materials(vec![0, 0, 2, 2, 1, 1]).unwrap();
    let names = ["stone", "two words", "Ünicode"].map(str::to_owned);
    attributes.into_iter().fold(mesh.with_material_names(names), |m, a| m.with_attribute(a).unwrap())
}

#[test]
fn geometry_comes_back_from_every_format() {
    let mesh = rich();
    for format in ALL.into_iter().filter(|&f| f != Format::Stl) {
        let back = again(format, &mesh);
        assert_eq!(bits(&back), bits(&mesh), "{format}");
        assert_eq!(back.triangles(), mesh.triangles(), "{format}");
    }
    // STL has no unused vertices and numbers by first use.
    let back = again(Format::Stl, &mesh);
    let corners = |m: &Mesh| -> Vec<_> { m.indices().iter().map(|&v| bits(m)[v as usize]).collect() };
    assert_eq!(corners(&back), corners(&mesh));
    assert_eq!(back.positions().len(), 8);
}

#[test]
fn attributes_come_back_from_formats_that_hold_them() {
    let mesh = rich();
    let few: &[&str] = &["normal", "uv", "color"];
    let every: Vec<&str> = mesh.attributes().iter().map(Attribute::name).collect();
    for (format, kept) in [
        (Format::Obj, few),
        (Format::Off, few),
        (Format::Ply, &every),
        (Format::Glb, &every),
        (Format::Gltf, &every),
        (Format::Stl, &[]),
    ] {
        let back = again(format, &mesh);
        assert_eq!(back.attributes().len(), kept.len(), "{format}");
        if format == Format::Stl {
            continue;
        }
        for name in kept {
            assert_eq!(back.attribute(name), mesh.attribute(name), "{format} {name}");
        }
    }
}

#[test]
fn materials_come_back_with_names() {
    let mesh = rich();
    for format in [Format::Obj, Format::Ply] {
        let back = again(format, &mesh);
        assert_eq!(back.materials(), mesh.materials(), "{format}");
        assert_eq!(back.material_names(), mesh.material_names(), "{format}");
    }
    for format in [Format::Glb, Format::Gltf] {
        let back = again(format, &mesh);
        assert_eq!(back.materials(), mesh.materials(), "{format}");
        assert_eq!(back.material_names(), mesh.material_names(), "{format}");
    }
}

#[test]
fn colours_that_are_no_bytes_stay_exact() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let colors = [[0.1_f32, 0.2, 0.3, 1.0], [0.0, 2.5, -1.0, 0.5], [1.0, 1.0 / 3.0, 0.5, 0.25]];
    let mesh = Mesh::new(positions, [[0, 1, 2]])
        .unwrap()
        .with_attribute(Attribute::floats("color", &colors))
        .unwrap();
    for format in [Format::Obj, Format::Ply, Format::Off, Format::Glb] {
        assert_eq!(again(format, &mesh), mesh, "{format}");
    }
}

#[test]
fn empty_meshes_come_back() {
    for format in ALL {
        assert_eq!(again(format, &Mesh::default()), Mesh::default(), "{format}");
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused() {
    let mesh = Mesh::new([[0.0; 3]], []).unwrap();
    let wide = Attribute::new("wide", 7, AttributeValues::Float(vec![0.0; 7]));
    let error =
        io::write_bytes(Format::Glb, &mesh.clone().with_attribute(wide.clone()).unwrap()).unwrap_err();
    assert!(error.to_string().contains("\"wide\" of width 7"), "{error}");
    assert_eq!(again(Format::Ply, &mesh.clone().with_attribute(wide).unwrap()).attributes().len(), 1);

    let clash = Attribute::new("x", 1, AttributeValues::Int(vec![3]));
    let error = io::write_bytes(Format::Ply, &mesh.with_attribute(clash).unwrap()).unwrap_err();
    assert!(error.to_string().contains("\"x\""), "{error}");
    assert!(io::write("mesh.txt", &Mesh::default()).unwrap_err().to_string().contains(".obj"));
}

#[test]
fn files_are_read_and_written_by_extension() {
    let directory = tempdir("by_extension");
    let mesh = rich();
    for format in ALL {
        let path = directory.join(format!("mesh.{}", format.extension().to_uppercase()));
        assert_eq!(Format::from_path(&path), Some(format));
        io::write(&path, &mesh).unwrap();
        assert_eq!(io::read(&path).unwrap(), again(format, &mesh));
    }
    std::fs::remove_dir_all(directory).unwrap();
}

fn tempdir(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("multires-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Any finite single, with all exponents as likely as one another.
fn single() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite())
}

fn mesh() -> impl Strategy<Value = Mesh> {
    (1_usize..20).prop_flat_map(|count| {
        let corner = 0..count as u32;
        let positions = prop::collection::vec([single(), single(), single()], count);
        let triangles = prop::collection::vec([corner.clone(), corner.clone(), corner], 0..20);
        let uvs = prop::collection::vec([single(), single()], count);
        (positions, triangles, uvs).prop_map(|(positions, triangles, uvs)| {
            Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats("uv", &uvs)).unwrap()
        })
    })
}

proptest! {
    #[test]
    fn every_finite_number_comes_back(mesh in mesh()) {
        for format in [Format::Obj, Format::Ply, Format::Off, Format::Glb, Format::Gltf] {
            if mesh.triangles().is_empty() && format != Format::Ply && format != Format::Off {
                continue;
            }
            let back = again(format, &mesh);
            prop_assert_eq!(bits(&back), bits(&mesh), "{}", format);
            prop_assert_eq!(back.triangles(), mesh.triangles(), "{}", format);
            let words = |m: &Mesh| -> Vec<u32> {
                m.attribute("uv").and_then(Attribute::as_floats).unwrap().iter().map(|x| x.to_bits()).collect()
            };
            prop_assert_eq!(words(&back), words(&mesh), "{}", format);
        }
        let once = again(Format::Stl, &mesh);
        prop_assert_eq!(&again(Format::Stl, &once), &once);
    }
}

/// Vertices, triangles.
const REAL: &[(&str, usize, usize)] = &[
    ("real/armadillo.ply", 43_243, 86_482),
    ("real/cow.obj", 2_903, 5_804),
    ("real/elephant.ply", 20_007, 40_022),
    ("real/fandisk.obj", 6_475, 12_946),
    ("real/fertility.ply", 4_494, 9_000),
    ("real/homer.obj", 6_002, 12_000),
    ("real/horse.ply", 48_485, 96_966),
    ("real/igea.ply", 134_345, 268_686),
    ("real/lion.ply", 8_356, 16_674),
    ("real/nefertiti.ply", 49_971, 99_938),
    ("real/ogre.obj", 19_985, 39_856),
    ("real/rocker-arm.obj", 10_044, 20_088),
    ("real/skull.ply", 49_999, 100_002),
    ("real/stanford-bunny.ply", 35_947, 69_451),
    ("real/suzanne.obj", 507, 968),
    ("real/teapot.obj", 3_644, 6_320),
    ("game/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf", 7_712, 10_203),
    ("game/FlightHelmet/FlightHelmet.gltf", 55_392, 94_722),
    ("game/Fox.glb", 1_728, 576),
    ("game/pigman/scene.gltf", 27_754, 37_136),
    // One mesh of 6,561 vertices and 12,800 triangles, shown by two nodes.
    ("game/terrain/Mountains.gltf", 13_122, 25_600),
    ("subdivision/3holes.ply", 3_596, 7_200),
    ("subdivision/penguin-control.obj", 201, 398),
    ("subdivision/icosphere-s3.obj", 642, 1_280),
];

#[test]
fn real_models_have_their_counts_and_come_back() {
    let Some(root) = crate::models::all("real_models_have_their_counts_and_come_back") else { return };
    for &(file, vertices, triangles) in REAL {
        let mesh = io::read(root.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (vertices, triangles), "{file}");
        for format in [Format::Ply, Format::Obj] {
            let back = again(format, &mesh);
            assert_eq!(bits(&back), bits(&mesh), "{file} {format}");
            assert_eq!(back.triangles(), mesh.triangles(), "{file} {format}");
        }
        assert_eq!(again(Format::Ply, &mesh), mesh, "{file}");
    }
}

#[test]
fn seams_of_real_models_split_vertices_next_to_each_other() {
    let Some(root) = crate::models::all("seams_of_real_models_split_vertices_next_to_each_other") else {
        return;
    };
    for (file, positions, vertices) in
        [("real/spot.obj", 2_930, 3_225), ("subdivision/boat.obj", 16_210, 16_665)]
    {
        let mesh = io::read(root.join(file)).unwrap();
        assert_eq!(mesh.positions().len(), vertices, "{file}");
        let runs = mesh.positions().chunk_by(|a, b| a == b).count();
        assert_eq!(runs, positions, "{file}");
        assert_eq!(mesh.attribute("uv").unwrap().width(), 2);
    }
}
