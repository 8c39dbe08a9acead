//! `cargo +nightly fuzz run --features libfuzzer simplified fuzz/corpus/simplified`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::built::simplified(data);
});
