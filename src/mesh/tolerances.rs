//! Largest differences between equal values, by stream, in the unit people judge the stream by.
//!
//! ```text
//!     normal, tangent    degrees between directions         joints, ids      exact
//!     uv, uv1, ...       texels of a texture                all other floats a share of the value
//!     color, color1, ... steps of 8 bits                    position         steps of the largest coordinate,
//!                                                                            on open borders alone
//! ```
//!
//! Two wedges are equal if all their streams agree. Defaults are one step of 16-bit storage: simplification should not
//! separate values equal in a vertex buffer or a compressed file.

use super::{Attribute, AttributeValues, Mesh, names};

/// Largest differences between vertices of a point that form a single wedge, and between border points that merge.
///
/// 0 asks for equal values. `f32::INFINITY` leaves a kind of stream out of the comparison; [`Tolerances::without`]
/// leaves out a single stream.
///
/// ```
/// use multires::{Simplifier, mesh::{Tolerances, shapes}};
///
/// // Normals of a seam that differ by less than 2 degrees are one.
/// let tolerances = Tolerances::default().with_normal(2.0);
/// let sequence = Simplifier::new().tolerances(tolerances).run(&shapes::demo())?;
/// assert!(!sequence.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tolerances {
    /// Between normals and between tangents, degrees, 0 to 180 (180 or more: any values agree). Default 0.003: the
    /// diagonal of a cell of three 16-bit numbers from -1 to 1. Below 180, handedness must be equal.
    pub normal: f32,
    /// Between texture coordinates, texels in each direction. Default 1.
    pub uv: f32,
    /// Texels along a side of the texture. The texture covers coordinates from 0 to 1, or the stream's range if wider.
    /// Default 65,536.
    pub texture_size: f32,
    /// Between colours, steps of 1/255 in each channel. Default 1/257: a step of 16 bits.
    pub color: f32,
    /// Between values of all other float streams, as a share of the largest component of both values. Default 2^-16.
    pub relative: f32,
    /// Between points on open borders, steps of 2^-23 of the mesh's largest coordinate. Default 8: about the rounding
    /// of sine and cosine over a full turn. Points merge only within a quarter of the shortest edge at either, so a
    /// very short edge keeps both ends.
    pub position: f32,
    ignored: Vec<String>,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            normal: 0.003,
            uv: 1.0,
            texture_size: 65_536.0,
            color: 1.0 / 257.0,
            relative: 1.0 / 65_536.0,
            position: 8.0,
            ignored: Vec::new(),
        }
    }
}

impl Tolerances {
    /// Accepts equal values only, bit for bit.
    pub fn exact() -> Self {
        Self { normal: 0.0, uv: 0.0, color: 0.0, relative: 0.0, position: 0.0, ..Self::default() }
    }

    /// Sets the degrees between normals and between tangents.
    #[must_use]
    pub fn with_normal(mut self, degrees: f32) -> Self {
        self.normal = degrees;
        self
    }

    /// Sets the texels between texture coordinates.
    #[must_use]
    pub fn with_uv(mut self, texels: f32) -> Self {
        self.uv = texels;
        self
    }

    /// Sets the texels along a side of the texture.
    #[must_use]
    pub fn with_texture_size(mut self, texels: f32) -> Self {
        self.texture_size = texels;
        self
    }

    /// Sets the steps of 1/255 between colours.
    #[must_use]
    pub fn with_color(mut self, steps: f32) -> Self {
        self.color = steps;
        self
    }

    /// Sets the share of the value by which other floats may differ.
    #[must_use]
    pub fn with_relative(mut self, share: f32) -> Self {
        self.relative = share;
        self
    }

    /// Sets the steps of 2^-23 of the largest coordinate between border points.
    #[must_use]
    pub fn with_position(mut self, steps: f32) -> Self {
        self.position = steps;
        self
    }

    /// Leaves a stream out of the comparison, labels too. Wedges differing in it alone merge and take the values of the
    /// lowest vertex.
    #[must_use]
    pub fn without(mut self, name: impl Into<String>) -> Self {
        self.ignored.push(name.into());
        self
    }

    /// Whether [`Tolerances::without`] leaves out a stream.
    pub fn ignores(&self, name: &str) -> bool {
        self.ignored.iter().any(|ignored| ignored == name)
    }

