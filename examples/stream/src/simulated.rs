//! Server and client in one process, over a line with a clock of its own: equal bytes at equal times in every run.
//!
//! ```text
//!     session -- packet, as the line has room --> rate and delay --> client
//!             <-- request, with every frame  ---- delay alone   ----
//! ```
//!
//! Time is whole microseconds. Both sides take no time to compute.

use std::collections::VecDeque;

use multires::stream::{ClientOptions, Server, Session};
use multires::view::ObjectView;

use crate::AnyError;
use crate::browser::Browser;
use crate::bucket::packet_bytes;

/// A line: bytes a second towards the client, and the delay of each direction in microseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Bytes a second.
    pub rate: f64,
    /// Microseconds from one side to the other.
    pub delay: u64,
}

/// A session, a client, and the messages on their way between them.
pub struct Simulated {
    line: Line,
    budget: usize,
    session: Session,
    browser: Browser,
    now: u64,
    /// Packets on their way, with the times of their arrival.
    packets: VecDeque<(u64, Vec<u8>)>,
    /// Requests on their way, with the times of their arrival.
    requests: VecDeque<(u64, Vec<u8>)>,
    /// Time at which the line has room for another packet.
    free: u64,
    /// Set while the session has nothing to send.
    silent: bool,
    /// Begin and end of every packet on the line.
    busy: Vec<[u64; 2]>,
}

/// The next thing to happen.
enum Event {
    Request,
    Packet,
    Room,
}

impl Simulated {
    /// Connects a client that draws at most `triangles` with a server.
    ///
    /// # Errors
    /// None: the client has no journal that could fail.
    pub fn new(
        server: &Server,
        options: ClientOptions,
        triangles: Option<usize>,
        line: Line,
    ) -> Result<Self, AnyError> {
        Ok(Self {
            line,
            budget: packet_bytes(line.rate),
            session: server.session(),
            browser: Browser::open(options, triangles, None)?,
            now: 0,
            packets: VecDeque::new(),
            requests: VecDeque::new(),
            free: 0,
            silent: true,
            busy: Vec::new(),
        })
    }

    /// Sets the views at the time of now, and tells the server.
    pub fn look(&mut self, views: &[ObjectView]) {
        self.browser.look(views);
        self.tell();
    }

    fn tell(&mut self) {
        if let Some(request) = self.browser.request() {
            self.requests.push_back((self.now + self.line.delay, request));
        }
    }

    /// Lets time pass until `time`, microseconds.
    ///
    /// # Errors
    /// One side does not understand the other: a bug.
    pub fn run(&mut self, time: u64) -> Result<(), AnyError> {
        while let Some((at, event)) = self.next().filter(|(at, _)| *at <= time) {
            self.now = at;
            match event {
                Event::Request => {
                    if let Some((_, request)) = self.requests.pop_front() {
                        self.session.receive(&request)?;
                        self.silent = false;
                    }
                }
                Event::Packet => {
                    if let Some((_, packet)) = self.packets.pop_front() {
                        self.browser.take(&packet)?;
                        if self.browser.is_pressed() {
                            self.tell();
                        }
                    }
                }
                Event::Room => match self.session.packet(self.budget) {
                    Some(packet) => {
                        self.free = at + (packet.len() as f64 / self.line.rate * 1e6).ceil() as u64;
                        self.busy.push([at, self.free]);
                        self.packets.push_back((self.free + self.line.delay, packet));
                    }
                    None => self.silent = true,
                },
            }
        }
        self.now = time;
        Ok(())
    }

    fn next(&self) -> Option<(u64, Event)> {
        let request = self.requests.front().map(|(at, _)| (*at, Event::Request));
        let packet = self.packets.front().map(|(at, _)| (*at, Event::Packet));
        let room = (!self.silent).then(|| (self.free.max(self.now), Event::Room));
        // Requests first: the next packet is for the newest view.
        [request, packet, room].into_iter().flatten().min_by_key(|(at, _)| *at)
    }

    /// Returns the share of the time between two moments in which the line was busy.
    pub fn busy(&self, from: u64, to: u64) -> f64 {
        let shared = |[begin, end]: &[u64; 2]| (*end).min(to).saturating_sub((*begin).max(from));
        self.busy.iter().map(shared).sum::<u64>() as f64 / to.saturating_sub(from).max(1) as f64
    }

    /// Returns the client.
    pub fn browser(&self) -> &Browser {
        &self.browser
    }

    /// Returns the session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the time, microseconds.
    pub fn now(&self) -> u64 {
        self.now
    }
}
