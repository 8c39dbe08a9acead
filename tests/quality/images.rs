//! What `image_difference` promises: 0 for what looks the same, areas of silhouettes in pixels, no matter how large or
//! where the meshes are, more difference the coarser a level is, the same bytes for any number of threads and on every
//! machine, and an error where there is nothing to see.
#![cfg(feature = "quality")]

use multires::{
    Simplifier,
    mesh::{Attribute, Mesh, names, shapes},
    quality::{ImageDifference, ImageOptions, QualityError, ReferenceImages, image_difference},
};
use proptest::prelude::*;

fn options(views: usize, size: usize) -> ImageOptions {
    ImageOptions::default().with_views(views).with_size(size)
}

fn compare(a: &Mesh, b: &Mesh, views: usize, size: usize) -> ImageDifference {
    image_difference(a, b, &options(views, size)).unwrap()
}

fn moved(mesh: &Mesh, scale: f32, shift: [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> =
        mesh.positions().iter().map(|p| std::array::from_fn(|i| p[i] * scale + shift[i])).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

/// A square across x, from -1 to 1, its middle at `z`, of `cells` squared cells.
fn plate(cells: u32, z: f32) -> Mesh {
    let at = |i: u32| 2.0 * i as f32 / cells as f32 - 1.0;
    let grid = |n: u32| (0..n).flat_map(move |y| (0..n).map(move |x| (x, y)));
    let positions: Vec<_> = grid(cells + 1).map(|(x, y)| [0.0, at(x), at(y) + z]).collect();
    let row = cells + 1;
    let triangles: Vec<_> = grid(cells)
        .map(|(x, y)| y * row + x)
        .flat_map(|v| [[v, v + 1, v + row + 1], [v, v + row + 1, v + row]])
        .collect();
    Mesh::new(positions, triangles).unwrap()
}

/// The cube of side 2 with a pit in the face towards z, `depth` deep in its middle.
fn pitted(depth: f32) -> Mesh {
    let mut positions: Vec<[f32; 3]> =
        (0..8).map(|i| [1, 2, 4].map(|bit| if i & bit == 0 { -1.0 } else { 1.0 })).collect();
    positions.push([0.0, 0.0, 1.0 - depth]);
    let quads: [[u32; 4]; 5] = [[0, 2, 3, 1], [0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3]];
    let mut triangles: Vec<_> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    triangles.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
    Mesh::new(positions, triangles).unwrap()
}

fn is_none(difference: &ImageDifference) -> bool {
    let d = difference;
    let measures = [d.l1, d.l2, d.silhouette, d.silhouette_share, d.l1_max, d.l2_max];
    measures == [0.0; 6] && d.silhouette_max == 0 && d.pixels_first == d.pixels_second
}

#[test]
fn a_mesh_looks_like_itself() {
    for mesh in [shapes::demo(), plate(3, 0.0), shapes::soup(50, 1), shapes::torus_knot(2, 3, 200, 12)] {
        let difference = compare(&mesh, &mesh, 42, 48);
        assert!(is_none(&difference), "{difference:?}");
        assert!(difference.pixels_first > 0);
        assert_eq!((difference.views, difference.size), (42, 48));
    }
}

#[test]
fn only_the_surface_counts() {
    // Another tessellation of the same planes; creases stay apart.
    let (fine, coarse) = (plate(7, 0.0), plate(1, 0.0));
    assert!(compare(&fine, &coarse, 42, 64).l2 < 0.1);
    let cube = pitted(0.0);
    let flat = Mesh::new(
        &cube.positions()[..8],
        cube.triangles()[..10].iter().copied().chain([[4, 5, 7], [4, 7, 6]]).collect::<Vec<_>>(),
    )
    .unwrap();
    let difference = compare(&cube, &flat, 42, 64);
    assert!(difference.l2 < 0.1 && difference.silhouette == 0.0, "{difference:?}");

    // Normals that the mesh brings are not looked at, nor is which way all of it faces.
    let ball = shapes::icosphere(3);
    let bare = Mesh::new(ball.positions(), ball.triangles()).unwrap();
    let wrong = vec![[0.0f32, 0.0, 1.0]; bare.positions().len()];
    let dressed = bare.clone().with_attribute(Attribute::floats(names::NORMAL, &wrong)).unwrap();
    assert!(is_none(&compare(&bare, &dressed, 5, 64)));
    let turned: Vec<_> = ball.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let difference = compare(&bare, &Mesh::new(ball.positions(), turned).unwrap(), 5, 64);
    assert!(difference.l2 < 0.1 && difference.silhouette == 0.0, "{difference:?}");
}

#[test]
fn areas_are_pixels() {
    // One view alone looks along x. The ball around the plate has a radius of the root of 2.
    let images = ReferenceImages::new(&plate(2, 0.0), &options(1, 512)).unwrap();
    let direction = images.direction(0).unwrap();
    assert!((direction[0] - 1.0).abs() < 1e-12, "{direction:?}");
    let pixel = 2.0 * 2f64.sqrt() * 1.0625 / 512.0;
    for shift in [0.125, 0.25, -0.5] {
        let difference = images.difference(&plate(2, shift)).unwrap();
        // A strip on either side, each as wide as the shift.
        let area = 2.0 * 2.0 * f64::from(shift.abs());
        let seen = difference.silhouette * pixel * pixel;
        assert!((seen / area - 1.0).abs() < 0.02, "{shift}: {seen} for {area}");
        assert!((difference.pixels_first as f64 * pixel * pixel / 4.0 - 1.0).abs() < 0.01);
        assert!((difference.silhouette_share - area / 4.0).abs() < 0.01, "{difference:?}");
        assert_eq!(difference.silhouette_max as f64, difference.silhouette);
    }

    // A ball is a disc from every side, and fills the picture but for the room around it.
    let ball = compare(&shapes::icosphere(5), &shapes::icosphere(1), 42, 256);
    let disc = std::f64::consts::PI * (128.0 / 1.0625f64).powi(2);
    assert!((ball.pixels_first as f64 / 42.0 / disc - 1.0).abs() < 0.005, "{ball:?}");
    // Within the ball, so what differs is what is missing.
    assert_eq!(ball.silhouette * 42.0, (ball.pixels_first - ball.pixels_second) as f64);
}

#[test]
fn brightness_is_the_angle_to_the_light() {
    // Flat plates seen from the front: the cosine to the light is 2 / 3.
    let images = ReferenceImages::new(&plate(1, 0.0), &options(1, 9)).unwrap();
    let picture = images.picture(0).unwrap();
    let expected = (32.0 + 223.0 * (1.0 + 2.0 / 3.0) / 2.0_f64).round() as u8;
    assert_eq!((picture.pixels()[40], picture.pixels()[0]), ([expected; 3], [0; 3]));
    // From a grazing plate to none at all is the whole grey; all pixels that show either count.
    let none = images.difference(&moved(&plate(1, 0.0), 1.0, [0.0, 0.0, 8.0])).unwrap();
    assert_eq!((none.l1, none.l2, none.silhouette_share), (f64::from(expected), f64::from(expected), 1.0));
    assert_eq!(none.pixels_second, 0);
}

#[test]
fn a_common_frame_makes_it_symmetric() {
    let (a, b) = (pitted(0.0), pitted(0.75));
    let (there, back) = (compare(&a, &b, 42, 64), compare(&b, &a, 42, 64));
    assert!(there.l1 > 0.5 && there.l2 > there.l1, "{there:?}");
    assert_eq!((there.l1, there.l2, there.silhouette), (back.l1, back.l2, back.silhouette));
    assert_eq!((there.l1_max_view, there.l2_max_view), (back.l1_max_view, back.l2_max_view));
    assert_eq!((there.pixels_first, there.pixels_second), (back.pixels_second, back.pixels_first));
}

#[test]
fn size_and_place_do_not_matter() {
    let (a, b) = (shapes::torus(1.0, 0.375, 48, 24), shapes::torus(1.0, 0.375, 12, 7));
    let here = compare(&a, &b, 42, 64);
    for scale in [2f32.powi(-20), 0.5, 2f32.powi(40)] {
        assert_eq!(compare(&moved(&a, scale, [0.0; 3]), &moved(&b, scale, [0.0; 3]), 42, 64), here);
    }
    for (scale, shift) in [(1.0, [8.0, -3.0, 0.5]), (3.0, [0.0; 3]), (0.1, [1.0, 2.0, 3.0])] {
        let there = compare(&moved(&a, scale, shift), &moved(&b, scale, shift), 42, 64);
        for (there, here) in
            [(there.l1, here.l1), (there.l2, here.l2), (there.silhouette_share, here.silhouette_share)]
        {
            assert!((there / here - 1.0).abs() < 0.01, "{scale} {shift:?}: {there} for {here}");
        }
    }
}

#[test]
fn coarser_levels_look_more_different() {
    let mesh = shapes::demo();
    let sequence = Simplifier::new().run(&mesh).unwrap();
    let images = ReferenceImages::new(&mesh, &options(42, 96)).unwrap();
    let mut last: Option<ImageDifference> = None;
    for percent in [60, 25, 10, 4] {
        let steps = sequence.steps_for_triangles(mesh.triangles().len() * percent / 100);
        let now = images.difference(&sequence.extract(&mesh, steps)).unwrap();
        if let Some(last) = last {
            assert!(now.l1 > last.l1 && now.l2 > last.l2, "{percent} %: {now:?} after {last:?}");
            assert!(now.silhouette >= last.silhouette, "{percent} %: {now:?} after {last:?}");
        }
        assert!(now.l1_max >= now.l1 && now.l2_max >= now.l2);
        last = Some(now);
    }
    assert!(last.unwrap().silhouette > 0.0);
}

#[test]
fn views_can_be_looked_at() {
    let (mesh, other) = (shapes::cube(), shapes::icosphere(2));
    let images = ReferenceImages::new(&mesh, &options(7, 33)).unwrap();
    assert_eq!(images.views(), 7);
    for view in 0..7 {
        let length: f64 = images.direction(view).unwrap().iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-12);
        let alone = images.picture(view).unwrap();
        assert_eq!((alone.width(), alone.height()), (33, 33));
        let row = images.compare_view(&other, view).unwrap();
        assert_eq!((row.width(), row.height()), (99, 33));
        for (i, pixel) in alone.pixels().iter().enumerate() {
            let at = |column: usize| row.pixels()[i / 33 * 99 + 33 * column + i % 33];
            assert_eq!(at(0), *pixel);
            assert_eq!(at(2)[0], at(0)[0].abs_diff(at(1)[0]).saturating_mul(4));
        }
    }
    assert_eq!((images.direction(7), images.picture(7)), (None, None));
    assert_eq!(images.compare_view(&other, 7), Err(QualityError::View { view: 7, views: 7 }));
}

#[test]
fn worst_views_are_named() {
    // A ball and the same with a bump to one side: seen best where the bump sticks out.
    let ball = shapes::icosphere(3);
    let mut positions = ball.positions().to_vec();
    for p in &mut positions {
        if p[1] > 0.9 {
            *p = p.map(|x| x * 0.8);
        }
    }
    let dented = Mesh::new(positions, ball.triangles()).unwrap();
    let images = ReferenceImages::new(&ball, &options(42, 64)).unwrap();
    let difference = images.difference(&dented).unwrap();
    let side = images.direction(difference.silhouette_max_view).unwrap();
    assert!(side[1].abs() < 0.4, "{side:?}");
    let front = images.direction(difference.l1_max_view).unwrap();
    assert!(front[1] > 0.6, "{front:?}");
}

#[test]
fn numbers_are_the_same_on_every_machine() {
    let d = compare(&shapes::icosphere(4), &shapes::icosphere(1), 42, 64);
    let spiral = compare(&shapes::demo(), &shapes::torus_knot(2, 3, 64, 8), 5, 64);
    let counts = |d: &ImageDifference| [d.pixels_first, d.pixels_second, d.silhouette_max];
    let measures = |d: &ImageDifference| [d.l1, d.l2];
    assert_eq!((counts(&d), counts(&spiral)), ([119492, 111268, 214], [6200, 6734, 1566]));
    assert_eq!(
        (measures(&d), measures(&spiral)),
        ([14.222475433219943, 44.21870029604897], [148.23426846398507, 167.5502319319696])
    );
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (a, b) = (shapes::torus(1.0, 0.4, 40, 20), shapes::torus(1.0, 0.4, 9, 6));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let images = ReferenceImages::new(&a, &options(6, 50)).unwrap();
            let pictures: Vec<_> = (0..6).map(|view| images.picture(view).unwrap()).collect();
            (images.difference(&b).unwrap(), pictures)
        })
    };
    let alone = with(1);
    for threads in [2, 5] {
        assert_eq!(with(threads), alone);
    }
}

