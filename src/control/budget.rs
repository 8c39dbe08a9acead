//! A split of one number of triangles over the objects of a scene, by the screen error that each triangle saves.
//!
//! ```text
//!     error saved   |o                            steps of all objects, most saved per triangle first
//!     per triangle  | o o
//!                   |    o  o o                   taken until the triangles are spent;
//!                   |--------------o--- slope     the slope at the end opens the search of the next frame
//!                   |                o   o    o   steps already drawn count 1 + hysteresis times, so that equals
//!                   +-------------------------->  do not take turns
//!                    triangles, summed  ^ budget
//! ```
//!
//! Funkhouser and Sequin 1993 maximise benefit within a cost, greedily by benefit over cost, from the split of the last frame.
//! Gobbetti and Bouvier 1999 do so for continuous resolutions, as a convex program. Here benefit is screen error saved. On the
//! convex hull of each ladder the greedy split is the optimum of the continuous problem but for the last step, and the slope of
//! that step proves how far the split is from the best.

use super::error::{ControlError, check};
use super::exact::{Exact, Problem};
use super::ladder::{LadderObject, Step};
use super::selection::reach;

/// Most steps, after the first that does not fit, that are tried for the rest of the triangles.
const REST: usize = 512;
/// Objects by which the slope of a first frame is estimated, at least.
const SAMPLE: usize = 128;
/// The steps looked at first have slopes within these factors of the slope of the last frame; then all steps.
const WINDOWS: [f32; 2] = [1.2, 4.0];

/// Options of [`Budget`]. Defaults: 1,000,000 triangles, hysteresis 0.05, gap 0.02, no tolerance, up to 64 objects split exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BudgetOptions {
    /// Most triangles of all objects together. Default 1,000,000.
    pub triangles: usize,
    /// Share by which a step must save more error per triangle than a step drawn already, to take its triangles; 0 to 1. Default
    /// 0.05.
    pub hysteresis: f32,
    /// Share of the total screen error by which a small scene's split may be above the best; above 0, at most 1. Default 0.02.
    pub gap: f32,
    /// Screen error that needs no finer level, pixels, 0 or more: triangles that would only save less are not spent. Default 0:
    /// spends the whole budget.
    pub tolerance_px: f32,
    /// Most objects for which the best split is searched, where the greedy split is not proven to be within the gap. The search
    /// ends after 20,000 nodes (about 0.3 ms). With more objects, a step is a small part of the scene. Default 64.
    pub exact: usize,
}

impl Default for BudgetOptions {
    fn default() -> Self {
        Self { triangles: 1_000_000, hysteresis: 0.05, gap: 0.02, tolerance_px: 0.0, exact: 64 }
    }
}

impl BudgetOptions {
    /// Sets the most triangles of all objects together.
    #[must_use]
    pub fn with_triangles(mut self, most: usize) -> Self {
        self.triangles = most;
        self
    }

    /// Sets the share by which a step must be better than a step drawn already.
    #[must_use]
    pub fn with_hysteresis(mut self, share: f32) -> Self {
        self.hysteresis = share;
        self
    }

    /// Sets the share by which a small scene's split may be above the best.
    #[must_use]
    pub fn with_gap(mut self, share: f32) -> Self {
        self.gap = share;
        self
    }

    /// Sets the screen error that needs no finer level, pixels.
    #[must_use]
    pub fn with_tolerance_px(mut self, pixels: f32) -> Self {
        self.tolerance_px = pixels;
        self
    }

    /// Sets the most objects for which the best split is searched.
    #[must_use]
    pub fn with_exact(mut self, objects: usize) -> Self {
        self.exact = objects;
        self
    }

    fn check(&self) -> Result<(), ControlError> {
        let Self { hysteresis, gap, tolerance_px, .. } = *self;
        check("hysteresis", hysteresis.into(), (0.0..=1.0).contains(&hysteresis), "0 to 1")?;
        check("gap", gap.into(), gap > 0.0 && gap <= 1.0, "above 0 and at most 1")?;
        let pixels = tolerance_px >= 0.0 && tolerance_px.is_finite();
        check("tolerance_px", tolerance_px.into(), pixels, "0 or more and finite")
    }
}

