//! Promise: lazy and k-disk transforms give back what went in, are linear, keep constants and seams, and leave midpoint
//! subdivision where coefficients are left out; k-disk wavelets are orthogonal to the coarse hats of their disk, norms
//! and errors are the integrals they say, and at equal counts k-disk wavelets are nearer than lazy ones.

use crate::wavelet::*;
use multires::mesh::{Mesh, names, shapes};
use multires::wavelet::{
    Coefficients, Wavelet, WaveletBuilder, WaveletError, WaveletMesh, WaveletOptions, WaveletTransform,
    l2_error,
};
use proptest::prelude::*;

const KINDS: [Wavelet; 4] = [Wavelet::Lazy, Wavelet::Disk(0), Wavelet::Disk(1), Wavelet::Disk(2)];

fn options() -> WaveletOptions {
    WaveletOptions::default()
}

fn flat(mesh: &WaveletMesh) -> &[f32] {
    mesh.vertices().positions().as_flattened()
}

fn triples(values: &[f32]) -> Vec<[f32; 3]> {
    values.chunks_exact(3).map(|xyz| [xyz[0], xyz[1], xyz[2]]).collect()
}

/// Every float attribute with its width.
fn floats(mesh: &WaveletMesh) -> impl Iterator<Item = (&[f32], usize)> {
    mesh.vertices().attributes().iter().filter_map(|a| Some((a.as_floats()?, a.width())))
}

/// The largest difference.
fn apart(a: &[f32], b: &[f32]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(&a, &b)| (f64::from(a) - f64::from(b)).abs()).fold(0.0, f64::max)
}

/// Finest triangles as vertices of the mesh.
fn leaves(mesh: &WaveletMesh) -> Vec<[u32; 3]> {
    let of = mesh.subdivision();
    let finest = mesh.finest(multires::wavelet::Normals::Kept);
    let mut used = vec![true; of.vertex_count()];
    used[..of.base_vertex_count()].fill(false);
    let base = (0..of.base_face_count() as u32).filter_map(|face| of.base_face(face));
    base.flatten().for_each(|vertex| used[vertex as usize] = true);
    let used: Vec<u32> = (0..of.vertex_count() as u32).filter(|&v| used[v as usize]).collect();
    assert_eq!(finest.positions().len(), used.len());
    finest.triangles().iter().map(|t| t.map(|v| used[v as usize])).collect()
}

/// Inner product over the faces of the finest level, each of area 1: by the middles of sides, exact for quadratics.
fn product(leaves: &[[u32; 3]], f: &[f32], g: &[f32]) -> f64 {
    let at = |values: &[f32], t: &[u32; 3], k: usize| {
        0.5 * (f64::from(values[t[k] as usize]) + f64::from(values[t[(k + 1) % 3] as usize]))
    };
    leaves.iter().map(|t| (0..3).map(|k| at(f, t, k) * at(g, t, k)).sum::<f64>() / 3.0).sum()
}

/// A function that is 1 at one node, by coefficient.
fn unit(transform: &WaveletTransform, node: usize) -> Vec<f32> {
    let mut nodes = vec![0.0; transform.node_count()];
    nodes[node] = 1.0;
    transform.coefficients(nodes, 1).unwrap().synthesise()
}

/// The hat of a node on a level: 1 there, 0 at all other nodes of the level, linear on its faces.
fn hat(lazy: &WaveletTransform, node: usize, level: usize) -> Vec<f32> {
    let values: Vec<f32> = (0..lazy.vertex_count() as u32)
        .map(|vertex| f32::from(u8::from(lazy.node_of(vertex) == Some(node))))
        .collect();
    lazy.analyse(&values, 1).unwrap().to_level(level).synthesise()
}

#[cfg(feature = "io")]
const WITH_CONNECTIVITY: [&str; 9] = [
    "subdivision/bunny-rand-s3.ply",
    "subdivision/boat.obj",
    "subdivision/penguin-s3.ply",
    "subdivision/icosphere-s3.obj",
    "subdivision/bumpy-s2.ply",
    "subdivision/torus-s3.obj",
    "subdivision/3holes.ply",
    "subdivision/cube-uv-s1.obj",
    "real/homer.obj",
];

