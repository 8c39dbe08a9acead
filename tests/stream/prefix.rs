//! Promise: every beginning of a progressive file is a coarser mesh, attributes and materials included, and better the longer it is.

use multires::hierarchy::VertexHierarchy;
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::{StreamOptions, read_prefix, write_prefix};

use crate::sent::content;

fn check(mesh: &Mesh) {
    let model = VertexHierarchy::bake(mesh).unwrap();
    let bytes = write_prefix(&model, &StreamOptions::exact()).unwrap();
    let mut last = 0;
    let mut found = Vec::new();
    for cut in (0..=bytes.len()).step_by(bytes.len() / 97 + 1).chain([bytes.len()]) {
        let prefix = read_prefix(&bytes[..cut]).unwrap();
        assert!(prefix.bytes <= cut && prefix.complete == (cut == bytes.len()), "{cut} of {}", bytes.len());
        let triangles = prefix.mesh.triangles().len();
        assert!(triangles >= last);
        last = triangles;
        assert_eq!(prefix.mesh.materials().is_empty(), mesh.materials().is_empty() || triangles == 0);
        found.push(prefix.mesh);
    }
    // All of it is the model, bit for bit.
    let whole = found.pop().unwrap();
    let mut lod = model.instance(model.values(|_| [0_u8; 4]), &LodOptions::default()).unwrap();
    lod.refine_fully();
    assert!(content(&whole) == content(&lod.to_mesh()));
    #[cfg(feature = "quality")]
    {
        use multires::quality::{DistanceOptions, distance};
        let options = DistanceOptions::default().with_samples(20_000);
        let error = |mesh: &Mesh| distance(&whole, mesh, &options).unwrap().hausdorff();
        let [quarter, half, most] = [1, 2, 3].map(|part| error(&found[part * found.len() / 4]));
        assert!(quarter >= half && half >= most && quarter > most, "{quarter} {half} {most}");
    }
}

#[test]
fn of_a_surface() {
    check(&shapes::rock(3_000, 1));
}

#[test]
fn of_seams_and_materials() {
    check(&shapes::prop(4));
    check(&shapes::demo());
}

/// Flat parts have no error, and come all the same.
#[test]
fn of_a_flat_sheet() {
    let positions: Vec<[f32; 3]> = (0..400).map(|at| [(at % 20) as f32, (at / 20) as f32, 0.0]).collect();
    let square = |at: u32| [[at, at + 1, at + 20], [at + 1, at + 21, at + 20]];
    let triangles: Vec<[u32; 3]> = (0..380).filter(|at| at % 20 < 19).flat_map(square).collect();
    let model = VertexHierarchy::bake(&Mesh::new(positions, triangles.clone()).unwrap()).unwrap();
    let bytes = write_prefix(&model, &StreamOptions::default()).unwrap();
    let whole = read_prefix(&bytes).unwrap();
    assert!(whole.complete);
    assert_eq!(whole.mesh.triangles().len(), triangles.len());
}
