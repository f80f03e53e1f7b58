//! The structure check: walks a file beside the table of [`super::format`] and notes each missing or
//! unknown key, wrong type, wrong unit and value out of range, without stopping at any.

use super::format::{FILE, Key, Kind, Quantity, SCHEMA_VERSION, Table};
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::source::Span;
use crate::base::tree::{Entry, Node, Value};
use crate::base::units::{
    Dimension, UnitError, parse_quantity, round_to_digits, show, show_range, split_quantity,
};

/// All structural errors of a building file.
pub fn check(root: &Node) -> Vec<Diagnostic> {
    check_against(root, &FILE)
}

/// All structural errors of a file that a table of keys describes.
pub fn check_against(root: &Node, table: &'static Table) -> Vec<Diagnostic> {
    let mut walk = Walk { found: Vec::new(), file: table.noun };
    if !matches!(root.value, Value::Table(_)) {
        walk.wrong_type(root, "the file", "a table of keys and values", None);
        return walk.found;
    }
    let version_only = version_is_other(root);
    walk.table(root, root.span, table, "the file", false);
    if version_only {
        // Another version may have other keys: say only that.
        walk.found.retain(|d| d.code == "schema-version");
    }
    walk.found
}

fn version_is_other(root: &Node) -> bool {
    match root.get("schema").map(|n| &n.value) {
        Some(Value::Number(v)) => *v != SCHEMA_VERSION && *v > 1.0,
        Some(Value::Text(text)) => text.starts_with(OF_OTHERS),
        _ => false,
    }
}

/// How the versions of the files begin that the program itself writes.
const OF_OTHERS: &str = "fallwerk-";

/// The SI value of a node, or what is wrong with it. The range is not checked here.
pub fn quantity_of(node: &Node, dimension: Dimension) -> Result<f64, UnitError> {
    match &node.value {
        Value::Number(value) if value.is_finite() => Ok(*value),
        Value::Number(_) => Err(UnitError::NotFinite),
        Value::Text(text) => parse_quantity(text, dimension),
        _ => Err(UnitError::NotANumber),
    }
}

/// Whether a text can be an id.
pub fn is_id(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !text.is_empty() && text.len() <= 80 && text.chars().all(allowed)
}

/// Whether a text may name members, their ends and strips of slabs (`SLAB:COLUMN|COLUMN`), `*` standing for any characters.
fn is_pattern(text: &str) -> bool {
    text.replace('*', "x").split([':', '|']).all(is_id)
}

struct Walk {
    found: Vec<Diagnostic>,
    /// Noun of the table that the whole file is.
    file: &'static str,
}

impl Walk {
    /// `header` is where missing keys are reported; a `tagged` table also has the key `kind`.
    fn table(&mut self, node: &Node, header: Span, table: &Table, name: &str, tagged: bool) {
        let Value::Table(entries) = &node.value else {
            return self.wrong_type(node, name, "a table of keys and values", None);
        };
        for entry in entries {
            match table.key(&entry.key) {
                Some(key) => self.value(&entry.node, entry.key_span, &key.kind, key.name, Some(key)),
                None if entry.key == "kind" && tagged => {}
                None => self.unknown_key(&entry.key, entry.key_span, table),
            }
        }
        for key in table.keys.iter().filter(|key| key.required && node.get(key.name).is_none()) {
            // A misspelt key has been reported with its remedy.
            let unknown = |e: &&Entry| table.key(&e.key).is_none();
            if !entries.iter().filter(unknown).any(|e| suggestion(&e.key, table) == Some(key.name)) {
                self.missing_key(header, key, table);
            }
        }
    }

    fn value(&mut self, node: &Node, header: Span, kind: &Kind, name: &str, key: Option<&Key>) {
        match kind {
            Kind::Text(limit) => self.text(node, name, *limit, key),
            Kind::Id | Kind::Reference(_) => self.id(node, name, key),
            Kind::MemberPattern => {
                if !node.text().is_some_and(is_pattern) {
                    self.wrong_type(
                        node,
                        name,
                        "a member id, or a pattern such as \"C1-*\" or \"S1:*\"",
                        key,
                    );
                }
            }
            Kind::Version => self.version(node),
            Kind::Quantity(quantity) => self.quantity(node, name, quantity, key),
            Kind::Count(min, max) => self.count(node, name, (*min, *max), key),
            Kind::Choice(words, unsupported) => self.choice(node, name, words, unsupported, key),
            Kind::List(of, min, max) => self.list(node, header, name, of, (*min, *max), key),
            Kind::Tuple(kinds) => self.tuple(node, name, kinds, key),
            Kind::Table(table) => self.table(node, place_of_table(node, header), table, name, false),
            Kind::Variants(tables, unsupported) => self.variants(node, header, name, tables, unsupported),
            Kind::Map(of) => self.map(node, name, of),
        }
    }

