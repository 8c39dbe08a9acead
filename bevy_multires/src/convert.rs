//! Meshes of Bevy as meshes of multires and back, bit for bit.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_multires::convert::{from_bevy, to_bevy};
//! use multires::mesh::shapes;
//!
//! let sphere = Mesh::from(Sphere::new(1.0)); // normals, texture coordinates, 32-bit indices
//! let (mesh, layout) = from_bevy(&sphere)?;
//! assert!(mesh.attribute("normal").is_some());
//! assert_eq!(layout.to_bevy(&mesh)?, sphere);
//!
//! let rock = to_bevy(&shapes::rock(500, 1))?; // a mesh that never was Bevy's
//! assert!(rock.indices().is_some());
//! # Ok::<(), bevy_multires::ConvertError>(())
//! ```
//!
//! | Bevy | multires |
//! |---|---|
//! | `ATTRIBUTE_POSITION` | positions |
//! | `ATTRIBUTE_NORMAL`, `_TANGENT`, `_COLOR` | `normal`, `tangent`, `color` |
//! | `ATTRIBUTE_UV_0`, `_UV_1` | `uv`, `uv1` |
//! | `ATTRIBUTE_JOINT_INDEX`, `_JOINT_WEIGHT` | `joints`, `weights` |
//! | any other attribute | its name; with `#` and its number behind where the name is taken |
//! | morph target `k`: positions | `displacement`, `displacement1`, ... |
//! | morph target `k`: normals and tangents, if there are any | `morph`, `morph1`, ... |

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use bevy::asset::RenderAssetUsages;
use bevy::math::bounding::Aabb3d;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::skinning::SkinnedMeshBounds;
use bevy::mesh::{
    Indices, Mesh as BevyMesh, MeshAccessError, MeshVertexAttribute, PrimitiveTopology,
    VertexAttributeValues, VertexFormat,
};
use multires::mesh::{Attribute, AttributeValues, Mesh, names};

use crate::format;

