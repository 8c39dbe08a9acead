//! A split on the wire: written and read by one text, against the mesh that both sides have.
//!
//! ```text
//!     leaves      0 1 2 3 4 5 6 7 8 9      every drawn vertex stands for a run of leaves (vertices of full resolution)
//!     before     |  to             |
//!     after      |  to     |  new  |       a split is named by the leaf where a run parts: its key
//! ```
//!
//! A triangle comes as its three leaves. One is in the new vertex's run and one in what stays of the old. The third is mostly
//! found by its edges: triangles drawn around the first two have edges with no triangle on the other side. What is left is a
//! vertex next to the old one, and a leaf of it.
//!
//! Scalars are written as differences from the mean of the new vertex's neighbours: on most surfaces a small number.

use super::channels::{Channel, Layout};
use super::coder::{Bit, Coder, Number, Signed};
use super::error::Damage;

/// Longest run whose leaves are looked at one by one.
const NEAR: u32 = 32;
/// Most triangles around a leaf that are looked at.
const MOST_AROUND: usize = 32;
/// Most earlier triangles of the same split that are looked at.
const EARLIER: usize = 8;
/// Splits that bring more vertices have no surroundings.
const MOST_PARTS: usize = 8;
/// Most vertices that a split brings, and most triangles.
pub(super) const MOST_BROUGHT: u32 = 1 << 12;
pub(super) const MOST_OWNED: u32 = 1 << 16;
/// Candidates for a third leaf that have a model of their own.
const CANDIDATES: usize = 4;

/// A drawn vertex, and the leaves it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub vertex: u32,
    pub start: u32,
    pub end: u32,
}

impl Run {
    fn holds(&self, leaf: u32) -> bool {
        self.start <= leaf && leaf < self.end
    }

    fn len(&self) -> u32 {
        self.end - self.start
    }
}

/// The mesh drawn by a client, as both sides know it.
pub(super) trait DrawnMesh {
    /// Returns the number of leaves.
    fn leaves(&self) -> u32;
    /// Returns the drawn vertex of a leaf.
    fn run(&self, leaf: u32) -> Run;
    /// Returns the drawn vertex of a leaf, and its first leaf.
    fn vertex(&self, leaf: u32) -> [u32; 2];
    /// Returns the numbers of a vertex's scalars.
    fn numbers(&self, vertex: u32) -> &[u32];
    /// Calls `each` with the other two leaves of all drawn triangles around a leaf, at most so many, in any order.
    fn around(&self, leaf: u32, most: usize, each: impl FnMut([u32; 2]));
}

/// A split: what a client must know to make it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Record {
    /// Per vertex brought, in the order in which they come, its first leaf. The first is the split's key.
    pub firsts: Vec<u32>,
    /// Numbers of the scalars of the vertices brought, vertex by vertex.
    pub numbers: Vec<u32>,
    /// Leaves of the triangles brought.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle, its group.
    pub groups: Vec<u16>,
}

impl Record {
    pub fn key(&self) -> u32 {
        self.firsts[0]
    }

    /// Bytes of the record.
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.firsts[..])
            + size_of_val(&self.numbers[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.groups[..])
    }

    /// Empties the record, but for a key.
    pub fn start(&mut self, key: u32) {
        self.firsts.clear();
        self.firsts.push(key);
        self.numbers.clear();
        self.triangles.clear();
        self.groups.clear();
    }
}

/// Models of all that is written of splits. They learn from split to split, alike on both sides.
#[derive(Debug, Clone)]
pub(super) struct Models {
    /// Gaps between the keys of a set.
    pub gaps: Number,
    /// Number of vertices brought besides the first; whether one of them takes what is left of a run.
    more: Number,
    rest: Bit,
    /// Number of triangles.
    owned: Number,
    /// Whether a triangle lies along the parted run.
    along: Bit,
    /// Per number of open edges, of candidates, and place among the candidates, whether a third leaf is this candidate.
    candidates: [[[Bit; CANDIDATES]; CANDIDATES]; 2],
    /// Whether a third leaf is of a vertex next to the old one.
    beside: Bit,
    /// Side of a triangle: of the first, and after either side.
    sides: [Bit; 3],
    group: Bit,
    last_group: u16,
    /// Differences of positions, by the size of their surroundings in bits.
    positions: Vec<Signed>,
    /// Differences of attributes, by scalar.
    attributes: Vec<Signed>,
    /// Differences of scalars, and of corners, from one to the next in the coarsest mesh.
    base_scalars: Vec<Signed>,
    base_corners: [Signed; 3],
    scratch: Scratch,
}

