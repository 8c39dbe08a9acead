//! Who takes part. A contender is a name and a function; the function alone is timed.

use std::error::Error;

use meshopt::{SimplifyOptions, VertexDataAdapter};
use multires::mesh::Mesh;
use multires::simplify::metric::LindstromTurk;
use multires::simplify::{ErrorMeasure, Placement, Simplifier, Target};

/// A simplifier under measurement.
pub(crate) struct Contender {
    /// Shown in tables and in file names.
    pub name: &'static str,
    /// Simplifies the mesh to at most that many triangles (fewer are fine, more are reported as such). Everything a
    /// user of the simplifier has to pay for belongs inside, from plain arrays to plain arrays.
    pub run: fn(&Mesh, usize) -> Outcome,
}

/// What a contender returns, or why it could not.
pub(crate) type Outcome = Result<Output, Box<dyn Error>>;

/// What a contender hands over, in its own form: turning it into a mesh is not timed.
pub(crate) enum Output {
    /// Triangles on the input's own vertices.
    Indices(Vec<u32>),
    /// A mesh with vertices of its own, for contenders that move or make vertices.
    Mesh(Mesh),
}

/// Every contender, in the order they run within a round.
pub(crate) const CONTENDERS: &[Contender] = &[
    Contender { name: "meshopt", run: meshopt },
    Contender { name: "parametric", run: |mesh, n| sequence(mesh, n, ErrorMeasure::Parametric) },
    Contender { name: "measured", run: |mesh, n| sequence(mesh, n, ErrorMeasure::Measured) },
    Contender { name: "verified", run: |mesh, n| sequence(mesh, n, ErrorMeasure::Verified) },
    Contender { name: "lindstrom-turk", run: lindstrom_turk },
];

/// Refuses names that no contender has.
pub(crate) fn check_names(names: &[String]) -> Result<(), String> {
    match names.iter().find(|name| CONTENDERS.iter().all(|c| c.name != name.as_str())) {
        Some(unknown) => {
            let known: Vec<&str> = CONTENDERS.iter().map(|c| c.name).collect();
            Err(format!("there is no contender {unknown:?}; there are: {}", known.join(", ")))
        }
        None => Ok(()),
    }
}

impl Output {
    /// Number of triangles.
    pub(crate) fn triangles(&self) -> usize {
        match self {
            Self::Indices(indices) => indices.len() / 3,
            Self::Mesh(mesh) => mesh.triangles().len(),
        }
    }

    /// As a mesh of its own.
    pub(crate) fn into_mesh(self, input: &Mesh) -> Result<Mesh, Box<dyn Error>> {
        match self {
            Self::Indices(indices) => {
                let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
                crate::input::compact(input.positions(), triangles)
            }
            Self::Mesh(mesh) => Ok(mesh),
        }
    }
}

/// `meshopt_simplify`: half-edge collapses onto existing vertices; no limit on the error, so the count decides.
fn meshopt(mesh: &Mesh, triangles: usize) -> Outcome {
    let bytes = meshopt::typed_to_bytes(mesh.positions());
    let vertices = VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0)?;
    let simple =
        meshopt::simplify(mesh.indices(), &vertices, triangles * 3, f32::MAX, SimplifyOptions::None, None);
    Ok(Output::Indices(simple))
}

/// The whole sequence down to the base mesh, quadrics and endpoint placement, and the level asked for taken from it.
fn sequence(mesh: &Mesh, triangles: usize, measure: ErrorMeasure) -> Outcome {
    let sequence = Simplifier::new().error_measure(measure).run(mesh)?;
    let (level, _) = sequence.triangles_at(mesh, sequence.steps_for_triangles(triangles));
    Ok(Output::Indices(level.into_flattened()))
}

/// Lindstrom-Turk with optimal placement, to the level asked for.
fn lindstrom_turk(mesh: &Mesh, triangles: usize) -> Outcome {
    let simplifier = Simplifier::new().metric(LindstromTurk::new()).placement(Placement::Optimal);
    let sequence = simplifier.target(Target::Triangles(triangles)).run(mesh)?;
    Ok(Output::Mesh(sequence.extract(mesh, sequence.len())))
}
