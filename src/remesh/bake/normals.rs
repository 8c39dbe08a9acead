//! Normal maps: the normals of the mesh, as a texture of a coarser one.
//!
//! ```text
//!          N   n                 n = x T + y B + z N, scaled to unit length, where T, B and N are those of the level's
//!          |  /     B            vertices, interpolated and not scaled (MikkTSpace)
//!          | /   /
//!     _____|/_/_______           T  along growing u of the atlas
//!           \     level          B  along falling v: up in the picture, as glTF has it; B = w (N x T)
//!            T                   w = -1: charts turn the way of their faces, and v runs down
//! ```

use glam::{DMat3, DVec3};

use crate::mesh::{Attribute, Mesh, MeshPoint, names};
use crate::remesh::{Depth, Parameterisation, RemeshError};
use crate::wavelet::{Atlas, ErrorBound, WaveletOptions};

use super::BakedTexture;
use super::stream::Stream;
use super::texture::byte;

/// Handedness of every tangent: the atlas has no mirrored charts.
const HANDEDNESS: f32 = -1.0;
/// Least share of the level's normal in a normal of the map: glTF has none that face away.
const LEAST_Z: f64 = 1.0 / 255.0;

/// The frame that normals of a map are expressed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum NormalSpace {
    /// The tangent frames of a level's vertices: fits this level alone, in any pose.
    Tangent {
        /// Splits of every base face.
        level: usize,
    },
    /// The axes of the mesh: fits every level, in the mesh's own pose.
    Object,
}

/// A normal map, and the mesh that it belongs to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct NormalMap {
    /// Normals as `127.5 (n + 1)`, opaque. Texels outside charts and gutters are `[128, 128, 255, 255]`.
    pub texture: BakedTexture,
    /// The level: positions, the coordinates of the atlas as `uv`, normals, tangents, all other attributes, materials. With
    /// [`NormalSpace::Object`], the base.
    pub mesh: Mesh,
}

impl Parameterisation {
    /// Bakes the mesh's normals into the texture of an atlas: of its vertices where it has normals, else its triangles'.
    ///
    /// Tangent space is as glTF has it: a renderer adds up `x T + y B + z N`, with `B = w (N x T)`, where tangent `T` runs
    /// along growing `u` and `B` along falling `v`. `N`, `T` and `w` are those of [`NormalMap::mesh`], interpolated between
    /// its vertices and not scaled to unit length in between (MikkTSpace). Its normals are the mesh's own at its vertices;
    /// for a mesh without, those of the level's triangles, smooth everywhere.
    ///
    /// `mesh` is the mesh that the map was made from, `atlas` an atlas of the base or of a remesh. The same bytes for any
    /// number of threads. O(texels log n) expected.
    ///
    /// # Errors
    /// The mesh has another number of triangles; the atlas has another number of charts; the level has too many faces.
    pub fn bake_normals(
        &self,
        mesh: &Mesh,
        atlas: &Atlas,
        space: NormalSpace,
    ) -> Result<NormalMap, RemeshError> {
        self.check_baking(mesh, atlas)?;
        let level = match space {
            NormalSpace::Tangent { level } => level,
            NormalSpace::Object => 0,
        };
        // Bounds are of no use here.
        let options = WaveletOptions::default().with_bound(ErrorBound::WithoutSiblings);
        let model = self.bake(mesh, Depth::Levels(level), &options)?;
        let coarse = model.structure().with_atlas(atlas)?;
        let of = coarse.subdivision();
        let faces = of.faces_of(of.depth());
        let corners = faces.clone().filter_map(|face| of.face(face)).collect::<Vec<_>>();
        let materials = match self.base().materials() {
            [] => Vec::new(),
            materials => faces.clone().map(|face| materials[of.base_face_of(face) as usize]).collect(),
        };
        let all: Vec<u32> = (0..of.vertex_count() as u32).collect();
        let mut level = coarse.vertices().gather(&all, corners, materials);
        if Stream::<3>::of(&level, names::NORMAL).is_err() {
            level = level.with_smooth_normals();
        }
        let tangents: Vec<[f32; 4]> = tangents(&level)?
            .iter()
            .map(|tangent| {
                let [x, y, z] = tangent.as_vec3().to_array();
                [x, y, z, HANDEDNESS]
            })
            .collect();
        let level = level
            .without_attribute(names::TANGENT)
            .with_attribute(Attribute::floats(names::TANGENT, &tangents))?;

        let own = Stream::<3>::of(mesh, names::NORMAL).ok();
        let normals = Stream::<3>::of(&level, names::NORMAL)?;
        let texture = BakedTexture::fill(atlas, [128, 128, 255, 255], |place| {
            let n = normal(mesh, own.as_ref(), &self.to_mesh(place)?);
            if space == NormalSpace::Object {
                return Some(encode(n.unwrap_or(DVec3::Z)));
            }
            let (face, weights, _) = of.face_at(place)?;
            let corners = of.face(face)?.map(|v| v as usize);
            let (mut z, mut x) = (DVec3::ZERO, DVec3::ZERO);
            for (vertex, weight) in corners.into_iter().zip(weights) {
                z += weight * normals.vector(vertex);
                x += weight * DVec3::from_array([0, 1, 2].map(|i| f64::from(tangents[vertex][i])));
            }
            let y = f64::from(HANDEDNESS) * z.cross(x);
            Some(encode(n.map_or(DVec3::Z, |n| in_frame(DMat3::from_cols(x, y, z), n))))
        });
        Ok(NormalMap { texture, mesh: level })
    }
}

