//! What a program of a microcontroller takes, read from its file.

use std::fs;
use std::path::Path;

/// Where RAM begins (tests/bare-metal/memory.x).
const RAM: u32 = 0x2000_0000;

/// Bytes of a 32-bit little-endian ELF program.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Code and constants, and the start values of variables.
    pub flash: u32,
    /// Variables.
    pub ram: u32,
}

impl Sizes {
    /// Adds up the program's segments; `None` if the file is no such program.
    pub fn of(path: &Path) -> Option<Sizes> {
        let file = fs::read(path).ok()?;
        let word = |at: usize| {
            file.get(at..)?.first_chunk().map(|bytes: &[u8; 4]| u32::from_le_bytes(*bytes))
        };
        let half = |at: usize| {
            file.get(at..)?.first_chunk().map(|bytes: &[u8; 2]| u16::from_le_bytes(*bytes))
        };
        if !file.starts_with(b"\x7fELF\x01\x01") {
            return None;
        }
        let (table, size, count) = (word(28)? as usize, half(42)?, half(44)?);
        let mut sizes = Sizes { flash: 0, ram: 0 };
        for i in 0..count {
            let header = table + usize::from(i) * usize::from(size);
            let is_loaded = word(header)? == 1;
            if is_loaded {
                let (address, in_file, in_memory) =
                    (word(header + 8)?, word(header + 16)?, word(header + 20)?);
                sizes.flash += in_file;
                sizes.ram += if address >= RAM { in_memory } else { 0 };
            }
        }
        Some(sizes)
    }
}
