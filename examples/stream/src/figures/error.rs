//! Bytes a view against screen error: with every view anew, with coherence between views, and with a cache too.

use std::io::Write;
use std::path::Path;

use multires::lod::Lod;
use multires::stream::ClientOptions;

use super::{Figures, PIXELS, exchange};
use crate::AnyError;
use crate::browser::positions;
use crate::camera::{Pose, Script, VIEWPORT};
use crate::charts::{BLUE, GREEN, Line as Curve, ORANGE, Panel, svg};

/// Seconds of the script between two views.
const STEP: f64 = 0.5;
/// Bytes that a view may take.
const BUDGETS: [usize; 9] = [250, 500, 1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 64_000];
/// Most pixels that a view counts with, and the pixels of a view without a mesh.
const MOST: f64 = 100.0;

/// A way to follow the camera.
struct Way {
    name: &'static str,
    colour: plotters::style::RGBColor,
    /// Begins a new stream for every view.
    anew: bool,
    options: ClientOptions,
}

pub(super) fn make(figures: &Figures, file: &Path, says: &mut impl Write) -> Result<(), AnyError> {
    let none = ClientOptions::default().with_cache_share(0.0);
    let cache = ClientOptions::default();
    let ways = [
        Way { name: "every view anew", colour: ORANGE, anew: true, options: none },
        Way { name: "coherence", colour: BLUE, anew: false, options: none },
        Way { name: "coherence and a cache of 5 %", colour: GREEN, anew: false, options: cache },
    ];
    let count = (Script::Approach.seconds() / STEP) as usize;
    let poses: Vec<Pose> =
        (0..count).map(|at| Script::Approach.pose(&figures.scene, at as f64 * STEP)).collect();
    let mut lines = Vec::new();
    writeln!(says, "\nbytes a view, {count} views:  limit  bytes  error px")?;
    for way in ways {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for budget in BUDGETS {
            let point = follow(figures, &way, &poses, budget)?;
            writeln!(says, "{}: {budget} {:.0} {:.2}", way.name, point.0, point.1)?;
            // A higher limit changes nothing once all that is asked for comes.
            if points.last().is_none_or(|last| point.0 > 1.01 * last.0) {
                points.push(point);
            }
        }
        lines.push(Curve { name: way.name, colour: way.colour, points });
    }
    let panel = Panel {
        title: "Screen error, 95th percentile, mean of all views",
        axes: ["bytes a view, mean", "pixels"],
        log: true,
        most: None,
        lines,
    };
    Ok(std::fs::write(file, svg(&[panel], (1, 1), (860, 380))?)?)
}

/// Follows the camera with at most about `budget` bytes for each view. Returns the mean bytes and the mean screen error.
fn follow(figures: &Figures, way: &Way, poses: &[Pose], budget: usize) -> Result<(f64, f64), AnyError> {
    let begin = || (figures.server.session(), positions(way.options));
    let (mut session, mut client) = begin();
    let (mut bytes, mut errors) = (0, 0.0);
    for pose in poses {
        if way.anew {
            (session, client) = begin();
        }
        client.adapt(&[pose.view(VIEWPORT, PIXELS)?], 0.0);
        bytes += exchange(&mut session, &mut client, budget)?;
        let error = figures.errors.measure(&client.to_mesh(), pose, VIEWPORT)?;
        errors += error.unwrap_or(MOST).min(MOST);
    }
    Ok((bytes as f64 / poses.len() as f64, errors / poses.len() as f64))
}
