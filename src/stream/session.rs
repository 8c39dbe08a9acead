//! One client, as its server sees it.

use std::sync::Arc;

use crate::hierarchy::VertexHierarchy;

use super::bits::Bits;
use super::cache::Cache;
use super::coder::{Coder, Writer};
use super::error::{Damage, StreamError};
use super::keys::code_keys;
use super::packet::{self, HEAD, Kind};
use super::plan::{Plan, Wish};
use super::record::{Models, Record, code_base_scalars, code_base_triangle, code_split};
use super::request::Request;
use super::server::Shared;
use super::tables::{Tables, record_of};

/// Bytes of packets that may be on their way before the client acknowledges one. Default of [`Session::set_window`].
const WINDOW: usize = 1 << 16;
/// Default of [`Session::set_most_cache_share`].
const MOST_CACHE_SHARE: f32 = 0.25;
/// Bytes of content that a packet has room for, whatever the budget.
const LEAST_BUDGET: usize = 64;
/// Most bytes of content.
pub(super) const MOST_CONTENT: usize = 1 << 20;

/// What follows in a packet.
pub(super) const END: u32 = 0;
pub(super) const BASE: u32 = 1;
pub(super) const COLLAPSES: u32 = 2;
pub(super) const SPLITS: u32 = 3;

/// Most splits and collapses in a packet, most triangles of splits, and most vertices and triangles of the coarsest mesh each: a
/// few bytes must not keep a client busy for long.
pub(super) const MOST_STEPS: usize = 1 << 16;
pub(super) const MOST_TRIANGLES: usize = 1 << 18;

/// One client of a [`Server`](super::Server): what it has, what it wants to see, and the packets on their way.
///
/// ```text
///     request of the client  ->  receive      every now and then: a new view, an acknowledgement
///     packets to the client  <-  packet       while there are any: collapses of what no view asks for, then splits, coarse first
/// ```
///
/// A new request is heeded at the next packet: nothing of the old view is queued. The client's triangle limit holds after
/// every packet.
#[derive(Debug)]
pub struct Session {
    shared: Arc<Shared>,
    stream: u32,
    has: Bits,
    splits: usize,
    triangles: usize,
    cache: Cache,
    models: Box<Models>,
    wish: Wish,
    /// Base vertices and base triangles sent.
    base: [usize; 2],
    /// Set if there is nothing to do for the wish.
    done: bool,
    /// History of the packets that were acknowledged.
    history: u64,
    /// Number of the next packet; packets sent and not acknowledged; which of them to send again.
    next: u32,
    sent: Vec<Vec<u8>>,
    again: Option<usize>,
    window: usize,
    cache_share: f32,
    most_cache_share: f32,
    /// Bytes that a split of weight 1 takes, about.
    bytes_a_split: f32,
    record: Record,
    counts: SessionCounts,
}

/// What a [`Session`] has sent so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct SessionCounts {
    /// Packets, not counting those sent again.
    pub packets: usize,
    /// Their bytes.
    pub bytes: usize,
    /// Splits with their content.
    pub splits: usize,
    /// Splits that the client had in its cache.
    pub cached: usize,
    /// Collapses.
    pub collapses: usize,
}

impl Session {
    pub(super) fn new(shared: Arc<Shared>) -> Self {
        let models = Box::new(Models::new(shared.channels()));
        let mut session = Self {
            shared,
            stream: 0,
            has: Bits::default(),
            splits: 0,
            triangles: 0,
            cache: Cache::new(0),
            models,
            wish: Wish::default(),
            base: [0; 2],
            done: true,
            history: 0,
            next: 0,
            sent: Vec::new(),
            again: None,
            window: WINDOW,
            cache_share: 0.0,
            most_cache_share: MOST_CACHE_SHARE,
            bytes_a_split: 0.0,
            record: Record::default(),
            counts: SessionCounts::default(),
        };
        session.begin(0);
        session.done = true;
        session
    }

    /// Begins a new stream: the client has nothing that counts, and knows at most a stream of another server.
    fn begin(&mut self, known: u32) {
        self.stream = self.shared.next_stream();
        if self.stream == known {
            self.stream = self.shared.next_stream();
        }
        self.history = 0;
        self.has = Bits::new(self.shared.of().split_count());
        (self.splits, self.triangles, self.base, self.next) = (0, 0, [0; 2], 0);
        *self.models = Models::new(self.shared.channels());
        self.sent.clear();
        self.again = None;
        self.done = false;
        self.bytes_a_split = 4.0 + 2.0 * self.shared.channels() as f32;
    }

