//! The driver of a simplification, and what it keeps.
//!
//! | file | idea |
//! |---|---|
//! | `driver.rs` | the driver: batches, the queue, targets |
//! | `attempt.rs` | tries the candidates of a point: asks the oracles, verifies costs |
//! | `commit.rs` | does a collapse |
//! | `candidates.rs` | candidates: pair, position and cost |
//! | `queue.rs` | points by cost |
//! | `around.rs` | what a collapse makes stale |
//! | `hubs.rs` | points with very many triangles |
//! | `vanish.rs` | how a part vanishes |
//! | `filling.rs` | when a batch is full |
//! | `give.rs` | rules that give before a target is missed |
//! | `watch.rs` | the guard: the largest error explained by the remaining triangles |
//! | `recorder.rs` | writes the sequence |
//! | `reorder.rs` | puts the steps of tiles in order |
//! | `finish.rs` | how a simplification ends |

mod around;
mod attempt;
mod candidates;
mod commit;
mod driver;
mod filling;
mod finish;
mod give;
mod hubs;
mod queue;
mod recorder;
mod reorder;
mod vanish;
mod watch;

pub(super) use driver::{Engine, Plan};
