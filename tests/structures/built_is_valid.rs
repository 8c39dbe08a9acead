//! Promise: what is built is valid, and comes back equal from its bytes, wherever its coordinates are within single precision.
#![cfg(feature = "io")]

use std::fmt::Debug;

use multires::hierarchy::{Dependencies, HierarchyBuilder};
use multires::io::{Stored, bake, unbake};
use multires::lod::{Baked, Structure};
use multires::mesh::{Mesh, shapes};
use multires::simplify::Placement;
use multires::view::ErrorShape;
use multires::wavelet::{ErrorBound, Face, Midpoint, WaveletBuilder, WaveletMesh, WaveletOptions};
use multires::{Gmesh, TotallyOrderedMesh};
use proptest::prelude::*;

/// The largest, the least, what rounds to nothing, and what is in between.
const EXTREMES: [f32; 12] =
    [f32::MAX, -f32::MAX, 3.4e38, -1.7e38, 2.0e19, -1.0, 0.0, 1.0, 1e-19, f32::MIN_POSITIVE, 1e-45, -1e-40];

/// Coordinates of a vertex: extremes, or its own at any scale.
fn moved(mesh: &Mesh, scale: f32, picks: &[(prop::sample::Index, u8, u8)]) -> Mesh {
    let mut places: Vec<[f32; 3]> =
        (mesh.positions().iter()).map(|p| p.map(|x| (x * scale).clamp(-f32::MAX, f32::MAX))).collect();
    for (at, axis, value) in picks {
        places[at.index(mesh.positions().len())][usize::from(axis % 3)] =
            EXTREMES[usize::from(*value) % EXTREMES.len()];
    }
    Mesh::new(places, mesh.triangles()).unwrap()
}

fn comes_back<S: Stored + PartialEq + Debug>(model: &Baked<S>) {
    let bytes = model.to_bytes().unwrap();
    let back = Baked::<S>::from_bytes(&bytes);
    let back = back.unwrap_or_else(|error| panic!("{}: {error}", S::KIND));
    assert!(back == *model, "{}", S::KIND);
}

fn base(kind: usize) -> Mesh {
    match kind % 5 {
        0 => shapes::icosphere(1),
        1 => shapes::terrain(6, 1),
        2 => shapes::box_with_face_normals(2),
        3 => shapes::book(9),
        _ => shapes::torus(1.0, 0.4, 8, 5),
    }
}

fn wavelet_options(kind: usize) -> WaveletOptions {
    let plain = WaveletOptions::default();
    match kind % 4 {
        0 => plain,
        1 => plain.with_shape(ErrorShape::SphereAndCones),
        2 => plain.with_bound(ErrorBound::WithoutSiblings),
        _ => plain.with_bound(ErrorBound::WithoutSiblings).with_shape(ErrorShape::SphereAndCones),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn structures_of_merges(
        kind in 0usize..5,
        scale in prop::sample::select(vec![3e38_f32, 1e19, 1.0, 1e-19, 1e-38, 1e-44]),
        picks in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), any::<u8>()), 0..6),
    ) {
        let mesh = moved(&base(kind), scale, &picks);
        let tom = TotallyOrderedMesh::bake(&mesh).unwrap();
        prop_assert_eq!(tom.structure().validate(), Ok(()));
        comes_back(&tom);
        let crowd = Gmesh::bake(&mesh).unwrap();
        comes_back(&crowd);
        for dependencies in [Dependencies::None, Dependencies::Adjacent, Dependencies::Neighbours, Dependencies::Manifold] {
            let placement = if kind % 2 == 0 { Placement::Optimal } else { Placement::Subset };
            let mut builder = HierarchyBuilder::new().placement(placement).dependencies(dependencies);
            let hierarchy = builder.bake(&mesh).unwrap();
            prop_assert_eq!(hierarchy.structure().validate(), Ok(()));
            comes_back(&hierarchy);
        }
    }

    #[test]
    fn wavelets(
        kind in 0usize..5,
        how in 0usize..4,
        scale in prop::sample::select(vec![3e38_f32, 1e19, 1.0, 1e-19, 1e-38, 1e-44]),
        picks in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), any::<u8>()), 0..6),
        places in prop::collection::vec((any::<u8>(), any::<u8>(), any::<u8>()), 1..20),
    ) {
        let mut builder = WaveletBuilder::new(&moved(&base(kind), scale, &picks)).unwrap();
        for level in 0..3 {
            let mut at = 0;
            let place = |midpoint: &Midpoint| {
                at += 1;
                let mut place = midpoint.middle;
                let (axis, value, often) = places[at % places.len()];
                if often % 8 == 0 {
                    place[usize::from(axis % 3)] = EXTREMES[usize::from(value) % EXTREMES.len()];
                }
                place
            };
            let split = |face: &Face| level == 0 || (face.vertices[0] + face.vertices[1]) % 3 != how as u32;
            builder.subdivide_where(split, place).unwrap();
        }
        let mesh = builder.build(&wavelet_options(how)).unwrap();
        prop_assert_eq!(mesh.validate(), Ok(()));
        let bytes = bake(WaveletMesh::KIND, &mesh).unwrap();
        let back = unbake::<WaveletMesh>(WaveletMesh::KIND, &bytes);
        prop_assert!(back.unwrap() == mesh);
    }
}
