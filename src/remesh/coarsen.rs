//! From a mesh to a base: simplifies, and records the map of every collapse.

use std::ops::ControlFlow;

use glam::{DVec2, DVec3};

use crate::mesh::{NONE, Tolerances};
use crate::simplify::metric::ErrorMetric;
use crate::simplify::oracle::{
    Borders, LinkCondition, Locks, NonManifold, NormalFlip, Seams, TriangleQuality,
};
use crate::simplify::{
    AttributeWeights, CollapseSequence, ErrorMeasure, Frame, Guard, Oracle, Parts, Permissive, Placement,
    Simplifier, SimplifyReport, Target,
};

use super::RemeshError;
use super::flatten::{flatten, is_fan};
use super::layout::{FanFace, Hub, Layout};
use super::oracle::{EvenValence, Flattens, LimitedValence, walk};
use super::sectors::Sectors;

/// Where the rules allow no base nearly as small as asked for, one in so many faces asked for is left on top of the smallest
/// possible base, so that parts which could go on are not ground down in the place of parts which cannot.
const SPARE: usize = 4;
/// Share of the time taken by the simplification.
const SIMPLIFICATION: f32 = 0.9;

/// A base, and the map from the input to it.
pub(super) struct Coarse {
    pub layout: Layout,
    /// Sectors at the corners of every face ever made; input faces first.
    pub corners: Vec<[u32; 3]>,
    pub report: SimplifyReport,
}

pub(super) fn coarsen(
    sectors: &Sectors,
    metric: impl ErrorMetric,
    faces: usize,
    mut progress: impl FnMut(f32) -> ControlFlow<()>,
) -> Result<Coarse, RemeshError> {
    let oracles: Vec<Box<dyn Oracle>> = vec![
        Box::new(Locks),
        Box::new(Borders::Slide),
        Box::new(NonManifold::Slide),
        Box::new(Seams),
        Box::new(LinkCondition),
        Box::new(LimitedValence),
        Box::new(EvenValence),
        Box::new(NormalFlip::degrees(60.0)),
        Box::new(TriangleQuality::at_least(0.4)),
        Box::new(Flattens),
    ];
    let mut simplifier = Simplifier::new()
        .metric(metric)
        .oracles(oracles)
        .placement(Placement::Endpoint)
        .error_measure(ErrorMeasure::Parametric)
        .permissive(Permissive::Off)
        .guard(Guard::Off)
        .parts(Parts::Keep)
        .tolerances(Tolerances::exact())
        .attributes(AttributeWeights::Off)
        .target(Target::Triangles(faces));
    let mut is_cancelled = false;
    let sequence = simplifier.run_with(&sectors.mesh, |state| {
        let flow = progress(SIMPLIFICATION * state.fraction());
        is_cancelled = flow.is_break();
        flow
    })?;
    if is_cancelled {
        return Err(RemeshError::Cancelled);
    }
    let fewest = sequence.triangles_after(sequence.len());
    let spare = faces / SPARE;
    let steps = match fewest > faces.saturating_add(spare) {
        true => sequence.steps_for_triangles(fewest + spare),
        false => sequence.len(),
    };
    replay(sectors, &sequence, steps)
}