/// Classes of surroundings.
const SIZES: usize = 12;

impl Models {
    /// Creates models that know nothing, for vertices of so many scalars.
    pub fn new(channels: usize) -> Self {
        Self {
            gaps: Number::default(),
            more: Number::default(),
            rest: Bit::default(),
            owned: Number::default(),
            along: Bit::default(),
            candidates: Default::default(),
            beside: Bit::default(),
            sides: Default::default(),
            group: Bit::default(),
            last_group: 0,
            positions: vec![Signed::default(); SIZES],
            attributes: vec![Signed::default(); channels.saturating_sub(3)],
            base_scalars: vec![Signed::default(); channels],
            base_corners: Default::default(),
            scratch: Scratch::default(),
        }
    }

    /// Bytes of the models.
    pub fn memory(&self) -> usize {
        let signed = self.positions.len() + self.attributes.len() + self.base_scalars.len();
        size_of::<Self>() + signed * size_of::<Signed>()
    }
}

/// A vertex brought: the run it parts, as it was just before, and the run it takes.
#[derive(Debug, Clone, Copy)]
struct Part {
    from: Run,
    /// The earlier part that brings the vertex parted, if this split brings it.
    by: Option<usize>,
    first: u32,
}

impl Part {
    /// Whether the vertex takes the whole run, and the old vertex goes.
    fn is_rest(&self) -> bool {
        self.first == self.from.start
    }

    fn taken(&self) -> Run {
        Run { vertex: u32::MAX, start: self.first, end: self.from.end }
    }

    fn left(&self) -> Run {
        Run { end: self.first, ..self.from }
    }
}

#[derive(Debug, Clone, Default)]
struct Scratch {
    parts: Vec<Part>,
    /// A leaf, and the number of triangles at its edges to the first and the second leaf.
    edges: Vec<(u32, [u8; 2])>,
    /// Starts and ends of runs.
    ring: Vec<[u32; 2]>,
    /// The part whose old vertex `ring` surrounds.
    ring_of: Option<usize>,
    sums: Vec<u64>,
    /// Numbers of the vertex parted.
    old: Vec<u32>,
}

/// Codes a split of a known key. A reader fills the record; a writer leaves it as it is. The mesh is as before the split.
/// `groups` is the number of groups of triangles.
pub(super) fn code_split<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    mesh: &impl DrawnMesh,
    layout: &Layout,
    groups: usize,
    record: &mut Record,
) -> Result<(), Damage> {
    let mut scratch = std::mem::take(&mut models.scratch);
    let result = code_parts(coder, models, mesh, &mut scratch, record)
        .and_then(|()| code_triangles(coder, models, mesh, &mut scratch, groups, record))
        .and_then(|()| code_numbers(coder, models, mesh, &mut scratch, layout, record));
    models.scratch = scratch;
    result
}

/// Returns the run of a leaf after the first `done` parts.
fn run_after(mesh: &impl DrawnMesh, parts: &[Part], leaf: u32) -> (Run, Option<usize>) {
    if let Some(at) = parts.iter().rposition(|part| part.taken().holds(leaf)) {
        let taken = parts[at].taken();
        // Later parts of the same run leave less of it.
        let cut = parts[at + 1..].iter().filter(|part| taken.holds(part.first) && part.first > taken.start);
        let end = cut.map(|part| part.first).min().unwrap_or(taken.end);
        return (Run { end, ..taken }, Some(at));
    }
    let run = mesh.run(leaf);
    let cut = parts.iter().filter(|part| run.holds(part.first)).map(|part| part.first).min();
    (Run { end: cut.unwrap_or(run.end), ..run }, None)
}

