//! Values distinguishing wedges: texture coordinates, normals and colours of every vertex; and the side of texture
//! space of each triangle.

use glam::Vec3;

use crate::geometry::segment::blend_weight;
use crate::geometry::texture::{area, side};
use crate::mesh::{Attribute, Mesh, names};
use crate::simplify::metric::Pair;
use crate::simplify::surface::{Corner, WorkingSurface};

use super::classify::kind;
use super::sheets::Layer;
use super::wedge_map::WedgeMap;

/// Weight of a deviation of 1 in a normal; `COLOR`: in a colour. Shares of the diagonal.
const NORMAL: f32 = 0.003;
const COLOR: f32 = 0.01;
/// Weight of sliding texture, as a share of the distance slid.
const SLIDE: f32 = 0.1;
/// Values per vertex, new vertices included.
#[derive(Debug, Clone, Default)]
pub(crate) struct WedgeValues {
    /// Number of sets of texture coordinates, which come first.
    sets: usize,
    /// Weight of a deviation of 1, per scalar.
    weights: Vec<f32>,
    /// Range of the normal's scalars; empty without normals.
    normal: std::ops::Range<usize>,
    data: Vec<f32>,
    /// Per triangle and set its side in the input: 1 or -1, 0 for none.
    sides: Vec<i8>,
}

impl WedgeValues {
    /// Collects texture coordinates, and with `seams` also normals and colours. O(values).
    pub fn new(mesh: &Mesh, seams: bool) -> Self {
        let is_set = |name: &str, stem: &str| {
            name.strip_prefix(stem).is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()))
        };
        let of = |stem: &'static str| {
            mesh.attributes().iter().filter(move |a| is_set(a.name(), stem) && a.as_floats().is_some())
        };
        let mut chosen: Vec<(&Attribute, f32)> = Vec::new();
        chosen.extend(of(names::UV).filter(|a| a.width() == 2).map(|a| (a, SLIDE * units_per_uv(mesh, a))));
        let sets = chosen.len();
        let mut normal = 0..0;
        if seams {
            if let Some(attribute) = of(names::NORMAL).find(|a| a.name() == names::NORMAL && a.width() == 3) {
                normal = 2 * sets..2 * sets + 3;
                chosen.push((attribute, NORMAL));
            }
            chosen.extend(of(names::COLOR).map(|a| (a, COLOR)));
        }
        let weights: Vec<f32> = chosen.iter().flat_map(|&(a, w)| std::iter::repeat_n(w, a.width())).collect();
        let count = if chosen.is_empty() { 0 } else { mesh.positions().len() };
        let mut data = Vec::with_capacity(count * weights.len());
        for vertex in 0..count {
            for (attribute, _) in &chosen {
                let width = attribute.width();
                data.extend_from_slice(&attribute.as_floats().unwrap_or(&[])[vertex * width..][..width]);
            }
        }
        let mut values = Self { sets, weights, normal, data, sides: Vec::new() };
        values.sides.reserve(sets * mesh.triangles().len());
        for &triangle in mesh.triangles() {
            for set in 0..sets {
                let corners = triangle.map(|v| values.uv(set, v));
                values.sides.push(side(corners));
            }
        }
        values
    }

    fn of(&self, vertex: u32) -> &[f32] {
        let stride = self.weights.len();
        &self.data[vertex as usize * stride..][..stride]
    }

    fn uv(&self, set: usize, vertex: u32) -> [f32; 2] {
        let at = vertex as usize * self.weights.len() + 2 * set;
        [self.data[at], self.data[at + 1]]
    }

    /// Returns the squared distance between the values of two vertices, in shares of the diagonal. Non-finite values do
    /// not count.
    pub fn distance_squared(&self, a: u32, b: u32) -> f32 {
        let terms = self.of(a).iter().zip(self.of(b)).zip(&self.weights).map(|((a, b), w)| {
            let d = w * (a - b);
            if d.is_finite() { d * d } else { 0.0 }
        });
        terms.sum()
    }

    /// Returns true first if two vertices differ, and second if only their normals differ.
    pub fn differ(&self, a: u32, b: u32) -> (bool, bool) {
        let (mut any, mut beside) = (false, false);
        for (i, (a, b)) in self.of(a).iter().zip(self.of(b)).enumerate() {
            let differs = a.to_bits() != b.to_bits();
            any |= differs;
            beside |= differs && !self.normal.contains(&i);
        }
        (any, any && !beside)
    }

    /// Appends a vertex blended of two, as the sequence does.
    pub fn push_blend(&mut self, [a, b]: [u32; 2], weight: f32) {
        let stride = self.weights.len();
        for i in 0..stride {
            let (a, b) = (self.data[a as usize * stride + i], self.data[b as usize * stride + i]);
            self.data.push(mix(a, b, weight));
        }
    }
}

fn mix(a: f32, b: f32, weight: f32) -> f32 {
    if weight == 0.0 || a.to_bits() == b.to_bits() { a } else { a + (b - a) * weight }
}

