//! The rule language, the checks of rule files, the engine, the seed rules.

mod commands;
mod engine;
mod facts;
mod learn;
mod malformed;
mod records;
mod seed;

use fallwerk::rules::{RuleBase, Source};

/// The text of one rule. `lines` replaces or adds fields (`field = value`).
pub fn rule(id: &str, lines: &[&str]) -> String {
    let mut fields: Vec<(String, String)> = [
        ("id", format!("\"{id}\"")),
        ("words", "\"A rule.\"".to_string()),
        ("applies_to", "\"member\"".to_string()),
        ("when", "\"member.kind == 'column'\"".to_string()),
        ("action", "\"rigid_body\"".to_string()),
        ("priority", "10".to_string()),
        ("source", "\"a test\"".to_string()),
    ]
    .map(|(name, value)| (name.to_string(), value))
    .into();
    for line in lines {
        let (name, value) = line.split_once(" = ").unwrap();
        match fields.iter_mut().find(|(n, _)| n == name) {
            Some(field) => field.1 = value.to_string(),
            None => fields.push((name.to_string(), value.to_string())),
        }
    }
    let body: String = fields.iter().map(|(name, value)| format!("{name} = {value}\n")).collect();
    format!("[[rule]]\n{body}")
}

/// A rule base of one file with these rules.
pub fn base(rules: &[String]) -> Result<RuleBase, String> {
    let text = format!("schema = 1\n{}", rules.concat());
    RuleBase::from_sources(vec![Source { name: "test.toml".into(), text }])
        .map_err(|problems| problems.to_string())
}
