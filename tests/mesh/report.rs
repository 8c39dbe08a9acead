//! The report's counts: exact on small awkward meshes, and equal to the published table for real models.
//!
//! The models lie in `$MULTIRES_MODELS`, `../shared/models` by default; what is missing there is skipped by name.

use multires::mesh::{Attribute, Mesh, Report, names, shapes};

fn expect(report: &Report, expected: [i64; 7]) {
    let found = [
        report.border_edges as i64,
        report.non_manifold_edges as i64,
        report.non_manifold_vertices as i64,
        report.flipped_edges as i64,
        report.components as i64,
        report.euler_characteristic,
        report.duplicate_triangles as i64,
    ];
    assert_eq!(found, expected, "border, nm edges, nm vertices, flipped, components, Euler, duplicates");
}

#[test]
fn awkward_meshes_have_exact_counts() {
    expect(&Report::new(&shapes::tetrahedron()), [0, 0, 0, 0, 1, 2, 0]);
    expect(&Report::new(&shapes::pillow()), [0, 0, 0, 0, 1, 2, 1]);
    expect(&Report::new(&shapes::book(2)), [6, 0, 0, 0, 1, 1, 0]);
    expect(&Report::new(&shapes::book(7)), [21, 1, 0, 0, 1, 1, 0]);
    expect(&Report::new(&shapes::bowtie()), [8, 0, 1, 0, 1, 1, 0]);
    expect(&Report::new(&shapes::two_spheres_touching(1)), [0, 0, 1, 0, 1, 3, 0]);
    expect(&Report::new(&shapes::moebius(20)), [40, 0, 0, 1, 1, 0, 0]);
    expect(&Report::new(&shapes::hub(1000)), [1000, 0, 0, 0, 1, 1, 0]);
    expect(&Report::new(&shapes::spindle(1000)), [0, 0, 0, 0, 1, 2, 0]);
    expect(&Report::new(&shapes::soup(50, 1)), [150, 0, 0, 0, 50, 50, 0]);
    expect(&Report::new(&Mesh::default()), [0; 7]);
    assert_eq!(Report::new(&Mesh::default()).genus(), None);
}

/// ```text
///     1---3     triangles 0 1 2, its copies turned and reversed, one of a repeated index, one without area,
///     |\  |     two more at positions of the first, and an unused vertex
///     0-2-4
/// ```
#[test]
fn duplicate_degenerate_and_unused_parts_are_counted() {
    let positions = vec![
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 0.0, -0.0],
        [9.0, 9.0, 9.0],
    ];
    let triangles = [[0, 2, 1], [1, 0, 2], [2, 0, 1], [3, 3, 4], [0, 2, 4], [5, 2, 1]];
    let mesh = Mesh::new(positions, triangles).unwrap();

    let stored = Report::new(&mesh);
    assert_eq!((stored.vertices, stored.triangles), (7, 6));
    assert_eq!(stored.duplicate_triangles, 2);
    assert_eq!(stored.degenerate_triangles, 2);
    assert_eq!(stored.duplicate_vertices, 1);
    assert_eq!(stored.unused_vertices, 1);
    assert_eq!(stored.wedges, 6, "a negative zero is no other position");
    assert_eq!(stored.components, 1);
    assert_eq!(stored.diagonal, 5.0_f64.sqrt());
    // 0 1 2 4 5; 0-1 0-2 1-2 0-4 2-4 5-1 5-2; all but the one of a repeated index.
    assert_eq!(stored.euler_characteristic, 5 - 7 + 5);

    let welded = Report::welded(&mesh);
    assert_eq!((welded.vertices, welded.triangles), (6, 6));
    assert_eq!(welded.duplicate_triangles, 3);
    assert_eq!((welded.duplicate_vertices, welded.unused_vertices), (1, 1));
    assert_eq!(welded.euler_characteristic, 4 - 5 + 5);
}

/// Flat is what has at most 1e-10 of its longest edge squared for an area, whatever its size.
#[test]
fn needles_and_caps_are_degenerate() {
    let degenerate = |scale: f32, height: f32| {
        let positions = [[0.0; 3], [scale, 0.0, 0.0], [0.5 * scale, height * scale, 0.0]];
        Report::new(&Mesh::new(positions, [[0, 1, 2]]).unwrap()).degenerate_triangles
    };
    for scale in [1e-18, 1.0, 1e18, 3e38] {
        assert_eq!(degenerate(scale, 1.9e-10), 1, "at scale {scale}");
        assert_eq!(degenerate(scale, 2.1e-10), 0, "at scale {scale}");
    }
}

