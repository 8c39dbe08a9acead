//! Bevy meshes go to multires and back bit for bit, and what cannot is a typed error.

mod support;

use std::collections::BTreeSet;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{
    Indices, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues as Values, VertexFormat,
};
use bevy::prelude::*;
use bevy_multires::ConvertError;
use bevy_multires::convert::{by_material, from_bevy, to_bevy};
use half::f16;
use multires::mesh::{Attribute, AttributeValues, shapes};
use support::list;

/// Four corners, two triangles.
fn square() -> Mesh {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, -0.0], [0.0, 1.0, 0.0]];
    list(corners, Indices::U16(vec![0, 1, 2, 0, 2, 3]))
}

/// Returns a mesh to multires and back.
fn there_and_back(mesh: &Mesh) -> Mesh {
    let (there, layout) = from_bevy(mesh).expect("a legal mesh");
    layout.to_bevy(&there).expect("the same mesh")
}

/// Holds two meshes equal bit for bit: `==` takes no two NaN for equal, and zeros of both signs for equal.
fn assert_same(a: &Mesh, b: &Mesh) {
    let bytes = |mesh: &Mesh| -> Vec<(&'static str, Vec<u8>)> {
        mesh.attributes().map(|(attribute, values)| (attribute.name, values.get_bytes().to_vec())).collect()
    };
    assert_eq!(bytes(a), bytes(b));
    assert_eq!(a.indices(), b.indices());
    assert_eq!(a.asset_usage, b.asset_usage);
    let targets = |mesh: &Mesh| mesh.morph_targets().map(|all| bytemuck::cast_slice::<_, u8>(all).to_vec());
    assert_eq!(targets(a), targets(b));
    assert_eq!(a.morph_target_names(), b.morph_target_names());
}

#[test]
fn all_of_bevys_own_attributes() {
    let mesh = square()
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 4])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, vec![[0.0, 0.5]; 4])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, vec![[0.25, 0.125]; 4])
        .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[1.0, 0.0, 0.0, -1.0]; 4])
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, vec![[0.1, 0.2, 0.3, 0.4]; 4])
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[0.5, 0.5, 0.0, 0.0]; 4])
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            Values::Uint16x4(vec![[0, 1, 2, 65_535], [3; 4], [4; 4], [5; 4]]),
        );
    let (there, _) = from_bevy(&mesh).expect("a legal mesh");
    let names: Vec<&str> = there.attributes().iter().map(Attribute::name).collect();
    assert_eq!(names, ["normal", "uv", "uv1", "tangent", "color", "weights", "joints"]);
    assert_same(&there_and_back(&mesh), &mesh);
    assert_eq!(there_and_back(&mesh), mesh);
}

