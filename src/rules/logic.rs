//! Whether conditions can hold together, for the search for conflicts and gaps.
//!
//! A condition becomes a disjunction of conjunctions of atoms. A conjunction is refuted if a name
//! or flag has no value left, a number no interval left, or two features no order left. What is not
//! refuted counts as possible: an overlap may be reported that needs features to depend on each other, but
//! none is missed.

use super::expr::{Expr, Operand, Relation, Test};
use super::features::{self, FeatureType};
use super::value::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

const LESS: u8 = 1;
const EQUAL: u8 = 2;
const GREATER: u8 = 4;

/// Most conjunctions looked at; beyond it the answer is "possible".
pub(super) const TERMS_LIMIT: usize = 2048;

/// A simple statement about features.
#[derive(Debug, Clone, PartialEq)]
pub enum Atom {
    /// The name (or flag) is one of these.
    OneOf(String, BTreeSet<String>),
    /// The number is in one of the orders of the mask against a value.
    Bound(String, u8, f64),
    /// The first number is in one of the orders of the mask against a factor times the second.
    Order(String, u8, f64, String),
}

/// Statements that hold together.
pub type Conjunction = Vec<Atom>;

/// The conjunctions of which at least one holds if `expr` holds (if it does not hold, when
/// `negated`); refuted ones are left out. `None`: too many.
pub fn cases(expr: &Expr, negated: bool) -> Option<Vec<Conjunction>> {
    match expr {
        Expr::Always => Some(if negated { vec![] } else { vec![vec![]] }),
        Expr::Not(inner) => cases(inner, !negated),
        Expr::And(a, b) if negated => either(cases(a, true)?, cases(b, true)?),
        Expr::Or(a, b) if !negated => either(cases(a, false)?, cases(b, false)?),
        Expr::And(a, b) | Expr::Or(a, b) => both(&cases(a, negated)?, &cases(b, negated)?),
        Expr::Test(test) => Some(test_cases(test, negated)),
    }
}

fn either(mut a: Vec<Conjunction>, b: Vec<Conjunction>) -> Option<Vec<Conjunction>> {
    a.extend(b);
    (a.len() <= TERMS_LIMIT).then_some(a)
}

/// All pairs of conjunctions that are not refuted. `None`: too many.
pub fn both(a: &[Conjunction], b: &[Conjunction]) -> Option<Vec<Conjunction>> {
    let mut joined: Vec<Conjunction> = Vec::new();
    for left in a {
        for right in b {
            let mut conjunction = left.clone();
            conjunction.extend(right.iter().filter(|atom| !left.contains(atom)).cloned());
            if possible(&conjunction) && !joined.contains(&conjunction) {
                joined.push(conjunction);
                if joined.len() > TERMS_LIMIT {
                    return None;
                }
            }
        }
    }
    Some(joined)
}

fn test_cases(test: &Test, negated: bool) -> Vec<Conjunction> {
    let name = &test.feature.0;
    let Some(values) = values_of(name) else { return number_cases(test, negated) };
    let listed: BTreeSet<String> = test
        .operands
        .iter()
        .filter_map(|(operand, _)| match operand {
            Operand::Literal(Value::Name(name)) => Some(name.clone()),
            Operand::Literal(Value::Flag(flag)) => Some(flag.to_string()),
            _ => None,
        })
        .collect();
    let left: BTreeSet<String> =
        values.into_iter().map(str::to_string).filter(|v| listed.contains(v) != negated).collect();
    if left.is_empty() { vec![] } else { vec![vec![Atom::OneOf(name.clone(), left)]] }
}

/// All names that a feature can have, or those of a flag; none of a number.
fn values_of(name: &str) -> Option<Vec<&'static str>> {
    match features::find(name)?.kind {
        FeatureType::Names(names) => Some(names.to_vec()),
        FeatureType::Flag => Some(vec!["false", "true"]),
        FeatureType::Number { .. } => None,
    }
}