/// Codes which vertices are brought.
fn code_parts<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    mesh: &impl DrawnMesh,
    scratch: &mut Scratch,
    record: &mut Record,
) -> Result<(), Damage> {
    let parts = &mut scratch.parts;
    parts.clear();
    let more = coder.number(&mut models.more, record.firsts.len() as u32 - 1)?;
    if more >= MOST_BROUGHT {
        return Err(Damage("a split brings too many vertices"));
    }
    for at in 0..=more as usize {
        if at > 0 {
            // Often the rest of the run that the key parts.
            let rest = parts[0].from.start;
            let first = record.firsts.get(at).copied().unwrap_or(0);
            let is_rest = coder.bit(&mut models.rest, first == rest)?;
            let first = if is_rest { rest } else { coder.below(mesh.leaves(), first)? };
            if C::READS {
                record.firsts.push(first);
            }
        }
        let first = record.firsts[at];
        if first >= mesh.leaves() {
            return Err(Damage("a split is of no leaf"));
        }
        let (from, by) = run_after(mesh, parts, first);
        parts.push(Part { from, by, first });
    }
    Ok(())
}

fn code_triangles<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    mesh: &impl DrawnMesh,
    scratch: &mut Scratch,
    groups: usize,
    record: &mut Record,
) -> Result<(), Damage> {
    let owned = coder.number(&mut models.owned, record.triangles.len() as u32)?;
    if owned > MOST_OWNED {
        return Err(Damage("a split brings too many triangles"));
    }
    let mut side_before = 2;
    scratch.ring_of = None;
    for at in 0..owned as usize {
        let leaves = record.triangles.get(at).copied().unwrap_or([0; 3]);
        let found = along(&scratch.parts, leaves);
        let is_along = coder.bit(&mut models.along, found.is_some())?;
        let leaves = if is_along {
            let (part, [a, b, c], side) = found.unwrap_or((0, [0; 3], false));
            let part = coder.below(scratch.parts.len() as u32, part as u32)? as usize;
            let (taken, left) = (scratch.parts[part].taken(), scratch.parts[part].left());
            let a = taken.start + coder.below(taken.len(), a.wrapping_sub(taken.start))?;
            let b = left.start + coder.below(left.len(), b.wrapping_sub(left.start))?;
            if left.len() == 0 {
                return Err(Damage("a triangle lies along no vertex"));
            }
            let earlier = &record.triangles[at.saturating_sub(EARLIER)..at];
            let c = code_third(coder, models, mesh, scratch, (part, [a, b]), earlier, c)?;
            let side = coder.bit(&mut models.sides[side_before], side)?;
            side_before = usize::from(side);
            if side { [b, a, c] } else { [a, b, c] }
        } else {
            let mut read = [0; 3];
            for (to, leaf) in read.iter_mut().zip(leaves) {
                *to = coder.below(mesh.leaves(), leaf)?;
            }
            read
        };
        let group = record.groups.get(at).copied().unwrap_or(0);
        let group = if groups > 1 && !coder.bit(&mut models.group, group == models.last_group)? {
            coder.below(groups as u32, group.into())? as u16
        } else if groups > 1 {
            models.last_group
        } else {
            0
        };
        models.last_group = group;
        if C::READS {
            record.triangles.push(leaves);
            record.groups.push(group);
        }
    }
    Ok(())
}

/// Finds the part along which a triangle lies: its leaves, from the taken run, from what is left, and the third, and whether the
/// first two change places in the triangle.
fn along(parts: &[Part], leaves: [u32; 3]) -> Option<(usize, [u32; 3], bool)> {
    parts.iter().enumerate().find_map(|(at, part)| {
        let (taken, left) = (part.taken(), part.left());
        (0..3).find_map(|turn| {
            let [x, y, z] = [0, 1, 2].map(|k| leaves[(k + turn) % 3]);
            match () {
                () if part.from.holds(z) => None,
                () if taken.holds(x) && left.holds(y) => Some((at, [x, y, z], false)),
                () if taken.holds(y) && left.holds(x) => Some((at, [y, x, z], true)),
                () => None,
            }
        })
    })
}

