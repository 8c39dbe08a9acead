//! The client on TCP: connects, and connects again when the line breaks. A caller moves the camera meanwhile.

use std::time::{Duration, Instant};

use multires::view::ObjectView;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::time::{MissedTickBehavior, interval, sleep, timeout};

use crate::AnyError;
use crate::browser::Browser;
use crate::messages::{LineError, MOST_PACKET, Messages};

/// Time between two views.
pub const FRAME: Duration = Duration::from_millis(50);
/// Longest time that a write, or the first packet, may take.
const PATIENCE: Duration = Duration::from_secs(30);
/// Connections without a packet, in a row, before the client gives up.
const TRIES: u32 = 20;
/// Pause before another connection.
const PAUSE: Duration = Duration::from_millis(250);

/// The application of a client: looks at the mesh, and says what to see next. Closures implement it.
pub trait Watch {
    /// Takes a frame, `time` after the start and `quiet` after the last packet. Returns the views, or `None` to end.
    ///
    /// # Errors
    /// Any error ends the client.
    fn frame(
        &mut self,
        browser: &Browser,
        time: Duration,
        quiet: Duration,
    ) -> Result<Option<Vec<ObjectView>>, AnyError>;
}

impl<F: FnMut(&Browser, Duration, Duration) -> Result<Option<Vec<ObjectView>>, AnyError>> Watch for F {
    fn frame(
        &mut self,
        browser: &Browser,
        time: Duration,
        quiet: Duration,
    ) -> Result<Option<Vec<ObjectView>>, AnyError> {
        self(browser, time, quiet)
    }
}

/// Runs a client until `watch` ends it.
///
/// # Errors
/// No packet from 20 connections in a row; the server does not keep to the format; an error of `watch` or of the journal.
pub async fn run(browser: &mut Browser, address: &str, watch: &mut impl Watch) -> Result<(), AnyError> {
    let start = Instant::now();
    let mut tries = 0;
    loop {
        let before = browser.received().packets;
        let end = match TcpStream::connect(address).await {
            Ok(socket) => {
                browser.connected();
                converse(browser, socket, start, watch).await
            }
            Err(error) => Err(End::Line(error.into())),
        };
        let error = match end {
            Ok(()) => return Ok(()),
            Err(End::Other(error)) => return Err(error),
            Err(End::Line(error)) => error,
        };
        tries = if browser.received().packets > before { 1 } else { tries + 1 };
        if tries >= TRIES {
            return Err(format!("{address}: {error}").into());
        }
        sleep(PAUSE).await;
    }
}

/// Why a connection ended: the line broke, or by an error that another connection does not mend.
enum End {
    Line(LineError),
    Other(AnyError),
}

impl From<LineError> for End {
    fn from(error: LineError) -> Self {
        match error {
            LineError::Stream(_) | LineError::TooLong { .. } => Self::Other(error.into()),
            _ => Self::Line(error),
        }
    }
}

impl From<std::io::Error> for End {
    fn from(error: std::io::Error) -> Self {
        Self::Line(error.into())
    }
}

async fn converse(
    browser: &mut Browser,
    mut socket: TcpStream,
    start: Instant,
    watch: &mut impl Watch,
) -> Result<(), End> {
    socket.set_nodelay(true)?;
    let (read, mut write) = socket.split();
    let mut packets = Messages::new(read, MOST_PACKET);
    let mut frames = interval(FRAME);
    frames.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut last = Instant::now();
    loop {
        let due = tokio::select! {
            biased;
            _ = frames.tick() => {
                let views = watch.frame(browser, start.elapsed(), last.elapsed()).map_err(End::Other)?;
                let Some(views) = views else { return Ok(()) };
                if browser.client().stream() == 0 && last.elapsed() >= PATIENCE {
                    return Err(LineError::Silent.into());
                }
                browser.look(&views);
                true
            }
            packet = packets.next() => {
                let packet = packet?.ok_or(LineError::Cut)?;
                browser.take(&packet).map_err(End::Other)?;
                last = Instant::now();
                browser.is_pressed()
            }
        };
        if let Some(request) = due.then(|| browser.request()).flatten() {
            timeout(PATIENCE, write.write_all(&request)).await.map_err(|_| LineError::Silent)??;
        }
    }
}
