//! Reading rule files: TOML, `schema = 1`, any number of `[[rule]]`. All problems of a file are
//! found at once, except that a file which is no TOML of this form has only its first.

use super::action::{self, Action, ActionSpec, CATALOGUE, ParameterType};
use super::expr;
use super::features::{FeatureType, suggestion};
use super::problem::{Place, Problem, Source};
use super::rule::{Rule, Statistics};
use super::typing;
use super::value::{SubjectKind, Value};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;

/// Version of the file format.
pub const RULES_SCHEMA: i64 = 1;
/// Longest id of a rule: it stands in traces and tables.
const LONGEST_ID: usize = 200;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    schema: Spanned<i64>,
    #[serde(default)]
    rule: Vec<RawRule>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRule {
    id: Spanned<String>,
    words: Spanned<String>,
    applies_to: Spanned<String>,
    when: Spanned<String>,
    action: Spanned<String>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, Spanned<toml::Value>>,
    priority: i64,
    source: Spanned<String>,
    #[serde(default)]
    evidence: Vec<String>,
    #[serde(default)]
    range: BTreeMap<Spanned<String>, Spanned<[f64; 2]>>,
    #[serde(default)]
    supersedes: Vec<String>,
    statistics: Option<Spanned<Statistics>>,
    #[serde(default)]
    counter_examples: Vec<String>,
}

/// Reads the rules of one file; those with problems are left out, the problems are added, and their ids to those of `faulty` rules.
pub fn read(source: Source, problems: &mut Vec<Problem>, faulty: &mut BTreeSet<String>) -> Vec<Rule> {
    let source = Arc::new(source);
    let mut reader = Reader { source: source.clone(), problems };
    let raw: RawFile = match toml::from_str(&source.text) {
        Ok(raw) => raw,
        Err(error) => {
            reader.unread(error.span().unwrap_or(0..0), error.message().trim().replace('\n', "; "));
            return Vec::new();
        }
    };
    if *raw.schema.get_ref() != RULES_SCHEMA {
        let message = format!("schema {}; this program reads schema {RULES_SCHEMA}", raw.schema.get_ref());
        reader.unread(raw.schema.span(), message);
        return Vec::new();
    }
    let read = raw.rule.into_iter().filter_map(|rule| {
        let id = rule.id.get_ref().clone();
        let sound = reader.rule(rule);
        faulty.extend(sound.is_none().then_some(id));
        sound
    });
    read.collect()
}

struct Reader<'a> {
    source: Arc<Source>,
    problems: &'a mut Vec<Problem>,
}

