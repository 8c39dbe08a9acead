//! Promise: attribute deviations cost what they are documented to cost, steer the collapses towards levels that look
//! like the input, and leave values that nothing blended bit for bit.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use crate::meshes::*;
use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::metric::{
    AttributeQuadric, Attributes, Dependence, MetricEvent, MetricProperties, Optimum, Quadric, Substitutions,
    WithAttributes,
};
use multires::simplify::{
    AttributeWeights, CollapseSequence, ErrorMetric, Origin, Pair, Placement, Simplifier, WorkingSurface,
};

const PLACEMENTS: [Placement; 4] =
    [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal];

fn steps(sequence: &CollapseSequence) -> Vec<Vec<[u32; 2]>> {
    (0..sequence.len()).map(|s| sequence.substitutions(s).to_vec()).collect()
}

/// A flat grid whose values are `f(u, v)`.
fn painted(n: u32, f: impl Fn(f32, f32) -> f32) -> Mesh {
    let mesh = grid(n, n, |_, _| 0.0);
    let values: Vec<[f32; 1]> = mesh.positions().iter().map(|p| [f(p[0], p[1])]).collect();
    mesh.with_attribute(Attribute::floats("heat", &values)).unwrap()
}

/// A metric of no opinion.
struct Nothing;

impl ErrorMetric for Nothing {
    fn cost(&self, _: &WorkingSurface, _: Pair, _: [f32; 3]) -> f32 {
        0.0
    }
    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("nothing").with_dependence(Dependence::Both)
    }
}

/// One linear function over one input triangle.
#[derive(Clone)]
struct Plane {
    double_area: f64,
    origin: [f32; 3],
    gradient: [f64; 3],
    value: f64,
}

/// Compares the attribute metric with the plain sum over all triangles merged so far, in double precision.
struct Checked {
    inner: WithAttributes<Nothing>,
    /// Values of every vertex times weight, in the inner frame; new ones are appended.
    values: Vec<Vec<f64>>,
    unit: f64,
    planes: Vec<Vec<Vec<Plane>>>,
    compared: Arc<Mutex<usize>>,
}

impl Checked {
    fn expected(&self, vertex: u32, x: [f32; 3], values: &[f64]) -> f64 {
        let planes = self.planes[vertex as usize].iter().zip(values);
        planes
            .flat_map(|(list, value)| {
                list.iter().map(move |p| {
                    let off = dot(p.gradient, sub(x, p.origin)) + p.value - value;
                    p.double_area * off * off
                })
            })
            .sum()
    }
}

impl Checked {
    fn sum_up(&mut self, surface: &WorkingSurface) {
        let stride = self.values[0].len();
        let scale = self.unit * surface.frame().scale();
        self.values.iter_mut().flatten().for_each(|x| *x *= scale);
        self.planes = vec![vec![Vec::new(); stride]; self.values.len()];
        for t in 0..surface.triangle_count() as u32 {
            let Some(points) = surface.triangle(t) else { continue };
            let [p, q, r] = points.map(|v| surface.position(v));
            let n = normal([p, q, r]);
            let wedges = surface.corner_vertices(t);
            for s in 0..stride {
                let [a, b, c] = wedges.map(|v| self.values[v as usize][s]);
                let (e, f) = (cross(sub(r, p), n), cross(n, sub(q, p)));
                let gradient =
                    std::array::from_fn(|i| ((b - a) * e[i] + (c - a) * f[i]) / dot(n, n).max(1e-300));
                let plane = Plane { double_area: dot(n, n).sqrt(), origin: p, gradient, value: a };
                wedges.iter().for_each(|&v| self.planes[v as usize][s].push(plane.clone()));
            }
        }
    }

    fn compare(&mut self, surface: &WorkingSurface, pair: Pair, position: [f32; 3], s: Substitutions<'_>) {
        for vertex in (s.first_new..).take(s.new_vertices.len()) {
            // The value of least deviation: the mean of what every triangle's plane says there, by area.
            let sources = || s.pairs.iter().filter(|p| p[1] == vertex).map(|p| p[0]);
            let best = (0..self.values[0].len()).map(|scalar| {
                let planes = || sources().flat_map(|v| &self.planes[v as usize][scalar]);
                let there = |p: &Plane| dot(p.gradient, sub(position, p.origin)) + p.value;
                let area: f64 = planes().map(|p| p.double_area).sum();
                planes().map(|p| p.double_area * there(p)).sum::<f64>() / area
            });
            self.values.push(best.collect());
            self.planes.push(vec![Vec::new(); self.values[0].len()]);
        }
        let targets: BTreeSet<u32> = s.pairs.iter().map(|p| p[1]).collect();
        let sources = s.pairs.iter().copied().chain(targets.iter().map(|&t| [t, t]));
        let expected: f64 =
            sources.map(|[from, to]| self.expected(from, position, &self.values[to as usize])).sum();
        let found = f64::from(self.inner.cost(surface, pair, position));
        assert!(
            (found - expected).abs() <= 1e-3 * expected + 1e-9,
            "{found} where {expected} is right, after {} steps",
            self.compared.lock().unwrap()
        );
        *self.compared.lock().unwrap() += 1;
        for &[from, to] in s.pairs {
            let moved = std::mem::take(&mut self.planes[from as usize]);
            self.planes[to as usize].iter_mut().zip(moved).for_each(|(list, more)| list.extend(more));
        }
    }
}

