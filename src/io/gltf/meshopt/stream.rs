//! Bytes of a stream, read in order.

/// What is wrong with a stream.
pub(super) type Fault = &'static str;

pub(super) const ENDS: Fault = "the stream ends too early";
pub(super) const LEFT: Fault = "bytes are left at the end of the stream";
pub(super) const HEADER: Fault = "the first byte is no version that is known";

/// The bytes still to be read.
pub(super) struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(ENDS)?;
        self.0 = rest;
        Ok(taken)
    }

    pub fn byte(&mut self) -> Result<u8, Fault> {
        let (&byte, rest) = self.0.split_first().ok_or(ENDS)?;
        self.0 = rest;
        Ok(byte)
    }

    /// Reads an unsigned LEB128 number of 1 to 5 bytes; bits beyond 32 are lost.
    pub fn number(&mut self) -> Result<u32, Fault> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err("a number is longer than 5 bytes")
    }

    pub fn end(self) -> Result<(), Fault> {
        if self.0.is_empty() { Ok(()) } else { Err(LEFT) }
    }
}

/// Splits a stream into its header byte, content, and a tail of `tail` bytes.
pub(super) fn parts(stream: &[u8], tail: usize) -> Result<(u8, Bytes<'_>, &[u8]), Fault> {
    let (&header, rest) = stream.split_first().ok_or(ENDS)?;
    let (content, tail) = rest.split_at_checked(rest.len().checked_sub(tail).ok_or(ENDS)?).ok_or(ENDS)?;
    Ok((header, Bytes(content), tail))
}

/// Returns the difference of a number whose lowest bit is its sign: 0, -1, 1, -2, 2.
pub(super) fn unzigzag(number: u32) -> u32 {
    (number >> 1) ^ (number & 1).wrapping_neg()
}

/// Appends an index of 2 or 4 bytes.
pub(super) fn put(to: &mut Vec<u8>, index: u32, stride: usize) {
    to.extend_from_slice(&index.to_le_bytes()[..stride]);
}
