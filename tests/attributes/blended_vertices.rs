//! Promise: a vertex that a collapse or a subdivision makes carries what a renderer may use: influences of its sources'
//! joints that sum to what they should, unit normals, tangents beside them of one handedness, values between its sources'.

use multires::mesh::{Attribute, AttributeValues, Mesh, names, shapes};
use multires::simplify::{CollapseSequence, Origin, Placement, Simplifier, Target};
use multires::wavelet::{WaveletBuilder, WaveletOptions};

const JOINTS: usize = 12;

/// What each joint weighs at a position: tents along z, at most three at a time.
fn influence(p: [f32; 3]) -> [f64; JOINTS] {
    let z = f64::from(p[2]) * 2.0 + 6.0;
    let tents: [f64; JOINTS] = std::array::from_fn(|joint| (1.5 - (z - joint as f64).abs()).max(0.0));
    let sum: f64 = tents.iter().sum();
    tents.map(|weight| weight / sum)
}

/// Joints and weights of every vertex, in `slots` slots whose order differs from vertex to vertex.
fn slots(mesh: &Mesh, slots: usize) -> (Vec<u32>, Vec<f64>) {
    let (mut joints, mut weights) = (Vec::new(), Vec::new());
    for (vertex, &p) in mesh.positions().iter().enumerate() {
        let weight = influence(p);
        let mut row = vec![(0, 0.0); slots];
        for (i, joint) in (0..JOINTS).filter(|&joint| weight[joint] > 0.0).enumerate() {
            row[(i * 3 + vertex) % slots] = (joint as u32, weight[joint]);
        }
        joints.extend(row.iter().map(|&(joint, _)| joint));
        weights.extend(row.iter().map(|&(_, weight)| weight));
    }
    (joints, weights)
}

/// Columns `from..from + 4` of rows of `width`.
fn columns<T: Copy>(values: &[T], width: usize, from: usize) -> Vec<T> {
    values.chunks(width).flat_map(|row| &row[from..from + 4]).copied().collect()
}

fn with(mesh: Mesh, name: &str, values: AttributeValues) -> Mesh {
    mesh.with_attribute(Attribute::new(name, 4, values)).unwrap()
}

fn skinned(mesh: Mesh) -> Mesh {
    let (joints, weights) = slots(&mesh, 4);
    let mesh = with(mesh, names::JOINTS, AttributeValues::Uint(joints));
    with(mesh, names::WEIGHTS, AttributeValues::Float(weights.iter().map(|&w| w as f32).collect()))
}

/// What the joints of a vertex weigh, over all sets.
fn dense(mesh: &Mesh, vertex: usize) -> [f64; JOINTS] {
    let mut dense = [0.0; JOINTS];
    for set in ["", "1"] {
        let find = |name: &str| mesh.attribute(&format!("{name}{set}"));
        let (Some(joints), Some(weights)) = (find(names::JOINTS), find(names::WEIGHTS)) else { continue };
        let AttributeValues::Uint(joints) = joints.values() else { panic!("joints are labels") };
        for slot in 4 * vertex..4 * vertex + 4 {
            dense[joints[slot] as usize] += match weights.values() {
                AttributeValues::Float(weights) => f64::from(weights[slot]),
                AttributeValues::Uint(weights) => f64::from(weights[slot]),
                _ => panic!("weights are numbers"),
            };
        }
    }
    dense
}

/// The vertices of a level as the sequence numbers them, in the order in which `extract` puts them.
fn sources(sequence: &CollapseSequence, mesh: &Mesh) -> Vec<u32> {
    let (triangles, _) = sequence.triangles_at(mesh, sequence.len());
    let mut seen = vec![false; mesh.positions().len() + sequence.new_vertices().len()];
    let corners = triangles.into_iter().flatten();
    corners.filter(|&v| !std::mem::replace(&mut seen[v as usize], true)).collect()
}

/// A level with so many new vertices that most of its vertices are new, and how it came about.
fn simplified(mesh: &Mesh, placement: Placement) -> (Mesh, CollapseSequence) {
    let mut simplifier = Simplifier::new().placement(placement).target(Target::Ratio(0.2));
    let sequence = simplifier.run(mesh).unwrap();
    let level = sequence.extract(mesh, sequence.len());
    let new = sources(&sequence, mesh).iter().filter(|&&v| v as usize >= mesh.positions().len()).count();
    assert!(2 * new > level.positions().len(), "{new} of {} are new", level.positions().len());
    (level, sequence)
}

/// Of every vertex of a sequence what its joints weigh: blended over all joints at once.
fn expected(mesh: &Mesh, sequence: &CollapseSequence) -> Vec<[f64; JOINTS]> {
    let mut all: Vec<_> = (0..mesh.positions().len()).map(|v| dense(mesh, v)).collect();
    for new in sequence.new_vertices() {
        let [a, b] = new.from.map(|v| all[v as usize]);
        let share = f64::from(new.weight);
        all.push(std::array::from_fn(|joint| (1.0 - share) * a[joint] + share * b[joint]));
    }
    all
}

