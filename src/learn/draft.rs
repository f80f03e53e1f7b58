//! Rules out of the leaves of a tree, and the text of a rule file.

use super::prune::{Validated, range};
use super::questions::{Answer, Question};
use super::tree::{Column, Count, Kind, Node, Table};
use super::{Case, REPORT};
use crate::rules::Statistics;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Below all seed rules: a learned rule decides by what it supersedes, and that only within its range of evidence.
const PRIORITY: i64 = 5;
/// Counter-examples that a rule names.
const COUNTER_EXAMPLES: usize = 5;

/// A rule.
pub struct Draft {
    /// Its id.
    pub id: String,
    /// Its condition.
    pub when: String,
    words: String,
    answer: &'static Answer,
    pub statistics: Statistics,
    evidence: Vec<String>,
    counter_examples: Vec<String>,
    range: BTreeMap<&'static str, [f64; 2]>,
    /// Why it is not used.
    pub refused: Option<&'static str>,
}

/// Bounds of a column on the way to a leaf: above the first, up to the second.
type Bounds = [Option<f64>; 2];
/// What is asked on the way to a leaf, by column, in the order of asking.
type Path = Vec<(usize, Bounds)>;

/// The rules of a tree, one for each leaf with enough buildings behind it.
pub fn drafts(question: &'static Question, table: &Table, tree: &Node, cases: &[Case]) -> Vec<Draft> {
    let mut leaves = Vec::new();
    walk(tree, &mut Path::new(), &mut leaves);
    let mut drafts: Vec<Draft> = leaves
        .iter()
        .filter_map(|(path, leaf)| {
            let answer = question.answer(leaf.count.answer()?);
            Some(draft(question, table, leaf, path, answer, cases))
        })
        .collect();
    let mut taken = BTreeMap::<String, usize>::new();
    for draft in &mut drafts {
        let number = taken.entry(draft.id.clone()).or_default();
        *number += 1;
        if *number > 1 {
            let _ = write!(draft.id, "-{number}");
        }
    }
    drafts
}

/// What would be rules if mechanics allowed it: splits that were refused, if they are worth the price of a leaf.
pub fn refused(
    question: &'static Question,
    table: &Table,
    validated: &Validated,
    cases: &[Case],
) -> Vec<(Draft, String)> {
    let mut nodes = Vec::new();
    every(&validated.tree, &mut Path::new(), &mut nodes);
    let mut list = Vec::new();
    for (path, node) in nodes {
        let Some(split) = node.refused.as_ref().filter(|s| s.saves(node) > validated.price.max(1e-9)) else {
            continue;
        };
        let feature = table.columns[split.column].feature;
        for (side, upper) in [(&split.low, true), (&split.high, false)] {
            let Some(says) = side.count.answer() else { continue };
            let mut path = path.clone();
            narrow(&mut path, split.column, split.threshold, upper);
            let draft = draft(question, table, side, &path, question.answer(says), cases);
            let more = if table.columns[split.column].more == Some(true) { "more" } else { "less" };
            let reason = format!(
                "against mechanics: with a larger `{feature}` a yes should be {more} likely, and these studies say the opposite (above {}: {:.2}, up to it: {:.2})",
                split.threshold,
                split.high.count.probability(),
                split.low.count.probability()
            );
            list.push((draft, reason));
        }
    }
    list
}

/// Leaves with their paths, from low to high.
fn walk<'a>(node: &'a Node, path: &mut Path, leaves: &mut Vec<(Path, &'a Node)>) {
    let mut nodes = Vec::new();
    every(node, path, &mut nodes);
    leaves.extend(nodes.into_iter().filter(|(_, node)| node.split.is_none()));
}

fn every<'a>(node: &'a Node, path: &mut Path, nodes: &mut Vec<(Path, &'a Node)>) {
    nodes.push((path.clone(), node));
    let Some(split) = &node.split else { return };
    for (side, upper) in [(&split.low, true), (&split.high, false)] {
        let mut next = path.clone();
        narrow(&mut next, split.column, split.threshold, upper);
        every(side, &mut next, nodes);
    }
}

