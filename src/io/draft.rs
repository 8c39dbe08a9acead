//! What every reader fills: a mesh in double precision, before the origin is moved and positions are rounded.
//!
//! Coordinates stay `f64` until [`Draft::finish`], so that a mesh far from the origin can be moved there before single
//! precision takes its digits. Indices are not trusted: [`Mesh::new`] checks them.

use super::{Imported, ReadError, ReadOptions, SceneOrigin};
use crate::mesh::{Attribute, AttributeValues, Mesh, Topology};

/// A mesh being read.
#[derive(Default)]
pub(super) struct Draft {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub attributes: Vec<Attribute>,
    /// One per triangle, or empty.
    pub materials: Vec<u32>,
    pub material_names: Vec<String>,
    pub notes: Vec<String>,
    /// The vertices are a triangle soup: those at equal positions become one.
    pub weld: bool,
}

impl Draft {
    /// Moves the origin, rounds, welds where asked, and validates.
    pub fn finish(mut self, options: &ReadOptions) -> Result<Imported, ReadError> {
        let origin = match options.origin {
            SceneOrigin::Keep => [0.0; 3],
            SceneOrigin::At(origin) => origin,
            SceneOrigin::Center => self.center(),
        };
        let round = |p: &[f64; 3]| [0, 1, 2].map(|axis| (p[axis] - origin[axis]) as f32);
        let positions: Vec<[f32; 3]> = self.positions.iter().map(round).collect();
        self.positions = Vec::new();
        let mut mesh = Mesh::new(positions, self.triangles)?;
        if self.weld {
            mesh = weld(&mesh)?;
        }
        for attribute in &self.attributes {
            note_non_finite(attribute, &mut self.notes);
        }
        for attribute in self.attributes {
            mesh = mesh.with_attribute(attribute)?;
        }
        let mesh = mesh.with_materials(self.materials)?.with_material_names(self.material_names);
        Ok(Imported { mesh, origin, notes: self.notes })
    }

    /// Middle of the box around all finite vertices that a triangle uses.
    fn center(&self) -> [f64; 3] {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let used = self.triangles.as_flattened().iter().filter_map(|&v| self.positions.get(v as usize));
        for p in used.filter(|p| p.iter().all(|x| x.is_finite())) {
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
        }
        [0, 1, 2].map(|axis| if low[axis] <= high[axis] { low[axis] * 0.5 + high[axis] * 0.5 } else { 0.0 })
    }
}

/// One vertex per point, in order of first appearance.
fn weld(soup: &Mesh) -> Result<Mesh, ReadError> {
    let topology = Topology::new(soup);
    let at = |&v: &u32| soup.positions()[v as usize];
    let positions: Vec<[f32; 3]> = topology.vertex_of_point().iter().map(at).collect();
    let triangles: Vec<[u32; 3]> =
        soup.triangles().iter().map(|t| t.map(|v| topology.point_of()[v as usize])).collect();
    Ok(Mesh::new(positions, triangles)?)
}

/// Attribute values are carried as the file has them, NaN too; the caller should know.
fn note_non_finite(attribute: &Attribute, notes: &mut Vec<String>) {
    let AttributeValues::Float(values) = attribute.values() else { return };
    let mut bad = values.iter().enumerate().filter(|(_, x)| !x.is_finite());
    if let Some((first, _)) = bad.next() {
        let (name, vertex) = (attribute.name(), first / attribute.width().max(1));
        notes.push(format!(
            "attribute {name:?} has {} non-finite values, first at vertex {vertex}",
            1 + bad.count()
        ));
    }
}

/// Counts something worth telling, and remembers where the first that was added is.
#[derive(Default)]
pub(super) struct Tally {
    count: usize,
    first: usize,
}

impl Tally {
    pub fn add(&mut self, place: usize) {
        if self.count == 0 {
            self.first = place;
        }
        self.count += 1;
    }

    /// Puts "`count` `what`, such as at `place` N" among the notes, if there was any.
    pub fn note(&self, what: &str, place: &str, notes: &mut Vec<String>) {
        if self.count > 0 {
            notes.push(format!("{} {what}, such as at {place} {}", self.count, self.first));
        }
    }
}
