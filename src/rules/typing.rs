//! Checks of a condition against the catalogue of features: names, subjects, types.

use super::expr::{Expr, Operand, Relation, Span, Test};
use super::features::{self, CATALOGUE, Feature, FeatureType, suggestion};
use super::value::{SubjectKind, Value};

/// A fault in a condition: where in its text, and what.
pub type Fault = (Span, String);

/// All faults of a condition about subjects of one kind.
pub fn faults(expr: &Expr, subject: SubjectKind) -> Vec<Fault> {
    let mut found = Vec::new();
    visit(expr, &mut |test| check(test, subject, &mut found));
    found
}

/// Calls `action` for each comparison, in order of the text.
pub fn visit<'a>(expr: &'a Expr, action: &mut impl FnMut(&'a Test)) {
    match expr {
        Expr::Always => {}
        Expr::And(a, b) | Expr::Or(a, b) => {
            visit(a, action);
            visit(b, action);
        }
        Expr::Not(a) => visit(a, action),
        Expr::Test(test) => action(test),
    }
}

/// The feature of this name, if subjects of this kind have it; otherwise what to say.
pub fn lookup(name: &str, subject: SubjectKind) -> Result<&'static Feature, String> {
    let own = || CATALOGUE.iter().filter(|f| f.subjects.contains(&subject)).map(|f| f.name);
    match features::find(name) {
        Some(feature) if feature.subjects.contains(&subject) => Ok(feature),
        Some(feature) => {
            let kinds: Vec<&str> = feature.subjects.iter().map(|k| k.name()).collect();
            Err(format!("a {subject} has no feature `{name}` (only: {})", kinds.join(", ")))
        }
        None => Err(match suggestion(name, own()) {
            Some(near) => format!("unknown feature `{name}`; did you mean `{near}`?"),
            None => {
                format!("unknown feature `{name}`; a {subject} has: {}", own().collect::<Vec<_>>().join(", "))
            }
        }),
    }
}

fn check(test: &Test, subject: SubjectKind, found: &mut Vec<Fault>) {
    let (name, span) = &test.feature;
    let feature = match lookup(name, subject) {
        Ok(feature) => feature,
        Err(message) => return found.push((span.clone(), message)),
    };
    let is_number = |f: &Feature| matches!(f.kind, FeatureType::Number { .. });
    if test.relation != Relation::Equal && !is_number(feature) {
        return found.push((
            test.span.clone(),
            format!("`{name}` is {}: it can be equal or not, but not less or greater", feature.type_words()),
        ));
    }
    for (operand, span) in &test.operands {
        match operand {
            Operand::Literal(value) if feature.admits(value) => {}
            Operand::Literal(value) => found.push((span.clone(), mismatch(feature, value))),
            Operand::Feature(_, other) => match lookup(other, subject) {
                Err(message) => found.push((span.clone(), message)),
                Ok(other) if !(is_number(feature) && is_number(other)) => {
                    // A bare word where a name is meant lacks its quotes.
                    found.push((
                        span.clone(),
                        format!("`{name}` and `{}` cannot be compared: only numbers can", other.name),
                    ));
                }
                Ok(other) if other.kind != feature.kind => {
                    found.push((
                        span.clone(),
                        format!(
                            "`{name}` is {}, `{}` is {}",
                            feature.type_words(),
                            other.name,
                            other.type_words()
                        ),
                    ));
                }
                Ok(_) => {}
            },
        }
    }
}

fn mismatch(feature: &Feature, value: &Value) -> String {
    let near = match (feature.kind, value) {
        (FeatureType::Names(names), Value::Name(name)) => suggestion(name, names.iter().copied()),
        _ => None,
    };
    let hint = near.map(|n| format!("; did you mean '{n}'?")).unwrap_or_default();
    format!("`{}` is {}, not {value}{hint}", feature.name, feature.type_words())
}