/// Codes the third leaf of a triangle along a part, of known other leaves.
fn code_third<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    mesh: &impl DrawnMesh,
    scratch: &mut Scratch,
    (part, ends): (usize, [u32; 2]),
    earlier: &[[u32; 3]],
    third: u32,
) -> Result<u32, Damage> {
    let Scratch { parts, edges, ring, ring_of, .. } = scratch;
    let old = parts[part].from;
    edges.clear();
    for (end, &leaf) in ends.iter().enumerate() {
        let mut note = |others: [u32; 2]| {
            for other in others.into_iter().filter(|&other| !old.holds(other)) {
                let mut sides = [0; 2];
                sides[end] = 1;
                edges.push((other, sides));
            }
        };
        mesh.around(leaf, MOST_AROUND, &mut note);
        for triangle in earlier {
            if let Some(at) = triangle.iter().position(|&corner| corner == leaf) {
                note([triangle[(at + 1) % 3], triangle[(at + 2) % 3]]);
            }
        }
    }
    edges.sort_unstable();
    edges.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 = [kept.1[0].saturating_add(next.1[0]), kept.1[1].saturating_add(next.1[1])];
        }
        same
    });
    let open = |sides: &[u8; 2]| sides.iter().filter(|&&side| side == 1).count();
    edges.retain(|(_, sides)| open(sides) > 0);
    edges.sort_unstable_by_key(|(leaf, sides)| (2 - open(sides), *leaf));
    let crowd = edges.len().min(CANDIDATES) - usize::from(!edges.is_empty());
    for (at, (leaf, sides)) in edges.iter().take(CANDIDATES).enumerate() {
        if coder.bit(&mut models.candidates[open(sides) - 1][crowd][at], *leaf == third)? {
            return Ok(*leaf);
        }
    }
    // Then a leaf of a vertex next to the old one.
    if *ring_of != Some(part) {
        *ring_of = Some(part);
        ring.clear();
        if old.len() <= NEAR && parts.len() <= MOST_PARTS {
            for leaf in old.start..old.end {
                mesh.around(leaf, MOST_AROUND, |others| {
                    ring.extend(others.into_iter().filter(|&other| !old.holds(other)).map(|other| {
                        let run = mesh.run(other);
                        [run.start, run.end]
                    }));
                });
            }
            ring.sort_unstable();
            ring.dedup();
        }
    }
    let place = ring.iter().position(|[start, end]| (*start..*end).contains(&third));
    if !ring.is_empty() && coder.bit(&mut models.beside, place.is_some())? {
        let place = coder.below(ring.len() as u32, place.unwrap_or(0) as u32)?;
        let [start, end] = ring[place as usize];
        return Ok(start + coder.below(end - start, third.wrapping_sub(start))?);
    }
    coder.below(mesh.leaves(), third)
}

