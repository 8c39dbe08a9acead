//! Building a subdivision level by level: who is split, and the edges that this makes.
//!
//! Edges of one level are numbered anew: the halves of those with a wavelet, and three inside every split face. Each runs in one
//! direction, its wavelet's: that of the lower end first on the base, of its whole for a half, of the centre's side
//! inside.

use crate::mesh::{Edges, NONE};

use super::WaveletError;
use super::subdivision::{MOST_ALONG, MOST_FACES, MOST_LEVELS, Side, Subdivision};

/// A subdivision under construction. All of a level is split, or not, before the next.
#[derive(Debug)]
pub(super) struct SubdivisionBuilder {
    done: Subdivision,
    split_faces: Vec<u32>,
    /// Per face of the last level its edges, and which of them run against the side.
    edges: Vec<[u32; 3]>,
    against: Vec<[bool; 3]>,
    edge_count: usize,
    /// Per edge of the last level whether it is on a seam of the base.
    seam: Vec<bool>,
    /// Edges of the last level on the sides of coarser faces that are not split, and these.
    coarser: Vec<(u32, Side)>,
}

impl SubdivisionBuilder {
    /// `corners`: vertices of the base faces; `points`: the same, one number for each position; `midpoints`: for faces that
    /// are to be split something that tells sides with the same ends apart, or `NONE`.
    pub fn new(
        corners: Vec<[u32; 3]>,
        vertex_count: usize,
        points: &[[u32; 3]],
        midpoints: &[[u32; 3]],
    ) -> Result<Self, WaveletError> {
        check_faces(corners.len())?;
        let point_count = points.as_flattened().iter().max().map_or(0, |&max| max as usize + 1);
        let by_ends = Edges::new(points, point_count);
        let ends = by_ends.of_half_edges(points.len());
        // Several edges may have the same ends.
        let mut keys: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * points.len());
        for (face, edges) in ends.iter().enumerate() {
            for (side, &edge) in edges.iter().enumerate() {
                let middle = midpoints.get(face).map_or(NONE, |sides| sides[side]);
                // An edge of a face that has a point twice is its own.
                let alone = if edge == NONE { 3 * face as u32 + side as u32 } else { NONE };
                keys.push(([edge, if edge == NONE { alone } else { middle }], 3 * face as u32 + side as u32));
            }
        }
        keys.sort_unstable();
        let mut edges = vec![[NONE; 3]; corners.len()];
        let mut edge_count = 0;
        for same in keys.chunk_by(|a, b| a.0 == b.0) {
            if same.len() > MOST_ALONG {
                let triangle = (same[0].1 / 3) as usize;
                return Err(WaveletError::TooManyAlongEdge {
                    triangle,
                    count: same.len(),
                    limit: MOST_ALONG,
                });
            }
            same.iter().for_each(|key| edges.as_flattened_mut()[key.1 as usize] = edge_count as u32);
            edge_count += 1;
        }
        let runs = |p: &[u32; 3]| [0, 1, 2].map(|k| p[k] > p[(k + 1) % 3]);
        let against: Vec<[bool; 3]> = points.iter().map(runs).collect();
        Ok(Self::with_edges(corners, vertex_count as u32, edges, against, edge_count))
    }

    /// From the edges of the base faces: which is on each side, none twice on one face and at most [`MOST_ALONG`] times in
    /// all, and whether the side runs against it.
    pub fn with_edges(
        corners: Vec<[u32; 3]>,
        vertex_count: u32,
        edges: Vec<[u32; 3]>,
        against: Vec<[bool; 3]>,
        edge_count: usize,
    ) -> Self {
        // A seam is where the two ends, in order, are not the same vertices in all faces.
        let mut seam = vec![false; edge_count];
        let mut first = vec![[NONE; 2]; edge_count];
        for face in 0..corners.len() {
            for k in 0..3 {
                let [a, b] = [corners[face][k], corners[face][(k + 1) % 3]];
                let ends = if against[face][k] { [b, a] } else { [a, b] };
                let edge = edges[face][k] as usize;
                if first[edge] == [NONE; 2] {
                    first[edge] = ends;
                }
                seam[edge] |= first[edge] != ends;
            }
        }
        let count = corners.len() as u32;
        let done = Subdivision {
            base_sides: vec![[NONE; 3]; corners.len()],
            base: corners,
            base_vertices: vertex_count,
            face_levels: vec![0, count],
            levels: vec![0],
            ..Subdivision::default()
        };
        Self { done, split_faces: Vec::new(), edges, against, edge_count, seam, coarser: Vec::new() }
    }

    /// The subdivision so far; what is split in the last level is not known to it.
    pub fn subdivision(&self) -> &Subdivision {
        &self.done
    }

    /// Faces of the last level.
    pub fn last_level(&self) -> std::ops::Range<u32> {
        self.done.faces_of(self.done.depth())
    }

    /// Edges on seams that a split face is at.
    fn interior_seams(&self, split: &[bool]) -> Vec<bool> {
        let mut interior_seams = vec![false; self.edge_count];
        for (edges, _) in self.edges.iter().zip(split).filter(|(_, split)| **split) {
            edges.iter().for_each(|&edge| interior_seams[edge as usize] = self.seam[edge as usize]);
        }
        interior_seams
    }

    /// The first face of the last level that would be split only because one across a seam is. O(faces of the level).
    pub fn first_dragged(&self, split: &[bool]) -> Option<u32> {
        if !self.seam.contains(&true) {
            return None;
        }
        let interior_seams = self.interior_seams(split);
        let is_torn = |(edges, split): (&[u32; 3], &bool)| {
            !*split && edges.iter().any(|&edge| interior_seams[edge as usize])
        };
        let at = self.edges.iter().zip(split).position(is_torn)?;
        Some(self.last_level().start + at as u32)
    }

    /// Lets faces across a seam be split together, so that each side of a seam has vertices of its own.
    fn close(&self, split: &mut [bool]) {
        if !self.seam.contains(&true) {
            return;
        }
        loop {
            let interior_seams = self.interior_seams(split);
            let mut more = false;
            for (edges, split) in self.edges.iter().zip(split.iter_mut()) {
                if !*split && edges.iter().any(|&edge| interior_seams[edge as usize]) {
                    (*split, more) = (true, true);
                }
            }
            if !more {
                return;
            }
        }
    }

    /// Splits those of the last level, and those across seams from them; `false` where there is none.
    pub fn split(&mut self, mut split: Vec<bool>) -> Result<bool, WaveletError> {
        self.close(&mut split);
        self.split_only(&split)
    }

    /// Splits those of the last level and no others; `false` where there is none.
    pub fn split_only(&mut self, split: &[bool]) -> Result<bool, WaveletError> {
        let faces = self.last_level();
        let new: Vec<u32> = (faces.clone()).zip(split).filter(|(_, split)| **split).map(|(f, _)| f).collect();
        if new.is_empty() {
            return Ok(false);
        }
        if self.done.depth() == MOST_LEVELS {
            let (count, limit) = (MOST_LEVELS + 1, MOST_LEVELS);
            return Err(WaveletError::TooMany { what: "levels", count, limit });
        }
        let end = faces.end as usize + 4 * new.len();
        check_faces(end)?;

        // Wavelets, in the order of the faces.
        let first = self.done.along.len() as u32;
        let mut wavelet_on = vec![NONE; self.edge_count];
        let mut wavelets = 0;
        for &face in &new {
            let sides = self.edges[(face - faces.start) as usize].map(|edge| {
                let wavelet = &mut wavelet_on[edge as usize];
                if *wavelet == NONE {
                    *wavelet = first + wavelets;
                    wavelets += 1;
                }
                *wavelet
            });
            self.done.sides.push(sides);
        }
        let mut coarser: Vec<(u32, Side)> = Vec::new();
        self.done.along.resize((first + wavelets) as usize, [Side::NONE; 2]);
        for face in faces.clone() {
            let at = (face - faces.start) as usize;
            for k in 0..3 {
                let wavelet = wavelet_on[self.edges[at][k] as usize];
                if faces.start == 0 {
                    self.done.base_sides[at][k] = wavelet;
                }
                if wavelet == NONE {
                    continue;
                }
                let side = Side::new(face, k, self.against[at][k]);
                self.add(wavelet, side);
                if !split[at] {
                    coarser.push((wavelet, side));
                }
            }
        }
        for (edge, side) in std::mem::take(&mut self.coarser) {
            let wavelet = wavelet_on[edge as usize];
            if wavelet != NONE {
                self.add(wavelet, side);
                coarser.push((wavelet, side));
            }
        }
        let halves = |&(wavelet, side): &(u32, Side)| [0, 1].map(|half| (2 * (wavelet - first) + half, side));
        self.coarser = coarser.iter().flat_map(halves).collect();

        // Faces and edges of the next level.
        let inside = 2 * wavelets;
        let mut edges = Vec::with_capacity(4 * new.len());
        let mut against = Vec::with_capacity(4 * new.len());
        let mut seam = vec![false; inside as usize + 3 * new.len()];
        for (rank, &face) in new.iter().enumerate() {
            let at = (face - faces.start) as usize;
            let whole = self.edges[at];
            let runs = self.against[at];
            let half = |k: usize, half: u32| {
                2 * (wavelet_on[whole[k] as usize] - first) + (half ^ u32::from(runs[k]))
            };
            let inner = |k: usize| inside + 3 * rank as u32 + k as u32;
            for i in 0..3 {
                let j = (i + 2) % 3;
                edges.push([half(i, 0), inner(j), half(j, 1)]);
                against.push([runs[i], true, runs[j]]);
            }
            edges.push([0, 1, 2].map(inner));
            against.push([false; 3]);
            for k in 0..3 {
                let on = self.seam[whole[k] as usize];
                [0, 1].into_iter().for_each(|h| seam[half(k, h) as usize] = on);
            }
        }
        self.edge_count = seam.len();
        (self.edges, self.against, self.seam) = (edges, against, seam);
        self.split_faces.extend(new);
        self.done.face_levels.push(end as u32);
        self.done.levels.push(first + wavelets);
        self.done.split_count = self.split_faces.len() as u32;
        self.index();
        Ok(true)
    }

    fn add(&mut self, wavelet: u32, side: Side) {
        let [one, two] = &mut self.done.along[wavelet as usize];
        if *one == Side::NONE {
            *one = side;
        } else if *two == Side::NONE {
            *two = side;
        } else {
            self.done.more.push((wavelet, side));
        }
    }

    /// Makes known which faces are split.
    fn index(&mut self) {
        let done = &mut self.done;
        // Not of earlier levels alone: then the faces of the new one are split as their numbers say.
        if self.split_faces.last().is_some_and(|&last| last as usize + 1 == self.split_faces.len()) {
            return;
        }
        let words = done.face_levels.last().map_or(0, |&end| end as usize).div_ceil(64);
        done.split.clear();
        done.split.resize(words, 0);
        for &face in &self.split_faces {
            done.split[face as usize / 64] |= 1 << (face % 64);
        }
        done.before.clear();
        let mut count = 0;
        for word in &done.split {
            done.before.push(count);
            count += word.count_ones();
        }
        done.split_faces.clone_from(&self.split_faces);
    }

    /// The subdivision, where every wavelet has one vertex.
    pub fn finish_without_seams(self) -> Subdivision {
        let mut done = self.done;
        done.more.sort_unstable_by_key(|more| (more.0, more.1.0));
        done
    }

    /// The subdivision. `key` tells the vertices at the midpoint of a side of a split face apart, as children have them: the one
    /// at the first half, the one at the second, and the centre. Those along one edge with the same key share one.
    pub fn finish<K: PartialEq>(self, key: impl Fn(&Subdivision, u32, usize, Part) -> K) -> Subdivision {
        let mut done = self.finish_without_seams();
        // Across a seam faces are split together.
        done.tell_apart(
            |of, along| of.is_split(along.face()),
            |of, _, face, side, part| key(of, face, side, part),
        );
        done
    }

    /// The same where faces that are not split are beside seams too: `key` is asked for their sides for each wavelet there.
    pub fn finish_beside<K: PartialEq>(
        self,
        key: impl Fn(&Subdivision, u32, u32, usize, Part) -> K,
    ) -> Subdivision {
        let mut done = self.finish_without_seams();
        done.tell_apart(|_, _| true, key);
        done
    }
}

