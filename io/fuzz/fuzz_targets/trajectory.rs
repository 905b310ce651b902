#![no_main]

#[path = "../../scenes/tests/fuzzing/targets.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::target("trajectory")(data));
