//! The model to be sent: baked from a mesh file, read from a baked file, or made by the crate.

use std::path::Path;

use multires::io;
use multires::mesh::{Mesh, shapes};
use multires::prelude::*;
use multires::stream::{Server, StreamOptions};

use crate::AnyError;

/// Reads a baked `.mres` file, or bakes a mesh file. Without a file, bakes [`shapes::demo`].
///
/// # Errors
/// The file cannot be read or baked; the message names the file.
pub fn open(file: Option<&Path>) -> Result<Baked<VertexHierarchy>, AnyError> {
    let Some(file) = file else { return Ok(VertexHierarchy::bake(&shapes::demo())?) };
    let baked = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mres"));
    // Errors of the operating system name the file already.
    let named = |error: &dyn std::fmt::Display| {
        let (path, error) = (file.display().to_string(), error.to_string());
        if error.starts_with(&path) { error } else { format!("{path}: {error}") }
    };
    if baked {
        return Ok(Baked::read(file).map_err(|error| named(&error))?);
    }
    let mesh = io::read(file).map_err(|error| named(&error))?;
    Ok(VertexHierarchy::bake(&mesh).map_err(|error| named(&error))?)
}

/// Returns the name of a model for captions.
pub fn name(file: Option<&Path>) -> String {
    let name = file.and_then(|file| Some(file.file_stem()?.to_string_lossy().into_owned()));
    name.unwrap_or_else(|| "a sculpture made by the crate".to_owned())
}

/// Prepares a model for sending, with coordinates of `bits` bits.
///
/// # Errors
/// `bits` is not 1 to 31, or a split of the model is too large for a packet.
pub fn server(model: &Baked<VertexHierarchy>, bits: u32) -> Result<Server, AnyError> {
    Ok(Server::new(model, &StreamOptions::default().with_position_bits(Some(bits)))?)
}

/// Returns an instance of a server's model: it draws what a client draws once all packets have come.
///
/// # Errors
/// The model has no instance.
pub fn local(server: &Server) -> Result<impl Lod + use<>, AnyError> {
    let model = server.model();
    let positions = model.vertices().positions();
    Ok(model.instance(model.values(|vertex| positions[vertex]), &LodOptions::default())?)
}

/// Returns all triangles of a server's model, as clients get them.
///
/// # Errors
/// The model has no instance.
pub fn full(server: &Server) -> Result<Mesh, AnyError> {
    let mut lod = local(server)?;
    lod.refine_fully();
    Ok(lod.to_mesh())
}
