//! The elements of a PLY file to a mesh: `vertex`, `face` and `tristrips` in any order; other elements are skipped.
//!
//! Checks every declared count against the bytes left before reserving memory for it.

use super::header::{Element, Encoding, Header, Kind, Property};
use crate::io::draft::{Draft, Tally};
use crate::io::error::{Place, ReadError};
use crate::io::polygon::Polygons;
use crate::io::text::{Words, number, quoted};
use crate::mesh::{Attribute, AttributeValues, NONE, names};

/// Most properties of an element, against hostile files: names are compared pairwise.
const MAX_PROPERTIES: usize = 1024;

pub(super) fn read(header: &Header, bytes: &[u8]) -> Result<Draft, ReadError> {
    for (i, element) in header.elements.iter().enumerate() {
        if element.properties.len() > MAX_PROPERTIES {
            let what =
                format!("{} properties in element {i}, more than {MAX_PROPERTIES}", element.properties.len());
            return Err(ReadError::unsupported(what));
        }
    }
    let mut draft = Draft { material_names: header.material_names.clone(), ..Draft::default() };
    let mut source = Source::new(header, bytes);
    let mut faces = Faces::new(bytes.len());
    // Faces before the vertices wait until the vertices are known.
    let mut waiting = Vec::new();
    let mut vertices_known = false;
    for element in &header.elements {
        source.check(element)?;
        let is_face = matches!(element.name.as_str(), "face" | "tristrips");
        if element.name == "vertex" {
            if std::mem::replace(&mut vertices_known, true) {
                return Err(ReadError::line(1, "the header has two vertex elements"));
            }
            read_vertices(element, &mut source, &mut draft)?;
        } else if is_face && vertices_known {
            faces.read(element, &mut source, &mut draft)?;
        } else {
            if is_face {
                waiting.push((element, source.clone()));
            }
            source.skip(element)?;
        }
    }
    for (element, mut start) in waiting {
        faces.read(element, &mut start, &mut draft)?;
    }
    faces.polygons.note(&mut draft.notes);
    faces.no_material.note(
        "faces with a negative material index count as material 0",
        "face",
        &mut draft.notes,
    );
    Ok(draft)
}

/// Converts an integer to a share of its type's largest value.
pub(super) fn unit(value: f64, maximum: f64) -> f32 {
    (value / maximum) as f32
}

/// Values of the body in order, in any encoding.
#[derive(Clone)]
struct Source<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    at: usize,
    words: Words<'a>,
}

impl<'a> Source<'a> {
    fn new(header: &Header, bytes: &'a [u8]) -> Self {
        let words = Words::new(&bytes[header.body..], header.body_line);
        Self { encoding: header.encoding, bytes, at: header.body, words }
    }

    fn left(&self) -> usize {
        match self.encoding {
            Encoding::Text => self.words.left(),
            _ => self.bytes.len() - self.at,
        }
    }

    /// Checks that the bytes left can hold the declared number of entries.
    fn check(&self, element: &Element) -> Result<(), ReadError> {
        let (least, left) = (element.least_size(self.encoding), self.left());
        // The last word of a text needs no blank after it.
        match element.count.checked_mul(least) {
            Some(needed) if needed <= left as u64 + u64::from(self.encoding == Encoding::Text) => Ok(()),
            _ => {
                let Element { name, count, .. } = element;
                let what =
                    format!("{count} entries of element {name:?} take {least} bytes each, {left} are left");
                Err(ReadError::truncated(what))
            }
        }
    }

