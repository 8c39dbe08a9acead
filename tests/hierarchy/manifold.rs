//! Promise: with [`Dependencies::Manifold`], every cut of a manifold mesh is a manifold, and if its parts stay, with its Euler
//! characteristic, and without borders where it has none.
//!
//! Cuts are random closed sets of splits, not those of views. `MULTIRES_CUTS=N` tests N cuts of each model, not a few.

use std::path::Path;

use crate::{meshes, models};
use multires::adapt::Refinements;
use multires::hierarchy::{Dependencies, VertexHierarchy};
use multires::mesh::{Mesh, shapes};
use multires::simplify::{Parts, Placement, Simplifier};
use proptest::prelude::*;

/// Random numbers.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Edges of three and more triangles, edges of one, and points less edges plus triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Shape {
    overfull: usize,
    border: usize,
    euler: i64,
    /// Fans of triangles around points, less points: above 0 where a point is pinched.
    pinches: usize,
}

/// Describes triangles by their points.
fn shape(triangles: &[[u32; 3]], points: usize) -> Shape {
    let side = |[a, b]: [u32; 2]| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
    // Corners of a point are in one fan if their triangles share an edge at the point.
    let mut sides: Vec<(u64, u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, [a, b, c]) in (0..).zip(triangles.iter().copied()) {
        sides.extend([(side([a, b]), 3 * t), (side([b, c]), 3 * t + 1), (side([c, a]), 3 * t + 2)]);
    }
    sides.sort_unstable();
    let mut fan: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    fn find(fan: &mut [u32], mut corner: u32) -> u32 {
        while fan[corner as usize] != corner {
            fan[corner as usize] = fan[fan[corner as usize] as usize];
            corner = fan[corner as usize];
        }
        corner
    }
    let (mut edges, mut overfull, mut border) = (0, 0, 0);
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        edges += 1;
        overfull += usize::from(run.len() > 2);
        border += usize::from(run.len() == 1);
        for pair in run.windows(2) {
            let ends = [pair[0].1, pair[1].1].map(|at| {
                let (t, k) = (at / 3, at % 3);
                [3 * t + k, 3 * t + (k + 1) % 3]
                    .map(|corner| (triangles[t as usize][corner as usize % 3], corner))
            });
            for (point, corner) in ends[0] {
                let other = ends[1].into_iter().find(|end| end.0 == point).map(|end| end.1);
                if let Some(other) = other {
                    let (a, b) = (find(&mut fan, corner), find(&mut fan, other));
                    fan[a as usize] = b;
                }
            }
        }
    }
    let mut used = vec![false; points];
    triangles.as_flattened().iter().for_each(|&point| used[point as usize] = true);
    let points = used.iter().filter(|used| **used).count();
    let fans = (0..fan.len() as u32).filter(|&corner| find(&mut fan, corner) == corner).count();
    Shape { overfull, border, euler: points as i64 - edges + triangles.len() as i64, pinches: fans - points }
}

/// A hierarchy, and what tells its cuts.
struct Subject {
    hierarchy: VertexHierarchy,
    /// Per vertex of the hierarchy: its point, the split that brings it, and the vertex that takes its place.
    point: Vec<u32>,
    brought_by: Vec<u32>,
    substitute: Vec<u32>,
    places: Vec<[f32; 3]>,
    there: Vec<bool>,
    image: Vec<u32>,
    /// Whether all parts stay.
    stays: bool,
}

impl Subject {
    fn new(mesh: &Mesh, placement: Placement, parts: Parts, dependencies: Dependencies) -> Self {
        let sequence = Simplifier::new().placement(placement).parts(parts).run(mesh).unwrap();
        let built = VertexHierarchy::build(mesh, &sequence, dependencies).unwrap();
        assert!(built.hierarchy.validate().is_ok());
        let points = meshes::points(mesh, &sequence);
        let place = |v: u32| meshes::position(mesh, &sequence, v);
        let arrays = multires::hierarchy::HierarchyParts::from(built.hierarchy.clone());
        let mut brought_by = vec![u32::MAX; built.hierarchy.vertex_count()];
        for split in 0..built.hierarchy.split_count() {
            let brings = arrays.brings_start[split] as usize..arrays.brings_start[split + 1] as usize;
            arrays.brings[brings].iter().for_each(|&vertex| brought_by[vertex as usize] = split as u32);
        }
        Self {
            point: built.vertex_order.iter().map(|&v| points[v as usize]).collect(),
            places: built.vertex_order.iter().map(|&v| place(v)).collect(),
            substitute: arrays.substitute,
            brought_by,
            there: vec![false; built.hierarchy.split_count()],
            image: Vec::new(),
            stays: parts == Parts::Keep,
            hierarchy: built.hierarchy,
        }
    }

    /// Chooses a random closed set: of single splits, of places, of levels, or of all of that.
    fn choose(&mut self, dice: &mut Dice) {
        let Self { hierarchy, there, places, .. } = self;
        let count = hierarchy.split_count();
        there.fill(false);
        let mut stack: Vec<u32> = Vec::new();
        let kind = dice.below(8);
        if kind & 1 == 0 {
            let most = [3, 30, 300][dice.below(3)];
            stack.extend((0..1 + dice.below(most)).map(|_| dice.below(count) as u32));
        }
        if kind & 2 == 0 {
            // Coarse ones.
            let most = count >> dice.below(8);
            stack.extend((0..1 + dice.below(100)).map(|_| dice.below(most) as u32));
        }
        if kind & 4 == 0 {
            let centre = places[dice.below(places.len())];
            let reach = hierarchy.diagonal() as f32 / (1 << (1 + dice.below(7))) as f32;
            let near = |place: [f32; 3]| (0..3).all(|k| (place[k] - centre[k]).abs() < reach);
            let share = 1 + dice.below(4);
            let splits = (0..count as u32).filter(|&split| near(hierarchy.bounds(split).centre));
            stack.extend(splits.filter(|_| dice.below(share) == 0).take(3_000));
        }
        stack.retain(|&split| (split as usize) < count);
        while let Some(split) = stack.pop() {
            if !std::mem::replace(&mut there[split as usize], true) {
                stack.extend(hierarchy.parents(split).chain(hierarchy.dependencies(split)));
            }
        }
    }