/// Why a mesh cannot be converted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// The mesh is no triangle list.
    #[error("the mesh is a {found:?}, and not a TriangleList")]
    Topology {
        /// The topology found.
        found: PrimitiveTopology,
    },
    /// The mesh has no positions.
    #[error("the mesh has no positions")]
    NoPositions,
    /// Positions are not three 32-bit floats.
    #[error("positions are {found:?}, and not Float32x3")]
    PositionFormat {
        /// The format found.
        found: VertexFormat,
    },
    /// The data of the mesh went to the render world: its `asset_usage` lacks `MAIN_WORLD`.
    #[error("the mesh is in the render world alone; give it RenderAssetUsages::default()")]
    Extracted,
    /// An attribute has not one value a vertex.
    #[error("{name} has {found} values for {vertices} vertices")]
    Length {
        /// Name of the attribute.
        name: String,
        /// Number of values.
        found: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The number of morph attributes is no multiple of the number of vertices.
    #[error("{found} morph attributes are no multiple of {vertices} vertices")]
    MorphTargets {
        /// Number of morph attributes.
        found: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// The number of indices, or of vertices without indices, is no multiple of 3.
    #[error("{found} corners are no multiple of 3")]
    Corners {
        /// Number of corners.
        found: usize,
    },
    /// A layout names an attribute that the mesh lacks.
    #[error("the mesh has no attribute {name}")]
    Missing {
        /// Name of the attribute.
        name: String,
    },
    /// Values of an attribute do not fit Bevy's format.
    #[error("the values of {name} do not fit {format:?}")]
    Values {
        /// Name of the attribute.
        name: String,
        /// Bevy's format.
        format: VertexFormat,
    },
    /// Bevy has no format with so many scalars a vertex.
    #[error("{name} has {width} scalars a vertex; Bevy takes at most 4")]
    Width {
        /// Name of the attribute.
        name: String,
        /// Scalars a vertex.
        width: usize,
    },
    /// multires refuses the arrays.
    #[error(transparent)]
    Mesh(#[from] multires::MeshError),
}

impl From<MeshAccessError> for ConvertError {
    fn from(_: MeshAccessError) -> Self {
        Self::Extracted
    }
}

/// What a Bevy mesh holds besides numbers: its attributes, the width of its indices, its usages. Takes a mesh with the same
/// attributes back to Bevy, such as a level of detail.
#[derive(Debug, Clone)]
pub struct Layout {
    attributes: Vec<(MeshVertexAttribute, String)>,
    indices: Width,
    /// Number of morph targets; `None` if the mesh holds no morph attributes.
    morph_targets: Option<usize>,
    morph_names: Option<Vec<String>>,
    rest: Rest,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Width {
    /// Three vertices in sequence are a triangle.
    None,
    Short,
    Long,
}

/// Fields of a Bevy mesh that do not depend on its vertices.
#[derive(Debug, Clone)]
struct Rest {
    usage: RenderAssetUsages,
    raytracing: bool,
    aabb: Option<Aabb3d>,
    skin: Option<SkinnedMeshBounds>,
}

impl Rest {
    fn of(mesh: &BevyMesh) -> Self {
        Self {
            usage: mesh.asset_usage,
            raytracing: mesh.enable_raytracing,
            aabb: mesh.final_aabb,
            skin: mesh.skinned_mesh_bounds().cloned(),
        }
    }

    fn mesh(&self) -> BevyMesh {
        let mut mesh = BevyMesh::new(PrimitiveTopology::TriangleList, self.usage);
        mesh.enable_raytracing = self.raytracing;
        mesh.final_aabb = self.aabb;
        mesh.set_skinned_mesh_bounds(self.skin.clone());
        mesh
    }
}

/// Bevy's attributes with customary names in multires.
const CUSTOMARY: [(MeshVertexAttribute, &str); 7] = [
    (BevyMesh::ATTRIBUTE_NORMAL, names::NORMAL),
    (BevyMesh::ATTRIBUTE_UV_0, names::UV),
    (BevyMesh::ATTRIBUTE_UV_1, "uv1"),
    (BevyMesh::ATTRIBUTE_TANGENT, names::TANGENT),
    (BevyMesh::ATTRIBUTE_COLOR, names::COLOR),
    (BevyMesh::ATTRIBUTE_JOINT_INDEX, names::JOINTS),
    (BevyMesh::ATTRIBUTE_JOINT_WEIGHT, names::WEIGHTS),
];

/// Name of what a morph target does to normals and tangents.
const MORPH: &str = "morph";
/// Scalars of [`MorphAttributes`] besides the position.
const MORPH_REST: usize = 9;

/// Returns the name of a set of an attribute: `uv`, `uv1`, `uv2`.
fn set_of(first: &str, at: usize) -> String {
    if at == 0 { first.to_owned() } else { format!("{first}{at}") }
}

/// Returns a Bevy mesh as a mesh of multires, and the layout that takes it back ([`Layout::to_bevy`]). All attributes come along.
/// O(n).
///
/// # Errors
/// The mesh is no triangle list, has no positions, went to the render world, or has arrays of different lengths; or multires refuses
/// it: positions that are not finite, indices without a vertex.
pub fn from_bevy(mesh: &BevyMesh) -> Result<(Mesh, Layout), ConvertError> {
    let positions = positions(mesh)?;
    let vertices = positions.len();
    let (triangles, indices) = triangles(mesh, vertices)?;
    let mut out = Mesh::new(positions, triangles)?;

    let mut attributes = Vec::new();
    for (attribute, values) in mesh.try_attributes()? {
        check_length(attribute.name, values.len(), vertices)?;
        if attribute.id == BevyMesh::ATTRIBUTE_POSITION.id {
            continue;
        }
        let name = name_of(&out, attribute);
        let (width, scalars) = format::encode(values);
        out = out.with_attribute(Attribute::new(name.clone(), width, scalars))?;
        attributes.push((*attribute, name));
    }
    let morph_targets = match mesh.try_morph_targets() {
        Ok(targets) => {
            if !targets.len().is_multiple_of(vertices.max(1)) {
                return Err(ConvertError::MorphTargets { found: targets.len(), vertices });
            }
            for (at, target) in targets.chunks_exact(vertices.max(1)).enumerate() {
                out = with_morph_target(out, at, target)?;
            }
            Some(targets.len() / vertices.max(1))
        }
        Err(MeshAccessError::ExtractedToRenderWorld) => return Err(ConvertError::Extracted),
        Err(_) => None,
    };
    let morph_names = mesh.try_morph_target_names()?.map(<[String]>::to_vec);
    Ok((out, Layout { attributes, indices, morph_targets, morph_names, rest: Rest::of(mesh) }))
}

fn check_length(name: &str, found: usize, vertices: usize) -> Result<(), ConvertError> {
    if found == vertices {
        Ok(())
    } else {
        Err(ConvertError::Length { name: name.to_owned(), found, vertices })
    }
}

fn positions(mesh: &BevyMesh) -> Result<&[[f32; 3]], ConvertError> {
    match mesh.try_attribute_option(BevyMesh::ATTRIBUTE_POSITION)? {
        Some(VertexAttributeValues::Float32x3(positions)) => Ok(positions),
        Some(others) => Err(ConvertError::PositionFormat { found: others.into() }),
        None => Err(ConvertError::NoPositions),
    }
}

fn triangles(mesh: &BevyMesh, vertices: usize) -> Result<(Vec<[u32; 3]>, Width), ConvertError> {
    let topology = mesh.primitive_topology();
    if topology != PrimitiveTopology::TriangleList {
        return Err(ConvertError::Topology { found: topology });
    }
    let indices = mesh.try_indices_option()?;
    let corners = indices.map_or(vertices, Indices::len);
    if !corners.is_multiple_of(3) {
        return Err(ConvertError::Corners { found: corners });
    }
    Ok(match indices {
        None => {
            ((0..corners as u32).step_by(3).map(|first| [first, first + 1, first + 2]).collect(), Width::None)
        }
        Some(Indices::U16(indices)) => {
            (indices.as_chunks::<3>().0.iter().map(|corners| corners.map(u32::from)).collect(), Width::Short)
        }
        Some(Indices::U32(indices)) => (indices.as_chunks::<3>().0.to_vec(), Width::Long),
    })
}

/// Returns the name of a Bevy attribute in multires, free in `mesh`.
fn name_of(mesh: &Mesh, attribute: &MeshVertexAttribute) -> String {
    if let Some((_, name)) = CUSTOMARY.iter().find(|(customary, _)| customary.id == attribute.id) {
        return (*name).to_owned();
    }
    let name = attribute.name;
    // Names with a meaning in multires stay free for what they mean.
    let meant = [names::VERTEX, names::DISPLACEMENT, MORPH].iter().any(|first| names::is_set_of(name, first))
        || CUSTOMARY.iter().any(|(_, customary)| *customary == name);
    if !meant && mesh.attribute(name).is_none() {
        return name.to_owned();
    }
    let number: String = format!("{:?}", attribute.id).chars().filter(char::is_ascii_digit).collect();
    format!("{name}#{number}")
}

fn with_morph_target(mesh: Mesh, at: usize, target: &[MorphAttributes]) -> Result<Mesh, ConvertError> {
    let moved: Vec<[f32; 3]> = target.iter().map(|vertex| vertex.position.to_array()).collect();
    let rest = |vertex: &MorphAttributes| -> [f32; MORPH_REST] {
        let MorphAttributes { pad_a, normal, pad_b, tangent, pad_c, .. } = *vertex;
        let ([a, b, c], [d, e, f]) = (normal.to_array(), tangent.to_array());
        [pad_a, a, b, c, pad_b, d, e, f, pad_c]
    };
    let mesh = mesh.with_attribute(Attribute::floats(set_of(names::DISPLACEMENT, at), &moved))?;
    if target.iter().all(|vertex| rest(vertex).iter().all(|x| x.to_bits() == 0)) {
        return Ok(mesh);
    }
    Ok(mesh.with_attribute(Attribute::of(set_of(MORPH, at), target, rest))?)
}

impl Layout {
    /// Returns a mesh as a Bevy mesh of this layout. Indices have 16 bits if they had them and still fit, and there are none if there
    /// were none and the triangles are still in sequence. O(n).
    ///
    /// Attributes of multires that this layout does not name stay behind, as do materials, locks and the origin: a Bevy mesh has one
    /// material.
    ///
    /// # Errors
    /// The mesh lacks an attribute of the layout, or has it with another width, another type or integers too large for Bevy's format.
    pub fn to_bevy(&self, mesh: &Mesh) -> Result<BevyMesh, ConvertError> {
        let mut out = self.rest.mesh();
        out.try_insert_attribute(BevyMesh::ATTRIBUTE_POSITION, mesh.positions().to_vec())?;
        for (attribute, name) in &self.attributes {
            let MeshVertexAttribute { format, .. } = *attribute;
            let values = mesh.attribute(name).ok_or_else(|| ConvertError::Missing { name: name.clone() })?;
            let values = format::decode(format, values.width(), values.values())
                .ok_or_else(|| ConvertError::Values { name: name.clone(), format })?;
            out.try_insert_attribute(*attribute, values)?;
        }
        if let Some(targets) = self.morph_targets {
            let mut all = Vec::with_capacity(targets * mesh.positions().len());
            for at in 0..targets {
                morph_target(mesh, at, &mut all)?;
            }
            out.try_set_morph_targets(all)?;
        }
        if let Some(names) = &self.morph_names {
            out.try_set_morph_target_names(names.clone())?;
        }
        let in_sequence = || mesh.indices().iter().zip(0..).all(|(&index, at)| index == at);
        if self.indices != Width::None || mesh.indices().len() != mesh.positions().len() || !in_sequence() {
            let short = self.indices == Width::Short;
            out.try_insert_indices(indices(mesh.indices(), short))?;
        }
        Ok(out)
    }
}

/// Returns indices with 16 bits, if so wished and all fit.
pub(crate) fn indices(indices: &[u32], short: bool) -> Indices {
    let narrow = |&index: &u32| u16::try_from(index).ok();
    match short.then(|| indices.iter().map(narrow).collect()).flatten() {
        Some(short) => Indices::U16(short),
        None => Indices::U32(indices.to_vec()),
    }
}

/// Appends a morph target.
fn morph_target(mesh: &Mesh, at: usize, all: &mut Vec<MorphAttributes>) -> Result<(), ConvertError> {
    let rows = |name: &str, width: usize| {
        let Some(attribute) = mesh.attribute(name) else { return Ok(None) };
        let wrong = || ConvertError::Values { name: name.to_owned(), format: VertexFormat::Float32x3 };
        attribute.as_floats().filter(|_| attribute.width() == width).map(Some).ok_or_else(wrong)
    };
    let name = set_of(names::DISPLACEMENT, at);
    let moved = rows(&name, 3)?.ok_or(ConvertError::Missing { name })?.as_chunks::<3>().0;
    let rest = rows(&set_of(MORPH, at), MORPH_REST)?.map(|rest| rest.as_chunks::<MORPH_REST>().0);
    all.extend(moved.iter().enumerate().map(|(vertex, &position)| {
        let [pad_a, a, b, c, pad_b, d, e, f, pad_c] = rest.map_or([0.0; MORPH_REST], |rest| rest[vertex]);
        let (position, normal, tangent) = (position.into(), [a, b, c].into(), [d, e, f].into());
        MorphAttributes { position, pad_a, normal, pad_b, tangent, pad_c }
    }));
    Ok(())
}

/// Returns a mesh of multires as a Bevy mesh. Customary attributes become Bevy's own, displacements become morph targets, all others
/// attributes of their names. Indices have 16 bits if they fit. O(n).
///
/// Materials, locks and the origin stay behind: a Bevy mesh has one material ([`by_material`] makes one mesh for each).
/// Colours without alpha get alpha 1. The names of other attributes are kept for the life of the program, each once, because
/// Bevy's names are `'static`.
///
/// # Errors
/// An attribute has more than 4 scalars a vertex, or one of Bevy's own does not fit Bevy's format: joints above 65,535.
pub fn to_bevy(mesh: &Mesh) -> Result<BevyMesh, ConvertError> {
    let usage = RenderAssetUsages::default();
    let mut out = Rest { usage, raytracing: true, aabb: None, skin: None }.mesh();
    out.try_insert_attribute(BevyMesh::ATTRIBUTE_POSITION, mesh.positions().to_vec())?;
    for attribute in mesh.attributes() {
        let name = attribute.name();
        if [names::VERTEX, MORPH, names::DISPLACEMENT].iter().any(|first| names::is_set_of(name, first)) {
            continue;
        }
        let (bevy, values) = bevy_attribute(attribute)?;
        out.try_insert_attribute(bevy, values)?;
    }
    let targets = (0..).take_while(|&at| mesh.attribute(&set_of(names::DISPLACEMENT, at)).is_some()).count();
    if targets > 0 {
        let mut all = Vec::with_capacity(targets * mesh.positions().len());
        (0..targets).try_for_each(|at| morph_target(mesh, at, &mut all))?;
        out.try_set_morph_targets(all)?;
    }
    out.try_insert_indices(indices(mesh.indices(), true))?;
    Ok(out)
}

/// Returns a Bevy mesh for each material of a mesh, with the material's id, ascending; a single mesh with id `u32::MAX` if the mesh has
/// no materials. Each holds the vertices that it uses. O(n) for each material.
///
/// # Errors
/// As [`to_bevy`].
pub fn by_material(mesh: &Mesh) -> Result<Vec<(u32, BevyMesh)>, ConvertError> {
    let all = to_bevy(mesh)?;
    if mesh.materials().is_empty() {
        return Ok(vec![(u32::MAX, all)]);
    }
    let mut ids = mesh.materials().to_vec();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter().map(|id| Ok((id, material(mesh, &all, id)?))).collect()
}

/// Returns the triangles of a material, with the vertices that they use. `all` is the mesh as a Bevy mesh.
pub(crate) fn material(mesh: &Mesh, all: &BevyMesh, id: u32) -> Result<BevyMesh, ConvertError> {
    let triangles = mesh.triangles().iter().zip(mesh.materials()).filter(|(_, material)| **material == id);
    let mut number = vec![u32::MAX; mesh.positions().len()];
    let mut order = Vec::new();
    let mut corners = Vec::new();
    for &corner in triangles.flat_map(|(triangle, _)| triangle) {
        let number = &mut number[corner as usize];
        if *number == u32::MAX {
            *number = order.len() as u32;
            order.push(corner);
        }
        corners.push(*number);
    }
    let mut out = gather(all, &order)?;
    out.try_insert_indices(indices(&corners, true))?;
    Ok(out)
}

/// Returns Bevy's attribute for one of multires, with the values.
fn bevy_attribute(
    attribute: &Attribute,
) -> Result<(MeshVertexAttribute, VertexAttributeValues), ConvertError> {
    let (name, width) = (attribute.name(), attribute.width());
    let own = CUSTOMARY.iter().find(|(_, customary)| *customary == name).map(|(own, _)| *own);
    if name == names::COLOR
        && width == 3
        && let (Some(own), Some(rgb)) = (own, attribute.as_floats())
    {
        let rgba: Vec<[f32; 4]> = rgb.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        return Ok((own, rgba.into()));
    }
    let bevy = match own {
        Some(own) => own,
        None => custom(attribute)?,
    };
    let values = format::decode(bevy.format, width, attribute.values());
    Ok((bevy, values.ok_or_else(|| ConvertError::Values { name: name.to_owned(), format: bevy.format })?))
}

/// Returns an attribute of an application's own, numbered by its name.
fn custom(attribute: &Attribute) -> Result<MeshVertexAttribute, ConvertError> {
    let (name, width) = (attribute.name(), attribute.width());
    let formats = match attribute.values() {
        AttributeValues::Float(_) => {
            [VertexFormat::Float32, VertexFormat::Float32x2, VertexFormat::Float32x3, VertexFormat::Float32x4]
        }
        AttributeValues::Int(_) => {
            [VertexFormat::Sint32, VertexFormat::Sint32x2, VertexFormat::Sint32x3, VertexFormat::Sint32x4]
        }
        _ => [VertexFormat::Uint32, VertexFormat::Uint32x2, VertexFormat::Uint32x3, VertexFormat::Uint32x4],
    };
    let format = width.checked_sub(1).and_then(|at| formats.get(at));
    let &format = format.ok_or_else(|| ConvertError::Width { name: name.to_owned(), width })?;
    // FNV-1a, with the highest bit set: apart from Bevy's own numbers, and the same in every run.
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    Ok(MeshVertexAttribute::new(kept(name), hash | 1 << 63, format))
}

/// Returns a name for the life of the program. Each name is kept once.
fn kept(name: &str) -> &'static str {
    static NAMES: Mutex<BTreeMap<String, &'static str>> = Mutex::new(BTreeMap::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    names.entry(name.to_owned()).or_insert_with(|| name.to_owned().leak())
}

/// Returns the vertices in `order` with all attributes and morph targets, without indices. Vertices may repeat. O(output).
///
/// # Errors
/// The mesh went to the render world, or an array is shorter than a number in `order`.
pub(crate) fn gather(mesh: &BevyMesh, order: &[u32]) -> Result<BevyMesh, ConvertError> {
    let mut out = Rest::of(mesh).mesh();
    let vertices = positions(mesh)?.len();
    for (attribute, values) in mesh.try_attributes()? {
        let short =
            || ConvertError::Length { name: attribute.name.to_owned(), found: values.len(), vertices };
        out.try_insert_attribute(*attribute, format::gather(values, order).ok_or_else(short)?)?;
    }
    if let Ok(targets) = mesh.try_morph_targets() {
        let picked = targets.chunks_exact(vertices.max(1)).flat_map(|target| {
            order.iter().map(|&vertex| target.get(vertex as usize).copied().unwrap_or_default())
        });
        out.try_set_morph_targets(picked.collect())?;
    }
    if let Some(names) = mesh.try_morph_target_names()? {
        out.try_set_morph_target_names(names.to_vec())?;
    }
    Ok(out)
}

/// Holds if the indices of a mesh have 16 bits.
pub(crate) fn is_short(mesh: &BevyMesh) -> bool {
    matches!(mesh.try_indices_option(), Ok(Some(Indices::U16(_))))
}