    /// Returns name, value and valid range of the first tolerance outside its range.
    pub(crate) fn out_of_range(&self) -> Option<(&'static str, f32, &'static str)> {
        let all = [
            ("normal tolerance", self.normal),
            ("texture coordinate tolerance", self.uv),
            ("colour tolerance", self.color),
            ("relative tolerance", self.relative),
            ("position tolerance", self.position),
        ];
        let wrong = all.into_iter().find(|(_, value)| value.is_nan() || *value < 0.0);
        let no_texture = self.texture_size.is_nan() || self.texture_size <= 0.0;
        match wrong {
            Some((name, value)) => Some((name, value, "0 or more")),
            None => no_texture.then_some(("texture size", self.texture_size, "more than 0")),
        }
    }

    /// Whether wedges must be equal in every stream, bit for bit.
    fn is_exact(&self) -> bool {
        [self.normal, self.uv, self.color, self.relative].iter().all(|&t| t == 0.0)
    }
}

/// Comparison rule of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rule {
    /// Bit for bit.
    Exact,
    /// Chord between directions, as a share of the longer direction. Other components must be equal.
    Direction(f64),
    /// Difference of each component.
    Absolute(f64),
    /// Difference of each component, as a share of the largest component of both values.
    Relative(f64),
}

/// The compared streams of a mesh, each with its rule.
pub(super) struct Comparison<'a> {
    streams: Vec<(&'a Attribute, Rule)>,
    is_exact: bool,
}

impl<'a> Comparison<'a> {
    /// Computes the rule of each stream. O(texture coordinates), for their range.
    pub fn new(mesh: &'a Mesh, tolerances: &Tolerances) -> Self {
        let streams = mesh.attributes().iter().filter(|stream| !tolerances.ignores(stream.name()));
        let streams = streams.filter_map(|stream| Some((stream, rule(stream, tolerances)?)));
        Self { streams: streams.collect(), is_exact: tolerances.is_exact() }
    }

    /// Whether wedges must be equal in every compared stream, bit for bit.
    pub fn is_exact(&self) -> bool {
        self.is_exact || self.streams.iter().all(|(_, rule)| *rule == Rule::Exact)
    }

    /// Whether two vertices have equal values, bit for bit.
    pub fn equal(&self, a: u32, b: u32) -> bool {
        self.streams.iter().all(|(stream, _)| stream.words(a) == stream.words(b))
    }

    /// The raw words of a vertex, stream by stream.
    pub fn words(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.streams.iter().flat_map(move |(stream, _)| stream.words(vertex)).copied()
    }

    /// Whether two vertices agree within the tolerances of all streams.
    pub fn near(&self, a: u32, b: u32) -> bool {
        self.streams.iter().all(|(stream, rule)| {
            let (start, width) = ([a, b].map(|v| v as usize * stream.width()), stream.width());
            stream.words(a) == stream.words(b)
                || stream.as_floats().is_some_and(|values| {
                    rule.accepts(&values[start[0]..start[0] + width], &values[start[1]..start[1] + width])
                })
        })
    }
}

/// Returns the rule of a stream; `None` if any two values agree.
fn rule(stream: &Attribute, tolerances: &Tolerances) -> Option<Rule> {
    let AttributeValues::Float(values) = stream.values() else { return Some(Rule::Exact) };
    let set = |customary: &str| {
        let further = stream.name().strip_prefix(customary);
        further.is_some_and(|number| number.bytes().all(|digit| digit.is_ascii_digit()))
    };
    let is_direction = matches!(stream.name(), names::NORMAL | names::TANGENT) && stream.width() >= 3;
    let (tolerance, rule) = if is_direction {
        let half = f64::from(tolerances.normal.min(180.0)).to_radians() / 2.0;
        let any = tolerances.normal >= 180.0;
        (if any { f32::INFINITY } else { tolerances.normal }, Rule::Direction(2.0 * half.sin()))
    } else if set(names::UV) {
        let finite = values.iter().filter(|x| x.is_finite()).map(|&x| f64::from(x));
        let [low, high] = finite.fold([0.0_f64, 1.0], |[low, high], x| [low.min(x), high.max(x)]);
        let texel = (high - low) / f64::from(tolerances.texture_size);
        (tolerances.uv, Rule::Absolute(f64::from(tolerances.uv) * texel))
    } else if set(names::COLOR) {
        (tolerances.color, Rule::Absolute(f64::from(tolerances.color) / 255.0))
    } else {
        (tolerances.relative, Rule::Relative(f64::from(tolerances.relative)))
    };
    match tolerance {
        f32::INFINITY => None,
        0.0 => Some(Rule::Exact),
        _ => Some(rule),
    }
}

