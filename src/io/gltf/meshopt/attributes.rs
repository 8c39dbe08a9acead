//! Mode ATTRIBUTES, versions 0 and 1: each byte of an element as a difference from the same byte of the element before.
//!
//! ```text
//!     0xa0 or 0xa1 | block | block | ... | zeros | first element's predecessor | modes of channels (version 1)
//!     block: up to 256 elements     = controls (version 1) | plane of byte 0 | plane of byte 1 | ...
//!     plane: a byte of each element = 2 bits for each group | group | group | ...
//!     group: 16 numbers of 0, 1, 2, 4 or 8 bits; a number of all ones stands for a byte behind the group
//! ```
//!
//! A channel is 4 bytes of an element. Its mode says what the numbers are: differences of bytes, of 16-bit words, or the
//! exclusive or of 32-bit words, turned.

use super::stream::{Bytes, ENDS, Fault, HEADER, parts, unzigzag};

const VERSION_0: u8 = 0xa0;
const VERSION_1: u8 = 0xa1;

/// Elements of a group.
const GROUP: usize = 16;
/// Most elements of a block.
const BLOCK: usize = 256;

/// Bits per number, by the 2 bits of a group.
type Widths = [u8; 4];
const WIDTHS_0: Widths = [0, 2, 4, 8];
const NARROW: Widths = [0, 1, 2, 4];
const WIDE: Widths = [1, 2, 4, 8];

/// The numbers of a channel's bytes.
type Planes = [[u8; BLOCK]; 4];

fn block_elements(stride: usize) -> usize {
    (8192 / stride / GROUP * GROUP).min(BLOCK)
}

fn tail(is_1: bool, stride: usize) -> usize {
    if is_1 { (stride + stride / 4).max(24) } else { stride.max(32) }
}

/// Returns the least number of bytes that a stream of `count` elements has.
pub(super) fn least(stream: &[u8], count: usize, stride: usize) -> usize {
    let (elements, is_1) = (block_elements(stride), stream.first() != Some(&VERSION_0));
    let block = if is_1 { stride / 4 } else { stride * elements.div_ceil(4 * GROUP) };
    (count / elements).saturating_mul(block).saturating_add(1 + tail(is_1, stride))
}

/// Appends the elements of a stream. `stride`: a multiple of 4 from 4 to 256.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize, to: &mut Vec<u8>) -> Result<(), Fault> {
    let is_1 = match stream.first() {
        Some(&VERSION_0) => false,
        Some(&VERSION_1) => true,
        Some(_) => return Err(HEADER),
        None => return Err(ENDS),
    };
    let (_, mut bytes, tail) = parts(stream, tail(is_1, stride))?;
    let channels = stride / 4;
    let (rest, modes) = tail.split_at(tail.len() - if is_1 { channels } else { 0 });
    let kinds = (0..channels).map(|channel| Kind::new(modes.get(channel).copied().unwrap_or(0)));
    let kinds = kinds.collect::<Result<Vec<Kind>, Fault>>()?;
    let mut last = rest[rest.len() - stride..].to_vec();
    let mut planes = [[0; BLOCK]; 4];
    let mut left = count;
    while left > 0 {
        let elements = left.min(block_elements(stride));
        let start = to.len();
        to.resize(start + elements * stride, 0);
        let controls = if is_1 { Some(bytes.take(channels)?) } else { None };
        for (channel, kind) in kinds.iter().enumerate() {
            for (i, plane) in planes.iter_mut().enumerate() {
                let control = controls.map(|controls| controls[channel] >> (2 * i) & 3);
                fill(&mut bytes, control, &mut plane[..elements.next_multiple_of(GROUP)], elements)?;
            }
            let last = &mut last[4 * channel..4 * channel + 4];
            kind.undo(&planes, last, to[start..].chunks_exact_mut(stride).map(|e| &mut e[4 * channel..]));
        }
        left -= elements;
    }
    bytes.end()
}

/// Reads a plane of whole groups.
fn fill(bytes: &mut Bytes, control: Option<u8>, plane: &mut [u8], elements: usize) -> Result<(), Fault> {
    let widths = match control {
        None => WIDTHS_0,
        Some(0) => NARROW,
        Some(1) => WIDE,
        Some(2) => {
            plane.fill(0);
            return Ok(());
        }
        Some(_) => {
            plane[..elements].copy_from_slice(bytes.take(elements)?);
            return Ok(());
        }
    };
    let header = bytes.take((plane.len() / GROUP).div_ceil(4))?;
    for (g, group) in plane.chunks_exact_mut(GROUP).enumerate() {
        match widths[usize::from(header[g / 4] >> (2 * (g % 4)) & 3)] {
            0 => group.fill(0),
            1 => unpack::<1>(bytes, group)?,
            2 => unpack::<2>(bytes, group)?,
            4 => unpack::<4>(bytes, group)?,
            _ => group.copy_from_slice(bytes.take(GROUP)?),
        }
    }
    Ok(())
}

/// Reads a group of numbers of `BITS` bits: single bits from the lowest up, others from the highest down.
fn unpack<const BITS: usize>(bytes: &mut Bytes, group: &mut [u8]) -> Result<(), Fault> {
    let packed = bytes.take(2 * BITS)?;
    let (each, all) = (8 / BITS, u8::MAX >> (8 - BITS));
    for (i, number) in group.iter_mut().enumerate() {
        let place = if BITS == 1 { i % each } else { each - 1 - i % each };
        let found = packed[i / each] >> (BITS * place) & all;
        *number = if found == all { bytes.byte()? } else { found };
    }
    Ok(())
}

/// What the numbers of a channel are.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Bytes,
    Words,
    /// Turned to the left by so many bits.
    Turned(u32),
}

impl Kind {
    fn new(mode: u8) -> Result<Self, Fault> {
        match (mode & 15, mode >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Words),
            (2, turn) => Ok(Self::Turned(turn.into())),
            _ => Err("a channel's mode is not known"),
        }
    }

    /// Turns numbers to the first 4 bytes of each element. `last`: bytes of the element before; becomes the last element.
    fn undo<'a>(self, planes: &Planes, last: &mut [u8], elements: impl Iterator<Item = &'a mut [u8]>) {
        let mut value = u32::from_le_bytes([last[0], last[1], last[2], last[3]]);
        for (e, element) in elements.enumerate() {
            let numbers = [planes[0][e], planes[1][e], planes[2][e], planes[3][e]];
            value = match self {
                Self::Bytes => {
                    let (mut bytes, old) = (numbers, value.to_le_bytes());
                    for (byte, old) in bytes.iter_mut().zip(old) {
                        *byte = old.wrapping_add(unzigzag((*byte).into()) as u8);
                    }
                    u32::from_le_bytes(bytes)
                }
                Self::Words => {
                    let word = |number: u32, old: u32| old.wrapping_add(unzigzag(number)) & 0xffff;
                    let number = u32::from_le_bytes(numbers);
                    word(number & 0xffff, value) | word(number >> 16, value >> 16) << 16
                }
                Self::Turned(turn) => value ^ u32::from_le_bytes(numbers).rotate_right(turn),
            };
            element[..4].copy_from_slice(&value.to_le_bytes());
        }
        last.copy_from_slice(&value.to_le_bytes());
    }
}
