//! Wavefront OBJ: text, with separate indices for positions, texture coordinates and normals.
//!
//! Read: `v` (with optional `r g b [a]`), `vt`, `vn`, `f` with corners of any form, `usemtl` as material ids. In a file
//! with colours, positions without a colour are white. Points and lines are left out with a note. Other statements are
//! skipped; no .mtl file is opened. Distinct triples (v, vt, vn) become vertices, ordered by v and then
//! by first use. So a file with a single triple per position keeps its numbering. Positions used by no face are kept.
//! An out-of-range `vt` or `vn` index counts as not given and is noted; an out-of-range `v` index is an error. In a file
//! with `vt`, corners without an index get 0; in a file with `vn`, the normal of their triangles.
//!
//! Written: `v` with `color`, `vt` from `uv`, `vn` from `normal`, `usemtl`. Other attributes and locks are not written.
//! Material ids without a name are called `material_ID`, and are renumbered by appearance on reading.
//!
//! The parser is our own: `tobj` renumbers vertices in every group, drops unused vertices and invents texture indices
//! for corners without any (`docs/architecture.md`, Readers).

use std::collections::BTreeMap;

use glam::DVec3;

use super::corners::number_vertices;
use super::draft::{Draft, Tally};
use super::error::ReadError;
use super::polygon::Triangulator;
use super::text::{self, Lines, integer, number, push_float, push_position, quoted, words};
use crate::error::MeshError;
use crate::geometry::triangle;
use crate::mesh::{Attribute, AttributeValues, MAX_ELEMENTS, Mesh, NONE, names};

/// A corner: indices of v, vt and vn.
type Corner = [u32; 3];

/// Colour of positions without a colour, in a file that has colours.
const WHITE: [f32; 4] = [1.0; 4];

/// Content of the statements, before corners become vertices.
#[derive(Default)]
struct Statements {
    positions: Vec<[f64; 3]>,
    /// Four values a position, for positions up to the last coloured position; empty without colours. Positions without
    /// a colour are white.
    colors: Vec<[f32; 4]>,
    color_width: usize,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    /// Number of corners of each face.
    sizes: Vec<u32>,
    /// Material of each face; empty before the first `usemtl`.
    face_materials: Vec<u32>,
    material_names: Vec<String>,
    material_ids: BTreeMap<String, u32>,
    /// Largest index of each kind and its line: a face may precede the elements it names.
    largest: [(u32, usize); 3],
    small_faces: Tally,
    points_and_lines: Tally,
    bad_attributes: Tally,
}

/// Reads a whole file. O(n) in its size; O(n log n) if a position has very many triples.
pub(super) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let mut statements = parse(bytes)?;
    let count = statements.positions.len();
    if let Some(vertex) = statements.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        // Reported here, because splitting below may renumber. Positions too large for single precision are checked
        // later: moving the origin may help.
        let position = statements.positions[vertex].map(|x| x as f32);
        return Err(MeshError::NonFinitePosition { vertex, position }.into());
    }
    let (largest, line) = statements.largest[0];
    if largest as usize >= count && line > 0 {
        let given = u64::from(largest) + 1;
        return Err(ReadError::line(line, format!("a face names vertex {given}, but there are {count}")));
    }
    if count.max(statements.corners.len()) > MAX_ELEMENTS {
        return Err(ReadError::too_large(format!("{count} vertices, {} corners", statements.corners.len())));
    }
    for corner in &mut statements.corners {
        for (index, limit) in [(1, statements.uvs.len()), (2, statements.normals.len())] {
            if corner[index] != NONE && corner[index] as usize >= limit {
                corner[index] = NONE;
                statements.bad_attributes.add(statements.largest[index].1);
            }
        }
    }
    Ok(assemble(statements, bytes.len()))
}