impl Rule {
    /// Whether two values agree that are not equal bit for bit. Values that are not finite never agree.
    fn accepts(self, a: &[f32], b: &[f32]) -> bool {
        let difference = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).abs();
        let both = || a.iter().zip(b);
        match self {
            Self::Exact => false,
            Self::Absolute(most) => both().all(|pair| difference(pair) <= most),
            Self::Relative(share) => {
                let largest = a.iter().chain(b).fold(0.0_f64, |most, &x| most.max(f64::from(x).abs()));
                largest.is_finite() && both().all(|pair| difference(pair) <= share * largest)
            }
            Self::Direction(chord) => {
                let square = |v: &[f32]| v[..3].iter().map(|&x| f64::from(x).powi(2)).sum::<f64>();
                let apart: f64 = both().take(3).map(|pair| difference(pair).powi(2)).sum();
                let longer = square(a).max(square(b));
                longer.is_finite() && apart <= chord * chord * longer && a[3..] == b[3..]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_one(name: &str, a: &[f32], b: &[f32], tolerances: &Tolerances) -> bool {
        let stream = Attribute::new(name, a.len(), AttributeValues::Float([a, b].concat()));
        rule(&stream, tolerances).is_none_or(|rule| rule.accepts(a, b))
    }

    #[test]
    fn each_stream_has_its_unit() {
        let exact = Tolerances::exact();
        let half_a_degree = exact.clone().with_normal(0.5);
        let turned = |degrees: f64| [degrees.to_radians().sin() as f32, degrees.to_radians().cos() as f32];
        let [near, far] = [turned(0.49), turned(0.51)];
        type Case<'a> = (&'a str, &'a [f32], &'a [f32], &'a [f32], Tolerances);
        let cases: [Case; 6] = [
            (
                names::NORMAL,
                &[0.0, 0.0, 1.0],
                &[near[0], 0.0, near[1]],
                &[far[0], 0.0, far[1]],
                half_a_degree.clone(),
            ),
            (
                names::TANGENT,
                &[0.0, 1.0, 0.0, 1.0],
                &[0.0, near[1], near[0], 1.0],
                &[0.0, near[1], near[0], -1.0],
                half_a_degree,
            ),
            (
                names::UV,
                &[0.5, 0.5],
                &[0.5009, 0.5],
                &[0.5011, 0.5],
                exact.clone().with_uv(1.0).with_texture_size(1e3),
            ),
            (
                "uv1",
                &[9.0, 5.0],
                &[8.992, 5.0],
                &[8.990, 5.0],
                exact.clone().with_uv(1.0).with_texture_size(1e3),
            ),
            (
                "color2",
                &[0.5, 0.5, 0.5],
                &[0.507, 0.5, 0.5],
                &[0.509, 0.5, 0.5],
                exact.clone().with_color(2.0),
            ),
            ("uvw", &[0.0, 100.0], &[0.9, 100.0], &[1.1, 100.0], exact.clone().with_relative(0.01)),
        ];
        for (name, value, near, far, tolerances) in cases {
            assert!(is_one(name, value, near, &tolerances), "{name}");
            assert!(!is_one(name, value, far, &tolerances), "{name}");
            assert!(!is_one(name, value, near, &exact), "{name}");
            assert!(!is_one(name, value, &[f32::NAN; 4][..value.len()], &tolerances), "{name}");
        }
    }

    #[test]
    fn an_infinite_tolerance_accepts_anything() {
        let any = f32::INFINITY;
        let all = Tolerances::exact().with_normal(any).with_uv(any).with_color(any).with_relative(any);
        for name in [names::NORMAL, names::UV, names::COLOR, "other"] {
            assert!(is_one(name, &[1.0; 3], &[f32::NAN; 3], &all), "{name}");
        }
    }
}