/// Returns the distance on the surface covered by 1 unit of a texture on average, as a share of the diagonal; 0 where
/// undefined.
fn units_per_uv(mesh: &Mesh, uv: &Attribute) -> f32 {
    let values = uv.as_floats().unwrap_or(&[]);
    let (mut surface, mut texture) = (0.0f64, 0.0f64);
    for t in mesh.triangles() {
        let [p, q, r] = t.map(|v| glam::DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        let (covered, _) = area(t.map(|v| [values[2 * v as usize], values[2 * v as usize + 1]]));
        if covered.is_finite() {
            surface += (q - p).cross(r - p).length();
            texture += covered.abs();
        }
    }
    let diagonal = mesh.diagonal();
    if texture > 0.0 && diagonal > 0.0 {
        ((surface / texture).sqrt() / diagonal).min(1e6) as f32
    } else {
        0.0
    }
}

impl WorkingSurface {
    /// Appends the values of a new vertex.
    pub(crate) fn add_vertex(&mut self, from: [u32; 2], weight: f32) {
        self.values.push_blend(from, weight);
    }

    /// Returns true if merging `pair` at `x` leaves every triangle on its side of texture space. O(valence).
    pub(crate) fn keeps_uv_sides(&self, pair: Pair, x: Vec3) -> bool {
        let sets = self.values.sets;
        if sets == 0 {
            return true;
        }
        let stays = x == self.at(pair.kept);
        let share = blend_weight(self.at(pair.lost), self.at(pair.kept), x);
        let blend = |set: usize, partner: Option<u32>, kept: u32| {
            let b = self.values.uv(set, kept);
            match partner {
                Some(a) if !stays => {
                    let a = self.values.uv(set, a);
                    [mix(a[0], b[0], share), mix(a[1], b[1], share)]
                }
                _ => b,
            }
        };
        let either = self.kind(pair.lost) | self.kind(pair.kept);
        if !self.has_seams() || either & kind::WEDGES == 0 {
            // A single wedge each.
            let vertex = |point: u32| {
                let corner = self.star(point).next()?;
                Some(self.corner_vertices(corner.triangle)[corner.slot as usize])
            };
            let (Some(lost), Some(kept)) = (vertex(pair.lost), vertex(pair.kept)) else { return true };
            let to = |set: usize, _: u32| blend(set, Some(lost), kept);
            return self.keep_sides(pair.lost, pair.kept, to)
                && (stays || self.keep_sides(pair.kept, pair.lost, to));
        }
        let map = WedgeMap::chosen(self, pair);
        if map.overflows() {
            return false;
        }
        let of_kept = |set: usize, kept: u32| {
            let kept = map.root(kept);
            blend(set, map.partner(kept), kept)
        };
        let of_lost = |set: usize, lost: u32| match map.get(lost) {
            Some(to) if to != lost => of_kept(set, to),
            _ => self.values.uv(set, lost),
        };
        self.keep_sides(pair.lost, pair.kept, of_lost)
            && (stays && !map.joins_kept() || self.keep_sides(pair.kept, pair.lost, of_kept))
    }

    /// Returns true if the triangles of the lost point's wedge `from` stay on their sides with `to` in its place.
    pub(crate) fn keeps_sides_of(&self, pair: Pair, from: u32, to: u32) -> bool {
        self.star(pair.lost).filter(|corner| !corner.others.contains(&pair.kept)).all(|corner| {
            let mut own =
                self.layers(corner.triangle).filter(|layer| layer.vertices[corner.slot as usize] == from);
            own.all(|layer| self.layer_keeps_side(corner.slot, layer, |set, _| self.values.uv(set, to)))
        })
    }

    /// Returns true if every triangle around a point, except triangles with `other`, stays on its side when the
    /// coordinates of the point's wedges become `to`.
    fn keep_sides(&self, point: u32, other: u32, to: impl Fn(usize, u32) -> [f32; 2]) -> bool {
        let mut corners = self.star(point).filter(|corner| !corner.others.contains(&other));
        corners.all(|corner| self.keeps_side(corner, &to))
    }

    fn keeps_side(&self, corner: Corner, to: impl Fn(usize, u32) -> [f32; 2]) -> bool {
        self.layers(corner.triangle).all(|layer| self.layer_keeps_side(corner.slot, layer, &to))
    }

    fn layer_keeps_side(&self, slot: u8, layer: Layer, to: impl Fn(usize, u32) -> [f32; 2]) -> bool {
        let (values, vertices) = (&self.values, layer.vertices);
        (0..values.sets).all(|set| {
            let input = values.sides[layer.triangle as usize * values.sets + set];
            if input == 0 {
                return true;
            }
            // The layer's vertices come in the leader's order.
            let input = if layer.opposite { -input } else { input };
            let before = vertices.map(|v| values.uv(set, v));
            let mut after = before;
            after[slot as usize] = to(set, vertices[slot as usize]);
            let now = side(after);
            // A triangle without a side may stay without, but not go over to the other side.
            now == input || now == 0 && side(before) == 0 && area(after).0 * f64::from(input) >= 0.0
        })
    }
}
