//! Hashes identical on every machine: to group, to shuffle and to jitter.

/// Multiplies and folds the halves: every input bit reaches every output bit.
#[cfg(any(feature = "quality", feature = "stream"))]
#[inline]
pub(crate) fn mix(x: u64) -> u64 {
    let product = u128::from(x ^ 0x9e37_79b9_7f4a_7c15) * 0xd6e8_feb8_6659_fd93_u128;
    (product as u64) ^ (product >> 64) as u64
}

/// Hashes several words, in order.
#[cfg(feature = "quality")]
pub(crate) fn words<const N: usize>(words: [u64; N]) -> u64 {
    words.into_iter().fold(0, |hash, word| mix(hash ^ word.wrapping_mul(0xa076_1d64_78bd_642f)))
}

/// Returns a number in 0..1 from a seed and an index.
#[cfg(feature = "quality")]
pub(crate) fn unit(seed: u64, index: u64) -> f64 {
    (words([seed, index]) >> 11) as f64 / (1u64 << 53) as f64
}
