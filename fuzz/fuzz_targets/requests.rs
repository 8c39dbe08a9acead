//! `cargo +nightly fuzz run --features libfuzzer requests fuzz/corpus/requests fuzz/seeds/requests`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::decoders::requests(data);
});
