//! Promise: a totally ordered mesh with its vertices gives every level that its sequence has, comes back from a file
//! equal, and does not come back from parts that do not fit.

use crate::support;
use crate::support::content::content;
use crate::support::lod::bake_tom;
use multires::lod::Level;
use multires::mesh::{Attribute, AttributeValues, Mesh, Topology, shapes};
use multires::simplify::Simplifier;
use proptest::prelude::*;

fn is_compact(mesh: &Mesh) -> bool {
    let mut used = vec![false; mesh.positions().len()];
    mesh.indices().iter().for_each(|&v| used[v as usize] = true);
    used.iter().all(|&u| u)
}

proptest! {
    #[test]
    fn every_level_is_the_sequences((mesh, sequence) in support::endpoint()) {
        let labels = AttributeValues::Uint(Topology::new(&mesh).wedge_of().to_vec());
        let mesh = mesh.with_attribute(Attribute::new("wedge", 1, labels)).unwrap();
        let bundle = bake_tom(&mesh, &sequence);
        let names = |mesh: &Mesh| mesh.attributes().iter().map(|a| a.name().to_owned()).collect::<Vec<_>>();
        let mut resolution = bundle.structure().finest();
        loop {
            let level = bundle.mesh_at(resolution);
            prop_assert!(is_compact(&level));
            prop_assert_eq!(level.triangles().len(), resolution.triangles());
            prop_assert!(level.positions().len() <= resolution.vertices());
            prop_assert_eq!(names(&level), names(&mesh));
            prop_assert_eq!(level.materials().is_empty(), mesh.materials().is_empty() || level.triangles().is_empty());
            // Some step of the sequence shows the same.
            let shown = content(&level);
            let same = (0..=sequence.len()).rev().any(|steps| {
                let other = sequence.extract(&mesh, steps);
                let mut other = content(&other);
                other.retain(|(c, _)| c[0] != c[1] && c[1] != c[2] && c[2] != c[0]);
                other == shown
            });
            prop_assert!(same);
            match bundle.structure().coarser(resolution) {
                Some(coarser) => resolution = coarser,
                None => break,
            }
        }
    }
}

#[test]
fn a_model_keeps_all_it_has() {
    let mesh = shapes::demo();
    let locks: Vec<bool> = (0..mesh.positions().len()).map(|v| v % 97 == 0).collect();
    let mesh = mesh.with_locks(locks).unwrap();
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let bundle = bake_tom(&mesh, &sequence);
    assert!(content(&bundle.level(Level::Ratio(1.0)).mesh) == content(&mesh));
    let base = bundle.level(Level::Ratio(0.0)).mesh;
    assert!(content(&base) == content(&sequence.extract(&mesh, sequence.len())));
    assert_eq!(base.material_names(), mesh.material_names());
    assert!(bundle.vertices().triangles().is_empty());
    assert!(bundle.memory() > bundle.plain_memory());
    assert!(bundle.memory() < bundle.plain_memory() * 6 / 5);
    assert_eq!(bundle.plain_memory(), bundle.level(Level::Ratio(1.0)).mesh.memory());
}

#[test]
fn nothing_makes_nothing() {
    for mesh in [Mesh::default(), Mesh::new([[0.0; 3]; 3], [[0, 1, 1]]).unwrap()] {
        let bundle = bake_tom(&mesh, &Simplifier::new().run(&mesh).unwrap());
        let level = bundle.level(Level::Triangles(10)).mesh;
        assert!(level.triangles().is_empty() && level.positions().is_empty());
    }
}

#[cfg(feature = "io")]
#[test]
fn it_comes_back_from_a_file_and_not_from_parts_that_do_not_fit() {
    use multires::TotallyOrderedMesh;
    use multires::io::{bake, unbake};
    use multires::lod::{Baked, Origins, Structure};

    #[derive(serde::Serialize)]
    struct Parts<'a> {
        vertices: &'a Mesh,
        structure: &'a TotallyOrderedMesh,
        origins: &'a Origins,
    }

    let mesh = shapes::demo();
    let bundle = bake_tom(&mesh, &Simplifier::new().run(&mesh).unwrap());
    let bytes = bake(TotallyOrderedMesh::KIND, &bundle).unwrap();
    assert_eq!(unbake::<Baked<TotallyOrderedMesh>>(TotallyOrderedMesh::KIND, &bytes).unwrap(), bundle);
    let parts = |vertices: &Mesh, origins: &Origins| {
        let parts = Parts { vertices, structure: bundle.structure(), origins };
        bake(TotallyOrderedMesh::KIND, &parts).unwrap()
    };
    assert!(parts(bundle.vertices(), bundle.origins()) == bytes);

    let refused = |vertices: &Mesh, origins: &Origins| {
        let bytes = parts(vertices, origins);
        unbake::<Baked<TotallyOrderedMesh>>(TotallyOrderedMesh::KIND, &bytes).unwrap_err().to_string()
    };
    let (positions, origins) = (bundle.vertices().positions(), bundle.origins());
    let few = Mesh::new(&positions[1..], []).unwrap();
    assert!(refused(&few, origins).contains("vertices"));
    let more = Mesh::new([positions, &[[0.0; 3]]].concat(), []).unwrap();
    assert!(refused(&more, origins).contains("vertices"));
    let drawn = Mesh::new(positions, [[0, 1, 2]]).unwrap();
    assert!(refused(&drawn, origins).contains("triangles"));
    let sphere = shapes::icosphere(1);
    let other = bake_tom(&sphere, &Simplifier::new().run(&sphere).unwrap());
    let (found, expected) = (other.origins().len(), positions.len());
    let said = refused(bundle.vertices(), other.origins());
    assert!(said.contains(&format!("{found} origins where {expected} are needed")), "{said}");
}
