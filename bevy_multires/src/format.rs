//! Vertex formats: a Bevy attribute as 32-bit scalars of multires and back, bit for bit, and selections of vertices.
//!
//! | Bevy's format | scalars | so that |
//! |---|---|---|
//! | `Float32` | the floats | they can be weighed and blended |
//! | `Uint8` to `Uint32`, `Sint8` to `Sint32` | the integers, widened | labels are only copied |
//! | `Unorm*`, `Snorm*` | the floats that a shader reads | colours and normals can be weighed |
//! | `Float16` | the floats; the bits where one is not a number | no payload of a NaN is lost |
//! | `Float64` | two words each | no bit is lost |

use bevy::mesh::{VertexAttributeValues as Values, VertexFormat};
use half::f16;
use multires::mesh::AttributeValues;

/// How the scalars of a format are stored in 32 bits.
trait Code<T> {
    /// Returns 32-bit scalars.
    fn encode(values: &[T]) -> AttributeValues;
    /// Returns the values of 32-bit scalars; `None` if their type is another, or if one does not fit.
    fn decode(scalars: &AttributeValues) -> Option<Vec<T>>;
}

/// 32-bit floats.
struct Floats;
/// Unsigned integers.
struct Unsigned;
/// Signed integers.
struct Signed;
/// Integers standing for 0 to 1, or -1 to 1.
struct Shares;
/// 16-bit floats.
struct Halves;
/// 64-bit floats.
struct Doubles;

impl Code<f32> for Floats {
    fn encode(values: &[f32]) -> AttributeValues {
        AttributeValues::Float(values.to_vec())
    }

    fn decode(scalars: &AttributeValues) -> Option<Vec<f32>> {
        match scalars {
            AttributeValues::Float(values) => Some(values.clone()),
            _ => None,
        }
    }
}

impl<T: Copy + Into<u32> + TryFrom<u32>> Code<T> for Unsigned {
    fn encode(values: &[T]) -> AttributeValues {
        AttributeValues::Uint(values.iter().map(|&value| value.into()).collect())
    }

    fn decode(scalars: &AttributeValues) -> Option<Vec<T>> {
        match scalars {
            AttributeValues::Uint(values) => values.iter().map(|&value| value.try_into().ok()).collect(),
            _ => None,
        }
    }
}

impl<T: Copy + Into<i32> + TryFrom<i32>> Code<T> for Signed {
    fn encode(values: &[T]) -> AttributeValues {
        AttributeValues::Int(values.iter().map(|&value| value.into()).collect())
    }

    fn decode(scalars: &AttributeValues) -> Option<Vec<T>> {
        match scalars {
            AttributeValues::Int(values) => values.iter().map(|&value| value.try_into().ok()).collect(),
            _ => None,
        }
    }
}

/// Shares of the largest integer. The least signed integer is a little below -1, so that it comes back.
macro_rules! shares {
    ($($integer:ty),*) => { $(
        impl Code<$integer> for Shares {
            fn encode(values: &[$integer]) -> AttributeValues {
                let share = |&value: &$integer| f32::from(value) / f32::from(<$integer>::MAX);
                AttributeValues::Float(values.iter().map(share).collect())
            }

            fn decode(scalars: &AttributeValues) -> Option<Vec<$integer>> {
                let AttributeValues::Float(shares) = scalars else { return None };
                // The cast saturates.
                let integer = |&share: &f32| (share * f32::from(<$integer>::MAX)).round() as $integer;
                Some(shares.iter().map(integer).collect())
            }
        }
    )* };
}
shares!(u8, i8, u16, i16);

impl Code<f16> for Halves {
    fn encode(values: &[f16]) -> AttributeValues {
        if values.iter().any(|value| value.is_nan()) {
            return AttributeValues::Uint(values.iter().map(|value| value.to_bits().into()).collect());
        }
        AttributeValues::Float(values.iter().map(|value| value.to_f32()).collect())
    }

    fn decode(scalars: &AttributeValues) -> Option<Vec<f16>> {
        match scalars {
            AttributeValues::Float(values) => {
                Some(values.iter().map(|&value| f16::from_f32(value)).collect())
            }
            AttributeValues::Uint(bits) => {
                bits.iter().map(|&bits| Some(f16::from_bits(bits.try_into().ok()?))).collect()
            }
            _ => None,
        }
    }
}

impl Code<f64> for Doubles {
    fn encode(values: &[f64]) -> AttributeValues {
        let words = |value: &f64| [value.to_bits() as u32, (value.to_bits() >> 32) as u32];
        AttributeValues::Uint(values.iter().flat_map(words).collect())
    }

    fn decode(scalars: &AttributeValues) -> Option<Vec<f64>> {
        let AttributeValues::Uint(words) = scalars else { return None };
        let double = |&[low, high]: &[u32; 2]| f64::from_bits(u64::from(high) << 32 | u64::from(low));
        let (pairs, rest) = words.as_chunks::<2>();
        rest.is_empty().then(|| pairs.iter().map(double).collect())
    }
}

