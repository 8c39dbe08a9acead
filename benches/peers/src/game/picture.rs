//! What is seen of a difference: pictures of both meshes from twelve sides, with a checker on the texture and lit by the
//! vertices' normals, compared pixel by pixel.
//!
//! ```text
//!     twelve corners of an icosahedron     orthographic, one frame for both meshes, 4 samples a pixel
//!     grey = 255 * checker(uv) * light     checker: 1 or 0.5, cells of 1/32 of the diagonal on average
//!                                          light:   0.2 + 0.8 (1 + n.l) / 2, from the left, above and in front
//!     times the vertices' colour and the material's; black where there is nothing
//!     difference = mean over the pixels that show either mesh, and over red, green and blue, levels of 255
//! ```
//!
//! Both sides of a triangle are seen; the far side has its normals turned. Of coincident triangles the one that faces
//! the eye counts.

use multires::mesh::{Mesh, names};
use multires::quality::palette;

use super::model::{floats, uv_area};

type V3 = [f64; 3];

/// Pixels on a side.
pub(crate) const SIDE: usize = 192;
/// Samples along a pixel's side.
const FINE: usize = 2;
/// Cells of the checker along the diagonal.
const CELLS: f64 = 32.0;
/// Depth by which a triangle that faces away loses against one that does not, in parts of the frame.
const BEHIND: f64 = 1e-4;

/// Pictures of a mesh from all sides, to compare others with.
pub(crate) struct Pictures {
    frame: Frame,
    views: Vec<View>,
}

/// What all pictures have in common.
struct Frame {
    middle: V3,
    /// Half the side of a picture, object units.
    half: f64,
    /// Cells of the checker along one unit of a texture coordinate.
    cells: f64,
}

/// One picture: sums of `FINE * FINE` samples, and how many samples show the mesh.
pub(crate) struct View {
    pub colour: Vec<[u16; 3]>,
    pub covered: Vec<u8>,
}

impl Pictures {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let [low, high] = mesh.bounds().unwrap_or([[0.0; 3], [1.0; 3]]);
        let middle = [0, 1, 2].map(|i| 0.5 * (f64::from(low[i]) + f64::from(high[i])));
        let half = (mesh.diagonal() * 0.51).max(f64::MIN_POSITIVE);
        let cells = units_per_uv(mesh) * CELLS / mesh.diagonal().max(f64::MIN_POSITIVE);
        let frame = Frame { middle, half, cells };
        let views = directions().iter().map(|&from| frame.draw(mesh, from)).collect();
        Self { frame, views }
    }

    /// Mean difference over the pixels that show either mesh, levels of 255.
    pub(crate) fn difference(&self, level: &Mesh) -> f64 {
        let (mut sum, mut pixels) = (0.0, 0u64);
        for (view, &from) in self.views.iter().zip(&directions()) {
            let other = self.frame.draw(level, from);
            for pixel in 0..SIDE * SIDE {
                if view.covered[pixel] + other.covered[pixel] > 0 {
                    let apart = |i: usize| view.colour[pixel][i].abs_diff(other.colour[pixel][i]);
                    sum += f64::from(apart(0)) + f64::from(apart(1)) + f64::from(apart(2));
                    pixels += 1;
                }
            }
        }
        sum / (3 * FINE * FINE) as f64 / pixels.max(1) as f64
    }

    /// The picture of another mesh, in the frame of the first, as rows of red, green and blue.
    pub(crate) fn picture(&self, mesh: &Mesh, view: usize) -> Vec<u8> {
        let drawn = self.frame.draw(mesh, directions()[view]);
        let mean = |sum: u16| (sum / (FINE * FINE) as u16) as u8;
        drawn.colour.iter().flat_map(|c| c.map(mean)).collect()
    }
}

/// Object units that one unit of the texture coordinate covers, on average over the area; 0 without a texture.
pub(crate) fn units_per_uv(mesh: &Mesh) -> f64 {
    let Some(uv) = floats(mesh, names::UV, 2) else { return 0.0 };
    let (mut surface, mut texture) = (0.0, 0.0);
    for &t in mesh.triangles() {
        surface += twice_area(mesh, t);
        texture += uv_area(uv, t).abs();
    }
    if texture > 0.0 { (surface / texture).sqrt() } else { 0.0 }
}

/// Twice a triangle's area.
pub(crate) fn twice_area(mesh: &Mesh, triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| mesh.positions()[v as usize].map(f64::from));
    length(cross(minus(b, a), minus(c, a)))
}

/// The corners of an icosahedron.
fn directions() -> [V3; 12] {
    let long = (1.0 + 5f64.sqrt()) / 2.0;
    let mut all = [[0.0; 3]; 12];
    for (i, direction) in all.iter_mut().enumerate() {
        let sign = |bit: usize| if i >> bit & 1 == 1 { -1.0 } else { 1.0 };
        let axis = i / 4;
        direction[axis] = sign(0);
        direction[(axis + 1) % 3] = sign(1) * long;
        *direction = unit(*direction);
    }
    all
}

