//! Errors of baked files.

use std::path::PathBuf;

/// Error of reading or writing a baked file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The operating system reported an error.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The bytes do not start with the magic number of a baked file, or a transfer in text mode changed them.
    #[error("this is no baked file")]
    NotBaked,
    /// The file has a format version that this version of the crate does not read.
    #[error("the file has format version {found}, this is version {expected}")]
    OtherVersion {
        /// Version in the file.
        found: u32,
        /// Version written.
        expected: u32,
    },
    /// The file holds another kind of structure.
    #[error("the file holds a {found:?}, not a {expected:?}")]
    OtherKind {
        /// Kind in the file.
        found: String,
        /// Kind requested.
        expected: String,
    },
    /// The bytes differ from the bytes written, or the structure is not valid.
    #[error("the file is damaged: {what}")]
    Damaged {
        /// Description of the damage.
        what: String,
    },
    /// The file lacks a section that its kind needs.
    #[error("the file has no section {section:?}")]
    Missing {
        /// Name of the section.
        section: String,
    },
    /// Bytes follow the end of the content.
    #[error("{bytes} bytes follow the end of the file's content")]
    Trailing {
        /// Number of extra bytes.
        bytes: usize,
    },
    /// The kind's name is not 1 to 16 printable ASCII characters.
    #[error("{kind:?} is no name of a kind: 1 to 16 printable ASCII characters are")]
    BadKind {
        /// Name given.
        kind: String,
    },
    /// The value cannot be serialised.
    #[error("the value cannot be written: {what}")]
    Encode {
        /// Reason.
        what: String,
    },
}

impl BakeError {
    pub(crate) fn damaged(what: impl ToString) -> Self {
        Self::Damaged { what: what.to_string() }
    }
}
