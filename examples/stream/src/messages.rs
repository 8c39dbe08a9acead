//! Whole messages from a byte stream.
//!
//! TCP delivers bytes without borders. `message_length` finds the end of a message from its head. A damaged head, or a length
//! beyond the bound, ends the connection before the content is kept.

use multires::stream::{StreamError, message_length};
use tokio::io::{AsyncRead, AsyncReadExt};

/// Most bytes of a request: 16 views take 4,656.
pub const MOST_REQUEST: usize = 8_192;
/// Most bytes of a packet: content of at most 2^20 bytes, and a head, with room to spare.
pub const MOST_PACKET: usize = 1 << 21;
/// Bytes asked of the operating system at once.
const CHUNK: usize = 4_096;

/// Error of a connection.
#[derive(Debug, thiserror::Error)]
pub enum LineError {
    /// The operating system reports an error.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// The bytes do not follow the format.
    #[error(transparent)]
    Stream(#[from] StreamError),
    /// A message is longer than this side takes.
    #[error("a message of {length} bytes came, at most {most} are taken")]
    TooLong {
        /// Its length, bytes.
        length: usize,
        /// The bound, bytes.
        most: usize,
    },
    /// The connection ended in the middle of a message.
    #[error("the connection ended within a message")]
    Cut,
    /// The other side is silent, or does not read, for too long.
    #[error("the other side neither writes nor reads")]
    Silent,
    /// A new connection of the same client took the session.
    #[error("the client came back on another connection")]
    Moved,
}

/// Messages of one direction of a connection.
#[derive(Debug)]
pub struct Messages<R> {
    from: R,
    buffer: Vec<u8>,
    most: usize,
}

impl<R: AsyncRead + Unpin> Messages<R> {
    /// Creates a reader of messages of at most `most` bytes. Keeps at most one message and 4 KiB.
    pub fn new(from: R, most: usize) -> Self {
        Self { from, buffer: Vec::new(), most }
    }

    /// Returns the next message; `None` after the last. Cancel safe: bytes that came are kept for the next call.
    ///
    /// # Errors
    /// The bytes are no message, or too long a message, or the connection breaks.
    pub async fn next(&mut self) -> Result<Option<Vec<u8>>, LineError> {
        loop {
            if let Some(length) = message_length(&self.buffer)? {
                if length > self.most {
                    return Err(LineError::TooLong { length, most: self.most });
                }
                if self.buffer.len() >= length {
                    let rest = self.buffer.split_off(length);
                    return Ok(Some(std::mem::replace(&mut self.buffer, rest)));
                }
            }
            self.buffer.reserve(CHUNK);
            let mut limited = (&mut self.from).take(CHUNK as u64);
            if limited.read_buf(&mut self.buffer).await? == 0 {
                return if self.buffer.is_empty() { Ok(None) } else { Err(LineError::Cut) };
            }
        }
    }
}