/// That a feature has none of some names; none if it has no others.
pub fn none_of(name: &str, among: &BTreeSet<String>) -> Option<Atom> {
    let others = values_of(name)?.into_iter().map(str::to_string).filter(|v| !among.contains(v));
    let others: BTreeSet<String> = others.collect();
    (!others.is_empty()).then(|| Atom::OneOf(name.to_string(), others))
}

fn number_cases(test: &Test, negated: bool) -> Vec<Conjunction> {
    let mask = if negated { orders(test.relation) ^ 7 } else { orders(test.relation) };
    let atoms = test.operands.iter().filter_map(|(operand, _)| match operand {
        Operand::Literal(Value::Number(value)) => Some(Atom::Bound(test.feature.0.clone(), mask, *value)),
        Operand::Literal(_) => None,
        Operand::Feature(factor, other) => Some(order(&test.feature.0, mask, *factor, other)),
    });
    // One of a list: any of them; none of a list: all of the negations.
    let mut cases: Vec<Conjunction> =
        if negated { vec![atoms.collect()] } else { atoms.map(|atom| vec![atom]).collect() };
    cases.retain(|case| possible(case));
    cases
}

/// Comparisons with numbers that the range of the feature decides, and whether they hold wherever it is known.
pub fn decided(test: &Test) -> Vec<(Atom, bool)> {
    let mut found = Vec::new();
    for (operand, _) in &test.operands {
        let Operand::Literal(Value::Number(value)) = operand else { continue };
        let of = |mask: u8| Atom::Bound(test.feature.0.clone(), mask, *value);
        let mask = orders(test.relation);
        let [may_hold, may_fail] = [mask, mask ^ 7].map(|mask| possible(&[of(mask)]));
        if !(may_hold && may_fail) {
            found.push((of(mask), may_hold));
        }
    }
    found
}

/// That a number is below a value, and that it is above another one.
pub fn beyond(name: &str, [below, above]: [f64; 2]) -> [Atom; 2] {
    [Atom::Bound(name.to_string(), LESS, below), Atom::Bound(name.to_string(), GREATER, above)]
}

/// The orders that a relation admits.
fn orders(relation: Relation) -> u8 {
    match relation {
        Relation::Equal => EQUAL,
        Relation::Less => LESS,
        Relation::AtMost => LESS | EQUAL,
        Relation::Greater => GREATER,
        Relation::AtLeast => GREATER | EQUAL,
    }
}

/// An order with the names sorted, so that `a < b` and `b > a` are the same statement.
fn order(a: &str, mask: u8, factor: f64, b: &str) -> Atom {
    if a <= b || factor == 0.0 {
        return Atom::Order(a.to_string(), mask, factor, b.to_string());
    }
    // a ? f b is b ?' a / f, with the order turned round for a positive factor only.
    let turned = if factor > 0.0 {
        (mask & EQUAL)
            | if mask & LESS != 0 { GREATER } else { 0 }
            | if mask & GREATER != 0 { LESS } else { 0 }
    } else {
        mask
    };
    Atom::Order(b.to_string(), turned, 1.0 / factor, a.to_string())
}

/// Whether a conjunction is not refuted.
pub fn possible(conjunction: &[Atom]) -> bool {
    let mut sets: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut bounds: BTreeMap<&str, Vec<(u8, f64)>> = BTreeMap::new();
    let mut orders: BTreeMap<(&str, u64, &str), u8> = BTreeMap::new();
    for atom in conjunction {
        match atom {
            Atom::OneOf(name, values) => {
                let values: BTreeSet<&str> = values.iter().map(String::as_str).collect();
                sets.entry(name).and_modify(|held| held.retain(|v| values.contains(v))).or_insert(values);
            }
            Atom::Bound(name, mask, value) => bounds.entry(name).or_default().push((*mask, *value)),
            Atom::Order(a, mask, factor, b) => *orders.entry((a, factor.to_bits(), b)).or_insert(7) &= mask,
        }
    }
    let same = |(a, factor, b): &(&str, u64, &str), mask: u8| {
        a != b || f64::from_bits(*factor) != 1.0 || mask & EQUAL != 0
    };
    sets.values().all(|values| !values.is_empty())
        && bounds.into_iter().all(|(name, own)| interval_left(&[own, of_range(name)].concat()))
        && orders.iter().all(|(key, mask)| *mask != 0 && same(key, *mask))
}

