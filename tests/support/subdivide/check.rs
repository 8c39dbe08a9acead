//! What the documentation of a recognition promises of any mesh, asked from the forest alone.

use std::collections::BTreeMap;

use multires::mesh::{Mesh, Topology};
use multires::wavelet::Recognition;

const NONE: u32 = u32::MAX;

/// Asks of a recognition all that its documentation says of any.
pub fn check(mesh: &Mesh, found: &Recognition) {
    let forest = &found.quadrisection;
    let (split, leaves) = (forest.split(), forest.leaves());
    assert_eq!((split.len(), leaves.len()), (forest.len(), forest.len()));

    // Every triangle is one leaf; levels follow each other.
    let mut triangles: Vec<u32> = leaves.iter().filter(|&&leaf| leaf != NONE).map(|leaf| leaf / 3).collect();
    triangles.sort_unstable();
    assert_eq!(triangles, (0..mesh.triangles().len() as u32).collect::<Vec<_>>());
    assert_eq!(forest.triangles(), triangles.len());
    assert!(split.iter().zip(leaves).all(|(&split, &leaf)| split == (leaf == NONE)));
    assert_eq!(forest.level(0), 0..forest.base_faces());
    for level in 0..=forest.levels() {
        let splits = forest.level(level).filter(|&face| split[face]).count();
        assert_eq!(forest.level(level + 1), forest.level(level).end..forest.level(level).end + 4 * splits);
        assert_eq!(splits == 0, level == forest.levels());
    }

    // Components: their triangles, base faces and levels.
    let mut lowest: Vec<u32> =
        leaves.iter().map(|&leaf| if leaf == NONE { NONE } else { leaf / 3 }).collect();
    let (mut depth, mut leaf_count) = (vec![0; forest.len()], vec![1; forest.len()]);
    let splits: Vec<_> = forest.splits().collect();
    for &(face, first) in splits.iter().rev() {
        let four = first..first + 4;
        assert!(depth[four.clone()].iter().all(|&d| d == depth[first]), "levels differ in one component");
        depth[face] = depth[first] + 1;
        lowest[face] = *lowest[four.clone()].iter().min().unwrap();
        leaf_count[face] = leaf_count[four].iter().sum();
    }
    let mut base = 0;
    for component in &found.components {
        let own =
            component.first_base_face as usize..(component.first_base_face + component.base_faces) as usize;
        assert_eq!(own.start, base);
        base = own.end;
        assert!(depth[own.clone()].iter().all(|&d| d == component.levels));
        assert_eq!(leaf_count[own.clone()].iter().sum::<u32>(), component.triangles);
        assert_eq!(lowest[own.start], component.first_triangle);
        assert!(lowest[own].is_sorted());
        assert!(!component.to_string().is_empty());
    }
    assert_eq!(base, forest.base_faces());
    assert!(found.components.is_sorted_by_key(|c| c.first_triangle));

    // Corners by wedge; distinct points; one material.
    let topology = Topology::new(mesh);
    let wedges: Vec<_> =
        mesh.triangles().iter().map(|t| t.map(|v| topology.wedge_of()[v as usize])).collect();
    let corners = forest.corners(&wedges);
    let mut material: Vec<u32> = leaves
        .iter()
        .map(|&leaf| mesh.materials().get((leaf / 3) as usize).copied().unwrap_or(NONE))
        .collect();
    for &(face, first) in splits.iter().rev() {
        let [c0, c1, c2] = corners[face];
        let [m0, m1, m2] = corners[first + 3];
        assert_eq!(corners[first..first + 3], [[c0, m0, m2], [c1, m1, m0], [c2, m2, m1]]);
        let points = [c0, c1, c2].map(|v| topology.point_of()[v as usize]);
        assert!(points[0] != points[1] && points[1] != points[2] && points[2] != points[0]);
        material[face] = material[first];
        assert!(material[first..first + 4].iter().all(|&m| m == material[face]));
    }
    for &(face, _) in splits.iter().filter(|&&(face, _)| face < forest.base_faces()) {
        assert!(corners[face].iter().all(|&v| v >= corners[face][0]));
    }

    // Edges: inner ones have a centre and a corner face, outer ones the same two halves in all faces along them.
    let mut by_points = BTreeMap::new();
    let mut pairs = BTreeMap::new();
    let mut uses: BTreeMap<u32, u32> = BTreeMap::new();
    let mut edges = vec![[NONE; 3]; forest.len()];
    let mut mate: BTreeMap<u32, u32> = BTreeMap::new();
    let mut fresh = 0..;
    for face in (0..forest.len()).filter(|&face| !split[face]) {
        let points = corners[face].map(|v| topology.point_of()[v as usize]);
        if points[0] == points[1] || points[1] == points[2] || points[2] == points[0] {
            continue;
        }
        edges[face] = [0, 1, 2].map(|k| {
            let (a, b) = (points[k], points[(k + 1) % 3]);
            *by_points.entry([a.min(b), a.max(b)]).or_insert_with(|| fresh.next().unwrap())
        });
        edges[face].iter().for_each(|&edge| *uses.entry(edge).or_default() += 1);
    }
    for &(face, first) in splits.iter().rev() {
        for k in 0..3 {
            let inner = edges[first + 3][k];
            assert_eq!(inner, edges[first + (k + 1) % 3][1]);
            assert_eq!(uses[&inner], 2, "an inner edge has other faces");
            let halves = [edges[first + k][0], edges[first + (k + 1) % 3][2]];
            for (a, b) in [(halves[0], halves[1]), (halves[1], halves[0])] {
                assert_eq!(*mate.entry(a).or_insert(b), b, "halves do not belong together");
            }
            let key = [halves[0].min(halves[1]), halves[0].max(halves[1])];
            let edge = *pairs.entry(key).or_insert_with(|| fresh.next().unwrap());
            edges[face][k] = edge;
            *uses.entry(edge).or_default() += 1;
        }
    }
}
