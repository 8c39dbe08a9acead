//! Errors of a store.

use crate::io::BakeError;

use super::super::error::{Damage, StreamError};

/// Error of writing a [`Store`](super::Store), of opening it, or of a page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Reading or writing failed.
    #[error("reading or writing: {0}")]
    Io(#[from] std::io::Error),
    /// The bytes of the header, or of a page, are no sections of a baked file, or damaged.
    #[error(transparent)]
    Sections(#[from] BakeError),
    /// An option is out of its range, or the model cannot be sent.
    #[error(transparent)]
    Stream(#[from] StreamError),
    /// The arrays of the header, or of a page, do not fit together.
    #[error("the store makes no sense: {what}")]
    Damaged {
        /// What makes no sense.
        what: &'static str,
    },
    /// The bytes are of another page, or of another store.
    #[error("these are not the bytes of page {page} of this store")]
    OtherPage {
        /// The page asked for.
        page: u32,
    },
    /// There is no such page.
    #[error("there is no page {page}, but {pages} pages")]
    NoPage {
        /// The page asked for.
        page: u32,
        /// Number of pages.
        pages: u32,
    },
}

impl From<Damage> for StoreError {
    fn from(Damage(what): Damage) -> Self {
        Self::Damaged { what }
    }
}
