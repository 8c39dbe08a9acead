//! What each metric says a collapse costs: by hand on an octahedron, on planes and borders, and as laws.
//!
//! ```text
//!            u (0,0,1)               The pair is u -> v. Triangles around u: 4 (2 on the edge), around v: 4 (the same 2).
//!          / | \                     u -> v flattens the upper half: the two triangles on the far side sweep
//!   far  -- w1,w3 --  v (1,0,0)      a volume of 1/3 each.
//!          \ | /
//!            d (0,0,-1)
//! ```

use std::sync::{Arc, Mutex};

use multires::mesh::{Attribute, Mesh, Topology, shapes};
use multires::simplify::metric::{
    AttributeQuadric, Attributes, EdgeLength, LindstromTurk, MemorylessQuadric, MetricEvent, NAMES, Optimum,
    PerBatch, ProgressiveMeshMetric, Quadric, UnsignedVolume, VolumeArea, WithAttributes, by_name,
};
use multires::simplify::{Batch, ErrorMetric, Order, Pair, Placement, Simplifier, Target, WorkingSurface};
use proptest::prelude::*;

const V: u32 = 0;
const U: u32 = 4;
const PAIR: Pair = Pair { lost: U, kept: V };

fn surface(mesh: &Mesh) -> WorkingSurface {
    WorkingSurface::new(mesh, &Topology::new(mesh))
}

/// Corners 0 to 3 on the equator (0 is v), 4 is u at the top, 5 at the bottom.
fn octahedron(scale: f32, shift: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let at = |x: f32, y: f32, z: f32| [shift + scale * x, scale * y, scale * z];
    let positions = vec![
        at(1.0, 0.0, 0.0),
        at(0.0, 1.0, 0.0),
        at(-1.0, 0.0, 0.0),
        at(0.0, -1.0, 0.0),
        at(0.0, 0.0, 1.0),
        at(0.0, 0.0, -1.0),
    ];
    let triangles = (0..4).flat_map(|i| [[4, i, (i + 1) % 4], [5, (i + 1) % 4, i]]).collect();
    (positions, triangles)
}

/// An octahedron. The two faces away from u and v are bent a little in their middles, so that its edges are no creases.
fn one_octahedron() -> WorkingSurface {
    let (mut positions, triangles) = octahedron(1.0, 0.0);
    let far = |t: &&[u32; 3]| !t.contains(&U) && !t.contains(&V);
    let mut bent: Vec<[u32; 3]> = triangles.iter().filter(|t| !far(t)).copied().collect();
    for &[a, b, c] in triangles.iter().filter(far) {
        let middle = positions.len() as u32;
        positions.push(std::array::from_fn(|i| {
            0.42 * (positions[a as usize][i] + positions[b as usize][i] + positions[c as usize][i])
        }));
        bent.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
    }
    let triangles = bent;
    surface(&Mesh::new(positions, triangles).expect("octahedron"))
}

fn begun<M: ErrorMetric>(mut metric: M, surface: &WorkingSurface) -> M {
    metric.update(surface, MetricEvent::Begin(Batch::first(surface)));
    metric
}

/// The cost of a pair at the kept point, as endpoint placement asks for it.
fn quick(metric: &dyn ErrorMetric, surface: &WorkingSurface, pair: Pair) -> f32 {
    let mut cost = [f32::NAN];
    metric.costs_at_kept(surface, pair.lost, &[pair.kept], &mut cost);
    cost[0]
}

fn named(name: &str, surface: &WorkingSurface) -> Box<dyn ErrorMetric> {
    begun(by_name(name).expect("a known name"), surface)
}

/// The cost of u -> v at v, both ways of asking, in object units: costs grow with the given power of lengths.
fn cost_at_kept(metric: impl ErrorMetric, power: i32) -> f64 {
    let surface = one_octahedron();
    let metric = begun(metric, &surface);
    let general = metric.cost(&surface, PAIR, surface.position(V));
    let quick = quick(&metric, &surface, PAIR);
    assert!((general - quick).abs() <= 1e-6 * general, "{}: {general} and {quick}", metric.properties().name);
    f64::from(quick) / surface.frame().scale().powi(power)
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 2e-6 * expected.abs(), "found {found}, expected {expected}");
}