fn parse(bytes: &[u8]) -> Result<Statements, ReadError> {
    let mut s = Statements::default();
    let mut material = NONE;
    let mut unknown = None;
    let mut joined = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((number, mut line)) = lines.next() {
        line = text::without_comment(line);
        if line.ends_with(b"\\") {
            joined.clear();
            while let Some(part) = line.strip_suffix(b"\\") {
                joined.extend_from_slice(part);
                joined.push(b' ');
                line = lines.next().map_or(&[], |(_, next)| text::without_comment(next));
            }
            joined.extend_from_slice(line);
            line = &joined;
        }
        let mut rest = words(line);
        let Some(keyword) = rest.next() else { continue };
        match keyword {
            b"v" => s.vertex(rest, number)?,
            b"vt" => {
                let [u, v] = floats(rest, 1, number, "vt")?;
                s.uvs.push([u as f32, v as f32]);
            }
            b"vn" => {
                let normal: [f64; 3] = floats(rest, 3, number, "vn")?;
                s.normals.push(normal.map(|x| x as f32));
            }
            b"f" | b"fo" => s.face(rest, number, material)?,
            b"usemtl" => material = s.material(name_after(line, keyword)),
            b"p" | b"l" => s.points_and_lines.add(number),
            b"vp" | b"mtllib" | b"o" | b"g" | b"s" => {}
            _ => unknown = unknown.or_else(|| Some((number, quoted(keyword)))),
        }
    }
    match unknown {
        Some((line, word)) if s.positions.is_empty() && s.sizes.is_empty() => {
            Err(ReadError::line(line, format!("{word} is no OBJ statement, and there are no vertices")))
        }
        _ => Ok(s),
    }
}

/// Returns the name in a statement: the rest of its line, including inner blanks.
fn name_after(line: &[u8], keyword: &[u8]) -> String {
    let line = line.trim_ascii();
    String::from_utf8_lossy(line.get(keyword.len()..).unwrap_or_default().trim_ascii()).into_owned()
}

/// Parses up to N numbers. The first `needed` are required, missing ones are 0, further words are ignored.
fn floats<'a, const N: usize>(
    mut rest: impl Iterator<Item = &'a [u8]>,
    needed: usize,
    line: usize,
    what: &str,
) -> Result<[f64; N], ReadError> {
    let mut values = [0.0; N];
    for (i, value) in values.iter_mut().enumerate() {
        match rest.next() {
            Some(word) => *value = real(word, line)?,
            None if i >= needed => break,
            None => {
                return Err(ReadError::line(
                    line,
                    format!("{what} has {i} numbers where {needed} are needed"),
                ));
            }
        }
    }
    Ok(values)
}

fn real(word: &[u8], line: usize) -> Result<f64, ReadError> {
    number(word).ok_or_else(|| ReadError::line(line, format!("{} is not a number", quoted(word))))
}

impl Statements {
    /// Parses `x y z [w]`, `x y z r g b` or `x y z r g b a`.
    fn vertex<'a>(&mut self, mut rest: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<(), ReadError> {
        let position = floats(&mut rest, 3, line, "v")?;
        let mut extra = [0.0; 4];
        let mut count = 0;
        for (value, word) in extra.iter_mut().zip(rest) {
            *value = real(word, line)? as f32;
            count += 1;
        }
        if count >= 3 {
            if count == 3 {
                extra[3] = 1.0;
            }
            self.color_width = self.color_width.max(count);
            self.colors.resize(self.positions.len(), WHITE);
            self.colors.push(extra);
        }
        self.positions.push(position);
        Ok(())
    }

    fn face<'a>(
        &mut self,
        rest: impl Iterator<Item = &'a [u8]>,
        line: usize,
        material: u32,
    ) -> Result<(), ReadError> {
        let start = self.corners.len();
        for word in rest {
            let mut parts = word.split(|&b| b == b'/');
            let mut corner = [NONE; 3];
            let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
            for (slot, index) in corner.iter_mut().enumerate() {
                let part = parts.next().unwrap_or_default();
                if part.is_empty() && slot > 0 {
                    continue;
                }
                let given = integer(part).ok_or_else(|| {
                    ReadError::line(
                        line,
                        format!("the face corner {} is not made of whole numbers", quoted(word)),
                    )
                })?;
                match resolve(given, counts[slot]) {
                    Some(found) => *index = found,
                    None if slot > 0 => self.bad_attributes.add(line),
                    None => {
                        let count = counts[0];
                        return Err(ReadError::line(
                            line,
                            format!("a face names vertex {given}, and there are {count} up to here"),
                        ));
                    }
                }
            }
            for (largest, &index) in self.largest.iter_mut().zip(&corner) {
                if index >= largest.0 && index != NONE {
                    *largest = (index, line);
                }
            }
            self.corners.push(corner);
        }
        let size = self.corners.len() - start;
        if size < 3 {
            self.corners.truncate(start);
            self.small_faces.add(line);
            return Ok(());
        }
        self.sizes.push(size as u32);
        if !self.material_names.is_empty() {
            // Faces before the first `usemtl` have an unnamed material.
            if self.face_materials.len() + 1 < self.sizes.len() {
                let unnamed = self.material(String::new());
                self.face_materials.resize(self.sizes.len() - 1, unnamed);
            }
            self.face_materials.push(material);
        }
        Ok(())
    }

    /// Returns the id of a name, in order of first appearance.
    fn material(&mut self, name: String) -> u32 {
        *self.material_ids.entry(name).or_insert_with_key(|name| {
            self.material_names.push(name.clone());
            self.material_names.len() as u32 - 1
        })
    }
}

