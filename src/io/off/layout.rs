//! [`Layout`]: what each vertex has beside `x y z`, and in which order. [`Streams`]: these values of all vertices.

use crate::io::draft::Draft;
use crate::io::error::ReadError;
use crate::io::text::quoted;
use crate::mesh::{Attribute, AttributeValues, names};

/// Most values of a vertex: x y z w, a normal, r g b a, s t.
pub(super) const MOST: usize = 13;

/// Bits of a colour component that the file does not give: a NaN that no parser returns.
const MISSING: u32 = 0x7fc0_0001;

/// Data of each vertex.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Layout {
    pub uv: bool,
    pub color: bool,
    pub normal: bool,
    /// A fourth coordinate that divides the others.
    pub weight: bool,
    /// The colour comes before the normal.
    pub color_first: bool,
    /// The first word does not say what the file has: a vertex may lack its colour.
    pub implied: bool,
    /// The dimension is declared by the file.
    pub dimension: bool,
}

impl Layout {
    /// Parses `[ST][C][N][4][n]OFF` with a count behind it or none; `None` for any other word. Returns the layout and
    /// the count. `n` is not `N`, unless the word is in lower case.
    pub fn named(word: &[u8]) -> Option<Result<(Self, &[u8]), ReadError>> {
        let digits = word.iter().rev().take_while(|b| b.is_ascii_digit()).count();
        let (name, count) = word.split_at(word.len() - digits);
        let (mut prefix, end) = name.split_at_checked(name.len().checked_sub(3)?)?;
        if !end.eq_ignore_ascii_case(b"off") {
            return None;
        }
        let is_lower = end == b"off";
        let mut layout = Self::default();
        while let [first, rest @ ..] = prefix {
            prefix = rest;
            match first {
                b'n' if !is_lower => layout.dimension = true,
                b'N' | b'n' => layout.normal = true,
                b'C' | b'c' => (layout.color, layout.color_first) = (true, layout.normal),
                b'4' => layout.weight = true,
                b'S' | b's' if matches!(rest, [b'T' | b't', ..]) => (layout.uv, prefix) = (true, &rest[1..]),
                _ => {
                    let kind = quoted(name);
                    return Some(Err(ReadError::unsupported(format!("OFF files of the kind {kind}"))));
                }
            }
        }
        Some(Ok((layout, count)))
    }

    /// Returns the number of coordinates.
    pub fn coordinates(self) -> usize {
        3 + usize::from(self.weight)
    }

    /// Returns the index of a colour's first component.
    pub fn color_at(self) -> usize {
        self.coordinates() + 3 * usize::from(self.normal && !self.color_first)
    }

    /// Returns the number of values of a vertex whose colours have `color` components.
    pub fn width(self, color: usize) -> usize {
        self.coordinates()
            + 3 * usize::from(self.normal)
            + color * usize::from(self.color)
            + 2 * usize::from(self.uv)
    }
}

/// Values of the vertices, flat.
#[derive(Default)]
pub(super) struct Streams {
    pub layout: Layout,
    pub positions: Vec<[f64; 3]>,
    normals: Vec<f32>,
    colors: Vec<f32>,
    pub color_width: usize,
    uvs: Vec<f32>,
}

impl Streams {
    pub fn new(layout: Layout) -> Self {
        Self { layout, ..Self::default() }
    }

    /// Adds a vertex whose colour has `color` components; returns false if it lies at infinity (`w` is 0). Colours get
    /// `color_width` components, of which missing ones are 1. `values` holds at least `layout.width(color)` values.
    pub fn add(&mut self, values: &[f64], color: usize) -> bool {
        let layout = self.layout;
        let (position, rest) = values.split_at(layout.coordinates());
        let color = color * usize::from(layout.color);
        let normal = 3 * usize::from(layout.normal);
        let (normal_at, color_at) = if layout.color_first { (color, 0) } else { (0, normal) };
        let uv_at = normal + color;

        self.normals.extend(rest[normal_at..normal_at + normal].iter().map(|&x| x as f32));
        let component =
            |i: usize| if i < color { rest[color_at + i] as f32 } else { f32::from_bits(MISSING) };
        self.colors.extend((0..self.color_width).map(component));
        let uv = 2 * usize::from(layout.uv);
        self.uvs.extend(rest[uv_at..uv_at + uv].iter().map(|&x| x as f32));
        let weight = position.get(3).copied();
        let [x, y, z] = [position[0], position[1], position[2]];
        self.positions.push(weight.map_or([x, y, z], |w| [x / w, y / w, z / w]));
        weight != Some(0.0)
    }

    /// Moves positions and attributes to a draft. Divides colours by `color_maximum`.
    pub fn into_draft(mut self, color_maximum: f64) -> Draft {
        for x in &mut self.colors {
            *x = if x.to_bits() == MISSING { 1.0 } else { (f64::from(*x) / color_maximum) as f32 };
        }
        let of = |given: bool, name, width, values| {
            (given && width > 0).then(|| Attribute::new(name, width, AttributeValues::Float(values)))
        };
        let Layout { normal, color, uv, .. } = self.layout;
        let attributes = [
            of(normal, names::NORMAL, 3, self.normals),
            of(color, names::COLOR, self.color_width, self.colors),
            of(uv, names::UV, 2, self.uvs),
        ];
        Draft {
            positions: self.positions,
            attributes: attributes.into_iter().flatten().collect(),
            ..Draft::default()
        }
    }
}
