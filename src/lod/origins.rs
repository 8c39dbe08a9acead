//! Where the vertices of a structure come from: how values of any type follow, also years later.

use bytemuck::NoUninit;

use crate::adapt::Blend;
use crate::error::MeshError;
#[cfg(feature = "serde")]
use crate::mesh::MAX_ELEMENTS;
use crate::mesh::{Mesh, Topology, check_folded, folded};
use crate::simplify::CollapseSequence;

/// A vertex that is none of the input's: `(1 - weight) * first + weight * second` of two others.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mixture {
    /// Input vertices, or earlier mixtures numbered from the number of input vertices on.
    pub from: [u32; 2],
    /// Share of the second, 0 to 1.
    pub weight: f32,
}

/// Where every vertex of a structure comes from: a vertex of the input, or a mixture of others.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts"))]
pub struct Origins {
    input_vertices: u32,
    /// Per vertex of the structure an input vertex, or the number of input vertices plus that of a mixture.
    order: Vec<u32>,
    mixtures: Vec<Mixture>,
    /// Input vertices that lie elsewhere than the input has them, ascending.
    snapped: Vec<u32>,
    /// Pairs of input vertices that nothing in the mesh told apart, as `[duplicate, kept]`.
    folded: Vec<[u32; 2]>,
}

impl Origins {
    /// Of the vertices of a structure that was made from a sequence; `order` has their numbers in the sequence.
    pub(crate) fn of_sequence(mesh: &Mesh, sequence: &CollapseSequence, order: Vec<u32>) -> Self {
        let mixtures = sequence.new_vertices().iter();
        Self {
            input_vertices: sequence.input_vertices() as u32,
            order,
            mixtures: mixtures.map(|new| Mixture { from: new.from, weight: new.weight }).collect(),
            snapped: sequence.snaps().iter().map(|snap| snap[0]).collect(),
            folded: sequence.folded(mesh),
        }
    }

    /// Of vertices that are the input's own, one for each wedge.
    pub(crate) fn of_wedges(mesh: &Mesh, topology: &Topology, order: Vec<u32>) -> Self {
        Self::new(mesh.positions().len(), order, Vec::new()).folded_as(mesh, topology)
    }

    /// The same of an input whose duplicates are one.
    pub(crate) fn folded_as(mut self, mesh: &Mesh, topology: &Topology) -> Self {
        let wedges = (0_u32..).zip(topology.wedge_of());
        let duplicates = wedges.filter(|(v, wedge)| v != *wedge).map(|(v, &wedge)| [v, wedge]);
        self.folded = folded(mesh, duplicates);
        self
    }

    /// Of vertices that are the input's own, in that order, and mixtures of those, which follow the input's numbers.
    pub(crate) fn new(input_vertices: usize, order: Vec<u32>, mixtures: Vec<Mixture>) -> Self {
        Self { input_vertices: input_vertices as u32, order, mixtures, ..Self::default() }
    }

    /// Vertices of the structure.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether the structure has no vertices.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Vertices of the input.
    pub fn input_vertices(&self) -> usize {
        self.input_vertices as usize
    }

    /// Per vertex of the structure the input's vertex, or where it is below none, the number of input vertices plus the number
    /// of its mixture.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Vertices that are none of the input's.
    pub fn mixtures(&self) -> &[Mixture] {
        &self.mixtures
    }

    /// Values of the input's vertices in the structure's order. O(n).
    ///
    /// # Errors
    /// As many values as input vertices are needed ([`MeshError::LengthMismatch`]). The structure has vertices that are none of
    /// the input's ([`MeshError::NewVertices`]). Vertices that nothing in the mesh told apart differ ([`MeshError::Folded`]):
    /// a seam would be lost.
    pub fn arrange<V: NoUninit>(&self, values: &[V]) -> Result<Vec<V>, MeshError> {
        let arranged = self.arrange_any(values)?;
        check_folded(values, &self.folded)?;
        Ok(arranged)
    }

    /// The same for values of any type, which cannot be compared: where they differ by more than the mesh told vertices at one
    /// position apart, one stands for all.
    ///
    /// # Errors
    /// Those of [`Origins::arrange`], but the last.
    pub fn arrange_any<V: Clone>(&self, values: &[V]) -> Result<Vec<V>, MeshError> {
        if !self.mixtures.is_empty() {
            return Err(MeshError::NewVertices { count: self.mixtures.len() });
        }
        self.check(values.len())?;
        Ok(self.order.iter().map(|&v| values[v as usize].clone()).collect())
    }

