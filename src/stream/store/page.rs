//! A page: 512 splits with all that the cut and the mesh need of them.
//!
//! In a file a page is a baked file of its own, with the sections below. Splits, vertices and triangles are numbered within the
//! page; parents, children and dependencies are named by their numbers in the store, triangles by leaves.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::adapt::Refinements;
use crate::geometry::array::{Array, SharedBytes};
use crate::geometry::lists::Lists;
use crate::hierarchy::VertexHierarchy;
use crate::sections::{BakeOptions, OpenOptions, Reader, Writer};
use crate::view::Bounds;

use super::StoreError;
use super::order::Order;

/// Splits of a page; the last page may have fewer.
pub(super) const PAGE: u32 = 1 << 9;

/// Kind of a page, as a baked file.
const KIND: &str = "store-page";

/// Section `page`: which page of which store this is.
#[derive(Debug, Serialize, Deserialize, PartialEq, Eq)]
pub(super) struct Name {
    pub store: u64,
    pub page: u32,
}

/// What a page must keep to: sizes of its store.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub splits: u32,
    pub leaves: u32,
    /// Whether a split has dependencies besides its parents.
    pub has_dependencies: bool,
    /// Groups of triangles.
    pub groups: u32,
    /// Scalars of a vertex.
    pub channels: usize,
}

/// The arrays of a page.
#[derive(Debug, Clone, Default)]
pub(super) struct Page {
    pub bounds: Array<Bounds>,
    /// Per split, how many floats above its error the one is that orders it.
    above: Array<u32>,
    pub parents: Lists,
    pub children: Lists,
    pub dependencies: Lists,
    /// Per split, its first vertex; with one more entry than splits. Vertices are in the order in which they come.
    first_vertex: Array<u32>,
    /// Per vertex, its first leaf.
    pub first_leaf: Array<u32>,
    /// Bits of the vertices' scalars, scalar by scalar.
    scalars: Array<u32>,
    /// Per split, its first triangle; with one more entry than splits.
    first_triangle: Array<u32>,
    /// Leaves of the triangles.
    pub triangles: Array<[u32; 3]>,
    /// Per triangle, its group; empty if there is one group.
    group_of: Array<u16>,
}

