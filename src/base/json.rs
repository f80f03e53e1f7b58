//! Reading JSON into values: what does not fit is told with its path in the file, beside line and column.

use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt;

/// Why a text is no value of a kind.
#[derive(Debug)]
pub struct JsonError {
    /// Path such as `bodies[3].mass_kg`; empty where the text is no JSON but for a number, or for the whole of it.
    pub path: String,
    /// What is wrong with the text, with place and remedy, where that can be told better than the cause does.
    pub complaint: Option<String>,
    /// The cause, with line and column where there is a text.
    pub source: serde_json::Error,
}

impl fmt::Display for JsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        match &self.complaint {
            Some(complaint) => complaint.fmt(f),
            None => self.source.fmt(f),
        }
    }
}

impl std::error::Error for JsonError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Reads a text.
///
/// # Errors
/// If it is no JSON, or a value in it does not fit.
pub fn from_text<T: DeserializeOwned>(text: &str) -> Result<T, JsonError> {
    // paths cost time, and large files are mostly sound
    serde_json::from_str(text).map_err(|source| {
        let mut reader = serde_json::Deserializer::from_str(text);
        let again = serde_path_to_error::deserialize::<_, T>(&mut reader).err();
        let number = bad_number(text, &source);
        let excess = too_many(text, &source);
        let is_told = source.is_data() || number.is_some() || excess.is_some();
        let within = |e: &serde_path_to_error::Error<_>| {
            let value = serde_json::from_str(text).ok().filter(|_| source.is_data())?;
            Some(part_within::<T>(&value, e.path()))
        };
        let path = again.filter(|_| is_told).map(|e| words(e.path()) + &within(&e).unwrap_or_default());
        let complaint = no_json(text).map(str::to_string).or(number).or(excess);
        JsonError { path: path.unwrap_or_default(), complaint, source }
    })
}

/// The same for JSON already read.
///
/// # Errors
/// If a value in it does not fit.
pub fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, JsonError> {
    serde_path_to_error::deserialize(&value).map_err(|error| {
        let path = words(error.path()) + &part_within::<T>(&value, error.path());
        JsonError { path, complaint: None, source: error.into_inner() }
    })
}

/// Keys that tell the kind of a value, which are read before the others.
const TAGS: [&str; 2] = ["kind", "event"];

/// Where in the value that a path leads to a part of the wrong type is, as the rest of the path. Of a value that is read as a whole before its kind is known ([`TAGS`]), errors tell no more than its own path. Its kind is
/// read first, the others in their order, and the first error ends that: it is in the last part without which the error would be another one, or in the kind if it is in none of them.
fn part_within<T: DeserializeOwned>(root: &Value, path: &serde_path_to_error::Path) -> String {
    let error = |root: &Value| T::deserialize(root).err().map(|e| e.to_string());
    let is_of_a_part =
        |e: &String| ["invalid type", "invalid value", "unknown variant"].iter().any(|w| e.starts_with(w));
    let mut pointer: String = path.iter().filter_map(step).collect();
    let mut rest = String::new();
    let Some(known) = error(root).filter(is_of_a_part) else { return rest };
    loop {
        let mut parts: Vec<(String, String)> = match root.pointer(&pointer) {
            Some(Value::Object(map)) => map.keys().map(|k| (key(k), format!(".{k}"))).collect(),
            Some(Value::Array(list)) => {
                (0..list.len()).map(|i| (format!("/{i}"), format!("[{i}]"))).collect()
            }
            _ => return rest,
        };
        parts.sort_by_key(|(_, words)| !TAGS.iter().any(|tag| words[1..] == **tag));
        let is_in = |(step, _): &&(String, String)| {
            let mut other = root.clone();
            if let Some(part) = other.pointer_mut(&format!("{pointer}{step}")) {
                *part = Value::Null;
            }
            error(&other).as_ref() != Some(&known)
        };
        let Some((step, words)) = parts.iter().rfind(is_in) else { return rest };
        pointer += step;
        rest += words;
    }
}