#[test]
fn edge_length_is_squared() {
    assert_near(cost_at_kept(EdgeLength::new(), 2), 2.0);
}

#[test]
fn unsigned_volume_is_the_flattened_half() {
    assert_near(cost_at_kept(UnsignedVolume::new(), 3), 2.0 / 3.0);
}

#[test]
fn hybrid_multiplies_by_the_largest_turn() {
    // (-1, 1, 1) / sqrt 3 becomes (0, 0, 1).
    let expected = 2.0 / 3.0 * (1.0 - 1.0 / 3f64.sqrt());
    assert_near(cost_at_kept(by_name("hybrid").expect("hybrid"), 3), expected);
}

#[test]
fn progressive_mesh_adds_squared_distances_and_springs() {
    // v lies 2 / sqrt 3 off the two far planes, on all others; and sqrt 2, 2, sqrt 2, sqrt 2 from the points around.
    assert_near(cost_at_kept(ProgressiveMeshMetric::new().with_kappa(0.0), 2), 8.0 / 3.0);
    assert_near(cost_at_kept(ProgressiveMeshMetric::new().with_kappa(0.5), 2), 8.0 / 3.0 + 0.5 * 10.0);
    assert_near(cost_at_kept(ProgressiveMeshMetric::new().with_kappa(f32::NAN), 2), 8.0 / 3.0);
    assert_near(cost_at_kept(ProgressiveMeshMetric::new().with_schedule(|_| 0.25), 2), 8.0 / 3.0 + 2.5);
}

#[test]
fn memoryless_quadric_weighs_by_area() {
    // Each of the two far triangles has twice the area sqrt 3.
    assert_near(cost_at_kept(MemorylessQuadric::new(), 4), 2.0 * 3f64.sqrt() * 4.0 / 3.0);
}

#[test]
fn accumulated_quadric_agrees_where_nothing_is_counted_twice() {
    // The triangles on the edge are in both quadrics, but v lies on them. Where v stays, the sum is divided by the
    // root of the four triangles' weights (twice their areas, sqrt 3 each).
    let surface = one_octahedron();
    let metric = begun(Quadric::new(), &surface);
    let (scale, sum) = (surface.frame().scale(), 2.0 * 3f64.sqrt() * 4.0 / 3.0);
    assert_near(f64::from(metric.cost(&surface, PAIR, surface.position(V))) / scale.powi(4), sum);
    let quick = f64::from(quick(&metric, &surface, PAIR)) / scale.powi(3);
    assert_near(quick, sum / (4.0 * 3f64.sqrt()).sqrt());
}

#[test]
fn volume_area_adds_swept_signed_and_area() {
    // Volumes 2/3 swept and as much signed; area 4 sqrt(3)/2 becomes 2; the edge is sqrt 2 long.
    let volumes = 2.0 / 3.0 + 3.0 * 2.0 / 3.0;
    let area = 2.0 * 3f64.sqrt() - 2.0;
    let expected = volumes + 2f64.sqrt() * 0.5 * area + 1e-6 * 2f64.sqrt().powi(3);
    assert_near(cost_at_kept(VolumeArea::new(), 3), expected);
}

#[test]
fn lindstrom_turk_preserves_the_volume() {
    // At (t, 0, t) the four outer tetrahedra have -1/6 each, the two on the edge (2t - 1)/6: together 0 at t = 3/2.
    let surface = one_octahedron();
    let metric = begun(LindstromTurk::new(), &surface);
    let Optimum { position: x, cost, .. } =
        metric.optimum(&surface, PAIR, &AttributeQuadric::NONE).expect("a position");
    let t = 1.5 * surface.frame().scale() as f32;
    assert!(x.iter().zip([t, 0.0, t]).all(|(a, b)| (a - b).abs() < 1e-6), "{x:?}");
    // Squared volumes: 6 x (1/3)^2 / 4 = 4 (1/6)^2 + 2 (2/6)^2 there, 2 (1/3)^2 at v, 4 (1/6)^2 in the middle.
    let at_kept = quick(&metric, &surface, PAIR);
    assert_near(f64::from(cost / at_kept), (4.0 / 36.0 + 2.0 / 9.0) / (2.0 / 9.0));
    let middle = surface.position(U).map(|x| 0.5 * x);
    let middle = [0, 1, 2].map(|i| middle[i] + 0.5 * surface.position(V)[i]);
    assert_near(f64::from(metric.cost(&surface, PAIR, middle) / at_kept), 0.5);
}

