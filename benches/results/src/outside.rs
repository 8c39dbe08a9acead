//! Pictures of a view-dependent mesh: what the camera sees, and the same triangles from outside, with the frustum.
//!
//! ```text
//!     .----------------.  .----------------.
//!     |   the view     |  |  from outside  |      blue: in the picture and towards the eye
//!     |   of a frame   |  |     \          |      grey: in the picture, facing away
//!     |                |  |  eye <  model  |      sand: outside of the picture
//!     '----------------'  '-----/----------'
//! ```

use std::error::Error;

use glam::{DQuat, DVec3};
use multires::mesh::Mesh;
use multires::quality::{Camera, Colours, Picture, RenderOptions, Shading, render};

use super::flight::{DEGREES, Pose};
use super::sheet::SIZE;

const SEEN: [u8; 3] = [112, 160, 214];
const AWAY: [u8; 3] = [206, 209, 214];
const OUTSIDE: [u8; 3] = [232, 196, 132];
const FRUSTUM: [u8; 3] = [208, 52, 44];
/// What the colours mean.
pub const LEGEND: [([u8; 3], &str); 4] =
    [(SEEN, "in view"), (AWAY, "facing away"), (OUTSIDE, "outside the view"), (FRUSTUM, "frustum")];

/// One frame: the triangles drawn and the camera.
pub struct Shot {
    pub mesh: Mesh,
    pub pose: Pose,
}

fn options(edges: f32) -> RenderOptions {
    RenderOptions::default()
        .with_size(SIZE[0], SIZE[1])
        .with_shading(Shading::Flat)
        .with_background([255; 3], [255; 3])
        .with_occlusion_rays(0)
        .with_edges(edges)
}

/// The camera of a pose.
pub fn camera(pose: &Pose) -> Camera {
    Camera::new(pose.eye.to_array(), pose.target.to_array())
        .with_up(pose.up.to_array())
        .with_field_of_view(DEGREES.to_radians())
}

/// What the camera of the frame sees, with edges of this width in pixels.
pub fn view(shot: &Shot, edges: f32) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
    let colours = match shot.mesh.materials() {
        [] => Colours::Uniform([150, 172, 200]),
        _ => Colours::Materials,
    };
    let options = options(edges).with_colours(colours);
    Ok(render(&shot.mesh, &camera(&shot.pose), &options)?.pixels().to_vec())
}

/// The same triangles from beside the camera, with its frustum.
pub fn outside(shot: &Shot) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
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
