//! Builds a subdivision level by level: the faces to split, and the new edges.
//!
//! Edges of each level are numbered anew: the halves of edges with a wavelet, and three inside every split face. Each
//! edge runs in a single direction, its wavelet's: on the base from the lower end, a half as its whole edge, an inside
//! edge as the side of the central child.

use crate::geometry::lists::Lists;
use crate::mesh::NONE;
use crate::wavelet::WaveletError;

use super::base_edges::{edge_keys, number_edges, seam_edges};
use super::{MOST_FACES, MOST_LEVELS, Part, Side, Subdivision};

/// A subdivision under construction. All faces to split in a level are given before the next level.
#[derive(Debug)]
pub(crate) struct SubdivisionBuilder {
    done: Subdivision,
    split_faces: Vec<u32>,
    /// Per face of the last level its edges. `against`: whether a side and its edge run in opposite directions.
    edges: Vec<[u32; 3]>,
    against: Vec<[bool; 3]>,
    edge_count: usize,
    /// Per edge of the last level whether it is on a seam of the base.
    seam: Vec<bool>,
    /// Edges of the last level on the sides of unsplit coarser faces, with these sides.
    coarser: Vec<(u32, Side)>,
}

impl SubdivisionBuilder {
    /// Creates a builder. `corners`: vertices of the base faces. `points`: corners with a single number for each
    /// position. `midpoints`: per side of a face to be split, a number telling apart sides with the same ends, or `NONE`.
    pub fn new(
        corners: Vec<[u32; 3]>,
        vertex_count: usize,
        points: &[[u32; 3]],
        midpoints: &[[u32; 3]],
    ) -> Result<Self, WaveletError> {
        check_faces(corners.len())?;
        let (edges, edge_count) = number_edges(&edge_keys(points, midpoints), corners.len())?;
        let runs = |p: &[u32; 3]| [0, 1, 2].map(|k| p[k] > p[(k + 1) % 3]);
        let against: Vec<[bool; 3]> = points.iter().map(runs).collect();
        Ok(Self::with_edges(corners, vertex_count as u32, edges, against, edge_count))
    }

