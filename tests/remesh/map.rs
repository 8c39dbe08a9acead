//! Promise: the map between a mesh and its base is one to one and continuous, and holds for every point of both.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use crate::support::{along, at, awkward, distance, is_face, map, models, on_base, remesh, sides, weights};
use multires::mesh::{Mesh, MeshPoint, shapes};
use multires::remesh::{Depth, Fitting, Parameterisation, RemeshError, Remesher, Smoothing};
use multires::wavelet::{DomainPoint, WaveletOptions};

/// Largest distance of a point that went there and back from the point itself, share of the diagonal.
const ROUND_TRIP: f64 = 1e-12;
/// Largest distance of the images of a point of a base edge, as a point of each base face there, share of the diagonal.
const CRACK: f64 = 1e-12;

fn all() -> impl Iterator<Item = (&'static str, Mesh, usize)> {
    models().into_iter().chain(awkward().into_iter().map(|(name, mesh)| (name, mesh, 4)))
}

/// Returns the farthest that points of the base, and points of the mesh, come back from themselves, shares of the diagonal.
fn round_trips(map: &Parameterisation, mesh: &Mesh, samples: u64) -> [f64; 2] {
    let diagonal = mesh.diagonal();
    let (mut of_base, mut of_mesh) = (0.0f64, 0.0f64);
    for face in 0..map.base().triangles().len() as u32 {
        for sample in 0..samples {
            let place = DomainPoint::new(face, weights(u64::from(face), sample));
            let back = map.to_base(&map.to_mesh(&place).unwrap()).unwrap();
            of_base =
                of_base.max(distance(on_base(map.base(), &place), on_base(map.base(), &back)) / diagonal);
        }
    }
    for triangle in (0..mesh.triangles().len()).filter(|&t| is_face(mesh, t)) {
        for sample in 0..samples.min(8) {
            let point = MeshPoint::new(triangle as u32, weights(triangle as u64, sample));
            let back = map.to_mesh(&map.to_base(&point).unwrap()).unwrap();
            of_mesh = of_mesh.max(distance(at(mesh, &point), at(mesh, &back)) / diagonal);
        }
    }
    [of_base, of_mesh]
}

#[test]
fn points_come_back_from_the_other_side() {
    for (name, mesh, faces) in all() {
        let map = map(&mesh, faces);
        let [of_base, of_mesh] = round_trips(&map, &mesh, 40);
        println!("{name}: {of_base:.1e} {of_mesh:.1e}, {} base faces", map.base().triangles().len());
        assert!(of_base < ROUND_TRIP && of_mesh < ROUND_TRIP, "{name}: {of_base:e}, {of_mesh:e}");
    }
}

#[test]
fn base_faces_agree_along_their_edges() {
    for (name, mesh, faces) in all() {
        let map = map(&mesh, faces);
        let (mut worst, mut shared) = (0.0f64, 0);
        for sides in sides(map.base()).values().filter(|sides| sides.len() > 1) {
            shared += 1;
            for step in 0..=64 {
                let images = sides.iter().map(|&(face, side, backward)| {
                    let place = DomainPoint::new(face, along(side, backward, f64::from(step) / 64.0));
                    at(&mesh, &map.to_mesh(&place).unwrap())
                });
                let images: Vec<[f64; 3]> = images.collect();
                worst = images.iter().map(|p| distance(*p, images[0])).fold(worst, f64::max);
            }
        }
        println!("{name}: {shared} edges, {:.1e}", worst / mesh.diagonal());
        assert!(worst < CRACK * mesh.diagonal(), "{name}: {:e}", worst / mesh.diagonal());
    }
}

#[test]
fn every_triangle_has_its_image() {
    for (name, mesh, faces) in all() {
        let map = map(&mesh, faces);
        let count = map.base().triangles().len() as u32;
        let mut reached = vec![false; count as usize];
        for triangle in 0..mesh.triangles().len() {
            for weights in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0 / 3.0; 3]] {
                let place = map.to_base(&MeshPoint::new(triangle as u32, weights));
                assert_eq!(place.is_some(), is_face(&mesh, triangle), "{name}, triangle {triangle}");
                let Some(place) = place else { continue };
                assert!(place.base_face < count, "{name}");
                let sum: f64 = place.barycentric.iter().sum();
                assert!((sum - 1.0).abs() < 1e-12 && place.barycentric.iter().all(|w| *w >= 0.0), "{name}");
                reached[place.base_face as usize] = true;
            }
        }
        // Where there are several triangles a base face, each base face has the middle of some.
        let full = mesh.triangles().len() < 20 * count as usize || reached.iter().all(|&reached| reached);
        assert!(full, "{name}");
    }
}

