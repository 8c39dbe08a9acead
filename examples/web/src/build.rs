//! Builds: a built-in shape, or a file that was dropped, becomes the bytes of a baked model.

use std::ops::ControlFlow;

use js_sys::Function;
use multires::io::{self, BakeError, Format, ReadError, ReadOptions, SceneOrigin};
use multires_viewer::scene::{BuildOptions, Coordinates, Model, StructureKind, Texture};
use wasm_bindgen::prelude::*;

use crate::names::builtin;

/// A baked model, its pictures, and what is to be said of it.
#[wasm_bindgen]
pub struct Built {
    bytes: Vec<u8>,
    triangles: usize,
    /// Colours, and normals in tangent space.
    pictures: [Option<Texture>; 2],
    is_painted: bool,
    warnings: Vec<String>,
}

#[wasm_bindgen]
impl Built {
    /// The baked model. Leaves nothing behind.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }

    /// Pixels of its colours (0) or normals (1), four bytes each, row by row; empty if it has none. Leaves nothing behind.
    pub fn take_picture(&mut self, which: usize) -> Vec<u8> {
        self.pictures[which].take().map_or_else(Vec::new, |picture| picture.pixels.into_flattened())
    }

    /// Width of its colours (0) or normals (1), pixels; 0 if it has none, or they were taken.
    pub fn width(&self, which: usize) -> u32 {
        self.pictures[which].as_ref().map_or(0, |picture| picture.size[0])
    }

    /// Whether its file names pictures to paint it with.
    #[wasm_bindgen(getter)]
    pub fn is_painted(&self) -> bool {
        self.is_painted
    }

    /// Triangles at full resolution.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// What was not read as the file has it.
    #[wasm_bindgen(getter)]
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

fn structure(name: &str) -> Option<StructureKind> {
    match name {
        "hierarchy" => Some(StructureKind::Hierarchy),
        "tom" => Some(StructureKind::Tom),
        "gmesh" => Some(StructureKind::Gmesh),
        "wavelet" => Some(StructureKind::Wavelet),
        _ => None,
    }
}

/// Builds the model of a built-in scene, or of a file: its name, for its format, and its bytes. `progress` is told the share of the
/// way, 0 to 1. A baked file keeps its structure.
///
/// # Errors
/// There is no such scene or structure, the file cannot be read, or the structure cannot be built from it: an `Error` whose message
/// says so in one line.
#[wasm_bindgen]
pub fn build(
    name: &str,
    bytes: Option<Vec<u8>>,
    structure_name: &str,
    progress: &Function,
) -> Result<Built, JsError> {
    let structure = structure(structure_name)
        .ok_or_else(|| JsError::new(&format!("there is no structure named {structure_name:?}")))?;
    let mut options = BuildOptions::default().with_structure(structure);
    let is_gltf = [".glb", ".gltf"].iter().any(|end| name.to_lowercase().ends_with(end));
    let (mesh, warnings) = match &bytes {
        Some(bytes) if name.to_lowercase().ends_with(".mres") => {
            return Ok(Built::of(&Model::of_baked(bytes, options.coordinates)?, Vec::new())?);
        }
        Some(bytes) => {
            if is_gltf {
                // Its pictures are for the coordinates that it has.
                options = options.with_coordinates(Coordinates::Own);
            }
            let format = Format::from_path(name)
                .ok_or_else(|| JsError::new(&ReadError::UnknownFormat { path: name.into() }.to_string()))?;
            let options = ReadOptions::default().with_origin(SceneOrigin::Center);
            let read = io::read_bytes_with(format, bytes, &options)?;
            (read.mesh, read.notes.iter().map(ToString::to_string).collect())
        }
        None => {
            let builtin =
                builtin(name).ok_or_else(|| JsError::new(&format!("there is no scene named {name:?}")))?;
            options = options.with_coarsest(builtin.coarsest());
            (builtin.mesh(None, structure), Vec::new())
        }
    };
    let mut told = -1.0;
    let mut tell = |at: f32| {
        // A message a percent is enough, and none can fail.
        if at - told >= 0.01 {
            told = at;
            let _ = progress.call1(&JsValue::NULL, &JsValue::from(at));
        }
        ControlFlow::Continue(())
    };
    let mut model = Model::build(&mesh, &options, &mut tell)?;
    if let Some(bytes) = bytes.filter(|_| is_gltf) {
        model = model.with_pictures_in(&bytes);
    }
    Ok(Built::of(&model, warnings)?)
}

impl Built {
    fn of(model: &Model, mut warnings: Vec<String>) -> Result<Self, BakeError> {
        warnings.extend_from_slice(model.warnings());
        Ok(Self {
            bytes: model.baked().to_bytes()?,
            triangles: model.triangle_count(),
            pictures: [model.texture().cloned(), model.normal_map().cloned()],
            is_painted: model.is_painted(),
            warnings,
        })
    }
}