/// Converts an OBJ index to an index from 0: positive indices count from 1, negative ones from the end of the current
/// list. `None` if it is invalid.
fn resolve(given: i64, count: usize) -> Option<u32> {
    let index = if given < 0 { given.checked_add(count as i64)? } else { given - 1 };
    u32::try_from(index).ok().filter(|&i| given != 0 && i != NONE)
}

/// Splits faces into triangles and corners into vertices.
fn assemble(s: Statements, file_size: usize) -> Draft {
    let mut draft = Draft::default();
    let mut triangulator = Triangulator::new(file_size);
    let mut corners = Vec::with_capacity(s.corners.len());
    let mut first = 0;
    let mut points = Vec::new();
    for (face, &size) in s.sizes.iter().enumerate() {
        let polygon = &s.corners[first..first + size as usize];
        first += size as usize;
        if let Some(&id) = s.face_materials.get(face) {
            draft.materials.extend(std::iter::repeat_n(id, polygon.len() - 2));
        }
        if polygon.len() == 3 {
            corners.extend_from_slice(polygon);
            continue;
        }
        points.clear();
        points.extend(polygon.iter().map(|c| s.positions[c[0] as usize]));
        triangulator.split(&points, |t| corners.extend(t.map(|i| polygon[i as usize])));
    }
    s.small_faces.note("faces with fewer than 3 corners left out", "line", &mut draft.notes);
    s.points_and_lines.note("statements of points and lines left out", "line", &mut draft.notes);
    s.bad_attributes.note(
        "texture or normal indices name nothing and count as not given",
        "line",
        &mut draft.notes,
    );
    triangulator.note(&mut draft.notes);
    draft.material_names = s.material_names;
    if corners.iter().all(|c| c[1] == NONE && c[2] == NONE) {
        draft.triangles = corners.chunks_exact(3).map(|c| [c[0][0], c[1][0], c[2][0]]).collect();
        draft.attributes.extend(color(&s.colors, s.color_width, 0..s.positions.len() as u32));
        draft.positions = s.positions;
        return draft;
    }

    let (vertices, numbers) = number_vertices(&corners, s.positions.len());
    draft.triangles = numbers.chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect();
    draft.positions = vertices.iter().map(|c| s.positions[c[0] as usize]).collect();
    draft.attributes.extend(stream(names::UV, &s.uvs, &corners, &vertices, 1, |_| [0.0; 2]));
    let computed = computed_normals(&corners, &vertices, &mut draft);
    let normal = |vertex: usize| computed.get(vertex).copied().unwrap_or_default();
    draft.attributes.extend(stream(names::NORMAL, &s.normals, &corners, &vertices, 2, normal));
    draft.attributes.extend(color(&s.colors, s.color_width, vertices.iter().map(|c| c[0])));
    draft
}

/// Returns normals for vertices without one: the mean of their triangles by area, or the z axis where there is no area.
/// Empty if all corners have normals or none has. Adds a note.
fn computed_normals(corners: &[Corner], vertices: &[Corner], draft: &mut Draft) -> Vec<[f32; 3]> {
    let lacks = |corner: &Corner| corner[2] == NONE;
    if corners.iter().all(lacks) || !corners.iter().any(lacks) {
        return Vec::new();
    }
    let mut normals = vec![DVec3::ZERO; vertices.len()];
    for triangle in &draft.triangles {
        let places = triangle.map(|v| DVec3::from_array(draft.positions[v as usize]));
        triangle.iter().for_each(|&v| normals[v as usize] += triangle::normal(&places));
    }
    let count = vertices.iter().filter(|vertex| lacks(vertex)).count();
    draft.notes.push(format!("{count} vertices have no normal and get one of their triangles"));
    normals.iter().map(|normal| normal.normalize_or(DVec3::Z).as_vec3().to_array()).collect()
}

