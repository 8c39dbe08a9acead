//! The client without sockets: packets in, requests out, packets kept in a journal.
//!
//! ```text
//!     look(views)   notes the views
//!     request()     Some: to be sent now; a view changed, or packets came that are not acknowledged
//!     take(packet)  changes the mesh; appends to the journal, before the packet is acknowledged
//! ```

use std::path::Path;

use multires::lod::{Lod, LodOptions};
use multires::stream::{Client, ClientOptions, StreamError, StreamVertex};
use multires::view::ObjectView;

use crate::AnyError;
use crate::journal::Journal;

/// A client whose vertices are positions.
pub type Positions = Client<[f32; 3], fn(StreamVertex<'_>) -> [f32; 3]>;

/// Creates a client whose vertices are positions.
pub fn positions(options: ClientOptions) -> Positions {
    Client::new(options, |vertex| vertex.position())
}

/// Returns the number of triangles that a client draws.
pub fn triangles(client: &Positions) -> usize {
    (0..client.groups()).map(|group| client.triangles(group).len()).sum()
}

/// Bytes after which packets are acknowledged even without a new view: a quarter of a session's window.
const UNACKNOWLEDGED: usize = 16_384;

/// Counts of a [`Browser`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Received {
    /// Packets from the line.
    pub packets: usize,
    /// Bytes of packets from the line.
    pub bytes: usize,
    /// Packets from the journal.
    pub journal_packets: usize,
    /// Bytes of packets from the journal.
    pub journal_bytes: usize,
    /// Bytes of requests.
    pub requested: usize,
    /// Streams that began on the line: 0 after a resumption, 1 for a new client.
    pub streams: usize,
}

/// A client and its journal.
pub struct Browser {
    client: Positions,
    journal: Option<Journal>,
    received: Received,
    unacknowledged: usize,
}

impl Browser {
    /// Creates a client that draws at most `triangles`. With a journal, the client begins with the packets of the file.
    ///
    /// # Errors
    /// The journal cannot be opened.
    pub fn open(
        options: ClientOptions,
        triangles: Option<usize>,
        journal: Option<&Path>,
    ) -> Result<Self, AnyError> {
        let mut client = positions(options);
        client.set_options(&LodOptions::default().with_triangles(triangles))?;
        let mut received = Received::default();
        let mut journal = match journal {
            None => None,
            Some(path) => {
                let opened = Journal::open(path, |packet| {
                    let good = client.receive(packet).is_ok_and(|receipt| !receipt.repeated);
                    client.clean();
                    if good {
                        received.journal_packets += 1;
                        received.journal_bytes += packet.len();
                    }
                    good
                });
                Some(opened.map_err(|error| format!("{}: {error}", path.display()))?)
            }
        };
        if client.stream() == 0 {
            // A packet that makes no sense empties the client: the packets before are of no use either.
            received = Received::default();
            journal.as_mut().map_or(Ok(()), Journal::restart)?;
        }
        Ok(Self { client, journal, received, unacknowledged: 0 })
    }

    /// Notes a new connection: what was on its way on the last connection is lost, and asked for again.
    pub fn connected(&mut self) {
        self.client.ask_again();
    }

    /// Notes the views.
    pub fn look(&mut self, views: &[ObjectView]) {
        self.client.adapt(views, 0.0);
    }

    /// Returns a request that tells the server what has changed; `None` if nothing has.
    pub fn request(&mut self) -> Option<Vec<u8>> {
        if !self.client.has_request() {
            return None;
        }
        self.unacknowledged = 0;
        let request = self.client.request();
        self.received.requested += request.len();
        Some(request)
    }

    /// Whether a request must go at once, without waiting for a new view: the server would soon stop and wait.
    pub fn is_pressed(&self) -> bool {
        self.unacknowledged >= UNACKNOWLEDGED
    }

    /// Takes a packet in. Damaged packets, and packets after a gap, are asked for again.
    ///
    /// # Errors
    /// The server does not keep to the format, or the journal cannot be written.
    pub fn take(&mut self, packet: &[u8]) -> Result<(), AnyError> {
        self.received.packets += 1;
        self.received.bytes += packet.len();
        self.unacknowledged += packet.len();
        let before = self.client.stream();
        let receipt = match self.client.receive(packet) {
            Ok(receipt) => receipt,
            Err(StreamError::NoMessage { .. } | StreamError::Missing { .. }) => return Ok(()),
            Err(error) => {
                // The client is empty again, so the journal must be.
                self.journal.as_mut().map_or(Ok(()), Journal::restart)?;
                return Err(error.into());
            }
        };
        let begins = self.client.stream() != before;
        self.received.streams += usize::from(begins);
        if let Some(journal) = self.journal.as_mut().filter(|_| !receipt.repeated) {
            if begins {
                journal.restart()?;
            }
            journal.append(packet)?;
        }
        // A renderer uploads the written ranges here.
        self.client.clean();
        Ok(())
    }

    /// Returns the client.
    pub fn client(&self) -> &Positions {
        &self.client
    }

    /// Returns the number of triangles drawn.
    pub fn triangles(&self) -> usize {
        triangles(&self.client)
    }

    /// Returns the counts so far.
    pub fn received(&self) -> Received {
        self.received
    }
}
