//! Corners around points, and edges with their half-edges: exact answers on the smallest meshes, and agreement with a
//! plain ordered map on random ones.

use std::collections::BTreeMap;

use multires::mesh::{Adjacency, Edges, shapes};
use proptest::prelude::*;

const NONE: u32 = u32::MAX;

/// ```text
///     3---2
///     |1 /|        half-edges  0: 0->1   1: 1->2   2: 2->0
///     | / |                    3: 0->2   4: 2->3   5: 3->0
///     |/ 0|
///     0---1
/// ```
#[test]
fn a_square_has_one_inner_edge() {
    let square = [[0, 1, 2], [0, 2, 3]];
    let adjacency = Adjacency::new(&square, 5);
    assert_eq!(adjacency.point_count(), 5);
    assert_eq!(adjacency.corners(0), [0, 3]);
    assert_eq!(adjacency.corners(1), [1]);
    assert_eq!(adjacency.corners(2), [2, 4]);
    assert_eq!(adjacency.corners(3), [5]);
    assert!(adjacency.corners(4).is_empty() && adjacency.corners(5).is_empty());
    assert!(adjacency.corners(NONE).is_empty());
    assert_eq!(adjacency.valence(2), 2);

    let edges = Edges::new(&square, 5);
    assert_eq!(edges.ends(), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
    let half_edges: Vec<_> = (0..5).map(|e| edges.half_edges(e).to_vec()).collect();
    assert_eq!(half_edges, [vec![0], vec![3, 2], vec![5], vec![1], vec![4]]);
    assert_eq!((edges.forward(1), edges.backward(1)), (&[3][..], &[2][..]));
    assert_eq!(edges.find(2, 0), Some(1));
    assert_eq!(edges.find(1, 3), None);
    assert!(edges.is_border(0) && !edges.is_border(1) && !edges.is_flipped(1));
    assert_eq!(edges.of_half_edges(2), [[0, 3, 1], [1, 4, 2]]);
    assert!(edges.half_edges(5).is_empty() && edges.forward(NONE).is_empty());
}

/// ```text
///       2                 triangle 1 has been turned over: both run along 0-1 from 0 to 1
///      /0\
///     0-->-1
///      \1/
///       3
/// ```
#[test]
fn two_triangles_the_same_way_are_flipped() {
    let edges = Edges::new(&[[0, 1, 2], [0, 1, 3]], 4);
    assert_eq!((edges.forward(0), edges.backward(0)), (&[0, 3][..], &[][..]));
    assert!(edges.is_flipped(0) && !edges.is_border(0) && !edges.is_non_manifold(0));
    let edges = Edges::new(&[[1, 0, 2], [1, 0, 3]], 4);
    assert_eq!((edges.forward(0), edges.backward(0)), (&[][..], &[0, 3][..]));
    assert!(edges.is_flipped(0));
}

/// ```text
///     .   1   .           three pages on the spine 0-1, the second one facing the other way
///     |\ /|\ /|
///     | ' | ' |           page 0: 1 -> 0 in triangle 1; page 1: 0 -> 1 in triangle 3; page 2: 1 -> 0 in triangle 5
///     .   0   .
/// ```
#[test]
fn a_book_has_a_non_manifold_spine() {
    let book = shapes::book(3);
    let edges = Edges::new(book.triangles(), book.positions().len());
    assert_eq!(edges.ends()[0], [0, 1]);
    assert_eq!(edges.forward(0), [9]);
    assert_eq!(edges.backward(0), [5, 17]);
    assert!(edges.is_non_manifold(0) && !edges.is_flipped(0));
    assert_eq!(edges.len(), 1 + 3 * 4);
}

/// ```text
///      .---.        both triangles have all three edges, one each way
///      \0 1/
///       \ /         corners 0 1 2 and 2 1 0
///        .
/// ```
#[test]
fn a_pillow_is_closed() {
    let pillow = shapes::pillow();
    let edges = Edges::new(pillow.triangles(), 3);
    assert_eq!(edges.ends(), [[0, 1], [0, 2], [1, 2]]);
    let half_edges: Vec<_> = (0..3).map(|e| [edges.forward(e), edges.backward(e)].concat()).collect();
    assert_eq!(half_edges, [[0, 4], [5, 2], [1, 3]]);
}

/// ```text
///     0---0---1      0---9---1       a repeated point, and points that do not exist, make no edges
/// ```
#[test]
fn broken_triangles_have_no_edges() {
    let triangles = [[0, 0, 1], [0, 1, 9], [NONE, NONE, NONE], [2, 1, 0]];
    let edges = Edges::new(&triangles, 3);
    assert_eq!(edges.ends(), [[0, 1], [0, 2], [1, 2]]);
    assert!((0..3).all(|e| edges.is_border(e)));
    assert_eq!(edges.of_half_edges(4), [[NONE; 3], [NONE; 3], [NONE; 3], [2, 0, 1]]);
    let adjacency = Adjacency::new(&triangles, 3);
    assert_eq!(adjacency.corners(0), [0, 1, 3, 11]);
    assert_eq!(adjacency.corners(1), [2, 4, 10]);
    assert_eq!(adjacency.corners(2), [9]);
    assert!(Edges::new(&[], 0).is_empty() && Edges::new(&[[0, 1, 2]], 0).is_empty());
    assert!(Adjacency::default().corners(0).is_empty());
}

/// A point in 100 000 triangles, and an edge in as many.
#[test]
fn high_valence_is_no_trouble() {
    let n = 100_000;
    let hub = shapes::hub(n);
    let edges = Edges::new(hub.triangles(), hub.positions().len());
    assert_eq!(edges.len(), 2 * n as usize);
    assert_eq!(Adjacency::new(hub.triangles(), hub.positions().len()).valence(0), n as usize);
    let book = shapes::book(n);
    let edges = Edges::new(book.triangles(), book.positions().len());
    assert_eq!(edges.half_edges(0).len(), n as usize);
}

proptest! {
    #[test]
    fn any_triangles_agree_with_an_ordered_map(
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 0..60),
    ) {
        let points = 10;
        let mut expected: BTreeMap<[u32; 2], [Vec<u32>; 2]> = BTreeMap::new();
        let mut corners = vec![Vec::new(); points];
        for (t, &triangle) in triangles.iter().enumerate() {
            for (k, &point) in triangle.iter().enumerate() {
                if let Some(list) = corners.get_mut(point as usize) {
                    list.push((3 * t + k) as u32);
                }
            }
            let [a, b, c] = triangle;
            if a == b || b == c || c == a || triangle.iter().any(|&p| p as usize >= points) {
                continue;
            }
            for (k, [from, to]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                let ways = expected.entry([from.min(to), from.max(to)]).or_default();
                ways[usize::from(from > to)].push((3 * t + k) as u32);
            }
        }
        let edges = Edges::new(&triangles, points);
        prop_assert_eq!(edges.ends(), expected.keys().copied().collect::<Vec<_>>());
        for (edge, ways) in expected.values().enumerate() {
            prop_assert_eq!(edges.forward(edge as u32), &ways[0][..]);
            prop_assert_eq!(edges.backward(edge as u32), &ways[1][..]);
        }
        let adjacency = Adjacency::new(&triangles, points);
        for (point, list) in corners.iter().enumerate() {
            prop_assert_eq!(adjacency.corners(point as u32), &list[..]);
        }
    }
}
