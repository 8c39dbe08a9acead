//! Attribute deviations on top of any metric (Hoppe 1999, "New quadric metric for simplifying meshes with
//! appearance attributes").
//!
//! ```text
//!   on a triangle, a scalar attribute s is linear in the plane:   s(x) = g . (x - p) + s_p,   g in the plane
//!   moved to x with the value v it is off by:                     area * (w * (g . (x - p) + s_p - v))^2
//!   the sum over the triangles around a wedge, with G, S the means of g and of s at the wedge's place, by area:
//!                                                                 area * (G . d + S - v)^2  +  rest(d)
//! ```
//!
//! `rest` is a quadric of the position alone: how much the triangles disagree about the value there. Two sums with areas
//! a and b and means G, S and H, T merge into a single sum, whose rest grows by `a b / (a + b) ((G - H) . d + S - T)^2`.
//! Nothing is ever subtracted: the rest of a linear attribute is 0, and single precision suffices (compare `quadric.rs`).
//! A wedge's sum goes where the wedge goes, so the two sides of a seam stay apart. The attribute cost of a collapse is
//! the sum over the lost point's wedges, each evaluated at the kept wedge replacing it.

use glam::{Vec3, Vec4};

use crate::mesh::{Attribute, Mesh, names};
use crate::simplify::options::OptionError;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::classify::kind;
use crate::simplify::surface::wedge_map::WedgeMap;

use super::loss::attribute_cost;
use super::{
    AttributeQuadric, AttributeSum, ErrorMetric, Loss, MetricEvent, MetricProperties, Optimum, Pair, Quadric,
    Substitutions,
};

/// The attributes counted by collapse costs, and their weights.
///
/// A weight is the distance costing as much as a deviation of 1 unit, as a share of the diagonal of the mesh's box: with
/// a normal weight of 0.01, a normal off by a vector of length 1 counts as much as a surface off by 1 % of the diagonal.
/// Values that are not finite count as 0.
#[derive(Debug, Clone)]
pub struct Attributes<'a> {
    mesh: &'a Mesh,
    groups: Vec<Group<'a>>,
    error: Option<OptionError>,
}

/// The scalars of a single attribute.
#[derive(Debug, Clone, Copy)]
struct Group<'a> {
    /// `None` for values outside the mesh.
    name: Option<&'a str>,
    values: &'a [f32],
    width: usize,
    weight: f32,
    /// Whether blended values are normalised to unit length.
    direction: bool,
}