#[test]
fn every_format_of_a_custom_attribute() {
    let halves = [0x0000, 0x8000, 0x7c01, 0x7e00].map(f16::from_bits); // zeros, NaNs of both kinds
    let some = [1.0, -2.5, 65_504.0, 6e-8].map(f16::from_f32);
    let nan = f64::from_bits(0x7ff4_0000_0000_0001);
    let all = [
        Values::Uint8(vec![0, 1, 254, 255]),
        Values::Uint8x2(vec![[0, 255]; 4]),
        Values::Uint8x4(vec![[0, 1, 2, 255]; 4]),
        Values::Sint8(vec![-128, -127, 0, 127]),
        Values::Sint8x2(vec![[-128, 127]; 4]),
        Values::Sint8x4(vec![[-128, -1, 0, 127]; 4]),
        Values::Unorm8(vec![0, 1, 254, 255]),
        Values::Unorm8x2(vec![[3, 200]; 4]),
        Values::Unorm8x4(vec![[0, 1, 2, 255]; 4]),
        Values::Snorm8(vec![-128, -127, 0, 127]),
        Values::Snorm8x2(vec![[-128, 127]; 4]),
        Values::Snorm8x4(vec![[-128, -127, 1, 127]; 4]),
        Values::Uint16(vec![0, 1, 65_534, 65_535]),
        Values::Uint16x2(vec![[0, 65_535]; 4]),
        Values::Uint16x4(vec![[0, 1, 2, 65_535]; 4]),
        Values::Sint16(vec![-32_768, -1, 0, 32_767]),
        Values::Sint16x2(vec![[-32_768, 32_767]; 4]),
        Values::Sint16x4(vec![[-32_768, -1, 0, 32_767]; 4]),
        Values::Unorm16(vec![0, 1, 65_534, 65_535]),
        Values::Unorm16x2(vec![[0, 65_535]; 4]),
        Values::Unorm16x4(vec![[0, 1, 32_768, 65_535]; 4]),
        Values::Snorm16(vec![-32_768, -32_767, 0, 32_767]),
        Values::Snorm16x2(vec![[-32_768, 32_767]; 4]),
        Values::Snorm16x4(vec![[-32_768, -1, 1, 32_767]; 4]),
        Values::Float16(halves.to_vec()),
        Values::Float16(some.to_vec()),
        Values::Float16x2(vec![[some[0], some[1]]; 4]),
        Values::Float16x4(vec![some, halves, some, halves]),
        Values::Float32(vec![0.0, -0.0, f32::INFINITY, f32::from_bits(0x7fa0_0001)]),
        Values::Float32x2(vec![[1e-40, -1.0]; 4]),
        Values::Float32x3(vec![[1.0, 2.0, f32::NAN]; 4]),
        Values::Float32x4(vec![[1.0, 2.0, 3.0, 4.0]; 4]),
        Values::Uint32(vec![0, 1, u32::MAX, 7]),
        Values::Uint32x2(vec![[0, u32::MAX]; 4]),
        Values::Uint32x3(vec![[0, 1, u32::MAX]; 4]),
        Values::Uint32x4(vec![[0, 1, 2, u32::MAX]; 4]),
        Values::Sint32(vec![i32::MIN, -1, 0, i32::MAX]),
        Values::Sint32x2(vec![[i32::MIN, i32::MAX]; 4]),
        Values::Sint32x3(vec![[i32::MIN, 0, i32::MAX]; 4]),
        Values::Sint32x4(vec![[i32::MIN, -1, 0, i32::MAX]; 4]),
        Values::Float64(vec![0.1, -0.0, nan, f64::MAX]),
        Values::Float64x2(vec![[0.1, nan]; 4]),
        Values::Float64x3(vec![[0.1, nan, 1e300]; 4]),
        Values::Float64x4(vec![[0.1, nan, 1e300, -0.0]; 4]),
        Values::Unorm10_10_10_2(vec![0, u32::MAX, 0x8040_2010, 0x4000_03ff]),
        Values::Unorm8x4Bgra(vec![[0, 1, 2, 255]; 4]),
    ];
    for values in all {
        let format = VertexFormat::from(&values);
        let custom = MeshVertexAttribute::new("custom", 1_000, format);
        let mesh = square().with_inserted_attribute(custom, values);
        assert_same(&there_and_back(&mesh), &mesh);
    }
}

#[test]
fn every_value_of_short_shares() {
    let custom = MeshVertexAttribute::new("shares", 1_000, VertexFormat::Unorm16);
    let signed = MeshVertexAttribute::new("signed", 1_001, VertexFormat::Snorm16);
    let positions = (0..=u16::MAX).map(|at| [f32::from(at), 0.0, 0.0]).collect();
    let mesh = list(positions, Indices::U32(vec![0, 1, 2]))
        .with_inserted_attribute(custom, Values::Unorm16((0..=u16::MAX).collect()))
        .with_inserted_attribute(signed, Values::Snorm16((i16::MIN..=i16::MAX).collect()));
    assert_same(&there_and_back(&mesh), &mesh);
}

#[test]
fn attributes_with_names_that_mean_something_else() {
    let named = |name, id| MeshVertexAttribute::new(name, id, VertexFormat::Float32);
    let mesh = square()
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 4])
        .with_inserted_attribute(named("normal", 100), vec![1.0_f32; 4])
        .with_inserted_attribute(named("vertex", 101), vec![2.0_f32; 4])
        .with_inserted_attribute(named("displacement1", 102), vec![3.0_f32; 4])
        .with_inserted_attribute(named("twice", 103), vec![4.0_f32; 4])
        .with_inserted_attribute(named("twice", 104), vec![5.0_f32; 4]);
    let (there, _) = from_bevy(&mesh).expect("a legal mesh");
    assert!(there.attribute("normal#100").is_some() && there.attribute("twice#104").is_some());
    assert_same(&there_and_back(&mesh), &mesh);
}

