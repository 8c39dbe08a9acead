//! Promise: files as other programs write them, after public bug reports, are read with all they hold. The files lie in
//! the folder `cases` of the models; `variants.rs` builds the like of them for those who have no models.
#![cfg(feature = "io")]

use std::path::Path;

use multires::io::{self, Imported, ReadOptions};
use multires::mesh::{Attribute, Mesh};

use crate::hostile_files::open_edges;

/// A file and what is read from it: vertices, triangles, attributes with the values of the first vertex, and words of
/// the only note (or of none).
type Case<'a> = (&'a str, usize, usize, &'a str, &'a str);

const CASES: &[Case<'static>] = &[
    (
        "meshlab_exports/all.obj",
        42,
        80,
        "uv 0.5257311 0.8506508, normal -2.9808674 4.823145 1e-16, color 1 0.498039 0",
        "",
    ),
    (
        "meshlab_exports/all.off",
        42,
        80,
        "normal -2.98087 4.82314 5.55112e-17, color 1 0.49803922 0 1, uv 0.525731 0.850651",
        "colours of faces left out, because vertices have colours",
    ),
    (
        "meshlab_exports/all.ply",
        42,
        80,
        "normal -2.9808674 4.823145 5.551115e-17, color 1 0.49803922 0 1, quality 0, uv 0.5257311 0.8506508",
        "colours of faces left out, because vertices have colours",
    ),
    ("meshlab_exports/all.stl", 42, 80, "", ""),
    ("obj_concave_ngon/comb.obj", 303, 301, "", ""),
    ("obj_faces_points_lines/lp.obj", 5, 2, "normal 0 0 1", "4 vertices have no normal"),
    ("obj_negative_interleaved/blocks.obj", 126, 240, "", ""),
    ("obj_partial_color/partial.obj", 42, 80, "color 1 0.5 0.25", ""),
    ("off_glued/glued.off", 6, 8, "", ""),
    ("off_glued/oneline.off", 6, 8, "", ""),
    ("off_variants/cnoff_meshlab.off", 42, 80, "normal -0.5257311 0.8506508 0, color 1 0.5019608 0 1", ""),
    ("off_variants/coff.off", 42, 80, "color 0.5 0.25 1 1", ""),
    ("off_variants/comments.off", 42, 80, "", ""),
    ("off_variants/facecolor.off", 42, 80, "color 1 0 0", ""),
    ("off_variants/lower.off", 42, 80, "", ""),
    ("off_variants/noedges.off", 42, 80, "", ""),
    ("off_variants/noff.off", 42, 80, "normal -0.5257311 0.8506508 0", ""),
    ("off_variants/off4.off", 42, 80, "", ""),
    (
        "off_variants/off_with_colors.off",
        42,
        80,
        "color 0.039215688 0.078431375 0.11764706 1",
        "4 more values than the first word says: taken for colours",
    ),
    ("off_variants/oneline.off", 42, 80, "", ""),
    ("off_variants/stoff.off", 42, 80, "uv 0.5 0.25", ""),
    ("ply_crlf_binary/cr.ply", 162, 320, "", ""),
    ("ply_crlf_binary/cr_then_0a.ply", 162, 320, "", ""),
    ("ply_crlf_binary/crlf.ply", 162, 320, "", ""),
    ("ply_crlf_binary/crlf_then_0a.ply", 162, 320, "", ""),
    ("ply_crlf_binary/lf.ply", 162, 320, "", ""),
    ("ply_crlf_binary/lf_then_0a.ply", 162, 320, "", ""),
    ("ply_crlf_binary/lf_then_0d.ply", 162, 320, "", ""),
    ("ply_diffuse_color/diffuse.ply", 42, 80, "color 1 0.5019608 0", ""),
    ("ply_extra_elements/extra.ply", 25, 32, "quality 0.5, color 1 0.5019608 0, flags", ""),
    // A square of 25 points, red on one side of a line of 5 points and blue on the other.
    ("ply_face_color/facecolor.ply", 30, 32, "color 1 0 0 1", ""),
    ("ply_long_row/long_face_row.ply", 6, 8, "", "8 rows have more values than properties"),
    ("ply_long_row/long_row.ply", 6, 8, "", "6 rows have more values than properties"),
    ("ply_types/double_uchar_uint.ply", 162, 320, "", ""),
    ("ply_types/double_uint_uint.ply", 162, 320, "", ""),
    ("ply_types/float_uint8_int32.ply", 162, 320, "", ""),
    ("ply_types/float_ushort_ushort.ply", 162, 320, "", ""),
    ("ply_wedge_texcoord/wedges.ply", 40, 32, "uv 0 0", "texture numbers of faces"),
    ("stl_binary_variants/color.stl", 42, 80, "", ""),
    ("stl_binary_variants/count0.stl", 42, 80, "", "the file declares 0 triangles; its size gives 80"),
    ("stl_binary_variants/countmax.stl", 42, 80, "", "its size gives 80"),
    ("stl_binary_variants/solid.stl", 42, 80, "", ""),
    ("stl_binary_variants/solid_facet.stl", 42, 80, "", ""),
    ("stl_binary_variants/solid_tail.stl", 42, 80, "", "4 bytes after the last triangle left out"),
    ("stl_text_variants/comma.stl", 42, 80, "", "240 vertices have decimal commas"),
    ("stl_text_variants/end_facet.stl", 42, 80, "", ""),
    ("stl_text_variants/end_loop.stl", 42, 80, "", ""),
    ("stl_text_variants/end_solid.stl", 42, 80, "", ""),
    ("stl_text_variants/long.stl", 42, 80, "", ""),
    ("stl_text_variants/msnan.stl", 42, 80, "", ""),
    ("stl_text_variants/name_endsolid.stl", 42, 80, "", ""),
    ("stl_text_variants/name_with_facet.stl", 42, 80, "", ""),
    ("stl_text_variants/nan.stl", 42, 80, "", ""),
    ("stl_text_variants/nannum.stl", 42, 80, "", ""),
    ("stl_text_variants/upper.stl", 42, 80, "", ""),
    ("stl_text_variants/vertex_name.stl", 42, 80, "", ""),
];