#[cfg(feature = "io")]
fn model(name: &str) -> Option<WaveletMesh> {
    let mesh = crate::models::read("wavelet/transform", name)?;
    let bare = Mesh::new(mesh.positions(), mesh.triangles()).unwrap();
    // Texture seams may cut through coarse faces.
    let found = WaveletMesh::recognise(&mesh, &options());
    Some(found.or_else(|_| WaveletMesh::recognise(&bare, &options())).unwrap())
}

/// What both transforms give back of everything a mesh has.
fn check_round_trips(mesh: &WaveletMesh, kind: Wavelet, exact: bool) {
    let points = WaveletTransform::of_points(mesh, kind).unwrap();
    let vertices = WaveletTransform::of_vertices(mesh.subdivision(), kind).unwrap();
    let positions = std::iter::once((flat(mesh), 3)).map(|values| (&points, values));
    let attributes = floats(mesh).chain([(flat(mesh), 3)]).map(|values| (&vertices, values));
    for (transform, (values, width)) in positions.chain(attributes) {
        let back = transform.analyse(values, width).unwrap().synthesise();
        let largest = values.iter().fold(0.0_f32, |a, b| a.max(b.abs()));
        if exact {
            assert_eq!(values, back);
        }
        let error = apart(values, &back);
        assert!(error <= 6e-8 * f64::from(largest), "{kind:?}: {error}");
    }
}

