//! Sessions by the number of their stream, so that a client whose connection broke finds its session again.
//!
//! ```text
//!     enter(stream)   there and away   -> its session
//!                     there and here   -> the old connection is told to leave, then as above
//!                     not there        -> a new session
//!     leave(session)  kept for some minutes, at most so many
//! ```
//!
//! Stream numbers are easy to guess, so a session goes only to the network address that had it before. Another program at that
//! address may still take a session, and the client then begins anew.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use multires::stream::Session;
use tokio::sync::Notify;

/// Owner and whereabouts of a session.
#[derive(Debug)]
struct Place {
    peer: IpAddr,
    /// The session and since when its client is away; `None` while a connection has it.
    away: Option<(Session, Instant)>,
    /// Tells the connection that has the session to leave it.
    leave: Arc<Notify>,
}

/// What [`Lobby::enter`] finds.
#[derive(Debug)]
pub enum Found {
    /// The session, which now belongs to the new connection. [`Lobby::leave`] gives the session back.
    Session(Box<Session>),
    /// An older connection has the session, and was told to leave: ask again in a moment.
    Busy,
    /// No session of this stream, or a session of another address.
    None,
}

/// Sessions of all clients that are here, and of some that are away.
#[derive(Debug)]
pub struct Lobby {
    places: Mutex<HashMap<u32, Place>>,
    /// Most sessions of clients that are away.
    most_away: usize,
    /// Time for which a session is kept.
    away_for: Duration,
}

impl Lobby {
    /// Creates a lobby that keeps at most `most_away` sessions of clients that are away, each for `away_for`.
    pub fn new(most_away: usize, away_for: Duration) -> Self {
        Self { places: Mutex::default(), most_away, away_for }
    }

    /// Looks for the session of a stream.
    pub fn enter(&self, stream: u32, peer: IpAddr) -> Found {
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        self.sweep(&mut places);
        match places.get_mut(&stream) {
            Some(place) if place.peer == peer => match place.away.take() {
                Some((session, _)) => {
                    place.leave = Arc::default();
                    Found::Session(Box::new(session))
                }
                None => {
                    place.leave.notify_one();
                    Found::Busy
                }
            },
            _ => Found::None,
        }
    }

    /// Notes that a connection has the session of `stream`, whose stream was `before` if it had one. Returns the notice by which
    /// this connection is told to leave.
    pub fn here(&self, before: Option<u32>, stream: u32, peer: IpAddr) -> Arc<Notify> {
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        let known = before.and_then(|before| places.remove(&before));
        let leave = known.map(|place| place.leave).unwrap_or_default();
        places.insert(stream, Place { peer, away: None, leave: Arc::clone(&leave) });
        leave
    }

    /// Keeps the session of a connection that ended.
    pub fn leave(&self, session: Session) {
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = places.get_mut(&session.stream()) {
            place.away = Some((session, Instant::now()));
        }
        self.sweep(&mut places);
    }

    /// Drops sessions that have been away for too long, then the sessions longest away while there are too many.
    fn sweep(&self, places: &mut HashMap<u32, Place>) {
        places
            .retain(|_, place| place.away.as_ref().is_none_or(|(_, since)| since.elapsed() < self.away_for));
        loop {
            let away = places.iter().filter_map(|(&stream, place)| Some((place.away.as_ref()?.1, stream)));
            let count = away.clone().count();
            let Some((_, oldest)) = away.min().filter(|_| count > self.most_away) else { break };
            places.remove(&oldest);
        }
    }

    /// Returns the number of sessions, and the number of sessions whose clients are away.
    pub fn count(&self) -> [usize; 2] {
        let places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        [places.len(), places.values().filter(|place| place.away.is_some()).count()]
    }
}
