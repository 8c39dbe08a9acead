//! Faces and strips to triangles, with their values by corner and by face.

use super::body::unit;
use super::header::{Element, Encoding, Kind, Property};
use super::source::Source;
use crate::io::corners::CornerValues;
use crate::io::draft::{Draft, Tally};
use crate::io::error::ReadError;
use crate::io::polygon::Polygons;
use crate::mesh::NONE;

/// Meaning of a face's property.
#[derive(Clone, Copy)]
enum Role {
    /// Is skipped.
    None,
    /// List of vertex indices; type of its count.
    Corners(Kind),
    Material,
    /// List of two values a corner; type of its count.
    Uv(Kind),
    /// Component, and divisor of integers (their type's largest value).
    Color(usize, Option<f64>),
}

/// Returns the roles of an element's properties; `None` without a list of vertex indices.
fn roles(element: &Element) -> Option<Vec<Role>> {
    let properties = &element.properties;
    let find_value = |name: &str| properties.iter().position(|p| p.count.is_none() && p.name == name);
    let find_list = |allowed: &dyn Fn(&Property) -> bool| {
        let index = properties.iter().position(|p| p.count.is_some() && allowed(p))?;
        Some((index, properties[index].count?))
    };
    let is_corners =
        |p: &Property| !p.kind.is_float() && matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
    let is_uv = |p: &Property| matches!(p.name.as_str(), "texcoord" | "texcoords");
    let is_material = |p: &Property| {
        p.count.is_none() && matches!(p.name.as_str(), "material_index" | "material" | "material_id")
    };

    let mut roles = vec![Role::None; properties.len()];
    let (corners, count) = find_list(&is_corners)?;
    roles[corners] = Role::Corners(count);
    if let Some(material) = properties.iter().position(is_material) {
        roles[material] = Role::Material;
    }
    if element.name == "tristrips" {
        return Some(roles);
    }
    if let Some((uv, count)) = find_list(&is_uv) {
        roles[uv] = Role::Uv(count);
    }
    let colors = [
        ["red", "green", "blue", "alpha"],
        ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ];
    let found = |names: &[&str; 4]| names.map(find_value);
    if let Some(found) = colors.iter().map(found).find(|found| found[..3].iter().all(Option::is_some)) {
        for (component, property) in found.into_iter().enumerate() {
            if let Some(property) = property {
                roles[property] = Role::Color(component, properties[property].kind.maximum());
            }
        }
    }
    Some(roles)
}

/// Reads faces and strips.
pub(super) struct Faces {
    polygons: Polygons,
    values: CornerValues,
    /// UV of the current face, two values a corner.
    uvs: Vec<f32>,
    no_material: Tally,
    no_uv: Tally,
}

impl Faces {
    pub fn new(file_size: usize) -> Self {
        Self {
            polygons: Polygons::new(file_size),
            values: CornerValues::default(),
            uvs: Vec::new(),
            no_material: Tally::default(),
            no_uv: Tally::default(),
        }
    }