fn load(path: &Path) -> Imported {
    io::read_with(path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Names of the attributes, with the values of the first vertex where they are floats.
fn attributes(mesh: &Mesh) -> String {
    let of = |attribute: &Attribute| {
        let values = attribute.as_floats().map_or(&[][..], |values| &values[..attribute.width()]);
        let shown = values
            .iter()
            .map(|x| if x.abs() < 1e-3 && *x != 0.0 { format!(" {x:e}") } else { format!(" {x}") });
        format!("{}{}", attribute.name(), shown.collect::<String>())
    };
    mesh.attributes().iter().map(of).collect::<Vec<_>>().join(", ")
}

#[test]
fn every_case_is_read_with_all_it_holds() {
    let Some(folder) = crate::models::find("every_case_is_read_with_all_it_holds", "cases") else { return };
    let mut wrong = Vec::new();
    for &(file, vertices, triangles, wanted, note) in CASES {
        let found = load(&folder.join(file));
        let counts = (found.mesh.positions().len(), found.mesh.triangles().len());
        let (attributes, notes) = (attributes(&found.mesh), found.notes.join("; "));
        let noted = notes.contains(note) && (notes.is_empty() == note.is_empty());
        if counts != (vertices, triangles) || attributes != wanted || !noted {
            wrong.push(format!("{file}: {counts:?} {attributes:?} {notes:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));

    // No file of these formats is forgotten.
    let kinds = ["obj_", "off_", "ply_", "stl_", "meshlab_"];
    for entry in std::fs::read_dir(&folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !kinds.iter().any(|kind| name.starts_with(kind)) {
            continue;
        }
        for file in std::fs::read_dir(folder.join(&name)).unwrap() {
            let file = format!("{name}/{}", file.unwrap().file_name().into_string().unwrap());
            let listed = CASES.iter().any(|case| case.0 == file) || file.ends_with(".mtl");
            assert!(listed, "{file} is not listed");
        }
    }
}

/// Files of 42 vertices and of 162 hold spheres: closed, and all alike.
#[test]
fn cases_of_one_shape_are_alike() {
    let Some(folder) = crate::models::find("cases_of_one_shape_are_alike", "cases") else { return };
    for (vertices, triangles) in [(42, 80), (162, 320)] {
        let of_shape = CASES.iter().filter(|case| (case.1, case.2) == (vertices, triangles));
        let mut shape: Option<[Vec<i64>; 2]> = None;
        for (file, ..) in of_shape {
            let mesh = load(&folder.join(file)).mesh;
            assert_eq!(open_edges(&mesh), 0, "{file}");
            // STL numbers vertices by appearance: coordinates by size, whatever their order.
            let rounded = |x: &f32| (f64::from(*x) * 1e4).round() as i64;
            let mut places: Vec<i64> = mesh.positions().as_flattened().iter().map(rounded).collect();
            let corner = |v: &u32| mesh.positions()[*v as usize];
            let mut corners: Vec<i64> =
                mesh.indices().iter().map(corner).flat_map(|p| p.map(|x| rounded(&x))).collect();
            places.sort_unstable();
            corners.sort_unstable();
            match &shape {
                None => shape = Some([places, corners]),
                Some(wanted) => assert!(*wanted == [places, corners], "{file}"),
            }
        }
    }
}

#[test]
fn values_of_cases_are_where_they_belong() {
    let Some(folder) = crate::models::find("values_of_cases_are_where_they_belong", "cases") else { return };
    // Every second vertex has no colour.
    let mesh = load(&folder.join("obj_partial_color/partial.obj")).mesh;
    let colors = mesh.attribute("color").unwrap().as_floats().unwrap();
    assert!(colors.chunks_exact(6).all(|pair| pair[..3] == [1.0, 0.5, 0.25] && pair[3..] == [1.0; 3]));

    // The texture of each half of the square is shifted against its places by its own amount.
    let mesh = load(&folder.join("ply_wedge_texcoord/wedges.ply")).mesh;
    let uv = mesh.attribute("uv").unwrap().as_floats().unwrap();
    for triangle in mesh.triangles() {
        let shift = triangle.map(|v| {
            let place = mesh.positions()[v as usize];
            [uv[2 * v as usize] - place[0] / 2.0, uv[2 * v as usize + 1] - place[1]]
        });
        assert!(shift[0] == shift[1] && shift[1] == shift[2], "{triangle:?} {shift:?}");
    }

    // Each triangle has one colour.
    let mesh = load(&folder.join("ply_face_color/facecolor.ply")).mesh;
    let color = mesh.attribute("color").unwrap().as_floats().unwrap();
    let of = |v: u32| &color[4 * v as usize..][..4];
    assert!(mesh.triangles().iter().all(|&[a, b, c]| of(a) == of(b) && of(b) == of(c)));
    assert!(mesh.triangles().iter().any(|&[a, ..]| of(a) == [0.0, 0.0, 1.0, 1.0]));
}
