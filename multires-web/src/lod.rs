//! A level of detail that follows a camera.

use multires::hierarchy::HierarchyBuilder;
use multires::lod::{self, LodOptions, Model, Values, VertexBuffer};
use multires::tom::TomBuilder;
use multires::view::View;
use wasm_bindgen::prelude::*;

use crate::input::{Options, mesh, simplifier};

/// A mesh and the level of detail that is drawn of it.
#[wasm_bindgen]
pub struct Lod {
    instance: Box<dyn lod::Lod>,
    order: Vec<u32>,
    full: usize,
    /// Whether what was written before has been told.
    is_told: bool,
    /// Cameras since the last `adapt`.
    views: Vec<multires::view::ObjectView>,
}

#[wasm_bindgen]
impl Lod {
    /// Builds levels of detail of a mesh: positions, three numbers each, and triangles. See `index.d.ts` for the options.
    ///
    /// # Errors
    /// As `simplify`; or there is no structure of that name.
    #[wasm_bindgen(constructor, skip_typescript)]
    pub fn new(positions: &[f32], indices: &[u32], options: &JsValue) -> Result<Lod, JsError> {
        let options = Options(options);
        let mesh = mesh(positions, indices, &options)?;
        let simplifier = simplifier(&options)?;
        let name = options.text("structure")?.unwrap_or_else(|| "hierarchy".to_owned());
        let model: Box<dyn Model<[f32; 3]>> = match &*name {
            "hierarchy" => Box::new(HierarchyBuilder::new().simplifier(simplifier).bake(&mesh)?),
            "tom" => Box::new(TomBuilder::new().simplifier(simplifier).bake(&mesh)?),
            _ => {
                return Err(JsError::new(&format!("there is no structure named {name:?}: hierarchy or tom")));
            }
        };
        let most = options.count("most")?;
        let how = LodOptions::default().with_buffer(VertexBuffer::Shared).with_triangles(most);
        let values = Values::from(model.vertices().positions().to_vec());
        Ok(Self {
            instance: model.instance(&values, &how)?,
            order: model.origins().order().to_vec(),
            full: mesh.triangles().len(),
            is_told: false,
            views: Vec::new(),
        })
    }

    /// The vertex of the input that every vertex of the level of detail is: attributes are to be put into this order, once.
    #[wasm_bindgen(getter)]
    pub fn order(&self) -> Vec<u32> {
        self.order.clone()
    }

    /// Triangles at full resolution.
    #[wasm_bindgen(getter, js_name = fullTriangles)]
    pub fn full_triangles(&self) -> usize {
        self.full
    }

    /// Adds a camera of the next `adapt`: the matrix from object to eye (column-major, as three.js has it; the eye looks along -z), the
    /// vertical field of view in radians, the size of the picture in pixels, and how many pixels the surface may be off.
    ///
    /// # Errors
    /// The matrix is not 16 finite numbers, or scales unevenly; the picture has no size.
    #[wasm_bindgen(js_name = addView)]
    pub fn add_view(
        &mut self,
        object_to_eye: &[f32],
        field_of_view: f32,
        width: u32,
        height: u32,
        tolerance: f32,
    ) -> Result<(), JsError> {
        let matrix: &[f32; 16] =
            object_to_eye.try_into().map_err(|_| JsError::new("a matrix has 16 numbers"))?;
        let columns: [[f32; 4]; 4] = std::array::from_fn(|c| std::array::from_fn(|r| matrix[4 * c + r]));
        let identity = std::array::from_fn(|c| std::array::from_fn(|r| f32::from(u8::from(c == r))));
        let view = View::perspective(identity, field_of_view, [width, height])?.with_tolerance_px(tolerance);
        self.views.push(view.of_object(columns)?);
        Ok(())
    }

    /// Follows the cameras that were added since the last call, `seconds` after it. Returns whether other triangles are drawn than before.
    pub fn adapt(&mut self, seconds: f32) -> bool {
        // All that an instance has at first counts as changed.
        if self.is_told {
            self.instance.clean();
        }
        self.is_told = true;
        self.instance.adapt(&self.views, seconds);
        self.views.clear();
        self.instance.uploads().next().is_some()
    }

    /// Number of groups of triangles: one for each material, at least one.
    #[wasm_bindgen(getter)]
    pub fn groups(&self) -> usize {
        self.instance.groups()
    }

    /// The material of a group.
    pub fn material(&self, group: usize) -> u32 {
        if group < self.instance.groups() { self.instance.material(group) } else { u32::MAX }
    }

    /// Triangles that are drawn.
    #[wasm_bindgen(getter)]
    pub fn triangles(&self) -> usize {
        (0..self.instance.groups()).map(|group| self.instance.triangles(group).len()).sum()
    }

    /// Where the indices of a group's drawn triangles lie in this module's memory: the first byte, and the number of indices. The bindings
    /// make a view of them, which holds until the next call of anything here.
    #[wasm_bindgen(skip_typescript)]
    pub fn place(&self, group: usize) -> Vec<u32> {
        let indices = self.instance.triangles(group).as_flattened();
        vec![indices.as_ptr() as usize as u32, indices.len() as u32]
    }

    /// Where the indices of a group have changed in the last `adapt`: pairs of first index and number of indices.
    pub fn changed(&self, group: usize) -> Vec<u32> {
        if group >= self.instance.groups() {
            return Vec::new();
        }
        self.instance
            .dirty_triangles(group, 16)
            .flat_map(|range| [3 * range.start as u32, 3 * range.len() as u32])
            .collect()
    }
}
