//! [`Format`]: the formats, and what each keeps.

use std::fmt;
use std::path::Path;

/// A mesh file format.
///
/// | | positions | triangles | attributes | materials |
/// |---|---|---|---|---|
/// | OBJ | exact | exact | `color`, `uv`, `normal` | ids and names |
/// | PLY | exact | exact | all | ids and names |
/// | STL | exact, welded | exact | none | none |
/// | OFF | exact | exact | `color`, `uv`, `normal` | none |
/// | glTF | exact | exact, grouped by material | all up to width 4 | ids and names |
///
/// The table lists the data written, and restored on reading. Readers also keep what other programs write: UV by corner
/// (OBJ, PLY) and colours of faces (PLY, OFF, if vertices have none). A vertex becomes several vertices where its
/// corners differ. [`Imported::notes`](super::Imported::notes) names what is left out. Files leave out the attribute
/// `vertex`. Only the baked container keeps locks.
///
/// Positions are written in world coordinates: the mesh's [`origin`](crate::mesh::Mesh::origin) is added in double
/// precision. If the origin is not zero, text has the digits needed, PLY has doubles, STL is text, and glTF moves its
/// node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// Stanford polygon format, `.ply`; read as text and binary of either byte order, written as little-endian binary.
    Ply,
    /// Stereolithography, `.stl`; read as text and binary, written as binary, or as text if the origin is not zero.
    Stl,
    /// Object file format, `.off`; read as text and binary of either byte order, written as text.
    Off,
    /// glTF 2.0 in a single file, `.glb`.
    Glb,
    /// glTF 2.0 as JSON, `.gltf`; written with an embedded buffer.
    Gltf,
}

impl Format {
    /// Returns the format of a path's extension, ignoring case.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        let extension = path.as_ref().extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "off" => Self::Off,
            "glb" => Self::Glb,
            "gltf" => Self::Gltf,
            _ => return None,
        })
    }

    /// Returns the customary extension, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Off => "off",
            Self::Glb => "glb",
            Self::Gltf => "gltf",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.extension())
    }
}