    /// Sets the bytes that may be on their way before the client acknowledges a packet; default 65,536. They are kept, to be sent
    /// again if they are lost. A packet alone may be larger.
    pub fn set_window(&mut self, bytes: usize) {
        self.window = bytes;
    }

    /// Sets the largest share of all splits that the cache has places for, whatever the client asks; default 0.25. A place takes
    /// 4 bytes. Heeded where a stream begins; NaN counts as 0.
    pub fn set_most_cache_share(&mut self, share: f32) {
        self.most_cache_share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    }

    /// Takes in a request of the client. A client that has another stream, of this server or of another, begins anew. Damaged
    /// requests change nothing: the client sends more.
    ///
    /// # Errors
    /// The bytes are no request, or ask for packets that the client acknowledged: an old request, which changes nothing.
    pub fn receive(&mut self, request: &[u8]) -> Result<(), StreamError> {
        let request = Request::read(request)?;
        let first = self.next - self.sent.len() as u32;
        // A client that has nothing yet does not know its stream.
        let waits = request.stream == 0 && self.next > 0 && first == 0;
        if (request.stream == self.stream || waits) && request.next < first {
            return Err(StreamError::Damaged { what: "a client asks for packets that it acknowledged" });
        }
        // Other servers number their streams alike: only what came tells a stream.
        let acknowledged = (request.next.wrapping_sub(first)) as usize;
        let came = self.sent.get(..acknowledged);
        let history =
            came.map(|came| came.iter().fold(self.history, |before, next| packet::history(before, next)));
        if request.stream != self.stream && !waits || history != Some(request.history) {
            let known = request.stream;
            self.begin(known);
            self.cache_share = request.cache_share;
            self.heed(request);
            return Ok(());
        }
        self.history = request.history;
        self.sent.drain(..acknowledged);
        self.again = match self.again {
            _ if request.missing && !self.sent.is_empty() => Some(0),
            Some(at) => Some(at.saturating_sub(acknowledged)).filter(|&at| at < self.sent.len()),
            None => None,
        };
        self.heed(request);
        Ok(())
    }

    fn heed(&mut self, request: Request) {
        if request.wish != self.wish {
            self.wish = request.wish;
            self.done = false;
        }
    }

    /// Returns the next packet, of at most about `budget` bytes, or `None` if there is nothing to send: the client has all that
    /// its views ask for, or must first acknowledge what is on its way. The first packet of a stream, the header, may be larger.
    /// Another may exceed the budget by a split or so. O(splits of the client + splits asked for).
    pub fn packet(&mut self, budget: usize) -> Option<Vec<u8>> {
        if let Some(at) = self.again {
            self.again = Some(at + 1).filter(|&next| next < self.sent.len());
            return self.sent.get(at).cloned();
        }
        let waiting: usize = self.sent.iter().map(Vec::len).sum();
        if self.done || waiting >= self.window {
            return None;
        }
        let mut packet = packet::start(Kind::Packet, self.stream, self.next);
        let room = budget.saturating_sub(HEAD).clamp(LEAST_BUDGET, MOST_CONTENT);
        if self.next == 0 {
            let share = self.cache_share.min(self.most_cache_share);
            let places = (f64::from(share) * self.shared.of().split_count() as f64).ceil() as u32;
            let header = super::header::Header { places, ..self.shared.header.clone() };
            self.cache = Cache::new(places as usize);
            header.write(&mut packet);
        } else {
            let mut writer = Writer::default();
            // Writing never fails: what is written is within the ranges that a reader checks.
            let wrote = self.write(&mut writer, room).and_then(|wrote| {
                writer.raw(2, END)?;
                Ok(wrote)
            });
            if !wrote.unwrap_or(false) {
                self.done = true;
                return None;
            }
            writer.finish(&mut packet);
        }
        packet::finish(&mut packet);
        self.next += 1;
        self.counts.packets += 1;
        self.counts.bytes += packet.len();
        self.sent.push(packet.clone());
        Some(packet)
    }

