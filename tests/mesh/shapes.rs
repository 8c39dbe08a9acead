//! Procedural meshes: closed where they say so, turned outwards, bit-equal at joins, and legal for any argument.

use multires::mesh::{Mesh, Report, Topology, names, shapes};
use proptest::prelude::*;

/// What every shape promises: a legal mesh, whose attributes fit, with unit normals that but for a few lie on the
/// triangles' side.
fn check(mesh: &Mesh) {
    let copy = Mesh::new(mesh.positions(), mesh.triangles()).expect("positions and indices");
    let copy = mesh.attributes().iter().cloned().try_fold(copy, Mesh::with_attribute).expect("attributes");
    copy.with_materials(mesh.materials()).expect("materials");
    let Some(normals) = mesh.attribute(names::NORMAL).and_then(|n| n.as_floats()) else { return };
    let mut back = 0;
    for corners in mesh.triangles() {
        let face = cross(corners.map(|v| mesh.positions()[v as usize].map(f64::from)));
        for &v in corners {
            let normal: Vec<_> = normals[3 * v as usize..][..3].iter().map(|&x| f64::from(x)).collect();
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((length - 1.0).abs() < 1e-5, "normal of length {length}");
            back += usize::from((0..3).map(|i| normal[i] * face[i]).sum::<f64>() < -1e-9);
        }
    }
    // On rough rock a facet may look away from the average around its corner.
    assert!(back * 500 <= mesh.indices().len(), "{back} normals to the back");
}

/// Twice the area, along the normal.
fn cross([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
    [0, 1, 2].map(|i| u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3])
}

fn volume(mesh: &Mesh) -> f64 {
    let one = |corners: &[u32; 3]| {
        let p = corners.map(|v| mesh.positions()[v as usize].map(f64::from));
        let turned = cross(p);
        (0..3).map(|i| p[0][i] * turned[i]).sum::<f64>() / 6.0
    };
    mesh.triangles().iter().map(one).sum()
}

fn assert_closed(mesh: &Mesh, genus: u32) {
    check(mesh);
    let welded = Report::welded(mesh);
    assert!(welded.is_closed() && welded.is_manifold(), "{welded}");
    assert_eq!(welded.genus(), Some(genus), "{welded}");
    assert_eq!((welded.duplicate_triangles, welded.degenerate_triangles, welded.unused_vertices), (0, 0, 0));
    assert!(volume(mesh) > 0.0, "inside out: {}", volume(mesh));
}

#[test]
fn shapes_without_seams_are_closed_as_stored() {
    for (mesh, genus) in [
        (shapes::tetrahedron(), 0),
        (shapes::cube(), 0),
        (shapes::icosphere(3), 0),
        (shapes::torus(1.0, 0.3, 24, 12), 1),
        (shapes::spindle(17), 0),
        (shapes::rock(3_000, 5), 0),
    ] {
        assert_closed(&mesh, genus);
        assert_eq!(Report::new(&mesh), Report::welded(&mesh));
        assert_eq!(Report::new(&mesh).duplicate_vertices, 0);
    }
}

#[test]
fn shapes_with_seams_are_closed_once_welded() {
    assert_closed(&shapes::uv_sphere(24, 12), 0);
    assert_closed(&shapes::box_with_face_normals(7), 0);
    for (p, q) in [(2, 3), (3, 2), (1, 1), (1, 9), (5, 7), (40, 3)] {
        assert_closed(&shapes::torus_knot(p, q, 600, 9), 1);
    }
}

#[test]
fn counts_are_as_documented() {
    let counts = |mesh: &Mesh| [mesh.positions().len(), mesh.triangles().len()];
    assert_eq!(counts(&shapes::icosphere(0)), [12, 20]);
    assert_eq!(counts(&shapes::icosphere(4)), [2562, 5120]);
    assert_eq!(counts(&shapes::cube()), [8, 12]);
    assert_eq!(counts(&shapes::box_with_face_normals(1)), [24, 12]);
    assert_eq!(counts(&shapes::box_with_face_normals(3)), [6 * 16, 12 * 9]);
    assert_eq!(counts(&shapes::uv_sphere(8, 4)), [9 * 5 - 2, 48]);
    assert_eq!(counts(&shapes::torus(1.0, 0.25, 10, 6)), [60, 120]);
    assert_eq!(counts(&shapes::torus_knot(2, 3, 10, 6)), [77, 120]);
    assert_eq!(counts(&shapes::terrain(33, 1)), [33 * 33, 2 * 32 * 32]);
    assert_eq!(counts(&shapes::terrain(50, 1)), [2500, 2 * 49 * 49]);
    assert_eq!(counts(&shapes::rock(1_000, 1)), [642, 1280]);
    assert_eq!(counts(&shapes::plane(4)), [25, 32]);
    assert_eq!(counts(&shapes::soup(9, 0)), [27, 9]);
    assert_eq!(counts(&shapes::two_spheres_touching(1)), [83, 160]);
}