    fn map(&mut self, node: &Node, name: &str, of: &Kind) {
        let Value::Table(entries) = &node.value else {
            return self.wrong_type(node, name, "a table of ids", None);
        };
        for entry in entries {
            if !is_id(&entry.key) {
                self.found.push(bad_id(&entry.key, entry.key_span));
            }
            self.value(&entry.node, entry.key_span, of, &entry.key, None);
        }
    }

    fn variants(
        &mut self,
        node: &Node,
        header: Span,
        name: &str,
        tables: &'static [(&'static str, &'static Table)],
        unsupported: &[&str],
    ) {
        if !matches!(node.value, Value::Table(_)) {
            return self.wrong_type(node, name, "a table with a `kind`", None);
        }
        let words: Vec<&str> = tables.iter().map(|(word, _)| *word).collect();
        let Some(kind) = node.get("kind") else {
            let error = Diagnostic::error("missing-key", format!("{} has no `kind`", quoted(name)))
                .at(place_of_table(node, header), "which kind is this?")
                .help(format!("add `kind = \"…\"` with one of {}", list_words(&words)));
            return self.found.push(error);
        };
        match tables.iter().find(|(word, _)| kind.text() == Some(word)) {
            Some((_, table)) => self.table(node, place_of_table(node, header), table, name, true),
            None => self.choice(kind, "kind", &words, unsupported, None),
        }
    }

    fn list(
        &mut self,
        node: &Node,
        header: Span,
        name: &str,
        of: &Kind,
        limits: (usize, usize),
        key: Option<&Key>,
    ) {
        let Value::List(items) = &node.value else {
            return self.wrong_type(node, name, "a list", key);
        };
        if items.len() < limits.0 || items.len() > limits.1 {
            let message = format!("`{name}` has {} entries", items.len());
            let label = format!("{} to {} are possible", limits.0, limits.1);
            self.found.push(Diagnostic::error("list-length", message).at(node.span, label));
        }
        for item in items.iter().take(limits.1) {
            let place = if item.span.start == item.span.end { header } else { item.span };
            self.value(item, place, of, name, None);
        }
    }

    fn tuple(&mut self, node: &Node, name: &str, kinds: &[Kind], key: Option<&Key>) {
        let items = node.items();
        if items.len() != kinds.len() || !matches!(node.value, Value::List(_)) {
            return self.wrong_type(node, name, &format!("a list of {} numbers", kinds.len()), key);
        }
        for (item, kind) in items.iter().zip(kinds) {
            self.value(item, item.span, kind, name, None);
        }
    }

    fn text(&mut self, node: &Node, name: &str, limit: usize, key: Option<&Key>) {
        let Some(text) = node.text() else { return self.wrong_type(node, name, "a text in quotes", key) };
        if name == "name"
            && (text.trim().is_empty() || text.contains(['/', '\\']) || text.chars().any(char::is_control))
        {
            let error = Diagnostic::error("bad-name", format!("{} is no usable name", quoted(text)))
                .at(node.span, "it becomes part of file names")
                .help("use letters, digits, spaces, `-` and `_`");
            return self.found.push(error);
        }
        if text.chars().count() > limit {
            let message = format!("`{name}` is longer than {limit} characters");
            self.found.push(Diagnostic::error("too-long", message).at(node.span, ""));
        }
    }

    fn id(&mut self, node: &Node, name: &str, key: Option<&Key>) {
        match node.text() {
            None => self.wrong_type(node, name, "an id in quotes", key),
            Some(text) if !is_id(text) => self.found.push(bad_id(text, node.span)),
            Some(_) => {}
        }
    }

