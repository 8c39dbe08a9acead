//! `cargo +nightly fuzz run --features libfuzzer structures fuzz/corpus/structures`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::built::structures(data);
});
