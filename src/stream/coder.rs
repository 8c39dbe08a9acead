//! Coding of bits and numbers by adaptive models. One trait writes and reads, so that a format is a single text.
//!
//! ```text
//!     number   0 | 1 | 2 3 | 4 5 6 7 | 8 ...     length in bits, by a tree of bits; then the bits below the highest:
//!                                               the first two by models, the rest as they are
//! ```
//!
//! The range coder is `constriction`'s. Models learn as they go, on both sides alike.

use std::borrow::Borrow;
use std::num::NonZeroU16;

use constriction::backends::Cursor;
use constriction::stream::model::{DecoderModel, EncoderModel, EntropyModel};
use constriction::stream::queue::{RangeDecoder, RangeEncoder};
use constriction::stream::{Decode, Encode};

use super::error::Damage;

/// Bits of a probability.
const PRECISION: usize = 16;
/// Least share of either value of a bit, in 2^16ths.
const LEAST: u16 = 64;
/// Slowest rates of learning of the two estimates, as shifts.
const SLOWEST: [u8; 2] = [4, 7];

/// Probability that a bit is 0, learnt from the bits before: the mean of a quick and a slow estimate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bit {
    zero: [u16; 2],
    seen: u8,
}

impl Default for Bit {
    fn default() -> Self {
        Self { zero: [1 << 15; 2], seen: 1 }
    }
}

impl Bit {
    fn zero(&self) -> u16 {
        let [quick, slow] = self.zero;
        (quick / 2 + slow / 2).clamp(LEAST, u16::MAX - LEAST)
    }

    fn learn(&mut self, bit: bool) {
        let target = if bit { 0 } else { i32::from(u16::MAX) };
        for (zero, slowest) in self.zero.iter_mut().zip(SLOWEST) {
            // The first bits teach most.
            let shift = self.seen.min(slowest);
            *zero = (i32::from(*zero) + ((target - i32::from(*zero)) >> shift)) as u16;
        }
        self.seen = self.seen.saturating_add(1);
    }
}

/// A bit as `constriction` sees it.
#[derive(Clone, Copy)]
struct Binary(u16);

impl Binary {
    fn part(self, bit: bool) -> (u16, NonZeroU16) {
        let size = if bit { 0_u16.wrapping_sub(self.0) } else { self.0 };
        (if bit { self.0 } else { 0 }, NonZeroU16::new(size).unwrap_or(NonZeroU16::MIN))
    }
}

impl EntropyModel<PRECISION> for Binary {
    type Symbol = bool;
    type Probability = u16;
}

impl EncoderModel<PRECISION> for Binary {
    fn left_cumulative_and_probability(&self, symbol: impl Borrow<bool>) -> Option<(u16, NonZeroU16)> {
        Some(self.part(*symbol.borrow()))
    }
}

impl DecoderModel<PRECISION> for Binary {
    fn quantile_function(&self, quantile: u16) -> (bool, u16, NonZeroU16) {
        let bit = quantile >= self.0;
        let (left, size) = self.part(bit);
        (bit, left, size)
    }
}

/// Equally likely numbers below a limit of at most 2^12.
#[derive(Clone, Copy)]
struct Even(u32);

impl Even {
    fn part(self, symbol: u32) -> Option<(u16, NonZeroU16)> {
        let at = |symbol: u32| (symbol << PRECISION) / self.0;
        let (left, right) = (at(symbol), at(symbol + 1));
        Some((left as u16, NonZeroU16::new((right - left) as u16)?))
    }
}

impl EntropyModel<PRECISION> for Even {
    type Symbol = u32;
    type Probability = u16;
}

impl EncoderModel<PRECISION> for Even {
    fn left_cumulative_and_probability(&self, symbol: impl Borrow<u32>) -> Option<(u16, NonZeroU16)> {
        Some(*symbol.borrow()).filter(|&symbol| symbol < self.0).and_then(|symbol| self.part(symbol))
    }
}

