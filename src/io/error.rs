//! Errors of reading and writing files: an enum each. Each message is a single line naming the place.

use std::fmt;
use std::path::PathBuf;

use crate::error::MeshError;

/// Place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Line number, from 1.
    Line(usize),
    /// Offset in bytes from the start of the file.
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

/// Error of reading a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system reported an error.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The extension is not a readable format.
    #[error("{}: the extension is none of .obj, .ply, .stl, .off, .glb, .gltf", path.display())]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
    },
    /// The content violates the format.
    #[error("{place}: {what}")]
    Syntax {
        /// Place of the violation.
        place: Place,
        /// Description of the violation.
        what: String,
    },
    /// An element of a structured file (a glTF document) violates the format; the message names it by index.
    #[error("{what}")]
    Invalid {
        /// Element and its violation.
        what: String,
    },
    /// The file ends before all declared content.
    #[error("truncated: {what}")]
    Truncated {
        /// Content expected and content present.
        what: String,
    },
    /// The file declares more than a limit allows.
    #[error("too large: {what}")]
    TooLarge {
        /// Part that is too large.
        what: String,
    },
    /// The file uses an unsupported part of the format.
    #[error("not supported: {what}")]
    Unsupported {
        /// Unsupported part.
        what: String,
    },
    /// The file was read, but does not hold a valid mesh.
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

/// Error of writing a file. An existing file is unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The operating system reported an error.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The extension is not a writable format.
    #[error("{}: the extension is none of .obj, .ply, .stl, .off, .glb, .gltf", path.display())]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
    },
    /// The format cannot hold the mesh.
    #[error("{format} cannot hold {what}")]
    Unsupported {
        /// Name of the format.
        format: &'static str,
        /// Part of the mesh that the format cannot hold.
        what: String,
    },
}
