//! The server: one task for each connection, one session for each client.
//!
//! ```text
//!     accept      a place is free    -> a task for the connection
//!                 no place is free   -> the connection is closed at once
//!     shutdown    no more accepts; each connection ends after the packet that is being written
//! ```
//!
//! A connection that is silent, does not read, or sends anything but requests ends alone: other connections go on. A connection
//! holds a session, at most one request, and one packet.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use multires::stream::Server;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};

use crate::guest::Guest;
use crate::lobby::Lobby;
use crate::messages::{LineError, MOST_REQUEST, Messages};

/// Time that connections have to end at a shutdown. Connections still open are then cut.
const FAREWELL: Duration = Duration::from_secs(2);
/// Pause after the operating system refuses a connection.
const PAUSE: Duration = Duration::from_millis(100);

/// Options of a [`Service`]. Defaults: no limit of the rate, 64 clients, 64 sessions of absent clients for 5 minutes.
#[derive(Debug, Clone)]
pub struct ServiceOptions {
    /// Bytes a second to each client; infinite for no limit. Default infinite.
    pub rate: f64,
    /// Most connections at once. More connections are closed. Default 64.
    pub clients: usize,
    /// Most sessions kept for clients that are away. Default 64.
    pub away: usize,
    /// Time for which the session of a client that is away is kept. Default 5 minutes.
    pub away_for: Duration,
    /// Time in which a new connection must send its first request. Default 10 seconds.
    pub greeting: Duration,
    /// Longest silence of a client that has all it asked for, and longest time in which a client must read a packet. Default
    /// 2 minutes.
    pub patience: Duration,
}

impl Default for ServiceOptions {
    fn default() -> Self {
        Self {
            rate: f64::INFINITY,
            clients: 64,
            away: 64,
            away_for: Duration::from_secs(300),
            greeting: Duration::from_secs(10),
            patience: Duration::from_secs(120),
        }
    }
}

/// Counts of a [`Service`] since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ServiceCounts {
    /// Connections that were given a place.
    pub connections: usize,
    /// Connections that were closed for want of a place.
    pub refused: usize,
    /// Connections that ended by an error: garbage, silence, a broken line.
    pub failed: usize,
    /// Sessions made: clients that began anew.
    pub sessions: usize,
    /// Sessions given to clients that came back.
    pub resumed: usize,
    /// Bytes of all packets written.
    pub bytes: usize,
}

/// The same counts, written by all connections at once.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    connections: AtomicUsize,
    refused: AtomicUsize,
    failed: AtomicUsize,
    pub(crate) sessions: AtomicUsize,
    pub(crate) resumed: AtomicUsize,
    pub(crate) bytes: AtomicUsize,
}

/// Waits for a shutdown. Cancel safe.
pub(crate) async fn stopped(stop: &mut watch::Receiver<bool>) {
    // The sender outlives all receivers, so there is no error.
    let _ = stop.wait_for(|stop| *stop).await;
}

/// A model that is served on a socket.
#[derive(Debug)]
pub struct Service {
    pub(crate) server: Server,
    pub(crate) options: ServiceOptions,
    pub(crate) lobby: Lobby,
    pub(crate) counters: Counters,
    pub(crate) started: Instant,
    stop: watch::Sender<bool>,
}

impl Service {
    /// Prepares a service.
    pub fn new(server: Server, options: ServiceOptions) -> Arc<Self> {
        Arc::new(Self {
            lobby: Lobby::new(options.away, options.away_for),
            server,
            options,
            counters: Counters::default(),
            started: Instant::now(),
            stop: watch::Sender::new(false),
        })
    }

    /// Returns the model as clients get it.
    pub fn server(&self) -> &Server {
        &self.server
    }

    /// Returns the sessions of clients.
    pub fn lobby(&self) -> &Lobby {
        &self.lobby
    }

    /// Returns counts since the start.
    pub fn counts(&self) -> ServiceCounts {
        let Counters { connections, refused, failed, sessions, resumed, bytes } = &self.counters;
        let [connections, refused, failed, sessions, resumed, bytes] =
            [connections, refused, failed, sessions, resumed, bytes]
                .map(|count| count.load(Ordering::Relaxed));
        ServiceCounts { connections, refused, failed, sessions, resumed, bytes }
    }

    /// Ends [`run`](Service::run): now, or as soon as it is called.
    pub fn stop(&self) {
        self.stop.send_replace(true);
    }

    /// Serves the connections of a listener until [`stop`](Service::stop). Needs a runtime of several threads.
    pub async fn run(self: Arc<Self>, listener: TcpListener) {
        let places = Arc::new(Semaphore::new(self.options.clients));
        let mut stop = self.stop.subscribe();
        let mut connections = JoinSet::new();
        loop {
            let accepted = tokio::select! {
                biased;
                () = stopped(&mut stop) => break,
                Some(_) = connections.join_next() => continue,
                accepted = listener.accept() => accepted,
            };
            let (socket, peer) = match accepted {
                Ok(accepted) => accepted,
                Err(error) => {
                    // Too many open files, in most cases: other connections close theirs.
                    eprintln!("accept: {error}");
                    sleep(PAUSE).await;
                    continue;
                }
            };
            let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
                self.counters.refused.fetch_add(1, Ordering::Relaxed);
                continue;
            };
            let service = Arc::clone(&self);
            connections.spawn(async move {
                service.serve(socket, peer).await;
                drop(place);
            });
        }
        drop(listener);
        let all = async { while connections.join_next().await.is_some() {} };
        if timeout(FAREWELL, all).await.is_err() {
            connections.shutdown().await;
        }
    }

    async fn serve(&self, socket: TcpStream, peer: SocketAddr) {
        self.counters.connections.fetch_add(1, Ordering::Relaxed);
        let since = Instant::now();
        let end = self.attend(socket, peer.ip()).await;
        if end.is_err() {
            self.counters.failed.fetch_add(1, Ordering::Relaxed);
        }
        let reason = end.map_or_else(|error| error.to_string(), |()| "closed".to_owned());
        eprintln!("{peer}: {reason} after {:.1} s", since.elapsed().as_secs_f64());
    }

    async fn attend(&self, mut socket: TcpStream, peer: IpAddr) -> Result<(), LineError> {
        // Requests and packets are small, and must not wait for more.
        socket.set_nodelay(true)?;
        let mut stop = self.stop.subscribe();
        let (read, write) = socket.split();
        let mut requests = Messages::new(read, MOST_REQUEST);
        let first = tokio::select! {
            () = stopped(&mut stop) => return Ok(()),
            first = timeout(self.options.greeting, requests.next()) => first.map_err(|_| LineError::Silent)??,
        };
        let Some(first) = first else { return Ok(()) };
        Guest::new(self, &first, peer).await?.converse(requests, write, stop).await
    }
}