    /// Reads `size` bytes of a binary file.
    fn take(&mut self, size: usize) -> Result<&'a [u8], ReadError> {
        let left = &self.bytes[self.at..];
        if size > left.len() {
            return Err(ReadError::truncated(format!(
                "{size} bytes are needed at byte {}, {} are left",
                self.at,
                left.len()
            )));
        }
        self.at += size;
        Ok(&left[..size])
    }

    fn value(&mut self, kind: Kind) -> Result<f64, ReadError> {
        if self.encoding != Encoding::Text {
            return Ok(kind.value(self.take(kind.size())?, self.encoding));
        }
        match self.words.next() {
            None => Err(ReadError::truncated(format!("a value is missing after line {}", self.words.line()))),
            Some(word) => number(word).ok_or_else(|| self.fail(format!("{} is not a number", quoted(word)))),
        }
    }

    /// Reads the length of a list. Checks it against the bytes left, at least 1 byte an entry.
    fn list(&mut self, count: Kind, kind: Kind) -> Result<usize, ReadError> {
        let count = self.value(count)?;
        let least = if self.encoding == Encoding::Text { 1 } else { kind.size() };
        if !(count >= 0.0 && count.fract() == 0.0) {
            return Err(self.fail(format!("{count} is no length of a list")));
        }
        if count * least as f64 > self.left() as f64 {
            let (place, left) = (self.place(), self.left());
            return Err(ReadError::truncated(format!(
                "a list of {count} values at {place}, {left} bytes are left"
            )));
        }
        Ok(count as usize)
    }

    fn skip_property(&mut self, property: &Property) -> Result<(), ReadError> {
        let count = match property.count {
            Some(count) => self.list(count, property.kind)?,
            None => 1,
        };
        if self.encoding == Encoding::Text {
            (0..count).try_for_each(|_| self.value(property.kind).map(|_| ()))
        } else {
            self.take(count * property.kind.size()).map(|_| ())
        }
    }

    fn skip(&mut self, element: &Element) -> Result<(), ReadError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        if self.encoding != Encoding::Text && element.is_flat() {
            let size = (element.count * element.least_size(self.encoding)) as usize;
            return self.take(size).map(|_| ());
        }
        for _ in 0..element.count {
            element.properties.iter().try_for_each(|p| self.skip_property(p))?;
        }
        Ok(())
    }

    fn place(&self) -> Place {
        match self.encoding {
            Encoding::Text => Place::Line(self.words.line()),
            _ => Place::Byte(self.at),
        }
    }

    fn fail(&self, what: impl Into<String>) -> ReadError {
        ReadError::Syntax { place: self.place(), what: what.into() }
    }
}

/// Destination of the values of a vertex property.
#[derive(Clone, Copy)]
enum Target {
    Nowhere,
    Position(usize),
    /// Index of the attribute, component, and divisor of integers (their type's largest value).
    Attribute(usize, usize, Option<f64>),
}

/// An attribute and its properties.
struct Group {
    name: String,
    properties: Vec<usize>,
    /// Integers are divided by their type's largest value.
    is_unit: bool,
    kind: Kind,
}

/// Groups the properties of an element to attributes.
fn groups(element: &Element) -> Vec<Group> {
    let properties = &element.properties;
    let mut free: Vec<bool> = properties.iter().map(|p| p.count.is_none() && !is_axis(&p.name)).collect();
    let find =
        |name: &str, free: &[bool]| properties.iter().zip(free).position(|(p, &free)| free && p.name == name);
    let mut groups: Vec<Group> = Vec::new();
    let known: [(&str, &[&str]); 7] = [
        (names::NORMAL, &["nx", "ny", "nz"]),
        (names::UV, &["s", "t"]),
        (names::UV, &["u", "v"]),
        (names::UV, &["texture_u", "texture_v"]),
        (names::UV, &["texture_s", "texture_t"]),
        (names::COLOR, &["red", "green", "blue", "alpha"]),
        (names::COLOR, &["red", "green", "blue"]),
    ];
    for (name, parts) in known {
        let found: Option<Vec<usize>> = parts.iter().map(|part| find(part, &free)).collect();
        let Some(found) = found.filter(|_| groups.iter().all(|g| g.name != name)) else { continue };
        found.iter().for_each(|&i| free[i] = false);
        let is_unit = name == names::COLOR;
        groups.push(Group { name: name.to_owned(), properties: found, is_unit, kind: Kind::F32 });
    }
    for first in 0..properties.len() {
        if !free[first] {
            continue;
        }
        let Property { name, kind, .. } = &properties[first];
        let mut found = vec![first];
        let mut group_name = name.as_str();
        if let Some(base) = name.strip_suffix("_0") {
            let alike = |&i: &usize| {
                let other = properties[i].kind;
                other.is_float() == kind.is_float() && other.is_signed() == kind.is_signed()
            };
            let part = |component: usize| find(&format!("{base}_{component}"), &free).filter(alike);
            found.extend((1..16).map_while(part));
            if found.len() > 1 {
                group_name = base;
            }
        }
        found.iter().for_each(|&i| free[i] = false);
        groups.push(Group { name: group_name.to_owned(), properties: found, is_unit: false, kind: *kind });
    }
    groups.sort_by_key(|group| group.properties[0]);
    groups
}