    pub fn read(
        &mut self,
        element: &Element,
        source: &mut Source,
        draft: &mut Draft,
    ) -> Result<(), ReadError> {
        let Some(roles) = roles(element) else {
            draft
                .notes
                .push(format!("element {:?} has no list of vertex indices and is left out", element.name));
            return source.skip(element);
        };
        if element.properties.iter().any(|p| p.name == "texnumber") {
            draft.notes.push("texture numbers of faces (texnumber) left out".to_owned());
        }
        let strips = element.name == "tristrips";
        if !strips && source.encoding != Encoding::Text {
            reserve(element, &roles, source, draft);
        }
        let has_uv = roles.iter().any(|role| matches!(role, Role::Uv(_)));
        for face in 0..element.count as usize {
            let mut id = None;
            let (mut color, mut color_width) = ([1.0; 4], 0);
            self.polygons.corners.clear();
            for (property, &role) in element.properties.iter().zip(&roles) {
                match role {
                    Role::None => source.skip_property(property)?,
                    Role::Corners(count) => {
                        self.read_corners(face, count, property.kind, source, draft, strips)?
                    }
                    Role::Material => id = Some(source.value(property.kind)?),
                    Role::Uv(count) => {
                        self.uvs.clear();
                        for _ in 0..source.list(count, property.kind)? {
                            self.uvs.push(source.value(property.kind)? as f32);
                        }
                    }
                    Role::Color(component, one) => {
                        let value = source.value(property.kind)?;
                        color[component] = one.map_or(value as f32, |one| unit(value, one));
                        color_width = color_width.max(component + 1);
                    }
                }
            }
            source.end_entry();
            let before = draft.triangles.len();
            if strips {
                unroll(&self.polygons.corners, &mut draft.triangles);
            } else if has_uv {
                self.add_with_uv(face, draft);
            } else {
                self.polygons.add(face, draft);
            }
            if color_width > 0 {
                self.values.set_color(before, draft.triangles.len(), &color[..color_width]);
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

    /// Adds the current face with its UV by corner.
    fn add_with_uv(&mut self, face: usize, draft: &mut Draft) {
        if self.uvs.len() != 2 * self.polygons.corners.len() {
            self.no_uv.add(face);
            return self.polygons.add(face, draft);
        }
        let (uvs, values) = (&self.uvs, &mut self.values);
        let mut triangle = draft.triangles.len();
        self.polygons.add_each(face, draft, |corners| {
            values.set_uvs(triangle, corners.map(|c| [uvs[2 * c as usize], uvs[2 * c as usize + 1]]));
            triangle += 1;
        });
    }

    /// Reads the corners of a face. In a strip, -1 starts a new strip and is kept as `NONE`. Errors in a binary file
    /// name the end of the list.
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
        let corner = |given: f64| {
            if strips && given == -1.0 {
                return Ok(NONE);
            }
            let exists = given >= 0.0 && given < vertices as f64 && given.fract() == 0.0;
            let what = || format!("face {face} names vertex {given}, but there are {vertices} vertices");
            if exists { Ok(given as u32) } else { Err(what()) }
        };
        let length = source.list(count, kind)?;
        if source.encoding == Encoding::Text {
            for _ in 0..length {
                let found = corner(source.value(kind)?);
                self.polygons.corners.push(found.map_err(|what| source.fail(what))?);
            }
            return Ok(());
        }
        let (encoding, size) = (source.encoding, kind.size());
        for value in source.take(length * size)?.chunks_exact(size) {
            let found = corner(kind.value(value, encoding));
            self.polygons.corners.push(found.map_err(|what| source.fail(what))?);
        }
        Ok(())
    }

    /// Adds the values by corner and by face to the draft, and notes.
    pub fn finish(self, draft: &mut Draft) -> Result<(), ReadError> {
        self.polygons.note(&mut draft.notes);
        let what = "faces with a negative material index count as material 0";
        self.no_material.note(what, "face", &mut draft.notes);
        let what = "faces without two texture coordinates a corner: theirs count as 0";
        self.no_uv.note(what, "face", &mut draft.notes);
        self.values.apply(draft)
    }
}

/// Reserves memory for the triangles of a binary file. Most files have triangles: their number is the number of faces,
/// if the bytes left could hold so many. A list takes at least the bytes of its count.
fn reserve(element: &Element, roles: &[Role], source: &Source, draft: &mut Draft) {
    let is_corners = |(_, role): &(&Property, &Role)| matches!(role, Role::Corners(_));
    let index = element.properties.iter().zip(roles).find(is_corners).map_or(1, |(p, _)| p.kind.size());
    let per_face = element.least_size(source.encoding) as usize + 3 * index;
    draft.triangles.reserve((element.count as usize).min(source.left() / per_face + 1));
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
