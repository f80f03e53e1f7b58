//! No input makes the reader panic.

use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, inspect};
use proptest::prelude::*;

fn mutated(text: &str, changes: &[(usize, u8, u8)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for &(at, byte, kind) in changes {
        let at = at % bytes.len().max(1);
        match kind % 4 {
            0 => bytes[at] = byte,
            1 => drop(bytes.drain(at..(at + usize::from(byte % 16)).min(bytes.len() - 1))),
            2 => bytes.insert(at, byte),
            // Structure and numbers are where it hurts.
            _ => bytes[at] = b"[]{}\"'=,.-+0123456789eE\n#"[usize::from(byte) % 25],
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn survive(text: &str, format: Format) {
    let inspection = inspect(text, format, "mutated");
    let rendered = inspection.diagnostics.render(false);
    assert_eq!(inspection.building.is_none(), rendered.contains("error"), "{rendered}");
    inspection.diagnostics.to_json();
}

/// Nesting that would overflow the stack of a recursive parser.
#[test]
fn deep_nesting_is_refused() {
    let many = 200_000;
    survive(&format!("x = {}{}", "[".repeat(many), "]".repeat(many)), Format::Toml);
    survive(&format!("{}x = 1", "a.".repeat(many)), Format::Toml);
    survive(&format!("[{}x]", "a . ".repeat(many)), Format::Toml);
    survive(&format!("x = {{ {}x = 1 }}", "a.".repeat(many)), Format::Toml);
    survive(&"{x=".repeat(many), Format::Toml);
    survive(&format!("{}{}", "[".repeat(many), "]".repeat(many)), Format::Json);
    survive(&"{\"x\":".repeat(many), Format::Json);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_toml_never_panics(changes in prop::collection::vec((0usize..8000, any::<u8>(), any::<u8>()), 1..8)) {
        survive(&mutated(EXAMPLE, &changes), Format::Toml);
    }

    #[test]
    fn mutated_json_never_panics(changes in prop::collection::vec((0usize..4000, any::<u8>(), any::<u8>()), 1..4)) {
        survive(&mutated(&super::reference::example_as_json(), &changes), Format::Json);
    }

    /// Any number in place of any number of the file: no panic and no endless loop.
    #[test]
    fn strange_numbers_never_panic(which in 0usize..100, value in prop_oneof![
        any::<f64>().prop_map(|v| format!("{v:e}")),
        any::<i64>().prop_map(|v| v.to_string()),
        Just("nan".to_string()), Just("-inf".to_string()), Just("1e308".to_string()), Just("\"1e300 km\"".to_string()),
    ]) {
        let lines: Vec<usize> = (0..EXAMPLE.lines().count())
            .filter(|&i| EXAMPLE.lines().nth(i).is_some_and(|l| l.contains('=') && !l.starts_with('#')))
            .collect();
        let line = lines[which % lines.len()];
        let text: Vec<String> = EXAMPLE.lines().enumerate().map(|(i, l)| {
            match l.split_once('=') {
                Some((key, _)) if i == line => format!("{key}= {value}"),
                _ => l.to_string(),
            }
        }).collect();
        survive(&text.join("\n"), Format::Toml);
    }
}
