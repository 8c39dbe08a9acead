//! Promise: every metric sees rims: on a flat sheet corners and straight borders stay where they are, and a hole in a thin
//! plate is not the first thing to go.

use multires::mesh::{Mesh, names, shapes};
use multires::simplify::metric::{NAMES, by_name};
use multires::simplify::{Placement, Simplifier};

/// The sides of a mesh's box.
fn extent(mesh: &Mesh) -> [f64; 3] {
    let [low, high] = mesh.bounds().unwrap();
    std::array::from_fn(|i| f64::from(high[i]) - f64::from(low[i]))
}

fn area(mesh: &Mesh) -> f64 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions()[v as usize].map(f64::from));
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        0.5 * n.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    mesh.triangles().iter().map(area).sum()
}

fn level(mesh: &Mesh, metric: &str, placement: Placement, triangles: usize) -> Mesh {
    let simplifier = Simplifier::new().metric(by_name(metric).unwrap()).placement(placement);
    let sequence = { simplifier }.run(mesh).unwrap();
    let level = sequence.extract(mesh, sequence.steps_for_triangles(triangles));
    assert!(level.triangles().len() <= triangles, "{metric}, {placement:?}: {}", level.triangles().len());
    level
}

#[test]
fn a_flat_sheet_keeps_its_extent() {
    let mesh = shapes::plane(30);
    for metric in NAMES {
        for placement in [Placement::Endpoint, Placement::Optimal, Placement::Subset] {
            let level = level(&mesh, metric, placement, 200);
            let what = format!("{metric}, {placement:?}");
            for (before, after) in extent(&mesh).into_iter().zip(extent(&level)) {
                assert!((before - after).abs() < 1e-5, "{what}: {before} became {after}");
            }
            assert!((area(&mesh) - area(&level)).abs() < 1e-5 * area(&mesh), "{what}: {}", area(&level));
        }
    }
}

#[test]
fn a_hole_in_a_thin_plate_stays_round() {
    // Three quarters of what is there is redundant, and the walls are so low that little of a wall's area hangs on the rim.
    let plain = shapes::plate_with_hole(32, 0.01);
    let mesh = (0..2).fold(plain.clone(), |mesh, _| shapes::cut_in_four(&mesh));
    for metric in NAMES {
        let level = level(&mesh, metric, Placement::Endpoint, plain.triangles().len() * 3);
        let lost = (area(&mesh) - area(&level)).abs() / area(&mesh);
        assert!(lost < 0.002, "{metric}: {lost} of the area");
    }
}

#[test]
fn a_seam_between_two_colours_stays_where_it_is() {
    // Of one colour on either side, so that neither the surface nor the colours tell where the seam lies.
    let mesh = shapes::painted_disc(64, 12);
    let red = |mesh: &Mesh| {
        let colours = mesh.attribute(names::COLOR).unwrap().as_floats().unwrap();
        let is_red = |t: &&[u32; 3]| colours[3 * t[0] as usize + 1] < 0.5;
        let triangles: Vec<_> = mesh.triangles().iter().filter(is_red).copied().collect();
        area(&Mesh::new(mesh.positions().to_vec(), triangles).unwrap())
    };
    for metric in NAMES {
        for placement in [Placement::Endpoint, Placement::Optimal] {
            let level = level(&mesh, metric, placement, mesh.triangles().len() / 4);
            let lost = (red(&mesh) - red(&level)).abs() / red(&mesh);
            assert!(lost < 0.02, "{metric}, {placement:?}: {lost} of the red");
        }
    }
}
