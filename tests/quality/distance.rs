//! What `distance` promises: exact answers where geometry gives them, on any scale and anywhere in space, the same
//! bytes for any number of threads, and an error rather than NaN where there is no surface.
#![cfg(feature = "quality")]

use multires::{
    mesh::Mesh,
    quality::{Distance, DistanceOptions, QualityError, Surface, distance, vertex_distances},
};
use proptest::prelude::*;

fn options(samples: usize) -> DistanceOptions {
    DistanceOptions::default().with_samples(samples)
}

fn measure(a: &Mesh, b: &Mesh) -> Distance {
    distance(a, b, &options(20_000)).unwrap()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

/// A height field over `-size..size` squared, `steps` cells a side.
fn plane(steps: u32, size: f32, height: impl Fn(f32, f32) -> f32) -> Mesh {
    let at = |i: u32| size * (2.0 * i as f32 / steps as f32 - 1.0);
    let grid = || (0..=steps).flat_map(|y| (0..=steps).map(move |x| (x, y)));
    let positions: Vec<_> = grid().map(|(x, y)| [at(x), at(y), height(at(x), at(y))]).collect();
    let row = steps + 1;
    let cells = grid().filter(|&(x, y)| x < steps && y < steps).map(|(x, y)| y * row + x);
    let triangles: Vec<_> =
        cells.flat_map(|v| [[v, v + 1, v + row + 1], [v, v + row + 1, v + row]]).collect();
    Mesh::new(positions, triangles).unwrap()
}

/// An octahedron whose triangles are split in four `levels` times, with its vertices on a sphere.
fn sphere(levels: u32, radius: f32) -> Mesh {
    let corner = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mut soup: Vec<[[f64; 3]; 3]> = faces.map(|f: [usize; 3]| f.map(|v| corner[v])).to_vec();
    let middle = |a: [f64; 3], b: [f64; 3]| {
        let sum: [f64; 3] = std::array::from_fn(|i| a[i] + b[i]);
        sum.map(|x| x / length(sum))
    };
    for _ in 0..levels {
        soup = soup
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<[f32; 3]> =
        soup.as_flattened().iter().map(|p| p.map(|x| (x * f64::from(radius)) as f32)).collect();
    let triangles: Vec<[u32; 3]> = (0..soup.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A triangle's normal, twice its area long.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (u, v): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn transformed(mesh: &Mesh, scale: f32, shift: [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> =
        mesh.positions().iter().map(|p| std::array::from_fn(|i| p[i] * scale + shift[i])).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

#[test]
fn a_mesh_is_at_no_distance_from_itself() {
    for mesh in [sphere(3, 2.0), plane(20, 1.0, |x, y| x * y), transformed(&sphere(2, 1.0), 1.0, [4096.0; 3])]
    {
        let d = measure(&mesh, &mesh);
        assert!(d.hausdorff() <= 1e-12 * d.diagonal, "{d:?}");
        assert!(d.rms() <= 1e-12 * d.diagonal, "{d:?}");
    }
}

#[test]
fn a_plane_is_its_offset_from_another() {
    let d = measure(&plane(1, 1.0, |_, _| 0.0), &plane(7, 1.0, |_, _| 0.03));
    let offset = f64::from(0.03f32);
    for (one, sign) in [(d.forward, -1.0), (d.backward, 1.0)] {
        assert_close(one.max, offset, 1e-9);
        assert_close(one.mean, offset, 1e-9);
        assert_close(one.rms, offset, 1e-9);
        assert_close(one.max_at[2] - one.max_to[2], sign * offset, 1e-9);
    }
    assert_close(d.hausdorff_percent(), 100.0 * offset / 8f64.sqrt(), 1e-9);
    assert_close(d.mean_percent(), d.percent(d.mean()), 1e-12);
}

#[test]
fn a_ramp_has_the_mean_and_rms_of_calculus() {
    // Height (x + 1) / 100 over -1..1: distance to the flat plane is the height itself.
    let ramp = plane(3, 1.0, |x, _| (x + 1.0) * 0.01);
    let d = distance(&ramp, &plane(1, 4.0, |_, _| 0.0), &options(400_000)).unwrap();
    assert_close(d.forward.max, 0.02, 1e-5);
    assert_close(d.forward.mean, 0.01, 1e-5);
    assert_close(d.forward.rms, 0.02 / 3f64.sqrt(), 1e-5);
}

#[test]
fn concentric_spheres_lie_between_the_bounds_of_their_facets() {
    let (inner, outer) = (1.0, 1.25);
    let unit = sphere(4, 1.0);
    // Every facet lies between its own plane's distance from the centre and the sphere.
    let depth = unit
        .triangles()
        .iter()
        .map(|t| {
            let corners @ [a, ..] = t.map(|v| unit.positions()[v as usize].map(f64::from));
            let n = normal(corners);
            (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]).abs() / length(n)
        })
        .fold(1.0, f64::min);
    assert!(depth > 0.995, "{depth}");
    let d = measure(&sphere(4, inner as f32), &sphere(4, outer as f32));
    for one in [d.forward, d.backward] {
        // Along a radius both facets are met at the same share of their radii, which bounds the distance from above.
        assert!(one.max <= (outer - inner) * (1.0 + 1e-5), "{one:?}");
        assert!(one.mean <= one.max && one.mean <= one.rms, "{one:?}");
        assert!(one.mean >= outer * depth - inner, "{one:?}");
    }
    // From an outer corner the inner sphere is no nearer than its radius allows.
    assert!(d.backward.max >= outer - inner - 1e-5, "{d:?}");
}

#[test]
fn a_spike_is_found_however_thin() {
    // One vertex of 41 x 41 raised: the maximum is its height, attained at that vertex alone.
    let spiky = plane(40, 1.0, |x, y| if x == 0.0 && y == 0.0 { 0.7 } else { 0.0 });
    let d = distance(&spiky, &plane(40, 1.0, |_, _| 0.0), &options(100)).unwrap();
    assert_close(d.forward.max, f64::from(0.7f32), 1e-5);
    assert_eq!(d.forward.max_at.map(|x| x as f32), [0.0, 0.0, 0.7]);
    // The other way, the point under the apex is nearest to the steepest flank, whose foot is 0.05 away.
    let flank = 0.7 * 0.05 / 0.7f64.hypot(0.05);
    assert!(d.backward.max <= flank * (1.0 + 1e-5) && d.backward.max > 0.5 * flank, "{d:?}");
}

#[test]
fn edges_are_sampled_by_length_however_thin_the_triangle() {
    // A fin across a pit, its corners on the rim and its area next to nothing beside the other triangle's.
    let positions = [
        [-0.6, 0.0, 0.0],
        [0.6, 0.0, 0.0],
        [0.6, 1e-6, 0.0],
        [-1.0, 0.6, 0.0],
        [1.0, 0.6, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let fin = Mesh::new(positions, [[0, 1, 2], [3, 4, 5]]).unwrap();
    let pit = plane(4, 1.0, |x, y| if x == 0.0 && y == 0.0 { -0.5 } else { 0.0 });
    let d = distance(&fin, &pit, &options(1000)).unwrap();
    assert!(d.forward.max > 0.2 && d.forward.mean < 1e-3, "{d:?}");
    assert_eq!(d.forward.edge_samples, 6 + 250);
}

#[test]
fn neither_place_nor_size_matters() {
    let (a, b) = (sphere(3, 1.0), sphere(2, 1.0));
    let here = measure(&a, &b);
    // Powers of two, so that the scaled meshes are the same but for their exponents.
    for exponent in [-100, -40, 40, 120] {
        let scale = 2f32.powi(exponent);
        let there = measure(&transformed(&a, scale, [0.0; 3]), &transformed(&b, scale, [0.0; 3]));
        assert_close(there.hausdorff(), here.hausdorff() * f64::from(scale), 1e-9);
        assert_close(there.mean(), here.mean() * f64::from(scale), 1e-9);
        assert_close(there.rms(), here.rms() * f64::from(scale), 1e-9);
    }
    // A shift that every coordinate survives exactly: the meshes are moved, not rounded.
    let steps = |mesh: &Mesh| {
        let rounded = |x: f32| (x * 256.0).round() / 256.0;
        Mesh::new(mesh.positions().iter().map(|p| p.map(rounded)).collect::<Vec<_>>(), mesh.triangles())
            .unwrap()
    };
    let (a, b) = (steps(&a), steps(&b));
    let shift = [32768.0, -16384.0, 16384.0];
    let (here, there) =
        (measure(&a, &b), measure(&transformed(&a, 1.0, shift), &transformed(&b, 1.0, shift)));
    assert_close(there.hausdorff(), here.hausdorff(), 1e-9);
    assert_close(there.mean(), here.mean(), 1e-9);
    assert_close(there.rms(), here.rms(), 1e-9);
}

#[test]
fn a_tiny_mesh_and_a_distant_one_are_measured_too() {
    let tiny = transformed(&sphere(2, 1.0), 1e-30, [0.0; 3]);
    let d = measure(&tiny, &transformed(&sphere(2, 1.0), 1.0, [3e7, 0.0, 0.0]));
    assert_close(d.hausdorff(), 3e7, 1e-6);
    assert_close(d.mean(), 3e7, 1e-6);
}

#[test]
fn huge_coordinates_stay_finite() {
    let at = |z: f32| Mesh::new([[-3e38, -3e38, z], [3e38, -3e38, z], [0.0, 3e38, z]], [[0, 1, 2]]).unwrap();
    let d = measure(&at(0.0), &at(1e38));
    assert_close(d.rms(), f64::from(1e38f32), 1e-9);
    assert_close(d.hausdorff(), f64::from(1e38f32), 1e-9);
}

#[test]
fn coincident_and_degenerate_triangles_change_nothing() {
    let mesh = plane(6, 1.0, |x, y| 0.1 * x * y);
    let other = plane(1, 1.0, |_, _| 0.25);
    let expected = measure(&mesh, &other);
    let mut triangles = mesh.triangles().to_vec();
    // 60 thousand times one triangle, turned and flipped: pairing neighbours would take one round each.
    triangles.extend((0..60_000).map(|i| match (mesh.triangles()[5], i % 3) {
        ([a, b, c], 0) => [b, c, a],
        ([a, b, c], 1) => [c, b, a],
        (same, _) => same,
    }));
    triangles.extend([[0, 0, 0], [0, 1, 1], [21, 22, 23]]);
    let crowded = Mesh::new(mesh.positions(), triangles).unwrap();
    assert_eq!(measure(&crowded, &other), expected);
}

#[test]
fn concentric_triangles_do_not_stall_the_build() {
    // Nested and turned about one centre, in order of size: every box prefers the smallest.
    let count = 20_000;
    let positions: Vec<[f32; 3]> = (0..3 * count)
        .map(|i| {
            let (ring, corner) = (i / 3, i % 3);
            let angle = ring as f32 * 0.37 + corner as f32 * std::f32::consts::TAU / 3.0;
            let radius = 1.0 + ring as f32 / count as f32;
            [radius * angle.cos(), radius * angle.sin(), 0.0]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let rings = Mesh::new(positions, triangles).unwrap();
    let d = distance(&rings, &plane(1, 4.0, |_, _| 0.5), &options(1000)).unwrap();
    assert_close(d.forward.mean, 0.5, 1e-6);
}

#[test]
fn the_order_of_triangles_hardly_matters() {
    let (a, b) = (sphere(3, 1.0), sphere(1, 1.0));
    let mut triangles = a.triangles().to_vec();
    triangles.reverse();
    let turned = Mesh::new(a.positions(), triangles).unwrap();
    assert_close(measure(&turned, &b).mean(), measure(&a, &b).mean(), 1e-3);
}

#[test]
fn swapping_the_meshes_swaps_the_sides() {
    let (a, b) = (sphere(2, 1.0), sphere(1, 1.1));
    let (ab, ba) = (measure(&a, &b), measure(&b, &a));
    assert_eq!((ab.forward, ab.backward), (ba.backward, ba.forward));
    assert_eq!((ab.hausdorff(), ab.mean(), ab.rms()), (ba.hausdorff(), ba.mean(), ba.rms()));
}

#[test]
fn a_prepared_surface_gives_the_same_bytes() {
    let meshes = [sphere(3, 1.0), sphere(1, 1.0), plane(4, 1.5, |x, y| x * y)];
    let surfaces: Vec<Surface<'_>> = meshes.iter().map(|mesh| Surface::new(mesh).unwrap()).collect();
    for (a, first) in meshes.iter().zip(&surfaces) {
        for (b, second) in meshes.iter().zip(&surfaces) {
            let options = options(5_000);
            assert_eq!(first.distance(second, &options), distance(a, b, &options));
            assert_eq!(
                first.distance_to(second, &options).unwrap(),
                distance(a, b, &options).unwrap().forward
            );
            assert_eq!(second.point_distances(a.positions()), vertex_distances(a, b).unwrap());
        }
    }
    assert_eq!(surfaces[0].diagonal(), meshes[0].diagonal());
    assert_eq!(surfaces[0].mesh(), &meshes[0]);
}

#[test]
fn the_maximum_is_closed_in_on_from_few_samples() {
    // A hill whose top lies over the inside of a triangle, far from its corners.
    let bump = |x: f32, y: f32| 0.3 - 0.2 * ((x - 0.21).powi(2) + (y - 0.13).powi(2)).sqrt();
    let (flat, hill) = (plane(1, 1.0, |_, _| 0.0), plane(64, 1.2, bump));
    // Concentric spheres are as far from each other nearly everywhere: nothing can be dropped early.
    let (inner, outer) = (sphere(2, 1.0), sphere(4, 1.1));
    for (a, b, loose) in [(&flat, &hill, 1.001), (&hill, &flat, 1.001), (&inner, &outer, 1.5)] {
        let coarse = distance(a, b, &options(2_000)).unwrap();
        let fine = distance(a, b, &options(1_000_000)).unwrap();
        for (few, many) in [(coarse.forward, fine.forward), (coarse.backward, fine.backward)] {
            assert!(many.max <= few.max_bound && few.max <= many.max_bound, "{few:?} {many:?}");
            assert!(few.max_bound <= few.max * loose + 1e-8, "{few:?}");
            assert!(few.max >= 0.999 * many.max - 1e-8, "{few:?} {many:?}");
        }
        assert_eq!(coarse.hausdorff_bound(), coarse.forward.max_bound.max(coarse.backward.max_bound));
    }
    // With hardly any samples hardly any pieces may be looked at: the bound is looser, and no less true.
    let (few, many) = (distance(&inner, &outer, &options(1)).unwrap(), measure(&inner, &outer));
    assert!(few.forward.max_bound >= many.forward.max && few.forward.max_bound < 1.0, "{few:?}");
}

#[test]
fn concentric_spheres_approach_the_difference_of_their_radii() {
    let apart = |levels| {
        let d = measure(&sphere(levels, 1.0), &sphere(levels, 1.25));
        (d.mean() - 0.25).abs().max((d.rms() - 0.25).abs()).max((d.hausdorff() - 0.25).abs())
    };
    // Facets of half the size sag a quarter as much, and so does all that differs from the exact spheres.
    let errors: Vec<f64> = (2..7).map(apart).collect();
    assert!(errors.windows(2).all(|pair| pair[1] < 0.27 * pair[0]), "{errors:?}");
    assert!(errors[4] < 2e-4, "{errors:?}");
}

#[test]
fn seeds_move_the_samples_and_little_else() {
    let (a, b) = (sphere(3, 1.0), sphere(1, 1.0));
    let other = distance(&a, &b, &options(20_000).with_seed(9)).unwrap();
    let first = measure(&a, &b);
    assert_ne!(first, other);
    assert_close(other.mean(), first.mean(), 1e-3);
    assert_close(other.rms(), first.rms(), 1e-3);
}

#[test]
fn unused_vertices_are_no_surface() {
    let mesh = plane(2, 1.0, |_, _| 0.0);
    let mut positions = mesh.positions().to_vec();
    positions.push([0.0, 0.0, 9.0]);
    let stray = Mesh::new(positions, mesh.triangles()).unwrap();
    assert_eq!(measure(&stray, &mesh), measure(&mesh, &mesh));
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (a, b) = (sphere(4, 1.0), sphere(2, 1.0));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| measure(&a, &b))
    };
    let alone = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(with(threads), alone);
    }
}

#[test]
fn meshes_without_a_surface_are_refused_by_name() {
    let good = sphere(0, 1.0);
    let empty = Mesh::default();
    let points = Mesh::new([[0.0; 3], [1.0; 3]], [[0, 1, 1], [0, 0, 0]]).unwrap();
    let line = Mesh::new([[0.0; 3], [0.25; 3], [0.75; 3]], [[0, 1, 2]]).unwrap();
    for (bad, triangles) in [(&empty, 0), (&points, 2), (&line, 1)] {
        let error = |which| Err(QualityError::NoSurface { which, triangles });
        assert_eq!(distance(bad, &good, &options(10)), error("first"));
        assert_eq!(distance(&good, bad, &options(10)), error("second"));
    }
    assert!(distance(&points, &good, &options(1)).unwrap_err().to_string().contains("first mesh"));
}

#[test]
fn sample_counts_out_of_range_are_refused() {
    let mesh = sphere(0, 1.0);
    for samples in [0, (1 << 32) + 1] {
        let error = distance(&mesh, &mesh, &options(samples)).unwrap_err();
        assert!(matches!(error, QualityError::Samples { samples: s, .. } if s == samples));
    }
    assert_eq!(distance(&mesh, &mesh, &options(1)).unwrap().forward.face_samples, 1);
}

fn soup() -> impl Strategy<Value = Mesh> {
    let coordinate = prop_oneof![(-4i8..5).prop_map(f32::from), -1.0f32..1.0, -1e-6f32..1e-6, Just(1e5)];
    let positions = prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 3..24);
    positions.prop_flat_map(|positions| {
        let index = 0..positions.len() as u32;
        let triangles = prop::collection::vec([index.clone(), index.clone(), index], 1..40);
        triangles.prop_map(move |triangles| Mesh::new(positions.clone(), triangles).unwrap())
    })
}

/// Distance of a point from a segment, and from a triangle by closing in on it: slow, and independent of the library.
fn from_segment(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let at = |t: f64| length(std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t - p[i]));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(left) < at(right) { high = right } else { low = left }
    }
    at(low).min(at(0.0)).min(at(1.0))
}

fn from_triangle(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    // Distance to the segment from a to a point of bc is convex in that point.
    let foot = |t: f64| std::array::from_fn(|i| b[i] + (c[i] - b[i]) * t);
    let at = |t: f64| from_segment(p, a, foot(t));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..100 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(left) < at(right) { high = right } else { low = left }
    }
    at(low).min(at(0.0)).min(at(1.0))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn any_input_gives_finite_ordered_numbers_or_an_error(a in soup(), b in soup()) {
        match distance(&a, &b, &options(300)) {
            Ok(d) => for one in [d.forward, d.backward] {
                prop_assert!(one.max.is_finite() && one.mean.is_finite() && one.rms.is_finite());
                prop_assert!(0.0 <= one.mean && one.mean <= one.rms * (1.0 + 1e-9));
                prop_assert!(one.rms <= one.max * (1.0 + 1e-9));
                prop_assert!(one.max <= one.max_bound && one.max_bound.is_finite());
            },
            Err(error) => {
                prop_assert!(matches!(error, QualityError::NoSurface { .. }), "{}", error);
            }
        }
    }

    #[test]
    fn the_nearest_point_is_the_nearest(a in soup(), b in soup()) {
        if let Ok(d) = distance(&a, &b, &options(50)) {
            let one = d.forward;
            let nearest = b
                .triangles()
                .iter()
                .map(|t| t.map(|v| b.positions()[v as usize].map(f64::from)))
                .filter(|&t| length(normal(t)) > 0.0)
                .map(|t| from_triangle(one.max_at, t))
                .fold(f64::INFINITY, f64::min);
            prop_assert!((one.max - nearest).abs() <= 1e-5 * nearest + 1e-6, "{} {}", one.max, nearest);
        }
    }
}
