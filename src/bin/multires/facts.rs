//! Facts about a baked model, for JSON and for people: common to all models, and of each structure. Of the other files of
//! the program, `build.rs` names structures to build them, and `extract.rs` wavelets for their own levels.

use multires::Baked;
use multires::gmesh::{Gmesh, Partition};
use multires::hierarchy::{Dependencies, VertexHierarchy};
use multires::lod::{Extracted, Level};
use multires::tom::TotallyOrderedMesh;
use multires::view::ErrorShape;
use multires::wavelet::{ErrorBound, WaveletMesh};
use serde_json::{Value, json};

use crate::model::Model;
use crate::output::{Table, error_text, percent};

/// Members of a JSON object, and rows of a table.
pub struct Facts {
    pub members: Vec<(&'static str, Value)>,
    pub rows: Table,
}

impl Facts {
    /// Collects the facts of a model.
    pub fn new(model: &Model) -> Self {
        let mut facts = Self { members: Vec::new(), rows: Table::default() };
        let any = model.0.as_any();
        if let Some(model) = any.downcast_ref::<Baked<VertexHierarchy>>() {
            facts.hierarchy(model.structure());
        } else if let Some(baked) = any.downcast_ref::<Baked<WaveletMesh>>() {
            facts.wavelet(baked.structure());
        } else if let Some(baked) = any.downcast_ref::<Baked<Gmesh>>() {
            facts.gmesh(baked.structure(), model.diagonal());
        } else if let Some(baked) = any.downcast_ref::<Baked<TotallyOrderedMesh>>() {
            facts.tom(baked.structure(), model);
        }
        facts.memory(model);
        facts
    }

