//! A level of a mesh, and what is known of it.

use multires::mesh::{Attribute, Mesh, names};
use multires::simplify::{AttributeDeviation, Growth};
use multires::{CollapseSequence, MeshError};

use super::{Simplify, Values};

/// A level of a mesh.
pub struct Level {
    pub mesh: Mesh,
    pub deviations: Vec<AttributeDeviation>,
    pub growth: Growth,
    /// Error, units of the mesh: of the collapses, and of parts that were grown.
    pub error: f32,
}

impl Level {
    /// Makes the level after some steps. `farthest`: the largest error that parts may have from growing.
    pub fn new(
        command: &Simplify,
        mesh: &Mesh,
        sequence: &CollapseSequence,
        steps: usize,
        farthest: f32,
    ) -> Self {
        let level = match command.attribute_values {
            Values::Fitted => {
                let fitted = sequence.extract_fitted(mesh, steps);
                with_own_values(fitted, &sequence.extract(mesh, steps))
            }
            Values::Kept => sequence.extract(mesh, steps),
        };
        let deviations = sequence.attribute_deviations(mesh, steps, &level);
        let (mesh, growth) = match command.no_growth {
            false => sequence.grow(mesh, steps, level, farthest),
            true => (level, Growth::default()),
        };
        // Grown parts lie off the surface by as much.
        let error = sequence.error_after(steps).max(growth.distance);
        Self { mesh, deviations, growth, error }
    }
}

/// Whether an attribute may be fitted: an application's own may be numbers of things.
fn is_customary(name: &str) -> bool {
    let sets = [names::UV, names::COLOR, names::JOINTS, names::WEIGHTS, names::DISPLACEMENT];
    let is_target = name.starts_with(names::DISPLACEMENT);
    [names::NORMAL, names::TANGENT].contains(&name)
        || is_target
        || sets.iter().any(|set| names::is_set_of(name, set))
}

/// Takes the values of an application's own attributes from vertices of the input: `kept` is the same level with the values of
/// its vertices.
fn with_own_values(level: Mesh, kept: &Mesh) -> Mesh {
    let is_own = |a: &&Attribute| a.as_floats().is_some() && !is_customary(a.name());
    if !level.attributes().iter().any(|a| is_own(&a)) || level.positions().len() != kept.positions().len() {
        return level;
    }
    let rebuild = || -> Result<Mesh, MeshError> {
        let mut mesh = Mesh::new(level.positions(), level.triangles())?
            .with_materials(level.materials())?
            .with_material_names(level.material_names())
            .with_locks(level.locks())?
            .with_origin(level.origin())?;
        for attribute in level.attributes() {
            let own = kept.attribute(attribute.name()).filter(is_own);
            mesh = mesh.with_attribute(own.unwrap_or(attribute).clone())?;
        }
        Ok(mesh)
    };
    rebuild().unwrap_or_else(|_| level.clone())
}
