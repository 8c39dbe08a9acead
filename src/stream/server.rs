//! A model that is sent: shared by all its sessions.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::hierarchy::VertexHierarchy;
use crate::lod::Baked;

use super::channels::Layout;
use super::error::StreamError;
use super::header::Header;
use super::plan::Plan;
use super::record::{MOST_BROUGHT, MOST_OWNED};
use super::session::Session;
use super::tables::{SetMesh, Tables};

/// Options of a [`Server`]. Defaults: positions of 16 bits, attributes of 12.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct StreamOptions {
    /// Bits of each coordinate of a position, 1 to 31: a grid over the model's box, of cubes. `None` sends floats exactly.
    /// Default 16: half a step is at most 1/131,070 of the longest side.
    pub position_bits: Option<u32>,
    /// Bits of each scalar of a float attribute, 1 to 31: a grid between its least and its largest value. `None` sends floats
    /// exactly. Integers are always exact. Default 12.
    pub attribute_bits: Option<u32>,
}

impl Default for StreamOptions {
    fn default() -> Self {
        Self { position_bits: Some(16), attribute_bits: Some(12) }
    }
}

impl StreamOptions {
    /// Returns options by which everything arrives bit for bit.
    pub fn exact() -> Self {
        Self { position_bits: None, attribute_bits: None }
    }

    /// Sets the bits of each coordinate of a position; `None` for exact floats.
    #[must_use]
    pub fn with_position_bits(mut self, bits: Option<u32>) -> Self {
        self.position_bits = bits;
        self
    }

    /// Sets the bits of each scalar of a float attribute; `None` for exact floats.
    #[must_use]
    pub fn with_attribute_bits(mut self, bits: Option<u32>) -> Self {
        self.attribute_bits = bits;
        self
    }

    /// Checks the options.
    pub(super) fn check(&self) -> Result<(), StreamError> {
        let options = [("position_bits", self.position_bits), ("attribute_bits", self.attribute_bits)];
        for (option, bits) in options {
            if let Some(bits) = bits.filter(|bits| !(1..32).contains(bits)) {
                return Err(StreamError::OutOfRange { option, value: bits.into(), expected: "1 to 31" });
            }
        }
        Ok(())
    }
}

/// A model to be sent to any number of clients. Immutable; clones share everything.
///
/// Takes about 80 bytes a vertex besides the model. Bytes in, bytes out: sockets are the application's.
///
/// ```
/// use multires::prelude::*;
/// use multires::stream::{Client, ClientOptions, Server, StreamOptions};
/// use multires::{mesh::shapes, view::look_at};
///
/// let model = VertexHierarchy::bake(&shapes::rock(2_000, 1))?;
/// let server = Server::new(&model, &StreamOptions::default())?;
/// let mut session = server.session(); // one for each connection
/// let mut client = Client::new(ClientOptions::default(), |vertex| vertex.position());
///
/// let camera = look_at([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
/// let view = View::perspective(camera, 1.0, [1920, 1080])?.of_world();
/// client.adapt(&[view], 0.0);
/// session.receive(&client.request())?; // over the line
/// while let Some(packet) = session.packet(4_096) {
///     client.receive(&packet)?; // over the line; a valid mesh after every packet
/// }
/// assert!(client.triangles(0).len() > 100);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Server(Arc<Shared>);

/// What all sessions of a model share.
#[derive(Debug)]
pub(super) struct Shared {
    pub model: Baked<VertexHierarchy>,
    pub tables: Tables,
    /// Numbers of all vertices' scalars.
    pub numbers: Vec<u32>,
    pub header: Header,
    /// Number of the last stream.
    streams: AtomicU32,
    /// Plans not in use: as many as sessions ever were at work at once.
    plans: Mutex<Vec<Plan>>,
}

impl Shared {
    pub fn of(&self) -> &VertexHierarchy {
        self.model.structure()
    }

    pub fn channels(&self) -> usize {
        self.header.layout.len()
    }

    /// Returns how much a split counts for the bytes of a packet: 1 for one vertex and two triangles, and more for a split that
    /// brings more, up to whole components.
    pub fn weight(&self, split: u32) -> usize {
        self.of().owned(split).len().div_ceil(2).max(self.of().brings(split).len())
    }

    /// Returns a number that no stream has had.
    pub fn next_stream(&self) -> u32 {
        self.streams.fetch_add(1, Ordering::Relaxed).wrapping_add(1).max(1)
    }

    /// Returns a plan to work with.
    pub fn take_plan(&self) -> Plan {
        let free = self.plans.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| Plan::new(self.of().split_count()))
    }

    /// Gives a plan back.
    pub fn give_plan(&self, plan: Plan) {
        self.plans.lock().unwrap_or_else(PoisonError::into_inner).push(plan);
    }

    /// Returns the mesh of a client with some splits.
    pub fn mesh<'a>(&'a self, has: &'a super::bits::Bits) -> SetMesh<'a> {
        let (of, tables, numbers) = (self.of(), &self.tables, &self.numbers[..]);
        SetMesh { of, tables, numbers, channels: self.channels(), has }
    }
}

impl Server {
    /// Prepares a model for sending. O(n). The attribute [`VERTEX`](crate::mesh::names::VERTEX) is not sent.
    ///
    /// # Errors
    /// An option is out of its range; a split brings more vertices or triangles than a packet holds (4,096 and 65,536).
    pub fn new(model: &Baked<VertexHierarchy>, options: &StreamOptions) -> Result<Self, StreamError> {
        options.check()?;
        let of = &**model.structure();
        for split in 0..of.split_count() as u32 {
            if of.brings(split).len() > MOST_BROUGHT as usize {
                return Err(StreamError::TooLarge { what: "vertices of a split" });
            }
            if of.owned(split).len() > MOST_OWNED as usize {
                return Err(StreamError::TooLarge { what: "triangles of a split" });
            }
        }
        let vertices = model.vertices();
        let layout = Layout::new(vertices, options.position_bits, options.attribute_bits);
        let numbers = layout.numbers(vertices);
        let tables = Tables::new(of);
        let header = Header {
            leaves: of.leaf_count() as u32,
            splits: of.split_count() as u32,
            triangles: of.triangle_count() as u32,
            base_vertices: tables.base.len() as u32,
            base_triangles: of.base_triangle_count() as u32,
            places: 0,
            extent: model.bounds().unwrap_or_default(),
            materials: of.materials().to_vec(),
            layout,
        };
        let words: Vec<u32> =
            numbers.chunks_exact(header.layout.len()).flat_map(|n| header.layout.words(n)).collect();
        // The vertices of a model are a mesh; rounded, they still are.
        let sent =
            header.layout.mesh(&words, Vec::new())?.with_material_names(vertices.material_names().to_vec());
        let model = model.with_vertices(sent);
        Ok(Self(Arc::new(Shared {
            model,
            tables,
            numbers,
            header,
            streams: AtomicU32::new(0),
            plans: Mutex::default(),
        })))
    }

    /// Returns the model as clients get it: the same structure, with all scalars rounded to their bits. What a client draws for a
    /// view is what an instance of this model draws.
    pub fn model(&self) -> &Baked<VertexHierarchy> {
        &self.0.model
    }

    /// Creates a session: one for each connected client. Takes 1 bit a split, a cache of the size that its client asks for, and
    /// the packets that its client has not acknowledged.
    pub fn session(&self) -> Session {
        Session::new(Arc::clone(&self.0))
    }

    /// Returns the bytes of what sessions share, without the model.
    pub fn memory(&self) -> usize {
        self.0.tables.memory() + size_of_val(&self.0.numbers[..])
    }
}
