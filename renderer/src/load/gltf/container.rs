//! The binary container `.glb`: a header and two chunks.

use super::super::error::{Fault, malformed};

/// The parts of a glTF file.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    /// The first buffer of a `.glb` file.
    pub(super) binary: Option<&'a [u8]>,
}

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// Splits a file by its content: one that does not start like a `.glb` is all JSON.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, Fault> {
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if !json.trim_ascii_start().starts_with(b"{") {
            return Err(malformed("neither a .glb file (wrong magic) nor JSON"));
        }
        return Ok(Container { json, binary: None });
    }
    let [Some(version), Some(length)] = [4, 8].map(|at| word(bytes, at)) else {
        return Err(malformed("the header of the .glb file is cut off"));
    };
    if version != 2 {
        return Err(malformed(format!("version {version} of the .glb container, not 2")));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(malformed(format!(
            "the file is cut off: {} bytes of {length} that its header says",
            bytes.len()
        )));
    }
    let mut rest = &bytes[..length.max(HEADER)][HEADER..];

    let Some((kind, json)) = chunk(&mut rest)? else {
        return Err(malformed("the .glb file has no JSON chunk"));
    };
    if kind != JSON {
        return Err(malformed("the first chunk of the .glb file is not JSON"));
    }
    let mut binary = None;
    while let Some((kind, data)) = chunk(&mut rest)? {
        // Chunks of other kinds belong to extensions.
        if kind == BIN && binary.is_none() {
            binary = Some(data);
        }
    }
    Ok(Container { json, binary })
}

/// Takes the next chunk off `rest`: its kind and its data.
fn chunk<'a>(rest: &mut &'a [u8]) -> Result<Option<(u32, &'a [u8])>, Fault> {
    if rest.is_empty() {
        return Ok(None);
    }
    let [Some(length), Some(kind)] = [0, 4].map(|at| word(rest, at)) else {
        return Err(malformed("the header of a .glb chunk is cut off"));
    };
    let data = &rest[CHUNK_HEADER..];
    let Some((data, after)) = data.split_at_checked(length as usize) else {
        return Err(malformed(format!(
            "a .glb chunk of {length} bytes reaches past the end ({} bytes left)",
            data.len()
        )));
    };
    *rest = after;
    Ok(Some((kind, data)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at + 4)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}
