//! Compressed sections: differences of neighbouring elements, in planes of bits, by LZ4, chunk by chunk.
//!
//! ```text
//!     section   c | length of chunk 0, 1, ... | chunk 0 | chunk 1 | ... | zeros      numbers of 4 bytes, little-endian
//!     chunk     c elements, the last fewer; c is a multiple of 8
//!     scalar    minus the same scalar of the element before (0 before the first of a chunk), as an integer of its width,
//!               wrapping; d becomes 2d, or -2d - 1 if negative, so that small differences of both signs have high bits 0
//!     planes    scalar by scalar, bit by bit from the lowest: that bit of all elements of the chunk, eight a byte, the
//!               first in the lowest bit, and zeros up to a whole byte
//! ```
//!
//! The planes of a chunk are compressed as an LZ4 block. The highest bit of a chunk's length is set if they are stored as they
//! are instead. Most bits that differ at random lie in planes of their own, so that the others are runs of zeros.

use crate::geometry::parallel;

use super::table::MOST_EXPANSION;
use super::{BakeError, Element};

/// Bytes of the elements of a chunk, about.
const CHUNK: usize = 1 << 17;
/// Most bytes of a chunk: the memory for a file's chunk while it is read.
const LARGEST_CHUNK: usize = 1 << 20;
/// Marks the length of a chunk without LZ4.
const RAW: u32 = 1 << 31;

/// Compresses the bytes of elements. The result is shorter than the input, or `None`.
pub(super) fn compress(bytes: &[u8], scalars: &[u8]) -> Option<Vec<u8>> {
    let size: usize = scalars.iter().map(|&width| usize::from(width)).sum();
    let per_chunk = (CHUNK / size).max(8) / 8 * 8;
    let count = bytes.len().div_ceil(per_chunk * size);
    let chunks = parallel::map(count, 1, |chunk| {
        let own = &bytes[chunk * per_chunk * size..];
        let planes = to_planes(&own[..own.len().min(per_chunk * size)], size, scalars);
        let packed = lz4_flex::block::compress(&planes);
        if packed.len() < planes.len() { (0, packed) } else { (RAW, planes) }
    });
    let mut out = (per_chunk as u32).to_le_bytes().to_vec();
    for (mark, chunk) in &chunks {
        out.extend((mark | chunk.len() as u32).to_le_bytes());
    }
    chunks.iter().for_each(|(_, chunk)| out.extend_from_slice(chunk));
    // Readers refuse what expands by more.
    let least = (bytes.len() as u64).div_ceil(MOST_EXPANSION) as usize;
    out.resize(out.len().max(least), 0);
    (out.len() < bytes.len()).then_some(out)
}

