//! Promise: triangles over the same three points are simplified as one sheet, and come back each with its own wedges, winding
//! and material.

use std::collections::BTreeMap;

use crate::meshes::{grid, grid_positions, grid_triangles, normal, seamed_grid};
use multires::hierarchy::{Dependencies, VertexHierarchy};
use multires::mesh::{Attribute, Mesh, Report, names, shapes};
use multires::simplify::{AttributeWeights, CollapseSequence, Placement, Simplifier, StopReason, Target};
use multires::tom::TotallyOrderedMesh;

fn simplify(mesh: &Mesh, placement: Placement, target: Target) -> CollapseSequence {
    simplify_by(mesh, placement, target, AttributeWeights::Customary)
}

fn simplify_by(mesh: &Mesh, placement: Placement, target: Target, by: AttributeWeights) -> CollapseSequence {
    let mut simplifier = Simplifier::new().placement(placement).target(target).attributes(by);
    let sequence = simplifier.run(mesh).unwrap();
    assert_eq!(sequence.validate(), Ok(()));
    assert_eq!(simplifier.run(mesh).unwrap(), sequence, "the same input gives the same collapses");
    sequence
}

fn reached(mesh: &Mesh, placement: Placement, ratio: f64) -> Mesh {
    reached_by(mesh, placement, ratio, AttributeWeights::Customary)
}

fn reached_by(mesh: &Mesh, placement: Placement, ratio: f64, by: AttributeWeights) -> Mesh {
    let sequence = simplify_by(mesh, placement, Target::Ratio(ratio), by);
    assert_eq!(sequence.report().stop, StopReason::Target, "{:?}", sequence.report());
    let level = sequence.extract(mesh, sequence.len());
    assert!(level.triangles().len() as f64 <= ratio * mesh.triangles().len() as f64);
    level
}

fn back(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    triangles.iter().map(|&[a, b, c]| [a, c, b]).collect()
}

/// A mesh without attributes and its back, on the same vertices.
fn shared(mesh: &Mesh) -> Mesh {
    let triangles = [mesh.triangles().to_vec(), back(mesh.triangles())].concat();
    Mesh::new(mesh.positions(), triangles).unwrap()
}

fn smooth_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0f64; 3]; mesh.positions().len()];
    for corners in mesh.triangles() {
        let n = normal(corners.map(|v| mesh.positions()[v as usize]));
        corners.iter().for_each(|&v| (0..3).for_each(|i| sums[v as usize][i] += n[i]));
    }
    let unit = |n: [f64; 3]| n.map(|x| (x / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt()) as f32);
    sums.into_iter().map(unit).collect()
}

/// The front with its normals.
fn front_with_normals(mesh: &Mesh) -> Mesh {
    mesh.clone().with_attribute(Attribute::floats(names::NORMAL, &smooth_normals(mesh))).unwrap()
}

/// A mesh and its back on vertices of its own, each side with its normals.
fn two_normals(mesh: &Mesh) -> Mesh {
    let count = mesh.positions().len() as u32;
    let behind = back(mesh.triangles()).into_iter().map(|t| t.map(|v| v + count)).collect();
    let normals = smooth_normals(mesh);
    let opposite = normals.iter().map(|n| n.map(|x| -x)).collect();
    let positions = [mesh.positions(), mesh.positions()].concat();
    Mesh::new(positions, [mesh.triangles().to_vec(), behind].concat())
        .and_then(|m| m.with_attribute(Attribute::floats(names::NORMAL, &[normals, opposite].concat())))
        .unwrap()
}

/// The triangles of a mesh by position, from the lowest corner on; in order.
fn placed(mesh: &Mesh, triangles: impl Iterator<Item = usize>) -> Vec<[[u32; 3]; 3]> {
    let place = |t: usize| {
        let [a, b, c] =
            mesh.triangles()[t].map(|v| mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits()));
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
    };
    let mut list: Vec<_> = triangles.map(place).collect();
    list.sort_unstable();
    list
}