/// Result of [`Budget::split`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Split {
    /// Triangles of all levels chosen.
    pub triangles: usize,
    /// Total screen error: the sum over all objects of `importance * pixels * error`, pixels.
    pub error: f64,
    /// Total screen error that no split within the budget can be below, pixels: Lagrange's bound. `error / bound - 1` is the most
    /// by which the split is above the best.
    pub bound: f64,
    /// Number of objects whose level differs from the last call. New objects count as drawn at their coarsest before.
    pub changed: usize,
    /// Set if the coarsest levels have more triangles than the budget. Then all objects are at their coarsest.
    pub over_budget: bool,
}

/// Bits of a key that do not tell its class: classes are an eighth of an octave wide.
const CLASS_SHIFT: u32 = 20;
/// Number of classes of keys: all finite keys and infinity.
const CLASSES: usize = (f32::INFINITY.to_bits() >> CLASS_SHIFT) as usize + 1;

/// Returns the class of a key of at least 0. Higher keys have no lower classes.
fn class_of(key: f32) -> usize {
    ((key.to_bits() >> CLASS_SHIFT) as usize).min(CLASSES - 1)
}

/// Returns the lowest and the highest key of a class.
fn keys_of(class: usize) -> [f32; 2] {
    let low = (class as u32) << CLASS_SHIFT;
    let high = (low | ((1 << CLASS_SHIFT) - 1)).min(f32::INFINITY.to_bits());
    [low, high].map(f32::from_bits)
}

/// A step of an object to a finer level of its hull.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// Screen error saved per triangle; a step drawn already counts `1 + hysteresis` times.
    key: f32,
    object: u32,
    step: u32,
    triangles: u32,
}

/// Splits one number of triangles over all objects of a scene, so that the total screen error is as small as possible.
///
/// Every frame: fill a reused vector of [`LadderObject`]s, call [`split`](Self::split), draw each object at its level of
/// [`levels`](Self::levels). Levels may belong to totally ordered meshes, geomorph meshes or anything else with triangles and
/// errors; hierarchies and wavelet meshes come in by an [`Estimate`](super::Estimate).
///
/// Objects keep their places in the slice from call to call; new objects come last. Where objects change places, only
/// hysteresis suffers; [`forget`](Self::forget) avoids it.
///
/// O(n) expected in the number of levels of all objects. Allocates only while objects grow in number.
///
/// ```
/// use multires::control::{Budget, BudgetOptions, Ladder, LadderObject};
///
/// let statue = Ladder::new(&[(10_000, 0.0), (2_000, 0.01), (200, 0.1)])?;
/// let tree = Ladder::new(&[(500, 0.05), (2, 1.0)])?;
/// let mut budget = Budget::new(BudgetOptions::default().with_triangles(3_000))?;
///
/// // A statue at 100 pixels a unit, two trees at 40, a statue out of sight.
/// let objects = [(&statue, 100.0), (&tree, 40.0), (&tree, 40.0), (&statue, 0.0)];
/// let objects = objects.map(|(ladder, pixels)| LadderObject::new(ladder, pixels));
/// let split = budget.split(&objects);
/// assert_eq!(budget.levels(), [2, 0, 0, 2]);
/// assert!(split.triangles <= 3_000);
/// # Ok::<(), multires::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Budget {
    options: BudgetOptions,
    /// Weight of each object's errors, in this call.
    weights: Vec<f32>,
    /// Chosen rung of each object.
    rungs: Vec<u32>,
    /// Rungs before a call, of a small scene.
    before: Vec<u32>,
    /// Chosen level of each object.
    levels: Vec<u32>,
    /// Steps that each object takes, hysteresis and rest included; where the search of the next call begins.
    taken: Vec<u32>,
    entries: Vec<Entry>,
    /// Triangles of the steps of each class of keys.
    classes: Vec<u64>,
    /// Error saved per triangle by the first step that did not fit; 0: all fitted.
    slope: f32,
    exact: Exact,
}

