//! Scenes by name.

use multires_viewer::scene::Builtin;

/// The built-in scene of that name.
pub(crate) fn builtin(name: &str) -> Option<Builtin> {
    match name {
        "demo" => Some(Builtin::Demo),
        "terrain" => Some(Builtin::Terrain),
        "rocks" => Some(Builtin::Rocks),
        "crowd" => Some(Builtin::Crowd),
        _ => None,
    }
}
