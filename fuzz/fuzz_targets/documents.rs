//! `cargo +nightly fuzz run --features libfuzzer documents fuzz/corpus/documents fuzz/seeds/documents`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::documents(data);
});