#[test]
fn seams_are_positions_with_several_texture_coordinates() {
    let positions = vec![[0.0; 3], [0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    // Vertices 0 and 1 agree; 2 does not; 5 differs from 3 but is not used.
    let uv = [[0.5, 0.5], [0.5, 0.5], [0.0, 0.5], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    let mesh = |triangles: &[[u32; 3]]| {
        let mesh = Mesh::new(positions.clone(), triangles).unwrap();
        mesh.with_attribute(Attribute::floats(names::UV, &uv)).unwrap()
    };
    assert_eq!(Report::new(&mesh(&[[0, 3, 4], [1, 4, 3]])).seam_vertices, 0);
    assert_eq!(Report::new(&mesh(&[[0, 3, 4], [2, 4, 3]])).seam_vertices, 1);
    assert_eq!(Report::welded(&mesh(&[[0, 3, 4], [2, 4, 5]])).seam_vertices, 2);
    assert_eq!(Report::new(&mesh(&[[0, 3, 4]])).wedges, 5);
}

#[test]
fn genus_needs_a_closed_oriented_manifold() {
    assert_eq!(Report::new(&shapes::icosphere(2)).genus(), Some(0));
    assert_eq!(Report::new(&shapes::torus(1.0, 0.3, 9, 5)).genus(), Some(1));
    for open in [shapes::plane(3), shapes::open_cylinder(5, 2), shapes::moebius(7)] {
        assert_eq!(Report::new(&open).genus(), None);
        assert!(Report::new(&open).is_manifold());
    }
    assert_eq!(Report::new(&shapes::two_spheres_touching(0)).genus(), None);
    let sphere = shapes::icosphere(1);
    let mut triangles = sphere.triangles().to_vec();
    triangles[7].swap(0, 1);
    let flipped = Report::new(&Mesh::new(sphere.positions(), triangles).unwrap());
    assert_eq!((flipped.flipped_edges, flipped.genus()), (3, None));
    assert!(flipped.is_closed());
}

#[test]
fn the_text_is_aligned() {
    let text = Report::new(&shapes::plane(40)).to_string();
    assert!(text.lines().all(|line| line.len() == 35), "{text}");
    assert!(text.contains("vertices                      1,681\n"), "{text}");
    assert!(text.contains("triangles                     3,200\n"), "{text}");
    assert!(text.ends_with("surface              open, manifold"), "{text}");
}

#[cfg(feature = "io")]
mod table {
    use std::path::{Path, PathBuf};

    use super::*;

    /// One line of the table, its counts in the table's order.
    struct Row {
        file: PathBuf,
        vertices: usize,
        /// After fanning polygons.
        triangles: usize,
        polygons: bool,
        /// Open edges, non-manifold edges, non-manifold vertices, flipped edges, pieces.
        surface: [usize; 5],
        euler: i64,
        /// Duplicate vertices, duplicate faces, degenerate faces, unused vertices.
        blemishes: [usize; 4],
        seam_vertices: usize,
        /// Four digits of it.
        diagonal: f64,
    }

    fn number<T: std::str::FromStr>(text: &str) -> T {
        let digits: String = text.trim().chars().filter(|&c| c != ',').collect();
        digits.parse().unwrap_or_else(|_| panic!("{text:?} is no number"))
    }

    /// The lines of `## real/` and `## subdivision/` that hold counts.
    fn rows(models: &Path, readme: &str) -> Vec<Row> {
        let mut rows = Vec::new();
        let mut folder = None;
        for line in readme.lines() {
            if let Some(title) = line.strip_prefix("## ") {
                folder = ["real/", "subdivision/"].into_iter().find(|f| title.starts_with(f));
            }
            let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
            let (Some(folder), Some(name)) = (folder, cells[0].strip_prefix('`')) else { continue };
            if cells.len() != 17 {
                continue;
            }
            // "500 (968 tri)" and "UV (3,225, 277 seam v), N"
            let fanned = cells[2].split_once('(').and_then(|(_, tri)| tri.strip_suffix(" tri)"));
            let seam = cells[13].split_once(" seam v").and_then(|(before, _)| before.rsplit(' ').next());
            rows.push(Row {
                file: models.join(folder).join(name.trim_matches('`')),
                vertices: number(cells[1]),
                triangles: number(fanned.unwrap_or(cells[2])),
                polygons: fanned.is_some(),
                surface: [3, 4, 5, 6, 7].map(|column| number(cells[column])),
                euler: number(cells[8]),
                blemishes: [9, 10, 11, 12].map(|column| number(cells[column])),
                seam_vertices: seam.map_or(0, number),
                diagonal: number(cells[14]),
            });
        }
        rows
    }

    fn models() -> Option<(PathBuf, String)> {
        let models = crate::models::all("mesh/report")?;
        let readme = models.join("README.md");
        match std::fs::read_to_string(&readme) {
            Ok(text) => Some((models, text)),
            Err(_) => {
                eprintln!("skipped: {} is missing", readme.display());
                None
            }
        }
    }

    fn read(file: &Path) -> Option<Mesh> {
        if !file.exists() {
            eprintln!("skipped: {} is missing", file.display());
            return None;
        }
        Some(multires::io::read(file).unwrap_or_else(|error| panic!("{}: {error}", file.display())))
    }

    fn surface(report: &Report) -> [usize; 5] {
        [
            report.border_edges,
            report.non_manifold_edges,
            report.non_manifold_vertices,
            report.flipped_edges,
            report.components,
        ]
    }

    /// The table counts by the file's position index. Where texture coordinates or normals make the reader split
    /// vertices, the stored vertices are more than that, and the welded report is the one to compare: it has the same
    /// points, because those files have no duplicate positions of their own. What never depends on that (triangles,
    /// degenerate ones, seams, the diagonal) is compared always.
    #[test]
    fn every_real_model_agrees_with_the_table() {
        let Some((models, readme)) = models() else { return };
        let rows = rows(&models, &readme);
        assert!(rows.len() >= 39, "only {} lines of the table were understood", rows.len());
        for row in rows {
            let Some(mesh) = read(&row.file) else { continue };
            let file = row.file.display();
            let stored = Report::new(&mesh);
            let split = stored.vertices != row.vertices;
            assert!(!split || row.blemishes[0] == 0, "{file}: {} vertices", stored.vertices);
            let report = if split { Report::welded(&mesh) } else { stored };

            assert_eq!(report.vertices, row.vertices, "{file}: vertices");
            assert_eq!(report.triangles, row.triangles, "{file}: triangles");
            // Two quads of suzanne share three corners, so that fanning makes one triangle and one diagonal twice.
            // In all other polygon files diagonals are new edges, and change neither of these counts.
            let twice = usize::from(row.polygons && row.file.ends_with("suzanne.obj"));
            let [open, edges, vertices, flipped, pieces] = row.surface;
            assert_eq!(surface(&report), [open, edges + twice, vertices, flipped, pieces], "{file}: surface");
            assert_eq!(report.euler_characteristic, row.euler + twice as i64, "{file}: Euler characteristic");
            let [duplicates, faces, degenerate, unused] = row.blemishes;
            if !split {
                assert_eq!(report.duplicate_vertices, duplicates, "{file}: duplicate vertices");
            }
            assert_eq!(report.duplicate_triangles, faces + twice, "{file}: duplicate triangles");
            assert_eq!(report.degenerate_triangles, degenerate, "{file}: degenerate triangles");
            assert_eq!(report.unused_vertices, unused, "{file}: unused vertices");
            assert_eq!(report.seam_vertices, row.seam_vertices, "{file}: seam vertices");
            let off = (report.diagonal - row.diagonal).abs() / row.diagonal;
            assert!(off < 5e-4, "{file}: diagonal {} is not {}", report.diagonal, row.diagonal);
        }
    }

    /// "- `real/teapot.obj` welded exactly: 3,241 vertices, 160 open edges, 0 non-manifold edges, 3 pieces, χ = 1"
    #[test]
    fn welding_agrees_with_the_notes() {
        let Some((models, readme)) = models() else { return };
        let mut seen = 0;
        for line in readme.lines().filter(|line| line.starts_with("- `real/")) {
            let Some((name, counts)) = line[3..].split_once("` welded exactly: ") else { continue };
            seen += 1;
            let Some(mesh) = read(&models.join(name)) else { continue };
            let report = Report::welded(&mesh);
            // As above: the table counts polygons.
            let twice = i64::from(name == "real/suzanne.obj");
            let found = [
                report.vertices as i64,
                report.border_edges as i64,
                report.non_manifold_edges as i64 - twice,
                report.components as i64,
                report.euler_characteristic - twice,
            ];
            let counts: Vec<i64> = counts
                .split(", ")
                .map(|part| number(part.trim_start_matches("χ = ").split(' ').next().unwrap_or("")))
                .collect();
            assert_eq!(counts, found, "{name}");
        }
        assert!(seen >= 2, "the notes on welding were not understood");
    }
}
