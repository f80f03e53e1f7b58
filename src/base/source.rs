//! A source text with its name, and places in it.

use std::path::Path;

/// Largest input file that is read, bytes. A building of ten thousand members takes about a megabyte.
pub const MAX_FILE_BYTES: u64 = 16 * 1024 * 1024;

/// A range of bytes in a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl From<std::ops::Range<usize>> for Span {
    fn from(range: std::ops::Range<usize>) -> Self {
        Self { start: range.start, end: range.end }
    }
}

/// A text with the name it goes by in messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name shown in messages: the path as the user wrote it.
    pub name: String,
    /// The text.
    pub text: String,
}

/// Why a file could not be read as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unreadable {
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

impl Source {
    /// A text with a name.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into() }
    }

    /// Reads a text file.
    pub fn read(path: &Path) -> Result<Self, Unreadable> {
        let problem = |message: &str, remedy: String| Unreadable { message: message.into(), remedy };
        let found = std::fs::metadata(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => problem("there is no such file", remedy_for_missing(path)),
            _ => problem(&format!("the file cannot be read: {error}"), "check its permissions".into()),
        })?;
        if found.is_dir() {
            return Err(problem("this is a directory, not a file", remedy_for_directory(path)));
        }
        if !found.is_file() {
            return Err(problem("this is not a regular file", "give a text file".into()));
        }
        if found.len() > MAX_FILE_BYTES {
            let remedy = format!("the largest input is {} MiB", MAX_FILE_BYTES >> 20);
            return Err(problem("the file is too large", remedy));
        }
        let bytes = std::fs::read(path).map_err(|error| {
            problem(&format!("the file cannot be read: {error}"), "check its permissions".into())
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            let message = format!("this is not a text file: byte {at} is not UTF-8");
            problem(&message, "save it as text in UTF-8".into())
        })?;
        Ok(Self::new(path.display().to_string(), text))
    }

    /// Line and column (in characters) of a byte, both from 1.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let head = &self.text[..self.boundary_before(byte)];
        let line_start = head.rfind('\n').map_or(0, |i| i + 1);
        (head.matches('\n').count() + 1, head[line_start..].chars().count() + 1)
    }

    /// The part of a span on its first line, on character boundaries: what is marked in a message.
    pub fn first_line_of(&self, span: Span) -> Span {
        let start = self.boundary_before(span.start);
        let end = self.boundary_before(span.end.max(start));
        let piece = &self.text[start..end];
        let length = piece.find(['\n', '\r']).unwrap_or(piece.len());
        Span { start, end: start + length }
    }

    fn boundary_before(&self, byte: usize) -> usize {
        let mut at = byte.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}

/// Names a file of the same directory that is spelled alike.
fn remedy_for_missing(path: &Path) -> String {
    let wanted = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut names: Vec<String> = std::fs::read_dir(parent)
        .map(|entries| entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    names.sort();
    match crate::base::diagnostic::closest(&wanted, names.iter().map(String::as_str)) {
        Some(name) => format!("did you mean `{}`?", path.with_file_name(name).display()),
        None => "check its name and its folder".into(),
    }
}

fn remedy_for_directory(path: &Path) -> String {
    let mut inside: Vec<String> = std::fs::read_dir(path)
        .map(|entries| entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    inside.retain(|name| name.ends_with(".toml") || name.ends_with(".json"));
    inside.sort();
    match inside.first() {
        Some(name) => format!("give a file in it, such as `{}`", path.join(name).display()),
        None => "give a TOML or JSON file".into(),
    }
}