impl DecoderModel<PRECISION> for Even {
    fn quantile_function(&self, quantile: u16) -> (u32, u16, NonZeroU16) {
        let symbol = ((u32::from(quantile) + 1) * self.0 - 1) >> PRECISION;
        let (left, size) = self.part(symbol).unwrap_or((0, NonZeroU16::MIN));
        (symbol, left, size)
    }
}

/// Writes or reads. A writer returns what it is given; a reader ignores it, and returns what it reads.
pub(super) trait Coder {
    /// Whether values are read.
    const READS: bool;

    /// Codes a bit of a probability in 2^16ths that it is 0.
    fn binary(&mut self, zero: u16, bit: bool) -> Result<bool, Damage>;

    /// Codes one of `limit` equally likely numbers; `limit` is 2 to 2^12.
    fn even(&mut self, limit: u32, value: u32) -> Result<u32, Damage>;

    /// Codes a bit.
    fn bit(&mut self, model: &mut Bit, bit: bool) -> Result<bool, Damage> {
        let bit = self.binary(model.zero(), bit)?;
        model.learn(bit);
        Ok(bit)
    }

    /// Codes the lowest `bits` bits of a number as they are.
    fn raw(&mut self, bits: u32, value: u32) -> Result<u32, Damage> {
        let mut result = 0;
        let mut done = 0;
        while done < bits {
            let next = (bits - done).min(12);
            let part = self.even(1 << next, value >> done & ((1 << next) - 1))?;
            result |= part << done;
            done += next;
        }
        Ok(result)
    }

    /// Codes one of `limit` equally likely numbers from 0 on. Nothing is written for a limit of 1 or less.
    fn below(&mut self, limit: u32, value: u32) -> Result<u32, Damage> {
        if limit <= 1 {
            return Ok(0);
        }
        let shift = (32 - (limit - 1).leading_zeros()).saturating_sub(12);
        let low = self.raw(shift, value)?;
        let high = match (limit - 1) >> shift {
            0 => 0,
            last => self.even(last + 1, value >> shift)?,
        };
        let value = high << shift | low & ((1 << shift) - 1);
        if value < limit { Ok(value) } else { Err(Damage("a number is out of range")) }
    }

    /// Codes a number.
    fn number(&mut self, model: &mut Number, value: u32) -> Result<u32, Damage> {
        let length = 32 - value.leading_zeros();
        let mut node = 1;
        for level in (0..6).rev() {
            let bit = self.bit(&mut model.lengths[node], length >> level & 1 == 1)?;
            node = 2 * node + usize::from(bit);
        }
        let length = node as u32 - 64;
        if length > 32 {
            return Err(Damage("a number is too long"));
        }
        if length <= 1 {
            return Ok(length);
        }
        let [first, second @ ..] = &mut model.bits[length as usize];
        let rest = length - 2;
        let high = self.bit(first, value >> rest & 1 == 1)?;
        let mut result = 2 | u32::from(high);
        if rest == 0 {
            return Ok(result);
        }
        let rest = rest - 1;
        let next = self.bit(&mut second[usize::from(high)], value >> rest & 1 == 1)?;
        result = result << 1 | u32::from(next);
        Ok(if rest == 0 { result } else { result << rest | self.raw(rest, value & ((1 << rest) - 1))? })
    }

    /// Codes a number with a sign, of a magnitude within 32 bits.
    fn signed(&mut self, model: &mut Signed, value: i64) -> Result<i64, Damage> {
        let size = self.number(&mut model.size, value.unsigned_abs() as u32)?;
        if size == 0 {
            return Ok(0);
        }
        let negative = self.bit(&mut model.sign, value < 0)?;
        Ok(if negative { -i64::from(size) } else { i64::from(size) })
    }
}

/// Model of a number. Per length: the bit behind the highest, and the bit behind this one, for either value.
#[derive(Debug, Clone)]
pub(super) struct Number {
    lengths: [Bit; 64],
    bits: [[Bit; 3]; 33],
}

impl Default for Number {
    fn default() -> Self {
        Self { lengths: [Bit::default(); 64], bits: [[Bit::default(); 3]; 33] }
    }
}