impl<'a> Attributes<'a> {
    /// Counts no attribute of this mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, groups: Vec::new(), error: None }
    }

    /// Counts normals, all sets of texture coordinates and all sets of colours of the mesh, with weights for rendering:
    /// normals [`NORMAL_WEIGHT`](Self::NORMAL_WEIGHT), at most [`NORMAL_EDGES`](Self::NORMAL_EDGES) of an edge; colours
    /// [`COLOR_WEIGHT`](Self::COLOR_WEIGHT); texture coordinates [`SLIDE_WEIGHT`](Self::SLIDE_WEIGHT) times the distance
    /// covered by 1 unit on this mesh's surface; displacements as much as the distance they are off by (Mohr and Gleicher
    /// 2003, "Deformation sensitive decimation": the sum over the poses).
    pub fn customary(mesh: &'a Mesh) -> Self {
        let mut all = Self::new(mesh);
        if mesh.attribute(names::NORMAL).is_some() {
            let edges = f64::from(Self::NORMAL_EDGES) * edge_length(mesh);
            all = all.normals(f64::from(Self::NORMAL_WEIGHT).min(edges) as f32);
        }
        for attribute in mesh.attributes() {
            let name = attribute.name();
            if names::is_set_of(name, names::UV) {
                all = all.optional(name, Self::SLIDE_WEIGHT * units_per_uv(mesh, attribute));
            } else if names::is_set_of(name, names::COLOR) {
                all = all.optional(name, Self::COLOR_WEIGHT);
            } else if names::is_set_of(name, names::DISPLACEMENT) {
                all = all.optional(name, per_unit(mesh));
            }
        }
        all
    }

    /// Weight of normals in [`customary`](Self::customary).
    pub const NORMAL_WEIGHT: f32 = 0.004;
    /// Largest weight of normals, in edges of mean length. On dense meshes normals follow the roughness from edge to
    /// edge, which no coarser level can show: a larger weight only makes triangles of a single size.
    pub const NORMAL_EDGES: f32 = 0.15;
    /// Weight of colours in [`customary`](Self::customary).
    pub const COLOR_WEIGHT: f32 = 0.01;
    /// Cost of a texture sliding along the surface, as a share of the distance it slides.
    pub const SLIDE_WEIGHT: f32 = 0.4;

    /// Counts [`names::NORMAL`], if the mesh has it.
    #[must_use]
    pub fn normals(self, weight: f32) -> Self {
        self.optional(names::NORMAL, weight)
    }

    /// Counts [`names::UV`], if the mesh has it. The weight is per unit of the coordinate: a whole texture.
    #[must_use]
    pub fn uv(self, weight: f32) -> Self {
        self.optional(names::UV, weight)
    }

    /// Counts [`names::COLOR`], if the mesh has it.
    #[must_use]
    pub fn colors(self, weight: f32) -> Self {
        self.optional(names::COLOR, weight)
    }

    /// Counts the float attribute named `name`, which the mesh must have.
    #[must_use]
    pub fn custom(mut self, name: &str, weight: f32) -> Self {
        if self.mesh.attribute(name).and_then(|a| a.as_floats()).is_none() {
            self.error.get_or_insert(OptionError::NoAttribute { name: name.to_owned() });
        }
        self.optional(name, weight)
    }

    /// Counts values outside the mesh: `width` floats per vertex, vertex by vertex.
    #[must_use]
    pub fn values(mut self, values: &'a [f32], width: usize, weight: f32) -> Self {
        if width == 0 || values.len() != width * self.mesh.positions().len() {
            let value = values.len() as f64;
            let expected = "as many values as vertices times a width of 1 or more";
            self.error.get_or_insert(OptionError::OutOfRange { option: "attribute values", value, expected });
        }
        self.group(Group { name: None, values, width, weight, direction: false })
    }

    /// Whether no attribute counts.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Returns `self`, or the first error recorded while attributes were added.
    pub(crate) fn checked(self) -> Result<Self, OptionError> {
        match self.error {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }

    fn optional(self, name: &str, weight: f32) -> Self {
        let Some(attribute) = self.mesh.attribute(name) else { return self };
        let Some(values) = attribute.as_floats() else { return self };
        let direction = name == names::NORMAL && attribute.width() == 3;
        self.group(Group {
            name: Some(attribute.name()),
            values,
            width: attribute.width(),
            weight,
            direction,
        })
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

/// Largest weight, and limit on the size of value times weight (larger products are clamped): squares stay well inside
/// `f32`.
const MAX_WEIGHT: f32 = 1e6;

/// Least ratio of height to length of a triangle with a usable gradient. On thinner triangles values count as constant.
const THINNEST: f32 = 1e-5;

/// Edge length of equilateral triangles with the mesh's area and triangle count, as a share of the diagonal of the mesh's
/// box; 0 without triangles or extent.
fn edge_length(mesh: &Mesh) -> f64 {
    let at = |v: u32| Vec3::from(mesh.positions()[v as usize]).as_dvec3();
    let area = |&[a, b, c]: &[u32; 3]| 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).length();
    let (sum, count) = (mesh.triangles().iter().map(area).sum::<f64>(), mesh.triangles().len() as f64);
    let length = (4.0 / 3f64.sqrt() * sum / count).sqrt() / mesh.diagonal();
    if length.is_finite() { length } else { 0.0 }
}

/// Weight by which a deviation of 1 object unit counts as this distance; 0 without a diagonal.
fn per_unit(mesh: &Mesh) -> f32 {
    let weight = 1.0 / mesh.diagonal();
    if weight.is_finite() { weight.min(f64::from(MAX_WEIGHT)) as f32 } else { 0.0 }
}

/// Mean distance on the surface covered by 1 unit of a set of texture coordinates, as a share of the diagonal; 0 where
/// undefined (width other than 2, no area in texture space, no diagonal).
fn units_per_uv(mesh: &Mesh, set: &Attribute) -> f32 {
    let Some(uv) = set.as_floats().filter(|_| set.width() == 2) else { return 0.0 };
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

/// Squared attribute deviations on top of another metric `M`, at the exchange rate given by `M`
/// ([`ErrorMetric::cost_of`]).
///
/// The attribute part is accumulated since the input, even if `M` accumulates nothing. New vertices made by a collapse
/// get the values of least deviation, wedge by wedge. [`optimum`](ErrorMetric::optimum) weighs the values together with
/// the position: the values are eliminated, since the best value of every scalar is linear in the position. Use it with
/// the mesh given to [`Attributes::new`]; the values of vertices beyond the mesh's own count as 0.
///
/// Memory: 56 bytes per vertex plus 24 bytes per scalar of a vertex, scalars rounded up to a multiple of 4. A cost takes
/// O(scalars) per wedge.
///
/// ```
/// use multires::simplify::metric::{Attributes, LindstromTurk, WithAttributes};
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// let mesh = shapes::demo();
/// let metric = WithAttributes::with(LindstromTurk::new(), &Attributes::new(&mesh).normals(0.1))?;
/// let sequence = Simplifier::new().metric(metric).target(Target::Ratio(0.2)).run(&mesh)?;
/// assert!(sequence.report().triangles < mesh.triangles().len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WithAttributes<M = Quadric> {
    metric: M,
    /// Names of the counted attributes that belong to the mesh.
    names: Vec<String>,
    /// Blocks of 4 scalars per vertex; lanes beyond the last scalar are 0.
    stride: usize,
    /// The input's values times weight, `stride` blocks per vertex, as shares of the diagonal.
    source: Vec<Vec4>,
    /// Diagonal of the mesh's box, object units.
    diagonal: f64,
    /// First scalar and weight of every direction attribute.
    directions: Vec<(usize, f32)>,
    /// Whether to count no attributes if the inner metric counts attributes already.
    yields: bool,
    /// Whether the inner metric counts attributes already, and `yields` is set.
    yielded: bool,
    /// The diagonal, inner units.
    unit: f32,
    /// Values in the inner frame, one set per vertex, including new vertices.
    values: Vec<Vec4>,
    heads: Vec<Head>,
    /// `stride` per vertex.
    planes: Vec<Planes>,
}

/// The part of a wedge's sum independent of the number of scalars: its area, and its rest `d'Rd + 2 b'd + c` at the best
/// values.
#[derive(Debug, Clone, Copy, Default)]
struct Head {
    origin: Vec3,
    /// xx, yy, zz, xy, xz, yz.
    rest: [f32; 6],
    b: Vec3,
    c: f32,
    area: f32,
}

impl Head {
    #[inline]
    fn times(&self, d: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, xz, yz] = self.rest;
        Vec3::new(
            xx * d.x + xy * d.y + xz * d.z,
            xy * d.x + yy * d.y + yz * d.z,
            xz * d.x + yz * d.y + zz * d.z,
        )
    }

    /// The rest at `d` from the origin.
    #[inline]
    fn at(&self, d: Vec3) -> f32 {
        d.dot(self.times(d)) + 2.0 * d.dot(self.b) + self.c
    }
}

