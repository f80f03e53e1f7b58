//! TOML and JSON as one tree in which each value knows its place.

use super::diagnostic::{Diagnostic, quoted};
use super::source::{Source, Span};
use toml::de::{DeTable, DeValue};

/// A language of input files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// TOML 1.1.
    Toml,
    /// JSON (RFC 8259), no comments, no trailing commas.
    Json,
}

impl Format {
    /// The format of a file by the ending of its name.
    pub fn of_path(path: &std::path::Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "toml" => Some(Self::Toml),
            "json" => Some(Self::Json),
            _ => None,
        }
    }
}

/// A value with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Place of the value; of a TOML table, its header.
    pub span: Span,
    /// The value.
    pub value: Value,
}

/// What a file can say.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Text.
    Text(String),
    /// A number; NaN and infinity are possible in TOML.
    Number(f64),
    /// True or false.
    Bool(bool),
    /// A list.
    List(Vec<Node>),
    /// Keys and values in the order of the file.
    Table(Vec<Entry>),
    /// Something no reader accepts: a date, null.
    Other(&'static str),
}

/// A key with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Place of the key.
    pub key_span: Span,
    /// The value.
    pub node: Node,
}

impl Node {
    /// The entry with this key, if this is a table.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries().iter().find(|e| e.key == key)
    }

    /// The value of a key, if this is a table.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|e| &e.node)
    }

    /// The entries of a table, none for anything else.
    pub fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The items of a list, none for anything else.
    pub fn items(&self) -> &[Node] {
        match &self.value {
            Value::List(items) => items,
            _ => &[],
        }
    }

    /// The text, if it is one.
    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// What it is, with its article, for messages.
    pub fn noun(&self) -> &'static str {
        match &self.value {
            Value::Text(_) => "a text",
            Value::Number(_) => "a number",
            Value::Bool(_) => "true or false",
            Value::List(_) => "a list",
            Value::Table(_) => "a table",
            Value::Other(noun) => noun,
        }
    }
}

/// Deepest nesting of lists and tables that is read.
const MAX_DEPTH: usize = 64;
/// Most syntax errors that are reported.
const MAX_SYNTAX_ERRORS: usize = 10;

/// Parses a source; all syntax errors come back at once (JSON stops at the first).
pub fn parse(source: &Source, format: Format) -> Result<Node, Vec<Diagnostic>> {
    match format {
        Format::Toml => parse_toml(source),
        Format::Json => parse_json(source),
    }
}

fn parse_toml(source: &Source) -> Result<Node, Vec<Diagnostic>> {
    let (table, mut errors) = DeTable::parse_recoverable(&source.text);
    if !errors.is_empty() {
        errors.sort_by_key(|e| e.span().map(|s| s.start));
        // After a bracket that is not closed everything to the end of the file looks wrong.
        let unclosed = errors.iter().position(|e| e.message().contains("array"));
        let shown = unclosed.map_or(errors.len(), |at| at + 1).min(MAX_SYNTAX_ERRORS);
        return Err(errors[..shown].iter().map(|e| toml_error(source, e)).collect());
    }
    let span = table.span().into();
    Ok(Node { span, value: toml_table(table.into_inner()) })
}

fn toml_error(source: &Source, error: &toml::de::Error) -> Diagnostic {
    let end = source.text.len();
    let span = error.span().unwrap_or(end..end);
    Diagnostic::error("syntax", format!("this is not valid TOML: {}", error.message()))
        .at(span.into(), "")
        .help(if error.message().contains("array") {
            "is a `[` not closed, or a comma missing, before this?"
        } else {
            "values are checked once the syntax is right"
        })
}

fn toml_table(table: DeTable<'_>) -> Value {
    let mut entries: Vec<Entry> = table
        .into_iter()
        .map(|(key, value)| {
            let (key_span, span) = (key.span().into(), value.span().into());
            let node = Node { span, value: toml_value(value.into_inner()) };
            Entry { key: key.into_inner().into_owned(), key_span, node }
        })
        .collect();
    entries.sort_by_key(|entry| entry.key_span);
    Value::Table(entries)
}

