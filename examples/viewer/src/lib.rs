//! The reference renderer: what the library's slices become on a graphics card.
//!
//! Uses nothing of `multires` but its public face.
//!
//! | room | what it holds |
//! |---|---|
//! | [`renderer`] | the part to lift into an engine: buffers in step with a level of detail, pipelines, pictures |
//! | [`scene`] | what is drawn: models, instances, built-in scenes, builds in a thread |
//! | [`camera`] | poses, orbit and fly, paths |
//! | [`gpu`] | the graphics card |
//! | `arguments` | what the program is told |
//! | `headless` | pictures and tables without a window |
//! | `window` | the window and its panel |
//!
//! The last three are the program, and need its feature; the others also run in a browser (`examples/web`).
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[cfg(feature = "program")]
pub mod arguments;
pub mod camera;
pub mod gpu;
#[cfg(feature = "program")]
pub mod headless;
pub mod renderer;
pub mod scene;
#[cfg(feature = "program")]
pub mod window;