/// The mean slopes of 4 scalars, and their mean values at the origin.
#[derive(Debug, Clone, Copy, Default)]
struct Planes {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    value: Vec4,
}

impl Planes {
    /// The best values at `d` from the origin.
    #[inline]
    fn at(&self, d: Vec3) -> Vec4 {
        self.value + self.x * d.x + self.y * d.y + self.z * d.z
    }

    /// Subtracts `other`, relative to the same origin.
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
            value: self.value - other.value,
        }
    }

    /// Moves by `share` of `difference`.
    #[inline]
    fn toward(&mut self, difference: &Self, share: f32) {
        self.x += difference.x * share;
        self.y += difference.y * share;
        self.z += difference.z * share;
        self.value += difference.value * share;
    }
}

/// Sums of squared differences of planes, lane by lane.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    rest: [Vec4; 6],
    b: [Vec4; 3],
    c: Vec4,
}

impl Squares {
    #[inline]
    fn add(&mut self, Planes { x, y, z, value }: &Planes) {
        let (x, y, z, value) = (*x, *y, *z, *value);
        let terms = [x * x, y * y, z * z, x * y, x * z, y * z];
        self.rest.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        self.b.iter_mut().zip([x, y, z]).for_each(|(sum, slope)| *sum += slope * value);
        self.c += value * value;
    }

