//! Sets of keys on the wire: ascending, as gaps.

use super::coder::{Coder, Number};
use super::error::Damage;

/// Codes an ascending set of keys below `leaves`. A reader passes a slice of as many entries, whatever they hold.
pub(super) fn code_keys<C: Coder>(
    coder: &mut C,
    gaps: &mut Number,
    leaves: u32,
    keys: &mut [u32],
) -> Result<(), Damage> {
    // Gaps are about this long; the bits far below are as good as even.
    let mean = leaves / keys.len().max(1) as u32;
    let low = (32 - mean.leading_zeros()).saturating_sub(3);
    let mut next = 0;
    for key in keys {
        let gap = key.wrapping_sub(next);
        let high = coder.number(gaps, gap >> low)?;
        let rest = coder.raw(low, gap & ((1 << low) - 1))?;
        let gap = high.checked_mul(1 << low).map(|high| high | rest);
        let found = gap.and_then(|gap| next.checked_add(gap)).filter(|&key| key < leaves);
        *key = found.ok_or(Damage("a key is out of range"))?;
        next = *key + 1;
    }
    Ok(())
}