/// A step of a path as one of a JSON pointer (RFC 6901); none for the kind of a value.
fn step(segment: &serde_path_to_error::Segment) -> Option<String> {
    match segment {
        serde_path_to_error::Segment::Seq { index } => Some(format!("/{index}")),
        serde_path_to_error::Segment::Map { key: name } => Some(key(name)),
        _ => None,
    }
}

/// A key in a JSON pointer.
fn key(name: &str) -> String {
    format!("/{}", name.replace('~', "~0").replace('/', "~1"))
}

/// What is wrong with the start of a text.
fn no_json(text: &str) -> Option<&'static str> {
    if text.starts_with('\u{feff}') {
        return Some("begins with a byte order mark, which is no part of JSON: save it as UTF-8 without one");
    }
    text.trim().is_empty().then_some("is empty, expected JSON")
}

/// That a list is longer than what it is read into: for the reader a slip of the syntax, in a text without one.
fn too_many(text: &str, error: &serde_json::Error) -> Option<String> {
    let is_sound = error.is_syntax() && serde_json::from_str::<serde::de::IgnoredAny>(text).is_ok();
    let (line, column) = (error.line(), error.column());
    is_sound.then(|| format!("has too many values: none is expected at line {line} column {column}"))
}

/// What is wrong with a number that JSON does not have, or that is too large.
fn bad_number(text: &str, error: &serde_json::Error) -> Option<String> {
    let word = word_at(text, error)?;
    let place = format!("line {} column {}", error.line(), error.column());
    let bare = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if ["nan", "inf", "infinity"].contains(&bare.as_str()) {
        return Some(format!(
            "is {word} at {place}, which JSON does not have: write a finite number, or leave the key out if it may be"
        ));
    }
    let is_too_large = word.parse::<f64>().is_ok_and(f64::is_infinite);
    is_too_large.then(|| format!("is {word} at {place}, expected a number of at most 1.8e308"))
}

/// The word that an error of syntax is about.
fn word_at<'a>(text: &'a str, error: &serde_json::Error) -> Option<&'a str> {
    let line = text.lines().nth(error.line().checked_sub(1)?).filter(|_| error.is_syntax())?;
    let is_part = |c: char| c.is_ascii_alphanumeric() || ['+', '-', '.'].contains(&c);
    // columns count bytes from 1; that of a number is its last one or the one behind
    let at = error.column().checked_sub(1)?.min(line.len());
    let (before, behind) = (line.get(..at)?, line.get(at..)?);
    let begin = before.trim_end_matches(is_part).len();
    let end = at + behind.len() - behind.trim_start_matches(is_part).len();
    line.get(begin..end).filter(|word| !word.is_empty())
}

