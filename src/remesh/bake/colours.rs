//! Base colours: from the mesh's own textures, or from its vertex colours.

use crate::mesh::{Mesh, names};
use crate::remesh::{Parameterisation, RemeshError};
use crate::wavelet::{Atlas, WaveletError};

use super::stream::Stream;
use super::texture::byte;
use super::{BakedTexture, Texture};

impl Parameterisation {
    /// Bakes the mesh's own textures into the texture of an atlas: every texel has the value of the texture at the texture
    /// coordinates of its point of the mesh. `textures[m]` belongs to material `m`, `textures[0]` to a mesh without
    /// materials; triangles of other materials leave their texels transparent black, as outside charts.
    ///
    /// `mesh` is the mesh that the map was made from, `atlas` an atlas of the base or of a remesh. The same bytes for any
    /// number of threads. O(texels log n) expected.
    ///
    /// # Errors
    /// The mesh has no texture coordinates, or another number of triangles; the atlas has another number of charts.
    pub fn bake_texture(
        &self,
        mesh: &Mesh,
        atlas: &Atlas,
        textures: &[Texture<'_>],
    ) -> Result<BakedTexture, RemeshError> {
        self.check_baking(mesh, atlas)?;
        let uv = Stream::<2>::of(mesh, names::UV)?;
        Ok(BakedTexture::fill(atlas, [0; 4], |place| {
            let point = self.to_mesh(place)?;
            let material = mesh.materials().get(point.triangle as usize).copied().unwrap_or(0);
            let texture = textures.get(material as usize)?;
            Some(texture.at(uv.at(mesh, &point)?).map(byte))
        }))
    }

    /// Bakes the mesh's vertex colours, 0 to 1, into the texture of an atlas. Colours of three channels are opaque.
    /// Otherwise as [`Parameterisation::bake_texture`].
    ///
    /// # Errors
    /// The mesh has no colours, or another number of triangles; the atlas has another number of charts.
    pub fn bake_colours(&self, mesh: &Mesh, atlas: &Atlas) -> Result<BakedTexture, RemeshError> {
        self.check_baking(mesh, atlas)?;
        let opaque = |[r, g, b]: [f64; 3]| [r, g, b, 1.0];
        let bytes = |colour: [f64; 4]| colour.map(|channel| byte(255.0 * channel));
        match Stream::<4>::of(mesh, names::COLOR) {
            Ok(colours) => Ok(BakedTexture::fill(atlas, [0; 4], |place| {
                colours.at(mesh, &self.to_mesh(place)?).map(bytes)
            })),
            Err(_) => {
                let colours = Stream::<3>::of(mesh, names::COLOR)?;
                Ok(BakedTexture::fill(atlas, [0; 4], |place| {
                    colours.at(mesh, &self.to_mesh(place)?).map(opaque).map(bytes)
                }))
            }
        }
    }

    /// Fails unless the mesh has the triangles of the map, and the atlas its base faces.
    pub(super) fn check_baking(&self, mesh: &Mesh, atlas: &Atlas) -> Result<(), RemeshError> {
        let [triangles, charts] = [self.source_triangles(), self.base().triangles().len()];
        for (what, found, expected) in
            [("triangles", mesh.triangles().len(), triangles), ("charts", atlas.len(), charts)]
        {
            if found != expected {
                return Err(WaveletError::Length { what, found, expected }.into());
            }
        }
        Ok(())
    }
}
