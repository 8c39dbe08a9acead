//! Promise: variants of a format that programs write every day are read with all they hold.
#![cfg(feature = "io")]

use multires::io::{self, Format, Imported, ReadOptions};
use multires::mesh::{Attribute, Mesh};

fn read(format: Format, bytes: impl AsRef<[u8]>) -> Imported {
    let bytes = bytes.as_ref();
    let shown = || String::from_utf8_lossy(bytes).into_owned();
    io::read_bytes_with(format, bytes, &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{format}: {e}\n{}", shown()))
}

fn floats<'a>(mesh: &'a Mesh, name: &str) -> &'a [f32] {
    mesh.attribute(name).and_then(Attribute::as_floats).unwrap_or_else(|| panic!("no {name}"))
}

fn names(mesh: &Mesh) -> Vec<(&str, usize)> {
    mesh.attributes().iter().map(|a| (a.name(), a.width())).collect()
}

/// Position and value of each corner: what the triangles look like, however vertices are numbered.
fn corners(mesh: &Mesh, name: &str) -> Vec<([f32; 3], Vec<f32>)> {
    let (values, width) = (floats(mesh, name), mesh.attribute(name).unwrap().width());
    let of = |&v: &u32| (mesh.positions()[v as usize], values[v as usize * width..][..width].to_vec());
    mesh.indices().iter().map(of).collect()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
/// ```text
///   3---2
///   | / |
///   0---1
/// ```
const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const ROWS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

fn ply(vertex: &str, face: &str, rows: &str) -> String {
    let list = "property list uchar int vertex_indices\n";
    let faces = rows.lines().count() - 4;
    format!(
        "ply\nformat ascii 1.0\nelement vertex 4\n{XYZ}{vertex}element face {faces}\n{list}{face}end_header\n{rows}"
    )
}

#[test]
fn ply_uv_by_corner_splits_vertices_where_it_differs() {
    let texcoord = "property list uchar float texcoord\nproperty int texnumber\n";
    let rows = "3 0 1 2 6 0 0 .5 0 .5 1 0\n3 0 2 3 6 0 0 1 1 0 1 1\n";
    let found = read(Format::Ply, ply("", texcoord, &format!("{ROWS}{rows}")));
    // Vertex 2 has two UV, the others one.
    assert_eq!(found.mesh.triangles(), [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(floats(&found.mesh, "uv"), [0.0, 0.0, 0.5, 0.0, 0.5, 1.0, 1.0, 1.0, 0.0, 1.0]);
    assert_eq!(found.mesh.positions()[2..4], [SQUARE[2]; 2]);
    assert_eq!(found.notes, ["texture numbers of faces (texnumber) left out"]);

    // Polygons, and faces with another number of coordinates.
    let rows = "4 0 1 2 3 8 0 0 1 0 1 1 0 1 0\n3 0 1 2 0 0\n";
    let found = read(Format::Ply, ply("", texcoord, &format!("{ROWS}{rows}")));
    let uvs: Vec<Vec<f32>> = corners(&found.mesh, "uv").into_iter().map(|(_, uv)| uv).collect();
    let wanted = [[0., 0.], [1., 0.], [1., 1.], [0., 0.], [1., 1.], [0., 1.], [0., 0.], [0., 0.], [0., 0.]];
    assert_eq!(uvs, wanted);
    assert_eq!(
        found.notes[1],
        "1 faces without two texture coordinates a corner: theirs count as 0, such as at face 1"
    );

    // UV by corner replaces UV by vertex; other attributes follow their vertices.
    let vertex = "property float s\nproperty float t\nproperty float quality\n";
    let rows = "0 0 0 7 7 1\n1 0 0 7 7 2\n1 1 0 7 7 3\n0 1 0 7 7 4\n3 0 1 2 6 0 0 1 0 1 1 0\n3 2 3 0 6 5 5 0 1 0 0 0\n";
    let found = read(Format::Ply, ply(vertex, texcoord, rows));
    assert_eq!(names(&found.mesh), [("quality", 1), ("uv", 2)]);
    assert_eq!(floats(&found.mesh, "quality"), [1.0, 2.0, 3.0, 3.0, 4.0]);
    assert_eq!(found.notes[1], "UV by vertex left out, because faces have UV by corner");
}

#[test]
fn ply_uv_by_corner_is_read_before_the_vertices_and_in_binary() {
    let header = |order: &str| {
        format!(
            "ply\nformat {order} 1.0\nelement face 1\nproperty list uchar float texcoord\n\
            property list uchar uchar vertex_index\nelement vertex 3\n{XYZ}end_header\n"
        )
    };
    let text = format!("{}6 0 0 .25 0 0 1\n3 0 1 2\n0 0 0 1 0 0 0 1 0\n", header("ascii"));
    let mut binary = header("binary_big_endian").into_bytes();
    binary.push(6);
    binary.extend([0.0, 0.0, 0.25, 0.0, 0.0, 1.0].iter().flat_map(|x: &f32| x.to_be_bytes()));
    binary.extend([3, 0, 1, 2]);
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0_f32]];
    binary.extend(positions.as_flattened().iter().flat_map(|x| x.to_be_bytes()));
    let found = read(Format::Ply, &binary);
    assert_eq!(found, read(Format::Ply, text));
    assert_eq!(found.mesh.positions(), positions);
    assert_eq!(floats(&found.mesh, "uv"), [0.0, 0.0, 0.25, 0.0, 0.0, 1.0]);
}

#[test]
fn ply_colours_of_faces_become_those_of_their_corners() {
    let color = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let rows = "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n";
    let found = read(Format::Ply, ply("", color, &format!("{ROWS}{rows}")));
    assert_eq!(found.mesh.positions().len(), 6);
    let colors: Vec<Vec<f32>> = corners(&found.mesh, "color").into_iter().map(|(_, color)| color).collect();
    assert_eq!(colors, [vec![[1.0, 0.0, 0.0]; 3], vec![[0.0, 0.0, 1.0]; 3]].concat());
    let places: Vec<[f32; 3]> = corners(&found.mesh, "color").into_iter().map(|(place, _)| place).collect();
    assert_eq!(places, [0, 1, 2, 0, 2, 3].map(|v: usize| SQUARE[v]));
    assert!(found.notes.is_empty(), "{:?}", found.notes);

    // Of one colour, no vertex is split.
    let found = read(Format::Ply, ply("", color, &format!("{ROWS}{}", rows.replace("0 0 255", "255 0 0"))));
    assert_eq!(found.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(found.mesh.positions(), SQUARE);

    // With UV by corner, and with an alpha.
    let both = format!("{color}property uchar alpha\nproperty list uchar float texcoord\n");
    let rows = "3 0 1 2 255 0 0 51 6 0 0 1 0 1 1\n3 0 2 3 255 0 0 51 6 0 0 1 1 0 1\n";
    let found = read(Format::Ply, ply("", &both, &format!("{ROWS}{rows}")));
    assert_eq!(names(&found.mesh), [("uv", 2), ("color", 4)]);
    assert_eq!(floats(&found.mesh, "color"), [1.0, 0.0, 0.0, 0.2].repeat(4));
    assert_eq!(floats(&found.mesh, "uv"), [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]);

    // Colours of vertices are finer.
    let rows = "0 0 0 1 1 1\n1 0 0 1 1 1\n1 1 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2 255 0 0\n";
    let vertex = "property float red\nproperty float green\nproperty float blue\n";
    let found = read(Format::Ply, ply(vertex, color, rows));
    assert_eq!(floats(&found.mesh, "color"), [1.0; 12]);
    assert_eq!(found.notes, ["colours of faces left out, because vertices have colours"]);
}

#[test]
fn ply_diffuse_colours_are_colours() {
    for prefix in ["", "diffuse_"] {
        let color = ["red", "green", "blue"].map(|name| format!("property uchar {prefix}{name}\n")).concat();
        let rows = "0 0 0 255 0 51\n1 0 0 255 0 51\n1 1 0 255 0 51\n0 1 0 255 0 51\n3 0 1 2\n";
        let mesh = read(Format::Ply, ply(&color, "", rows)).mesh;
        assert_eq!(floats(&mesh, "color"), [1.0, 0.0, 0.2].repeat(4));
        let mesh = read(Format::Ply, ply("", &color, &format!("{ROWS}3 0 1 2 255 0 51\n"))).mesh;
        assert_eq!(floats(&mesh, "color"), [[1.0, 0.0, 0.2].repeat(3), vec![1.0; 3]].concat());
    }
}

#[test]
fn ply_rows_may_be_long_where_a_row_is_an_entry() {
    let plain = read(Format::Ply, ply("", "", &format!("{ROWS}3 0 1 2\n3 0 2 3\n"))).mesh;
    let rows = "0 0 0 .5\n1 0 0\n1 1 0 x\n\n0 1 0 .5 7\n3 0 1 2 255 0 0\n3 0 2 3  \n";
    let text = ply("", "", rows).replace("element face 3", "element face 2");
    for text in [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r")] {
        let found = read(Format::Ply, &text);
        assert_eq!(found.mesh, plain);
        assert!(found.notes[0].starts_with("4 rows have more values than properties"), "{:?}", found.notes);
        assert!(found.notes[0].ends_with("at line 10"), "{:?}", found.notes);
    }
    // Rows that are no entries are values in sequence, as before.
    let text = ply("", "", &format!("{ROWS}3 0 1 2\n3 0 2 3\n"));
    let (header, body) = text.split_once("end_header\n").unwrap();
    for blank in [" ", "\n", "\n \n"] {
        let body = body.replace(['\n', ' '], blank);
        let found = read(Format::Ply, format!("{header}end_header\n{body}"));
        assert_eq!((found.mesh, found.notes.len()), (plain.clone(), 0));
    }
    let found = read(Format::Ply, format!("{text}and more\n"));
    assert_eq!(found.mesh, plain);
    assert_eq!(found.notes, ["text after the last entry left out, from line 16 on"]);
}

/// Every type of coordinates, counts and indices, with every byte order and line end.
#[test]
fn ply_types_and_line_ends_are_all_the_same() {
    let values =
        ["char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "float32", "uint16"];
    let put = |kind: &str, value: u8, big: bool, out: &mut Vec<u8>| {
        let size = match kind {
            "char" | "uchar" | "int8" => 1,
            "short" | "ushort" | "uint16" => 2,
            "double" => 8,
            _ => 4,
        };
        let mut bytes = match kind {
            "float" | "float32" => f32::from(value).to_le_bytes().to_vec(),
            "double" => f64::from(value).to_le_bytes().to_vec(),
            _ => [vec![value], vec![0; size - 1]].concat(),
        };
        if big {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    // 10 and 13 are line ends in text: here the first byte of the body.
    let positions = [[10, 0, 0], [13, 13, 10], [0, 1, 0_u8]];
    let wanted = positions.map(|p| p.map(f32::from));
    for (x, count, index) in
        values.iter().flat_map(|x| values.iter().map(move |c| (x, c))).flat_map(|(x, c)| {
            values.iter().filter(|k| !k.starts_with("float") && **k != "double").map(move |i| (x, c, i))
        })
    {
        for (big, end) in [(false, "\n"), (false, "\r\n"), (false, "\r"), (true, "\n"), (true, "\r")] {
            let order = if big { "big" } else { "little" };
            let header = format!(
                "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty {x} x\nproperty {x} y\n\
                property {x} z\nelement face 1\nproperty list {count} {index} vertex_indices\nend_header\n"
            );
            let mut bytes = header.replace('\n', end).into_bytes();
            positions.as_flattened().iter().for_each(|&value| put(x, value, big, &mut bytes));
            put(count, 3, big, &mut bytes);
            [0, 1, 2].into_iter().for_each(|i| put(index, i, big, &mut bytes));
            let mesh = read(Format::Ply, &bytes).mesh;
            assert_eq!(mesh.positions(), wanted, "{x} {count} {index} {end:?}");
            assert_eq!(mesh.triangles(), [[0, 1, 2]]);
        }
    }
}

/// First word, rows of vertices, and attributes with the values of the first vertex.
#[test]
fn off_vertices_are_read_under_every_first_word() {
    type Wanted<'a> = &'a [(&'a str, &'a [f32])];
    let table: &[(&str, &str, &str, Wanted)] = &[
        ("OFF", "", "", &[]),
        ("off", "", "", &[]),
        ("Off", "", "", &[]),
        ("NOFF", " 0 0 1", "", &[("normal", &[0., 0., 1.])]),
        ("noff", " 0 0 1", "", &[("normal", &[0., 0., 1.])]),
        ("COFF", " .5 .25 1 1", "", &[("color", &[0.5, 0.25, 1.0, 1.0])]),
        ("coff", " .5 .25 1", "", &[("color", &[0.5, 0.25, 1.0])]),
        ("COFF", " 1 0 1", "", &[("color", &[1.0, 0.0, 1.0])]),
        ("COFF", " 255 0 51 255", "", &[("color", &[1.0, 0.0, 0.2, 1.0])]),
        ("STOFF", " .5 .25", "", &[("uv", &[0.5, 0.25])]),
        ("STCOFF", " 255 0 51 .5 .25", "", &[("color", &[1.0, 0.0, 0.2]), ("uv", &[0.5, 0.25])]),
        // Geomview's order, and MeshLab's: told by values, by lengths, by the first word.
        (
            "CNOFF",
            " 0 0 -1 255 0 51 255",
            "",
            &[("normal", &[0., 0., -1.]), ("color", &[1.0, 0.0, 0.2, 1.0])],
        ),
        (
            "CNOFF",
            " 255 0 51 255 0 0 -1",
            "",
            &[("normal", &[0., 0., -1.]), ("color", &[1.0, 0.0, 0.2, 1.0])],
        ),
        ("CNOFF", " 255 0 51 0 0 1", "", &[("normal", &[0., 0., 1.]), ("color", &[1.0, 0.0, 0.2])]),
        ("NCOFF", " 0 1 0 255 0 51", "", &[("normal", &[0., 1., 0.]), ("color", &[1.0, 0.0, 0.2])]),
        ("NCOFF", " 1 0 0 0 1 0", "", &[("normal", &[0., 1., 0.]), ("color", &[1.0, 0.0, 0.0])]),
        ("CNOFF", " 1 0 0 0 1 0", "", &[("normal", &[1., 0., 0.]), ("color", &[0.0, 1.0, 0.0])]),
        (
            "NCSTOFF",
            " 255 0 51 255 -2.98 4.82 5e-17 .5 .25",
            "",
            &[("normal", &[-2.98, 4.82, 5e-17]), ("color", &[1.0, 0.0, 0.2, 1.0]), ("uv", &[0.5, 0.25])],
        ),
        (
            "STCN4OFF",
            " 1 0 0 -1 1 .5 0 .5 .25",
            "",
            &[("normal", &[0., 0., -1.]), ("color", &[1.0, 0.5, 0.0]), ("uv", &[0.5, 0.25])],
        ),
        ("4OFF", " 1", "", &[]),
        ("nOFF 3", "", "", &[]),
        // More values than the word says.
        (
            "OFF",
            " 10 20 51",
            "3 more values than the first word says: taken for colours",
            &[("color", &[0.039_215_688, 0.078_431_375, 0.2])],
        ),
        ("OFF", " .5 0 1 1", "4 more values", &[("color", &[0.5, 0.0, 1.0, 1.0])]),
        ("OFF", " 0 0 -1", "taken for normals", &[("normal", &[0., 0., -1.])]),
        ("OFF", " 9", "1 more values than the first word says: left out", &[]),
    ];
    for &(word, values, note, wanted) in table {
        let rows: String = ROWS.lines().map(|row| format!("{row}{values}\n")).collect();
        let text = format!("{word}\n4 2 5\n{rows}3 0 1 2\n3 0 2 3\n");
        let found = read(Format::Off, &text);
        let (mesh, about) = (&found.mesh, format!("{text}{:?}", found.mesh.attributes()));
        assert_eq!(mesh.positions(), SQUARE, "{about}");
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]], "{about}");
        assert_eq!(mesh.attributes().len(), wanted.len(), "{about}");
        for (name, value) in wanted {
            assert_eq!(floats(mesh, name), value.repeat(4), "{about}");
        }
        let notes = found.notes.join("; ");
        assert!(notes.contains(note) && notes.is_empty() == note.is_empty(), "{text}{notes}");

        // The body in a single line: no values beside those of the first word.
        if note.is_empty() {
            assert_eq!(read(Format::Off, text.replace('\n', " ")).mesh, *mesh, "{about}");
            assert_eq!(read(Format::Off, text.replace('\n', " ").replace(" 3 0", "\n3 0")).mesh, *mesh);
        }
    }
}

#[test]
fn off_headers_come_in_many_forms() {
    let body = format!("{ROWS}3 0 1 2\n3 0 2 3\n");
    let plain = read(Format::Off, format!("OFF\n4 2 0\n{body}"));
    assert_eq!(plain.mesh.positions(), SQUARE);
    for header in [
        "OFF4 2 0\n",
        "OFF 4 2 0\n",
        "OFF4 2\n",
        "off4 2 0\n",
        "OFF\n4 2\n",
        "OFF 4 2\n",
        "OFF\n4\n2\n5\n",
        "4 2 0\n",
        "4 2\n",
        "OFF # made by x\n\n# counts:\n  4 2 0 # vertices, faces, edges\n\n# vertices\n",
        "OFF#x\n4 2#y\n",
        "\u{feff}OFF\r\n4 2 0\r\n",
        "OFF 4 2 0 and more\n",
        "OFF\n4 2 0 ",
    ] {
        assert_eq!(read(Format::Off, format!("{header}{body}")), plain, "{header}");
    }
    let commented = format!("OFF 4 2 0\n{}", body.replace('\n', " # c\n\n# d\n"));
    assert_eq!(read(Format::Off, &commented), plain);
    assert_eq!(read(Format::Off, commented.replace('\n', "\r\n")), plain);
    assert_eq!(read(Format::Off, commented.replace('\n', "\r")), plain);
    // The fourth coordinate divides the others.
    let halved = read(Format::Off, "4OFF 3 1 0\n2 4 6 2\n0 0 0 1\n1 0 0 .5\n3 0 1 2\n").mesh;
    assert_eq!(halved.positions(), [[1.0, 2.0, 3.0], [0.0; 3], [2.0, 0.0, 0.0]]);
}

#[test]
fn off_colours_of_faces_become_those_of_their_corners() {
    let colors = |faces: &str| {
        let found = read(Format::Off, format!("OFF 4 2 0\n{ROWS}{faces}"));
        let colors = match found.mesh.attribute("color") {
            Some(_) => corners(&found.mesh, "color").into_iter().map(|(_, color)| color).collect(),
            None => Vec::new(),
        };
        (colors, found.notes)
    };
    let (red, white) = (vec![1.0, 0.0, 0.2], vec![1.0; 3]);
    let three = |color: &[f32]| vec![color.to_vec(); 3];
    let both = [three(&red), three(&red)].concat();
    assert_eq!(colors("3 0 1 2 255 0 51\n3 0 2 3 255 0 51\n"), (both.clone(), vec![]));
    assert_eq!(colors("3 0 1 2 1.0 0 .2\n3 0 2 3 1 0 .2\n").0, both);
    assert_eq!(colors("3 0 1 2 255 0 51 # red\n3 0 2 3\n").0, [three(&red), three(&white)].concat());
    let clear = three(&[1.0, 0.0, 0.2, 0.2]);
    assert_eq!(colors("4 0 1 2 3 255 0 51 51\n0\n").0, [clear.clone(), clear].concat());
    let notes = vec!["2 faces have an index into a colour map, left out, such as at face 0".to_owned()];
    assert_eq!(colors("3 0 1 2 7\n3 0 2 3 8\n"), (vec![], notes));
}

/// Every byte order, with and without colours of faces, with colours of three and four components.
#[test]
fn off_binary_is_read_in_every_form() {
    let values: [(&str, &[f32]); 5] = [
        ("OFF", &[]),
        ("NOFF", &[0.0, 0.0, 1.0]),
        ("STCOFF", &[0.25, 0.5, 1.0, 7.0, 8.0]),
        ("STCNOFF", &[0.0, 0.0, -1.0, 0.25, 0.5, 1.0, 1.0, 7.0, 8.0]),
        ("4OFF", &[1.0]),
    ];
    for (word, values) in values {
        for (big, face_colors, tail) in
            [(true, true, 0), (true, false, 0), (false, true, 0), (false, false, 0), (true, true, 3)]
        {
            let mut bytes = format!("{word} BINARY\n").into_bytes();
            let put = |word: u32, bytes: &mut Vec<u8>| {
                bytes.extend(if big { word.to_be_bytes() } else { word.to_le_bytes() });
            };
            [4, 2, 0].into_iter().for_each(|n| put(n, &mut bytes));
            for p in SQUARE {
                p.iter().chain(values).for_each(|x| put(x.to_bits(), &mut bytes));
            }
            for face in [[0, 1, 2], [0, 2, 3]] {
                [3].into_iter().chain(face).for_each(|n| put(n, &mut bytes));
                if face_colors {
                    [3, 1.0_f32.to_bits(), 0, 0].into_iter().for_each(|n| put(n, &mut bytes));
                }
            }
            bytes.extend(vec![7; tail]);
            let found = read(Format::Off, &bytes);
            let (mesh, about) = (&found.mesh, format!("{word} {big} {face_colors} {tail}"));
            assert_eq!(mesh.positions(), SQUARE, "{about}");
            assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]], "{about}");
            if word == "STCNOFF" {
                assert_eq!(floats(mesh, "normal"), [0.0, 0.0, -1.0].repeat(4), "{about}");
            }
            match word {
                "STCOFF" | "STCNOFF" => {
                    assert_eq!(floats(mesh, "color")[..3], [0.25, 0.5, 1.0], "{about}");
                    assert_eq!(floats(mesh, "uv"), [7.0, 8.0].repeat(4), "{about}");
                }
                _ if face_colors => assert_eq!(floats(mesh, "color"), [1.0, 0.0, 0.0].repeat(4), "{about}"),
                _ => assert!(mesh.attribute("color").is_none(), "{about}"),
            }
            assert_eq!(found.notes.iter().any(|n| n.contains("after the last face")), tail > 0, "{about}");
        }
    }
}

