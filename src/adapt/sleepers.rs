//! Answers that still hold: how far the eye may move and turn until each is due, in dense arrays.
//!
//! ```text
//!     place        | 0 1 2 ... 63 | 64 ... 127 | ...      an answer is due once  distance / moved + angle / turned
//!     its answer   | share left at each rate   |          has used up its share
//!     block        | asleep | awake  | ...                a block sleeps until the first of its answers may be due,
//!                                                         in the course of the last motion
//! ```
//!
//! Two odometers run: the distance moved and the angle turned. A frame reads two numbers a block, and three numbers a place of the
//! blocks awake.

use crate::geometry::paged::trim;
use crate::view::{Answer, Motion};

/// Places in a block.
const BLOCK: usize = 64;
/// Share of an answer's slack to use: leaves more than the rounding of single-precision sums up to `PRECISE`.
const SHARE: f64 = 0.998;
/// Largest reading of an odometer, in multiples of an answer's slack, that leaves sums precise.
const PRECISE: f32 = 1024.0;
/// About this share of a block's sleep is kept for motion across the course.
const ACROSS: f64 = 1.0 / 16.0;

/// What is multiplied by these is not below, or not above, itself once it is rounded to single precision.
const UP: f64 = 1.0 + f32::EPSILON as f64;
const DOWN: f64 = 1.0 - f32::EPSILON as f64;

#[derive(Debug, Clone)]
pub(super) struct Sleepers {
    /// Per place, shares of its slack used per unit of distance and per radian, and the sum at which its answer is due.
    per_distance: Vec<f32>,
    per_angle: Vec<f32>,
    due_at: Vec<f32>,
    /// Per block, the readings of both odometers until which all of it sleeps.
    sleeps_until: Vec<[f64; 2]>,
    /// Distance and angle run since the readings were last set to 0.
    run: [f64; 2],
    /// The last motion.
    course: [f64; 2],
    /// Object's size, to compare distances with angles.
    size: f64,
    /// Set if an answer with a small slack could not be put down precisely.
    imprecise: bool,
    /// Set if no answer holds.
    all_due: bool,
}

impl Sleepers {
    /// Creates no places. `size` is the object's size, object units.
    pub fn new(size: f64) -> Self {
        let size = if size > 1e-290 { size } else { 1.0 };
        Self {
            per_distance: Vec::new(),
            per_angle: Vec::new(),
            due_at: Vec::new(),
            sleeps_until: Vec::new(),
            run: [0.0; 2],
            course: [size, 1.0],
            size,
            imprecise: false,
            all_due: false,
        }
    }

    fn len(&self) -> usize {
        self.due_at.len()
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.sleeps_until.len()
    }

    /// Adds a place, with an answer due.
    pub fn push(&mut self) {
        if self.len().is_multiple_of(BLOCK) {
            self.sleeps_until.push([f64::NEG_INFINITY; 2]);
        }
        self.per_distance.push(0.0);
        self.per_angle.push(0.0);
        self.due_at.push(f32::NEG_INFINITY);
        self.wake(self.len() - 1);
    }

    /// Removes a place. The last place takes its number.
    pub fn swap_remove(&mut self, place: usize) {
        self.per_distance.swap_remove(place);
        self.per_angle.swap_remove(place);
        self.due_at.swap_remove(place);
        self.sleeps_until.truncate(self.len().div_ceil(BLOCK));
        if place < self.len() {
            self.limit(place);
        }
    }

    fn wake(&mut self, place: usize) {
        self.sleeps_until[place / BLOCK] = [f64::NEG_INFINITY; 2];
    }

    /// Lets a place sleep while its answer holds.
    #[inline]
    pub fn rest(&mut self, place: usize, answer: Answer) {
        // Slacks are rounded down, rates up.
        let rate = |slack: f64| (1.0 / (slack * DOWN) as f32) * UP as f32;
        let [moving, turning] = [rate(answer.moved), rate(answer.turned)];
        let used = self.used(moving, turning);
        self.per_distance[place] = moving;
        self.per_angle[place] = turning;
        self.due_at[place] = if used < PRECISE {
            used + SHARE as f32
        } else {
            // Due in the next motion. That is too early if the slack is longer than the motion.
            let [distance, angle] = self.course;
            self.imprecise |=
                f64::from(moving) * distance + f64::from(turning) * angle < f64::from(PRECISE) / 16.0;
            f32::NEG_INFINITY
        };
        self.limit(place);
    }

    /// Sum of an answer's shares used since the odometers were last set to 0.
    #[inline]
    fn used(&self, per_distance: f32, per_angle: f32) -> f32 {
        let [distance, angle] = self.run.map(|run| (run * UP) as f32);
        per_distance * distance + per_angle * angle
    }