    /// Sums over the lanes times `weight`: squared slopes, slope times value, squared values.
    #[inline]
    fn weighed(&self, weight: f32) -> ([f32; 6], Vec3, f32) {
        (
            self.rest.map(|x| weight * sum(x)),
            Vec3::from_array(self.b.map(|x| weight * sum(x))),
            weight * sum(self.c),
        )
    }
}

/// `a b / (a + b)`; 0 if `a + b` is 0.
#[inline]
fn joint(a: f32, b: f32) -> f32 {
    if a + b > 0.0 { a * (b / (a + b)) } else { 0.0 }
}

/// The next corner of a triangle after each corner.
const NEXT: [usize; 3] = [1, 2, 0];

/// Sums 4 numbers in a fixed order, equal on every machine.
#[inline]
fn sum(lanes: Vec4) -> f32 {
    let [x, y, z, w] = lanes.to_array();
    (x + y) + (z + w)
}

impl WithAttributes<Quadric> {
    /// Combines accumulated quadrics with the [customary](Attributes::customary) attributes of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(Quadric::new(), &Attributes::customary(mesh), false)
    }
}

impl<M: ErrorMetric> WithAttributes<M> {
    /// Combines a metric with chosen attributes, whose values are copied. O(values).
    ///
    /// # Errors
    /// A weight outside 0 to 1,000,000, an attribute missing in the mesh, or values of the wrong length.
    pub fn with(metric: M, attributes: &Attributes<'_>) -> Result<Self, OptionError> {
        match &attributes.error {
            Some(error) => Err(error.clone()),
            None => Ok(Self::of(metric, attributes, false)),
        }
    }

    /// Combines a metric with chosen attributes, ignored if the metric counts attributes by itself.
    pub(crate) fn by_default(metric: M, attributes: &Attributes<'_>) -> Self {
        Self::of(metric, attributes, true)
    }

    fn of(metric: M, attributes: &Attributes<'_>, yields: bool) -> Self {
        let scalars: usize = attributes.groups.iter().map(|g| g.width).sum();
        let stride = scalars.div_ceil(4);
        let vertices = attributes.mesh.positions().len();
        let mut source = Vec::with_capacity(stride * vertices);
        let mut row = vec![0.0; stride * 4];
        for vertex in 0..vertices {
            let mut at = 0;
            for group in &attributes.groups {
                let scalars = &group.values[vertex * group.width..][..group.width];
                for &x in scalars {
                    let scaled = if x.is_finite() { x * group.weight } else { 0.0 };
                    row[at] = scaled.clamp(-MAX_WEIGHT, MAX_WEIGHT);
                    at += 1;
                }
            }
            source.extend(row.chunks_exact(4).map(Vec4::from_slice));
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
            names: attributes.groups.iter().filter_map(|g| g.name.map(str::to_owned)).collect(),
            stride,
            source,
            diagonal: attributes.mesh.diagonal(),
            directions,
            yields,
            yielded: false,
            unit: 0.0,
            values: Vec::new(),
            heads: Vec::new(),
            planes: Vec::new(),
        }
    }
}

