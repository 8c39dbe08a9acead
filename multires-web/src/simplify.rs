//! Fewer triangles over the same vertices.

use multires::sequence::StopReason;
use wasm_bindgen::prelude::*;

use crate::input::{Options, mesh, simplifier};

/// What came of a simplification.
#[wasm_bindgen]
pub struct Simplified {
    indices: Vec<u32>,
    triangles: Vec<u32>,
    error: f32,
    reason: StopReason,
}

#[wasm_bindgen]
impl Simplified {
    /// Three vertices of the input for every triangle that is left.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Vec<u32> {
        self.indices.clone()
    }

    /// The triangle of the input that every triangle was.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> Vec<u32> {
        self.triangles.clone()
    }

    /// How far the surface is off, in units of the positions.
    #[wasm_bindgen(getter)]
    pub fn error(&self) -> f32 {
        self.error
    }

    /// Why it stopped: `target`, `error`, `nothing-legal` or `guard`.
    #[wasm_bindgen(getter)]
    pub fn reason(&self) -> String {
        let reason = match self.reason {
            StopReason::Target => "target",
            StopReason::Error => "error",
            StopReason::Guard => "guard",
            _ => "nothing-legal",
        };
        reason.to_owned()
    }
}

/// Simplifies a mesh: positions, three numbers each, and triangles. See `index.d.ts` for the options.
///
/// # Errors
/// A position that is not finite, an index out of range, an array of the wrong kind or length, an option outside its range.
#[wasm_bindgen(skip_typescript)]
pub fn simplify(positions: &[f32], indices: &[u32], options: &JsValue) -> Result<Simplified, JsError> {
    let options = Options(options);
    let mesh = mesh(positions, indices, &options)?;
    let sequence = simplifier(&options)?.run(&mesh)?;
    let steps = sequence.len();
    let (left, triangles) = sequence.triangles_at(&mesh, steps);
    Ok(Simplified {
        indices: left.into_flattened(),
        triangles,
        error: sequence.error_after(steps),
        reason: sequence.report().stop,
    })
}