/// The range of a feature as bounds.
fn of_range(name: &str) -> Vec<(u8, f64)> {
    let [least, most] = features::find(name).map_or(features::ANY, |f| f.range);
    let bounds = [(GREATER | EQUAL, least), (LESS | EQUAL, most)];
    bounds.into_iter().filter(|(_, bound)| bound.is_finite()).collect()
}

/// Whether some number satisfies all bounds: tried at each value named, between neighbours, and outside.
fn interval_left(bounds: &[(u8, f64)]) -> bool {
    let mut values: Vec<f64> = bounds.iter().map(|(_, v)| *v).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let mut tries = vec![f64::NEG_INFINITY, f64::INFINITY];
    tries.extend(values.windows(2).map(|w| 0.5 * w[0] + 0.5 * w[1]));
    tries.extend(&values);
    tries.into_iter().any(|x| bounds.iter().all(|(mask, v)| Atom::admits(*mask, x, *v)))
}

impl Atom {
    /// Whether one of the orders of a mask is that of two numbers.
    pub fn admits(orders: u8, a: f64, b: f64) -> bool {
        orders & order_of(a, b) != 0
    }

    /// The features that it is about.
    pub fn features(&self) -> impl Iterator<Item = &String> {
        let (first, second) = match self {
            Self::OneOf(name, _) | Self::Bound(name, ..) => (name, None),
            Self::Order(a, _, _, b) => (a, Some(b)),
        };
        [Some(first), second].into_iter().flatten()
    }

    /// The least and the most number that has one of the orders of a mask against a value.
    pub fn range(orders: u8, value: f64) -> [f64; 2] {
        let [below, above] = [orders & LESS != 0, orders & GREATER != 0];
        [if below { f64::NEG_INFINITY } else { value }, if above { f64::INFINITY } else { value }]
    }
}

/// How a number stands to another one.
fn order_of(x: f64, v: f64) -> u8 {
    if x < v {
        LESS
    } else if x > v {
        GREATER
    } else {
        EQUAL
    }
}

impl fmt::Display for Atom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let symbol = |mask: u8| ["never", "<", "==", "<=", ">", "!=", ">=", "any"][usize::from(mask & 7)];
        match self {
            Self::OneOf(name, values) if values.len() == 1 => {
                let value = values.first().map_or("", String::as_str);
                match value {
                    "true" => write!(f, "{name}"),
                    "false" => write!(f, "not {name}"),
                    _ => write!(f, "{name} == '{value}'"),
                }
            }
            Self::OneOf(name, values) => {
                let list: Vec<String> = values.iter().map(|v| format!("'{v}'")).collect();
                write!(f, "{name} in [{}]", list.join(", "))
            }
            Self::Bound(name, mask, value) => write!(f, "{name} {} {value}", symbol(*mask)),
            Self::Order(a, mask, 1.0, b) => write!(f, "{a} {} {b}", symbol(*mask)),
            Self::Order(a, mask, factor, b) => write!(f, "{a} {} {factor} * {b}", symbol(*mask)),
        }
    }
}

/// A conjunction as a condition; sets of the same feature are drawn together.
pub fn words(conjunction: &[Atom]) -> String {
    let mut merged: Vec<Atom> = Vec::new();
    for atom in conjunction {
        if let Atom::OneOf(name, values) = atom {
            let held = merged.iter_mut().find_map(|m| match m {
                Atom::OneOf(n, held) if n == name => Some(held),
                _ => None,
            });
            if let Some(held) = held {
                held.retain(|v| values.contains(v));
                continue;
            }
        }
        merged.push(atom.clone());
    }
    if merged.is_empty() {
        return "always".to_string();
    }
    merged.iter().map(Atom::to_string).collect::<Vec<_>>().join(" and ")
}

