//! `cargo +nightly fuzz run --features libfuzzer prefix fuzz/corpus/prefix fuzz/seeds/prefix`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::prefix(data);
});
