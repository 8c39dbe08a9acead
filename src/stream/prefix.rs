//! A model as bytes of which every beginning is a coarser mesh: a progressive mesh as a file.
//!
//! ```text
//!     | header | coarsest mesh | splits, largest errors first, in packets that grow ...          |
//!                              ^ cut here or anywhere: what is whole before the cut is a mesh
//! ```
//!
//! The packets of a session whose client wants everything, more triangles at a time. Packets are small at first and up to an
//! eighth of what is before them later, so that a cut costs little.

use crate::hierarchy::VertexHierarchy;
use crate::lod::{Baked, Lod, LodOptions};
use crate::mesh::Mesh;
use crate::view::{Focus, ObjectView, View};

use super::client::{Client, ClientOptions, StreamVertex};
use super::error::StreamError;
use super::packet::{self, message_length};
use super::plan::Wish;
use super::request::Request;
use super::server::{Server, StreamOptions};

/// Least and most bytes of a packet.
const PACKETS: [usize; 2] = [256, 1 << 14];
/// Ratio of triangles from one step of the order to the next.
const STEP: f64 = 1.1;

/// What a beginning of a [`write_prefix`] file holds.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Prefix {
    /// The mesh, with all attributes and materials: vertices in the order of the model.
    pub mesh: Mesh,
    /// Bytes that were used. Those behind belong to a packet that is cut.
    pub bytes: usize,
    /// Whether this is the full resolution.
    pub complete: bool,
}

/// Returns a view that needs everything, larger errors first.
fn everything() -> Option<ObjectView> {
    let identity: [[f32; 4]; 4] =
        std::array::from_fn(|row| std::array::from_fn(|column| f32::from(u8::from(row == column))));
    let view = View::from_projection(identity, identity, [2, 2]).ok()?;
    let all = Focus { centre: [0.0; 3], radius: f32::MAX };
    Some(
        view.with_frustum(false)
            .with_back_faces_culled(false)
            .with_tolerance_px(0.0)
            .with_focus(Some(all))
            .of_world(),
    )
}

/// Writes a model so that every beginning of the bytes is a coarser mesh, attributes included. O(n log n) a packet: all that is
/// left is looked at for each.
///
/// ```
/// use multires::stream::{StreamOptions, read_prefix, write_prefix};
/// use multires::{Structure, hierarchy::VertexHierarchy, mesh::shapes};
///
/// let mesh = shapes::prop(4);
/// let model = VertexHierarchy::bake(&mesh)?;
/// let bytes = write_prefix(&model, &StreamOptions::default())?;
/// let half = read_prefix(&bytes[..bytes.len() / 2])?;
/// assert!(!half.complete && half.mesh.triangles().len() > 10);
/// assert!(read_prefix(&bytes)?.complete);
/// # Ok::<(), multires::Error>(())
/// ```
///
/// # Errors
/// As [`Server::new`].
pub fn write_prefix(model: &Baked<VertexHierarchy>, options: &StreamOptions) -> Result<Vec<u8>, StreamError> {
    let server = Server::new(model, options)?;
    let mut session = server.session();
    session.set_window(usize::MAX);
    let full = model.structure().triangle_count();
    let mut bytes = Vec::new();
    let mut most = model.structure().base_triangle_count();
    let (mut stream, mut next, mut history) = (0, 0, 0);
    loop {
        let triangles = if most < full { most } else { usize::MAX };
        let wish = Wish { views: everything().into_iter().collect(), triangles, keeps: false };
        session.receive(&Request { stream, next, history, wish, ..Request::default() }.write())?;
        stream = session.stream();
        loop {
            let budget = (bytes.len() / 8).clamp(PACKETS[0], PACKETS[1]);
            let Some(packet) = session.packet(budget) else { break };
            bytes.extend_from_slice(&packet);
            history = packet::history(history, &packet);
            next += 1;
        }
        if triangles == usize::MAX {
            return Ok(bytes);
        }
        most = ((most as f64 * STEP) as usize).max(most + 8);
    }
}

/// Reads a beginning of the bytes of [`write_prefix`], or all of them. Empty bytes, or the header alone, are an empty mesh.
///
/// # Errors
/// The bytes are of no such file, or are damaged.
pub fn read_prefix(bytes: &[u8]) -> Result<Prefix, StreamError> {
    let make = |vertex: StreamVertex<'_>| vertex.position();
    let mut client = Client::new(ClientOptions::default().with_cache_share(0.0).with_most(usize::MAX), make);
    client.set_options(&LodOptions::default()).ok();
    let mut at = 0;
    while let Some(length) = message_length(&bytes[at..])? {
        let Some(packet) = bytes.get(at..at + length) else { break };
        client.receive(packet)?;
        client.clean();
        at += length;
    }
    Ok(Prefix { mesh: client.to_mesh(), bytes: at, complete: client.is_complete() })
}