    fn version(&mut self, node: &Node) {
        if node.value != Value::Number(SCHEMA_VERSION) {
            let newer = matches!(node.value, Value::Number(v) if v > SCHEMA_VERSION);
            let is = |kind: &str| matches!(&node.value, Value::Text(text) if text.starts_with(kind));
            let help = if newer {
                "this file needs a newer Fallwerk, or write `schema = 1`"
            } else if is("fallwerk-mbs/") {
                "this is a multibody model: `fallwerk simulate` runs it"
            } else if is(OF_OTHERS) {
                "this is something that Fallwerk has written: give the building file that it was made of"
            } else {
                "write `schema = 1`"
            };
            let error = Diagnostic::error("schema-version", "this version of the file format is not known")
                .at(node.span, "Fallwerk reads version 1")
                .help(help);
            self.found.push(error);
        }
    }

    fn count(&mut self, node: &Node, name: &str, (min, max): (u32, u32), key: Option<&Key>) {
        let Value::Number(value) = node.value else {
            return self.wrong_type(node, name, "a whole number", key);
        };
        if value.fract() != 0.0 || !(f64::from(min)..=f64::from(max)).contains(&value) {
            let error = Diagnostic::error("out-of-range", format!("`{name}` cannot be {value}"))
                .at(node.span, format!("a whole number from {min} to {max}"));
            self.found.push(error);
        }
    }

    fn choice(&mut self, node: &Node, name: &str, words: &[&str], unsupported: &[&str], key: Option<&Key>) {
        let Some(text) = node.text() else {
            return self.wrong_type(node, name, &format!("one of {}", list_words(words)), key);
        };
        if words.contains(&text) {
            return;
        }
        let error = if unsupported.contains(&text) {
            Diagnostic::error("not-supported", format!("{} is not supported as `{name}`", quoted(text)))
                .at(node.span, "not supported")
                .help(format!("supported: {}", list_words(words)))
        } else {
            Diagnostic::error("unknown-word", format!("{} is no `{name}`", quoted(text)))
                .at(node.span, format!("expected one of {}", list_words(words)))
                .help_if(closest(text, words.iter().copied()).map(|w| format!("did you mean `{w}`?")))
        };
        self.found.push(error);
    }

    fn quantity(&mut self, node: &Node, name: &str, quantity: &Quantity, key: Option<&Key>) {
        match quantity_of(node, quantity.dimension) {
            Ok(value) if value >= quantity.min && value <= quantity.max => {}
            Ok(value) => self.found.push(out_of_range(node, name, value, quantity)),
            Err(UnitError::NotANumber) if node.text().is_none() => {
                let expected =
                    format!("{} such as {}", quantity.dimension.noun(), quantity.dimension.example());
                self.wrong_type(node, name, &expected, key);
            }
            Err(UnitError::NotFinite) => {
                let error = Diagnostic::error("not-finite", format!("`{name}` is not a finite number"));
                self.found.push(error.at(node.span, ""));
            }
            Err(error) => self.found.push(wrong_unit(node, name, &error, quantity)),
        }
    }

    fn wrong_type(&mut self, node: &Node, name: &str, expected: &str, key: Option<&Key>) {
        let example = key.filter(|k| !k.example.is_empty() && !expected.contains("such as"));
        let error = Diagnostic::error("wrong-type", format!("{} must be {expected}", quoted(name)))
            .at(node.span, format!("this is {}", node.noun()))
            .help_if(example.map(|k| format!("for example `{name} = {}`", k.example)));
        self.found.push(error);
    }

    fn unknown_key(&mut self, key: &str, span: Span, table: &Table) {
        let help = match suggestion(key, table) {
            Some(name) => format!("did you mean `{name}`?"),
            None => {
                let names: Vec<&str> = table.keys.iter().map(|k| k.name).collect();
                format!("the keys here are {}", list_words(&names))
            }
        };
        let error = Diagnostic::error("unknown-key", format!("unknown key {}", quoted(key)))
            .at(span, format!("not a key of {}", table.noun))
            .help(help);
        self.found.push(error);
    }

    fn missing_key(&mut self, header: Span, key: &Key, table: &Table) {
        let message = format!("{} needs the key `{}`", table.noun, key.name);
        let help = if key.example.is_empty() {
            let section = if matches!(key.kind, Kind::Map(_)) {
                format!("[{}.ID]", key.name)
            } else {
                format!("[{}]", key.name)
            };
            format!("add `{section}`: {}", key.doc)
        } else {
            format!("add `{} = {}`: {}", key.name, key.example, key.doc)
        };
        let mut error = Diagnostic::error("missing-key", message).help(help);
        if table.noun == self.file {
            error.place = None;
        } else {
            error = error.at(header, format!("`{}` is missing", key.name));
        }
        self.found.push(error);
    }
}

