//! The scalars of an array's elements: files are little-endian, processors need not be.

use bytemuck::Pod;

/// A type of an array's elements: plain data.
pub trait Element: Pod + Send + Sync {
    /// Widths of the scalars of an element in order, bytes.
    const SCALARS: &'static [u8];
}

macro_rules! elements {
    ($($element:ty: $scalars:expr),+ $(,)?) => {
        $(impl Element for $element { const SCALARS: &'static [u8] = &$scalars; })+
    };
}

elements! {
    u8: [1], u16: [2], u32: [4], u64: [8], f32: [4], f64: [8],
    [u32; 2]: [4; 2], [u32; 3]: [4; 3], [f32; 3]: [4; 3],
}

/// Reverses the bytes of every scalar.
pub(super) fn swap(bytes: &mut [u8], scalars: &[u8]) {
    let size = scalars.iter().map(|&width| usize::from(width)).sum();
    for element in bytes.chunks_exact_mut(size) {
        let mut rest = element;
        for &width in scalars {
            let (scalar, after) = rest.split_at_mut(usize::from(width));
            scalar.reverse();
            rest = after;
        }
    }
}

/// Turns bytes of the file's order into the processor's, or back.
pub(super) fn to_native(bytes: &mut [u8], scalars: &[u8]) {
    if cfg!(target_endian = "big") {
        swap(bytes, scalars);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scalars_are_swapped_each_by_itself() {
        let mut bytes = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14];
        swap(&mut bytes, &[4, 2, 1]);
        assert_eq!(bytes, [4, 3, 2, 1, 6, 5, 7, 11, 10, 9, 8, 13, 12, 14]);
    }
}