fn all_placed(mesh: &Mesh) -> Vec<[[u32; 3]; 3]> {
    placed(mesh, 0..mesh.triangles().len())
}

fn turned(mesh: &Mesh) -> Mesh {
    Mesh::new(mesh.positions(), back(mesh.triangles())).unwrap()
}

/// How often each triangle is there, whichever way it is wound.
fn copies(mesh: &Mesh) -> BTreeMap<[[u32; 3]; 3], usize> {
    let mut copies = BTreeMap::new();
    for mut corners in all_placed(mesh) {
        corners.sort_unstable();
        *copies.entry(corners).or_default() += 1;
    }
    copies
}

fn shuffled(mesh: &Mesh, seed: u32) -> Mesh {
    let mut state = seed;
    let mut triangles = mesh.triangles().to_vec();
    let mut materials = mesh.materials().to_vec();
    for i in (1..triangles.len()).rev() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let j = (state >> 8) as usize % (i + 1);
        triangles.swap(i, j);
        if !materials.is_empty() {
            materials.swap(i, j);
        }
    }
    let attributes = mesh.attributes().to_vec();
    let mesh = Mesh::new(mesh.positions(), triangles).and_then(|m| m.with_materials(materials)).unwrap();
    attributes.into_iter().fold(mesh, |mesh, attribute| mesh.with_attribute(attribute).unwrap())
}

fn singles() -> [(&'static str, Mesh); 3] {
    [
        ("grid", grid(24, 24, |u, v| 0.2 * (u - v) * (1.0 - u) * v)),
        ("rock", shapes::rock(2000, 4)),
        ("card", grid(9, 5, |_, _| 0.0)),
    ]
}

#[test]
fn each_side_of_a_doubled_sheet_is_what_the_single_one_becomes() {
    // By shape alone: with attributes two sides weigh twice as much as one.
    let reached = |mesh: &Mesh, placement: Placement, ratio: f64| {
        reached_by(mesh, placement, ratio, AttributeWeights::Off)
    };
    for (name, single) in singles() {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let expected = reached(&single, placement, 0.1);
            for (kind, doubled, expected) in [
                ("shared", shared(&single), expected.clone()),
                ("normals", two_normals(&single), reached(&front_with_normals(&single), placement, 0.1)),
            ] {
                let level = reached(&doubled, placement, 0.1);
                let half = level.triangles().len() / 2;
                assert_eq!(level.triangles().len(), 2 * expected.triangles().len(), "{name}, {kind}");
                assert_eq!(placed(&level, 0..half), all_placed(&expected), "{name}, {kind}: front");
                assert_eq!(
                    placed(&level, half..2 * half),
                    all_placed(&turned(&expected)),
                    "{name}, {kind}: back"
                );
            }
        }
    }
}

#[test]
fn both_sides_go_together_in_any_order_of_triangles() {
    for (name, single) in singles() {
        for seed in 0..3 {
            for doubled in [shuffled(&shared(&single), seed), shuffled(&two_normals(&single), seed)] {
                let sequence = simplify(&doubled, Placement::Endpoint, Target::Ratio(0.1));
                assert_eq!(sequence.report().stop, StopReason::Target, "{name}: {:?}", sequence.report());
                for steps in [sequence.len() / 3, sequence.len() / 2, sequence.len()] {
                    let level = sequence.extract(&doubled, steps);
                    assert_eq!(all_placed(&level), all_placed(&turned(&level)), "{name}, {steps} steps");
                    assert!(copies(&level).values().all(|&count| count == 2), "{name}, {steps} steps");
                }
            }
        }
    }
}