impl<M> WithAttributes<M> {
    /// Whether the inner metric's cost is the whole cost.
    fn is_idle(&self) -> bool {
        self.stride == 0 || self.yielded
    }

    /// The values of a vertex.
    #[inline]
    fn values_of(&self, vertex: u32) -> &[Vec4] {
        &self.values[vertex as usize * self.stride..][..self.stride]
    }

    #[inline]
    fn planes_of(&self, vertex: u32) -> &[Planes] {
        &self.planes[vertex as usize * self.stride..][..self.stride]
    }

    /// Squared deviation of `wedge` at position `x` with the values of vertex `like`, times area.
    #[inline]
    fn deviation(&self, wedge: u32, x: Vec3, like: u32) -> f32 {
        let head = &self.heads[wedge as usize];
        let d = x - head.origin;
        let mut off = Vec4::ZERO;
        for (planes, value) in self.planes_of(wedge).iter().zip(self.values_of(like)) {
            let u = *value - planes.at(d);
            off += u * u;
        }
        head.area * sum(off) + head.at(d).max(0.0)
    }

    /// Squared deviation of wedge `from` at position `x` with the values of wedge `to`.
    #[inline]
    fn off_of_wedge(&self, from: u32, to: u32, x: Vec3) -> AttributeSum {
        AttributeSum { sum: self.deviation(from, x, to), area: self.heads[from as usize].area, added: true }
    }

    /// Squared deviations of the attributes if `pair` is merged at the kept point. `whole` includes the deviations
    /// already carried by the kept wedges.
    fn off_at_kept(&self, surface: &WorkingSurface, pair: Pair, whole: bool) -> AttributeSum {
        let mut off = AttributeSum { added: !whole, ..AttributeSum::default() };
        let x = surface.at(pair.kept);
        for_wedges(surface, pair, |lost, kept| {
            off.sum += self.deviation(lost, x, kept);
            off.area += self.heads[lost as usize].area;
            if whole {
                off.sum += self.deviation(kept, x, kept);
                off.area += self.heads[kept as usize].area;
            }
        });
        off.sum = off.sum.min(f32::MAX);
        off
    }

    /// Squared deviations of the attributes as a function of the merged position, with the best values at each position.
    fn off_anywhere(&self, surface: &WorkingSurface, pair: Pair) -> AttributeQuadric {
        let origin = surface.at(pair.lost);
        let mut all = AttributeQuadric { origin, ..AttributeQuadric::default() };
        for_wedges(surface, pair, |lost, kept| self.add_wedges(&mut all, lost, kept));
        all
    }

    /// Adds the squared deviation of the wedge merged from `lost` and `kept`, as a function of position, with the best
    /// values there.
    #[inline]
    fn add_wedges(&self, all: &mut AttributeQuadric, lost: u32, kept: u32) {
        self.add_rest(all, lost);
        // Two parts not joined by an edge may share a wedge already.
        if lost == kept {
            return;
        }
        self.add_rest(all, kept);
        let (first, second) = (&self.heads[lost as usize], &self.heads[kept as usize]);
        let t = first.origin - second.origin;
        let mut squares = Squares::default();
        for (mine, theirs) in self.planes_of(lost).iter().zip(self.planes_of(kept)) {
            squares.add(&mine.minus(&Planes { value: theirs.at(t), ..*theirs }));
        }
        let (rest, b, c) = squares.weighed(joint(first.area, second.area));
        all.h.0.iter_mut().zip(rest).for_each(|(sum, x)| *sum += f64::from(x));
        all.b += b.as_dvec3();
        all.constant += f64::from(c);
    }

    /// Adds the rest of a wedge at its best values.
    #[inline]
    fn add_rest(&self, all: &mut AttributeQuadric, wedge: u32) {
        let head = &self.heads[wedge as usize];
        let t = all.origin - head.origin;
        all.h.0.iter_mut().zip(head.rest).for_each(|(sum, x)| *sum += f64::from(x));
        all.b += (head.b + head.times(t)).as_dvec3();
        all.constant += f64::from(head.at(t).max(0.0));
        all.area += head.area;
    }