impl Page {
    /// Gathers a page of a hierarchy. `words` has the scalars of a vertex.
    pub fn gather(of: &VertexHierarchy, order: &Order, page: u32, channels: usize, words: &[u32]) -> Self {
        let start = (page * PAGE) as usize;
        let splits = &order.splits[start..order.splits.len().min(start + PAGE as usize)];
        let (mut parents, mut children) = (Vec::new(), Vec::new());
        let (mut dependencies, mut above) = (Vec::new(), Vec::new());
        let (mut bounds, mut vertices, mut triangles, mut group_of) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut first_vertex, mut first_triangle) = (vec![0], vec![0]);
        let place = |other: u32| order.place[other as usize];
        for (&split, at) in splits.iter().zip(0..) {
            bounds.push(of.bounds(split));
            above.push(order.above[split as usize]);
            let list = |list: &mut Vec<(u32, u32)>, others: &mut dyn Iterator<Item = u32>| {
                let first = list.len();
                list.extend(others.map(|other| (at, place(other))));
                list[first..].sort_unstable();
            };
            list(&mut parents, &mut of.parents(split));
            list(&mut children, &mut of.children(split));
            list(&mut dependencies, &mut of.dependencies(split));
            vertices.extend(of.brings(split).iter().rev().copied());
            first_vertex.push(vertices.len() as u32);
            for triangle in of.owned(split) {
                triangles.push(of.triangles()[triangle as usize]);
                group_of.push(of.group_of(triangle) as u16);
            }
            first_triangle.push(triangles.len() as u32);
        }
        let lists = |pairs: Vec<(u32, u32)>| match pairs.is_empty() {
            true => Lists::default(),
            false => Lists::from_pairs(splits.len(), pairs.into_iter()),
        };
        let scalar = |channel: usize| vertices.iter().map(move |&v| words[v as usize * channels + channel]);
        if of.materials().len() < 2 {
            group_of.clear();
        }
        Self {
            bounds: bounds.into(),
            above: above.into(),
            parents: lists(parents),
            children: lists(children),
            dependencies: lists(dependencies),
            first_vertex: first_vertex.into(),
            first_leaf: vertices.iter().map(|&vertex| of.first_leaf(vertex)).collect(),
            scalars: (0..channels).flat_map(scalar).collect(),
            first_triangle: first_triangle.into(),
            triangles: triangles.into(),
            group_of: group_of.into(),
        }
    }

    /// Writes the page as bytes.
    pub fn write(&self, name: &Name, options: BakeOptions) -> Result<Vec<u8>, StoreError> {
        let mut to = Writer::new(options);
        to.meta("page", name)?;
        to.array("bounds", &self.bounds);
        to.array("above", &self.above);
        let lists = [
            ("parents.at", "parents", &self.parents),
            ("children.at", "children", &self.children),
            ("dependencies.at", "dependencies", &self.dependencies),
        ];
        for (at, items, lists) in lists {
            to.array_if_any(at, &lists.start);
            to.array_if_any(items, &lists.items);
        }
        to.array("first_vertex", &self.first_vertex);
        to.array("first_leaf", &self.first_leaf);
        to.array("scalars", &self.scalars);
        to.array("first_triangle", &self.first_triangle);
        to.array("triangles", &self.triangles);
        to.array_if_any("group_of", &self.group_of);
        Ok(to.finish(KIND)?)
    }

    /// Reads a page, in place where its bytes are aligned, and checks it. O(bytes).
    pub fn read(bytes: &SharedBytes, name: &Name, frame: Frame) -> Result<Self, StoreError> {
        let from = Reader::shared(bytes, OpenOptions::default())?;
        if from.meta::<Name>("page")? != *name {
            return Err(StoreError::OtherPage { page: name.page });
        }
        let lists = |at: &str, items: &str| -> Result<Lists, StoreError> {
            Ok(Lists { start: from.array_if_any(at)?, items: from.array_if_any(items)? })
        };
        let page = Self {
            bounds: from.array("bounds")?,
            above: from.array("above")?,
            parents: lists("parents.at", "parents")?,
            children: lists("children.at", "children")?,
            dependencies: lists("dependencies.at", "dependencies")?,
            first_vertex: from.array("first_vertex")?,
            first_leaf: from.array("first_leaf")?,
            scalars: from.array("scalars")?,
            first_triangle: from.array("first_triangle")?,
            triangles: from.array("triangles")?,
            group_of: from.array_if_any("group_of")?,
        };
        match page.find_fault(name.page, frame) {
            Some(what) => Err(StoreError::Damaged { what }),
            None => Ok(page),
        }
    }

    /// Returns what is wrong with the arrays.
    fn find_fault(&self, page: u32, frame: Frame) -> Option<&'static str> {
        let first = page * PAGE;
        let splits = PAGE.min(frame.splits - first) as usize;
        let are_starts = |start: &[u32], end: usize| {
            start.len() == splits + 1 && start[0] == 0 && start[splits] as usize == end && start.is_sorted()
        };
        let are_lists = |lists: &Lists| {
            let is_empty = lists.start.is_empty() && lists.items.is_empty();
            is_empty || are_starts(&lists.start, lists.items.len())
        };
        let are_splits = |lists: &Lists| lists.items.iter().all(|&split| split < frame.splits);
        let lists = [&self.parents, &self.children, &self.dependencies];
        let are_finite = |bounds: &Bounds| {
            let numbers = [bounds.radius, bounds.error, bounds.parametric];
            bounds.centre.iter().all(|x| x.is_finite()) && numbers.iter().all(|x| *x >= 0.0)
        };
        match () {
            () if self.bounds.len() != splits || self.above.len() != splits => {
                Some("a page has another number of splits")
            }
            () if !self.bounds.iter().all(are_finite) => Some("bounds are not finite"),
            () if !lists.into_iter().all(are_lists) => Some("lists of splits do not fit together"),
            () if !frame.has_dependencies && !self.dependencies.items.is_empty() => {
                Some("a split has dependencies in a store without")
            }
            () if lists.iter().any(|lists| !are_splits(lists)) => Some("a split is by none there is"),
            () if !are_starts(&self.first_vertex, self.first_leaf.len())
                || self.first_vertex.windows(2).any(|ends| ends[0] == ends[1]) =>
            {
                Some("a split brings no vertex")
            }
            () if self.first_leaf.iter().any(|&leaf| leaf >= frame.leaves) => Some("a vertex is of no leaf"),
            () if self.scalars.len() != frame.channels * self.first_leaf.len() => {
                Some("vertices have another number of scalars")
            }
            () if !are_starts(&self.first_triangle, self.triangles.len()) => {
                Some("triangles of splits do not fit together")
            }
            () if self.triangles.as_flattened().iter().any(|&leaf| leaf >= frame.leaves) => {
                Some("a triangle is of no leaf")
            }
            () if self.group_of.len() != if frame.groups > 1 { self.triangles.len() } else { 0 }
                || self.group_of.iter().any(|&group| u32::from(group) >= frame.groups) =>
            {
                Some("a triangle is of no group")
            }
            () => None,
        }
    }

    /// Returns the error that orders a split: above its own, and larger than that of every child.
    #[inline]
    pub fn order(&self, split: u32) -> f32 {
        let error = self.bounds[split as usize].error;
        f32::from_bits(error.to_bits().saturating_add(self.above[split as usize]))
    }

    /// Returns the vertices of a split, in the order in which they come.
    #[inline]
    pub fn brings(&self, split: u32) -> Range<u32> {
        self.first_vertex[split as usize]..self.first_vertex[split as usize + 1]
    }

    /// Returns the triangles of a split.
    #[inline]
    pub fn owned(&self, split: u32) -> Range<u32> {
        self.first_triangle[split as usize]..self.first_triangle[split as usize + 1]
    }

    /// Returns the group of a triangle.
    #[inline]
    pub fn group_of(&self, triangle: u32) -> usize {
        self.group_of.get(triangle as usize).map_or(0, |&group| group.into())
    }

    /// Appends the bits of a vertex's scalars.
    pub fn words(&self, vertex: u32, words: &mut Vec<u32>) {
        words.extend(self.scalars.iter().skip(vertex as usize).step_by(self.first_leaf.len()));
    }

    /// Returns bounds around those of all splits.
    pub fn union(&self) -> Bounds {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for bounds in &self.bounds {
            for axis in 0..3 {
                let (centre, radius) = (f64::from(bounds.centre[axis]), f64::from(bounds.radius));
                low[axis] = low[axis].min(centre - radius);
                high[axis] = high[axis].max(centre + radius);
            }
        }
        let largest = |of: &dyn Fn(&Bounds) -> f32| self.bounds.iter().map(of).fold(0.0, f32::max);
        let (error, parametric) = (largest(&|bounds| bounds.error), largest(&|bounds| bounds.parametric));
        let centre: [f32; 3] = std::array::from_fn(|axis| (0.5 * (low[axis] + high[axis])) as f32);
        let reach = |bounds: &Bounds| {
            let squares =
                (0..3).map(|axis| (f64::from(bounds.centre[axis]) - f64::from(centre[axis])).powi(2));
            squares.sum::<f64>().sqrt() + f64::from(bounds.radius)
        };
        let radius = self.bounds.iter().map(reach).fold(0.0, f64::max) as f32;
        let union = match centre.iter().all(|x| x.is_finite()) && radius.is_finite() {
            true => Bounds::new(centre, radius.next_up().next_up(), error, parametric),
            false => Bounds::new([0.0; 3], f32::MAX, error, parametric),
        };
        match self.cone() {
            Some((axis, half_angle)) => union.with_cone(axis.to_array(), half_angle),
            None => union,
        }
    }

    /// Returns a cone of the normals of all splits; `None` for all directions.
    fn cone(&self) -> Option<(DVec3, f64)> {
        let cones: Option<Vec<([f64; 3], f64)>> = self.bounds.iter().map(Bounds::cone).collect();
        let cones = cones?;
        let axis = cones.iter().map(|(axis, _)| DVec3::from_array(*axis)).sum::<DVec3>().try_normalize()?;
        let reach = |(other, half_angle): &([f64; 3], f64)| {
            axis.angle_between(DVec3::from_array(*other)) + half_angle
        };
        // Rounding is far less than this.
        Some((axis, cones.iter().map(reach).fold(0.0, f64::max) + 1e-6))
    }

    /// Returns the numbers of vertices and triangles, and the bytes of the arrays.
    pub fn sizes(&self) -> [u32; 3] {
        let lists = self.parents.memory() + self.children.memory() + self.dependencies.memory();
        let bytes = lists
            + size_of_val(&self.bounds[..])
            + size_of_val(&self.above[..])
            + size_of_val(&self.first_vertex[..])
            + size_of_val(&self.first_leaf[..])
            + size_of_val(&self.scalars[..])
            + size_of_val(&self.first_triangle[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.group_of[..]);
        [self.first_leaf.len() as u32, self.triangles.len() as u32, bytes as u32]
    }
}

