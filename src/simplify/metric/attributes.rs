//! Attribute deviations on top of any quadric metric (Hoppe 1999, "New quadric metric for simplifying meshes with
//! appearance attributes").
//!
//! ```text
//!   on a triangle, a scalar attribute s is linear in the plane:   s(x) = g . (x - p) + s_p,   g in the plane
//!   moved to x with the value v it is off by:                     area * (w * (g . (x - p) + s_p - v))^2
//! ```
//!
//! The sum over the triangles around a wedge is a quadric in position *and* value. Each is kept relative to its own
//! wedge's position and values, where it is 0 to begin with: the terms are then as small as what changes, and single
//! precision suffices (compare `quadric.rs`). A wedge's quadric goes where the wedge goes, so seams keep their sides
//! apart: the cost of a collapse is the sum over the lost point's wedges, each at the wedge it would become.

use glam::Vec3;

use super::{Batch, Dependence, ErrorMetric, Pair, Quadric, Substitutions};
use crate::mesh::{Mesh, names};
use crate::simplify::candidates::blend_weight;
use crate::simplify::classify::kind;
use crate::simplify::options::OptionError;
use crate::simplify::oracle::WedgeMap;
use crate::simplify::surface::Surface;

/// Which attributes count, and how much.
///
/// A weight is the distance that a deviation of one unit is worth, as a share of the diagonal of the mesh's box: with
/// a normal weight of 0.01, a normal that is off by a vector of length 1 counts as much as a surface that is off by
/// 1 % of the diagonal. Values that are not finite count as 0.
#[derive(Debug, Clone)]
pub struct Attributes<'a> {
    mesh: &'a Mesh,
    groups: Vec<Group<'a>>,
    error: Option<OptionError>,
}

/// The scalars of one attribute.
#[derive(Debug, Clone, Copy)]
struct Group<'a> {
    values: &'a [f32],
    width: usize,
    weight: f32,
    /// Brought back to unit length when blended.
    direction: bool,
}

impl<'a> Attributes<'a> {
    /// No attribute of this mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, groups: Vec::new(), error: None }
    }

    /// Normals, texture coordinates and colours where the mesh has them, with weights that suit rendering:
    /// [`NORMAL_WEIGHT`](Self::NORMAL_WEIGHT), [`COLOR_WEIGHT`](Self::COLOR_WEIGHT), and for texture coordinates
    /// [`SLIDE_WEIGHT`](Self::SLIDE_WEIGHT) times the distance that one unit covers on this mesh's surface.
    pub fn customary(mesh: &'a Mesh) -> Self {
        let slide = Self::SLIDE_WEIGHT * units_per_uv(mesh);
        Self::new(mesh).normals(Self::NORMAL_WEIGHT).uv(slide).colors(Self::COLOR_WEIGHT)
    }

    /// The customary weight of normals.
    pub const NORMAL_WEIGHT: f32 = 0.003;
    /// The customary weight of colours.
    pub const COLOR_WEIGHT: f32 = 0.01;
    /// What a texture that slides along the surface is worth, as a share of the way it slides.
    pub const SLIDE_WEIGHT: f32 = 0.1;

    /// Counts [`names::NORMAL`], where the mesh has it.
    #[must_use]
    pub fn normals(self, weight: f32) -> Self {
        self.optional(names::NORMAL, weight)
    }

    /// Counts [`names::UV`], where the mesh has it. Per unit of the coordinate: one whole texture.
    #[must_use]
    pub fn uv(self, weight: f32) -> Self {
        self.optional(names::UV, weight)
    }

    /// Counts [`names::COLOR`], where the mesh has it.
    #[must_use]
    pub fn colors(self, weight: f32) -> Self {
        self.optional(names::COLOR, weight)
    }

    /// Counts the float attribute of that name, which the mesh must have.
    #[must_use]
    pub fn custom(mut self, name: &str, weight: f32) -> Self {
        if self.mesh.attribute(name).and_then(|a| a.as_floats()).is_none() {
            self.error.get_or_insert(OptionError::NoAttribute { name: name.to_owned() });
        }
        self.optional(name, weight)
    }

    /// Counts values that are not part of the mesh: `width` floats per vertex, vertex by vertex.
    #[must_use]
    pub fn values(mut self, values: &'a [f32], width: usize, weight: f32) -> Self {
        if width == 0 || values.len() != width * self.mesh.positions().len() {
            let value = values.len() as f64;
            let expected = "as many values as vertices times a width of 1 or more";
            self.error.get_or_insert(OptionError::OutOfRange { option: "attribute values", value, expected });
        }
        self.group(Group { values, width, weight, direction: false })
    }

    fn optional(self, name: &str, weight: f32) -> Self {
        let Some(attribute) = self.mesh.attribute(name) else { return self };
        let Some(values) = attribute.as_floats() else { return self };
        let direction = name == names::NORMAL && attribute.width() == 3;
        self.group(Group { values, width: attribute.width(), weight, direction })
    }

    fn group(mut self, group: Group<'a>) -> Self {
        if !(0.0..=MAX_WEIGHT).contains(&group.weight) {
            let (value, expected) = (f64::from(group.weight), "0 to 1000000");
            self.error.get_or_insert(OptionError::OutOfRange { option: "attribute weight", value, expected });
        }
        if group.weight > 0.0 {
            self.groups.push(group);
        }
        self
    }
}

