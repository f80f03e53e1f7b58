//! Messages about a deck and the files it includes.

use crate::base::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::base::source::Source;
use std::fmt;
use std::sync::Arc;

/// Most messages that are kept; a deck with an error in each of a million lines needs no more.
const MOST_KEPT: usize = 200;

/// A place in one of the files of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct At {
    /// Index of the file, in the order of reading.
    pub file: usize,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// Something in a deck that has no effect, or another one than elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// File as the user named it.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// What is to be known.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.text)
    }
}

/// Why a deck cannot be used: all messages, file by file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeckErrors {
    files: Vec<Diagnostics>,
    left_out: usize,
}

impl DeckErrors {
    /// A single message about one of the files.
    pub(super) fn one(source: Arc<Source>, item: Diagnostic) -> Self {
        Self { files: vec![Diagnostics::new(source, vec![item])], left_out: 0 }
    }

    /// All messages in the order of the files.
    pub fn items(&self) -> impl Iterator<Item = &Diagnostic> {
        self.files.iter().flat_map(|f| f.items())
    }

    /// The messages as text, as rustc shows them.
    pub fn render(&self, colour: bool) -> String {
        let mut text: String = self.files.iter().map(|f| f.render(colour)).collect();
        if self.left_out > 0 {
            text.push_str(&format!("and {} more messages\n", self.left_out));
        }
        text
    }

    /// The messages for programs, one list over all files.
    pub fn to_json(&self) -> serde_json::Value {
        let of_file = |f: &Diagnostics| f.to_json().as_array().cloned().unwrap_or_default();
        serde_json::Value::Array(self.files.iter().flat_map(of_file).collect())
    }
}

impl fmt::Display for DeckErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for DeckErrors {}

/// Collects errors and notes while a deck is read.
#[derive(Debug, Default)]
pub(super) struct Messages {
    errors: Vec<(usize, Diagnostic)>,
    left_out: usize,
    notes: Vec<(At, String)>,
}

impl Messages {
    /// An error at a place: kind, what is wrong, label of the place, remedy.
    pub fn error(&mut self, at: At, code: &'static str, message: String, label: &str, help: &str) {
        let mut item = Diagnostic::error(code, message).at((at.start..at.end).into(), label);
        if !help.is_empty() {
            item = item.help(help);
        }
        self.push(at.file, item);
    }

    /// An error.
    pub fn push(&mut self, file: usize, item: Diagnostic) {
        if self.errors.len() < MOST_KEPT {
            self.errors.push((file, item));
        } else {
            self.left_out += 1;
        }
    }

    /// Something to be known; the same text is kept once.
    pub fn note(&mut self, at: At, text: impl Into<String>) {
        let text = text.into();
        if self.notes.len() < MOST_KEPT && !self.notes.iter().any(|(_, t)| *t == text) {
            self.notes.push((at, text));
        }
    }

    /// Number of errors.
    pub fn count(&self) -> usize {
        self.errors.len() + self.left_out
    }

    /// Whether there is any error.
    pub fn any(&self) -> bool {
        !self.errors.is_empty()
    }

    /// The notes in the order of their places, or the errors if there are any.
    pub fn finish(self, files: &[Arc<Source>]) -> Result<Vec<Note>, DeckErrors> {
        if self.errors.is_empty() {
            let mut notes = self.notes;
            notes.sort_by_key(|(at, _)| (at.file, at.start));
            let note = |(at, text): (At, String)| {
                let source = &files[at.file];
                Note { file: source.name.clone(), line: source.line_column(at.start).0, text }
            };
            return Ok(notes.into_iter().map(note).collect());
        }
        let of_file = |index: usize| {
            let own = self.errors.iter().filter(|(file, _)| *file == index);
            let items: Vec<Diagnostic> = own.map(|(_, item)| item.clone()).collect();
            (!items.is_empty()).then(|| Diagnostics::new(files[index].clone(), items))
        };
        let found: Vec<Diagnostics> = (0..files.len()).filter_map(of_file).collect();
        debug_assert!(found.iter().all(|f| f.items().iter().all(|d| d.severity == Severity::Error)));
        Err(DeckErrors { files: found, left_out: self.left_out })
    }
}
