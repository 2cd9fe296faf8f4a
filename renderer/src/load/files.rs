//! Files beside the scene file, and data inside URIs.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::error::{Fault, malformed, quoted};
use super::limits::Budget;

/// Reads what a scene file refers to: data URIs, and files in the folder of the scene file.
pub(super) struct Files {
    folder: Option<PathBuf>,
}

impl Files {
    /// The files in the folder of `scene_file`.
    pub(super) fn beside(scene_file: &Path) -> Self {
        let folder = match scene_file.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        Self { folder: Some(folder) }
    }

    /// No files, only data URIs.
    pub(super) fn none() -> Self {
        Self { folder: None }
    }

    /// The bytes that a URI of a glTF file means.
    pub(super) fn read_uri(&self, uri: &str, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
        if let Some(rest) = strip_prefix_ignoring_case(uri, "data:") {
            return decode_data_uri(rest, budget);
        }
        let decoded = percent_decode(uri);
        let name = std::str::from_utf8(&decoded)
            .map_err(|_| malformed(format!("the URI {} is not UTF-8", quoted(uri))))?;
        self.read_named(name, budget)
    }

    /// The bytes of the file called `name`, a relative path with forward slashes.
    pub(super) fn read_named(&self, name: &str, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
        let Some(folder) = &self.folder else {
            return Err(Fault::Unreadable(format!("no folder to find {} in", quoted(name))));
        };
        let shown = quoted(name);
        if has_scheme(name) || name.starts_with("//") {
            return Err(malformed(format!("{shown} is remote; only files beside it are read")));
        }
        let relative = Path::new(name);
        let inside = |c| matches!(c, Component::Normal(_) | Component::CurDir);
        let outside = || malformed(format!("{shown} lies outside the folder of the file"));
        if name.contains('\\') || !relative.components().all(inside) {
            return Err(outside());
        }
        // Links may lead out of the folder as well.
        let unreadable = |e| unreadable(&shown, &e);
        let resolved = folder.join(relative).canonicalize().map_err(unreadable)?;
        let folder = folder.canonicalize().map_err(unreadable)?;
        if !resolved.starts_with(&folder) {
            return Err(outside());
        }
        read_regular(&resolved, budget, &shown)
    }
}

/// Reads a file within the budget; `shown` is how messages call it.
pub(super) fn read_regular(
    path: &Path,
    budget: &mut Budget,
    shown: &str,
) -> Result<Vec<u8>, Fault> {
    let unreadable = |e: io::Error| unreadable(shown, &e);
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if !metadata.is_file() {
        return Err(Fault::Unreadable(format!("cannot read {shown}: not a file")));
    }
    budget.memory(metadata.len(), shown)?;
    let mut bytes = Vec::new();
    // A file that grows while it is read is cut at the size that was granted.
    file.take(metadata.len()).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

fn unreadable(shown: &str, error: &io::Error) -> Fault {
    let why = match error.kind() {
        io::ErrorKind::NotFound => "no such file".into(),
        kind => kind.to_string(),
    };
    Fault::Unreadable(format!("cannot read {shown}: {why}"))
}

/// What follows `data:`, as bytes.
fn decode_data_uri(rest: &str, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
    let fault = |what: &str| {
        let shown: String = rest.chars().take(40).collect();
        malformed(format!("{what} in the data URI {}", quoted(&format!("data:{shown}"))))
    };
    let Some((header, data)) = rest.split_once(',') else { return Err(fault("no comma")) };
    let mut parameters: Vec<&str> = header.split(';').collect();
    let base64 = parameters.last().is_some_and(|p| p.eq_ignore_ascii_case("base64"));
    if base64 {
        parameters.pop();
    }
    if parameters.iter().skip(1).any(|p| !p.contains('=')) {
        return Err(fault("malformed media type"));
    }
    budget.memory(data.len() as u64, "a data URI")?;
    let data = if data.contains('%') { percent_decode(data) } else { data.as_bytes().into() };
    if !base64 {
        return Ok(data.into_owned());
    }
    STANDARD.decode(&data).map_err(|_| fault("malformed base64"))
}

/// Replaces `%20` and its like; other percent signs stay.
fn percent_decode(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return text.as_bytes().into();
    }
    let digit = |byte: u8| (byte as char).to_digit(16);
    let bytes = text.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = match bytes[at..] {
            [b'%', high, low, ..] => digit(high).zip(digit(low)),
            _ => None,
        };
        if let Some((high, low)) = code {
            decoded.push((high * 16 + low) as u8);
            at += 3;
        } else {
            decoded.push(bytes[at]);
            at += 1;
        }
    }
    decoded.into()
}

/// `http:`, `file:`, but also `C:`.
fn has_scheme(name: &str) -> bool {
    name.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

fn strip_prefix_ignoring_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let (head, rest) = text.split_at_checked(prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::super::limits::Limits;
    use super::*;

    fn data(rest: &str) -> Result<Vec<u8>, Fault> {
        decode_data_uri(rest, &mut Budget::new(&Limits::default()))
    }

    #[test]
    fn data_uris() {
        assert_eq!(data("application/octet-stream;base64,AQID").unwrap(), [1, 2, 3]);
        assert_eq!(data(";base64,AQID").unwrap(), [1, 2, 3]);
        assert_eq!(data("text/plain;charset=utf-8,a%20b").unwrap(), b"a b");
        for broken in ["", "x;base64", "x;;base64,AQID", "x;base64,AQ", "x;base64,A!ID", "x;y,z"] {
            assert!(data(broken).is_err(), "{broken}");
        }
    }

    #[test]
    fn percent() {
        assert_eq!(&*percent_decode("a%20b%2Fc"), b"a b/c");
        assert_eq!(&*percent_decode("100%"), b"100%");
        assert_eq!(&*percent_decode("%zz%4"), b"%zz%4");
    }

    #[test]
    fn only_inside_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        std::fs::create_dir_all(inner.join("deep")).unwrap();
        std::fs::write(folder.path().join("secret"), b"s").unwrap();
        std::fs::write(inner.join("a b"), b"x").unwrap();
        std::fs::write(inner.join("deep/c"), b"y").unwrap();
        let limits = Limits { max_memory: 100, ..Limits::default() };
        let files = Files::beside(&inner.join("scene.gltf"));
        let read = |uri: &str| files.read_uri(uri, &mut Budget::new(&limits));

        assert_eq!(read("a%20b").unwrap(), b"x");
        assert_eq!(read("./deep/c").unwrap(), b"y");
        let absolute = folder.path().join("secret");
        for outside in [
            "../secret",
            "deep/../../secret",
            "%2e%2e/secret",
            "..\\secret",
            "file:///etc/passwd",
            "http://example.com/x.bin",
            "//example.com/x.bin",
            "C:\\x.bin",
            "C:x.bin",
            "a%00b",
            "",
            ".",
            "deep",
            absolute.to_str().unwrap(),
        ] {
            assert!(read(outside).is_err(), "{outside}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&absolute, inner.join("link")).unwrap();
            assert!(read("link").is_err());
        }
        std::fs::write(inner.join("large"), [0; 101]).unwrap();
        assert!(matches!(read("large"), Err(Fault::TooLarge(_))));
    }
}
