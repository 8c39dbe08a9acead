//! Progress on stderr, if it is a terminal; else nothing.

use std::io::IsTerminal;
use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Number of parts of the bar.
const PARTS: u64 = 1000;

/// A progress bar. Disappears when dropped.
pub struct Bar(ProgressBar);

impl Bar {
    /// Makes a bar at the start of a stage.
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

    /// Begins the next stage, with this share of the work done.
    pub fn begin(&self, stage: &'static str, share: f64) {
        self.0.set_message(stage);
        self.0.set_position((share * PARTS as f64) as u64);
        // A stage reports nothing until its end; the clock goes on.
        self.0.enable_steady_tick(std::time::Duration::from_millis(250));
    }

    /// Shows how far a simplification is. Never asks to stop.
    pub fn show(&self, progress: multires::simplify::Progress) -> ControlFlow<()> {
        self.share(progress.fraction())
    }

    /// Shows a share of work done, 0 to 1. Never asks to stop.
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
