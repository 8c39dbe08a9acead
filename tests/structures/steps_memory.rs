//! Promise: the table by which cursors move is in proportion to the mesh, whatever its chains of substitutes; extraction takes time in
//! proportion to vertices and triangles, also where every triangle hangs on such a chain.

use multires::mesh::{Mesh, shapes};
use multires::tom::{ErrorMark, TomError, TomParts, TomSteps, TotallyOrderedMesh};
use multires::{Level, Structure};

/// Three chains through all vertices, and triangles that all hang on their ends.
fn chains(vertices: u32, triangles: usize) -> TotallyOrderedMesh {
    let parts = TomParts {
        substitute: (0..vertices).map(|v| if v < 3 { v } else { v - 3 }).collect(),
        joined: Vec::new(),
        base_vertices: 3,
        triangles: vec![[vertices - 1, vertices - 2, vertices - 3]; triangles],
        error_marks: vec![ErrorMark { vertices: 3, error: 0.0 }],
        material_of: Vec::new(),
        material_ids: Vec::new(),
    };
    parts.try_into().unwrap()
}

fn line(triangles: u32) -> Mesh {
    let positions: Vec<[f32; 3]> = (0..triangles + 2).map(|v| [v as f32, 0.0, 0.0]).collect();
    let triangles: Vec<[u32; 3]> = (0..triangles).map(|t| [t, t + 1, t + 2]).collect();
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn long_chains_are_refused_and_still_extracted() {
    // As a file: 0.6 MB. Its table had 200 million moves.
    let tom = chains(30_000, 7_000);
    for steps in [TomSteps::new(tom.clone()), TomSteps::by_material(tom.clone())] {
        assert!(matches!(steps, Err(TomError::TooManyMoves { limit, .. }) if limit == 64 * 3 * 7_000));
    }
    for vertices in [3, 4, 5, 100, 29_999, 30_000] {
        let resolution = tom.at(Level::Vertices(vertices));
        let active = resolution.vertices() as u32;
        let end =
            |corner: u32| if corner < active { corner } else { active - 1 - (active - 1 - corner % 3) % 3 };
        let expected: Vec<u32> =
            [29_999, 29_998, 29_997].repeat(resolution.triangles()).into_iter().map(end).collect();
        let mut filled = Vec::new();
        tom.fill_indices(resolution, &mut filled);
        assert!(filled == expected, "{vertices}");
        let mut written = vec![0; tom.index_count(resolution)];
        assert_eq!(tom.write_indices(resolution, &mut written), written.len());
        assert!(written == expected, "{vertices}");
    }
}

#[test]
fn meshes_have_a_few_moves_a_corner() {
    let meshes = [
        ("sphere", shapes::icosphere(4)),
        ("terrain", shapes::terrain(60, 1)),
        ("hub", shapes::hub(3_000)),
        ("spindle", shapes::spindle(3_000)),
        ("book", shapes::book(3_000)),
        ("line", line(3_000)),
        ("soup", shapes::soup(3_000, 1)),
        ("forest", shapes::forest(200, 6, 1)),
        ("gravel", shapes::gravel(200, 1)),
    ];
    for (name, mesh) in meshes {
        let model = TotallyOrderedMesh::bake(&mesh).unwrap();
        let steps = TomSteps::new(model.structure().clone()).unwrap();
        // Four bytes a move and a vertex.
        let (entries, corners) = (steps.table_memory() / 4, 3 * mesh.triangles().len());
        let most = 16 * corners + model.structure().vertex_count() + 8;
        assert!(entries <= most, "{name}: {entries} entries for {corners} corners");
    }
}