/// A path; empty for the whole.
fn words(path: &serde_path_to_error::Path) -> String {
    if path.iter().next().is_some() { path.to_string() } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Body {
        #[serde(rename = "mass_kg")]
        _mass_kg: f64,
    }

    #[derive(Debug, Deserialize)]
    struct Model {
        #[serde(rename = "bodies")]
        _bodies: Vec<Body>,
    }

    fn said(text: &str) -> String {
        let of_text = from_text::<Model>(text).unwrap_err().to_string();
        if let Ok(value) = serde_json::from_str(text) {
            let of_value = from_value::<Model>(value).unwrap_err().to_string();
            assert!(of_text.starts_with(&of_value), "{of_text}: {of_value}");
        }
        of_text
    }

    #[derive(Debug, Deserialize)]
    struct Points {
        #[serde(rename = "points_m")]
        _points_m: Vec<[f64; 2]>,
    }

    #[test]
    fn a_list_that_is_too_long_is_told_with_its_path() {
        let text = from_text::<Points>("{\"points_m\": [[1, 2],\n[3, 4, 5]]}").unwrap_err().to_string();
        assert_eq!(text, "points_m[1]: has too many values: none is expected at line 2 column 8");
        let text = from_text::<Points>("{\"points_m\": [[1, 2] [3]]}").unwrap_err().to_string();
        assert!(text.starts_with("expected `,` or `]`"), "{text}");
    }

    #[derive(Debug, Deserialize)]
    #[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
    enum Force {
        Spring {
            #[serde(rename = "body")]
            _body: String,
            #[serde(rename = "law")]
            _law: Vec<[f64; 2]>,
            #[serde(rename = "of", default)]
            _of: Option<String>,
        },
    }

    #[derive(Debug, Deserialize)]
    struct Forces {
        #[serde(rename = "forces")]
        _forces: Vec<Force>,
    }

    /// Keys before and behind that of the kind, in the file and in the alphabet.
    #[test]
    fn parts_of_a_value_with_a_kind_are_told_with_their_path() {
        for (force, expected) in [
            (
                r#"{"kind": "spring", "body": "a", "law": [[1, 2], [3, "4"]]}"#,
                "forces[1].law[1][1]: invalid type: string \"4\", expected f64",
            ),
            (
                r#"{"kind": "spring", "body": 5, "law": []}"#,
                "forces[1].body: invalid type: integer `5`, expected a string",
            ),
            (
                r#"{"of": 3, "body": "a", "kind": "spring", "law": []}"#,
                "forces[1].of: invalid type: integer `3`, expected a string",
            ),
            (
                r#"{"kind": "sprung", "body": 5, "law": []}"#,
                "forces[1].kind: unknown variant `sprung`, expected `spring`",
            ),
            (r#"{"kind": "spring", "body": "a"}"#, "forces[1]: missing field `law`"),
            (
                r#"{"kind": "spring", "body": "a", "law": [[1, 2, 3]]}"#,
                "forces[1]: invalid length 3, expected 2 elements in sequence",
            ),
            (
                r#"{"kind": "spring", "low": 1}"#,
                "forces[1]: unknown field `low`, expected one of `body`, `law`, `of`",
            ),
        ] {
            let text = format!(r#"{{"forces": [{{"kind": "spring", "body": "b", "law": []}}, {force}]}}"#);
            let of_text = from_text::<Forces>(&text).unwrap_err().to_string();
            let of_value =
                from_value::<Forces>(serde_json::from_str(&text).unwrap()).unwrap_err().to_string();
            assert_eq!(of_value, expected);
            assert!(of_text.starts_with(expected), "{of_text}");
        }
    }

    #[test]
    fn a_list_that_is_too_short_is_told_as_a_whole() {
        let text = from_text::<Points>("{\"points_m\": [[1, 2], [3]]}").unwrap_err().to_string();
        assert!(text.starts_with("points_m[1]: invalid length 1"), "{text}");
    }

    #[test]
    fn what_does_not_fit_is_told_with_its_path() {
        for (text, expected) in [
            (
                r#"{"bodies": [{"mass_kg": 1}, {"mass_kg": "2"}]}"#,
                "bodies[1].mass_kg: invalid type: string \"2\", expected f64 at line 1 column 43",
            ),
            (
                r#"{"bodies": [{"mas_kg": 1}]}"#,
                "bodies[0].mas_kg: unknown field `mas_kg`, expected `mass_kg` at line 1 column 21",
            ),
            (r#"{"bodies": [{}]}"#, "bodies[0]: missing field `mass_kg` at line 1 column 14"),
            ("{}", "missing field `bodies` at line 1 column 2"),
            (r#"{"bodies": [}"#, "expected value at line 1 column 13"),
            (
                r#"{"bodies": [{"mass_kg": NaN}]}"#,
                "bodies[0].mass_kg: is NaN at line 1 column 25, which JSON does not have: write a finite number, or leave the key out if it may be",
            ),
            (
                "{\"bodies\": [{\"mass_kg\": 1},\n{\"mass_kg\": -Infinity}]}",
                "bodies[1].mass_kg: is -Infinity at line 2 column 14, which JSON does not have: write a finite number, or leave the key out if it may be",
            ),
            (
                r#"{"bodies": [{"mass_kg": 1e999}]}"#,
                "bodies[0].mass_kg: is 1e999 at line 1 column 29, expected a number of at most 1.8e308",
            ),
            ("", "is empty, expected JSON"),
            (" \n", "is empty, expected JSON"),
            (
                "\u{feff}{}",
                "begins with a byte order mark, which is no part of JSON: save it as UTF-8 without one",
            ),
        ] {
            assert_eq!(said(text), expected);
        }
    }
}