const STL: &str = "solid cube\n facet normal 0 0 1\n  outer loop\n   vertex 0.0 0.0 0.0\n   vertex 1.5e0 0.0 0.0\n   \
    vertex 0.0 -2.5 0.0\n  endloop\n endfacet\nendsolid cube\n";

#[test]
fn stl_text_comes_in_many_forms() {
    let plain = read(Format::Stl, STL);
    assert_eq!(plain.mesh.positions(), [[0.0; 3], [1.5, 0.0, 0.0], [0.0, -2.5, 0.0]]);
    for (from, to) in [
        ("endsolid cube\n", "end\n"),
        ("endsolid cube", "end solid cube"),
        ("endsolid cube\n", "endsolid"),
        ("endsolid cube\n", ""),
        ("endfacet", "end facet"),
        ("endfacet", "END FACET"),
        ("endloop", "end loop"),
        ("solid cube", "solid"),
        ("solid cube", "solid my endsolid thing"),
        ("solid cube", "solid facet plate - 300K"),
        ("solid cube", "solid vertex shader end"),
        ("solid cube\n", ""),
        ("0 0 1", "1.#QNAN 1.#QNAN -1.#IND"),
        ("0 0 1", "nan -nan(ind) inf"),
        ("normal 0 0 1", ""),
        ("\n", "\r\n"),
        ("\n", "\r"),
    ] {
        assert_eq!(read(Format::Stl, STL.replace(from, to)), plain, "{from:?} to {to:?}");
    }
    assert_eq!(read(Format::Stl, STL.to_uppercase()), plain);
    let long = "/".repeat(100_000);
    assert_eq!(read(Format::Stl, STL.replace("cube", &long)), plain);

    // Commas for points, and commas between numbers.
    for (from, to) in [(".", ","), ("0.0 -2.5 0.0", "0.0, -2.5, 0.0"), ("0.0 -2.5 0.0", "0,-2.5,0")] {
        let found = read(Format::Stl, STL.replace(from, to));
        assert_eq!(found.mesh, plain.mesh);
        assert!(found.notes[0].contains("decimal commas, or commas between numbers"), "{:?}", found.notes);
    }
}

