//! [`GltfDocument`]: reading, meshes out, meshes in.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use glam::DMat4;
use serde_json::Value;

use crate::io::error::{ReadError, WriteError};
use crate::io::gltf::accessor::Store;
use crate::io::gltf::document::Document;
use crate::io::gltf::plan::{Plan, is_surface};
use crate::io::gltf::primitives::{Builder, Ids};
use crate::io::gltf::semantics::{attribute, attributes, displacement};
use crate::io::gltf::{container, decoded, document, extensions};
use crate::io::{Format, Imported, ReadOptions, SceneOrigin};
use crate::mesh::Mesh;

use super::encode::{Encoded, Layout, Source};
use super::rig::Rig;
use super::sections::{Elements, Sections, elements, indices, value};

/// A glTF file, whole: meshes can be taken out, changed and put back; nodes, skins, animations, materials, pictures,
/// cameras, lights, variants, extras and extensions stay as they are.
///
/// A mesh is in its own space, with the values of the file: what is put back unchanged is written bit for bit. Besides
/// the attributes of [`read`](crate::io::read()) it has those of its morph targets: [`names::DISPLACEMENT`] and its sets are
/// the offsets of positions, `displacement.NORMAL` and the like those of other attributes. Its material ids are indices of
/// its primitives. Points and lines are no part of it, and stay. A mesh used by several nodes is one mesh.
///
/// Files compressed by `EXT_meshopt_compression`, `KHR_meshopt_compression` or, with the feature `draco`,
/// `KHR_draco_mesh_compression` are read, and written uncompressed. Files with an extension that is required and not known are
/// refused, by its name.
///
/// [`names::DISPLACEMENT`]: crate::mesh::names::DISPLACEMENT
///
/// ```
/// use multires::io::{Format, GltfDocument, write_bytes};
/// use multires::{Simplifier, Target, mesh::shapes};
///
/// let file = write_bytes(Format::Glb, &shapes::demo())?; // or GltfDocument::read("hero.glb")
/// let mut document = GltfDocument::from_bytes(&file)?;
/// for i in 0..document.mesh_count() {
///     let Some(mesh) = document.mesh(i)? else { continue }; // points and lines
///     let sequence = Simplifier::new().target(Target::Ratio(0.5)).run(&mesh.mesh)?;
///     document.replace(i, &sequence.extract(&mesh.mesh, sequence.len()))?;
/// }
/// let lighter = document.to_glb()?;
/// assert!(lighter.len() < file.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct GltfDocument {
    pub(super) sections: Sections,
    pub(super) document: Document,
    /// The meshes as text, and their names.
    pub(super) meshes: Elements,
    names: Vec<String>,
    pub(super) buffers: Vec<Cow<'static, [u8]>>,
    /// Where files beside the document lie.
    pub(super) directory: Option<PathBuf>,
    /// Bytes of the file.
    bytes: usize,
    pub(super) rig: Rig,
    /// Views of streams that were decoded.
    pub(super) streams: BTreeSet<usize>,
    pub(super) replaced: BTreeMap<usize, Encoded>,
    /// Meshes behind the document's own.
    pub(super) added: Vec<Added>,
    pub(super) notes: Vec<String>,
    /// Extensions of primitives that were left out.
    pub(super) dropped: BTreeSet<String>,
}

/// A mesh added for a level of detail.
#[derive(Debug, Clone)]
pub(super) struct Added {
    /// The document's mesh that it is a level of.
    pub of: usize,
    /// Number of the level, from 1.
    pub level: usize,
    /// Share of the screen's height below which it is drawn.
    pub coverage: f64,
    pub encoded: Encoded,
}

