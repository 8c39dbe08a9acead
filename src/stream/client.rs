//! What a client draws of a model that lies elsewhere.

use std::collections::BTreeMap;

use crate::adapt::{Change, DirtyRanges};
use crate::lod::{Draws, Lod, LodError, LodOptions, Uploads, Vertex, VertexBuffer};
use crate::mesh::{Mesh, NONE};
use crate::view::ObjectView;

use super::cache::Cache;
use super::coder::{Coder, Reader};
use super::error::{Damage, StreamError};
use super::header::Header;
use super::keys::code_keys;
use super::packet::{self, Kind};
use super::plan::Wish;
use super::received::Received;
use super::record::{Models, Record, code_base_scalars, code_base_triangle, code_split};
use super::request::Request;
use super::session::{BASE, COLLAPSES, END, MOST_STEPS, MOST_TRIANGLES, SPLITS};
use super::values::DrawnValues;

/// Options of a [`Client`]. Defaults: a cache of 5 % of all splits, at most 2^24 vertices and triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClientOptions {
    /// Share of all splits kept after they went, so that they come back without their content; 0 to 1. Default 0.05. The server
    /// may grant less ([`Session::set_most_cache_share`](super::Session::set_most_cache_share)).
    pub cache_share: f32,
    /// Whether splits that no view asks for any more stay, while [`LodOptions::triangles`] does not limit them. Default false.
    pub keeps: bool,
    /// Most vertices, and most triangles, that this side takes from a server. Default 16,777,216.
    pub most: usize,
}

impl Default for ClientOptions {
    fn default() -> Self {
        Self { cache_share: 0.05, keeps: false, most: 1 << 24 }
    }
}

impl ClientOptions {
    /// Sets the share of all splits kept after they went.
    #[must_use]
    pub fn with_cache_share(mut self, share: f32) -> Self {
        self.cache_share = share;
        self
    }

    /// Sets whether splits that no view asks for any more stay.
    #[must_use]
    pub fn with_keeps(mut self, keeps: bool) -> Self {
        self.keeps = keeps;
        self
    }

    /// Sets the most vertices, and the most triangles, that this side takes.
    #[must_use]
    pub fn with_most(mut self, count: usize) -> Self {
        self.most = count;
        self
    }
}

/// A vertex that arrived.
#[derive(Debug, Clone, Copy)]
pub struct StreamVertex<'a> {
    pub(super) words: &'a [u32],
    pub(super) header: &'a Header,
}

impl StreamVertex<'_> {
    /// Returns the position, object units.
    pub fn position(&self) -> [f32; 3] {
        self.floats(0)
    }

    /// Returns a float attribute by its name; `None` if there is none of this name and width.
    pub fn attribute<const WIDTH: usize>(&self, name: &str) -> Option<[f32; WIDTH]> {
        self.find(name, true, WIDTH).map(|first| self.floats(first))
    }

    /// Returns an attribute of integers by its name, as bits; `None` if there is none of this name and width.
    pub fn integers<const WIDTH: usize>(&self, name: &str) -> Option<[u32; WIDTH]> {
        self.find(name, false, WIDTH).map(|first| std::array::from_fn(|at| self.words[first + at]))
    }

    fn floats<const WIDTH: usize>(&self, first: usize) -> [f32; WIDTH] {
        std::array::from_fn(|at| f32::from_bits(self.words[first + at]))
    }

    fn find(&self, name: &str, floats: bool, width: usize) -> Option<usize> {
        let mut first = 3;
        for stream in &self.header.layout.streams {
            if stream.name == name {
                return (stream.width == width && floats == (stream.kind == 0)).then_some(first);
            }
            first += stream.width;
        }
        None
    }
}

/// What [`Client::receive`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Receipt {
    /// Set if the packet had come before: nothing has changed.
    pub repeated: bool,
    /// Splits made.
    pub splits: usize,
    /// Splits among them that were in the cache.
    pub cached: usize,
    /// Splits undone.
    pub collapses: usize,
}

/// A drawn instance of a model that a [`Server`](super::Server) sends.
///
/// Has no model of its own: the coarsest mesh comes first, then the splits that its views ask for. After every packet it is a
/// valid mesh. It is drawn as every [`Lod`]; [`adapt`](Lod::adapt) says what is wanted, [`request`](Client::request) tells the server,
/// [`receive`](Client::receive) takes in what comes. After the last packet for a view the triangles and vertices are those that a
/// local instance of [`Server::model`](super::Server::model) draws.
///
/// Vertices come without geomorphs. Of [`LodOptions`], only the limit of triangles counts; the server keeps it.
#[derive(Clone)]
pub struct Client<V, F> {
    options: ClientOptions,
    lod_options: LodOptions,
    factor: f32,
    views: Vec<ObjectView>,
    stream: u32,
    /// Number of the next packet.
    next: u32,
    missing: bool,
    /// History of the packets that came.
    history: u64,
    /// The request that the server was sent last: its stream, packet and wish.
    told: Option<(u32, u32, Wish)>,
    header: Header,
    received: Received,
    cache: Cache,
    /// The splits in the cache.
    cached: BTreeMap<u32, Record>,
    models: Box<Models>,
    /// Runs of the coarsest vertices.
    base: Vec<[u32; 2]>,
    base_triangles: usize,
    record: Record,
    values: DrawnValues<V, F>,
}