impl Budget {
    /// Creates a budget.
    ///
    /// # Errors
    /// An option is out of its range.
    pub fn new(options: BudgetOptions) -> Result<Self, ControlError> {
        options.check()?;
        Ok(Self {
            options,
            weights: Vec::new(),
            rungs: Vec::new(),
            before: Vec::new(),
            levels: Vec::new(),
            taken: Vec::new(),
            entries: Vec::new(),
            classes: Vec::new(),
            slope: 0.0,
            exact: Exact::default(),
        })
    }

    /// Returns the options.
    pub fn options(&self) -> &BudgetOptions {
        &self.options
    }

    /// Sets the options.
    ///
    /// # Errors
    /// An option is out of its range. Nothing has changed then.
    pub fn set_options(&mut self, options: BudgetOptions) -> Result<(), ControlError> {
        options.check()?;
        self.options = options;
        Ok(())
    }

    /// Sets the most triangles of all objects together: every frame, from [`FrameTime`](super::FrameTime) for example.
    pub fn set_triangles(&mut self, most: usize) {
        self.options.triangles = most;
    }

    /// Returns the level of each object of the last [`split`](Self::split), numbered as its ladder was made. 0 for an object on a
    /// default ladder.
    pub fn levels(&self) -> &[u32] {
        &self.levels
    }

    /// Forgets the last split, so that the next split has no hysteresis: after a cut to another scene.
    pub fn forget(&mut self) {
        self.rungs.clear();
        self.slope = 0.0;
    }

