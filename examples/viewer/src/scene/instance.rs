//! An instance whose structure is known where a controller needs it.

use multires::adapt::Change;
use multires::gmesh::{GmeshLod, Morph};
use multires::lod::{Lod, LodError, LodOptions};

use super::Model;
use crate::renderer::Vertex;

/// A drawn instance.
pub(super) enum Instance {
    /// Of a g-mesh, which can be shown in any state.
    Gmesh(Box<GmeshLod<Vertex>>),
    /// Of any structure.
    Other(Box<dyn Lod>),
}

impl Instance {
    /// Makes an instance of a model.
    pub fn new(model: &Model, options: &LodOptions) -> Result<Self, LodError> {
        Ok(match model.gmesh() {
            Some(baked) => Self::Gmesh(Box::new(baked.instance(model.vertices().clone(), options)?)),
            None => Self::Other(model.instance(options)?),
        })
    }

    pub fn lod(&self) -> &dyn Lod {
        match self {
            Self::Gmesh(lod) => &**lod,
            Self::Other(lod) => &**lod,
        }
    }

    pub fn lod_mut(&mut self) -> &mut dyn Lod {
        match self {
            Self::Gmesh(lod) => &mut **lod,
            Self::Other(lod) => &mut **lod,
        }
    }

    /// Draws a state of a g-mesh. Returns `None` for another structure.
    pub fn show(&mut self, state: Morph) -> Option<Change> {
        match self {
            Self::Gmesh(lod) => Some(lod.show(state)),
            Self::Other(_) => None,
        }
    }
}
