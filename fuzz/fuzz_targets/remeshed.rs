//! `cargo +nightly fuzz run --features libfuzzer remeshed fuzz/corpus/remeshed`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::built::remeshed(data);
});