#[test]
#[cfg(feature = "io")]
fn models_come_back() {
    for name in WITH_CONNECTIVITY {
        let Some(mesh) = model(name) else { continue };
        for kind in KINDS {
            check_round_trips(&mesh, kind, kind == Wavelet::Lazy);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mesh_comes_back(base in 0..bases().len(), levels in 0usize..4, seed: u64, kind in 0..4usize) {
        let mesh = uniform(&bases()[base].1, levels, seed, &options());
        check_round_trips(&mesh, KINDS[kind], false);
        let mesh = patchy(&bases()[base].1, levels, seed, &options());
        check_round_trips(&mesh, Wavelet::Lazy, false);
    }

    /// Lazily bit for bit, where values near each other are of sizes not too far apart, zero apart.
    #[test]
    fn lazy_is_exact(base in 0..bases().len(), levels in 1usize..4, seed: u64) {
        let mesh = patchy(&bases()[base].1, levels, seed, &options());
        let transform = WaveletTransform::of_vertices(mesh.subdivision(), Wavelet::Lazy).unwrap();
        let value = |v: u64| {
            let size = -26.0 * hash(v, seed ^ 1);
            let sign = (3.0 * hash(v, seed ^ 2) - 1.0).ceil() - 1.0;
            // With all bits of the fraction in use.
            (sign * (1.0 + hash(v, seed ^ 3)).min(1.9999) * size.floor().exp2()) as f32
        };
        let values: Vec<f32> = (0..transform.vertex_count() as u64).map(value).collect();
        prop_assert_eq!(transform.analyse(&values, 1).unwrap().synthesise(), values);
    }

    #[test]
    fn is_linear(base in 0..bases().len(), seed: u64, kind in 0..4usize, factor in -3.0f32..3.0) {
        let mesh = uniform(&bases()[base].1, 2, seed, &options());
        let transform = WaveletTransform::of_vertices(mesh.subdivision(), KINDS[kind]).unwrap();
        let random = |salt: u64| -> Vec<f32> {
            (0..transform.vertex_count() as u64).map(|v| hash(v, seed ^ salt) as f32).collect()
        };
        let (f, g) = (random(1), random(2));
        let sum: Vec<f32> = f.iter().zip(&g).map(|(f, g)| f + factor * g).collect();
        let [f, g, sum] = [&f, &g, &sum].map(|values| transform.analyse(values, 1).unwrap());
        for ((f, g), sum) in f.nodes().iter().zip(g.nodes()).zip(sum.nodes()) {
            prop_assert!((f + f64::from(factor) * g - sum).abs() < 1e-5);
        }
    }

    #[test]
    fn constants_are_kept(base in 0..bases().len(), seed: u64, kind in 0..4usize, value in -1e6f32..1e6) {
        let mesh = uniform(&bases()[base].1, 3, seed, &options());
        let transform = WaveletTransform::of_points(&mesh, KINDS[kind]).unwrap();
        let values = vec![value; transform.vertex_count()];
        let coefficients = transform.analyse(&values, 1).unwrap();
        prop_assert_eq!(coefficients.kept(), 0);
        prop_assert!(coefficients.of_level(0).iter().all(|&x| x == f64::from(value)));
        prop_assert_eq!(coefficients.synthesise(), values);
    }

    /// Without coefficients, midpoints are in the middle.
    #[test]
    fn without_coefficients_it_is_midpoint_subdivision(
        base in 0..bases().len(), seed: u64, kind in 0..4usize, level in 0usize..3,
    ) {
        let mesh = uniform(&bases()[base].1, 3, seed, &options());
        let of = mesh.subdivision();
        let transform = WaveletTransform::of_points(&mesh, KINDS[kind]).unwrap();
        let coarse = transform.analyse(flat(&mesh), 3).unwrap().to_level(level);
        let values = coarse.synthesise();
        let values = triples(&values);
        let at = |vertex: u32| values[vertex as usize];
        for vertex in of.base_vertex_count() as u32..of.vertex_count() as u32 {
            if of.level_of(of.wavelet_of(vertex).unwrap()) <= level {
                continue;
            }
            let [a, b] = of.ends(vertex).unwrap().map(at);
            for i in 0..3 {
                prop_assert!((at(vertex)[i] - 0.5 * (a[i] + b[i])).abs() < 1e-5);
            }
        }
        // Lazy levels are samples.
        if KINDS[kind] == Wavelet::Lazy {
            for vertex in 0..of.base_vertex_count() as u32 {
                prop_assert_eq!(at(vertex), mesh.vertices().positions()[vertex as usize]);
            }
        }
    }

    /// Positions on seams stay together, whatever is left out; attributes on the two sides have nothing to do with each
    /// other.
    #[test]
    fn seams_stay_closed(seed: u64, kind in 0..4usize, count in 0usize..200) {
        let mesh = uniform(&shapes::box_with_face_normals(1), 3, seed, &options());
        let of = mesh.subdivision();
        let points = WaveletTransform::of_points(&mesh, KINDS[kind]).unwrap();
        prop_assert!(points.node_count() < of.vertex_count());
        let values = points.analyse(flat(&mesh), 3).unwrap().to_count(count).synthesise();
        let values = triples(&values);
        let original = mesh.vertices().positions();
        for wavelet in 0..of.wavelet_count() as u32 {
            for double in of.seam_vertices_of(wavelet) {
                prop_assert_eq!(values[double as usize], values[of.vertex_of(wavelet) as usize]);
            }
        }
        for a in 0..of.base_vertex_count() {
            for b in 0..a {
                prop_assert!(original[a] != original[b] || values[a] == values[b]);
            }
        }

        // The normals of a side are one vector each: no coefficients, whatever is across the seams.
        let vertices = WaveletTransform::of_vertices(of, KINDS[kind]).unwrap();
        prop_assert_eq!(vertices.node_count(), of.vertex_count());
        let normals = mesh.vertices().attribute(names::NORMAL).unwrap();
        let coefficients = vertices.analyse(normals.as_floats().unwrap(), 3).unwrap();
        prop_assert_eq!(coefficients.kept(), 0);
        prop_assert_eq!(&coefficients.synthesise(), normals.as_floats().unwrap());
    }

    #[test]
    fn counts_and_tolerances_keep_the_largest(seed: u64, kind in 0..4usize, count in 0usize..700) {
        let mesh = uniform(&shapes::terrain(4, 1), 3, seed, &options());
        let transform = WaveletTransform::of_points(&mesh, KINDS[kind]).unwrap();
        let all = transform.analyse(flat(&mesh), 3).unwrap();
        prop_assert_eq!(all.count(), mesh.subdivision().wavelet_count());
        let kept = all.to_count(count);
        prop_assert_eq!(kept.kept(), count.min(all.kept()));
        let of = |node| (kept.nodes()[3 * node..3 * node + 3] != [0.0; 3], all.magnitude(node).unwrap());
        let rest = || (transform.nodes_of(0).end..transform.node_count()).map(of);
        let least = rest().filter(|x| x.0).map(|x| x.1).fold(f64::INFINITY, f64::min);
        let most = rest().filter(|x| !x.0).map(|x| x.1).fold(0.0, f64::max);
        prop_assert!(least >= most);
        prop_assert_eq!(kept.of_level(0), all.of_level(0));
        if most < least {
            let same = all.to_tolerance(most);
            prop_assert_eq!(same.nodes(), kept.nodes());
        }
    }
}

#[test]
fn norms_and_errors_are_integrals() {
    for (name, base) in bases() {
        let mesh = uniform(&base, 2, 3, &options());
        let (of, leaves) = (mesh.subdivision(), leaves(&mesh));
        let zero = vec![0.0; of.vertex_count()];
        for kind in KINDS {
            let transform = WaveletTransform::of_points(&mesh, kind).unwrap();
            for node in (transform.nodes_of(0).end..transform.node_count()).step_by(5) {
                let wavelet = unit(&transform, node);
                let integral = (product(&leaves, &wavelet, &wavelet) / leaves.len() as f64).sqrt();
                let error = l2_error(of, 1, &wavelet, &zero).unwrap();
                assert!((error - integral).abs() < 1e-6 * integral, "{name} {kind:?}: {error} {integral}");
                let norm = transform.norm(node).unwrap();
                assert!((norm - integral).abs() < 1e-6 * integral, "{name} {kind:?}: {norm} {integral}");
            }
        }
    }
}

/// Of several scalars it is the length of the difference.
#[test]
fn errors_of_vectors_add_up() {
    let mesh = uniform(&shapes::icosphere(0), 2, 5, &options());
    let of = mesh.subdivision();
    let zero = vec![0.0; flat(&mesh).len()];
    let all = l2_error(of, 3, flat(&mesh), &zero).unwrap();
    let squares = (0..3).map(|i| {
        let one: Vec<f32> = flat(&mesh).iter().skip(i).step_by(3).copied().collect();
        l2_error(of, 1, &one, &zero[..one.len()]).unwrap().powi(2)
    });
    assert!((all - squares.sum::<f64>().sqrt()).abs() < 1e-12);
}

/// On their disk, and only because they are lifted.
#[test]
fn disk_wavelets_are_orthogonal_to_their_disk() {
    for (name, base) in bases() {
        let mesh = uniform(&base, 2, 3, &options());
        let leaves = leaves(&mesh);
        for points in [true, false] {
            let transform = |kind| match points {
                true => WaveletTransform::of_points(&mesh, kind).unwrap(),
                false => WaveletTransform::of_vertices(mesh.subdivision(), kind).unwrap(),
            };
            let lazy = transform(Wavelet::Lazy);
            let mut size = 0;
            for rings in 0..3 {
                let disks = transform(Wavelet::Disk(rings));
                for level in 1..=2 {
                    for node in disks.nodes_of(level).step_by(7) {
                        let (disk, weights) = disks.lifting(node).unwrap();
                        assert_eq!(disk.len(), weights.len());
                        size += disk.len();
                        let wavelet = unit(&disks, node);
                        let midpoint = unit(&lazy, node);
                        let norm = product(&leaves, &wavelet, &wavelet).sqrt();
                        for (at, &coarse) in disk.iter().enumerate() {
                            let hat = hat(&lazy, coarse as usize, level - 1);
                            let scale = norm * product(&leaves, &hat, &hat).sqrt();
                            let with = product(&leaves, &wavelet, &hat) / scale;
                            assert!(with.abs() < 1e-6, "{name}, {rings} rings, level {level}: {with}");
                            if at < 2 {
                                assert!(product(&leaves, &midpoint, &hat) / scale > 0.1);
                            }
                        }
                    }
                }
            }
            assert!(size > 0);
        }
    }
}

/// The two ends; with their neighbours; with theirs.
#[test]
fn disks_have_rings() {
    let mesh = uniform(&shapes::torus(1.0, 0.4, 12, 12), 1, 1, &options());
    for (rings, size) in [(0, 2), (1, 10), (2, 24)] {
        let transform = WaveletTransform::of_points(&mesh, Wavelet::Disk(rings)).unwrap();
        for node in transform.nodes_of(1) {
            assert_eq!(transform.lifting(node).unwrap().0.len(), size);
        }
        // All alike.
        assert_eq!(transform.patterns(), 1, "{rings} rings");
    }
}

/// Where whole levels are missing there are no disks; components may still differ.
#[test]
fn disks_ask_for_whole_levels() {
    let mut builder = WaveletBuilder::new(&shapes::icosphere(0)).unwrap();
    builder.subdivide_where(|face| face.base_face < 5, |m| m.middle).unwrap();
    let mesh = builder.build(&options()).unwrap();
    for transform in [
        WaveletTransform::of_points(&mesh, Wavelet::Disk(1)),
        WaveletTransform::of_vertices(mesh.subdivision(), Wavelet::Disk(0)),
    ] {
        assert!(matches!(transform, Err(WaveletError::Invalid { at: 5.., .. })), "{transform:?}");
    }
    let zero = vec![0.0; mesh.subdivision().vertex_count()];
    assert!(matches!(l2_error(mesh.subdivision(), 1, &zero, &zero), Err(WaveletError::Invalid { .. })));
    assert!(WaveletTransform::of_points(&mesh, Wavelet::Lazy).is_ok());

    let (one, two) = (shapes::icosphere(0), shapes::tetrahedron());
    let count = one.positions().len() as u32;
    let far = two.positions().iter().map(|p| [p[0] + 5.0, p[1], p[2]]);
    let positions: Vec<[f32; 3]> = one.positions().iter().copied().chain(far).collect();
    let shifted = two.triangles().iter().map(|t| t.map(|v| v + count));
    let triangles: Vec<[u32; 3]> = one.triangles().iter().copied().chain(shifted).collect();
    let mut builder = WaveletBuilder::new(&Mesh::new(positions, triangles).unwrap()).unwrap();
    builder.subdivide_where(|face| face.base_face < 20, rough(1, 0.3)).unwrap();
    builder.subdivide_where(|face| face.base_face < 20, rough(2, 0.3)).unwrap();
    let mesh = builder.build(&options()).unwrap();
    for kind in KINDS {
        check_round_trips(&mesh, kind, false);
    }
    // 24 base faces of area 1; the last four are not split.
    let mut moved = flat(&mesh).to_vec();
    moved[3 * count as usize..][..12].iter_mut().for_each(|x| *x += 1.0);
    let error = l2_error(mesh.subdivision(), 3, flat(&mesh), &moved).unwrap();
    assert!((error - (3.0_f64 * 4.0 / 24.0).sqrt()).abs() < 1e-6, "{error}");
}

/// Around a vertex of very many neighbours, disks have as many rings as fit.
#[test]
fn crowded_disks_are_smaller() {
    let mesh = uniform(&shapes::hub(400), 2, 1, &options());
    for rings in 0..3 {
        let transform = WaveletTransform::of_points(&mesh, Wavelet::Disk(rings)).unwrap();
        for node in transform.nodes_of(1) {
            assert!(transform.lifting(node).unwrap().0.len() <= 256);
        }
        check_round_trips(&mesh, Wavelet::Disk(rings), false);
    }
}

#[test]
fn whatever_does_not_fit_is_refused() {
    let mesh = uniform(&shapes::box_with_face_normals(1), 1, 1, &options());
    let vertices = mesh.subdivision().vertex_count();
    let transform = WaveletTransform::of_points(&mesh, Wavelet::Disk(1)).unwrap();
    let length = |result: Result<Coefficients, WaveletError>, found, expected| {
        let error = WaveletError::Length { what: "values", found, expected };
        assert_eq!(result.err(), Some(error));
    };
    length(transform.analyse(&[], 3), 0, 3 * vertices);
    length(transform.analyse(&vec![0.0; 2 * vertices], 3), 2 * vertices, 3 * vertices);
    length(transform.analyse(&[], usize::MAX), 0, usize::MAX);
    length(transform.coefficients(vec![0.0; 5], 1), 5, transform.node_count());
    let invalid = |error: Option<WaveletError>, number: usize| {
        assert!(matches!(error, Some(WaveletError::Invalid { at, .. }) if at == number), "{error:?}");
    };
    invalid(transform.analyse(&[], 0).err(), 0);
    invalid(transform.coefficients(Vec::new(), 0).err(), 0);
    let mut values = vec![0.0; 2 * vertices];
    values[7] = f32::NAN;
    invalid(transform.analyse(&values, 2).err(), 3);
    // A seam that is torn.
    let double = mesh.subdivision().vertex_count() - 1;
    let mut values = vec![0.0; vertices];
    values[double] = 1.0;
    invalid(transform.analyse(&values, 1).err(), double);
    let mut nodes = vec![0.0; 2 * transform.node_count()];
    nodes[9] = f64::INFINITY;
    invalid(transform.coefficients(nodes, 2).err(), 4);
    invalid(WaveletTransform::of_points(&mesh, Wavelet::Disk(3)).err(), 3);
    let error = l2_error(mesh.subdivision(), 2, &vec![0.0; 2 * vertices], &[]);
    assert_eq!(error, Err(WaveletError::Length { what: "values", found: 0, expected: 2 * vertices }));

    // Out of range is nothing, not an error.
    let base = transform.nodes_of(0).end;
    assert_eq!((transform.norm(0), transform.norm(base - 1), transform.norm(usize::MAX)), (None, None, None));
    assert!(transform.lifting(base - 1).is_none() && transform.lifting(usize::MAX).is_none());
    assert!(transform.nodes_of(usize::MAX).is_empty() && transform.vertex_of(usize::MAX).is_none());
    assert_eq!(transform.node_of(u32::MAX), None);
    let all = transform.analyse(flat(&mesh), 3).unwrap();
    assert_eq!(all.to_level(usize::MAX).nodes(), all.nodes());
    assert_eq!(all.to_count(usize::MAX).nodes(), all.nodes());
    assert_eq!(all.to_tolerance(f64::NAN).kept(), 0);
    assert!(all.of_level(usize::MAX).is_empty());
}

#[test]
fn nothing_is_nothing() {
    let none = Mesh::new(Vec::new(), Vec::new()).unwrap();
    let mesh = WaveletBuilder::new(&none).unwrap().build(&options()).unwrap();
    for kind in KINDS {
        let transform = WaveletTransform::of_points(&mesh, kind).unwrap();
        assert!(transform.analyse(&[], 3).unwrap().to_count(1).synthesise().is_empty());
        let of = multires::wavelet::Subdivision::default();
        assert_eq!(WaveletTransform::of_vertices(&of, kind).unwrap().node_count(), 0);
        assert_eq!(l2_error(&of, 1, &[], &[]), Ok(0.0));
    }
}

/// L2 errors of the kinds with a share of the coefficients.
fn errors(mesh: &WaveletMesh, share: f64) -> [f64; 4] {
    KINDS.map(|kind| {
        let transform = WaveletTransform::of_points(mesh, kind).unwrap();
        let all = transform.analyse(flat(mesh), 3).unwrap();
        let some = all.to_count((share * all.count() as f64) as usize).synthesise();
        l2_error(mesh.subdivision(), 3, flat(mesh), &some).unwrap()
    })
}

fn check_order(name: &str, mesh: &WaveletMesh) {
    for share in [0.0, 0.02, 0.1, 0.2, 0.5] {
        let [lazy, zero, one, two] = errors(mesh, share);
        // Which are the largest is a matter of luck where they are few: two rings may lose a little.
        let ordered = zero < 0.96 * lazy && one < zero && two < 1.03 * one;
        assert!(ordered, "{name}, {share}: {lazy} {zero} {one} {two}");
    }
}

#[test]
fn disks_are_nearer_than_lazy_wavelets() {
    let terrain = WaveletMesh::recognise(&shapes::terrain(65, 1), &options()).unwrap();
    check_order("terrain", &terrain);
    check_order("rough ball", &uniform(&shapes::icosphere(0), 5, 1, &options()));
}

#[test]
#[cfg(feature = "io")]
fn disks_are_nearer_on_models() {
    // The sides of a cube are flat: nothing to leave out.
    for name in WITH_CONNECTIVITY.into_iter().filter(|name| !name.contains("cube")) {
        if let Some(mesh) = model(name) {
            check_order(name, &mesh);
        }
    }
}