fn is_axis(name: &str) -> bool {
    matches!(name, "x" | "y" | "z")
}

/// Values of an attribute being read.
enum Store {
    Float(Vec<f32>),
    Int(Vec<i32>),
    Uint(Vec<u32>),
}

fn read_vertices(element: &Element, source: &mut Source, draft: &mut Draft) -> Result<(), ReadError> {
    // `check` compared the count with the bytes left, so it fits memory.
    let count = element.count as usize;
    let mut targets = vec![Target::Nowhere; element.properties.len()];
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let found = element.properties.iter().position(|p| p.name == *name && p.count.is_none());
        let found =
            found.ok_or_else(|| ReadError::line(1, format!("the vertex element has no property {name}")))?;
        targets[found] = Target::Position(axis);
    }
    let groups = groups(element);
    let mut stores = Vec::with_capacity(groups.len());
    for (g, group) in groups.iter().enumerate() {
        let width = group.properties.len();
        for (component, &property) in group.properties.iter().enumerate() {
            let one = element.properties[property].kind.maximum().filter(|_| group.is_unit);
            targets[property] = Target::Attribute(g, component, one);
        }
        stores.push(match (group.kind.is_float(), group.kind.is_signed()) {
            (true, _) => Store::Float(vec![0.0; count * width]),
            (_, true) => Store::Int(vec![0; count * width]),
            _ => Store::Uint(vec![0; count * width]),
        });
    }

    draft.positions = vec![[0.0; 3]; count];
    let mut put = |vertex: usize, target: Target, value: f64| match target {
        Target::Nowhere => {}
        Target::Position(axis) => draft.positions[vertex][axis] = value,
        Target::Attribute(group, component, one) => {
            let at = vertex * groups[group].properties.len() + component;
            match &mut stores[group] {
                Store::Float(values) => values[at] = one.map_or(value as f32, |one| unit(value, one)),
                Store::Int(values) => values[at] = value as i32,
                Store::Uint(values) => values[at] = value as u32,
            }
        }
    };
    if source.encoding != Encoding::Text && element.is_flat() {
        let mut offset = 0;
        let mut fields = Vec::with_capacity(targets.len());
        for (property, &target) in element.properties.iter().zip(&targets) {
            fields.push((offset, property.kind, target));
            offset += property.kind.size();
        }
        let encoding = source.encoding;
        for (vertex, entry) in source.take(count * offset)?.chunks_exact(offset).enumerate() {
            for &(offset, kind, target) in &fields {
                put(vertex, target, kind.value(&entry[offset..], encoding));
            }
        }
    } else {
        for vertex in 0..count {
            for (property, &target) in element.properties.iter().zip(&targets) {
                if property.count.is_some() {
                    source.skip_property(property)?;
                } else {
                    put(vertex, target, source.value(property.kind)?);
                }
            }
        }
    }
    for (group, store) in groups.into_iter().zip(stores) {
        let values = match store {
            Store::Float(values) => AttributeValues::Float(values),
            Store::Int(values) => AttributeValues::Int(values),
            Store::Uint(values) => AttributeValues::Uint(values),
        };
        draft.attributes.push(Attribute::new(group.name, group.properties.len(), values));
    }
    Ok(())
}

