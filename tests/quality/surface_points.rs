//! Promise: samples of a surface stand for equal areas, and the nearest points that are visited are the nearest, with every
//! triangle that touches there.
#![cfg(feature = "quality")]

use multires::{
    mesh::{Mesh, shapes},
    quality::{DistanceOptions, QualityError, Surface, SurfacePoint},
};

fn samples(surface: &Surface<'_>, count: usize) -> Vec<SurfacePoint> {
    surface.samples(&DistanceOptions::default().with_samples(count)).unwrap()
}

/// The place that triangle and weights say.
fn place(mesh: &Mesh, point: &SurfacePoint) -> [f64; 3] {
    let corners = mesh.triangles()[point.triangle as usize].map(|v| mesh.positions()[v as usize]);
    [0, 1, 2].map(|i| (0..3).map(|k| point.weights[k] * f64::from(corners[k][i])).sum())
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn samples_lie_where_they_say_and_share_the_area() {
    // A strip of a large and a small square: 4 to 1.
    let positions = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [2.0, 1.0], [3.0, 1.0], [3.0, 2.0]];
    let positions: Vec<[f32; 3]> = positions.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let mesh = Mesh::new(positions, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 2]]).unwrap();
    let surface = Surface::new(&mesh).unwrap();
    let samples = samples(&surface, 1_000);
    assert_eq!(samples.len(), 1_000);
    let mut count = [0; 4];
    for sample in &samples {
        count[sample.triangle as usize] += 1;
        assert!(apart(place(&mesh, sample), sample.position) < 1e-6 && sample.distance == 0.0);
        assert!((sample.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
    assert_eq!(count.map(|c: i32| (c + 5) / 10), [40, 40, 10, 10]);
}

#[test]
fn nearest_points_are_at_the_distance_and_on_all_triangles_there() {
    let (mesh, other) = (shapes::icosphere(2), shapes::rock(600, 3));
    let (surface, from) = (Surface::new(&mesh).unwrap(), Surface::new(&other).unwrap());
    let mut points: Vec<[f64; 3]> = samples(&from, 200).iter().map(|sample| sample.position).collect();
    // Corners of the mesh: all triangles around them touch.
    let corners = points.len();
    points.extend(mesh.positions().iter().map(|p| p.map(|x| 2.0 * f64::from(x))));
    points.push([f64::NAN, 0.0, 0.0]);
    let narrow: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let distances = surface.point_distances(&narrow);
    let mut visited = 0;
    surface.nearest(&points, |number, places| {
        assert_eq!(number, visited, "in order");
        visited += 1;
        for found in places {
            assert!((found.distance - distances[number]).abs() < 1e-5);
            assert!(apart(place(&mesh, found), found.position) < 1e-5);
            assert!((apart(points[number], found.position) - found.distance).abs() < 1e-9);
        }
        if number >= corners {
            let around = mesh.indices().iter().filter(|&&v| v as usize == number - corners).count();
            let mut triangles: Vec<u32> = places.iter().map(|found| found.triangle).collect();
            triangles.sort_unstable();
            triangles.dedup();
            assert_eq!((places.len(), triangles.len()), (around, around), "corner {}", number - corners);
        }
    });
    assert_eq!(visited, points.len() - 1, "what is not finite is passed over");
}

#[test]
fn a_number_of_samples_that_makes_no_sense_is_refused() {
    let mesh = shapes::cube();
    let surface = Surface::new(&mesh).unwrap();
    let none = surface.samples(&DistanceOptions::default().with_samples(0));
    assert!(matches!(none, Err(QualityError::Samples { samples: 0, .. })));
}