/// Returns the attribute named by slot `slot` of the vertices' triples; `None` if no corner has an index there.
/// `missing` gives the value of a vertex without an index.
fn stream<const N: usize>(
    name: &str,
    values: &[[f32; N]],
    corners: &[Corner],
    vertices: &[Corner],
    slot: usize,
    missing: impl Fn(usize) -> [f32; N],
) -> Option<Attribute> {
    if corners.iter().all(|c| c[slot] == NONE) {
        return None;
    }
    // If values are numbered like positions, unused positions keep their values too.
    let positions = vertices.last().map_or(0, |last| last[0] as usize + 1);
    let alike = values.len() == positions && corners.iter().all(|c| c[slot] == c[0]);
    let value = |(vertex, c): (usize, &Corner)| {
        let index = if alike { c[0] } else { c[slot] };
        values.get(index as usize).copied().unwrap_or_else(|| missing(vertex))
    };
    let values: Vec<[f32; N]> = vertices.iter().enumerate().map(value).collect();
    Some(Attribute::floats(name, &values))
}

fn color(colors: &[[f32; 4]], width: usize, of: impl Iterator<Item = u32>) -> Option<Attribute> {
    if colors.is_empty() {
        return None;
    }
    let value = |v: u32| colors.get(v as usize).copied().unwrap_or(WHITE).into_iter().take(width);
    Some(Attribute::new(names::COLOR, width, AttributeValues::Float(of.flat_map(value).collect())))
}

/// Encodes a mesh; numbers read back to equal bits.
pub(super) fn write(mesh: &Mesh) -> Vec<u8> {
    let floats = |name, widths: &[usize]| {
        let attribute = mesh.attribute(name).filter(|a| widths.contains(&a.width()))?;
        Some((attribute.as_floats()?, attribute.width()))
    };
    let (color, uv, normal) =
        (floats(names::COLOR, &[3, 4]), floats(names::UV, &[2]), floats(names::NORMAL, &[3]));
    let mut out = Vec::with_capacity(40 * (mesh.positions().len() + mesh.triangles().len()));
    let line = |keyword: &str, values: &[f32], out: &mut Vec<u8>| {
        out.extend_from_slice(keyword.as_bytes());
        for &x in values {
            out.push(b' ');
            push_float(x, out);
        }
        out.push(b'\n');
    };
    for (v, position) in mesh.positions().iter().enumerate() {
        out.extend_from_slice(b"v ");
        push_position(*position, mesh.origin(), &mut out);
        line("", color.map_or(&[], |(c, width)| &c[v * width..(v + 1) * width]), &mut out);
    }
    for (keyword, values) in [("vt", uv), ("vn", normal)] {
        if let Some((values, width)) = values {
            values.chunks_exact(width).for_each(|value| line(keyword, value, &mut out));
        }
    }
    // Names first, in order: reading restores the ids.
    if !mesh.materials().is_empty() {
        for id in 0..mesh.material_names().len() {
            out.extend_from_slice(format!("usemtl {}\n", material_name(mesh, id as u32)).as_bytes());
        }
    }
    let mut current = None;
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let material = mesh.materials().get(t).copied();
        if material != current {
            current = material;
            let name = material.map(|id| material_name(mesh, id)).unwrap_or_default();
            out.extend_from_slice(format!("usemtl {name}\n").as_bytes());
        }
        out.push(b'f');
        for v in triangle.map(|v| v + 1) {
            let corner = match (uv.is_some(), normal.is_some()) {
                (false, false) => format!(" {v}"),
                (true, false) => format!(" {v}/{v}"),
                (false, true) => format!(" {v}//{v}"),
                (true, true) => format!(" {v}/{v}/{v}"),
            };
            out.extend_from_slice(corner.as_bytes());
        }
        out.push(b'\n');
    }
    out
}

/// Returns a material name safe for a line; `material_ID` without a name.
fn material_name(mesh: &Mesh, id: u32) -> String {
    match mesh.material_names().get(id as usize) {
        Some(name) => name.replace(['\n', '\r', '\\'], " "),
        None => format!("material_{id}"),
    }
}
