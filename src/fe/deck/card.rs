//! Data lines cut into fields: columns of fixed width, or pieces between commas.

use super::error::{At, Messages};
use super::lines::{Block, Columns};
use super::number;
use crate::base::diagnostic::{closest, quoted};
use std::collections::BTreeMap;

/// Names of the fields of a card, in order.
pub(super) type Names = &'static [&'static str];
/// Values of `*PARAMETER` by name in capitals.
pub(super) type Parameters = BTreeMap<String, f64>;

/// One data line.
#[derive(Debug, Clone)]
pub(super) struct Card<'a> {
    names: Names,
    /// Place of the line.
    pub at: At,
    fields: Vec<(&'a str, At)>,
}

impl<'a> Card<'a> {
    /// The trimmed text of a field; empty if it is not there.
    pub fn text(&self, field: usize) -> &'a str {
        self.fields.get(field).map_or("", |f| f.0)
    }

    /// Place of a field, that of the line if it is empty.
    pub fn place(&self, field: usize) -> At {
        self.fields.get(field).filter(|f| !f.0.is_empty()).map_or(self.at, |f| f.1)
    }

    /// Number of fields up to the last one that is not empty.
    pub fn len(&self) -> usize {
        self.fields.iter().rposition(|f| !f.0.is_empty()).map_or(0, |i| i + 1)
    }
}

/// The data lines of a block, taken one after the other.
pub(super) struct Cards<'a, 'm> {
    /// The block.
    pub block: &'a Block,
    text: &'a str,
    parameters: &'a Parameters,
    /// Where errors and notes go.
    pub messages: &'m mut Messages,
    next: usize,
}

impl<'a, 'm> Cards<'a, 'm> {
    /// All lines of a block of a file's text.
    pub fn new(
        block: &'a Block,
        text: &'a str,
        parameters: &'a Parameters,
        messages: &'m mut Messages,
    ) -> Self {
        Self { block, text, parameters, messages, next: 0 }
    }

