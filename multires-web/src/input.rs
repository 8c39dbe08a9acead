//! A mesh from typed arrays, and options from an object.

use js_sys::{Float32Array, Reflect, Uint32Array};
use multires::mesh::{Attribute, AttributeValues, Mesh, names};
use multires::simplify::{Simplifier, Target};
use wasm_bindgen::{JsCast, JsError, JsValue};

/// An object of options; nothing stands for an empty one.
pub struct Options<'a>(pub &'a JsValue);

impl Options<'_> {
    /// The value of that name, if it is there.
    fn get(&self, name: &str) -> Option<JsValue> {
        if !self.0.is_object() {
            return None;
        }
        let value = Reflect::get(self.0, &JsValue::from_str(name)).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    /// The number of that name.
    pub fn number(&self, name: &str) -> Result<Option<f64>, JsError> {
        let wrong = || JsError::new(&format!("option {name} is not a number"));
        self.get(name).map(|value| value.as_f64().ok_or_else(wrong)).transpose()
    }

    /// The count of that name.
    pub fn count(&self, name: &str) -> Result<Option<usize>, JsError> {
        let wrong = |value| JsError::new(&format!("option {name} is {value}, which is no count"));
        let count = |value: f64| {
            if value >= 0.0 && value <= f64::from(u32::MAX) { Ok(value as usize) } else { Err(wrong(value)) }
        };
        self.number(name)?.map(count).transpose()
    }

    /// The text of that name.
    pub fn text(&self, name: &str) -> Result<Option<String>, JsError> {
        let wrong = || JsError::new(&format!("option {name} is not a string"));
        self.get(name).map(|value| value.as_string().ok_or_else(wrong)).transpose()
    }

    fn array<A: JsCast>(&self, name: &str, kind: &str) -> Result<Option<A>, JsError> {
        let wrong = |_| JsError::new(&format!("option {name} is not a {kind}"));
        self.get(name).map(|value| value.dyn_into().map_err(wrong)).transpose()
    }
}

/// A mesh of positions, three numbers each, and triangles, with the streams among `normals`, `uvs` and `colors` and the `materials` of
/// the options. What streams there are count for the error, and differing values at one place make a seam.
pub fn mesh(positions: &[f32], indices: &[u32], options: &Options<'_>) -> Result<Mesh, JsError> {
    let uneven = |what: &str, length: usize| {
        JsError::new(&format!("{what} have {length} numbers, which is not a multiple of 3"))
    };
    let (corners, rest) = positions.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(uneven("positions", positions.len()));
    }
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(uneven("indices", indices.len()));
    }
    let mut mesh = Mesh::new(corners, triangles)?;
    let streams = [("normals", names::NORMAL, 3), ("uvs", names::UV, 2), ("colors", names::COLOR, 0)];
    for (option, name, width) in streams {
        if let Some(values) = options.array::<Float32Array>(option, "Float32Array")? {
            let values = values.to_vec();
            // Colours have three or four channels.
            let width = if width > 0 { width } else { (values.len() / corners.len().max(1)).clamp(3, 4) };
            mesh = mesh.with_attribute(Attribute::new(name, width, AttributeValues::Float(values)))?;
        }
    }
    if let Some(materials) = options.array::<Uint32Array>("materials", "Uint32Array")? {
        mesh = mesh.with_materials(materials.to_vec())?;
    }
    Ok(mesh)
}

/// A simplifier with the targets of the options.
pub fn simplifier(options: &Options<'_>) -> Result<Simplifier, JsError> {
    let mut simplifier = Simplifier::new();
    if let Some(triangles) = options.count("triangles")? {
        simplifier = simplifier.target(Target::Triangles(triangles));
    }
    if let Some(ratio) = options.number("ratio")? {
        simplifier = simplifier.target(Target::Ratio(ratio));
    }
    if let Some(error) = options.number("error")? {
        simplifier = simplifier.target(Target::Error(error as f32));
    }
    Ok(simplifier)
}
