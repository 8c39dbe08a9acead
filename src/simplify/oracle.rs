//! Legality of collapses: small rules checked in order, each counting its refusals.
//!
//! Any collapse leaves a valid mesh (an image of the input's triangles). The rules decide whether the mesh is *good*:
//! same topology, no flipped triangles, seams and borders in place.

use crate::mesh::NONE;

pub use super::apart::SelfIntersection;
use super::classify::kind;
use super::metric::Pair;
use super::patch::{Facet, Patch, quality};
use super::surface::WorkingSurface;
use super::wedge_map::WedgeMap;

/// A collapse submitted to an oracle.
#[derive(Debug, Clone, Copy)]
pub struct Collapse<'a> {
    /// The lost and the kept point.
    pub pair: Pair,
    /// Position of the merged point, inner frame.
    pub position: [f32; 3],
    /// The triangles changed by the collapse, before and after.
    pub patch: &'a Patch,
}

impl Collapse<'_> {
    /// Whether the kept point does not move.
    pub fn keeps_position(&self, surface: &WorkingSurface) -> bool {
        surface.position(self.pair.kept) == self.position
    }
}

/// Data read by an oracle besides the surface. Around points with many triangles, the whole patch is gathered only for
/// candidates allowed by the rules that read less.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reads {
    /// Only the pair and the position.
    Pair,
    /// The patch's facets, each independently: a facet refused alone is refused in any patch.
    Facets,
    /// The patch as a whole.
    #[default]
    Patch,
}

/// A rule deciding which collapses are legal.
pub trait Oracle: Send + Sync {
    /// Name under which refusals are counted.
    fn name(&self) -> &str;

    /// Whether the collapse is legal.
    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool;

    /// The data read by the rule. Default: the whole patch, which is always correct.
    fn reads(&self) -> Reads {
        Reads::Patch
    }

    /// Cost factor of candidates refused by this rule, at least 1: the candidate is done once collapses of the increased
    /// cost are due. Default `None`: a refused candidate is never done.
    fn surcharge(&self) -> Option<f32> {
        None
    }

    /// Called before the first collapse on a surface. Returns whether the rule wants calls of
    /// [`changed`](Oracle::changed). Default: no.
    fn begin(&mut self, surface: &WorkingSurface) -> bool {
        let _ = surface;
        false
    }

    /// Called after each step if [`begin`](Oracle::begin) returned true. The triangles `dead` are removed, and the
    /// triangles around `kept` may have changed (`None` if a part vanished and nothing else changed).
    fn changed(&mut self, surface: &WorkingSurface, kept: Option<u32>, dead: &[u32]) {
        let _ = (surface, kept, dead);
    }

    /// Whether a part of the surface may vanish as a whole ([`Parts::Vanish`](super::Parts::Vanish)). `points` are all
    /// points of the part. Default: yes.
    fn allows_vanishing(&self, surface: &WorkingSurface, points: &[u32]) -> bool {
        let _ = (surface, points);
        true
    }

    /// Whether the rule keeps the topology. Such rules do not apply to joined parts
    /// ([`join_distance`](super::Simplifier::join_distance)), whose topology has changed anyway, and they give before a
    /// size is missed ([`Permissive`](super::Permissive)). Default: no.
    fn keeps_topology(&self) -> bool {
        false
    }
}

/// Returns the default rules, in the order of their checks: cheap rules first.
pub fn default_oracles() -> Vec<Box<dyn Oracle>> {
    vec![
        Box::new(Locks),
        Box::new(Borders::Slide),
        Box::new(NonManifold::Slide),
        Box::new(Seams),
        Box::new(Materials),
        Box::new(LinkCondition),
        Box::new(NormalFlip::default()),
        Box::new(TriangleQuality::default()),
        Box::new(UvOrientation),
    ]
}

/// Locked vertices neither move nor vanish.
#[derive(Debug, Clone, Copy, Default)]
pub struct Locks;

impl Oracle for Locks {
    fn name(&self) -> &str {
        "locks"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        !surface.is_locked(collapse.pair.lost)
            && (!surface.is_locked(collapse.pair.kept) || collapse.keeps_position(surface))
    }

    fn reads(&self) -> Reads {
        Reads::Pair
    }

    fn allows_vanishing(&self, surface: &WorkingSurface, points: &[u32]) -> bool {
        !points.iter().any(|&point| surface.is_locked(point))
    }
}

/// Collapses allowed at open borders.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Borders {
    /// A border point moves only along its border: borders are simplified but never leave themselves.
    #[default]
    Slide,
    /// Border points stay unchanged: for tiles that must fit their neighbours.
    Locked,
}

