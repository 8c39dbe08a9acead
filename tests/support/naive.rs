//! A small half-edge simplifier and small meshes, to have sequences to test with. Not part of the library's promises.

#![allow(dead_code)]

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::CollapseSequence;

/// The steps of a simplification.
pub type Steps = Vec<(Vec<[u32; 2]>, f32)>;

/// A torus of `rows` x `columns` quads with bumps: closed, `2 * rows * columns` triangles. With `seam`, two of its
/// circles are cut in texture coordinates (wedges), not in position; with `materials`, stripes have ids 7, 3 and 40.
pub fn torus(rows: u32, columns: u32, seam: bool, materials: bool) -> Mesh {
    let (across, along) = if seam { (columns + 1, rows + 1) } else { (columns, rows) };
    let mut positions = Vec::new();
    let mut coordinates = Vec::new();
    for i in 0..along {
        for j in 0..across {
            let (u, v) = ((i % rows) as f32 / rows as f32, (j % columns) as f32 / columns as f32);
            let (a, b) = (u * std::f32::consts::TAU, v * std::f32::consts::TAU);
            let r = 0.5 + 0.05 * (5.0 * a).sin() * (7.0 * b).cos() + 0.01 * (31.0 * a + 17.0 * b).sin();
            let ring = 1.5 + r * b.cos();
            positions.push([ring * a.cos(), ring * a.sin(), r * b.sin()]);
            coordinates.push([i as f32 / rows as f32, j as f32 / columns as f32]);
        }
    }
    let at = |i: u32, j: u32| if seam { i * across + j } else { (i % rows) * across + j % columns };
    let mut triangles = Vec::new();
    let mut ids = Vec::new();
    for i in 0..rows {
        for j in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
            ids.extend([[7, 3, 40][(j / 3 % 3) as usize]; 2]);
        }
    }
    let mut mesh = Mesh::new(positions, triangles).unwrap();
    if seam {
        mesh = mesh.with_attribute(Attribute::floats(names::UV, &coordinates)).unwrap();
    }
    if materials { mesh.with_materials(ids).unwrap() } else { mesh }
}

