//! What can be wrong with a scene file.

use std::fmt::{self, Write as _};
use std::path::PathBuf;

/// Why a scene file was not loaded. Shown as one line that names the file and the fault.
#[derive(Debug)]
pub struct LoadError {
    /// The scene file; empty for [`super::load_bytes`].
    pub path: PathBuf,
    /// What is wrong.
    pub fault: Fault,
}

/// What is wrong with a scene file. Each text is one line, without control characters.
#[derive(Debug)]
#[non_exhaustive]
pub enum Fault {
    /// A file cannot be read.
    Unreadable(String),
    /// The data contradicts its format.
    Malformed(String),
    /// The data needs what this loader does not have, such as an extension; names it.
    Unsupported(String),
    /// The scene is larger than [`super::Limits`] allow; names the limit.
    TooLarge(String),
    /// The file is well formed and holds no triangle that could be seen.
    Empty(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(text)
            | Self::Malformed(text)
            | Self::Unsupported(text)
            | Self::TooLarge(text) => f.write_str(text),
            Self::Empty(text) => write!(f, "nothing to render: {text}"),
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.as_os_str().is_empty() {
            // A path is shown as it is, except that it cannot break the line.
            for c in self.path.to_string_lossy().chars() {
                if c.is_control() { write!(f, "{}", c.escape_debug())? } else { f.write_char(c)? }
            }
            f.write_str(": ")?;
        }
        self.fault.fmt(f)
    }
}

impl std::error::Error for LoadError {}

pub(super) fn malformed(text: impl Into<String>) -> Fault {
    Fault::Malformed(text.into())
}

/// Text of a file as messages may show it: quoted, on one line, not endless.
pub(super) fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    let shown: String = text.chars().take(SHOWN).collect();
    let more = if shown.len() < text.len() { "..." } else { "" };
    format!("\"{}{more}\"", shown.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_on_one_line() {
        let error = LoadError { path: "a\nb'.obj".into(), fault: malformed("broken") };
        assert_eq!(error.to_string(), "a\\nb'.obj: broken");
    }

    #[test]
    fn names_stay_on_one_line() {
        assert_eq!(quoted("a\nb\u{1b}[31m"), r#""a\nb\u{1b}[31m""#);
        assert_eq!(quoted(&"ä".repeat(1000)).chars().count(), 65);
    }
}
