//! Pictures of a view-dependent mesh: what the camera sees, and beside it the same triangles from outside, with the frustum.
//!
//! ```text
//!     .----------------.  .----------------.
//!     |   the view     |  |  from outside  |      blue: in the picture and towards the eye
//!     |   of a frame   |  |     \          |      grey: in the picture, facing away
//!     |                |  |  eye <  model  |      sand: outside of the picture
//!     '----------------'  '-----/----------'
//! ```

#[path = "../../src/bin/multires/lettering.rs"]
mod lettering;

use std::error::Error;

use glam::{DQuat, DVec3};
use image::{Rgb, RgbImage};
use multires::mesh::Mesh;
use multires::quality::{Camera, Colours, Picture, RenderOptions, Shading, render};

use super::flight::{DEGREES, Pose};

/// Pixels of a picture, and between and under pictures.
pub const SIZE: [usize; 2] = [512, 288];
const GAP: usize = 8;
const CAPTION: usize = 30;
const LEGEND: usize = 38;
const PAPER: [u8; 3] = [238, 238, 238];
const INK: [u8; 3] = [52, 58, 68];
const SEEN: [u8; 3] = [112, 160, 214];
const AWAY: [u8; 3] = [206, 209, 214];
const OUTSIDE: [u8; 3] = [232, 196, 132];
const FRUSTUM: [u8; 3] = [208, 52, 44];

/// One frame: the triangles drawn, the camera, and what to write below.
pub struct Shot {
    pub mesh: Mesh,
    pub pose: Pose,
    pub captions: [String; 2],
}

/// All frames, one below the other, and a legend at the foot.
pub fn strip(shots: &[Shot]) -> Result<RgbImage, Box<dyn Error>> {
    let row = SIZE[1] + CAPTION;
    let size = [2 * SIZE[0] + 3 * GAP, shots.len() * row + GAP + LEGEND];
    let mut sheet = RgbImage::from_pixel(size[0] as u32, size[1] as u32, Rgb(PAPER));
    for (number, shot) in shots.iter().enumerate() {
        let top = GAP + number * row;
        let pictures = [view(shot)?, outside(shot)?];
        for (column, (pixels, caption)) in pictures.iter().zip(&shot.captions).enumerate() {
            let left = GAP + column * (SIZE[0] + GAP);
            for (i, &pixel) in pixels.iter().enumerate() {
                let at = [left + i % SIZE[0], top + i / SIZE[0]].map(|n| n as u32);
                sheet.put_pixel(at[0], at[1], Rgb(pixel));
            }
            let middle = [left + SIZE[0] / 2, top + SIZE[1] + CAPTION / 2].map(|n| n as f32);
            lettering::write(&mut sheet, caption, middle, INK);
        }
    }
    legend(&mut sheet, [size[0] as f32, (size[1] - LEGEND / 2) as f32]);
    Ok(sheet)
}

fn legend(sheet: &mut RgbImage, [width, middle]: [f32; 2]) {
    let entries =
        [(SEEN, "in view"), (AWAY, "facing away"), (OUTSIDE, "outside the view"), (FRUSTUM, "frustum")];
    const SWATCH: f32 = 18.0;
    let wide = |text: &str| SWATCH + 8.0 + lettering::length(text);
    let all: f32 = entries.iter().map(|(_, text)| wide(text) + 30.0).sum::<f32>() - 30.0;
    let mut x = (width - all) * 0.5;
    for (colour, text) in entries {
        for py in 0..SWATCH as u32 {
            for px in 0..SWATCH as u32 {
                let at = [x as u32 + px, (middle - SWATCH * 0.5) as u32 + py];
                if let Some(pixel) = sheet.get_pixel_mut_checked(at[0], at[1]) {
                    *pixel = Rgb(colour);
                }
            }
        }
        let text_middle = x + SWATCH + 8.0 + lettering::length(text) * 0.5;
        lettering::write(sheet, text, [text_middle, middle], INK);
        x += wide(text) + 30.0;
    }
}

fn options(edges: f32) -> RenderOptions {
    RenderOptions::default()
        .with_size(SIZE[0], SIZE[1])
        .with_shading(Shading::Flat)
        .with_background([255; 3], [255; 3])
        .with_occlusion_rays(0)
        .with_edges(edges)
}

/// What the camera of the frame sees.
fn view(shot: &Shot) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
    let colours = match shot.mesh.materials() {
        [] => Colours::Uniform([150, 172, 200]),
        _ => Colours::Materials,
    };
    let pose = &shot.pose;
    let camera = Camera::new(pose.eye.to_array(), pose.target.to_array())
        .with_up(pose.up.to_array())
        .with_field_of_view(DEGREES.to_radians());
    Ok(render(&shot.mesh, &camera, &options(1.0).with_colours(colours))?.pixels().to_vec())
}

/// The same triangles from beside the camera, with its frustum.
fn outside(shot: &Shot) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
    let camera = beside(shot);
    let seen = colours(shot);
    let draw = |mesh: &Mesh, colours: &[[u8; 3]], edges: f32| {
        render(mesh, &camera, &options(edges).with_colours(Colours::PerTriangle(colours.to_vec())))
    };
    let tubes = frustum(shot, &camera);
    let with = joined(&shot.mesh, &tubes)?;
    let mut all = seen.clone();
    all.extend(tubes.triangles().iter().map(|_| FRUSTUM));
    let red = vec![FRUSTUM; tubes.triangles().len()];

    // Edges are drawn on the model alone; the frustum where it is in front of it, and faintly where it is behind.
    let pictures: [Picture; 4] = [
        draw(&shot.mesh, &seen, 1.0)?,
        draw(&shot.mesh, &seen, 0.0)?,
        draw(&with, &all, 0.0)?,
        draw(&tubes, &red, 0.0)?,
    ];
    let [edged, plain, both, alone] = pictures.each_ref().map(Picture::pixels);
    let pixel = |i: usize| {
        if both[i] != plain[i] {
            FRUSTUM
        } else if alone[i] != [255; 3] {
            std::array::from_fn(|k| ((3 * u16::from(edged[i][k]) + u16::from(FRUSTUM[k])) / 4) as u8)
        } else {
            edged[i]
        }
    };
    Ok((0..edged.len()).map(pixel).collect())
}

