//! Frames: what every message begins with, so that loss, doubling, reordering and damage are told apart.
//!
//! ```text
//!     offset  bytes
//!          0      3   "MRS"
//!          3      1   version of the format
//!          4      1   kind: 1 packet of a server, 2 request of a client
//!          5      3   zeros
//!          8      4   stream: a number that a server gives to a session
//!         12      4   number of the packet; in a request, of the first packet that is missing
//!         16      4   length of the content, bytes
//!         20      4   zeros
//!         24      8   checksum of all bytes but itself
//!         32          content
//! ```

use crate::geometry::hash::mix;

use super::error::StreamError;

const MAGIC: [u8; 3] = *b"MRS";
/// Version of the wire format. Both sides must have the same.
pub const VERSION: u8 = 1;
const CHECKSUM_AT: usize = 24;
/// Bytes before the content.
pub(super) const HEAD: usize = 32;
/// Most bytes of a message.
pub(super) const MOST: usize = 1 << 24;

/// Which side sent a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Packet = 1,
    Request = 2,
}

/// A message without its head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Frame<'a> {
    pub stream: u32,
    pub number: u32,
    pub content: &'a [u8],
}

/// Returns the history after a packet: a hash of all packets so far. Both sides keep one, to know that they mean the same stream.
pub(super) fn history(before: u64, packet: &[u8]) -> u64 {
    let mut sum = [0; 8];
    sum.copy_from_slice(&packet[CHECKSUM_AT..HEAD]);
    mix(before ^ u64::from_le_bytes(sum)).rotate_left(1)
}

/// Starts a message; its content is to be appended, then [`finish`] called.
pub(super) fn start(kind: Kind, stream: u32, number: u32) -> Vec<u8> {
    let mut bytes = vec![0; HEAD];
    bytes[..3].copy_from_slice(&MAGIC);
    bytes[3] = VERSION;
    bytes[4] = kind as u8;
    bytes[8..12].copy_from_slice(&stream.to_le_bytes());
    bytes[12..16].copy_from_slice(&number.to_le_bytes());
    bytes
}

/// Writes length and checksum.
pub(super) fn finish(bytes: &mut [u8]) {
    let length = (bytes.len() - HEAD) as u32;
    bytes[16..20].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(bytes);
    bytes[CHECKSUM_AT..HEAD].copy_from_slice(&sum.to_le_bytes());
}

/// Reads the head of a message.
pub(super) fn open(kind: Kind, bytes: &[u8]) -> Result<Frame<'_>, StreamError> {
    let broken = |what| Err(StreamError::NoMessage { what });
    if bytes.len() < HEAD || bytes[..3] != MAGIC {
        return broken("it has no head");
    }
    if bytes[3] != VERSION {
        return Err(StreamError::OtherVersion { found: bytes[3], expected: VERSION });
    }
    if bytes.len() > MOST || number(bytes, 16) as usize != bytes.len() - HEAD {
        return broken("its length is not as said");
    }
    let mut sum = [0; 8];
    sum.copy_from_slice(&bytes[CHECKSUM_AT..HEAD]);
    if u64::from_le_bytes(sum) != checksum(bytes) {
        return broken("the checksum does not fit");
    }
    if bytes[4] != kind as u8 {
        return broken("it is of the other side");
    }
    Ok(Frame { stream: number(bytes, 8), number: number(bytes, 12), content: &bytes[HEAD..] })
}

/// Returns the length of the first message of a byte stream, its head included; `None` if bytes are still missing to tell.
///
/// ```
/// use multires::stream::{Client, ClientOptions, message_length};
///
/// let mut client = Client::new(ClientOptions::default(), |vertex| vertex.position());
/// let request = client.request();
/// assert_eq!(message_length(&request[..10]), Ok(None));
/// assert_eq!(message_length(&request), Ok(Some(request.len())));
/// ```
///
/// # Errors
/// The bytes are no message of this version.
pub fn message_length(bytes: &[u8]) -> Result<Option<usize>, StreamError> {
    let known = bytes.len().min(4);
    let head = [MAGIC[0], MAGIC[1], MAGIC[2], VERSION];
    if bytes[..known] != head[..known] {
        return Err(match bytes {
            [a, b, c, version, ..] if [*a, *b, *c] == MAGIC => {
                StreamError::OtherVersion { found: *version, expected: VERSION }
            }
            _ => StreamError::NoMessage { what: "it has no head" },
        });
    }
    if bytes.len() < HEAD {
        return Ok(None);
    }
    let length = HEAD + number(bytes, 16) as usize;
    if length > MOST { Err(StreamError::NoMessage { what: "it is too long" }) } else { Ok(Some(length)) }
}

/// Returns the number of the stream of a request: to find the [`Session`](super::Session) of a client that comes back. 0 if the client has none.
///
/// ```
/// use multires::stream::{Client, ClientOptions, stream_of};
///
/// let mut client = Client::new(ClientOptions::default(), |vertex| vertex.position());
/// assert_eq!(stream_of(&client.request()), Ok(0));
/// ```
///
/// # Errors
/// The bytes are no request, or damaged.
pub fn stream_of(request: &[u8]) -> Result<u32, StreamError> {
    open(Kind::Request, request).map(|frame| frame.stream)
}

/// Returns a number at an offset known to exist.
fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Hashes all bytes but the checksum, by words of 8. Each word's step is a bijection of the state only before folding, so damage
/// is missed with probability 2^-64, not never.
fn checksum(bytes: &[u8]) -> u64 {
    let mut state = bytes.len() as u64;
    for part in [&bytes[..CHECKSUM_AT], &bytes[HEAD..]] {
        for word in part.chunks(8) {
            let mut whole = [0; 8];
            whole[..word.len()].copy_from_slice(word);
            state = mix(state ^ u64::from_le_bytes(whole)).rotate_left(1);
        }
    }
    state
}
