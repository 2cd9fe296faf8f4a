//! What goes wrong with what a user gives.

use std::fmt;

/// An input that cannot be used: a file, a scene or the value of an option. Its text is one line
/// that names the input and says what is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(String);

impl Error {
    /// An error with that text; line breaks and other control characters become spaces.
    #[must_use]
    pub fn new(text: impl fmt::Display) -> Error {
        let text = text.to_string();
        let words = text.split(|c: char| c.is_control()).map(str::trim);
        Error(words.filter(|words| !words.is_empty()).collect::<Vec<_>>().join(" "))
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Error {}
