//! Sections: named arrays in one file, each used where it lies.
//!
//! ```text
//!     header | table | section | section | ...        a section starts at a multiple of 64 bytes
//!              name, offset, lengths, checksum
//! ```
//!
//! A structure knows its sections ([`Sections`]); nothing here knows a structure. docs/format.md describes the bytes.
//!
//! | file | idea |
//! |---|---|
//! | `layout.rs` | [`Element`]: the scalars of an array's elements, for byte order |
//! | `table.rs` | header and table: written, read and checked |
//! | `codec.rs` | compressed sections: differences, planes of bits, LZ4 |
//! | `meta.rs`, `decoder.rs` | small values by serde and bincode |
//! | `writer.rs`, `reader.rs` | sections into bytes, and out of them |
//! | `options.rs` | [`BakeOptions`], [`OpenOptions`] |
//! | `error.rs` | [`BakeError`] |

mod codec;
mod decoder;
mod error;
mod layout;
mod meta;
mod options;
mod reader;
mod table;
mod writer;

pub use error::BakeError;
pub use layout::Element;
pub use options::{BakeOptions, Compression, OpenOptions, Trust};
pub use reader::Reader;
pub use table::SectionInfo;
pub use writer::Writer;

pub(crate) use meta::{decode, encode};
pub(crate) use table::{VERSION, is_kind, kind_of, section_infos, version_of};

/// What writes its arrays to sections, and reads them.
pub trait Sections: Sized {
    /// Writes all sections.
    ///
    /// # Errors
    /// A small value cannot be serialised.
    fn write_sections(&self, to: &mut Writer) -> Result<(), BakeError>;

    /// Reads all sections. Checks them unless [`Reader::is_trusted`]. Lengths are checked always.
    ///
    /// # Errors
    /// A section is missing, or what it holds is not valid.
    fn read_sections(from: &Reader<'_>) -> Result<Self, BakeError>;
}
