//! What `render` promises: surfaces where they are, in the colours asked for, lit from the camera; the same bytes for
//! any number of threads; the background where there is nothing; and an error for what makes no picture.
#![cfg(feature = "quality")]

use multires::{
    mesh::{Attribute, Mesh, names},
    quality::{Camera, Colours, Picture, QualityError, RenderOptions, Shading, palette, render},
};

/// Two triangles, a square from -1 to 1 at height `z`, facing up z.
fn square(z: f32) -> Mesh {
    Mesh::new([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]], [[0, 1, 2], [0, 2, 3]])
        .unwrap()
}

/// A camera above the origin; a square from -1 to 1 at height 0 spans half the picture.
fn above() -> Camera {
    Camera::new([0.0, 0.0, 2.0], [0.0; 3]).with_field_of_view(std::f64::consts::FRAC_PI_2)
}

fn options(side: usize) -> RenderOptions {
    RenderOptions::default()
        .with_size(side, side)
        .with_supersampling(false)
        .with_occlusion_rays(0)
        .with_background([255, 0, 255], [255, 0, 255])
}

fn is_background(pixel: [u8; 3]) -> bool {
    pixel == [255, 0, 255]
}

fn at(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
    picture.pixels()[y * picture.width() + x]
}

#[test]
fn a_square_covers_exactly_its_pixels() {
    let picture = render(&square(0.0), &above(), &options(40)).unwrap();
    for y in 0..40 {
        for x in 0..40 {
            let inside = (10..30).contains(&x) && (10..30).contains(&y);
            assert_eq!(is_background(at(&picture, x, y)), !inside, "{x} {y}");
        }
    }
}

#[test]
fn up_is_up_and_right_is_right() {
    // One triangle in the quadrant of positive x and y: the picture's upper right.
    let mesh = Mesh::new([[0.1, 0.1, 0.0], [1.9, 0.1, 0.0], [0.1, 1.9, 0.0]], [[0, 1, 2]]).unwrap();
    let picture = render(&mesh, &above(), &options(40)).unwrap();
    let seen: Vec<(usize, usize)> =
        (0..1600).map(|i| (i % 40, i / 40)).filter(|&(x, y)| !is_background(at(&picture, x, y))).collect();
    assert!(!seen.is_empty() && seen.iter().all(|&(x, y)| x >= 20 && y < 20), "{seen:?}");
    let turned = render(&mesh, &above().with_up([1.0, 0.0, 0.0]), &options(40)).unwrap();
    assert!(!is_background(at(&turned, 15, 15)) && is_background(at(&turned, 25, 15)));
}

#[test]
fn what_lies_behind_is_not_seen() {
    let away = Camera::new([0.0, 0.0, 2.0], [0.0, 0.0, 4.0]);
    assert!(render(&square(0.0), &away, &options(8)).unwrap().pixels().iter().all(|&p| is_background(p)));
}

#[test]
fn the_nearer_surface_hides_the_farther() {
    let positions = [square(0.0).positions(), square(0.5).positions()].concat();
    let mesh = Mesh::new(positions, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]).unwrap();
    let colours = vec![[255, 0, 0], [255, 0, 0], [0, 0, 255], [0, 0, 255]];
    let options = options(40).with_colours(Colours::PerTriangle(colours));
    let [r, g, b] = at(&render(&mesh, &above(), &options).unwrap(), 20, 20);
    assert!(b > 100 && r < b / 2 && g < b / 2, "{:?}", [r, g, b]);
}

#[test]
fn colours_come_by_vertex_triangle_material_or_for_all() {
    let mesh = square(0.0);
    let paint = |colours| {
        let picture = render(&mesh, &above(), &options(40).with_colours(colours)).unwrap();
        // Left edge of the upper triangle, right edge of the lower one.
        (at(&picture, 12, 14), at(&picture, 28, 26))
    };
    let vertices = vec![[255, 0, 0], [0, 255, 0], [0, 255, 0], [255, 0, 0]];
    let (left, right) = paint(Colours::PerVertex(vertices));
    assert!(left[0] > left[1] && right[1] > right[0], "{left:?} {right:?}");
    let (upper, lower) = paint(Colours::PerTriangle(vec![[0, 255, 0], [255, 0, 0]]));
    assert!(lower[1] > lower[0] && upper[0] > upper[1], "{lower:?} {upper:?}");
    let (a, b) = paint(Colours::Uniform([40, 200, 40]));
    assert!(a[1] > a[0] && b[1] > b[0]);
    let two = square(0.0).with_materials([1, 5]).unwrap();
    let picture = render(&two, &above(), &options(40)).unwrap();
    assert_ne!(at(&picture, 12, 14), at(&picture, 28, 26));
}