    /// Builds the sums of the current surface, over the triangles in order, so that results are reproducible.
    fn build(&mut self, surface: &WorkingSurface) {
        let triangles = || (0..surface.triangle_count() as u32).filter(|&t| surface.triangle(t).is_some());
        let vertices = triangles().flat_map(|t| surface.layers(t)).flat_map(|layer| layer.vertices);
        let count = vertices.max().map_or(0, |v| v as usize + 1);
        self.unit = (self.diagonal * surface.frame().scale()) as f32;
        self.values.clear();
        self.values.extend(self.source.iter().map(|x| *x * self.unit));
        let count = count.max(self.source.len() / self.stride.max(1));
        self.values.resize(count * self.stride, Vec4::ZERO);
        self.heads.clear();
        self.heads.resize(count, Head::default());
        self.planes.clear();
        self.planes.extend(self.values.iter().map(|&value| Planes { value, ..Planes::default() }));
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

    /// Adds a triangle to the sums of its three wedges. At each wedge the triangle agrees with the wedge's value; only
    /// the slopes differ.
    fn add_triangle(&mut self, [p, q, r]: [Vec3; 3], wedges: [u32; 3]) {
        let (e, f) = (q - p, r - p);
        let cross = e.cross(f);
        let area = cross.length();
        let longest = e.length_squared().max(f.length_squared()).max(q.distance_squared(r));
        let inverse = if area > THINNEST * longest { 1.0 / area } else { 0.0 };
        // grad s = (s_q - s_p) * along_e + (s_r - s_p) * along_f
        let normal = cross * inverse;
        let (along_e, along_f) = (f.cross(normal) * inverse, normal.cross(e) * inverse);
        let mut squares = [Squares::default(); 3];
        for block in 0..self.stride {
            let [sp, sq, sr] = wedges.map(|w| self.values[w as usize * self.stride + block]);
            let (se, sf) = (sq - sp, sr - sp);
            let [x, y, z] = [0, 1, 2].map(|i| se * along_e[i] + sf * along_f[i]);
            for (&wedge, squares) in wedges.iter().zip(&mut squares) {
                let own = &mut self.planes[wedge as usize * self.stride + block];
                let difference = Planes { x, y, z, value: own.value }.minus(own);
                squares.add(&difference);
                let before = self.heads[wedge as usize].area;
                own.toward(&difference, if before + area > 0.0 { area / (before + area) } else { 0.0 });
            }
        }
        for ((wedge, origin), squares) in wedges.into_iter().zip([p, q, r]).zip(squares) {
            let head = &mut self.heads[wedge as usize];
            let (rest, ..) = squares.weighed(joint(head.area, area));
            head.origin = origin;
            head.rest.iter_mut().zip(rest).for_each(|(sum, term)| *sum += term);
            head.area += area;
        }
    }

    /// Adds the sum of wedge `from` to the sum of wedge `to`, relative to the origin of `to`.
    fn transfer(&mut self, from: u32, to: u32) {
        let head = self.heads[from as usize];
        let (before, t) = (self.heads[to as usize].area, self.heads[to as usize].origin - head.origin);
        let both = before + head.area;
        let share = if both > 0.0 { head.area / both } else { 0.0 };
        let mut squares = Squares::default();
        for block in 0..self.stride {
            let more = self.planes[from as usize * self.stride + block];
            let own = &mut self.planes[to as usize * self.stride + block];
            let difference = Planes { value: more.at(t), ..more }.minus(own);
            squares.add(&difference);
            own.toward(&difference, share);
        }
        let (rest, b, c) = squares.weighed(joint(before, head.area));
        let target = &mut self.heads[to as usize];
        target.rest.iter_mut().zip(head.rest).zip(rest).for_each(|((sum, x), y)| *sum += x + y);
        target.b += head.b + head.times(t) + b;
        target.c += head.at(t).max(0.0) + c;
        target.area += head.area;
    }

    /// Merges the sums of replaced vertices, and gives new vertices the best values at the merged point.
    fn substitute(&mut self, position: [f32; 3], substitutions: Substitutions<'_>) {
        let Substitutions { pairs, first_new, new_vertices } = substitutions;
        let reach = pairs.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        if reach > self.heads.len() {
            self.heads.resize(reach, Head::default());
            self.values.resize(reach * self.stride, Vec4::ZERO);
            self.planes.resize(reach * self.stride, Planes::default());
        }
        for (new, vertex) in new_vertices.iter().zip(first_new..) {
            self.heads[vertex as usize].origin = Vec3::from(position);
            for block in 0..self.stride {
                let [a, b] = new.from.map(|v| self.values[v as usize * self.stride + block]);
                let value = a + (b - a) * new.weight;
                // Without an area only the blended value is known.
                self.planes[vertex as usize * self.stride + block].value = value;
                self.values[vertex as usize * self.stride + block] = value;
            }
        }
        for &[from, to] in pairs {
            self.transfer(from, to);
        }
        for vertex in (first_new..).take(new_vertices.len()) {
            self.solve(vertex);
        }
    }

    /// Gives a vertex the best values at its position; directions are normalised.
    fn solve(&mut self, vertex: u32) {
        let first = vertex as usize * self.stride;
        for (value, planes) in self.values[first..].iter_mut().zip(&self.planes[first..]) {
            *value = planes.value;
        }
        for &(scalar, weight) in &self.directions {
            let at = |i: usize| (first + (scalar + i) / 4, (scalar + i) % 4);
            let direction = Vec3::from_array(std::array::from_fn(|i| self.values[at(i).0][at(i).1]));
            if let Some(unit) = direction.try_normalize() {
                let direction = unit * (weight * self.unit);
                (0..3).for_each(|i| self.values[at(i).0][at(i).1] = direction[i]);
            }
        }
    }
}

/// Costs of attributes on top of those of the metric.
impl<M: ErrorMetric> WithAttributes<M> {
    /// Returns the cost of the attributes where `pair` is merged at a position.
    fn added_at(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let off = if position == surface.position(pair.kept) {
            self.off_at_kept(surface, pair, true)
        } else {
            self.off_anywhere(surface, pair).at(position)
        };
        attribute_cost(&self.metric, surface, pair, off)
    }

