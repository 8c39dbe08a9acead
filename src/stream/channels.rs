//! The scalars of a vertex as whole numbers, and back: what a vertex is on the wire.
//!
//! ```text
//!     grid     (value - least) / step, rounded     0 to 2^bits - 1; the three of a position share their step
//!     exact    the bits of a float, in the order of floats: as numbers, near values are near
//!     label    the bits of an integer, never mixed
//! ```

use crate::mesh::{Attribute, AttributeValues, Mesh, names};

use super::error::StreamError;

/// One scalar of a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Channel {
    Grid { least: f32, step: f64, bits: u32 },
    Exact,
    Label,
}

/// The sign of a float.
const SIGN: u32 = 1 << 31;

impl Channel {
    /// Returns the number on the wire of a scalar's bits.
    fn number(self, word: u32) -> u32 {
        match self {
            Self::Grid { least, step, bits } => {
                let steps = (f64::from(f32::from_bits(word)) - f64::from(least)) / step;
                // The cast maps values that are not finite to the ends.
                (steps.round() as u32).min(((1_u64 << bits) - 1) as u32)
            }
            Self::Exact if word & SIGN != 0 => !word,
            Self::Exact => word | SIGN,
            Self::Label => word,
        }
    }

    /// Returns the bits of a scalar from its number on the wire.
    pub fn word(self, number: u32) -> u32 {
        match self {
            Self::Grid { least, step, .. } => {
                ((f64::from(least) + step * f64::from(number)) as f32).to_bits()
            }
            Self::Exact if number & SIGN != 0 => number & !SIGN,
            Self::Exact => !number,
            Self::Label => number,
        }
    }

    /// Returns the largest number on the wire.
    pub fn largest(self) -> u32 {
        match self {
            Self::Grid { bits, .. } => ((1_u64 << bits) - 1) as u32,
            Self::Exact | Self::Label => u32::MAX,
        }
    }
}

/// An attribute on the wire: its name, its scalars, and their kind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stream {
    pub name: String,
    pub width: usize,
    /// 0 floats, 1 signed, 2 unsigned integers.
    pub kind: u8,
}

/// All scalars of a vertex: its position and its attributes.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Layout {
    /// The first three are the position.
    pub channels: Vec<Channel>,
    pub streams: Vec<Stream>,
}

/// Returns the least and the largest finite value.
fn range(values: impl Iterator<Item = f32>) -> [f32; 2] {
    let finite = values.filter(|x| x.is_finite());
    let ends =
        finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)]);
    if ends[0] <= ends[1] { ends } else { [0.0; 2] }
}

fn grid([least, most]: [f32; 2], bits: u32) -> Channel {
    let step = (f64::from(most) - f64::from(least)) / ((1_u64 << bits) - 1) as f64;
    Channel::Grid { least, step: if step > 0.0 { step } else { 1.0 }, bits }
}

impl Layout {
    /// Chooses the channels of a mesh's vertices: grids of so many bits, or exact floats.
    pub fn new(vertices: &Mesh, position_bits: Option<u32>, attribute_bits: Option<u32>) -> Self {
        let mut layout = Self::default();
        let axes = [0, 1, 2].map(|axis| range(vertices.positions().iter().map(|p| p[axis])));
        let longest =
            axes.iter().map(|[least, most]| f64::from(*most) - f64::from(*least)).fold(0.0, f64::max);
        layout.channels.extend(axes.map(|[least, _]| match position_bits {
            Some(bits) => match longest / ((1_u64 << bits) - 1) as f64 {
                step if step > 0.0 => Channel::Grid { least, step, bits },
                _ => Channel::Grid { least, step: 1.0, bits },
            },
            None => Channel::Exact,
        }));
        for attribute in vertices.attributes().iter().filter(|attribute| attribute.name() != names::VERTEX) {
            let width = attribute.width();
            let kind = match attribute.values() {
                AttributeValues::Float(_) => 0,
                AttributeValues::Int(_) => 1,
                AttributeValues::Uint(_) => 2,
            };
            layout.channels.extend((0..width).map(|at| match (attribute.as_floats(), attribute_bits) {
                (Some(values), Some(bits)) => {
                    grid(range(values.iter().skip(at).step_by(width).copied()), bits)
                }
                (Some(_), None) => Channel::Exact,
                (None, _) => Channel::Label,
            }));
            layout.streams.push(Stream { name: attribute.name().to_owned(), width, kind });
        }
        layout
    }

    /// Returns the number of scalars.
    pub fn len(&self) -> usize {
        self.channels.len()
    }

    /// Returns the numbers of all vertices, vertex by vertex.
    pub fn numbers(&self, vertices: &Mesh) -> Vec<u32> {
        let attributes: Vec<&Attribute> =
            self.streams.iter().filter_map(|stream| vertices.attribute(&stream.name)).collect();
        let mut numbers = Vec::with_capacity(self.len() * vertices.positions().len());
        for (vertex, position) in (0_u32..).zip(vertices.positions()) {
            let words = position.iter().map(|x| x.to_bits());
            let words = words.chain(attributes.iter().flat_map(|attribute| attribute.words(vertex)).copied());
            numbers.extend(self.channels.iter().zip(words).map(|(channel, word)| channel.number(word)));
        }
        numbers
    }

    /// Makes a mesh of vertices' words, vertex by vertex.
    pub fn mesh(&self, words: &[u32], triangles: Vec<[u32; 3]>) -> Result<Mesh, StreamError> {
        let damaged = |_| StreamError::Damaged { what: "vertices make no mesh" };
        let all = || words.chunks_exact(self.len().max(1));
        let position = |words: &[u32]| [words[0], words[1], words[2]].map(f32::from_bits);
        let mut mesh = Mesh::new(all().map(position).collect::<Vec<_>>(), triangles).map_err(damaged)?;
        let mut first = 3;
        for stream in &self.streams {
            let range = first..first + stream.width;
            let words = all().flat_map(|words| &words[range.clone()]);
            let values = match stream.kind {
                0 => AttributeValues::Float(words.map(|&word| f32::from_bits(word)).collect()),
                1 => AttributeValues::Int(words.map(|&word| word as i32).collect()),
                _ => AttributeValues::Uint(words.copied().collect()),
            };
            mesh = mesh
                .with_attribute(Attribute::new(stream.name.clone(), stream.width, values))
                .map_err(damaged)?;
            first = range.end;
        }
        Ok(mesh)
    }

    /// Returns the bits of a vertex's scalars from its numbers.
    pub fn words<'a>(&'a self, numbers: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        self.channels.iter().zip(numbers).map(|(channel, &number)| channel.word(number))
    }
}