fn toml_value(value: DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(number) => {
            let exact = i128::from_str_radix(number.as_str(), number.radix()).map(|n| n as f64);
            Value::Number(exact.unwrap_or(f64::INFINITY))
        }
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Bool(value),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(items) => Value::List(
            items
                .into_iter()
                .map(|item| Node { span: item.span().into(), value: toml_value(item.into_inner()) })
                .collect(),
        ),
        DeValue::Table(table) => toml_table(table),
    }
}

fn parse_json(source: &Source) -> Result<Node, Vec<Diagnostic>> {
    // `serde_json` is strict (missing commas, nesting depth); `jsonc-parser` then gives the places.
    if let Err(error) = serde_json::from_str::<serde::de::IgnoredAny>(&source.text) {
        return Err(vec![json_error(source, &error)]);
    }
    if let Some(at) = too_deep(&source.text) {
        let error =
            Diagnostic::error("syntax", format!("lists and tables are nested more than {MAX_DEPTH} deep"));
        return Err(vec![error.at((at..at + 1).into(), "")]);
    }
    let options = jsonc_parser::ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
    };
    let parsed =
        jsonc_parser::parse_to_ast(&source.text, &Default::default(), &options).map_err(|error| {
            let range = error.range();
            let message = format!("this is not valid JSON: {}", error.kind());
            vec![Diagnostic::error("syntax", message).at((range.start..range.end).into(), "")]
        })?;
    let mut errors = Vec::new();
    let Some(value) = parsed.value else {
        return Err(vec![Diagnostic::error("syntax", "this is not valid JSON: the file is empty")]);
    };
    let node = json_node(&value, &mut errors);
    if errors.is_empty() { Ok(node) } else { Err(errors) }
}

/// Where valid JSON is nested too deeply: the parser that gives the places uses the stack.
fn too_deep(text: &str) -> Option<usize> {
    let (mut depth, mut in_text, mut escaped) = (0usize, false, false);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_text => escaped = true,
            b'"' => in_text = !in_text,
            b'[' | b'{' if !in_text => depth += 1,
            b']' | b'}' if !in_text => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Some(at);
        }
    }
    None
}

fn json_error(source: &Source, error: &serde_json::Error) -> Diagnostic {
    let line_start: usize =
        source.text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let at = (line_start + error.column().saturating_sub(1)).min(source.text.len());
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    Diagnostic::error("syntax", format!("this is not valid JSON: {message}"))
        .at((at..at + 1).into(), "")
        .help("values are checked once the syntax is right")
}

fn json_node(value: &jsonc_parser::ast::Value<'_>, errors: &mut Vec<Diagnostic>) -> Node {
    use jsonc_parser::ast::Value as Json;
    use jsonc_parser::common::Ranged;
    let range = value.range();
    let tree = match value {
        Json::StringLit(text) => Value::Text(text.value.clone().into_owned()),
        Json::NumberLit(number) => Value::Number(number.value.parse().unwrap_or(f64::NAN)),
        Json::BooleanLit(value) => Value::Bool(value.value),
        Json::NullKeyword(_) => Value::Other("null"),
        Json::Array(array) => Value::List(array.elements.iter().map(|e| json_node(e, errors)).collect()),
        Json::Object(object) => {
            let mut entries: Vec<Entry> = Vec::new();
            let mut seen = std::collections::BTreeMap::new();
            for property in &object.properties {
                let key = property.name.as_str().to_string();
                let name = property.name.range();
                let key_span: Span = (name.start..name.end).into();
                if let Some(first) = seen.insert(key.clone(), key_span) {
                    let message = format!("the key {} is given twice", quoted(&key));
                    errors.push(
                        Diagnostic::error("syntax", message)
                            .at(key_span, "again here")
                            .also(first, "first here"),
                    );
                    continue;
                }
                entries.push(Entry { key, key_span, node: json_node(&property.value, errors) });
            }
            Value::Table(entries)
        }
    };
    Node { span: (range.start..range.end).into(), value: tree }
}