impl Oracle for Borders {
    fn name(&self) -> &str {
        "border"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let slide = *self == Self::Slide;
        stays_on_curve(surface, collapse, kind::BORDER, slide)
    }

    fn reads(&self) -> Reads {
        Reads::Pair
    }

    fn allows_vanishing(&self, surface: &WorkingSurface, points: &[u32]) -> bool {
        *self == Self::Slide || !points.iter().any(|&point| surface.is_border(point))
    }

    fn keeps_topology(&self) -> bool {
        *self == Self::Slide
    }
}

/// Collapses allowed at non-manifold edges and vertices.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NonManifold {
    /// Curves of non-manifold edges are simplified along themselves, as borders are: a point on a curve moves only along
    /// the curve. Points at the ends of curves or where several curves meet stay. A pinch (a point where fans without a
    /// common edge meet) moves with all its fans to a neighbour that is neither non-manifold nor on a border.
    #[default]
    Slide,
    /// Non-manifold points stay unchanged.
    Locked,
}

impl Oracle for NonManifold {
    fn name(&self) -> &str {
        "non-manifold"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let slide = *self == Self::Slide;
        stays_on_curve(surface, collapse, kind::NON_MANIFOLD, slide)
            || slide && moves_pinch(surface, collapse)
    }

    fn reads(&self) -> Reads {
        Reads::Pair
    }

    fn allows_vanishing(&self, surface: &WorkingSurface, points: &[u32]) -> bool {
        *self == Self::Slide || !points.iter().any(|&point| surface.is_non_manifold(point))
    }

    fn keeps_topology(&self) -> bool {
        *self == Self::Slide
    }
}

/// Borders between materials move only along themselves.
#[derive(Debug, Clone, Copy, Default)]
pub struct Materials;

impl Oracle for Materials {
    fn name(&self) -> &str {
        "material"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        stays_on_curve(surface, collapse, kind::MATERIAL, true)
    }

    fn reads(&self) -> Reads {
        Reads::Pair
    }
}

/// Seams move only along themselves, and every wedge has exactly one wedge to merge into. Creases made by normals are
/// seams.
#[derive(Debug, Clone, Copy, Default)]
pub struct Seams;

impl Oracle for Seams {
    fn name(&self) -> &str {
        "seam"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        if !surface.has_seams() {
            return true;
        }
        if !surface.holds(kind::SEAM) {
            // Wedges without a partner are chosen anew, but no two wedges of the kept point may become a single wedge.
            let either = surface.kind(collapse.pair.lost) | surface.kind(collapse.pair.kept);
            return either & kind::WEDGES == 0 || !WedgeMap::new(surface, collapse.pair).joins_kept();
        }
        stays_on_curve(surface, collapse, kind::SEAM, true)
            && (surface.edge_kind(collapse.pair.lost, collapse.pair.kept).is_none()
                || WedgeMap::new(surface, collapse.pair).is_complete())
    }

    fn reads(&self) -> Reads {
        Reads::Pair
    }
}

/// No triangle changes its orientation in texture space: mirrored triangles stay mirrored, and no other triangle becomes
/// mirrored. Checked for every set of texture coordinates, with the wedges given to each triangle by the collapse.
#[derive(Debug, Clone, Copy, Default)]
pub struct UvOrientation;

impl Oracle for UvOrientation {
    fn name(&self) -> &str {
        "uv orientation"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        surface.keeps_uv_sides(collapse.pair, collapse.position.into())
    }
}

/// Whether a point with feature edges of the kind `bit` moves along one of exactly two, to a point with equal features.
#[inline]
fn stays_on_curve(surface: &WorkingSurface, collapse: &Collapse, bit: u16, slide: bool) -> bool {
    let either = surface.kind(collapse.pair.lost) | surface.kind(collapse.pair.kept);
    either & bit == 0 || slides_along_curve(surface, collapse, bit, slide)
}

fn slides_along_curve(surface: &WorkingSurface, collapse: &Collapse, bit: u16, slide: bool) -> bool {
    let slides = |pair: Pair| {
        let bits = surface.kind(pair.lost);
        if bits & bit == 0 {
            return true;
        }
        match surface.edge_kind(pair.lost, pair.kept) {
            // Without an edge two parts are being joined on purpose.
            None => slide,
            Some(edge) => slide && bits & kind::CURVE != 0 && edge == bits & kind::FEATURE,
        }
    };
    slides(collapse.pair)
        && (collapse.keeps_position(surface)
            || slides(Pair { lost: collapse.pair.kept, kept: collapse.pair.lost }))
}