impl<V: Vertex, F: FnMut(StreamVertex<'_>) -> V> Client<V, F> {
    /// Creates a client without a mesh. `make` makes the vertices to be drawn of those that arrive. Options out of their ranges
    /// count as the nearest legal value.
    pub fn new(options: ClientOptions, make: F) -> Self {
        let share = if options.cache_share >= 0.0 { options.cache_share.min(1.0) } else { 0.0 };
        Self {
            options: options.with_cache_share(share),
            lod_options: LodOptions::default().with_buffer(VertexBuffer::Packed),
            factor: 1.0,
            views: Vec::new(),
            stream: 0,
            next: 0,
            missing: false,
            history: 0,
            told: None,
            header: Header::default(),
            received: Received::new(0, 1, 3),
            cache: Cache::new(0),
            cached: BTreeMap::new(),
            models: Box::new(Models::new(3)),
            base: Vec::new(),
            base_triangles: 0,
            record: Record::default(),
            values: DrawnValues::new(make),
        }
    }

    /// Returns a request to be sent to the server: what the last [`adapt`](Lod::adapt) wants to see, and which packets have come. Send it
    /// whenever [`has_request`](Client::has_request) holds, and again if no answer comes.
    pub fn request(&mut self) -> Vec<u8> {
        let wish = self.wish();
        let request = Request {
            stream: self.stream,
            next: self.next,
            missing: self.missing,
            cache_share: self.options.cache_share,
            history: self.history,
            wish: wish.clone(),
        };
        self.missing = false;
        self.told = Some((self.stream, self.next, wish));
        request.write()
    }

    /// Whether the server should be told something: another view, packets that came, or packets that are missing.
    pub fn has_request(&self) -> bool {
        self.missing
            || self.told.as_ref().is_none_or(|(stream, next, wish)| {
                (*stream, *next) != (self.stream, self.next) || *wish != self.wish()
            })
    }

    /// Asks for all packets that have not come, with the next request: after a time without an answer, or on a new connection.
    pub fn ask_again(&mut self) {
        self.missing = true;
    }

    fn wish(&self) -> Wish {
        let factor = f64::from(self.factor);
        Wish {
            views: self.views.iter().map(|view| view.coarsened(factor)).collect(),
            triangles: self.lod_options.triangles.unwrap_or(usize::MAX),
            keeps: self.options.keeps,
        }
    }

    /// Takes in a packet of the server.
    ///
    /// # Errors
    /// - [`StreamError::NoMessage`], [`StreamError::Missing`]: the packet is damaged, or others are missing before it. Nothing has
    ///   changed, and the next request asks for what is missing.
    /// - [`StreamError::Damaged`], [`StreamError::TooLarge`]: the server does not keep to the format, or sends more than this client
    ///   takes. The client is empty again, and its next request begins anew.
    pub fn receive(&mut self, packet: &[u8]) -> Result<Receipt, StreamError> {
        let frame = match packet::open(Kind::Packet, packet) {
            Ok(frame) => frame,
            Err(error) => {
                self.missing = true;
                return Err(error);
            }
        };
        if frame.stream != self.stream {
            if frame.number != 0 {
                self.missing = true;
                return Err(StreamError::Missing { expected: 0, found: frame.number });
            }
            self.empty();
            let result = self.begin(frame.content);
            if result.is_ok() {
                (self.stream, self.next) = (frame.stream, 1);
                self.history = packet::history(0, packet);
            }
            return result.map(|()| Receipt::default());
        }
        if frame.number < self.next {
            return Ok(Receipt { repeated: true, ..Receipt::default() });
        }
        if frame.number > self.next {
            self.missing = true;
            return Err(StreamError::Missing { expected: self.next, found: frame.number });
        }
        let receipt = self.take_in(frame.content);
        match receipt {
            Ok(_) => {
                self.next += 1;
                self.history = packet::history(self.history, packet);
            }
            Err(_) => self.empty(),
        }
        self.write_vertices();
        receipt
    }

    /// Forgets the mesh.
    fn empty(&mut self) {
        (self.stream, self.next, self.history, self.told) = (0, 0, 0, None);
        self.header = Header::default();
        self.received = Received::new(0, 1, 3);
        self.cache = Cache::new(0);
        self.cached.clear();
        self.base.clear();
        self.base_triangles = 0;
        self.values.clear();
    }

    fn begin(&mut self, content: &[u8]) -> Result<(), StreamError> {
        let header = Header::read(content)?;
        let most = self.options.most;
        if header.leaves as usize > most || header.triangles as usize > most {
            return Err(StreamError::TooLarge { what: "vertices or triangles" });
        }
        let places = (f64::from(self.options.cache_share) * f64::from(header.splits)).ceil();
        if header.places as f64 > places || header.splits / 2 > header.leaves {
            return Err(StreamError::Damaged { what: "the cache is larger than asked for" });
        }
        self.received = Received::new(header.leaves, header.materials.len().max(1), header.layout.len());
        self.cache = Cache::new(header.places as usize);
        *self.models = Models::new(header.layout.len());
        self.header = header;
        Ok(())
    }

    fn take_in(&mut self, content: &[u8]) -> Result<Receipt, StreamError> {
        let mut reader = Reader::new(content)?;
        let mut receipt = Receipt::default();
        let (mut steps, mut triangles) = (0, 0);
        loop {
            let kind = reader.raw(2, 0)?;
            let complete = self.base_triangles == self.header.base_triangles as usize
                && self.base.len() == self.header.base_vertices as usize;
            match kind {
                END => break,
                BASE if !complete => self.take_base(&mut reader)?,
                COLLAPSES | SPLITS if complete => {
                    let count = reader.raw(24, 0)? as usize;
                    steps += count;
                    if count == 0 || steps > MOST_STEPS {
                        return Err(StreamError::Damaged { what: "a set is empty or too large" });
                    }
                    let mut keys = vec![0; count];
                    code_keys(&mut reader, &mut self.models.gaps, self.header.leaves, &mut keys)?;
                    for key in keys {
                        if kind == COLLAPSES {
                            let mut record = Record::default();
                            if self.received.collapse(key, &mut record)? {
                                self.cached.insert(key, record);
                                if let Some(oldest) = self.cache.put(key) {
                                    self.cached.remove(&oldest);
                                }
                            }
                            receipt.collapses += 1;
                            continue;
                        }
                        if self.cache.take(key) {
                            let record =
                                self.cached.remove(&key).ok_or(Damage("the cache has lost a split"))?;
                            self.received.split(&record)?;
                            receipt.cached += 1;
                        } else {
                            self.record.start(key);
                            let Self { models, received, header, record, .. } = self;
                            let groups = header.materials.len().max(1);
                            code_split(&mut reader, models, received, &header.layout, groups, record)?;
                            triangles += record.triangles.len();
                            if triangles > MOST_TRIANGLES {
                                return Err(StreamError::Damaged { what: "a packet has too many triangles" });
                            }
                            received.split(record)?;
                        }
                        receipt.splits += 1;
                    }
                    if self.received.vertices() > self.options.most.saturating_mul(3)
                        || self.received.surface.triangle_count() > self.options.most
                    {
                        return Err(StreamError::TooLarge { what: "vertices or triangles" });
                    }
                }
                _ => return Err(StreamError::Damaged { what: "a packet comes out of turn" }),
            }
        }
        Ok(receipt)
    }

    /// Takes in a part of the coarsest mesh.
    fn take_base(&mut self, reader: &mut Reader) -> Result<(), StreamError> {
        let Self { header, models, received, base, record, .. } = self;
        let count = reader.raw(24, 0)? as usize;
        let left = header.base_vertices as usize - base.len();
        if count > left || count > MOST_STEPS {
            return Err(StreamError::Damaged { what: "there are too many coarsest vertices" });
        }
        let start = base.last().map_or(0, |run| run[0] + 1);
        let mut firsts = vec![0; count];
        code_keys(reader, &mut models.gaps, header.leaves - start, &mut firsts)?;
        for first in firsts {
            let first = start + first;
            if base.is_empty() && first != 0 {
                return Err(StreamError::Damaged { what: "the first leaf is of no vertex" });
            }
            let before = std::mem::take(&mut record.numbers);
            record.numbers.resize(header.layout.len(), 0);
            let before = if base.is_empty() { &[][..] } else { &before };
            code_base_scalars(reader, models, &header.layout, before, &mut record.numbers)?;
            received.add_base_vertex(first, &record.numbers);
            if let Some(last) = base.last_mut() {
                last[1] = first;
            }
            base.push([first, header.leaves]);
        }
        let count = reader.raw(24, 0)? as usize;
        let left = header.base_triangles as usize - self.base_triangles;
        if count > left || count > MOST_STEPS || count > 0 && base.len() < header.base_vertices as usize {
            return Err(StreamError::Damaged { what: "there are too many coarsest triangles" });
        }
        let mut before = [0; 3];
        for _ in 0..count {
            let mut leaves = [0; 3];
            code_base_triangle(reader, models, base, &mut before, &mut leaves)?;
            let group = match header.materials.len() {
                groups @ 2.. => reader.below(groups as u32, 0)? as u16,
                _ => 0,
            };
            received.add_base_triangle(leaves, group)?;
        }
        self.base_triangles += count;
        Ok(())
    }

    /// Makes the vertices of slots that were written.
    fn write_vertices(&mut self) {
        let Self { header, received, values, .. } = self;
        let scalars =
            |vertex: u32, words: &mut Vec<u32>| words.extend(header.layout.words(received.numbers(vertex)));
        values.write(&received.surface, header, scalars);
    }

    /// Returns the number of the stream, 0 before its first packet.
    pub fn stream(&self) -> u32 {
        self.stream
    }

    /// Returns the number of triangles of the model at full resolution; 0 before the first packet.
    pub fn full_triangles(&self) -> usize {
        self.header.triangles as usize
    }

    /// Whether the mesh is the full resolution.
    pub fn is_complete(&self) -> bool {
        self.stream != 0
            && self.base_triangles == self.header.base_triangles as usize
            && self.base.len() == self.header.base_vertices as usize
            && self.received.splits() == self.header.splits as usize
    }

    /// Returns the smallest and largest corner of the box around the model, object units; `None` before the first packet.
    pub fn bounds(&self) -> Option<[[f32; 3]; 2]> {
        (self.stream != 0).then_some(self.header.extent)
    }

    /// Returns the drawn vertices, by slot.
    pub fn values(&self) -> &[V] {
        self.values.all()
    }
}