impl ErrorMetric for Checked {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self.inner.cost(surface, pair, position)
    }

    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        self.inner.costs_at_kept(surface, lost, kept, costs);
    }

    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        self.inner.optimum(surface, pair, attributes)
    }

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        match event {
            MetricEvent::Begin(_) => self.sum_up(surface),
            MetricEvent::Collapsing { pair, position, substitutions } => {
                self.compare(surface, pair, position, substitutions);
            }
            _ => {}
        }
        self.inner.update(surface, event);
    }

    fn properties(&self) -> MetricProperties<'_> {
        MetricProperties::named("checked").with_dependence(Dependence::Both)
    }
}

#[test]
fn costs_are_the_sum_over_all_merged_triangles() {
    let wavy = |u: f32, v: f32| 0.1 * (9.0 * u).sin() * (7.0 * v).cos();
    let meshes = [seamed_grid(6, 12, wavy), tube(14, 9), charted_torus()];
    for mesh in meshes {
        let uv = mesh.attribute(names::UV).unwrap().as_floats().unwrap();
        for placement in PLACEMENTS {
            let compared = Arc::new(Mutex::new(0));
            let weight = 0.3f32;
            let metric = Checked {
                inner: WithAttributes::with(Nothing, &Attributes::new(&mesh).uv(weight)).unwrap(),
                values: uv
                    .chunks(2)
                    .map(|c| c.iter().map(|&x| f64::from(x) * f64::from(weight)).collect())
                    .collect(),
                unit: mesh.diagonal(),
                planes: Vec::new(),
                compared: compared.clone(),
            };
            let sequence = Simplifier::new().metric(metric).placement(placement).run(&mesh).unwrap();
            assert_eq!(*compared.lock().unwrap(), sequence.len());
            assert!(sequence.len() > 20);
        }
    }
}

/// A torus in two charts with coordinates that vary.
fn charted_torus() -> Mesh {
    let mesh = torus(12, 8);
    let count = mesh.positions().len() as u32;
    let positions = [mesh.positions(), mesh.positions()].concat();
    let triangles: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .enumerate()
        .map(|(i, t)| t.map(|v| if i < 96 { v } else { v + count }))
        .collect();
    let uv: Vec<[f32; 2]> = positions
        .iter()
        .enumerate()
        .map(|(i, p)| [p[0] * p[1] + (i / count as usize) as f32, (3.0 * p[2]).sin()])
        .collect();
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

#[test]
fn without_weights_it_is_the_metric_below() {
    let mesh = seamed_grid(8, 16, |u, v| 0.1 * (9.0 * u).sin() * (7.0 * v).cos());
    for placement in PLACEMENTS {
        let plain =
            Simplifier::new().attributes(AttributeWeights::Off).placement(placement).run(&mesh).unwrap();
        for attributes in
            [Attributes::new(&mesh), Attributes::new(&mesh).uv(0.0), Attributes::new(&mesh).normals(1.0)]
        {
            let metric = WithAttributes::with(Quadric::new(), &attributes).unwrap();
            let sequence = Simplifier::new().metric(metric).placement(placement).run(&mesh).unwrap();
            assert_eq!(steps(&sequence), steps(&plain));
        }
    }
}

/// On a flat sheet a value that is linear costs nothing; one that bends costs as a surface that bends.
#[test]
fn only_what_is_not_linear_counts() {
    let spread = |mesh: &Mesh| {
        let metric =
            WithAttributes::with(Quadric::new(), &Attributes::new(mesh).custom("heat", 0.1)).unwrap();
        let sequence = Simplifier::new().metric(metric).run(mesh).unwrap();
        let coarse = sequence.extract(mesh, sequence.steps_for_triangles(mesh.triangles().len() / 8));
        coarse.positions().iter().filter(|p| p[0] < 0.5).count() as f32 / coarse.positions().len() as f32
    };
    let bent = spread(&painted(32, |u, v| if u < 0.5 { (20.0 * u).sin() * (20.0 * v).sin() } else { u }));
    assert!(bent > 0.8, "{bent} of the vertices where the value bends");
}

/// Root mean square difference of a value between the input's vertices and a level of a flat mesh over the unit
/// square, looked up in the plane.
fn off(mesh: &Mesh, coarse: &Mesh, name: &str) -> f64 {
    let values = |m: &Mesh| m.attribute(name).unwrap().as_floats().unwrap().to_vec();
    let (fine, rough) = (values(mesh), values(coarse));
    let mut sum = 0.0;
    for (p, &expected) in mesh.positions().iter().zip(&fine) {
        let best = coarse
            .triangles()
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| coarse.positions()[v as usize]);
                let area = |a, b, c| normal([a, b, c])[2];
                let whole = area(a, b, c);
                let w = [area(*p, b, c) / whole, area(a, *p, c) / whole, area(a, b, *p) / whole];
                let value: f64 = (0..3).map(|i| w[i] * f64::from(rough[t[i] as usize])).sum();
                (w.into_iter().fold(f64::INFINITY, f64::min), value)
            })
            .max_by(|x, y| x.0.total_cmp(&y.0))
            .unwrap();
        sum += (best.1 - f64::from(expected)).powi(2);
    }
    (sum / fine.len() as f64).sqrt()
}

