//! Promise: a triangle with two corners at one place is degenerate for every structure alike, also where the corners are
//! different wedges: none draws it, and a mesh without borders has none at any level.

use std::collections::BTreeMap;

use crate::support::lod::{Random, bake_hierarchy, bake_tom};
use crate::support::naive;
use multires::hierarchy::Dependencies;
use multires::lod::{Lod, LodOptions, Values};
use multires::mesh::{Mesh, Topology, shapes};
use multires::simplify::{CollapseSequence, Placement, ProgressiveMesh, Simplifier};
use multires::view::Motion;

type Place = [u32; 3];

fn places(mesh: &Mesh, corners: [u32; 3]) -> [Place; 3] {
    corners.map(|v| mesh.positions()[v as usize].map(|x| (x + 0.0).to_bits()))
}

fn has_zero_edge([a, b, c]: [Place; 3]) -> bool {
    a == b || b == c || c == a
}

/// Edges, by place, of an odd number of triangles.
fn odd_edges(mesh: &Mesh) -> usize {
    let mut count: BTreeMap<[Place; 2], usize> = BTreeMap::new();
    for &corners in mesh.triangles() {
        let [a, b, c] = places(mesh, corners);
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if a != b {
                *count.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
    }
    count.values().filter(|&&n| n % 2 == 1).count()
}

/// Shrinks some edges between two points of several wedges to length zero: all wedges of one point move to the other.
fn snapped(mesh: Mesh) -> Mesh {
    let topology = Topology::new(&mesh);
    let point = |v: u32| topology.point_of()[v as usize];
    let mut wedges = vec![0; topology.point_count()];
    let named = (0..mesh.positions().len() as u32).filter(|&v| topology.wedge_of()[v as usize] == v);
    named.for_each(|v| wedges[point(v) as usize] += 1);
    // Points that have moved, or were moved to.
    let mut done = vec![false; topology.point_count()];
    let mut goal: Vec<u32> = (0..topology.point_count() as u32).collect();
    for corners in mesh.triangles() {
        for i in 0..3 {
            let [p, q] = [corners[i], corners[(i + 1) % 3]].map(point);
            let both = wedges[p as usize] > 1 && wedges[q as usize] > 1;
            if both && p != q && !done[p as usize] && !done[q as usize] {
                goal[p as usize] = q;
                (done[p as usize], done[q as usize]) = (true, true);
            }
        }
    }
    let place =
        |v: u32| mesh.positions()[topology.vertex_of_point()[goal[point(v) as usize] as usize] as usize];
    let positions: Vec<[f32; 3]> = (0..mesh.positions().len() as u32).map(place).collect();
    let mut moved = Mesh::new(positions, mesh.triangles()).unwrap().with_materials(mesh.materials()).unwrap();
    for attribute in mesh.attributes() {
        moved = moved.with_attribute(attribute.clone()).unwrap();
    }
    moved
}

/// Closed meshes with seams, some of whose edges have no length and two wedges at the one place.
fn inputs() -> Vec<Mesh> {
    let shapes = [
        shapes::uv_sphere(14, 9),
        shapes::torus_knot(2, 3, 60, 6),
        shapes::box_with_face_normals(4),
        naive::torus(12, 9, true, true),
    ];
    let inputs: Vec<Mesh> = shapes.into_iter().map(snapped).collect();
    for mesh in &inputs {
        let topology = Topology::new(mesh);
        let wedges = |corners: [u32; 3]| corners.map(|v| topology.wedge_of()[v as usize]);
        let parted = |&&t: &&[u32; 3]| has_zero_edge(places(mesh, t)) && !naive::degenerate(wedges(t));
        assert!(mesh.triangles().iter().filter(parted).count() >= 4, "zero-length edges between wedges");
        assert_eq!(odd_edges(mesh), 0);
    }
    inputs
}

fn check(level: &Mesh, what: &str) {
    assert_eq!(odd_edges(level), 0, "{what}: odd edges of {} triangles", level.triangles().len());
    let stray = level.triangles().iter().filter(|&&t| has_zero_edge(places(level, t))).count();
    assert_eq!(stray, 0, "{what}: triangles with a zero-length edge of {}", level.triangles().len());
}

fn sequences(mesh: &Mesh) -> Vec<CollapseSequence> {
    let placements = [Placement::Endpoint, Placement::Midpoint];
    placements.map(|placement| Simplifier::new().placement(placement).run(mesh).unwrap()).into()
}

#[test]
fn the_sequence_and_its_progressive_mesh() {
    for mesh in inputs() {
        for sequence in sequences(&mesh) {
            let mut progressive = ProgressiveMesh::new(&mesh, &sequence).unwrap();
            for steps in 1..=sequence.len() {
                let level = sequence.extract(&mesh, steps);
                check(&level, "sequence");
                assert_eq!(level.triangles().len(), sequence.triangles_after(steps));
                progressive.seek(steps);
                let shown = Mesh::new(progressive.positions(), progressive.triangles()).unwrap();
                check(&shown, "progressive mesh");
                assert_eq!(shown.triangles().len(), level.triangles().len());
            }
        }
    }
}

#[test]
fn the_totally_ordered_mesh() {
    for mesh in inputs() {
        let sequence = Simplifier::new().run(&mesh).unwrap();
        let ordered = bake_tom(&mesh, &sequence);
        let tom = ordered.structure();
        let mut resolution = tom.finest();
        let drawn = tom.triangle_count();
        assert_eq!(drawn, sequence.triangles_after(0), "triangles at full resolution");
        loop {
            check(&ordered.mesh_at(resolution), "totally ordered mesh");
            match tom.coarser(resolution) {
                Some(coarser) => resolution = coarser,
                None => break,
            }
        }
    }
}

#[test]
fn the_vertex_hierarchy() {
    for mesh in inputs() {
        for sequence in sequences(&mesh) {
            let bundle = bake_hierarchy(&mesh, &sequence, Dependencies::None);
            let hierarchy = bundle.structure();
            assert_eq!(hierarchy.triangle_count(), sequence.triangles_after(0));
            let none = Values::none(hierarchy.vertex_count());
            let mut lod = bundle.instance(none, &LodOptions::default()).unwrap();
            check(&lod.to_mesh(), "hierarchy, coarsest");
            for (seed, share) in [100, 80, 60, 40, 20].into_iter().enumerate() {
                let asked = Random::new(hierarchy, seed as u64 + 1, share);
                lod.adapt_by(&asked, Motion::Other, 0.0);
                check(&lod.to_mesh(), "hierarchy");
            }
        }
    }
}

/// Substitutions from elsewhere: the zero-length triangles are degenerate before the first of them.
#[test]
fn a_sequence_from_elsewhere() {
    for mesh in inputs() {
        let steps = naive::simplify(&mesh, 20);
        let sequence = CollapseSequence::from_substitutions(&mesh, steps).unwrap();
        let flat = mesh.triangles().iter().map(|&t| has_zero_edge(places(&mesh, t)));
        let ends = sequence.triangle_ends().iter().map(|&end| end == 0);
        assert!(flat.eq(ends), "degenerate triangles, and no others, are gone after 0 steps");
        let ordered = bake_tom(&mesh, &sequence);
        check(&ordered.mesh_at(ordered.structure().finest()), "totally ordered mesh");
    }
}
