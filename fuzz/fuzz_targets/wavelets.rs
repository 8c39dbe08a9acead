//! `cargo +nightly fuzz run --features libfuzzer wavelets fuzz/corpus/wavelets`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    multires_fuzz::built::wavelets(data);
});
