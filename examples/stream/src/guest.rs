//! One connection of the server: a client's session while the connection lasts.
//!
//! ```text
//!     first request -> session of its stream, or a new session
//!     loop   a request has come      -> into the session
//!            the line has room       -> the next packet, for the newest view
//!            nothing to send         -> wait for a request
//!     end    the session stays in the lobby for some minutes
//! ```

use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use multires::stream::{Session, stream_of};
use tokio::io::AsyncWriteExt;
use tokio::net::tcp::{ReadHalf, WriteHalf};
use tokio::sync::{Notify, watch};
use tokio::task::block_in_place;
use tokio::time::{sleep, timeout};

use crate::bucket::{Bucket, packet_bytes};
use crate::lobby::Found;
use crate::messages::{LineError, Messages};
use crate::service::{Service, stopped};

/// Time in which an older connection must leave the session of a client that came back.
const HANDOVER: Duration = Duration::from_secs(2);
/// Time between two looks whether the older connection has left.
const GLANCE: Duration = Duration::from_millis(5);

/// A session while a connection has it. The session goes back to the lobby when the guest is dropped.
pub(crate) struct Guest<'a> {
    service: &'a Service,
    peer: IpAddr,
    /// `None` only while the guest is dropped.
    session: Option<Session>,
    stream: u32,
    /// Notified when the client came back on another connection.
    leave: Arc<Notify>,
}

impl Drop for Guest<'_> {
    fn drop(&mut self) {
        if let Some(session) = self.session.take() {
            self.service.lobby.leave(session);
        }
    }
}

impl<'a> Guest<'a> {
    /// Finds the session that the first request is for, or makes one.
    pub(crate) async fn new(service: &'a Service, first: &[u8], peer: IpAddr) -> Result<Self, LineError> {
        let stream = stream_of(first)?;
        let since = Instant::now();
        let known = loop {
            match service.lobby.enter(stream, peer) {
                Found::Session(session) => break Some(*session),
                Found::Busy if since.elapsed() < HANDOVER => sleep(GLANCE).await,
                Found::Busy | Found::None => break None,
            }
        };
        if let Some(mut session) = known {
            let before = session.stream();
            // Refused if the client lost packets that it had acknowledged: its journal lost the end. Then it begins anew.
            if session.receive(first).is_ok() {
                let resumed = session.stream() == before;
                let counters = &service.counters;
                let count = if resumed { &counters.resumed } else { &counters.sessions };
                count.fetch_add(1, Ordering::Relaxed);
                return Ok(Self::with(service, session, Some(before), peer));
            }
            service.lobby.leave(session);
        }
        let mut session = service.server.session();
        session.receive(first)?;
        service.counters.sessions.fetch_add(1, Ordering::Relaxed);
        Ok(Self::with(service, session, None, peer))
    }

    fn with(service: &'a Service, session: Session, before: Option<u32>, peer: IpAddr) -> Self {
        let stream = session.stream();
        let leave = service.lobby.here(before, stream, peer);
        Self { service, peer, session: Some(session), stream, leave }
    }

    /// Takes a request in. The session may begin a new stream by the request.
    fn heed(&mut self, request: &[u8]) -> Result<(), LineError> {
        let Some(session) = &mut self.session else { return Ok(()) };
        session.receive(request)?;
        let stream = session.stream();
        if stream != self.stream {
            self.service.counters.sessions.fetch_add(1, Ordering::Relaxed);
            self.service.lobby.here(Some(self.stream), stream, self.peer);
            self.stream = stream;
        }
        Ok(())
    }

    /// Serves the client until the connection ends.
    pub(crate) async fn converse(
        &mut self,
        mut requests: Messages<ReadHalf<'_>>,
        mut write: WriteHalf<'_>,
        mut stop: watch::Receiver<bool>,
    ) -> Result<(), LineError> {
        let Service { options, counters, started, .. } = self.service;
        let budget = packet_bytes(options.rate);
        let mut bucket = Bucket::new(options.rate, budget as f64);
        let leave = Arc::clone(&self.leave);
        let mut idle = false;
        loop {
            let wait = if idle { options.patience } else { bucket.wait(started.elapsed()) };
            tokio::select! {
                biased;
                () = stopped(&mut stop) => return Ok(()),
                () = leave.notified() => return Err(LineError::Moved),
                request = requests.next() => {
                    let Some(request) = request? else { return Ok(()) };
                    self.heed(&request)?;
                    idle = false;
                }
                () = sleep(wait) => {
                    if idle {
                        return Err(LineError::Silent);
                    }
                    // Takes milliseconds for a large model: other tasks move to other threads.
                    let packet = self.session.as_mut().and_then(|s| block_in_place(|| s.packet(budget)));
                    let Some(packet) = packet else { idle = true; continue };
                    bucket.spend(packet.len());
                    let written = timeout(options.patience, write.write_all(&packet)).await;
                    written.map_err(|_| LineError::Silent)??;
                    counters.bytes.fetch_add(packet.len(), Ordering::Relaxed);
                }
            }
        }
    }
}
