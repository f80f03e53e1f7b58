//! The JSON Schema of the building file (draft 2020-12), made from the table of keys that the reader uses.

use super::format::{FILE, Kind, Quantity, SCHEMA_VERSION, Table};
use crate::base::units::Dimension;
use serde_json::{Map, Value, json};

/// The JSON Schema of a building file.
pub fn json_schema() -> Value {
    schema_of(&FILE, "Fallwerk building")
}

/// The JSON Schema of a file that a table of keys describes.
pub fn schema_of(table: &'static Table, title: &str) -> Value {
    let mut schema = of_table(table, None);
    if let Value::Object(object) = &mut schema {
        object.insert("$schema".into(), json!("https://json-schema.org/draft/2020-12/schema"));
        object.insert("title".into(), json!(title));
    }
    schema
}

fn of_table(table: &Table, tag: Option<&str>) -> Value {
    let mut properties = Map::new();
    let mut required: Vec<&str> = Vec::new();
    if let Some(tag) = tag {
        properties.insert("kind".into(), json!({ "const": tag }));
        required.push("kind");
    }
    for key in table.keys {
        let mut value = of_kind(&key.kind);
        if let Value::Object(object) = &mut value {
            object.insert("description".into(), json!(key.doc));
        }
        properties.insert(key.name.into(), value);
        if key.required {
            required.push(key.name);
        }
    }
    json!({
        "type": "object",
        "description": table.doc,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn of_kind(kind: &Kind) -> Value {
    match kind {
        Kind::Text(limit) => json!({ "type": "string", "maxLength": limit }),
        Kind::Id | Kind::Reference(_) => json!({ "type": "string", "pattern": "^[A-Za-z0-9_.-]{1,80}$" }),
        Kind::MemberPattern => json!({ "type": "string", "pattern": "^[A-Za-z0-9_.*:|-]{1,242}$" }),
        Kind::Version => json!({ "const": SCHEMA_VERSION as i64 }),
        Kind::Quantity(quantity) => of_quantity(quantity),
        Kind::Count(min, max) => json!({ "type": "integer", "minimum": min, "maximum": max }),
        Kind::Choice(words, _) => json!({ "enum": words }),
        Kind::List(of, min, max) => {
            json!({ "type": "array", "items": of_kind(of), "minItems": min, "maxItems": max })
        }
        Kind::Tuple(kinds) => {
            let items: Vec<Value> = kinds.iter().map(of_kind).collect();
            json!({ "type": "array", "prefixItems": items, "minItems": kinds.len(), "maxItems": kinds.len() })
        }
        Kind::Table(table) => of_table(table, None),
        Kind::Variants(tables, _) => {
            let kinds: Vec<Value> = tables.iter().map(|(tag, table)| of_table(table, Some(tag))).collect();
            json!({ "oneOf": kinds })
        }
        Kind::Map(of) => json!({ "type": "object", "additionalProperties": of_kind(of) }),
    }
}

/// The number of a quantity as a regular expression, with what may stand around it.
const NUMBER: &str = "^\\s*[-+\u{2212}0-9.eE]+\\s*";

/// All ways in which a unit may be written, as a regular expression: powers as digits, behind `^` or raised, and the Greek letter of `us`.
fn spellings(symbol: &str) -> String {
    match symbol {
        "deg" => "deg|°".to_string(),
        "us" => "[uµμ]s".to_string(),
        "1/s" => "1/s|s\\^?-1".to_string(),
        plain => plain.replace('2', "(\\^?2|²)").replace('3', "(\\^?3|³)"),
    }
}

fn of_quantity(quantity: &Quantity) -> Value {
    let number = json!({ "type": "number", "minimum": quantity.min, "maximum": quantity.max });
    let units: Vec<String> = quantity.dimension.units().map(|u| spellings(u.symbol)).collect();
    let si = quantity.dimension.si_symbol();
    let comment = if si.is_empty() { "a pure number".into() } else { format!("a plain number is in {si}") };
    let text = json!({
        "type": "string",
        "pattern": format!("{NUMBER}({})\\s*$", units.join("|")),
        "examples": [quantity.dimension.example().trim_matches('"')],
    });
    if quantity.dimension == Dimension::Number {
        return json!({ "anyOf": [number, { "type": "string", "pattern": format!("{NUMBER}%\\s*$") }], "$comment": comment });
    }
    json!({ "anyOf": [number, text], "$comment": comment })
}
