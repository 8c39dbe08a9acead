//! Baked files of multires (`.mres`) as assets: levels without a build.

use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{Asset, AssetId, AssetLoader, Handle, LoadContext};
use bevy::ecs::component::Component;
use bevy::mesh::Mesh;
use bevy::reflect::{Reflect, TypePath};
use multires::io::{BakeError, OpenOptions, StoredModel, open_model};
use multires::lod::{Level, Model};

use crate::auto_lod::{AutoLod, LodLevel, LodLevels};
use crate::build::{Following, Ladder};
use crate::convert::{self, ConvertError};

/// Why a baked file cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] std::io::Error),
    /// The file is damaged, or no baked file.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// Bevy takes no such vertices.
    #[error(transparent)]
    Convert(#[from] ConvertError),
}

/// A baked model of any structure, loaded from a `.mres` file. Spawn [`LodModel3d`] to draw it.
///
/// The file's levels are sub-assets too: `rocks.mres#Part0/Level0` is the mesh of its first material at full resolution.
#[derive(Asset, TypePath)]
pub struct LodModel {
    pub(crate) following: Arc<Following>,
    pub(crate) parts: Vec<LodPart>,
}

/// The triangles of a model with one material.
#[derive(Debug)]
#[non_exhaustive]
pub struct LodPart {
    /// Id of the material; `u32::MAX` if the model has none.
    pub material: u32,
    /// Name of the material; empty if it has none.
    pub name: String,
    /// The part at full resolution.
    pub mesh: Handle<Mesh>,
    /// Its levels.
    pub levels: Arc<LodLevels>,
}

impl std::fmt::Debug for LodModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LodModel").field("kind", &self.kind()).field("parts", &self.parts).finish()
    }
}

impl LodModel {
    /// Returns the parts, one for each material; a single part if the model has no materials.
    pub fn parts(&self) -> &[LodPart] {
        &self.parts
    }

    /// Returns the name of the structure's kind.
    pub fn kind(&self) -> &'static str {
        self.following.model.kind()
    }
}

/// Draws a part of a [`LodModel`]: the plugin adds `Mesh3d` when the file is there. Add a `MeshMaterial3d`, and a `Transform` if need be.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_multires::{AutoLod, LodModel3d};
///
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((LodModel3d::new(assets.load("rock.mres")), AutoLod::default().with_tolerance_px(2.0)));
/// }
/// # bevy::ecs::system::assert_is_system(spawn);
/// ```
#[derive(Component, Debug, Clone, PartialEq, Reflect)]
#[require(AutoLod)]
pub struct LodModel3d {
    /// The model.
    pub model: Handle<LodModel>,
    /// Number of the part to draw; default 0.
    pub part: usize,
}

impl LodModel3d {
    /// Draws the first part of a model.
    pub fn new(model: Handle<LodModel>) -> Self {
        Self { model, part: 0 }
    }

    /// Draws another part.
    #[must_use]
    pub fn with_part(mut self, part: usize) -> Self {
        self.part = part;
        self
    }

    pub(crate) fn id(&self) -> AssetId<LodModel> {
        self.model.id()
    }
}

/// Loads `.mres` files: [`LodModel`]. Damaged files are an error of the asset server.
#[derive(Debug, Default, TypePath)]
pub struct LodModelLoader;

impl AssetLoader for LodModelLoader {
    type Asset = LodModel;
    type Settings = ();
    type Error = ModelError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<LodModel, ModelError> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let model: Box<dyn StoredModel<u32>> = open_model(Arc::new(bytes), OpenOptions::default())?;
        let model: Arc<dyn Model<u32>> = Arc::<dyn StoredModel<u32>>::from(model);
        load(model, context)
    }

    fn extensions(&self) -> &[&str] {
        &["mres"]
    }
}

/// A level before it is an asset: mesh, bound for its error, number of triangles.
type Rung = (Mesh, f32, usize);

fn load(model: Arc<dyn Model<u32>>, context: &mut LoadContext<'_>) -> Result<LodModel, ModelError> {
    let [full, least] = model.triangle_counts();
    let steps = Ladder::default().steps(full).take_while(|&triangles| triangles >= least);
    let levels = std::iter::once(Level::Ratio(1.0)).chain(steps.map(Level::Triangles));
    let ids = match model.materials() {
        [] => vec![u32::MAX],
        ids => ids.to_vec(),
    };
    let mut rungs: Vec<Vec<Rung>> = ids.iter().map(|_| Vec::new()).collect();
    let aabb = model.bounds().map(|[low, high]| bevy::math::bounding::Aabb3d::from_min_max(low, high));
    for level in levels {
        let extracted = model.level(level);
        let mut all = convert::to_bevy(&extracted.mesh)?;
        all.final_aabb = aabb;
        for (&id, rungs) in ids.iter().zip(&mut rungs) {
            let mesh = match model.materials() {
                [] => all.clone(),
                _ => convert::material(&extracted.mesh, &all, id)?,
            };
            let triangles = mesh.try_indices().map_err(ConvertError::from)?.len() / 3;
            // A small part may be as it was, or gone: then the level before stands for this one.
            if triangles > 0 && rungs.last().is_none_or(|(.., last)| triangles < *last) {
                rungs.push((mesh, extracted.error, triangles));
            }
        }
    }
    let mut parts = Vec::new();
    for (at, (material, rungs)) in ids.into_iter().zip(rungs).enumerate() {
        let mut levels = rungs.into_iter().enumerate().map(|(level, (mesh, error, triangles))| LodLevel {
            mesh: context.add_labeled_asset(format!("Part{at}/Level{level}"), mesh),
            error,
            triangles,
        });
        // A material without a triangle at full resolution is no part.
        let Some(finest) = levels.next() else { continue };
        let coarser = levels.collect();
        let names = model.vertices().material_names();
        let name = usize::try_from(material).ok().and_then(|id| names.get(id)).cloned().unwrap_or_default();
        let levels = Arc::new(LodLevels { full_triangles: finest.triangles, coarser });
        parts.push(LodPart { material, name, mesh: finest.mesh, levels });
    }
    let mut vertices = convert::to_bevy(model.vertices())?;
    vertices.final_aabb = aabb;
    let short = vertices.count_vertices() <= usize::from(u16::MAX) + 1;
    let following = Arc::new(Following { model, vertices, short });
    Ok(LodModel { following, parts })
}
