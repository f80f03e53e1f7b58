//! The JSON Schema and the reader say the same: probed from outside, key by key.

use fallwerk::base::diagnostic::Severity;
use fallwerk::base::tree::Format;
use fallwerk::building::{inspect, schema::json_schema};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const EVERYTHING: &str = include_str!("good/everything.toml");

/// An object of a file with the part of the schema that describes it.
type Described = (Vec<String>, Value);

/// All objects of `value`, as paths, each with its schema.
fn objects(value: &Value, schema: &Value, path: &[String], all: &mut Vec<Described>) {
    let inner = |key: String| [path, &[key]].concat();
    match value {
        Value::Object(map) => {
            let kinds = schema["oneOf"].as_array();
            let schema = kinds
                .and_then(|kinds| kinds.iter().find(|k| k["properties"]["kind"]["const"] == map["kind"]))
                .unwrap_or(schema);
            if schema["properties"].is_object() {
                all.push((path.to_vec(), schema.clone()));
            }
            for (key, value) in map {
                let part = schema["properties"].get(key).unwrap_or(&schema["additionalProperties"]);
                assert!(part.is_object(), "the schema does not know {key} in {path:?}");
                objects(value, part, &inner(key.clone()), all);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                objects(item, &schema["items"], &inner(i.to_string()), all);
            }
        }
        _ => {}
    }
}

fn at<'a>(root: &'a mut Value, path: &[String]) -> &'a mut serde_json::Map<String, Value> {
    let mut value = root;
    for step in path {
        value = match value {
            Value::Array(items) => &mut items[step.parse::<usize>().unwrap()],
            other => &mut other[step],
        };
    }
    value.as_object_mut().unwrap()
}

fn messages(root: &Value, code: &str) -> Vec<String> {
    let found = inspect(&root.to_string(), Format::Json, "a.json").diagnostics;
    found.items().iter().filter(|d| d.code == code).map(|d| d.message.clone()).collect()
}

#[test]
fn schema_and_reader_agree_on_keys() {
    let root: Value = toml::from_str(EVERYTHING).unwrap();
    let mut all = Vec::new();
    objects(&root, &json_schema(), &[], &mut all);
    assert_eq!(all.len(), 38);
    for (path, schema) in &all {
        let required: BTreeSet<&str> =
            schema["required"].as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect();
        let known = schema["properties"].as_object().unwrap();
        for key in at(&mut root.clone(), path).keys() {
            let mut without = root.clone();
            at(&mut without, path).remove(key);
            let named = |m: &String| m.contains(&format!("`{key}`"));
            let missing = messages(&without, "missing-key").iter().any(named);
            // Without beams a grid needs no beam section: the one conditional key.
            let conditional = path == &["grid"] && key == "beam_section";
            assert_eq!(missing, required.contains(key.as_str()) || conditional, "{path:?} {key}");
            assert!(known.contains_key(key), "{path:?} {key}");
        }
        let mut with = root.clone();
        at(&mut with, path).insert("zzz".into(), json!(1));
        assert_eq!(messages(&with, "unknown-key"), ["unknown key `zzz`"], "{path:?}");
    }
}

/// Each key of the schema appears in the file of all keys, so that the test above probes it.
#[test]
fn the_file_of_all_keys_is_complete() {
    let root: Value = toml::from_str(EVERYTHING).unwrap();
    let mut all = Vec::new();
    objects(&root, &json_schema(), &[], &mut all);
    let mut root = root;
    let mut unseen: BTreeSet<String> = BTreeSet::new();
    let mut seen: BTreeSet<String> = BTreeSet::new();
    for (path, schema) in &all {
        let present = at(&mut root, path);
        for key in schema["properties"].as_object().unwrap().keys() {
            let name = format!("{} {key}", schema["description"]);
            if present.contains_key(key) {
                seen.insert(name)
            } else {
                unseen.insert(name)
            };
        }
    }
    assert_eq!(unseen.difference(&seen).collect::<Vec<_>>(), Vec::<&String>::new());
}

/// Whatever spelling of a unit the reader takes the schema takes as well.
#[test]
fn the_schema_knows_the_spellings_of_units() {
    let schema = json_schema();
    let of = |path: &[&str]| {
        let table = path[..path.len() - 1].iter().fold(&schema, |s, key| &s["properties"][key]);
        let text = &table["properties"][path[path.len() - 1]]["anyOf"][1];
        text["pattern"].as_str().unwrap().to_string()
    };
    let gravity = of(&["settings", "gravity"]);
    assert_eq!(gravity, "^\\s*[-+\u{2212}0-9.eE]+\\s*(m/s(\\^?2|²)|mm/s(\\^?2|²))\\s*$");
    assert!(of(&["settings", "end_time"]).contains("|[uµμ]s|"));
    assert!(of(&["settings", "critical_strain_rate"]).contains("(1/s|s\\^?-1|1/ms)"));
    let reads = |gravity: &str| {
        messages_of(&EVERYTHING.replace("gravity = 9.80665", &format!("gravity = \"{gravity}\"")))
    };
    for gravity in ["9.81 m/s²", " 9.81 m/s^2", "9810 mm/s² "] {
        assert!(reads(gravity).is_empty(), "{gravity}: {:?}", reads(gravity));
    }
}

/// The errors of a file.
fn messages_of(text: &str) -> Vec<String> {
    let found = inspect(text, Format::Toml, "a.toml").diagnostics;
    let errors = found.items().iter().filter(|d| d.severity == Severity::Error);
    errors.map(|d| d.message.clone()).collect()
}