/// Replays the first steps of a sequence of collapses onto kept vertices, and records the map of each.
fn replay(sectors: &Sectors, sequence: &CollapseSequence, steps: usize) -> Result<Coarse, RemeshError> {
    let mesh = &sectors.mesh;
    let count = mesh.triangles().len();
    // Positions as the rules saw them.
    let frame = Frame::new(mesh);
    let at = |sector: u32| DVec3::from_array(frame.inner(mesh.positions()[sector as usize]).map(f64::from));
    let report = sequence.report().clone();
    let patches = (0..steps).map(|step| sequence.substitutions(step).len()).sum();
    let mut corners = Vec::with_capacity(count + 5 * patches);
    corners.extend_from_slice(mesh.triangles());
    let mut coarse = Coarse { layout: Layout::new(count, patches), corners, report };
    // Triangles keep their slots and the order of their corners, while their faces change.
    let mut face_of: Vec<u32> = (0..count as u32).collect();
    let mut first_corner = vec![0u8; count];
    let mut triangles = mesh.triangles().to_vec();
    let mut stars = Stars::new(&triangles, &sectors.is_face, mesh.positions().len());
    let (mut ring, mut order, mut positions, mut flat) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut star, mut before) = (Vec::new(), Vec::new());
    for step in 0..steps {
        for &[lost, kept] in sequence.substitutions(step) {
            stars.collect(lost, &triangles, &mut star);
            order.clear();
            let others = star.iter().map(|&corner| others(&triangles, corner));
            let closed = walk(others, &mut ring, |number| order.push(star[number]));
            let hub = ring.iter().position(|&vertex| vertex == kept);
            let (Some(closed), Some(hub)) = (closed, hub) else { return Err(RemeshError::Unmapped { step }) };
            positions.clear();
            positions.extend(ring.iter().map(|&vertex| at(vertex)));
            if !flatten(at(lost), &positions, closed, &mut flat) || !is_fan(&flat, hub) {
                return Err(RemeshError::Unmapped { step });
            }
            before.clear();
            before.extend(order.iter().map(|&corner| {
                let (slot, k) = (corner as usize / 3, corner as usize % 3);
                FanFace {
                    face: face_of[slot],
                    hub_corner: ((k + 3 - usize::from(first_corner[slot])) % 3) as u8,
                }
            }));
            let hubs = [Hub::Inside(DVec2::ZERO), Hub::Ring(hub)];
            // A triangle between two ring vertices other than the kept vertex goes on as the next face of the new fan.
            let mut face = coarse.layout.replace(&flat, closed, hubs, &before);
            for (number, &corner) in order.iter().enumerate() {
                let (slot, k) = (corner as usize / 3, corner as usize % 3);
                let [a, b] = [ring[number], ring[(number + 1) % ring.len()]];
                if a == kept || b == kept {
                    triangles[slot] = [NONE; 3];
                    continue;
                }
                face_of[slot] = face;
                first_corner[slot] = k as u8;
                triangles[slot][k] = kept;
                coarse.corners.push([kept, a, b]);
                stars.push(kept, corner);
                face += 1;
            }
        }
    }
    coarse.layout.shrink();
    Ok(coarse)
}

fn others(triangles: &[[u32; 3]], corner: u32) -> [u32; 2] {
    let (triangle, slot) = (triangles[corner as usize / 3], corner as usize % 3);
    [triangle[(slot + 1) % 3], triangle[(slot + 2) % 3]]
}

/// Corners around every sector, as linked lists.
struct Stars {
    first: Vec<u32>,
    next: Vec<u32>,
}

impl Stars {
    fn new(triangles: &[[u32; 3]], is_face: &[bool], sectors: usize) -> Self {
        let mut stars = Self { first: vec![NONE; sectors], next: vec![NONE; 3 * triangles.len()] };
        for (t, corners) in triangles.iter().enumerate().rev().filter(|(t, _)| is_face[*t]) {
            for k in (0..3).rev() {
                stars.push(corners[k], (3 * t + k) as u32);
            }
        }
        stars
    }

    fn push(&mut self, sector: u32, corner: u32) {
        self.next[corner as usize] = std::mem::replace(&mut self.first[sector as usize], corner);
    }

    /// Takes the corners at a sector out; those of dead triangles are dropped.
    fn collect(&mut self, sector: u32, triangles: &[[u32; 3]], star: &mut Vec<u32>) {
        star.clear();
        let mut at = std::mem::replace(&mut self.first[sector as usize], NONE);
        while at != NONE {
            if triangles[at as usize / 3][at as usize % 3] == sector {
                star.push(at);
            }
            at = self.next[at as usize];
        }
    }
}
