//! The form of the facts in `kb/facts`.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

#[test]
fn every_fact_has_an_id_words_a_source_and_a_value_or_a_law() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("kb/facts");
    let mut ids = BTreeSet::new();
    for item in fs::read_dir(folder).unwrap() {
        let path = item.unwrap().path();
        let table: toml::Table = fs::read_to_string(&path).unwrap().parse().unwrap();
        assert_eq!(table["schema"].as_integer(), Some(1), "{}", path.display());
        for fact in table["fact"].as_array().unwrap() {
            let text = |name: &str| fact.get(name).and_then(toml::Value::as_str).unwrap_or("");
            let id = text("id");
            assert!(ids.insert(id.to_string()) && !id.is_empty(), "{}: `{id}`", path.display());
            assert!(!text("words").is_empty() && !text("source").is_empty(), "{id}");
            assert!(["text", "secondary"].contains(&text("basis")), "{id}");
            let valued =
                fact.get("value").is_some_and(|v| v.as_float().is_some()) && !text("unit").is_empty();
            let lawful = !text("law").is_empty() && fact.get("parameters").is_some_and(toml::Value::is_table);
            assert!(valued != lawful, "{id}: either a value with a unit or a law with parameters");
        }
    }
    assert!(ids.len() >= 6);
}
