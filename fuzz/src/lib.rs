//! `multires` given any bytes, and any choices: no panic, no endless loop, no memory beyond a multiple of the input, and what is promised
//! of whatever comes out.
//!
//! ```text
//! cargo run --release -p multires-fuzz --bin bounded [-- --runs N] [TARGET...]                  any compiler, changes of its own
//! cargo +nightly fuzz run --features libfuzzer TARGET fuzz/corpus/TARGET fuzz/seeds/TARGET      guided by coverage
//! ```
//!
//! | target | what is decoded |
//! |---|---|
//! | [`decoders::baked`] | a baked file of any structure, and an instance of what opens |
//! | [`decoders::store`] | a store and its pages, and an instance flown |
//! | [`decoders::packets`] | messages of a server, at a client |
//! | [`decoders::requests`] | messages of a client, at a session |
//! | [`decoders::prefix`] | a file of which every beginning is a mesh |
//! | [`decoders::documents`] | a GLB file, whole: meshes, poses, levels, and written again |
//! | [`decoders::meshes`] | OBJ, PLY, STL, OFF, GLB and glTF, by the second byte |
//!
//! | target | what is built from a mesh and options that the bytes choose |
//! |---|---|
//! | [`built::simplified`] | levels, of any metric, placement, order and rules |
//! | [`built::structures`] | each structure of a simplification, its bytes, and an instance flown |
//! | [`built::wavelets`] | a mesh subdivided anyhow, its bytes, edits, an atlas, and an instance flown |
//! | [`built::remeshed`] | a remesh of any mesh, and the map there and back |

pub mod built;
pub mod decoders;
mod mend;

/// What is fuzzed, by its name.
pub struct Target {
    /// The name.
    pub name: &'static str,
    /// Runs it. Returns whether some of the data was of use.
    pub run: fn(&[u8]) -> bool,
    /// Whether any bytes are of use; otherwise there are seeds.
    pub is_built: bool,
}

const fn decoder(name: &'static str, run: fn(&[u8]) -> bool) -> Target {
    Target { name, run, is_built: false }
}

const fn built(name: &'static str, run: fn(&[u8]) -> bool) -> Target {
    Target { name, run, is_built: true }
}

/// All targets.
pub const TARGETS: [Target; 11] = [
    decoder("baked", decoders::baked),
    decoder("store", decoders::store),
    decoder("packets", decoders::packets),
    decoder("requests", decoders::requests),
    decoder("prefix", decoders::prefix),
    decoder("meshes", decoders::meshes),
    decoder("documents", decoders::documents),
    built("simplified", built::simplified),
    built("structures", built::structures),
    built("wavelets", built::wavelets),
    built("remeshed", built::remeshed),
];