#[test]
fn back_faces_are_seen_and_told_apart() {
    let mesh = square(0.0);
    let flipped = Mesh::new(mesh.positions(), [[0, 2, 1], [0, 3, 2]]).unwrap();
    let (front, back) =
        (render(&mesh, &above(), &options(8)).unwrap(), render(&flipped, &above(), &options(8)).unwrap());
    assert!(!is_background(at(&back, 4, 4)));
    assert_ne!(at(&front, 4, 4), at(&back, 4, 4));
}

#[test]
fn smooth_shading_blends_and_flat_does_not() {
    // A gentle roof along y, seen from above; its two slopes lean to either side.
    let positions = [
        [-1.0, -1.0, 0.0],
        [0.0, -1.0, 0.2],
        [1.0, -1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 1.0, 0.2],
        [1.0, 1.0, 0.0],
    ];
    let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let roof = Mesh::new(positions, triangles).unwrap();
    let step = |mesh: &Mesh, shading| {
        let picture = render(mesh, &above(), &options(80).with_shading(shading)).unwrap();
        i32::from(at(&picture, 39, 40)[0]) - i32::from(at(&picture, 40, 40)[0])
    };
    assert!(step(&roof, Shading::Flat).abs() > 5);
    assert!(step(&roof, Shading::Smooth).abs() <= 2);
    // A steep one is creased, unless its own normals say otherwise.
    let steep = Mesh::new(positions.map(|[x, y, z]| [x, y, z * 5.0]), triangles).unwrap();
    assert!(step(&steep, Shading::Smooth).abs() > 5);
    let own = steep.with_attribute(Attribute::floats(names::NORMAL, &[[0.0, 0.0, 1.0]; 6])).unwrap();
    assert!(step(&own, Shading::Smooth).abs() <= 2);
}

#[test]
fn edges_are_drawn_where_they_are() {
    let plain = render(&square(0.0), &above(), &options(40)).unwrap();
    let lined = render(&square(0.0), &above(), &options(40).with_edges(2.0)).unwrap();
    // The diagonal from lower left to upper right, and the middle of one triangle.
    assert!(at(&lined, 20, 19)[0] < at(&plain, 20, 19)[0] - 20);
    assert_eq!(at(&lined, 24, 25), at(&plain, 24, 25));
    // Not a number is no width.
    assert_eq!(render(&square(0.0), &above(), &options(40).with_edges(f32::NAN)).unwrap(), plain);
}

#[test]
fn a_niche_is_darker_than_the_open() {
    // A square, and a wall along its middle.
    let positions =
        [square(0.0).positions(), &[[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.9], [0.0, -1.0, 0.9]]]
            .concat();
    let mesh = Mesh::new(positions, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]).unwrap();
    let picture = render(&mesh, &above(), &options(40).with_occlusion_rays(64)).unwrap();
    assert!(at(&picture, 21, 20)[0] + 10 < at(&picture, 28, 20)[0]);
}

#[test]
fn framing_fills_the_picture_and_cuts_nothing() {
    let positions = [[5.0, 1.0, 0.0], [9.0, 1.5, 0.5], [6.0, 7.0, -1.0], [5.5, 2.0, 3.0]];
    let mesh = Mesh::new(positions, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap();
    for direction in [[0.0, 0.0, -1.0], [1.0, -0.5, 0.2], [0.0, -3.0, 0.0], [0.0; 3]] {
        let picture = render(&mesh, &Camera::framing(&mesh, direction), &options(100)).unwrap();
        let seen =
            || (0..10_000).map(|i| (i % 100, i / 100)).filter(|&(x, y)| !is_background(at(&picture, x, y)));
        let (low_x, high_x) = (seen().map(|p| p.0).min().unwrap(), seen().map(|p| p.0).max().unwrap());
        let (low_y, high_y) = (seen().map(|p| p.1).min().unwrap(), seen().map(|p| p.1).max().unwrap());
        assert!(low_x > 0 && high_x < 99 && low_y > 0 && high_y < 99);
        assert!((high_x - low_x).max(high_y - low_y) > 75, "{direction:?}");
    }
}

#[test]
fn place_and_size_do_not_show() {
    let camera = |scale: f64, shift: f64| {
        Camera::new([shift, shift, shift + 2.0 * scale], [shift; 3])
            .with_field_of_view(std::f64::consts::FRAC_PI_2)
    };
    let mesh = |scale: f32, shift: f32| {
        let positions: Vec<_> =
            square(0.0).positions().iter().map(|p| p.map(|x| x * scale + shift)).collect();
        Mesh::new(positions, square(0.0).triangles()).unwrap()
    };
    let expected = render(&mesh(1.0, 0.0), &camera(1.0, 0.0), &options(20)).unwrap();
    for (scale, shift) in [(2f32.powi(100), 0.0), (2f32.powi(-100), 0.0), (1.0, 65536.0)] {
        let picture = render(&mesh(scale, shift), &camera(scale.into(), shift.into()), &options(20)).unwrap();
        assert_eq!(picture, expected, "{scale} {shift}");
    }
}

#[test]
fn nothing_to_see_is_the_background() {
    let fade = options(4).with_background([0, 0, 0], [255, 255, 255]);
    for mesh in [Mesh::default(), Mesh::new([[0.0; 3]], [[0, 0, 0]]).unwrap()] {
        let picture = render(&mesh, &Camera::framing(&mesh, [0.0, 0.0, -1.0]), &fade).unwrap();
        assert!((1..4).all(|y| at(&picture, 0, y)[0] > at(&picture, 0, y - 1)[0]));
        assert!((0..4).all(|y| at(&picture, 3, y) == at(&picture, 0, y)));
    }
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let mesh = square(0.0);
    let options = RenderOptions::default().with_size(64, 48).with_edges(1.0);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&mesh, &Camera::framing(&mesh, [0.2, 0.1, -1.0]), &options).unwrap())
    };
    let alone = with(1);
    for threads in [2, 5] {
        assert_eq!(with(threads), alone);
    }
}

