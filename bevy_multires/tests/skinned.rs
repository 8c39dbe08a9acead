//! Levels of skinned and morphed meshes: every vertex keeps its joints, weights, attributes and morph targets.

mod support;

use std::collections::HashSet;

use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_multires::{AutoLod, LodCache, convert};
use multires::mesh::shapes;
use support::{add, app, built, camera, level, mesh_of};

const SMILE: usize = 0;
const FROWN: usize = 1;

/// Where a target moves a vertex.
fn moved(p: &[f32; 3], target: usize) -> MorphAttributes {
    let moved = Vec3::new(p[1], 0.1 * p[2], p[0]) * (1.0 + target as f32);
    MorphAttributes::new(0.1 * moved, moved, -moved)
}

/// A skinned tube with two morph targets. Position and joints tell vertices apart.
fn tube() -> Mesh {
    let mut mesh = convert::to_bevy(&shapes::skinned_tube(48, 60)).expect("a legal mesh");
    let Some(positions) = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|values| values.as_float3())
    else {
        panic!("positions are floats")
    };
    let targets = [SMILE, FROWN].iter().flat_map(|&target| positions.iter().map(move |p| moved(p, target)));
    let targets = targets.collect();
    mesh.set_morph_targets(targets);
    mesh.set_morph_target_names(vec!["smile".to_owned(), "frown".to_owned()]);
    mesh.generate_skinned_mesh_bounds().expect("it has joints and weights");
    mesh
}

/// The bytes of each vertex: all attributes and all morph targets.
fn rows(mesh: &Mesh) -> Vec<Vec<u8>> {
    let vertices = mesh.count_vertices();
    let mut rows = vec![Vec::new(); vertices];
    let mut push = |values: &[u8]| {
        let values = values.chunks_exact(values.len() / vertices);
        rows.iter_mut().zip(values).for_each(|(row, value)| row.extend(value));
    };
    mesh.attributes().for_each(|(_, values)| push(values.get_bytes()));
    for target in mesh.morph_targets().expect("it has targets").chunks_exact(vertices) {
        push(bytemuck::cast_slice(target));
    }
    rows
}

/// The bytes of what moves each vertex: position, joints and weights.
fn bones(mesh: &Mesh) -> Vec<Vec<u8>> {
    let mut bare = mesh.clone();
    for (attribute, _) in mesh.attributes() {
        if ![Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT]
            .contains(attribute)
        {
            bare.remove_attribute(*attribute);
        }
    }
    bare.set_morph_targets(Vec::new());
    rows(&bare)
}

#[test]
fn vertices_of_levels_are_vertices_of_the_mesh() {
    let mut app = app();
    let source = tube();
    assert!(matches!(
        source.attribute(Mesh::ATTRIBUTE_JOINT_INDEX),
        Some(VertexAttributeValues::Uint16x4(_))
    ));
    let mesh = add(&mut app, source.clone());
    let model = app.world_mut().spawn((Mesh3d(mesh.clone()), AutoLod::default())).id();
    built(&mut app, &[model]);
    let all: HashSet<Vec<u8>> = bones(&source).into_iter().collect();
    let levels = app.world().resource::<LodCache>().levels(&mesh).expect("they are built").clone();
    assert!(levels.coarser().len() >= 4);
    for level in levels.coarser() {
        let mesh = app.world().resource::<Assets<Mesh>>().get(&level.mesh).expect("it is there");
        assert!(bones(mesh).iter().all(|row| all.contains(row)));
        assert_eq!(mesh.morph_target_names(), source.morph_target_names());
        assert_eq!(mesh.skinned_mesh_bounds().is_some(), source.skinned_mesh_bounds().is_some());
        // Targets are fitted: each vertex goes about where the mesh goes there.
        let positions =
            mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(|values| values.as_float3()).expect("floats");
        let targets = mesh.morph_targets().expect("it has targets");
        assert_eq!(targets.len(), 2 * positions.len());
        for (target, vertices) in [SMILE, FROWN].into_iter().zip(targets.chunks_exact(positions.len())) {
            for (position, vertex) in positions.iter().zip(vertices) {
                let expected = moved(position, target).position;
                assert!(
                    vertex.position.distance(expected) <= 0.02 + level.error,
                    "{} {expected}",
                    vertex.position
                );
            }
        }
    }
}

#[test]
fn the_skin_of_an_entity_stays_as_it_was() {
    for lod in [AutoLod::default(), AutoLod::view_dependent()] {
        let mut app = app();
        app.init_asset::<SkinnedMeshInverseBindposes>();
        let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 4]);
        let inverse_bindposes =
            app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
        let joints: Vec<Entity> = (0..4).map(|_| app.world_mut().spawn(Transform::default()).id()).collect();
        let skin = SkinnedMesh { inverse_bindposes: inverse_bindposes.clone(), joints: joints.clone() };
        let mesh = add(&mut app, tube());
        app.world_mut().spawn(camera(Vec3::Z * 60.0));
        let model = app.world_mut().spawn((Mesh3d(mesh), skin, lod)).id();
        built(&mut app, &[model]);

        let skin = app.world().get::<SkinnedMesh>(model).expect("it is still there");
        assert_eq!((&skin.inverse_bindposes, &skin.joints), (&inverse_bindposes, &joints));
        let poses = app.world().resource::<Assets<SkinnedMeshInverseBindposes>>().get(&inverse_bindposes);
        assert_eq!(poses.map(|poses| poses.to_vec()), Some(vec![Mat4::IDENTITY; 4]));
        let drawn = mesh_of(&app, model);
        assert!(drawn.count_vertices() < tube().count_vertices() / 2);
        assert!(drawn.contains_attribute(Mesh::ATTRIBUTE_JOINT_INDEX));
        let of = if lod.view_dependent { rows } else { bones };
        let all: HashSet<Vec<u8>> = of(&tube()).into_iter().collect();
        assert!(of(drawn).iter().all(|row| all.contains(row)));
        if !lod.view_dependent {
            assert!(level(&app, model) > 0);
        }
    }
}