/// The known key that a misspelt one probably means.
fn suggestion(key: &str, table: &Table) -> Option<&'static str> {
    closest(key, table.keys.iter().map(|k| k.name))
}

fn place_of_table(node: &Node, header: Span) -> Span {
    if node.span.start < node.span.end { node.span } else { header }
}

fn bad_id(text: &str, span: Span) -> Diagnostic {
    let error = Diagnostic::error("bad-id", format!("{} cannot be an id", quoted(text)))
        .at(span, "letters, digits, `-`, `_` and `.` only, at most 80");
    if text.contains('*') {
        error.help("no pattern is possible here: write one entry for each id")
    } else {
        error
    }
}

/// "`a`, `b` or `c`".
pub fn list_words(words: &[&str]) -> String {
    let shown: Vec<String> = words.iter().map(|w| format!("`{w}`")).collect();
    match shown.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => shown.concat(),
    }
}

fn out_of_range(node: &Node, name: &str, value: f64, quantity: &Quantity) -> Diagnostic {
    let dimension = quantity.dimension;
    let label = format!("plausible: {}", show_range(quantity.min, quantity.max, dimension));
    Diagnostic::error(
        "out-of-range",
        format!("`{name}` is {}, which is out of range", show(value, dimension)),
    )
    .at(node.span, label)
    .help_if(unit_slip(node, value, quantity).map(|meant| format!("did you mean `\"{meant}\"`?")))
    .help_if(weight_per_volume(value, quantity))
}

/// A usual density if the number is a weight per volume in kN/m3, as drawings and codes of loads give it.
fn weight_per_volume(value: f64, quantity: &Quantity) -> Option<String> {
    const GRAVITY_M_S2: f64 = 9.81;
    let meant = round_to_digits(1e3 * value / GRAVITY_M_S2, 3);
    let is_usual = meant >= quantity.usual.0 && meant <= quantity.usual.1;
    (quantity.dimension == Dimension::Density && is_usual)
        .then(|| format!("a weight of {value} kN/m3 is a density of about {meant} kg/m3"))
}

/// The same digits with another unit, if that gives a usual value.
fn unit_slip(node: &Node, value: f64, quantity: &Quantity) -> Option<String> {
    let number = match &node.value {
        Value::Text(text) => split_quantity(text)?.0,
        _ => value,
    };
    let (least, most) = quantity.usual;
    let usual = |unit: &&crate::base::units::Unit| {
        let meant = number * unit.factor;
        let common = !matches!(unit.symbol, "%" | "dm" | "km" | "us" | "min");
        number != 0.0 && common && meant >= least && meant <= most
    };
    let unit = quantity.dimension.units().find(usual)?;
    Some(format!("{} {}", round_to_digits(number, 9), unit.symbol))
}

fn wrong_unit(node: &Node, name: &str, error: &UnitError, quantity: &Quantity) -> Diagnostic {
    let written = node.text().map_or_else(|| "this number".into(), quoted);
    let dimension = quantity.dimension;
    let message = match error {
        UnitError::WrongDimension { found } => {
            let expected = format!("{} such as {}", dimension.noun(), dimension.example());
            format!("`{name}`: expected {expected}, found {written}, {}", found.noun())
        }
        _ => format!("`{name}`: {written} is not {}", dimension.noun()),
    };
    let units: Vec<&str> = dimension.units().map(|u| u.symbol).collect();
    let help = match error {
        UnitError::UnknownUnit { similar: Some(unit), .. } => Some(format!("did you mean `{unit}`?")),
        UnitError::UnknownUnit { similar: None, .. } => Some(format!("the units are {}", list_words(&units))),
        UnitError::MissingUnit { number } if dimension == Dimension::Number => {
            Some(format!("write {number} without quotes"))
        }
        UnitError::MissingUnit { number } => Some(format!(
            "write {number} without quotes for {}, or add a unit: {}",
            dimension.si_symbol(),
            list_words(&units)
        )),
        UnitError::DecimalComma => {
            node.text().map(|t| format!("write \"{}\"", t.replacen(',', ".", 1).escape_debug()))
        }
        UnitError::NotANumber => Some(format!("write {} as {}", dimension.noun(), dimension.example())),
        _ => None,
    };
    Diagnostic::error("wrong-unit", message).at(node.span, error.to_string()).help_if(help)
}
