//! `cargo +nightly fuzz run --features libfuzzer packets fuzz/corpus/packets fuzz/seeds/packets`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::packets(data);
});