    /// Adds the costs of the attributes where `lost` is merged into each of `kept` as it is.
    fn add_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        if let ([kept], [cost]) = (kept, &mut *costs) {
            let pair = Pair { lost, kept: *kept };
            *cost += attribute_cost(&self.metric, surface, pair, self.off_at_kept(surface, pair, false));
            return;
        }
        let is_plain = surface.kind(lost) & (kind::FEATURE | kind::WEDGES) == 0;
        let one_wedge = surface.has_seams() && is_plain;
        let mut star = surface.star(lost);
        for (&kept, cost) in kept.iter().zip(costs) {
            let pair = Pair { lost, kept };
            // Neighbours mostly come in the order of the star, so the current triangle gives both wedges.
            let corner = if one_wedge { star.next().filter(|c| c.others[0] == kept) } else { None };
            let off = match corner {
                Some(corner) => {
                    let vertices = surface.corner_vertices(corner.triangle);
                    let [from, to] = [corner.slot as usize, NEXT[corner.slot as usize]].map(|i| vertices[i]);
                    self.off_of_wedge(from, to, surface.at(kept))
                }
                None => self.off_at_kept(surface, pair, false),
            };
            *cost += attribute_cost(&self.metric, surface, pair, off);
        }
    }
}

impl<M: ErrorMetric> ErrorMetric for WithAttributes<M> {
    #[inline]
    fn cost(&self, surface: &WorkingSurface, pair: Pair, position: [f32; 3]) -> f32 {
        let cost = self.metric.cost(surface, pair, position);
        if self.is_idle() { cost } else { cost + self.added_at(surface, pair, position) }
    }