#[test]
fn values_come_out_closer() {
    let mesh = painted(40, |u, v| (-30.0 * ((u - 0.4).powi(2) + (v - 0.6).powi(2))).exp());
    for placement in PLACEMENTS {
        let weighed =
            WithAttributes::with(Quadric::new(), &Attributes::new(&mesh).custom("heat", 0.1)).unwrap();
        let blind =
            Simplifier::new().attributes(AttributeWeights::Off).placement(placement).run(&mesh).unwrap();
        let aware = Simplifier::new().placement(placement).metric(weighed).run(&mesh).unwrap();
        let at = |s: &CollapseSequence| off(&mesh, &s.extract(&mesh, s.steps_for_triangles(160)), "heat");
        let (blind, aware) = (at(&blind), at(&aware));
        assert!(aware < 0.5 * blind, "{aware} with, {blind} without, {placement:?}");
    }
}

/// Values that are not part of the mesh weigh the same as an attribute of the same values.
#[test]
fn plain_slices_weigh_as_attributes_do() {
    let mesh = painted(20, |u, v| (10.0 * u * v).sin());
    let slice = mesh.attribute("heat").unwrap().as_floats().unwrap();
    let run = |attributes: Attributes<'_>| {
        let metric = WithAttributes::with(Quadric::new(), &attributes).unwrap();
        steps(&Simplifier::new().metric(metric).run(&mesh).unwrap())
    };
    assert_eq!(
        run(Attributes::new(&mesh).values(slice, 1, 0.2)),
        run(Attributes::new(&mesh).custom("heat", 0.2))
    );
}

#[test]
fn only_new_normals_are_normalised() {
    let mesh = grid(14, 14, |u, v| 0.1 * (6.0 * u).sin() * (5.0 * v).sin());
    // Of other lengths than one.
    let normals: Vec<[f32; 3]> =
        mesh.positions().iter().enumerate().map(|(i, p)| [p[2], 0.3 * p[0], (i % 5) as f32 + 0.2]).collect();
    let mesh = mesh.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    for placement in PLACEMENTS {
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        let (mut kept, mut made) = (0, 0);
        for steps in [1, sequence.len() / 3, sequence.len() * 2 / 3, sequence.len()] {
            let coarse = sequence.extract(&mesh, steps);
            let (triangles, _) = sequence.triangles_at(&mesh, steps);
            let values: Vec<[f32; 3]> = rows(coarse.attribute(names::NORMAL).unwrap().as_floats().unwrap());
            for (t, own) in triangles.iter().zip(coarse.triangles()) {
                for (&vertex, &v) in t.iter().zip(own) {
                    let n = values[v as usize];
                    match sequence.origin(vertex) {
                        Origin::Input(i) => {
                            assert_eq!(n.map(f32::to_bits), normals[i as usize].map(f32::to_bits));
                            kept += 1;
                        }
                        _ => {
                            let length = n.iter().map(|x| x * x).sum::<f32>().sqrt();
                            assert!((length - 1.0).abs() < 1e-4, "a new normal of length {length}");
                            made += 1;
                        }
                    }
                }
            }
        }
        assert!(kept > 0 && (made > 0) == (placement != Placement::Endpoint));
    }
}

