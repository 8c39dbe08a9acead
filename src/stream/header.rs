//! The first packet of a stream: sizes, materials, and what the scalars of a vertex are.

use super::channels::{Channel, Layout, Stream};
use super::error::Damage;

/// Most scalars of a vertex.
const MOST_CHANNELS: usize = 1 << 10;

/// What a client must know of a model before anything else.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Header {
    pub leaves: u32,
    pub splits: u32,
    /// Triangles at full resolution.
    pub triangles: u32,
    pub base_vertices: u32,
    pub base_triangles: u32,
    /// Places of the cache.
    pub places: u32,
    /// Smallest and largest corner of the box around the model, object units.
    pub extent: [[f32; 3]; 2],
    /// Material ids, one a group of triangles; empty for a single group without a material.
    pub materials: Vec<u32>,
    pub layout: Layout,
}

impl Header {
    pub fn write(&self, out: &mut Vec<u8>) {
        let sizes =
            [self.leaves, self.splits, self.triangles, self.base_vertices, self.base_triangles, self.places];
        sizes.iter().for_each(|size| out.extend(size.to_le_bytes()));
        self.extent.as_flattened().iter().for_each(|x| out.extend(x.to_le_bytes()));
        out.extend((self.materials.len() as u32).to_le_bytes());
        self.materials.iter().for_each(|id| out.extend(id.to_le_bytes()));
        out.extend((self.layout.streams.len() as u32).to_le_bytes());
        for stream in &self.layout.streams {
            out.extend((stream.name.len() as u32).to_le_bytes());
            out.extend(stream.name.as_bytes());
            out.push(stream.kind);
            out.push(stream.width as u8);
        }
        for channel in &self.layout.channels {
            match *channel {
                Channel::Grid { least, step, bits } => {
                    out.push(bits as u8);
                    out.extend(least.to_le_bytes());
                    out.extend(step.to_le_bytes());
                }
                Channel::Exact => out.push(32),
                Channel::Label => out.push(33),
            }
        }
    }

    pub fn read(bytes: &[u8]) -> Result<Self, Damage> {
        let mut bytes = Bytes(bytes);
        let mut header = Self::default();
        let Self { leaves, splits, triangles, base_vertices, base_triangles, places, .. } = &mut header;
        for size in [leaves, splits, triangles, base_vertices, base_triangles, places] {
            *size = bytes.number()?;
        }
        for x in header.extent.as_flattened_mut() {
            *x = f32::from_bits(bytes.number()?);
        }
        let counts_fit = header.base_vertices <= header.leaves
            && (header.base_vertices > 0) == (header.leaves > 0)
            && header.base_triangles <= header.triangles;
        if !counts_fit || !header.extent.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(Damage("the header's sizes do not fit together"));
        }
        // An id takes 4 bytes: more than there are bytes of the rest cannot follow.
        for _ in 0..bytes.count(4)? {
            header.materials.push(bytes.number()?);
        }
        if header.materials.len() > 1 << 16 {
            return Err(Damage("there are too many materials"));
        }
        let mut channels = 3;
        for _ in 0..bytes.count(6)? {
            let length = bytes.count(1)?;
            let name =
                std::str::from_utf8(bytes.take(length)?).map_err(|_| Damage("a name is no text"))?.to_owned();
            let [kind, width] = [bytes.take(1)?[0], bytes.take(1)?[0]];
            if kind > 2 || !(1..=16).contains(&width) {
                return Err(Damage("an attribute has no such kind or width"));
            }
            channels += usize::from(width);
            header.layout.streams.push(Stream { name, width: width.into(), kind });
        }
        if channels > MOST_CHANNELS {
            return Err(Damage("vertices have too many scalars"));
        }
        for _ in 0..channels {
            header.layout.channels.push(match bytes.take(1)?[0] {
                33 => Channel::Label,
                32 => Channel::Exact,
                bits @ 1..32 => {
                    let least = f32::from_bits(bytes.number()?);
                    let step = f64::from_bits(u64::from(bytes.number()?) | u64::from(bytes.number()?) << 32);
                    let channel = Channel::Grid { least, step, bits: bits.into() };
                    let most = f32::from_bits(channel.word(channel.largest()));
                    if !(step > 0.0 && least.is_finite() && most.is_finite()) {
                        return Err(Damage("a grid is not finite"));
                    }
                    channel
                }
                _ => return Err(Damage("a scalar has no such kind")),
            });
        }
        if header.layout.channels[..3].contains(&Channel::Label) {
            return Err(Damage("a position is a label"));
        }
        if bytes.0.is_empty() { Ok(header) } else { Err(Damage("bytes follow the header")) }
    }
}

/// Bytes still to be read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Damage> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Damage("the header is cut"))?;
        self.0 = rest;
        Ok(taken)
    }

    fn number(&mut self) -> Result<u32, Damage> {
        let bytes = self.take(4)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    }

    /// Reads a number of elements of at least so many bytes each.
    fn count(&mut self, size: usize) -> Result<usize, Damage> {
        let count = self.number()? as usize;
        if count > self.0.len() / size { Err(Damage("the header is cut")) } else { Ok(count) }
    }
}