impl Frame {
    /// Draws a mesh as seen from that direction.
    fn draw(&self, mesh: &Mesh, from: V3) -> View {
        let fine = SIDE * FINE;
        let right = unit(cross(if from[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }, from));
        let axes = [right, cross(from, right), from];
        let place = |p: &[f32; 3]| {
            let offset = minus(p.map(f64::from), self.middle);
            let [x, y, z] = axes.map(|axis| dot(axis, offset) / self.half);
            [(x + 1.0) * 0.5 * fine as f64, (1.0 - y) * 0.5 * fine as f64, z]
        };
        let places: Vec<V3> = mesh.positions().iter().map(place).collect();
        let mut nearest = vec![(f64::NEG_INFINITY, u32::MAX, [0f32; 2]); fine * fine];
        for (number, t) in mesh.triangles().iter().enumerate() {
            rasterise(t.map(|v| places[v as usize]), number as u32, fine, &mut nearest);
        }
        let shade = Shade::new(mesh, self.cells, axes);
        let mut view = View { colour: vec![[0; 3]; SIDE * SIDE], covered: vec![0; SIDE * SIDE] };
        for (sample, &(_, triangle, weights)) in nearest.iter().enumerate() {
            if triangle != u32::MAX {
                let pixel = sample / fine / FINE * SIDE + sample % fine / FINE;
                let colour = shade.colour(triangle, weights.map(f64::from));
                (0..3).for_each(|i| view.colour[pixel][i] += u16::from(colour[i]));
                view.covered[pixel] += 1;
            }
        }
        view
    }
}

/// Puts a triangle into the samples where it is the nearest to the eye: its depth, its number, and the weights of its
/// second and third corners.
fn rasterise([a, b, c]: [V3; 3], number: u32, fine: usize, nearest: &mut [(f64, u32, [f32; 2])]) {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 {
        return;
    }
    // Rows run down, so a triangle that faces the eye runs clockwise.
    let bias = if area < 0.0 { 0.0 } else { BEHIND };
    let span = |i: usize| {
        let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
        (low - 0.5).ceil().max(0.0) as usize..((high - 0.5).floor() + 1.0).clamp(0.0, fine as f64) as usize
    };
    let columns = span(0);
    for row in span(1) {
        let y = row as f64 + 0.5 - a[1];
        for column in columns.clone() {
            let x = column as f64 + 0.5 - a[0];
            let second = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area;
            let third = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area;
            if second < 0.0 || third < 0.0 || second + third > 1.0 {
                continue;
            }
            let depth = a[2] + (b[2] - a[2]) * second + (c[2] - a[2]) * third - bias;
            let sample = &mut nearest[row * fine + column];
            if depth > sample.0 {
                *sample = (depth, number, [second as f32, third as f32]);
            }
        }
    }
}

/// What a point of a mesh looks like.
struct Shade<'a> {
    mesh: &'a Mesh,
    normals: Option<&'a [f32]>,
    uv: Option<&'a [f32]>,
    colours: Option<(&'a [f32], usize)>,
    cells: f64,
    light: V3,
    eye: V3,
}

impl<'a> Shade<'a> {
    fn new(mesh: &'a Mesh, cells: f64, [right, up, eye]: [V3; 3]) -> Self {
        let light = unit([0, 1, 2].map(|i| 2.0 * up[i] + 2.0 * eye[i] - right[i]));
        let colours = mesh.attribute(names::COLOR).and_then(|a| Some((a.as_floats()?, a.width())));
        Self {
            mesh,
            normals: floats(mesh, names::NORMAL, 3),
            uv: floats(mesh, names::UV, 2).filter(|_| cells > 0.0),
            colours,
            cells,
            light,
            eye,
        }
    }

    fn colour(&self, triangle: u32, [second, third]: [f64; 2]) -> [u8; 3] {
        let corners = self.mesh.triangles()[triangle as usize];
        let weights = [1.0 - second - third, second, third];
        let [a, b, c] = corners.map(|v| self.mesh.positions()[v as usize].map(f64::from));
        let facet = unit(cross(minus(b, a), minus(c, a)));
        let own = self.normals.map(|normals| unit(blend(normals, 3, corners, weights)));
        let mut normal = own.filter(|n| dot(*n, *n) > 0.5).unwrap_or(facet);
        if dot(facet, self.eye) < 0.0 {
            normal = normal.map(|x| -x);
        }
        let checker = self.uv.map_or(1.0, |uv| {
            let [u, v, _] = blend(uv, 2, corners, weights).map(|x| (x * self.cells).floor());
            if (u + v).rem_euclid(2.0) < 0.5 { 1.0 } else { 0.5 }
        });
        let light = checker * (0.2 + 0.4 * (1.0 + dot(normal, self.light)));
        let tint = match self.colours {
            Some((values, width)) if width >= 3 => blend(values, width, corners, weights),
            _ => [1.0; 3],
        };
        let material = self.mesh.materials().get(triangle as usize);
        let base = material.map_or([235; 3], |&id| palette::categorical(id));
        [0, 1, 2].map(|i| (f64::from(base[i]) * tint[i] * light).clamp(0.0, 255.0).round() as u8)
    }
}

/// The first three scalars of an attribute at a point of a triangle; those that are missing are 0.
pub(crate) fn blend(values: &[f32], width: usize, corners: [u32; 3], weights: [f64; 3]) -> V3 {
    let mut sum = [0.0; 3];
    for (v, weight) in corners.iter().zip(weights) {
        for (sum, &value) in sum.iter_mut().zip(&values[*v as usize * width..][..width]) {
            *sum += weight * f64::from(value);
        }
    }
    sum
}

pub(crate) fn minus(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}

/// Of length 1; zero for what has no length.
pub(crate) fn unit(a: V3) -> V3 {
    let length = length(a);
    if length > 0.0 { a.map(|x| x / length) } else { [0.0; 3] }
}
