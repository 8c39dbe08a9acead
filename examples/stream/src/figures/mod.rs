//! The pictures and charts of docs/results/streaming.md: equal bytes in every run, without a network.
//!
//! | file | shows |
//! |---|---|
//! | `arrival.png` | a model at moments after the first request |
//! | `path.svg` | triangles, screen error and line along a path: splits alone, and with collapses (Southern, Fig. 5.6) |
//! | `error.svg` | bytes a view against screen error: every view anew, coherence, cache |
//! | `detail.png` | a detail at three limits of triangles (Southern, Fig. 5.8) |

mod arrival;
mod detail;
mod error;
mod path;

use std::io::Write;
use std::path::Path;

use multires::lod::Lod;
use multires::mesh::Mesh;
use multires::stream::{Server, Session};

use crate::AnyError;
use crate::browser::Positions;
use crate::camera::{Detail, Scene};
use crate::screen_error::ScreenError;
use crate::simulated::Line;

/// Tolerance of all views, pixels.
const PIXELS: f32 = 1.0;
/// Points that a screen error is measured at.
const SAMPLES: usize = 6_000;
/// Microseconds between two views.
const FRAME: u64 = 50_000;
/// Most bytes of a packet where no line limits it.
const PACKET: usize = 16_384;

/// A model on a server, a line, and a scene for the cameras.
#[derive(Debug)]
pub struct Figures {
    server: Server,
    full: Mesh,
    errors: ScreenError,
    scene: Scene,
    line: Line,
}

impl Figures {
    /// Prepares the figures of a server's model.
    ///
    /// # Errors
    /// The model cannot be drawn.
    pub fn new(server: Server, detail: &Detail, line: Line) -> Result<Self, AnyError> {
        let full = crate::model::full(&server)?;
        let scene = Scene::new(server.model().bounds().unwrap_or_default(), detail);
        Ok(Self { errors: ScreenError::new(&full, SAMPLES), server, full, scene, line })
    }

    /// Writes all files to the folder `out`, and the numbers measured to `says`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn make(&self, out: &Path, says: &mut impl Write) -> Result<(), AnyError> {
        std::fs::create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
        let Line { rate, delay } = self.line;
        let triangles = self.full.triangles().len();
        writeln!(says, "{triangles} triangles; {rate} bytes a second, {} ms each way", delay / 1_000)?;
        arrival::make(self, &out.join("arrival.png"), says)?;
        path::make(self, &out.join("path.svg"), says)?;
        error::make(self, &out.join("error.svg"), says)?;
        detail::make(self, &out.join("detail.png"), says)
    }
}

/// Sends packets for the views of a client, about `budget` bytes at most. Returns the bytes sent.
fn exchange(session: &mut Session, client: &mut Positions, budget: usize) -> Result<usize, AnyError> {
    let mut bytes = 0;
    while bytes < budget {
        session.receive(&client.request())?;
        let Some(packet) = session.packet((budget - bytes).min(PACKET)) else { break };
        bytes += packet.len();
        client.receive(&packet)?;
        client.clean();
    }
    Ok(bytes)
}
