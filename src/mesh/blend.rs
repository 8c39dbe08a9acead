//! Blends of two vertices' attributes. Every new vertex of the crate gets its values here.
//!
//! | stream | blend |
//! |---|---|
//! | normals | blended and scaled to unit length; where both ends cancel, the nearer end's normal |
//! | tangents | blended, made perpendicular to the blended normal, unit length; handedness of the nearer end |
//! | joints and weights | blended as sets: the weight of a joint is the blend of its weights at both ends |
//! | other floats | blended component by component, within the range of both ends |
//! | other labels | copied from the nearer end |
//!
//! A vertex blended from a single source, or with a share of 0 or 1, is a copy, bit for bit.
//!
//! The nearer end's tangent direction is copied where the ends differ in handedness or their directions cancel. Of a
//! blended set the heaviest joints stay, and weights are scaled to the larger of both ends' sums.

use glam::Vec3;

use super::{Attribute, names};

/// Maximum width of an attribute, scalars.
const WIDEST: usize = 16;
/// Blended directions cancel if they are shorter than this share of the longer end: their direction is noise.
const CANCELLED: f32 = 1e-3;
/// A sum of weights within this of 1 counts as 1.
const ROUNDING: f64 = 0.01;

/// Attribute streams of a mesh, growing by blends of vertices already in them.
#[derive(Debug, Clone)]
pub(crate) struct Blender {
    attributes: Vec<Attribute>,
    normal: Option<usize>,
    tangent: Option<usize>,
    /// Pairs of streams, joints and weights. All pairs together hold the set of a vertex.
    skin: Vec<[usize; 2]>,
    /// Joints and weights of the current vertex.
    set: Vec<[f64; 2]>,
}

impl Blender {
    /// Copies the streams and reserves room for `more` vertices. O(values).
    pub fn new(attributes: &[Attribute], more: usize) -> Self {
        let mut attributes = attributes.to_vec();
        attributes.iter_mut().for_each(|attribute| attribute.reserve(more));
        let direction = |name| {
            let is_it = |a: &Attribute| a.name() == name && a.width() >= 3 && a.as_floats().is_some();
            attributes.iter().position(is_it)
        };
        Self {
            normal: direction(names::NORMAL),
            tangent: direction(names::TANGENT),
            skin: skin(&attributes),
            attributes,
            set: Vec::new(),
        }
    }

    /// Appends `(1 - share) * from[0] + share * from[1]`. Both vertices must exist. O(scalars).
    pub fn push(&mut self, from: [u32; 2], share: f32) {
        let Some(first) = self.attributes.first() else { return };
        let vertex = (first.len() / first.width()) as u32;
        self.attributes.iter_mut().for_each(Attribute::push_row);
        self.put(vertex, from, share);
    }

    /// Overwrites `vertex` with `(1 - share) * from[0] + share * from[1]`. `vertex` must differ from both ends.
    /// O(scalars).
    pub fn put(&mut self, vertex: u32, from: [u32; 2], share: f32) {
        let nearer = from[usize::from(share > 0.5)];
        if from[0] == from[1] || share <= 0.0 || share >= 1.0 {
            self.attributes.iter_mut().for_each(|attribute| attribute.copy_row(nearer, vertex));
            return;
        }
        for (i, attribute) in self.attributes.iter_mut().enumerate() {
            if self.skin.iter().flatten().any(|&stream| stream == i) {
                continue;
            }
            let width = attribute.width;
            match attribute.floats_mut() {
                Some(values) if Some(i) != self.tangent => blend_row(values, width, vertex, from, share),
                _ => attribute.copy_row(nearer, vertex),
            }
        }
        self.put_normal(vertex, from, nearer);
        self.put_tangent(vertex, from, share, nearer);
        self.put_skin(vertex, from, share);
    }

    /// Returns the streams.
    pub fn finish(self) -> Vec<Attribute> {
        self.attributes
    }

    /// Returns the first three scalars of a vertex in a stream.
    fn vector(&self, stream: usize, vertex: u32) -> Vec3 {
        let attribute = &self.attributes[stream];
        match attribute.as_floats() {
            Some(v) => Vec3::from_slice(&v[vertex as usize * attribute.width..][..3]),
            None => Vec3::ZERO,
        }
    }

    fn set_vector(&mut self, stream: usize, vertex: u32, vector: Vec3) {
        let attribute = &mut self.attributes[stream];
        let start = vertex as usize * attribute.width;
        if let Some(v) = attribute.floats_mut() {
            vector.write_to_slice(&mut v[start..][..3]);
        }
    }

    /// Scales a blended normal to unit length.
    fn put_normal(&mut self, vertex: u32, from: [u32; 2], nearer: u32) {
        let Some(stream) = self.normal else { return };
        let blended = self.vector(stream, vertex);
        let [a, b] = from.map(|v| self.vector(stream, v).length());
        let whole =
            if blended.length() > CANCELLED * a.max(b) { blended } else { self.vector(stream, nearer) };
        self.set_vector(stream, vertex, unit(whole));
    }