/// Largest weight, and largest value times weight (beyond it is taken as this): squares stay well inside `f32`.
const MAX_WEIGHT: f32 = 1e6;

/// Thinnest triangle (height over length) whose gradient is trusted; on thinner ones values count as constant.
const THINNEST: f32 = 1e-5;

/// The distance on the surface that one unit of [`names::UV`] covers on average, as a share of the diagonal; 0 where
/// that makes no sense.
fn units_per_uv(mesh: &Mesh) -> f32 {
    let Some(uv) = mesh.attribute(names::UV).filter(|a| a.width() == 2).and_then(|a| a.as_floats()) else {
        return 0.0;
    };
    let (mut surface, mut texture) = (0.0f64, 0.0f64);
    for t in mesh.triangles() {
        let [p, q, r] = t.map(|v| glam::DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        let [a, b, c] =
            t.map(|v| glam::DVec2::new(f64::from(uv[2 * v as usize]), f64::from(uv[2 * v as usize + 1])));
        let covered = (b - a).perp_dot(c - a).abs();
        if covered.is_finite() {
            surface += (q - p).cross(r - p).length();
            texture += covered;
        }
    }
    let diagonal = mesh.diagonal();
    if texture > 0.0 && diagonal > 0.0 {
        ((surface / texture).sqrt() / diagonal).min(f64::from(MAX_WEIGHT)) as f32
    } else {
        0.0
    }
}

/// Squared attribute deviations on top of another metric.
///
/// The metric below may be any whose cost is (twice) an area times a squared distance, such as [`Quadric`]. The
/// attribute part is accumulated since the input, whether the metric below is or not. Positions are left to the metric
/// below: [`optimum`](ErrorMetric::optimum) is its optimum, at the cost of both; values there are blends along the
/// edge. Use it for the mesh that the attributes were taken from; vertices beyond those count with values of 0.
///
/// Memory: 56 bytes and 20 bytes per scalar for every vertex. A cost takes O(scalars) for every wedge.
#[derive(Debug, Clone)]
pub struct WithAttributes<M = Quadric> {
    metric: M,
    /// Scalars per vertex.
    stride: usize,
    /// The input's values times weight, `stride` per vertex: shares of the diagonal.
    source: Vec<f32>,
    /// Diagonal of the mesh's box, object units.
    diagonal: f64,
    /// First scalar and weight of every direction.
    directions: Vec<(usize, f32)>,
    /// The diagonal in the inner frame.
    unit: f32,
    /// Values in the inner frame, one set per vertex, new ones included.
    values: Vec<f32>,
    heads: Vec<Head>,
    /// Sums of area times gradient, and of area times offset; `stride` per vertex.
    slopes: Vec<[f32; 4]>,
}

/// The part of a wedge's quadric that does not grow with the scalars: `d'Ad + 2 b'd + c` at unchanged values.
#[derive(Debug, Clone, Copy, Default)]
struct Head {
    origin: Vec3,
    /// xx, yy, zz, xy, xz, yz.
    a: [f32; 6],
    b: Vec3,
    c: f32,
    area: f32,
}

impl Head {
    #[inline]
    fn times(&self, d: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, xz, yz] = self.a;
        Vec3::new(
            xx * d.x + xy * d.y + xz * d.z,
            xy * d.x + yy * d.y + yz * d.z,
            xz * d.x + yz * d.y + zz * d.z,
        )
    }
}

