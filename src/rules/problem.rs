//! What is wrong with a rule file, with its place: `file:line:column: message` and the marked line.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A rule file: its name as shown and its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Path as shown to people.
    pub name: String,
    /// The text.
    pub text: String,
}

/// A place in a rule file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub source: Arc<Source>,
    /// Bytes of the text.
    pub span: Range<usize>,
}

impl Place {
    /// Line and column from 1 (columns count characters), the line's text, and the length of the mark.
    fn locate(&self) -> (usize, usize, &str, usize) {
        let text = &self.source.text;
        let floor = |mut at: usize| {
            at = at.min(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let start = floor(self.span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let mark = text[start..floor(self.span.end).clamp(start, line_end)].chars().count();
        let line = text[..start].matches('\n').count() + 1;
        (line, text[line_start..start].chars().count() + 1, &text[line_start..line_end], mark.max(1))
    }

    /// `file:line`.
    pub fn short(&self) -> String {
        format!("{}:{}", self.source.name, self.locate().0)
    }
}

/// One problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where; `None` for something that has no place (a folder that cannot be read).
    pub place: Option<Place>,
    /// What is wrong and what would be right.
    pub message: String,
    /// Whether a file or folder could not be read as rules at all, so that nothing else is known of it.
    pub is_unread: bool,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else { return f.write_str(&self.message) };
        let (line, column, text, mark) = place.locate();
        let gutter = line.to_string().len();
        let (text, before) = excerpt(text.trim_end_matches('\r'), column - 1);
        // Tabs stay tabs in front of the mark, so that it stands below what it marks.
        let indent: String = text.chars().take(before).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let mark = mark.min(text.chars().count().saturating_sub(before)).max(1);
        writeln!(f, "{}:{line}:{column}: {}", place.source.name, self.message)?;
        writeln!(f, "{line} | {text}")?;
        write!(f, "{:gutter$} | {indent}{}", "", "^".repeat(mark))
    }
}

/// Most characters that are shown of a line, and how many of them before the mark.
const SHOWN: (usize, usize) = (240, 80);

/// A line, or what is around a place in a long one, and how many characters of that are before the place.
fn excerpt(line: &str, place: usize) -> (String, usize) {
    let (most, before) = SHOWN;
    let skipped = if line.chars().count() > most { place.saturating_sub(before) } else { 0 };
    let start = if skipped > 0 { "…" } else { "" };
    let text: String = line.chars().skip(skipped).take(most).collect();
    let end = if line.chars().count() > skipped + most { "…" } else { "" };
    (format!("{start}{text}{end}"), place - skipped + start.chars().count())
}

/// All problems of a rule base, in order of files and places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problems(pub Vec<Problem>);

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.0.iter().enumerate() {
            write!(f, "{}{problem}", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

impl Problems {
    /// How many there are, in words.
    pub fn count_words(&self) -> String {
        match self.0.len() {
            1 => "1 problem".to_string(),
            count => format!("{count} problems"),
        }
    }

    /// Whether some file or folder could not be read at all.
    pub fn has_unread(&self) -> bool {
        self.0.iter().any(|problem| problem.is_unread)
    }
}