    /// Writes what comes next. Returns whether anything was written.
    fn write(&mut self, writer: &mut Writer, room: usize) -> Result<bool, Damage> {
        let mut wrote = false;
        let header = &self.shared.header;
        if self.base != [header.base_vertices as usize, header.base_triangles as usize] {
            self.write_base(writer, room)?;
            let header = &self.shared.header;
            let complete = self.base == [header.base_vertices as usize, header.base_triangles as usize];
            if !complete || writer.len() >= room {
                return Ok(true);
            }
            wrote = true;
        }
        let mut plan = self.shared.take_plan();
        plan.make(self.shared.of(), &self.has, &self.wish);
        let result = self.write_plan(writer, room, &plan);
        self.shared.give_plan(plan);
        Ok(result? || wrote)
    }

    /// Writes the coarsest mesh, as much of it as fits.
    fn write_base(&mut self, writer: &mut Writer, room: usize) -> Result<(), Damage> {
        let shared = Arc::clone(&self.shared);
        let (of, tables, header) = (shared.of(), &shared.tables, &shared.header);
        let channels = shared.channels();
        let numbers = |vertex: u32| &shared.numbers[vertex as usize * channels..][..channels];
        writer.raw(2, BASE)?;
        // As many as surely fit, or a few.
        let share =
            |each: usize, writer: &Writer| (room.saturating_sub(writer.len()) / each).clamp(16, MOST_STEPS);
        let [first, _] = self.base;
        let last = tables.base.len().min(first + share(5 + 4 * channels, writer));
        writer.raw(24, (last - first) as u32)?;
        let mut keys: Vec<u32> =
            tables.base[first..last].iter().map(|&vertex| of.first_leaf(vertex)).collect();
        let start = first.checked_sub(1).map_or(0, |before| of.first_leaf(tables.base[before]) + 1);
        keys.iter_mut().for_each(|key| *key -= start);
        code_keys(writer, &mut self.models.gaps, header.leaves - start, &mut keys)?;
        for at in first..last {
            let before = at.checked_sub(1).map_or(&[][..], |before| numbers(tables.base[before]));
            let mut own = numbers(tables.base[at]).to_vec();
            code_base_scalars(writer, &mut self.models, &header.layout, before, &mut own)?;
        }
        self.base[0] = last;
        let first = self.base[1];
        let mut end = first;
        if last == tables.base.len() {
            end = of.base_triangle_count().min(first + share(20, writer));
        }
        writer.raw(24, (end - first) as u32)?;
        let runs: Vec<[u32; 2]> = tables
            .base
            .iter()
            .map(|&vertex| tables.base_run(of, vertex))
            .map(|run| [run.start, run.end])
            .collect();
        let mut before = [0; 3];
        for triangle in first..end {
            let mut leaves = of.triangles()[triangle];
            code_base_triangle(writer, &mut self.models, &runs, &mut before, &mut leaves)?;
            if header.materials.len() > 1 {
                writer.below(header.materials.len() as u32, of.group_of(triangle as u32) as u32)?;
            }
        }
        self.base[1] = end;
        self.triangles = end;
        Ok(())
    }

