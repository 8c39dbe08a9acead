//! Promise: curves of non-manifold edges are simplified along themselves as borders are; the network that they make keeps
//! its branch points and its curves, and the error is honest.
#![cfg(feature = "quality")]

use std::collections::BTreeMap;

use multires::mesh::{Mesh, Topology, shapes};
use multires::quality::vertex_distances;
use multires::simplify::oracle::NonManifold;
use multires::simplify::{CollapseSequence, Permissive, Placement, Simplifier, StopReason, Target};
use proptest::prelude::*;

type Place = [f32; 3];

/// Sheets between two edges each, in a grid of cells: corners `a`, `b` along one side, `d`, `c` along the other.
fn sheets(sides: &[[Place; 4]], cells: u32) -> Mesh {
    let mix = |a: Place, b: Place, t: f32| -> Place { std::array::from_fn(|i| a[i] * (1.0 - t) + b[i] * t) };
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for &[a, b, c, d] in sides {
        let first = positions.len() as u32;
        for y in 0..=cells {
            for x in 0..=cells {
                let (u, v) = (x as f32 / cells as f32, y as f32 / cells as f32);
                positions.push(mix(mix(a, b, u), mix(d, c, u), v));
            }
        }
        for y in 0..cells {
            for x in 0..cells {
                let at = |x: u32, y: u32| first + y * (cells + 1) + x;
                let [p, q, r, s] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                triangles.extend([[p, q, r], [p, r, s]]);
            }
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

/// Sheets that meet in the z axis like the pages of a book, bent by `bend` along it.
fn pages(count: u32, cells: u32, bend: f32) -> Mesh {
    let directions = [[1.0, 0.2], [-0.5, 0.8], [-0.4, -0.9], [0.6, -0.7], [0.1, 1.0]];
    let sides: Vec<[Place; 4]> = directions[..count as usize]
        .iter()
        .map(|&[x, y]| [[0.0, 0.0, 0.0], [x, y, 0.0], [x, y, 1.0], [0.0, 0.0, 1.0]])
        .collect();
    let mesh = sheets(&sides, cells);
    let positions: Vec<Place> =
        mesh.positions().iter().map(|&[x, y, z]| [x + bend * z * (1.0 - z), y, z]).collect();
    Mesh::new(positions, mesh.triangles()).unwrap()
}

/// Walls of rooms in a row, glued at their common walls: every room a closed box.
fn rooms(count: u32, cells: u32) -> Mesh {
    let mut walls = Vec::new();
    for i in 0..=count {
        let x = i as f32;
        walls.push([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]]);
        if i < count {
            let y = x + 1.0;
            walls.push([[x, 0.0, 0.0], [y, 0.0, 0.0], [y, 1.0, 0.0], [x, 1.0, 0.0]]);
            walls.push([[x, 0.0, 1.0], [y, 0.0, 1.0], [y, 1.0, 1.0], [x, 1.0, 1.0]]);
            walls.push([[x, 0.0, 0.0], [y, 0.0, 0.0], [y, 0.0, 1.0], [x, 0.0, 1.0]]);
            walls.push([[x, 1.0, 0.0], [y, 1.0, 0.0], [y, 1.0, 1.0], [x, 1.0, 1.0]]);
        }
    }
    sheets(&walls, cells)
}

/// Two cubes that share one edge.
fn cubes_at_an_edge(cells: u32) -> Mesh {
    let mut walls = Vec::new();
    for o in [0.0, 1.0] {
        let at = |x: f32, y: f32, z: f32| [x + o, y + o, z];
        for t in [0.0, 1.0] {
            walls.push([at(t, 0.0, 0.0), at(t, 1.0, 0.0), at(t, 1.0, 1.0), at(t, 0.0, 1.0)]);
            walls.push([at(0.0, t, 0.0), at(1.0, t, 0.0), at(1.0, t, 1.0), at(0.0, t, 1.0)]);
            walls.push([at(0.0, 0.0, t), at(1.0, 0.0, t), at(1.0, 1.0, t), at(0.0, 1.0, t)]);
        }
    }
    sheets(&walls, cells)
}

/// What the non-manifold edges of a mesh make.
#[derive(Debug, PartialEq)]
struct Network {
    /// Places where other than two of them meet, and how many.
    branches: Vec<(String, usize)>,
    /// Edges less points: the number of loops less that of components.
    loops: i64,
    components: usize,
}

fn network(mesh: &Mesh) -> (Network, usize) {
    let topology = Topology::new(mesh);
    let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for t in mesh.triangles() {
        let t = t.map(|v| topology.point_of()[v as usize]);
        for i in 0..3 {
            let (u, v) = (t[i], t[(i + 1) % 3]);
            *edges.entry([u.min(v), u.max(v)]).or_default() += 1;
        }
    }
    let curve: Vec<[u32; 2]> = edges.into_iter().filter(|e| e.1 > 2).map(|e| e.0).collect();
    let mut degrees: BTreeMap<u32, usize> = BTreeMap::new();
    let mut parent: BTreeMap<u32, u32> = BTreeMap::new();
    fn root(parent: &BTreeMap<u32, u32>, mut p: u32) -> u32 {
        while parent[&p] != p {
            p = parent[&p];
        }
        p
    }
    for &[u, v] in &curve {
        for p in [u, v] {
            *degrees.entry(p).or_default() += 1;
            parent.entry(p).or_insert(p);
        }
        let (a, b) = (root(&parent, u), root(&parent, v));
        parent.insert(a.max(b), a.min(b));
    }
    let place = |p: u32| format!("{:?}", mesh.positions()[topology.vertex_of_point()[p as usize] as usize]);
    let mut branches: Vec<_> =
        degrees.iter().filter(|d| *d.1 != 2).map(|(&p, &degree)| (place(p), degree)).collect();
    branches.sort();
    let loops = curve.len() as i64 - degrees.len() as i64;
    let components = parent.iter().filter(|(p, q)| p == q).count();
    (Network { branches, loops, components }, curve.len())
}

fn base(mesh: &Mesh) -> CollapseSequence {
    Simplifier::new().run(mesh).unwrap()
}

fn check_levels(mesh: &Mesh, sequence: &CollapseSequence) {
    let (before, _) = network(mesh);
    for part in 0..=8 {
        let steps = sequence.len() * part / 8;
        let level = sequence.extract(mesh, steps);
        assert_eq!(network(&level).0, before, "after {steps} of {}", sequence.len());
    }
}

#[test]
fn curves_come_down_to_their_ends() {
    for (mesh, triangles, edges) in [
        (pages(3, 12, 0.0), 6, 1),
        (pages(5, 12, 0.0), 10, 1),
        (rooms(3, 8), 2 * (4 * 3 + 4), 2 * 4),
        (cubes_at_an_edge(8), 24, 1),
    ] {
        let sequence = base(&mesh);
        check_levels(&mesh, &sequence);
        // Down to the exact shape nothing is lost: by then every curve is one edge and every wall two triangles.
        let steps = (0..=sequence.len()).find(|&s| sequence.triangles_after(s) <= triangles);
        let steps = steps.unwrap_or_else(|| panic!("{} of {triangles}", sequence.report().triangles));
        assert!(sequence.error_after(steps) < 1e-5, "{} at {triangles}", sequence.error_after(steps));
        assert_eq!(network(&sequence.extract(&mesh, steps)).1, edges);
    }
}

#[test]
fn locked_curves_stay_as_they_are() {
    let mesh = pages(3, 8, 0.1);
    let sequence = Simplifier::new().oracle(NonManifold::Locked).run(&mesh).unwrap();
    let level = sequence.extract(&mesh, sequence.len());
    assert_eq!(network(&level), network(&mesh));
}

/// A pinch moves with its fans where all else is in the way, and takes in its neighbours.
#[test]
fn pinches_do_not_stop_anything() {
    let mesh = shapes::two_spheres_touching(3);
    let sequence = base(&mesh);
    // Two tetrahedra at a point.
    assert_eq!(sequence.report().triangles, 8);
    let level = sequence.extract(&mesh, sequence.len());
    let points = Topology::new(&level).point_count();
    assert_eq!(points, 7, "still joined at one point");
}

/// Roughened by a function of the place, so that glued points stay glued.
fn roughened(mesh: &Mesh, jitter: f32) -> Mesh {
    let rough = |x: f32| {
        let f = x * 7.3 + 0.4;
        f - f.floor() - 0.5
    };
    let moved = |&[x, y, z]: &Place| {
        [x + jitter * rough(y + 3.0 * z), y + jitter * rough(x + 5.0 * z), z + jitter * rough(x + 2.0 * y)]
    };
    Mesh::new(mesh.positions().iter().map(moved).collect::<Vec<_>>(), mesh.triangles()).unwrap()
}

/// Walls are turned either way, so that a point may have neighbours that no triangle lists as its next corner. A merged point once
/// forgot that, and two triangles came to lie upon each other.
#[test]
fn walls_turned_against_each_other_keep_their_topology() {
    let mesh = roughened(&rooms(4, 7), 0.013_295_249);
    let simplifier = Simplifier::new().placement(Placement::Optimal).target(Target::Ratio(0.05));
    let sequence = { simplifier }.run(&mesh).unwrap();
    let before = network(&mesh).0;
    for steps in 0..=sequence.len() {
        assert_eq!(network(&sequence.extract(&mesh, steps)).0, before, "after {steps} of {}", sequence.len());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_network_keeps_its_topology(
        which in 0u8..3, cells in 3u32..9, bend in -0.5f32..0.5, count in 3u32..6, jitter in 0.0f32..0.02,
        optimal in any::<bool>(), ratio in 0.05f64..0.6,
    ) {
        let mesh = roughened(&match which {
            0 => pages(count, cells, bend),
            1 => rooms(count - 1, cells),
            _ => cubes_at_an_edge(cells),
        }, jitter);
        let placement = if optimal { Placement::Optimal } else { Placement::Endpoint };
        // By default the topology gives where a size would be missed: three pages are three triangles at least.
        let simplifier = Simplifier::new().permissive(Permissive::Off).placement(placement);
        let sequence = simplifier.target(Target::Ratio(ratio)).run(&mesh).unwrap();
        check_levels(&mesh, &sequence);
        prop_assert!(matches!(sequence.report().stop, StopReason::Target | StopReason::NothingLegal | StopReason::Guard));
        let level = sequence.extract(&mesh, sequence.len());
        let farthest = vertex_distances(&mesh, &level).unwrap().into_iter().fold(0.0, f64::max);
        let error = f64::from(sequence.report().error);
        prop_assert!(farthest <= 1e-5 + error, "{farthest} beyond {error}");
    }
}