impl Subdivision {
    /// Gives wavelets one vertex for each key that the sides along their edges have; to those that are `looked_at`. A face that is
    /// not split has the key of the first side, or one that no other has. `key` is told wavelet, face, side and part.
    pub(super) fn tell_apart<K: PartialEq>(
        &mut self,
        looked_at: impl Fn(&Self, Side) -> bool,
        key: impl Fn(&Self, u32, u32, usize, Part) -> K,
    ) {
        let first = (self.base_vertices as usize + self.along.len()) as u32;
        let mut known: Vec<(K, u32)> = Vec::new();
        for wavelet in 0..self.along.len() as u32 {
            known.clear();
            let sides: Vec<Side> = self.faces_along(wavelet).filter(|&side| looked_at(self, side)).collect();
            let mut interior_seams = false;
            for along in sides {
                let (face, side) = (along.face(), along.side());
                let vertices = Part::ALL.map(|part| {
                    let key = key(self, wavelet, face, side, part);
                    let at = known.iter().position(|known| known.0 == key).unwrap_or_else(|| {
                        let own = if known.is_empty() {
                            self.vertex_of(wavelet)
                        } else {
                            self.seam_vertices.push((wavelet, along));
                            first + self.seam_vertices.len() as u32 - 1
                        };
                        known.push((key, own));
                        known.len() - 1
                    });
                    known[at].1
                });
                if !self.is_split(face) {
                    continue;
                }
                interior_seams |= vertices.iter().any(|&vertex| vertex != vertices[0]);
                for (part, vertex) in Part::ALL.into_iter().zip(vertices) {
                    if vertex != self.vertex_of(wavelet) {
                        let (child, corner) = part.corner(side);
                        self.seams.push((self.child(face, child) << 2 | corner as u32, vertex));
                        self.mark_seam(face, side);
                    }
                }
            }
            if interior_seams {
                self.interior_seams.push(wavelet);
            }
        }
        self.seams.sort_unstable();
    }
}

/// Children of a split face that meet at the midpoint of a side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    First,
    Second,
    Centre,
}

impl Part {
    pub const ALL: [Self; 3] = [Self::First, Self::Second, Self::Centre];

    /// The child, and its corner at the midpoint of that side.
    pub fn corner(self, side: usize) -> (usize, usize) {
        match self {
            Self::First => (side, 1),
            Self::Second => ((side + 1) % 3, 2),
            Self::Centre => (3, side),
        }
    }
}

fn check_faces(count: usize) -> Result<(), WaveletError> {
    if count > MOST_FACES {
        Err(WaveletError::TooMany { what: "faces", count, limit: MOST_FACES })
    } else {
        Ok(())
    }
}