#[test]
fn open_shapes_have_the_borders_they_say() {
    let border = |mesh: &Mesh| Report::new(mesh).border_edges;
    assert_eq!(border(&shapes::open_cylinder(11, 4)), 22);
    assert_eq!(Report::new(&shapes::open_cylinder(11, 4)).euler_characteristic, 0);
    assert_eq!(border(&shapes::plane(6)), 24);
    assert_eq!(border(&shapes::terrain(20, 3)), 4 * 19);
    assert_eq!(border(&shapes::moebius(13)), 26);
    for mesh in [shapes::terrain(20, 3), shapes::plane(3)] {
        let up = |corners: &[u32; 3]| cross(corners.map(|v| mesh.positions()[v as usize].map(f64::from)))[1];
        assert!(mesh.triangles().iter().all(|corners| up(corners) > 0.0));
        assert_eq!(Report::new(&mesh).flipped_edges, 0);
    }
}

#[test]
fn levels_of_the_icosphere_nest() {
    let (coarse, fine) = (shapes::icosphere(2), shapes::icosphere(3));
    assert_eq!(fine.positions()[..coarse.positions().len()], *coarse.positions());
    for (t, corners) in coarse.triangles().iter().enumerate() {
        for (k, &corner) in corners.iter().enumerate() {
            assert_eq!(fine.triangles()[4 * t + 1 + k][0], corner);
        }
    }
}

#[test]
fn the_uv_sphere_has_one_seam() {
    let report = Report::welded(&shapes::uv_sphere(16, 8));
    assert_eq!(report.seam_vertices, 7 + 2);
    assert_eq!(report.vertices, 16 * 7 + 2);
}

#[test]
fn the_demo_has_all_that_a_demo_needs() {
    let demo = shapes::demo();
    assert_closed(&demo, 3);
    assert!((65_000..75_000).contains(&demo.triangles().len()), "{} triangles", demo.triangles().len());
    let report = Report::welded(&demo);
    assert_eq!(report.components, 6);
    assert!(report.seam_vertices > 500);
    let (points, wedges) = (Topology::new(&demo).point_count(), report.wedges);
    assert!(wedges > points + report.seam_vertices, "creases beyond seams");
    assert_eq!(demo.material_names().len(), 5);
    for material in 0..5 {
        assert!(demo.materials().iter().filter(|&&m| m == material).count() >= 20);
    }
    assert!(demo.attribute(names::UV).is_some() && demo.attribute(names::NORMAL).is_some());
}