#[test]
fn what_cannot_be_seen_is_refused() {
    let ball = shapes::icosphere(1);
    let empty = Mesh::default();
    let line = Mesh::new([[0.0; 3], [1.0; 3], [2.0; 3]], [[0, 1, 2]]).unwrap();
    for (nothing, triangles) in [(&empty, 0), (&line, 1)] {
        let error = image_difference(nothing, &ball, &options(2, 8)).unwrap_err();
        assert_eq!(error, QualityError::NoSurface { which: "first", triangles });
        let images = ReferenceImages::new(&ball, &options(2, 8)).unwrap();
        let expected = QualityError::NoSurface { which: "second", triangles };
        assert_eq!(images.difference(nothing), Err(expected.clone()));
        assert_eq!(images.compare_view(nothing, 0), Err(expected));
    }
    for (views, size) in [(0, 8), (8, 0), (usize::MAX, 1), (1, usize::MAX), (1025, 1024)] {
        let error = image_difference(&ball, &ball, &options(views, size)).unwrap_err();
        assert_eq!(error, QualityError::ImagePixels { views, size, limit: 1 << 30 });
    }
}

fn any_mesh() -> impl Strategy<Value = Mesh> {
    let coordinate = prop_oneof![8 => -1.0f32..1.0, 1 => Just(0.0), 1 => -1e30f32..1e30];
    let position = prop::array::uniform3(coordinate);
    let positions = prop::collection::vec(position, 3..12);
    (positions, prop::collection::vec(prop::array::uniform3(0u32..1000), 1..12)).prop_map(|(positions, t)| {
        let count = positions.len() as u32;
        Mesh::new(positions, t.iter().map(|t| t.map(|v| v % count)).collect::<Vec<_>>()).unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn measures_bound_each_other(a in any_mesh(), b in any_mesh(), views in 1usize..6) {
        let Ok(d) = image_difference(&a, &b, &options(views, 20)) else { return Ok(()) };
        prop_assert!(0.0 <= d.l1 && d.l1 <= d.l2 + 1e-12 && d.l2 <= 255.0);
        prop_assert!(d.l1 <= d.l1_max + 1e-12 && d.l2 <= d.l2_max + 1e-12);
        prop_assert!(d.silhouette <= d.silhouette_max as f64 && d.silhouette_max <= 400);
        let apart = d.pixels_first.abs_diff(d.pixels_second) as f64;
        prop_assert!(apart <= d.silhouette * views as f64 + 1e-9);
        prop_assert!(d.silhouette == 0.0 || d.l1 > 0.0);
        prop_assert!([d.l1_max_view, d.l2_max_view, d.silhouette_max_view].iter().all(|&v| v < views));
    }
}