/// Per triangle a colour for where it is to the frame's camera.
fn colours(shot: &Shot) -> Vec<[u8; 3]> {
    let (mesh, pose) = (&shot.mesh, &shot.pose);
    let triangles = mesh.triangles().iter().map(|corners| {
        let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        let inside = [a, b, c, (a + b + c) / 3.0].into_iter().any(|p| pose.sees(p));
        match (inside, (b - a).cross(c - a).dot(pose.eye - a) > 0.0) {
            (false, _) => OUTSIDE,
            (true, false) => AWAY,
            (true, true) => SEEN,
        }
    });
    triangles.collect()
}

/// A camera that looks at the model and the eye from the side and from above, from as near as shows both.
fn beside(shot: &Shot) -> Camera {
    let (mesh, pose) = (&shot.mesh, &shot.pose);
    let [low, high] = mesh.bounds().unwrap_or([[-1.0; 3], [1.0; 3]]);
    let size = mesh.diagonal().max(f64::MIN_POSITIVE);
    let away = pose.eye - pose.target;
    // An eye far away would leave nothing of the model: then its frustum comes in from beyond the picture.
    let mut points = vec![pose.target + away.clamp_length_max(0.5 * size)];
    points.extend((0..8).map(|i| {
        let corner = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        // Nearer than the corners of the box, where a model seldom is.
        pose.target.lerp(DVec3::from_array(std::array::from_fn(|axis| f64::from(corner(axis)))), 0.8)
    }));
    let level = away - pose.up * away.dot(pose.up);
    let around = DQuat::from_axis_angle(pose.up, 105_f64.to_radians()) * level.normalize_or(DVec3::X);
    let direction = (around + pose.up * 0.6).normalize_or(DVec3::Y);

    // Straight on, the middle of all; then nearer while all is inside.
    let flat = Pose { eye: pose.target + direction, target: pose.target, up: pose.up };
    let [right, up, _] = flat.axes();
    let span = |axis: DVec3| {
        let along = points.iter().map(|p| (*p - pose.target).dot(axis));
        axis * 0.5 * (along.clone().fold(f64::MAX, f64::min) + along.fold(f64::MIN, f64::max))
    };
    let target = pose.target + span(right) + span(up);
    let slope = 0.94 * (Camera::new([0.0; 3], [1.0; 3]).field_of_view * 0.5).tan();
    let wide = slope * SIZE[0] as f64 / SIZE[1] as f64;
    let fits = |far: f64| {
        let at = Pose { eye: target + direction * far, target, up: pose.up };
        points.iter().all(|&p| {
            let p = at.to_eye(p);
            p.x.abs() <= p.z * wide && p.y.abs() <= p.z * slope
        })
    };
    let (mut near, mut far) = (0.0, 20.0 * size);
    for _ in 0..40 {
        let middle = 0.5 * (near + far);
        (near, far) = if fits(middle) { (near, middle) } else { (middle, far) };
    }
    Camera::new((target + direction * far).to_array(), target.to_array()).with_up(pose.up.to_array())
}

/// The four edges of the frustum as tubes, some two pixels wide wherever they are.
fn frustum(shot: &Shot, camera: &Camera) -> Mesh {
    let pose = &shot.pose;
    let [right, up, forward] = pose.axes();
    let [wide, high] = Pose::slopes();
    let depth = (pose.eye - pose.target).length() + 3.0 * shot.mesh.diagonal();
    let far = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| pose.eye + (forward + right * (x * wide) + up * (y * high)) * depth);
    let eye = DVec3::from_array(camera.eye);
    let pixel = 2.0 * (camera.field_of_view * 0.5).tan() / SIZE[1] as f64;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut tube = |from: DVec3, to: DVec3| {
        // In short pieces, each as wide as its distance asks for.
        const PIECES: u32 = 64;
        let (side, across) = (to - from).normalize_or(DVec3::X).any_orthonormal_pair();
        let first = positions.len() as u32;
        for piece in 0..=PIECES {
            let at = from.lerp(to, f64::from(piece) / f64::from(PIECES));
            let radius = at.distance(eye) * pixel;
            for (x, y) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
                positions.push((at + (side * x + across * y) * radius).as_vec3().to_array());
            }
        }
        for ring in 0..PIECES {
            for k in 0..4 {
                let [a, b] = [first + 4 * ring + k, first + 4 * ring + (k + 1) % 4];
                triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
            }
        }
    };
    (0..4).for_each(|k| tube(pose.eye, far[k]));
    // A frame a little way out, to see which way is up.
    let near = far.map(|corner| pose.eye.lerp(corner, (0.12 * shot.mesh.diagonal() / depth).min(1.0)));
    (0..4).for_each(|k| tube(near[k], near[(k + 1) % 4]));
    Mesh::new(positions, triangles).unwrap_or_default()
}

fn joined(a: &Mesh, b: &Mesh) -> Result<Mesh, multires::MeshError> {
    let first = a.positions().len() as u32;
    let positions = [a.positions(), b.positions()].concat();
    let moved = b.triangles().iter().map(|corners| corners.map(|v| v + first));
    let triangles: Vec<[u32; 3]> = a.triangles().iter().copied().chain(moved).collect();
    Mesh::new(positions, triangles)
}