    /// Writes steps of a plan until the room is spent. Returns whether anything was written.
    fn write_plan(&mut self, writer: &mut Writer, room: usize, plan: &Plan) -> Result<bool, Damage> {
        let (mut count, mut triangles) = (0, 0);
        for (kind, steps, levels) in
            [(COLLAPSES, &plan.collapses, &plan.collapse_levels), (SPLITS, &plan.splits, &plan.split_levels)]
        {
            let mut at = 0;
            for &end in levels {
                while at < end {
                    let left = room.saturating_sub(writer.len());
                    if count > 0 && left == 0 || count >= MOST_STEPS || triangles >= MOST_TRIANGLES / 2 {
                        return Ok(true);
                    }
                    // A set of as many as fit: sent in the order of their keys, which costs less.
                    let each = if kind == SPLITS { self.bytes_a_split } else { 2.0 };
                    let fit = ((left as f32 / each) as usize).max(1);
                    let mut set = &steps[at..end.min(at + fit.min(MOST_STEPS - count))];
                    if kind == SPLITS {
                        let mut weight = 0;
                        let light = |split: &&u32| {
                            weight += self.shared.weight(**split);
                            weight <= fit
                        };
                        let light = set.iter().take_while(light).count();
                        // A split that brings a whole component goes alone, in a packet of its own.
                        if light == 0 && count > 0 {
                            return Ok(true);
                        }
                        set = &set[..light.max(1)];
                        let mut room = MOST_TRIANGLES - triangles;
                        let fits = |split: &&u32| {
                            let owned = self.shared.of().owned(**split).len();
                            room.checked_sub(owned).map(|left| room = left).is_some()
                        };
                        set = &set[..set.iter().take_while(fits).count()];
                        triangles = MOST_TRIANGLES - room;
                    }
                    let before = writer.len();
                    writer.raw(2, kind)?;
                    let sent = match kind {
                        SPLITS => self.write_splits(writer, set)?,
                        _ => self.write_collapses(writer, set)?,
                    };
                    if kind == SPLITS && sent >= 16 {
                        let bytes = (writer.len() - before) as f32 / sent as f32;
                        self.bytes_a_split = 0.5 * self.bytes_a_split + 0.5 * bytes.max(0.5);
                    }
                    at += set.len();
                    count += set.len();
                }
            }
        }
        Ok(count > 0)
    }

    fn keys(&mut self, writer: &mut Writer, set: &[u32]) -> Result<Vec<(u32, u32)>, Damage> {
        let of = self.shared.of();
        let mut keyed: Vec<(u32, u32)> = set.iter().map(|&split| (Tables::key(of, split), split)).collect();
        keyed.sort_unstable();
        let mut keys: Vec<u32> = keyed.iter().map(|(key, _)| *key).collect();
        writer.raw(24, keys.len() as u32)?;
        code_keys(writer, &mut self.models.gaps, of.leaf_count() as u32, &mut keys)?;
        Ok(keyed)
    }

    /// Writes splits that do not build on each other. Returns the weight of the splits that were sent with their content.
    fn write_splits(&mut self, writer: &mut Writer, set: &[u32]) -> Result<usize, Damage> {
        let keyed = self.keys(writer, set)?;
        let shared = Arc::clone(&self.shared);
        let groups = shared.header.materials.len().max(1);
        let (mut sent, mut weight) = (0, 0);
        for (key, split) in keyed {
            if self.cache.take(key) {
                self.counts.cached += 1;
            } else {
                record_of(shared.of(), &shared.numbers, shared.channels(), split, &mut self.record);
                let mesh = shared.mesh(&self.has);
                code_split(writer, &mut self.models, &mesh, &shared.header.layout, groups, &mut self.record)?;
                weight += shared.weight(split);
                sent += 1;
            }
            self.has.add(split);
            self.triangles += shared.of().owned(split).len();
        }
        self.splits += set.len();
        self.counts.splits += sent;
        Ok(weight)
    }

    fn write_collapses(&mut self, writer: &mut Writer, set: &[u32]) -> Result<usize, Damage> {
        let of = |session: &Self| Arc::clone(&session.shared);
        for (key, split) in self.keys(writer, set)? {
            let shared = of(self);
            let of: &VertexHierarchy = shared.of();
            if Tables::is_keyed(of, split) {
                self.cache.put(key);
            }
            self.has.remove(split);
            self.triangles -= of.owned(split).len();
        }
        self.splits -= set.len();
        self.counts.collapses += set.len();
        Ok(set.len())
    }

    /// Returns the number of the stream: what requests of a client that knows the stream begin with ([`stream_of`](super::stream_of)).
    pub fn stream(&self) -> u32 {
        self.stream
    }

    /// Whether the client has been sent all that its last request asks for.
    pub fn is_done(&self) -> bool {
        self.done && self.again.is_none()
    }

    /// Returns the number of triangles that the client draws once all packets have come.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Returns the number of splits that the client has once all packets have come.
    pub fn splits(&self) -> usize {
        self.splits
    }

    /// Returns what was sent so far.
    pub fn counts(&self) -> SessionCounts {
        self.counts
    }

    /// Returns the bytes of this session: what it keeps between packets, without what it shares.
    pub fn memory(&self) -> usize {
        let sent: usize = self.sent.iter().map(Vec::len).sum();
        size_of::<Self>() + self.has.memory() + self.cache.memory() + self.models.memory() + sent
    }
}
