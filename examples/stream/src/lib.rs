//! A model on one machine, looked at on another: the parts of the programs `serve` and `browse`.
//!
//! ```text
//!     browse                                            serve
//!     camera -> Browser -> request  ---- TCP ---->  Messages -> Session of this client
//!     picture <- Browser <- packet  <--- TCP -----  Bucket   <- packet
//!                   |                                  |
//!                Journal: packets kept on disk       Lobby: sessions of clients that are away
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `model.rs` | the model to be sent: a file, or a model made by the crate |
//! | `messages.rs` | whole messages from a byte stream, of bounded size |
//! | `bucket.rs` | a token bucket: bytes a second, without a clock of its own |
//! | `lobby.rs` | sessions by stream number, so that a client finds its session again |
//! | `service.rs` | the server: accepts connections, and ends them at a shutdown |
//! | `guest.rs` | one connection of the server: requests in, packets out |
//! | `journal.rs` | packets on disk, so that a client resumes after it was killed |
//! | `browser.rs` | the client without sockets: packets in, requests out |
//! | `line.rs` | the client on TCP, with reconnection |
//! | `camera.rs` | scripted cameras |
//! | `tour.rs` | a camera's tour on TCP: pictures and a chart over time |
//! | `simulated.rs` | server and client in one process, over a line with a clock of its own |
//! | `screen_error.rs` | distance of the drawn mesh from the model, in pixels |
//! | `pictures.rs`, `charts.rs` | PNG and SVG files |
//! | `figures/` | the pictures and charts of docs/results/streaming.md |

pub mod browser;
pub mod bucket;
pub mod camera;
pub mod charts;
pub mod figures;
mod guest;
pub mod journal;
pub mod line;
pub mod lobby;
pub mod messages;
pub mod model;
pub mod pictures;
pub mod screen_error;
pub mod service;
pub mod simulated;
pub mod tour;

#[path = "../../../src/bin/multires/canvas.rs"]
#[allow(missing_docs)]
mod canvas;
#[path = "../../../src/bin/multires/lettering.rs"]
#[allow(missing_docs)]
mod lettering;

/// Any error of a program.
pub type AnyError = Box<dyn std::error::Error + Send + Sync>;
