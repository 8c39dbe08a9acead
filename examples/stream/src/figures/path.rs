//! Triangles, screen error and use of the line along a path: with splits alone the client draws ever more, with collapses too it
//! draws what the view asks for (Southern, Fig. 5.6).

use std::io::Write;
use std::path::Path;

use multires::lod::Lod;
use multires::stream::ClientOptions;

use super::{FRAME, Figures, PIXELS};
use crate::AnyError;
use crate::camera::{Pose, Script, VIEWPORT};
use crate::charts::{BLUE, GREY, Line as Curve, ORANGE, Panel, svg};
use crate::simulated::Simulated;

/// Frames between two points of the chart.
const EVERY: u64 = 4;
/// Microseconds over which the use of the line is taken.
const SECOND: u64 = 1_000_000;

/// Points of a chart: seconds and value.
type Points = Vec<(f64, f64)>;

pub(super) fn make(figures: &Figures, file: &Path, says: &mut impl Write) -> Result<(), AnyError> {
    let ways = [
        ("splits alone", ORANGE, ClientOptions::default().with_keeps(true)),
        ("splits and collapses", BLUE, ClientOptions::default()),
    ];
    let mut curves = [const { Vec::new() }; 3];
    writeln!(
        says,
        "\npath:  bytes  splits  cached  collapses  triangles: mean, last  error px: mean  line busy %: mean"
    )?;
    for (name, colour, options) in ways {
        let (sim, points) = fly(figures, options)?;
        let counts = sim.session().counts();
        let mean = |at: usize| points[at].iter().map(|p| p.1).sum::<f64>() / points[at].len().max(1) as f64;
        writeln!(
            says,
            "{name}: {} {} {} {}  {:.0} {:.0}  {:.2}  {:.0}",
            counts.bytes,
            counts.splits,
            counts.cached,
            counts.collapses,
            mean(0),
            points[0].last().map_or(0.0, |p| p.1),
            mean(1),
            mean(2)
        )?;
        for (curves, points) in curves.iter_mut().zip(points) {
            curves.push(Curve { name, colour, points });
        }
    }
    let [mut triangles, error, busy] = curves;
    triangles.push(Curve { name: "asked for by the view", colour: GREY, points: asked_for(figures)? });
    let panel = |title, unit, most, lines| Panel { title, axes: ["seconds", unit], log: false, most, lines };
    let panels = [
        panel("Triangles drawn", "triangles", None, triangles),
        panel("Screen error, 95th percentile", "pixels", Some(4.0), error),
        panel("Line in use, over the last second", "%", Some(110.0), busy),
    ];
    Ok(std::fs::write(file, svg(&panels, (3, 1), (860, 780))?)?)
}

fn frames() -> u64 {
    (Script::Approach.seconds() * 1e6) as u64 / FRAME
}

fn pose(figures: &Figures, frame: u64) -> Pose {
    Script::Approach.pose(&figures.scene, (frame * FRAME) as f64 / 1e6)
}

/// Flies along the path over the line. Returns points of triangles, screen error and use of the line.
fn fly(figures: &Figures, options: ClientOptions) -> Result<(Simulated, [Points; 3]), AnyError> {
    let mut sim = Simulated::new(&figures.server, options, None, figures.line)?;
    let mut points = [const { Vec::new() }; 3];
    for frame in 0..frames() {
        let pose = pose(figures, frame);
        sim.look(&[pose.view(VIEWPORT, PIXELS)?]);
        sim.run((frame + 1) * FRAME)?;
        if frame % EVERY != EVERY - 1 {
            continue;
        }
        let time = sim.now();
        let mesh = sim.browser().client().to_mesh();
        let values = [
            Some(mesh.triangles().len() as f64),
            figures.errors.measure(&mesh, &pose, VIEWPORT)?,
            Some(100.0 * sim.busy(time.saturating_sub(SECOND), time)),
        ];
        for (points, value) in points.iter_mut().zip(values) {
            points.extend(value.map(|value| (time as f64 / 1e6, value)));
        }
    }
    Ok((sim, points))
}

/// Returns the triangles that each view asks for, from an instance of the whole model.
fn asked_for(figures: &Figures) -> Result<Points, AnyError> {
    let mut local = crate::model::local(&figures.server)?;
    let mut points = Vec::new();
    for frame in 0..frames() {
        let change = local.adapt(&[pose(figures, frame).view(VIEWPORT, PIXELS)?], 0.0);
        if frame % EVERY == EVERY - 1 {
            points.push((((frame + 1) * FRAME) as f64 / 1e6, change.triangles as f64));
        }
    }
    Ok(points)
}
