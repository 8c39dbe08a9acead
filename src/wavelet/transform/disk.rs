//! Weights making lazy wavelets nearly orthogonal to coarser functions: lifting by Galerkin's condition on a disk.
//!
//! ```text
//! for every level, for the midpoint e of every edge
//!     disk        the ends of the edge, and k rings of neighbours on the coarser level
//!     G s = b     G: products of the disk's hats, b: theirs with the hat at e
//!     psi_e = phi_e - sum over the disk of s_k phi_k
//! ```
//!
//! So psi_e is orthogonal to every coarse hat of its disk (Lounsbery et al. 1997; Southern, appendix A, equations A.2 and A.3,
//! with the system restricted to the disk before it is solved, not after). Edges with exactly equal systems share a solution.
//! Nodes of a disk are ordered by connectivity, so equal surroundings give equal systems.

use crate::mesh::NONE;

use super::super::{Subdivision, WaveletError};
use super::domain::Domain;
use super::products::Products;

/// Most hats in a disk. If k rings have more, the disk takes as many whole rings as fit.
pub(super) const MOST: usize = 256;
/// Flag in a position: the node waits to be added to the disk.
const WAITING: u32 = 1 << 31;

/// Weights of the coarse hats lifting each wavelet.
#[derive(Debug, Clone, Default)]
pub(super) struct Lifting {
    /// Per node above the base, the start of its disk; and the end of the last.
    offsets: Vec<usize>,
    nodes: Vec<u32>,
    /// Per node above the base, the start of its weights.
    pattern: Vec<usize>,
    weights: Vec<f64>,
    /// Per node above the base, the amount by which lifting reduces the product of its hat with itself, in 48ths of the area of
    /// a coarse face.
    pub gain: Vec<f64>,
    /// Number of different systems solved.
    pub patterns: usize,
}

impl Lifting {
    /// Computes the weights for disks of `rings` rings.
    pub fn new(of: &Subdivision, domain: &Domain, rings: u8) -> Result<Self, WaveletError> {
        let mut lifting = Self { offsets: vec![0], ..Self::default() };
        let mut disk = Disk { position: vec![NONE; domain.len()], ..Disk::default() };
        let mut system = System::default();
        let mut cache = Cache::default();
        for level in 1..=domain.depth() {
            let products = Products::new(domain, level - 1, &domain.split_faces(of, level - 1)?);
            for node in domain.nodes_of(level) {
                disk.find(&products, domain.ends(node), rings);
                system.assemble(&products, &disk, node);
                let (start, gain) = cache.solution(&system).unwrap_or_else(|hash| {
                    let gain = system.solve();
                    let start = lifting.weights.len();
                    lifting.weights.extend(&system.solution);
                    cache.insert(hash, &system, start, gain);
                    (start, gain)
                });
                lifting.nodes.extend(&disk.nodes);
                lifting.offsets.push(lifting.nodes.len());
                lifting.pattern.push(start);
                lifting.gain.push(gain);
                disk.clear();
            }
        }
        lifting.patterns = cache.entries.len();
        Ok(lifting)
    }

    /// Returns a node's disk and the weights of its hats; `at` counts nodes from the first above the base.
    #[inline]
    pub fn disk(&self, at: usize) -> (&[u32], &[f64]) {
        let nodes = &self.nodes[self.offsets[at]..self.offsets[at + 1]];
        (nodes, &self.weights[self.pattern[at]..][..nodes.len()])
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.offsets[..])
            + size_of_val(&self.nodes[..])
            + size_of_val(&self.pattern[..])
            + size_of_val(&self.weights[..])
            + size_of_val(&self.gain[..])
    }
}

/// The coarse nodes around an edge.
#[derive(Debug, Default)]
struct Disk {
    nodes: Vec<u32>,
    /// Per node its index in `nodes`; or `WAITING` plus its index in `waiting`; or `NONE`.
    position: Vec<u32>,
    /// Nodes about to be added, each after the lowest index in `nodes` of a neighbour.
    waiting: Vec<(u32, u32)>,
}