/// FNV-1a over all bits of positions and indices.
fn print(mesh: &Mesh) -> u64 {
    let words =
        mesh.positions().as_flattened().iter().map(|x| x.to_bits()).chain(mesh.indices().iter().copied());
    words.fold(0xcbf2_9ce4_8422_2325, |h, w| (h ^ u64::from(w)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn seeds_matter_and_nothing_else_does() {
    for make in [shapes::terrain as fn(u32, u32) -> Mesh, shapes::rock, shapes::soup] {
        assert_eq!(print(&make(100, 7)), print(&make(100, 7)));
        assert_ne!(print(&make(100, 7)), print(&make(100, 8)));
    }
}

/// The bytes are a promise, on every platform. A change of shape is a change of these numbers.
#[test]
fn the_bytes_are_pinned() {
    let prints = [
        print(&shapes::demo()),
        print(&shapes::terrain(65, 1)),
        print(&shapes::rock(20_000, 1)),
        print(&shapes::torus_knot(2, 3, 100, 10)),
        print(&shapes::icosphere(4)),
        print(&shapes::soup(10, 1)),
    ];
    let pinned = [
        0x184f_73ad_77a2_c9cb,
        0x2db0_8a44_a592_4c10,
        0x6b2a_f43d_8812_a4c9,
        0x7368_6c2e_d794_6f1f,
        0x0f08_6d86_5981_b08b,
        0xf496_c752_8ce0_1d0b,
    ];
    assert_eq!(prints, pinned, "{prints:#018x?}");
}

/// Arguments too small are raised, and lengths that make no sense replaced.
#[test]
fn senseless_arguments_give_sensible_shapes() {
    assert_closed(&shapes::uv_sphere(0, 0), 0);
    assert_closed(&shapes::torus(1.0, 0.5, 0, 0), 1);
    assert_closed(&shapes::box_with_face_normals(0), 0);
    assert_closed(&shapes::spindle(0), 0);
    assert_closed(&shapes::rock(0, 0), 0);
    for length in [f32::NAN, f32::INFINITY, 0.0, -1.0, f32::MAX, f32::MIN_POSITIVE] {
        assert_eq!(shapes::torus(length, length, 5, 5), shapes::torus(1.0, 0.4, 5, 5));
    }
    assert_eq!(shapes::torus_knot(0, 0, 0, 0), shapes::torus_knot(1, 1, 3, 3));
    assert_eq!(shapes::torus_knot(4, 6, 90, 5), shapes::torus_knot(2, 3, 90, 5));
    for open in [shapes::open_cylinder(0, 0), shapes::moebius(0), shapes::plane(0), shapes::terrain(0, 0)] {
        check(&open);
        assert!(!open.triangles().is_empty());
    }
    assert_eq!(shapes::book(0), shapes::book(1));
    assert_eq!(shapes::hub(0), shapes::hub(3));
    assert!(shapes::soup(0, 0).triangles().is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_counts_close(segments in 3_u32..60, sides in 3_u32..20, n in 1_u32..8, seed: u32) {
        assert_closed(&shapes::uv_sphere(segments, sides), 0);
        assert_closed(&shapes::torus(2.0, 0.5, segments, sides), 1);
        assert_closed(&shapes::box_with_face_normals(n), 0);
        assert_closed(&shapes::rock(20 * n * n, seed), 0);
        check(&shapes::terrain(segments, seed));
        prop_assert_eq!(Report::welded(&shapes::torus_knot(2, 3, segments, sides)).genus(), Some(1));
    }
}

#[test]
fn game_models_have_what_games_have() {
    let prop = shapes::prop(24);
    assert_eq!(prop.triangles().len(), 12 * 24 * 24);
    assert_closed(&prop, 0);
    assert_eq!(prop.material_names().len(), 2);
    assert!(prop.positions().len() > Topology::new(&prop).point_count(), "hard edges");

    let robot = shapes::robot(4);
    check(&robot);
    let report = Report::welded(&robot);
    assert!(report.is_closed() && report.is_manifold(), "{report}");
    assert_eq!(report.components, 8);
    let uv = robot.attribute(names::UV).and_then(|a| a.as_floats()).unwrap();
    let mirrored = robot.triangles().iter().filter(|t| uv_area(uv, **t) < 0.0).count();
    assert!(mirrored * 4 > robot.triangles().len() && mirrored * 2 < robot.triangles().len(), "{mirrored}");

    let tree = shapes::tree(300);
    check(&tree);
    assert_eq!(tree.triangles().len(), 480 + 600);
    assert_eq!(Report::new(&tree).components, 301);

    let flat = shapes::flat_rock(500, 1);
    check(&flat);
    assert_eq!(flat.positions().len(), 3 * flat.triangles().len());
    assert!(Report::welded(&flat).is_closed());

    let tube = shapes::skinned_tube(16, 20);
    check(&tube);
    assert_eq!(tube.triangles().len(), 640);
    let weights = tube.attribute(names::WEIGHTS).and_then(|a| a.as_floats()).unwrap();
    assert!(
        weights.chunks(4).all(|w| (w.iter().sum::<f32>() - 1.0).abs() < 1e-6 && w.iter().all(|x| *x >= 0.0))
    );

    let disc = shapes::painted_disc(32, 8);
    check(&disc);
    assert_eq!(disc.triangles().len(), 32 * 15);
    let colours = disc.attribute(names::COLOR).and_then(|a| a.as_floats()).unwrap();
    let colour = |v: u32| &colours[3 * v as usize..][..3];
    assert!(disc.triangles().iter().all(|&[a, b, c]| colour(a) == colour(b) && colour(b) == colour(c)));
    let red = disc.triangles().iter().filter(|t| colour(t[0])[1] < 0.5).count();
    assert_eq!(red, 32 * 7);
}

/// Twice the signed area of texture coordinates.
fn uv_area(uv: &[f32], triangle: [u32; 3]) -> f32 {
    let [a, b, c] = triangle.map(|v| [uv[2 * v as usize], uv[2 * v as usize + 1]]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn game_models_take_any_argument() {
    for n in [0, 1, 2, 3, 9] {
        let all = [shapes::prop(n), shapes::robot(n), shapes::tree(n), shapes::flat_rock(n, n)];
        for (which, mesh) in all.iter().enumerate() {
            println!("shape {which} of {n}");
            check(mesh);
        }
        check(&shapes::skinned_tube(n, n));
        check(&shapes::painted_disc(n, n));
    }
}
