//! Parts that vanish as a whole shrink to a point of their own, instead of flying to the part that stands for them.

use glam::Vec3;

use crate::geometry::sets::Sets;
use crate::mesh::NONE;

/// A sequence as shrinking reads it, by the numbers of its forest.
pub(super) struct Vanishing<'a, P, K> {
    /// For every triangle the steps after which it is gone (`NONE`: never) and its corners.
    pub drawn: &'a [(u32, [u32; 3])],
    /// Steps after which each level is reached.
    pub marks: &'a [u32],
    /// Per number the steps after which it is gone.
    pub removed: &'a [u32],
    /// The number that replaces a number.
    pub parent: &'a dyn Fn(u32) -> u32,
    /// Position of a number.
    pub position: P,
    /// Holds if some level draws a number.
    pub is_kept: K,
}

impl<P: Fn(u32) -> [f32; 3], K: Fn(u32) -> bool> Vanishing<'_, P, K> {
    /// Sets the targets of the vertices of vanishing parts: to the part's vertex nearest to the target. A part is what the
    /// input's triangles join, over seams too. O(n log n).
    pub fn shrink(&self, targets: &mut [u32]) {
        let part_of = self.parts(targets.len());
        // Steps after which a part has no triangle left, by the number of its root.
        let mut end = vec![0_u32; targets.len()];
        for (last, corners) in self.drawn {
            let part = part_of[corners[0] as usize] as usize;
            end[part] = end[part].max(*last);
        }
        let level = |steps: u32| self.marks.partition_point(|&mark| mark < steps);
        let part = |number: u32| {
            let part = part_of[number as usize];
            let vanishes =
                part != NONE && end[part as usize] != NONE && self.removed[number as usize] != NONE;
            let goes = vanishes && level(end[part as usize]) == level(self.removed[number as usize]);
            (goes && (self.is_kept)(number)).then_some(part as usize)
        };
        // Per part its heir, the vertex it is merged into, and the vertex of the part nearest to the heir.
        let mut heirs = vec![NONE; targets.len()];
        for number in 0..targets.len() as u32 {
            let target = targets[number as usize];
            if let Some(part) = part(number)
                && part_of[target as usize] as usize != part
                && heirs[part] == NONE
            {
                heirs[part] = target;
            }
        }
        let mut nearest = vec![(f32::INFINITY, NONE); targets.len()];
        for number in 0..targets.len() as u32 {
            if let Some(part) = part(number).filter(|&part| heirs[part] != NONE) {
                let [at, heir] = [number, heirs[part]].map(|n| Vec3::from_array((self.position)(n)));
                let distance = at.distance_squared(heir);
                if distance < nearest[part].0 || nearest[part].1 == NONE {
                    nearest[part] = (distance, number);
                }
            }
        }
        // A triangle with a single corner of a part would keep its area: parts that grew together do not shrink.
        for (last, corners) in self.drawn {
            let mut corners = *corners;
            for &mark in self.marks.iter().take_while(|&&mark| mark < *last) {
                for corner in &mut corners {
                    if self.removed[*corner as usize] <= mark {
                        *corner = targets[*corner as usize];
                    }
                }
                let goes = |&number: &u32| {
                    self.marks.get(level(mark) + 1).is_some_and(|&next| self.removed[number as usize] <= next)
                };
                let parts = corners.map(|number| Some(number).filter(goes).and_then(part));
                for at in 0..3 {
                    let others = [parts[(at + 1) % 3], parts[(at + 2) % 3]];
                    if let Some(part) = parts[at].filter(|_| !others.contains(&parts[at])) {
                        nearest[part].1 = NONE;
                    }
                }
            }
        }
        for number in 0..targets.len() as u32 {
            if let Some(part) = part(number).filter(|&part| nearest[part].1 != NONE) {
                targets[number as usize] = nearest[part].1;
            }
        }
    }

    /// Returns the part of every number, named by a number; `NONE` where no triangle is. Vertices made by merges belong to the
    /// part of what was merged.
    fn parts(&self, count: usize) -> Vec<u32> {
        let mut sets = Sets::new(count);
        let mut used: Vec<u32> = self.drawn.iter().flat_map(|(_, corners)| *corners).collect();
        for (_, [a, b, c]) in self.drawn {
            sets.join(*a, *b);
            sets.join(*b, *c);
        }
        used.sort_unstable();
        used.dedup();
        // Zeros of either sign are one place.
        let place = |&number: &u32| (self.position)(number).map(|x| (x + 0.0).to_bits());
        used.sort_by_cached_key(place);
        for pair in used.windows(2) {
            if place(&pair[0]) == place(&pair[1]) {
                sets.join(pair[0], pair[1]);
            }
        }
        let mut part_of = vec![NONE; count];
        for &number in &used {
            part_of[number as usize] = sets.find(number);
        }
        for number in (0..count as u32).rev() {
            let parent = (self.parent)(number);
            if part_of[parent as usize] == NONE {
                part_of[parent as usize] = part_of[number as usize];
            }
        }
        part_of
    }
}
