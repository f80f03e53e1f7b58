//! Messages about a source text: each with its place, the value found and what would be right.

use super::source::{Source, Span, Unreadable};
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str};
use std::fmt;
use std::sync::Arc;

/// Most messages that are rendered at once; the rest is counted.
pub const MAX_RENDERED: usize = 50;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The input cannot be used.
    Error,
    /// The input can be used, but is probably not what was meant.
    Warning,
}

/// One message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Kind of the problem, stable for programs that read the JSON output.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// Where, with a short label; `None` if the file as a whole is meant.
    pub place: Option<(Span, String)>,
    /// Other places that explain it.
    pub related: Vec<(Span, String)>,
    /// What would be right.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// An error.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            place: None,
            related: Vec::new(),
            help: Vec::new(),
        }
    }

    /// A warning.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// Sets the place and its label (which may be empty).
    pub fn at(mut self, span: Span, label: impl Into<String>) -> Self {
        self.place = Some((span, label.into()));
        self
    }

    /// Adds a related place.
    pub fn also(mut self, span: Span, label: impl Into<String>) -> Self {
        self.related.push((span, label.into()));
        self
    }

    /// Adds a remedy.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Adds a remedy if there is one.
    pub fn help_if(self, text: Option<String>) -> Self {
        match text {
            Some(text) => self.help(text),
            None => self,
        }
    }
}

/// The messages about one source, in the order of their places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostics {
    source: Arc<Source>,
    items: Vec<Diagnostic>,
}

impl Diagnostics {
    /// Sorts messages by place (those about the whole file first) and drops repetitions.
    pub fn new(source: Arc<Source>, mut items: Vec<Diagnostic>) -> Self {
        items.sort_by_key(|d| (d.place.as_ref().map(|(span, _)| span.start), d.severity));
        items.dedup();
        Self { source, items }
    }

    /// Adds a message that was found later.
    pub fn add(&mut self, item: Diagnostic) {
        let items = std::mem::take(&mut self.items).into_iter().chain([item]).collect();
        *self = Self::new(self.source.clone(), items);
    }

    /// The single message that a file cannot be read.
    pub fn unreadable(name: &str, problem: Unreadable) -> Self {
        let item = Diagnostic::error("unreadable", problem.message).help(problem.remedy);
        Self { source: Arc::new(Source::new(name, "")), items: vec![item] }
    }

    /// All messages.
    pub fn items(&self) -> &[Diagnostic] {
        &self.items
    }

    /// The source they are about.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Number of errors.
    pub fn errors(&self) -> usize {
        self.items.iter().filter(|d| d.severity == Severity::Error).count()
    }

    /// Number of warnings.
    pub fn warnings(&self) -> usize {
        self.items.len() - self.errors()
    }

    /// The messages as text, as rustc shows them.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let mut text = String::new();
        for item in self.items.iter().take(MAX_RENDERED) {
            text.push_str(&renderer.render(&[self.group(item)]));
            text.push_str("\n\n");
        }
        if self.items.len() > MAX_RENDERED {
            text.push_str(&format!("and {} more messages\n\n", self.items.len() - MAX_RENDERED));
        }
        text.push_str(&self.tally());
        text.push('\n');
        text
    }

    /// "3 errors, 1 warning in building.toml".
    pub fn tally(&self) -> String {
        let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let name = normalize_untrusted_str(&self.source.name);
        match (self.errors(), self.warnings()) {
            (0, w) => format!("{} in {name}", count(w, "warning")),
            (e, 0) => format!("{} in {name}", count(e, "error")),
            (e, w) => format!("{}, {} in {name}", count(e, "error"), count(w, "warning")),
        }
    }

    fn group<'a>(&'a self, item: &'a Diagnostic) -> Group<'a> {
        let level = match item.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let mut group = level.primary_title(item.message.as_str()).id(item.code).element(self.frame(item));
        for help in &item.help {
            group = group.element(Level::HELP.message(normalize_untrusted_str(help)));
        }
        group
    }

    fn frame<'a>(&'a self, item: &'a Diagnostic) -> annotate_snippets::Element<'a> {
        let Some((span, label)) = &item.place else {
            return Origin::path(self.source.name.as_str()).into();
        };
        let mark = |kind: AnnotationKind, span: &Span, label: &'a String| {
            let piece = self.source.first_line_of(*span);
            let mark = kind.span(piece.start..piece.end);
            if label.is_empty() { mark } else { mark.label(label.as_str()) }
        };
        Snippet::source(self.source.text.as_str())
            .path(self.source.name.as_str())
            .annotation(mark(AnnotationKind::Primary, span, label))
            .annotations(item.related.iter().map(|(s, l)| mark(AnnotationKind::Context, s, l)))
            .into()
    }

    /// The messages for programs: a list of objects with file, line, column, severity, code, message, help.
    pub fn to_json(&self) -> serde_json::Value {
        let item = |d: &Diagnostic| {
            let place = d.place.as_ref().map(|(span, _)| self.source.line_column(span.start));
            serde_json::json!({
                "file": self.source.name,
                "line": place.map(|p| p.0),
                "column": place.map(|p| p.1),
                "severity": if d.severity == Severity::Error { "error" } else { "warning" },
                "code": d.code,
                "message": d.message,
                "label": d.place.as_ref().map(|(_, label)| label),
                "help": d.help,
            })
        };
        serde_json::Value::Array(self.items.iter().map(item).collect())
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}

/// The candidate that is spelled most like `wanted`, if any is near enough to be a slip.
pub fn closest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let likeness = strsim::jaro_winkler(&wanted, &candidate.to_lowercase());
        let edits = strsim::damerau_levenshtein(&wanted, &candidate.to_lowercase());
        let allowed = (candidate.chars().count() / 3).max(1);
        if (edits <= allowed || likeness > 0.9) && best.is_none_or(|(b, _)| likeness > b) {
            best = Some((likeness, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// A text of the user in backquotes, without control characters and not too long.
pub fn quoted(text: &str) -> String {
    let mut shown: String = text.chars().take(60).flat_map(char::escape_debug).collect();
    if text.chars().nth(60).is_some() {
        shown.push('…');
    }
    format!("`{}`", shown.replace("\\\"", "\"").replace("\\'", "'"))
}
