//! `cargo +nightly fuzz run --features libfuzzer meshes fuzz/corpus/meshes fuzz/seeds/meshes`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::meshes(data);
});