    #[inline]
    fn costs_at_kept(&self, surface: &WorkingSurface, lost: u32, kept: &[u32], costs: &mut [f32]) {
        self.metric.costs_at_kept(surface, lost, kept, costs);
        if !self.is_idle() {
            self.add_at_kept(surface, lost, kept, costs);
        }
    }

    /// Counts the attributes of this metric. The cost of further attributes is added by whoever asks with them.
    fn optimum(
        &self,
        surface: &WorkingSurface,
        pair: Pair,
        attributes: &AttributeQuadric,
    ) -> Option<Optimum> {
        if self.is_idle() {
            return self.metric.optimum(surface, pair, attributes);
        }
        let own = self.off_anywhere(surface, pair);
        let Optimum { position, cost, counts_attributes } = self.metric.optimum(surface, pair, &own)?;
        let added = match counts_attributes {
            true => 0.0,
            false => attribute_cost(&self.metric, surface, pair, own.at(position)),
        };
        Some(Optimum::new(position, cost + added))
    }

    fn cost_of(&self, surface: &WorkingSurface, pair: Pair, loss: Loss) -> Option<f32> {
        self.metric.cost_of(surface, pair, loss)
    }

    fn update(&mut self, surface: &WorkingSurface, event: MetricEvent<'_>) {
        self.metric.update(surface, event);
        match event {
            MetricEvent::Begin(batch) => {
                self.yielded = self.yields && self.metric.properties().attributes.is_some();
                if batch.index == 0 || self.heads.is_empty() {
                    self.build(surface);
                }
            }
            MetricEvent::Collapsing { position, substitutions, .. } => {
                self.substitute(position, substitutions);
            }
            MetricEvent::Collapsed { .. } => {}
        }
    }

    fn properties(&self) -> MetricProperties<'_> {
        let inner = self.metric.properties();
        let name = match inner.name {
            "quadric" => "quadric+attributes",
            "memoryless-quadric" => "memoryless-quadric+attributes",
            "lindstrom-turk" => "lindstrom-turk+attributes",
            "volume-area" => "volume-area+attributes",
            "unsigned-volume" => "unsigned-volume+attributes",
            "hybrid" => "hybrid+attributes",
            "progressive-mesh" => "progressive-mesh+attributes",
            "edge-length" => "edge-length+attributes",
            _ => "attributes",
        };
        let names = if self.is_idle() { inner.attributes.unwrap_or_default() } else { &self.names };
        MetricProperties { name, ..inner }.with_attributes(names)
    }
}

/// Calls `visit` with every wedge of the lost point and the wedge of the kept point replacing it.
#[inline]
fn for_wedges(surface: &WorkingSurface, pair: Pair, mut visit: impl FnMut(u32, u32)) {
    if !surface.has_seams() {
        return visit(surface.point_vertex(pair.lost), surface.point_vertex(pair.kept));
    }
    if surface.kind(pair.lost) & kind::WEDGES == 0 {
        // A single wedge: any triangle on the edge gives its partner.
        for corner in surface.star(pair.lost) {
            if let Some(side) = corner.others.iter().position(|&o| o == pair.kept) {
                let vertices = surface.corner_vertices(corner.triangle);
                let slot = corner.slot as usize;
                return visit(vertices[slot], vertices[(slot + 1 + side) % 3]);
            }
        }
    }
    // While seams hold, a wedge without a partner makes the collapse illegal at any cost.
    let map = if surface.holds(kind::SEAM) {
        WedgeMap::new(surface, pair)
    } else {
        WedgeMap::chosen(surface, pair)
    };
    map.pairs().iter().for_each(|&[from, to]| visit(from, to));
    if map.pairs().is_empty() {
        // Without an edge two parts are being joined: a single wedge stands for all.
        let first = |point: u32| {
            let corner = surface.star(point).next()?;
            Some(surface.corner_vertices(corner.triangle)[corner.slot as usize])
        };
        if let (Some(from), Some(to)) = (first(pair.lost), first(pair.kept)) {
            visit(from, to);
        }
    }
}