impl Disk {
    fn find(&mut self, products: &Products, ends: [usize; 2], rings: u8) {
        for end in ends {
            if self.position[end] == NONE {
                self.put(end as u32);
            }
        }
        let mut start = 0;
        for _ in 0..rings {
            let end = self.nodes.len();
            for at in start..end {
                if !self.grow(products, at) {
                    for node in self.nodes.drain(end..) {
                        self.position[node as usize] = NONE;
                    }
                    return;
                }
            }
            start = end;
        }
    }

    fn put(&mut self, node: u32) {
        self.position[node as usize] = self.nodes.len() as u32;
        self.nodes.push(node);
    }

    fn clear(&mut self) {
        for node in self.nodes.drain(..) {
            self.position[node as usize] = NONE;
        }
    }

    /// Adds the neighbours of a node, next to the earliest other nodes first. Returns `false` if there are too many.
    fn grow(&mut self, products: &Products, at: usize) -> bool {
        let row = products.row(self.nodes[at]);
        if row.len() >= MOST {
            return false;
        }
        let new = row.iter().filter(|item| self.position[item.0 as usize] == NONE).count();
        if self.nodes.len() + new > MOST {
            return false;
        }
        self.waiting.clear();
        for &(node, _) in row {
            if self.position[node as usize] == NONE {
                self.position[node as usize] = WAITING | self.waiting.len() as u32;
                self.waiting.push((WAITING, node));
            }
        }
        for i in 0..new {
            let earlier = short_row(products, self.waiting[i].1).iter();
            let places = earlier.map(|item| self.position[item.0 as usize]);
            let first = places.filter(|&place| place < WAITING && place != at as u32).min();
            self.waiting[i].0 = first.unwrap_or(WAITING);
        }
        for _ in 0..new {
            let next = (0..new).min_by_key(|&i| self.waiting[i]).unwrap_or(0);
            let node = std::mem::replace(&mut self.waiting[next], (NONE, NONE)).1;
            let place = self.nodes.len() as u32;
            self.put(node);
            for &(neighbour, _) in short_row(products, node) {
                let found = self.position[neighbour as usize];
                if found != NONE && found >= WAITING {
                    let first = &mut self.waiting[(found & !WAITING) as usize].0;
                    *first = (*first).min(place);
                }
            }
        }
        true
    }
}

/// Returns a row; empty for rows longer than `MOST`, since reading them for every disk around would take quadratic time.
fn short_row(products: &Products, node: u32) -> &[(u32, u32)] {
    let row = products.row(node);
    if row.len() > MOST { &[] } else { row }
}

/// The system G s = b of a disk, in whole numbers, and its solution.
#[derive(Debug, Default)]
struct System {
    /// Per row: the diagonal, b, the number of other entries left of the diagonal, and these entries as column and value.
    words: Vec<u32>,
    size: usize,
    right: Vec<u32>,
    row: Vec<(u32, u32)>,
    /// The lower triangle, row by row.
    matrix: Vec<f64>,
    solution: Vec<f64>,
}

impl System {
    fn assemble(&mut self, products: &Products, disk: &Disk, midpoint: usize) {
        self.size = disk.nodes.len();
        self.right.clear();
        self.right.resize(self.size, 0);
        for (node, product) in products.of_midpoint(midpoint) {
            let place = disk.position[node as usize];
            if place != NONE {
                self.right[place as usize] += product;
            }
        }
        self.words.clear();
        for (place, &node) in disk.nodes.iter().enumerate() {
            let row = products.row(node);
            self.row.clear();
            if row.len() <= MOST {
                let entries = row.iter().map(|&(other, product)| (disk.position[other as usize], product));
                self.row.extend(entries.filter(|entry| (entry.0 as usize) < place));
                self.row.sort_unstable();
            } else {
                for (column, other) in disk.nodes[..place].iter().enumerate() {
                    if let Ok(at) = row.binary_search_by_key(other, |entry| entry.0) {
                        self.row.push((column as u32, row[at].1));
                    }
                }
            }
            self.words.extend([products.diagonal[node as usize], self.right[place], self.row.len() as u32]);
            self.words.extend(self.row.iter().flat_map(|entry| [entry.0, entry.1]));
        }
    }