#[test]
fn indices_keep_their_width() {
    let long = list(vec![[0.0; 3]; 3], Indices::U32(vec![0, 1, 2]));
    assert_eq!(there_and_back(&long), long);
    assert_eq!(there_and_back(&square()), square());

    let bare = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 6]);
    assert_eq!(there_and_back(&bare), bare); // no indices come of none

    // 16 bits as long as they do: a mesh that grew takes 32.
    let (_, layout) = from_bevy(&square()).expect("a legal mesh");
    let many = multires::Mesh::new(vec![[0.0; 3]; 70_000], [[0, 1, 69_999]]).expect("a legal mesh");
    let many = layout.to_bevy(&many).expect("a legal mesh");
    assert_eq!(many.indices(), Some(&Indices::U32(vec![0, 1, 69_999])));
}

#[test]
fn morph_targets_and_their_names() {
    let vertex = |x: f32| MorphAttributes::new(Vec3::splat(x), Vec3::X * x, Vec3::Z * -x);
    let moved = |x: f32| MorphAttributes::new(Vec3::splat(x), Vec3::ZERO, Vec3::ZERO);
    let targets: Vec<MorphAttributes> =
        (0..4).map(|at| vertex(at as f32)).chain((4..8).map(|at| moved(at as f32))).collect();
    let mesh = square()
        .with_morph_targets(targets)
        .with_morph_target_names(vec!["smile".to_owned(), "frown".to_owned()]);
    let (there, _) = from_bevy(&mesh).expect("a legal mesh");
    assert_eq!(there.attribute("displacement1").map(Attribute::width), Some(3));
    assert!(there.attribute("morph").is_some() && there.attribute("morph1").is_none()); // the second moves positions alone
    assert_same(&there_and_back(&mesh), &mesh);
    assert_eq!(there_and_back(&mesh), mesh);
}

#[test]
fn meshes_of_bevys_own_shapes() {
    for mesh in [
        Mesh::from(Sphere::new(1.0)),
        Mesh::from(Cuboid::new(1.0, 2.0, 3.0)),
        Mesh::from(Torus::new(0.5, 1.0)).with_generated_tangents().expect("it has texture coordinates"),
        Mesh::from(Cylinder::new(1.0, 2.0)).with_duplicated_vertices().with_computed_flat_normals(),
    ] {
        assert_eq!(there_and_back(&mesh), mesh);
    }
}

#[test]
fn meshes_of_multires_there_and_back() {
    let mesh = shapes::robot(3);
    let heat: Vec<[f32; 1]> = mesh.positions().iter().map(|p| [p[1]]).collect();
    let ids: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    let mesh = mesh
        .with_attribute(Attribute::floats("heat", &heat))
        .and_then(|mesh| mesh.with_attribute(Attribute::new("id", 1, AttributeValues::Uint(ids))))
        .expect("the names are free");
    let bevy = to_bevy(&mesh).expect("a legal mesh");
    let (back, _) = from_bevy(&bevy).expect("a legal mesh");
    assert_eq!(back.positions(), mesh.positions());
    assert_eq!(back.triangles(), mesh.triangles());
    for attribute in mesh.attributes() {
        assert_eq!(back.attribute(attribute.name()), Some(attribute));
    }
    assert_eq!(back.attributes().len(), mesh.attributes().len());
}

#[test]
fn a_mesh_for_each_material() {
    let plate = shapes::two_material_plate(16, 0.3);
    let parts = by_material(&plate).expect("a legal mesh");
    assert_eq!(parts.iter().map(|(id, _)| *id).collect::<Vec<_>>(), [0, 1]);
    let count = |mesh: &Mesh| mesh.indices().map_or(0, Indices::len) / 3;
    assert_eq!(parts.iter().map(|(_, part)| count(part)).sum::<usize>(), plate.triangles().len());
    for (_, part) in &parts {
        let used: BTreeSet<usize> =
            part.indices().map(|indices| indices.iter().collect()).unwrap_or_default();
        assert_eq!(used.len(), part.count_vertices()); // none besides
    }
}