fn encode(normal: DVec3) -> [u8; 4] {
    let [x, y, z] = normal.to_array().map(|x| byte(127.5 * (x + 1.0)));
    [x, y, z, 255]
}

/// Returns the unit normal of a mesh at a point: of its vertices where it has normals, else its triangle's; `None` for a
/// triangle without area.
fn normal(mesh: &Mesh, normals: Option<&Stream<'_, 3>>, point: &MeshPoint) -> Option<DVec3> {
    let smooth = normals.and_then(|normals| normals.at(mesh, point));
    smooth.and_then(|normal| DVec3::from_array(normal).try_normalize()).or_else(|| {
        let corners = mesh.triangles().get(point.triangle as usize)?;
        let [a, b, c] = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        (b - a).cross(c - a).try_normalize()
    })
}

/// Returns the components of a normal in a frame, scaled to unit length; straight up if the frame has no inverse. Normals
/// facing away are bent until they do not.
fn in_frame(frame: DMat3, n: DVec3) -> DVec3 {
    let scale = frame.x_axis.length() * frame.y_axis.length() * frame.z_axis.length();
    if frame.determinant().abs() <= 1e-9 * scale {
        return DVec3::Z;
    }
    let inside = (frame.inverse() * n).normalize_or(DVec3::Z);
    if inside.z >= LEAST_Z {
        return inside;
    }
    let flat = inside.truncate().normalize_or_zero() * (1.0 - LEAST_Z * LEAST_Z).sqrt();
    flat.extend(LEAST_Z).normalize_or(DVec3::Z)
}

/// Returns the tangents of all vertices as MikkTSpace has them: the directions of growing `u` of the triangles around a
/// vertex, in the plane across its normal, weighted by the corners' angles there. Vertices with the same place and other
/// texture coordinates have tangents of their own.
fn tangents(mesh: &Mesh) -> Result<Vec<DVec3>, RemeshError> {
    let (normals, uv) = (Stream::<3>::of(mesh, names::NORMAL)?, Stream::<2>::of(mesh, names::UV)?);
    let mut sums = vec![DVec3::ZERO; mesh.positions().len()];
    for corners in mesh.triangles() {
        let at = corners.map(|v| DVec3::from_array(mesh.positions()[v as usize].map(f64::from)));
        let [p, q, r] = corners.map(|v| uv.value(v as usize));
        let (e, f) = (at[1] - at[0], at[2] - at[0]);
        let (s, t) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        // Divided by the area in the texture, which is positive.
        let along = t[1] * e - s[1] * f;
        for k in 0..3 {
            let vertex = corners[k] as usize;
            let across = normals.vector(vertex).normalize_or_zero();
            let flat = |v: DVec3| (v - v.dot(across) * across).normalize_or_zero();
            let (a, b) = (flat(at[(k + 1) % 3] - at[k]), flat(at[(k + 2) % 3] - at[k]));
            sums[vertex] += a.dot(b).clamp(-1.0, 1.0).acos() * flat(along);
        }
    }
    let unit = |(vertex, sum): (usize, DVec3)| {
        let across = normals.vector(vertex).normalize_or(DVec3::Z);
        sum.try_normalize().unwrap_or_else(|| across.any_orthonormal_vector())
    };
    Ok(sums.into_iter().enumerate().map(unit).collect())
}