    /// Keeps the sleep of a place's block within the place's own.
    #[inline]
    fn limit(&mut self, place: usize) {
        let until = self.sleeps_until[place / BLOCK];
        if until[0] == f64::NEG_INFINITY {
            return;
        }
        let own = self.until(self.frames(place));
        self.sleeps_until[place / BLOCK] = [0, 1].map(|i| own[i].min(until[i]));
    }

    /// Motions like [`Sleepers::pace`] until a place's answer is due; 0 or less, or NaN, if it is.
    #[inline]
    fn frames(&self, place: usize) -> f64 {
        let [distance, angle] = self.pace();
        let [moving, turning] = [self.per_distance[place], self.per_angle[place]];
        let left = self.due_at[place] - self.used(moving, turning);
        f64::from(left) / (f64::from(moving) * distance + f64::from(turning) * angle)
    }

    /// Distance and angle by which sleeps of blocks are counted: the last motion, with some of what it lacks.
    fn pace(&self) -> [f64; 2] {
        let [distance, angle] = self.course;
        [distance.max(ACROSS * angle * self.size), angle.max(ACROSS * distance / self.size)]
    }

    /// Readings of the odometers after a number of motions.
    fn until(&self, frames: f64) -> [f64; 2] {
        let ([distance, angle], pace) = (self.run, self.pace());
        match frames > 0.0 {
            true => [distance + frames * pace[0], angle + frames * pace[1]],
            false => [f64::NEG_INFINITY; 2],
        }
    }

    /// Forgets all answers: all are due in the next call of [`Sleepers::advance`].
    pub fn forget(&mut self) {
        self.all_due = true;
    }

    /// Lists the places with answers due after a motion, ascending, and returns the number of blocks asleep.
    pub fn advance(&mut self, motion: Motion, due: &mut Vec<u32>) -> usize {
        due.clear();
        let moved = match motion {
            Motion::Moved { distance, angle } if !self.all_due => [distance, angle],
            _ => [f64::NAN; 2],
        };
        if moved == [0.0; 2] {
            return self.sleeps_until.len();
        }
        if self.imprecise {
            self.rebase();
        }
        if moved.iter().all(|x| x.is_finite()) {
            self.course = moved;
        }
        self.run = [0, 1].map(|i| self.run[i] + moved[i]);
        if !self.run.iter().all(|run| run.is_finite()) {
            self.all_due = false;
            self.run = [0.0; 2];
            self.sleeps_until.fill([f64::NEG_INFINITY; 2]);
            due.extend(0..self.len() as u32);
            return 0;
        }
        let mut asleep = 0;
        for block in 0..self.sleeps_until.len() {
            let until = self.sleeps_until[block];
            if self.run[0] < until[0] && self.run[1] < until[1] {
                asleep += 1;
            } else {
                self.look_through(block, due);
            }
        }
        asleep
    }

    /// Lists the places of a block with answers due. If there are none, the block falls asleep.
    fn look_through(&mut self, block: usize, due: &mut Vec<u32>) {
        let places = block * BLOCK..self.len().min((block + 1) * BLOCK);
        let [distance, angle] = self.run.map(|run| (run * UP) as f32);
        let columns = self.per_distance[places.clone()]
            .iter()
            .zip(&self.per_angle[places.clone()])
            .zip(&self.due_at[places.clone()]);
        // First all comparisons, then the few that count. What is no number does not hold.
        let mut holds = [true; BLOCK];
        for (holds, ((moving, turning), due_at)) in holds.iter_mut().zip(columns) {
            *holds = moving * distance + turning * angle < *due_at;
        }
        let (mut found, mut count) = ([0; BLOCK], 0);
        for (at, holds) in holds.iter().enumerate() {
            found[count % BLOCK] = (places.start + at) as u32;
            count += usize::from(!holds);
        }
        due.extend_from_slice(&found[..count]);
        let until = match count {
            0 => self.until(places.map(|place| self.frames(place)).fold(f64::INFINITY, f64::min)),
            _ => [f64::NEG_INFINITY; 2],
        };
        self.sleeps_until[block] = until;
    }

    /// Sets the readings to 0.
    fn rebase(&mut self) {
        for place in 0..self.len() {
            let left = self.due_at[place] - self.used(self.per_distance[place], self.per_angle[place]);
            self.due_at[place] = left.next_down();
        }
        for until in &mut self.sleeps_until {
            *until = [0, 1].map(|i| until[i] - self.run[i]);
        }
        self.run = [0.0; 2];
        self.imprecise = false;
    }

    /// Gives back memory if most of it is not in use.
    pub fn trim(&mut self) {
        trim(&mut self.per_distance);
        trim(&mut self.per_angle);
        trim(&mut self.due_at);
        trim(&mut self.sleeps_until);
    }

    /// Bytes of the arrays.
    pub fn memory(&self) -> usize {
        3 * self.due_at.capacity() * size_of::<f32>() + self.sleeps_until.capacity() * size_of::<[f64; 2]>()
    }
}