/// Whether one end is a pinch without other features, and the other end is free to become a pinch.
#[cold]
fn moves_pinch(surface: &WorkingSurface, collapse: &Collapse) -> bool {
    let is_pinch = |point: u32| {
        let corners = || surface.star(point).flat_map(|corner| corner.others);
        let is_non_manifold =
            |other| surface.edge_kind(point, other).is_some_and(|edge| edge & kind::NON_MANIFOLD != 0);
        surface.kind(point) & kind::FEATURE == kind::NON_MANIFOLD && !corners().any(is_non_manifold)
    };
    let is_free = |point: u32| surface.kind(point) & (kind::BORDER | kind::NON_MANIFOLD) == 0;
    let Pair { lost, kept } = collapse.pair;
    is_pinch(lost) && is_free(kept) || !collapse.keeps_position(surface) && is_pinch(kept) && is_free(lost)
}

/// The link condition: the collapse keeps the topology (Dey et al. 1999; Berkey 3.1, read as: the only points adjacent to
/// both ends are the third corners of the edge's own triangles).
///
/// A pair without an edge (see [`Simplifier::join_distance`](super::Simplifier::join_distance)) is allowed if the two
/// points have no common neighbour: it joins two parts on purpose.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinkCondition;

impl Oracle for LinkCondition {
    fn name(&self) -> &str {
        "link"
    }

    fn keeps_topology(&self) -> bool {
        true
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let Pair { lost, kept } = collapse.pair;
        let opposite = collapse.patch.opposite();
        // Each triangle on the edge must have a third corner of its own.
        if !collapse.patch.thirds_differ()
            || opposite.len() > 1 && surface.is_border(lost) && surface.is_border(kept)
        {
            // The second condition: two borders would meet in a point.
            return false;
        }
        if (surface.kind(lost) | surface.kind(kept)) & kind::NON_MANIFOLD != 0
            && opposite.iter().any(|&third| joins_curves(surface, collapse.pair, third))
        {
            return false;
        }
        let near = Neighbourhood::new(surface, kept);
        let (mut meets, mut between_thirds) = (false, false);
        for facet in collapse.patch.facets_of_lost() {
            // Thirds are neighbours of both ends. No other point may be.
            let [a, b] = facet.others;
            let (third_a, third_b) = (collapse.patch.has_third(a), collapse.patch.has_third(b));
            meets |= (!third_a & near.contains(a)) | (!third_b & near.contains(b));
            between_thirds |= third_a & third_b;
        }
        if meets {
            return false;
        }
        // Both ends have the edge ab: if `kept` also has a triangle there, the two triangles would coincide.
        let coincides = |facet: &Facet| {
            let [a, b] = facet.others;
            collapse.patch.has_third(a) && collapse.patch.has_third(b) && has_triangle(surface, kept, a, b)
        };
        if between_thirds && collapse.patch.facets_of_lost().iter().any(coincides) {
            return false;
        }
        // If nothing of the star survives, every remaining edge must belong to another triangle.
        !collapse.patch.facets_of_lost().is_empty()
            || opposite.iter().all(|&third| is_shared_edge(surface, kept, third))
    }
}

/// Whether a third corner is joined to both ends by borders or non-manifold edges: the collapse would merge two curves
/// and remove the sheet between them.
#[cold]
fn joins_curves(surface: &WorkingSurface, pair: Pair, third: u32) -> bool {
    let is_curve = |end: u32| {
        surface.edge_kind(end, third).is_some_and(|edge| edge & (kind::BORDER | kind::NON_MANIFOLD) != 0)
    };
    is_curve(pair.lost) && is_curve(pair.kept)
}

/// Whether at least two triangles share an edge.
fn is_shared_edge(surface: &WorkingSurface, u: u32, v: u32) -> bool {
    // Searches the side with fewer triangles: the other may be a hub.
    let (from, to) = if surface.valence(u) <= surface.valence(v) { (u, v) } else { (v, u) };
    surface.star(from).filter(|corner| corner.others.contains(&to)).nth(1).is_some()
}

fn has_triangle(surface: &WorkingSurface, point: u32, a: u32, b: u32) -> bool {
    let mut corners = [point, a, b];
    corners.sort_unstable_by_key(|&p| surface.valence(p));
    let [from, p, q] = corners;
    surface.star(from).any(|corner| corner.others == [p, q] || corner.others == [q, p])
}

/// Tests for neighbours of a point: in a short list of fixed length (compared in a few vector instructions), or for a hub
/// in the star with fewer triangles.
struct Neighbourhood<'a> {
    surface: &'a WorkingSurface,
    point: u32,
    list: [u32; 16],
    listed: bool,
}

