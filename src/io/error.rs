//! What can be wrong with a file: one enum for reading and one for writing, each message one line that names the place.

use std::fmt;
use std::path::PathBuf;

use crate::error::MeshError;

/// Where in a file something was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line, counted from 1.
    Line(usize),
    /// An offset in bytes from the start of the file.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The extension names no format that can be read.
    #[error("{}: the extension is none of .obj, .ply, .stl, .off, .glb, .gltf", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// Something does not follow the format.
    #[error("{place}: {what}")]
    Syntax {
        /// Where.
        place: Place,
        /// What is wrong there.
        what: String,
    },
    /// Something in a structured file (a glTF document) does not follow the format; named by its index.
    #[error("{what}")]
    Invalid {
        /// What is wrong with which element.
        what: String,
    },
    /// The file ends before what it declares.
    #[error("truncated: {what}")]
    Truncated {
        /// What was expected and what is there.
        what: String,
    },
    /// The file describes more than can or should be held.
    #[error("too large: {what}")]
    TooLarge {
        /// What is too large.
        what: String,
    },
    /// A part of the format that is not supported.
    #[error("not supported: {what}")]
    Unsupported {
        /// Which part.
        what: String,
    },
    /// The file was read, but what it holds is not a legal mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl ReadError {
    pub(super) fn line(line: usize, what: impl Into<String>) -> Self {
        Self::Syntax { place: Place::Line(line), what: what.into() }
    }

    pub(super) fn byte(byte: usize, what: impl Into<String>) -> Self {
        Self::Syntax { place: Place::Byte(byte), what: what.into() }
    }

    pub(super) fn invalid(what: impl Into<String>) -> Self {
        Self::Invalid { what: what.into() }
    }

    pub(super) fn truncated(what: impl Into<String>) -> Self {
        Self::Truncated { what: what.into() }
    }

    pub(super) fn too_large(what: impl Into<String>) -> Self {
        Self::TooLarge { what: what.into() }
    }

    pub(super) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported { what: what.into() }
    }
}

/// Why a file could not be written. Whatever the reason, a file that was there before is untouched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The extension names no format that can be written.
    #[error("{}: the extension is none of .obj, .ply, .stl, .off, .glb, .gltf", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The format cannot hold the mesh.
    #[error("{format} cannot hold {what}")]
    Unsupported {
        /// The format's name.
        format: &'static str,
        /// What it cannot hold.
        what: String,
    },
}
