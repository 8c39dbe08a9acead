//! Colours for numbers and labels, as sRGB bytes: distinguishable with any colour vision, and in grey print.

/// Dark blue through green to yellow, with evenly rising lightness: eighths of the viridis scale (Smith and van der
/// Walt, "A Better Default Colormap for Matplotlib", SciPy 2015).
const SEQUENTIAL: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Hues of labels: Okabe and Ito's set ("Color Universal Design", 2008), softened for shading under light.
const CATEGORICAL: [[u8; 3]; 8] = [
    [148, 160, 178],
    [219, 165, 74],
    [110, 170, 205],
    [72, 150, 124],
    [224, 214, 120],
    [74, 118, 168],
    [200, 112, 72],
    [188, 132, 166],
];

/// Colour of NaN.
const UNKNOWN: [u8; 3] = [190, 190, 190];

/// Returns the colour of `t` on a scale from 0 (dark blue) to 1 (yellow). Values outside are clamped. NaN is grey.
pub fn sequential(t: f32) -> [u8; 3] {
    if t.is_nan() {
        return UNKNOWN;
    }
    let steps = (SEQUENTIAL.len() - 1) as f32;
    let position = t.clamp(0.0, 1.0) * steps;
    let index = (position as usize).min(SEQUENTIAL.len() - 2);
    let share = position - index as f32;
    std::array::from_fn(|i| {
        let (low, high) = (f32::from(SEQUENTIAL[index][i]), f32::from(SEQUENTIAL[index + 1][i]));
        (low + (high - low) * share).round() as u8
    })
}

/// Returns the colour of every value on the [`sequential`] scale from `range[0]` to `range[1]`. If both are equal,
/// larger values take the high end and all others the low end. O(n).
pub fn colours(values: &[f32], range: [f32; 2]) -> Vec<[u8; 3]> {
    let [low, high] = range.map(f64::from);
    let place = |x: f64| {
        if high != low {
            (x - low) / (high - low)
        } else if x > high {
            1.0
        } else {
            x * 0.0
        }
    };
    values.iter().map(|&x| sequential(place(f64::from(x)) as f32)).collect()
}

/// Returns the colour of a label, such as a material id; eight colours repeat.
pub fn categorical(label: u32) -> [u8; 3] {
    CATEGORICAL[label as usize % CATEGORICAL.len()]
}