/// Adds a bound to a path.
fn narrow(path: &mut Path, column: usize, threshold: f64, upper: bool) {
    let at = match path.iter().position(|(c, _)| *c == column) {
        Some(at) => at,
        None => {
            path.push((column, [None, None]));
            path.len() - 1
        }
    };
    path[at].1[usize::from(upper)] = Some(threshold);
}

fn draft(
    question: &'static Question,
    table: &Table,
    leaf: &Node,
    path: &Path,
    answer: &'static Answer,
    cases: &[Case],
) -> Draft {
    let yes = std::ptr::eq(answer, &question.yes);
    let conditions: Vec<String> = path.iter().map(|(c, b)| condition(&table.columns[*c], *b)).collect();
    let slugs: Vec<String> = path.iter().map(|(c, b)| slug(&table.columns[*c], *b)).collect();
    let slug = if slugs.is_empty() { "always".to_string() } else { slugs.join("/") };
    let of_column = |(c, _): &(usize, Bounds)| {
        let feature = table.columns[*c].feature;
        let is_number = table.columns[*c].kind == Kind::Number;
        is_number.then(|| Some((feature, range(table, leaf, *c)?))).flatten()
    };
    let name = |building: usize| cases[building].study.building.clone();
    let rows = || leaf.rows.iter().map(|i| &table.rows[*i]);
    let wrong = rows().filter(|row| row.yes != yes);
    let mut counter_examples: Vec<String> =
        wrong.map(|row| format!("{}:{}", name(row.building), row.place)).collect();
    counter_examples.sort();
    counter_examples.truncate(COUNTER_EXAMPLES);
    Draft {
        id: format!("learned/{}/{slug}", question.name),
        when: std::iter::once(question.common())
            .chain(conditions.iter().cloned())
            .collect::<Vec<_>>()
            .join(" and "),
        words: words(question, answer, &conditions),
        answer,
        statistics: statistics(&leaf.count, yes, table.rows.len()),
        evidence: leaf.count.0.keys().map(|b| name(*b)).collect(),
        counter_examples,
        range: path.iter().filter_map(of_column).chain(storeys(leaf, cases)).collect(),
        refused: answer.refused,
    }
}

/// Storeys of the buildings behind a leaf.
fn storeys(leaf: &Node, cases: &[Case]) -> Option<(&'static str, [f64; 2])> {
    let of = |b: &usize| cases[*b].known.members.first()?.number("storeys");
    let storeys: Vec<f64> = leaf.count.0.keys().filter_map(of).collect();
    let least = storeys.iter().copied().reduce(f64::min)?;
    Some(("storeys", [least, storeys.iter().copied().reduce(f64::max)?]))
}

fn statistics(count: &Count, yes: bool, all: usize) -> Statistics {
    let right = if yes { count.yes() } else { count.places() - count.yes() };
    let probability = if yes { count.probability() } else { 1.0 - count.probability() };
    Statistics {
        buildings: count.0.len(),
        places: count.places(),
        right,
        coverage: to_thousandths(count.places() as f64 / all as f64),
        confidence: to_thousandths(probability),
    }
}

fn to_thousandths(x: f64) -> f64 {
    (1e3 * x).round() / 1e3
}

fn condition(column: &Column, [above, up_to]: Bounds) -> String {
    let name = column.feature;
    match column.kind {
        Kind::Number => {
            let above = above.map(|x| format!("{name} > {x}"));
            let up_to = up_to.map(|x| format!("{name} <= {x}"));
            above.into_iter().chain(up_to).collect::<Vec<_>>().join(" and ")
        }
        Kind::Flag if above.is_some() => name.to_string(),
        Kind::Flag => format!("not {name}"),
        Kind::Is(value) if above.is_some() => format!("{name} == '{value}'"),
        Kind::Is(value) => format!("{name} != '{value}'"),
    }
}

