//! Meshes under measurement: from files and from formulas, with vertices welded by position and unused ones dropped,
//! so that every contender sees the same connectivity.

use std::error::Error;
use std::path::Path;

use multires::mesh::{Mesh, Topology};

/// Positions and triangles, unchecked.
type Soup = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A named mesh.
pub(crate) struct Input {
    pub name: String,
    pub mesh: Mesh,
}

/// Reads a file of any format that multires reads. Attributes are left behind.
pub(crate) fn read(path: &Path) -> Result<Input, Box<dyn Error>> {
    let name = path.file_stem().ok_or("not a file name")?.to_string_lossy().into_owned();
    Ok(Input { name, mesh: welded(multires::io::read(path)?)? })
}

/// A terrain of `grid` x `grid` quads (open border, flat parts and slopes) and a bumpy sphere of six such patches
/// (closed): `2 grid^2` and about `3 grid^2` triangles.
pub(crate) fn generated(grid: u32) -> Result<Vec<Input>, Box<dyn Error>> {
    let height = |x: f64, y: f64| {
        let hills = (6.3 * x + 1.0).sin() * (5.1 * y).cos() * 0.08 + (23.0 * x * y).sin() * 0.02;
        hills.max(-0.03) + (71.0 * x + 13.0 * y).sin() * (57.0 * y - 31.0 * x).cos() * 0.002
    };
    let terrain = patch(grid, |x, y| [x, y, height(x, y)].map(|c| c as f32));

    // Half as fine a patch on every face of the cube, welded along the cube's edges.
    let fine = (grid / 2).max(1);
    let mut sphere = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (mut positions, mut triangles) = patch(fine, |u, v| {
                let mut p = [0.0; 3];
                p[axis] = side;
                p[(axis + 1) % 3] = side * (2.0 * u - 1.0);
                p[(axis + 2) % 3] = 2.0 * v - 1.0;
                bumpy(p)
            });
            let first = sphere.0.len() as u32;
            triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner += first);
            sphere.0.append(&mut positions);
            sphere.1.append(&mut triangles);
        }
    }
    [("terrain", terrain), ("bumpy-sphere", sphere)]
        .into_iter()
        .map(|(name, (positions, triangles))| {
            Ok(Input { name: format!("{name}-{grid}"), mesh: welded(Mesh::new(positions, triangles)?)? })
        })
        .collect()
}

/// The cube's surface pushed out to a sphere with bumps. Depends on nothing but the point, so edges of the cube meet.
fn bumpy(p: [f64; 3]) -> [f32; 3] {
    let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
    let [x, y, z] = p.map(|c| c / length);
    let radius = 1.0
        + 0.05 * (9.0 * x).sin() * (8.0 * y).cos() * (7.0 * z).sin()
        + 0.01 * (40.0 * x * y + 30.0 * z).sin();
    [x, y, z].map(|c| (c * radius) as f32)
}

/// A grid of quads over the unit square, each cut in two.
fn patch(grid: u32, place: impl Fn(f64, f64) -> [f32; 3]) -> Soup {
    let row = grid + 1;
    let at = |i: u32| f64::from(i) / f64::from(grid);
    let positions = (0..row * row).map(|i| place(at(i % row), at(i / row))).collect();
    let quads = (0..grid * grid).map(|i| i / grid * row + i % grid);
    let triangles = quads.flat_map(|q| [[q, q + 1, q + row + 1], [q, q + row + 1, q + row]]).collect();
    (positions, triangles)
}

/// One vertex a position, no unused vertices, no triangles with equal corners.
pub(crate) fn welded(mesh: Mesh) -> Result<Mesh, Box<dyn Error>> {
    let topology = Topology::new(&mesh);
    let point = |v: u32| topology.point_of()[v as usize];
    let triangles = mesh.triangles().iter().map(|t| t.map(point));
    let triangles: Vec<[u32; 3]> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let positions: Vec<[f32; 3]> =
        topology.vertex_of_point().iter().map(|&v| mesh.positions()[v as usize]).collect();
    compact(&positions, triangles)
}

/// The same triangles without unused vertices; the others keep their order.
pub(crate) fn compact(positions: &[[f32; 3]], mut triangles: Vec<[u32; 3]>) -> Result<Mesh, Box<dyn Error>> {
    let mut number = vec![u32::MAX; positions.len()];
    for &corner in triangles.as_flattened() {
        *number.get_mut(corner as usize).ok_or("a triangle names a vertex that does not exist")? = 0;
    }
    let mut used = Vec::new();
    for (position, number) in positions.iter().zip(&mut number) {
        if *number == 0 {
            *number = used.len() as u32;
            used.push(*position);
        }
    }
    triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner = number[*corner as usize]);
    Ok(Mesh::new(used, triangles)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn welding_joins_positions_and_drops_unused_vertices() {
        let positions =
            [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        let mesh = Mesh::new(positions, [[1, 2, 3], [4, 5, 3], [2, 4, 5]]).unwrap();
        let mesh = welded(mesh).unwrap();
        assert_eq!(mesh.positions(), [positions[1], positions[2], positions[3], positions[5]]);
        assert_eq!(mesh.triangles(), [[0, 1, 2], [1, 3, 2]]);
    }

    #[test]
    fn the_generated_sphere_is_closed() {
        let inputs = generated(16).unwrap();
        assert_eq!(inputs[0].mesh.triangles().len(), 2 * 16 * 16);
        let sphere = &inputs[1].mesh;
        let (v, f) = (sphere.positions().len(), sphere.triangles().len());
        assert_eq!(f, 6 * 2 * 8 * 8);
        // Every directed edge has its opposite, and Euler's formula holds for 3/2 f edges.
        let mut edges: Vec<[u32; 2]> =
            sphere.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|w| w[0] != w[1]), "two triangles run along an edge the same way");
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()), "an edge is open");
        assert_eq!(v + f, 3 * f / 2 + 2);
    }
}
