//! Rules that give before a target is missed: seams and creases first, then material borders, the topology last.
//!
//! ```text
//!     all hold                 down to the target, or until no legal collapse is left
//!     seams and creases give   a point may leave its seam; its wedges are chosen anew (`wedge_map.rs`)
//!     materials give           a point may leave its material border; triangles keep their materials
//!     the topology gives       holes close and sheets meet: rules that keep the topology are not asked any more
//! ```
//!
//! The last legal collapses before a run gets stuck eat the shape, having nowhere else to go. So rules begin to give
//! earlier: a run that gets stuck is started over, and edges of the blocking kind give from [`EARLY`] times as many
//! triangles on.
//!
//! Points are merged, never vertices, so nothing opens along a seam or between materials, and closed surfaces stay
//! closed. Locks and the sides of triangles in texture space always hold.

use crate::sequence::GivenUp;

use super::metric::Pair;
use super::surface::WorkingSurface;
use super::surface::classify::kind;
use super::surface::wedge_map::WedgeMap;

/// Whether seams, creases, material borders and the topology may give.
///
/// ```
/// use multires::simplify::Permissive;
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// // Seams give where the size asked for cannot be had otherwise.
/// let mut simplifier = Simplifier::new().permissive(Permissive::On).target(Target::Ratio(0.05));
/// let sequence = simplifier.run(&shapes::demo())?;
/// println!("gave up {:?}", sequence.report().given_up);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Permissive {
    /// All hold in any case.
    Off,
    /// All hold if the target size is reached so. If a size would be missed, all hold down to 2.5 times the triangles at
    /// which no legal collapse would be left, and give from there. Finding this number takes a run of its own for each
    /// kind that must give. The topology gives last: a torus has at least 14 triangles while it is a torus. Without a
    /// target of size, down to the base mesh or to an error, all hold.
    #[default]
    Auto,
    /// Seams and creases give from the start, at their cost. Material borders give if nothing else is left, with or
    /// without a target size. The topology gives only before a size is missed. For attributes to cost anything, use
    /// [`WithAttributes`](super::metric::WithAttributes).
    On,
}

impl GivenUp {
    pub(super) fn add(&mut self, gives: u8) {
        self.seams += u64::from(gives & gives::SEAM != 0);
        self.creases += u64::from(gives & gives::CREASE != 0);
        self.materials += u64::from(gives & gives::MATERIAL != 0);
        self.topology += u64::from(gives & gives::TOPOLOGY != 0);
    }
}

/// Kinds begin to give at this multiple of the triangles of a stuck run. The levels before equal the levels of a run with
/// all rules holding.
const EARLY: f64 = 2.5;

/// The kinds that may give, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Giving {
    Seams,
    Materials,
    Topology,
}

/// Triangles at which each kind begins to give; 0: when nothing else is left.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Schedule {
    pub seams: usize,
    pub materials: usize,
    pub topology: usize,
}

impl Schedule {
    /// Returns the schedule with `giving` early enough for a run stuck at `stuck` triangles.
    pub fn with(mut self, giving: Giving, stuck: usize) -> Self {
        let at = match giving {
            Giving::Seams => &mut self.seams,
            Giving::Materials => &mut self.materials,
            Giving::Topology => &mut self.topology,
        };
        *at = ((stuck as f64 * EARLY) as usize).max(1);
        self
    }
}

/// Rules given up by a collapse, as bits.
pub(super) mod gives {
    pub const SEAM: u8 = 1;
    pub const CREASE: u8 = 2;
    pub const MATERIAL: u8 = 4;
    pub const TOPOLOGY: u8 = 8;
}

impl WorkingSurface {
    /// Returns the rules given up by merging `pair`; `stays` if the kept point does not move. O(valences).
    pub(super) fn gives_up(&mut self, pair: Pair, stays: bool) -> u8 {
        let mut leaves = self.leaves_curve(pair.lost, pair.kept);
        if !stays {
            leaves |= self.leaves_curve(pair.kept, pair.lost);
        }
        // If a kind of curve still holds, the oracles allow leaving it only along another curve of the kind.
        let leaves = leaves & !self.held;
        let mut given = if leaves & kind::MATERIAL != 0 { gives::MATERIAL } else { 0 };
        let several = (self.kind(pair.lost) | self.kind(pair.kept)) & kind::WEDGES != 0;
        if leaves & kind::SEAM != 0
            || !self.holds(kind::SEAM) && several && !WedgeMap::new(self, pair).is_complete()
        {
            let at_lost = self.seams_at(pair.lost);
            let found = if at_lost == 0 { self.seams_at(pair.kept) } else { at_lost };
            given |= if found == gives::CREASE { gives::CREASE } else { gives::SEAM };
        }
        given
    }

    /// Returns the kinds of curves left by moving a point to another.
    fn leaves_curve(&mut self, from: u32, to: u32) -> u16 {
        let bits = self.kind_if_held(from) & (kind::FEATURE | kind::CURVE);
        let edge = self.edge_kind_if_held(from, to);
        let slides = bits & kind::CURVE != 0 && edge == Some(bits & kind::FEATURE);
        // Without an edge two parts are being joined on purpose.
        if slides || edge.is_none() { 0 } else { bits & kind::FEATURE }
    }

    /// Returns whether seams meet a point, and whether creases made by normals alone do, as bits. O(valence log valence).
    fn seams_at(&mut self, point: u32) -> u8 {
        let mut ends = std::mem::take(&mut self.scratch.ends);
        ends.clear();
        for corner in self.star(point) {
            let vertices = self.corner_vertices(corner.triangle);
            for (side, &other) in corner.others.iter().enumerate() {
                let slot = corner.slot as usize;
                ends.push([other, vertices[slot], vertices[(slot + 1 + side) % 3]]);
            }
        }
        ends.sort_unstable();
        let mut found = 0;
        for pair in ends.windows(2).filter(|pair| pair[0][0] == pair[1][0]) {
            for end in [1, 2] {
                let (differs, in_normals_alone) = self.values.differ(pair[0][end], pair[1][end]);
                found |= match (differs, in_normals_alone) {
                    (false, _) => 0,
                    (true, true) => gives::CREASE,
                    (true, false) => gives::SEAM,
                };
            }
        }
        self.scratch.ends = ends;
        found
    }
}