impl<'a> Neighbourhood<'a> {
    #[inline]
    fn new(surface: &'a WorkingSurface, point: u32) -> Self {
        let mut list = [NONE; 16];
        let count = surface.few_neighbours(point, &mut list);
        Self { surface, point, list, listed: count <= 16 }
    }

    #[inline]
    fn contains(&self, other: u32) -> bool {
        if self.listed {
            self.list.iter().fold(false, |any, &n| any | (n == other))
        } else {
            self.search(other)
        }
    }

    #[cold]
    fn search(&self, other: u32) -> bool {
        let (from, to) = if self.surface.valence(other) <= self.surface.valence(self.point) {
            (other, self.point)
        } else {
            (self.point, other)
        };
        self.surface.star(from).any(|corner| corner.others.contains(&to))
    }
}

/// Refuses collapses that turn a triangle's normal by more than an angle.
#[derive(Debug, Clone, Copy)]
pub struct NormalFlip {
    cos: f32,
}

impl Default for NormalFlip {
    /// 78 degrees.
    fn default() -> Self {
        Self::degrees(78.0)
    }
}

impl NormalFlip {
    /// Allows normals to turn by at most `angle` degrees in a collapse, 0 to 180 (clamped; NaN: 78).
    pub fn degrees(angle: f32) -> Self {
        let angle = if angle.is_nan() { 78.0 } else { angle.clamp(0.0, 180.0) };
        Self { cos: (f64::from(angle).to_radians().cos()) as f32 }
    }
}

impl Oracle for NormalFlip {
    fn name(&self) -> &str {
        "normal flip"
    }

    fn allows(&self, _: &WorkingSurface, collapse: &Collapse) -> bool {
        let cos_squared = self.cos * self.cos.abs();
        collapse.patch.facets().iter().all(|facet| {
            let (before, after) = (facet.before.length_squared(), facet.after.length_squared());
            let dot = facet.before.dot(facet.after);
            // dot > cos * |before| |after|, squared with its sign. A triangle without area has no side to flip to.
            dot * dot.abs() > cos_squared * before * after || before <= f32::MIN_POSITIVE
        })
    }

    fn reads(&self) -> Reads {
        Reads::Facets
    }
}

/// Delays collapses making needles: the thinnest new triangle should reach `least`, or the quality of the thinnest of the
/// triangles replaced or removed (needles in, needles out).
///
/// The measure is `4 sqrt(3) area / (sum of squared sides)`: 1 for an equilateral triangle, 0 for one without area.
///
/// A thin triangle is no error: on a long box only thin triangles are exact. So this rule does not end a simplification.
/// A refused collapse counts as 64 times dearer (about 8 times the distance), and is done once collapses of this cost are
/// due. The report counts how often it was put off. [`strict`](TriangleQuality::strict) makes the rule absolute.
#[derive(Debug, Clone, Copy)]
pub struct TriangleQuality {
    least: f32,
    strict: bool,
}

/// Cost factor of a collapse making a needle.
const NEEDLE_SURCHARGE: f32 = 64.0;

impl Default for TriangleQuality {
    /// 0.01.
    fn default() -> Self {
        Self::at_least(0.01)
    }
}

impl TriangleQuality {
    /// Asks for new triangles of at least this quality, 0 (anything) to 1 (equilateral only).
    pub fn at_least(least: f32) -> Self {
        Self { least, strict: false }
    }

    /// Makes the rule absolute: a refused collapse is never done. For meshes that must not get thinner triangles than
    /// they have; simplifications may miss their target.
    #[must_use]
    pub fn strict(self) -> Self {
        Self { strict: true, ..self }
    }
}

impl Oracle for TriangleQuality {
    fn name(&self) -> &str {
        "triangle quality"
    }

    fn allows(&self, surface: &WorkingSurface, collapse: &Collapse) -> bool {
        let patch = collapse.patch;
        let thinnest = |of: fn(&Facet) -> f32| patch.facets().iter().map(of).fold(f32::INFINITY, f32::min);
        let after = thinnest(Facet::quality_after);
        if after >= self.least {
            return true;
        }
        let dying = patch.opposite().iter().map(|&third| {
            let [p, q, r] = [collapse.pair.lost, collapse.pair.kept, third].map(|point| surface.at(point));
            quality((q - p).cross(r - p), q - p, r - p)
        });
        after >= dying.fold(thinnest(Facet::quality_before), f32::min)
    }

    fn surcharge(&self) -> Option<f32> {
        (!self.strict).then_some(NEEDLE_SURCHARGE)
    }
}