#[test]
fn quadrics_find_the_corner_that_was_cut_off() {
    // The corner (1, 1, 1) of a cube, cut off between a, b and c at depth 1/10: two planes and part of the third meet
    // in it, and the small triangle abc pulls the least.
    let cut = 0.9;
    let positions = [
        [cut, 1.0, 1.0],
        [1.0, cut, 1.0],
        [1.0, 1.0, cut],
        [0.0, 1.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let triangles = [
        [0, 1, 2],
        [0, 3, 6],
        [0, 6, 1],
        [1, 6, 4],
        [1, 4, 7],
        [1, 7, 2],
        [2, 7, 5],
        [2, 5, 8],
        [2, 8, 0],
        [0, 8, 3],
    ];
    let surface = surface(&Mesh::new(positions, triangles).expect("corner"));
    let corner = surface.frame().inner([1.0; 3]);
    let pair = Pair { lost: 0, kept: 1 };
    for name in ["memoryless-quadric", "quadric"] {
        let optimum = named(name, &surface).optimum(&surface, pair, &AttributeQuadric::NONE);
        let x = optimum.expect("a position").position;
        let distance = (0..3).map(|i| (x[i] - corner[i]).powi(2)).sum::<f32>().sqrt();
        assert!(distance < 0.02 * surface.frame().scale() as f32, "{name}: {distance} off");
    }
}

#[test]
fn nothing_costs_anything_on_a_plane() {
    let surface = surface(&shapes::plane(8));
    let pair = Pair { lost: 4 * 9 + 4, kept: 4 * 9 + 5 };
    let edge = (2.0 / 8.0 * surface.frame().scale()) as f32;
    for name in NAMES {
        let metric = named(name, &surface);
        let costs = [quick(&*metric, &surface, pair), metric.cost(&surface, pair, surface.position(40))];
        let tie_break = match name {
            "edge-length" => edge * edge,
            "quadric" => 1e-9 * edge.powi(4),
            "volume-area" => 2e-6 * edge.powi(3),
            // The springs alone.
            "progressive-mesh" => 1e-5 * 8.0 * 5.0 * edge * edge,
            _ => 0.0,
        };
        assert!(costs.iter().all(|&cost| cost <= tie_break), "{name}: {costs:?}");
        if tie_break > 0.0 {
            assert!(costs[0] > 0.0, "{name} leaves the order on a plane to chance");
        }
    }
}

#[test]
fn borders_may_slide_but_not_be_cut() {
    // 0 is a corner of the square, 1 the next border point, 2 the one after.
    let surface = surface(&shapes::plane(8));
    let slide = Pair { lost: 1, kept: 2 };
    let cut = Pair { lost: 0, kept: 10 };
    for name in ["lindstrom-turk", "memoryless-quadric", "quadric", "progressive-mesh", "volume-area"] {
        let metric = named(name, &surface);
        let (slide, cut) = (quick(&*metric, &surface, slide), quick(&*metric, &surface, cut));
        assert!(cut > 100.0 * slide, "{name}: slide {slide}, cut {cut}");
    }
}

#[test]
fn costs_scale_by_their_unit() {
    // Two octahedra, one a quarter of the other's size: every cost is a power of length.
    let (mut positions, mut triangles) = octahedron(1.0, 0.0);
    let (more, small) = octahedron(0.25, 4.0);
    positions.extend(more);
    triangles.extend(small.iter().map(|t| t.map(|v| v + 6)));
    let surface = surface(&Mesh::new(positions, triangles).expect("two octahedra"));
    let small = Pair { lost: U + 6, kept: V + 6 };
    let powers = [3, 4, 6, 3, 3, 3, 2, 2];
    for (name, power) in NAMES.into_iter().zip(powers) {
        let metric = named(name, &surface);
        let ratio = quick(&*metric, &surface, PAIR) / quick(&*metric, &surface, small);
        assert_near(f64::from(ratio), 4f64.powi(power));
    }
}

#[test]
fn scale_by_powers_of_two_changes_no_decision() {
    let mesh = shapes::rock(1500, 3);
    let scaled = |factor: f32| {
        let positions: Vec<_> = mesh.positions().iter().map(|p| p.map(|x| x * factor)).collect();
        Mesh::new(positions, mesh.triangles()).expect("scaled")
    };
    for name in NAMES {
        let run = |mesh: &Mesh| {
            let sequence =
                Simplifier::new().metric(by_name(name).expect("known")).run(mesh).expect("options");
            (0..sequence.len()).flat_map(|step| sequence.substitutions(step).to_vec()).collect::<Vec<_>>()
        };
        let plain = run(&scaled(1.0));
        assert!(!plain.is_empty());
        assert_eq!(plain, run(&scaled(2f32.powi(-20))), "{name}");
        assert_eq!(plain, run(&scaled(2f32.powi(13))), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// An optimum is no dearer than what it replaces, and its cost is the cost there.
    #[test]
    fn optimum_is_the_best_place_known(seed in 0u32..1000, bumps in prop::collection::vec(-0.2f32..0.2, 42)) {
        let sphere = shapes::icosphere(1);
        let bumped: Vec<_> =
            sphere.positions().iter().zip(bumps.iter().cycle()).map(|(p, b)| p.map(|x| x * (1.0 + b))).collect();
        let mesh = Mesh::new(bumped, sphere.triangles()).expect("bumpy sphere");
        let surface = surface(&mesh);
        let [lost, kept, _] = mesh.triangles()[seed as usize % mesh.triangles().len()];
        let point_of = Topology::new(&mesh).point_of().to_vec();
        let pair = Pair { lost: point_of[lost as usize], kept: point_of[kept as usize] };
        let ends = [surface.position(pair.lost), surface.position(pair.kept)];
        let middle = [0, 1, 2].map(|i| 0.5 * (ends[0][i] + ends[1][i]));
        for name in NAMES {
            let metric = named(name, &surface);
            let Some(Optimum { position: x, cost, .. }) =
                metric.optimum(&surface, pair, &AttributeQuadric::NONE) else {
                prop_assert_eq!(name, "edge-length");
                continue;
            };
            prop_assert!((metric.cost(&surface, pair, x) - cost).abs() <= 1e-4 * cost + 1e-12, "{}", name);
            // Preserving the volume comes before the cost.
            if name != "lindstrom-turk" {
                for place in [ends[0], ends[1], middle] {
                    let there = metric.cost(&surface, pair, place);
                    prop_assert!(cost <= there * 1.001 + 1e-12, "{}: {} there {}", name, cost, there);
                }
            }
        }
    }
}

/// A metric that checks after every collapse that what it keeps is what a new one would sum up.
struct Checked<M, F> {
    metric: M,
    fresh: F,
}

impl<M: ErrorMetric, F: Fn() -> M + Send + Sync> ErrorMetric for Checked<M, F> {
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        self.metric.cost(surface, pair, position)
    }
    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        self.metric.optimum(surface, pair, attributes)
    }
    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.metric.update(surface, event);
        let MetricEvent::Collapsed { .. } = event else { return };
        let fresh = begun((self.fresh)(), surface);
        for point in 0..surface.point_count() as u32 {
            surface.for_neighbours(point, |kept| {
                let pair = Pair { lost: point, kept };
                let (kept, new) = (quick(&self.metric, surface, pair), quick(&fresh, surface, pair));
                assert!((kept - new).abs() <= 1e-3 * new + 1e-9, "{point}: {kept} kept, {new} afresh");
            });
        }
    }
}

#[test]
fn sums_are_kept_up_to_date() {
    for mesh in [shapes::rock(300, 5), shapes::terrain(9, 2), shapes::moebius(12)] {
        let check = |metric: Simplifier<_>| metric.placement(Placement::Optimal).run(&mesh).expect("options");
        let fresh = MemorylessQuadric::new;
        assert!(!check(Simplifier::new().metric(Checked { metric: fresh(), fresh })).is_empty());
    }
}

/// The volume inside a closed mesh.
fn volume(mesh: &Mesh) -> f64 {
    let p = |v: u32| mesh.positions()[v as usize].map(f64::from);
    let six = |t: &[u32; 3]| {
        let [a, b, c] = t.map(p);
        (0..3)
            .map(|i| a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]))
            .sum::<f64>()
    };
    mesh.triangles().iter().map(six).sum::<f64>() / 6.0
}

