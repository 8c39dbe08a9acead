//! Rules for what a point is: locked, on a border, a seam, a border between materials or a non-manifold edge.

use crate::simplify::metric::Pair;
use crate::simplify::surface::WorkingSurface;
use crate::simplify::surface::classify::kind;
use crate::simplify::surface::wedge_map::WedgeMap;

use super::{Collapse, Oracle, Reads};

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
///
/// ```
/// use multires::simplify::oracle::Borders;
/// use multires::{Simplifier, mesh::shapes};
///
/// // A sheet whose outline stays as it is, vertex by vertex.
/// let sheet = shapes::terrain(16, 1);
/// let free = Simplifier::new().run(&sheet)?.report().triangles;
/// let held = Simplifier::new().oracle(Borders::Locked).run(&sheet)?.report().triangles;
/// assert!(held > free);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