    fn line(&self, at: At) -> &'a str {
        &self.text[at.start..at.end]
    }

    /// Whether a line that is not blank is left.
    pub fn more(&self) -> bool {
        self.block.lines[self.next.min(self.block.lines.len())..]
            .iter()
            .any(|at| !self.line(*at).trim().is_empty())
    }

    /// Steps over blank lines: for lists, where they mean nothing.
    pub fn skip_blank(&mut self) {
        while self.block.lines.get(self.next).is_some_and(|at| self.line(*at).trim().is_empty()) {
            self.next += 1;
        }
    }

    /// The next line as it stands.
    pub fn title(&mut self) -> Option<(&'a str, At)> {
        let at = *self.block.lines.get(self.next)?;
        self.next += 1;
        Some((self.line(at).trim(), at))
    }

    /// Steps over the line that an option `_TITLE` or `_ID` puts before a set of cards.
    pub fn skip_title(&mut self, has: bool) {
        if has {
            self.next += 1;
        }
    }

    /// The next line with fields of ten columns; `None` at the end of the block.
    pub fn card(&mut self, names: Names) -> Option<Card<'a>> {
        self.card_of(names, &[10; 8])
    }

    /// Like [`Self::card`]; that it is missing is an error.
    pub fn required(&mut self, names: Names) -> Option<Card<'a>> {
        let card = self.card(names);
        if card.is_none() {
            let message = format!("*{}: a line is missing", self.block.keyword);
            let help = format!("the line holds {}", names.join(", "));
            self.messages.error(self.block.at, "missing-card", message, "", &help);
        }
        card
    }

    /// The first line of the next of several entries, each under a title if `titled`; `None` after the last one.
    pub fn entry(&mut self, titled: bool, names: Names) -> Option<Card<'a>> {
        self.skip_blank();
        if !self.more() {
            return None;
        }
        if titled && self.next > 0 {
            self.must_be_title();
        }
        self.skip_title(titled);
        self.required(names)
    }

    /// Refuses a line of several numbers where an identifier and a heading are expected: it may be an entry.
    fn must_be_title(&mut self) {
        let at = self.block.lines[self.next];
        let mut words = self.line(at).split([' ', ',']).filter(|w| !w.is_empty());
        let numbers = words.clone().count() > 1 && words.all(|w| number::real(w).is_some());
        if numbers {
            let message = format!("*{}: numbers in place of an identifier and a heading", self.block.keyword);
            let help = "each entry has a line with its identifier and heading before it; repeat the keyword before others";
            self.messages.error(at, "missing-title", message, "", help);
        }
    }

    /// The next line with fields of the given widths (20 columns each in the long format).
    pub fn card_of(&mut self, names: Names, widths: &[usize]) -> Option<Card<'a>> {
        let at = *self.block.lines.get(self.next)?;
        self.next += 1;
        let line = self.line(at);
        let place = |from: usize, to: usize| {
            let piece = &line[from..to];
            let lead = piece.len() - piece.trim_start().len();
            let trimmed = piece.trim();
            let start = at.start + from + lead;
            (trimmed, At { file: at.file, start, end: start + trimmed.len() })
        };
        let mut fields = Vec::with_capacity(names.len());
        let mut from = 0;
        if line.contains(',') {
            for piece in line.split(',') {
                fields.push(place(from, from + piece.len()));
                from += piece.len() + 1;
            }
            if fields.iter().skip(widths.len()).any(|f| !f.0.is_empty()) {
                let message = format!("*{}: {} fields in a line", self.block.keyword, fields.len());
                let help = format!("at most {} are expected", widths.len());
                self.messages.error(at, "too-many-fields", message, "", &help);
            }
        } else {
            if line.contains('\t') {
                let message = format!("*{}: a tab in a line with fixed columns", self.block.keyword);
                self.messages.error(at, "tab", message, "", "use blanks, or commas between the fields");
                return Some(Card { names, at, fields });
            }
            let mut before = 0;
            for width in widths {
                let to = after_columns(line, from, self.block.columns.width(*width));
                if from == to {
                    break;
                }
                fields.push(place(from, to));
                if from > 0 && !line[..from].ends_with(' ') && !line[from..].starts_with(' ') {
                    self.must_be_two([place(before, from), place(from, to)]);
                }
                (before, from) = (from, to);
            }
        }
        Some(Card { names, at, fields })
    }

    /// Two fields without a blank between them: refuses what can only be one number that is longer than its field, and notes what may be. A second
    /// number with a sign or a point of its own stands for itself, as in decks that fill their columns.
    fn must_be_two(&mut self, [(first, from), (second, to)]: [(&str, At); 2]) {
        let is_real = |text: &str| text.contains(['.', 'e', 'E', 'd', 'D']);
        if !is_real(first) || second.contains('.') || second.starts_with(['+', '-']) {
            return;
        }
        let joined = format!("{first}{second}");
        if number::real(first).is_none() || number::real(&joined).is_none() {
            return;
        }
        let at = At { end: to.end, ..from };
        let cut = second.len() > 1 && second.starts_with('0');
        if !cut && !is_real(second) {
            let text = format!("{joined} fills more than its field: it is read as {first} and {second}");
            return self.messages.note(at, text);
        }
        let message = format!("*{}: {} is longer than its field", self.block.keyword, quoted(&joined));
        let help = format!(
            "it would be cut to {} and {}: give it fewer digits, or put commas between the fields",
            quoted(first),
            quoted(second)
        );
        self.messages.error(at, "cut-number", message, "", &help);
    }

    /// The value of a text that is the name of a parameter.
    fn named(&self, text: &str) -> Option<f64> {
        let (sign, name) = parameter(text)?;
        Some(sign * self.parameters.get(&name.trim().to_uppercase())?)
    }

    fn resolve(&mut self, card: &Card<'a>, field: usize) -> Option<Result<f64, &'a str>> {
        let text = card.text(field);
        let Some((_, name)) = parameter(text) else { return Some(Err(text)) };
        if let Some(value) = self.named(text) {
            return Some(Ok(value));
        }
        let wanted = name.trim().to_uppercase();
        let names = self.parameters.keys().map(String::as_str);
        let help = match closest(&wanted, names) {
            Some(near) => format!("did you mean `&{}`?", near.to_lowercase()),
            None => "define it with *PARAMETER before it is used".into(),
        };
        let message = format!("there is no parameter {}", quoted(name));
        self.messages.error(card.place(field), "unknown-parameter", message, "", &help);
        None
    }

    /// A real number; 0 if blank, not a number after an error.
    pub fn real(&mut self, card: &Card<'a>, field: usize) -> f64 {
        if card.text(field).is_empty() {
            return 0.0;
        }
        match self.resolve(card, field) {
            None => f64::NAN,
            Some(Ok(value)) => value,
            Some(Err(text)) => number::real(text).unwrap_or_else(|| {
                self.not_a_number(card, field, "a number");
                f64::NAN
            }),
        }
    }

    /// A real number, the default where it is blank or 0.
    pub fn real_or(&mut self, card: &Card<'a>, field: usize, default: f64) -> f64 {
        let value = self.real(card, field);
        if value == 0.0 { default } else { value }
    }

    /// A whole number; 0 if blank, `None` after an error.
    pub fn whole(&mut self, card: &Card<'a>, field: usize) -> Option<i64> {
        if card.text(field).is_empty() {
            return Some(0);
        }
        let found = match self.resolve(card, field)? {
            Ok(value) if value.fract() == 0.0 && value.abs() < 9e15 => Some(value as i64),
            Ok(_) => None,
            Err(text) => number::whole(text),
        };
        if found.is_none() {
            self.not_a_number(card, field, "a whole number");
        }
        found
    }

    /// An identifier; 0 if blank, `None` after an error.
    pub fn id(&mut self, card: &Card<'a>, field: usize) -> Option<u64> {
        let found = self.whole(card, field)?;
        let id = u64::try_from(found).ok();
        if id.is_none() {
            self.not_a_number(card, field, "an identifier, which is positive");
        }
        id
    }

    /// Like [`Self::id`]; blank or 0 is an error.
    pub fn required_id(&mut self, card: &Card<'a>, field: usize) -> Option<u64> {
        let id = self.id(card, field)?;
        if id == 0 {
            let name = card.names.get(field).copied().unwrap_or("ID");
            let message = format!("*{}: {name} is missing", self.block.keyword);
            self.messages.error(card.at, "missing-id", message, "", "give a positive whole number");
            return None;
        }
        Some(id)
    }

    /// A positive real number.
    pub fn positive(&mut self, card: &Card<'a>, field: usize) -> f64 {
        let value = self.real(card, field);
        if value <= 0.0 {
            self.refuse(card, field, "it has to be positive");
        }
        value
    }

    /// Refuses a field that is neither blank nor 0.
    pub fn must_be_zero(&mut self, card: &Card<'a>, field: usize, remedy: &str) {
        let value = self.real(card, field);
        if value != 0.0 && !value.is_nan() {
            self.refuse(card, field, remedy);
        }
    }

    /// Refuses a death time that ends something within reach; blank, 0 and 1e20 mean never.
    pub fn must_be_never(&mut self, card: &Card<'a>, field: usize) {
        let value = self.real(card, field);
        if value != 0.0 && value < 1e20 {
            self.refuse(card, field, "what is given acts over the whole run; leave the time out");
        }
    }

    /// An error about the value of a field.
    pub fn refuse(&mut self, card: &Card<'a>, field: usize, remedy: &str) {
        let name = card.names.get(field).copied().unwrap_or("?");
        let text = card.text(field);
        let shown = match self.named(text) {
            Some(value) => format!("{} = {value}", quoted(text)),
            None if text.is_empty() => "blank".into(),
            None => quoted(text),
        };
        let message = format!("*{}: {name} is {shown}", self.block.keyword);
        self.messages.error(card.place(field), "unsupported-value", message, "", remedy);
    }

    fn not_a_number(&mut self, card: &Card<'a>, field: usize, expected: &str) {
        let name = card.names.get(field).copied().unwrap_or("?");
        let text = card.text(field);
        let value = self.named(text).map_or(String::new(), |value| format!(" = {value}"));
        let message =
            format!("*{}: {name} is {}{value}, expected {expected}", self.block.keyword, quoted(text));
        let columns = match self.block.columns {
            Columns::Standard => "8 or 10",
            Columns::Ten => "10",
            Columns::Long => "20",
        };
        let help = match text.contains(char::is_whitespace) {
            true => format!("the fields are {columns} columns wide; otherwise put commas between them"),
            false => String::new(),
        };
        self.messages.error(card.place(field), "bad-number", message, "", &help);
    }

    /// Refuses lines that are left.
    pub fn end(&mut self) {
        if self.more() {
            self.skip_blank();
            let at = self.block.lines[self.next];
            let message = format!("*{}: a line too many", self.block.keyword);
            let help = "take it out, or repeat the keyword before a further set";
            self.messages.error(at, "too-many-cards", message, "", help);
        }
    }
}

/// Sign and name of a parameter in a field.
fn parameter(text: &str) -> Option<(f64, &str)> {
    match (text.strip_prefix('&'), text.strip_prefix("-&")) {
        (Some(name), _) => Some((1.0, name)),
        (_, Some(name)) => Some((-1.0, name)),
        _ => None,
    }
}

/// The byte after `count` characters from byte `from`.
fn after_columns(line: &str, from: usize, count: usize) -> usize {
    if line.is_ascii() {
        return (from + count).min(line.len());
    }
    line[from..].char_indices().nth(count).map_or(line.len(), |(i, _)| from + i)
}