#[test]
fn images_of_base_faces_have_the_area_of_the_mesh() {
    let area = |mesh: &Mesh| {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions()[v as usize].map(f64::from));
            let (e, f): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
            0.5 * distance(n, [0.0; 3])
        };
        mesh.triangles().iter().map(of).sum::<f64>()
    };
    // Triangles of a level cut corners of the surface: the finer they are, the less area they lack.
    for (name, mesh, faces) in models() {
        let map = map(&mesh, faces);
        let level = if map.base().triangles().len() < 100 { 5 } else { 4 };
        let finest = remesh(&map, &mesh, level).finest(multires::wavelet::Normals::Kept);
        let share = area(&finest) / area(&mesh);
        println!("{name}: {share:.4}");
        assert!((0.97..1.001).contains(&share), "{name}: {share}");
    }
}

#[test]
fn vertices_of_the_remesh_lie_at_their_images() {
    for (name, mesh, faces) in all() {
        let map = Remesher::new().base_faces(faces).fitting(Fitting::Off).run(&mesh).unwrap();
        let go_on = |_| ControlFlow::Continue(());
        let baked = map.bake_with(&mesh, Depth::Levels(3), &WaveletOptions::default(), go_on).unwrap();
        let remesh = baked.model.structure();
        let of = remesh.subdivision();
        assert_eq!(of.base_face_count(), map.base().triangles().len(), "{name}");
        let mut moved = BTreeSet::new();
        for face in 0..of.face_count() as u32 {
            let corners = of.face(face).unwrap().into_iter().zip(of.domain_of_face(face).unwrap());
            for (vertex, place) in corners {
                let position = remesh.vertices().positions()[vertex as usize].map(f64::from);
                let image = at(&mesh, &map.to_mesh(&place).unwrap());
                if distance(position, image) > 1e-6 * mesh.diagonal() {
                    moved.insert(vertex);
                }
            }
        }
        // Corners of triangles that would face away are moved.
        assert!(moved.len() <= 3 * (baked.unfolded + baked.folded), "{name}: {moved:?}");
    }
}

#[test]
fn nothing_is_folded_or_lost_in_figures() {
    for (name, mesh, faces) in models() {
        let map = map(&mesh, faces);
        let found = map.distortion(&mesh, 3);
        assert_eq!(found.triangles, 64 * map.base().triangles().len(), "{name}");
        for spread in [found.angle, found.area] {
            assert!(spread.mean >= 1.0 && spread.mean < 20.0, "{name}: {found:?}");
            assert!(spread.p99 >= spread.mean.min(1.0) && spread.p99.is_finite(), "{name}: {found:?}");
        }
        // A triangle of a level may cut a concave corner of a flat sheet; a remesh has none of these.
        assert!(found.folded <= found.triangles / 1_000, "{name}: {found:?}");
        let go_on = |_| ControlFlow::Continue(());
        let baked = map.bake_with(&mesh, Depth::Levels(3), &WaveletOptions::default(), go_on).unwrap();
        assert_eq!((baked.unfolded, baked.folded), (found.folded, 0), "{name}");
    }
    // A mesh that is its own base is not distorted.
    let sphere = shapes::icosphere(1);
    let own = Remesher::new().base_faces(80).smoothing(Smoothing::Off).run(&sphere).unwrap();
    let own = own.distortion(&sphere, 2);
    assert!(own.angle.p99 < 1.0 + 1e-6 && own.area.p99 < 1.0 + 1e-6 && own.folded == 0, "{own:?}");
}

#[test]
fn places_that_are_none_have_no_image() {
    let mesh = shapes::rock(500, 1);
    let map = map(&mesh, 40);
    let faces = map.base().triangles().len() as u32;
    let triangles = mesh.triangles().len() as u32;
    assert!(map.to_mesh(&DomainPoint::new(faces, [1.0, 0.0, 0.0])).is_none());
    assert!(map.to_base(&MeshPoint::new(triangles, [1.0, 0.0, 0.0])).is_none());
    for weights in [[0.0; 3], [-1.0, -1.0, 0.0], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
        assert!(map.to_mesh(&DomainPoint::new(0, weights)).is_none(), "{weights:?}");
        assert!(map.to_base(&MeshPoint::new(0, weights)).is_none(), "{weights:?}");
    }
    // Others are scaled.
    let place = |weights| map.to_mesh(&DomainPoint::new(3, weights)).unwrap();
    assert_eq!(place([2.0, 2.0, -1.0]), place([0.5, 0.5, 0.0]));
}