    /// Solves the system by Cholesky's decomposition; returns s . b in 48ths of the area. Hats are independent and their
    /// products well conditioned (Wathen 1987), so every pivot is at least half of its diagonal entry.
    fn solve(&mut self) -> f64 {
        let n = self.size;
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        let mut at = 0;
        for row in 0..n {
            self.matrix[row * n + row] = f64::from(self.words[at]);
            let entries = self.words[at + 2] as usize;
            for entry in self.words[at + 3..][..2 * entries].chunks_exact(2) {
                self.matrix[row * n + entry[0] as usize] = f64::from(entry[1]);
            }
            at += 3 + 2 * entries;
        }
        let (matrix, solution) = (&mut self.matrix, &mut self.solution);
        for i in 0..n {
            let (above, row) = matrix.split_at_mut(i * n);
            for j in 0..i {
                let other = &above[j * n..][..=j];
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            row[i] = (row[i] - dot(&row[..i], &row[..i])).sqrt();
        }
        // Products with midpoints are in 48ths, products of coarse hats in twelfths.
        solution.clear();
        solution.extend(self.right.iter().map(|&b| 0.25 * f64::from(b)));
        for i in 0..n {
            let row = &matrix[i * n..][..=i];
            solution[i] = (solution[i] - dot(&row[..i], &solution[..i])) / row[i];
        }
        for i in (0..n).rev() {
            solution[i] /= matrix[i * n + i];
            for j in 0..i {
                solution[j] -= matrix[i * n + j] * solution[i];
            }
        }
        solution.iter().zip(&self.right).map(|(s, &b)| s * f64::from(b)).sum()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Hash table of systems and their solutions, with open addressing.
#[derive(Debug, Default)]
struct Cache {
    table: Vec<u32>,
    entries: Vec<Entry>,
    words: Vec<u32>,
}

#[derive(Debug)]
struct Entry {
    hash: u64,
    words: std::ops::Range<usize>,
    start: usize,
    gain: f64,
}

impl Cache {
    /// Returns the start of the weights of an equal system, and the gain; or the hash for inserting the system.
    fn solution(&self, system: &System) -> Result<(usize, f64), u64> {
        let hash = hash(&system.words);
        let mask = self.table.len().wrapping_sub(1);
        let mut slot = hash as usize & mask;
        while let Some(entry) = self.table.get(slot).and_then(|&at| self.entries.get(at as usize)) {
            if entry.hash == hash && self.words[entry.words.clone()] == system.words[..] {
                return Ok((entry.start, entry.gain));
            }
            slot = (slot + 1) & mask;
        }
        Err(hash)
    }

    fn insert(&mut self, hash: u64, system: &System, start: usize, gain: f64) {
        let first = self.words.len();
        self.words.extend(&system.words);
        self.entries.push(Entry { hash, words: first..self.words.len(), start, gain });
        if 2 * self.entries.len() > self.table.len() {
            let size = (4 * self.entries.len()).next_power_of_two();
            self.table.clear();
            self.table.resize(size, NONE);
            (0..self.entries.len()).for_each(|entry| self.link(entry));
        } else {
            self.link(self.entries.len() - 1);
        }
    }

    fn link(&mut self, entry: usize) {
        let mask = self.table.len() - 1;
        let mut slot = self.entries[entry].hash as usize & mask;
        while self.table[slot] != NONE {
            slot = (slot + 1) & mask;
        }
        self.table[slot] = entry as u32;
    }
}

fn hash(words: &[u32]) -> u64 {
    let mixed = words.iter().fold(words.len() as u64, |hash, &word| {
        (hash.rotate_left(5) ^ u64::from(word)).wrapping_mul(0x517c_c1b7_2722_0a95)
    });
    mixed ^ mixed >> 32
}