    /// Blends tangents and makes the result perpendicular to the blended normal. Expects the nearer end's tangent in
    /// `vertex`.
    fn put_tangent(&mut self, vertex: u32, from: [u32; 2], share: f32, nearer: u32) {
        let Some(stream) = self.tangent else { return };
        let attribute = &self.attributes[stream];
        let hand = |v: u32| match attribute.as_floats() {
            Some(values) if attribute.width > 3 => values[v as usize * attribute.width + 3] < 0.0,
            _ => false,
        };
        let normal = self.normal.map_or(Vec3::ZERO, |normal| self.vector(normal, vertex));
        let flat =
            |tangent: Vec3| tangent - normal * (normal.dot(tangent) / normal.length_squared().max(1e-12));
        let [a, b] = from.map(|v| self.vector(stream, v));
        let own = self.vector(stream, nearer);
        let least = CANCELLED * a.length().max(b.length());
        let mixed = flat(a * (1.0 - share) + b * share);
        let tangent = if hand(from[0]) == hand(from[1]) && mixed.length() > least {
            mixed
        } else if flat(own).length() > least {
            flat(own)
        } else {
            own
        };
        self.set_vector(stream, vertex, unit(tangent));
    }

    /// Blends joints and weights as sets.
    fn put_skin(&mut self, vertex: u32, from: [u32; 2], share: f32) {
        if self.skin.is_empty() {
            return;
        }
        let mut set = std::mem::take(&mut self.set);
        set.clear();
        let mut sums = [0.0; 2];
        for (end, (v, part)) in from.into_iter().zip([1.0 - f64::from(share), f64::from(share)]).enumerate() {
            for &[joints, weights] in &self.skin {
                let (joints, weights) = (&self.attributes[joints], &self.attributes[weights]);
                for slot in v as usize * joints.width..(v as usize + 1) * joints.width {
                    let weight = weights.scalar_at(slot);
                    if weight.is_finite() && weight > 0.0 {
                        sums[end] += weight;
                        set.push([joints.scalar_at(slot), part * weight]);
                    }
                }
            }
        }
        set.sort_by(|a, b| a[0].total_cmp(&b[0]));
        set.dedup_by(|next, kept| {
            let same = next[0] == kept[0];
            kept[1] += if same { next[1] } else { 0.0 };
            same
        });
        set.sort_by(|a, b| b[1].total_cmp(&a[1]).then(a[0].total_cmp(&b[0])));
        set.truncate(self.skin.iter().map(|&[joints, _]| self.attributes[joints].width).sum());
        let sums = sums.map(|sum| if (sum - 1.0).abs() < ROUNDING { 1.0 } else { sum });
        let [_, weights] = self.skin[0];
        let is_float = self.attributes[weights].as_floats().is_some();
        scale_to(&mut set, sums[0].max(sums[1]), is_float);

        let mut rest = set.iter();
        for &[joints, weights] in &self.skin {
            let width = self.attributes[joints].width;
            for slot in vertex as usize * width..(vertex as usize + 1) * width {
                let &[joint, weight] = rest.next().unwrap_or(&[0.0; 2]);
                self.attributes[joints].set_scalar(slot, joint);
                self.attributes[weights].set_scalar(slot, weight);
            }
        }
        self.set = set;
    }
}

/// Blends the floats of a vertex; every component stays within the range of both ends.
fn blend_row(values: &mut [f32], width: usize, vertex: u32, from: [u32; 2], share: f32) {
    let [to, a, b] = [vertex, from[0], from[1]].map(|v| v as usize * width);
    for i in 0..width {
        let (a, b) = (values[a + i], values[b + i]);
        let between = (1.0 - share) * a + share * b;
        let same = a.to_bits() == b.to_bits();
        values[to + i] = if same { a } else { between.max(a.min(b)).min(a.max(b)) };
    }
}

/// Scales a vector to unit length, unless it has no length or its length is 1 up to rounding.
fn unit(vector: Vec3) -> Vec3 {
    let length = vector.length();
    if length > 1e-12 && (length - 1.0).abs() > 1e-5 { vector / length } else { vector }
}

/// Scales weights, largest first, to `sum`. Integers are rounded down, and the remainder goes to the weights that lost
/// most: the sum is exact.
fn scale_to(set: &mut [[f64; 2]], sum: f64, is_float: bool) {
    let now: f64 = set.iter().map(|pair| pair[1]).sum();
    if now <= 0.0 {
        return;
    }
    set.iter_mut().for_each(|pair| pair[1] *= sum / now);
    if is_float {
        return;
    }
    let mut left = sum - set.iter().map(|pair| pair[1].floor()).sum::<f64>();
    let mut parts = [f64::NEG_INFINITY; WIDEST];
    for (part, pair) in parts.iter_mut().zip(set.iter_mut()) {
        *part = pair[1] - pair[1].floor();
    }
    for pair in set.iter_mut() {
        pair[1] = pair[1].floor();
    }
    while left >= 1.0 {
        let most = (0..parts.len()).fold(0, |most, i| if parts[i] > parts[most] { i } else { most });
        set[most][1] += 1.0;
        parts[most] -= 1.0;
        left -= 1.0;
    }
}

/// Finds the pairs of joint and weight streams, set by set; stops at the first set of unequal widths or of another
/// weight type.
fn skin(attributes: &[Attribute]) -> Vec<[usize; 2]> {
    let position = |name: &str, set: usize| {
        let is_it = |attribute: &Attribute| {
            let number = attribute.name().strip_prefix(name);
            number.is_some_and(|n| if set == 0 { n.is_empty() } else { n.parse() == Ok(set) })
        };
        attributes.iter().position(is_it)
    };
    let mut skin: Vec<[usize; 2]> = Vec::new();
    for set in 0..attributes.len() {
        let (Some(joints), Some(weights)) = (position(names::JOINTS, set), position(names::WEIGHTS, set))
        else {
            break;
        };
        let is_float = |stream: usize| attributes[stream].as_floats().is_some();
        let fits = attributes[joints].width == attributes[weights].width
            && skin.first().is_none_or(|first| is_float(first[1]) == is_float(weights));
        if !fits {
            break;
        }
        skin.push([joints, weights]);
    }
    skin
}
