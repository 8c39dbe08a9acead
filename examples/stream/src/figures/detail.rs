//! A detail at three limits of triangles (Southern, Fig. 5.8): the surface and the triangles as the camera sees them, and the
//! triangles from further away, where the rest of the model is coarse.

use std::io::Write;
use std::path::Path;

use multires::lod::{Lod, LodOptions};
use multires::stream::ClientOptions;

use super::{Figures, PACKET, PIXELS};
use crate::AnyError;
use crate::browser::{positions, triangles};
use crate::camera::{Script, VIEWPORT};
use crate::pictures;

/// Limits of triangles.
const LIMITS: [usize; 3] = [1_000, 1_500, 2_000];
/// Tolerance, pixels: the view asks for more than any limit.
const FINE: f32 = 0.25 * PIXELS;
/// Distance of the eye for the pictures from further away, in distances of the camera.
const BACK: f64 = 4.0;
/// Pixels of a picture.
const PICTURE: [usize; 2] = [400, 260];

pub(super) fn make(figures: &Figures, file: &Path, says: &mut impl Write) -> Result<(), AnyError> {
    let pose = Script::Detail.pose(&figures.scene, 0.0);
    let far = pose.back(BACK);
    let view = pose.view(VIEWPORT, FINE)?;
    let mut rows = [const { Vec::new() }; 3];
    writeln!(says, "\ndetail:  limit  triangles  most after any packet  bytes  error px")?;
    for limit in LIMITS {
        let (mut session, mut client) = (figures.server.session(), positions(ClientOptions::default()));
        client.set_options(&LodOptions::default().with_triangles(limit))?;
        client.adapt(std::slice::from_ref(&view), 0.0);
        let (mut bytes, mut most) = (0, 0);
        loop {
            session.receive(&client.request())?;
            let Some(packet) = session.packet(PACKET) else { break };
            client.receive(&packet)?;
            client.clean();
            bytes += packet.len();
            most = most.max(triangles(&client));
        }
        let mesh = client.to_mesh();
        let count = mesh.triangles().len();
        let error = figures.errors.measure(&mesh, &pose, VIEWPORT)?.unwrap_or(f64::NAN);
        writeln!(says, "{limit} {count} {most} {bytes} {error:.2}")?;
        let captions = [
            format!("limit {limit}   {bytes} bytes"),
            format!("{count} triangles"),
            "from further away".to_owned(),
        ];
        let looks = [(&pose, 0.0), (&pose, 0.8), (&far, 0.6)];
        for ((row, (pose, edges)), caption) in rows.iter_mut().zip(looks).zip(captions) {
            row.push((pictures::draw(&mesh, pose, PICTURE, edges)?, caption));
        }
    }
    pictures::write(file, &rows.into_iter().flatten().collect::<Vec<_>>(), LIMITS.len())
}