impl Reader<'_> {
    fn place(&self, span: Range<usize>) -> Place {
        Place { source: self.source.clone(), span }
    }

    fn problem(&mut self, span: Range<usize>, message: String) {
        let place = self.place(span);
        self.problems.push(Problem { place: Some(place), message, is_unread: false });
    }

    /// A problem that keeps the whole file from being read.
    fn unread(&mut self, span: Range<usize>, message: String) {
        let place = self.place(span);
        self.problems.push(Problem { place: Some(place), message, is_unread: true });
    }

    fn rule(&mut self, raw: RawRule) -> Option<Rule> {
        let before = self.problems.len();
        let place = self.place(raw.id.span());
        self.texts(&raw);
        let subject = self.subject(&raw.applies_to);
        let condition = match expr::parse(raw.when.get_ref()) {
            Ok(condition) => Some(condition),
            Err(error) => {
                let span = self.inside(&raw.when, error.span);
                self.problem(span, error.message);
                None
            }
        };
        if let (Some(condition), Some(subject)) = (&condition, subject) {
            for (span, message) in typing::faults(condition, subject) {
                let span = self.inside(&raw.when, span);
                self.problem(span, message);
            }
        }
        let action = self.action(&raw.action, subject);
        let parameters = action.map(|spec| self.parameters(spec, &raw)).unwrap_or_default();
        let statistics = raw.statistics.as_ref().map(|s| self.statistics(s));
        let range = subject.map(|subject| self.range(subject, &raw.range)).unwrap_or_default();
        if self.problems.len() > before {
            return None;
        }
        Some(Rule {
            id: raw.id.into_inner(),
            words: raw.words.into_inner().trim().to_string(),
            applies_to: subject?,
            when: raw.when.into_inner().trim().to_string(),
            condition: condition?,
            action: action.map(|spec: &ActionSpec| -> Action { spec.action })?,
            parameters,
            priority: raw.priority,
            source: raw.source.into_inner(),
            evidence: raw.evidence,
            range,
            supersedes: raw.supersedes,
            statistics,
            counter_examples: raw.counter_examples,
            place,
        })
    }

    fn statistics(&mut self, raw: &Spanned<Statistics>) -> Statistics {
        let statistics = *raw.get_ref();
        let share = |x: f64| (0.0..=1.0).contains(&x);
        if !share(statistics.coverage) || !share(statistics.confidence) {
            self.problem(raw.span(), "`coverage` and `confidence` lie between 0 and 1".to_string());
        }
        if statistics.right > statistics.places {
            let message = format!("right at {} of {} places", statistics.right, statistics.places);
            self.problem(raw.span(), message);
        }
        statistics
    }

    fn texts(&mut self, raw: &RawRule) {
        let id = raw.id.get_ref();
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_' | '/');
        if id.is_empty() || !id.chars().all(plain) {
            self.problem(raw.id.span(), format!("id `{id}`: use small letters, digits, `-`, `_` and `/`"));
        }
        if id.len() > LONGEST_ID {
            let message = format!("an id of {} characters: use at most {LONGEST_ID}", id.len());
            self.problem(raw.id.span(), message);
        }
        if raw.words.get_ref().trim().is_empty() {
            self.problem(raw.words.span(), "`words` must say the rule in plain language".to_string());
        }
        if raw.source.get_ref().trim().is_empty() {
            self.problem(raw.source.span(), "`source` must say where the rule comes from".to_string());
        }
    }

    fn subject(&mut self, raw: &Spanned<String>) -> Option<SubjectKind> {
        let found = SubjectKind::from_name(raw.get_ref());
        if found.is_none() {
            let known = || SubjectKind::ALL.into_iter().map(SubjectKind::name);
            self.problem(raw.span(), unknown("kind of subject", raw.get_ref(), known()));
        }
        found
    }

    fn action(&mut self, raw: &Spanned<String>, subject: Option<SubjectKind>) -> Option<&'static ActionSpec> {
        let Some(spec) = action::find(raw.get_ref()) else {
            self.problem(raw.span(), unknown("action", raw.get_ref(), CATALOGUE.iter().map(|s| s.name)));
            return None;
        };
        if let Some(subject) = subject.filter(|subject| !spec.subjects.contains(subject)) {
            let kinds: Vec<&str> = spec.subjects.iter().map(|k| k.name()).collect();
            self.problem(
                raw.span(),
                format!("action `{}` is for {}, not for a {subject}", spec.name, kinds.join(" or ")),
            );
        }
        Some(spec)
    }

    fn parameters(&mut self, spec: &ActionSpec, raw: &RawRule) -> BTreeMap<String, Value> {
        let mut values = BTreeMap::new();
        for (name, value) in &raw.parameters {
            let Some(parameter) = spec.parameters.iter().find(|p| p.name == name.get_ref()) else {
                let what = format!("parameter of `{}`", spec.name);
                self.problem(
                    name.span(),
                    unknown(&what, name.get_ref(), spec.parameters.iter().map(|p| p.name)),
                );
                continue;
            };
            match parameter_value(parameter.kind, value.get_ref()) {
                Ok(value) => {
                    values.insert(parameter.name.to_string(), value);
                }
                Err(expected) => {
                    self.problem(value.span(), format!("`{}` must be {expected}", parameter.name))
                }
            }
        }
        for parameter in spec.parameters.iter().filter(|p| p.required) {
            if !raw.parameters.keys().any(|name| name.get_ref() == parameter.name) {
                self.problem(
                    raw.action.span(),
                    format!("action `{}` needs the parameter `{}`", spec.name, parameter.name),
                );
            }
        }
        values
    }

    fn range(
        &mut self,
        subject: SubjectKind,
        raw: &BTreeMap<Spanned<String>, Spanned<[f64; 2]>>,
    ) -> BTreeMap<String, [f64; 2]> {
        let mut ranges = BTreeMap::new();
        for (name, range) in raw {
            let [low, high] = *range.get_ref();
            match typing::lookup(name.get_ref(), subject) {
                Err(message) => self.problem(name.span(), message),
                Ok(feature) if !matches!(feature.kind, FeatureType::Number { .. }) => {
                    self.problem(
                        name.span(),
                        format!("`{}` is {}: only numbers have a range", feature.name, feature.type_words()),
                    );
                }
                Ok(_) if low.is_nan() || high.is_nan() || low > high => {
                    self.problem(
                        range.span(),
                        format!("a range goes from low to high, not from {low} to {high}"),
                    );
                }
                Ok(feature) => {
                    ranges.insert(feature.name.to_string(), [low, high]);
                }
            }
        }
        ranges
    }

    /// The place in the file of a place in a text: exact if the text stands in the file as it is.
    fn inside(&self, text: &Spanned<String>, inner: Range<usize>) -> Range<usize> {
        let whole = text.span();
        let Some(token) = self.source.text.get(whole.clone()) else { return whole };
        match token.find(text.get_ref().as_str()) {
            Some(offset) => {
                let start = whole.start + offset;
                start + inner.start..start + inner.end
            }
            None => whole,
        }
    }
}

fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    match suggestion(name, known.clone()) {
        Some(near) => format!("unknown {what} `{name}`; did you mean `{near}`?"),
        None => {
            let list = known.collect::<Vec<_>>().join(", ");
            format!("unknown {what} `{name}`; known: {}", if list.is_empty() { "none" } else { &list })
        }
    }
}

fn parameter_value(kind: ParameterType, value: &toml::Value) -> Result<Value, String> {
    let number = match value {
        toml::Value::Integer(n) => Some(*n as f64),
        toml::Value::Float(x) => Some(*x),
        _ => None,
    };
    match kind {
        ParameterType::Positive(unit) => {
            number.filter(|x| x.is_finite() && *x > 0.0).map(Value::Number).ok_or_else(|| {
                if unit == "1" {
                    "a number above 0".to_string()
                } else {
                    format!("a number above 0, in {unit}")
                }
            })
        }
        ParameterType::Count(least, most) => match value {
            toml::Value::Integer(n) if (i64::from(least)..=i64::from(most)).contains(n) => {
                Ok(Value::Number(*n as f64))
            }
            other => Err(format!("a whole number, at least {least} and at most {most}, not {other}")),
        },
        ParameterType::Names(names) => match value {
            toml::Value::String(name) if names.contains(&name.as_str()) => Ok(Value::Name(name.clone())),
            _ => Err(format!("one of '{}'", names.join("', '"))),
        },
    }
}