    /// Values in the structure's order, where `blend` makes those that are none of the input's from two others and the share of
    /// the second. O(n).
    ///
    /// # Errors
    /// As many values as input vertices are needed.
    pub fn arrange_with<V: Clone>(
        &self,
        values: &[V],
        mut blend: impl FnMut(&V, &V, f32) -> V,
    ) -> Result<Vec<V>, MeshError> {
        self.check(values.len())?;
        let mut made: Vec<V> = Vec::with_capacity(self.mixtures.len());
        for mixture in &self.mixtures {
            let [a, b] = mixture.from.map(|v| self.value(values, &made, v));
            let new = blend(a, b, mixture.weight);
            made.push(new);
        }
        Ok(self.order.iter().map(|&v| self.value(values, &made, v).clone()).collect())
    }

    /// Values in the structure's order, mixed where they are none of the input's; `place` puts those where the structure has
    /// them that lie elsewhere than the values say: mixed ones, and those that closed a crack. `positions` are the structure's.
    ///
    /// # Errors
    /// As many values as input vertices, and as many positions as vertices of the structure, are needed. Vertices that nothing
    /// in the mesh told apart differ ([`MeshError::Folded`]).
    pub fn arrange_blended<V: NoUninit + Blend>(
        &self,
        values: &[V],
        positions: &[[f32; 3]],
        mut place: impl FnMut(&mut V, [f32; 3]),
    ) -> Result<Vec<V>, MeshError> {
        if positions.len() != self.order.len() {
            let (found, expected) = (positions.len(), self.order.len());
            return Err(MeshError::LengthMismatch { what: "positions".to_owned(), found, expected });
        }
        let mut arranged = self.arrange_with(values, V::blend)?;
        check_folded(values, &self.folded)?;
        for ((value, &origin), &position) in arranged.iter_mut().zip(&self.order).zip(positions) {
            if origin >= self.input_vertices || self.snapped.binary_search(&origin).is_ok() {
                place(value, position);
            }
        }
        Ok(arranged)
    }

    fn value<'a, V>(&self, values: &'a [V], made: &'a [V], v: u32) -> &'a V {
        match v.checked_sub(self.input_vertices) {
            Some(mixture) => &made[mixture as usize],
            None => &values[v as usize],
        }
    }

    fn check(&self, found: usize) -> Result<(), MeshError> {
        let expected = self.input_vertices();
        if found == expected {
            return Ok(());
        }
        Err(MeshError::LengthMismatch { what: "values".to_owned(), found, expected })
    }

    /// Bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.order[..])
            + size_of_val(&self.mixtures[..])
            + size_of_val(&self.snapped[..])
            + size_of_val(&self.folded[..])
    }
}

/// What comes out of a file.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct Parts {
    input_vertices: u32,
    order: Vec<u32>,
    mixtures: Vec<Mixture>,
    snapped: Vec<u32>,
    folded: Vec<[u32; 2]>,
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for Origins {
    type Error = MeshError;

    fn try_from(parts: Parts) -> Result<Self, MeshError> {
        let Parts { input_vertices, order, mixtures, snapped, folded } = parts;
        let within = |index: u32, count: u64, at: usize| {
            if u64::from(index) < count {
                return Ok(());
            }
            Err(MeshError::Origin { vertex: at, found: index })
        };
        if input_vertices as usize > MAX_ELEMENTS {
            let (count, limit) = (input_vertices as usize, MAX_ELEMENTS);
            return Err(MeshError::TooMany { what: "vertices of the input", count, limit });
        }
        let input = u64::from(input_vertices);
        for (k, mixture) in mixtures.iter().enumerate() {
            mixture.from.iter().try_for_each(|&v| within(v, input + k as u64, k))?;
            if !(0.0..=1.0).contains(&mixture.weight) {
                return Err(MeshError::Origin { vertex: k, found: mixture.from[0] });
            }
        }
        let all = input + mixtures.len() as u64;
        order.iter().enumerate().try_for_each(|(at, &v)| within(v, all, at))?;
        snapped.iter().enumerate().try_for_each(|(at, &v)| within(v, input, at))?;
        if let Some(at) = snapped.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(MeshError::Origin { vertex: at, found: snapped[at] });
        }
        folded.iter().flatten().enumerate().try_for_each(|(at, &v)| within(v, input, at))?;
        Ok(Self { input_vertices, order, mixtures, snapped, folded })
    }
}