#[test]
fn pictures_stand_side_by_side() {
    let tall = render(&square(0.0), &above(), &options(6)).unwrap();
    let low = render(&square(0.0), &above(), &options(6).with_size(4, 3)).unwrap();
    let both = Picture::beside(&[tall.clone(), low.clone()]);
    assert_eq!((both.width(), both.height()), (10, 6));
    for y in 0..6 {
        assert!((0..6).all(|x| at(&both, x, y) == at(&tall, x, y)));
        assert!((0..4).all(|x| at(&both, 6 + x, y) == if y < 3 { at(&low, x, y) } else { [255; 3] }));
    }
    assert_eq!(both.to_rgb_bytes().len(), 3 * 60);
    assert_eq!(both.rgb_bytes()[..3], at(&both, 0, 0));
    assert!(Picture::beside(&[]).pixels().is_empty());
}

#[test]
fn what_makes_no_picture_is_refused() {
    let mesh = square(0.0);
    let refused = |camera: Camera, options: RenderOptions| render(&mesh, &camera, &options).unwrap_err();
    for (width, height) in [(0, 5), (5, 0), (20_000, 5), (5, usize::MAX)] {
        let error = refused(above(), options(1).with_size(width, height));
        assert!(
            matches!(error, QualityError::PictureSize { width: w, height: h, .. } if (w, h) == (width, height))
        );
    }
    for camera in [
        Camera::new([0.0; 3], [0.0; 3]),
        Camera::new([f64::NAN; 3], [0.0; 3]),
        Camera::new([0.0; 3], [f64::INFINITY; 3]),
        above().with_field_of_view(0.0),
        above().with_field_of_view(4.0),
        above().with_field_of_view(f64::NAN),
    ] {
        assert!(matches!(refused(camera, options(4)), QualityError::Camera { .. }));
    }
    let few = |colours| refused(above(), options(4).with_colours(colours));
    assert_eq!(
        few(Colours::PerVertex(vec![[0; 3]])),
        QualityError::ColourCount { what: "vertices", found: 1, expected: 4 }
    );
    assert_eq!(
        few(Colours::PerTriangle(vec![])),
        QualityError::ColourCount { what: "triangles", found: 0, expected: 2 }
    );
}

#[test]
fn the_sequential_scale_rises_in_lightness() {
    let lightness = |[r, g, b]: [u8; 3]| 0.3 * f32::from(r) + 0.59 * f32::from(g) + 0.11 * f32::from(b);
    let scale: Vec<[u8; 3]> = (0..=256).map(|i| palette::sequential(i as f32 / 256.0)).collect();
    assert!(scale.windows(2).all(|pair| lightness(pair[0]) <= lightness(pair[1]) + 0.75));
    assert_eq!((palette::sequential(-3.0), palette::sequential(7.0)), (scale[0], scale[256]));
    let coloured = palette::colours(&[2.0, 4.0, 3.0, f32::NAN, f32::INFINITY], [2.0, 4.0]);
    assert_eq!(coloured[..3], [scale[0], scale[256], scale[128]]);
    assert_eq!(coloured[4], scale[256]);
    assert!(!scale.contains(&coloured[3]));
    assert_eq!(palette::colours(&[1.0, 2.0], [1.0, 1.0]), [scale[0], scale[256]]);
    assert_ne!(palette::categorical(0), palette::categorical(1));
}
