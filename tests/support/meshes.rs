//! Small meshes with seams, materials and odd topology, and what a test asks of every level of a sequence.
#![allow(dead_code)]

use std::collections::{BTreeMap, HashMap};

use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::CollapseSequence;

/// Triangles of a grid of `columns` by `rows` cells over vertices numbered row by row from `first`.
pub fn grid_triangles(columns: u32, rows: u32, first: u32) -> Vec<[u32; 3]> {
    let at = |x: u32, y: u32| first + y * (columns + 1) + x;
    let cell = |x: u32, y: u32| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        if (x ^ y) & 1 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    (0..rows).flat_map(|y| (0..columns).flat_map(move |x| cell(x, y))).collect()
}

/// Values in arrays, one per vertex.
pub fn rows<T: Copy + Default, const WIDTH: usize>(values: &[T]) -> Vec<[T; WIDTH]> {
    let row = |chunk: &[T]| {
        let mut row = [T::default(); WIDTH];
        row.copy_from_slice(chunk);
        row
    };
    values.chunks_exact(WIDTH).map(row).collect()
}

/// Points of a grid over the unit square, lifted by `height`.
pub fn grid_positions(columns: u32, rows: u32, height: impl Fn(f32, f32) -> f32) -> Vec<[f32; 3]> {
    let mut positions = Vec::new();
    for y in 0..=rows {
        for x in 0..=columns {
            let (u, v) = (x as f32 / columns as f32, y as f32 / rows as f32);
            positions.push([u, v, height(u, v)]);
        }
    }
    positions
}

/// A grid without attributes.
pub fn grid(columns: u32, rows: u32, height: impl Fn(f32, f32) -> f32) -> Mesh {
    Mesh::new(grid_positions(columns, rows, height), grid_triangles(columns, rows, 0)).unwrap()
}

/// Two grids that share a column of positions; each is a chart of its own: `u` in 0 to 0.5 and in 10 to 10.5.
pub fn seamed_grid(columns: u32, rows: u32, height: impl Fn(f32, f32) -> f32 + Copy) -> Mesh {
    let mut positions = grid_positions(columns, rows, |u, v| height(0.5 * u, v));
    positions.iter_mut().for_each(|p| p[0] *= 0.5);
    let mut uv: Vec<[f32; 2]> = positions.iter().map(|p| [p[0], p[1]]).collect();
    let mut triangles = grid_triangles(columns, rows, 0);
    triangles.extend(grid_triangles(columns, rows, positions.len() as u32));
    let mut right = grid_positions(columns, rows, |u, v| height(0.5 + 0.5 * u, v));
    right.iter_mut().for_each(|p| p[0] = 0.5 + 0.5 * p[0]);
    uv.extend(right.iter().map(|p| [p[0] + 9.5, p[1]]));
    positions.extend(right);
    Mesh::new(positions, triangles).unwrap().with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
}