/// The part of an id that says where a leaf lies, without numbers, so that it stays the same if a threshold moves.
fn slug(column: &Column, [above, up_to]: Bounds) -> String {
    let name = column.feature.replace(['.', '_'], "-");
    match (column.kind, above.is_some(), up_to.is_some()) {
        (Kind::Number, true, true) => format!("middle-{name}"),
        (Kind::Number, true, false) => format!("high-{name}"),
        (Kind::Number, ..) => format!("low-{name}"),
        (Kind::Flag, true, _) => name,
        (Kind::Flag, ..) => format!("no-{name}"),
        (Kind::Is(value), true, _) => format!("{name}-{}", value.replace('_', "-")),
        (Kind::Is(value), ..) => format!("{name}-not-{}", value.replace('_', "-")),
    }
}

fn words(question: &Question, answer: &Answer, conditions: &[String]) -> String {
    let what = match (question.name, question.condition) {
        ("beam-ends" | "beam-ends-late", _) => "The end of a beam",
        ("column-ends" | "column-ends-late", _) => "The end of a column",
        ("floors", _) => "A floor",
        ("columns", _) => "A column",
        ("slab-lines", _) => "A strip of a slab between columns",
        ("wall-ends", _) => "The foot or head of a wall",
        _ => "A slab or beam",
    };
    let when = if question.phase == "before_contact" {
        "before the first contact"
    } else {
        "in the course of the collapse"
    };
    let place =
        if conditions.is_empty() { String::new() } else { format!(" where {}", conditions.join(" and ")) };
    format!("{what} {} {when}{place}.", answer.words)
}

/// The text of a rule file.
pub fn file(question: &Question, drafts: &[Draft]) -> String {
    let mut text = format!(
        "# {}\n# Learned by `fallwerk rules learn` from the studies named; written again by it, so not to be edited. See {REPORT}.\nschema = 1\n",
        question.words
    );
    for draft in drafts {
        text += "\n";
        text += &rule(question, draft);
    }
    text
}

/// The text of a rule.
pub fn rule(question: &Question, draft: &Draft) -> String {
    let mut text = String::from("[[rule]]\n");
    let quoted = |list: &[String]| list.iter().map(|x| format!("\"{x}\"")).collect::<Vec<_>>().join(", ");
    let s = &draft.statistics;
    let _ = writeln!(text, "id = \"{}\"", draft.id);
    let _ = writeln!(text, "words = \"{}\"", draft.words);
    let _ = writeln!(text, "applies_to = \"{}\"", question.subject);
    let _ = writeln!(text, "when = \"{}\"", draft.when);
    let _ = writeln!(text, "action = \"{}\"", draft.answer.action);
    if !draft.answer.parameters.is_empty() {
        let _ = writeln!(text, "parameters = {{ {} }}", draft.answer.parameters);
    }
    let _ = writeln!(text, "priority = {PRIORITY}");
    let _ = writeln!(text, "source = \"learned from studies: {}\"", question.words);
    if !draft.answer.supersedes.is_empty() {
        let supersedes: Vec<String> = draft.answer.supersedes.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "supersedes = [{}]", quoted(&supersedes));
    }
    let _ = writeln!(
        text,
        "statistics = {{ buildings = {}, places = {}, right = {}, coverage = {}, confidence = {} }}",
        s.buildings,
        s.places,
        s.right,
        decimal(s.coverage),
        decimal(s.confidence)
    );
    let ranges: Vec<String> = draft
        .range
        .iter()
        .map(|(n, [a, b])| format!("\"{n}\" = [{}, {}]", decimal(*a), decimal(*b)))
        .collect();
    if !ranges.is_empty() {
        let _ = writeln!(text, "range = {{ {} }}", ranges.join(", "));
    }
    let _ = writeln!(text, "evidence = [{}]", quoted(&draft.evidence));
    if !draft.counter_examples.is_empty() {
        let _ = writeln!(text, "counter_examples = [{}]", quoted(&draft.counter_examples));
    }
    text
}

/// A number as TOML writes one that is not whole.
fn decimal(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e15 { format!("{x:.1}") } else { format!("{x}") }
}