impl WithAttributes<Quadric> {
    /// Accumulated quadrics and the [customary](Attributes::customary) attributes of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(Quadric::new(), &Attributes::customary(mesh))
    }
}

impl<M: ErrorMetric> WithAttributes<M> {
    /// A metric and chosen attributes, whose values are copied. O(values).
    ///
    /// # Errors
    /// A weight that is negative or not a number, an attribute that the mesh does not have, or values of the wrong
    /// length.
    pub fn with(metric: M, attributes: &Attributes<'_>) -> Result<Self, OptionError> {
        match &attributes.error {
            Some(error) => Err(error.clone()),
            None => Ok(Self::of(metric, attributes)),
        }
    }

    fn of(metric: M, attributes: &Attributes<'_>) -> Self {
        let stride = attributes.groups.iter().map(|g| g.width).sum();
        let mut source = Vec::with_capacity(stride * attributes.mesh.positions().len());
        for vertex in 0..attributes.mesh.positions().len() {
            for group in &attributes.groups {
                let scalars = &group.values[vertex * group.width..][..group.width];
                let scaled = |x: f32| if x.is_finite() { x * group.weight } else { 0.0 };
                source.extend(scalars.iter().map(|&x| scaled(x).clamp(-MAX_WEIGHT, MAX_WEIGHT)));
            }
        }
        let mut directions = Vec::new();
        let mut first = 0;
        for group in &attributes.groups {
            if group.direction {
                directions.push((first, group.weight));
            }
            first += group.width;
        }
        Self {
            metric,
            stride,
            source,
            diagonal: attributes.mesh.diagonal(),
            directions,
            unit: 0.0,
            values: Vec::new(),
            heads: Vec::new(),
            slopes: Vec::new(),
        }
    }
}

impl<M> WithAttributes<M> {
    /// The values of a vertex.
    #[inline]
    fn values_of(&self, vertex: u32) -> &[f32] {
        &self.values[vertex as usize * self.stride..][..self.stride]
    }

    /// The quadric of a wedge at a position and values.
    #[inline]
    fn deviation(&self, wedge: u32, x: Vec3, value: impl Fn(usize) -> f32) -> f32 {
        let head = &self.heads[wedge as usize];
        let d = x - head.origin;
        let mut sum = d.dot(head.times(d)) + 2.0 * d.dot(head.b) + head.c;
        let slopes = &self.slopes[wedge as usize * self.stride..][..self.stride];
        for (scalar, (own, slope)) in self.values_of(wedge).iter().zip(slopes).enumerate() {
            let u = value(scalar) - own;
            let [x, y, z, offset] = *slope;
            sum += u * (head.area * u - 2.0 * (x * d.x + y * d.y + z * d.z + offset));
        }
        sum.max(0.0)
    }

    /// One scalar of the blend of two vertices.
    #[inline]
    fn blend(&self, from: [u32; 2], share: f32, scalar: usize) -> f32 {
        let [a, b] = from.map(|v| self.values_of(v));
        let mix = |i: usize| a[i] + (b[i] - a[i]) * share;
        if let Some(&(first, weight)) = self.directions.iter().find(|d| (d.0..d.0 + 3).contains(&scalar)) {
            let length = Vec3::new(mix(first), mix(first + 1), mix(first + 2)).length();
            return if length > 0.0 { mix(scalar) * (weight * self.unit / length) } else { 0.0 };
        }
        mix(scalar)
    }

    /// What the attributes cost where `pair` is merged at `x`, the kept point's own place or between; `whole` with what
    /// the kept wedges carry where they stay as they are.
    fn attribute_cost(&self, surface: &Surface, pair: Pair, x: Vec3, whole: bool) -> f32 {
        let mut sum = 0.0;
        let stays = x == surface.at(pair.kept);
        let share = blend_weight(surface.at(pair.lost), surface.at(pair.kept), x);
        for_wedges(surface, pair, |lost, kept| {
            sum += if stays {
                let values = self.values_of(kept);
                let own = if whole { self.heads[kept as usize].c } else { 0.0 };
                self.deviation(lost, x, |s| values[s]) + own
            } else {
                let value = |s: usize| self.blend([lost, kept], share, s);
                self.deviation(lost, x, value) + self.deviation(kept, x, value)
            };
        });
        sum.min(f32::MAX)
    }