/// The area of a mesh in the plane y = 0.
fn flat_area(mesh: &Mesh) -> f64 {
    let p = |v: u32| mesh.positions()[v as usize].map(f64::from);
    let twice = |t: &[u32; 3]| {
        let [a, b, c] = t.map(p);
        (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
    };
    mesh.triangles().iter().map(twice).sum::<f64>() / 2.0
}

fn lindstrom_turk(mesh: &Mesh, ratio: f64) -> Mesh {
    let mut simplifier = Simplifier::new()
        .metric(LindstromTurk::new())
        .placement(Placement::Optimal)
        .target(Target::Ratio(ratio));
    let sequence = simplifier.run(mesh).expect("options");
    let result = sequence.extract(mesh, sequence.len());
    assert!(result.triangles().len() <= (ratio * mesh.triangles().len() as f64) as usize, "target missed");
    result
}

#[test]
fn closed_meshes_keep_their_volume() {
    for mesh in [shapes::torus_knot(2, 3, 300, 20), shapes::icosphere(5), shapes::rock(10_000, 7)] {
        let before = volume(&mesh);
        let after = volume(&lindstrom_turk(&mesh, 0.05));
        assert!((after / before - 1.0).abs() < 0.005, "{before} became {after}");
    }
}

#[test]
fn flat_sheets_keep_their_area() {
    // A disc: rings of points, its border a polygon of 96 sides.
    let (rings, sides) = (12u32, 96u32);
    let mut positions = vec![[0.0f32, 0.0, 0.0]];
    for ring in 1..=rings {
        for side in 0..sides {
            let angle = side as f32 / sides as f32 * std::f32::consts::TAU;
            let radius = ring as f32 / rings as f32;
            positions.push([radius * angle.sin(), 0.0, radius * angle.cos()]);
        }
    }
    let at = |ring: u32, side: u32| if ring == 0 { 0 } else { 1 + (ring - 1) * sides + side % sides };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for side in 0..sides {
            triangles.push([at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)]);
            if ring > 0 {
                triangles.push([at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)]);
            }
        }
    }
    let mesh = Mesh::new(positions, triangles).expect("disc");
    let before = flat_area(&mesh);
    let result = lindstrom_turk(&mesh, 0.01);
    let after = flat_area(&result);
    assert!((after / before - 1.0).abs() < 1e-5, "{before} became {after}");
}