#[test]
fn stl_binary_counts_may_be_unknown() {
    let mesh = Mesh::new(SQUARE, [[0, 1, 2], [0, 2, 3]]).unwrap();
    let bytes = io::write_bytes(Format::Stl, &mesh).unwrap();
    let with = |header: &[u8], count: u32, tail: usize| {
        let mut bytes = [&bytes[..], &vec![b' '; tail]].concat();
        bytes[..header.len()].copy_from_slice(header);
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        io::read_bytes_with(Format::Stl, &bytes, &ReadOptions::default())
    };
    for header in [&b"x"[..], b"solid", b"solid facet normal endsolid", b"facet"] {
        let found = with(header, 2, 0).unwrap();
        assert_eq!((found.mesh, found.notes.len()), (mesh.clone(), 0));
        let found = with(header, 2, 4).unwrap();
        assert_eq!(
            (found.mesh, &found.notes[0][..]),
            (mesh.clone(), "4 bytes after the last triangle left out")
        );
        for (count, tail) in [(0, 0), (u32::MAX, 0), (u32::MAX, 3)] {
            let found = with(header, count, tail).unwrap();
            assert_eq!(found.mesh, mesh, "{header:?} {count}");
            assert_eq!(
                found.notes[0],
                format!("the file declares {count} triangles; its size gives 2"),
                "{header:?}"
            );
        }
    }
    assert!(with(b"x", 3, 0).unwrap_err().to_string().contains("3 triangles are declared, 2 are there"));
    // No triangles.
    let empty = io::read_bytes_with(Format::Stl, &[0; 84], &ReadOptions::default()).unwrap();
    assert_eq!((empty.mesh.triangles().len(), empty.notes.len()), (0, 0));
}