#[test]
fn what_cannot_be_converted_is_told() {
    let error = |mesh: &Mesh| from_bevy(mesh).map(drop).expect_err("it must be refused");
    let empty = |topology| Mesh::new(topology, RenderAssetUsages::default());
    for topology in [
        PrimitiveTopology::PointList,
        PrimitiveTopology::LineList,
        PrimitiveTopology::LineStrip,
        PrimitiveTopology::TriangleStrip,
    ] {
        let mesh = empty(topology).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 3]);
        assert_eq!(error(&mesh), ConvertError::Topology { found: topology });
    }
    assert_eq!(error(&empty(PrimitiveTopology::TriangleList)), ConvertError::NoPositions);

    let flat = MeshVertexAttribute::new("Vertex_Position", 0, VertexFormat::Float32x2);
    let mesh = empty(PrimitiveTopology::TriangleList).with_inserted_attribute(flat, vec![[0.0; 2]; 3]);
    assert_eq!(error(&mesh), ConvertError::PositionFormat { found: VertexFormat::Float32x2 });

    let mesh = square().with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, vec![[0.0; 2]; 3]);
    assert_eq!(error(&mesh), ConvertError::Length { name: "Vertex_Uv".to_owned(), found: 3, vertices: 4 });

    let mesh = square().with_morph_targets(vec![MorphAttributes::default(); 5]);
    assert_eq!(error(&mesh), ConvertError::MorphTargets { found: 5, vertices: 4 });

    let mesh = list(vec![[0.0; 3]; 4], Indices::U32(vec![0, 1, 2, 3]));
    assert_eq!(error(&mesh), ConvertError::Corners { found: 4 });
    let mesh = empty(PrimitiveTopology::TriangleList)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 4]);
    assert_eq!(error(&mesh), ConvertError::Corners { found: 4 });

    let mesh = list(vec![[0.0; 3]; 3], Indices::U32(vec![0, 1, 3]));
    assert!(matches!(
        error(&mesh),
        ConvertError::Mesh(multires::MeshError::IndexOutOfRange { index: 3, .. })
    ));
    let mesh = list(vec![[0.0, f32::NAN, 0.0]; 3], Indices::U32(vec![0, 1, 2]));
    assert!(matches!(error(&mesh), ConvertError::Mesh(multires::MeshError::NonFinitePosition { .. })));

    let mut gone = square();
    gone.take_gpu_data().expect("it is here");
    assert_eq!(error(&gone), ConvertError::Extracted);
}

#[test]
fn what_bevy_has_no_place_for_is_told() {
    let mesh = shapes::tetrahedron();
    let wide =
        mesh.clone().with_attribute(Attribute::floats("wide", &[[0.0; 5]; 4])).expect("the name is free");
    assert_eq!(to_bevy(&wide), Err(ConvertError::Width { name: "wide".to_owned(), width: 5 }));

    let many = AttributeValues::Uint(vec![65_536; 16]);
    let joints = mesh.clone().with_attribute(Attribute::new("joints", 4, many)).expect("the name is free");
    let refused = ConvertError::Values { name: "joints".to_owned(), format: VertexFormat::Uint16x4 };
    assert_eq!(to_bevy(&joints), Err(refused));

    let normals = square().with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 4]);
    let (_, layout) = from_bevy(&normals).expect("a legal mesh");
    assert_eq!(layout.to_bevy(&mesh), Err(ConvertError::Missing { name: "normal".to_owned() }));
}

#[test]
fn an_empty_list_there_and_back() {
    let empty = list(Vec::new(), Indices::U16(Vec::new()));
    assert_eq!(there_and_back(&empty), empty);
    let targets = empty.with_morph_targets(Vec::new());
    assert_eq!(there_and_back(&targets), targets);
}