#[test]
fn labels_are_copied_and_never_mixed() {
    use multires::mesh::AttributeValues;
    let mesh = grid(10, 10, |u, v| 0.1 * (6.0 * u).sin() * (5.0 * v).sin());
    let labels: Vec<u32> = (0..mesh.positions().len() as u32).flat_map(|v| [v, 1000 + v]).collect();
    let mesh = mesh.with_attribute(Attribute::new(names::JOINTS, 2, AttributeValues::Uint(labels))).unwrap();
    for placement in PLACEMENTS {
        let sequence = Simplifier::new().placement(placement).run(&mesh).unwrap();
        let coarse = sequence.extract(&mesh, sequence.len() / 2);
        let AttributeValues::Uint(values) = coarse.attribute(names::JOINTS).unwrap().values() else {
            panic!("another type");
        };
        assert_eq!(values.len(), 2 * coarse.positions().len());
        assert!(rows(values).iter().all(|[a, b]| *b == a + 1000 && (*a as usize) < 121));
    }
}

/// Values that are not numbers count as 0, so they neither stop nor steer anything.
#[test]
fn values_that_are_not_finite_count_as_nothing() {
    let clean = painted(16, |_, _| 0.0);
    let broken = painted(16, |u, v| match (16.0 * u) as u32 % 3 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        _ => 0.0 * v,
    });
    let run = |mesh: &Mesh| {
        let metric =
            WithAttributes::with(Quadric::new(), &Attributes::new(mesh).custom("heat", 1.0)).unwrap();
        steps(&Simplifier::new().metric(metric).run(mesh).unwrap())
    };
    assert_eq!(run(&broken), run(&clean));
}

/// A metric may be used again, also for another mesh than its values are from.
#[test]
fn a_metric_may_be_used_again() {
    let mesh = painted(16, |u, v| (9.0 * u * v).sin());
    let other = torus(20, 12);
    let metric = WithAttributes::with(Quadric::new(), &Attributes::new(&mesh).custom("heat", 0.1)).unwrap();
    let mut simplifier = Simplifier::new().metric(metric).placement(Placement::Midpoint);
    let first = simplifier.run(&mesh).unwrap();
    assert!(simplifier.run(&other).unwrap().len() > 20);
    assert_eq!(simplifier.run(&mesh).unwrap(), first);
}

#[test]
fn customary_weights_suit_real_models() {
    for name in ["real/spot.obj", "real/ogre.obj"] {
        let Some(path) = crate::models::find("customary_weights_suit_real_models", name) else { continue };
        let mesh = textured(&path).unwrap();
        let plain = Simplifier::new().attributes(AttributeWeights::Off).run(&mesh).unwrap();
        let sequence = Simplifier::new().run(&mesh).unwrap();
        let asked_for = Simplifier::new().metric(WithAttributes::new(&mesh)).run(&mesh).unwrap();
        assert_eq!(sequence, asked_for, "{name}: the default is not the customary");
        let point = points(&mesh, &sequence);
        let borders = |steps: usize| {
            let level = level(&mesh, &sequence, &point, steps);
            edges(&level.points).values().filter(|&&count| count == 1).count()
        };
        assert!(borders(sequence.len()) <= borders(0), "{name} tears");
        // Texture is not bought with a far worse shape.
        let target = mesh.triangles().len() / 10;
        let error = |s: &CollapseSequence| s.error_after(s.steps_for_triangles(target));
        assert!(error(&sequence) < 2.0 * error(&plain), "{name}: {} {}", error(&sequence), error(&plain));
    }
}

/// A Wavefront file's positions and texture coordinates, one vertex per pair.
fn textured(path: &std::path::Path) -> Option<Mesh> {
    let text = std::fs::read_to_string(path).ok()?;
    let (mut places, mut coordinates) = (Vec::<[f32; 3]>::new(), Vec::<[f32; 2]>::new());
    let (mut positions, mut uv, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let mut known = std::collections::HashMap::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let kind = words.next().unwrap_or("");
        match kind {
            "v" | "vt" => {
                let x: Vec<f32> = words.filter_map(|w| w.parse().ok()).collect();
                match kind {
                    "v" => places.push([x[0], x[1], x[2]]),
                    _ => coordinates.push([x[0], x[1]]),
                }
            }
            "f" => {
                let corners: Vec<u32> = words
                    .filter_map(|w| {
                        let mut parts = w.split('/');
                        let p: usize = parts.next()?.parse().ok()?;
                        let t: usize = parts.next()?.parse().ok()?;
                        Some(*known.entry((p, t)).or_insert_with(|| {
                            positions.push(places[p - 1]);
                            uv.push(coordinates[t - 1]);
                            positions.len() as u32 - 1
                        }))
                    })
                    .collect();
                triangles.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
            }
            _ => {}
        }
    }
    Mesh::new(positions, triangles).ok()?.with_attribute(Attribute::floats(names::UV, &uv)).ok()
}
