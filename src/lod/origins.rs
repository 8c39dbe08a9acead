//! Origins of a structure's vertices: values of any type follow, even years later.

use bytemuck::NoUninit;

use crate::adapt::Blend;
use crate::error::MeshError;
use crate::geometry::array::Array;

#[cfg(feature = "serde")]
use crate::mesh::MAX_ELEMENTS;
use crate::mesh::{Mesh, Topology, check_folded, folded};
use crate::sequence::CollapseSequence;

/// A vertex not in the input: `(1 - weight) * first + weight * second` of two other vertices.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Mixture {
    /// Input vertices or earlier mixtures. Mixtures are numbered from the number of input vertices on.
    pub from: [u32; 2],
    /// Share of the second vertex, 0 to 1.
    pub weight: f32,
}

/// Origin of every vertex of a structure: an input vertex, or a mixture of other vertices.
///
/// ```
/// use multires::{Structure, mesh::shapes, tom::TotallyOrderedMesh};
///
/// let mesh = shapes::icosphere(2);
/// let model = TotallyOrderedMesh::bake(&mesh)?;
/// let names: Vec<String> = (0..mesh.positions().len()).map(|v| format!("vertex {v}")).collect();
/// let ordered = model.origins().arrange_any(&names)?; // values of any type
/// assert_eq!(ordered[0], names[model.origins().order()[0] as usize]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts"))]
pub struct Origins {
    pub(super) input_vertices: u32,
    /// Per vertex of the structure an input vertex, or the number of input vertices plus a mixture's index.
    pub(super) order: Array<u32>,
    pub(super) mixtures: Array<Mixture>,
    /// Input vertices whose place in the structure differs from the input's, ascending.
    pub(super) snapped: Array<u32>,
    /// Pairs of input vertices not told apart by the mesh, as `[duplicate, kept]`.
    pub(super) folded: Array<[u32; 2]>,
}

impl Origins {
    /// Makes the origins of a structure made from a sequence. `order` holds the vertices' numbers in the sequence.
    pub(crate) fn of_sequence(mesh: &Mesh, sequence: &CollapseSequence, order: Vec<u32>) -> Self {
        let mixtures = sequence.new_vertices().iter();
        Self {
            input_vertices: sequence.input_vertices() as u32,
            order: order.into(),
            mixtures: mixtures.map(|new| Mixture { from: new.from, weight: new.weight }).collect(),
            snapped: sequence.snaps().iter().map(|snap| snap[0]).collect(),
            folded: sequence.folded(mesh).into(),
        }
    }

    /// Makes the origins of vertices all in the input, a vertex per wedge.
    pub(crate) fn of_wedges(mesh: &Mesh, topology: &Topology, order: Vec<u32>) -> Self {
        Self::new(mesh.positions().len(), order, Vec::new()).folded_as(mesh, topology)
    }

    /// Adds the duplicates of the input: vertices of equal wedge.
    pub(crate) fn folded_as(mut self, mesh: &Mesh, topology: &Topology) -> Self {
        let wedges = (0_u32..).zip(topology.wedge_of());
        let duplicates = wedges.filter(|(v, wedge)| v != *wedge).map(|(v, &wedge)| [v, wedge]);
        self.folded = folded(mesh, duplicates).into();
        self
    }

    /// Makes origins from vertices in order and mixtures. Mixtures are numbered after the input's vertices.
    pub(crate) fn new(input_vertices: usize, order: Vec<u32>, mixtures: Vec<Mixture>) -> Self {
        let (order, mixtures) = (order.into(), mixtures.into());
        Self { input_vertices: input_vertices as u32, order, mixtures, ..Self::default() }
    }

    /// Returns the number of vertices of the structure.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Holds if the structure has no vertices.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// Returns the number of vertices of the input.
    pub fn input_vertices(&self) -> usize {
        self.input_vertices as usize
    }

    /// Returns the origin of each vertex of the structure: `v` below [`Origins::input_vertices`] is an input vertex, any other
    /// is mixture `v - input_vertices`.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the vertices not in the input, as mixtures.
    pub fn mixtures(&self) -> &[Mixture] {
        &self.mixtures
    }

    /// Puts values of the input's vertices into the structure's order. O(n).
    ///
    /// # Errors
    /// - The number of values is not the number of input vertices ([`MeshError::LengthMismatch`]).
    /// - The structure has vertices not in the input ([`MeshError::NewVertices`]).
    /// - Values differ at vertices not told apart by the mesh ([`MeshError::Folded`]): a seam would be lost.
    pub fn arrange<V: NoUninit>(&self, values: &[V]) -> Result<Vec<V>, MeshError> {
        let arranged = self.arrange_any(values)?;
        check_folded(values, &self.folded)?;
        Ok(arranged)
    }

    /// Puts values of any type into the structure's order, without comparing them. Where values differ at vertices not told
    /// apart by the mesh, a single value stands for all. O(n).
    ///
    /// # Errors
    /// As [`Origins::arrange`], except [`MeshError::Folded`].
    pub fn arrange_any<V: Clone>(&self, values: &[V]) -> Result<Vec<V>, MeshError> {
        if !self.mixtures.is_empty() {
            return Err(MeshError::NewVertices { count: self.mixtures.len() });
        }
        self.check(values.len())?;
        Ok(self.order.iter().map(|&v| values[v as usize].clone()).collect())
    }

    /// Puts values into the structure's order. `blend(first, second, share of second)` makes the values of vertices not in the
    /// input. O(n).
    ///
    /// # Errors
    /// The number of values is not the number of input vertices.
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

    /// Puts values into the structure's order, blended at vertices not in the input. Calls `place` with the structure's
    /// position, from `positions`, for every vertex that lies elsewhere than its value says: mixtures, and vertices moved to
    /// close a crack.
    ///
    /// # Errors
    /// The number of values is not the number of input vertices, or the number of positions not the number of the structure's
    /// vertices. Values differ at vertices not told apart by the mesh ([`MeshError::Folded`]).
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

    /// Returns the bytes of its arrays.
    pub fn memory(&self) -> usize {
        size_of_val(&self.order[..])
            + size_of_val(&self.mixtures[..])
            + size_of_val(&self.snapped[..])
            + size_of_val(&self.folded[..])
    }
}

/// The fields of a file.
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
        let (order, mixtures) = (order.into(), mixtures.into());
        let origins =
            Self { input_vertices, order, mixtures, snapped: snapped.into(), folded: folded.into() };
        origins.validate()?;
        Ok(origins)
    }
}

#[cfg(feature = "serde")]
impl Origins {
    /// Checks that everything named exists. O(n).
    pub(super) fn validate(&self) -> Result<(), MeshError> {
        let Self { input_vertices, order, mixtures, snapped, folded } = self;
        let within = |index: u32, count: u64, at: usize| {
            if u64::from(index) < count {
                return Ok(());
            }
            Err(MeshError::Origin { vertex: at, found: index })
        };
        if *input_vertices as usize > MAX_ELEMENTS {
            let (count, limit) = (*input_vertices as usize, MAX_ELEMENTS);
            return Err(MeshError::TooMany { what: "vertices of the input", count, limit });
        }
        let input = u64::from(*input_vertices);
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
        folded.iter().flatten().enumerate().try_for_each(|(at, &v)| within(v, input, at))
    }
}
