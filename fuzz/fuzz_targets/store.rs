//! `cargo +nightly fuzz run --features libfuzzer store fuzz/corpus/store fuzz/seeds/store`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::store(data);
});