    /// Returns the triangles at the cut, by their points.
    fn drawn(&mut self) -> Vec<[u32; 3]> {
        let Self { hierarchy, point, brought_by, substitute, there, image, .. } = self;
        let is_there = |vertex: u32| {
            brought_by[vertex as usize] == u32::MAX || there[brought_by[vertex as usize] as usize]
        };
        image.clear();
        image.resize(point.len(), u32::MAX);
        let mut way = Vec::new();
        for leaf in 0..hierarchy.leaf_count() as u32 {
            let mut vertex = leaf;
            while image[vertex as usize] == u32::MAX && !is_there(vertex) {
                way.push(vertex);
                vertex = substitute[vertex as usize];
            }
            let end = if image[vertex as usize] == u32::MAX { vertex } else { image[vertex as usize] };
            image[vertex as usize] = end;
            way.drain(..).for_each(|on_the_way| image[on_the_way as usize] = end);
        }
        let points = |&corners: &[u32; 3]| corners.map(|leaf| point[image[leaf as usize] as usize]);
        let is_drawn = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        hierarchy.triangles().iter().map(points).filter(is_drawn).collect()
    }

    fn shape(&mut self) -> Shape {
        let points = 1 + *self.point.iter().max().unwrap() as usize;
        shape(&self.drawn(), points)
    }

    /// Checks random cuts against the whole mesh. Returns how many of them were not as it is.
    fn check(&mut self, cuts: usize, seed: u64) -> usize {
        self.there.fill(true);
        let whole = self.shape();
        assert_eq!((whole.overfull, whole.pinches), (0, 0), "not a manifold");
        let mut dice = Dice(seed);
        (0..cuts)
            .filter(|_| {
                self.choose(&mut dice);
                let Shape { overfull, border, euler, pinches } = self.shape();
                let same = euler == whole.euler && (border == 0) == (whole.border == 0);
                (overfull, pinches) != (0, 0) || self.stays && !same
            })
            .count()
    }
}

fn made(which: usize) -> Mesh {
    match which {
        0 => shapes::icosphere(3),
        1 => meshes::torus(24, 12),
        2 => shapes::rock(2_000, 3),
        3 => meshes::grid(20, 20, |x, y| (3.0 * x).sin() * (2.0 * y).cos()),
        4 => meshes::tube(12, 30),
        5 => meshes::seamed_grid(20, 14, |x, y| (x - y).abs()),
        6 => shapes::shell(2, 0.8),
        7 => meshes::quilt(4, 5, false, |x, y| (2.0 * x).sin() + y * y),
        _ => meshes::quilt(6, 3, true, |x, y| (3.0 * x - y).cos()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_cut_of_a_manifold_is_one(which in 0usize..9, optimal: bool, keep: bool, seed: u64) {
        let placement = if optimal { Placement::Optimal } else { Placement::Endpoint };
        let parts = if keep { Parts::Keep } else { Parts::Vanish };
        let mut subject = Subject::new(&made(which), placement, parts, Dependencies::Manifold);
        prop_assert_eq!(subject.check(40, seed), 0);
    }
}

/// The test would see it: without dependencies, some cuts are none.
#[test]
fn without_dependencies_some_are_not() {
    let mut found = 0;
    for which in 0..3 {
        found +=
            Subject::new(&made(which), Placement::Endpoint, Parts::Keep, Dependencies::None).check(400, 7);
    }
    assert!(found > 0);
}

#[cfg(feature = "io")]
#[test]
fn of_real_models_too() {
    let Some(folder) = models::find("of_real_models_too", "real") else { return };
    let cuts = std::env::var("MULTIRES_CUTS").ok().and_then(|n| n.parse().ok());
    let limit = if cuts.is_some() { usize::MAX } else { 40_000 };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let (mut checked, mut models) = (0, 0);
    for file in files {
        let Ok(mesh) = multires::io::read(&file) else { continue };
        if mesh.triangles().len() > limit || !is_manifold(&mesh) {
            continue;
        }
        models += 1;
        for (placement, name) in [(Placement::Endpoint, "endpoint"), (Placement::Optimal, "optimal")] {
            let mut subject = Subject::new(&mesh, placement, Parts::Keep, Dependencies::Manifold);
            let cuts = cuts.unwrap_or(5);
            let wrong = subject.check(cuts, 11);
            checked += cuts;
            let file = file.file_name().map(Path::new).unwrap().display();
            if std::env::var_os("MULTIRES_CUTS").is_some() {
                let without =
                    Subject::new(&mesh, placement, Parts::Keep, Dependencies::None).check(cuts.min(500), 11);
                println!(
                    "{file}, {name}: {wrong} of {cuts} wrong; without dependencies {without} of {}",
                    cuts.min(500)
                );
            }
            assert_eq!(wrong, 0, "{file}, {name}");
        }
    }
    println!("{checked} cuts of {models} models");
}

fn is_manifold(mesh: &Mesh) -> bool {
    let point = multires::mesh::Topology::new(mesh).point_of().to_vec();
    let points = mesh.triangles().iter().map(|corners| corners.map(|v| point[v as usize]));
    let triangles: Vec<_> = points.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let Shape { overfull, pinches, .. } = shape(&triangles, point.len());
    overfull == 0 && pinches == 0 && !triangles.is_empty()
}