#[test]
fn the_normals_of_each_side_point_its_way() {
    for single in [grid(24, 24, |u, v| 0.2 * (u - v) * (1.0 - u) * v), shapes::rock(2000, 4)] {
        for placement in [Placement::Endpoint, Placement::Optimal, Placement::Midpoint] {
            let level = reached(&shuffled(&two_normals(&single), 9), placement, 0.2);
            let normals = level.attribute(names::NORMAL).unwrap().as_floats().unwrap();
            let mut along = 0;
            for corners in level.triangles() {
                let facet = normal(corners.map(|v| level.positions()[v as usize]));
                for &v in corners {
                    let own = &normals[3 * v as usize..][..3];
                    let dot: f64 = (0..3).map(|i| facet[i] * f64::from(own[i])).sum();
                    along += usize::from(dot > 0.0);
                }
            }
            // Rocks have ridges, over which a smooth normal may look away from a facet; but from one side only.
            assert!(
                along * 100 > 98 * 3 * level.triangles().len(),
                "{along} of {}",
                3 * level.triangles().len()
            );
        }
    }
}

#[test]
fn each_side_keeps_its_material_and_its_border_with_others() {
    // In front all is 0; behind, 1 turns into 2 half-way.
    let single = grid(20, 20, |_, _| 0.0);
    let left = |corners: &[u32; 3]| corners.iter().all(|&v| single.positions()[v as usize][0] <= 0.5);
    let behind = single.triangles().iter().map(|t| if left(t) { 1 } else { 2 });
    let materials: Vec<u32> = single.triangles().iter().map(|_| 0).chain(behind).collect();
    let mesh = shared(&single).with_materials(materials).unwrap();
    for mesh in [mesh.clone(), shuffled(&mesh, 3)] {
        let sequence = simplify(&mesh, Placement::Endpoint, Target::Error(0.0));
        let level = sequence.extract(&mesh, sequence.len());
        let mut areas = [0.0; 3];
        for (corners, &material) in level.triangles().iter().zip(level.materials()) {
            let n = normal(corners.map(|v| level.positions()[v as usize]));
            assert_eq!(n[2] > 0.0, material == 0, "material {material} looks along {n:?}");
            areas[material as usize] += 0.5 * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        }
        assert!(areas.iter().zip([1.0, 0.5, 0.5]).all(|(a, b)| (a - b).abs() < 1e-6), "{areas:?}");
        // Two rectangles, seen from both sides.
        assert_eq!(level.triangles().len(), 2 * 4, "{:?}", sequence.report());
    }
}

#[test]
fn seams_of_one_side_stay_in_place() {
    // In front a seam at x = 0.5; behind one chart.
    let front = seamed_grid(10, 20, |_, _| 0.0);
    let count = front.positions().len() as u32;
    let first = |v: u32| (0..count).find(|&w| front.positions()[w as usize] == front.positions()[v as usize]);
    let behind = back(front.triangles()).into_iter().map(|t| t.map(|v| first(v).unwrap() + count));
    let triangles: Vec<[u32; 3]> = front.triangles().iter().copied().chain(behind).collect();
    let mut uv = front.attribute(names::UV).unwrap().as_floats().unwrap().to_vec();
    uv.extend(front.positions().iter().flat_map(|p| [20.0 + p[0], p[1]]));
    let uv: Vec<[f32; 2]> = uv.chunks(2).map(|c| [c[0], c[1]]).collect();
    let positions = [front.positions(), front.positions()].concat();
    let mesh =
        Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap();

    let level = reached(&mesh, Placement::Endpoint, 0.05);
    let uv = level.attribute(names::UV).unwrap().as_floats().unwrap();
    let mut area = 0.0;
    for corners in level.triangles() {
        let corner = |i: usize| [uv[2 * corners[i] as usize], uv[2 * corners[i] as usize + 1]].map(f64::from);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        let chart = |p: [f64; 2]| (p[0] / 8.0) as u32;
        assert!(
            chart(a) == chart(b) && chart(b) == chart(c),
            "a triangle spans two charts: {a:?} {b:?} {c:?}"
        );
        area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    }
    assert!((area - 2.0).abs() < 1e-5, "the charts cover {area} of 2");
}

