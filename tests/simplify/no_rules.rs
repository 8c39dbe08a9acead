//! Without any oracle the result is still a valid sequence: rules decide how good it is, never whether it holds.

use multires::mesh::{Mesh, shapes};
use multires::simplify::{ErrorMeasure, Order, Placement, Simplifier};
use multires::tom::TotallyOrderedMesh;

fn meshes() -> Vec<Mesh> {
    vec![
        shapes::tetrahedron(),
        shapes::pillow(),
        shapes::book(5),
        shapes::bowtie(),
        shapes::hub(40),
        shapes::moebius(12),
        shapes::soup(60, 7),
        shapes::box_with_face_normals(3),
        shapes::uv_sphere(12, 8),
        shapes::rock(600, 1),
    ]
}

#[test]
fn everything_goes_without_rules() {
    for (which, mesh) in meshes().iter().enumerate() {
        for placement in [Placement::Endpoint, Placement::Midpoint, Placement::Subset, Placement::Optimal] {
            for order in [Order::Linear, Order::Batched] {
                for measure in [ErrorMeasure::Parametric, ErrorMeasure::Measured, ErrorMeasure::Verified] {
                    for join in [0.0, 0.3] {
                        let simplifier = Simplifier::new().oracles(Vec::new()).placement(placement);
                        let sequence = simplifier
                            .order(order)
                            .error_measure(measure)
                            .join_distance(join)
                            .run(mesh)
                            .expect("options");
                        for steps in [0, sequence.len() / 2, sequence.len()] {
                            let level = sequence.extract(mesh, steps);
                            if steps > 0 {
                                assert_eq!(
                                    level.triangles().len(),
                                    sequence.triangles_after(steps),
                                    "mesh {which}"
                                );
                            }
                        }
                        assert!(sequence.report().error.is_finite());
                        if placement == Placement::Endpoint {
                            let built =
                                TotallyOrderedMesh::build(mesh, &sequence).expect("an endpoint sequence");
                            built.tom.validate().expect("a valid structure");
                        }
                    }
                }
            }
        }
    }
}
