//! How much a scene file may ask for.

use super::error::Fault;

/// What loading may take. The defaults are generous: they are met by files that would bring the
/// machine down, not by large scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Triangles of the scene, all instances counted. Default 50 million.
    pub max_triangles: u64,
    /// Bytes that loading takes, estimated before they are taken. Default 4 GiB.
    pub max_memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_triangles: 50_000_000, max_memory: 4 << 30 }
    }
}

/// What is used up of the [`Limits`].
pub(super) struct Budget {
    limits: Limits,
    triangles: u64,
    memory: u64,
}

impl Budget {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { limits: *limits, triangles: 0, memory: 0 }
    }

    /// To be called before drawing triangles.
    pub(super) fn triangles(&mut self, count: u64) -> Result<(), Fault> {
        self.triangles = self.triangles.saturating_add(count);
        if self.triangles > self.limits.max_triangles {
            return Err(Fault::TooLarge(format!(
                "the scene has more than {} triangles, the limit (--max-triangles)",
                self.limits.max_triangles
            )));
        }
        Ok(())
    }

    /// To be called before taking memory for `what`.
    pub(super) fn memory(&mut self, bytes: u64, what: &str) -> Result<(), Fault> {
        self.memory = self.memory.saturating_add(bytes);
        if self.memory > self.limits.max_memory {
            return Err(Fault::TooLarge(format!(
                "{what} would need more memory than the limit (--max-memory) of {} MB",
                self.limits.max_memory >> 20
            )));
        }
        Ok(())
    }
}