#[test]
fn a_sheet_may_be_doubled_in_part() {
    // A leaf (x over 0.5, two-sided) on a stem (one-sided).
    let single = grid(24, 24, |_, _| 0.0);
    let is_leaf = |t: &&[u32; 3]| t.iter().all(|&v| single.positions()[v as usize][0] >= 0.5);
    let leaf: Vec<[u32; 3]> = single.triangles().iter().filter(is_leaf).copied().collect();
    let triangles = [single.triangles().to_vec(), back(&leaf)].concat();
    let mesh = shuffled(&Mesh::new(single.positions(), triangles).unwrap(), 1);
    let sequence = simplify(&mesh, Placement::Endpoint, Target::Error(0.0));
    let level = sequence.extract(&mesh, sequence.len());
    assert_eq!(level.triangles().len(), 2 + 2 * 2, "{:?}", sequence.report());
    for (corners, times) in copies(&level) {
        let middle: f32 = corners.iter().map(|p| f32::from_bits(p[0]) / 3.0).sum();
        assert_eq!(times, if middle > 0.5 { 2 } else { 1 });
    }
}

#[test]
fn triangles_may_be_there_many_times() {
    let single = shapes::rock(1000, 2);
    let once = single.triangles();
    for layers in
        [vec![once.to_vec(); 2], vec![once.to_vec(); 5], vec![once.to_vec(), back(once), once.to_vec()]]
    {
        let times = layers.len();
        let mesh = shuffled(&Mesh::new(single.positions(), layers.concat()).unwrap(), 5);
        let level = reached(&mesh, Placement::Endpoint, 0.1);
        assert!(copies(&level).values().all(|&count| count == times), "{times} times");
    }
}

#[test]
fn layers_of_more_kinds_than_can_be_kept_are_left_apart() {
    let single = grid(3, 3, |_, _| 0.0);
    let materials: Vec<u32> = (0..12).flat_map(|m| vec![m; single.triangles().len()]).collect();
    let mesh = Mesh::new(single.positions(), [single.triangles(); 12].concat()).unwrap();
    let mesh = mesh.with_materials(materials).unwrap();
    let sequence = simplify(&mesh, Placement::Endpoint, Target::Ratio(0.1));
    let level = sequence.extract(&mesh, sequence.len());
    assert!(copies(&level).values().all(|&count| count == 12));
}

#[test]
fn cards_in_a_heap_are_reduced_on_both_sides() {
    // Forty leaves that curl, each on its own points.
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for card in 0..40u32 {
        let first = positions.len() as u32;
        let (x, y) = ((card % 8) as f32, (card / 8) as f32);
        let leaf = grid_positions(8, 8, |u, v| 0.3 * u * (1.0 - v) * u);
        positions.extend(leaf.iter().map(|p| [p[0] + 1.5 * x, p[1] + 1.5 * y, p[2] + 0.1 * x]));
        triangles.extend(grid_triangles(8, 8, first));
    }
    let level = reached(&two_normals(&Mesh::new(positions, triangles).unwrap()), Placement::Endpoint, 0.1);
    assert!(copies(&level).values().all(|&count| count == 2));
}

#[test]
fn structures_show_both_sides() {
    let mesh = shuffled(&two_normals(&shapes::rock(1500, 8)), 2);
    let sequence = simplify(&mesh, Placement::Endpoint, Target::Ratio(0.05));
    let built = TotallyOrderedMesh::build(&mesh, &sequence).unwrap();
    assert_eq!(built.tom.validate(), Ok(()));
    let hierarchy = VertexHierarchy::build(&mesh, &sequence, Dependencies::Neighbours).unwrap();
    assert_eq!(hierarchy.hierarchy.validate(), Ok(()));
    for steps in [0, sequence.len() / 2, sequence.len()] {
        let level = sequence.extract(&mesh, steps);
        assert_eq!(level.triangles().len(), sequence.triangles_after(steps));
        assert_eq!(Report::welded(&level).border_edges, 0, "{steps} steps");
    }
}