#[test]
fn metric_may_change_between_batches() {
    let mesh = shapes::rock(2000, 1);
    let asked = Arc::new(Mutex::new(Vec::new()));
    let seen = asked.clone();
    let changing = PerBatch::new(move |batch| {
        seen.lock().expect("one thread").push((batch.index, batch.triangles));
        if batch.index < 2 { Box::new(EdgeLength::new()) } else { Box::new(Quadric::new()) }
    });
    let run = |metric: Box<dyn ErrorMetric>| {
        Simplifier::new().metric(metric).order(Order::Batched).run(&mesh).expect("options")
    };
    let changed = run(Box::new(changing));
    let plain = run(Box::new(EdgeLength::new()));
    let end = changed.batches()[1] as usize;
    assert_eq!(changed.batches()[..2], plain.batches()[..2], "the same metric decides alike");
    assert!((0..end).all(|step| changed.substitutions(step) == plain.substitutions(step)));
    let rest = changed.len().min(plain.len());
    assert!((end..rest).any(|step| changed.substitutions(step) != plain.substitutions(step)));
    let asked = asked.lock().expect("one thread");
    let counted: Vec<usize> = std::iter::once(mesh.triangles().len())
        .chain(changed.batches().iter().map(|&end| changed.triangles_after(end as usize)))
        .collect();
    for (i, &(index, triangles)) in asked.iter().enumerate() {
        assert_eq!((index, triangles), (i, counted[i]), "one call a batch, with what is left");
    }
    // The last call may have found nothing to do.
    assert!(asked.len() >= changed.batches().len() && asked.len() > 3);
}

