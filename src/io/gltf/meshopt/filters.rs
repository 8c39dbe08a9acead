//! Filters: elements of 4 numbers, or floats, out of forms with fewer bits.
//!
//! | filter | form | element |
//! |---|---|---|
//! | OCTAHEDRAL | x, y on an octahedron, 1, any | unit vector, any |
//! | QUATERNION | the 3 smaller components by √2, 1 with the place of the largest | unit quaternion |
//! | EXPONENTIAL | exponent of 8 bits, mantissa of 24 | float |
//! | COLOR | luma, two differences, alpha below a bit of 1 | red, green, blue, alpha |
//!
//! Each form says its own precision, by the number that stands for 1. Results are rounded once, from single precision; forms
//! that are none give any numbers.

/// What is done to elements after decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl Filter {
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "NONE" => Self::None,
            "OCTAHEDRAL" => Self::Octahedral,
            "QUATERNION" => Self::Quaternion,
            "EXPONENTIAL" => Self::Exponential,
            "COLOR" => Self::Color,
            _ => return None,
        })
    }

    /// Tests if elements may have this stride, a multiple of 4.
    pub fn takes(self, stride: usize) -> bool {
        match self {
            Self::None | Self::Exponential => true,
            Self::Octahedral | Self::Color => stride == 4 || stride == 8,
            Self::Quaternion => stride == 8,
        }
    }

    /// Replaces forms by elements.
    pub fn apply(self, bytes: &mut [u8], stride: usize) {
        match (self, stride) {
            (Self::None, _) => {}
            (Self::Octahedral, 4) => small(bytes, |v| octahedral(v.map(|x| (x as i8).into()), 127.0)),
            (Self::Octahedral, _) => large(bytes, |v| octahedral(v.map(|x| (x as i16).into()), 32_767.0)),
            (Self::Quaternion, _) => large(bytes, |v| quaternion(v.map(|x| (x as i16).into()))),
            (Self::Exponential, _) => {
                for word in bytes.chunks_exact_mut(4) {
                    let form = i32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                    word.copy_from_slice(&exponential(form).to_le_bytes());
                }
            }
            (Self::Color, 4) => small(bytes, |v| {
                color([v[0].into(), (v[1] as i8).into(), (v[2] as i8).into(), v[3].into()], 255.0)
            }),
            (Self::Color, _) => large(bytes, |v| {
                color([v[0].into(), (v[1] as i16).into(), (v[2] as i16).into(), v[3].into()], 65_535.0)
            }),
        }
    }
}

/// Changes elements of 4 bytes. Keeps the low bits of each number.
fn small(bytes: &mut [u8], change: impl Fn([u8; 4]) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(4) {
        let changed = change([element[0], element[1], element[2], element[3]]);
        element.copy_from_slice(&changed.map(|x| x as u8));
    }
}

/// Changes elements of 4 words of 16 bits.
fn large(bytes: &mut [u8], change: impl Fn([u16; 4]) -> [i32; 4]) {
    for element in bytes.chunks_exact_mut(8) {
        let word = |i: usize| u16::from_le_bytes([element[2 * i], element[2 * i + 1]]);
        let changed = change([word(0), word(1), word(2), word(3)]);
        for (to, word) in element.chunks_exact_mut(2).zip(changed) {
            to.copy_from_slice(&(word as u16).to_le_bytes());
        }
    }
}

fn octahedral([x, y, one, any]: [i32; 4], most: f32) -> [i32; 4] {
    let (x, y) = (x as f32 / one as f32, y as f32 / one as f32);
    let z = 1.0 - x.abs() - y.abs();
    // The lower half is folded outwards over the edges of the upper one.
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    let round = |value: f32| (value / length * most).round() as i32;
    [round(x), round(y), round(z), any]
}

fn quaternion([x, y, z, last]: [i32; 4]) -> [i32; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / (last | 3) as f32;
    let [x, y, z] = [x, y, z].map(|value| value as f32 * scale);
    let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut turned = [0; 4];
    for (i, value) in [largest, x, y, z].into_iter().enumerate() {
        turned[((last & 3) as usize + i) % 4] = (value * 32_767.0).round() as i32;
    }
    turned
}

/// Returns `mantissa * 2^exponent`, rounded once.
fn exponential(form: i32) -> f32 {
    let (exponent, mantissa) = (form >> 24, form << 8 >> 8);
    // In double precision every such power is a normal number.
    let power = f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52);
    (f64::from(mantissa) * power) as f32
}

fn color([y, co, cg, alpha]: [i32; 4], most: f32) -> [i32; 4] {
    // The highest bit of alpha tells the bits of the others: all of them, set.
    let whole = alpha.checked_ilog2().map_or(0, |bit| (2 << bit) - 1);
    let (r, g, b) = (y + co - cg, y + cg, y - co - cg);
    let alpha = alpha & (whole >> 1);
    let alpha = alpha << 1 | (alpha & 1);
    [r, g, b, alpha].map(|value| (value as f32 * (most / whole as f32)).round().clamp(0.0, most) as i32)
}