    /// The quadrics of the surface as it is. Their sums run over the triangles in order, so they are the same always.
    fn build(&mut self, surface: &Surface) {
        let triangles = || (0..surface.triangle_count() as u32).filter(|&t| surface.triangle(t).is_some());
        let vertices = triangles().flat_map(|t| surface.layers(t)).flat_map(|layer| layer.vertices);
        let count = vertices.max().map_or(0, |v| v as usize + 1);
        self.unit = (self.diagonal * surface.frame().scale()) as f32;
        self.values.clear();
        self.values.extend(self.source.iter().map(|x| x * self.unit));
        let count = count.max(self.source.len() / self.stride.max(1));
        self.values.resize(count * self.stride, 0.0);
        self.heads.clear();
        self.heads.resize(count, Head::default());
        self.slopes.clear();
        self.slopes.resize(count * self.stride, [0.0; 4]);
        let mut points = [0; 3];
        for t in triangles() {
            if let Some(corners) = surface.triangle(t) {
                points = corners;
            }
            for layer in surface.layers(t) {
                self.add_triangle(points.map(|p| surface.at(p)), layer.vertices);
            }
        }
    }

    /// Adds a triangle to the quadrics of its three wedges.
    fn add_triangle(&mut self, [p, q, r]: [Vec3; 3], wedges: [u32; 3]) {
        let (e, f) = (q - p, r - p);
        let cross = e.cross(f);
        let area = cross.length();
        let longest = e.length_squared().max(f.length_squared()).max(q.distance_squared(r));
        let inverse = if area > THINNEST * longest { 1.0 / area } else { 0.0 };
        // grad s = (s_q - s_p) * along_e + (s_r - s_p) * along_f
        let normal = cross * inverse;
        let (along_e, along_f) = (f.cross(normal) * inverse, normal.cross(e) * inverse);
        let mut a = [0.0; 6];
        for scalar in 0..self.stride {
            let [sp, sq, sr] = wedges.map(|w| self.values[w as usize * self.stride + scalar]);
            let g = (sq - sp) * along_e + (sr - sp) * along_f;
            let w = area * g;
            for (sum, term) in
                a.iter_mut().zip([w.x * g.x, w.y * g.y, w.z * g.z, w.x * g.y, w.x * g.z, w.y * g.z])
            {
                *sum += term;
            }
            for wedge in wedges {
                let slope = &mut self.slopes[wedge as usize * self.stride + scalar];
                for i in 0..3 {
                    slope[i] += w[i];
                }
            }
        }
        for (wedge, origin) in wedges.into_iter().zip([p, q, r]) {
            let head = &mut self.heads[wedge as usize];
            head.origin = origin;
            head.area += area;
            head.a.iter_mut().zip(a).for_each(|(sum, term)| *sum += term);
        }
    }

    /// Adds the quadric of `from` to that of `to`, about the place and values of `to`.
    fn transfer(&mut self, from: u32, to: u32) {
        let (from, to) = (from as usize, to as usize);
        let head = self.heads[from];
        let target = &mut self.heads[to];
        let t = target.origin - head.origin;
        let at = head.times(t);
        let mut b = head.b + at;
        let mut c = t.dot(at) + 2.0 * t.dot(head.b) + head.c;
        for scalar in 0..self.stride {
            let (i, j) = (from * self.stride + scalar, to * self.stride + scalar);
            let u = self.values[j] - self.values[i];
            let [x, y, z, offset] = self.slopes[i];
            let here = offset + x * t.x + y * t.y + z * t.z - head.area * u;
            c -= u * (here + here + head.area * u);
            b -= u * Vec3::new(x, y, z);
            let slope = &mut self.slopes[j];
            for (sum, term) in slope.iter_mut().zip([x, y, z, here]) {
                *sum += term;
            }
        }
        target.b += b;
        target.c += c.max(0.0);
        target.area += head.area;
        target.a.iter_mut().zip(head.a).for_each(|(sum, term)| *sum += term);
    }
}

