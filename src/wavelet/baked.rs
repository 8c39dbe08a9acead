//! Wavelet meshes under the interface common to all structures: baking, instances, levels of the whole mesh.

use crate::adapt::Refinements;
use crate::lod::{
    Baked, Extracted, Level, LodError, LodOptions, Origins, Progress, Structure, Triangulation, Values,
    Vertex, VertexRank,
};
use crate::mesh::{Mesh, Topology};

use super::{Normals, WaveletError, WaveletLod, WaveletMesh, WaveletOptions};

impl Structure for WaveletMesh {
    const KIND: &'static str = "wavelet";
    const TRIANGULATIONS: bool = true;

    type Options = WaveletOptions;
    type Error = WaveletError;
    type Table = ();
    type Instance<V: Vertex> = WaveletLod<V>;

    /// Simplifies nothing: finds the coarsest mesh of which `mesh` is a four-to-one subdivision
    /// ([`WaveletMesh::recognise`]).
    fn build_baked(
        mesh: &Mesh,
        options: &WaveletOptions,
        progress: Progress<'_>,
    ) -> Result<Baked<Self>, WaveletError> {
        let (found, order) = Self::recognise_with(mesh, options, progress)?;
        Ok(Baked::new(found, None, Origins::of_wedges(mesh, &Topology::new(mesh), order)))
    }

    fn table(_: &Baked<Self>) -> Result<(), LodError> {
        Ok(())
    }

    fn instance<V: Vertex>(
        model: &Baked<Self>,
        values: Values<V>,
        options: &LodOptions,
    ) -> Result<WaveletLod<V>, LodError> {
        WaveletLod::new(model.structure().clone(), values, options)
    }

    /// Selects the wavelets with bounds above an error, or as many of the largest bounds as fit; exact triangulation.
    fn level(model: &Baked<Self>, level: Level) -> Extracted {
        let mesh = &**model.structure();
        let exact = Triangulation::Exact;
        let set = match level {
            // NaN: no wavelet is known to err by at most NaN, so all are used.
            Level::Error(error) if error.is_nan() => mesh.closure(|_| true),
            Level::Error(error) => mesh.closure(|wavelet| mesh.bounds(wavelet).largest_error() > error),
            Level::Triangles(most) => mesh.largest_within(most, exact),
            Level::Vertices(most) => mesh.largest_within_vertices(most, exact),
            Level::Ratio(ratio) => {
                // The cast turns NaN and negative numbers into 0.
                let most = f64::from(ratio) * mesh.subdivision().triangle_count() as f64;
                mesh.largest_within(most as usize, exact)
            }
        };
        let holds = |wavelet: u32| set[wavelet as usize];
        Extracted::new(mesh.extract(holds, exact, Normals::Kept), mesh.largest_left_out(holds))
    }

    fn vertex_count(&self) -> usize {
        self.subdivision().vertex_count()
    }

    fn finest_vertex_count(&self) -> usize {
        self.subdivision().vertex_count()
    }

    fn triangle_count(&self) -> usize {
        self.subdivision().triangle_count()
    }

    fn base_triangle_count(&self) -> usize {
        self.subdivision().base_face_count()
    }

    fn materials(&self) -> &[u32] {
        self.materials()
    }

    fn extent(&self, _: &Mesh) -> Option<[[f32; 3]; 2]> {
        self.extent()
    }

    fn vertex_ranks(&self) -> Vec<VertexRank> {
        let of = self.subdivision();
        let rank = |vertex: u32| match of.wavelet_of(vertex) {
            None => VertexRank::COARSEST,
            Some(wavelet) => {
                let share = of.level_of(wavelet) as f32 / of.depth() as f32;
                VertexRank::new(share, self.bounds(wavelet).largest_error())
            }
        };
        (0..of.vertex_count() as u32).map(rank).collect()
    }

    fn own_vertices(&self) -> Option<&Mesh> {
        Some(self.vertices())
    }

    fn check_vertices(&self, vertices: &Mesh) -> Result<(), WaveletError> {
        match vertices.positions().len() {
            0 => Ok(()),
            found => Err(WaveletError::Length { what: "vertices beside the mesh's", found, expected: 0 }),
        }
    }

    fn structure_memory(&self) -> usize {
        self.structure_memory()
    }
}

impl From<WaveletMesh> for Baked<WaveletMesh> {
    /// Creates a model whose input is the mesh's own vertices.
    fn from(mesh: WaveletMesh) -> Self {
        let count = mesh.subdivision().vertex_count();
        Self::new(mesh, None, Origins::new(count, (0..count as u32).collect(), Vec::new()))
    }
}
