//! Progress on stderr, where that is a terminal; nothing anywhere else.

use std::io::IsTerminal;
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Parts that the bar has.
const PARTS: u64 = 1000;

/// A bar that goes away when it is dropped.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar at the start of a stage.
    pub fn new(stage: &'static str) -> Self {
        let visible = std::io::stderr().is_terminal();
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(PARTS), target);
        if let Ok(style) = ProgressStyle::with_template("{msg:<12} [{bar:40}] {percent:>3} % {elapsed}") {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(stage);
        Self(bar)
    }

    /// The next stage begins, with this share of the work done.
    pub fn begin(&self, stage: &'static str, share: f64) {
        self.0.set_message(stage);
        self.0.set_position((share * PARTS as f64) as u64);
        // A stage says nothing until it is over; the clock goes on.
        self.0.enable_steady_tick(std::time::Duration::from_millis(250));
    }

    /// How far a simplification is; never asks to stop.
    pub fn show(&self, progress: multires::simplify::Progress) -> ControlFlow<()> {
        self.share(progress.fraction())
    }

    /// How far anything is, 0 to 1; never asks to stop.
    pub fn share(&self, share: f32) -> ControlFlow<()> {
        self.0.set_position((f64::from(share) * PARTS as f64) as u64);
        ControlFlow::Continue(())
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