    /// Chooses a level for each object. The triangles never exceed the budget, unless the coarsest levels do.
    pub fn split(&mut self, objects: &[LadderObject<'_>]) -> Split {
        let limit = self.options.triangles as u64;
        let (mut base, mut steps) = (0_u64, 0);
        for object in objects {
            base += object.ladder.coarsest().1 as u64;
            steps += object.ladder.steps().len();
        }
        // The window of a later frame may hold all steps.
        self.entries.clear();
        self.entries.reserve(steps);
        self.weights.clear();
        self.weights.extend(objects.iter().map(LadderObject::weight));
        let known = self.rungs.len() == objects.len();
        self.rungs.resize(objects.len(), 0);
        self.taken.resize(objects.len(), 0);
        if objects.len() <= self.options.exact {
            self.before.clone_from(&self.rungs);
        }
        match limit.checked_sub(base) {
            Some(room) => self.take(objects, room),
            None => {
                self.taken.fill(0);
                self.slope = f32::INFINITY;
            }
        }
        let tolerance = self.options.tolerance_px;
        let [mut found, mut kept] = [Sum::default(); 2];
        let mut least = 0.0;
        let weighted = objects.iter().zip(&self.weights);
        for (((object, &weight), &taken), rung) in weighted.zip(&self.taken).zip(&mut self.rungs) {
            let finest = object.finest_rung(weight, tolerance);
            let (weight, before, after) = (f64::from(weight), *rung, rung_after(object, taken));
            // A rung of the last split may be gone, or too fine by now.
            *rung = before.min(finest);
            kept.add(object, weight, *rung, *rung != before);
            found.add(object, weight, after, after != before);
            least += lagrange(object, weight, self.slope, finest, taken);
        }
        let keeps = known && kept.triangles <= limit && kept.error <= found.error;
        let bound = (least - f64::from(self.slope) * limit as f64).max(0.0);
        let bound = if base > limit { found.error } else { bound };
        let sum = if keeps { kept } else { found };
        if !keeps {
            for ((object, &taken), rung) in objects.iter().zip(&self.taken).zip(&mut self.rungs) {
                *rung = rung_after(object, taken);
            }
        }
        self.write_levels(objects);
        let mut split = Split {
            triangles: usize::try_from(sum.triangles).unwrap_or(usize::MAX),
            error: sum.error,
            bound: bound.min(sum.error),
            changed: sum.changed,
            over_budget: base > limit,
        };
        let gap = f64::from(self.options.gap);
        if !split.over_budget
            && objects.len() <= self.options.exact
            && split.error > split.bound * (1.0 + gap)
        {
            self.improve(objects, &mut split);
        }
        split
    }

    /// Searches the best split of a small scene.
    fn improve(&mut self, objects: &[LadderObject<'_>], split: &mut Split) {
        let problem = Problem {
            objects,
            tolerance_px: self.options.tolerance_px,
            triangles: self.options.triangles as u64,
            slope: f64::from(self.slope),
            threshold: split.error * (1.0 - f64::from(self.options.gap)),
        };
        let Some((triangles, error)) = self.exact.search(&problem, f64::from(self.options.gap)) else {
            return;
        };
        split.triangles = triangles as usize;
        split.error = error;
        split.bound = split.bound.min(error);
        self.rungs.clear();
        self.rungs.extend_from_slice(self.exact.rungs());
        split.changed = self.rungs.iter().zip(&self.before).filter(|(rung, before)| rung != before).count();
        self.write_levels(objects);
    }

    /// Sets the levels of the chosen rungs.
    fn write_levels(&mut self, objects: &[LadderObject<'_>]) {
        self.levels.clear();
        self.levels.extend(objects.iter().zip(&self.rungs).map(|(object, &rung)| level(object, rung)));
    }

    /// Sets how many steps each object takes: the best, within `room` triangles.
    fn take(&mut self, objects: &[LadderObject<'_>], room: u64) {
        let last = self.slope;
        let known = last > 0.0 && last.is_finite();
        if known && WINDOWS.iter().any(|&by| self.take_within(objects, room, [last / by, last * by])) {
            return;
        }
        // A sample of the objects finds about where the split ends; all objects find it surely.
        let every = objects.len() / SAMPLE;
        if every > 1 {
            let [low, high] = self.survey(objects, every, room / every as u64);
            if self.take_within(objects, room, [low / WINDOWS[0], high * WINDOWS[0]]) {
                return;
            }
        }
        let window = self.survey(objects, 1, room);
        self.take_within(objects, room, window);
    }

    /// Returns a window of keys in which the split of every so many objects ends, of `room` triangles: triangles are summed by
    /// classes of keys, an eighth of an octave wide.
    fn survey(&mut self, objects: &[LadderObject<'_>], every: usize, room: u64) -> [f32; 2] {
        let Self { options, weights, rungs, classes, .. } = self;
        let boost = 1.0 + options.hysteresis;
        classes.clear();
        classes.resize(CLASSES, 0);
        for ((object, &weight), &rung) in objects.iter().zip(&*weights).zip(&*rungs).step_by(every) {
            let (steps, scale) = (object.ladder.steps(), object.scale());
            if weight <= 0.0 {
                continue;
            }
            for step in steps.iter().take_while(|step| scale * step.error > options.tolerance_px) {
                let key = weight * step.slope * if step.to <= rung { boost } else { 1.0 };
                classes[class_of(key)] += u64::from(step.triangles);
            }
        }
        let mut sum = 0_u64;
        let reached = classes.iter().rposition(|triangles| {
            sum += triangles;
            sum > room
        });
        // Steps that follow within the next frame's first window may fill the rest.
        let [low, high] = reached.map_or([0.0; 2], keys_of);
        [low / (boost * WINDOWS[0]), high]
    }

    /// Takes all steps above a window of keys, none below, and the best within. Returns whether the split ends in the window.
    fn take_within(&mut self, objects: &[LadderObject<'_>], room: u64, [low, high]: [f32; 2]) -> bool {
        let Self { options, weights, rungs, taken, entries, slope, .. } = self;
        let boost = 1.0 + options.hysteresis;
        let (mut above, mut more) = (0_u64, false);
        entries.clear();
        let weighted = objects.iter().zip(&*weights);
        for (number, (((object, &weight), &rung), taken)) in
            weighted.zip(&*rungs).zip(&mut *taken).enumerate()
        {
            let (steps, levels, scale) = (object.ladder.steps(), object.ladder.rungs(), object.scale());
            let key = |step: &Step| weight * step.slope * if step.to <= rung { boost } else { 1.0 };
            let needed = |step: &Step| scale * step.error > options.tolerance_px;
            // Keys and errors fall from step to step. The place of the last call is mostly near.
            let mut first = if weight > 0.0 { (*taken as usize).min(steps.len()) } else { 0 };
            while first > 0 && !(needed(&steps[first - 1]) && key(&steps[first - 1]) > high) {
                first -= 1;
            }
            let mut at = first;
            while weight > 0.0 && at < steps.len() && needed(&steps[at]) {
                let key = key(&steps[at]);
                if key > high {
                    first = at + 1;
                } else if key >= low {
                    let (object, step, triangles) = (number as u32, at as u32, steps[at].triangles);
                    entries.push(Entry { key, object, step, triangles });
                } else {
                    more = true;
                    break;
                }
                at += 1;
            }
            if let Some(last) = first.checked_sub(1) {
                above += u64::from(levels[steps[last].to as usize].triangles - levels[0].triangles);
            }
            *taken = first as u32;
        }
        let Some(mut room) = room.checked_sub(above) else { return false };
        let order = |a: &Entry, b: &Entry| {
            b.key.total_cmp(&a.key).then(a.object.cmp(&b.object)).then(a.step.cmp(&b.step))
        };
        let Some(reached) = reach(entries, room + 1, order, |entry| u64::from(entry.triangles)) else {
            if more {
                return false;
            }
            for entry in &*entries {
                taken[entry.object as usize] += 1;
            }
            *slope = 0.0;
            return true;
        };
        let first_left = entries[reached - 1];
        for entry in &entries[..reached - 1] {
            taken[entry.object as usize] += 1;
            room -= u64::from(entry.triangles);
        }
        let step = objects[first_left.object as usize].ladder.steps()[first_left.step as usize];
        let drawn = step.to <= rungs[first_left.object as usize];
        *slope = if drawn { first_left.key / boost } else { first_left.key };
        // Smaller steps may still fit. The room only shrinks, so steps too large for it now need no sorting.
        entries.drain(..reached);
        if entries.len() > REST {
            entries.select_nth_unstable_by(REST, order);
            entries.truncate(REST);
        }
        entries.retain(|entry| u64::from(entry.triangles) <= room);
        entries.sort_unstable_by(order);
        for entry in entries {
            let next = &mut taken[entry.object as usize];
            if *next == entry.step && u64::from(entry.triangles) <= room {
                *next += 1;
                room -= u64::from(entry.triangles);
            }
        }
        true
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    triangles: u64,
    error: f64,
    /// Objects on another rung than before.
    changed: usize,
}

impl Sum {
    fn add(&mut self, object: &LadderObject<'_>, weight: f64, rung: u32, changed: bool) {
        self.changed += usize::from(changed);
        if let Some(rung) = object.ladder.rungs().get(rung as usize) {
            self.triangles += u64::from(rung.triangles);
            self.error += weight * f64::from(rung.error);
        }
    }
}

fn level(object: &LadderObject<'_>, rung: u32) -> u32 {
    object.ladder.rungs().get(rung as usize).map_or(0, |rung| rung.level)
}

/// Returns the rung of the hull after a number of steps.
fn rung_after(object: &LadderObject<'_>, steps: u32) -> u32 {
    (steps as usize).checked_sub(1).map_or(0, |last| object.ladder.steps()[last].to)
}

/// Returns the least `weight * error + slope * triangles` of the rungs up to `finest`. Begins after a number of steps: mostly the
/// place of the least.
fn lagrange(object: &LadderObject<'_>, weight: f64, slope: f32, finest: u32, begin: u32) -> f64 {
    let (slope, ladder) = (f64::from(slope), object.ladder);
    let steps = ladder.steps();
    let saves = |at: usize| steps[at].to <= finest && weight * f64::from(steps[at].slope) > slope;
    let mut count = (begin as usize).min(steps.len());
    while count > 0 && !saves(count - 1) {
        count -= 1;
    }
    while count < steps.len() && saves(count) {
        count += 1;
    }
    let rung = ladder.rungs().get(rung_after(object, count as u32) as usize);
    rung.map_or(0.0, |rung| weight * f64::from(rung.error) + slope * f64::from(rung.triangles))
}