#[test]
fn runs_end_where_progress_breaks() {
    let mesh = shapes::rock(3_000, 1);
    let mut shares: Vec<f32> = Vec::new();
    let all = |share: f32| {
        shares.push(share);
        ControlFlow::Continue(())
    };
    let map = Remesher::new().base_faces(100).run_with(&mesh, all).unwrap();
    assert!(
        shares.len() > 1 && shares.is_sorted() && shares.iter().all(|s| (0.0..=1.0).contains(s)),
        "{shares:?}"
    );
    for calls in 0..shares.len() {
        let run = Remesher::new().base_faces(100).run_with(&mesh, breaking_after(calls));
        assert_eq!(run.unwrap_err(), RemeshError::Cancelled, "after {calls} calls");
    }

    let (depth, options) = (Depth::Levels(3), WaveletOptions::default());
    let mut shares = Vec::new();
    let baked = map.bake_with(&mesh, depth, &options, |share| {
        shares.push(share);
        ControlFlow::Continue(())
    });
    assert!(baked.unwrap().model == map.bake(&mesh, depth, &options).unwrap());
    assert!(
        shares.len() > 1 && shares.is_sorted() && shares.iter().all(|s| (0.0..=1.0).contains(s)),
        "{shares:?}"
    );
    for calls in 0..shares.len() {
        let baked = map.bake_with(&mesh, depth, &options, breaking_after(calls));
        assert_eq!(baked.unwrap_err(), RemeshError::Cancelled, "after {calls} calls");
    }
}

/// A progress callback that breaks at call `calls`, from 0.
fn breaking_after(calls: usize) -> impl FnMut(f32) -> ControlFlow<()> {
    let mut made = 0;
    move |_| {
        made += 1;
        if made > calls { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let meshes = [(shapes::rock(4_000, 2), 80), (shapes::prop(10), 150), (shapes::skinned_tube(16, 40), 40)];
    let make = || {
        meshes.each_ref().map(|(mesh, faces)| {
            let map = map(mesh, *faces);
            let baked = map.bake(mesh, Depth::Levels(3), &WaveletOptions::default()).unwrap();
            let places = (0..mesh.triangles().len() as u32)
                .map(|triangle| map.to_base(&MeshPoint::new(triangle, [0.5, 0.25, 0.25])).unwrap());
            (places.collect::<Vec<_>>(), map.base().clone(), baked)
        })
    };
    let [one, two] = [1, 2]
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(make));
    assert!(one == two, "one thread and two");
    assert!(one == make(), "twice");
}

#[test]
fn the_map_takes_as_many_bytes_as_it_says() {
    for (name, mesh, faces) in [
        ("rock", shapes::rock(20_000, 1), 200),
        ("terrain", shapes::terrain(101, 1), 200),
        ("flat rock", shapes::flat_rock(8_000, 1), 200),
    ] {
        let map = map(&mesh, faces);
        let bytes = map.memory() as f64 / mesh.triangles().len() as f64;
        println!("{name}: {bytes:.1} bytes a triangle");
        assert!((40.0..200.0).contains(&bytes), "{name}: {bytes} bytes a triangle");
    }
}

#[test]
fn meshes_without_triangles_are_refused() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    for mesh in [
        Mesh::default(),
        Mesh::new(points, []).unwrap(),
        // Triangles with two equal points, by number and by position.
        Mesh::new(points, [[0, 0, 1], [1, 1, 1], [0, 2, 1]]).unwrap(),
    ] {
        assert_eq!(Remesher::new().run(&mesh).unwrap_err(), RemeshError::Empty);
    }
}

#[test]
fn other_meshes_are_refused() {
    let mesh = shapes::rock(500, 1);
    let map = map(&mesh, 40);
    let other = shapes::rock(600, 1);
    assert!(matches!(
        map.bake(&other, Depth::Levels(1), &WaveletOptions::default()),
        Err(RemeshError::Wavelet(multires::wavelet::WaveletError::Length { what: "triangles", .. }))
    ));
}