fn sum(weights: &[f64]) -> f64 {
    weights.iter().sum()
}

#[test]
fn joints_and_weights_are_blended_as_sets() {
    let mesh = skinned(shapes::rock(3000, 5));
    for placement in [Placement::Optimal, Placement::Midpoint] {
        let (level, sequence) = simplified(&mesh, placement);
        let expected = expected(&mesh, &sequence);
        let mut exact = 0;
        for (vertex, source) in sources(&sequence, &mesh).into_iter().enumerate() {
            let (found, expected) = (dense(&level, vertex), expected[source as usize]);
            assert!((sum(&found) - 1.0).abs() < 1e-6, "vertex {vertex} sums to {}", sum(&found));
            // Only joints that its sources had, and where four suffice their weights.
            for joint in 0..JOINTS {
                assert!(found[joint] == 0.0 || expected[joint] > 0.0, "vertex {vertex}: joint {joint}");
            }
            if expected.iter().filter(|&&w| w > 0.0).count() <= 4 {
                exact += 1;
                let off = (0..JOINTS).map(|j| (found[j] - expected[j]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-5, "vertex {vertex} is off by {off}: {found:?}, not {expected:?}");
            }
        }
        assert!(4 * exact > 3 * level.positions().len(), "{exact} of {}", level.positions().len());
    }
}

#[test]
fn two_sets_of_joints_are_one_set_of_influences() {
    let mesh = shapes::rock(2000, 3);
    let (joints, weights) = slots(&mesh, 8);
    let mut mesh = mesh;
    for (set, from) in [("", 0), ("1", 4)] {
        let weights = columns(&weights, 8, from).into_iter().map(|w| w as f32).collect();
        let joints = AttributeValues::Uint(columns(&joints, 8, from));
        mesh = with(mesh, &format!("{}{set}", names::JOINTS), joints);
        mesh = with(mesh, &format!("{}{set}", names::WEIGHTS), AttributeValues::Float(weights));
    }
    let (level, sequence) = simplified(&mesh, Placement::Midpoint);
    let expected = expected(&mesh, &sequence);
    for (vertex, source) in sources(&sequence, &mesh).into_iter().enumerate() {
        let found = dense(&level, vertex);
        assert!((sum(&found) - 1.0).abs() < 1e-6);
        let off = (0..JOINTS).map(|j| (found[j] - expected[source as usize][j]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3, "vertex {vertex} is off by {off}");
    }
}

#[test]
fn weights_stored_as_integers_keep_their_sum_exactly() {
    for whole in [255u32, 65535] {
        let mesh = shapes::rock(2000, 7);
        let (joints, weights) = slots(&mesh, 4);
        let mut stored: Vec<u32> = weights.iter().map(|w| (w * f64::from(whole)) as u32).collect();
        for row in stored.chunks_mut(4) {
            let most = (0..4).max_by_key(|&i| row[i]).unwrap();
            row[most] += whole - row.iter().sum::<u32>();
        }
        let mesh = with(mesh, names::JOINTS, AttributeValues::Uint(joints));
        let mesh = with(mesh, names::WEIGHTS, AttributeValues::Uint(stored));
        let (level, sequence) = simplified(&mesh, Placement::Optimal);
        let expected = expected(&mesh, &sequence);
        for (vertex, source) in sources(&sequence, &mesh).into_iter().enumerate() {
            let found = dense(&level, vertex);
            assert_eq!(sum(&found), f64::from(whole), "vertex {vertex}");
            if expected[source as usize].iter().filter(|&&w| w > 0.0).count() <= 4 {
                // Rounded once for every blend that it is made of.
                let off = (0..JOINTS).map(|j| (found[j] - expected[source as usize][j]).abs());
                assert!(off.fold(0.0, f64::max) < 8.0);
            }
        }
    }
}

#[test]
fn influences_without_weight_do_not_thin_out_the_others() {
    // The second end is not skinned at all: weights of 0 throughout.
    let mesh = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0]], [[0, 1, 2]]).unwrap();
    let joints = [3, 5, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0];
    let weights = [0.75, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mesh = with(mesh, names::JOINTS, AttributeValues::Uint(joints.into()));
    let mesh = with(mesh, names::WEIGHTS, AttributeValues::Float(weights.into()));
    let new = multires::simplify::NewVertex { from: [0, 1], weight: 0.5, position: [0.5, 0.5, 0.0] };
    let step = ([[0, 4]], 0.0);
    let sequence = CollapseSequence::from_collapses(&mesh, &[new], [step]).unwrap();
    let level = sequence.extract(&mesh, 1);
    let found = dense(&level, 0);
    assert_eq!((found[3], found[5], sum(&found)), (0.75, 0.25, 1.0));
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn vector(values: &[f32], vertex: usize, width: usize) -> [f64; 3] {
    std::array::from_fn(|i| f64::from(values[vertex * width + i]))
}

/// A sphere with normals, tangents and colours; handedness differs from the half with `x < 0` to the other, without a
/// seam between.
fn shaded() -> Mesh {
    let mesh = shapes::rock(4000, 9);
    let (mut normals, mut tangents, mut colours) = (Vec::new(), Vec::new(), Vec::new());
    for &[x, y, z] in mesh.positions() {
        let length = (x * x + y * y + z * z).sqrt();
        let n = [x, y, z].map(|c| c / length);
        // Beside the normal: about y, and about x near the poles.
        let t = if n[1].abs() < 0.9 { [n[2], 0.0, -n[0]] } else { [0.0, -n[2], n[1]] };
        let long = (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt();
        normals.push(n);
        tangents.push([t[0] / long, t[1] / long, t[2] / long, if x < 0.0 { -1.0 } else { 1.0 }]);
        colours.push([if y > 0.0 { 1.0 } else { 0.0 }, 0.5 + 0.5 * n[0], 0.1, 1.0]);
    }
    mesh.with_attribute(Attribute::floats(names::NORMAL, &normals))
        .and_then(|mesh| mesh.with_attribute(Attribute::floats(names::TANGENT, &tangents)))
        .and_then(|mesh| mesh.with_attribute(Attribute::floats(names::COLOR, &colours)))
        .unwrap()
}

fn assert_shaded(level: &Mesh, what: &str) {
    let floats = |name: &str| level.attribute(name).unwrap().as_floats().unwrap();
    let (normals, tangents) = (floats(names::NORMAL), floats(names::TANGENT));
    for vertex in 0..level.positions().len() {
        let (n, t) = (vector(normals, vertex, 3), vector(tangents, vertex, 4));
        let hand = tangents[4 * vertex + 3];
        assert!((dot(n, n).sqrt() - 1.0).abs() < 1e-4, "{what}: vertex {vertex} has the normal {n:?}");
        assert!((dot(t, t).sqrt() - 1.0).abs() < 1e-4, "{what}: vertex {vertex} has the tangent {t:?}");
        assert!(dot(n, t).abs() < 1e-3, "{what}: vertex {vertex}: {t:?} is not beside {n:?}");
        assert!(hand == 1.0 || hand == -1.0, "{what}: vertex {vertex} has handedness {hand}");
    }
    assert!(floats(names::COLOR).iter().all(|c| (0.0..=1.0).contains(c)), "{what}: colours");
}

#[test]
fn normals_tangents_and_colours_stay_what_they_are() {
    let mesh = shaded();
    for placement in [Placement::Optimal, Placement::Midpoint] {
        let (level, _) = simplified(&mesh, placement);
        assert_shaded(&level, "simplified");
    }
    let mut builder = WaveletBuilder::new(&mesh).unwrap();
    builder.subdivide(|midpoint| midpoint.middle).unwrap();
    let wavelets = builder.build(&WaveletOptions::default()).unwrap();
    assert!(wavelets.vertices().positions().len() > 2 * mesh.positions().len());
    assert_shaded(wavelets.vertices(), "subdivided");
}

#[test]
fn a_blend_is_a_copy_where_it_has_one_source() {
    // Not of unit length, not beside each other, not summing to 1: what the input holds is nobody's to mend.
    let mesh = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]).unwrap();
    let mesh = mesh.with_attribute(Attribute::floats(names::NORMAL, &[[3.0, 0.5, 0.25f32]; 3])).unwrap();
    let mesh = with(mesh, names::JOINTS, AttributeValues::Uint(vec![7; 12]));
    let mesh = with(mesh, names::WEIGHTS, AttributeValues::Float(vec![0.7; 12]));
    for (from, weight) in [([0, 0], 0.3), ([0, 1], 0.0), ([1, 0], 1.0)] {
        let new = multires::simplify::NewVertex { from, weight, position: [0.5, 0.5, 0.0] };
        let sequence = CollapseSequence::from_collapses(&mesh, &[new], [([[0, 3]], 0.0)]).unwrap();
        assert!(matches!(sequence.origin(3), Origin::Blend(_)));
        let level = sequence.extract(&mesh, 1);
        for (before, after) in mesh.attributes().iter().zip(level.attributes()) {
            assert_eq!(before.values(), after.values());
        }
    }
}

#[test]
fn opposite_normals_do_not_cancel() {
    let mesh = Mesh::new([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2]]).unwrap();
    let normals = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0f32]];
    let mesh = mesh.with_attribute(Attribute::floats(names::NORMAL, &normals)).unwrap();
    let new = multires::simplify::NewVertex { from: [0, 1], weight: 0.5, position: [0.5, 0.0, 0.0] };
    let sequence = CollapseSequence::from_collapses(&mesh, &[new], [([[0, 3]], 0.0)]).unwrap();
    let level = sequence.extract(&mesh, 1);
    assert_eq!(level.attribute(names::NORMAL).unwrap().as_floats().unwrap()[..3], [0.0, 0.0, 1.0]);
}