impl<M: ErrorMetric> ErrorMetric for WithAttributes<M> {
    fn name(&self) -> &'static str {
        match self.metric.name() {
            "quadric" => "quadric+attributes",
            "memoryless-quadric" => "memoryless-quadric+attributes",
            _ => "attributes",
        }
    }

    fn begin(&mut self, surface: &Surface, batch: Batch) {
        self.metric.begin(surface, batch);
        if batch.index == 0 || self.heads.is_empty() {
            self.build(surface);
        }
    }

    fn cost(&self, surface: &Surface, pair: Pair, position: [f32; 3]) -> f32 {
        self.metric.cost(surface, pair, position)
            + self.attribute_cost(surface, pair, Vec3::from(position), true)
    }

    fn cost_at_kept(&self, surface: &Surface, pair: Pair) -> f32 {
        // Attribute deviations are summed as plain quadrics are, with six times the integral: at the inner metric's
        // own rate they keep their weight beside it.
        let rate = self.metric.cost_per_deviation(surface, pair).map_or(1.0, |rate| rate / 6.0);
        self.metric.cost_at_kept(surface, pair)
            + rate * self.attribute_cost(surface, pair, surface.at(pair.kept), false)
    }

    fn optimum(&self, surface: &Surface, pair: Pair) -> Option<([f32; 3], f32)> {
        let (position, cost) = self.metric.optimum(surface, pair)?;
        Some((position, cost + self.attribute_cost(surface, pair, Vec3::from(position), true)))
    }

    fn collapsing(&mut self, surface: &Surface, pair: Pair, position: [f32; 3]) {
        self.metric.collapsing(surface, pair, position);
    }

    fn substituting(&mut self, surface: &Surface, substitutions: Substitutions<'_>) {
        self.metric.substituting(surface, substitutions);
        let Substitutions { position, pairs, first_new, new_vertices } = substitutions;
        let reach = pairs.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        if reach > self.heads.len() {
            self.heads.resize(reach, Head::default());
            self.values.resize(reach * self.stride, 0.0);
            self.slopes.resize(reach * self.stride, [0.0; 4]);
        }
        for (new, vertex) in new_vertices.iter().zip(first_new..) {
            self.heads[vertex as usize].origin = Vec3::from(position);
            for scalar in 0..self.stride {
                self.values[vertex as usize * self.stride + scalar] =
                    self.blend(new.from, new.weight, scalar);
            }
        }
        for &[from, to] in pairs {
            self.transfer(from, to);
        }
    }

    fn collapsed(&mut self, surface: &Surface, pair: Pair) {
        self.metric.collapsed(surface, pair);
    }

    fn cost_per_deviation(&self, surface: &Surface, pair: Pair) -> Option<f32> {
        self.metric.cost_per_deviation(surface, pair)
    }

    fn dependence(&self) -> Dependence {
        self.metric.dependence()
    }
}

/// Calls `visit` with every wedge of the lost point and the wedge of the kept point that it would become.
#[inline]
fn for_wedges(surface: &Surface, pair: Pair, mut visit: impl FnMut(u32, u32)) {
    if !surface.has_seams() {
        return visit(surface.point_vertex(pair.lost), surface.point_vertex(pair.kept));
    }
    if surface.kind(pair.lost) & kind::FEATURE == 0 && !surface.has_sheets() {
        // One wedge: any triangle on the edge tells.
        for corner in surface.star(pair.lost) {
            if let Some(side) = corner.others.iter().position(|&o| o == pair.kept) {
                let vertices = surface.corner_vertices(corner.triangle);
                let slot = corner.slot as usize;
                return visit(vertices[slot], vertices[(slot + 1 + side) % 3]);
            }
        }
    }
    let map = WedgeMap::new(surface, pair);
    map.pairs().iter().for_each(|&[from, to]| visit(from, to));
    if map.pairs().is_empty() {
        // No edge: two parts are being joined, and one wedge stands for all.
        let first = |point: u32| {
            let corner = surface.star(point).next()?;
            Some(surface.corner_vertices(corner.triangle)[corner.slot as usize])
        };
        if let (Some(from), Some(to)) = (first(pair.lost), first(pair.kept)) {
            visit(from, to);
        }
    }
}