/// Reads faces and strips.
struct Faces {
    polygons: Polygons,
    no_material: Tally,
}

impl Faces {
    fn new(file_size: usize) -> Self {
        Self { polygons: Polygons::new(file_size), no_material: Tally::default() }
    }

    fn read(&mut self, element: &Element, source: &mut Source, draft: &mut Draft) -> Result<(), ReadError> {
        let is_list = |p: &Property| {
            p.count.is_some()
                && !p.kind.is_float()
                && matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
        };
        let is_material = |p: &Property| {
            p.count.is_none() && matches!(p.name.as_str(), "material_index" | "material" | "material_id")
        };
        let Some(list) = element.properties.iter().position(is_list) else {
            draft
                .notes
                .push(format!("element {:?} has no list of vertex indices and is left out", element.name));
            return source.skip(element);
        };
        let material = element.properties.iter().position(is_material);
        let strips = element.name == "tristrips";
        if !strips && source.encoding != Encoding::Text {
            // A list takes at least 1 byte. Most files have triangles: this is their number.
            let per_face =
                element.least_size(source.encoding) as usize + 3 * element.properties[list].kind.size();
            draft.triangles.reserve((element.count as usize).min(source.left() / per_face + 1));
        }
        for face in 0..element.count as usize {
            let mut id = None;
            self.polygons.corners.clear();
            for (p, property) in element.properties.iter().enumerate() {
                match property.count {
                    Some(count) if p == list => {
                        self.read_corners(face, count, property.kind, source, draft, strips)?
                    }
                    None if Some(p) == material => id = Some(source.value(property.kind)?),
                    _ => source.skip_property(property)?,
                }
            }
            let before = draft.triangles.len();
            if strips {
                unroll(&self.polygons.corners, &mut draft.triangles);
            } else {
                self.polygons.add(face, draft);
            }
            if let Some(id) = id {
                if id < 0.0 {
                    self.no_material.add(face);
                } else if !(id <= f64::from(u32::MAX) && id.fract() == 0.0) {
                    return Err(source.fail(format!("face {face} has the material index {id}")));
                }
                let id = id as u32;
                draft.materials.resize(before, 0);
                draft.materials.resize(draft.triangles.len(), id);
            } else if !draft.materials.is_empty() {
                draft.materials.resize(draft.triangles.len(), 0);
            }
        }
        Ok(())
    }

    /// Reads the corners of a face. In a strip, -1 starts a new strip and is kept as `NONE`.
    fn read_corners(
        &mut self,
        face: usize,
        count: Kind,
        kind: Kind,
        source: &mut Source,
        draft: &Draft,
        strips: bool,
    ) -> Result<(), ReadError> {
        let vertices = draft.positions.len();
        for _ in 0..source.list(count, kind)? {
            let given = source.value(kind)?;
            let corner = if strips && given == -1.0 {
                NONE
            } else if given >= 0.0 && given < vertices as f64 && given.fract() == 0.0 {
                given as u32
            } else {
                return Err(source
                    .fail(format!("face {face} names vertex {given}, but there are {vertices} vertices")));
            };
            self.polygons.corners.push(corner);
        }
        Ok(())
    }
}

/// Converts strips to triangles: flips every second triangle. Skips triangles with equal corners, used only to move a
/// strip.
fn unroll(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    for strip in corners.split(|&c| c == NONE) {
        for (i, corners) in strip.windows(3).enumerate() {
            let [a, b, c] = [corners[i % 2], corners[1 - i % 2], corners[2]];
            if a != b && b != c && c != a {
                triangles.push([a, b, c]);
            }
        }
    }
}
