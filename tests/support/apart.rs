//! How far a level lies from its input by samples, both ways, on the surface and along curves: by nothing but the two
//! meshes and which vertex stands for which, to hold against what a sequence says of itself.

use std::collections::BTreeMap;

use multires::mesh::{Mesh, Topology};
use multires::quality::{DistanceOptions, Surface};
use multires::simplify::{CollapseSequence, Origin};

type Point = [f64; 3];
type Segment = [Point; 2];

/// The largest sampled distances between an input and a level of it, object units.
#[derive(Debug, Clone, Copy)]
pub struct Apart {
    pub surface: f64,
    pub curves: f64,
}

impl Apart {
    pub fn largest(self) -> f64 {
        self.surface.max(self.curves)
    }
}

/// Samples along each edge of a curve.
const ALONG: usize = 6;

/// An input that is prepared once.
pub struct Input<'a> {
    mesh: &'a Mesh,
    surface: Surface<'a>,
    /// Vertices at the ends of the edges of its curves.
    curves: Vec<[u32; 2]>,
}

impl<'a> Input<'a> {
    /// `cosine`: the edges of triangles whose normals are less alike than this are curves too.
    pub fn new(mesh: &'a Mesh, cosine: f64) -> Self {
        Self { mesh, surface: Surface::new(mesh).unwrap(), curves: curves(mesh, cosine) }
    }

    /// The level after so many steps, against the input.
    pub fn apart(&self, sequence: &CollapseSequence, steps: usize) -> Apart {
        let level = sequence.extract(self.mesh, steps);
        let surface = match Surface::new(&level) {
            Ok(level) => {
                let options = DistanceOptions::default().with_samples(4_000);
                self.surface.distance(&level, &options).unwrap().hausdorff()
            }
            Err(_) => 0.0,
        };
        Apart { surface, curves: self.curves_apart(sequence, steps) }
    }

    /// The curves of the level after so many steps, against the input's.
    pub fn curves_apart(&self, sequence: &CollapseSequence, steps: usize) -> f64 {
        let level = sequence.extract(self.mesh, steps);
        let position = |vertex: u32| match sequence.origin(vertex) {
            Origin::Input(v) => point(self.mesh.positions()[v as usize]),
            Origin::Blend(new) => point(new.position),
            _ => unreachable!(),
        };
        let to = sequence.representatives(steps);
        let ends = |edge: &[u32; 2]| edge.map(&position);
        let input: Vec<Segment> = self.curves.iter().map(ends).collect();
        let mut image: Vec<Segment> =
            self.curves.iter().map(|edge| edge.map(|v| position(to[v as usize]))).collect();
        image.sort_by(|a, b| a.partial_cmp(b).unwrap());
        image.dedup();
        // Whatever is a border of the level or lies between two of its materials must lie on a curve of the input.
        let mut own: Vec<Segment> = curves(&level, -2.0)
            .iter()
            .map(|edge| edge.map(|v| point(level.positions()[v as usize])))
            .collect();
        own.extend(&image);
        farthest(&input, &image).max(farthest(&own, &input))
    }
}

fn point(p: [f32; 3]) -> Point {
    p.map(f64::from)
}

/// The largest distance of a sample on `from` from the nearest of `to`; 0 where there are none.
fn farthest(from: &[Segment], to: &[Segment]) -> f64 {
    if to.is_empty() {
        return 0.0;
    }
    let (mut worst, mut before): (f64, usize) = (0.0, 0);
    for [a, b] in from {
        for i in 0..=ALONG {
            let share = i as f64 / ALONG as f64;
            let p: Point = std::array::from_fn(|k| a[k] + share * (b[k] - a[k]));
            // What was nearest to the place before may be near enough.
            let mut nearest = squared_distance(p, &to[before]);
            for (i, segment) in to.iter().enumerate() {
                if nearest <= worst * worst {
                    break;
                }
                let distance = squared_distance(p, segment);
                if distance < nearest {
                    (nearest, before) = (distance, i);
                }
            }
            worst = worst.max(nearest.sqrt());
        }
    }
    worst
}

fn squared_distance(p: Point, &[a, b]: &Segment) -> f64 {
    let sub = |p: Point, q: Point| -> Point { std::array::from_fn(|i| p[i] - q[i]) };
    let dot = |p: Point, q: Point| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (ab, ap) = (sub(b, a), sub(p, a));
    let length = dot(ab, ab);
    let share = if length > 0.0 { (dot(ap, ab) / length).clamp(0.0, 1.0) } else { 0.0 };
    let off: Point = std::array::from_fn(|i| ap[i] - share * ab[i]);
    dot(off, off)
}

/// Whether no attribute of two vertices differs by more than 16 bits can tell apart, a few times over.
fn alike(mesh: &Mesh, v: u32, w: u32) -> bool {
    mesh.attributes().iter().all(|attribute| {
        let Some(values) = attribute.as_floats() else { return true };
        let of = |v: u32| &values[v as usize * attribute.width()..][..attribute.width()];
        of(v).iter().zip(of(w)).all(|(a, b)| (a - b).abs() <= 1e-4 * a.abs().max(1.0))
    })
}

/// The edges that are borders, non-manifold, seams, between two materials, or between triangles whose normals have a lower
/// cosine.
pub fn curves(mesh: &Mesh, cosine: f64) -> Vec<[u32; 2]> {
    let topology = Topology::new(mesh);
    let (point_of, wedge_of) = (topology.point_of(), topology.wedge_of());
    /// A triangle on an edge: its vertices there, lower point first, its material, its normal, and which way it runs.
    struct Side {
        vertices: [u32; 2],
        material: u32,
        normal: Point,
        forward: bool,
    }
    let mut edges: BTreeMap<[u32; 2], Vec<Side>> = BTreeMap::new();
    // Triangles over the same three points are one sheet.
    let mut sheets = std::collections::BTreeSet::new();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let points = triangle.map(|v| point_of[v as usize]);
        if points[0] == points[1] || points[1] == points[2] || points[2] == points[0] {
            continue;
        }
        let mut sheet = points;
        sheet.sort_unstable();
        if !sheets.insert(sheet) {
            continue;
        }
        let [a, b, c] = triangle.map(|v| point(mesh.positions()[v as usize]));
        let (u, v): (Point, Point) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for i in 0..3 {
            let (from, to) = (i, (i + 1) % 3);
            let forward = points[from] < points[to];
            let (low, high) = if forward { (from, to) } else { (to, from) };
            edges.entry([points[low], points[high]]).or_default().push(Side {
                vertices: [triangle[low], triangle[high]],
                material: mesh.materials().get(t).copied().unwrap_or(0),
                normal,
                forward,
            });
        }
    }
    let is_curve = |sides: &Vec<Side>| {
        let [a, b] = &sides[..] else { return true };
        let same_wedge =
            |&(v, w): &(u32, u32)| wedge_of[v as usize] == wedge_of[w as usize] || alike(mesh, v, w);
        let same_wedges = a.vertices.into_iter().zip(b.vertices).all(|pair| same_wedge(&pair));
        let dot: f64 = (0..3).map(|i| a.normal[i] * b.normal[i]).sum();
        let length = |n: Point| n.iter().map(|x| x * x).sum::<f64>().sqrt();
        let facing = if a.forward == b.forward { -1.0 } else { 1.0 };
        a.material != b.material
            || !same_wedges
            || facing * dot < cosine * length(a.normal) * length(b.normal)
    };
    edges.into_values().filter(is_curve).map(|sides| sides[0].vertices).collect()
}