/// A grid of `blocks` by `blocks` charts of `cells` by `cells` cells each, far apart in the texture and every other one
/// mirrored; normals are those of a sheet that leans another way in every block where `leaning`.
pub fn quilt(blocks: u32, cells: u32, leaning: bool, height: impl Fn(f32, f32) -> f32) -> Mesh {
    let all = blocks * cells;
    let (mut positions, mut triangles, mut uv, mut normals) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (bx, by) in (0..blocks).flat_map(|by| (0..blocks).map(move |bx| (bx, by))) {
        triangles.extend(grid_triangles(cells, cells, positions.len() as u32));
        let odd = (bx + by) % 2 == 1;
        for (x, y) in (0..=cells).flat_map(|y| (0..=cells).map(move |x| (x, y))) {
            let (u, v) = ((bx * cells + x) as f32 / all as f32, (by * cells + y) as f32 / all as f32);
            positions.push([u, v, height(u, v)]);
            let local = if odd { cells - x } else { x };
            let at = |block: u32, local: u32| (2 * block * cells + local) as f32 / (2 * all) as f32;
            uv.push([at(bx, local), at(by, y)]);
            normals.push(if odd { [0.6, 0.0, 0.8] } else { [0.0, 0.6, 0.8] });
        }
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let stream =
        if leaning { Attribute::floats(names::NORMAL, &normals) } else { Attribute::floats(names::UV, &uv) };
    mesh.with_attribute(stream).unwrap()
}

/// Triangles whose orientation in texture space is opposite to the input's, of those that have one in both.
pub fn mirrored(mesh: &Mesh, sequence: &CollapseSequence, steps: usize) -> usize {
    let coarse = sequence.extract(mesh, steps);
    let (_, origin) = sequence.triangles_at(mesh, steps);
    let uv = |mesh: &Mesh| rows::<f32, 2>(mesh.attribute(names::UV).unwrap().as_floats().unwrap());
    let (before, after) = (uv(mesh), uv(&coarse));
    let side = |uv: &[[f32; 2]], t: [u32; 3]| {
        let [a, b, c] = t.map(|v| uv[v as usize].map(f64::from));
        let (e, f) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let (area, scale) =
            (e[0] * f[1] - e[1] * f[0], e[0] * e[0] + e[1] * e[1] + f[0] * f[0] + f[1] * f[1]);
        if area.abs() > 1e-5 * scale { area.signum() } else { 0.0 }
    };
    let pairs = coarse.triangles().iter().zip(&origin);
    pairs.filter(|&(&t, &o)| side(&after, t) * side(&before, mesh.triangles()[o as usize]) < 0.0).count()
}

/// An open tube around z with a texture wrapped around it once: a seam at angle 0, one chart on both its sides.
pub fn tube(around: u32, along: u32) -> Mesh {
    let flat = grid_positions(around, along, |_, _| 0.0);
    let positions: Vec<[f32; 3]> = flat
        .iter()
        .map(|&[u, v, _]| {
            // The last column repeats the first bit for bit.
            let angle = std::f32::consts::TAU * (u % 1.0);
            [angle.cos(), angle.sin(), 3.0 * v]
        })
        .collect();
    let uv: Vec<[f32; 2]> = flat.iter().map(|p| [p[0], p[1]]).collect();
    Mesh::new(positions, grid_triangles(around, along, 0))
        .unwrap()
        .with_attribute(Attribute::floats(names::UV, &uv))
        .unwrap()
}

/// A closed cube of `n` by `n` cells a face, with one normal per face.
pub fn cube(n: u32) -> Mesh {
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [0.0f32, 1.0] {
            triangles.extend(
                grid_triangles(n, n, positions.len() as u32)
                    .into_iter()
                    .map(|[a, b, c]| if side > 0.5 { [a, b, c] } else { [a, c, b] }),
            );
            for [u, v, _] in grid_positions(n, n, |_, _| 0.0) {
                let (mut p, mut normal) = ([0.0; 3], [0.0; 3]);
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, u, v);
                normal[axis] = 2.0 * side - 1.0;
                positions.push(p);
                normals.push(normal);
            }
        }
    }
    Mesh::new(positions, triangles)
        .unwrap()
        .with_attribute(Attribute::floats(names::NORMAL, &normals))
        .unwrap()
}

/// A closed torus without attributes.
pub fn torus(around: u32, across: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b) = (
                std::f32::consts::TAU * i as f32 / around as f32,
                std::f32::consts::TAU * j as f32 / across as f32,
            );
            let r = 1.0 + 0.4 * b.cos();
            positions.push([r * a.cos(), r * a.sin(), 0.4 * b.sin()]);
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let triangles: Vec<[u32; 3]> = (0..around)
        .flat_map(|i| (0..across).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(positions, triangles).unwrap()
}

/// Three sheets that meet in one line, an edge of three triangles each.
pub fn three_sheets(n: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for sheet in 0..3 {
        let angle = std::f32::consts::TAU * sheet as f32 / 3.0;
        triangles.extend(grid_triangles(n, n, positions.len() as u32));
        positions.extend(
            grid_positions(n, n, |_, _| 0.0)
                .into_iter()
                .map(|[u, v, _]| [u * angle.cos(), u * angle.sin(), v]),
        );
    }
    Mesh::new(positions, triangles).unwrap()
}

/// Two grids that touch in one corner point only.
pub fn two_fans(n: u32) -> Mesh {
    let mut positions = grid_positions(n, n, |_, _| 0.0);
    let mut triangles = grid_triangles(n, n, 0);
    triangles.extend(grid_triangles(n, n, positions.len() as u32));
    positions.extend(grid_positions(n, n, |_, _| 0.0).into_iter().map(|[u, v, w]| [u + 1.0, v + 1.0, w]));
    Mesh::new(positions, triangles).unwrap()
}

/// The same mesh with every position put through `map`.
pub fn mapped(mesh: &Mesh, map: impl Fn([f32; 3]) -> [f32; 3]) -> Mesh {
    let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|&p| map(p)).collect();
    let mut result = Mesh::new(positions, mesh.triangles())
        .unwrap()
        .with_materials(mesh.materials())
        .unwrap()
        .with_locks(mesh.locks())
        .unwrap();
    for attribute in mesh.attributes() {
        result = result.with_attribute(attribute.clone()).unwrap();
    }
    result
}

/// A smooth displacement that depends on the position only, so seams stay closed.
pub fn wave(p: [f32; 3], height: f32, phase: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = p;
    [
        x + height * (3.0 * y + 2.0 * z + phase[0]).sin(),
        y + height * (2.0 * z + 3.0 * x + phase[1]).sin(),
        z + height * (3.0 * x + 2.0 * y + phase[2]).sin(),
    ]
}