/// Half-edge collapses by quadric error down to `target` triangles. All wedges of a point go in one step, each to the
/// kept point's wedge that shares a triangle with it, or to any.
pub fn simplify(mesh: &Mesh, target: usize) -> Steps {
    let topology = multires::mesh::Topology::new(mesh);
    let point_of = topology.point_of();
    let wedge_of = topology.wedge_of();
    let points = topology.point_count();
    let place = |p: u32| mesh.positions()[topology.vertex_of_point()[p as usize] as usize].map(f64::from);

    // Triangles by current wedge, faces around each point, and the input vertices' current wedges.
    let mut triangles: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|t| t.map(|v| wedge_of[v as usize])).collect();
    let mut faces: Vec<Vec<u32>> = vec![Vec::new(); points];
    let mut quadrics = vec![[0.0f64; 10]; points];
    for (t, corners) in triangles.iter().enumerate() {
        let p = corners.map(|v| point_of[v as usize]);
        let quadric = plane(p.map(place));
        for p in p {
            faces[p as usize].push(t as u32);
            quadrics[p as usize].iter_mut().zip(quadric).for_each(|(a, b)| *a += b);
        }
    }
    let mut alive = triangles.iter().filter(|t| !degenerate(t.map(|v| point_of[v as usize]))).count();
    let mut version = vec![0u32; points];
    let mut heap = BinaryHeap::new();
    let cost = |from: u32, to: u32, quadrics: &[[f64; 10]]| {
        let (q, r) = (&quadrics[from as usize], &quadrics[to as usize]);
        let at = place(to);
        (evaluate(q, at) + evaluate(r, at)).max(0.0) + 1e-9 * distance(place(from), at)
    };
    let neighbours = |p: u32, triangles: &[[u32; 3]], faces: &[Vec<u32>]| -> Vec<u32> {
        let mut all: Vec<u32> = (faces[p as usize].iter())
            .flat_map(|&t| triangles[t as usize].map(|v| point_of[v as usize]))
            .filter(|&q| q != p)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let push = |heap: &mut BinaryHeap<_>, p: u32, q: u32, quadrics: &[[f64; 10]], version: &[u32]| {
        let (v, w) = (version[p as usize], version[q as usize]);
        heap.push(Reverse((cost(p, q, quadrics).to_bits(), p, q, v, w)));
    };
    for p in 0..points as u32 {
        for q in neighbours(p, &triangles, &faces) {
            push(&mut heap, p, q, &quadrics, &version);
        }
    }
    let mut steps: Steps = Vec::new();
    let mut gone = vec![false; points];
    while alive > target {
        let Some(Reverse((bits, p, q, v, w))) = heap.pop() else { break };
        if gone[p as usize] || gone[q as usize] || version[p as usize] != v || version[q as usize] != w {
            continue;
        }
        // Link condition: common neighbours are the third corners of the edge's own triangles.
        let near = neighbours(p, &triangles, &faces);
        let far: HashSet<u32> = neighbours(q, &triangles, &faces).into_iter().collect();
        let shared = faces[p as usize]
            .iter()
            .filter(|&&t| triangles[t as usize].iter().any(|&v| point_of[v as usize] == q))
            .count();
        if near.iter().filter(|n| far.contains(n)).count() > shared {
            continue;
        }
        // Wedges of p, in order of first use, each to a wedge of q.
        let mut step: Vec<[u32; 2]> = Vec::new();
        let any = faces[q as usize]
            .iter()
            .flat_map(|&t| triangles[t as usize])
            .find(|&v| point_of[v as usize] == q)
            .unwrap_or(wedge_of[topology.vertex_of_point()[q as usize] as usize]);
        for &t in &faces[p as usize] {
            let corners = triangles[t as usize];
            let from = corners.into_iter().find(|&v| point_of[v as usize] == p).unwrap();
            let to = corners.into_iter().find(|&v| point_of[v as usize] == q);
            match step.iter_mut().find(|s| s[0] == from) {
                Some(entry) => entry[1] = to.unwrap_or(entry[1]),
                None => step.push([from, to.unwrap_or(any)]),
            }
        }
        if step.is_empty() {
            continue;
        }
        let moved = std::mem::take(&mut faces[p as usize]);
        for t in moved {
            let corners = &mut triangles[t as usize];
            for c in corners.iter_mut() {
                if let Some(s) = step.iter().find(|s| s[0] == *c) {
                    *c = s[1];
                }
            }
            let ends = corners.map(|v| point_of[v as usize]);
            if degenerate(ends) {
                alive -= 1;
                for e in ends {
                    faces[e as usize].retain(|&f| f != t);
                }
            } else {
                faces[q as usize].push(t);
            }
        }
        gone[p as usize] = true;
        let absorbed = quadrics[p as usize];
        quadrics[q as usize].iter_mut().zip(absorbed).for_each(|(a, b)| *a += b);
        version[q as usize] += 1;
        for n in neighbours(q, &triangles, &faces) {
            push(&mut heap, q, n, &quadrics, &version);
            push(&mut heap, n, q, &quadrics, &version);
        }
        steps.push((step, f64::from_bits(bits).sqrt() as f32));
    }
    steps
}

/// A sequence of the above, down to `target` triangles.
pub fn sequence(mesh: &Mesh, target: usize) -> CollapseSequence {
    CollapseSequence::from_substitutions(mesh, simplify(mesh, target)).unwrap()
}

pub fn degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
}

/// The quadric of a triangle's plane, weighted by area: xx xy xz xw yy yz yw zz zw ww.
fn plane([a, b, c]: [[f64; 3]; 3]) -> [f64; 10] {
    let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if length == 0.0 {
        return [0.0; 10];
    }
    let [x, y, z] = n.map(|c| c / length);
    let w = -(x * a[0] + y * a[1] + z * a[2]);
    let s = 0.5 * length;
    [x * x, x * y, x * z, x * w, y * y, y * z, y * w, z * z, z * w, w * w].map(|c| s * c)
}

fn evaluate(q: &[f64; 10], [x, y, z]: [f64; 3]) -> f64 {
    q[0] * x * x
        + 2.0 * (q[1] * x * y + q[2] * x * z + q[3] * x + q[5] * y * z + q[6] * y + q[8] * z)
        + q[4] * y * y
        + q[7] * z * z
        + q[9]
}
