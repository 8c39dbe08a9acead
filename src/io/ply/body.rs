//! The elements of a PLY file to a mesh: `vertex`, `face` and `tristrips` in any order; other elements are skipped.
//!
//! Checks every declared count against the bytes left before reserving memory for it.

use super::faces::Faces;
use super::header::{Element, Encoding, Header, Kind, Property};
use super::source::{Rows, Source};
use crate::io::draft::Draft;
use crate::io::error::ReadError;
use crate::mesh::{Attribute, AttributeValues, names};

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
    let rows = Rows::new(header, bytes);
    let mut source = Source::new(header, bytes, &rows);
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
    source.note(&mut draft.notes);
    faces.finish(&mut draft)?;
    Ok(draft)
}

/// Converts an integer to a share of its type's largest value.
pub(super) fn unit(value: f64, maximum: f64) -> f32 {
    (value / maximum) as f32
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
    let known: [(&str, &[&str]); 9] = [
        (names::NORMAL, &["nx", "ny", "nz"]),
        (names::UV, &["s", "t"]),
        (names::UV, &["u", "v"]),
        (names::UV, &["texture_u", "texture_v"]),
        (names::UV, &["texture_s", "texture_t"]),
        (names::COLOR, &["red", "green", "blue", "alpha"]),
        (names::COLOR, &["red", "green", "blue"]),
        (names::COLOR, &["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"]),
        (names::COLOR, &["diffuse_red", "diffuse_green", "diffuse_blue"]),
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
            source.end_entry();
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
