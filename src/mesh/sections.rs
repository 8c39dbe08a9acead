//! The vertices of a mesh in the sections of a baked file: positions, attributes and locks, without triangles.

use serde::{Deserialize, Serialize};

use super::attribute::Scalar;
use super::triangle_mesh::check_positions;
use super::{Attribute, Mesh};
use crate::sections::{BakeError, Reader, Writer};

/// Section `vertices`.
#[derive(Serialize, Deserialize)]
struct Head {
    attributes: Vec<Stream>,
    material_names: Vec<String>,
    origin: [f64; 3],
}

/// An attribute, whose values are section `attribute.N`.
#[derive(Serialize, Deserialize)]
struct Stream {
    name: String,
    width: u32,
    /// 0 float, 1 int, 2 uint.
    scalar: u32,
}

impl Mesh {
    /// Writes positions, attributes, locks, origin and the names of materials.
    ///
    /// # Errors
    /// None in practice: the small values can be serialised.
    pub(crate) fn write_vertices(&self, to: &mut Writer) -> Result<(), BakeError> {
        let stream = |attribute: &Attribute| Stream {
            name: attribute.name().to_owned(),
            width: attribute.width() as u32,
            scalar: attribute.scalar() as u32,
        };
        let head = Head {
            attributes: self.attributes.iter().map(stream).collect(),
            material_names: self.material_names.clone(),
            origin: self.origin,
        };
        to.meta("vertices", &head)?;
        to.array("positions", &self.positions);
        for (i, attribute) in self.attributes.iter().enumerate() {
            to.array(&section(i), attribute.all_words());
        }
        let locks: Vec<u8> = self.locks.iter().map(|&lock| u8::from(lock)).collect();
        to.array_if_any("locks", &locks);
        Ok(())
    }

    /// Reads the sections of [`Mesh::write_vertices`]. Attributes stay in the file.
    ///
    /// # Errors
    /// A section is missing; unless the file is trusted, also what [`Mesh::new`] and its kin refuse.
    pub(crate) fn read_vertices(from: &Reader<'_>) -> Result<Self, BakeError> {
        let Head { attributes: streams, material_names, origin } = from.meta("vertices")?;
        let positions = from.array("positions")?;
        if !from.is_trusted() {
            check_positions(&positions).map_err(BakeError::damaged)?;
        }
        let mut attributes = Vec::new();
        for (i, Stream { name, width, scalar }) in streams.into_iter().enumerate() {
            let scalar = [Scalar::Float, Scalar::Int, Scalar::Uint].get(scalar as usize);
            let scalar =
                *scalar.ok_or_else(|| BakeError::damaged(format!("attribute {name:?} has no type")))?;
            attributes.push(Attribute::stored(name, width as usize, scalar, from.array(&section(i))?));
        }
        let locks = from.array_if_any::<u8>("locks")?;
        if locks.iter().any(|&lock| lock > 1) {
            return Err(BakeError::damaged("a lock is neither 0 nor 1"));
        }
        let mesh = Self { positions, ..Self::default() }.with_material_names(material_names);
        let mesh = mesh.with_locks(locks.iter().map(|&lock| lock == 1).collect::<Vec<bool>>());
        let mesh = mesh.and_then(|mesh| mesh.with_origin(origin));
        mesh.and_then(|mesh| mesh.with_streams(attributes)).map_err(BakeError::damaged)
    }
}

/// Names the section of an attribute.
fn section(attribute: usize) -> String {
    format!("attribute.{attribute}")
}
