//! The bytes behind buffer views.

use std::borrow::Cow;

use super::super::error::{Fault, malformed};
use super::super::files::Files;
use super::super::limits::Budget;
use super::json::Root;

/// The buffers of a file. Absent are those that exist only compressed.
pub(super) struct Buffers<'a>(Vec<Option<Cow<'a, [u8]>>>);

impl<'a> Buffers<'a> {
    pub(super) fn load(
        root: &Root,
        binary: Option<&'a [u8]>,
        files: &Files,
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let bytes: Cow<'a, [u8]> = match (&buffer.uri, binary) {
                (Some(uri), _) => files.read_uri(uri, budget)?.into(),
                _ if buffer.extensions.is_compressed() => {
                    buffers.push(None);
                    continue;
                }
                (None, Some(binary)) if i == 0 => binary.into(),
                (None, _) => return Err(malformed(format!("buffers[{i}] has no data"))),
            };
            let length = buffer.byte_length;
            if (bytes.len() as u64) < length {
                let n = bytes.len();
                return Err(malformed(format!("buffers[{i}] holds {n} bytes of {length}")));
            }
            buffers.push(Some(bytes));
        }
        Ok(Self(buffers))
    }

    /// The bytes of a buffer view, which was checked to lie inside its buffer.
    pub(super) fn view(&self, root: &Root, index: usize) -> Result<&[u8], Fault> {
        let view = &root.buffer_views[index];
        let Some(bytes) = &self.0[view.buffer] else {
            return Err(Fault::Unsupported(format!(
                "bufferViews[{index}]: its data is compressed with EXT_meshopt_compression"
            )));
        };
        Ok(&bytes[view.byte_offset as usize..][..view.byte_length as usize])
    }
}
