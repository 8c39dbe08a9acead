//! Errors of a stream.

/// Why content cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Damage(pub &'static str);

/// Error of a [`Client`](super::Client), a [`Server`](super::Server) or a [`Session`](super::Session).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// Bytes are no message of a stream: cut, or changed on the way. Nothing has changed; ask again.
    #[error("this is no message of a stream: {what}")]
    NoMessage {
        /// What is wrong.
        what: &'static str,
    },
    /// The message has another version of the format.
    #[error("the message has version {found} of the format, this is version {expected}")]
    OtherVersion {
        /// Version found.
        found: u8,
        /// Version supported.
        expected: u8,
    },
    /// A packet came before packets sent earlier. Nothing has changed; the next request asks for the missing packets.
    #[error("packet {found} came, but packet {expected} is missing")]
    Missing {
        /// Number of the packet that is needed.
        expected: u32,
        /// Number of the packet that came.
        found: u32,
    },
    /// A packet arrived as it was sent, but makes no sense: the other side does not keep to the format. The client is empty
    /// again, and its next request begins anew.
    #[error("the stream makes no sense: {what}")]
    Damaged {
        /// What makes no sense.
        what: &'static str,
    },
    /// There is more of something than a client takes ([`ClientOptions`](super::ClientOptions)), or than a packet holds.
    #[error("there are too many {what} to be sent")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
    },
    /// An option is out of its range.
    #[error("{option} is {value}, which is not {expected}")]
    OutOfRange {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
        /// The allowed values.
        expected: &'static str,
    },
}

impl From<Damage> for StreamError {
    fn from(Damage(what): Damage) -> Self {
        Self::Damaged { what }
    }
}
