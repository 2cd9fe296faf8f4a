#![no_main]

use libfuzzer_sys::fuzz_target;
use renderer::load::Format;

#[path = "../src/check.rs"]
mod check;

fuzz_target!(|bytes: &[u8]| check::load(Format::Gltf, bytes));