#[test]
fn springs_follow_their_schedule() {
    let surface = one_octahedron();
    let mut metric =
        ProgressiveMeshMetric::new().with_schedule(|batch| if batch.index == 0 { 1.0 } else { 0.0 });
    let mut batch = Batch::first(&surface);
    metric.update(&surface, MetricEvent::Begin(batch));
    let stiff = quick(&metric, &surface, PAIR);
    batch.index = 1;
    metric.update(&surface, MetricEvent::Begin(batch));
    let loose = quick(&metric, &surface, PAIR);
    assert_near(f64::from(stiff / loose), (8.0 / 3.0 + 10.0) / (8.0 / 3.0));
}

#[test]
fn names_lead_to_metrics_and_back() {
    for name in NAMES {
        assert_eq!(by_name(name).map(|metric| metric.properties().name), Some(name));
    }
    assert!(by_name("shortest").is_none());
}

/// A closure simplifies as a type with the same costs does.
#[test]
fn a_closure_is_a_metric() {
    struct Squared;
    fn squared(surface: &WorkingSurface, pair: Pair) -> f32 {
        let [a, b] = [pair.lost, pair.kept].map(|point| surface.position(point));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
    }
    impl ErrorMetric for Squared {
        fn cost(&self, surface: &WorkingSurface, pair: Pair, _: [f32; 3]) -> f32 {
            squared(surface, pair)
        }
    }
    let mesh = shapes::rock(500, 3);
    let target = Target::Triangles(100);
    let by_closure = |surface: &WorkingSurface, pair: Pair, _: [f32; 3]| squared(surface, pair);
    let by_closure = Simplifier::new().metric(by_closure).target(target).run(&mesh).expect("options");
    let by_type = Simplifier::new().metric(Squared).target(target).run(&mesh).expect("options");
    assert_eq!(by_closure, by_type);
    assert!(by_closure.report().triangles <= 100);
}

/// A metric whose optimum knows nothing of attributes gets their cost added, and one that counts them does not.
#[test]
fn attributes_count_at_any_optimum() {
    struct Flat {
        counts: bool,
    }
    impl ErrorMetric for Flat {
        fn cost(&self, _: &WorkingSurface, _: Pair, _: [f32; 3]) -> f32 {
            1.0
        }
        fn optimum(
            &self,
            surface: &WorkingSurface,
            pair: Pair,
            attributes: &AttributeQuadric,
        ) -> Option<Optimum> {
            let [a, b] = [pair.lost, pair.kept].map(|point| surface.position(point));
            let middle = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
            let both = || Optimum::of_both(middle, 1.0 + attributes.at(middle).sum);
            Some(if self.counts { both() } else { Optimum::new(middle, 1.0) })
        }
    }
    let mesh = shapes::terrain(9, 2);
    let heat: Vec<[f32; 1]> = mesh.positions().iter().map(|p| [(7.0 * p[0] * p[2]).sin()]).collect();
    let mesh = mesh.with_attribute(Attribute::floats("heat", &heat)).expect("values");
    let surface = surface(&mesh);
    let pair = Pair { lost: 30, kept: 31 };
    let costs = [false, true].map(|counts| {
        let attributes = Attributes::new(&mesh).custom("heat", 0.5);
        let metric = WithAttributes::with(Flat { counts }, &attributes).expect("an attribute");
        let metric = begun(metric, &surface);
        let Optimum { position, cost, .. } =
            metric.optimum(&surface, pair, &AttributeQuadric::NONE).expect("the middle");
        assert_eq!(cost, metric.cost(&surface, pair, position));
        cost
    });
    assert!(costs[0] > 1.0, "{costs:?}");
    assert_eq!(costs[0], costs[1]);
}