impl GltfDocument {
    /// Reads a .gltf or .glb file. Buffers may lie beside it; pictures are not opened.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        if !matches!(Format::from_path(path), Some(Format::Glb | Format::Gltf)) {
            return Err(ReadError::UnknownFormat { path: path.to_owned() });
        }
        let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::open(&bytes, Some(folder))
    }

    /// Reads a document whose buffers are embedded.
    ///
    /// # Errors
    /// See [`ReadError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReadError> {
        Self::open(bytes, None)
    }

    fn open(bytes: &[u8], directory: Option<&Path>) -> Result<Self, ReadError> {
        let (json, chunk) = document::open(bytes)?;
        let mut document = document::parse(json)?;
        let mut sections = Sections::parse(json)?;
        let mut buffers = container::buffers(&document, chunk, directory)?;
        let decoded = decoded::decode(json, &mut document, &mut buffers, bytes.len())?;
        let buffers: Vec<Cow<'static, [u8]>> =
            buffers.into_iter().map(|bytes| Cow::Owned(bytes.into_owned())).collect();
        let store = Store::new(&document, &buffers);
        sections.set_decoded(&document, &decoded);
        sections.mend_bounds(&store, &decoded.filtered);
        let rig = Rig::new(&store, &sections)?;
        let meshes = sections.array("meshes");
        let name = |text| value(text).get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        Ok(Self {
            names: meshes.iter().map(|text| name(text)).collect(),
            meshes,
            sections,
            document,
            buffers,
            directory: directory.map(Path::to_owned),
            bytes: bytes.len(),
            rig,
            streams: decoded.streams,
            replaced: BTreeMap::new(),
            added: Vec::new(),
            notes: Vec::new(),
            dropped: BTreeSet::new(),
        })
    }

    /// Returns the number of meshes.
    pub fn mesh_count(&self) -> usize {
        self.document.meshes.len()
    }

    /// Returns the name of a mesh; empty if it has none.
    pub fn mesh_name(&self, mesh: usize) -> &str {
        self.names.get(mesh).map_or("", String::as_str)
    }

    /// Returns the largest length that 1 unit of a mesh has in the scenes, over all nodes that show it; of a skinned mesh in
    /// the pose of the document, over the joints that move its vertices. 1 for meshes that no node shows. O(nodes), and
    /// O(vertices) if skinned.
    pub fn mesh_scale(&self, mesh: usize) -> f64 {
        if mesh >= self.mesh_count() {
            return 1.0;
        }
        let scale = self.rig.scale(&self.store(), mesh);
        if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }
    }

    /// Returns the lines about what was left out when meshes were replaced.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    pub(super) fn store(&self) -> Store<'_> {
        Store::new(&self.document, &self.buffers)
    }

    fn check(&self, mesh: usize) -> Result<(), ReadError> {
        let count = self.mesh_count();
        if mesh < count {
            return Ok(());
        }
        Err(ReadError::invalid(format!("mesh {mesh} is asked for, but there are {count}")))
    }

    /// Returns a mesh as it was read; `None` if it has no triangles in the file, but points or lines.
    ///
    /// # Errors
    /// See [`ReadError`]; also for an index that is not below [`mesh_count`](Self::mesh_count).
    pub fn mesh(&self, mesh: usize) -> Result<Option<Imported>, ReadError> {
        self.check(mesh)?;
        let store = self.store();
        if !self.document.meshes[mesh].primitives.iter().any(is_surface) {
            return Ok(None);
        }
        let targets = self.targets(mesh);
        let targets = |_: usize, primitive: usize| targets.get(primitive).cloned().unwrap_or_default();
        let mut builder =
            Builder::new(&store, &BTreeSet::from([mesh]), &targets, Ids::Primitive, self.bytes)?;
        builder.add(mesh, DMat4::IDENTITY)?;
        let (mut draft, _) = builder.finish();
        draft.material_names.clear();
        draft.finish(&ReadOptions::default().with_origin(SceneOrigin::Keep)).map(Some)
    }

    /// Returns the accessors of all morph targets, primitive by primitive.
    fn targets(&self, mesh: usize) -> Vec<Vec<BTreeMap<String, usize>>> {
        let json = self.mesh_value(mesh);
        let primitives = elements(json.get("primitives")).iter();
        let of =
            |target: &Value| indices(Some(target)).map(|(name, index)| (name.to_owned(), index)).collect();
        primitives.map(|p| elements(p.get("targets")).iter().map(of).collect()).collect()
    }

    pub(super) fn mesh_value(&self, mesh: usize) -> Value {
        self.meshes.get(mesh).map_or(Value::Null, |text| value(text))
    }

    /// Puts a mesh in the place of another: a level of what [`mesh`](Self::mesh) returned. Attributes that it lacks are left
    /// out, and so are primitives without triangles.
    ///
    /// # Errors
    /// [`WriteError::Unsupported`] for a mesh without triangles, and for material ids that are no indices of surfaces.
    pub fn replace(&mut self, mesh: usize, level: &Mesh) -> Result<(), WriteError> {
        let encoded = self.encode(mesh, level)?;
        self.replaced.insert(mesh, encoded);
        Ok(())
    }

    /// Encodes a level of a mesh; notes what is left out.
    pub(super) fn encode(&mut self, mesh: usize, level: &Mesh) -> Result<Encoded, WriteError> {
        let refused = |error: ReadError| WriteError::Unsupported { format: "glTF", what: error.to_string() };
        self.check(mesh).map_err(refused)?;
        let layouts = self.layouts(mesh).map_err(refused)?;
        let encoded = Encoded::new(level, &layouts)?;
        let json = self.mesh_value(mesh);
        for (p, primitive) in elements(json.get("primitives")).iter().enumerate() {
            if !layouts.iter().any(|layout| layout.primitive == p) {
                continue;
            }
            if !encoded.primitives.iter().any(|e| e.primitive == p) {
                self.note(format!("mesh {mesh}: primitive {p} has no triangles left, and is left out"));
            }
            for name in
                primitive.get("extensions").and_then(Value::as_object).into_iter().flat_map(|e| e.keys())
            {
                if !extensions::survives(name) && !extensions::COMPRESSED.contains(&name.as_str()) {
                    self.dropped.insert(name.clone());
                    self.note(format!(
                        "mesh {mesh}: the extension {name} of a primitive speaks of vertices, and is left out"
                    ));
                }
            }
            for (name, _) in indices(primitive.get("attributes")) {
                let known = layouts.iter().filter(|l| l.primitive == p).flat_map(|l| &l.attributes);
                if known.clone().all(|(semantic, _)| semantic != name) {
                    self.note(format!(
                        "mesh {mesh}: {name} is no attribute that glTF knows, and is left out"
                    ));
                }
            }
        }
        Ok(encoded)
    }

    pub(super) fn note(&mut self, note: String) {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Returns the surfaces of a mesh, with the types and accessors of their attributes.
    fn layouts(&self, mesh: usize) -> Result<Vec<Layout>, ReadError> {
        let store = self.store();
        let targets = self.targets(mesh);
        let of = |_: usize, primitive: usize| targets.get(primitive).cloned().unwrap_or_default();
        let plan = Plan::new(&store, &BTreeSet::from([mesh]), &of)?;
        let mut layouts = Vec::new();
        for (p, primitive) in self.document.meshes[mesh].primitives.iter().enumerate() {
            let Some(Some(part)) = plan.meshes[&mesh].primitives.get(p) else { continue };
            let source = |name: Option<String>, old: usize| -> Result<Source, ReadError> {
                let is_sparse = store.accessor(old)?.buffer_view.is_none();
                Ok(Source { name, old, shape: store.shape(old)?, is_sparse })
            };
            let mut list = vec![("POSITION".to_owned(), source(None, part.position)?)];
            for (semantic, accessor) in attributes(primitive) {
                let Some((name, ..)) = attribute(semantic, store.shape(accessor)?) else { continue };
                list.push((semantic.to_string(), source(Some(name), accessor)?));
            }
            let mut displaced = Vec::new();
            for (t, target) in targets.get(p).into_iter().flatten().enumerate() {
                let target = target.iter().map(|(semantic, &accessor)| {
                    Ok((semantic.clone(), source(Some(displacement(t, semantic)), accessor)?))
                });
                displaced.push(target.collect::<Result<Vec<_>, ReadError>>()?);
            }
            let shape = primitive.indices.map(|i| store.shape(i.value())).transpose()?;
            layouts.push(Layout {
                primitive: p,
                first_like: plan.meshes[&mesh].first_like[p],
                attributes: list,
                targets: displaced,
                indices: primitive.indices.map(|i| i.value()).zip(shape),
            });
        }
        Ok(layouts)
    }
}