    /// Creates a builder from the edges of the base faces. Per side its edge (never twice on a face, at most
    /// [`MOST_ALONG`](super::MOST_ALONG) times in all), and whether the side runs against the edge.
    pub fn with_edges(
        corners: Vec<[u32; 3]>,
        vertex_count: u32,
        edges: Vec<[u32; 3]>,
        against: Vec<[bool; 3]>,
        edge_count: usize,
    ) -> Self {
        let seam = seam_edges(&corners, &edges, &against, edge_count);
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

    /// Returns the subdivision so far, without splits of the last level.
    pub fn subdivision(&self) -> &Subdivision {
        &self.done
    }

    /// Returns the faces of the last level.
    pub fn last_level(&self) -> std::ops::Range<u32> {
        self.done.faces_of(self.done.depth())
    }

    /// Also splits the faces across a seam from split faces, so each side of a seam has its own vertices. O(faces of the level).
    fn close(&self, split: &mut [bool]) {
        if !self.seam.contains(&true) {
            return;
        }
        let on_seams = |face: usize| self.edges[face].into_iter().filter(|&edge| self.seam[edge as usize]);
        let sides =
            (0..self.edges.len()).flat_map(|face| on_seams(face).map(move |edge| (edge, face as u32)));
        let faces_on = Lists::from_pairs(self.edge_count, sides);
        let mut reached = vec![false; self.edge_count];
        let mut waiting: Vec<usize> = (0..split.len()).filter(|&face| split[face]).collect();
        while let Some(face) = waiting.pop() {
            for edge in on_seams(face).filter(|&edge| !std::mem::replace(&mut reached[edge as usize], true)) {
                for &beyond in faces_on.get(edge) {
                    if !std::mem::replace(&mut split[beyond as usize], true) {
                        waiting.push(beyond as usize);
                    }
                }
            }
        }
    }

    /// Splits the given faces of the last level, and faces across seams from them. `false`: no face was split.
    pub fn split(&mut self, mut split: Vec<bool>) -> Result<bool, WaveletError> {
        self.close(&mut split);
        self.split_only(&split)
    }

    /// Splits only the given faces of the last level. `false`: no face was split.
    pub fn split_only(&mut self, split: &[bool]) -> Result<bool, WaveletError> {
        let faces = self.last_level();
        let new: Vec<u32> = (faces.clone()).zip(split).filter(|(_, split)| **split).map(|(f, _)| f).collect();
        if new.is_empty() {
            return Ok(false);
        }
        let end = faces.end as usize + 4 * new.len();
        self.check_level(end)?;
        let wavelets = self.add_wavelets(&new);
        self.add_sides(&wavelets, split);
        self.next_level(&wavelets, &new);
        self.split_faces.extend(new);
        self.done.face_levels.push(end as u32);
        self.done.levels.push(wavelets.end);
        self.done.split_count = self.split_faces.len() as u32;
        self.index();
        Ok(true)
    }

    /// Fails if there are too many levels, or too many faces with the next level, `end` in all.
    fn check_level(&self, end: usize) -> Result<(), WaveletError> {
        if self.done.depth() == MOST_LEVELS {
            let (count, limit) = (MOST_LEVELS + 1, MOST_LEVELS);
            return Err(WaveletError::TooMany { what: "levels", count, limit });
        }
        check_faces(end)
    }

    /// Adds a wavelet on each edge of the split faces, in the order of the faces.
    fn add_wavelets(&mut self, split_faces: &[u32]) -> LevelWavelets {
        let first = self.done.along.len() as u32;
        let mut wavelets = LevelWavelets { first, end: first, on: vec![NONE; self.edge_count] };
        let faces = self.last_level();
        for &face in split_faces {
            let sides = self.edges[(face - faces.start) as usize].map(|edge| wavelets.add(edge));
            self.done.sides.push(sides);
        }
        self.done.along.resize(wavelets.end as usize, [Side::NONE; 2]);
        wavelets
    }

    /// Lists the sides along each new wavelet's edge: of faces of the level, then of coarser faces.
    fn add_sides(&mut self, wavelets: &LevelWavelets, split: &[bool]) {
        let faces = self.last_level();
        let mut coarser: Vec<(u32, Side)> = Vec::new();
        for face in faces.clone() {
            let at = (face - faces.start) as usize;
            for k in 0..3 {
                let wavelet = wavelets.on[self.edges[at][k] as usize];
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
            let wavelet = wavelets.on[edge as usize];
            if wavelet != NONE {
                self.add(wavelet, side);
                coarser.push((wavelet, side));
            }
        }
        let halves = |&(wavelet, side): &(u32, Side)| [0, 1].map(|half| (wavelets.half(wavelet, half), side));
        self.coarser = coarser.iter().flat_map(halves).collect();
    }

    /// Replaces the edges of the last level by those of the children: the halves of split edges, then three edges inside
    /// every split face.
    fn next_level(&mut self, wavelets: &LevelWavelets, split_faces: &[u32]) {
        let start = self.last_level().start;
        let inside = 2 * (wavelets.end - wavelets.first);
        let mut edges = Vec::with_capacity(4 * split_faces.len());
        let mut against = Vec::with_capacity(4 * split_faces.len());
        let mut seam = vec![false; inside as usize + 3 * split_faces.len()];
        for (rank, &face) in split_faces.iter().enumerate() {
            let at = (face - start) as usize;
            let whole = self.edges[at];
            let runs = self.against[at];
            let half = |k: usize, half: u32| {
                wavelets.half(wavelets.on[whole[k] as usize], half ^ u32::from(runs[k]))
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

    /// Updates the index of split faces.
    fn index(&mut self) {
        let done = &mut self.done;
        // If exactly the first faces are split, their numbers tell so: no index needed.
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

    /// Returns the subdivision, with a single vertex per wavelet.
    pub fn finish_without_seams(self) -> Subdivision {
        let mut done = self.done;
        done.more.sort_unstable_by_key(|more| (more.0, more.1.0));
        done
    }

    /// Returns the subdivision. `key` tells apart the vertices at the midpoint of a split face's side, as its children
    /// have them: at the first half, at the second half, and at the centre. Children along the same edge with equal keys
    /// share a vertex.
    pub fn finish<K: PartialEq>(self, key: impl Fn(&Subdivision, u32, usize, Part) -> K) -> Subdivision {
        let mut done = self.finish_without_seams();
        // Across a seam faces are split together.
        done.tell_apart(
            |of, along| of.is_split(along.face()),
            |of, _, face, side, part| key(of, face, side, part),
        );
        done
    }

    /// Returns the subdivision, like `finish`, where unsplit faces may be beside seams too: `key` is also called for
    /// their sides, for each wavelet there.
    pub fn finish_beside<K: PartialEq>(
        self,
        key: impl Fn(&Subdivision, u32, u32, usize, Part) -> K,
    ) -> Subdivision {
        let mut done = self.finish_without_seams();
        done.tell_apart(|_, _| true, key);
        done
    }
}

fn check_faces(count: usize) -> Result<(), WaveletError> {
    if count > MOST_FACES {
        Err(WaveletError::TooMany { what: "faces", count, limit: MOST_FACES })
    } else {
        Ok(())
    }
}

/// Wavelets of a level under construction.
struct LevelWavelets {
    first: u32,
    end: u32,
    /// Per edge of the level its wavelet, or `NONE`.
    on: Vec<u32>,
}

impl LevelWavelets {
    /// Returns the wavelet on an edge; adds it if there is none.
    fn add(&mut self, edge: u32) -> u32 {
        let wavelet = &mut self.on[edge as usize];
        if *wavelet == NONE {
            *wavelet = self.end;
            self.end += 1;
        }
        *wavelet
    }

    /// Returns a half of the wavelet's edge, as an edge of the next level.
    fn half(&self, wavelet: u32, half: u32) -> u32 {
        2 * (wavelet - self.first) + half
    }
}