/// The point (welded position) of every vertex, input and new.
pub fn points(mesh: &Mesh, sequence: &CollapseSequence) -> Vec<u32> {
    let mut first: HashMap<[u32; 3], u32> = HashMap::new();
    let mut point: Vec<u32> = Vec::new();
    for p in mesh.positions() {
        let next = point.len() as u32;
        point.push(*first.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next));
    }
    point.resize(point.len() + sequence.new_vertices().len(), u32::MAX);
    for step in 0..sequence.len() {
        let mut made: Vec<u32> = sequence.substitutions(step).iter().map(|s| s[1]).collect();
        // A wedge that moves on its own joins the point that stays.
        let stays = made.iter().map(|&v| point[v as usize]).find(|&p| p != u32::MAX);
        made.retain(|&v| point[v as usize] == u32::MAX);
        let least = made.iter().copied().min();
        for v in made {
            point[v as usize] = stays.or(least).unwrap_or(v);
        }
    }
    point
}

/// One level: the vertices and points of its triangles, and where each comes from.
pub struct Level {
    pub vertices: Vec<[u32; 3]>,
    pub points: Vec<[u32; 3]>,
    pub origin: Vec<u32>,
}

/// The level after some steps, less triangles that are degenerate in the input.
pub fn level(mesh: &Mesh, sequence: &CollapseSequence, point: &[u32], steps: usize) -> Level {
    let (vertices, origin) = sequence.triangles_at(mesh, steps);
    let mut level = Level { vertices: Vec::new(), points: Vec::new(), origin: Vec::new() };
    for (t, o) in vertices.into_iter().zip(origin) {
        let p = t.map(|v| point[v as usize]);
        let degenerate = p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
        assert!(!degenerate || steps == 0, "triangle {o} has two equal points after {steps} steps");
        if !degenerate {
            level.vertices.push(t);
            level.points.push(p);
            level.origin.push(o);
        }
    }
    level
}

/// How many triangles each edge between points has.
pub fn edges(triangles: &[[u32; 3]]) -> BTreeMap<[u32; 2], u32> {
    let mut edges = BTreeMap::new();
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *edges.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
        }
    }
    edges
}

/// Points less edges plus triangles.
pub fn euler(triangles: &[[u32; 3]]) -> i64 {
    let mut points: Vec<u32> = triangles.as_flattened().to_vec();
    points.sort_unstable();
    points.dedup();
    points.len() as i64 - edges(triangles).len() as i64 + triangles.len() as i64
}

/// Connected components over shared points.
pub fn components(triangles: &[[u32; 3]]) -> usize {
    let size = triangles.as_flattened().iter().max().map_or(0, |&m| m as usize + 1);
    let mut parent: Vec<usize> = (0..size).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for t in triangles {
        for v in &t[1..] {
            let (a, b) = (root(&mut parent, t[0] as usize), root(&mut parent, *v as usize));
            parent[a] = b;
        }
    }
    let mut roots: Vec<usize> =
        triangles.as_flattened().iter().map(|&v| root(&mut parent, v as usize)).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.len()
}

/// The position of a vertex, input or new.
pub fn position(mesh: &Mesh, sequence: &CollapseSequence, vertex: u32) -> [f32; 3] {
    match (vertex as usize).checked_sub(mesh.positions().len()) {
        Some(new) => sequence.new_vertices()[new].position,
        None => mesh.positions()[vertex as usize],
    }
}

pub fn sub(a: [f32; 3], b: [f32; 3]) -> [f64; 3] {
    std::array::from_fn(|i| f64::from(a[i]) - f64::from(b[i]))
}

pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Twice the area times the normal.
pub fn normal(corners: [[f32; 3]; 3]) -> [f64; 3] {
    cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))
}

/// Distance of a point from a triangle, by Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
pub fn distance(p: [f32; 3], [a, b, c]: [[f32; 3]; 3]) -> f64 {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let n = cross(ab, ac);
    let nn = dot(n, n);
    if nn > 0.0 {
        let (u, v) = (dot(cross(ap, ac), n) / nn, dot(cross(ab, ap), n) / nn);
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
            return dot(ap, n).abs() / nn.sqrt();
        }
    }
    [(a, b), (b, c), (c, a)]
        .map(|(s, e)| {
            let (d, q) = (sub(e, s), sub(p, s));
            let t = if dot(d, d) > 0.0 { (dot(q, d) / dot(d, d)).clamp(0.0, 1.0) } else { 0.0 };
            let r: [f64; 3] = std::array::from_fn(|i| q[i] - t * d[i]);
            dot(r, r).sqrt()
        })
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}
