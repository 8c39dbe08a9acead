//! Wavelet meshes of uneven depth: faces split at random, faces at a common edge by at most one level apart.

use std::collections::{BTreeMap, BTreeSet};

use multires::mesh::{Mesh, Topology};
use multires::wavelet::{Face, WaveletBuilder, WaveletMesh, WaveletOptions};

use super::next;

/// How faces are chosen.
#[derive(Debug, Clone, Copy)]
pub enum Chosen {
    /// Each face alone, with this chance in 256.
    Alone(u64),
    /// All faces near some places, nearer the deeper, with this chance in 256 of a place at a base face.
    Near(u64),
}

/// A side of a face: its ends, and whether it lies on a side of the base with a seam.
type Side = ([u32; 2], bool);

/// Splits the faces of a base at random.
pub fn uneven(base: &Mesh, levels: usize, chosen: Chosen, seed: u64) -> WaveletMesh {
    let topology = Topology::new(base);
    let mut state = seed;
    let point = |v: u32| topology.point_of()[v as usize];
    let seams = seams(base, &topology);
    let mut builder = WaveletBuilder::new(base).unwrap();
    let mut points: Vec<u32> = (0..base.positions().len() as u32).map(point).collect();
    let centres: Vec<bool> =
        base.triangles().iter().map(|_| next(&mut state) % 256 < chance(chosen)).collect();
    // Sides of unsplit faces of the last level but one, by their halves.
    let mut coarse: BTreeSet<[u32; 2]> = BTreeSet::new();
    for level in 0..levels {
        let mut faces: Vec<([Side; 3], bool)> = Vec::new();
        // Splits nothing: only lists faces.
        builder
            .subdivide_where(
                |face| {
                    let wanted = match chosen {
                        Chosen::Alone(chance) => next(&mut state) % 256 < chance,
                        Chosen::Near(_) => centres[face.base_face as usize] && is_near(face, level),
                    };
                    faces.push((sides(face, &points, &seams), wanted));
                    false
                },
                |midpoint| midpoint.middle,
            )
            .unwrap();
        let may = |sides: &[Side; 3]| sides.iter().all(|side| !coarse.contains(&side.0));
        let mut split: Vec<bool> = faces.iter().map(|(sides, wanted)| *wanted && may(sides)).collect();
        drag(&faces, &mut split, &may);
        let mut at = 0;
        let mut ends = Vec::new();
        builder
            .subdivide_where(
                |_| {
                    at += 1;
                    split[at - 1]
                },
                |midpoint| {
                    ends.push(midpoint.ends.map(|end| points[end as usize]));
                    // Somewhere off the middle, so that positions tell nothing.
                    let bump = next(&mut state) % 1024;
                    let [x, y, z] = midpoint.middle;
                    [x, y, z + bump as f32 / 4096.0]
                },
            )
            .unwrap();
        if ends.is_empty() {
            continue;
        }
        let first = points.len() as u32;
        let midpoint_of: BTreeMap<[u32; 2], u32> = (first..)
            .zip(&ends)
            .map(|(vertex, &[a, b])| ([a.min(b), a.max(b)], vertex + 1_000_000))
            .collect();
        points.extend((first..).take(ends.len()).map(|vertex| vertex + 1_000_000));
        coarse.clear();
        for (sides, _) in faces.iter().zip(&split).filter(|(_, split)| !**split).map(|(face, _)| face) {
            for ([a, b], _) in sides {
                if let Some(&m) = midpoint_of.get(&[*a, *b]) {
                    coarse.extend([[*a, m], [*b, m]].map(|[a, b]| [a.min(b), a.max(b)]));
                }
            }
        }
    }
    builder.build(&WaveletOptions::default()).unwrap()
}

fn chance(chosen: Chosen) -> u64 {
    match chosen {
        Chosen::Alone(chance) | Chosen::Near(chance) => chance,
    }
}

/// Whether a face is near the first corner of its base face.
fn is_near(face: &Face, level: usize) -> bool {
    face.barycentric.iter().any(|weights| weights[0] > 1.0 - 0.7f64.powi(level as i32))
}

/// Leaves out faces across a seam from unsplit ones, after adding those that may be added.
fn drag(faces: &[([Side; 3], bool)], split: &mut [bool], may: &impl Fn(&[Side; 3]) -> bool) {
    let on_seams: Vec<(usize, [u32; 2])> = (0..faces.len())
        .flat_map(|face| faces[face].0.iter().filter(|side| side.1).map(move |side| (face, side.0)))
        .collect();
    loop {
        let wanted: BTreeSet<[u32; 2]> =
            on_seams.iter().filter(|(face, _)| split[*face]).map(|(_, side)| *side).collect();
        let added: Vec<usize> = on_seams
            .iter()
            .filter(|(face, side)| wanted.contains(side) && !split[*face] && may(&faces[*face].0))
            .map(|(face, _)| *face)
            .collect();
        if added.is_empty() {
            break;
        }
        added.into_iter().for_each(|face| split[face] = true);
    }
    loop {
        let unsplit: BTreeSet<[u32; 2]> =
            on_seams.iter().filter(|(face, _)| !split[*face]).map(|(_, side)| *side).collect();
        let torn: Vec<usize> = on_seams
            .iter()
            .filter(|(face, side)| unsplit.contains(side) && split[*face])
            .map(|(face, _)| *face)
            .collect();
        if torn.is_empty() {
            break;
        }
        torn.into_iter().for_each(|face| split[face] = false);
    }
}

/// Per base face, which sides are seams.
fn seams(base: &Mesh, topology: &Topology) -> Vec<[bool; 3]> {
    let mut first: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
    let ends = |t: &[u32; 3], k: usize| {
        let [a, b] = [t[k], t[(k + 1) % 3]];
        let points = [a, b].map(|v| topology.point_of()[v as usize]);
        let wedges = [a, b].map(|v| topology.wedge_of()[v as usize]);
        if points[0] < points[1] {
            (points, wedges)
        } else {
            ([points[1], points[0]], [wedges[1], wedges[0]])
        }
    };
    let mut torn: BTreeSet<[u32; 2]> = BTreeSet::new();
    for triangle in base.triangles() {
        for k in 0..3 {
            let (points, wedges) = ends(triangle, k);
            if *first.entry(points).or_insert(wedges) != wedges {
                torn.insert(points);
            }
        }
    }
    base.triangles().iter().map(|t| [0, 1, 2].map(|k| torn.contains(&ends(t, k).0))).collect()
}

fn sides(face: &Face, points: &[u32], seams: &[[bool; 3]]) -> [Side; 3] {
    [0, 1, 2].map(|k| {
        let [a, b] = [k, (k + 1) % 3];
        let [p, q] = [a, b].map(|corner| points[face.vertices[corner] as usize]);
        let on = |side: usize| {
            let opposite = (side + 2) % 3;
            face.barycentric[a][opposite] == 0.0 && face.barycentric[b][opposite] == 0.0
        };
        let on_seam = (0..3).any(|side| on(side) && seams[face.base_face as usize][side]);
        ([p.min(q), p.max(q)], on_seam)
    })
}
