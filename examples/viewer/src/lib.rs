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
//! | [`arguments`] | what the program is told |
//! | [`headless`] | pictures and tables without a window |
//! | [`window`] | the window and its panel |
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod arguments;
pub mod camera;
pub mod gpu;
pub mod headless;
pub mod renderer;
pub mod scene;
pub mod window;