impl<V: Vertex, F: FnMut(StreamVertex<'_>) -> V + Send> Lod for Client<V, F> {
    /// Notes the views for the next request. The mesh changes as packets come.
    fn adapt(&mut self, views: &[ObjectView], _: f32) -> Change {
        self.views.clear();
        self.views.extend_from_slice(&views[..views.len().min(super::request::MOST_VIEWS)]);
        Change { triangles: self.received.surface.triangle_count(), ..Change::default() }
    }

    /// Does nothing but count: what has not arrived cannot be drawn.
    fn refine_fully(&mut self) -> Change {
        Change { triangles: self.received.surface.triangle_count(), ..Change::default() }
    }

    fn settle(&mut self) {}

    fn options(&self) -> &LodOptions {
        &self.lod_options
    }

    fn set_options(&mut self, options: &LodOptions) -> Result<(), LodError> {
        self.lod_options = LodOptions::default().with_buffer(VertexBuffer::Packed);
        self.lod_options.triangles = options.triangles;
        Ok(())
    }

    fn tolerance_factor(&self) -> f32 {
        self.factor
    }

    fn set_tolerance_factor(&mut self, factor: f32) {
        if factor > 0.0 && factor.is_finite() {
            self.factor = factor;
        }
    }

    fn refinements(&self) -> usize {
        self.received.splits()
    }

    fn groups(&self) -> usize {
        self.received.surface.groups()
    }

    fn material(&self, group: usize) -> u32 {
        self.header.materials.get(group).copied().unwrap_or(NONE)
    }

    fn triangles(&self, group: usize) -> &[[u32; 3]] {
        self.received.surface.triangles(group)
    }

    /// Returns names of the vertices in the slots: numbers of this client's own.
    fn vertices(&self) -> Option<&[u32]> {
        self.received.surface.vertices()
    }

    fn vertex_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.values.all())
    }

    fn vertex_size(&self) -> usize {
        size_of::<V>()
    }

    fn shares_vertices(&self) -> bool {
        false
    }

    fn dirty_triangles(&self, group: usize, gap: usize) -> DirtyRanges<'_> {
        self.received.surface.dirty_triangles(group, gap)
    }

    fn dirty_vertices(&self, gap: usize) -> DirtyRanges<'_> {
        self.received.surface.dirty_vertices(gap)
    }

    fn uploads(&self) -> Uploads<'_> {
        Uploads::new(self)
    }

    fn draws(&self) -> Draws<'_> {
        Draws::new(self)
    }

    fn clean(&mut self) {
        self.received.surface.clean();
    }

    fn invalidate(&mut self) {
        self.received.surface.invalidate();
        self.received.surface.invalidate_vertices();
    }

    /// Returns the drawn triangles with all attributes, vertices in the order of the model.
    fn to_mesh(&self) -> Mesh {
        self.received.to_mesh(&self.header).unwrap_or_default()
    }

    fn memory(&self) -> usize {
        let records: usize = self.cached.values().map(Record::memory).sum();
        self.received.memory()
            + records
            + self.cache.memory()
            + self.models.memory()
            + size_of_val(self.values.all())
    }
}
