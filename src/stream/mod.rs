//! Transmission of a model that lies elsewhere: coarse at once, then what is looked at. Bytes in, bytes out; no sockets.
//!
//! ```text
//!     client   adapt(views) -> request() ------>  receive(request)   session of a server
//!              receive(packet)           <------  packet(budget)     one hierarchy, shared by all sessions
//! ```
//!
//! A client has no hierarchy. It gets the coarsest mesh and the splits that its views ask for, and draws them as any
//! [`Lod`](crate::lod::Lod). Its session keeps account of what the client has: a bit for each split. What no view asks for any more is
//! collapsed, and stays in a cache for a while, of which both sides know the contents. Loss, doubling, reordering and damage of
//! packets are detected and answered by sending again.
//!
//! Source: Southern, section 5.2 (a client without a state of its own, coherence, triangle limit, cache).
//!
//! | file | idea |
//! |---|---|
//! | `server.rs` | [`Server`]: a model to be sent, and what all sessions share |
//! | `session.rs` | [`Session`]: one client, as its server sees it |
//! | `plan.rs` | the steps from what a client has to what its views ask for |
//! | `client.rs` | [`Client`]: what a client draws |
//! | `received.rs` | vertices, splits and triangles that arrived, and their mesh |
//! | `values.rs` | vertices to be drawn, made of those that arrived |
//! | `starts.rs` | which drawn vertex a leaf belongs to |
//! | `store/` | a model in pages, fetched as they are looked at; needs the feature `io` |
//! | `prefix.rs` | a file of which every beginning is a coarser mesh |
//! | `record.rs` | a split on the wire, written and read by one text |
//! | `channels.rs` | the scalars of a vertex as whole numbers |
//! | `keys.rs` | sets of splits on the wire |
//! | `coder.rs` | bits and numbers by adaptive models |
//! | `packet.rs` | frames: numbers, lengths, checksums |
//! | `header.rs`, `request.rs` | the first packet; what a client asks for |
//! | `cache.rs`, `bits.rs`, `tables.rs` | collapsed splits; sets of splits; a server's tables of its model |
//! | `error.rs` | [`StreamError`] |

mod bits;
mod cache;
mod channels;
mod client;
mod coder;
mod error;
mod header;
mod keys;
mod packet;
mod plan;
mod prefix;
mod received;
mod record;
mod request;
mod server;
mod session;
mod starts;
#[cfg(feature = "io")]
pub mod store;
mod tables;
mod values;

pub use client::{Client, ClientOptions, Receipt, StreamVertex};
pub use error::StreamError;
pub use packet::{VERSION, message_length, stream_of};
pub use prefix::{Prefix, read_prefix, write_prefix};
pub use server::{Server, StreamOptions};
pub use session::{Session, SessionCounts};