/// Codes the scalars of the vertices brought.
fn code_numbers<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    mesh: &impl DrawnMesh,
    scratch: &mut Scratch,
    layout: &Layout,
    record: &mut Record,
) -> Result<(), Damage> {
    let Scratch { parts, ring, sums, old, .. } = scratch;
    for at in 0..parts.len() {
        let Part { from, by, .. } = parts[at];
        let channels = layout.len();
        old.clear();
        old.extend_from_slice(match by {
            Some(part) => &record.numbers[part * channels..][..channels],
            None => mesh.numbers(from.vertex),
        });
        sums.clear();
        sums.resize(channels, 0);
        let mut size = 0;
        // Where the old vertex goes, both that it becomes lie on either side of it.
        let is_twin = |part: &Part| part.by.is_none() && part.from.vertex == from.vertex;
        let twin = parts[..at].iter().rposition(is_twin).filter(|_| by.is_none() && parts[at].is_rest());
        if let Some(twin) = twin {
            for channel in 0..channels {
                let mirrored = 2 * u64::from(old[channel]);
                let known = u64::from(record.numbers[twin * channels + channel]);
                sums[channel] = mirrored.saturating_sub(known).min(layout.channels[channel].largest().into());
            }
        } else {
            ring.clear();
            let (run, _) = run_after(mesh, parts, parts[at].first);
            let mut note = |others: [u32; 2]| {
                for other in others {
                    // What this vertex and later vertices take is not known yet.
                    match parts.iter().rposition(|part| part.taken().holds(other)) {
                        Some(part) if part < at => ring.push([parts[part].first, part as u32 | PART]),
                        Some(_) => {}
                        None => {
                            let [vertex, start] = mesh.vertex(other);
                            ring.push([start, vertex]);
                        }
                    }
                }
            };
            if run.len() <= NEAR && parts.len() <= MOST_PARTS {
                (run.start..run.end).for_each(|leaf| mesh.around(leaf, MOST_AROUND, &mut note));
            }
            for triangle in record.triangles.iter().take(EARLIER) {
                if let Some(at) = triangle.iter().position(|&corner| run.holds(corner)) {
                    note([triangle[(at + 1) % 3], triangle[(at + 2) % 3]]);
                }
            }
            ring.push([from.start, by.map_or(from.vertex, |part| part as u32 | PART)]);
            ring.sort_unstable();
            ring.dedup();
            for &[_, name] in &*ring {
                let numbers = match name & PART != 0 {
                    true => &record.numbers[(name & !PART) as usize * channels..][..channels],
                    false => mesh.numbers(name),
                };
                sums.iter_mut().zip(numbers).for_each(|(sum, &number)| *sum += u64::from(number));
            }
            let count = ring.len() as u64;
            sums.iter_mut().for_each(|sum| *sum = (*sum + count / 2) / count);
        }
        for axis in 0..3 {
            size = size.max(u64::from(old[axis]).abs_diff(sums[axis]));
        }
        let class = (64 - size.leading_zeros()).min(SIZES as u32 - 1) as usize;
        for channel in 0..channels {
            let model = match channel {
                0..3 => &mut models.positions[class],
                _ => &mut models.attributes[channel - 3],
            };
            let kind = layout.channels[channel];
            let expected =
                if kind == Channel::Label { i64::from(old[channel]) } else { sums[channel] as i64 };
            let number = record.numbers.get(at * channels + channel).copied().unwrap_or(0);
            // Away from the old vertex counts as up: surfaces bend alike.
            let sign = if expected < i64::from(old[channel]) { -1 } else { 1 };
            let number = expected + sign * coder.signed(model, sign * (i64::from(number) - expected))?;
            let number = u32::try_from(number).ok().filter(|&number| number <= kind.largest());
            let number = number.ok_or(Damage("a scalar is out of range"))?;
            if C::READS {
                record.numbers.push(number);
            }
        }
    }
    Ok(())
}

/// Marks the name of a vertex brought by the same split.
const PART: u32 = 1 << 31;

/// Codes the scalars of a vertex of the coarsest mesh, after those of the vertex before.
pub(super) fn code_base_scalars<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    layout: &Layout,
    before: &[u32],
    numbers: &mut [u32],
) -> Result<(), Damage> {
    for (channel, number) in numbers.iter_mut().enumerate() {
        let last = before.get(channel).map_or(0, |&number| i64::from(number));
        let step = coder.signed(&mut models.base_scalars[channel], i64::from(*number) - last)?;
        let found =
            u32::try_from(last + step).ok().filter(|&found| found <= layout.channels[channel].largest());
        *number = found.ok_or(Damage("a scalar is out of range"))?;
    }
    Ok(())
}

/// Codes a triangle of the coarsest mesh, after the places of the corners of the triangle before. `places` are of runs in `base`,
/// a run for each vertex.
pub(super) fn code_base_triangle<C: Coder>(
    coder: &mut C,
    models: &mut Models,
    base: &[[u32; 2]],
    before: &mut [u32; 3],
    leaves: &mut [u32; 3],
) -> Result<(), Damage> {
    for (corner, leaf) in leaves.iter_mut().enumerate() {
        let place = base.partition_point(|[start, _]| start <= leaf).saturating_sub(1);
        // The first corner from the last triangle's, the others from the corner before.
        let from = i64::from(if corner == 0 { before[0] } else { before[corner - 1] });
        let step = coder.signed(&mut models.base_corners[corner], place as i64 - from)?;
        let place = usize::try_from(from + step).ok().filter(|&place| place < base.len());
        let place = place.ok_or(Damage("a corner is of no vertex"))?;
        before[corner] = place as u32;
        let [start, end] = base[place];
        *leaf = start + coder.below(end - start, leaf.wrapping_sub(start))?;
    }
    Ok(())
}