#[test]
fn obj_colours_that_are_missing_are_white() {
    for (row, rest) in [("0 1 .5 .25", vec![1.0; 3]), ("0 1 .5 .25 .75", vec![1.0; 4])] {
        let text = format!("v 0 0 {row}\nv 1 0 0\nv 1 1 {row}\nv 0 1 0\nf 1 2 3 4\n");
        let mesh = read(Format::Obj, text).mesh;
        let color: Vec<f32> = row.split(' ').skip(1).map(|word| word.parse().unwrap()).collect();
        assert_eq!(floats(&mesh, "color"), [&color[..], &rest, &color, &rest].concat());
    }
}

#[test]
fn obj_indices_count_back_from_their_line() {
    let block = |x: usize| {
        format!(
            "v {x} 0 0\nv {x} 1 0\nv {x} 1 1\nvt 0 {x}\nvn {x} 0 1\nf -3/-1/-1 -2/-1/-1 -1/-1/-1\nl -1 -2\np -1\n"
        )
    };
    let found = read(Format::Obj, (0..3).map(block).collect::<String>());
    assert_eq!(found.mesh.triangles(), [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
    assert_eq!(floats(&found.mesh, "uv")[12..], [0.0, 2.0, 0.0, 2.0, 0.0, 2.0]);
    assert_eq!(floats(&found.mesh, "normal")[9..12], [1.0, 0.0, 1.0]);
    assert_eq!(found.notes, ["6 statements of points and lines left out, such as at line 7"]);
}

#[test]
fn obj_normals_that_are_missing_are_computed() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\nvn 0 1e-40 1\nf 1//1 2//1 3//1\nf 1 3 4\nf 1//9 4 3\n";
    let found = read(Format::Obj, text);
    let normals: Vec<f32> =
        corners(&found.mesh, "normal").into_iter().flat_map(|(_, normal)| normal).collect();
    assert_eq!(normals[..9], [0.0, 1e-40, 1.0].repeat(3));
    // Two triangles that turn their backs on each other have no common normal: the z axis.
    assert_eq!(normals[9..], [0.0, 0.0, 1.0].repeat(6));
    let found = read(Format::Obj, text.replace("f 1 3 4\n", ""));
    let normals: Vec<f32> =
        corners(&found.mesh, "normal").into_iter().flat_map(|(_, normal)| normal).collect();
    assert_eq!(normals[9..], [0.0, 0.0, -1.0].repeat(3));
    assert!(found.notes[0].starts_with("1 texture or normal indices name nothing"), "{:?}", found.notes);
    assert_eq!(found.notes[1], "4 vertices have no normal and get one of their triangles");
}

/// ```text
///    |\ /\ /\ /|
///    | v  v  v |      every second corner of the upper side is concave
///    +---------+
/// ```
#[test]
fn concave_polygons_are_read_in_every_format() {
    let teeth = 20;
    let mut corners = vec![[0.0, 0.0], [teeth as f32, 0.0]];
    corners.extend((0..=2 * teeth).rev().map(|i| [i as f32 * 0.5, if i % 2 == 0 { 3.0 } else { 1.0 }]));
    let rows =
        |prefix: &str| -> String { corners.iter().map(|[x, y]| format!("{prefix}{x} {y} 0\n")).collect() };
    let face = |from: usize| -> String { (from..from + corners.len()).map(|i| format!(" {i}")).collect() };
    let count = corners.len();
    let list = "property list uchar int vertex_indices\nend_header\n";
    for (format, text) in [
        (Format::Obj, format!("{}f{}\n", rows("v "), face(1))),
        (Format::Off, format!("OFF {count} 1 0\n{}{count}{}\n", rows(""), face(0))),
        (
            Format::Ply,
            format!(
                "ply\nformat ascii 1.0\nelement vertex {count}\n{XYZ}element face 1\n{list}{}{count}{}\n",
                rows(""),
                face(0)
            ),
        ),
    ] {
        let mesh = read(format, text).mesh;
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        assert_eq!(mesh.triangles().len(), count - 2);
        assert!(mesh.triangles().iter().all(|t| area(t) > 0.0), "{format}");
        assert_eq!(mesh.triangles().iter().map(area).sum::<f32>(), 2.0 * teeth as f32);
    }
}
