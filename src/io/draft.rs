//! The output of every reader: a mesh in double precision, before the origin is moved and positions are rounded.
//!
//! Coordinates stay `f64` until [`Draft::finish`]: the origin of a distant mesh can be moved before rounding to single
//! precision loses digits. Indices are not trusted: [`Mesh::new`] checks them.

use super::{Imported, ReadError, ReadOptions, SceneOrigin};
use crate::geometry::boxes;
use crate::mesh::{Attribute, AttributeValues, Mesh, Topology};

/// Largest rounding of positions to single precision, as a share of the diagonal, for which the origin stays.
const MOST_LOST: f64 = 1e-6;

/// A mesh being read.
#[derive(Default)]
pub(super) struct Draft {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub attributes: Vec<Attribute>,
    /// Material id of each triangle, or empty.
    pub materials: Vec<u32>,
    pub material_names: Vec<String>,
    pub notes: Vec<String>,
    /// The vertices are a triangle soup: vertices at equal positions are welded.
    pub weld: bool,
}

impl Draft {
    /// Moves the origin, rounds, welds if requested, and validates.
    pub fn finish(mut self, options: &ReadOptions) -> Result<Imported, ReadError> {
        let origin = match options.origin {
            SceneOrigin::Keep => [0.0; 3],
            SceneOrigin::At(origin) => origin,
            SceneOrigin::Center => self.center(),
            SceneOrigin::Automatic => self.own_origin(),
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
        let mesh = mesh.with_origin(origin)?;
        Ok(Imported { mesh, origin, notes: self.notes })
    }

    /// Returns the finite vertices used by triangles, once for each corner.
    fn used(&self) -> impl Iterator<Item = &[f64; 3]> {
        let used = self.triangles.as_flattened().iter().filter_map(|&v| self.positions.get(v as usize));
        used.filter(|p| p.iter().all(|x| x.is_finite()))
    }

    /// Returns the smallest and largest corner of the box around all used vertices; `None` without used vertices.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        boxes::around_any(self.used().copied())
    }

    /// Returns the middle of the box around all used vertices.
    fn center(&self) -> [f64; 3] {
        self.bounds().map_or([0.0; 3], |[low, high]| [0, 1, 2].map(|i| low[i] * 0.5 + high[i] * 0.5))
    }

    /// Returns zero, unless single precision would round positions by more than [`MOST_LOST`] of the diagonal. Then
    /// returns the middle of the box, rounded to a multiple of a power of two about as large as the box. The rounding
    /// makes sums with positions exact, and gives most levels of a mesh the mesh's own origin. Adds a note about the
    /// move.
    fn own_origin(&mut self) -> [f64; 3] {
        let Some([low, high]) = self.bounds() else { return [0.0; 3] };
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let diagonal = length([0, 1, 2].map(|i| high[i] - low[i]));
        let rounding = |p: &[f64; 3]| length(p.map(|x| x - f64::from(x as f32)));
        let lost = self.used().map(rounding).fold(0.0, f64::max);
        // Overflowing values are left unchanged, and rejected later.
        let far = lost > MOST_LOST * diagonal && lost.is_finite() && diagonal > 0.0;
        // Numbers written from single precision lose nothing.
        if !far || self.used().flatten().all(|&x| is_single(x)) {
            return [0.0; 3];
        }
        let unit = diagonal.log2().ceil().exp2();
        let origin = self.center().map(|x| (x / unit).round() * unit);
        if !origin.iter().all(|x| x.is_finite()) {
            return [0.0; 3];
        }
        self.notes.push(format!(
            "coordinates are kept relative to {origin:?}: single precision would round them by up to {lost:.2e}"
        ));
        origin
    }
}

/// Tests if a number is a single precision number, exactly or by its shortest decimal form.
fn is_single(x: f64) -> bool {
    let single = x as f32;
    f64::from(single) == x || single.to_string().parse() == Ok(x)
}

/// Welds to a vertex per point, in order of first appearance.
fn weld(soup: &Mesh) -> Result<Mesh, ReadError> {
    let topology = Topology::new(soup);
    let at = |&v: &u32| soup.positions()[v as usize];
    let positions: Vec<[f32; 3]> = topology.vertex_of_point().iter().map(at).collect();
    let triangles: Vec<[u32; 3]> =
        soup.triangles().iter().map(|t| t.map(|v| topology.point_of()[v as usize])).collect();
    Ok(Mesh::new(positions, triangles)?)
}

/// Adds a note if an attribute has values that are not finite: these are kept as in the file.
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

/// Counts occurrences, and remembers the place of the first.
#[derive(Clone, Default)]
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

    /// Adds the note "`count` `what`, such as at `place` N", if `count > 0`.
    pub fn note(&self, what: &str, place: &str, notes: &mut Vec<String>) {
        if self.count > 0 {
            notes.push(format!("{} {what}, such as at {place} {}", self.count, self.first));
        }
    }
}
