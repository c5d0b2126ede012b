//! Under a fuzzer: the target `scene_xml`. Otherwise: runs it on the files named.
#![cfg_attr(fuzzing, no_main)]

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| spectral_fuzz::scene_xml(bytes));

#[cfg(not(fuzzing))]
fn main() -> std::io::Result<()> {
    spectral_fuzz::replay_arguments(spectral_fuzz::scene_xml)
}
