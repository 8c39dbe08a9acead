//! `cargo +nightly fuzz run --features libfuzzer baked fuzz/corpus/baked fuzz/seeds/baked`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::baked(data);
});