#[cfg(test)]
mod tests {
    use super::super::expr::parse;
    use super::*;

    fn overlap(a: &str, b: &str) -> bool {
        let case = |text: &str| cases(&parse(text).unwrap(), false).unwrap();
        !both(&case(a), &case(b)).unwrap().is_empty()
    }

    #[test]
    fn overlaps() {
        assert!(overlap("member.kind == 'column'", "member.slenderness > 3"));
        assert!(!overlap("member.kind == 'column'", "member.kind in ['beam', 'slab']"));
        assert!(!overlap(
            "member.kind != 'column'",
            "not member.kind in ['beam', 'slab', 'wall', 'footing']"
        ));
        assert!(!overlap("member.slenderness < 3", "member.slenderness >= 3"));
        assert!(overlap("member.slenderness <= 3", "member.slenderness >= 3"));
        assert!(!overlap("member.slenderness <= 3 and member.slenderness != 3", "member.slenderness >= 3"));
        assert!(!overlap(
            "member.strain_rate <= critical_strain_rate",
            "critical_strain_rate < member.strain_rate"
        ));
        assert!(!overlap(
            "member.strain_rate > 2 * critical_strain_rate",
            "critical_strain_rate >= 0.5 * member.strain_rate"
        ));
        assert!(overlap(
            "member.strain_rate <= critical_strain_rate",
            "member.strain_rate >= critical_strain_rate"
        ));
        assert!(!overlap("end.clamped", "not end.clamped"));
        assert!(!overlap("always", "member.length < member.length"));
        assert!(!overlap("storeys in [1, 2]", "storeys not in [1, 2]"));
        assert!(overlap("not (member.kind == 'column' and storeys > 3)", "member.kind == 'column'"));
        // features have ranges
        assert!(!overlap("always", "contact.approach_speed < -1"));
        assert!(!overlap("always", "not member.length >= 0"));
        assert!(!overlap("section.position in [2, -1]", "always"));
        assert!(overlap("section.position >= 1", "section.position <= 1"));
        assert!(overlap("member.fall_height < -1", "member.axial_ratio < 0"));
    }

    #[test]
    fn ranges_of_features_decide_comparisons() {
        for (text, expected) in [
            ("contact.approach_speed < -1", vec![("contact.approach_speed < -1", false)]),
            ("contact.approach_speed >= 0", vec![("contact.approach_speed >= 0", true)]),
            ("contact.approach_speed > 0", vec![]),
            ("section.position in [0.5, 2]", vec![("section.position == 2", false)]),
            ("section.position <= 1", vec![("section.position <= 1", true)]),
            ("member.axial_ratio < -1", vec![]),
            ("member.length > 2 * storeys", vec![]),
        ] {
            let Expr::Test(test) = parse(text).unwrap() else { panic!("{text}") };
            let found: Vec<(String, bool)> =
                decided(&test).into_iter().map(|(atom, holds)| (atom.to_string(), holds)).collect();
            let expected: Vec<(String, bool)> =
                expected.into_iter().map(|(a, b)| (a.to_string(), b)).collect();
            assert_eq!(found, expected, "{text}");
        }
    }

    #[test]
    fn negation_covers_what_is_left() {
        let expr = parse("member.kind == 'column' and (end.clamped or storeys <= 3)").unwrap();
        let rest = cases(&expr, true).unwrap();
        assert_eq!(rest.len(), 2);
        assert_eq!(words(&rest[0]), "member.kind in ['beam', 'footing', 'slab', 'wall']");
        assert_eq!(words(&rest[1]), "not end.clamped and storeys > 3");
    }
}
