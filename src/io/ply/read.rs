//! A file to a draft: the header, then the body.

use crate::io::draft::Draft;
use crate::io::error::ReadError;

use super::{body, header};

/// Reads a whole file. O(n) in its size; reserves no more memory than the bytes left could fill.
pub(in crate::io) fn read(bytes: &[u8]) -> Result<Draft, ReadError> {
    let header = header::read(bytes)?;
    body::read(&header, bytes)
}
