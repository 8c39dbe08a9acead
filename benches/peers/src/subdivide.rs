//! Larger meshes from small ones: every triangle in four.

use std::collections::HashMap;
use std::error::Error;

use multires::mesh::Mesh;

/// Loop's subdivision, the given number of times: four times the triangles each, and no more flat than the input, as midpoints
/// alone would be. Borders, and edges of more than two triangles, keep their shape.
pub(crate) fn subdivide(mesh: Mesh, times: u32) -> Result<Mesh, Box<dyn Error>> {
    (0..times).try_fold(mesh, |mesh, _| once(&mesh))
}

fn once(mesh: &Mesh) -> Result<Mesh, Box<dyn Error>> {
    let place = |v: u32| mesh.positions()[v as usize].map(f64::from);
    let count = mesh.positions().len();
    // Per edge its number, and the vertices across.
    let mut number: HashMap<[u32; 2], usize> = HashMap::new();
    let mut edges: Vec<([u32; 2], Vec<u32>)> = Vec::new();
    for t in mesh.triangles() {
        for k in 0..3 {
            let [a, b, across] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            let ends = [a.min(b), a.max(b)];
            let edge = *number.entry(ends).or_insert(edges.len());
            if edge == edges.len() {
                edges.push((ends, Vec::new()));
            }
            edges[edge].1.push(across);
        }
    }

    let mut sum = vec![([0.0; 3], 0.0_f64, true); count];
    for ([a, b], across) in &edges {
        for [v, other] in [[*a, *b], [*b, *a]] {
            let (sum, valence, inner) = &mut sum[v as usize];
            let other = place(other);
            (0..3).for_each(|i| sum[i] += other[i]);
            *valence += 1.0;
            *inner &= across.len() == 2;
        }
    }
    let old = sum.iter().enumerate().map(|(v, (sum, valence, inner))| {
        let here = place(v as u32);
        if !inner || *valence < 3.0 {
            return here;
        }
        let ring = (0.625 - (0.375 + 0.25 * (std::f64::consts::TAU / valence).cos()).powi(2)) / valence;
        std::array::from_fn(|i| (1.0 - valence * ring) * here[i] + ring * sum[i])
    });
    let new = edges.iter().map(|([a, b], across)| {
        let [a, b] = [place(*a), place(*b)];
        std::array::from_fn(|i| match across[..] {
            [c, d] => 0.375 * (a[i] + b[i]) + 0.125 * (place(c)[i] + place(d)[i]),
            _ => 0.5 * (a[i] + b[i]),
        })
    });
    let positions: Vec<[f32; 3]> = old.chain(new).map(|p: [f64; 3]| p.map(|x| x as f32)).collect();
    let middle = |a: u32, b: u32| (count + number[&[a.min(b), a.max(b)]]) as u32;
    let triangles: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        })
        .collect();
    Ok(Mesh::new(positions, triangles)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use multires::mesh::shapes;

    #[test]
    fn a_subdivided_sphere_is_a_closed_sphere() {
        let mesh = subdivide(shapes::icosphere(2), 2).unwrap();
        let (v, f) = (mesh.positions().len(), mesh.triangles().len());
        assert_eq!(f, 320 * 16);
        assert_eq!(v + f, 3 * f / 2 + 2);
        let radius = |p: &[f32; 3]| p.iter().map(|x| x * x).sum::<f32>().sqrt();
        let (low, high) = mesh
            .positions()
            .iter()
            .map(radius)
            .fold((f32::MAX, 0.0_f32), |(low, high), r| (low.min(r), high.max(r)));
        assert!(low > 0.9 && high <= 1.0 && high - low < 0.02, "{low} {high}");
    }
}
