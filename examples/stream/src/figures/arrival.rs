//! A model at moments after the first request: what is seen while bytes come.

use std::io::Write;
use std::path::Path;

use multires::lod::Lod;
use multires::stream::ClientOptions;

use super::{FRAME, Figures, PIXELS};
use crate::AnyError;
use crate::camera::{Script, VIEWPORT};
use crate::pictures;
use crate::simulated::Simulated;

/// Moments of the pictures, milliseconds.
const MOMENTS: [u64; 6] = [200, 300, 500, 1_000, 2_000, 4_000];
/// Moment of the script at which the camera stands still, seconds: on the orbit, the detail in front.
const STANDS: f64 = 8.0;

pub(super) fn make(figures: &Figures, file: &Path, says: &mut impl Write) -> Result<(), AnyError> {
    let mut sim = Simulated::new(&figures.server, ClientOptions::default(), None, figures.line)?;
    let pose = Script::Approach.pose(&figures.scene, STANDS);
    let view = pose.view(VIEWPORT, PIXELS)?;
    let mut pictures = Vec::new();
    writeln!(says, "\narrival:  ms  bytes  triangles  error px")?;
    for moment in MOMENTS {
        while sim.now() < moment * 1_000 {
            sim.look(std::slice::from_ref(&view));
            sim.run(sim.now() + FRAME)?;
        }
        let mesh = sim.browser().client().to_mesh();
        let (bytes, triangles) = (sim.browser().received().bytes, mesh.triangles().len());
        let error = figures.errors.measure(&mesh, &pose, VIEWPORT)?.unwrap_or(f64::NAN);
        writeln!(says, "{moment:>12} {bytes:>6} {triangles:>10} {error:>9.2}")?;
        let seconds = moment as f64 / 1e3;
        let caption = format!("{seconds} s   {bytes} bytes   {triangles} triangles");
        pictures.push((pictures::draw(&mesh, &pose, [400, 280], 0.6)?, caption));
    }
    writeln!(says, "the line is silent: {}", sim.session().is_done())?;
    pictures::write(file, &pictures, 3)
}