    fn say(&mut self, members: impl IntoIterator<Item = (&'static str, Value)>) {
        self.members.extend(members);
    }

    fn memory(&mut self, model: &Model) {
        let memory = model.0.memory();
        let share = percent(memory as f64, model.0.plain_memory() as f64);
        let origins = model.0.origins().memory();
        self.say([
            ("memory", json!(memory)),
            ("memory_percent", json!(share)),
            ("origins_memory", json!(origins)),
        ]);
        let share = share.map_or(String::from("-"), |p| format!("{p:.1}"));
        let each = self.members.iter().find(|(name, _)| *name == "structure_bytes_per_vertex");
        let each = each.and_then(|(_, each)| each.as_f64());
        let each = each.map_or(String::new(), |each| format!("; structure {each:.1} a vertex"));
        self.rows.row("memory", format!("{memory} bytes, {share} % of the plain mesh{each}"));
        self.rows.row("origins", format!("{origins} bytes: where vertices come from"));
    }

    fn tom(&mut self, tom: &TotallyOrderedMesh, model: &Model) {
        let diagonal = model.diagonal();
        let marks: Vec<Value> =
            tom.error_marks().iter().map(|m| json!({ "vertices": m.vertices, "error": m.error })).collect();
        let describe = |resolution: multires::tom::Resolution| {
            let [vertices, triangles] = [resolution.vertices(), resolution.triangles()];
            counts(vertices, triangles, resolution.error(), diagonal)
        };
        self.say([
            ("finest", describe(tom.finest())),
            ("coarsest", describe(tom.coarsest())),
            ("error_marks", json!(marks)),
        ]);
        for (label, resolution) in [("finest", tom.finest()), ("coarsest", tom.coarsest())] {
            let (vertices, triangles) = (resolution.vertices(), resolution.triangles());
            self.rows.row(label, format!("{vertices} vertices, {triangles} triangles"));
        }
        let worst = f64::from(tom.coarsest().error());
        self.rows.row("error of coarsest", error_text(worst, percent(worst, diagonal)));
        self.rows.row("error marks", tom.error_marks().len());
    }

    fn hierarchy(&mut self, hierarchy: &VertexHierarchy) {
        let leaves = hierarchy.leaf_count();
        let overhead = (leaves > 0).then(|| hierarchy.overhead() as f64 / leaves as f64);
        let dependencies = match hierarchy.dependency_kind() {
            Dependencies::None => "none",
            Dependencies::Manifold => "manifold",
            Dependencies::Adjacent => "adjacent",
            Dependencies::Neighbours => "neighbours",
            _ => "other",
        };
        self.say([
            ("splits", json!(hierarchy.split_count())),
            ("vertices", json!({ "finest": leaves, "all": hierarchy.vertex_count() })),
            ("triangles", json!(hierarchy.triangle_count())),
            ("base_triangles", json!(hierarchy.base_triangle_count())),
            ("dependencies", json!(dependencies)),
            // Bytes a vertex of the finest level, beyond the plain mesh's triangles.
            ("structure_bytes_per_vertex", json!(overhead)),
        ]);
        let made = hierarchy.vertex_count() - leaves;
        self.rows
            .row("finest", format!("{leaves} vertices, {} triangles", hierarchy.triangle_count()))
            .row("coarsest", format!("{} triangles", hierarchy.base_triangle_count()))
            .row("splits", format!("{}, {made} new vertices", hierarchy.split_count()))
            .row("dependencies", dependencies);
    }

    fn gmesh(&mut self, gmesh: &Gmesh, diagonal: f64) {
        let level = |level: &multires::gmesh::GmeshLevel| {
            json!({
                "triangles": level.triangles,
                "vertices": level.vertices,
                "error": level.error,
                "error_percent": percent(f64::from(level.error), diagonal),
                "volume": level.volume,
            })
        };
        let [volume, error] = [Partition::by_volume(gmesh), Partition::by_error(gmesh)];
        self.say([
            ("levels", gmesh.levels().iter().map(level).collect()),
            ("starts_by_volume", json!(volume.starts())),
            ("starts_by_error", json!(error.starts())),
        ]);
        for (index, level) in gmesh.levels().iter().enumerate() {
            let volume = level.volume.map_or(String::new(), |volume| format!(", volume {volume:.6}"));
            let error = error_text(f64::from(level.error), percent(f64::from(level.error), diagonal));
            let counts = format!("{} vertices, {} triangles", level.vertices, level.triangles);
            self.rows.row(&format!("level {index}"), format!("{counts}, error {error}{volume}"));
        }
    }

    fn wavelet(&mut self, mesh: &WaveletMesh) {
        let of = mesh.subdivision();
        let vertices = of.vertex_count();
        let each = (vertices > 0).then(|| mesh.structure_memory() as f64 / vertices as f64);
        let error = |level: usize| {
            let end = of.wavelets_of(level).end;
            mesh.largest_left_out(|wavelet| wavelet < end)
        };
        let levels = (0..=of.depth()).map(|level| {
            json!({
                "faces": of.faces_of(level).len(),
                "wavelets": of.wavelets_of(level).len(),
                "error": error(level),
            })
        });
        let shape = match mesh.options().shape {
            ErrorShape::Spheroid => "spheroid",
            ErrorShape::SphereAndCones => "hoppe",
            _ => "other",
        };
        self.say([
            ("levels", json!(of.depth())),
            ("base_triangles", json!(of.base_face_count())),
            ("wavelets", json!(of.wavelet_count())),
            ("vertices", json!(vertices)),
            ("triangles", json!(of.triangle_count())),
            ("by_level", levels.collect()),
            ("bound", json!(bound(mesh))),
            ("shape", json!(shape)),
            // Bytes a vertex of the finest level, beyond the vertices themselves.
            ("structure_bytes_per_vertex", json!(each)),
        ]);
        self.rows
            .row("finest", format!("{vertices} vertices, {} triangles", of.triangle_count()))
            .row("coarsest", format!("{} base faces", of.base_face_count()))
            .row("wavelets", format!("{} on {} levels", of.wavelet_count(), of.depth()));
        for level in 0..of.depth() {
            let error = f64::from(error(level));
            self.rows
                .row(&format!("error of level {level}"), error_text(error, percent(error, mesh.diagonal())));
        }
        self.rows.row("bounds", format!("{}, {shape}", bound(mesh)));
    }
}

/// Returns the name of a wavelet mesh's kind of bound.
pub fn bound(mesh: &WaveletMesh) -> &'static str {
    match mesh.options().bound {
        ErrorBound::Conservative => "conservative",
        ErrorBound::WithoutSiblings => "without-siblings",
        _ => "other",
    }
}

/// Describes a level of detail, for JSON.
pub fn counts(vertices: usize, triangles: usize, error: f32, diagonal: f64) -> Value {
    json!({
        "vertices": vertices,
        "triangles": triangles,
        "error": error,
        "error_percent": percent(f64::from(error), diagonal),
    })
}

/// Returns the coarsest level of a model.
pub fn coarsest(model: &Model) -> Extracted {
    model.0.level(Level::Triangles(0))
}