/// Model of a number with a sign.
#[derive(Debug, Clone, Default)]
pub(super) struct Signed {
    size: Number,
    sign: Bit,
}

/// Writes bits.
#[derive(Default)]
pub(super) struct Writer(RangeEncoder<u32, u64>);

impl Writer {
    /// Returns about how many bytes were written.
    pub fn len(&self) -> usize {
        4 * self.0.num_words()
    }

    /// Appends the bytes written.
    pub fn finish(self, out: &mut Vec<u8>) {
        // Writing to a vector never fails.
        let words = self.0.into_compressed().unwrap_or_default();
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }
}

impl Coder for Writer {
    const READS: bool = false;

    fn binary(&mut self, zero: u16, bit: bool) -> Result<bool, Damage> {
        self.0.encode_symbol(bit, Binary(zero)).map_err(|_| Damage("a bit cannot be written"))?;
        Ok(bit)
    }

    fn even(&mut self, limit: u32, value: u32) -> Result<u32, Damage> {
        self.0.encode_symbol(value, Even(limit)).map_err(|_| Damage("a number cannot be written"))?;
        Ok(value)
    }
}

/// Reads bits. Past the end of the bytes, bits are arbitrary.
pub(super) struct Reader(RangeDecoder<u32, u64, Cursor<u32, Vec<u32>>>);

impl Reader {
    /// Starts at the first of the bytes; their number must be a multiple of 4.
    pub fn new(bytes: &[u8]) -> Result<Self, Damage> {
        let words = bytes.chunks_exact(4);
        if !words.remainder().is_empty() {
            return Err(Damage("the content is no whole number of words"));
        }
        let words: Vec<u32> =
            words.map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
        // A cursor over a vector never fails.
        RangeDecoder::from_compressed(words).map(Self).map_err(|_| Damage("the content cannot be read"))
    }
}

impl Coder for Reader {
    const READS: bool = true;

    fn binary(&mut self, zero: u16, _: bool) -> Result<bool, Damage> {
        self.0.decode_symbol(Binary(zero)).map_err(|_| Damage("the content is no code"))
    }

    fn even(&mut self, limit: u32, _: u32) -> Result<u32, Damage> {
        self.0.decode_symbol(Even(limit)).map_err(|_| Damage("the content is no code"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes numbers of all lengths in every way, written or read.
    fn code<C: Coder>(coder: &mut C, numbers: &mut [u32]) -> Result<(), Damage> {
        let (mut model, mut signed, mut flag) = (Number::default(), Signed::default(), Bit::default());
        for number in numbers {
            let value = coder.number(&mut model, *number)?;
            assert_eq!(coder.raw(32, *number)?, value);
            assert_eq!(coder.below(u32::MAX, value.min(u32::MAX - 1))?, value.min(u32::MAX - 1));
            assert_eq!(
                coder.below(value % 9000 + 1, value % 7 % (value % 9000 + 1))?,
                value % 7 % (value % 9000 + 1)
            );
            assert_eq!(coder.signed(&mut signed, -i64::from(value))?, -i64::from(value));
            assert_eq!(coder.bit(&mut flag, value % 3 == 0)?, value % 3 == 0);
            *number = value;
        }
        Ok(())
    }

    #[test]
    fn what_is_written_is_read() {
        let mut numbers: Vec<u32> =
            (0..32).flat_map(|bits| [(1 << bits) - 1, 1 << bits, (1 << bits) + 1]).collect();
        numbers.push(u32::MAX);
        let mut writer = Writer::default();
        code(&mut writer, &mut numbers.clone()).expect("written");
        let mut bytes = Vec::new();
        writer.finish(&mut bytes);
        let mut read = vec![0; numbers.len()];
        code(&mut Reader::new(&bytes).expect("words"), &mut read).expect("read");
        assert_eq!(read, numbers);
    }

    #[test]
    fn equal_numbers_cost_next_to_nothing() {
        let mut writer = Writer::default();
        let mut model = Number::default();
        for _ in 0..10_000 {
            writer.number(&mut model, 5).expect("written");
        }
        assert!(writer.len() < 250, "{}", writer.len());
    }
}