/// Largest values of the four parts of `Unorm10_10_10_2`.
const TEN_TEN_TEN_TWO: [f32; 4] = [1023.0, 1023.0, 1023.0, 3.0];

fn unpack(word: u32) -> [f32; 4] {
    let parts = [word & 1023, word >> 10 & 1023, word >> 20 & 1023, word >> 30];
    std::array::from_fn(|part| parts[part] as f32 / TEN_TEN_TEN_TWO[part])
}

fn pack(shares: [f32; 4]) -> u32 {
    let part = |at: usize| (shares[at].clamp(0.0, 1.0) * TEN_TEN_TEN_TWO[at]).round() as u32;
    part(0) | part(1) << 10 | part(2) << 20 | part(3) << 30
}

/// Values of a vertex as a flat slice.
macro_rules! flat {
    (1, $values:expr) => {
        &$values[..]
    };
    ($width:literal, $values:expr) => {
        $values.as_flattened()
    };
}

/// A flat vector as values of vertices.
macro_rules! nested {
    (1, $values:expr) => {
        $values
    };
    ($width:literal, $values:expr) => {
        $values.as_chunks::<$width>().0.to_vec()
    };
}

/// Defines [`encode`], [`decode`] and [`gather`] from a row for each format: name, values of a vertex, scalars of multires for
/// each value, code.
macro_rules! formats {
    ($($name:ident $width:tt $words:literal $code:ident;)*) => {
        /// Returns the number of 32-bit scalars of a vertex, and all scalars.
        pub(crate) fn encode(values: &Values) -> (usize, AttributeValues) {
            match values {
                $( Values::$name(values) => ($width * $words, $code::encode(flat!($width, values))), )*
                Values::Unorm10_10_10_2(words) => {
                    (4, AttributeValues::Float(words.iter().flat_map(|&word| unpack(word)).collect()))
                }
            }
        }

        /// Returns the values of a format from 32-bit scalars, [`encode`]'s inverse. `None` if the format takes another type or
        /// number of scalars, or smaller integers.
        pub(crate) fn decode(format: VertexFormat, width: usize, scalars: &AttributeValues) -> Option<Values> {
            match format {
                $( VertexFormat::$name => {
                    (width == $width * $words).then_some(())?;
                    Some(Values::$name(nested!($width, $code::decode(scalars)?)))
                } )*
                VertexFormat::Unorm10_10_10_2 => {
                    let AttributeValues::Float(shares) = scalars else { return None };
                    let words = shares.as_chunks::<4>().0.iter().map(|&shares| pack(shares)).collect();
                    (width == 4).then_some(Values::Unorm10_10_10_2(words))
                }
            }
        }

        /// Returns the values of the vertices in `order`; `None` if one does not exist.
        pub(crate) fn gather(values: &Values, order: &[u32]) -> Option<Values> {
            match values {
                $( Values::$name(values) => Some(Values::$name(pick(values, order)?)), )*
                Values::Unorm10_10_10_2(values) => Some(Values::Unorm10_10_10_2(pick(values, order)?)),
            }
        }
    };
}

formats! {
    Uint8 1 1 Unsigned; Uint8x2 2 1 Unsigned; Uint8x4 4 1 Unsigned;
    Sint8 1 1 Signed; Sint8x2 2 1 Signed; Sint8x4 4 1 Signed;
    Unorm8 1 1 Shares; Unorm8x2 2 1 Shares; Unorm8x4 4 1 Shares;
    Snorm8 1 1 Shares; Snorm8x2 2 1 Shares; Snorm8x4 4 1 Shares;
    Uint16 1 1 Unsigned; Uint16x2 2 1 Unsigned; Uint16x4 4 1 Unsigned;
    Sint16 1 1 Signed; Sint16x2 2 1 Signed; Sint16x4 4 1 Signed;
    Unorm16 1 1 Shares; Unorm16x2 2 1 Shares; Unorm16x4 4 1 Shares;
    Snorm16 1 1 Shares; Snorm16x2 2 1 Shares; Snorm16x4 4 1 Shares;
    Float16 1 1 Halves; Float16x2 2 1 Halves; Float16x4 4 1 Halves;
    Float32 1 1 Floats; Float32x2 2 1 Floats; Float32x3 3 1 Floats; Float32x4 4 1 Floats;
    Uint32 1 1 Unsigned; Uint32x2 2 1 Unsigned; Uint32x3 3 1 Unsigned; Uint32x4 4 1 Unsigned;
    Sint32 1 1 Signed; Sint32x2 2 1 Signed; Sint32x3 3 1 Signed; Sint32x4 4 1 Signed;
    Float64 1 2 Doubles; Float64x2 2 2 Doubles; Float64x3 3 2 Doubles; Float64x4 4 2 Doubles;
    Unorm8x4Bgra 4 1 Shares;
}

fn pick<T: Copy>(values: &[T], order: &[u32]) -> Option<Vec<T>> {
    order.iter().map(|&vertex| values.get(vertex as usize).copied()).collect()
}