/// Decompresses into elements.
pub(super) fn decompress<T: Element>(stored: &[u8], elements: &mut [T]) -> Result<(), BakeError> {
    let damaged = |what: &str| BakeError::damaged(format!("a compressed section: {what}"));
    let size = size_of::<T>();
    let word = |at: usize| {
        let bytes = stored.get(4 * at..4 * at + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let per_chunk = word(0).unwrap_or(0) as usize;
    if per_chunk == 0 || !per_chunk.is_multiple_of(8) || per_chunk > LARGEST_CHUNK / size {
        return Err(damaged("its chunks have no size"));
    }
    let count = elements.len().div_ceil(per_chunk);
    let mut start = 4 * (1 + count);
    if start > stored.len() {
        return Err(damaged("lengths of chunks are missing"));
    }
    let mut chunks = Vec::with_capacity(count);
    for chunk in 0..count {
        let length = word(1 + chunk).unwrap_or(0);
        let end = start + (length & !RAW) as usize;
        let bytes = stored.get(start..end).ok_or_else(|| damaged("a chunk is missing"))?;
        chunks.push((length & RAW != 0, bytes));
        start = end;
    }
    if stored[start..].iter().any(|&byte| byte != 0) {
        return Err(damaged("bytes follow its last chunk"));
    }
    let broken = std::sync::atomic::AtomicBool::new(false);
    parallel::fill_chunks(elements, per_chunk, |(chunk, elements)| {
        let (raw, bytes) = chunks[chunk];
        let own = bytemuck::cast_slice_mut(elements);
        let length = own.len().div_ceil(8 * size) * 8 * size;
        let mut planes = Vec::new();
        let planes = if raw {
            bytes
        } else {
            planes.resize(length, 0);
            match lz4_flex::block::decompress_into(bytes, &mut planes) {
                Ok(found) if found == length => &planes,
                _ => &[][..],
            }
        };
        if planes.len() == length {
            from_planes(planes, own, size, T::SCALARS);
        } else {
            broken.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    });
    if broken.into_inner() { Err(damaged("a chunk is none")) } else { Ok(()) }
}

/// Transposes 8 x 8 bits: bit `i` of byte `j` becomes bit `j` of byte `i`. Hacker's Delight, section 7-3.
fn transpose(mut x: u64) -> u64 {
    for (shift, mask) in
        [(7, 0x00aa_00aa_00aa_00aa), (14, 0x0000_cccc_0000_cccc), (28, 0x0000_0000_f0f0_f0f0)]
    {
        let t = (x ^ (x >> shift)) & mask;
        x ^= t ^ (t << shift);
    }
    x
}

/// Reads a scalar as an integer.
fn load(bytes: &[u8]) -> u64 {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(word)
}

/// Turns the elements of a chunk, little-endian, into planes.
fn to_planes(elements: &[u8], size: usize, scalars: &[u8]) -> Vec<u8> {
    let plane = (elements.len() / size).div_ceil(8);
    let mut planes = vec![0; plane * 8 * size];
    let mut offset = 0;
    for &width in scalars {
        let width = usize::from(width);
        let shift = 64 - 8 * width as u32;
        let planes = &mut planes[plane * 8 * offset..];
        let mut before = 0;
        for (group, elements) in elements.chunks(8 * size).enumerate() {
            let mut differences = [0_u64; 8];
            for (difference, element) in differences.iter_mut().zip(elements.chunks_exact(size)) {
                let own = load(&element[offset..offset + width]);
                // In the highest bits, so that signs are signs.
                let signed = (own.wrapping_sub(before) << shift) as i64;
                *difference = ((signed << 1) ^ (signed >> 63)) as u64 >> shift;
                before = own;
            }
            for byte in 0..width {
                let column = differences.map(|difference| (difference >> (8 * byte)) as u8);
                let bits = transpose(u64::from_le_bytes(column)).to_le_bytes();
                for (bit, bits) in bits.into_iter().enumerate() {
                    planes[(8 * byte + bit) * plane + group] = bits;
                }
            }
        }
        offset += width;
    }
    planes
}

/// Turns planes into the elements of a chunk, in the processor's order.
fn from_planes(planes: &[u8], elements: &mut [u8], size: usize, scalars: &[u8]) {
    let plane = (elements.len() / size).div_ceil(8);
    let mut offset = 0;
    for &width in scalars {
        let own = &planes[plane * 8 * offset..];
        match width {
            1 => scalar_from_planes::<1>(own, plane, elements, size, offset),
            2 => scalar_from_planes::<2>(own, plane, elements, size, offset),
            4 => scalar_from_planes::<4>(own, plane, elements, size, offset),
            _ => scalar_from_planes::<8>(own, plane, elements, size, offset),
        }
        offset += usize::from(width);
    }
    super::layout::to_native(elements, scalars);
}

/// Turns the planes of a scalar of `WIDTH` bytes at an offset in the elements into its values, little-endian.
fn scalar_from_planes<const WIDTH: usize>(
    planes: &[u8],
    plane: usize,
    elements: &mut [u8],
    size: usize,
    offset: usize,
) {
    let bytes: [[&[u8]; 8]; WIDTH] =
        std::array::from_fn(|byte| std::array::from_fn(|bit| &planes[(8 * byte + bit) * plane..][..plane]));
    let mut before = 0_u64;
    for (group, elements) in elements.chunks_mut(8 * size).enumerate() {
        let columns = bytes.map(|bits| {
            let bits = bits.map(|plane| plane[group]);
            transpose(u64::from_le_bytes(bits)).to_le_bytes()
        });
        for (i, element) in elements.chunks_exact_mut(size).enumerate() {
            let mut code = [0; 8];
            code[..WIDTH].copy_from_slice(&columns.map(|column| column[i]));
            let code = u64::from_le_bytes(code);
            // The bytes beyond the width are of no account.
            before = before.wrapping_add((code >> 1) ^ (code & 1).wrapping_neg());
            element[offset..offset + WIDTH].copy_from_slice(&before.to_le_bytes()[..WIDTH]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round_trip<T: Element + PartialEq + std::fmt::Debug>(elements: &[T]) -> usize {
        let bytes: &[u8] = bytemuck::cast_slice(elements);
        let Some(stored) = compress(bytes, T::SCALARS) else { return bytes.len() };
        let mut back = vec![T::zeroed(); elements.len()];
        decompress(&stored, &mut back).expect("a whole section");
        assert_eq!(back, elements);
        stored.len()
    }

    #[test]
    fn elements_come_back() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            state >> 20
        };
        for count in [0, 1, 7, 8, 9, 1000, 40_000] {
            assert!(round_trip::<u32>(&(0..count).collect::<Vec<_>>()) <= 4 * count as usize);
            round_trip::<u8>(&(0..count).map(|i| i as u8).collect::<Vec<_>>());
            round_trip::<u16>(&(0..count).map(|_| random() as u16).collect::<Vec<_>>());
            round_trip::<u64>(&(0..count).map(|_| random() << 21).collect::<Vec<_>>());
            round_trip::<[f32; 3]>(&(0..count).map(|i| [i as f32, -0.0, f32::MIN]).collect::<Vec<_>>());
            let near = |i: u32| [i, i + (random() % 16) as u32, u32::MAX - i];
            round_trip::<[u32; 3]>(&(0..count).map(near).collect::<Vec<_>>());
        }
        assert!(round_trip::<u32>(&(0..1_000_000).collect::<Vec<_>>()) == 125_000);
    }

    #[test]
    fn planes_are_the_bits_of_differences() {
        // Differences 3, -1, 0: codes 6, 1, 0.
        let planes = to_planes(&[3, 2, 2], 1, &[1]);
        assert_eq!(planes, [0b010, 0b001, 0b001, 0, 0, 0, 0, 0]);
    }
}