/// Shares bytes that are owned.
pub(super) fn share(bytes: Vec<u8>) -> SharedBytes {
    Arc::new(bytes)
}

#[cfg(test)]
impl Page {
    /// Changes some numbers to others that mostly are in range.
    pub fn forge(&mut self, mut random: impl FnMut(u32) -> u32) {
        let near = |number: &mut u32, random: &mut dyn FnMut(u32) -> u32| match random(3) {
            0 => *number = number.wrapping_add(1),
            1 => *number = number.saturating_sub(1),
            _ => *number = random(number.saturating_mul(2).saturating_add(2)),
        };
        for _ in 0..1 + random(8) {
            let which = random(10);
            let at = random(1 << 20) as usize;
            let numbers = match which {
                0 => &mut self.parents.items,
                1 => &mut self.children.items,
                2 => &mut self.dependencies.items,
                3 => &mut self.first_vertex,
                4 | 5 => &mut self.first_leaf,
                6 => &mut self.first_triangle,
                7 => &mut self.scalars,
                8 => {
                    self.triangles.edit(|triangles| {
                        let count = triangles.len().max(1);
                        if let Some(triangle) = triangles.get_mut(at % count) {
                            near(&mut triangle[at % 3], &mut random);
                        }
                    });
                    continue;
                }
                _ => {
                    self.bounds.edit(|bounds| {
                        let count = bounds.len();
                        bounds[at % count].radius *= random(4) as f32;
                        bounds[at % count].error *= random(4) as f32;
                    });
                    continue;
                }
            };
            numbers.edit(|numbers| {
                let count = numbers.len().max(1);
                if let Some(number) = numbers.get_mut(at % count) {
                    near(number, &mut random);
                }
            });
        }
    }
}
